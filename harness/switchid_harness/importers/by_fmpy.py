"""fmpy: a loop of our own over its slaves, and its simulation of an SSP system."""

import shutil
from pathlib import Path
from types import SimpleNamespace

from fmpy import extract, instantiate_fmu, read_model_description
from fmpy.ssp.simulation import simulate_ssp

from .case import WATCHED, WIRES, CannotDo, Case, Fmus
from .system import write_ssp


class _Slave:
    def __init__(self, path: Path):
        self.directory = extract(str(path))
        description = read_model_description(self.directory)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.fmu = instantiate_fmu(self.directory, description, fmi_type="CoSimulation")

    def begin(self, start: float, reals: dict[str, float], integers: dict[str, int]) -> None:
        self.fmu.setupExperiment(startTime=start)
        self.fmu.setReal([self.references[name] for name in reals], list(reals.values()))
        self.fmu.setInteger([self.references[name] for name in integers], list(integers.values()))
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def get(self, names: list[str]) -> list[float]:
        return self.fmu.getReal([self.references[name] for name in names])

    def set(self, names: list[str], values: list[float]) -> None:
        self.fmu.setReal([self.references[name] for name in names], values)

    def end(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.directory, ignore_errors=True)


CLOCKS = {
    "product": lambda start, step, number, before: start + (number + 1) * step,
    "sum": lambda start, step, number, before: before + step,
    "nanoseconds": lambda start, step, number, before: round((start + (number + 1) * step) * 1e9) * 1e-9,
}
"""How an importer comes to the time of its next step: the last bits differ, and with them the last digits of a law."""


def loop(fmus: Fmus, case: Case, clock: str = "product", blind: bool = False) -> list[float]:
    """The reference: all outputs after the last step; `blind` leaves the first inputs at 0."""
    pairs = [(_Slave(fmus.plant), _Slave(fmus.identifier)) for _ in range(case.pairs)]
    values = _run(pairs, case, clock, blind)
    if case.rerun:
        for slave in sum(pairs, ()):
            slave.fmu.reset()
        values = _run(pairs, case, clock, blind)
    for slave in sum(pairs, ()):
        slave.end()
    return values


def _run(pairs: list[tuple[_Slave, _Slave]], case: Case, clock: str, blind: bool) -> list[float]:
    for pair, (plant, identifier) in enumerate(pairs):
        plant.begin(case.start, case.plant, {"seed": case.seed(pair)})
        identifier.begin(case.start, {}, {"model": case.law})
    time = case.start
    for number, step in enumerate(case.steps):
        for plant, identifier in pairs:
            if number > 0 or not blind:
                identifier.set(WIRES, plant.get(WIRES))
        for slave in sum(pairs, ()):
            slave.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)
        time = CLOCKS[clock](case.start, step, number, time) if case.step else time + step
    return sum((plant.get(WIRES) + identifier.get(WATCHED) for plant, identifier in pairs), [])


def ssp(fmus: Fmus, case: Case, folder: Path) -> list[float]:
    """The same as a system that fmpy reads from an .ssp file. Its connectors are 0 until the first step is over."""
    if case.step is None or case.rerun or case.start:
        raise CannotDo("fixed steps from 0, once")
    path = write_ssp(fmus, case, folder / "system.ssp")
    parameters = []
    for pair in range(case.pairs):
        values = {f"plant{pair}.{name}": value for name, value in case.plant.items()}
        values |= {f"plant{pair}.seed": case.seed(pair), f"identifier{pair}.model": case.law}
        parameters += [SimpleNamespace(name=name, value=value) for name, value in values.items()]
    stop = case.step * (len(case.steps) - 0.5)
    result = simulate_ssp(
        str(path), stop_time=stop, step_size=case.step, parameter_set=SimpleNamespace(parameters=parameters)
    )
    parts = [
        (f"{part}{pair}", own)
        for pair in range(case.pairs)
        for part, own in (("plant", WIRES), ("identifier", WATCHED))
    ]
    return [float(result[-1][f"{part}.{name}"]) for part, own in parts for name in own]
