"""ecospy, the Python package of the Ecos co-simulation engine."""

from pathlib import Path

from .case import WATCHED, WIRES, CannotDo, Case, Fmus


def simulate(fmus: Fmus, case: Case, _: Path) -> list[float]:
    """Outputs of every plant and identifier after the last step."""
    from ecospy import EcosSimulation, EcosSimulationStructure

    if case.step is None:
        raise CannotDo("fixed steps")
    if case.start:
        raise CannotDo("a start at 0 (it tells FMUs of another one, but steps from 0)")
    with EcosSimulationStructure() as structure:
        for pair in range(case.pairs):
            structure.add_model(f"plant{pair}", str(fmus.plant))
            structure.add_model(f"identifier{pair}", str(fmus.identifier))
            for name in WIRES:
                structure.make_real_connection(f"plant{pair}::{name}", f"identifier{pair}::{name}")
        values = {f"plant{pair}::{name}": value for pair in range(case.pairs) for name, value in case.plant.items()}
        values |= {f"plant{pair}::seed": case.seed(pair) for pair in range(case.pairs)}
        # it does not set enumerations, so that the law is chosen by its terms
        values |= {f"identifier{pair}::terms": case.terms for pair in range(case.pairs)}
        structure.add_parameter_set("case", values)
        with EcosSimulation(structure=structure, step_size=case.step) as simulation:
            simulation.init(start_time=case.start, parameter_set="case")
            simulation.step(len(case.steps))
            if case.rerun:
                simulation.reset()
                simulation.init(start_time=case.start, parameter_set="case")
                simulation.step(len(case.steps))
            return [
                simulation.get_real(f"{part}{pair}::{name}")
                for pair in range(case.pairs)
                for part, own in (("plant", WIRES), ("identifier", WATCHED))
                for name in own
            ]
