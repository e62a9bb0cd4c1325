"""A gate for a plant of your own: pytest test_own_plant.py --identifier SwitchedIdentifier.fmu"""

from switchid_harness.own import Gates, Plant

TERMS = ["qdd", "qd", "q", "q_3"]


def test_the_plant_is_identified_and_its_switch_is_seen(switchid):
    switches = {"noise.q": 0.01, "noise.qd": 0.01, "stage[2].time": 15.0, "stage[2].k1": 6.0}
    plant = Plant("target/fmu/Duffing.fmu", truth={term: f"true.coef.{term}" for term in TERMS}, parameters=switches)
    switchid(plant, terms=TERMS, duration=25.0, gates=Gates(error=1e-4, delay=0.5, tracking=5.0))
