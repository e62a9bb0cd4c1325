"""Plants of models beside the plant they describe: same excitation, same state at the start, then nothing in common."""

from dataclasses import dataclass

import numpy as np

from .stepping import INPUTS, RATE, STEP

_OBSERVED = [*INPUTS, "true.q", "true.qd"]


@dataclass
class FreeRun:
    """What plant and models put out at every sample."""

    time: np.ndarray
    """(n,), s."""
    measured: np.ndarray
    """(n, 3): q, q̇, F with sensor noise."""
    truth: np.ndarray
    """(n, 2): q, q̇ without noise."""
    predicted: dict[str, np.ndarray]
    """(n, 3) by model: q, q̇, F."""


def run_free(plant, models: dict[str, object], duration: float) -> FreeRun:
    """Steps the plant and all models from 0 to `duration` (s). Each has the interface of `slave.Slave`."""
    samples = round(duration * RATE)
    time = np.arange(samples) / RATE
    ports = {name: model.port(INPUTS) for name, model in models.items()}
    predicted = {name: np.empty((samples, len(INPUTS))) for name in models}
    observed, output = np.empty((samples, len(_OBSERVED))), plant.port(_OBSERVED)
    for index, now in enumerate(time.tolist()):
        observed[index] = output.read()
        for name, port in ports.items():
            predicted[name][index] = port.read()
        for slave in (plant, *models.values()):
            slave.step(now, STEP)
    return FreeRun(time, observed[:, :3], observed[:, 3:], predicted)


def free_run_error(run: FreeRun, name: str) -> float:
    """RMS of a model's error in q ÷ std of the true q over the whole record."""
    q = run.truth[:, 0]
    return float(np.sqrt(np.mean((run.predicted[name][:, 0] - q) ** 2)) / np.std(q))


def error_over_time(run: FreeRun, name: str, span: float = 1.0) -> np.ndarray:
    """The same with the RMS over the last `span` seconds, (n,)."""
    q = run.truth[:, 0]
    total = np.concatenate([[0.0], np.cumsum((run.predicted[name][:, 0] - q) ** 2)])
    end = np.arange(1, len(total))
    begin = np.maximum(end - round(span * RATE), 0)
    return np.sqrt(np.maximum(total[end] - total[begin], 0.0) / (end - begin)) / np.std(q)
