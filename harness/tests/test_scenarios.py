"""The scenarios are what the project promises."""

import pytest

from switchid_harness import scenarios
from switchid_harness.laws import DUFFING, VAN_DER_POL, factors, in_order, symbol


def _sets():
    return [scenarios.documented(), scenarios.drawn(7)]


@pytest.mark.parametrize("chosen", _sets(), ids=["documented", "drawn"])
def test_four_scenarios_with_and_without_noise_of_five_stages(chosen):
    assert len(chosen) == 8
    assert {(s.law.name, s.excitation, s.noise) for s in chosen} == {
        (law, kind, noise) for law in ("Duffing", "van der Pol") for kind in ("sine", "white") for noise in (0.0, 0.01)
    }
    assert all(len(s.stages) >= 5 and s.stages[0].start == 0.0 for s in chosen)
    assert {s.intensity for s in chosen if s.law is DUFFING and s.excitation == "white"} == {3.0}


@pytest.mark.parametrize("chosen", _sets(), ids=["documented", "drawn"])
def test_every_parameter_switches_and_no_switch_changes_nothing(chosen):
    for scenario in chosen:
        names = scenario.law.parameters + (("P", "omega") if scenario.excitation == "sine" else ())
        for name in names:
            assert len({stage.parameters[name] for stage in scenario.stages}) > 1, (scenario.id, name)
        for before, after in zip(scenario.stages, scenario.stages[1:]):
            assert scenario.law.coefficients(before.parameters) != scenario.law.coefficients(after.parameters)


def test_damping_changes_sign_at_every_van_der_pol_switch():
    for scenario in scenarios.documented() + scenarios.drawn(3):
        if scenario.law is VAN_DER_POL:
            signs = [stage.parameters["a"] > 0 for stage in scenario.stages]
            assert all(a != b for a, b in zip(signs, signs[1:]))


def test_a_seed_gives_the_same_set_and_another_seed_another():
    assert scenarios.drawn(5) == scenarios.drawn(5)
    assert scenarios.drawn(5)[0].stages != scenarios.drawn(6)[0].stages


def test_coefficients_follow_from_parameters():
    assert VAN_DER_POL.coefficients({"L": 1.2, "alpha": 0.9, "a": -0.5, "C": 0.8}) == pytest.approx(
        {"qdd": 1.2, "qd": 0.45, "q_2_qd": 0.9, "q": 1.25}
    )
    assert DUFFING.coefficients({"m": 1.4, "c": 0.4, "k1": 3.0, "k3": 1.5}) == {
        "qdd": 1.4,
        "qd": 0.4,
        "q": 3.0,
        "q_3": 1.5,
    }


def test_terms_are_read_and_ordered_as_laws_are_written():
    assert factors("q_2_qd") == [("q", 2), ("qd", 1)] and factors("const") == []
    assert symbol("q_qd_2") == "q q̇²" and symbol("const") == "1"
    assert in_order(["const", "q_3", "q", "q_2_qd", "qd", "qdd"]) == ["qdd", "qd", "q_2_qd", "q", "q_3", "const"]
