"""Traces of a run as the page needs them: thinned, rounded to what can be seen, packed.

All traces of a run share one time grid: even over the record, denser after every switch, so that a switch can be
looked at closely. A trace is stored as float32 with 13 bits of mantissa, its bytes grouped by significance (equal
bytes stand together and compress), and the whole is one zlib stream in base64.
"""

import base64
import zlib

import numpy as np

from ..free_run import error_over_time
from ..improvement import Improvement
from ..laws import in_order
from ..run import UNKNOWN_STD, Run
from ..stepping import Track

_EVEN_POINTS = 2400
_DENSE_STRIDE = 5
_DENSE_BEFORE, _DENSE_AFTER = 250, 1500


def grid(samples: int, switches: list[int]) -> np.ndarray:
    """Indices of the samples that are kept."""
    even = np.linspace(0, samples - 1, min(samples, _EVEN_POINTS)).astype(int)
    dense = [np.arange(s - _DENSE_BEFORE, s + _DENSE_AFTER, _DENSE_STRIDE) for s in switches]
    chosen = np.unique(np.concatenate([even, *dense]))
    return chosen[(chosen >= 0) & (chosen < samples)]


def pack(traces: list[np.ndarray]) -> str:
    """Traces of one length as a base64 zlib stream."""
    stacked = np.ascontiguousarray(np.stack(traces), dtype="<f4")
    bits = stacked.view("<u4")
    rounded = np.where(np.isfinite(stacked), (bits + 0x200) & 0xFFFFFC00, bits).astype("<u4")
    planes = rounded.view(np.uint8).reshape(len(traces), -1, 4).transpose(0, 2, 1)
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode()


def _spans(status: np.ndarray, time: np.ndarray) -> list[list[float]]:
    """Runs of equal status: [start, end, status]."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(status)) + 1])
    ends = np.concatenate([starts[1:], [len(status) - 1]])
    return [[round(float(time[a]), 3), round(float(time[b]), 3), int(status[a])] for a, b in zip(starts, ends)]


def _shown_terms(run: Run) -> list[str]:
    """Terms that some stage has, or that a method believed in."""
    used = {term for stage in run.figures["stages"] for term in stage["coefficients"]}
    for track in run.record.tracks.values():
        used |= {term for i, term in enumerate(track.terms) if np.any(track.coefficients[:, i] != 0.0)}
    return in_order(used)


def _method_traces(track: Track, error: np.ndarray, terms: list[str], method: str, kept: np.ndarray) -> dict:
    traces = {f"{method}.e": error[kept]}
    for name in ("deviation", "threshold"):
        traces[f"{method}.{name}"] = track.outputs[name][kept]
    has_law = np.any(track.coefficients[kept] != 0.0, axis=1)
    for name in ("prediction.q", "prediction.qd"):
        traces[f"{method}.{name}"] = np.where(has_law, track.outputs[name][kept], np.nan)
    for term in terms:
        index = track.terms.index(term)
        traces[f"{method}.coef.{term}"] = track.coefficients[kept, index]
        std = track.std[kept, index]
        traces[f"{method}.std.{term}"] = np.where(std < UNKNOWN_STD, std, np.nan)
    return traces


def improvement_traces(improvement: Improvement) -> dict:
    """Packed traces of a fresh record: `points`, `names` in stored order, `data`. `<model>.error` is over the last second."""
    run = improvement.run
    kept = grid(len(run.time), [])
    traces = {"t": run.time[kept]}
    traces |= {name: run.measured[kept, i] for i, name in enumerate(("q", "qd", "F"))}
    for model, motion in run.predicted.items():
        traces |= {f"{model}.{name}": motion[kept, i] for i, name in enumerate(("q", "qd"))}
        traces[f"{model}.error"] = error_over_time(run, model)[kept]
    return {"points": len(kept), "names": list(traces), "data": pack(list(traces.values()))}


def run_traces(run: Run) -> dict:
    """Packed traces: `points`, `names` in stored order, `data`; `terms` shown; `status` spans by method."""
    record = run.record
    switches = [round(stage.start / (record.time[1] - record.time[0])) for stage in run.scenario.stages[1:]]
    kept = grid(len(record.time), switches)
    terms = _shown_terms(run)
    traces = {"t": record.sampled[kept]}
    traces |= {name: record.observed[kept, i] for i, name in enumerate(("q", "qd", "F"))}
    for method, track in record.tracks.items():
        traces |= _method_traces(track, run.errors[method], terms, method, kept)
    status = {method: _spans(track.outputs["status"], record.time) for method, track in record.tracks.items()}
    with np.errstate(over="ignore"):
        data = pack(list(traces.values()))
    return {"points": len(kept), "names": list(traces), "terms": terms, "status": status, "data": data}
