"""From a record to a better model, on documents and motions that are made up: every gate fails on its own."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake import FakePort

from switchid_harness import hidden
from switchid_harness.free_run import FreeRun, error_over_time, free_run_error, run_free
from switchid_harness.improvement import Findings, Improvement, evaluate, find, model_text
from switchid_harness.report.effects import effect_card, effect_row
from switchid_harness.report.effect_views import effect_views
from switchid_harness.stepping import STEP
from switchid_harness.table import effect_block, failures

SCENARIO = hidden.documented()[0]
EFFECT = SCENARIO.effect


def _comparison(force_residual: float, noise_floor: float = 0.004) -> dict:
    coefficients = {"qdd": 0.99, "qd": 0.44, "q": 3.9, "q^3": 2.05}
    return {
        "error": {"force_residual": force_residual, "noise_floor": noise_floor, "window": 0.6},
        "best": {"coefficients": coefficients, "std": dict.fromkeys(coefficients, 1e-3)},
        "fails": [{"sentence": "70 % of the error lies around <velocity> reversals"}],
    }


def _diagnosis(verdict: str = "missing", effect: str | None = EFFECT) -> dict:
    return {"verdict": verdict, "effect": effect, "indistinguishable": [], "answer": ["missing", "sure", "decides"]}


def _added(effect: str) -> dict:
    return {"coefficients": {"qdd": 1.0, "q^3": 2.0, effect: 0.2}, "std": {"qdd": 1e-4, effect: 1e-4}}


def _free_run(before: float = 0.1, after: float = 0.001) -> FreeRun:
    time = np.arange(4000) * STEP
    truth = np.column_stack([np.sin(3.0 * time), 3.0 * np.cos(3.0 * time)])
    measured = np.column_stack([truth + 0.01, np.cos(time)])
    off = {"refitted": before, "improved": after}
    predicted = {name: np.column_stack([truth, time]) + value * time[:, None] for name, value in off.items()}
    return FreeRun(time, measured, truth, predicted)


def _improvement(
    diagnosis: dict | None = None, after: float = 0.0042, free_run: FreeRun | None = None
) -> Improvement:
    diagnosis = diagnosis or _diagnosis()
    added = _added(diagnosis["effect"]) if diagnosis["effect"] else None
    compared = {"refitted": _comparison(0.07), "improved": _comparison(after)}
    return evaluate(SCENARIO, Findings(_comparison(0.07), diagnosis, added, compared), free_run or _free_run())


def _failed(figures: dict) -> set[str]:
    return {gate["name"] for gate in figures["gates"] if not gate["passed"]}


def test_the_right_effect_with_errors_that_fall_passes():
    figures = _improvement().figures
    assert figures["passed"] and _failed(figures) == set() and len(figures["gates"]) == 3
    assert failures([figures]) == [] and "gate ok" in effect_block(figures)


@pytest.mark.parametrize(
    ("changes", "gate"),
    [
        ({"diagnosis": _diagnosis(effect="quadratic_damping")}, "wrong diagnosis"),
        ({"diagnosis": _diagnosis(verdict="unexplained")}, "wrong diagnosis"),
        ({"diagnosis": _diagnosis("adequate", None)}, "wrong diagnosis"),
        ({"after": 0.00481}, "force residual ÷ noise floor"),
        ({"free_run": _free_run(after=0.02)}, "free-run error, after ÷ before"),
    ],
)
def test_a_bad_outcome_fails_at_its_gate_alone(changes, gate):
    figures = _improvement(**changes).figures
    assert _failed(figures) == {gate} and not figures["passed"]
    assert any(gate in line for line in failures([figures])) and "FAIL" in effect_block(figures)
    assert "fails" in effect_row(figures)


def test_without_a_noise_floor_there_is_no_ratio_and_the_gate_fails():
    compared = {"refitted": _comparison(0.07), "improved": _comparison(0.004, noise_floor=0.0)}
    findings = Findings(_comparison(0.07), _diagnosis(), _added(EFFECT), compared)
    assert _failed(evaluate(SCENARIO, findings, _free_run()).figures) == {"force residual ÷ noise floor"}


class _ScriptedCommands:
    """Answers with made-up documents and keeps what it was asked."""

    def __init__(self, directory: Path, effect: str | None):
        self.directory, self.effect, self.asked = directory, effect, []

    def json(self, *arguments: str) -> dict:
        self.asked.append(arguments)
        documents = {"compare": _comparison(0.07), "diagnose": _diagnosis(effect=self.effect), "add": _added(EFFECT)}
        return documents[arguments[0]]


def test_what_is_named_is_added_and_the_model_knows_nothing_of_the_effect(tmp_path):
    commands = _ScriptedCommands(tmp_path, "quadratic_damping")
    find(SCENARIO, commands)
    assert [command[0] for command in commands.asked] == ["compare", "diagnose", "add"]
    assert commands.asked[2][1] == "quadratic_damping"
    assert not any(EFFECT in word for command in commands.asked for word in command)
    text = (tmp_path / "model.toml").read_text()
    assert text.count('= "fit"') == 4 and not re.search(r"\d\.\d|friction", text)
    assert '"q^3" = 2.05' in (tmp_path / "refitted.toml").read_text()


def test_where_nothing_is_named_nothing_is_added(tmp_path):
    commands = _ScriptedCommands(tmp_path, None)
    assert find(SCENARIO, commands)[2] is None
    assert [command[0] for command in commands.asked] == ["compare", "diagnose"]
    assert (tmp_path / "improved.toml").read_text() == (tmp_path / "refitted.toml").read_text()


def test_a_model_file_keeps_every_digit():
    assert '"qdd" = 0.1\n"q" = "fit"\n"qd" = -1.2345678901234568e-05' in model_text(
        "m", {"qdd": 0.1, "q": "fit", "qd": -1.2345678901234568e-05}
    )


class _Clock:
    """A slave whose outputs are multiples of its own time."""

    def __init__(self, factor: float):
        self.factor, self.state = factor, {}
        self._show(0.0)

    def _show(self, time: float) -> None:
        names = ["q", "qd", "F", "true.q", "true.qd"]
        self.state.update({name: self.factor * (index + 1) * time for index, name in enumerate(names)})

    def port(self, names: list[str]) -> FakePort:
        return FakePort(self.state, names)

    def step(self, time: float, step: float) -> None:
        self._show(time + step)


def test_plant_and_models_are_read_at_the_same_instants():
    run = run_free(_Clock(1.0), {"one": _Clock(2.0), "two": _Clock(-1.0)}, 0.05)
    assert run.time == pytest.approx(np.arange(50) * STEP)
    assert run.measured == pytest.approx(np.outer(run.time, [1.0, 2.0, 3.0]))
    assert run.truth == pytest.approx(np.outer(run.time, [4.0, 5.0]))
    assert run.predicted["one"] == pytest.approx(2.0 * run.measured)
    assert run.predicted["two"] == pytest.approx(-run.measured)


def test_free_run_errors_are_shares_of_the_true_motion():
    time = np.arange(3000) * STEP
    truth = np.column_stack([np.where(time < 1.5, 3.0, -1.0), time])
    predicted = np.column_stack([truth[:, 0] + np.where(time < 2.0, 0.0, 0.5), time, time])
    run = FreeRun(time, predicted, truth, {"model": predicted})
    assert free_run_error(run, "model") == pytest.approx(0.5 * np.sqrt(1.0 / 3.0) / 2.0)
    error = error_over_time(run, "model")
    assert error[1999] == 0.0 and error[2249] == pytest.approx(0.125) and error[2999] == pytest.approx(0.25)


def test_card_and_traces_are_complete_and_have_no_nan():
    found = _improvement()
    card = effect_card(found.figures)
    assert "&lt;velocity&gt;" in card and "<velocity>" not in card
    plain = re.sub(r"<[^>]+>", "", card).replace("\u2009", " ")
    assert "1.0000 q̈ + 2.000 q3 + 0.20000 Coulomb friction = F" in plain
    drawn = effect_views(found)
    assert {"q", "refitted.q", "improved.qd", "improved.error"} <= set(drawn["names"])
    force = drawn["views"]["falls"][0]["layers"]
    assert force[0]["bars"][1][0] == "+ Coulomb friction" and force[1]["mark"]["label"] == "noise floor 0.4 %"
    json.dumps(found.figures, allow_nan=False)


def test_the_fresh_record_has_another_seed_and_the_same_plant():
    first, fresh = (SCENARIO.plant_parameters(fresh) for fresh in (False, True))
    assert first.pop("seed") != fresh.pop("seed") and first == fresh
    assert first[f"hidden.{EFFECT}"] == SCENARIO.coefficient
    model = SCENARIO.excitation(fresh=True)
    assert not any(name.startswith(("hidden", "noise", "stage")) for name in model)


def test_draws_differ_from_seed_to_seed_and_repeat():
    assert hidden.drawn(5) == hidden.drawn(5)
    drawn = [hidden.drawn(seed)[0] for seed in range(30)]
    assert len({scenario.effect for scenario in drawn}) > 3 and len({scenario.coefficient for scenario in drawn}) > 25
    assert len({replace(scenario, group="").id for scenario in [*drawn, SCENARIO]}) == 2
