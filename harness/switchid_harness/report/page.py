"""The page: template, style and scripts put together with the figures and traces of every run."""

import json
from html import escape
from pathlib import Path

from ..figures import LEVEL
from .effects import effect_card, effect_meta, effect_row
from .fragments import overview_row, run_fragment
from .overview import summary

_ASSETS = Path(__file__).parent / "assets"
_SCRIPTS = ["decode.js", "axes.js", "chart.js", "views.js", "effects.js", "app.js"]


Results = list[tuple[dict, dict]]


def write_page(path: Path, seed: int, results: Results, improvements: Results) -> None:
    """Writes the report. Figures and traces of every run, and of every hidden effect, as `traces` makes them."""
    path.write_text(page(seed, results, improvements), encoding="utf-8")


def page(seed: int, results: Results, improvements: Results) -> str:
    """The page's text."""
    runs, effects = ([figures for figures, _ in group] for group in (results, improvements))
    parts = {
        "style": _asset("style.css"),
        "script": "\n".join(_asset(name) for name in _SCRIPTS),
        "flow": _asset("flow.svg"),
        "summary": summary(seed, runs, effects),
        "overview": "\n".join(overview_row(run) for run in runs),
        "fragments": "\n".join(run_fragment(run) for run in runs),
        "options": "\n".join(_option(run) for run in runs),
        "effect-rows": "\n".join(effect_row(effect) for effect in effects),
        "effects": "\n".join(effect_card(effect) for effect in effects),
        "data": "\n".join(
            [_data(figures, traces, _meta(figures, traces)) for figures, traces in results]
            + [_data(figures, traces, effect_meta(figures, traces)) for figures, traces in improvements]
        ),
    }
    text = _asset("page.html")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part)
    return text


def _asset(name: str) -> str:
    return (_ASSETS / name).read_text(encoding="utf-8")


def _option(run: dict) -> str:
    return f'<option value="{escape(run["id"])}">{escape(run["set"])}: {escape(run["title"])}</option>'


def _meta(figures: dict, traces: dict) -> dict:
    """What the script needs to know of a run beside its traces."""
    stages = [{"start": s["start"], "end": s["end"], "truth": s["coefficients"]} for s in figures["stages"]]
    alarms = {
        method: {"detected": [s["detected"] for s in m["stages"]], "false": m["false_alarms"]}
        for method, m in figures["methods"].items()
    }
    layout = {key: traces[key] for key in ("points", "names", "terms", "status")}
    return {"end": figures["end"], "stages": stages, "alarms": alarms, "level": LEVEL, **layout}


def _data(figures: dict, traces: dict, layout: dict) -> str:
    run = escape(figures["id"])
    meta = json.dumps(layout, allow_nan=False).replace("</", "<\\/")
    return (
        f'<script type="application/json" id="meta-{run}">{meta}</script>\n'
        f'<script type="text/plain" id="data-{run}">{traces["data"]}</script>'
    )
