"""Pieces of the page that are text: rows of the overview, and each run's equations and table."""

from collections.abc import Iterable
from html import escape

from .. import table
from ..laws import in_order
from .equations import digits, equation, power, term_markup

_METHODS = (("default", "ours"), ("publication", "published"))


def _worst(values: Iterable[float | None]) -> float | None:
    """The largest; None (never reached) counts as worse than any number."""
    kept = list(values)
    return None if not kept or None in kept else max(kept)


def pill(outcome: str) -> str:
    """Whether gates hold, as a coloured word; `outcome` as `table.verdict` gives it."""
    names = {"ok": ("good", "holds"), "FAIL": ("bad", "fails"), "–": ("", "not gated")}
    kind, text = names[outcome]
    return f'<span class="pill {kind}">{text}</span>'


def _method_cells(run: dict, method: str) -> str:
    figures = run["methods"][method]
    stages = figures["stages"]
    cells = [
        power(_worst(stage["e"] for stage in stages)),
        table.seconds(_worst(stage["detection_delay"] for stage in stages[1:])),
        table.seconds(_worst(stage["tracking_delay"] for stage in stages[1:])),
        f"{figures['missed_switches']} / {len(figures['false_alarms'])}",
    ]
    return "".join(f'<td class="{method}">{cell}</td>' for cell in cells)


def overview_row(run: dict) -> str:
    """One run in one row: worst figures of both methods."""
    methods = "".join(_method_cells(run, method) for method, _ in _METHODS)
    outcome = "ok" if run["passed"] else "FAIL"
    name = f"{escape(run['title'])}<small>{escape(run['set'])}</small>"
    return (
        f'<tr data-run="{escape(run["id"])}" tabindex="0"><th scope="row">{name}</th>'
        f"{methods}<td>{pill(outcome)}</td></tr>"
    )


def run_fragment(run: dict) -> str:
    """Equations and table of a run, to be shown when it is chosen."""
    cards = "".join(_stage_card(run, index) for index in range(len(run["stages"])))
    return (
        f'<template id="fragment-{escape(run["id"])}"><section class="laws">{cards}</section>'
        f'<section class="figures">{_stage_table(run)}</section></template>'
    )


def _drive(run: dict, parameters: dict[str, float]) -> str:
    if run["excitation"] == "white":
        return f"F: white noise, 2D = {run['intensity']:g}"
    return f"F = {parameters['P']:g} sin {parameters['omega']:g} t"


def _stage_card(run: dict, index: int) -> str:
    stage = run["stages"][index]
    rows = [("truth", "truth", equation(stage["coefficients"], {}), "")]
    for method, name in _METHODS:
        found = run["methods"][method]["stages"][index]
        error = f"e = {power(found['e'])}"
        rows.append((method, name, equation(found["coefficients"], found["std"]), error))
    lines = "".join(
        f'<div class="law {kind}"><span>{name}</span><div>{markup}</div><em>{error}</em></div>'
        for kind, name, markup, error in rows
    )
    when = f"{stage['start']:g} – {stage['end']:g} s · {escape(_drive(run, stage['parameters']))}"
    return f'<article class="card stage-{index % 6}"><h4>Stage {index + 1}<small>{when}</small></h4>{lines}</article>'


def _coefficient_cell(run: dict, method: str, index: int) -> str:
    found, truth = run["methods"][method]["stages"][index], run["stages"][index]["coefficients"]
    lines = []
    for term in in_order(run["terms"]):
        value, std = found["coefficients"][term], found["std"].get(term)
        if value == 0.0 and term not in truth:
            continue
        spread = "unknown" if std is None else f"± {power(std)}"
        sign = "−" if value < 0.0 else ""
        lines.append(
            f"<tr><td>{term_markup(term)}</td><td>{sign}{digits(abs(value), std)}</td><td>{spread}</td>"
            f"<td>{truth.get(term, 0.0):.5g}</td></tr>".replace(">-", ">−")
        )
    return f'<table class="coefficients">{"".join(lines)}</table>'


def _stage_row(run: dict, index: int) -> str:
    cells = [f'<th scope="row" class="stage-{index % 6}">{index + 1}</th>']
    for method, _ in _METHODS:
        found = run["methods"][method]["stages"][index]
        if method == "default":
            cells.append(f"<td>{_coefficient_cell(run, method, index)}</td>")
        texts = [power(found["e"])]
        texts += [table.seconds(found[key]) for key in ("detection_delay", "tracking_delay", "identified")]
        cells += [f'<td class="{method}">{text}</td>' for text in texts]
    return f"<tr>{''.join(cells)}<td>{pill(table.verdict(run, index + 1))}</td></tr>"


_COLUMNS = (
    "<th>e</th><th>detected<small>after</small></th><th>tracked<small>after</small></th>"
    "<th>validated<small>at</small></th>"
)
_HEAD = (
    '<thead><tr><th rowspan="2">stage</th><th rowspan="2" class="left">coefficient ± std, truth</th>'
    '<th colspan="4" class="default">ours</th><th colspan="4" class="publication">published method</th>'
    f'<th rowspan="2">gate</th></tr><tr>{_COLUMNS}{_COLUMNS}</tr></thead>'
)


def _stage_table(run: dict) -> str:
    rows = "".join(_stage_row(run, index) for index in range(len(run["stages"])))
    return f'<table class="wide">{_HEAD}<tbody>{rows}</tbody></table><p class="note">{_alarms(run)}</p>{gate_table(run)}'


def _alarms(run: dict) -> str:
    parts = []
    for method, name in _METHODS:
        figures = run["methods"][method]
        times = ", ".join(f"{time:.2f} s" for time in figures["false_alarms"][:8])
        more = " …" if len(figures["false_alarms"]) > 8 else ""
        at = f" (at {times}{more})" if times else ""
        parts.append(f"{name}: {table.alarms(figures)}{at}")
    return escape("; ".join(parts)) + "."


def gate_table(run: dict) -> str:
    """The gates of a run, folded."""
    rows = "".join(
        f"<tr><td>{escape(gate['name'])}{'' if gate['stage'] is None else ', stage ' + str(gate['stage'])}</td>"
        f"<td>{'none' if gate['value'] is None else format(gate['value'], '.3g')}</td><td>≤ {gate['floor']:.3g}</td>"
        f"<td>{pill('ok' if gate['passed'] else 'FAIL')}</td></tr>"
        for gate in run["gates"]
    )
    head = "<thead><tr><th>gate</th><th>figure</th><th>floor</th><th></th></tr></thead>"
    title = f"{len(run['gates'])} gates of this run"
    return f'<details class="gates"><summary>{title}</summary><table>{head}<tbody>{rows}</tbody></table></details>'
