"""The figures of a run: motion, prediction, coefficients, error and deviation of both methods."""

import numpy as np

from ..figure import Panel, area, axis, band, band_around, line, mark, panel, reference, series
from ..figures import LEVEL
from ..laws import in_order, symbol
from ..run import METHODS, UNKNOWN_STD, Run
from ..stepping import Track
from ..table import alarms
from .store import Store, grid

_TIME = axis("t, s")
_STATUS = "0 acquiring, 1 tracking, 2 switch suspected, 3 re-identifying"
_CHANNELS = {"q": "displacement q", "qd": "velocity q̇", "F": "excitation F"}
_FIRST_STATUS = 1  # the FMU's number of "acquiring"
_ERRORS, _DEVIATIONS = (1e-16, 1e3), (1e-12, 1e3)


def run_views(run: Run) -> dict:
    """`views` by place of the page, and the packed traces that their panels name."""
    record = run.record
    switches = [round(stage.start / (record.time[1] - record.time[0])) for stage in run.scenario.stages[1:]]
    store = Store(record.sampled, grid(len(record.time), switches))
    for index, name in enumerate(_CHANNELS):
        store.add(name, record.observed[:, index])
    views = {
        "state": _state(run),
        "prediction": _prediction(run, store),
        "portraits": _portraits(run, store),
        "coefficients": [_coefficient(run, store, term) for term in _shown_terms(run)],
        "error": [_error(run, store), _status(run)],
        "deviation": [_deviation(run, store, method) for method in METHODS],
    }
    return {"views": views, **store.packed()}


def _shown_terms(run: Run) -> list[str]:
    """Terms that some stage has, or that a method believed in."""
    used = {term for stage in run.figures["stages"] for term in stage["coefficients"]}
    for track in run.record.tracks.values():
        used |= {term for i, term in enumerate(track.terms) if np.any(track.coefficients[:, i] != 0.0)}
    return in_order(used)


def _marked(run: Run, method: str, layers: list[dict]) -> list[dict]:
    """Layers over the stages as bands, with a method's alarms: those apart from a band's edge are false."""
    stages = [band(stage["start"], stage["end"]) for stage in run.figures["stages"]]
    found = run.figures["methods"][method]
    detected = [mark(stage["detected"]) for stage in found["stages"] if stage["detected"] is not None]
    return [*stages, *layers, *detected, *(mark(time) for time in found["false_alarms"])]


def _state(run: Run) -> list[Panel]:
    panels = {name: [reference("measured", series("t", name))] for name in ("F", "q", "qd")}
    return [panel(_TIME, axis(_CHANNELS[name]), _marked(run, "default", layers)) for name, layers in panels.items()]


def _predictions(track: Track, name: str) -> np.ndarray:
    """What a method predicts of a channel; NaN while it has no law."""
    has_law = np.any(track.coefficients != 0.0, axis=1)
    return np.where(has_law, track.outputs[f"prediction.{name}"], np.nan)


def _prediction(run: Run, store: Store) -> list[Panel]:
    panels = []
    for name in ("q", "qd"):
        lines = [
            line(words, series("t", store.add(f"{method}.{name}", _predictions(run.record.tracks[method], name))))
            for method, words in METHODS.items()
        ]
        observed = store.traces[name]
        space = 0.15 * float(np.ptp(observed)) + 1e-9
        shown = axis(_CHANNELS[name], shown=(float(observed.min()) - space, float(observed.max()) + space))
        measured = reference("measured", series("t", name))
        panels.append(panel(_TIME, shown, _marked(run, "default", [measured, *lines])))
    return [*panels, _differences(run, store)]


def _differences(run: Run, store: Store) -> Panel:
    lines, names = [], []
    for method, words in METHODS.items():
        predicted = (_predictions(run.record.tracks[method], name) for name in ("q", "qd"))
        apart = sum(np.abs(values - run.record.observed[:, index]) for index, values in enumerate(predicted))
        names.append(store.add(f"{method}.apart", apart))
        lines.append(line(words, series("t", names[-1])))
    label = axis("|difference|", log=True, shown=store.extent(names, _DEVIATIONS))
    title = "|predicted − measured|, q and q̇ together"
    return panel(_TIME, label, _marked(run, "default", lines), title=title)


