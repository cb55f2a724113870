"""Coordinates without mass: massless rotations, lag states, springs in series with dashpots."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, real_array
from periodic.first_order import FirstOrderSystem
from periodic.system import PeriodicSystem
from periodic.terms import Term, checked_terms, harmonics, square, symmetric
from periodic.waveforms import Impulses
from periodic.waveforms import cosine as cosine_wave
from periodic.waveforms import sine as sine_wave

# A direction has no mass if what it has is below this part of the largest, coordinates scaled to equal mass; and a
# matrix does not act on it if what it does is below this part of its norm.
MASSLESS_ROUNDING = 1e-13


class Condensed(NamedTuple):
    """A system without massless coordinates.

    Attributes
    ----------
    system : PeriodicSystem or FirstOrderSystem
    coordinates : ndarray, shape (n, m)
        The coordinates that were given are ``coordinates`` times those of ``system``, or times its states.
    said : str
        What was done, in one sentence.
    """

    system: PeriodicSystem | FirstOrderSystem
    coordinates: FloatArray
    said: str


def without_massless(
    mass: ArrayLike,
    gyroscopic: ArrayLike | None = None,
    damping: ArrayLike | None = None,
    stiffness: ArrayLike | None = None,
    cosine: ArrayLike | None = None,
    sine: ArrayLike | None = None,
    *,
    terms: Iterable[Term] = (),
) -> Condensed:
    """Return a system with a singular mass matrix without the coordinates that have no mass.

    Where no damping or gyroscopic matrix acts on them and their stiffness is constant, they follow the others at once
    and are condensed. Where damping acts on all of them, they are states of their own in a system of first order.

    Parameters
    ----------
    mass, gyroscopic, damping, stiffness, cosine, sine, terms
        As those of `PeriodicSystem`; ``mass`` is symmetric positive semidefinite.

    Returns
    -------
    Condensed

    Raises
    ------
    ValueError
        If a matrix has the wrong shape or symmetry; if mass is indefinite; if the motion of the massless coordinates
        is not determined, or would need products of terms that depend on time.
    """
    M = real_array("mass", mass, 2)
    n = len(M)
    M = symmetric("mass", square("mass", M, n), 1)
    heavy, light = _directions(M)
    given = [
        np.zeros((n, n)) if x is None else square(name, real_array(name, x, 2), n)
        for name, x in (("gyroscopic", gyroscopic), ("damping", damping), ("stiffness", stiffness))
    ]
    velocity, K = given[0] + given[1], given[2]
    parts = list(checked_terms(terms, n, ("mass", "gyroscopic", "damping", "stiffness")))
    for name, matrices, wave in (("cosine", cosine, cosine_wave), ("sine", sine, sine_wave)):
        if matrices is not None:
            parts += [Term("stiffness", X, wave(j)) for j, X in enumerate(harmonics(name, matrices, n), start=1)]
    if not light.shape[1]:
        system = PeriodicSystem(M, given[0], given[1], K, terms=parts)
        return Condensed(system, np.eye(n), f"All {n} coordinates have mass; nothing was condensed.")
    for term in parts:
        if term.of == "mass" and _acts(term.matrix, light):
            raise ValueError(
                "a mass term acts on a coordinate without mass; give a mass matrix that is positive definite"
            )
    count = light.shape[1]
    touched = [term for term in parts if _acts(term.matrix, light)]
    if not _acts(velocity, light) and not touched:
        return _condensed(M, given, parts, heavy, light)
    drag = light.T @ velocity @ light
    if np.linalg.cond(drag) * MASSLESS_ROUNDING < 1:
        return _first_order(M, velocity, K, parts, heavy, light)
    raise ValueError(
        f"mass has {count} directions without mass, and damping acts on some of them only or not at all while the "
        "excitation does; give them a small mass, damping on all of them, or write the equations as a FirstOrderSystem"
    )


def _directions(M: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a basis (n, n - r) of directions with mass, and one (n, r) of those without."""
    diagonal = np.diagonal(M)
    if (diagonal < 0).any():
        raise ValueError(
            f"mass has the diagonal entry {float(diagonal.min()):.6g}; give a positive semidefinite matrix"
        )
    scale = np.where(diagonal > 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 1.0)
    sizes, vectors = np.linalg.eigh(scale[:, None] * M * scale)
    if sizes[0] < -MASSLESS_ROUNDING * len(M) or sizes[-1] <= 0:
        raise ValueError(
            f"mass has the lowest eigenvalue {sizes[0]:.6g} where its diagonal is one; "
            "give a positive semidefinite matrix that is not zero"
        )
    light = sizes <= MASSLESS_ROUNDING * len(M)
    return scale[:, None] * vectors[:, ~light], scale[:, None] * vectors[:, light]


