"""In-plane problem: the Ritz discretisation (6) of eqs. (2a, b), eq. (8), and the stress resultants (3).

u is a sum of p_m(X) q_n(Y), v of s_(m+1)(X) q_n(Y), with m and n from 0: the paper's spaces in an orthonormal basis, so
that M_i is the identity. Everything is divided by beta = 12 (b/h)^2 = C^2, C being the speed of stretching waves at
nu = 0: the unknowns are C^2 u and C^2 v; frequency w = j Omega and speed enter as kappa = w/C and as V/C. Eq. (8) reads

    [ (1 + i w c) K_ie - kappa^2 M_i + i kappa (V/C) G_i + (V/C)^2 K_ig ] U = f [phi(r, Y) - phi(0, Y)]

The rigid translation u = const is left out at every frequency. It carries no stress. Its columns of G_i, K_ig and K_ie
vanish and M_i is diagonal, so that it acts on nothing else; without it the operator is regular at w = 0 too. At w = 0
eq. (8) in full keeps V^2 K_ig, the inertia of material that moves through a field stretched unevenly.

There are two subsystems: functions even in u and odd in v about the mid-line ("symmetric") never couple with the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag, cholesky, solve_triangular

from periodic.checks import ComplexArray, FloatArray
from plate.basis import (
    kronecker,
    legendre,
    legendre_derivative,
    sine_derivative,
    sine_legendre,
    sine_slopes,
    sine_wavenumbers,
    sines,
)
from plate.distribution import Distribution
from plate.transverse import NumericArray, stress_quadrature, stress_stiffness

# Legendre coefficients of a load below this part of the largest one are rounding.
LOAD_COEFFICIENT_TOLERANCE = 1e-14

# An eigenvalue is real if its imaginary part is below this part of its modulus: double ones keep half the digits.
REAL_EIGENVALUE_TOLERANCE = 1e-7

# A mode grows if the real part of its exponent is above this part of its modulus: a hundred times what rounding leaves.
GROWTH_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class StressField:
    """Stress resultants on a grid, dimensionless (multiples of D / b^2).

    The stress of harmonic j is Re[N e^{i j Omega t}] times eps; the static one (j = 0) is real.

    Parameters
    ----------
    x : ndarray, shape (p,)
        Places X = x/b, from 0 to r.
    y : ndarray, shape (q,)
        Places Y = y/b, from 0 to 1.
    N_xx, N_yy, N_xy : ndarray of complex, shape (q, p)
        Complex amplitudes; rows follow y, columns x.
    """

    x: FloatArray
    y: FloatArray
    N_xx: ComplexArray
    N_yy: ComplexArray
    N_xy: ComplexArray


class InPlaneFrequencies(NamedTuple):
    """Natural frequencies of in-plane vibration, ascending, by symmetry about the mid-line y = b/2.

    Parameters
    ----------
    symmetric : ndarray
        u even and v odd in y - b/2.
    antisymmetric : ndarray
        u odd and v even.
    """

    symmetric: FloatArray
    antisymmetric: FloatArray


@dataclass(frozen=True, eq=False)
class InPlaneSubsystem:
    """Eq. (8) for one lateral symmetry in energy coordinates z, in which K_ie is the identity.

    Parameters
    ----------
    shapes : ndarray, shape (coefficients, N)
        The coefficients of u and v are shapes @ z.
    inertia : ndarray, shape (N, N)
        M_i, symmetric.
    gyroscopic, transport : ndarray, shape (N, N)
        G_i and K_ig; neither symmetric nor skew, since u is free at the ends.
    """

    shapes: FloatArray
    inertia: FloatArray
    gyroscopic: FloatArray
    transport: FloatArray

    @cached_property
    def frequencies(self) -> FloatArray:
        """Natural frequencies at rest divided by C, ascending, shape (N,)."""
        return 1 / np.sqrt(np.linalg.eigvalsh(self.inertia)[::-1])

    def exponents(self, mach: float, loss_time: float) -> ComplexArray:
        """Return the exponents of free in-plane motion divided by C, shape (2 N,).

        Parameters
        ----------
        mach : float
            V / C.
        loss_time : float
            c C: Kelvin–Voigt damping in the time unit of in-plane waves.
        """
        size = len(self.inertia)
        one, zero = np.eye(size), np.zeros((size, size))
        elastic = one + mach**2 * self.transport
        resistance = mach * self.gyroscopic + loss_time * one
        lower = -np.linalg.solve(self.inertia, np.hstack([elastic, resistance]))
        pencil = np.vstack([np.hstack([zero, one]), lower])
        return np.linalg.eigvals(pencil).astype(np.complex128)

    def frequencies_at(self, mach: float) -> FloatArray:
        """Return the natural frequencies at speed V divided by C, undamped, ascending."""
        if mach == 0:
            return self.frequencies.copy()
        exponents = self.exponents(mach, 0.0)
        return np.sort(exponents.imag[exponents.imag > REAL_EIGENVALUE_TOLERANCE * np.abs(exponents)])

    def solve(self, static: NumericArray, kappa: float, mach: float, loss: float) -> NumericArray:
        """Return z at one frequency.

        Parameters
        ----------
        static : ndarray, shape (N,) or (N, m)
            shapes.T @ force, which is also the static response at rest.
        kappa : float
            w / C.
        mach : float
            V / C.
        loss : float
            w c.
        """
        # eq. (8)
        operator = (1 + 1j * loss) * np.eye(len(self.inertia)) - kappa**2 * self.inertia
        operator += 1j * kappa * mach * self.gyroscopic + mach**2 * self.transport
        return np.linalg.solve(operator, static)


@dataclass(frozen=True)
class InPlaneProblem:
    """The discretised in-plane problem of a plate.

    Parameters
    ----------
    r : float
        Aspect ratio a/b.
    nu : float
        Poisson's ratio.
    axial, lateral : int
        M + 1 and N + 1, trial functions of u and of v along x and across y.
    """

    r: float
    nu: float
    axial: int
    lateral: int

    @cached_property
    def subsystems(self) -> tuple[InPlaneSubsystem, InPlaneSubsystem]:
        """The symmetric subsystem (u even, v odd about the mid-line) and the antisymmetric one."""
        K, G, K_g = self._matrices()
        n = np.arange(self.lateral)
        antisymmetric = np.concatenate([np.tile(n % 2, self.axial), np.tile((n + 1) % 2, self.axial)])
        elastic = np.arange(antisymmetric.size) > 0  # all functions but the rigid translation, p_0 q_0 in u
        subsystems = []
        for parity in (0, 1):
            members = np.flatnonzero((antisymmetric == parity) & elastic)
            here = np.ix_(members, members)
            # K_ie = R^T R and z = R U: these coordinates stay accurate for a long plate (a soft beam), modes would not
            R = cholesky(K[here])
            inverse = solve_triangular(R, np.eye(members.size))
            shapes = np.zeros((antisymmetric.size, members.size))
            shapes[members] = inverse
            matrices = (inverse.T @ inverse, inverse.T @ G[here] @ inverse, inverse.T @ K_g[here] @ inverse)
            subsystems.append(InPlaneSubsystem(shapes, *matrices))
        return subsystems[0], subsystems[1]

    @property
    def divergence_speed(self) -> float:
        """The smallest V / C at which I + (V/C)^2 K_ig is singular: the plate diverges in its own plane."""
        squares = np.concatenate([np.linalg.eigvals(-subsystem.transport) for subsystem in self.subsystems])
        real = squares.real[(np.abs(squares.imag) <= REAL_EIGENVALUE_TOLERANCE * np.abs(squares)) & (squares.real > 0)]
        return 1 / math.sqrt(real.max()) if real.size else math.inf

    def force(self, load: Distribution) -> FloatArray:
        """Return the edge force f [phi(r, Y) - phi(0, Y)] on each coefficient, shape (coefficients,)."""
        m = np.arange(self.axial)
        rise = np.where(m % 2 == 1, 2 * np.sqrt((2 * m + 1) / self.r), 0.0)  # p_m(r) - p_m(0)
        projection = load.projection(self.lateral)
        # a load symmetric about the mid-line excites only even functions, exactly
        projection[np.abs(projection) < LOAD_COEFFICIENT_TOLERANCE * np.abs(projection).max()] = 0.0
        on_u = np.outer(rise, projection).ravel()
        return np.concatenate([on_u, np.zeros_like(on_u)])

    def static_response(self, force: NumericArray) -> NumericArray:
        """Return the coefficients of u and v, multiplied by beta, without inertia and transport: K_ie^-1 force."""
        return sum((part.shapes @ (part.shapes.T @ force) for part in self.subsystems), np.zeros_like(force))

    def response(self, force: NumericArray, kappa: float, mach: float, loss: float) -> ComplexArray:
        """Return the coefficients of u and v, multiplied by beta (1 + i w c); arguments as `InPlaneSubsystem.solve`."""
        coefficients = np.zeros(force.shape, dtype=np.complex128)
        for subsystem in self.subsystems:
            coefficients += subsystem.shapes @ subsystem.solve(subsystem.shapes.T @ force, kappa, mach, loss)
        return (1 + 1j * loss) * coefficients

    def stress_stiffness(self, coefficients: NumericArray, K: int, lateral: int) -> NumericArray:
        """Return F of eq. (11) for the stresses of these coefficients, shape (..., K lateral, K lateral)."""
        X_rule, Y_rule = stress_quadrature(K, lateral, self.r, (self.axial, self.lateral))
        return stress_stiffness(self.stresses(coefficients, X_rule[0], Y_rule[0]), X_rule, Y_rule, K, lateral, self.r)

    def stresses(self, coefficients: NumericArray, X: FloatArray, Y: FloatArray) -> NumericArray:
        """Return N_xx, N_yy, N_xy of eq. (3) on a grid, shape (..., 3, X.size, Y.size).

        Parameters
        ----------
        coefficients : ndarray, shape (..., coefficients)
            Of u and v, multiplied by beta (1 + i w c).
        X : ndarray, shape (p,)
            Places from 0 to r.
        Y : ndarray, shape (q,)
            Places from 0 to 1.
        """
        A, B = np.moveaxis(coefficients.reshape(*coefficients.shape[:-1], 2, self.axial, self.lateral), -3, 0)
        p = legendre(X / self.r, self.axial) / math.sqrt(self.r)
        p_X = p @ legendre_derivative(self.axial) / self.r
        s, s_X = sines(X, self.axial, self.r), sine_slopes(X, self.axial, self.r)
        q = legendre(Y, self.lateral)
        q_Y = q @ legendre_derivative(self.lateral)
        u_X, u_Y, v_X, v_Y = p_X @ A @ q.T, p @ A @ q_Y.T, s_X @ B @ q.T, s @ B @ q_Y.T
        nu = self.nu
        return np.stack([u_X + nu * v_Y, v_Y + nu * u_X, (1 - nu) / 2 * (u_Y + v_X)], axis=-3)

    def growth(self, mach: float, loss_time: float) -> complex:
        """Return the exponent, divided by C, of the in-plane mode that grows fastest; 0 where none grows.

        Arguments as `InPlaneSubsystem.exponents`. (2a, b) move material through ends at which u is free. That is not
        conservative: pairs of modes may flutter. The growth of the highest modes of the discretised problem is
        spurious: it rises with the number of functions.
        """
        exponents = np.concatenate([part.exponents(mach, loss_time) for part in self.subsystems])
        growing = exponents[exponents.real > GROWTH_TOLERANCE * np.abs(exponents)]
        return complex(growing[np.argmax(growing.real)]) if growing.size else 0j

    def _matrices(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return K_ie / beta, G_i and K_ig of eq. (8)."""
        nu, one_x, one_y = self.nu, np.eye(self.axial), np.eye(self.lateral)
        P = legendre_derivative(self.axial) / self.r  # p' in terms of p
        D = legendre_derivative(self.lateral)
        S = sine_derivative(self.axial, self.r)
        alpha2 = np.diag(sine_wavenumbers(self.axial, self.r) ** 2)
        slope_sine = P.T @ sine_legendre(self.axial, self.axial)  # (s, p') = -(s', p), since s is zero at the ends
        shear = (1 - nu) / 2
        K_uu = kronecker(P.T @ P, one_y) + shear * kronecker(one_x, D.T @ D)  # (u_X, phi_X), (u_Y, phi_Y)
        K_vv = kronecker(one_x, D.T @ D) + shear * kronecker(alpha2, one_y)  # (v_Y, psi_Y), (v_X, psi_X)
        K_uv = kronecker(slope_sine, nu * D - shear * D.T)  # nu (v_Y, phi_X), (v_X, phi_Y)
        G = block_diag(2 * kronecker(P, one_y), 2 * kronecker(S, one_y))  # 2 (u_X, phi), 2 (v_X, psi)
        K_g = block_diag(kronecker(P @ P, one_y), kronecker(-alpha2, one_y))  # (u_XX, phi), (v_XX, psi)
        return np.block([[K_uu, K_uv], [K_uv.T, K_vv]]), G, K_g


@lru_cache(maxsize=8)
def inplane_problem(r: float, nu: float, axial: int, lateral: int) -> InPlaneProblem:
    """Return the problem of these parameters, shared by all plates that have them: its matrices are worked out once."""
    return InPlaneProblem(r, nu, axial, lateral)
