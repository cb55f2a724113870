"""The Floquet solution at one point of a chart: all multipliers, and the solution that grows fastest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from tqdm import tqdm

from floquet import Kind, StabilityChart, monodromy
from floquet.running import gather
from periodic import SystemFamily, stiffness_alone
from periodic.checks import ComplexArray, FloatArray

# Places in a period at which a solution is drawn. A solution with a dozen oscillations is still smooth.
SAMPLES_PER_PERIOD = 96
# Relative error of the solution that is drawn. The verdict does not depend on it: that is `floquet.monodromy`'s.
DRAWING_TOLERANCE = 1e-6
# Points along Omega and eps that can be clicked in a file: half a megabyte and half a minute for 28 coordinates.
CLICKABLE_POINTS = (32, 16)
# Digits behind the point to which growth rates are compared; what differs by less is rounding.
RATE_DIGITS = 12
# Multipliers whose moduli differ by less, relative to the largest, are equally dominant: of a stable elastic system,
# all.
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
        Multiplier of the solution shown: the largest one. Of several equally large ones, that of the slowest motion.
    coordinate : int
        The coordinate that moves most, counted from 0.
    wave : complex ndarray, shape (m,)
        That coordinate at t = k T / m, k = 0, ..., m - 1, scaled to a largest modulus of 1. In the following periods it
        is mu wave, mu^2 wave, ... Its real part is a solution.
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
    system = stiffness_alone(family.at(Omega), "family")
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
    scale = DRAWING_TOLERANCE * np.abs(start).max()
    path = solve_ivp(first_order, (0, T), start, "DOP853", times, rtol=DRAWING_TOLERANCE, atol=scale).y[n:]
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


def clickable_responses(
    family: SystemFamily, chart: StabilityChart, *, n_jobs: int = -1, progress: bool = False
) -> list[Response]:
    """Return the responses at the points of a chart that can be clicked in a file (`clickable_points`).

    Points that cannot be integrated are left out.
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
    """Divide a chart into rectangles of cells; return row and column of the fastest-growing cell of each.

    So every region that the chart shows has a point, however narrow it is.

    Parameters
    ----------
    growth_rate : ndarray, shape (k, m)
        Of a chart.
    columns, rows : int
        Number of rectangles along m and k; fewer if the chart has fewer cells.
    """
    k, m = growth_rate.shape
    picks = []
    for row in np.array_split(np.arange(k), min(rows, k)):
        for column in np.array_split(np.arange(m), min(columns, m)):
            rates = growth_rate[np.ix_(row, column)]
            # where all is stable, the cell in the middle
            distance = np.add.outer(np.abs(row - row.mean()), np.abs(column - column.mean()))
            best = np.lexsort((distance.ravel(), -np.round(rates.ravel(), RATE_DIGITS)))[0]
            picks.append((row[best // column.size], column[best % column.size]))
    chosen = np.array(picks, dtype=np.intp)
    return chosen[:, 0], chosen[:, 1]
