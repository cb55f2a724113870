"""Where theory and integration agree: region by region, in plain numbers.

Each region's two edges are traced by root-finding on the Floquet multipliers and held against the analytic transition
curves on a ladder of eps (`compare.ladder`). A theory of order m leaves a gap O(eps^(m+1)): what counts is that no part
of order m or lower is left as eps -> 0 (`compare.orders`).

A comparison has three outcomes. A region that could not be compared is neither agreement nor disagreement; it is
counted apart, with the reason (`compare.outcome`).
"""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike
from tqdm import tqdm

from compare.comparison import MIN_RUNGS, Key, Theory, compare_region
from compare.outcome import RegionAgreement, each_once
from compare.rigid import elastic_part
from floquet.running import gather
from periodic import AnyFamily, any_member_at
from periodic.checks import grid, interval, one_of, whole_number, workers


def agreement(
    family: AnyFamily,
    Omega_range: tuple[float, float],
    eps: ArrayLike | None = None,
    *,
    order: Literal[1, 2] = 1,
    types: tuple[str, ...] = ("sum", "difference"),
    modes: int | None = None,
    n_jobs: int | None = -1,
    progress: bool = False,
) -> list[RegionAgreement]:
    """Judge every region that opens in a frequency window, theory against Floquet integration.

    Parameters
    ----------
    family : AnyFamily
        A `periodic.PeriodicSystem` or `FirstOrderSystem`, a `plate.MovingPlate`, or anything with ``at(Omega)``.
        Rigid-body motions that nothing touches are set apart, and the modes of the rest are numbered
        (`compare.rigid.elastic_part`).
    Omega_range : (float, float)
        Window of excitation frequencies in which a region's centre must lie.
    eps : array_like, shape (k,), optional
        Ladder, increasing, at least three positive values. If left out, each region has one that suits it: eps is small
        where the excitation changes the stiffness of the region's modes by a small part, and a damped region is
        compared above its tip (`compare.ladder`). Smaller rungs are added where the gap has not come to its limit.
    order : 1 or 2
        Order of the theory; the gap is expected to be O(eps^(order + 1)).
    types : tuple of str
        Types of resonance to judge. Regions that the theory predicts closed are judged too: integration must find
        no instability there. What cannot be compared is in the list with the reason.
    modes : int, optional
        Judge only resonances among the lowest ``modes`` modes; all if left out.
    n_jobs : int or None
        Regions traced at once, as in `floquet.stability_chart`.
    progress : bool
        Show a progress bar.

    Returns
    -------
    list of RegionAgreement
        By ascending centre. A region that several resonances share comes once, under one of its names.

    Raises
    ------
    ValueError
        If an argument is out of range, or there is no theory for the system (see `perturb.transition_curves`).
    """
    window = interval("Omega_range", Omega_range, nonnegative=True)
    any_member_at(family, window[1], "family")
    ladder = None if eps is None else grid("eps", eps, positive=True)
    if ladder is not None and ladder.size < MIN_RUNGS:
        raise ValueError(f"eps has {ladder.size} values; give at least {MIN_RUNGS}, so that an order can be fitted")
    one_of("order", order, (1, 2))
    n_jobs = workers("n_jobs", n_jobs)
    if modes is not None:
        whole_number("modes", modes, least=1)

    tasks = [(*question, ladder) for question in questions(family, window, modes, order=order, types=types)]
    with tqdm(desc="boundaries", total=len(tasks), unit="region", disable=not progress) as bar:
        return each_once(gather(compare_region, tasks, n_jobs, bar))


def questions(
    family: AnyFamily,
    window: tuple[float, float],
    modes: int | None,
    *,
    order: Literal[1, 2] = 1,
    types: tuple[str, ...] = ("sum", "difference"),
) -> list[tuple[Theory, Key]]:
    """Return the regions to compare, by ascending centre, as the first arguments of `compare_region`."""
    elastic, _ = elastic_part(family, window[1])
    theory = Theory(elastic, window, order, types)
    keys = [key for key in theory.curves(1.0) if modes is None or max(key.p, key.q) <= modes]
    return [(theory, key) for key in keys]
