"""The plant in model exchange: fmpy's CVode integrates it, beside the same in co-simulation."""

import numpy as np
from fmpy import simulate_fmu

from .case import Fmus

DURATION, STEP = 3.0, 1e-3
CASES = {"no excitation": 1, "sine": 2, "input": 6}
"""Numbers of `excitation.kind`; a switch falls between two steps."""
START = {"stage[2].time": 1.2505, "stage[2].k3": 4.0, "q0": 0.8}


def distances(fmus: Fmus) -> dict[str, float]:
    """Largest difference of the displacement between both, for each excitation; amplitudes are about 1."""
    return {name: _distance(fmus, kind) for name, kind in CASES.items()}


def _distance(fmus: Fmus, kind: int) -> float:
    time = np.arange(0.0, DURATION + STEP / 2, STEP)
    force = np.zeros(len(time), dtype=[("time", float), ("excitation.F", float)])
    force["time"], force["excitation.F"] = time, 2.0 * np.sin(1.5 * time)
    arguments = {
        "stop_time": DURATION,
        "output_interval": STEP,
        "start_values": START | {"excitation.kind": kind},
        "input": force,
        "output": ["true.q"],
    }
    slave = simulate_fmu(str(fmus.plant), fmi_type="CoSimulation", **arguments)
    solver = {"solver": "CVode", "relative_tolerance": 1e-9, "record_events": False}
    solved = simulate_fmu(str(fmus.plant), fmi_type="ModelExchange", **solver, **arguments)
    return float(np.abs(np.interp(slave["time"], solved["time"], solved["true.q"]) - slave["true.q"]).max())
