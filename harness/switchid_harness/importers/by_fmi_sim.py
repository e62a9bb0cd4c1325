"""fmi-sim, the program of the Rust crate `fmi`: it steps one FMU, with inputs from a file."""

import csv
import os
import subprocess
from pathlib import Path

from .case import WATCHED, WIRES, CannotDo, Case, Fmus

PROGRAM = "SWITCHID_FMI_SIM"
"""The variable of the environment that names the built program."""


def simulate(fmus: Fmus, case: Case, folder: Path) -> list[float]:
    """The plant first, then the identifier behind what the plant gave."""
    program = os.environ.get(PROGRAM)
    if program is None:
        raise ImportError(f"{PROGRAM} does not name fmi-sim (`cargo xtask importers` builds it)")
    if case.step is None or case.rerun or case.pairs > 1:
        raise CannotDo("fixed steps of one FMU, once")
    clock = ["--output-interval", str(case.step), "-n", "0", "-s", str(case.start)]
    clock += ["-f", str(case.start + case.step * len(case.steps))]
    plant, identifier = folder / "plant.csv", folder / "identifier.csv"
    set_plant = case.plant | {"seed": case.seed(0)}
    _run([program, "--model", fmus.plant, "-o", plant, "co-simulation", *clock], set_plant)
    command = [program, "--model", fmus.identifier, "-i", _wired(plant, folder), "-o", identifier, "co-simulation"]
    _run([*command, *clock], {"model": case.law})
    return _last(plant, WIRES) + _last(identifier, WATCHED)


def _run(command: list, values: dict[str, float]) -> None:
    settings = [word for name, value in values.items() for word in ("--init-values", f"{name}={value}")]
    done = subprocess.run([*map(str, command), *settings], capture_output=True, text=True, timeout=120)
    if done.returncode:
        raise RuntimeError(f"fmi-sim ended with {done.returncode}: {done.stderr[-500:]}")


def _wired(plant: Path, folder: Path) -> Path:
    """The plant's outputs that the identifier takes, as a file of inputs."""
    path = folder / "inputs.csv"
    with open(plant, newline="") as source, open(path, "w", newline="") as target:
        rows = csv.DictReader(source)
        writer = csv.DictWriter(target, ["time", *WIRES], extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    return path


def _last(path: Path, names: list[str]) -> list[float]:
    with open(path, newline="") as file:
        last = list(csv.DictReader(file))[-1]
    return [float(last[name]) for name in names]
