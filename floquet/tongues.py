"""Narrow regions of instability, followed from the resonances that they start from.

A region much narrower than the distance between the columns of a scan is met by none of them. But beside it the
exponents of its two modes are smooth, and across it the test function f of the pair (`floquet.exponents`) is: nearly a
parabola in Omega, with its vertex in the middle of the region and its zeros at the edges. Three columns near a
resonance, one of them inside the region, give these parabolas for all amplitudes at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.column import least_frequency, log2_steps, multipliers
from floquet.coordinates import Block, blocks, equations
from floquet.coupling import Candidate
from floquet.exponents import follow, modes, modes_symplectic, test_function
from floquet.names import Name
from floquet.parallel import spread
from floquet.sampling import Sampler, Workspace
from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray

# Amplitudes below the window and in it, dense enough to extrapolate exponents from one to the next.
BELOW, LEVELS = 32, 47
# Error of the multipliers, as a part of the expected f, and at least and at most.
ACCURACY, FINEST, COARSEST = 1e-2, 1e-10, 1e-7
# Candidates that share their work space.
A_TASK = 4
# Columns placed in the middle of a region, at most; each shows where to place the next.
TRIALS = 4
# Columns placed at a tip above eps = 0, at most.
TIPS = 2
# The curvature of f in Omega is that of two modes with constant frequencies, but for this factor.
CURVATURE = 2.0
# A vertex further from the resonance than this part of its frequency is none.
FARTHEST = 0.1
# The height of a parabola counts where a column is inside the region, or that near to its vertex, as part of the square
# of the half width. The others follow from those above, as to low orders in eps.
NEAR = 0.25
# Levels in a row at which a fit may fail, where one of the modes meets a third one in passing.
GAP = 4
# Where nothing could be followed, part of the width up to which it is tried once more.
CROWDED = 0.25
TINY = 1e-30


class Tongue(NamedTuple):
    """A narrow region: its edges ``lower`` and ``upper`` in Omega at the amplitudes ``eps``, arrays (k,), from its tip
    upwards.

    ``witness`` is an (Omega, eps) at which the multipliers of a column are unstable, those of a block with so many
    ``modes``.
    """

    name: Name
    eps: FloatArray
    lower: FloatArray
    upper: FloatArray
    witness: tuple[float, float]
    modes: int


class _Fit(NamedTuple):
    """The parabolas of all amplitudes, arrays (k,): vertex, its height, half width, and whether they are to be trusted.

    The square of the half width is negative where f is.
    """

    centre: FloatArray
    height: FloatArray
    square: FloatArray
    sound: Any


def trace_tongues(
    family: SystemFamily,
    candidates: Sequence[Candidate],
    eps_range: tuple[float, float],
    widest: float,
    steps: float,
    n_jobs: int | None,
) -> list[Tongue]:
    """Return the narrow regions that start at the candidates, up to where they are ``widest`` in Omega, meet others, or
    leave ``eps_range``.

    ``steps`` in a cycle of the fastest motion give multipliers with an error of COARSEST.
    """
    batches = [candidates[i : i + A_TASK] for i in range(0, len(candidates), A_TASK)]
    tasks = ((family, batch, eps_range, widest, steps) for batch in batches)
    found = dict(spread(_tongues, tasks, n_jobs))
    return [tongue for i in range(len(batches)) for tongue in found[i] if tongue is not None]


def reach(candidate: Candidate, top: float, widest: float) -> float:
    """Return the amplitude, at most ``top``, up to which a candidate is not wider than ``widest``."""
    return top * min(1.0, (widest / max(candidate.width, TINY)) ** (1 / candidate.name.j))


def _tongues(
    family: SystemFamily, candidates: Sequence[Candidate], eps_range: tuple[float, float], widest: float, steps: float
) -> list[Tongue | None]:
    work, found = Workspace(), []
    for candidate in candidates:
        tongue = _tongue(family, candidate, eps_range, widest, steps, work)
        lower = CROWDED * min(candidate.width, widest)
        if tongue is None and reach(candidate, eps_range[1], lower) > eps_range[0]:  # others may be near further up
            tongue = _tongue(family, candidate, eps_range, lower, steps, work)
        found.append(tongue)
    return found


def _tongue(
    family: SystemFamily,
    candidate: Candidate,
    eps_range: tuple[float, float],
    widest: float,
    steps: float,
    work: Workspace,
) -> Tongue | None:
    """Return the region of a candidate, or its lower part; None if there is none that can be followed."""
    bottom, end = eps_range[0], reach(candidate, eps_range[1], widest)
    below = np.linspace(0.0, bottom, BELOW, endpoint=False)[: BELOW * (bottom > 0)]
    eps = np.concatenate([below, np.linspace(bottom, end, LEVELS + 1)])
    centre, half = candidate.name.centre, min(candidate.width, widest) / 2
    nodes: dict[float, FloatArray] = {}

    def add(Omega: float) -> None:
        nodes[Omega] = _column(family, candidate, Omega, eps, steps, work)

    add(centre - half)
    add(centre + half)
    fit, met, reached = _fit(nodes, candidate, np.full(len(eps), centre)), None, 0
    for _ in range(TRIALS):
        last = _end(fit.sound)
        middle = float(fit.centre[last - 1])
        if last <= max(len(below), 2, reached) or middle in nodes:
            break
        add(middle)
        fit = _fit(nodes, candidate, fit.centre)
        if (nodes[middle][len(below) :] > 0).any():
            met, reached = middle, last
            if last == len(eps):
                break
    if met is None:
        return None
    found = _outline(candidate, eps, len(below), fit, nodes, met)
    for _ in range(TIPS):
        if found is None or found.lower[0] < found.upper[0] or found.eps[0] == 0 or found.lower[0] in nodes:
            break
        add(float(found.lower[0]))  # a tip, which damping lifts: to be measured
        fit = _fit(nodes, candidate, fit.centre)
        found = _outline(candidate, eps, len(below), fit, nodes, met)
    return found


def _column(
    family: SystemFamily, candidate: Candidate, Omega: float, eps: FloatArray, steps: float, work: Workspace
) -> FloatArray:
    """Return the test function of a candidate in one column, (k,)."""
    block = _block(family.at(Omega), candidate)
    sampler = Sampler(block, equations(block, least_frequency(Omega)), Omega, work)
    error = min(max(ACCURACY * _expected(candidate, eps)[1][-1], FINEST), COARSEST)
    finer = (COARSEST / error) ** 0.25  # fourth order
    spectra = multipliers(sampler, eps, log2_steps(block, Omega, eps, steps * finer), error)
    found = (modes_symplectic if block.symplectic else modes)(spectra.mu, spectra.exponents)
    conservative = block.symplectic or block.reversible
    name, start = candidate.name, candidate.home.exponents * (2 * np.pi / Omega)
    followed = follow(found, eps, start, conservative)
    return test_function(followed, candidate.p, candidate.q, name.j, name.sign, conservative)


def _fit(nodes: dict[float, FloatArray], candidate: Candidate, near: FloatArray) -> _Fit:
    """Return the parabolas through the three columns nearest to ``near`` (k,); through two, with the curvature that two
    modes of constant frequencies have."""
    centre = candidate.name.centre
    expected = -((candidate.name.j * np.pi / centre) ** 2)
    at = np.array(list(nodes)) - centre
    values = np.array(list(nodes.values()))
    with np.errstate(all="ignore"):
        distance = np.where(np.isnan(values), np.inf, np.abs(at[:, None] - (near - centre)))
        chosen = np.argsort(distance, axis=0, kind="stable")[:3]
        x, f = at[chosen], np.take_along_axis(values, chosen, axis=0)
        slope = (f[1] - f[0]) / (x[1] - x[0])
        if len(x) == 3:
            curvature = ((f[2] - f[0]) / (x[2] - x[0]) - slope) / (x[2] - x[1])
        else:
            curvature = np.full(len(near), expected)
        slope = slope - curvature * (x[1] - x[0])  # at x[0]
        vertex = x[0] - slope / (2 * curvature)
        height = f[0] - slope**2 / (4 * curvature)
        ratio = curvature / expected
        sound = (ratio > 1 / CURVATURE) & (ratio < CURVATURE) & (np.abs(vertex) < FARTHEST * centre)
    return _Fit(centre + vertex, height, -height / curvature, sound)


def _outline(
    candidate: Candidate, eps: FloatArray, first: int, fit: _Fit, nodes: dict[float, FloatArray], middle: float
) -> Tongue | None:
    """Return the region, given a column that meets it at ``middle``; ``first`` is the first level in the window."""
    levels = np.arange(len(eps))
    last = _end(fit.sound)
    sound = fit.sound & (levels < last)
    if last < max(first, 2):
        return None
    known, square_of_eps = levels[sound], eps**2
    centre, height, square = (np.interp(square_of_eps, square_of_eps[known], part[known]) for part in fit[:3])
    if len(known) > 1 and last >= len(eps) - GAP:  # a short gap at the top, too
        beyond, (a, b) = slice(last, None), known[-2:]
        part = (square_of_eps[beyond] - square_of_eps[b]) / (square_of_eps[b] - square_of_eps[a])
        for values in (centre, height, square):
            values[beyond] = values[b] + part * (values[b] - values[a])
        last = len(eps)
    free, expected = _expected(candidate, eps)
    distance = np.abs(np.array(list(nodes))[:, None] - centre)
    nearest = np.array(list(nodes.values()))[distance.argmin(axis=0), levels]
    measured = (nearest > 0) | (distance.min(axis=0) ** 2 < NEAR * np.abs(square))
    above = None
    for k in range(last - 1, -1, -1):
        if measured[k]:
            above = k if height[k] > 0 else above
        elif above is None:
            last = k
        else:
            more, part = height[above] - free, (eps[k] / eps[above]) ** 2
            height[k] = free + expected[k] * max(more / expected[above], TINY) ** part
            square[k] = square[above] * height[k] / height[above]
    closed = np.flatnonzero(height[:last] < 0)
    start = max(first, closed[-1] + 1 if len(closed) else 0)
    if last - start < 2:
        return None
    centre, half, at = centre[start:last], np.sqrt(np.maximum(square[start:last], 0.0)), eps[start:last]
    if start > first:  # the tip, where f at the vertex is zero
        part = height[start] / (height[start] - height[start - 1])
        tip = at[0] - part * (eps[start] - eps[start - 1])
        at, centre, half = np.append(tip, at), np.append(centre[0], centre), np.append(0.0, half)
    column = np.where(np.isfinite(nodes[middle]), nodes[middle], -np.inf)[first:]
    level = len(column) - 1 if column[-1] > 0.5 * column.max() else int(column.argmax())  # the same for many
    witness = (middle, float(eps[first + level]))
    return Tongue(candidate.name, at, centre - half, centre + half, witness, len(candidate.home.exponents))


def _end(sound: NDArray[np.bool_]) -> int:
    """Return the number of levels up to the first long gap in the trusted ones, or to the last of them."""
    trusted = np.flatnonzero(sound)
    if len(trusted) == 0 or trusted[0] > GAP:
        return 0
    gaps = np.flatnonzero(np.diff(trusted) > GAP + 1)
    return int(trusted[gaps[0] if len(gaps) else -1]) + 1


def _expected(candidate: Candidate, eps: FloatArray) -> tuple[float, FloatArray]:
    """Return f in the middle of a region without excitation, and by how much more it is expected to be at ``eps``."""
    name, exponents = candidate.name, candidate.home.exponents
    period = 2 * np.pi / name.centre
    decay = exponents[candidate.p].real * exponents[candidate.q].real
    growth = candidate.width * name.j / 4 * (eps / candidate.eps) ** name.j
    return -float(decay) * period**2, (growth * period) ** 2


def _block(system: PeriodicSystem, candidate: Candidate) -> Block:
    """Return the block of a member of the family that the modes of a candidate belong to."""
    wanted = candidate.home.block.K.diagonal()
    same = [block for block in blocks(system) if len(block.K) == len(wanted)]
    return min(same, key=lambda block: float(np.abs(block.K.diagonal() - wanted).max()))
