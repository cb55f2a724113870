"""On an exact boundary neither answer is right, and next to one the error decides.

x'' + (-k^2/2 - k cos t + k^2/2 cos 2t) x = 0 has the solution x = exp(-k cos t), as inserting it shows; so mu = 1, and
by Liouville's theorem mu = 1 twice.
"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import Kind, monodromy
from periodic import PeriodicSystem
from periodic.examples import mathieu


def _on_the_boundary(k: float) -> PeriodicSystem:
    return PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[-(k**2) / 2]], [[[-k]], [[k**2 / 2]]])


@pytest.mark.parametrize("k", [k for k in np.linspace(-2.75, 2.75, 89) if k != 0])
def test_nothing_is_decided_on_a_boundary(k: float) -> None:
    found = monodromy(_on_the_boundary(k), 1.0, 1.0)
    assert found.kind == Kind.UNDECIDED
    np.testing.assert_allclose(found.multipliers, 1, atol=found.log_modulus_error + 1e-6)


def test_a_meeting_of_multipliers_within_the_error_is_not_called_unstable() -> None:
    # This point is proved stable in ball arithmetic; its two multipliers meet within the error of the matrix.
    assert monodromy(mathieu(), 1.7443588168468573, 0.5).kind == Kind.UNDECIDED
