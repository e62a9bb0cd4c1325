"""Gates for a plant of your own: stepped beside the identifier, its figures beside floors, in your CI.

    plant = Plant("Axis.fmu", names={"q": "body.x", "qd": "body.v", "F": "drive.force"})
    report = check(plant, "SwitchedIdentifier.fmu", terms=["qdd", "qd", "q", "q_3"], truth="laws.csv", duration=30.0)
    assert report.passed, report
"""

from .check import Gates, Plant, Report, check
from .truth import Truth, TruthError

__all__ = ["Gates", "Plant", "Report", "Truth", "TruthError", "check"]
