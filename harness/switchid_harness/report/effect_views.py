"""The figures of a hidden effect: how the errors fell, and both models beside the plant on the fresh record."""

from ..figure import Panel, axis, bars, line, mark, panel, reference, series
from ..free_run import error_over_time
from ..improvement import MODELS, Improvement
from ..table import percent
from .effects import named
from .store import Store, grid

_TIME = axis("t, s")
_CHANNELS = {"q": "displacement q", "qd": "velocity q̇"}
_ERRORS = (1e-9, 1e3)
_DRAWN = dict(reversed(MODELS.items()))  # in the colours of their laws: what was added is ours, as in every run
_SHOWN = 8.0  # s of the motion that are in view at first


def effect_views(improvement: Improvement) -> dict:
    """`views` by place of the page, and the packed traces that their panels name."""
    run = improvement.run
    store = Store(run.time, grid(len(run.time), []))
    for index, name in enumerate((*_CHANNELS, "F")):
        store.add(name, run.measured[:, index])
    views = {"falls": _falls(improvement.figures), "motion": _motion(run, store), "error": [_error(run, store)]}
    return {"views": views, **store.packed()}


def _falls(figures: dict) -> list[Panel]:
    """The force residual with its noise floor, and the free-run error, of both models."""
    added = f"+ {named(figures)}" if figures["diagnosis"]["effect"] else "nothing added"
    labels = dict(zip(MODELS, ("the model, refitted", added)))

    def fall(key: str, title: str, marks: list[dict]) -> Panel:
        values = {name: figures["models"][name][key] for name in MODELS}
        rows = [(labels[name], 100.0 * value, percent(value)) for name, value in values.items()]
        return panel(axis("%"), axis(""), [bars(rows), *marks], title=title)

    floor = figures["models"]["improved"]["noise_floor"]
    force = f"Force residual on the fresh record, windows of {figures['window']:.2f} s"
    return [
        fall("force_residual", force, [mark(100.0 * floor, f"noise floor {percent(floor)}")]),
        fall("free_run_error", "Free-run error on the fresh record", []),
    ]


def _motion(run, store: Store) -> list[Panel]:
    middle, panels = 0.5 * float(run.time[-1]), []
    time = axis("t, s", shown=(middle - 0.5 * _SHOWN, middle + 0.5 * _SHOWN))
    for index, (name, words) in enumerate(_CHANNELS.items()):
        both = [(words, run.predicted[model][:, index], f"{model}.{name}") for model, words in _DRAWN.items()]
        motion = [line(label, series("t", store.add(own, values))) for label, values, own in both]
        measured = reference("measured", series("t", name))
        panels.append(panel(time, axis(words), [measured, *motion]))
        apart = [(label, run.measured[:, index] - values, f"{own}.apart") for label, values, own in both]
        left = [line(label, series("t", store.add(own, values))) for label, values, own in apart]
        panels.append(panel(time, axis("measured − predicted"), left))
    return panels


def _error(run, store: Store) -> Panel:
    names = {model: store.add(f"{model}.error", error_over_time(run, model)) for model in _DRAWN}
    lines = [line(MODELS[model], series("t", name)) for model, name in names.items()]
    label = axis("free-run error in q ÷ std of q", log=True, shown=store.extent(list(names.values()), _ERRORS))
    return panel(_TIME, label, lines, title="Free-run error over the last second")
