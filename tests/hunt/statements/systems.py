"""Random systems of every sort that has ever been answered wrongly, each from its seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.linalg as sla

from periodic import PeriodicSystem
from plate import EdgeLoad, MovingPlate
from tests.hunt.statements.parts import Array

Random = np.random.Generator


def _turned(random: Random, size: int) -> Array:
    return np.asarray(np.linalg.qr(random.normal(size=(size, size)))[0])


def _symmetric(random: Random, *shape: int) -> Array:
    X = random.normal(size=shape)
    return np.asarray((X + np.swapaxes(X, -1, -2)) / 2)


def _frequencies(random: Random, size: int) -> Array:
    return np.sort(random.uniform(1.0, 3.0, size))


def _modal(
    random: Random,
    frequencies: Array,
    damping: float = 0.0,
    harmonics: int = 1,
    excitation: Array | None = None,
    gyroscopic: float = 0.0,
) -> PeriodicSystem:
    """A system of given frequencies in turned axes, with random mass."""
    size = len(frequencies)
    F = _symmetric(random, 2 * harmonics, size, size) if excitation is None else excitation
    G = random.normal(size=(size, size))
    C = np.diag(random.uniform(0.2, 1.8, size))
    T = np.diag(random.uniform(0.7, 1.4, size)) @ _turned(random, size)
    G, C, K = gyroscopic * (G - G.T) / 2, damping * C, np.diag(frequencies**2)
    symmetric = np.array([np.eye(size), C, K, *F])
    is_symmetric = bool((symmetric == symmetric.transpose(0, 2, 1)).all())
    symmetric, G = T.T @ symmetric @ T, T.T @ G @ T
    if is_symmetric:  # to the last bit: a proof is about these very numbers
        symmetric = (symmetric + symmetric.transpose(0, 2, 1)) / 2
    M, C, K, *F = symmetric
    half = len(F) // 2
    return PeriodicSystem((M + M.T) / 2, (G - G.T) / 2, (C + C.T) / 2, K, F[:half], F[half:])


def plain(random: Random) -> PeriodicSystem:
    return _modal(random, _frequencies(random, random.integers(1, 4)))


def damped(random: Random) -> PeriodicSystem:
    return _modal(random, _frequencies(random, random.integers(1, 4)), damping=10 ** random.uniform(-3, -1))


def strongly_damped(random: Random) -> PeriodicSystem:
    return _modal(random, _frequencies(random, 2), damping=random.uniform(0.1, 1.0))


def repeated(random: Random) -> PeriodicSystem:
    w = _frequencies(random, random.integers(2, 4))
    w[1] = w[0]
    return _modal(random, w, damping=random.choice([0.0, 0.01]))


def nearly_repeated(random: Random) -> PeriodicSystem:
    w = _frequencies(random, random.integers(2, 4))
    w[1] = w[0] * (1 + 10 ** random.uniform(-5, -1.5))
    return _modal(random, w, damping=random.choice([0.0, 0.01]))


def internal_resonance(random: Random) -> PeriodicSystem:
    """w2 = 2 w1, w3 = 3 w1, or w1 + w3 = 2 w2; exactly, or nearly."""
    w1 = random.uniform(1.0, 2.0)
    w = w1 * np.array([1.0, 2.0, 3.0])[: random.integers(2, 4)]
    if random.integers(2):
        w = w + random.choice([0.0, 1e-3, 1e-2]) * random.normal(size=len(w))
    return _modal(random, np.sort(w), damping=random.choice([0.0, 0.005]))


def mirrored(random: Random) -> PeriodicSystem:
    """Two hidden parts that nothing couples, sometimes with frequencies in common."""
    sizes = random.integers(1, 3), random.integers(1, 3)
    w = [_frequencies(random, n) for n in sizes]
    if random.integers(2):
        w[1][0] = w[0][0]
    F = np.array([sla.block_diag(*(_symmetric(random, n, n) for n in sizes)) for _ in range(2)])
    return _modal(random, np.concatenate(w), excitation=F)


def cyclic(random: Random) -> PeriodicSystem:
    """A ring of three or four equal oscillators."""
    size = int(random.integers(3, 5))
    shift = np.roll(np.eye(size), 1, axis=0)

    def ring(own: float, coupling: float) -> Array:
        return np.asarray(own * np.eye(size) + coupling * (2 * np.eye(size) - shift - shift.T))

    K = ring(random.uniform(1, 4), random.uniform(0.1, 1))
    F = ring(random.normal(), random.normal())
    C = random.choice([0.0, 0.02]) * np.eye(size)
    if random.integers(2):  # one of them excited alone: the symmetry is broken
        F = np.zeros((size, size))
        F[0, 0] = 1.0
    return PeriodicSystem(np.eye(size), np.zeros((size, size)), C, K, [F])


def free_chain(random: Random) -> PeriodicSystem:
    """A chain of masses with free ends, whose springs pulsate: one rigid motion."""
    size = int(random.integers(2, 5))
    rows = np.diff(np.eye(size), axis=0)

    def chain(springs: Array) -> Array:
        exact = np.ldexp(np.rint(np.ldexp(springs, 20)), -20)  # so that the rows add up to 0 to the last bit
        return np.asarray(rows.T @ np.diag(exact) @ rows)

    K, F = chain(random.uniform(1, 4, size - 1)), chain(random.normal(size=size - 1))
    C = random.choice([0.0, 2.0**-7]) * chain(random.uniform(0.5, 1.5, size - 1))
    return PeriodicSystem(np.diag(random.uniform(0.5, 2, size)), np.zeros((size, size)), C, K, [F])


def indefinite(random: Random) -> PeriodicSystem:
    """Stiffness that pushes, held by gyroscopic forces: differences are unstable, too."""
    J = np.array([[0.0, -1.0], [1.0, 0.0]])
    k1, k2 = random.uniform(0.2, 1.0, 2)
    G = (np.sqrt(k1) + np.sqrt(k2) + random.uniform(0.3, 1.5)) * J
    return PeriodicSystem(np.eye(2), G, np.zeros((2, 2)), -np.diag([k1, k2]), [_symmetric(random, 2, 2) / 2])


def unsymmetric(random: Random) -> PeriodicSystem:
    size = int(random.integers(2, 4))
    F = random.normal(size=(2, size, size))
    return _modal(random, _frequencies(random, size), damping=10 ** random.uniform(-2.5, -1), excitation=F)


def near_touching(random: Random) -> PeriodicSystem:
    """Regions whose gaps are as narrow as they are wide."""
    w = random.uniform(1.0, 2.0) * np.cumprod([1.0, *(1 + random.uniform(0.02, 0.3, 2))])
    return _modal(random, w, damping=random.choice([0.0, 0.01]))


def two_harmonics(random: Random) -> PeriodicSystem:
    size = int(random.integers(1, 4))
    return _modal(random, _frequencies(random, size), damping=random.choice([0.0, 0.01]), harmonics=2)


def gyroscopic(random: Random) -> PeriodicSystem:
    size = int(random.integers(2, 4))
    return _modal(
        random, _frequencies(random, size), damping=random.choice([0.0, 0.01]), gyroscopic=random.uniform(0.2, 1.5)
    )


def negatively_damped(random: Random) -> PeriodicSystem:
    """One mode grows without excitation."""
    k1, k2 = np.sort(random.uniform(0.5, 3.0, 2))
    c = random.uniform(0.02, 0.08)
    C = np.diag(random.permutation([-c, c * random.uniform(1.0, 2.0)]))
    F = random.normal(size=(2, 2))
    return PeriodicSystem(np.eye(2), np.zeros((2, 2)), C, np.diag([k1, k2]), [F if random.integers(2) else F + F.T])


def _load(random: Random) -> EdgeLoad:
    shapes: list[Callable[[], EdgeLoad]] = [
        EdgeLoad.uniform,
        lambda: EdgeLoad.linear(random.uniform(0.1, 2.0), random.uniform(0.0, 2.0)),
        lambda: EdgeLoad.partial(width := random.uniform(0.2, 0.9), width / 2 + random.uniform() * (1 - width)),
        lambda: EdgeLoad.parabolic(random.uniform(0.0, 2.0)),
        lambda: EdgeLoad.cosine(random.uniform(0.0, 2.0)),
    ]
    load = shapes[random.integers(len(shapes))]()
    if random.integers(3):
        return load
    return load.with_waveform({1: (random.uniform(-1, 1), 0.0), 2: tuple(random.uniform(-0.5, 0.5, 2).tolist())})


def _plate(random: Random, part_of_critical: float) -> PeriodicSystem:
    while True:
        try:
            plate = MovingPlate(
                speed=0.0,
                aspect_ratio=random.uniform(0.5, 2.5),
                tension=random.uniform(1.0, 30.0),
                damping=random.choice([0.0, 1e-4, 1e-3]),
                poisson_ratio=random.uniform(0.0, 0.45),
                thickness_ratio=random.uniform(0.003, 0.03),
                inplane=str(random.choice(["membrane", "static"])),
                load=_load(random),
                axial_terms=int(random.integers(1, 4)),
                lateral_terms=int(random.integers(1, 4)),
                inplane_terms=(5, 4),
            )
            return replace(plate, speed=part_of_critical * plate.critical_speed()).at(10.0)
        except ValueError:  # buckled by a part of a load that pulls the wrong way
            continue


def plate(random: Random) -> PeriodicSystem:
    return _plate(random, random.uniform(0.0, 0.9))


def plate_near_critical_speed(random: Random) -> PeriodicSystem:
    return _plate(random, 1 - 10 ** random.uniform(-4, -1.3))


SORTS: dict[str, Callable[[Random], PeriodicSystem]] = {
    make.__name__: make
    for make in (
        plain,
        damped,
        strongly_damped,
        repeated,
        nearly_repeated,
        internal_resonance,
        mirrored,
        cyclic,
        free_chain,
        indefinite,
        unsymmetric,
        near_touching,
        two_harmonics,
        gyroscopic,
        negatively_damped,
        plate,
        plate,
        plate_near_critical_speed,
    )
}
