"""What is simulated: schedules of laws and excitations, sensor noise, and the floors each run must keep.

The publication's values sit in figures that are not at hand. Those below are plausible ones: Duffing around
m = 1, c = 0.3, k1 = 4, k3 = 2, F = 2 sin 1.5 t; van der Pol around L = C = 1, alpha = 0.3 … 1.2, V = 1.2 sin 1.1 t with
a > 0 (limit cycle) and a < 0 (focus) in turn. Under white noise the intensity is 2D = 3.0 for Duffing, 1.0 for
van der Pol. `drawn` gives a second set from a seed.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from .laws import DUFFING, VAN_DER_POL, Law

SENSOR_NOISE = 0.01
MAX_E_WITHOUT_NOISE = 1e-6


@dataclass(frozen=True)
class Stage:
    """One law with one excitation, from `start` (s) on; the sine's `P` and `omega` (rad/s) are parameters too."""

    start: float
    parameters: dict[str, float]


@dataclass(frozen=True)
class Floors:
    """The largest figures with which a run passes; None is not gated."""

    e: float | None = None
    tracking_delay: float | None = None


@dataclass(frozen=True)
class Scenario:
    """A run of plant and identifier together."""

    id: str
    title: str
    group: str
    law: Law
    excitation: str
    """`sine` or `white`."""
    stages: tuple[Stage, ...]
    end: float
    intensity: float = 0.0
    """2D of the white noise."""
    noise: float = 0.0
    """Std of the Gaussian noise on q and on q̇."""
    seed: int = 1
    floors: Floors = field(default_factory=Floors)

    def bounds(self) -> list[tuple[float, float]]:
        """Start and end of every stage, s."""
        starts = [stage.start for stage in self.stages]
        return list(zip(starts, starts[1:] + [self.end]))


_DUFFING_NAMES = ("m", "c", "k1", "k3", "P", "omega")
_DUFFING_SINE = [
    (1.0, 0.30, 4.0, 2.0, 2.0, 1.5),
    (1.0, 0.60, 5.0, 4.0, 2.0, 1.5),
    (1.4, 0.40, 3.0, 1.5, 2.6, 1.2),
    (0.8, 0.20, 6.0, 3.0, 1.6, 2.0),
    (1.2, 0.50, 4.5, 2.5, 2.4, 1.7),
]
_DUFFING_WHITE = [
    (1.0, 0.30, 4.0, 2.0, 0.0, 0.0),
    (1.2, 0.50, 5.0, 3.0, 0.0, 0.0),
    (0.9, 0.20, 3.0, 4.0, 0.0, 0.0),
    (1.1, 0.70, 6.0, 1.5, 0.0, 0.0),
    (1.0, 0.40, 4.5, 2.5, 0.0, 0.0),
]
_VAN_DER_POL_NAMES = ("L", "alpha", "a", "C", "P", "omega")
_VAN_DER_POL_SINE = [
    (1.0, 0.6, 1.0, 1.00, 1.2, 1.1),
    (1.2, 0.9, -0.5, 0.80, 1.2, 1.1),
    (0.9, 1.2, 1.0, 1.25, 1.5, 1.3),
    (1.1, 0.4, -0.5, 1.00, 1.0, 0.9),
    (1.0, 0.8, 1.2, 0.90, 1.3, 1.2),
]
_VAN_DER_POL_WHITE = [
    (1.0, 0.5, 1.0, 1.00, 0.0, 0.0),
    (1.2, 0.8, -0.5, 0.80, 0.0, 0.0),
    (0.9, 1.1, 0.9, 1.20, 0.0, 0.0),
    (1.1, 0.6, -0.4, 0.90, 0.0, 0.0),
    (1.0, 0.3, 1.2, 1.10, 0.0, 0.0),
]


def _stages(names: tuple[str, ...], rows: list[tuple[float, ...]], starts: list[float]) -> tuple[Stage, ...]:
    return tuple(Stage(start, dict(zip(names, row))) for start, row in zip(starts, rows))


def _even(duration: float, count: int) -> list[float]:
    return [duration * index for index in range(count)]


def _with_and_without_noise(scenario: Scenario) -> list[Scenario]:
    delay = scenario.floors.tracking_delay
    quiet = replace(scenario, title=f"{scenario.title}, no noise", floors=Floors(MAX_E_WITHOUT_NOISE, delay))
    noisy = replace(
        scenario,
        id=f"{scenario.id}-noise",
        title=f"{scenario.title}, noise {SENSOR_NOISE}",
        noise=SENSOR_NOISE,
        floors=Floors(),
    )
    return [quiet, noisy]


