"""The two laws of motion of the plants, and the names of their terms.

Terms stand on the left-hand side, the excitation on the right (DESIGN section 2):

    Duffing        m q̈ + c q̇ + k1 q + k3 q³ = F
    van der Pol    L q̈ + alpha (q² − a) q̇ + q/C = V

Terms carry their FMU names: `qdd`, `qd`, `q`, `q_3`, `q_2_qd`, `const`.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

Coefficients = dict[str, float]


@dataclass(frozen=True)
class Law:
    """A law of motion: its plant FMU, its parameters, and what the identifier may assume about it."""

    name: str
    fmu: str
    parameters: tuple[str, ...]
    terms: str
    """FMU parameter `terms` of the identifier; empty = the full cubic library of eq. (11)."""
    coefficients: Callable[[dict[str, float]], Coefficients]
    """Coefficients of the terms from the parameters; terms not named have the coefficient 0."""


def _duffing(p: dict[str, float]) -> Coefficients:
    return {"qdd": p["m"], "qd": p["c"], "q": p["k1"], "q_3": p["k3"]}


def _van_der_pol(p: dict[str, float]) -> Coefficients:
    return {"qdd": p["L"], "qd": -p["alpha"] * p["a"], "q_2_qd": p["alpha"], "q": 1.0 / p["C"]}


DUFFING = Law("Duffing", "Duffing.fmu", ("m", "c", "k1", "k3"), "qdd qd q q^3", _duffing)
VAN_DER_POL = Law("van der Pol", "VanDerPol.fmu", ("L", "alpha", "a", "C"), "", _van_der_pol)


def factors(term: str) -> list[tuple[str, int]]:
    """The factors of a term by base and exponent: `q_2_qd` is [("q", 2), ("qd", 1)], `const` has none."""
    if term == "const":
        return []
    result: list[tuple[str, int]] = []
    for part in term.split("_"):
        if part.isdigit():
            result[-1] = (result[-1][0], int(part))
        else:
            result.append((part, 1))
    return result


def fmu_name(term: str) -> str:
    """The FMU name of a term of the command line: `q_3` of `q^3`, `const` of `1`; ids of effects stay."""
    return "const" if term == "1" else term.replace("^", "_").replace("*", "_")


def is_monomial(term: str) -> bool:
    """Whether the term is a product of powers, not the id of an effect."""
    return all(base in ("q", "qd", "qdd", "F") for base, _ in factors(term))


def in_words(effect: str) -> str:
    """The id of an effect as it is written in a sentence: `Coulomb friction`."""
    words = effect.replace("_", " ")
    for name in ("Coulomb", "Stribeck", "van der Pol"):
        words = words.replace(name.lower(), name)
    return words


def in_order(terms: Iterable[str]) -> list[str]:
    """The terms as laws are written: inertia, then damping, then stiffness, the constant, other effects; low powers first."""

    def rank(term: str) -> tuple:
        powers = dict(factors(term))
        degree = sum(powers.values())
        return (not is_monomial(term), "qdd" not in powers, degree == 0, "qd" not in powers, degree, -powers.get("q", 0))

    return sorted(terms, key=rank)


_SYMBOLS = {"qdd": "q̈", "qd": "q̇"}
_SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def symbol(term: str) -> str:
    """The term as it is written in a law, `q² q̇`; `1` for the constant."""
    written = [
        _SYMBOLS.get(base, base) + (str(n).translate(_SUPERSCRIPTS) if n > 1 else "") for base, n in factors(term)
    ]
    return " ".join(written) or "1"
