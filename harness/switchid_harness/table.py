"""The table on the terminal: one block per run, one row per stage."""

from .laws import in_order, symbol

_HEAD = ["stage", "from", "e", "detected", "tracked", "e", "detected", "tracked", "gate"]
_WIDTHS = [5, 8, 9, 9, 9, 9, 9, 9, 5]


def seconds(value: float | None) -> str:
    """A delay or an instant, `–` where there is none."""
    return "–" if value is None else f"{value:.3f} s"


def scientific(value: float | None) -> str:
    """A figure that spans decades."""
    return "–" if value is None else f"{value:.1e}"


def percent(value: float | None) -> str:
    """A share with three digits, `–` where there is none."""
    if value is None:
        return "–"
    return f"{100.0 * value:.3g} %" if abs(value) >= 1e-6 else f"{100.0 * value:.1e} %"


def coefficient(value: float, std: float | None, truth: float) -> str:
    """A coefficient ± its std, with the truth beside it."""
    spread = "unknown" if std is None else f"± {std:.1e}"
    return f"{value:.6g} {spread} ({truth:g})"


def coefficients(run: dict, method: str, index: int) -> list[tuple[str, str]]:
    """Symbol and text of the coefficients of a stage that are not 0 or should not be."""
    stage, laws = run["methods"][method]["stages"][index], run["stages"][index]["coefficients"]
    shown = [term for term in in_order(run["terms"]) if stage["coefficients"][term] != 0.0 or term in laws]
    return [
        (symbol(term), coefficient(stage["coefficients"][term], stage["std"].get(term), laws.get(term, 0.0)))
        for term in shown
    ]


def alarms(figures: dict) -> str:
    """Missed switches and false alarms of one method, in words."""
    missed = count(figures["missed_switches"], "missed switch", "es")
    return f"{missed}, {count(len(figures['false_alarms']), 'false alarm', 's')}"


def count(number: int, noun: str, plural: str) -> str:
    """`1 run`, `2 runs`."""
    return f"{number} {noun}{'' if number == 1 else plural}"


def verdict(run: dict, number: int | None) -> str:
    """`ok`, `FAIL` or `–` (nothing is gated) for a stage, or for what concerns the whole run (None)."""
    outcomes = [gate["passed"] for gate in run["gates"] if gate["stage"] == number]
    return ("ok" if all(outcomes) else "FAIL") if outcomes else "–"


def _row(cells: list[str]) -> str:
    left = "  ".join(cell.rjust(width) for cell, width in zip(cells[:5], _WIDTHS))
    right = "  ".join(cell.rjust(width) for cell, width in zip(cells[5:], _WIDTHS[5:]))
    return f"  {left}  │ {right}"


def _stage_lines(run: dict, index: int) -> list[str]:
    cells = [str(index + 1), seconds(run["stages"][index]["start"])]
    for method in ("default", "publication"):
        stage = run["methods"][method]["stages"][index]
        cells += [scientific(stage["e"]), seconds(stage["detection_delay"]), seconds(stage["tracking_delay"])]
    law = [f"{name}: {text}" for name, text in coefficients(run, "default", index)]
    groups = ["   ".join(law[i : i + 3]) for i in range(0, len(law), 3)]
    return [_row([*cells, verdict(run, index + 1)]), *(f"         {group}" for group in groups)]


def _alarm_line(run: dict) -> str:
    parts = []
    for method, name in (("default", "ours"), ("publication", "published")):
        parts.append(f"{name}: {alarms(run['methods'][method])}")
    return f"  {'; '.join(parts)}; gate {verdict(run, None)}"


def block(run: dict) -> str:
    """The block of one run."""
    head = _row(_HEAD)
    over = " " * head.index("│") + "│ published method"
    lines = [f"{run['title']} ({run['set']})", over, head]
    for index in range(len(run["stages"])):
        lines += _stage_lines(run, index)
    return "\n".join([*lines, _alarm_line(run), ""])


def effect_block(effect: dict) -> str:
    """The block of one hidden effect."""
    before, after = effect["models"]["refitted"], effect["models"]["improved"]
    lines = [f"{effect['title']} ({effect['set']})", *(f"  {line}" for line in effect["diagnosis"]["answer"])]
    for name, key in (("force residual", "force_residual"), ("free-run error", "free_run_error")):
        lines.append(f"  {name}, fresh record: {percent(before[key])} → {percent(after[key])}")
    return "\n".join([*lines, f"  noise floor {percent(after['noise_floor'])}; gate {verdict(effect, None)}", ""])


def failures(runs: list[dict]) -> list[str]:
    """One line per gate that failed."""
    lines = []
    for run in runs:
        for gate in run["gates"]:
            if not gate["passed"]:
                where = run["title"] if gate["stage"] is None else f"{run['title']}, stage {gate['stage']}"
                value = "none" if gate["value"] is None else f"{gate['value']:.3g}"
                lines.append(f"{run['set']}: {where}: {gate['name']} is {value}, the floor is {gate['floor']:.3g}")
    return lines
