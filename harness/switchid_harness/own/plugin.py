"""pytest fixture `switchid`: the identifier of `--identifier` (or SWITCHID_IDENTIFIER), to check plants with."""

import os

import pytest

from .check import Plant, Report, check


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds `--identifier`."""
    parser.addoption(
        "--identifier",
        help="the identifier's .fmu, for the fixture `switchid`",
        default=os.environ.get("SWITCHID_IDENTIFIER"),
    )


@pytest.fixture
def switchid(request: pytest.FixtureRequest):
    """Checks a plant and fails the test with the report where a gate fails; the arguments are those of `check`."""
    identifier = request.config.getoption("--identifier")
    if not identifier:
        pytest.fail(
            "which identifier? Give --identifier SwitchedIdentifier.fmu, or set SWITCHID_IDENTIFIER", pytrace=False
        )

    def run(plant: Plant, **arguments) -> Report:
        report = check(plant, identifier, **arguments)
        if not report.passed:
            pytest.fail(str(report), pytrace=False)
        return report

    return run
