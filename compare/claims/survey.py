"""The plates on which the paper's claims are judged: those of its figures, and a wider range of parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from typing import NamedTuple

from scipy.optimize import brentq

from compare.claims.convergence import KEPT_PLATES, converged
from compare.claims.scopes import Scope
from perturb import gyroscopic_modes
from plate import EdgeLoad, MovingPlate

# The only number of the paper's figures that survives: an axis tick under Fig. 2(c), next to 2 omega_3.
SURVIVING_TICK = 71.0
# A plate is not asked for at speeds nearer to divergence than this part of it.
MIN_SPEED_MARGIN = 1e-6


class NamedPlate(NamedTuple):
    """A plate, how a table names it, and the load that it is under."""

    name: str
    plate: MovingPlate
    load: str


@dataclass(frozen=True)
class ClaimRange:
    """Parameters over which the claims are judged; another range may lead to other numbers.

    Attributes
    ----------
    plate : MovingPlate
        Everything that a claim does not vary: Poisson's ratio, thickness. Static in-plane stress, so that inertia
        enters only where a claim is about it. Terms that it leaves open are chosen plate by plate
        (`compare.claims.convergence`).
    figure_tensions : tuple of float
        f0 of the paper's figures. The speed follows from the tick that survives (`figure_speed`).
    figure_aspect_ratios : tuple of float
        a/b of the paper's Fig. 5.
    aspect_ratios : tuple of float
        a/b.
    widths : tuple of float
        Loaded parts of the edge about the mid-line, by decreasing width.
    speed_fractions : tuple of float
        V as a part of each plate's own divergence speed.
    speeds : tuple of float
        V, where a claim compares plates at one speed.
    tensions : tuple of float
        f0.
    poisson_ratios, thickness_ratios, dampings : tuple of float
        nu, h/b and c, where a claim is about them.
    modes : int
        Lowest modes taken into account, as in the paper's figures.
    eps : float
        Amplitude at which widths are compared: small enough for first order to hold, large enough that widths stand
        clear of the errors of tracing.
    amplitudes : tuple of float
        Where a claim is about what first order leaves out.
    """

    plate: MovingPlate = field(default_factory=lambda: MovingPlate(inplane="static"))
    figure_tensions: tuple[float, ...] = (8.0, 10.0, 16.0, 25.0, 35.0)
    figure_aspect_ratios: tuple[float, ...] = (1.0, 2.0, 3.0)
    aspect_ratios: tuple[float, ...] = (1.0, 1.5, 2.0, 3.0)
    widths: tuple[float, ...] = (1.0, 0.75, 0.5, 0.25)
    speed_fractions: tuple[float, ...] = (0.35, 0.7, 0.9)
    speeds: tuple[float, ...] = (1.0, 2.0, 3.0)
    tensions: tuple[float, ...] = (10.0, 50.0)
    poisson_ratios: tuple[float, ...] = (0.0, 0.3)
    thickness_ratios: tuple[float, ...] = (0.001, 0.01, 0.05)
    dampings: tuple[float, ...] = (1e-5, 5e-5)
    modes: int = 3
    eps: float = 0.05
    amplitudes: tuple[float, ...] = (0.0025, 0.05, 0.4)

    # --- the paper's figures -----------------------------------------------------------------------------------------

    @property
    def figure_scope(self) -> str:
        """Where the plates of the figures lie, in words."""
        points = ", ".join(f"({f0:g}, {figure_speed(self.plate, f0, self.modes):.3g})" for f0 in self.figure_tensions)
        return f"2ω₃ = {SURVIVING_TICK:g} of the square plate under uniform load, (f0, V) = {points}"

    def figure(self, r: float = 1.0, load: EdgeLoad | None = None, load_name: str = "uniform load") -> list[NamedPlate]:
        """Return a plate of the figures at every point of the curve that the tick leaves."""
        return [self.figure_plate(f0, r, load, load_name) for f0 in self.figure_tensions]

    def figure_plate(
        self, f0: float, r: float = 1.0, load: EdgeLoad | None = None, load_name: str = "uniform load"
    ) -> NamedPlate:
        """Return one of them."""
        return self._named(self._figure(f0, r, load or EdgeLoad.uniform()), load_name)

    def figures(self, scope: Scope) -> tuple[str, list[NamedPlate]]:
        """Return the paper's Fig. 2, its plate with both stresses that a uniform load may be taken to cause."""
        plates = [
            NamedPlate(f"{name}, {said}", replace(plate, inplane=inplane), load)
            for name, plate, load in self.figure()
            for inplane, said in (("membrane", "N_xx = f"), ("static", "in-plane problem solved"))
        ]
        return f"Fig. 2: {self.figure_scope}; N_xx = f, or the in-plane problem solved", plates

    # --- the wider range ---------------------------------------------------------------------------------------------

    def survey(self, loads: dict[str, EdgeLoad]) -> tuple[str, list[NamedPlate]]:
        """Return a plate for every aspect ratio, load, tension and part of the divergence speed, and that in words."""
        scope = (
            f"a/b = {some(self.aspect_ratios)}; V = {some(self.speed_fractions)} of the divergence speed; "
            f"f0 = {some(self.tensions)}; nu = {self.plate.poisson_ratio:g}; loads: {', '.join(loads)}"
        )
        return scope, [self._named(request, name) for name, request in self._survey(loads)]

    def plates(self, scope: Scope, loads: dict[str, EdgeLoad]) -> tuple[str, list[NamedPlate]]:
        """Return the plates of a scope: the paper's Fig. 2, or `survey`."""
        return self.survey(loads) if scope is Scope.WIDER else self.figures(scope)

    def series_plate(self, r: float, speed: float, share: float) -> NamedPlate:
        """Return the plate of this aspect ratio and speed under a load on this part of the edge."""
        return self._named(self._series(r, speed, share), part_name(share))

    def model_plate(self, r: float, load: EdgeLoad, load_name: str, nu: float) -> NamedPlate:
        """Return the plate, as given, of this aspect ratio, load and Poisson's ratio."""
        return self._named(self._model(r, load, nu), load_name)

    # --- their terms -------------------------------------------------------------------------------------------------

    def requests(self) -> list[Request]:
        """Return every plate that the claims look at, to choose its terms; variants of it take the same."""
        half = middle_part(FIGURE_WIDTH)
        shapes = [(1.0, load) for load in linear_loads().values()] + [(r, half) for r in self.figure_aspect_ratios]
        figures = [self._figure(f0, r, load) for f0, (r, load) in product(self.figure_tensions, shapes)]
        survey = [request for _, request in self._survey(symmetric_loads(self) | skew_loads())]
        series = [self._series(*each) for each in product(self.aspect_ratios, self.speeds, self.widths)]
        loads = [*linear_loads().values(), *symmetric_loads(self).values()]
        nus = dict.fromkeys((*self.poisson_ratios, self.plate.poisson_ratio))
        models = [self._model(*each) for each in product(self.aspect_ratios, loads, nus)]
        return list(dict.fromkeys(figures + survey + series + models))

    def _figure(self, f0: float, r: float, load: EdgeLoad) -> Request:
        speed = figure_speed(self.plate, f0, self.modes)
        return Request(replace(self.plate, aspect_ratio=r, load=load, tension=f0, speed=speed), None)

    def _survey(self, loads: dict[str, EdgeLoad]) -> Iterator[tuple[str, Request]]:
        for r, (name, load), tension in product(self.aspect_ratios, loads.items(), self.tensions):
            still = replace(self.plate, aspect_ratio=r, load=load, tension=tension, speed=0.0)
            for fraction in self.speed_fractions:
                yield name, Request(still, fraction)

    def _series(self, r: float, speed: float, share: float) -> Request:
        return Request(replace(self.plate, aspect_ratio=r, speed=speed, load=middle_part(share)), None)

    def _model(self, r: float, load: EdgeLoad, nu: float) -> Request:
        return Request(replace(self.plate, aspect_ratio=r, load=load, poisson_ratio=nu), None)

    def _named(self, request: Request, load: str) -> NamedPlate:
        plate = converged(*request, self.modes).plate
        return NamedPlate(
            f"a/b = {plate.aspect_ratio:g}, {load}, V = {plate.speed:.3g}, f0 = {plate.tension:g}", plate, load
        )


