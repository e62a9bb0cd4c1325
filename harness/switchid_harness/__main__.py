"""`python -m switchid_harness`: every scenario, one table, gates, report.html and report.json."""

import argparse
import json
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from . import hidden, improvement, scenarios, table
from .hidden import HiddenEffect
from .report.effect_views import effect_views
from .report.page import write_page
from .report.run_views import run_views
from .run import perform
from .scenarios import Scenario
from .slave import Fmu

FMUS = ["SwitchedIdentifier.fmu", "Duffing.fmu", "VanDerPol.fmu"]

_fmus: dict[str, Fmu] = {}

_Job = Scenario | HiddenEffect


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="cargo xtask crosscheck", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="seed of the second, randomly drawn set (default 1)")
    parser.add_argument(
        "--quick", action="store_true", help="only the documented set without noise and the publication's cases"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes side by side (default: all cores)")
    parser.add_argument("--command", type=Path, default=Path("target/release/switchid-harness"), help=argparse.SUPPRESS)
    parser.add_argument("--fmus", type=Path, default=Path("target/fmu"), help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, default=Path("target/crosscheck"), help=argparse.SUPPRESS)
    return parser.parse_args()


def chosen(quick: bool, seed: int) -> tuple[list[Scenario], list[HiddenEffect]]:
    """The scenarios to run: switched plants, plants with a hidden effect."""
    documented = scenarios.documented()
    if quick:
        quiet = [scenario for scenario in documented if scenario.noise == 0.0]
        return quiet + scenarios.publication_cases(), hidden.documented()
    switched = documented + scenarios.publication_cases() + scenarios.drawn(seed)
    return switched, hidden.documented() + hidden.drawn(seed)


def unpack(source: Path, directory: Path) -> dict[str, Fmu]:
    """The three FMUs, unpacked into `directory`."""
    missing = [name for name in FMUS if not (source / name).is_file()]
    if missing:
        sys.exit(f"{', '.join(missing)} not found in {source}: run `cargo xtask fmu`")
    return {name: Fmu(source / name, directory / Path(name).stem) for name in FMUS}


def work(job: _Job, command: Path, out: Path) -> tuple[dict, dict]:
    """One scenario in a worker process: figures, and what the report draws of them."""
    if isinstance(job, HiddenEffect):
        found = improvement.perform(job, _fmus, command, out / job.id)
        return found.figures, effect_views(found)
    run = perform(job, _fmus)
    return run.figures, run_views(run)


def keep(fmus: dict[str, Fmu]) -> None:
    """Hands the unpacked FMUs to a worker process, once."""
    _fmus.update(fmus)


def run_all(jobs: list[_Job], options: argparse.Namespace) -> list[tuple[dict, dict]]:
    """Runs the scenarios side by side; results in the order of the scenarios."""
    begin = time.monotonic()
    with ProcessPoolExecutor(options.jobs, initializer=keep, initargs=(_fmus,)) as pool:
        futures = {pool.submit(work, job, options.command, options.out): job for job in jobs}
        for done, future in enumerate(as_completed(futures), start=1):
            mark = "gates hold" if future.result()[0]["passed"] else "GATES FAIL"
            elapsed = time.monotonic() - begin
            job = futures[future]
            print(f"[{elapsed:6.1f} s] {done}/{len(futures)} {job.title} ({job.group}): {mark}", file=sys.stderr)
        return [future.result() for future in futures]


def summary(runs: list[dict]) -> tuple[str, bool]:
    """The last lines of the output, and whether every gate holds."""
    failed = table.failures(runs)
    total = sum(len(run["gates"]) for run in runs)
    if failed:
        return "\n".join([f"{len(failed)} of {total} gates fail:", *(f"  {line}" for line in failed)]), False
    return f"all {total} gates hold", True


def main() -> int:
    """Runs everything; 1 when a gate fails."""
    options = arguments()
    options.out.mkdir(parents=True, exist_ok=True)
    if not options.command.is_file():
        sys.exit(f"{options.command} not found: run `cargo build --release --package switchid-harness-command`")
    keep(unpack(options.fmus, options.out / "unpacked"))
    switched, effects = chosen(options.quick, options.seed)
    results = run_all([*effects, *switched], options)
    improvements, results = results[: len(effects)], results[len(effects) :]
    runs, improved = ([figures for figures, _ in group] for group in (results, improvements))
    print("\n".join([*(table.block(run) for run in runs), *(table.effect_block(effect) for effect in improved)]))
    text, passed = summary(runs + improved)
    document = {"seed": options.seed, "passed": passed, "runs": runs, "hidden_effects": improved}
    (options.out / "report.json").write_text(json.dumps(document, indent=1, allow_nan=False))
    write_page(options.out / "report.html", options.seed, results, improvements)
    print(f"{text}\nreport: {options.out / 'report.html'}, figures: {options.out / 'report.json'}")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
