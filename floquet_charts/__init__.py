"""Stability charts of periodically excited systems, by theory and by integration: everything under one name.

>>> import floquet_charts as fc
>>> system = fc.examples.mathieu(damping=0.1)
>>> chart = fc.stability_chart(system, (1.5, 2.5), (0.0, 0.5), progress=False)
>>> fc.monodromy(system, Omega=2.0, eps=0.5).kind.name
'MINUS_ONE'
>>> (region,) = fc.trace_regions(system, (1.5, 2.5), (0.0, 0.5), progress=False)
>>> print(f"{region.label} opens at eps = {region.tip[1]:.3f}")
2ω₁ opens at eps = 0.200
>>> (curve,) = fc.transition_curves(system, (1.5, 2.5))
>>> print(f"theory: at eps = {curve.tip:.3f}")
theory: at eps = 0.200
>>> picture = fc.overlay(chart, [curve], [region])

This package hands on what the rooms offer and defines nothing: systems (`periodic`), models (`plate`, `beam`), theory
(`perturb`, `perturb.general`), integration (`floquet`, `floquet.modes`) and comparison (`compare`, with `load_system`
and `save_system` of `compare.files`). A room is imported when the first name of it is asked for. Proofs are in
`floquet.certified`, which needs python-flint.

The command ``floquet-charts`` does from a shell what needs no Python; ``floquet-charts --help`` lists it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # for editors and type checkers; at run time `__getattr__` finds the names
    from beam import *
    from compare import *
    from compare.files import load_system as load_system
    from compare.files import save_system as save_system
    from floquet import *
    from floquet.modes import *
    from periodic import *
    from periodic import examples as examples
    from perturb import *
    from perturb.general import *
    from plate import *
    from reduction import *

__version__ = "0.1.0"

# Where names are looked for, those first that are imported soonest. A room without a list hands on all it offers.
_ROOMS: dict[str, tuple[str, ...]] = {
    "periodic": (),
    "plate": (),
    "beam": (),
    "reduction": (),
    "perturb": (),
    "perturb.general": (),
    "floquet": (),
    "floquet.modes": (),
    "compare": (),
    "compare.files": ("load_system", "save_system"),
}
_MODULES = {"examples": "periodic.examples"}


def __getattr__(name: str) -> Any:
    if name == "__all__":
        names = {one for room, some in _ROOMS.items() for one in some or import_module(room).__all__}
        return sorted(names | set(_MODULES) | {"__version__"})
    if not name.startswith("_"):
        if name in _MODULES:
            return import_module(_MODULES[name])
        for room, some in _ROOMS.items():
            if name in (some or import_module(room).__all__):
                return getattr(import_module(room), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name, obj=import_module(__name__))


def __dir__() -> list[str]:
    return sorted({*globals(), *__getattr__("__all__")})
