"""From a family and a window to a proved chart."""

from __future__ import annotations

import math
import os
import time
from itertools import product

import numpy as np
from joblib import effective_n_jobs
from scipy.sparse.csgraph import connected_components
from tqdm import tqdm

from floquet.certified.areas.chart import AreaVerdict, PartArrays, ProvedChart
from floquet.certified.areas.coefficients import Coefficients, coefficients_of
from floquet.certified.areas.keeping import checked_folder, joined, piece_of
from floquet.certified.areas.search import Rectangle
from floquet.certified.growth import certified_growth
from floquet.certified.structure import coupling
from floquet.running import gather
from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import real_number

# Frequencies of the window at which a family is asked whether it is the same everywhere.
FAMILY_SAMPLES = 9
# Phase, in radians, by which multipliers turn over the width of a column of the window, at the start.
COLUMN_PHASE = 1.5
# Smallest cell, as a part of the window's width and height, unless the caller says otherwise.
LEAST = 1 / 1024


def prove_chart(
    family: SystemFamily,
    Omega_range: tuple[float, float],
    eps_range: tuple[float, float],
    *,
    least: float = LEAST,
    seconds: float | None = None,
    n_jobs: int | None = -1,
    progress: bool = True,
    cache: str | os.PathLike[str] | None = None,
) -> ProvedChart:
    """Prove whether the points of a window are stable: all of them, but for thin strips along the edges.

    Parameters
    ----------
    family : SystemFamily
        Periodic stiffness alone, in the short form of eq. (11), with matrices that are the same at all frequencies of
        the window. Its float64 numbers are taken as exact.
    Omega_range, eps_range : (float, float)
        The window: lowest and highest frequency, > 0, and amplitude. All are exact.
    least : float
        Width and height of the smallest cell, as parts of the window's. A cell of which nothing is proved is halved
        down to this size, and is then open.
    seconds : float, optional
        Stop after this time; what is not done by then is open.
    n_jobs : int
        As in `floquet.stability_chart`.
    progress : bool
        Show a bar.
    cache : path, optional
        Folder that keeps each piece of the window when it is proved. The same call, stopped by ``seconds`` or by hand,
        goes on there, with any ``seconds``; so does one of another window that has pieces in common with it.

    Returns
    -------
    ProvedChart

    Raises
    ------
    ValueError
        If an argument is wrong, the system is of first order or has other terms than periodic stiffness of power 1, or
        the family changes with Omega.

    Notes
    -----
    docs/certify.md has the proofs, what they rest on, and how long they take.
    """
    low, high = _range("Omega_range", Omega_range, positive=True)
    bottom, top = _range("eps_range", eps_range)
    least = real_number("least", least, positive=True)
    deadline = math.inf if seconds is None else time.monotonic() + real_number("seconds", seconds, positive=True)
    folder = checked_folder(cache)
    system = _same_everywhere(family, low, high)
    smallest = (least * (high - low), least * (top - bottom))
    constant = AreaVerdict.STABLE
    excited: list[tuple[np.ndarray, Coefficients]] = []
    for coordinates in _subsystems(system):
        subsystem = _restricted(system, coordinates)
        if subsystem.cosine.any() or subsystem.sine.any():
            excited.append((coordinates, coefficients_of(subsystem)))
            continue
        found = certified_growth(subsystem, low, 0.0, progress=False)
        verdict = AreaVerdict(found.verdict) if found.verdict != "undecided" else AreaVerdict.OPEN
        constant = min(constant, verdict, key=(AreaVerdict.UNSTABLE, AreaVerdict.OPEN, AreaVerdict.STABLE).index)
    tasks = [
        (number, (equation, coordinates, piece, smallest, deadline, folder))
        for number, (coordinates, equation) in enumerate(excited)
        for piece in _pieces(equation, low, high, bottom, top, n_jobs)
    ]
    # from high to low frequencies, which take longer: what time allows is proved of all subsystems alike
    tasks.sort(key=lambda task: task[1][2].low)
    with tqdm(total=len(tasks), desc="proof of a chart", unit="piece", leave=False, disable=not progress) as bar:
        done: list[PartArrays] = gather(piece_of, [arguments for _, arguments in tasks], n_jobs, bar)
    parts = [
        joined([one for one, task in zip(done, tasks, strict=True) if task[0] == number])
        for number in range(len(excited))
    ]
    return ProvedChart(system, (low, high), (bottom, top), tuple(parts), constant)


def _range(name: str, value: tuple[float, float], *, positive: bool = False) -> tuple[float, float]:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r} is no range; give the lowest and the highest value") from None
    low, high = (real_number(name, one, positive=positive) for one in (low, high))
    if not low < high:
        raise ValueError(f"{name} = {value!r} is empty; give the lower value first")
    return low, high


def _same_everywhere(family: SystemFamily, low: float, high: float) -> PeriodicSystem:
    """Return the family's member, if it is the same at several frequencies."""
    system = member_at(family, low, "family")
    for Omega in np.linspace(low, high, FAMILY_SAMPLES)[1:].tolist():
        other = member_at(family, Omega, "family")
        if other is not system and not all(
            np.array_equal(getattr(system, name), getattr(other, name))
            for name in ("mass", "gyroscopic", "damping", "stiffness", "cosine", "sine")
        ):
            raise ValueError(
                f"family has other matrices at Omega = {Omega!r} than at {low!r}; a chart is proved for matrices that "
                "are the same at all frequencies. certified_growth proves single points of any family"
            )
    return system


def _subsystems(system: PeriodicSystem) -> list[np.ndarray]:
    """Return the coordinates of the subsystems that exact zeros keep apart."""
    coupled = np.any(np.array(coupling(system, 1.0)) != 0, axis=0)
    count, label = connected_components(coupled, directed=False)
    return [np.flatnonzero(label == number) for number in range(count)]


def _restricted(system: PeriodicSystem, coordinates: np.ndarray) -> PeriodicSystem:
    rows, columns = np.ix_(coordinates, coordinates)
    return PeriodicSystem(
        system.mass[rows, columns],
        system.gyroscopic[rows, columns],
        system.damping[rows, columns],
        system.stiffness[rows, columns],
        system.cosine[:, rows, columns],
        system.sine[:, rows, columns],
    )


def _pieces(
    equation: Coefficients, low: float, high: float, bottom: float, top: float, n_jobs: int | None
) -> list[Rectangle]:
    """Return rectangles that cover the window, for the workers to share."""
    first, last = math.nextafter(1 / high, 0.0), math.nextafter(1 / low, math.inf)
    workers = effective_n_jobs(n_jobs)
    columns = math.ceil((last - first) * equation.norm * 2 * math.pi / COLUMN_PHASE)
    columns = max(workers * math.ceil(columns / workers), 1)
    rows = max(1, math.ceil((top - bottom) * equation.norms.sum() / equation.norm))
    x, y = np.linspace(first, last, columns + 1).tolist(), np.linspace(bottom, top, rows + 1).tolist()
    return [Rectangle(*x[i : i + 2], *y[k : k + 2]) for i, k in product(range(columns), range(rows))]
