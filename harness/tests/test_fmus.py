"""The FMUs as a user's tool sees them."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import FILES, ROOT
from fmpy.validation import validate_fmu

from switchid_harness import scenarios
from switchid_harness.run import plant_parameters
from switchid_harness.slave import Slave, UnknownVariable
from switchid_harness.stepping import step_together

IDENTIFIER = "SwitchedIdentifier.fmu"
DUFFING = next(s for s in scenarios.documented() if s.id == "duffing-sine-noise")


@pytest.mark.parametrize("name", FILES)
def test_fmpy_validate_finds_no_problem(fmu_directory, name):
    assert validate_fmu(str(fmu_directory / name)) == []


def _terms(fmus) -> list[str]:
    return fmus[IDENTIFIER].names("coef.")


def _together(fmus, identifiers: dict[str, Slave], seconds: float = 3.0):
    plant = Slave(fmus["Duffing.fmu"], "plant", plant_parameters(DUFFING))
    record = step_together(plant, identifiers, _terms(fmus), seconds)
    plant.close()
    return record


def test_several_instances_in_one_process_do_not_disturb_each_other(fmus):
    settings = {"terms": "qdd qd q q^3"}
    alone = {"first": Slave(fmus[IDENTIFIER], "first", settings)}
    reference = _together(fmus, alone).tracks["first"]
    crowd = {name: Slave(fmus[IDENTIFIER], name, settings) for name in ("first", "second")}
    crowd["other"] = Slave(fmus[IDENTIFIER], "other", {"method": "publication"})
    record = _together(fmus, crowd)
    for name in ("first", "second"):
        assert record.tracks[name].coefficients.tobytes() == reference.coefficients.tobytes()
    for slave in [*alone.values(), *crowd.values()]:
        slave.close()


def _step(slave: Slave, samples: np.ndarray, first: int) -> np.ndarray:
    inputs = slave.port(["q", "qd", "F"])
    outputs = slave.port(
        [name for name, v in slave.fmu.variables.items() if v.causality == "output" and v.type == "Real"]
    )
    rows = []
    for index, sample in enumerate(samples, start=first):
        inputs.write(sample)
        slave.step(index / 1000, 1e-3)
        rows.append(outputs.read().copy())
    return np.array(rows)


def test_saved_restored_and_serialised_states_go_on_the_same(fmus):
    samples = _together(fmus, {}, 4.0).observed
    one, two = (Slave(fmus[IDENTIFIER], name, {}) for name in ("one", "two"))
    _step(one, samples[:2500], 0)
    state = one.slave.getFMUState()
    data = one.slave.serializeFMUState(state)
    reference = _step(one, samples[2500:], 2500)
    one.slave.setFMUState(state)
    assert _step(one, samples[2500:], 2500).tobytes() == reference.tobytes()
    two.slave.setFMUState(two.slave.deserializeFMUState(data))
    assert _step(two, samples[2500:], 2500).tobytes() == reference.tobytes()
    one.slave.freeFMUState(state)
    one.close()
    two.close()


def test_the_plant_is_driven_as_the_scenario_says(fmus):
    record = _together(fmus, {}, 20.0)
    first, second = DUFFING.stages[0].parameters, DUFFING.stages[1].parameters
    before = record.sampled < DUFFING.stages[1].start
    drive = np.where(before, first["P"], second["P"]) * np.sin(first["omega"] * record.sampled)
    assert first["omega"] == second["omega"]
    assert record.observed[:, 2] == pytest.approx(drive, abs=1e-9)


def test_the_example_of_the_docs_runs(fmu_directory, tmp_path):
    script = ROOT / "harness/examples/identify_plant.py"
    done = subprocess.run([sys.executable, script, fmu_directory, "3"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert [line.split()[0] for line in done.stdout.splitlines()] == ["qdd", "qd", "q", "q_3"]


def test_an_unknown_variable_is_named(fmus):
    with pytest.raises(UnknownVariable, match="coef.q_77"):
        Slave(fmus[IDENTIFIER], "wrong", {}).port(["coef.q_77"])


def test_quick_crosscheck_writes_report_and_exits_by_its_gates(fmu_directory, command, tmp_path):
    harness = [sys.executable, "-m", "switchid_harness", "--quick", "--command", command]
    harness += ["--fmus", fmu_directory, "--out", tmp_path]
    done = subprocess.run(harness, cwd=Path(ROOT / "harness"), capture_output=True, text=True)
    assert (tmp_path / "report.html").stat().st_size > 100_000
    assert done.returncode == ("gates fail" in done.stdout)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
