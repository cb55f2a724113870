"""Proofs: of one point (Omega, eps), in ball arithmetic, and of a whole chart.

For a point, three modules follow docs/certify.md. `enclosure` encloses the monodromy matrix (sections 1 and 2),
`spectrum` its multipliers (section 3), and `growth` turns both into bounds of the growth rate and a verdict. The room
shares no code with the integrators that it is held against. It needs python-flint, the extra ``certify``.

>>> from floquet.certified import certified_growth
>>> from periodic.examples import mathieu
>>> found = certified_growth(mathieu(), Omega=2.0, eps=0.1)
>>> print(found.verdict)
unstable
>>> found.lower <= found.upper < found.lower * (1 + 1e-15)
True

What cannot be proved is undecided, with the reason:

>>> found = certified_growth(mathieu(0.0), Omega=1.0, eps=0.0)  # x'' = 0
>>> print(found.verdict)
undecided

A whole chart is proved in `floquet.certified.areas`:

>>> from floquet.certified import prove_chart
>>> prove_chart(mathieu(), (1.5, 2.5), (0.0, 0.4), progress=False).proved_fraction > 0.9999
True
"""

try:
    import flint  # noqa: F401
except ModuleNotFoundError:
    raise ImportError(
        "floquet.certified needs python-flint; install the extra certify: pip install 'floquet-charts[certify]'"
    ) from None

from floquet.certified.areas import AreaVerdict, ProvedChart, Strip, prove_chart
from floquet.certified.growth import (
    FIRST_BITS,
    MAX_BITS,
    CertifiedGrowth,
    ProvedVerdict,
    certified_growth,
    certified_monodromy,
)
from floquet.certified.reading import uncoupled_subsystems

__all__ = [
    "FIRST_BITS",
    "MAX_BITS",
    "AreaVerdict",
    "CertifiedGrowth",
    "ProvedChart",
    "ProvedVerdict",
    "Strip",
    "certified_growth",
    "certified_monodromy",
    "prove_chart",
    "uncoupled_subsystems",
]