def _portraits(run: Run, store: Store) -> list[Panel]:
    panels = []
    for number, stage in enumerate(run.figures["stages"], start=1):
        within = store.within(stage["start"], stage["end"])
        layers = [
            reference("measured", series("q", "qd", within)),
            line("ours", series("default.q", "default.qd", within)),
        ]
        edges = [axis(label, shown=_padded(store.traces[name])) for label, name in (("q", "q"), ("q̇", "qd"))]
        panels.append(panel(*edges, layers, title=f"Stage {number}"))
    return panels


def _padded(values: np.ndarray) -> tuple[float, float]:
    space = 0.06 * float(np.ptp(values)) + 1e-9
    return float(values.min()) - space, float(values.max()) + space


def _coefficient(run: Run, store: Store, term: str) -> Panel:
    """Both methods' values about the true ones, ours with two std."""
    stages = run.figures["stages"]
    steps = [[stage[edge], stage["coefficients"].get(term, 0.0)] for stage in stages for edge in ("start", "end")]
    truths = [value for _, value in steps]
    low, high = min(truths), max(truths)
    space = 0.6 * max(high - low, 0.15 * max(abs(low), abs(high)), 0.1)
    layers = [reference("true", steps)]
    for method, words in METHODS.items():
        track = run.record.tracks[method]
        index = track.terms.index(term)
        value = store.add(f"{method}.coef.{term}", track.coefficients[:, index])
        if method == "default":
            std = np.where(track.std[:, index] < UNKNOWN_STD, track.std[:, index], np.nan)
            layers.append(area("± 2 std", band_around("t", value, store.add(f"{method}.std.{term}", std), 2.0)))
        layers.append(line(words, series("t", value)))
    label = axis(f"coefficient of {symbol(term)}", shown=(low - space, high + space))
    return panel(_TIME, label, _marked(run, "default", layers))


def _error(run: Run, store: Store) -> Panel:
    names = {method: store.add(f"{method}.e", run.errors[method]) for method in METHODS}
    lines = [line(METHODS[method], series("t", name)) for method, name in names.items()]
    level = reference("0.05²", [[0.0, LEVEL], [run.figures["end"], LEVEL]])
    shown = store.extent(list(names.values()), _ERRORS)
    return panel(_TIME, axis("coefficient error e", log=True, shown=shown), _marked(run, "default", [*lines, level]))


def _status(run: Run) -> Panel:
    """What each method was doing, as steps over time."""
    lines = []
    for method, words in METHODS.items():
        status = run.record.tracks[method].outputs["status"] - _FIRST_STATUS
        edges = np.flatnonzero(np.diff(status))
        kept = np.unique(np.concatenate([[0], edges, edges + 1, [len(status) - 1]]))
        lines.append(line(words, [[round(float(run.record.time[k]), 4), float(status[k])] for k in kept]))
    # few points are shown each, for which plotly would widen the axis
    time = axis("t, s", shown=(0.0, float(run.figures["end"])))
    return panel(time, axis("status", shown=(-0.5, 3.5)), lines, title=_STATUS)


def _deviation(run: Run, store: Store, method: str) -> Panel:
    outputs = run.record.tracks[method].outputs
    names = {words: store.add(f"{method}.{words}", outputs[words]) for words in ("deviation", "threshold")}
    lines = [line(words, series("t", name)) for words, name in names.items()]
    shown = store.extent(list(names.values()), _DEVIATIONS)
    title = f"{METHODS[method]}: {alarms(run.figures['methods'][method])}"
    return panel(_TIME, axis("deviation", log=True, shown=shown), _marked(run, method, lines), title=title)
