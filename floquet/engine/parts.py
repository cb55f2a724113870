"""The parts of any system, each with its sampler: by the way that suits it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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


def parts_of(systems: Sequence[AnySystem], Omega: FloatArray, eps: FloatArray) -> list[tuple[AnySubsystem, ...]]:
    """Return the independent subsystems of each system at its frequency, without rigid motions.

    All systems have periodic stiffness alone, or none has.

    Raises
    ------
    ValueError
        If a mass becomes singular within the period at one of the amplitudes ``eps``.
    """
    if has_stiffness_alone(systems[0]):
        return [subsystems(system) for system in systems]
    for system in systems:
        if isinstance(system, PeriodicSystem):
            refuse_singular_mass(system, eps.tobytes())
    return [parts.subsystems for parts in general_subsystems(systems, Omega)]


def rigid_motions(system: AnySystem, Omega: float) -> int:
    """Return the number of rigid motions of the system at ``Omega``; see `floquet.engine.coordinates`."""
    if has_stiffness_alone(system):
        return rigid_motions_of_stiffness(system)
    return general_subsystems([system], np.array([Omega]))[0].rigid


def sampler_of(subsystem: AnySubsystem, Omega: float, work: Workspace) -> AnySampler:
    """Return the sampler of a subsystem in coordinates that suit ``Omega``."""
    if isinstance(subsystem, Subsystem):
        return Sampler.of(subsystem, Omega, work)
    return general_sampler(subsystem, Omega, work)
