"""What the tests of the beam need from the theory around it, kept apart from the packages under test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from periodic import PeriodicSystem
from periodic.checks import ComplexArray, FloatArray


def fundamental(system: PeriodicSystem, Omega: float, eps: float, time: float) -> FloatArray:
    """Return the matrix that takes (W', W) from t = 0 to ``time``, by SciPy's DOP853."""
    return carried(system, Omega, eps, time, np.eye(2 * system.size))


def carried(system: PeriodicSystem, Omega: float, eps: float, time: float, start: FloatArray) -> FloatArray:
    """Return what the columns of ``start``, in (W', W), are at ``time``."""
    n = system.size

    def rate(t: float, x: FloatArray) -> FloatArray:
        M, G, C, K = system.matrices(Omega * t, eps)
        V, W = x.reshape(2, n, -1)
        return np.concatenate([-np.linalg.solve(M, (G + C) @ V + K @ W), V]).ravel()

    run = solve_ivp(rate, (0, time), start.ravel(), method="DOP853", rtol=1e-12, atol=1e-13)
    return run.y[:, -1].reshape(start.shape)


def symplectic_defect(Phi: FloatArray, B: FloatArray, speed: float) -> float:
    """Return how far Phi, in (W', W), is from symplectic for dp ^ dW with p = W' + ``speed`` B W, relative."""
    n = len(B)
    one, zero = np.eye(n), np.zeros((n, n))
    momenta = np.block([[one, speed * B], [zero, one]])
    form = momenta.T @ np.block([[zero, one], [-one, zero]]) @ momenta
    return float(np.abs(Phi.T @ form @ Phi - form).max() / np.abs(Phi).max() ** 2)


def free_modes(system: PeriodicSystem) -> tuple[FloatArray, ComplexArray]:
    """Return frequencies and modes without excitation and damping, w^H (omega^2 M + K) w = 2."""
    n = system.size
    values, vectors = np.linalg.eig(np.block([[-system.gyroscopic, -system.stiffness], [np.eye(n), np.zeros((n, n))]]))
    kept = np.flatnonzero(values.imag > 0)
    kept = kept[np.argsort(values.imag[kept])]
    omega, w = values.imag[kept], vectors[n:, kept]
    size = omega**2 * (abs(w) ** 2).sum(axis=0) + np.einsum("ia,ij,ja->a", w.conj(), system.stiffness, w).real
    return omega, w * np.sqrt(2 / size)


@dataclass(frozen=True)
class ExactString:
    """The string of unit length and tension at the speed v0 (1 + eps cos Omega t) < 1, by characteristics.

    In the frame of the string both ends move by - s(t), s the integral of v, and w = f(X - t) + g(X + t). A wave is
    followed back, from end to end, each time with the other sign, to the motion at t = 0: w = sin pi x, w_t = 0.
    """

    v0: float
    Omega: float
    eps: float

    def s(self, t: float) -> float:
        return self.v0 * (t + self.eps * float(np.sin(self.Omega * t)) / self.Omega)

    def v(self, t: float) -> float:
        return self.v0 * (1 + self.eps * float(np.cos(self.Omega * t)))

    def w(self, x: float, t: float) -> float:
        X = x - self.s(t)
        return self._right(X - t)[0] + self._left(X + t)[0]

    def energy(self, t: float, places: int = 400) -> float:
        """Return half the integral of the squares of slope and velocity, in the frame of the string."""
        X = (np.arange(places) + 0.5) / places - self.s(t)
        return float(np.mean([self._right(x - t)[1] ** 2 + self._left(x + t)[1] ** 2 for x in X]))

    def _right(self, u: float) -> tuple[float, float]:
        """Return f(u) and f'(u)."""
        if u >= 0:
            part = (1 - self.v(0.0)) / 2
            return part * np.sin(np.pi * u), part * np.pi * np.cos(np.pi * u)
        t = self._root(lambda t: -self.s(t) - t - u, -u)  # when this wave left the end x = 0
        g, slope = self._left(t - self.s(t))
        return -g, slope * (1 - self.v(t)) / (1 + self.v(t))

    def _left(self, u: float) -> tuple[float, float]:
        """Return g(u) and g'(u)."""
        if u <= 1:
            part = (1 + self.v(0.0)) / 2
            return part * np.sin(np.pi * u), part * np.pi * np.cos(np.pi * u)
        t = self._root(lambda t: 1 - self.s(t) + t - u, u - 1)  # when this wave left the end x = 1
        f, slope = self._right(1 - self.s(t) - t)
        return -f, slope * (1 + self.v(t)) / (1 - self.v(t))

    def _root(self, function: Callable[[float], float], scale: float) -> float:
        top = 2 * scale / (1 - self.v0 * (1 + abs(self.eps)))
        return float(brentq(function, 0.0, top, xtol=1e-13))
