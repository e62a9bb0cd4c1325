"""Every kind of gate fails on a bad figure, also the whole run through the fake FMUs."""

from dataclasses import replace

import pytest
from fake import TERMS, FakePlant, Puppet

from switchid_harness import scenarios
from switchid_harness.gates import Gate, gates
from switchid_harness.run import evaluate
from switchid_harness.scenarios import Scenario, Stage
from switchid_harness.stepping import step_together
from switchid_harness.table import block, failures

QUIET = scenarios.documented()[0]


def _short(scenario: Scenario) -> Scenario:
    """Three stages of 3, 4 and 5 s."""
    stages = tuple(replace(stage, start=start) for stage, start in zip(scenario.stages, (0.0, 3.0, 7.0)))
    return replace(scenario, stages=stages, end=12.0)


def _run(puppet: dict) -> dict:
    scenario = _short(QUIET)
    default = {"detection": 0.2, "settling": 0.1, "residue": 1e-7}
    identifiers = {
        "default": Puppet(scenario, **(default | puppet)),
        "publication": Puppet(scenario, detection=None, settling=1.0, residue=1e-2),
    }
    return evaluate(scenario, step_together(FakePlant(scenario), identifiers, TERMS, scenario.end), TERMS).figures


def _failed(figures: dict) -> set[str]:
    return {gate["name"] for gate in figures["gates"] if not gate["passed"]}


def test_a_figure_at_its_floor_passes_and_one_above_or_missing_fails():
    assert Gate("e", 1, 1e-6, 1e-6).passed
    assert not Gate("e", 1, 1.0001e-6, 1e-6).passed
    assert not Gate("e", 1, None, 1e-6).passed
    assert not Gate("e", 1, float("nan"), 1e-6).passed


def test_a_good_run_passes_while_the_published_method_is_only_shown():
    figures = _run({})
    assert figures["passed"] and _failed(figures) == set()
    assert figures["methods"]["publication"]["missed_switches"] == 2
    assert [s["detection_delay"] for s in figures["methods"]["default"]["stages"]] == [
        None,
        *[pytest.approx(0.2, abs=2e-3)] * 2,
    ]


@pytest.mark.parametrize(
    ("puppet", "gate"),
    [
        ({"detection": None}, "missed switches"),
        ({"false_alarms": (1.5,)}, "false alarms"),
        ({"false_alarms": (5.5,)}, "false alarms"),
        ({"residue": 2e-3}, "e"),
        ({"settling": 0.6}, "tracking delay"),
    ],
)
def test_a_bad_run_fails_at_its_gate(puppet, gate):
    figures = _run(puppet)
    assert gate in _failed(figures)
    assert not figures["passed"]
    assert any(gate in line for line in failures([figures]))
    assert "FAIL" in block(figures)


def test_the_first_stage_is_gated_on_e_but_has_no_tracking_delay():
    stages = [{"e": 1.0, "tracking_delay": None}, {"e": 1e-9, "tracking_delay": 9.0}]
    failed = [(gate.name, gate.stage) for gate in gates(QUIET, stages, 0, 0) if not gate.passed]
    assert failed == [("e", 1), ("tracking delay", 2)]


def test_with_noise_only_the_alarms_are_gated_and_the_publications_cases_on_e():
    noisy = scenarios.documented()[1]
    assert {gate.name for gate in gates(noisy, [{"e": 1.0, "tracking_delay": None}] * 5, 0, 0)} == {
        "missed switches",
        "false alarms",
    }
    for case, floor in zip(scenarios.publication_cases(), (2.58e-4, 1e-2)):
        assert gates(case, [{"e": floor * 1.01, "tracking_delay": None}], 0, 0)[-1].passed is False


def test_a_term_that_the_identifier_lacks_is_an_error():
    scenario = _short(QUIET)
    stage = Stage(0.0, scenario.stages[0].parameters)
    record = step_together(FakePlant(scenario), {"default": Puppet(scenario, 0.2, 0.1, 0.0)}, TERMS, 0.01)
    with pytest.raises(ValueError, match="q_3"):
        evaluate(replace(scenario, stages=(stage,), end=0.01), record, [term for term in TERMS if term != "q_3"])
