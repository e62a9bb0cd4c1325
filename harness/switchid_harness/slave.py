"""One instance of a co-simulation FMU, stepped through fmpy's low-level interface.

Values pass through arrays that are made once: a step costs a few microseconds, not a search for names.
"""

import shutil
from ctypes import c_double, c_int, c_uint
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave


class UnknownVariable(KeyError):
    """The FMU has no variable of that name."""


class Fmu:
    """An unpacked .fmu file."""

    def __init__(self, path: Path, directory: Path):
        """Unpacks `path` into `directory`, which is emptied before."""
        shutil.rmtree(directory, ignore_errors=True)
        extract(str(path), unzipdir=str(directory))
        self.name = Path(path).name
        self.directory = directory.resolve()
        self.description = read_model_description(str(directory), validate=False)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}

    def variable(self, name: str):
        """The variable of that name."""
        if name not in self.variables:
            raise UnknownVariable(f"{self.name} has no variable {name}")
        return self.variables[name]

    def names(self, prefix: str) -> list[str]:
        """Names of the variables that begin with `prefix`, without it, in the order of the description."""
        return [name.removeprefix(prefix) for name in self.variables if name.startswith(prefix)]


class Port:
    """Several variables of one type that are read or written at once; `values` is the array in between."""

    def __init__(self, slave: FMU2Slave, references: list[int], kind: str):
        c_type, dtype = (c_double, np.float64) if kind == "Real" else (c_int, np.int32)
        self._buffer = (c_type * len(references))()
        self.values = np.frombuffer(self._buffer, dtype=dtype)
        self._arguments = (slave.component, (c_uint * len(references))(*references), len(references), self._buffer)
        self._get = getattr(slave, f"fmi2Get{kind}")
        self._set = getattr(slave, f"fmi2Set{kind}")

    def read(self) -> np.ndarray:
        """Reads the variables; the array is overwritten by the next read."""
        self._get(*self._arguments)
        return self.values

    def write(self, values: np.ndarray) -> None:
        """Writes the variables."""
        self.values[:] = values
        self._set(*self._arguments)


class Slave:
    """An instance, initialised and ready to step."""

    def __init__(self, fmu: Fmu, name: str, parameters: dict[str, float | int | str]):
        """Instantiates, sets the parameters (enumerations by the name of their item) and initialises at time 0."""
        self.fmu = fmu
        self.slave = FMU2Slave(
            guid=fmu.description.guid,
            unzipDirectory=str(fmu.directory),
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        for variable, value in parameters.items():
            self._set(variable, value)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def _set(self, name: str, value: float | int | str) -> None:
        variable = self.fmu.variable(name)
        reference = [variable.valueReference]
        match variable.type:
            case "Real":
                self.slave.setReal(reference, [float(value)])
            case "Enumeration":
                items = {item.name: int(item.value) for item in variable.declaredType.items}
                self.slave.setInteger(reference, [items[value] if isinstance(value, str) else value])
            case "Integer":
                self.slave.setInteger(reference, [int(value)])
            case "Boolean":
                self.slave.setBoolean(reference, [bool(value)])
            case _:
                self.slave.setString(reference, [str(value)])

    def port(self, names: list[str]) -> Port:
        """A port over variables of one type (enumerations count as integers)."""
        variables = [self.fmu.variable(name) for name in names]
        kind = variables[0].type
        kind = "Integer" if kind == "Enumeration" else kind
        return Port(self.slave, [variable.valueReference for variable in variables], kind)

    def step(self, time: float, step: float) -> None:
        """One communication step from `time` to `time + step`, s."""
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=step)

    def close(self) -> None:
        """Ends the instance."""
        self.slave.terminate()
        self.slave.freeInstance()
