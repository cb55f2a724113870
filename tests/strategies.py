"""Random systems, loads and plates for hypothesis, shared by the tests of all packages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import scipy.linalg as sla
from hypothesis import assume
from hypothesis import strategies as st
from numpy.typing import NDArray

from periodic import PeriodicSystem
from plate import EdgeLoad, MovingPlate

frequencies = st.floats(0.3, 8.0)
amplitudes = st.floats(-2.0, 2.0)
seeds = st.integers(0, 10**6)


def random_system(
    seed: int, n: int, harmonics: int = 1, *, symmetric: bool = True, damping: float = 0.0, gyroscopic: bool = True
) -> PeriodicSystem:
    """Mass well-conditioned, stiffness of order one and not always positive, excitation of order one."""
    rng = np.random.default_rng(seed)

    def entries(*shape: int) -> NDArray[np.float64]:
        return rng.standard_normal(shape)

    A, G, K, C = entries(n, n), entries(n, n), entries(n, n), entries(n, n)
    cosine, sine = entries(harmonics, n, n), entries(harmonics, n, n)
    if symmetric:
        K = K @ K.T + rng.uniform(-0.5, 1.0) * np.eye(n)
        cosine, sine = cosine + cosine.transpose(0, 2, 1), sine + sine.transpose(0, 2, 1)
    return PeriodicSystem(
        mass=A @ A.T / n + np.eye(n),
        gyroscopic=0.5 * (G - G.T) * gyroscopic,
        damping=damping * C @ C.T / n,
        stiffness=K,
        cosine=cosine,
        sine=sine,
    )


def systems(most: int = 5, **fixed: Any) -> st.SearchStrategy[PeriodicSystem]:
    """Systems of up to ``most`` coordinates of every kind; arguments of `random_system` may be fixed."""
    free: dict[str, st.SearchStrategy[Any]] = {
        "seed": seeds,
        "n": st.integers(1, most),
        "harmonics": st.integers(1, 4),
        "symmetric": st.booleans(),
        "damping": st.sampled_from([0.0, 0.0, 0.1, 1.0]),
        "gyroscopic": st.booleans(),
    }
    return st.builds(random_system, **(free | {name: st.just(value) for name, value in fixed.items()}))


def arrays(system: PeriodicSystem) -> tuple[NDArray[np.float64], ...]:
    """M, G, C, K, F_c, F_s."""
    return (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine, system.sine)


def transformed(system: PeriodicSystem, T: NDArray[np.float64]) -> PeriodicSystem:
    """The system in coordinates W = T x."""
    return PeriodicSystem(*[T.T @ S @ T for S in arrays(system)])


def join(*parts: PeriodicSystem) -> PeriodicSystem:
    """Independent systems side by side."""
    n, J = sum(s.size for s in parts), max(s.harmonics for s in parts)
    cosine, sine = np.zeros((J, n, n)), np.zeros((J, n, n))
    at = 0
    for s in parts:
        here = slice(at, at + s.size)
        cosine[: s.harmonics, here, here], sine[: s.harmonics, here, here] = s.cosine, s.sine
        at += s.size
    constant = (sla.block_diag(*matrices) for matrices in zip(*(arrays(s)[:4] for s in parts), strict=True))
    return PeriodicSystem(*constant, cosine, sine)


shapes = st.one_of(
    st.builds(EdgeLoad.uniform),
    st.builds(EdgeLoad.linear, st.floats(0.1, 2.0), st.floats(0.0, 2.0)),
    st.builds(
        lambda width, at: EdgeLoad.partial(width, width / 2 + at * (1 - width)), st.floats(0.2, 0.9), st.floats(0, 1)
    ),
    st.builds(EdgeLoad.parabolic, st.floats(0.0, 2.0)),
    st.builds(EdgeLoad.cosine, st.floats(0.0, 2.0)),
    st.builds(EdgeLoad.from_samples, st.just([0.0, 0.3, 1.0]), st.lists(st.floats(0.5, 2.0), min_size=3, max_size=3)),
)
waveforms = st.one_of(
    st.sampled_from(["cosine", "square", "triangle", "sawtooth"]),
    st.dictionaries(st.integers(1, 3), st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=1, max_size=3),
)
loads = st.builds(EdgeLoad.with_waveform, shapes, waveforms)


@st.composite
def plates(draw: st.DrawFn, **fixed: Any) -> MovingPlate:
    """Small plates below their divergence speed, moving either way; arguments of `MovingPlate` may be fixed."""
    free: dict[str, st.SearchStrategy[Any]] = {
        "aspect_ratio": st.floats(0.5, 2.5),
        "tension": st.floats(1.0, 30.0),
        "damping": st.sampled_from([0.0, 1e-4, 1e-3]),
        "poisson_ratio": st.floats(0.0, 0.45),
        "thickness_ratio": st.floats(0.003, 0.03),
        "inplane": st.sampled_from(["membrane", "static", "dynamic"]),
        "load": loads,
        "axial_terms": st.integers(1, 3),
        "lateral_terms": st.integers(1, 3),
        "inplane_terms": st.just((5, 4)),
    }
    given = {name: draw(strategy) for name, strategy in free.items() if name not in fixed} | fixed
    part = given.pop("speed", None)
    try:
        plate = MovingPlate(speed=0.0, **given)
        limit = plate.critical_speed()
    except ValueError:  # buckled by a part of a load that pulls the wrong way
        assume(False)
        raise
    return replace(plate, speed=draw(st.floats(-0.9, 0.9)) * limit if part is None else part)
