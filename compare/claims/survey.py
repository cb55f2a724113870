"""The range of parameters over which the paper's claims are judged, and the plates in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from typing import NamedTuple

from plate import EdgeLoad, MovingPlate


class NamedPlate(NamedTuple):
    """A plate and how a table names it."""

    name: str
    plate: MovingPlate


@dataclass(frozen=True)
class ClaimRange:
    """Parameters over which the claims are judged; another range may lead to other verdicts.

    Attributes
    ----------
    plate : MovingPlate
        Everything that a claim does not vary: Poisson's ratio, thickness, numbers of trial functions. Static in-plane
        stress, so that inertia enters only where a claim is about it.
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

    @property
    def scope(self) -> str:
        """The range of `survey` in words."""
        return (
            f"a/b = {some(self.aspect_ratios)}; V = {some(self.speed_fractions)} of the divergence speed; "
            f"f0 = {some(self.tensions)}; nu = {self.plate.poisson_ratio:g}; modes 1 to {self.modes}"
        )

    def survey(self, loads: dict[str, EdgeLoad]) -> Iterator[NamedPlate]:
        """Yield a plate for every aspect ratio, load, tension and part of the divergence speed."""
        for r, (load_name, load), tension in product(self.aspect_ratios, loads.items(), self.tensions):
            still = replace(self.plate, aspect_ratio=r, load=load, tension=tension, speed=0.0)
            for plate in _moving(still, self.speed_fractions):
                yield NamedPlate(f"a/b = {r:g}, {load_name}, V = {plate.speed:.3g}, f0 = {tension:g}", plate)

    def base(self) -> NamedPlate:
        """Return the plate as given."""
        plate = self.plate
        return NamedPlate(f"a/b = {plate.aspect_ratio:g}, V = {plate.speed:g}, f0 = {plate.tension:g}", plate)


@lru_cache(maxsize=256)
def _moving(still: MovingPlate, fractions: tuple[float, ...]) -> list[MovingPlate]:
    """Return the plate at parts of its divergence speed, kept since many claims look at the same plates."""
    return [replace(still, speed=fraction * still.critical_speed()) for fraction in fractions]


def middle_part(width: float) -> EdgeLoad:
    """Return the load on a part of the edge about the mid-line."""
    return EdgeLoad.uniform() if width == 1 else EdgeLoad.partial(width)


def part_name(width: float) -> str:
    """Return the name of `middle_part`."""
    return "uniform load" if width == 1 else f"load on the middle {width:g}"


def symmetric_loads(study: ClaimRange) -> dict[str, EdgeLoad]:
    """Return the widest load of the range and the one nearest half the edge, both symmetric about the mid-line."""
    half = min(study.widths, key=lambda width: abs(width - 0.5))
    return {part_name(width): middle_part(width) for width in dict.fromkeys((max(study.widths), half))}


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
    aspect_ratios=(1.0, 2.0),
    widths=(1.0, 0.5),
    speed_fractions=(0.7,),
    speeds=(3.0,),
    tensions=(10.0,),
    dampings=(1e-5,),
)
