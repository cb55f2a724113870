"""Systems by the names of their parameters: a user's function, a plate, or one of the planes that the program knows.

>>> from compare.explorer.parameters import KNOWN_PLANES, point_maker
>>> make = point_maker(KNOWN_PLANES["mathieu"], ("a", [1.0]), ("q", [0.2]), {})
>>> make(1.0, 0.2).eps
0.4
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from compare.explorer.variation import SWEEPABLE, varied
from compare.files import Plate, did_you_mean, load_system, python_function
from floquet import Point
from periodic import AnyFamily, waveforms
from periodic.checks import one_of
from periodic.examples import blade_flap, mathieu, quadrupole_trap
from periodic.waveforms import Waveform

# Frequency and amplitude of the excitation, which are parameters of every system that does not come as a Point.
EXCITATION = ("Omega", "eps")
# Systems that are kept, so that neighbouring cells share them.
MAX_KEPT_SYSTEMS = 1024
# Waveforms of a trap, by name.
TRAP_WAVES = ("cosine", "rectangular", "triangle", "sawtooth")

Value = float | str


class Parametric(NamedTuple):
    """A system with named parameters.

    Attributes
    ----------
    title : str
    build : callable
        Returns a `Point`, or a system or family, from keyword arguments.
    own : tuple of str
        The names of these arguments.
    optional : tuple of str
        Parameters that may be left out.
    excited : bool or None
        Whether ``build`` returns a system, so that Omega and eps are parameters beside its own. None if that shows only
        when it is called.
    """

    title: str
    build: Callable[..., Any]
    own: tuple[str, ...]
    optional: tuple[str, ...] = ()
    excited: bool | None = False

    @property
    def names(self) -> tuple[str, ...]:
        """All parameters."""
        if self.excited is False:
            return self.own
        return (*self.own, *(name for name in EXCITATION if name not in self.own))


def point_maker(
    system: Parametric, x: tuple[str, Sequence[float]], y: tuple[str, Sequence[float]], fixed: Mapping[str, Value]
) -> Callable[[float, float], Point]:
    """Return what makes a `Point` of the values of the parameters ``x`` and ``y``, the others being ``fixed``.

    Systems are kept, so that neighbouring cells share them.

    Raises
    ------
    ValueError
        If a name is unknown, given twice, or missing.
    """
    given = [x[0], y[0], *fixed]
    for name in given:
        if name not in system.names:
            hint = did_you_mean(name, system.names)
            raise ValueError(f"{system.title} has no parameter {name!r}; it has {', '.join(system.names)}{hint}")
        if given.count(name) > 1:
            raise ValueError(f"{name} is given twice; give it once, as --x, as --y or by --set")
    _refuse_missing(system, system.own, given)
    built = lru_cache(maxsize=MAX_KEPT_SYSTEMS)(lambda *values: system.build(**dict(values)))

    def found(at_x: float, at_y: float) -> tuple[Any, dict[str, Any]]:
        values = {**fixed, x[0]: at_x, y[0]: at_y}
        return built(*((name, value) for name, value in values.items() if name in system.own)), values

    if system.excited is not False and _gives_points(found, x[1], y[1]):
        beside = [name for name in EXCITATION if name in given and name not in system.own]
        if beside:
            raise ValueError(f"{system.title} returns a Point, which has its own {beside[0]}; leave that out")
    elif system.excited is not False:
        _refuse_missing(system, EXCITATION, given)

    def make(at_x: float, at_y: float) -> Point:
        one, values = found(at_x, at_y)
        return one if isinstance(one, Point) else Point(one, values["Omega"], values.get("eps", 1.0))

    return make


def _refuse_missing(system: Parametric, needed: Sequence[str], given: Sequence[str]) -> None:
    missing = [name for name in needed if name not in given and name not in system.optional]
    if missing:
        raise ValueError(f"{system.title} needs a value of {missing[0]}; add --set {missing[0]}=VALUE")


def _gives_points(
    found: Callable[[float, float], tuple[Any, dict[str, Any]]], x: Sequence[float], y: Sequence[float]
) -> bool:
    """Return whether a function gives a `Point` at the first of some cells at which it gives anything."""
    for at_x, at_y in product((x[0], x[len(x) // 2], x[-1]), (y[0], y[len(y) // 2], y[-1])):
        with suppress(ValueError):
            return isinstance(found(at_x, at_y)[0], Point)
    return False


def parametric_file(path: Path) -> Parametric:
    """Return the system in a file: in a Python file with the parameters of its function ``system``.

    If the function returns a system and no `Point`, Omega is a parameter, too, and eps, which is 1 if left out.

    Raises
    ------
    ValueError
        If the file cannot be read, or a parameter of its function has no name.
    """
    if path.suffix != ".py":
        system = load_system(path)
        return Parametric(path.name, lambda: system, (), excited=True)
    function = python_function(path)
    names, optional = [], ["eps"]
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind not in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            raise ValueError(f"{path}: system({parameter}) takes parameters without a name; give each its name")
        names.append(parameter.name)
        if parameter.default is not parameter.empty:
            optional.append(parameter.name)
    return Parametric(path.name, function, tuple(names), tuple(optional), excited=None)


def parametric_plate(title: str, plate: Plate) -> Parametric:
    """Return a plate with everything that `varied` changes as a parameter."""

    def build(**values: Value) -> AnyFamily:
        table = plate
        for name, value in values.items():
            table = varied(table, name, value)
        return table.build()

    own = (*SWEEPABLE, "waveform")
    return Parametric(title, build, own, own, excited=True)


def _trap(a: float, q: float, waveform: str = "cosine", duty: float = 0.5) -> Point:
    return Point(_kept_trap(a, waveform, duty), 2.0, q)


@lru_cache(maxsize=MAX_KEPT_SYSTEMS)
def _kept_trap(a: float, waveform: str, duty: float) -> AnyFamily:
    one_of("waveform", waveform, TRAP_WAVES)
    if duty != 0.5 and waveform != "rectangular":
        raise ValueError(f"duty = {duty!r} belongs to a rectangular waveform; add --set waveform=rectangular")
    wave: Waveform = waveforms.rectangular(duty) if waveform == "rectangular" else getattr(waveforms, waveform)()
    return quadrupole_trap(a, wave)


_kept_mathieu, _kept_blade = (
    lru_cache(maxsize=MAX_KEPT_SYSTEMS)(mathieu),
    lru_cache(maxsize=MAX_KEPT_SYSTEMS)(blade_flap),
)

KNOWN_PLANES = {
    "mathieu": Parametric(
        "Mathieu's equation, y″ + d y′ + (a − 2q cos 2z) y = 0",
        lambda a, q, damping=0.0: Point(_kept_mathieu(a, damping), 2.0, 2 * q),
        ("a", "q", "damping"),
        ("damping",),
    ),
    "mathieu-delta": Parametric(
        "Mathieu's equation, x″ + d x′ + (δ + ε cos t) x = 0",
        lambda delta, eps, damping=0.0: Point(_kept_mathieu(delta, damping), 1.0, eps),
        ("delta", "eps", "damping"),
        ("damping",),
    ),
    "trap": Parametric("quadrupole trap", _trap, ("a", "q", "waveform", "duty"), ("waveform", "duty")),
    "blade": Parametric(
        "flapping rotor blade",
        lambda gamma, mu, p=1.0: Point(_kept_blade(gamma, p), 1.0, mu),
        ("gamma", "mu", "p"),
        ("p",),
    ),
}
