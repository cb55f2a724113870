"""Whole areas of a stability chart, proved: for every point of a window a verdict, but for strips along the edges.

`prove_chart` cuts the window into patches of (1 / Omega, eps), encloses the monodromy matrix over each in a Taylor
model (`patches`, with the arithmetic of `models` and the equation of `coefficients`), and halves patches into cells
(`search`) until clusters of multipliers are proved apart (`isolation`) and polynomials (`signs`, put together in
`cells`) decide each of them. `ProvedChart` (`chart`) keeps the polynomials: their signs are the verdicts (`ranges`).
docs/certify.md has the proofs, in sections of the same order.

>>> from floquet.certified.areas import prove_chart
>>> from periodic.examples import mathieu
>>> chart = prove_chart(mathieu(), (1.5, 2.5), (0.0, 0.4), progress=False)
>>> chart.proved_fraction > 0.9999
True
>>> print(chart.verdict(Omega=2.0, eps=0.1), chart.verdict(Omega=1.7, eps=0.1))
unstable stable
>>> for strip in chart.edges(0.1):
...     print(f"{strip.below} {strip.lower:.6f} {strip.above}, thinner than 1e-8: {strip.thickness < 1e-8}")
stable 1.949698 unstable, thinner than 1e-8: True
unstable 2.049679 stable, thinner than 1e-8: True
"""

from floquet.certified.areas.chart import AreaVerdict, ProvedChart, Strip
from floquet.certified.areas.prove import prove_chart

__all__ = ["AreaVerdict", "ProvedChart", "Strip", "prove_chart"]
