"""Laws and figures typeset for the page, in plain HTML: any font with combining dots shows them well."""

import math
from html import escape

from ..laws import factors, in_order, in_words, is_monomial

_BASES = {"qdd": "q̈", "qd": "q̇"}


def digits(value: float, std: float | None) -> str:
    """`value` ≥ 0 with as many digits as its std supports, three significant ones at least, six at most."""
    if value == 0.0:
        return "0"
    wanted = 4
    if std and value > 0.0:
        wanted = min(max(math.ceil(math.log10(value / std)) + 1, 3), 6)
    exponent = math.floor(math.log10(value))
    if not -4 <= exponent < 6:
        return power(value)
    return f"{value:.{max(wanted - 1 - exponent, 0)}f}"


def power(value: float | None, decimals: int = 1) -> str:
    """`1.0 · 10⁻⁶` for figures that span decades; `–` where there is none."""
    if value is None:
        return "–"
    if value == 0.0:
        return "0"
    if 0.01 <= abs(value) < 1000.0:
        return f"{float(f'{value:.{decimals + 1}g}'):g}".replace("-", "−")
    mantissa, exponent = f"{value:.{decimals}e}".split("e")
    return f"{mantissa} · 10<sup>{int(exponent)}</sup>".replace("-", "−")


def _factor(base: str, exponent: int) -> str:
    raised = f"<sup>{exponent}</sup>" if exponent > 1 else ""
    return f"<i>{_BASES.get(base, base)}</i>{raised}"


def term_markup(term: str) -> str:
    """The term alone; 1 for the constant; an effect by its name."""
    if not is_monomial(term):
        return f'<span class="effect">{escape(in_words(term))}</span>'
    return "\u200a".join(_factor(base, exponent) for base, exponent in factors(term)) or "1"


def equation(coefficients: dict[str, float], std: dict[str, float]) -> str:
    """`1.000 q̈ + 0.300 q̇ + … = F`, inertia first; terms with the coefficient 0 are left out; `no law` without any."""
    if not any(coefficients.values()):
        return "<i>no law</i>"
    parts = []
    for term in in_order(coefficients):
        value = coefficients[term]
        if value == 0.0:
            continue
        sign = "−" if value < 0.0 else "+"
        lead = f"{sign} " if parts else sign.replace("+", "")
        symbol = "" if term == "const" else f"\u2009{term_markup(term)}"
        parts.append(f"<span>{lead}{digits(abs(value), std.get(term))}{symbol}</span>")
    return " ".join([*parts, "<span>= <i>F</i></span>"])
