"""What FMI Library, on which PyFMI and fmuCheck build, reads in ModelStructure: libcosimpy brings it along."""

import ctypes
from importlib.util import find_spec
from pathlib import Path

from fmpy import extract, read_model_description


def inputs_of_outputs(path: Path) -> dict[str, list[str]] | None:
    """For every output the inputs that it depends on at the same instant; None where FMI Library finds nothing said."""
    folder = extract(str(path))
    variables = read_model_description(folder).modelVariables
    library = _library()
    context = library.fmi_import_allocate_context(library.jm_get_default_callbacks())
    fmu = library.fmi2_import_parse_xml(context, str(folder).encode(), None)
    outputs = library.fmi2_import_get_outputs_list(fmu)
    begins, indices, kinds = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_void_p()
    library.fmi2_import_get_outputs_dependencies(
        fmu, ctypes.byref(begins), ctypes.byref(indices), ctypes.byref(kinds)
    )
    if not begins.value:
        return None
    begin = ctypes.cast(begins, ctypes.POINTER(ctypes.c_size_t))
    index = ctypes.cast(indices, ctypes.POINTER(ctypes.c_size_t))
    inputs = [variable.name for variable in variables if variable.causality == "input"]
    found = {}
    for output in range(library.fmi2_import_get_variable_list_size(outputs)):
        name = library.fmi2_import_get_variable_name(library.fmi2_import_get_variable(outputs, output)).decode()
        on = [index[place] for place in range(begin[output], begin[output + 1])]
        # 0 stands for "on everything"
        names = [variables[place - 1].name for place in on if place]
        found[name] = inputs if 0 in on else [own for own in names if own in inputs]
    return found


def _library() -> ctypes.CDLL:
    package = Path(find_spec("libcosimpy").origin).parent
    library = ctypes.CDLL(str(next(package.rglob("libcosimc.so"))))
    pointer, size = ctypes.c_void_p, ctypes.c_size_t
    types = {
        "jm_get_default_callbacks": (pointer, []),
        "fmi_import_allocate_context": (pointer, [pointer]),
        "fmi2_import_parse_xml": (pointer, [pointer, ctypes.c_char_p, pointer]),
        "fmi2_import_get_outputs_list": (pointer, [pointer]),
        "fmi2_import_get_outputs_dependencies": (None, [pointer] * 4),
        "fmi2_import_get_variable_list_size": (size, [pointer]),
        "fmi2_import_get_variable": (pointer, [pointer, size]),
        "fmi2_import_get_variable_name": (ctypes.c_char_p, [pointer]),
    }
    for name, (result, arguments) in types.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
