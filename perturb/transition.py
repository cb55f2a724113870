"""The transition curves of a system: every resonance of a range, described to first or second order in eps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from periodic import AnyFamily, AnySystem, PeriodicSystem, SystemFamily, any_member_at, has_stiffness_alone, member_at
from periodic.checks import (
    ComplexArray,
    FloatArray,
    interval,
    is_positive_definite,
    one_of,
    real_array,
    whole_number,
)
from periodic.system import SYMMETRY_TOLERANCE
from perturb.campbell import campbell_resonances
from perturb.coupling import amplitude, products
from perturb.curve import Prediction, TransitionCurve
from perturb.effective_matrix import alone, expansion_range, in_company
from perturb.expansion import Expansion, modal_equations, same_matrices, same_modes
from perturb.general import general_transition_curves
from perturb.modes import GyroscopicModes, gyroscopic_modes
from perturb.pair import Detuning
from perturb.resonance import TYPES, Resonance, Resonances, find_resonances
from perturb.resonant_pair import ResonantPair
from perturb.resonant_states import ResonantStates


def transition_curves(
    family: AnyFamily,
    Omega_range: tuple[float, float],
    order: int = 1,
    types: Sequence[str] = TYPES,
    *,
    vanishing_damping: ArrayLike | None = None,
) -> list[TransitionCurve]:
    """Return the transition curves of all resonances with centre in ``Omega_range``.

    First order treats a resonance by itself, as eqs. (24)-(28) do, with the excitation taken at the centre of the
    region. Resonances that coincide, or nearly, and are coupled are taken together (`TransitionCurve.coincident`).
    Second order adds frequency shift and curvature, and the regions of j = j1 + j2 (`perturb.effective_matrix`).

    If the modes depend on Omega, as those of a rotor do, the centre solves j Omega = omega_p(Omega) ± omega_q(Omega),
    and the width is divided by d(j Omega - omega_p ∓ omega_q) / d Omega. A resonance with several solutions has a curve
    for each. Where the two sides touch, the region is as wide as the square root of eps and the slope is infinite.
    Where they come near each other without meeting there is no curve, although a larger eps may open a region there.

    Systems of the form of eq. (11) are expanded about their undamped modes. What has other terms, an unsymmetric or
    indefinite stiffness, damping that feeds energy, or is of first order, is expanded about the right and left
    eigenvectors of its constant part, damping included (`perturb.general`): damping need not be small, and modes are
    numbered by the imaginary parts of the eigenvalues. Of a waveform that is no finite Fourier sum, theory takes as
    many harmonics as its second order needs, at most 128.

    Parameters
    ----------
    family : AnyFamily
        A `PeriodicSystem`, a `FirstOrderSystem`, or anything with ``at(Omega)``; all matrices may depend on Omega.
    Omega_range : (low, high)
        Excitation frequencies, 0 <= low < high.
    order : {1, 2}
        Order of the theory in eps.
    types : sequence of {"sum", "difference"}
        j Omega = omega_p + omega_q, j Omega = omega_p - omega_q.
    vanishing_damping : array_like, shape (n, n), optional
        Shape D of a damping matrix c D whose c -> 0: gives the literal eqs. (25), (27) at c = 0, whose edges lie
        further out than the undamped ones (the default) by (c_p + c_q) / (2 sqrt(c_p c_q)). For an undamped system of
        the form of eq. (11) at first order.

    Returns
    -------
    list of TransitionCurve
        By increasing centre. A region that is closed for every eps, such as those of difference type for symmetric
        excitation matrices, is in the list with slope 0 and tip infinite. So is one whose modes act in other resonances
        of the same frequency only.

    Raises
    ------
    ValueError
        If an argument has the wrong type, value or shape; if frequencies change too fast with Omega; if an eigenvalue
        of the constant part is defective, or the mass jumps (`perturb.general`).

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
    members = [any_member_at(family, at, "family") for at in (high, 0.5 * (low + high), low)]
    if not all(_is_of_eq_11(member) for member in {id(member): member for member in members}.values()):
        if vanishing_damping is not None:
            raise ValueError("vanishing_damping is for undamped systems of the form of eq. (11); leave it out")
        return general_transition_curves(family, (low, high), order, types)
    return _paper_curves(cast(SystemFamily, family), (low, high), order, types, vanishing_damping)


def _is_of_eq_11(system: AnySystem) -> bool:
    """Whether only the stiffness depends on time, and the undamped modes of eqs. (14)-(16) exist and none is fed."""
    if not has_stiffness_alone(system):
        return False
    K = system.stiffness
    if np.abs(K - K.T).max() > SYMMETRY_TOLERANCE * np.abs(K).max() or not is_positive_definite(0.5 * (K + K.T)):
        return False
    C = system.damping
    return not C.any() or is_positive_definite(C) or bool((gyroscopic_modes(system).decay >= 0).all())