class Request(NamedTuple):
    """A plate whose terms are still open, and its speed as a part of its divergence speed (None: as it is)."""

    plate: MovingPlate
    fraction: float | None


@lru_cache(maxsize=KEPT_PLATES)
def figure_speed(plate: MovingPlate, f0: float, modes: int) -> float:
    """Return the speed at which the square plate under uniform load has 2ω₃ at the tick that survives.

    Parameters
    ----------
    plate : MovingPlate
        Everything else, as `ClaimRange.plate`.
    f0 : float
        Tension.
    modes : int
        As `ClaimRange.modes`.

    Raises
    ------
    ValueError
        If no speed below the divergence speed does it.
    """
    still = replace(plate, aspect_ratio=1.0, load=EdgeLoad.uniform(), tension=f0, speed=0.0)
    for _ in range(2):  # with the terms of the plate at rest, then with those that it needs at that speed
        fastest = (1 - MIN_SPEED_MARGIN) * still.critical_speed()
        if _beyond_tick(0.0, still) < 0 or _beyond_tick(fastest, still) > 0:
            raise ValueError(f"f0 = {f0!r} leaves no speed with 2 omega_3 = {SURVIVING_TICK:g}; give another one")
        speed = float(brentq(_beyond_tick, 0.0, fastest, args=(still,), xtol=1e-10))
        still = replace(converged(replace(still, speed=speed), None, modes).plate, speed=0.0)
    return speed


