"""From a recording of a plant with a hidden effect to a better model, and both models as plant FMUs beside the plant.

Everything that estimates is the command line on files: compare, diagnose, add. It gets the noisy recording and a model that
lacks the effect; the hidden effect is looked at by the gates alone.
"""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from .command_line import CommandLine
from .free_run import FreeRun, free_run_error, run_free
from .gates import effect_gates
from .hidden import HiddenEffect
from .slave import Fmu, Slave

MODELS = {"refitted": "without the effect", "improved": "with what was added"}
FIRST, FRESH = "first.csv", "fresh.csv"


@dataclass
class Findings:
    """The command line's documents."""

    before: dict
    """`compare` of the model that lacks the effect, on the first record: its best coefficients."""
    diagnosis: dict
    """`diagnose` on the first record."""
    added: dict | None
    """`add` on the first record; None where the diagnosis names no effect."""
    compared: dict[str, dict]
    """`compare` on the fresh record by model."""


@dataclass
class Improvement:
    """A scenario, the models' run beside the plant on the fresh record, and its figures as they stand in report.json."""

    scenario: HiddenEffect
    run: FreeRun
    figures: dict


def perform(scenario: HiddenEffect, fmus: dict[str, Fmu], program: Path, directory: Path) -> Improvement:
    """Makes both records, has the command line find the effect, and steps the models' plant FMUs beside the plant.

    All files are left in `directory`.
    """
    directory.mkdir(parents=True, exist_ok=True)
    switchid = CommandLine(program, directory)
    write_record(directory / FIRST, _beside(scenario, fmus, {}, fresh=False))
    before, diagnosis, added = find(scenario, switchid)
    run = _beside(scenario, fmus, _plants(scenario, switchid), fresh=True)
    write_record(directory / FRESH, run)
    compared = {name: switchid.json("compare", FRESH, "--model", f"{name}.toml") for name in MODELS}
    return evaluate(scenario, Findings(before, diagnosis, added, compared), run)


def find(scenario: HiddenEffect, switchid: CommandLine) -> tuple[dict, dict, dict | None]:
    """Documents of compare, diagnose and add; writes `model.toml`, `refitted.toml` and `improved.toml`.

    Where no effect is named the improved model is the refitted one.
    """
    directory = switchid.directory
    model = ["--model", "model.toml"]
    (directory / "model.toml").write_text(model_text("model", dict.fromkeys(scenario.law.terms.split(), "fit")))
    before = switchid.json("compare", FIRST, *model)
    refitted = model_text("refitted", before["best"]["coefficients"])
    (directory / "refitted.toml").write_text(refitted)
    diagnosis = switchid.json("diagnose", FIRST, *model)
    if diagnosis["effect"] is None:
        (directory / "improved.toml").write_text(refitted)
        return before, diagnosis, None
    output = ["--data", FIRST, "-o", "improved.toml", "--force"]
    return before, diagnosis, switchid.json("add", diagnosis["effect"], *model, *output)


def _plants(scenario: HiddenEffect, switchid: CommandLine) -> dict[str, Slave]:
    """Both models as plant FMUs, driven like the plant in the fresh record, without sensor noise."""
    plants = {}
    for name in MODELS:
        switchid.json("fmu", "--plant", "--model", f"{name}.toml", "-o", f"{name}.fmu", "--force")
        fmu = Fmu(switchid.directory / f"{name}.fmu", switchid.directory / name)
        plants[name] = Slave(fmu, name, scenario.excitation(fresh=True))
    return plants


def _beside(scenario: HiddenEffect, fmus: dict[str, Fmu], models: dict[str, Slave], fresh: bool) -> FreeRun:
    plant = Slave(fmus[scenario.law.fmu], "plant", scenario.plant_parameters(fresh))
    run = run_free(plant, models, scenario.duration)
    for slave in (plant, *models.values()):
        slave.close()
    return run


def model_text(name: str, terms: dict[str, float | str]) -> str:
    """A model file: terms by name with their number or `fit`."""
    lines = [f'"{term}" = {json.dumps(given)}' for term, given in terms.items()]
    return "\n".join([f'name = "{name}"', 'hold = "zero"', "", "[terms]", *lines, ""])


def write_record(path: Path, run: FreeRun) -> None:
    """The measured signals as a CSV file, to the last bit."""
    rows = np.column_stack([run.time, run.measured])
    np.savetxt(path, rows, delimiter=",", header="t,q,qd,F", comments="", fmt="%.17g")


def evaluate(scenario: HiddenEffect, findings: Findings, run: FreeRun) -> Improvement:
    """Figures and gates of what the command line found."""
    models = {name: model_figures(name, findings, run) for name in MODELS}
    diagnosis, after = findings.diagnosis, models["improved"]
    named = diagnosis["verdict"] == "missing" and diagnosis["effect"] == scenario.effect
    checked = effect_gates(
        named,
        ratio(after["force_residual"], after["noise_floor"]),
        ratio(after["free_run_error"], models["refitted"]["free_run_error"]),
    )
    figures = {
        "id": scenario.id,
        "title": scenario.title,
        "set": scenario.group,
        "law": scenario.law.name,
        "hidden": scenario.effect,
        "truth": scenario.truth(),
        "noise": scenario.noise,
        "seed": scenario.seed,
        "end": scenario.duration,
        "diagnosis": {key: diagnosis[key] for key in ("verdict", "effect", "indistinguishable", "answer")},
        "fails": [fail["sentence"] for fail in findings.before["fails"]],
        "window": findings.compared["improved"]["error"]["window"],
        "models": models,
        "gates": [asdict(gate) | {"passed": gate.passed} for gate in checked],
        "passed": all(gate.passed for gate in checked),
    }
    return Improvement(scenario, run, figures)


def model_figures(name: str, findings: Findings, run: FreeRun) -> dict:
    """Coefficients of a model and its errors on the fresh record."""
    fitted = findings.added if name == "improved" and findings.added else findings.before["best"]
    error = findings.compared[name]["error"]
    return {
        "coefficients": fitted["coefficients"],
        "std": fitted["std"],
        "force_residual": error["force_residual"],
        "noise_floor": error["noise_floor"],
        "free_run_error": free_run_error(run, name),
    }


def ratio(value: float | None, reference: float | None) -> float | None:
    """The quotient, None where there is none."""
    return value / reference if value is not None and reference else None
