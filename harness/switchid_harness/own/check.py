"""A plant of a user's own beside the identifier, and what came of it."""

import json
import tempfile
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from ..figures import alarm_times, coefficient_error, detections, tracking_delay
from ..gates import Gate
from ..slave import Fmu, Slave
from .truth import Truth

INPUTS = ["q", "qd", "F"]


@dataclass(frozen=True)
class Plant:
    """The plant's .fmu and how it is run."""

    path: str | Path
    names: dict[str, str] = field(default_factory=dict)
    """What the plant calls q, qd and F, where it does not call them so."""
    truth: dict[str, str] = field(default_factory=dict)
    """Outputs that are a term's true coefficient, by term: {"q_3": "true.coef.q_3"}."""
    parameters: dict[str, float | int | str] = field(default_factory=dict)
    """Start values."""


@dataclass(frozen=True)
class Gates:
    """Floors; what is None is not gated."""

    error: float | None = 0.05**2
    """Coefficient error e, sum (theta − truth)² ÷ sum truth², at the end of every stage."""
    delay: float | None = None
    """From a switch until its alarm, s."""
    tracking: float | None = None
    """From a switch until e stays below 0.05², s."""
    false_alarms: int | None = 0
    missed: int | None = 0


@dataclass(frozen=True)
class Report:
    """What came of a run: for each stage its figures, and every gate with its figure."""

    stages: list[dict]
    """`start`, `detected` (s; None in the first stage and where it was missed), `delay`, `tracking_delay`, `e`."""
    false_alarms: list[float]
    gates: list[Gate]

    @property
    def passed(self) -> bool:
        """Whether every gate passed."""
        return all(gate.passed for gate in self.gates)

    def to_json(self) -> str:
        """Stages, false alarms and gates."""
        gates = [asdict(gate) | {"passed": gate.passed} for gate in self.gates]
        return json.dumps({"stages": self.stages, "false_alarms": self.false_alarms, "gates": gates}, indent=2)

    def __str__(self) -> str:
        rows = ["stage    start s   alarm s   delay s  tracked s          e"]
        for number, stage in enumerate(self.stages, start=1):
            cells = [_cell(stage[name]) for name in ("start", "detected", "delay", "tracking_delay")]
            rows.append(f"{number:<6}{''.join(cells)}{stage['e']:>11.1e}")
        failed = [gate for gate in self.gates if not gate.passed]
        said = [
            f"{gate.name}{f' in stage {gate.stage}' if gate.stage else ''}: {_shown(gate.value)}, floor {gate.floor:g}"
            for gate in failed
        ]
        return "\n".join(
            rows + [f"false alarms: {', '.join(f'{t:.3f} s' for t in self.false_alarms) or 'none'}", *said]
        )


def check(
    plant: Plant,
    identifier: str | Path,
    *,
    duration: float,
    terms: list[str],
    truth: str | Path | Truth | None = None,
    gates: Gates | None = None,
    step: float = 1e-3,
    parameters: dict[str, float | int | str] | None = None,
) -> Report:
    """Runs both together and gates what came of it.

    `terms` are those of the law, by the names of their outputs; `truth` is a file or a Truth, else it comes from the
    plant's outputs; `parameters` are the identifier's.
    """
    time, coefficients, count, shown = _run(
        plant, identifier, duration, step, terms, {"sample_time": step} | (parameters or {})
    )
    if truth is None:
        truth = Truth.from_samples(time - step, shown, list(plant.truth))
    elif not isinstance(truth, Truth):
        truth = Truth.from_file(Path(truth))
    return _report(time, coefficients, count, truth, terms, gates or Gates())


def _run(plant: Plant, identifier, duration: float, step: float, terms: list[str], parameters: dict):
    samples = round(duration / step)
    time = np.arange(1, samples + 1) * step
    coefficients, shown = np.empty((samples, len(terms))), np.empty((samples, len(plant.truth)))
    count = np.empty(samples, dtype=int)
    with tempfile.TemporaryDirectory() as folder:
        source = Slave(Fmu(Path(plant.path), Path(folder) / "plant"), "plant", plant.parameters)
        sink = Slave(
            Fmu(Path(identifier), Path(folder) / "identifier"), "identifier", {"terms": " ".join(terms)} | parameters
        )
        out = source.port([plant.names.get(name, name) for name in INPUTS])
        told = source.port(list(plant.truth.values())) if plant.truth else None
        into, law, switches = (
            sink.port(INPUTS),
            sink.port([f"coef.{term}" for term in terms]),
            sink.port(["switch.count"]),
        )
        for index in range(samples):
            into.write(out.read())
            if told:
                shown[index] = told.read()
            for slave in (sink, source):
                slave.step(index * step, step)
            coefficients[index], count[index] = law.read(), switches.read()[0]
        source.close()
        sink.close()
    return time, coefficients, count, shown


def _report(time, coefficients, count, truth: Truth, terms: list[str], gates: Gates) -> Report:
    found = detections(alarm_times(count, time), truth.switches)
    bounds = [*truth.times, float(time[-1])]
    stages = []
    for number, (start, end) in enumerate(zip(bounds, bounds[1:])):
        error = coefficient_error(coefficients, truth.coefficients(number, terms))
        detected = found.times[number - 1] if number else None
        stages.append(
            {
                "start": start,
                "detected": detected,
                "delay": None if detected is None else detected - start,
                "tracking_delay": tracking_delay(error, time, start, end),
                "e": float(error[np.searchsorted(time, end, side="right") - 1]),
            }
        )
    result = [
        Gate("missed switches", None, found.missed, gates.missed),
        Gate("false alarms", None, len(found.false_alarms), gates.false_alarms),
    ]
    for number, stage in enumerate(stages, start=1):
        result.append(Gate("coefficient error e", number, stage["e"], gates.error))
        if number > 1:
            result.append(Gate("detection delay, s", number, stage["delay"], gates.delay))
            result.append(Gate("tracking delay, s", number, stage["tracking_delay"], gates.tracking))
    return Report(stages, found.false_alarms, [gate for gate in result if gate.floor is not None])


def _shown(value: float | None) -> str:
    return "none" if value is None else f"{value:.3g}"


def _cell(value: float | None) -> str:
    return f"{'–' if value is None else f'{value:.3f}':>10}"
