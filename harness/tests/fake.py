"""Stand-ins for the FMUs with the interface of `slave.Slave`, so that report and figures can be tested without them.

The plant integrates a scenario's law in Python. The identifier plays back what it is told: alarms at given delays,
coefficients that approach the truth from there on. It is a puppet, no estimator.
"""

import math

import numpy as np

from switchid_harness.scenarios import Scenario
from switchid_harness.stepping import STEP

TERMS = ["const", "q", "qd", "qd_2", "q_2", "q_qd", "qd_3", "q_3", "q_2_qd", "q_qd_2", "qdd"]


class FakePort:
    """Values that are read from, or written to, a dictionary."""

    def __init__(self, state: dict[str, float], names: list[str]):
        self.state, self.names = state, names
        self.values = np.zeros(len(names))

    def read(self) -> np.ndarray:
        self.values[:] = [self.state[name] for name in self.names]
        return self.values

    def write(self, values: np.ndarray) -> None:
        self.state.update(zip(self.names, values))


class FakePlant:
    """The scenario's law, integrated by a semi-implicit Euler step."""

    def __init__(self, scenario: Scenario):
        self.scenario = scenario
        self.random = np.random.default_rng(scenario.seed)
        self.motion = [0.4, 0.0]
        self.state = {}
        self._publish(0.0)

    def port(self, names: list[str]) -> FakePort:
        return FakePort(self.state, names)

    def _stage(self, time: float) -> dict[str, float]:
        return [stage for stage in self.scenario.stages if stage.start <= time + 1e-9][-1].parameters

    def _publish(self, time: float) -> None:
        parameters = self._stage(time)
        if self.scenario.excitation == "white":
            force = self.random.normal() * math.sqrt(self.scenario.intensity / STEP)
        else:
            force = parameters["P"] * math.sin(parameters["omega"] * time)
        noise = self.random.normal(size=2) * self.scenario.noise
        self.state.update(q=self.motion[0] + noise[0], qd=self.motion[1] + noise[1], F=force)

    def step(self, time: float, step: float) -> None:
        law = self.scenario.law.coefficients(self._stage(time))
        q, qd = self.motion
        left = law["qd"] * qd + law["q"] * q + law.get("q_3", 0.0) * q**3 + law.get("q_2_qd", 0.0) * q * q * qd
        qd += step * (self.state["F"] - left) / law["qdd"]
        self.motion = [q + step * qd, qd]
        self._publish(time + step)


class Puppet:
    """Alarms `detection` s after every switch (None: never), then coefficients settle with the given time constant."""

    def __init__(
        self, scenario: Scenario, detection: float | None, settling: float, residue: float, false_alarms: tuple = ()
    ):
        self.scenario, self.settling, self.residue = scenario, settling, residue
        starts = [stage.start for stage in scenario.stages]
        self.known_from = [0.0] + [start + (math.inf if detection is None else detection) for start in starts[1:]]
        self.laws = [scenario.law.coefficients(stage.parameters) for stage in scenario.stages]
        self.false_alarms = false_alarms
        self.state = {f"coef.{term}": 0.0 for term in TERMS} | {f"std.{term}": 1e30 for term in TERMS}
        self.state |= dict.fromkeys(
            ["q", "qd", "F", "switch.time", "switch.count", "prediction.q", "prediction.qd"], 0.0
        )
        self.state |= {"switch.detection_time": 0.0, "deviation": 1e-4, "threshold": 0.05, "status": 1, "valid": 0}

    def port(self, names: list[str]) -> FakePort:
        return FakePort(self.state, names)

    def step(self, time: float, step: float) -> None:
        now = time + step
        known = [i for i, start in enumerate(self.known_from) if start <= now]
        index = known[-1]
        age = now - self.known_from[index]
        self.state["switch.count"] = index + sum(alarm <= now for alarm in self.false_alarms)
        self.state["switch.time"] = self.scenario.stages[index].start
        off = self.residue + math.exp(-age / self.settling)
        for term, value in self.laws[index].items():
            self.state[f"coef.{term}"] = value * (1.0 + off)
            self.state[f"std.{term}"] = abs(value) * off if age > 0.3 else 1e30
        current = [i for i, stage in enumerate(self.scenario.stages) if stage.start <= now][-1]
        wrong = current != index
        self.state["status"] = 3 if wrong else (2 if age > 1.0 else 4 if index else 1)
        self.state["valid"] = int(not wrong and age > 1.0)
        self.state["deviation"] = (0.5 if wrong else 0.0) + 1e-3 * (1.5 + math.sin(3.0 * now)) + math.exp(-3.0 * age)
        self.state["prediction.q"] = self.state["q"] + off * math.sin(now)
        self.state["prediction.qd"] = self.state["qd"] + off * math.cos(now)
