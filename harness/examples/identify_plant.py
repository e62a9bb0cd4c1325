"""Steps a plant FMU and the identifier together and prints the law: python identify_plant.py target/fmu [SECONDS]"""

import sys

from fmpy import extract, instantiate_fmu, read_model_description


def load(path):
    description, directory = read_model_description(path), extract(path)
    slave = instantiate_fmu(directory, description, fmi_type="CoSimulation")
    slave.setupExperiment(startTime=0.0)
    return slave, {variable.name: variable.valueReference for variable in description.modelVariables}


plant, out = load(sys.argv[1] + "/Duffing.fmu")
identifier, ref = load(sys.argv[1] + "/SwitchedIdentifier.fmu")
plant.setReal([out["noise.q"], out["noise.qd"]], [0.01, 0.01])
identifier.setString([ref["terms"]], ["qdd qd q q^3"])
for slave in (plant, identifier):
    slave.enterInitializationMode()
    slave.exitInitializationMode()
for step in range(1000 * int(sys.argv[2] if len(sys.argv) > 2 else 12)):
    identifier.setReal(
        [ref[name] for name in ("q", "qd", "F")], plant.getReal([out[name] for name in ("q", "qd", "F")])
    )
    for slave in (identifier, plant):
        slave.doStep(currentCommunicationPoint=step / 1000, communicationStepSize=0.001)
for name in ("qdd", "qd", "q", "q_3"):
    print(name, *identifier.getReal([ref["coef." + name], ref["std." + name]]))