def _beyond_tick(speed: float, still: MovingPlate) -> float:
    return 2 * float(gyroscopic_modes(replace(still, speed=speed).at(0.0)).frequencies[2]) - SURVIVING_TICK


# Loaded part of the edge in the paper's Figs. 4 and 5.
FIGURE_WIDTH = 0.5


def middle_part(width: float) -> EdgeLoad:
    """Return the load on a part of the edge about the mid-line."""
    return EdgeLoad.uniform() if width == 1 else EdgeLoad.partial(width)


def part_name(width: float) -> str:
    """Return the name of `middle_part`."""
    return "uniform load" if width == 1 else f"load on the middle {width:g}"


def symmetric_loads(study: ClaimRange) -> dict[str, EdgeLoad]:
    """Return the widest load of the range and the one nearest half the edge, both symmetric about the mid-line."""
    half = min(study.widths, key=lambda width: abs(width - FIGURE_WIDTH))
    return {part_name(width): middle_part(width) for width in dict.fromkeys((max(study.widths), half))}


def linear_loads() -> dict[str, EdgeLoad]:
    """Return linearly distributed loads."""
    return {"uniform load": EdgeLoad.uniform(), "load rising from 0.5 to 1.5": EdgeLoad.linear(0.5, 1.5)}


def skew_loads() -> dict[str, EdgeLoad]:
    """Return loads that are not symmetric about the mid-line."""
    return {
        "load rising from 0 to 2": EdgeLoad.linear(0.0, 2.0),
        "load on one half": EdgeLoad.partial(0.5, centre=0.25),
    }


def some(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:g}" for value in values)


# A first look: what `--quick` judges.
QUICK_RANGE = ClaimRange(
    figure_tensions=(10.0,),
    aspect_ratios=(1.0, 2.0),
    widths=(1.0, 0.5),
    speed_fractions=(0.7,),
    speeds=(3.0,),
    tensions=(10.0,),
    dampings=(1e-5,),
)
