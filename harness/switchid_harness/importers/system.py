"""A plant and an identifier as one .ssp file (System Structure and Parameterization 1.0)."""

import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

from .case import WATCHED, WIRES, Case, Fmus

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"'
    ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"'
    ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" name="switchid" version="1.0">\n'
)


def write_ssp(fmus: Fmus, case: Case, path: Path) -> Path:
    """Writes the case as a system, each plant wired to its identifier, parameters inside."""
    parts, wires = [], []
    for pair in range(case.pairs):
        reals = {name: ("Real", repr(value)) for name, value in case.plant.items()}
        parts.append(
            _component(f"plant{pair}", fmus.plant, WIRES, "output", reals | {"seed": ("Integer", str(case.seed(pair)))})
        )
        model = {"model": ("Integer", str(case.law))}
        parts.append(_component(f"identifier{pair}", fmus.identifier, WIRES, "input", model, outputs=WATCHED))
        wires += [
            f'      <ssd:Connection startElement="plant{pair}" startConnector="{name}"'
            f' endElement="identifier{pair}" endConnector="{name}"/>\n'
            for name in WIRES
        ]
    text = (
        f'{_HEAD}  <ssd:System name="system">\n    <ssd:Elements>\n{"".join(parts)}    </ssd:Elements>\n'
        f"    <ssd:Connections>\n{''.join(wires)}    </ssd:Connections>\n  </ssd:System>\n"
        f'  <ssd:DefaultExperiment startTime="{case.start!r}" stopTime="{case.start + sum(case.steps)!r}"/>\n'
        "</ssd:SystemStructureDescription>\n"
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("SystemStructure.ssd", text)
        for fmu in (fmus.plant, fmus.identifier):
            archive.write(fmu, f"resources/{fmu.name}")
    return path


def _component(name: str, fmu: Path, wires: list[str], kind: str, parameters: dict, outputs: list[str] = ()) -> str:
    connectors = [(wire, kind) for wire in wires] + [(output, "output") for output in outputs]
    listed = "".join(
        f'          <ssd:Connector name="{own}" kind="{direction}"><ssc:Real/></ssd:Connector>\n'
        for own, direction in connectors
    )
    values = "".join(
        f'<ssv:Parameter name={quoteattr(own)}><ssv:{kind} value="{value}"/></ssv:Parameter>'
        for own, (kind, value) in parameters.items()
    )
    return (
        f'      <ssd:Component name="{name}" type="application/x-fmu-sharedlibrary" source="resources/{fmu.name}"'
        f' implementation="CoSimulation">\n'
        f"        <ssd:Connectors>\n{listed}        </ssd:Connectors>\n"
        "        <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
        f'<ssv:ParameterSet version="1.0" name="{name}"><ssv:Parameters>{values}</ssv:Parameters></ssv:ParameterSet>'
        "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>\n"
        "      </ssd:Component>\n"
    )
