"""A system at one amplitude as one of eq. (11), where it is one: powers of eps are numbers then."""

from __future__ import annotations

from periodic import AnySystem, PeriodicSystem
from periodic.waveforms import Trigonometric


def short_form(system: AnySystem, eps: float) -> PeriodicSystem | None:
    """Return the system with periodic stiffness alone that ``system`` is at the amplitude ``eps``; None if it is none.

    Harmonics of the stiffness with higher powers of eps are harmonics of power one with other matrices, and what grows
    with eps without depending on time belongs to the constant matrices.

    Raises
    ------
    ValueError
        If the mass at ``eps`` is not positive definite.
    """
    if not isinstance(system, PeriodicSystem):
        return None
    if not system.terms:
        return system
    if not eps:
        return PeriodicSystem(system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine)
    constant = {name: getattr(system, name).copy() for name in ("mass", "gyroscopic", "damping", "stiffness")}
    J = system.harmonics
    excitation = []
    for term in system.terms:
        g, factor = term.waveform, eps**term.power
        if not isinstance(g, Trigonometric) or g.rest or (g.harmonics and term.of != "stiffness"):
            return None
        constant[term.of] += factor * g.cosines[0] * term.matrix
        if g.harmonics:
            excitation.append((g, factor / eps * term.matrix))
            J = max(J, g.harmonics)
    cosine, sine = ([*given, *[0 * given[0]] * (J - system.harmonics)] for given in (system.cosine, system.sine))
    for g, matrix in excitation:
        for j in range(1, g.harmonics + 1):
            cosine[j - 1] = cosine[j - 1] + g.cosines[j] * matrix
            sine[j - 1] = sine[j - 1] + g.sines[j] * matrix
    return PeriodicSystem(**constant, cosine=cosine, sine=sine)