def _acts(matrix: FloatArray, light: FloatArray) -> bool:
    size = MASSLESS_ROUNDING * float(np.abs(matrix).max()) * float(np.abs(light).sum())
    return bool(max(np.abs(matrix @ light).max(), np.abs(light.T @ matrix).max()) > size)


def _condensed(
    M: FloatArray, given: list[FloatArray], parts: list[Term], heavy: FloatArray, light: FloatArray
) -> Condensed:
    G, C, K = given
    restoring = light.T @ K @ light
    if np.linalg.cond(restoring) * MASSLESS_ROUNDING >= 1:
        raise ValueError("a coordinate without mass has no stiffness; nothing determines its motion, leave it out")
    follow = heavy - light @ np.linalg.solve(restoring, light.T @ K @ heavy)
    lead = heavy - light @ np.linalg.solve(restoring.T, light.T @ K.T @ heavy)
    M, G, C = (heavy.T @ X @ heavy for X in (M, G, C))
    terms = [Term(t.of, heavy.T @ t.matrix @ heavy, t.waveform, t.power) for t in parts]
    system = PeriodicSystem(M, G, C, lead.T @ K @ follow, terms=terms)
    said = (
        f"{light.shape[1]} of {len(heavy)} coordinates have no mass, damping or excitation; "
        "they follow the others by their stiffness and were condensed."
    )
    return Condensed(system, follow, said)


def _first_order(
    M: FloatArray, velocity: FloatArray, K: FloatArray, parts: list[Term], heavy: FloatArray, light: FloatArray
) -> Condensed:
    """Write x = (y', y, z), W = heavy y + light z, as a first-order system."""
    for term in parts:
        if term.of == "mass":
            raise ValueError("a mass term beside massless coordinates needs products of terms; use FirstOrderSystem")
        if term.of != "stiffness" and np.abs(term.matrix @ light).max() > 0 and _acts(term.matrix, light):
            raise ValueError(
                f"a {term.of} term acts on a coordinate without mass; its motion needs a quotient of terms, "
                "write the equations as a FirstOrderSystem"
            )
        if isinstance(term.waveform, Impulses) and _acts(term.matrix, light):
            raise ValueError("impulses act on a coordinate without mass; it would jump, give it a mass")
    h, r = heavy.shape[1], light.shape[1]
    drag, pull = light.T @ velocity @ light, heavy.T @ velocity @ light
    inertia = heavy.T @ M @ heavy

    def state(on_velocity: FloatArray, on_place: FloatArray, unit: float) -> FloatArray:
        """Return the rows of y'', y', z' from what multiplies W' and W; ``unit`` is one for the constant part."""
        toward = np.hstack([light.T @ on_velocity @ heavy, light.T @ on_place @ heavy, light.T @ on_place @ light])
        z = -np.linalg.solve(drag, toward)
        force = np.hstack([heavy.T @ on_velocity @ heavy, heavy.T @ on_place @ heavy, heavy.T @ on_place @ light])
        y = np.hstack([unit * np.eye(h), np.zeros((h, h + r))])
        return np.vstack([-np.linalg.solve(inertia, force + pull @ z), y, z])

    zero = np.zeros_like(K)
    terms = [
        Term(
            "state",
            state(zero, t.matrix, 0.0) if t.of == "stiffness" else state(t.matrix, zero, 0.0),
            t.waveform,
            t.power,
        )
        for t in parts
    ]
    said = (
        f"{r} of {len(K)} coordinates have no mass but damping; the system was written in the {2 * h + r} states "
        "velocity and place of the others, and place of these."
    )
    system = FirstOrderSystem(state(velocity, K, 1.0), terms=terms)
    return Condensed(system, np.hstack([np.zeros((len(K), h)), heavy, light]), said)
