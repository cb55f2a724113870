"""What a finite run shows: the response to initial values, and the largest transient growth of energy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as sla
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from floquet.modes.solutions import Pieces
from periodic import AnySystem, FirstOrderSystem
from periodic.checks import FloatArray, is_positive_definite, real_array, real_number, whole_number

# Phases of a period at which responses and growth are computed, and the most periods and numbers in one answer.
RESPONSE_SAMPLES, MAX_PERIODS, MAX_NUMBERS = 64, 100_000, 20_000_000
# Growth of a solution beyond which its square would leave the range of floats.
MAX_GROWN = 1e150
# Relative accuracy in time of the largest growth: near its top the growth is that accurate to the square of it.
GROWTH_TIME_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Response:
    """The motion that follows from initial values at t = 0.

    Attributes
    ----------
    times : ndarray, shape (m,)
    states : ndarray, shape (m, S)
        (W', W), or x of a first-order system; just after where something jumps.
    energy : ndarray, shape (m,) or None
        Kinetic and potential energy with the constant mass and stiffness; of a first-order system half the sum of the
        squares of the states. None if the stiffness has no positive definite symmetric part.
    """

    times: FloatArray
    states: FloatArray
    energy: FloatArray | None
    system: AnySystem

    @property
    def displacement(self) -> FloatArray:
        """W, shape (m, n).

        Raises
        ------
        ValueError
            If the system is of first order.
        """
        if isinstance(self.system, FirstOrderSystem):
            raise ValueError("the system is of first order and has no displacement; take states")
        return self.states[:, self.system.size :]

    def __repr__(self) -> str:
        return f"Response from t = 0 to {self.times[-1]:.6g} at {len(self.times)} times, {self.states.shape[1]} states"


@dataclass(frozen=True, eq=False)
class TransientGrowth:
    """The largest growth of energy that any initial values at t = 0 can cause.

    Attributes
    ----------
    times : ndarray, shape (m,)
    amplification : ndarray, shape (m,)
        Largest energy at each time divided by the energy at t = 0.
    largest : float
        The largest amplification up to the last time, between the ``times`` too.
    time : float
        When it is reached.
    initial : ndarray, shape (S,)
        The initial values that reach it, of energy one.
    """

    times: FloatArray
    amplification: FloatArray
    largest: float
    time: float
    initial: FloatArray

    def time_to_reach(self, amplification: float = 10.0) -> float:
        """Return the first time at which energy can have grown by a factor, to linear interpolation of its logarithm
        between the ``times``; infinite if it does not within them."""
        wanted = np.log(real_number("amplification", amplification, positive=True))
        logs = np.log(self.amplification)
        above = np.flatnonzero(logs >= wanted)
        if not above.size:
            return float("inf")
        k = int(above[0])
        if k == 0:
            return float(self.times[0])
        share = (wanted - logs[k - 1]) / (logs[k] - logs[k - 1])
        return float(self.times[k - 1] + share * (self.times[k] - self.times[k - 1]))

    def __repr__(self) -> str:
        return f"TransientGrowth(largest={self.largest:.6g}, time={self.time:.6g})"


def energy_matrix(system: AnySystem) -> FloatArray | None:
    """Return E (S, S), energy = state^T E state, of the constant mass and stiffness; None if it is indefinite."""
    if isinstance(system, FirstOrderSystem):
        return 0.5 * np.eye(system.size)
    K = (system.stiffness + system.stiffness.T) / 2
    return 0.5 * np.asarray(sla.block_diag(system.mass, K)) if is_positive_definite(K) else None


def respond(pieces: Pieces, initial: ArrayLike, periods: Any, samples: Any) -> Response:
    """Return the motion that follows from ``initial`` over a number of periods."""
    start = real_array("initial", initial, 1)
    S = pieces.states
    if start.shape != (S,):
        what = "the states" if isinstance(pieces.system, FirstOrderSystem) else "(W', W)"
        raise ValueError(f"initial has shape {start.shape}; give {S} values, {what} at t = 0")
    periods, samples = _checked(periods, samples, S)
    factors = pieces.factors(np.linspace(0, 1, samples + 1))
    states = np.empty((periods * samples + 1, S))
    states[0] = start
    for k in range(periods * samples):
        states[k + 1] = factors[k % samples] @ states[k]
        if not np.abs(states[k + 1]).max() <= MAX_GROWN:
            raise ValueError(f"periods = {periods}: the motion grows beyond {MAX_GROWN:.0e}; give fewer periods")
    times = pieces.period / samples * np.arange(len(states))
    E = energy_matrix(pieces.system)
    energy = None if E is None else ((states @ E) * states).sum(axis=1)
    return Response(times, states, energy, pieces.system)


def transient(pieces: Pieces, periods: Any, samples: Any, energy: ArrayLike | None) -> TransientGrowth:
    """Return the largest growth of energy within a number of periods."""
    S = pieces.states
    periods, samples = _checked(periods, samples, S)
    root = _root(pieces.system, energy, S)
    phases = np.linspace(0, 1, samples + 1)
    factors = root @ pieces.factors(phases) @ np.linalg.inv(root)
    Phi = np.eye(S)
    growth, best, before = [1.0], 1.0, Phi
    top = 0
    for k in range(periods * samples):
        former, Phi = Phi, factors[k % samples] @ Phi
        if not np.abs(Phi).max() <= MAX_GROWN:
            raise ValueError(f"periods = {periods}: energy grows by more than {MAX_GROWN:.0e}^2; give fewer periods")
        growth.append(float(np.linalg.norm(Phi, 2)) ** 2)
        if growth[-1] > best:
            best, top, before = growth[-1], k + 1, former
    times = pieces.period / samples * np.arange(len(growth))
    largest, time, matrix = best, float(times[top]), (factors[(top - 1) % samples] @ before if top else np.eye(S))
    if 0 < top < len(growth) - 1:
        largest, time, matrix = _refined(pieces, root, before, top, samples)
    initial = np.linalg.solve(root, np.linalg.svd(matrix)[2][0])
    return TransientGrowth(times, np.array(growth), largest, time, initial)


def _refined(
    pieces: Pieces, root: FloatArray, before: FloatArray, top: int, samples: int
) -> tuple[float, float, FloatArray]:
    """Return the largest growth near sample ``top``, its time and its matrix; ``before`` is that of the sample before
    it."""
    start, inverse = (top - 1) / samples, np.linalg.inv(root)
    turn = np.floor(start)

    def matrix(share: float) -> FloatArray:
        phases = np.array([start - turn, start - turn + share / samples])
        return np.asarray(root @ pieces.factors(phases)[0] @ inverse @ before)

    def loss(share: float) -> float:
        return -float(np.linalg.norm(matrix(share), 2))

    found = minimize_scalar(loss, bounds=(1e-9, 2.0), method="bounded", options={"xatol": GROWTH_TIME_TOLERANCE})
    share = min((float(found.x), 1.0), key=loss)
    Phi = matrix(share)
    return float(np.linalg.norm(Phi, 2)) ** 2, (start + share / samples) * pieces.period, Phi


def _root(system: AnySystem, energy: ArrayLike | None, S: int) -> FloatArray:
    """Return R with energy = |R state|^2."""
    E = energy_matrix(system) if energy is None else real_array("energy", energy, 2)
    if E is None:
        raise ValueError(
            "energy is not given, and the stiffness has no positive definite symmetric part that would define one; "
            f"give a symmetric positive definite matrix energy of shape ({S}, {S})"
        )
    if E.shape != (S, S) or not np.allclose(E, E.T, rtol=1e-10, atol=0) or not is_positive_definite(E):
        raise ValueError(f"energy has shape {E.shape}; give a symmetric positive definite matrix of shape ({S}, {S})")
    return np.asarray(np.linalg.cholesky(E).T)


def _checked(periods: Any, samples: Any, S: int) -> tuple[int, int]:
    periods = whole_number("periods", periods, least=1, most=MAX_PERIODS)
    samples = whole_number("samples", samples, least=1)
    if periods * samples * S > MAX_NUMBERS:
        raise ValueError(f"periods = {periods} with samples = {samples} are too many numbers; give fewer")
    return periods, samples
