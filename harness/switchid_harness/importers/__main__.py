"""Runs every case in every importer and prints one table: python -m switchid_harness.importers --fmus target/fmu"""

import argparse
import math
import sys
import tempfile
from pathlib import Path

from . import by_cosim, by_ecos, by_fmi_sim, by_fmpy, by_solver, fmi_library
from .case import CannotDo, Case, Fmus, cases

IMPORTERS = {
    "fmpy.ssp": by_fmpy.ssp,
    "ecospy": by_ecos.simulate,
    "libcosimpy": by_cosim.simulate,
    "fmi-sim": by_fmi_sim.simulate,
}
"""Beside the reference, which is a loop over fmpy's slaves."""

CLOSE = 1e-6
"""Largest relative difference that passes where the last digits differ: an importer's clock may."""


SOLVED = 1e-3
"""Largest difference of the displacement under fmpy's solver: it holds an input over its step from the other end."""


def main(arguments: list[str] | None = None) -> int:
    """The number of cases that failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fmus", type=Path, default=Path("target/fmu"))
    folder = parser.parse_args(arguments).fmus.resolve()
    fmus = Fmus(folder / "Duffing.fmu", folder / "SwitchedIdentifier.fmu")
    failed = 0
    for case in cases():
        references = _references(fmus, case)
        print(f"{case.name:<16}{'fmpy loop':<12}{len(case.steps)} steps, {len(references['product, seeing'])} values")
        for name, simulate in IMPORTERS.items():
            said, good = _compare(simulate, fmus, case, references)
            failed += not good
            print(f"{'':<16}{name:<12}{said}", flush=True)
    failed += _integrated(fmus) + _feed_through(fmus)
    print("all agree" if failed == 0 else f"{failed} differ")
    return failed


def _integrated(fmus: Fmus) -> int:
    """The plant under fmpy's solver beside itself in co-simulation; how many cases differ."""
    distances = by_solver.distances(fmus)
    print(f"{'model exchange':<16}" + ", ".join(f"{name}: {distance:.1e}" for name, distance in distances.items()))
    return sum(distance > SOLVED for distance in distances.values())


def _feed_through(fmus: Fmus) -> int:
    """Outputs that FMI Library takes to depend on an input at the same instant; how many FMUs have such, or say nothing."""
    failed = 0
    for path in (fmus.plant, fmus.identifier):
        found = fmi_library.inputs_of_outputs(path)
        through = None if found is None else [name for name, inputs in found.items() if inputs]
        said = "nothing is said" if found is None else f"{len(found)} outputs, feed-through {through or 'none'}"
        print(f"{'FMI Library':<16}{path.name:<28}{said}")
        failed += through != []
    return failed


def _references(fmus: Fmus, case: Case) -> dict[str, list[float]]:
    """What the loop gives under every clock, with the first inputs and without."""
    clocks = by_fmpy.CLOCKS if case.step else ["product"]
    return {
        f"{clock}, {'blind' if blind else 'seeing'}": by_fmpy.loop(fmus, case, clock, blind)
        for clock in clocks
        for blind in (False, True)
    }


def _compare(simulate, fmus: Fmus, case: Case, references: dict[str, list[float]]) -> tuple[str, bool]:
    try:
        with tempfile.TemporaryDirectory() as folder:
            values = simulate(fmus, case, Path(folder))
    except CannotDo as reason:
        return f"does {reason} only", True
    except ImportError as reason:
        return f"is not installed: {reason}", False
    for name, reference in references.items():
        if values == reference:
            return f"equal to the last digit ({name})", True
    name, distance = min(((name, _distance(values, own)) for name, own in references.items()), key=lambda pair: pair[1])
    return f"differs by {distance:.1e} ({name})", distance < CLOSE


def _distance(values: list[float], reference: list[float]) -> float:
    pairs = zip(values, reference, strict=True)
    return max(
        0.0 if own == other else abs(own - other) / max(abs(other), 1e-6) if math.isfinite(own) else math.inf
        for own, other in pairs
    )


if __name__ == "__main__":
    sys.exit(min(main(), 1))
