"""One scenario: set up the FMUs, step them, and take the figures."""

from dataclasses import asdict, dataclass

import numpy as np

from .figures import alarm_times, coefficient_error, detections, tracking_delay
from .gates import gates
from .scenarios import Scenario
from .slave import Fmu, Slave
from .stepping import Record, Track, step_together

METHODS = {"default": "ours", "publication": "published"}
UNKNOWN_STD = 1e29
"""The FMU says std = 1e30 while a coefficient is unknown."""


@dataclass
class Run:
    """A scenario, what was recorded, and its figures as they stand in report.json."""

    scenario: Scenario
    record: Record
    errors: dict[str, np.ndarray]
    """e over time by method."""
    figures: dict


def plant_parameters(scenario: Scenario) -> dict[str, float | int | str]:
    """The plant FMU's parameters."""
    parameters: dict[str, float | int | str] = {
        "excitation.kind": scenario.excitation,
        "excitation.intensity": scenario.intensity,
        "noise.q": scenario.noise,
        "noise.qd": scenario.noise,
        "seed": scenario.seed,
    }
    for number, stage in enumerate(scenario.stages, start=1):
        parameters[f"stage[{number}].time"] = stage.start
        parameters |= {f"stage[{number}].{name}": value for name, value in stage.parameters.items()}
    return parameters


def truth(scenario: Scenario, terms: list[str]) -> np.ndarray:
    """The coefficients of every stage, (stages, k)."""
    laws = [scenario.law.coefficients(stage.parameters) for stage in scenario.stages]
    missing = {name for law in laws for name in law} - set(terms)
    if missing:
        raise ValueError(f"{scenario.id}: the identifier has no coefficient for {sorted(missing)}")
    return np.array([[law.get(term, 0.0) for term in terms] for law in laws])


def identifier_parameters(method: str, scenario: Scenario) -> dict[str, float | int | str]:
    """Ours needs nothing but the terms; the published method gets the record length that the publication used in its noise cases.

    Its law comes some steps after the capture's end, which therefore lies a little before the record's.
    """
    parameters: dict[str, float | int | str] = {"method": method, "terms": scenario.law.terms}
    if method == "publication" and len(scenario.stages) == 1:
        parameters["initial_window"] = 0.97 * scenario.end
    return parameters


def perform(scenario: Scenario, fmus: dict[str, Fmu]) -> Run:
    """Steps the scenario's plant, our identifier and the published method together."""
    plant = Slave(fmus[scenario.law.fmu], "plant", plant_parameters(scenario))
    identifier = fmus["SwitchedIdentifier.fmu"]
    identifiers = {method: Slave(identifier, method, identifier_parameters(method, scenario)) for method in METHODS}
    terms = identifier.names("coef.")
    record = step_together(plant, identifiers, terms, scenario.end)
    for slave in (plant, *identifiers.values()):
        slave.close()
    return evaluate(scenario, record, terms)


def evaluate(scenario: Scenario, record: Record, terms: list[str]) -> Run:
    """The figures of a recorded scenario."""
    laws = truth(scenario, terms)
    errors = {method: error_over_time(scenario, track, record.time, laws) for method, track in record.tracks.items()}
    methods = {
        method: method_figures(scenario, track, record.time, errors[method]) for method, track in record.tracks.items()
    }
    ours = methods["default"]
    checked = gates(scenario, ours["stages"], ours["missed_switches"], len(ours["false_alarms"]))
    figures = {
        "id": scenario.id,
        "title": scenario.title,
        "set": scenario.group,
        "law": scenario.law.name,
        "excitation": scenario.excitation,
        "intensity": scenario.intensity,
        "noise": scenario.noise,
        "seed": scenario.seed,
        "end": scenario.end,
        "terms": terms,
        "stages": [stage_truth(scenario, terms, laws, i) for i in range(len(laws))],
        "methods": methods,
        "gates": [asdict(gate) | {"passed": gate.passed} for gate in checked],
        "passed": all(gate.passed for gate in checked),
    }
    return Run(scenario, record, errors, figures)


def stage_truth(scenario: Scenario, terms: list[str], laws: np.ndarray, index: int) -> dict:
    """Bounds, parameters and true coefficients of a stage."""
    start, end = scenario.bounds()[index]
    coefficients = {term: float(value) for term, value in zip(terms, laws[index]) if value != 0.0}
    return {"start": start, "end": end, "parameters": scenario.stages[index].parameters, "coefficients": coefficients}


def error_over_time(scenario: Scenario, track: Track, time: np.ndarray, laws: np.ndarray) -> np.ndarray:
    """e of the published coefficients against the law in force, (n,)."""
    starts = np.array([start for start, _ in scenario.bounds()])
    stage = np.clip(np.searchsorted(starts, time, side="left") - 1, 0, len(starts) - 1)
    error = np.empty(len(time))
    for index, law in enumerate(laws):
        error[stage == index] = coefficient_error(track.coefficients[stage == index], law)
    return error


def method_figures(scenario: Scenario, track: Track, time: np.ndarray, error: np.ndarray) -> dict:
    """Figures of one method: per stage and over the whole run."""
    switches = [start for start, _ in scenario.bounds()[1:]]
    found = detections(alarm_times(track.outputs["switch.count"], time), switches)
    detected = [None, *found.times]
    stages = [stage_figures(track, time, error, *bounds) for bounds in scenario.bounds()]
    for stage, (start, _), alarm in zip(stages, scenario.bounds(), detected):
        stage["detected"] = alarm
        stage["detection_delay"] = None if alarm is None else alarm - start
        stage["identified"] = identified(track, time, alarm if start > 0.0 else 0.0, stage["end"])
    return {"stages": stages, "missed_switches": found.missed, "false_alarms": found.false_alarms}


def stage_figures(track: Track, time: np.ndarray, error: np.ndarray, start: float, end: float) -> dict:
    """Last coefficients, e, and delays of one stage; times in s."""
    inside = np.flatnonzero((time > start) & (time <= end))
    last = inside[-1]
    known = {term: i for i, term in enumerate(track.terms) if track.std[last, i] < UNKNOWN_STD}
    return {
        "start": start,
        "end": end,
        "e": number(error[last]),
        "tracking_delay": tracking_delay(error, time, start, end),
        "coefficients": {term: float(track.coefficients[last, i]) for i, term in enumerate(track.terms)},
        "std": {term: float(track.std[last, i]) for term, i in known.items()},
        "start_estimate": number(track.outputs["switch.time"][last]),
        "valid": bool(track.outputs["valid"][last] > 0),
    }


def identified(track: Track, time: np.ndarray, since: float | None, end: float) -> float | None:
    """First time from `since` to `end` at which the identifier has validated its law."""
    if since is None:
        return None
    validated = time[(time >= since) & (time <= end) & (track.outputs["valid"] > 0)]
    return float(validated[0]) if validated.size else None


def number(value: float) -> float | None:
    """The value, or None where it is no finite number."""
    return float(value) if np.isfinite(value) else None
