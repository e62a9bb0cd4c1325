"""The figures of DESIGN section 7, each defined once.

Arrays run over samples (length n) and terms (length k). `time[i]` is the instant at which the outputs of step i hold.
"""

from dataclasses import dataclass

import numpy as np

LEVEL = 0.05**2
"""The coefficient error below which a law counts as known."""


def coefficient_error(coefficients: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """e of eq. (8), sum (theta − theta*)² ÷ sum theta*²; absent terms have truth 0. (n, k), (k,) → (n,)."""
    difference = coefficients - truth
    return np.sum(difference * difference, axis=-1) / np.sum(truth * truth)


def alarm_times(count: np.ndarray, time: np.ndarray) -> list[float]:
    """The instants at which the count of switches rose, one entry per count."""
    rises = np.diff(count, prepend=0)
    return [float(time[i]) for i in np.flatnonzero(rises > 0) for _ in range(int(rises[i]))]


@dataclass(frozen=True)
class Detections:
    """What became of every switch and alarm."""

    times: list[float | None]
    """Per switch, the alarm that detected it; None where it was missed."""
    false_alarms: list[float]

    @property
    def missed(self) -> int:
        """How many switches were missed."""
        return sum(time is None for time in self.times)


def detections(alarms: list[float], switches: list[float]) -> Detections:
    """The first alarm after a switch and before the next detects it; every other alarm is false."""
    bounds = switches + [np.inf]
    within = [[a for a in alarms if begin < a <= end] for begin, end in zip(bounds, bounds[1:])]
    before_first = [a for a in alarms if a <= bounds[0]]
    return Detections([w[0] if w else None for w in within], before_first + [a for w in within for a in w[1:]])


def tracking_delay(error: np.ndarray, time: np.ndarray, start: float, end: float) -> float | None:
    """Time from `start` until e stays below LEVEL until `end`; None when it is not below at the end."""
    stage = (time > start) & (time <= end)
    above = np.flatnonzero(~(error[stage] < LEVEL))
    instants = time[stage]
    if instants.size == 0 or (above.size and above[-1] == instants.size - 1):
        return None
    return float(instants[above[-1] + 1] - start) if above.size else 0.0
