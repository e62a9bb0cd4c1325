"""libcosimpy, the Python package of the Open Simulation Platform's libcosim."""

from pathlib import Path

from .case import WATCHED, WIRES, CannotDo, Case, Fmus


def simulate(fmus: Fmus, case: Case, _: Path) -> list[float]:
    """Outputs of every plant and identifier after the last step."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    if case.step is None or case.start or case.rerun:
        raise CannotDo("fixed steps from 0, once")
    execution = CosimExecution.from_step_size(step_size=round(case.step * 1e9))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    parts = []
    for pair in range(case.pairs):
        slaves = [
            _add(execution, CosimLocalSlave, path, f"{part}{pair}")
            for part, path in (("plant", fmus.plant), ("identifier", fmus.identifier))
        ]
        (plant, of_plant), (identifier, of_identifier) = slaves
        for name, value in case.plant.items():
            execution.real_initial_value(slave_index=plant, variable_reference=of_plant[name], value=value)
        execution.integer_initial_value(slave_index=plant, variable_reference=of_plant["seed"], value=case.seed(pair))
        # it passes over enumerations, so that the law is chosen by its terms
        execution.string_initial_value(
            slave_index=identifier, variable_reference=of_identifier["terms"], value=case.terms
        )
        for name in WIRES:
            execution.connect_real_variables(
                output_slave_index=plant,
                output_variable_reference=of_plant[name],
                input_slave_index=identifier,
                input_variable_reference=of_identifier[name],
            )
        parts += [(plant, [of_plant[name] for name in WIRES]), (identifier, [of_identifier[name] for name in WATCHED])]
    execution.step(step_count=len(case.steps))
    return [
        value
        for slave, references in parts
        for value in observer.last_real_values(slave_index=slave, variable_references=references)
    ]


def _add(execution, kind, path: Path, name: str) -> tuple[int, dict[str, int]]:
    index = execution.add_local_slave(local_slave=kind(fmu_path=str(path), instance_name=name))
    variables = execution.slave_variables(slave_index=index)
    return index, {own.name.decode(): own.reference for own in variables}
