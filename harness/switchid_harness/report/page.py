"""The page: template, style and scripts put together with the figures and traces of every run."""

import json
from html import escape
from pathlib import Path

from plotly.offline import get_plotlyjs

from .effects import effect_card, effect_row
from .fragments import overview_row, run_fragment
from .overview import summary

_ASSETS = Path(__file__).parent / "assets"
_SCRIPTS = ["figure.js", "decode.js", "app.js"]


Results = list[tuple[dict, dict]]


def write_page(path: Path, seed: int, results: Results, improvements: Results) -> None:
    """Writes the report. Figures of every run and of every hidden effect, each with what `run_views` and `effect_views` make."""
    path.write_text(page(seed, results, improvements), encoding="utf-8")


def page(seed: int, results: Results, improvements: Results) -> str:
    """The page's text."""
    runs, effects = ([figures for figures, _ in group] for group in (results, improvements))
    parts = {
        "style": _asset("style.css"),
        "plotly": get_plotlyjs(),
        "script": "\n".join(_asset(name) for name in _SCRIPTS),
        "flow": _asset("flow.svg"),
        "summary": summary(seed, runs, effects),
        "overview": "\n".join(overview_row(run) for run in runs),
        "fragments": "\n".join(run_fragment(run) for run in runs),
        "options": "\n".join(_option(run) for run in runs),
        "effect-rows": "\n".join(effect_row(effect) for effect in effects),
        "effects": "\n".join(effect_card(effect) for effect in effects),
        "data": "\n".join(_data(figures, drawn) for figures, drawn in [*results, *improvements]),
    }
    text = _asset("page.html")
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part)
    return text


def _asset(name: str) -> str:
    return (_ASSETS / name).read_text(encoding="utf-8")


def _option(run: dict) -> str:
    return f'<option value="{escape(run["id"])}">{escape(run["set"])}: {escape(run["title"])}</option>'


def _data(figures: dict, drawn: dict) -> str:
    run = escape(figures["id"])
    described = {key: drawn[key] for key in ("points", "names", "views")}
    meta = json.dumps(described, allow_nan=False, separators=(",", ":")).replace("</", "<\\/")
    return (
        f'<script type="application/json" id="meta-{run}">{meta}</script>\n'
        f'<script type="text/plain" id="data-{run}">{drawn["data"]}</script>'
    )
