"""The explorer live: sliders and zoom change the parameters, and charts of growing resolution follow.

State flows one way. A control replaces one entry of `State`. A worker thread makes system, curves and charts of the
newest state, and hands each to the page. The page changes only what it shows. A result is dropped if its state is no
longer the newest.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import ceil
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.events import RangesUpdate, Tap
from bokeh.layouts import row
from bokeh.models import Select, Slider
from bokeh.models.layouts import LayoutDOM
from bokeh.server.server import Server

from compare.explorer.exploration import Exploration, analytic_curves
from compare.explorer.page import Page
from compare.explorer.responses import response
from compare.explorer.variation import current, varied
from compare.files import Plate
from floquet import StabilityChart, stability_chart
from periodic import SystemFamily
from periodic.checks import whole_number
from plate import WAVEFORMS

logger = logging.getLogger(__name__)

ADDRESS = "127.0.0.1"
# Columns and rows of successive charts. The first one is a step coarser than what MAX_FIRST_CHART_SECONDS are expected
# to allow, since a change of the system can make a cell cost some times more. The others follow while nothing changes.
LIVE_RESOLUTIONS = ((24, 12), (48, 24), (96, 48), (192, 96), (256, 128))
MAX_FIRST_CHART_SECONDS = 0.6
# A chart is computed in parts that take so long, so that a control never waits long for a chart that is out of date.
MAX_PART_SECONDS = 0.25
# Ends of the sliders and of the zoom, in multiples of where they start (speed: of the critical speed); the least end of
# the damping slider, the largest eps of the zoom, and the end of the slider of harmonics.
SPEED_REACH, TENSION_REACH, DAMPING_REACH, MIN_DAMPING_REACH = 1.15, 3.0, 10.0, 0.002
ZOOM_REACH, MAX_ZOOM_EPS, MAX_SLIDER_HARMONICS = 3.0, 10.0, 9
HINT = "Click the chart for the multipliers and the solution there; zoom with a box to look closer."


@dataclass(frozen=True, eq=False)
class State:
    """What the user has chosen: the window, and a plate's table, or a system that no slider changes."""

    source: Plate | SystemFamily
    Omega: tuple[float, float]
    eps: tuple[float, float]

    @cached_property
    def family(self) -> SystemFamily:
        """The system. Raises ValueError where there is no plate with these parameters."""
        return self.source.build() if isinstance(self.source, Plate) else self.source


