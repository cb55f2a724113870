"""Transition curves by the method of multiple scales: eqs. (24)-(28), first order in eps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray, interval, one_of, real_array, whole_number
from periodic.system import SYMMETRY_TOLERANCE
from perturb.coupling import amplitude, products
from perturb.curve import TransitionCurve
from perturb.modes import REPEATED, ComplexArray, GyroscopicModes, gyroscopic_modes
from perturb.pair import pair_edges, pair_edges_vanishing, pair_growth, pair_slope, pair_tip

KINDS = ("sum", "difference")


class Resonances(NamedTuple):
    """All resonances with centre in a range, as arrays of equal length."""

    p: NDArray[np.intp]  # from 0, as q
    q: NDArray[np.intp]
    j: NDArray[np.intp]
    kind: NDArray[np.str_]
    centre: FloatArray


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """A resonant pair to first order (`perturb.curve.Resonance`).

    Attributes
    ----------
    kind : {"sum", "difference"}
    L : ndarray, shape (), complex
        Lambda_pq conj(Lambda_qp).
    C_p, C_q : ndarray, shape ()
        Decay coefficients of the two modes.
    vanishing : (c_p, c_q) or None
        Proportion in which the damping has vanished, for the literal eq. (25) at c = 0.
    """

    kind: str
    L: ComplexArray
    C_p: FloatArray
    C_q: FloatArray
    vanishing: tuple[FloatArray, FloatArray] | None = None

    @property
    def slope(self) -> float:
        return float(pair_slope(*(self.vanishing or (self.C_p, self.C_q)), self.L))

    @property
    def tip(self) -> float:
        return float(pair_tip(self.C_p, self.C_q, self.L))

    def edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        if self.kind == "difference" and self.L == 0:
            return np.full_like(eps, np.nan), np.full_like(eps, np.nan)
        if self.vanishing:
            return pair_edges_vanishing(*self.vanishing, eps**2 * self.L)
        return pair_edges(self.C_p, self.C_q, eps**2 * self.L)

    def growth(self, s: FloatArray, eps: FloatArray) -> FloatArray:
        return pair_growth(self.C_p, self.C_q, eps**2 * self.L, s)


def transition_curves(
    family: SystemFamily,
    Omega_range: tuple[float, float],
    order: int = 1,
    kinds: Sequence[str] = KINDS,
    *,
    vanishing_damping: ArrayLike | None = None,
) -> list[TransitionCurve]:
    """Return the transition curves of all resonances with centre in ``Omega_range``.

    First order treats every pair of modes (p, q) and harmonic j on its own, as eqs. (24)-(28) do, with the excitation
    taken at the centre of the region. Second order (`perturb.second_order`) adds frequency shift and curvature, the
    regions of j = j1 + j2, and the interaction of resonances that lie close together.

    Parameters
    ----------
    family : SystemFamily
        A `PeriodicSystem`, or anything with ``at(Omega)``. The stiffness must be symmetric positive definite and the
        damping must not feed energy into a mode.
    Omega_range : (low, high)
        Excitation frequencies, 0 <= low < high.
    order : {1, 2}
        Order of the theory in eps.
    kinds : sequence of {"sum", "difference"}
        j Omega = omega_p + omega_q, j Omega = omega_p - omega_q.
    vanishing_damping : array_like, shape (n, n), optional
        Shape D of a damping matrix c D whose c -> 0: gives the literal eqs. (25), (27) at c = 0, whose edges lie
        further out than the undamped ones (the default) by (c_p + c_q) / (2 sqrt(c_p c_q)). For an undamped system at
        first order.

    Returns
    -------
    list of TransitionCurve
        By increasing centre. A region that is closed for every eps, such as those of difference type for symmetric
        excitation matrices, is in the list with slope 0 and tip infinite.

    Raises
    ------
    ValueError
        If an argument has the wrong type, value or shape; if the stiffness is not symmetric positive definite; if the
        damping makes a mode grow.

    Notes
    -----
    Young, Huang and Chiu, eqs. (24)-(28). With L = Lambda_pq conj(Lambda_qp) and decay coefficients C_p, C_q,

    - damped: j Omega = omega_p ± omega_q ± (C_p + C_q)/2 sqrt(eps^2 L / (C_p C_q) - 1), closed below
      eps = sqrt(C_p C_q / L);
    - undamped: j Omega = omega_p ± omega_q ± eps sqrt(L);
    - complex L (unsymmetric excitation matrices) and C_p C_q = 0: `perturb.pair.pair_edges`.
    """
    low, high = interval("Omega_range", Omega_range, nonnegative=True)
    order = whole_number("order", order, least=1, most=1)
    kinds = _checked_kinds(kinds)
    system = _system_at(family, high)
    modes = gyroscopic_modes(system)
    if (modes.decay < 0).any():
        n = int(np.argmin(modes.decay))
        raise ValueError(
            f"damping makes mode {n + 1} grow (decay coefficient {modes.decay[n]:.3g}); the perturbation theory needs "
            "damping that takes energy from every mode (floquet/ takes any)"
        )
    proportion = _proportion(vanishing_damping, modes, order)
    found = find_resonances(modes, system.harmonics, (low, high), kinds)
    L = _products_at_centres(family, modes, found)
    C = modes.decay
    return [
        TransitionCurve(
            p=int(p) + 1,
            q=int(q) + 1,
            j=int(j),
            kind=str(kind),
            order=1,
            interaction=1,
            centre=float(centre),
            resonance=FirstOrder(
                str(kind), value, C[p], C[q], None if proportion is None else (proportion[p], proportion[q])
            ),
        )
        for p, q, j, kind, centre, value in zip(*found, L, strict=True)
    ]


def find_resonances(
    modes: GyroscopicModes, multiples: int, Omega_range: tuple[float, float], kinds: Sequence[str]
) -> Resonances:
    """Return all p >= q, j <= ``multiples`` with (omega_p ± omega_q) / j in the range, by increasing centre.

    A difference of one repeated frequency is none.
    """
    omega, j = modes.frequencies, np.arange(1, multiples + 1)
    p, q = np.tril_indices(len(omega))
    parts = []
    for kind in kinds:
        total = omega[p] + omega[q] if kind == "sum" else omega[p] - omega[q]
        centre = total / j[:, None]
        wanted = (total > REPEATED * omega[-1]) & (centre >= Omega_range[0]) & (centre <= Omega_range[1])
        row, pair = np.nonzero(wanted)
        parts.append(Resonances(p[pair], q[pair], j[row], np.full(len(row), kind), centre[wanted]))
    joined = [np.concatenate(column) for column in zip(*parts, strict=True)]
    by_centre = np.argsort(joined[-1], kind="stable")
    return Resonances(*(column[by_centre] for column in joined))


def _products_at_centres(family: SystemFamily, modes: GyroscopicModes, found: Resonances) -> ComplexArray:
    """Return L of every resonance, from the excitation at its centre."""
    L = np.zeros(len(found.p), dtype=complex)
    members: dict[
        int, tuple[PeriodicSystem, list[int]]
    ] = {}  # a family without frequency dependence returns one object
    for k, centre in enumerate(found.centre.tolist()):
        system = _system_at(family, centre)
        members.setdefault(id(system), (system, []))[1].append(k)
    for system, indices in members.values():
        chosen = np.array(indices)
        for j, kind in sorted(set(zip(found.j[chosen].tolist(), found.kind[chosen].tolist(), strict=True))):
            of_kind = chosen[(found.j[chosen] == j) & (found.kind[chosen] == kind)]
            L[of_kind] = products(modes, amplitude(system, j), kind)[found.p[of_kind], found.q[of_kind]]
    return L


def _checked_kinds(kinds: Any) -> tuple[str, ...]:
    if isinstance(kinds, str) or not hasattr(kinds, "__iter__"):
        raise ValueError(f"kinds = {kinds!r} is not a sequence; give some of {KINDS}")
    names = tuple(one_of("kinds", kind, KINDS) for kind in kinds)
    if not names or len(set(names)) < len(names):
        raise ValueError(f"kinds = {kinds!r} is empty or repeats itself; give some of {KINDS}")
    return names


def _system_at(family: Any, Omega: float) -> PeriodicSystem:
    if not callable(getattr(family, "at", None)):
        raise ValueError(f"family = {family!r} has no method at(Omega); give a PeriodicSystem or a SystemFamily")
    system = family.at(Omega)
    if not isinstance(system, PeriodicSystem):
        raise ValueError(f"family.at({Omega!r}) = {system!r} is not a PeriodicSystem; let it return one")
    return system


def _proportion(D: ArrayLike | None, modes: GyroscopicModes, order: int) -> FloatArray | None:
    """Return the decay coefficients of the vanishing damping."""
    if D is None:
        return None
    matrix = real_array("vanishing_damping", D, 2)
    n = len(modes.frequencies)
    if matrix.shape != (n, n):
        raise ValueError(f"vanishing_damping has shape {matrix.shape}; give ({n}, {n}), as the mass matrix has")
    if np.abs(matrix - matrix.T).max() > SYMMETRY_TOLERANCE * np.abs(matrix).max():
        raise ValueError("vanishing_damping is not symmetric; give a symmetric matrix")
    if order != 1 or modes.decay.any():
        raise ValueError("vanishing_damping is for undamped systems at order = 1; leave it out")
    proportion = modes.decay_coefficients(matrix)
    if (proportion < 0).any():
        raise ValueError("vanishing_damping makes a mode grow; give a positive semidefinite matrix")
    return proportion
