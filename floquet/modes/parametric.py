"""A system as a function of one parameter: what ``make`` gives at a value, and how far to go for a derivative."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from periodic import AnySystem, any_member_at
from periodic.checks import real_number

# Step of a derivative as part of the value; as a length where the value is zero.
RELATIVE_STEP = 1e-3


class At(NamedTuple):
    """A system at a point: the member at Omega."""

    system: AnySystem
    Omega: float
    eps: float


def made(make: Callable[[float], Any], value: float, Omega: float | None, eps: float | None) -> At:
    """Return the point that ``make`` gives at ``value``: a family at ``Omega`` and ``eps``, or a family, Omega and eps.

    Raises
    ------
    ValueError
        If it gives none of these.
    """
    found = make(value)
    if isinstance(found, tuple) and len(found) == 3:
        family, Omega, eps = found
    elif Omega is None or eps is None:
        raise ValueError(
            f"Omega = {Omega!r} and eps = {eps!r} do not say where; give both, or let make return (system, Omega, eps)"
        )
    else:
        family = found
    Omega = real_number("Omega", Omega, positive=True)
    return At(any_member_at(family, Omega, "make"), Omega, real_number("eps", eps))


def checked_make(make: Callable[[float], Any]) -> Callable[[float], Any]:
    """Return ``make`` if it can be called.

    Raises
    ------
    ValueError
        If it cannot.
    """
    if not callable(make):
        raise ValueError(
            f"make = {make!r} is not callable; give a function of one parameter that returns a system, or "
            "(system, Omega, eps)"
        )
    return make


def derivative_step(value: float, step: float | None) -> float:
    """Return the step of a derivative at ``value``.

    Raises
    ------
    ValueError
        If ``step`` is no positive number.
    """
    if step is not None:
        return real_number("step", step, positive=True)
    return RELATIVE_STEP * abs(value) if value else RELATIVE_STEP
