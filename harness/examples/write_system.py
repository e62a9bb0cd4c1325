"""Plant and identifier as one .ssp file: PYTHONPATH=harness python write_system.py target/fmu system.ssp"""

import sys
from pathlib import Path

from switchid_harness.importers.case import Case, Fmus
from switchid_harness.importers.system import write_ssp

folder = Path(sys.argv[1])
case = Case("Duffing, a switch after 1.5 s", steps=[1e-3] * 30_000)
write_ssp(Fmus(folder / "Duffing.fmu", folder / "SwitchedIdentifier.fmu"), case, Path(sys.argv[2]))
