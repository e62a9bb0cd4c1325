"""Gates: a figure beside the floor it must keep. A figure that does not exist (None, NaN) fails."""

from dataclasses import dataclass

from .scenarios import Scenario


@dataclass(frozen=True)
class Gate:
    """One floor. `stage` is counted from 1; None concerns the whole run."""

    name: str
    stage: int | None
    value: float | None
    floor: float

    @property
    def passed(self) -> bool:
        """Whether the figure is there and not above its floor."""
        return self.value is not None and self.value <= self.floor


def gates(scenario: Scenario, stages: list[dict], missed: int, false_alarms: int) -> list[Gate]:
    """The gates of a run. `stages`: per stage `e` and `tracking_delay` of the identifier under test."""
    floors = scenario.floors
    result = [Gate("missed switches", None, missed, 0), Gate("false alarms", None, false_alarms, 0)]
    for number, stage in enumerate(stages, start=1):
        if floors.e is not None:
            result.append(Gate("e", number, stage["e"], floors.e))
        if floors.tracking_delay is not None and number > 1:
            result.append(Gate("tracking delay", number, stage["tracking_delay"], floors.tracking_delay))
    return result


MAX_ERROR_TO_FLOOR = 1.2
MAX_FREE_RUN_FALL = 0.1


def effect_gates(named: bool, error_to_floor: float | None, free_run_fall: float | None) -> list[Gate]:
    """The gates of a hidden effect.

    `named`: the diagnosis names the hidden effect. The others are of the improved model on a record it has not seen: force
    residual ÷ noise floor, and free-run error ÷ that of the model without the effect.
    """
    return [
        Gate("wrong diagnosis", None, 0 if named else 1, 0),
        Gate("force residual ÷ noise floor", None, error_to_floor, MAX_ERROR_TO_FLOOR),
        Gate("free-run error, after ÷ before", None, free_run_fall, MAX_FREE_RUN_FALL),
    ]
