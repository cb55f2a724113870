"""Regions of families whose matrices depend on Omega."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import monodromy, trace_regions
from periodic import PeriodicSystem
from plate import MovingPlate

# At rest it falls into four independent parts; what the load does to each changes with Omega, in-plane inertia being
# large.
THICK = MovingPlate(inplane="dynamic", thickness_ratio=0.05, axial_terms=3, lateral_terms=4, speed=0.0)


@pytest.mark.filterwarnings("ignore:harmonic 1 of the excitation comes near:plate.InPlaneResonanceWarning")
@pytest.mark.parametrize(
    ("window", "top", "labels"),
    [
        ((146.0, 149.0), 0.3, {"(ω₈+ω₁₂)/2"}),
        ((130.0, 150.0), 1.0, {"2ω₁₁/2", "(ω₈+ω₁₂)/2", "(ω₉+ω₁₂)/2"}),
        ((170.0, 200.0), 0.3, {"2ω₇", "ω₅+ω₁₁"}),
    ],
)
def test_parts_are_followed_though_their_excitation_changes(
    window: tuple[float, float], top: float, labels: set[str]
) -> None:
    regions = {region.label: region for region in trace_regions(THICK, window, (0.0, top), progress=False)}
    assert labels <= regions.keys()
    for label in labels:
        assert regions[label].tip[1] == pytest.approx(0.0, abs=1e-3)
        assert monodromy(THICK, *regions[label].witness).kind > 0


class Switched:
    """Three oscillators, the first of which is excited by the third above Omega = 3 only."""

    def at(self, Omega: float) -> PeriodicSystem:
        F = np.array([[1.0, 0.2, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]])
        F[0, 2] = F[2, 0] = 0.5 * (Omega > 3.0)
        zero = np.zeros((3, 3))
        return PeriodicSystem(np.eye(3), zero, zero, np.diag([1.0, 4.0, 7.0]), [F])


def test_parts_that_change_with_Omega_are_refused() -> None:
    with pytest.raises(ValueError, match=r"at Omega = .* other independent subsystems .* apart"):
        trace_regions(Switched(), (1.0, 6.0), (0.0, 0.5), progress=False)
    below = trace_regions(Switched(), (1.5, 2.9), (0.0, 0.1), progress=False)
    above = trace_regions(Switched(), (3.4, 6.0), (0.0, 0.1), progress=False)
    assert "2ω₁" in [region.label for region in below]
    assert "ω₁+ω₃" in [region.label for region in above]
