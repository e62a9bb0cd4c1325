"""Gates from a command line: switchid-gate Axis.fmu SwitchedIdentifier.fmu --terms qdd,qd,q --truth laws.csv"""

import argparse
import sys

from .check import Gates, Plant, check
from .truth import TruthError


def _pair(text: str) -> tuple[str, str]:
    name, separator, value = text.partition("=")
    if not separator:
        raise argparse.ArgumentTypeError(f"{text!r} is no NAME=VALUE")
    return name, value


def main(arguments: list[str] | None = None) -> int:
    """0 where every gate passed, 1 where one failed, 2 for bad usage."""
    parser = argparse.ArgumentParser(
        prog="switchid-gate", description="Steps a plant FMU beside the identifier and gates what came of it."
    )
    parser.add_argument("plant", help="the plant's .fmu")
    parser.add_argument("identifier", help="SwitchedIdentifier.fmu, or one for your model from `switchid fmu`")
    parser.add_argument(
        "--map", type=_pair, action="append", default=[], metavar="q=body.x", help="what the plant calls q, qd, F"
    )
    parser.add_argument(
        "--set", type=_pair, action="append", default=[], metavar="NAME=VALUE", help="a parameter of the plant"
    )
    parser.add_argument("--terms", required=True, help="the law's terms by the names of their outputs: qdd,qd,q,q_3")
    parser.add_argument("--truth", help="CSV file: t, and a column for each term")
    parser.add_argument(
        "--true",
        type=_pair,
        action="append",
        default=[],
        metavar="q_3=body.k3",
        help="an output that is a true coefficient",
    )
    parser.add_argument("--duration", type=float, default=30.0, help="s")
    parser.add_argument("--step", type=float, default=1e-3, help="s")
    parser.add_argument("--error", type=float, default=Gates.error, help="floor of the coefficient error e")
    parser.add_argument("--delay", type=float, help="floor of the detection delay, s")
    parser.add_argument("--tracking", type=float, help="floor of the tracking delay, s")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    given = parser.parse_args(arguments)
    if not given.truth and not given.true:
        parser.error("which law is true? Give --truth FILE, or --true TERM=OUTPUT for each term")
    plant = Plant(given.plant, dict(given.map), dict(given.true), dict(given.set))
    gates = Gates(given.error, given.delay, given.tracking)
    try:
        report = check(
            plant,
            given.identifier,
            duration=given.duration,
            terms=given.terms.split(","),
            truth=given.truth,
            gates=gates,
            step=given.step,
        )
    except (KeyError, OSError, TruthError) as error:
        # a KeyError shows its text in quotes
        text = error.args[0] if isinstance(error, KeyError) else error
        print(f"error: {text}", file=sys.stderr)
        return 2
    print(report.to_json() if given.json else report)
    return 0 if report.passed else 1


if __name__ == "__main__":
    sys.exit(main())
