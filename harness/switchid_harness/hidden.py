"""Plants with an effect that their model lacks: what is simulated, and what the model may know.

The plant FMU has the law's terms and, as its parameters `hidden.*`, one effect of the catalogue. The model has the law's terms
alone, all to be estimated. `documented` is the set of the README, `drawn` one with parameters and effect from a seed.
"""

from dataclasses import dataclass

import numpy as np

from .laws import DUFFING, Law, in_words

EXCITATION = {
    "excitation.kind": "multisine",
    "excitation.from": 0.5,
    "excitation.to": 8.0,
    "excitation.count": 40,
    "excitation.rms": 1.5,
}
"""Forty sines from 0.5 to 8 rad/s, phases by the seed: through the resonance of all laws below."""

_FRESH = 500_000
"""What the fresh record's seed lies above the first one's."""


@dataclass(frozen=True)
class HiddenEffect:
    """A plant, the effect hidden in it, and how long it is watched."""

    id: str
    title: str
    group: str
    law: Law
    parameters: dict[str, float]
    effect: str
    """Id in the catalogue."""
    coefficient: float
    """On the left-hand side."""
    noise: float
    """Std of the Gaussian noise on q and on q̇."""
    duration: float
    """Length of each of the two records, s."""
    seed: int

    def excitation(self, fresh: bool) -> dict[str, float | int | str]:
        """What drives a plant in the first or in the fresh record, from the same state: the same for plants and models."""
        seed = self.seed + _FRESH if fresh else self.seed
        return EXCITATION | {"seed": seed, "q0": 0.0, "qd0": 0.0}

    def plant_parameters(self, fresh: bool) -> dict[str, float | int | str]:
        """The plant FMU's parameters."""
        law = {f"stage[1].{name}": value for name, value in self.parameters.items()}
        hidden = {f"hidden.{self.effect}": self.coefficient}
        return self.excitation(fresh) | law | hidden | {"noise.q": self.noise, "noise.qd": self.noise}

    def truth(self) -> dict[str, float]:
        """Coefficients of the whole law by FMU term, of the hidden effect by its id where it is no product of powers."""
        hidden = _MONOMIALS.get(self.effect, self.effect)
        return self.law.coefficients(self.parameters) | {hidden: self.coefficient}


_MONOMIALS = {
    "cubic_damping": "qd_3",
    "van_der_pol_damping": "q_2_qd",
    "quadratic_stiffness": "q_2",
    "constant_force": "const",
}


def _scenario(
    group: str, prefix: str, parameters: dict[str, float], effect: str, coefficient: float, seed: int
) -> HiddenEffect:
    return HiddenEffect(
        id=f"{prefix}hidden-effect",
        title=f"Duffing with hidden {in_words(effect)}",
        group=group,
        law=DUFFING,
        parameters=parameters,
        effect=effect,
        coefficient=coefficient,
        noise=0.01,
        duration=30.0,
        seed=seed,
    )


def documented() -> list[HiddenEffect]:
    """The documented one: Coulomb friction of 0.2, about an eighth of the excitation, in a Duffing oscillator."""
    parameters = {"m": 1.0, "c": 0.3, "k1": 4.0, "k3": 2.0}
    return [_scenario("documented", "", parameters, "coulomb_friction", 0.2, seed=1)]


_RANGES = {"m": (0.7, 1.4), "c": (0.2, 0.6), "k1": (3.0, 6.0), "k3": (1.0, 4.0)}
_HIDDEN = {
    "quadratic_damping": (0.15, 0.4),
    "cubic_damping": (0.1, 0.3),
    "van_der_pol_damping": (0.3, 1.0),
    "quadratic_stiffness": (0.8, 2.0),
    "constant_force": (0.2, 0.5),
}
"""No friction: where a draw makes the plant stick, the force residual counts what friction at rest holds."""


def drawn(seed: int) -> list[HiddenEffect]:
    """One with effect, its strength and the law's parameters drawn at random from the seed."""
    generator = np.random.default_rng([seed, 7])
    parameters = {name: round(float(generator.uniform(*bounds)), 3) for name, bounds in _RANGES.items()}
    effect = str(generator.choice(list(_HIDDEN)))
    coefficient = round(float(generator.uniform(*_HIDDEN[effect])), 3)
    group = f"drawn from seed {seed}"
    return [_scenario(group, "drawn-", parameters, effect, coefficient, seed=1000 * seed + 301)]
