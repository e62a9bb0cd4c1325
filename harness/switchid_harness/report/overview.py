"""The summary at the head of the page."""

from html import escape

from ..table import count, failures


def summary(seed: int, runs: list[dict], effects: list[dict]) -> str:
    """Verdict, what was run, and the list of gates that fail."""
    failed = failures(runs + effects)
    total = sum(len(run["gates"]) for run in runs + effects)
    verdict = f"All {total} gates hold" if not failed else f"{len(failed)} of {total} gates fail"
    switches = sum(len(run["stages"]) - 1 for run in runs)
    seconds = sum(run["end"] for run in runs)
    facts = [
        f"{count(len(runs), 'run', 's')}, {count(switches, 'switch', 'es')}, {seconds:.0f} s of record at 1 kHz",
        count(len(effects), "hidden effect", "s"),
        f"one default configuration; drawn parameters from seed {seed}",
    ]
    items = "".join(f"<li>{escape(line)}</li>" for line in failed)
    details = f"<details><summary>Gates that fail</summary><ul>{items}</ul></details>" if failed else ""
    kind = "bad" if failed else "good"
    chips = "".join(f'<span class="chip">{escape(fact)}</span>' for fact in facts)
    return f'<p class="verdict"><span class="chip {kind}">{escape(verdict)}</span>{chips}</p>{details}'