class LivePage:
    """One browser window: its page, its state and the threads that compute for it.

    Parameters
    ----------
    document : Document
        Bokeh's document of the session.
    title : str
        Heading.
    state : State
        What the page starts from.
    order : int
        Order of the analytic curves.
    n_jobs : int
        Workers for each chart.
    """

    def __init__(self, document: Document, title: str, state: State, order: int, n_jobs: int) -> None:
        self._document, self._order, self._n_jobs = document, order, n_jobs
        self._state, self._chosen = state, (float("nan"), float("nan"))
        self._seconds_a_cell = float("nan")
        # Clicks do not wait for charts.
        self._charts, self._points = ThreadPoolExecutor(1), ThreadPoolExecutor(1)
        self._page = Page(title, HINT)
        self._page.tell("computing the first chart …")
        self._page.frame(state.Omega, state.eps)
        # At lower Omega periods are long, and a chart would take minutes.
        self._page.figure.x_range.bounds = (state.Omega[0] / ZOOM_REACH, state.Omega[1] * ZOOM_REACH)
        self._page.figure.y_range.bounds = (0.0, max(state.eps[1], MAX_ZOOM_EPS))
        self._page.figure.on_event(RangesUpdate, self._zoomed)
        self._page.figure.on_event(Tap, lambda event: self._choose(event.x, event.y))
        controls = _controls(state.source, self._set) if isinstance(state.source, Plate) else []
        document.title = title
        self._page.live(document, controls)
        document.on_session_destroyed(lambda _: self._close())
        self._change(state)

    def _set(self, name: str, value: Any) -> None:
        plate = self._state.source
        if isinstance(plate, Plate):
            self._change(replace(self._state, source=varied(plate, name, value)))

    def _zoomed(self, event: RangesUpdate) -> None:
        state = replace(self._state, Omega=(event.x0, event.x1), eps=(event.y0, event.y1))
        if not np.allclose((*state.Omega, *state.eps), (*self._state.Omega, *self._state.eps), rtol=1e-6, atol=0.0):
            self._change(state)

    def _change(self, state: State) -> None:
        """Make a state the newest one; what is being computed for the old one will be dropped."""
        self._state = state
        self._charts.submit(self._work, state, self._compute_charts)
        self._choose(*self._chosen)

    def _choose(self, Omega: float, eps: float) -> None:
        self._chosen = (Omega, eps)
        if Omega > 0:
            self._points.submit(self._work, self._state, partial(self._compute_point, Omega=Omega, eps=max(eps, 0.0)))

    def _close(self) -> None:
        self._state = replace(self._state)  # so that the state that is being worked on is no longer the newest
        for executor in (self._charts, self._points):
            executor.shutdown(wait=False, cancel_futures=True)

    # In the worker threads, which read `_state` but change nothing that the page shows:

    def _work(self, state: State, task: Callable[[State], None]) -> None:
        try:
            task(state)
        except ValueError as error:
            self._later(state, self._page.tell, f"{error}. The page shows the last valid result.", fault=True)
        except Exception as error:
            logger.exception("the explorer met an error of its own")
            self._later(state, self._page.tell, f"{type(error).__name__}: {error}", fault=True)

    def _later(self, state: State, show: Callable[..., None], *arguments: Any, **options: Any) -> None:
        """Let the page show a result, unless its state is no longer the newest."""

        def callback() -> None:
            if state is self._state:
                show(*arguments, **options)

        if state is self._state:
            self._document.add_next_tick_callback(callback)

    def _compute_charts(self, state: State) -> None:
        if state is not self._state:
            return
        start = time.perf_counter()
        curves, remark = analytic_curves(state.family, state.Omega, state.eps[1], self._order)
        for chart in self._finer_and_finer(state):
            exploration = Exploration("", chart, curves, [], self._order, remark, traced=False)
            self._later(state, self._show, exploration, time.perf_counter() - start)

    def _finer_and_finer(self, state: State) -> Iterator[StabilityChart]:
        expected = [self._seconds_a_cell * columns * rows for columns, rows in LIVE_RESOLUTIONS]
        first = max(sum(seconds <= MAX_FIRST_CHART_SECONDS for seconds in expected) - 2, 0)
        for columns, rows in LIVE_RESOLUTIONS[first:]:
            Omega, eps = np.linspace(*state.Omega, columns), np.linspace(*state.eps, rows)
            seconds = self._seconds_a_cell * columns * rows
            parts = min(ceil(seconds / MAX_PART_SECONDS), columns) if seconds > 0 else 1
            start = time.perf_counter()
            done = []
            for part in np.array_split(Omega, parts):
                if state is not self._state:
                    return
                done.append(stability_chart(state.family, part, eps, n_jobs=self._n_jobs, progress=False, audit=0))
            self._seconds_a_cell = (time.perf_counter() - start) / (columns * rows)
            yield _joined(done)

    def _compute_point(self, state: State, *, Omega: float, eps: float) -> None:
        if state is self._state and self._chosen[0] == Omega:
            self._later(state, self._page.pick, response(state.family, Omega, eps))

    # In Bokeh's thread again:

    def _show(self, exploration: Exploration, seconds: float) -> None:
        chart = exploration.chart
        self._page.show(exploration)
        rows, columns = chart.kind.shape
        finest = (columns, rows) == LIVE_RESOLUTIONS[-1]
        progress = f"{columns} × {rows} points after {seconds:.2f} s{'' if finest else ', refining …'}"
        self._page.tell(" ".join(filter(None, (progress, exploration.remark))))
        if not self._chosen[0] > 0:
            row, column = np.unravel_index(np.argmax(chart.growth_rate), chart.growth_rate.shape)
            self._choose(float(chart.Omega[column]), float(chart.eps[row]))


