"""The transition curves of a system: every resonance of a range, described to first or second order in eps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import ComplexArray, FloatArray, interval, one_of, real_array, whole_number
from periodic.system import SYMMETRY_TOLERANCE
from perturb.coupling import amplitude, products
from perturb.curve import Prediction, TransitionCurve
from perturb.modes import GyroscopicModes, gyroscopic_modes
from perturb.resonance import TYPES, Resonances, find_resonances
from perturb.resonant_pair import ResonantPair
from perturb.resonant_states import Expansion, ResonantStates, same_excitation


def transition_curves(
    family: SystemFamily,
    Omega_range: tuple[float, float],
    order: int = 1,
    types: Sequence[str] = TYPES,
    *,
    vanishing_damping: ArrayLike | None = None,
) -> list[TransitionCurve]:
    """Return the transition curves of all resonances with centre in ``Omega_range``.

    First order treats every pair of modes (p, q) and harmonic j on its own, as eqs. (24)-(28) do, with the excitation
    taken at the centre of the region. Only modes of one repeated frequency act together. Second order
    (`perturb.resonant_states`) adds frequency shift and curvature, the regions of j = j1 + j2, and the interaction of
    resonances that lie close together or coincide.

    Parameters
    ----------
    family : SystemFamily
        A `PeriodicSystem`, or anything with ``at(Omega)``. The stiffness must be symmetric positive definite and the
        damping must not feed energy into a mode.
    Omega_range : (low, high)
        Excitation frequencies, 0 <= low < high.
    order : {1, 2}
        Order of the theory in eps.
    types : sequence of {"sum", "difference"}
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
    order = whole_number("order", order, least=1, most=2)
    types = _checked_types(types)
    system = member_at(family, high, "family")
    modes = gyroscopic_modes(system)
    if (modes.decay < 0).any():
        n = int(np.argmin(modes.decay))
        raise ValueError(
            f"damping makes mode {n + 1} grow (decay coefficient {modes.decay[n]:.3g}); the perturbation theory needs "
            "damping that takes energy from every mode (floquet/ takes any)"
        )
    proportion = _proportion(vanishing_damping, modes, order)
    direct = {j for j in range(1, system.harmonics + 1) if amplitude(system, j).any()}
    multiples = set(range(1, system.harmonics + 1))
    if order == 2:
        multiples |= {a + b for a in direct for b in direct}
    found = find_resonances(modes, sorted(multiples), (low, high), types)
    L = _products_at_centres(family, modes, found)
    expansion, repeated = Expansion(family, modes), modes.repeated.tolist()
    curves = []
    for resonance, value in zip(found.rows(), L, strict=True):
        p, q = resonance.p - 1, resonance.q - 1
        vanishing = None if proportion is None else (proportion[p], proportion[q])
        prediction: Prediction = ResonantPair(resonance.type, value, modes.decay[p], modes.decay[q], vanishing)
        if (repeated[p] or repeated[q]) and vanishing is None:
            prediction = ResonantStates(expansion, resonance, 1, prediction)
        if order == 2:
            prediction = ResonantStates(expansion, resonance, 2, prediction)
        interaction = 1 if order == 1 or resonance.j in direct else 2
        curves.append(TransitionCurve(resonance, order, interaction, prediction))
    return curves


def _products_at_centres(family: SystemFamily, modes: GyroscopicModes, found: Resonances) -> ComplexArray:
    """Return L of every resonance, from the excitation at its centre; 0 where the excitation has no such harmonic."""
    L = np.zeros(len(found.p), dtype=complex)
    for run, system in _shared_systems(family, found.centre):
        for j in range(1, system.harmonics + 1):
            for type in TYPES:
                chosen = run[(found.j[run] == j) & (found.type[run] == type)]
                if len(chosen):
                    L[chosen] = products(modes, amplitude(system, j), type)[found.p[chosen] - 1, found.q[chosen] - 1]
    return L


def _shared_systems(family: SystemFamily, centres: FloatArray) -> Iterator[tuple[NDArray[np.intp], PeriodicSystem]]:
    """Return runs of neighbouring centres (their indices) at which the excitation is the same, each with its system."""
    start, shared = 0, None
    for k, centre in enumerate(centres.tolist()):
        system = member_at(family, centre, "family")
        if shared is not None and not same_excitation(system, shared):
            yield np.arange(start, k), shared
            start, shared = k, system
        shared = shared or system
    if shared is not None:
        yield np.arange(start, len(centres)), shared


def _checked_types(types: Any) -> tuple[str, ...]:
    if isinstance(types, str) or not hasattr(types, "__iter__"):
        raise ValueError(f"types = {types!r} is not a sequence; give some of {TYPES}")
    names = tuple(one_of("types", type, TYPES) for type in types)
    if not names or len(set(names)) < len(names):
        raise ValueError(f"types = {types!r} is empty or repeats itself; give some of {TYPES}")
    return names


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
