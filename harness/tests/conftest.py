"""Under test: the FMUs of `target/fmu`, or of the directory that SWITCHID_FMUS names, and the command line."""

import os
from pathlib import Path

import pytest

from switchid_harness.slave import Fmu

ROOT = Path(__file__).resolve().parents[2]
DIRECTORY = Path(os.environ.get("SWITCHID_FMUS", ROOT / "target/fmu"))
COMMAND = ROOT / "target/release/switchid-harness"
FILES = ["SwitchedIdentifier.fmu", "Duffing.fmu", "VanDerPol.fmu"]


@pytest.fixture(scope="session")
def fmu_directory() -> Path:
    """Directory that holds the three FMUs."""
    missing = [name for name in FILES if not (DIRECTORY / name).is_file()]
    assert not missing, f"{missing} not in {DIRECTORY}: run `cargo xtask fmu`"
    return DIRECTORY


@pytest.fixture(scope="session")
def fmus(fmu_directory: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The three FMUs, unpacked."""
    directory = tmp_path_factory.mktemp("unpacked")
    return {name: Fmu(fmu_directory / name, directory / Path(name).stem) for name in FILES}


@pytest.fixture(scope="session")
def command() -> Path:
    """The command line that the cross-check calls."""
    assert COMMAND.is_file(), f"{COMMAND} is not there: run `cargo build --release --package switchid-harness-command`"
    return COMMAND