def serve(title: str, state: State, *, port: int, order: int = 1, n_jobs: int = -1) -> Server:
    """Start a server of the live page, for this machine alone, and return it; the caller runs its ``io_loop``.

    Parameters
    ----------
    title : str
        Heading.
    state : State
        What every new browser window starts from.
    port : int
        Of 127.0.0.1; 0 takes a free one (``server.port``).
    order : 1 or 2
        Order of the analytic curves.
    n_jobs : int
        Workers for each chart.

    Raises
    ------
    ValueError
        If the port is out of range or taken, or the state's system cannot be integrated.
    """
    whole_number("port", port, least=0, most=65535)

    def open_page(document: Document) -> None:
        LivePage(document, title, state, order, n_jobs)

    # Compile, or load, what the first page would otherwise wait for.
    stability_chart(state.family, state.Omega, state.eps, n_jobs=1, progress=False, audit=0)
    response(state.family, state.Omega[1], state.eps[1])

    try:
        server = Server({"/": open_page}, address=ADDRESS, port=port)
    except OSError as error:
        raise ValueError(f"port = {port} of {ADDRESS} cannot be opened ({error.strerror}); give another") from None
    server.start()
    return server


def _controls(plate: Plate, change: Callable[[str, Any], None]) -> list[LayoutDOM]:
    """Return a row of sliders for the plate's table; each reports a new value under its name."""
    now = current(plate)
    V_cr = plate.build().critical_speed()
    tension = TENSION_REACH * max(abs(now["tension"]), 1.0)
    damping = max(DAMPING_REACH * now["damping"], MIN_DAMPING_REACH)
    sliders = {
        "speed": ("speed V", 0.0, SPEED_REACH * V_cr, 0.01, "0.00"),
        "tension": ("tension f₀", min(0.0, now["tension"]), tension, tension / 300, "0.00"),
        "damping": ("damping c", 0.0, damping, damping / 200, "0.00000"),
        "width": ("load width / b", 0.05, 1.0, 0.01, "0.00"),
        "aspect_ratio": (
            "aspect ratio a/b",
            min(0.25, now["aspect_ratio"]),
            max(4.0, now["aspect_ratio"]),
            0.05,
            "0.00",
        ),
        "harmonics": ("harmonics", 1, max(MAX_SLIDER_HARMONICS, now["harmonics"]), 1, "0"),
    }
    waveform = Select(
        title="waveform",
        value=now["waveform"],
        options=sorted({*WAVEFORMS, now["waveform"]}),
        width=100,
        name="waveform",
    )
    waveform.on_change("value", lambda _, old, new: change("waveform", new))
    widgets: list[LayoutDOM] = []
    for name, (title, start, end, step, format) in sliders.items():
        slider = Slider(
            title=title, start=start, end=end, step=step, value=now[name], format=format, width=190, name=name
        )
        slider.on_change("value", lambda _, old, new, name=name: change(name, new))
        widgets.append(slider)
    return [row(*widgets, waveform, sizing_mode="stretch_width")]


def _joined(parts: list[StabilityChart]) -> StabilityChart:
    """Return one chart of parts that follow each other along Omega."""

    def joined(name: str) -> np.ndarray:
        return np.concatenate([getattr(part, name) for part in parts], axis=-1)

    return StabilityChart(
        Omega=joined("Omega"),
        eps=parts[0].eps,
        growth_rate=joined("growth_rate"),
        multiplier=joined("multiplier"),
        kind=joined("kind"),
        error=joined("error"),
        rigid=max(part.rigid for part in parts),
    )
