"""Which law the plant really has, and when: from a file, or from outputs of the plant."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np


class TruthError(ValueError):
    """The truth cannot be used; says what, where, and how to mend it."""


@dataclass(frozen=True)
class Truth:
    """The plant's laws in the order of time."""

    times: list[float]
    """When each law begins, s; the first at the start or before."""
    laws: list[dict[str, float]]
    """Coefficients by the name that outputs give a term (`q_3`); a term that is not there has 0."""

    @property
    def switches(self) -> list[float]:
        """When the law switches, s."""
        return self.times[1:]

    def coefficients(self, stage: int, terms: list[str]) -> np.ndarray:
        """The law of a stage, counted from 0, over these terms."""
        unknown = sorted(set(self.laws[stage]) - set(terms))
        if unknown:
            raise TruthError(f"the truth has {', '.join(unknown)}, which is not among the terms {', '.join(terms)}")
        return np.array([self.laws[stage].get(term, 0.0) for term in terms])

    @classmethod
    def from_file(cls, path: Path) -> "Truth":
        """Reads a CSV file: column t, s, and one for each term; every line is the law from then on."""
        with open(path, newline="") as lines:
            reader = csv.DictReader(lines)
            if "t" not in (reader.fieldnames or []):
                raise TruthError(f"{path}: line 1: there is no column t; begin with t,qdd,qd,q")
            rows = [_numbers(path, number, row) for number, row in enumerate(reader, start=2)]
        if not rows:
            raise TruthError(f"{path}: there is no law; add a line such as 0.0,1.0,0.3,4.0")
        times = [row.pop("t") for row in rows]
        if any(after <= before for before, after in zip(times, times[1:])):
            raise TruthError(f"{path}: t does not increase")
        return cls(times, rows)

    @classmethod
    def from_samples(cls, time: np.ndarray, values: np.ndarray, terms: list[str]) -> "Truth":
        """From what outputs of the plant said at every sample, (n,), (n, k): a law lasts as long as they stay."""
        begins = [0] + [int(index) + 1 for index in np.flatnonzero(np.any(np.diff(values, axis=0) != 0, axis=1))]
        return cls(
            [float(time[index]) for index in begins], [dict(zip(terms, values[index].tolist())) for index in begins]
        )


def _numbers(path: Path, line: int, row: dict[str, str]) -> dict[str, float]:
    try:
        return {name: float(value) for name, value in row.items()}
    except (TypeError, ValueError):
        raise TruthError(f"{path}: line {line}: every column needs a number, found {row}") from None
