"""Any system in any window: pictures, data, a page to click in (in a file or live), and sweeps of a parameter.

`explore` integrates a window, traces its regions and lays the analytic curves over them. The `Exploration` writes its
files; `region_lines` says in text what was found.

>>> from compare.explorer import explore, region_lines
>>> from periodic.examples import mathieu
>>> found = explore(mathieu(), (1.5, 2.5), 0.2, points=(9, 5), title="Mathieu", n_jobs=1)
>>> [curve.label for curve in found.curves], found.chart.kind.shape
(['2ω₁'], (5, 9))
>>> print(*region_lines(found.regions, 0.2, "mathieu-regions.json"))
2ω₁  from Ω = 2, ε = 0, up to 0.2 wide

`sweep` follows the regions of a plate along one parameter, `sweep_picture` draws it, and `varied` is the plate with one
parameter changed. `explore_plane` takes any two parameters of any system; `point_maker` finds them by their names.
`compare.explorer.page` and `compare.explorer.live` need Bokeh, so that nothing here imports them.
"""

from compare.explorer.exploration import Exploration, explore
from compare.explorer.listing import region_lines
from compare.explorer.parameters import KNOWN_PLANES, Parametric, parametric_file, parametric_plate, point_maker
from compare.explorer.planes import PlaneExploration, explore_plane
from compare.explorer.responses import Response, clickable_responses, response
from compare.explorer.sweep_panels import sweep_picture
from compare.explorer.sweeps import RegionSweep, Sweep, sweep
from compare.explorer.variation import SWEEPABLE, plate_table, varied

__all__ = [
    "KNOWN_PLANES",
    "SWEEPABLE",
    "Exploration",
    "Parametric",
    "PlaneExploration",
    "RegionSweep",
    "Response",
    "Sweep",
    "clickable_responses",
    "explore",
    "explore_plane",
    "parametric_file",
    "parametric_plate",
    "plate_table",
    "point_maker",
    "region_lines",
    "response",
    "sweep",
    "sweep_picture",
    "varied",
]
