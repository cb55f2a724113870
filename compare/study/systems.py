"""The matrices of a user as the subject of a study: the window, the regions, and how large an eps is small."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from compare.files import MATRIX_NAMES, MAX_CHART_POINTS, load_system
from compare.ladder import DECAY_ROUNDING
from compare.rigid import elastic_part
from compare.study.study import Subject
from compare.study.truncation import lowest_modes
from compare.window import MODES_SHOWN, default_window
from floquet.boundary import natural_modes
from periodic import AnyFamily, AnySystem, SparseSystem, has_stiffness_alone
from periodic.checks import FloatArray, interval, real_number, whole_number
from periodic.system import SYMMETRY_TOLERANCE
from perturb import gyroscopic_modes, transition_curves
from reduction import first_modes

# Columns and rows of the chart.
CHART_POINTS = (256, 128)
# Modes of a large system that a default window is chosen by.
FIRST_MODES = 12


@dataclass(frozen=True, eq=False)
class OwnSystem:
    """A system from a file, in a window.

    Attributes
    ----------
    path : Path
    system : AnyFamily
        As it is integrated: a large or stiff one in its lowest modes.
    window, eps : (float, float), float
        Excitation frequencies and largest amplitude.
    remark : str
        What was left out; empty if nothing.
    """

    path: Path
    system: AnyFamily
    window: tuple[float, float]
    eps: float
    remark: str


def own_system(
    path: str | Path,
    Omega_range: tuple[float, float] | None = None,
    eps_max: float | None = None,
    *,
    all_modes: bool = False,
) -> OwnSystem:
    """Read a system and choose its window.

    Parameters
    ----------
    path : str or Path
        As for `compare.files.load_system`.
    Omega_range, eps_max : optional
        The window; what is left out is `compare.window.default_window`'s.
    all_modes : bool
        Keep a large system as it is, however long it takes (`compare.study.truncation.lowest_modes`).

    Raises
    ------
    ValueError
        If the file is not readable, a matrix is wrong, or the window is, or a system of sparse matrices cannot be
        reduced or is not to be; the message names what it is about.
    """
    path = Path(path)
    system = load_system(path)
    if isinstance(system, SparseSystem) and all_modes:
        raise ValueError(
            f"{path}: {system.size} coordinates are too many to integrate all modes; leave out --all-modes"
        )
    window, eps = Omega_range, eps_max
    if window is None or eps is None:
        try:
            slow = first_modes(system, FIRST_MODES) if isinstance(system, SparseSystem) else system.at(0.0)
            default, default_eps = default_window(slow)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        window, eps = window or default, default_eps if eps is None else eps
    low, high = interval("Omega_range", window, nonnegative=True)
    window = real_number("Omega_range[0]", low, positive=True), high
    eps = real_number("eps_max", eps, positive=True)
    small, rigid = (system, 0) if isinstance(system, SparseSystem) else elastic_part(system, high)
    remark = ""
    if not all_modes:
        try:
            small, remark = lowest_modes(small, window, eps)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    assert not isinstance(small, SparseSystem)
    if rigid:
        motions = "1 rigid-body motion is" if rigid == 1 else f"{rigid} rigid-body motions are"
        set_apart = f"{motions} set apart: without stiffness, and the excitation never touches it."
        remark = " ".join(filter(None, (set_apart, remark)))
    return OwnSystem(path, small, window, eps, remark)


def system_subject(own: OwnSystem, *, points: tuple[int, int] = CHART_POINTS, modes: int = MODES_SHOWN) -> Subject:
    """Return a system as a subject of `run_study`.

    Judged are the regions between its ``modes`` lowest modes.

    Raises
    ------
    ValueError
        If there is no theory for the system, or none of these regions starts in the window; the message names file
        and matrix.
    """
    whole_number("modes", modes, least=1)
    columns, rows = (whole_number("points", number, least=2, most=MAX_CHART_POINTS) for number in points)
    family, system = own.system, own.system.at(own.window[1])
    try:
        if has_stiffness_alone(system) and not _is_unsymmetric(system.stiffness[None]):
            gyroscopic_modes(system)  # refuses what is unstable without excitation: it has no regions
        curves = transition_curves(family, own.window)
    except ValueError as error:
        field = str(error).partition(" ")[0]
        name = f"{MATRIX_NAMES[field]} ({field})" if field in MATRIX_NAMES else "the system"
        raise ValueError(
            f"{own.path}: there is no theory to compare with, because of {name}: {error}. "
            "scripts/explore.py --system draws its chart without"
        ) from None
    if not any(max(curve.p, curve.q) <= modes for curve in curves):
        found = natural_modes(system, own.window[1]).exponents.imag
        lowest = ", ".join(f"{frequency:.4g}" for frequency in found[:modes])
        raise ValueError(
            f"{own.path}: none of the regions between the {modes} lowest modes (natural frequencies {lowest}) starts "
            f"in the window, Omega from {own.window[0]:g} to {own.window[1]:g}; give another --Omega, or more --modes"
        )
    remarks = [own.remark]
    excited = has_stiffness_alone(system) and _is_unsymmetric(np.concatenate([system.cosine, system.sine]))
    if excited and not _is_damped_throughout(system, own.window[1]):
        remarks.append(
            "The excitation is unsymmetric and there is no damping: between the regions, too, solutions grow or decay, "
            "like ε², so that the regions have no edges. Add some damping."
        )
    return Subject(
        name=own.path.stem,
        title=own.path.name,
        systems={"": family},
        window=own.window,
        eps=own.eps,
        points=(columns, rows),
        modes=modes,
        remark=" ".join(filter(None, remarks)),
    )


def _is_damped_throughout(system: AnySystem, Omega: float) -> bool:
    exponents = natural_modes(system, Omega).exponents
    return bool((exponents.real < -DECAY_ROUNDING * np.abs(exponents)).all())


def _is_unsymmetric(matrices: FloatArray) -> bool:
    return any(np.abs(F - F.T).max() > SYMMETRY_TOLERANCE * np.abs(F).max() for F in matrices)
