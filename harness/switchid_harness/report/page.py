"""The page: template, style and scripts put together with the figures and traces of every run."""

import json
from html import escape
from pathlib import Path

from ..figures import LEVEL
from .fragments import overview_row, run_fragment
from .overview import summary

_ASSETS = Path(__file__).parent / "assets"
_SCRIPTS = ["decode.js", "axes.js", "chart.js", "views.js", "app.js"]


def write_page(path: Path, seed: int, results: list[tuple[dict, dict]]) -> None:
    """Writes the report. `results`: figures and traces of every run, as `run` and `traces` make them."""
    path.write_text(page(seed, results), encoding="utf-8")


def page(seed: int, results: list[tuple[dict, dict]]) -> str:
    """The page's text."""
    runs = [figures for figures, _ in results]
    parts = {
        "style": _asset("style.css"),
        "script": "\n".join(_asset(name) for name in _SCRIPTS),
        "flow": _asset("flow.svg"),
        "summary": summary(seed, runs),
        "overview": "\n".join(overview_row(run) for run in runs),
        "fragments": "\n".join(run_fragment(run) for run in runs),
        "options": "\n".join(_option(run) for run in runs),
        "data": "\n".join(_data(figures, traces) for figures, traces in results),
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


def _data(figures: dict, traces: dict) -> str:
    run = escape(figures["id"])
    meta = json.dumps(_meta(figures, traces), allow_nan=False).replace("</", "<\\/")
    return (
        f'<script type="application/json" id="meta-{run}">{meta}</script>\n'
        f'<script type="text/plain" id="data-{run}">{traces["data"]}</script>'
    )
