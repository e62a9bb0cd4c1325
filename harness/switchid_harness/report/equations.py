"""Laws typeset as MathML."""

import math

from ..laws import factors

_DOTS = {"qdd": "¨", "qd": "˙"}


def digits(value: float, std: float | None) -> str:
    """`value` ≥ 0 with as many digits as its std supports, three significant ones at least."""
    wanted = 4
    if std and value > 0.0:
        wanted = min(max(math.ceil(math.log10(value / std)) + 1, 3), 6)
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(value))
    if not -4 <= exponent < 6:
        return f"{value:.2e}"
    return f"{value:.{max(wanted - 1 - exponent, 0)}f}"


def _number(text: str) -> str:
    if "e" not in text:
        return f"<mn>{text}</mn>"
    mantissa, exponent = text.split("e")
    return f"<mn>{mantissa}</mn><mo>·</mo><msup><mn>10</mn><mn>{int(exponent)}</mn></msup>".replace("<mn>-", "<mn>−")


def _factor(base: str, exponent: int) -> str:
    dots = _DOTS.get(base)
    body = f'<mover accent="true"><mi>q</mi><mo>{dots}</mo></mover>' if dots else f"<mi>{base}</mi>"
    return body if exponent == 1 else f"<msup>{body}<mn>{exponent}</mn></msup>"


def _term(term: str) -> str:
    return '<mspace width="0.12em"/>'.join(_factor(base, exponent) for base, exponent in factors(term))


def term_markup(term: str) -> str:
    """The term alone; 1 for the constant."""
    return f"<math>{_term(term) or '<mn>1</mn>'}</math>"


def equation(coefficients: dict[str, float], std: dict[str, float]) -> str:
    """`1.000 q̈ + 0.300 q̇ + … = F`; terms with the coefficient 0 are left out."""
    parts = []
    for term, value in coefficients.items():
        if value == 0.0:
            continue
        sign = "−" if value < 0.0 else ("+" if parts else "")
        form = "" if parts or not sign else ' form="prefix"'
        operator = f"<mo{form}>{sign}</mo>" if sign else ""
        parts.append(f'<mrow>{operator}{_number(digits(abs(value), std.get(term)))}<mspace width="0.17em"/>{_term(term)}</mrow>')
    left = "".join(parts) or "<mn>0</mn>"
    return f"<math>{left}<mrow><mo>=</mo><mi>F</mi></mrow></math>"
