"""Families of systems: what every method is given, and how a method takes the member it needs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol, TypeGuard

from periodic import waveforms
from periodic.checks import FloatArray
from periodic.first_order import FirstOrderSystem
from periodic.system import PeriodicSystem

# Any linear periodic system, of second or of first order.
AnySystem = PeriodicSystem | FirstOrderSystem


class SystemFamily(Protocol):
    """What every method of this house is given: anything with ``at(Omega)``, such as a plate.

    A class that follows these rules is a model; it needs no base class and no registration.

    A model must:

    1. return a `PeriodicSystem` (or, for methods that take it, a `FirstOrderSystem`) from ``at(Omega)`` for every
       finite Omega >= 0, the same one, to the last bit, whenever it is asked for the same frequency;
    2. keep the number of coordinates and of harmonics, and what each coordinate means, at all frequencies;
    3. let its matrices depend on Omega smoothly if at all, but for ``cosine`` and ``sine`` at isolated resonances of
       the excitation. Theory (`perturb`) follows modes that depend on Omega, as those of a rotor do; integration takes
       the modes of the member at the frequency asked for;
    4. keep subsystems apart at all frequencies if it keeps them apart at one (a symmetric load stays symmetric);
    5. be immutable, and pickle: workers in threads, processes and on other machines call ``at`` at the same time;
    6. raise ValueError, with argument, value and remedy, where its parameters make no system: when it is made, not when
       ``at`` is called.

    A model may rely on this:

    7. nobody changes the arrays that it returns; they are read-only;
    8. ``at`` is called about once for a column of a chart and once for a point of a traced edge, so that it may take as
       long as integrating one point: milliseconds;
    9. units are its own. Omega is in the units of sqrt(stiffness / mass), and eps multiplies ``cosine`` and ``sine`` as
       they stand; ``terms`` with their own powers of eps;
    10. neither theory nor integration knows anything of it but what ``at`` returns.
    """

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the system at excitation frequency ``Omega``."""
        ...


class AnyFamily(Protocol):
    """A `SystemFamily` whose members may be of first order, too: for methods that take any linear periodic system."""

    def at(self, Omega: float) -> AnySystem:
        """Return the system at excitation frequency ``Omega``."""
        ...


def any_member_at(family: Any, Omega: float, name: str = "system") -> AnySystem:
    """Return the member of ``family`` at ``Omega``, for methods that take any linear periodic system.

    Raises
    ------
    ValueError
        If ``family`` is no `SystemFamily`.
    """
    if isinstance(family, type) or not callable(getattr(family, "at", None)):
        raise ValueError(
            f"{name} = {family!r} is no system; give a PeriodicSystem, a FirstOrderSystem "
            "or an object with a method at(Omega)"
        )
    member = family.at(Omega)
    if not isinstance(member, PeriodicSystem | FirstOrderSystem):
        raise ValueError(f"{name}.at({Omega!r}) gave {member!r}; it must give a PeriodicSystem or a FirstOrderSystem")
    return member


def member_at(family: Any, Omega: float, name: str = "system") -> PeriodicSystem:
    """Return the member of ``family`` at ``Omega``, for methods that take periodic stiffness alone: eq. (11).

    Raises
    ------
    ValueError
        If ``family`` is no `SystemFamily`, or its member has other terms.
    """
    return stiffness_alone(any_member_at(family, Omega, name), name)


def stiffness_alone(system: Any, name: str = "system") -> PeriodicSystem:
    """Return ``system`` if only its stiffness depends on time, in the short form of eq. (11).

    Every method that knows no other terms asks this, so that none is ignored.

    Raises
    ------
    ValueError
        If it is of first order or has other terms.
    """
    if isinstance(system, FirstOrderSystem):
        raise ValueError(
            f"{name} is of first order; this method takes a PeriodicSystem with periodic stiffness alone. "
            "monodromy, stability_chart, trace_boundary, transition_curves and agreement take any"
        )
    if not isinstance(system, PeriodicSystem):
        raise ValueError(f"{name} = {system!r} is no system; give a PeriodicSystem")
    if system.terms:
        term = system.terms[0]
        raise ValueError(
            f"{name} has a term of {term.of!r} with eps^{term.power} and the waveform "
            f"{type(term.waveform).__name__}; this method takes harmonics of the stiffness with eps^1 alone. "
            "monodromy, stability_chart, trace_boundary, transition_curves and agreement take any"
        )
    return system


def has_stiffness_alone(system: AnySystem) -> TypeGuard[PeriodicSystem]:
    """Return whether only the stiffness depends on time, in the short form of eq. (11); `stiffness_alone` refuses."""
    return isinstance(system, PeriodicSystem) and not system.terms


def excitation(system: AnySystem) -> Iterator[tuple[str, waveforms.Waveform, FloatArray, int]]:
    """Yield everything that depends on eps, the short form included: of which matrix, waveform, matrix, power."""
    of = "state" if isinstance(system, FirstOrderSystem) else "stiffness"
    for j, (c, s) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        if c.any():
            yield of, waveforms.cosine(j), c, 1
        if s.any():
            yield of, waveforms.sine(j), s, 1
    for term in system.terms:
        yield term.of, term.waveform, term.matrix, term.power
