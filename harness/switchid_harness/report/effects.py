"""Pieces of the page on hidden effects: the table's rows, and for each what was found, its laws and how the errors fell."""

from html import escape

from ..improvement import MODELS
from ..laws import fmu_name, in_words
from ..table import percent
from .equations import equation
from .fragments import gate_table, pill


def effect_row(effect: dict) -> str:
    """One scenario in one row of the table."""
    before, after = (effect["models"][name] for name in MODELS)
    cells = [percent(model["force_residual"]) for model in (before, after)]
    cells += [percent(after["noise_floor"])]
    cells += [percent(model["free_run_error"]) for model in (before, after)]
    name = f"{escape(effect['title'])}<small>{escape(effect['set'])}</small>"
    figures = "".join(f"<td>{cell}</td>" for cell in cells)
    outcome = pill("ok" if effect["passed"] else "FAIL")
    found = f'<td class="left">{escape(named(effect))}</td>'
    return f'<tr><th scope="row">{name}</th>{found}{figures}<td>{outcome}</td></tr>'


def named(effect: dict) -> str:
    """The effect that the diagnosis names, or its verdict where it names none."""
    diagnosis = effect["diagnosis"]
    return in_words(diagnosis["effect"] or diagnosis["verdict"])


def effect_card(effect: dict) -> str:
    """What was found and how the errors fell, with places for the charts."""
    fails = [f"where the model fails: {sentence}" for sentence in effect["fails"][:1]]
    answer = "".join(f"<li>{escape(line)}</li>" for line in [*fails, *effect["diagnosis"]["answer"]])
    return (
        f'<article class="effects-one" data-effect="{escape(effect["id"])}"><h3>{escape(effect["title"])}'
        f"<small>{escape(effect['set'])}</small></h3>"
        f'<div class="card found"><h4>What the command line says of the first record</h4><ul>{answer}</ul></div>'
        f'<div class="card">{_laws(effect)}</div><div class="falls"></div>'
        f'<div class="motion"></div><div class="error"></div>{gate_table(effect)}</article>'
    )


def _laws(effect: dict) -> str:
    rows = [("truth", "truth", equation(effect["truth"], {}))]
    for name, kind in (("refitted", "publication"), ("improved", "default")):
        model = effect["models"][name]
        laws = [{fmu_name(term): value for term, value in model[key].items()} for key in ("coefficients", "std")]
        rows.append((kind, MODELS[name], equation(*laws)))
    lines = "".join(f'<div class="law {kind}"><span>{words}</span><div>{law}</div></div>' for kind, words, law in rows)
    return f"<h4>Laws</h4>{lines}"
