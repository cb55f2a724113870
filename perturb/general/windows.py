"""Where excitation stabilises: the growth rate to second order at any frequency, and its stable windows.

At a frequency Omega the states of A_0 fall into groups whose Im lam - h Omega nearly coincide for some h. Each group
has an effective matrix of second order, as a resonance has, and the largest real part of all their eigenvalues is the
growth rate. It covers what no resonance names: a fast excitation that holds up an inverted pendulum (two real
eigenvalues, in resonance with each other at every Omega), and an anti-resonance, where a damped mode takes the energy
that another one is fed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from periodic import AnyFamily
from periodic.checks import FloatArray, interval, real_number
from perturb.effective_matrix import NEAR_RESONANCE, State
from perturb.general.equations import GeneralEquations, GeneralExpansion
from perturb.general.resonant_states import effective_matrix_of

# A range is sampled at so many frequencies; a window that is narrower than their spacing may be missed.
WINDOW_SAMPLES = 241

# Bisections that take the spacing of the samples down to rounding.
WINDOW_BISECTIONS = 44

# Growth rates below this part of Omega are rounding of exponents that coincide without damping.
STABLE_PART = 1e-9


class StableWindow(NamedTuple):
    """An interval of frequencies in which the system is stable at one amplitude, to second order in eps.

    Attributes
    ----------
    lower, upper : float
        Its ends; infinite where it reaches beyond the range asked for.
    """

    lower: float
    upper: float


def second_order_growth(family: AnyFamily, Omega: float, eps: float) -> float:
    """Return the growth rate at one point to second order in eps.

    Parameters
    ----------
    family : AnyFamily
    Omega : float
        Excitation frequency, > 0.
    eps : float
        Excitation amplitude.

    Raises
    ------
    ValueError
        If an argument is out of range, or there is no theory for the system (`perturb.transition_curves`).
    """
    Omega, eps = real_number("Omega", Omega, positive=True), real_number("eps", eps)
    return _growth(GeneralExpansion(family), Omega, eps)


def stable_windows(family: AnyFamily, Omega_range: tuple[float, float], eps: float) -> list[StableWindow]:
    """Return the windows of a range in which excitation stabilises a system that is unstable without it.

    What is beyond second order is not seen, such as the region of multiplier -1 that a strong excitation opens.

    Parameters
    ----------
    family : AnyFamily
    Omega_range : (low, high)
        0 < low < high; looked at in 240 parts.
    eps : float
        Excitation amplitude.

    Returns
    -------
    list of StableWindow
        By increasing frequency. At ``eps`` = 0 there is none.

    Raises
    ------
    ValueError
        If an argument is out of range, there is no theory for the system (`perturb.transition_curves`), or it is stable
        without excitation at one of the two ends.
    """
    low, high = interval("Omega_range", Omega_range, nonnegative=True)
    low, eps = real_number("Omega_range[0]", low, positive=True), real_number("eps", eps)
    expansion = GeneralExpansion(family)
    for Omega in (low, high):
        if expansion.modes_at(Omega).eigenvalues.real.max() <= STABLE_PART * Omega:
            raise ValueError(
                f"family is stable without excitation at Omega = {Omega!r}; windows in which excitation stabilises are "
                "for systems that are not (transition_curves has the regions in which it destabilises)"
            )

    def stable(Omega: float) -> bool:
        return _growth(expansion, Omega, eps) <= STABLE_PART * Omega

    Omega = np.linspace(low, high, WINDOW_SAMPLES).tolist()
    inside = [stable(one) for one in Omega]
    ends = [_end(stable, *Omega[k : k + 2]) for k in np.flatnonzero(np.diff(inside)).tolist()]
    ends = ([-np.inf] if inside[0] else []) + ends + ([np.inf] if inside[-1] else [])
    return [StableWindow(*pair) for pair in zip(ends[::2], ends[1::2], strict=True)]


def _end(stable: Callable[[float], bool], one: float, other: float) -> float:
    """Return where stability begins or ends between two frequencies."""
    first = stable(one)
    for _ in range(WINDOW_BISECTIONS):
        middle = 0.5 * (one + other)
        one, other = (middle, other) if stable(middle) == first else (one, middle)
    return 0.5 * (one + other)


def _growth(expansion: GeneralExpansion, Omega: float, eps: float) -> float:
    equations = expansion.equations(Omega, 2)
    rates = []
    for states in _groups(equations, Omega):
        matrix = effective_matrix_of(equations, states, Omega, 2)
        H = matrix.at(np.array(0.0), np.array(eps))
        rates.append(float(np.linalg.eigvals(H).real.max()))
    return max(rates)


def _groups(equations: GeneralEquations, Omega: float) -> list[list[State]]:
    """Return all states, each with one harmonic, in groups that are near each other modulo Omega."""
    places = equations.omega / Omega
    turned: FloatArray = places - np.floor(places)
    order = np.argsort(turned, kind="stable")
    gaps = np.diff(np.concatenate([turned[order], [turned[order[0]] + 1]]))
    start = int(gaps.argmax()) + 1  # the circle is cut at its widest gap
    groups: list[list[State]] = []
    for k in range(len(order)):
        place = (start + k) % len(order)
        a = int(order[place])
        harmonic = int(np.floor(places[a])) - (1 if start + k >= len(order) else 0)
        if k == 0 or gaps[place - 1] > NEAR_RESONANCE:
            groups.append([])
        groups[-1].append((a, harmonic))
    return groups
