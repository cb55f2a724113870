"""The one definition that every other package shares: a linear system with periodic stiffness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, is_positive_definite, real_array

# By how much two entries that should agree by symmetry may differ, in parts of the largest entry. Assembling and
# transforming a matrix in float64 loses far less; an asymmetry that is meant is far larger.
SYMMETRY_TOLERANCE = 1e-10


class SystemFamily(Protocol):
    """What every method of this house is given: anything with ``at(Omega)``, such as a plate.

    A class that follows these rules is a model; it needs no base class and no registration.

    A model must:

    1. return a `PeriodicSystem` from ``at(Omega)`` for every finite Omega >= 0, the same one, to the last bit, whenever
       it is asked for the same frequency;
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
       they stand;
    10. neither theory nor integration knows anything of it but what ``at`` returns.
    """

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the system at excitation frequency ``Omega``."""
        ...


@dataclass(frozen=True, eq=False)
class PeriodicSystem:
    """M W'' + (G + C) W' + (K + eps sum_j [F_cj cos(j Omega t) + F_sj sin(j Omega t)]) W = 0.

    The form of eq. (11) of Young, Huang and Chiu; any linear system with periodic stiffness has it. Arrays are copied,
    checked and made read-only. The units may be any that are consistent.

    Parameters
    ----------
    mass : array_like, shape (n, n)
        M, symmetric positive definite.
    gyroscopic : array_like, shape (n, n)
        G, skew-symmetric. The plate's V G_o.
    damping : array_like, shape (n, n)
        C, symmetric. The plate's c K_oe.
    stiffness : array_like, shape (n, n)
        K, any real matrix. The plate's K_o.
    cosine : array_like, shape (J, n, n)
        F_cj for j = 1..J, any real matrices. The plate's f0 F_cj.
    sine : array_like, shape (J, n, n), optional
        F_sj for j = 1..J; zero if left out.

    Attributes
    ----------
    size : int
        n, the number of coordinates.
    harmonics : int
        J, the number of harmonics of the excitation.

    Raises
    ------
    ValueError
        If a matrix has the wrong shape, type or symmetry, mass is not positive definite, or an entry is not finite.
    """

    mass: FloatArray
    gyroscopic: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    cosine: FloatArray
    sine: FloatArray

    def __init__(
        self,
        mass: ArrayLike,
        gyroscopic: ArrayLike,
        damping: ArrayLike,
        stiffness: ArrayLike,
        cosine: ArrayLike,
        sine: ArrayLike | None = None,
    ) -> None:
        M = real_array("mass", mass, 2)
        n = M.shape[0]
        if n == 0 or M.shape != (n, n):
            raise ValueError(f"mass has shape {M.shape}; give a square matrix")
        M = _symmetric("mass", M, 1)
        if not is_positive_definite(M):
            lowest = float(np.linalg.eigvalsh(M)[0])
            raise ValueError(f"mass has the lowest eigenvalue {lowest:.6g}; give a positive definite matrix")
        G = _symmetric("gyroscopic", _square("gyroscopic", gyroscopic, n), -1)
        C = _symmetric("damping", _square("damping", damping, n), 1)
        K = _square("stiffness", stiffness, n)
        Fc = _harmonics("cosine", cosine, n)
        Fs = np.zeros_like(Fc) if sine is None else _harmonics("sine", sine, n)
        if Fs.shape != Fc.shape:
            raise ValueError(f"sine has shape {Fs.shape}; give the shape of cosine, {Fc.shape}")
        arrays = {"mass": M, "gyroscopic": G, "damping": C, "stiffness": K, "cosine": Fc, "sine": Fs}
        for name, array in arrays.items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return int(self.mass.shape[0])

    @property
    def harmonics(self) -> int:
        """Number of harmonics J."""
        return int(self.cosine.shape[0])

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the system itself: its matrices do not depend on the frequency (`SystemFamily`)."""
        return self


def member_at(family: Any, Omega: float, name: str = "system") -> PeriodicSystem:
    """Return the member of ``family`` at ``Omega``.

    Raises
    ------
    ValueError
        If ``family`` is no `SystemFamily`.
    """
    if isinstance(family, type) or not callable(getattr(family, "at", None)):
        raise ValueError(
            f"{name} = {family!r} is no system; give a PeriodicSystem or an object with a method at(Omega)"
        )
    member = family.at(Omega)
    if not isinstance(member, PeriodicSystem):
        raise ValueError(f"{name}.at({Omega!r}) gave {member!r}; it must give a PeriodicSystem")
    return member


def _square(name: str, value: ArrayLike, n: int) -> FloatArray:
    array = real_array(name, value, 2)
    if array.shape != (n, n):
        raise ValueError(f"{name} has shape {array.shape}; give ({n}, {n}), as mass has")
    return array


def _symmetric(name: str, array: FloatArray, sign: int) -> FloatArray:
    """Return the exactly (skew-)symmetric matrix next to ``array``; refuse what differs by more than rounding."""
    half = 0.5 * array  # halved first: no overflow at the largest numbers
    defect = float(np.abs(half - sign * half.T).max())
    if defect > SYMMETRY_TOLERANCE * np.abs(half).max():
        kind = "symmetric" if sign > 0 else "skew-symmetric"
        raise ValueError(f"{name} is not {kind} (largest defect {2.0 * defect:.3g}); give a {kind} matrix")
    return half + sign * half.T


def _harmonics(name: str, value: ArrayLike, n: int) -> FloatArray:
    array = real_array(name, value, 3)
    if array.shape[0] == 0 or array.shape[1:] != (n, n):
        raise ValueError(f"{name} has shape {array.shape}; give (J, {n}, {n}) with J >= 1 harmonics")
    return array