def _paper_curves(
    family: SystemFamily,
    window: tuple[float, float],
    order: int,
    types: tuple[str, ...],
    vanishing_damping: ArrayLike | None,
) -> list[TransitionCurve]:
    """Return the transition curves of systems of the form of eq. (11)."""
    low, high = window
    system = member_at(family, high, "family")
    fixed = same_modes(system, member_at(family, 0.5 * (low + high), "family"))
    expansion = Expansion(family, gyroscopic_modes(system) if fixed else None)
    direct = {j for j in range(1, system.harmonics + 1) if amplitude(system, j).any()}
    multiples = set(range(1, system.harmonics + 1))
    if order == 2:
        multiples |= {a + b for a in direct for b in direct}
    if expansion.modes is None:
        found = Resonances.of(campbell_resonances(family, sorted(multiples), window, types))
    else:
        found = find_resonances(expansion.modes, sorted(multiples), window, types)
    vanishing = _proportion(vanishing_damping, expansion, order)
    by_themselves, accompanied = _first_order(expansion, found, vanishing)
    curves = []
    for resonance, alone_theory, together in zip(found.rows(), by_themselves, accompanied, strict=True):
        first: Prediction = alone_theory
        if together and vanishing is None:
            first = ResonantStates(expansion, resonance, 1, multiples, alone_theory)
        second = None if vanishing is not None else ResonantStates(expansion, resonance, 2, multiples, first)
        interaction = 1 if order == 1 or resonance.j in direct else 2
        curves.append(TransitionCurve(resonance, order, interaction, first, second))
    return curves


def _first_order(
    expansion: Expansion, found: Resonances, vanishing: FloatArray | None
) -> tuple[list[ResonantPair], list[bool]]:
    """Return the theory of each resonance by itself, and whether others resonate with it."""
    if expansion.modes is None:
        rows = list(found.rows())
        return [_moving_pair(expansion, resonance) for resonance in rows], [True] * len(rows)
    _check_decay(expansion.modes)
    L, company = np.zeros(len(found.p), dtype=complex), np.zeros(len(found.p), dtype=bool)
    eps_max = np.zeros(len(found.p))
    for run, system in _shared_systems(expansion.family, found.centre):
        shared = found.at(run)
        L[run] = _products(expansion.modes, system, shared)
        equations = modal_equations(expansion.modes, system)
        eps_max[run] = expansion_range(equations, shared.p, shared.q)
        company[run] = in_company(equations, shared)
    decay = expansion.modes.decay
    alone = [
        ResonantPair(
            resonance.type,
            value,
            decay[resonance.p - 1],
            decay[resonance.q - 1],
            Detuning(resonance.j, 0.0),
            float(most),
            None if vanishing is None else (vanishing[resonance.p - 1], vanishing[resonance.q - 1]),
        )
        for resonance, value, most in zip(found.rows(), L, eps_max, strict=True)
    ]
    return alone, company.tolist()


def _moving_pair(expansion: Expansion, resonance: Resonance) -> ResonantPair:
    """Return the theory of one resonance by itself where the modes depend on Omega."""
    modes = expansion.modes_at(resonance.centre)
    _check_decay(modes)
    one = Resonances.of([resonance])
    (L,) = _products(modes, member_at(expansion.family, resonance.centre, "family"), one)
    p, q = resonance.p - 1, resonance.q - 1
    equations = expansion.equations(resonance.centre, 2)
    detuning = alone(equations, resonance, 2).detuning_of_pair
    eps_max = float(expansion_range(equations, one.p, one.q)[0])
    return ResonantPair(resonance.type, L, modes.decay[p], modes.decay[q], detuning, eps_max)


def _products(modes: GyroscopicModes, system: PeriodicSystem, found: Resonances) -> ComplexArray:
    """Return L of resonances that share one system; 0 where its excitation has no such harmonic."""
    L = np.zeros(len(found.p), dtype=complex)
    for j in range(1, system.harmonics + 1):
        for type in TYPES:
            chosen = np.flatnonzero((found.j == j) & (found.type == type))
            if len(chosen):
                L[chosen] = products(modes, amplitude(system, j), type)[found.p[chosen] - 1, found.q[chosen] - 1]
    return L


def _shared_systems(family: SystemFamily, centres: FloatArray) -> Iterator[tuple[NDArray[np.intp], PeriodicSystem]]:
    """Return runs of neighbouring centres (their indices) at which the excitation is the same, each with its system."""
    start, shared = 0, None
    for k, centre in enumerate(centres.tolist()):
        system = member_at(family, centre, "family")
        if shared is not None and not same_matrices(system, shared):
            yield np.arange(start, k), shared
            start, shared = k, system
        shared = shared or system
    if shared is not None:
        yield np.arange(start, len(centres)), shared


def _check_decay(modes: GyroscopicModes) -> None:
    if (modes.decay < 0).any():
        n = int(np.argmin(modes.decay))
        raise ValueError(
            f"damping makes mode {n + 1} grow (decay coefficient {modes.decay[n]:.3g}); the perturbation theory needs "
            "damping that takes energy from every mode (floquet/ takes any)"
        )


def _checked_types(types: Any) -> tuple[str, ...]:
    if isinstance(types, str) or not hasattr(types, "__iter__"):
        raise ValueError(f"types = {types!r} is not a sequence; give some of {TYPES}")
    names = tuple(one_of("types", type, TYPES) for type in types)
    if not names or len(set(names)) < len(names):
        raise ValueError(f"types = {types!r} is empty or repeats itself; give some of {TYPES}")
    return names


def _proportion(D: ArrayLike | None, expansion: Expansion, order: int) -> FloatArray | None:
    """Return the decay coefficients of the vanishing damping."""
    if D is None:
        return None
    matrix = real_array("vanishing_damping", D, 2)
    modes = expansion.modes
    if modes is None:
        raise ValueError("vanishing_damping is for families whose modes do not depend on Omega; leave it out")
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
