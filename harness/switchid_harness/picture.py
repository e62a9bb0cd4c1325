"""`cargo xtask picture`: a switching record, the coefficients identified from it beside the true ones, and the alarms.

Draws what `switchid simulate` and `switchid identify --trace` wrote; needs no package. Nothing here is seen by an
estimator: the truth is read beside the trace, for the black lines alone.
"""

import argparse
import csv
import json
from dataclasses import dataclass
from html import escape
from pathlib import Path

from .laws import fmu_name, symbol

UNKNOWN = 1e30  # the std that the trace has for a coefficient that is not known
WIDTH, LEFT, RIGHT, TOP, BOTTOM, GAP = 1000, 74, 14, 58, 42, 12  # px
MOTION_HEIGHT, COEFFICIENT_HEIGHT = 130, 84  # px
STRIDE = 40  # samples between two points of a line
MARGIN = 0.35  # space above and below the true values, as a share of their range

TRUE, IDENTIFIED, MOTION, ALARM, GRID = "#1c1c1c", "#2e649e", "#7b8794", "#c0392b", "#d5d9de"


@dataclass
class Trace:
    """What the picture shows of a run, one entry per drawn sample; alarms are instants in seconds."""

    t: list[float]
    coefficients: dict[str, list[tuple[float, float] | None]]
    alarms: list[float]


@dataclass
class Panel:
    """A stretch of the picture with one vertical axis: values from `low` at the foot to `high` at `top`."""

    top: float
    height: float
    low: float
    high: float
    end: float

    def x(self, t: float) -> float:
        """Abscissa of an instant, px."""
        return LEFT + (WIDTH - LEFT - RIGHT) * t / self.end

    def y(self, value: float) -> float:
        """Ordinate of a value, px; values beyond the panel lie at its edge."""
        share = (value - self.low) / (self.high - self.low)
        return self.top + self.height * (1.0 - min(max(share, 0.0), 1.0))

    def points(self, pairs: list[tuple[float, float]]) -> str:
        """Instants and values as SVG's points; of a level stretch its ends alone."""
        drawn = [(f"{self.x(t):.1f}", f"{self.y(value):.1f}") for t, value in pairs]
        edges = [None, *(y for _, y in drawn), None]
        corners = [point for k, point in enumerate(drawn) if not edges[k] == edges[k + 1] == edges[k + 2]]
        return " ".join(f"{x},{y}" for x, y in corners)


def read_trace(path: Path, terms: list[str]) -> Trace:
    """Every `STRIDE`-th sample of a trace of `switchid identify`, and all its alarms."""
    trace = Trace([], {term: [] for term in terms}, [])
    count = 0
    with open(path, newline="") as file:
        for index, row in enumerate(csv.DictReader(file)):
            if int(row["switch.count"]) > count:
                count = int(row["switch.count"])
                trace.alarms.append(float(row["switch.detection_time"]))
            if index % STRIDE == 0:
                trace.t.append(float(row["t"]))
                for term, values in trace.coefficients.items():
                    std = float(row[f"std.{fmu_name(term)}"])
                    values.append((float(row[f"coef.{fmu_name(term)}"]), std) if std < UNKNOWN else None)
    return trace


def read_motion(path: Path) -> list[tuple[float, float]]:
    """Every `STRIDE`-th sample of the displacement, with its instant."""
    with open(path, newline="") as file:
        rows = csv.DictReader(file)
        return [(float(row["t"]), float(row["q"])) for index, row in enumerate(rows) if index % STRIDE == 0]


def known_stretches(t: list[float], values: list[tuple[float, float] | None]) -> list[list[tuple[float, float, float]]]:
    """The stretches over which a coefficient is known: instant, value, std."""
    stretches = [[]]
    for instant, known in zip(t, values):
        if known is None:
            stretches.append([])
        else:
            stretches[-1].append((instant, *known))
    return [stretch for stretch in stretches if len(stretch) > 1]


def line(points: str, colour: str, width: float) -> str:
    """A polyline."""
    return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{width}"/>'


def text(x: float, y: float, words: str, anchor: str = "start", colour: str = TRUE, size: int = 14) -> str:
    """Words, their foot at (x, y)."""
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    return f'<text {place} fill="{colour}" font-size="{size}">{escape(words)}</text>'


def frame(panel: Panel, name: str, ticks: list[float]) -> str:
    """A panel's name, its values on the left and its rules."""
    parts = [text(14, panel.top + panel.height / 2 + 5, name, size=16)]
    for value in ticks:
        y = panel.y(value)
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="{GRID}"/>')
        parts.append(text(LEFT - 6, y + 4, f"{value:g}", "end", "#555", 12))
    return "".join(parts)


