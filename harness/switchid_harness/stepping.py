"""Plant and identifiers stepped together: the identifier's inputs at t are the plant's outputs at t.

Works on anything with the interface of `slave.Slave` (`port`, `step`), so that the tests can put in their own.
"""

from dataclasses import dataclass

import numpy as np

RATE = 1000
"""Communication steps per second."""
STEP = 1.0 / RATE
"""Communication step, s."""

INPUTS = ["q", "qd", "F"]
_REALS = ["switch.time", "switch.detection_time", "deviation", "threshold", "prediction.q", "prediction.qd"]


@dataclass
class Track:
    """What one identifier put out, sample by sample."""

    terms: list[str]
    coefficients: np.ndarray
    """(n, k)."""
    std: np.ndarray
    """(n, k); 1e30 while unknown."""
    outputs: dict[str, np.ndarray]
    """Every other output by name, (n,)."""


@dataclass
class Record:
    """What plant and identifiers put out. Sample i was taken at `sampled[i]`, its outputs hold at `time[i]`."""

    sampled: np.ndarray
    time: np.ndarray
    observed: np.ndarray
    """(n, 3): q, q̇, F."""
    tracks: dict[str, Track]


class _Tap:
    """Reads the outputs of one identifier into arrays."""

    def __init__(self, identifier, terms: list[str], samples: int):
        names = [f"coef.{term}" for term in terms] + [f"std.{term}" for term in terms] + _REALS
        self.identifier = identifier
        self.terms = terms
        self.input = identifier.port(INPUTS)
        self.ports = [identifier.port(names), identifier.port(["switch.count", "status"]), identifier.port(["valid"])]
        self.arrays = [np.empty((samples, len(port.values))) for port in self.ports]

    def take(self, index: int, time: float, sample: np.ndarray) -> None:
        self.input.write(sample)
        self.identifier.step(time, STEP)
        for port, array in zip(self.ports, self.arrays):
            array[index] = port.read()

    def track(self) -> Track:
        reals, integers, valid = self.arrays
        count = len(self.terms)
        outputs = {name: reals[:, 2 * count + i] for i, name in enumerate(_REALS)}
        outputs |= {"switch.count": integers[:, 0], "status": integers[:, 1], "valid": valid[:, 0]}
        return Track(self.terms, reals[:, :count], reals[:, count : 2 * count], outputs)


def step_together(plant, identifiers: dict[str, object], terms: list[str], end: float) -> Record:
    """Steps the plant and every identifier from 0 to `end` (s) and records all outputs."""
    samples = round(end * RATE)
    sampled = np.arange(samples) / RATE
    observed = np.empty((samples, len(INPUTS)))
    output = plant.port(INPUTS)
    taps = {name: _Tap(identifier, terms, samples) for name, identifier in identifiers.items()}
    for index, time in enumerate(sampled.tolist()):
        observed[index] = output.read()
        for tap in taps.values():
            tap.take(index, time, observed[index])
        plant.step(time, STEP)
    return Record(
        sampled, np.arange(1, samples + 1) / RATE, observed, {name: tap.track() for name, tap in taps.items()}
    )
