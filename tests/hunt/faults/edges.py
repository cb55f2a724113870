"""Deliberate faults in `floquet/`: boundary and regions."""

from tests.hunt.fault import Fault

FAULTS = (
    Fault(
        "tongues as steep as if of first order",
        "floquet/regions/tongues.py",
        "self.slope = -expected.resonance.j * np.pi * expected.balance",
        "self.slope = -np.pi * expected.balance",
        "floquet/regions/test_tongues.py",
    ),
    Fault(
        "narrow regions go on within wide ones",
        "floquet/regions/segments.py",
        "met & (owner < 0)",
        "met",
        "floquet/regions/test_segments.py",
    ),
    Fault(
        "regions joined across a steep gap",
        "floquet/regions/outlines.py",
        "return [pair for pair in found if not is_across(*pair)]",
        "return found",
        "floquet/regions/test_outlines.py",
    ),
    Fault(
        "stable gaps between two amplitudes bridged",
        "floquet/regions/column.py",
        "wanted.append(float(eps[c] + eps[c + 1]) / 2)",
        "pass",
        "floquet/regions/test_regions_of_crowds.py",
    ),
    Fault(
        "bent edges taken from three amplitudes far apart",
        "floquet/regions/column.py",
        "if uncertainty > grid.resolution and",
        "if uncertainty > 1e9 and",
        "floquet/regions/test_column.py",
    ),
    Fault(
        "rounding taken for damping",
        "floquet/regions/widths.py",
        "slightest = -MIN_DECAY * subsystem.rate",
        "slightest = 0.0",
        "floquet/regions/test_widths.py",
    ),
    Fault(
        "instability with a third mode taken for that of two",
        "floquet/regions/detuning.py",
        "shift > MAX_MEAN_CHANGE * gain",
        "shift > 1e9",
        "floquet/regions/test_detuning.py",
    ),
    Fault(
        "lower edge above the upper",
        "floquet/boundary/region.py",
        "walk.edge(point, -1), walk.edge(point, 1)",
        "walk.edge(point, 1), walk.edge(point, -1)",
        "floquet/boundary/test_trace.py",
    ),
    Fault(
        "a narrow gap between two regions stepped over",
        "floquet/boundary/walk.py",
        "b.own > 0 and b.kind == a.kind and b.likeness >= MIN_STEP_LIKENESS",
        "b.value > 0",
        "floquet/boundary/test_neighbours.py",
    ),
    Fault(
        "coincident resonances of other subsystems forgotten",
        "floquet/boundary/companions.py",
        "if subsystem[name.p - 1] != own]",
        "if False]",
        "floquet/boundary/test_neighbours.py",
    ),
    Fault(
        "a window of stability taken for a region",
        "floquet/boundary/region.py",
        "return bool(exponents.real.max() > FREE_GROWTH_ROUNDING",
        "return bool(exponents.real.max() > 1e9",
        "floquet/boundary/test_closed.py",
    ),
    Fault(
        "sum resonances sought as differences",
        "floquet/boundary/resonance.py",
        "second.conj() if resonance",
        "second if resonance",
        "floquet/boundary/test_trace.py",
    ),
    Fault(
        "even tongues of the kind of odd ones",
        "floquet/boundary/resonance.py",
        "if self.j % 2 == 0",
        "if self.j % 2 == 1",
        "floquet/regions/test_regions.py",
    ),
)
