"""Figures as the description that `figure.js` draws (docs/figure-description.md), as plain JSON values.

Points are pairs, or a `series` that names traces of the page's store; NaN interrupts a line.
"""

from collections.abc import Sequence

Layer = dict
Panel = dict
Points = Sequence[Sequence[float]] | dict


def axis(label: str, log: bool = False, shown: tuple[float, float] | None = None) -> dict:
    """An axis: quantity and unit, whether it is logarithmic, what it shows (all where none is given)."""
    return {"label": label, "log": log, "range": shown}


def panel(x: dict, y: dict, layers: list[Layer], title: str = "") -> Panel:
    """Layers over a pair of axes, the first one lowest."""
    return {"title": title, "x": x, "y": y, "layers": layers}


def series(x: str, y: str, within: tuple[int, int] | None = None) -> dict:
    """Points of two traces of the store, those of a range of indices where one is given."""
    return {"x": x, "y": y} | ({} if within is None else {"from": within[0], "to": within[1]})


def band_around(x: str, y: str, half: str, factor: float) -> dict:
    """Edges of an area: a trace ± another one times a factor."""
    return {"x": x, "y": y, "half": half, "factor": factor}


def line(name: str, points: Points) -> Layer:
    """A line; its name stands in the legend."""
    return {"line": {"name": name, "points": points}}


def reference(name: str, points: Points) -> Layer:
    """A line in dark grey: what was measured or is true."""
    return {"reference": {"name": name, "points": points}}


def area(name: str, edges: dict) -> Layer:
    """The area between two curves, in the colour of the next line."""
    return {"area": {"name": name, "edges": edges}}


def bars(rows: list[tuple[str, float, str]]) -> Layer:
    """Named bars, each with its text."""
    return {"bars": rows}


def band(start: float, end: float, label: str = "") -> Layer:
    """A stretch of the axis to the right."""
    return {"band": {"from": start, "to": end, "label": label}}


def mark(at: float, label: str = "") -> Layer:
    """A value on the axis to the right."""
    return {"mark": {"at": at, "label": label}}
