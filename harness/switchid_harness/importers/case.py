"""What is simulated: a plant with sensor noise and a switch, an identifier beside it."""

from dataclasses import dataclass, field
from pathlib import Path

WIRES = ["q", "qd", "F"]
"""Outputs of the plant, inputs of the identifier."""

WATCHED = ["coef.qdd", "coef.qd", "coef.q", "coef.q_3", "std.q_3", "deviation"]
"""Real outputs of the identifier that are compared, beside the plant's."""


@dataclass(frozen=True)
class Case:
    """One run. `steps` are lengths in s; importers with a fixed step take only such where all are equal."""

    name: str
    steps: list[float]
    start: float = 0.0
    pairs: int = 1
    """How many plants with an identifier each run at once."""
    rerun: bool = False
    """Whether the run is thrown away, the FMUs reset, and run again."""
    plant: dict[str, float] = field(
        default_factory=lambda: {"noise.q": 0.01, "noise.qd": 0.01, "stage[2].time": 1.5, "stage[2].k3": 4.0}
    )
    law: int = 3
    """Number of the identifier's model: Duffing."""
    terms: str = "qdd qd q q^3"
    """The same as a text."""

    @property
    def step(self) -> float | None:
        """The one length of all steps, s."""
        return self.steps[0] if len(set(self.steps)) == 1 else None

    def seed(self, pair: int) -> int:
        """Seed of a plant's noise: every pair has another."""
        return 1 + pair


def cases() -> list[Case]:
    """All of them, some seconds each."""
    fine, coarse = [1e-3] * 2500, [1e-2] * 400
    uneven = [1e-3 * (1 + index * 7 % 5) for index in range(900)]
    return [
        Case("1 ms", fine),
        Case("10 ms", coarse),
        Case("variable", uneven),
        Case("start 100 s", fine, start=100.0),
        Case("two instances", coarse, pairs=2),
        Case("reset, rerun", coarse, rerun=True),
    ]


@dataclass(frozen=True)
class Fmus:
    """The two .fmu files."""

    plant: Path
    identifier: Path


class CannotDo(Exception):
    """The importer has no way to run such a case; it says why."""
