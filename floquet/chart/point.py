"""What one cell of a plane is about: a system, its excitation frequency and its amplitude."""

from __future__ import annotations

from dataclasses import dataclass

from periodic import AnyFamily, AnySystem, any_member_at
from periodic.checks import real_number


@dataclass(frozen=True, eq=False)
class Point:
    """A periodic system, the frequency and the amplitude of its excitation.

    Parameters
    ----------
    system : AnyFamily
        A `PeriodicSystem` or a `FirstOrderSystem`, or anything whose ``at(Omega)`` returns one.
    Omega : float
        Excitation frequency, positive, in the units of the system.
    eps : float
        Relative excitation amplitude, of any sign, dimensionless.

    Raises
    ------
    ValueError
        If ``system`` has no ``at``, or a number is not finite or has the wrong sign.
    """

    system: AnyFamily
    Omega: float
    eps: float

    def __post_init__(self) -> None:
        if isinstance(self.system, type) or not callable(getattr(self.system, "at", None)):
            raise ValueError(
                f"system = {self.system!r} is no system; give a PeriodicSystem, a FirstOrderSystem "
                "or an object with a method at(Omega)"
            )
        object.__setattr__(self, "Omega", real_number("Omega", self.Omega, positive=True))
        object.__setattr__(self, "eps", real_number("eps", self.eps))

    @property
    def member(self) -> AnySystem:
        """The system at its frequency."""
        return any_member_at(self.system, self.Omega)
