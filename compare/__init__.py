"""Theory against integration: agreement in numbers, overlays in pictures.

`agreement` traces the two edges of every region by integration and compares them with the analytic curves, on a ladder
of amplitudes. `overlay` draws both; `plot` draws one thing, whatever it
is. `difference` is what changes from one chart to another. `save` writes any result to a file, `load` reads it.

>>> from compare import agreement
>>> from periodic.examples import mathieu
>>> (region,) = agreement(mathieu(), (1.5, 2.5), n_jobs=1)
>>> region.label, region.outcome.value, region.order.round(1).tolist()
('2ω₁', 'agrees', [2.0, 2.0])

`check_whole_model` follows a motion of a reduced model into the whole one.

An outcome is "agrees", "disagrees" or "not compared"; `Tally` counts each region once.

The rooms: `compare.study` (cases and users' systems, with a report), `compare.claims` (the paper's claims),
`compare.explorer` (pages to click in), `compare.pictures`, `compare.files` (what is read and written). `default_window`
suggests where to look.
"""

from compare.change import ChartDifference, difference
from compare.files import load, save
from compare.outcome import Basis, Outcome, RegionAgreement
from compare.pictures import animate, overlay, plot
from compare.tally import Tally
from compare.verdicts import agreement
from compare.whole_model import WholeModelCheck, check_whole_model
from compare.window import default_window

__all__ = [
    "Basis",
    "ChartDifference",
    "Outcome",
    "RegionAgreement",
    "Tally",
    "WholeModelCheck",
    "agreement",
    "animate",
    "check_whole_model",
    "default_window",
    "difference",
    "load",
    "overlay",
    "plot",
    "save",
]