def _four(group: str, prefix: str, schedules: list[tuple[tuple[Stage, ...], float]], seed: int) -> list[Scenario]:
    """The four scenarios, each without and with noise, from four schedules (stages, end)."""
    kinds = [
        ("duffing-sine", "Duffing, sine", DUFFING, "sine", 0.0, 1.5),
        ("duffing-white", "Duffing, white noise", DUFFING, "white", 3.0, 4.0),
        ("vanderpol-sine", "van der Pol, sine", VAN_DER_POL, "sine", 0.0, 4.0),
        ("vanderpol-white", "van der Pol, white noise", VAN_DER_POL, "white", 1.0, 4.0),
    ]
    scenarios = []
    for index, ((name, title, law, kind, intensity, delay), (stages, end)) in enumerate(zip(kinds, schedules)):
        base = Scenario(
            f"{prefix}{name}",
            title,
            group,
            law,
            kind,
            stages,
            end,
            intensity,
            seed=seed + index,
            floors=Floors(None, delay),
        )
        scenarios += _with_and_without_noise(base)
    return scenarios


def documented() -> list[Scenario]:
    """The documented set: four scenarios of five stages, each without and with sensor noise."""
    schedules = [
        (_stages(_DUFFING_NAMES, _DUFFING_SINE, _even(16.0, 5)), 80.0),
        (_stages(_DUFFING_NAMES, _DUFFING_WHITE, _even(16.0, 5)), 80.0),
        (_stages(_VAN_DER_POL_NAMES, _VAN_DER_POL_SINE, _even(20.0, 5)), 100.0),
        (_stages(_VAN_DER_POL_NAMES, _VAN_DER_POL_WHITE, _even(20.0, 5)), 100.0),
    ]
    return _four("documented", "", schedules, seed=1)


def publication_cases() -> list[Scenario]:
    """The publication's two noise cases: one law each, noise 0.1 over 12 s and 0.05 over 24 s."""
    duffing = _stages(_DUFFING_NAMES, _DUFFING_SINE[:1], [0.0])
    van_der_pol = _stages(_VAN_DER_POL_NAMES, _VAN_DER_POL_SINE[:1], [0.0])
    group = "publication's noise cases"
    return [
        Scenario(
            "duffing-0.1",
            "Duffing, noise 0.1, 12 s",
            group,
            DUFFING,
            "sine",
            duffing,
            12.0,
            0.0,
            0.1,
            11,
            Floors(2.58e-4),
        ),
        Scenario(
            "vanderpol-0.05",
            "van der Pol, noise 0.05, 24 s",
            group,
            VAN_DER_POL,
            "sine",
            van_der_pol,
            24.0,
            0.0,
            0.05,
            12,
            Floors(1e-2),
        ),
    ]


_DUFFING_RANGES = {
    "m": (0.7, 1.4),
    "c": (0.15, 0.7),
    "k1": (3.0, 6.0),
    "k3": (1.0, 4.0),
    "P": (1.5, 2.8),
    "omega": (1.1, 2.1),
}
_VAN_DER_POL_RANGES = {"L": (0.8, 1.25), "alpha": (0.3, 1.2), "C": (0.8, 1.25), "P": (1.0, 1.5), "omega": (0.8, 1.4)}
_CYCLE, _FOCUS = (0.8, 1.2), (-0.7, -0.3)
_LEAST_CHANGE = 0.1


def _draw(generator: np.random.Generator, bounds: tuple[float, float], previous: float | None) -> float:
    """A number within the bounds that differs from the previous one by at least a tenth."""
    while True:
        value = round(float(generator.uniform(*bounds)), 3)
        if previous is None or abs(value - previous) >= _LEAST_CHANGE * abs(previous):
            return value


def _draw_stages(
    generator: np.random.Generator, ranges: dict[str, tuple[float, float]], count: int, shortest: float, longest: float
) -> tuple[tuple[Stage, ...], float]:
    stages, start = [], 0.0
    previous: dict[str, float] = {}
    for index in range(count):
        turn = {} if "alpha" not in ranges else {"a": _FOCUS if index % 2 else _CYCLE}
        bounds = ranges | turn
        previous = {name: _draw(generator, limits, previous.get(name)) for name, limits in bounds.items()}
        stages.append(Stage(start, previous))
        start = round(start + float(generator.uniform(shortest, longest)), 3)
    return tuple(stages), start


def drawn(seed: int) -> list[Scenario]:
    """The second set: the same four scenarios with parameters and switch instants drawn at random from the seed."""
    generator = np.random.default_rng(seed)
    duffing = [_draw_stages(generator, _DUFFING_RANGES, 5, 14.0, 18.0) for _ in range(2)]
    van_der_pol = [_draw_stages(generator, _VAN_DER_POL_RANGES, 5, 18.0, 22.0) for _ in range(2)]
    return _four(f"drawn from seed {seed}", "drawn-", duffing + van_der_pol, seed=1000 * seed + 101)
