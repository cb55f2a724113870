"""The parts of any system, each with its sampler: by the way that suits it."""

from __future__ import annotations

from floquet.engine.coordinates import Subsystem, subsystems
from floquet.engine.coordinates import rigid_motions as rigid_motions_of_stiffness
from floquet.engine.doubling import Sampler, Workspace
from floquet.engine.general import (
    GeneralSubsystem,
    JumpSampler,
    general_sampler,
    general_subsystems,
    refuse_singular_mass,
)
from periodic import AnySystem, PeriodicSystem, has_stiffness_alone
from periodic.checks import FloatArray

AnySubsystem = Subsystem | GeneralSubsystem
AnySampler = Sampler | JumpSampler


def parts_of(system: AnySystem, Omega: float, eps: FloatArray) -> tuple[AnySubsystem, ...]:
    """Return the independent subsystems of the system at ``Omega``, without rigid motions.

    Raises
    ------
    ValueError
        If a mass becomes singular within the period at one of the amplitudes ``eps``.
    """
    if has_stiffness_alone(system):
        return subsystems(system)
    if isinstance(system, PeriodicSystem):
        refuse_singular_mass(system, eps.tobytes())
    return general_subsystems(system, Omega).subsystems


def rigid_motions(system: AnySystem, Omega: float) -> int:
    """Return the number of rigid motions of the system at ``Omega``; see `floquet.engine.coordinates`."""
    return (
        rigid_motions_of_stiffness(system) if has_stiffness_alone(system) else general_subsystems(system, Omega).rigid
    )


def sampler_of(subsystem: AnySubsystem, Omega: float, work: Workspace) -> AnySampler:
    """Return the sampler of a subsystem in coordinates that suit ``Omega``."""
    if isinstance(subsystem, Subsystem):
        return Sampler.of(subsystem, Omega, work)
    return general_sampler(subsystem, Omega, work)
