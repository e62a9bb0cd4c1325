"""Traces of a run as the page needs them: thinned, rounded to what can be seen, packed.

All traces of a run share one time grid: even over the record, denser after every switch, so that a switch can be
looked at closely. A trace is stored as float32 with 13 bits of mantissa, its bytes grouped by significance (equal
bytes stand together and compress), and the whole is one zlib stream in base64.
"""

import base64
import zlib

import numpy as np

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
    with np.errstate(over="ignore"):
        stacked = np.ascontiguousarray(np.stack(traces), dtype="<f4")
    bits = stacked.view("<u4")
    rounded = np.where(np.isfinite(stacked), (bits + 0x200) & 0xFFFFFC00, bits).astype("<u4")
    planes = rounded.view(np.uint8).reshape(len(traces), -1, 4).transpose(0, 2, 1)
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode()


class Store:
    """Named traces on one grid; the first is the time `t`."""

    def __init__(self, time: np.ndarray, kept: np.ndarray) -> None:
        self.kept = kept
        self.traces = {"t": time[kept]}

    def add(self, name: str, values: np.ndarray) -> str:
        """Keeps a trace of the whole record under that name, and returns the name."""
        self.traces[name] = values[self.kept]
        return name

    def within(self, start: float, end: float) -> tuple[int, int]:
        """The range of indices of a stretch of time."""
        low, high = np.searchsorted(self.traces["t"], [start, end])
        return int(low), int(high)

    def extent(self, names: list[str], limits: tuple[float, float]) -> tuple[float, float]:
        """Lowest and highest positive value of traces, no further out than the limits: the range of a logarithmic axis."""
        values = np.concatenate([self.traces[name] for name in names])
        shown = np.clip(values[np.isfinite(values) & (values > 0.0)], *limits)
        return (float(0.5 * shown.min()), float(2.0 * shown.max())) if len(shown) else limits

    def packed(self) -> dict:
        """`points` of a trace, `names` in stored order, `data`."""
        return {"points": len(self.kept), "names": list(self.traces), "data": pack(list(self.traces.values()))}
