"""The standard linear solid: damping that relaxes, for any family with Kelvin–Voigt damping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from periodic.checks import FloatArray, real_number
from periodic.family import SystemFamily, any_member_at
from periodic.first_order import FirstOrderSystem
from periodic.system import PeriodicSystem
from periodic.terms import Term

# Eigenvalues of the damping below this part of the largest one are rounding, for each coordinate.
DAMPING_ROUNDING = 1e-14


@dataclass(frozen=True)
class StandardLinearSolid:
    """A family whose dashpots are in series with springs: standard linear solid (Zener) in place of Kelvin–Voigt.

    The force of the damping matrix C relaxes: C W' becomes F with time F' + F = C W'. Slow motions are damped as
    before, fast ones meet the stiffness C / time besides K. What is left of F is in as many further states as C has
    rank, so that the members are of first order: x = (W', W, Y), the force being R Y / sqrt(time) with C = R R^T.

    Parameters
    ----------
    family : SystemFamily
        Its members have a constant damping matrix, positive semidefinite, and a constant mass.
    time : float
        Relaxation time > 0, in the family's unit of time. It tends to Kelvin–Voigt as ``time`` tends to 0.

    Raises
    ------
    ValueError
        If ``time`` is no positive number, or the family damps the rate of strain of a particle: that of a memory that
        moves along is not offered. By `at`: if damping is negative somewhere or depends on time, or mass does.

    Notes
    -----
    All of the family's damping relaxes, also that of its surroundings.

    Source: the three-parameter solid of viscoelasticity, e.g. W. N. Findley, J. S. Lai, K. Onaran, Creep and Relaxation
    of Nonlinear Viscoelastic Materials (1976), chapter 5.

    Examples
    --------
    >>> from periodic.examples import mathieu
    >>> StandardLinearSolid(mathieu(damping=0.1), time=0.5).at(2.0).size
    3
    """

    family: SystemFamily
    time: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", real_number("time", self.time, positive=True))
        derivative = getattr(self.family, "derivative", "partial")
        if derivative != "partial":
            raise ValueError(
                f"family has derivative = {derivative!r}, but memory is kept at a place; give one with 'partial'"
            )

    def at(self, Omega: float) -> FirstOrderSystem:
        """Return the member at excitation frequency ``Omega``, of size 2 n + rank of the damping."""
        member: Any = any_member_at(self.family, Omega, "family")
        if not isinstance(member, PeriodicSystem):
            raise ValueError("family is of first order and has no damping matrix; give one of second order")
        for term in member.terms:
            if term.of in ("mass", "damping"):
                raise ValueError(f"family has a {term.of} that depends on time; give one with a constant {term.of}")
        n, R = member.size, _root(member.damping) / np.sqrt(self.time)
        r = R.shape[1]
        inverse = np.linalg.inv(member.mass)

        def state(on_velocity: FloatArray, on_place: FloatArray, on_memory: FloatArray) -> FloatArray:
            """Return the rows of W'' from what acts on W', W and Y."""
            rows = -inverse @ np.hstack([on_velocity, on_place, on_memory])
            return np.vstack([rows, np.zeros((n + r, 2 * n + r))])

        no, none = np.zeros((n, n)), np.zeros((n, r))
        A = state(member.gyroscopic, member.stiffness, R)
        A[n : 2 * n, :n] = np.eye(n)
        A[2 * n :, :n] = R.T
        A[2 * n :, 2 * n :] = -np.eye(r) / self.time
        return FirstOrderSystem(
            A,
            [state(no, X, none) for X in member.cosine],
            [state(no, X, none) for X in member.sine],
            terms=[
                Term(
                    "state",
                    state(no, term.matrix, none) if term.of == "stiffness" else state(term.matrix, no, none),
                    term.waveform,
                    term.power,
                )
                for term in member.terms
            ],
        )


def _root(C: FloatArray) -> FloatArray:
    """Return R with C = R R^T and as many columns as C has rank, shape (n, rank)."""
    sizes, vectors = np.linalg.eigh(C)
    rounding = DAMPING_ROUNDING * len(C) * float(np.abs(sizes).max())
    if sizes[0] < -rounding:
        raise ValueError(
            f"damping of the family has the eigenvalue {sizes[0]:.6g}; a dashpot cannot be negative, give a positive "
            "semidefinite matrix"
        )
    kept = sizes > rounding
    return vectors[:, kept] * np.sqrt(sizes[kept])
