"""Every region of instability of a window of the (Omega, eps) plane: outlines, names, widths.

>>> from floquet.regions import largest_width, trace_regions
>>> from periodic.examples import mathieu
>>> regions = trace_regions(mathieu(), (1.5, 2.5), (0.0, 0.4), progress=False)
>>> for region in regions:
...     print(region.label, f"{largest_width(region.outlines, 64):.2f}", region.contains([2.0, 2.4], 0.2))
2ω₁ 0.40 [ True False]

How the parts work together. A `window.Window` knows the family, the ranges and the amplitudes. A `scan.Scan` of it has
columns (`column`), which say at each Omega where in eps the system is unstable; `refinement` places more of them until
straight lines describe the edges, and `outlines` joins their intervals to closed polylines. What is narrower than the
distance between columns is expected at the resonances (`widths`). `tracking` tells the modes of a column apart,
`detuning` says by how much two of them miss a resonance, and `centrelines` where they miss it by nothing; there,
`tongues` measures the width. `segments` cuts tongues where they enter wide regions, `naming` finds the resonances that
wide regions start from, and `regions` puts all together.
"""

from floquet.regions.outlines import Loop, largest_width
from floquet.regions.regions import Region, Regions, trace_regions

__all__ = ["Loop", "Region", "Regions", "largest_width", "trace_regions"]
