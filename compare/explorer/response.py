"""The Floquet solution behind one point of a chart: its multipliers and how it grows from period to period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from tqdm import tqdm

from floquet import Kind, StabilityChart, monodromy
from floquet.running import gather
from periodic import SystemFamily
from periodic.checks import ComplexArray, FloatArray

# Enough for a smooth curve of a solution with a dozen oscillations in a period.
SAMPLES_PER_PERIOD = 96
# A picture of the solution needs no more than this; the verdict comes from `floquet.monodromy`.
SOLUTION_TOLERANCE = 1e-6
# Columns and rows of blocks that can be clicked in a file: half a megabyte and half a minute for 28 coordinates.
CLICKABLE_POINTS = (32, 16)
# Multipliers this close in modulus to the largest one are as dominant as it: all of a stable elastic system.
DOMINANCE_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Response:
    """Multipliers and dominant solution at one (Omega, eps).

    Attributes
    ----------
    Omega, eps : float
        The point.
    multipliers : complex ndarray, shape (2n,)
        By decreasing modulus.
    growth_rate : float
        max log|mu| / T.
    error : float
        Estimated error of max log|mu|.
    kind : Kind
        Verdict.
    mu : complex
        Multiplier of the solution shown: the largest, and of several equally large ones that of slowest motion.
    coordinate : int
        The coordinate with the largest motion, from 0.
    wave : complex ndarray, shape (SAMPLES_PER_PERIOD,)
        That coordinate over one period at t = k T / SAMPLES_PER_PERIOD, largest modulus 1; in the following periods it is
        mu wave, mu^2 wave, ... Its real part is a solution.
    """

    Omega: float
    eps: float
    multipliers: ComplexArray
    growth_rate: float
    error: float
    kind: Kind
    mu: complex
    coordinate: int
    wave: ComplexArray


def response(family: SystemFamily, Omega: float, eps: float) -> Response:
    """Return multipliers and dominant Floquet solution at one point.

    Raises
    ------
    ValueError
        If the point cannot be integrated (see `floquet.monodromy`).
    """
    system = family.at(Omega)
    result = monodromy(system, Omega, eps)
    values, vectors = np.linalg.eig(result.matrix)
    n = system.size
    candidates = np.flatnonzero(np.abs(values) >= (1 - DOMINANCE_TOLERANCE) * np.abs(values).max())
    velocity, displacement = (np.linalg.norm(part[:, candidates], axis=0) for part in (vectors[:n], vectors[n:]))
    chosen = candidates[np.argmin(velocity / displacement)]

    solve = np.linalg.inv(system.mass)
    D, K = solve @ (system.gyroscopic + system.damping), solve @ system.stiffness
    F = eps * solve @ np.concatenate([system.cosine, system.sine])
    j = np.arange(1, system.harmonics + 1)

    def first_order(t: float, q: ComplexArray) -> ComplexArray:
        waveform = np.concatenate([np.cos(j * Omega * t), np.sin(j * Omega * t)])
        force = D @ q[:n] + (K + np.tensordot(waveform, F, 1)) @ q[n:]
        return np.concatenate([-force, q[:n]])

    T = 2 * np.pi / Omega
    start = vectors[:, chosen].astype(complex)
    times = np.arange(SAMPLES_PER_PERIOD) * T / SAMPLES_PER_PERIOD
    scale = SOLUTION_TOLERANCE * np.abs(start).max()
    path = solve_ivp(first_order, (0, T), start, "DOP853", times, rtol=SOLUTION_TOLERANCE, atol=scale).y[n:]
    coordinate = int(np.argmax(np.abs(path).max(axis=1)))
    wave = path[coordinate]
    peak = wave[np.argmax(np.abs(wave))]
    return Response(
        Omega=Omega,
        eps=eps,
        multipliers=result.multipliers,
        growth_rate=result.growth_rate,
        error=result.log_modulus_error,
        kind=result.kind,
        mu=complex(values[chosen]),
        coordinate=coordinate,
        wave=wave * (peak.conjugate() / abs(peak) ** 2),
    )


def responses(
    family: SystemFamily, chart: StabilityChart, *, n_jobs: int = -1, progress: bool = False
) -> list[Response]:
    """Return the response at one cell of each block of a chart: the points that can be clicked in a file.

    A block gives its fastest-growing cell, so that no region is missed that the chart shows. Points that cannot be
    integrated are left out.
    """
    rows, columns = clickable_points(chart.growth_rate, *CLICKABLE_POINTS)
    tasks = [(family, float(chart.Omega[m]), float(chart.eps[k])) for k, m in zip(rows, columns, strict=True)]
    with tqdm(desc="points to click", total=len(tasks), unit="point", disable=not progress) as bar:
        return [result for result in gather(_try, tasks, n_jobs, bar) if result is not None]


def _try(family: SystemFamily, Omega: float, eps: float) -> Response | None:
    try:
        return response(family, Omega, eps)
    except ValueError:  # grows beyond all numbers within one period
        return None


def clickable_points(growth_rate: FloatArray, columns: int, rows: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return row and column of the fastest-growing cell of each block of a chart, so that no narrow region is missed.

    Parameters
    ----------
    growth_rate : ndarray, shape (k, m)
        Of a chart.
    columns, rows : int
        Number of blocks along m and k; fewer if the chart is smaller.
    """
    k, m = growth_rate.shape
    picks = []
    for row in np.array_split(np.arange(k), min(rows, k)):
        for column in np.array_split(np.arange(m), min(columns, m)):
            block = growth_rate[np.ix_(row, column)]
            # ties, as in a block that is all stable, go to its middle
            distance = np.add.outer(np.abs(row - row.mean()), np.abs(column - column.mean()))
            best = np.lexsort((distance.ravel(), -np.round(block.ravel(), 12)))[0]
            picks.append((row[best // column.size], column[best % column.size]))
    chosen = np.array(picks, dtype=np.intp)
    return chosen[:, 0], chosen[:, 1]
