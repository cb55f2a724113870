"""How the regions of a plate move with one of its parameters: by theory, and at a few values by integration."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from tqdm import tqdm

from compare.comparison import traced_curve
from compare.explorer.variation import SWEEPABLE, varied
from compare.files import Plate
from floquet import Kind, monodromy
from floquet.running import gather
from periodic.checks import FloatArray, grid, one_of, real_number, whole_number
from perturb import TransitionCurve, gyroscopic_modes, transition_curves
from plate import MovingPlate

# Values of the parameter at which regions are traced as well: enough to see whether the line is right.
MAX_TRACED_VALUES = 6
# The tip is looked for at the middle of the region at this multiple of the tip of theory, ...
TIPS_TO_CENTRELINE = 1.05
# ... between these multiples of it.
MIN_TIP_RATIO, MAX_TIP_RATIO = 0.5, 1.5
# Largest amplitude of a tip that is traced and drawn. Beyond it the excitation exceeds the static load, and theory its
# range.
MAX_TRACED_TIP = 1.0


@dataclass(frozen=True, eq=False)
class RegionSweep:
    """One region at the m values of a sweep, of which k are traced.

    Attributes
    ----------
    label : str
        The resonance. Modes are numbered by frequency at each value: where two frequencies cross, two regions change
        labels.
    centre, slope, tip : ndarray, shape (m,)
        By theory: the frequency at which the region opens, d(half width) / d eps at large eps, and the tip.
    width : ndarray, shape (m,)
        By theory, at the sweep's eps; 0 where the region is closed.
    traced_centre, traced_width, traced_tip : ndarray, shape (k,)
        By integration: middle of the two edges at the sweep's eps (NaN where closed), their distance (0 where closed),
        and tip (NaN without damping, above 1, or where there is none near that of theory). All are NaN where damping
        moves the frequencies by more than a few per cent.
    """

    label: str
    centre: FloatArray
    slope: FloatArray
    tip: FloatArray
    width: FloatArray
    traced_centre: FloatArray
    traced_width: FloatArray
    traced_tip: FloatArray


@dataclass(frozen=True, eq=False)
class Sweep:
    """Regions as functions of a parameter, made by `sweep`.

    Attributes
    ----------
    name : str
        The parameter.
    eps : float
        Amplitude at which widths are compared.
    values, traced_values : ndarray, shapes (m,) and (k,)
        Values of the parameter; the traced ones are among them.
    regions : list of RegionSweep
    left_out : list of (float, str)
        Values at which there is no plate, and why.
    """

    name: str
    eps: float
    values: FloatArray
    traced_values: FloatArray
    regions: list[RegionSweep]
    left_out: list[tuple[float, str]]

    @property
    def remark(self) -> str:
        """A sentence about the values left out; empty if there are none."""
        if not self.left_out:
            return ""
        values = [value for value, _ in self.left_out]
        few = f"= {values[0]:.6g}" if len(values) == 1 else f"from {min(values):.6g} to {max(values):.6g}"
        return f"{self.name} {few} is left out: {self.left_out[0][1]}"

    def write(self, folder: Path, name: str) -> None:
        """Write ``name``.csv, a line for each value and region, and ``name``.npz, an array for each attribute."""
        lines = ("centre", "slope", "tip", "width")
        points = ("traced_centre", "traced_width", "traced_tip")
        with (folder / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file)
            table.writerow([self.name, "region", *lines, *points])
            for region in self.regions:
                for i, value in enumerate(self.values):
                    traced = np.flatnonzero(self.traced_values == value)
                    numbers = [getattr(region, column)[i] for column in lines]
                    numbers += [getattr(region, column)[traced[0]] if traced.size else "" for column in points]
                    table.writerow([value, region.label, *numbers])
        arrays = {
            column: np.array([getattr(region, column) for region in self.regions]) for column in (*lines, *points)
        }
        arrays |= {"values": self.values, "traced_values": self.traced_values, "eps": np.array(self.eps)}
        arrays["labels"] = np.array([region.label for region in self.regions])
        np.savez_compressed(folder / f"{name}.npz", allow_pickle=False, **arrays)


def sweep(
    plate: Plate,
    name: str,
    values: ArrayLike,
    regions: Sequence[tuple[int, int]],
    *,
    eps: float = 0.1,
    order: int = 1,
    n_jobs: int = -1,
    progress: bool = False,
) -> Sweep:
    """Follow the main regions of a plate, those of sum type and first harmonic, along one parameter.

    Parameters
    ----------
    plate : Plate
        Table of a case file; everything but ``name`` stays as it is.
    name : str
        "speed", "tension", "damping", "aspect_ratio", "poisson_ratio", "thickness_ratio" or "width" (of the load).
    values : array_like, shape (m,)
        Increasing. Values at which there is no plate, such as speeds above divergence, are left out and listed.
    regions : sequence of (int, int)
        Pairs of modes, from 1.
    eps : float
        Amplitude at which widths are compared and edges traced, > 0.
    order : 1 or 2
        Order of the theory.
    n_jobs : int
        Regions traced at once (threads), as in joblib.
    progress : bool
        Show progress bars.

    Raises
    ------
    ValueError
        If an argument is out of range or without effect, there is no plate at any value, or a mode has a number beyond
        the plate's.
    """
    one_of("name", name, SWEEPABLE)
    if name == "thickness_ratio" and plate.inplane != "dynamic":
        raise ValueError('thickness_ratio has no effect without inplane = "dynamic"; set that in the case')
    eps = real_number("eps", eps, positive=True)
    for mode in chain(*regions):
        whole_number("regions", mode, least=1)
    pairs = [(max(pair), min(pair)) for pair in regions]
    plates: dict[float, MovingPlate] = {}
    left_out: list[tuple[float, str]] = []
    for value in grid("values", values).tolist():
        try:
            plates[value] = varied(plate, name, value).build()
        except ValueError as error:
            left_out.append((value, str(error)))
    if not plates:
        raise ValueError(f"{name} gives no plate at any of the values; at {left_out[0][0]:.6g}: {left_out[0][1]}")
    kept = np.array([*plates])
    bar = tqdm(plates.values(), desc="theory", unit="value", disable=not progress)
    theory = [_curves(family, pairs, order) for family in bar]
    traced = np.unique(np.linspace(0, kept.size - 1, MAX_TRACED_VALUES).round().astype(int))
    tasks = [(plates[kept[i]], curve, eps) for i in traced for curve in theory[i]]
    with tqdm(desc="boundaries", total=len(tasks), unit="region", disable=not progress) as steps:
        points = np.array(gather(_trace, tasks, n_jobs, steps)).reshape(traced.size, len(pairs), 3)
    rows = [_row([curves[k] for curves in theory], eps, points[:, k]) for k in range(len(pairs))]
    return Sweep(name, eps, kept, kept[traced], rows, left_out)


def _curves(family: MovingPlate, pairs: Sequence[tuple[int, int]], order: int) -> list[TransitionCurve]:
    frequencies = gyroscopic_modes(family.at(0.0)).frequencies
    most = max(p for p, _ in pairs)
    if most > frequencies.size:
        raise ValueError(f"regions ask for mode {most}; the plate has {frequencies.size} modes")
    window = (frequencies[0], 2.0 * frequencies[most - 1] * (1 + 1e-9))
    curves = transition_curves(family, window, order=order, types=("sum",))
    by_modes = {(curve.p, curve.q): curve for curve in curves if curve.j == 1}
    return [by_modes[pair] for pair in pairs]


def _row(curves: Sequence[TransitionCurve], eps: float, points: FloatArray) -> RegionSweep:
    edges = np.array([curve.edges(eps) for curve in curves])
    return RegionSweep(
        curves[0].label,
        np.array([curve.centre for curve in curves]),
        np.array([curve.slope for curve in curves]),
        np.array([curve.tip for curve in curves]),
        np.nan_to_num(edges[:, 1] - edges[:, 0]),
        *points.T,
    )


def _trace(family: MovingPlate, curve: TransitionCurve, eps: float) -> tuple[float, float, float]:
    """Return centre, width and tip of a region by integration; NaN where it is no longer the region of the curve."""
    trace = traced_curve(family, curve, eps)
    if trace is None:
        return float("nan"), float("nan"), float("nan")
    closed = float("nan") if trace.kind[0] == Kind.UNDECIDED else 0.0
    lower, upper = float(trace.lower[0]), float(trace.upper[0])
    centre, width = (0.5 * (lower + upper), upper - lower) if trace.is_open[0] else (float("nan"), closed)
    return centre, width, _traced_tip(family, curve)


def _traced_tip(family: MovingPlate, curve: TransitionCurve) -> float:
    """Return the eps at which the largest multiplier leaves the unit circle on the region's centreline."""
    if not 0 < curve.tip < MAX_TRACED_TIP:
        return float("nan")
    trace = traced_curve(family, curve, TIPS_TO_CENTRELINE * curve.tip)
    Omega = float("nan") if trace is None else 0.5 * float(trace.lower[0] + trace.upper[0])
    if not np.isfinite(Omega):
        return float("nan")

    def growth(eps: float) -> float:
        return monodromy(family, Omega, eps).growth_rate

    low, high = MIN_TIP_RATIO * curve.tip, MAX_TIP_RATIO * curve.tip
    if not growth(low) < 0 < growth(high):
        return float("nan")
    return float(brentq(growth, low, high, rtol=1e-6))
