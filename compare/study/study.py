"""The study of a subject: charts, analytic curves, traced boundaries and verdicts, and pictures of them."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from tqdm import tqdm

from compare.audit import audit_sentence
from compare.comparison import compare_region, traced_curve
from compare.files import Case
from compare.outcome import RegionAgreement, each_once
from compare.pictures import Layer, Picture, overlay, region_panels, variant_panels
from compare.tally import Tally, identity
from compare.verdicts import questions
from floquet import BoundaryTrace, StabilityChart, stability_chart
from floquet.chart import TileStore
from floquet.running import gather, single_blas_thread
from periodic import AnyFamily
from periodic.checks import FloatArray
from perturb import TransitionCurve, transition_curves

# Number of eps at which a boundary is traced for a picture. A boundary is smooth except where it meets another one, so
# that these draw it without corners.
TRACE_POINTS = 12
# Part of an end of the window by which a region may start beyond it and still be drawn: it may lean into the window.
WINDOW_MARGIN = 0.1
# Number of panels that fit on a page.
MAX_PANELS = 6
# Columns and rows of a chart, and number of eps of a traced boundary, of a quick study: enough for a first look.
QUICK_POINTS = (96, 48)
QUICK_TRACE_POINTS = 5


@dataclass(frozen=True, eq=False)
class Subject:
    """What a study looks at.

    Attributes
    ----------
    name, title : str
        What its files are called, and its heading.
    systems : dict of str to AnyFamily
        Each system under its label; one alone has the label "".
    window, eps : (float, float), float
        Window of excitation frequencies and largest amplitude of the charts.
    points : (int, int)
        Columns and rows of the charts.
    modes : int
        Regions between so many lowest modes are judged.
    pairs : list of (int, int), optional
        Modes whose first regions are looked at closely, in this order; the widest ones if left out.
    compare : {"within", "beside"}
        Whether pictures show the systems in one panel for each region, or in a panel each.
    remark : str
        What the reader has to know besides.
    units : optional
        Of the frequencies in pictures, as `compare.plot` takes them.
    """

    name: str
    title: str
    systems: Mapping[str, AnyFamily]
    window: tuple[float, float]
    eps: float
    points: tuple[int, int]
    modes: int
    pairs: Sequence[tuple[int, int]] | None = None
    compare: Literal["within", "beside"] = "within"
    remark: str = ""
    units: Any = None

    @classmethod
    def of_case(cls, case: Case) -> Subject:
        """Return what a case file asks for."""
        chart, modes = case.chart, max(max(pair) for pair in case.regions)
        systems, pairs = case.systems(), case.regions
        return cls(
            case.name,
            case.title,
            systems,
            case.window,
            chart.eps,
            chart.points,
            modes,
            pairs,
            compare=case.compare,
            units=case.units,
        )

    def selected(self, curves: Sequence[TransitionCurve]) -> list[TransitionCurve]:
        """Return the regions that are looked at closely."""
        if self.pairs is None:
            low, high = self.window
            inside = [c for c in curves if low < c.centre < high and max(c.p, c.q) <= self.modes]
            widths = {curve: float(np.subtract(*reversed(curve.edges(self.eps)))) for curve in inside}
            widest = sorted((curve for curve in inside if widths[curve] > 0), key=lambda curve: -widths[curve])
            return sorted(widest[:MAX_PANELS], key=lambda curve: curve.centre)
        wanted = [{*pair} for pair in self.pairs]
        shown = [curve for curve in curves if curve.type == "sum" and curve.j == 1 and {curve.p, curve.q} in wanted]
        return sorted(shown, key=lambda curve: wanted.index({curve.p, curve.q}))


@dataclass(frozen=True, eq=False)
class SystemStudy:
    """Everything computed for one system of a subject.

    Attributes
    ----------
    label : str
        Name of the system; empty where the subject has only one.
    family : AnyFamily
    chart : StabilityChart
        The wide chart.
    curves : list of TransitionCurve
        Every analytic region that starts in the window or next to it.
    panels : list of (TransitionCurve, BoundaryTrace)
        Theory and integration for the regions that the subject looks at closely, in its order.
    verdicts : list of RegionAgreement
        Theory against integration for every region of the subject's modes in the window.
    """

    label: str
    family: AnyFamily
    chart: StabilityChart
    curves: list[TransitionCurve]
    panels: list[tuple[TransitionCurve, BoundaryTrace]]
    verdicts: list[RegionAgreement]

    @property
    def passed_audit(self) -> bool:
        """Whether another integrator computed some cells of the chart again, and they bore it out."""
        audit = self.chart.audit
        return audit is not None and audit.compared > 0 and audit.ok

    @property
    def audit(self) -> str:
        """What became of the audit, in a sentence."""
        return audit_sentence(self.chart.audit)


@dataclass(frozen=True, eq=False)
class Study:
    """A subject and what was computed for each of its systems."""

    subject: Subject
    variants: list[SystemStudy]

    @property
    def tally(self) -> Tally:
        """The regions of all systems, each counted once."""
        return tally_of([self])

    @property
    def agrees(self) -> bool:
        """Whether something was compared, nothing disagrees, and every chart passed its audit."""
        return self.tally.agrees and all(variant.passed_audit for variant in self.variants)

    @property
    def chart_names(self) -> list[str]:
        """Name of each variant's chart among `figures`."""
        return ["chart"] if len(self.variants) == 1 else [f"chart-{i}" for i, _ in enumerate(self.variants, start=1)]

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, fit for JSON."""
        return {
            "case": self.subject.name,
            "title": self.subject.title,
            "remark": self.subject.remark,
            "agrees": self.agrees,
            "summary": self.tally.to_dict(),
            "variants": [
                {
                    "label": variant.label,
                    "chart_passed_audit": variant.passed_audit,
                    "regions": [verdict.to_dict() for verdict in variant.verdicts],
                }
                for variant in self.variants
            ],
        }

    def figures(self) -> dict[str, Picture]:
        """Return the pictures of the subject by name."""
        layers = [Layer(variant.label, variant.chart, variant.panels) for variant in self.variants]
        draw = region_panels if self.subject.compare == "within" else variant_panels
        looked_at = any(variant.panels for variant in self.variants)
        pictures = {"regions": draw(layers, title=self.subject.title)} if looked_at else {}
        for variant, name in zip(self.variants, self.chart_names, strict=True):
            title = "\n".join(filter(None, (self.subject.title, variant.label)))
            traces = [trace for _, trace in variant.panels]
            pictures[name] = overlay(variant.chart, variant.curves, traces, title=title, units=self.subject.units)
        return pictures


def tally_of(studies: Sequence[Study]) -> Tally:
    """Return the regions of several studies, each counted once."""
    return Tally.of((variant.family, variant.verdicts) for study in studies for variant in study.variants)


def run_study(
    subject: Subject,
    *,
    n_jobs: int = -1,
    quick: bool = False,
    progress: bool = False,
    cache: str | os.PathLike[str] | TileStore | None = None,
) -> Study:
    """Compute one subject; parameters, result and errors as of `run_studies`."""
    return run_studies([subject], n_jobs=n_jobs, quick=quick, progress=progress, cache=cache)[0]


def run_studies(
    subjects: Sequence[Subject],
    *,
    n_jobs: int = -1,
    quick: bool = False,
    progress: bool = False,
    cache: str | os.PathLike[str] | TileStore | None = None,
) -> list[Study]:
    """Compute charts, curves, traced boundaries and verdicts for every system of several subjects.

    A region that several subjects ask for is traced once, and the regions of all subjects share the workers.

    Parameters
    ----------
    subjects : sequence of Subject
        From `Subject.of_case` or `system_subject`.
    n_jobs : int
        Workers, as in joblib; -1 for all cores.
    quick : bool
        Coarser charts and fewer points on the traced boundaries; the verdicts are the same.
    progress : bool
        Show progress bars.
    cache : path or TileStore, optional
        Folder that keeps finished parts of the charts, as in `floquet.stability_chart`.

    Returns
    -------
    list of Study
        In the order of ``subjects``.

    Raises
    ------
    ValueError
        If a system cannot be analysed, for instance above its divergence speed, or none of its regions starts in the
        window; the message begins with the title of the subject.
    """
    with single_blas_thread():  # the matrices are small: threads of BLAS would only fight
        plans = [_plan(subject, label, quick) for subject in subjects for label in subject.systems]
        charts = [_chart(plan, n_jobs, quick, progress, cache) for plan in plans]
        compared = _once([plan.questions for plan in plans], compare_region, "boundaries", n_jobs, progress)
        traced = _once([plan.traces for plan in plans], traced_curve, "traces", n_jobs, progress)
    made: dict[int, list[SystemStudy]] = {}
    for plan, chart, verdicts, traces in zip(plans, charts, compared, traced, strict=True):
        panels = [(curve, trace) for curve, trace in zip(plan.shown, traces, strict=True) if trace is not None]
        study = SystemStudy(plan.label, plan.family, chart, plan.curves, panels, each_once(verdicts))
        made.setdefault(id(plan.subject), []).append(study)
    return [Study(subject, made[id(subject)]) for subject in subjects]


class _Task(NamedTuple):
    """Something to compute: what it is, so that it is computed once, and the arguments."""

    what: Hashable
    arguments: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class _Plan:
    """One system of a subject, and what has to be computed for it."""

    subject: Subject
    label: str
    family: AnyFamily
    curves: list[TransitionCurve]
    shown: list[TransitionCurve]
    questions: list[_Task]
    traces: list[_Task]


def _plan(subject: Subject, label: str, quick: bool) -> _Plan:
    family, window, eps_max = subject.systems[label], subject.window, subject.eps
    system = identity(family)
    with _titled(subject):
        curves = transition_curves(family, ((1 - WINDOW_MARGIN) * window[0], (1 + WINDOW_MARGIN) * window[1]))
        asked = [_Task((system, key), (theory, key, None)) for theory, key in questions(family, window, subject.modes)]
        if not asked:
            raise ValueError(
                f"none of the regions between the {subject.modes} lowest modes starts in the window, Omega from "
                f"{window[0]:g} to {window[1]:g}; give another window, or regions of higher modes"
            )
    shown = subject.selected(curves)
    points = QUICK_TRACE_POINTS if quick else TRACE_POINTS
    traces = []
    for curve in shown:
        eps = _ladder(curve, eps_max, points)
        traces.append(_Task((system, curve.p, curve.q, curve.j, curve.type, *eps.tolist()), (family, curve, eps)))
    return _Plan(subject, label, family, curves, shown, asked, traces)


def _chart(
    plan: _Plan, n_jobs: int, quick: bool, progress: bool, cache: str | os.PathLike[str] | TileStore | None
) -> StabilityChart:
    columns, rows = QUICK_POINTS if quick else plan.subject.points
    Omega, eps = np.linspace(*plan.subject.window, columns), np.linspace(0, plan.subject.eps, rows)
    with _titled(plan.subject):
        return stability_chart(plan.family, Omega, eps, n_jobs=n_jobs, progress=progress, cache=cache)


def _once(
    wanted: Sequence[Sequence[_Task]], function: Callable[..., Any], name: str, n_jobs: int, progress: bool
) -> list[list[Any]]:
    """Return the result of every task, each computed once."""
    different = {task.what: task.arguments for tasks in wanted for task in tasks}
    with tqdm(desc=name, total=len(different), unit="region", disable=not progress) as bar:
        results = dict(zip(different, gather(function, list(different.values()), n_jobs, bar), strict=True))
    return [[results[task.what] for task in tasks] for tasks in wanted]


@contextmanager
def _titled(subject: Subject) -> Iterator[None]:
    """Let errors begin with the title of the subject."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{subject.title}: {error}") from None


def _ladder(curve: TransitionCurve, eps_max: float, points: int) -> FloatArray:
    """Values of eps for a traced boundary: even, or crowded towards the tip of a damped region, where it turns."""
    tip = curve.tip if curve.tip < eps_max else 0.0
    step = np.linspace(0.01, 1, points)
    return tip + (eps_max - tip) * (step**2 if tip > 0 else step)
