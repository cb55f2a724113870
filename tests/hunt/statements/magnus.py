"""Many points at once by Magnus's series of sixth order: the integrator that statements are held against.

It shares no code with `floquet`, and no method either: exponentials of averaged matrices instead of Taylor series of
the solution. S. Blanes, F. Casas, J. A. Oteo, J. Ros, Phys. Rep. 470 (2009) 151, eqs. (253)-(257).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet import Kind
from tests.hunt.statements.parts import Array, Part

NODES = np.array([0.5 - np.sqrt(15) / 10, 0.5, 0.5 + np.sqrt(15) / 10])
# Fewest steps of a period, the longest step in units of the fastest motion, to begin with, and how often it is halved
# at most.
MIN_STEPS, FIRST_STEP, MAX_HALVINGS = 12, 2.0, 5
# Difference from half as many steps at which halving ends, as part of the norm.
ENOUGH = 3e-11
# By this factor the difference from half as many steps exceeds the error: 2^6, less what is not asymptotic.
GAIN = 20.0
# Errors that are not measured again, over those that were measured once for the part.
ASSUMED = 3.0
# That holds at points whose Omega and eps differ by at most this factor from those of the measurement.
NEAR = 1.3
# Rounding of one product.
ROUNDING = 3e-16
# Largest norm at which the series of the exponential is summed, and its terms.
SERIES_RADIUS, TERMS = 0.7, 16
# A multiplier is off the unit circle if it is so by this many of its errors; nothing is told where they are larger.
CLEAR, LARGEST = 10.0, 1e-6
# Floats held at once.
MAX_HELD = 4_000_000
COEFFICIENTS = 1 / np.cumprod(np.concatenate([[1.0], np.arange(1.0, TERMS + 1)]))


class Multipliers(NamedTuple):
    """At each of B points: ``state`` 1 unstable, -1 stable, 0 not to be told; ``growth`` log|mu| of the dominant one,
    its ``error``, and the ``dominant`` multiplier itself."""

    state: NDArray[np.int_]
    growth: Array
    error: Array
    dominant: NDArray[np.complex128]


class Flow:
    """Integrates one part of a system at many points."""

    def __init__(self, part: Part) -> None:
        G, D = part.G, part.G / 2 + part.C
        m = len(part.K)
        # in (y, y' + G y / 2) the motion is canonical, and the exponentials symplectic, where nothing is damped
        lower = D @ G / 2 - part.K
        self.scale = max(np.sqrt(np.abs(np.linalg.eigvals(lower)).max()), 1e-300)
        self.constant = np.block([[-G / 2, self.scale * np.eye(m)], [lower / self.scale, -D]])
        self.excitation = -part.F / self.scale
        self.rate = float(np.abs(np.linalg.eigvals(self.constant)).max())
        self.step, self.error = FIRST_STEP, np.inf  # what was needed so far, and the error that it left by step
        self.near = np.inf, 0.0, 0.0  # smallest and largest Omega and largest eps for which that is so
        self.force = float(sum(np.linalg.norm(F, 2) for F in part.F)) / self.scale

    def at(self, Omega: Array | list[float] | float, eps: Array | float, finest: float = LARGEST) -> Multipliers:
        """Return the multipliers at points that broadcast together; ``finest`` is the growth that must be noticed."""
        return _multipliers(*self._converged(Omega, eps), finest)

    def kinds(self, Omega: Array, eps: float) -> set[Kind]:
        """Return all kinds of instability at some points."""
        mu, growth, uncertain = _spectrum(*self._converged(Omega, eps))
        mu = mu[growth > uncertain]
        real = np.abs(mu.imag) <= 1e-9 * np.abs(mu)
        names = np.where(~real, Kind.COMPLEX, np.where(mu.real > 0, Kind.PLUS_ONE, Kind.MINUS_ONE))
        return {Kind(int(one)) for one in names}

    def _converged(self, Omega: Array | list[float] | float, eps: Array | float) -> tuple[Array, Array]:
        """Return the maps over one period and their errors."""
        w, e = np.broadcast_arrays(np.atleast_1d(np.asarray(Omega, float)), np.asarray(eps, float))
        fastest = 2 * np.pi / w.min() * (self.rate + self.force * float(e.max()) / 2)
        with np.errstate(over="ignore", invalid="ignore"):
            maps, error = self._halved(w, e, fastest)
        beyond = ~(np.isfinite(maps).all(axis=(1, 2)) & np.isfinite(error))
        maps[beyond], error[beyond] = 1e150 * np.eye(maps.shape[-1]), 0.0  # grown beyond all bounds
        return maps, error

    def _halved(self, w: Array, e: Array, fastest: float) -> tuple[Array, Array]:
        """Return maps and errors from steps that are halved until the maps change no more."""
        steps = int(np.ceil(max(fastest, MIN_STEPS * FIRST_STEP) / self.step))
        if self._measured(w, e):
            maps = self._maps(w, e, 2 * steps)
            return maps, self.error * 2 * steps * np.linalg.norm(maps, axis=(1, 2))
        before = self._maps(w, e, steps)
        for _ in range(MAX_HALVINGS):
            steps *= 2
            after = self._maps(w, e, steps)
            size = np.linalg.norm(after, axis=(1, 2))
            difference = np.linalg.norm(after - before, axis=(1, 2))
            if (difference <= ENOUGH * np.maximum(size, 1.0)).all():
                break
            before = after
            self.step /= 2
        error = difference / GAIN + ROUNDING * np.sqrt(steps) * size
        self.error = ASSUMED * float((error / size).max()) / steps
        self.near = float(w.min()), float(w.max()), float(e.max())
        return after, error

    def _measured(self, w: Array, e: Array) -> bool:
        """Whether the error was measured near by."""
        low, high, most = self.near
        return bool(w.min() > low / NEAR and w.max() < high * NEAR and e.max() < most * NEAR)

    def _maps(self, Omega: Array, eps: Array, steps: int) -> Array:
        """Return the maps over one period, (B, 2m, 2m)."""
        size = len(self.constant)
        whole = np.broadcast_to(np.eye(size), (len(Omega), size, size))
        chunk = max(1, MAX_HELD // (12 * len(Omega) * size**2))
        for start in range(0, steps, chunk):
            maps = self._steps(Omega, eps, steps, np.arange(start, min(start + chunk, steps)))
            while maps.shape[1] > 1:  # products of neighbours
                last = maps[:, -1:] if maps.shape[1] % 2 else maps[:, :0]
                maps = np.concatenate([maps[:, 1::2] @ maps[:, : maps.shape[1] // 2 * 2 : 2], last], axis=1)
            whole = maps[:, 0] @ whole
        return whole

    def _steps(self, Omega: Array, eps: Array, steps: int, numbers: NDArray[np.int_]) -> Array:
        """Return the maps of some steps, (B, S, 2m, 2m): eqs. (253)-(257)."""
        J, m = len(self.excitation) // 2, len(self.constant) // 2
        phase = 2 * np.pi * (numbers[:, None] + NODES) / steps
        angle = phase[..., None] * np.arange(1, J + 1)
        first, middle, last = np.moveaxis(
            np.tensordot(np.concatenate([np.cos(angle), np.sin(angle)], axis=-1), self.excitation, 1), 1, 0
        )
        h = (2 * np.pi / Omega / steps)[:, None, None, None]
        strength = h * eps[:, None, None, None]

        def kick(F: Array) -> Array:
            found = np.zeros((len(Omega), len(numbers), 2 * m, 2 * m))
            found[..., m:, :m] = strength * F
            return found

        a1 = h * self.constant + kick(middle)
        a2, a3 = kick(np.sqrt(15) / 3 * (last - first)), kick(10 / 3 * (last - 2 * middle + first))
        c1 = _commutator(a1, a2)
        c2 = -_commutator(a1, 2 * a3 + c1) / 60
        return _exponential(a1 + a3 / 12 + _commutator(-20 * a1 - a3 + c1, a2 + c2) / 240)


def _commutator(a: Array, b: Array) -> Array:
    return np.asarray(a @ b - b @ a)


def _exponential(X: Array) -> Array:
    largest = float(np.linalg.norm(X, axis=(-2, -1)).max())
    halvings = max(0, int(np.ceil(np.log2(max(largest, 1e-300) / SERIES_RADIUS))))
    x = X / 2**halvings
    one = np.eye(X.shape[-1])
    x2 = x @ x
    x3 = x2 @ x
    x4 = x2 @ x2
    c = COEFFICIENTS
    found = c[16] * one + np.zeros_like(x)
    for k in (12, 8, 4, 0):
        found = found @ x4 + (c[k] * one + c[k + 1] * x + c[k + 2] * x2 + c[k + 3] * x3)
    for _ in range(halvings):
        found = found @ found
    return np.asarray(found)


def _spectrum(maps: Array, error: Array) -> tuple[NDArray[np.complex128], Array, Array]:
    """Return all multipliers, their log|mu|, and how uncertain that is, (B, 2m) each."""
    mu, right = np.linalg.eig(maps)
    sizes = np.linalg.svd(right, compute_uv=False)
    safe = sizes[:, -1] > 1e-15
    inverse = np.linalg.inv(np.where(safe[:, None, None], right, np.eye(right.shape[-1])))
    condition = np.where(safe[:, None], np.linalg.norm(inverse, axis=2), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        return mu, np.log(np.abs(mu)), CLEAR * condition * error[:, None] / np.abs(mu)


def _multipliers(maps: Array, error: Array, finest: float) -> Multipliers:
    mu, growth, uncertain = _spectrum(maps, error)
    unstable = (growth > uncertain).any(axis=1)
    relevant = np.where(growth > -0.1, uncertain, 0.0).max(axis=1)
    state = np.where(unstable, 1, np.where(relevant < min(finest, LARGEST), -1, 0))
    leading = growth.argmax(axis=1)
    rows = np.arange(len(mu))
    return Multipliers(state, growth[rows, leading], uncertain[rows, leading], mu[rows, leading])


class Flows:
    """Several parts together: unstable where one of them is."""

    def __init__(self, parts: list[Part]) -> None:
        self.parts = parts
        self.flows = [Flow(part) for part in parts]

    def state(
        self, Omega: Array | list[float] | float, eps: Array | float, finest: float = LARGEST
    ) -> NDArray[np.int_]:
        """Return 1 unstable, -1 stable, 0 not to be told, at each point; stable if a growth ``finest`` would show."""
        found = np.array([flow.at(Omega, eps, finest).state for flow in self.flows])
        if not len(found):
            return np.full(np.broadcast(np.atleast_1d(Omega), eps).shape, -1)
        return np.where((found == 1).any(axis=0), 1, np.where((found == 0).any(axis=0), 0, -1))

    def dominant(self, Omega: Array | list[float] | float, eps: Array | float) -> Multipliers:
        """Return what the part with the largest growth does, at each point."""
        found = [flow.at(Omega, eps) for flow in self.flows]
        growth = np.array([one.growth for one in found])
        best = growth.argmax(axis=0)
        columns = np.arange(growth.shape[1])
        return Multipliers(
            self.state(Omega, eps), *(np.array([one[k] for one in found])[best, columns] for k in (1, 2, 3))
        )

    def damped(self, factor: float) -> Flows:
        """Return the same with ``factor`` times the damping."""
        return Flows([part.damped(factor) for part in self.parts])