def coefficient(panel: Panel, name: str, steps: list[tuple[float, float]], trace: Trace, term: str) -> str:
    """One coefficient: true in black, identified in blue with one std to both sides, nothing where it is not known."""
    truths = [value for _, value in steps]
    parts = [frame(panel, name, sorted({min(truths), max(truths)})), line(panel.points(steps), TRUE, 3.5)]
    for stretch in known_stretches(trace.t, trace.coefficients[term]):
        upper = [(t, value + std) for t, value, std in stretch]
        lower = [(t, value - std) for t, value, std in reversed(stretch)]
        parts.append(f'<polygon points="{panel.points(upper + lower)}" fill="{IDENTIFIED}" fill-opacity="0.25"/>')
        parts.append(line(panel.points([(t, value) for t, value, _ in stretch]), IDENTIFIED, 1.8))
    return "".join(parts)


def marks(panel: Panel, foot: float, switches: list[float], alarms: list[float]) -> str:
    """Switches as dashed lines through all panels, alarms as red triangles above them, with the delay of each."""
    parts = []
    for switch in switches:
        x = panel.x(switch)
        parts.append(
            f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{panel.top}" y2="{foot}" stroke="#555" stroke-dasharray="3 4"/>'
        )
    for alarm in alarms:
        x, y = panel.x(alarm), panel.top - 1
        parts.append(f'<path d="M{x:.1f} {y} l-7 -12 h14 z" fill="{ALARM}"/>')
        before = [switch for switch in switches if switch < alarm]
        words = f"+{1000 * (alarm - before[-1]):.0f} ms" if before else "false"
        parts.append(text(x + 11, y - 2, words, colour=ALARM, size=13))
    return "".join(parts)


def legend() -> str:
    """What the lines and marks are."""
    entries = [("measured", MOTION), ("true", TRUE), ("identified ± std", IDENTIFIED)]
    parts, x = [], float(LEFT)
    for words, colour in entries:
        parts.append(f'<line x1="{x}" x2="{x + 26}" y1="17" y2="17" stroke="{colour}" stroke-width="4"/>')
        parts.append(text(x + 33, 22, words))
        x += 62 + 8 * len(words)
    parts.append(f'<line x1="{x}" x2="{x + 26}" y1="17" y2="17" stroke="#555" stroke-dasharray="3 4"/>')
    parts.append(text(x + 33, 22, "the law switches"))
    x += 62 + 8 * len("the law switches")
    parts.append(f'<path d="M{x + 12} 23 l-7 -12 h14 z" fill="{ALARM}"/>' + text(x + 27, 22, "alarm, with its delay"))
    return "".join(parts)


def draw(motion: list[tuple[float, float]], truth: dict, trace: Trace) -> str:
    """The picture as SVG: motion above, one panel for each of the law's coefficients below, one axis of time."""
    end, reach = motion[-1][0], max(abs(q) for _, q in motion)
    panel = first = Panel(TOP, MOTION_HEIGHT, -1.1 * reach, 1.1 * reach, end)
    parts = [legend(), frame(panel, "q", [-1, 0, 1]), line(panel.points(motion), MOTION, 1.3)]
    for term in trace.coefficients:
        stages = truth["stages"]
        steps = [(stage[edge], stage["coefficients"][term]) for stage in stages for edge in ("start", "end")]
        low, high = min(value for _, value in steps), max(value for _, value in steps)
        space = MARGIN * (high - low or 1.0)
        panel = Panel(panel.top + panel.height + GAP, COEFFICIENT_HEIGHT, low - space, high + space, end)
        parts.append(coefficient(panel, symbol(fmu_name(term)), steps, trace, term))
    foot = panel.top + panel.height
    parts.append(text(14, first.top + first.height + GAP + 8, "coefficient of", colour="#555", size=12))
    parts.append(marks(first, foot, truth["switch_times"], trace.alarms))
    parts += [text(panel.x(t), foot + 18, f"{t}", "middle", "#555", 12) for t in range(0, int(end) + 1, 10)]
    parts.append(text((WIDTH + LEFT) / 2, foot + 37, "time, s", "middle"))
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {foot + BOTTOM:.0f}" width="{WIDTH}" '
    style = 'font-family="DejaVu Sans, Helvetica, Arial, sans-serif">'
    return "\n".join([head + style, '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>\n"])


def main() -> None:
    """Reads the record, its trace and its truth, and writes the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("record", type=Path, help="CSV of simulate")
    parser.add_argument("truth", type=Path, help="JSON beside it")
    parser.add_argument("trace", type=Path, help="CSV of identify --trace")
    parser.add_argument("picture", type=Path, help="SVG to write")
    options = parser.parse_args()
    truth = json.loads(options.truth.read_text())
    trace = read_trace(options.trace, list(truth["stages"][0]["coefficients"]))
    options.picture.write_text(draw(read_motion(options.record), truth, trace))


if __name__ == "__main__":
    main()
