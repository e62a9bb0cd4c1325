"""Gates for users' own plants."""

import json
from pathlib import Path

import numpy as np
import pytest

from switchid_harness.own import Gates, Plant, Truth, TruthError, check
from switchid_harness.own.__main__ import main

TERMS = ["qdd", "qd", "q", "q_3"]
NAMES = {"q": "true.q", "qd": "true.qd"}
SWITCH = {"stage[2].time": 6.0, "stage[2].k1": 7.0}


def plant(directory: Path, **more) -> Plant:
    return Plant(directory / "Duffing.fmu", names=NAMES, parameters=SWITCH, **more)


def test_truth_from_outputs_and_from_a_file_are_the_same(fmu_directory: Path, tmp_path: Path):
    truth = tmp_path / "truth.csv"
    truth.write_text("t,qdd,qd,q,q_3\n0,1.0,0.3,4.0,2.0\n6.0,1.0,0.3,7.0,2.0\n")
    told = plant(fmu_directory, truth={term: f"true.coef.{term}" for term in TERMS})
    identifier = fmu_directory / "SwitchedIdentifier.fmu"
    reports = [
        check(told, identifier, terms=TERMS, duration=12.0, gates=Gates(delay=0.3)),
        check(plant(fmu_directory), identifier, terms=TERMS, duration=12.0, truth=truth, gates=Gates(delay=0.3)),
    ]
    for report in reports:
        assert report.passed, report
        assert [stage["start"] for stage in report.stages] == pytest.approx([0.0, 6.0])
        assert report.stages[1]["e"] < 1e-6 and report.stages[1]["delay"] < 0.3
    assert json.loads(reports[0].to_json())["gates"][0]["passed"]


def test_a_wrong_truth_fails_the_gates_and_the_command_says_so(fmu_directory: Path, tmp_path: Path, capsys):
    truth = tmp_path / "truth.csv"
    truth.write_text("t,qdd,qd,q,q_3\n0,1.0,0.3,5.0,2.0\n")
    files = [str(fmu_directory / name) for name in ("Duffing.fmu", "SwitchedIdentifier.fmu")]
    arguments = files + ["--terms", ",".join(TERMS), "--truth", str(truth), "--duration", "8", "--map", "q=true.q"]
    assert main(arguments) == 1
    assert "coefficient error e in stage 1" in capsys.readouterr().out
    assert main(files + ["--terms", "qdd", "--truth", str(tmp_path / "none.csv")]) == 2
    assert "none.csv" in capsys.readouterr().err


def test_truth_files_that_are_none_are_named(tmp_path: Path):
    path = tmp_path / "truth.csv"
    for text, said in [
        ("q\n1\n", "no column t"),
        ("t,q\n", "no law"),
        ("t,q\n0,x\n", "line 2"),
        ("t,q\n1,1\n0,1\n", "increase"),
    ]:
        path.write_text(text)
        with pytest.raises(TruthError, match=said):
            Truth.from_file(path)


def test_a_law_lasts_as_long_as_the_outputs_stay():
    values = np.array([[1.0, 2.0], [1.0, 2.0], [1.0, 3.0], [1.0, 3.0]])
    truth = Truth.from_samples(np.arange(4.0), values, ["qdd", "q"])
    assert truth.times == [0.0, 2.0] and truth.laws[1] == {"qdd": 1.0, "q": 3.0}
    assert truth.coefficients(1, ["q", "qd", "qdd"]).tolist() == [3.0, 0.0, 1.0]
    with pytest.raises(TruthError, match="qdd"):
        truth.coefficients(0, ["q"])
