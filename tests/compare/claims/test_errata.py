"""What docs/errata.md says of the paper and no other test holds."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from perturb import gyroscopic_modes
from plate import EdgeLoad, MovingPlate
from tests.paths import ROOT
from tests.perturb.paper_blocks import modal_blocks


def test_damped_shear_stress_follows_the_shear_strain() -> None:
    # Eq. (3c). Far below the in-plane resonances the factor 1 + i Omega c of eq. (1) is common to strains and loads
    # and drops out, however large Omega c is. With the printed nu in the damping term of N_xy it would not.
    plate = MovingPlate(inplane="dynamic", thickness_ratio=1e-5, damping=0.5, load=EdgeLoad.partial(0.5))
    damped, static = plate.stress(3.0, 1), replace(plate, inplane="static", damping=0.0).stress(3.0, 1)
    scale = np.abs(static.N_xx).max()
    assert np.abs(static.N_xy).max() > 0.1 * scale
    for name in ("N_xx", "N_yy", "N_xy"):
        np.testing.assert_allclose(getattr(damped, name), getattr(static, name), atol=1e-6 * scale)


def test_damping_matrix_of_the_modes_is_only_semidefinite() -> None:
    # Below eq. (24). C = P^T diag(K_oe, 0) P of eq. (17).
    plate = MovingPlate(axial_terms=2, lateral_terms=3, damping=1.0)
    system = plate.at(10.0)
    n = system.size
    modes = gyroscopic_modes(system)
    C = modal_blocks(system, modes).C.swapaxes(1, 2).reshape(2 * n, 2 * n)
    values = np.linalg.eigvalsh(C)
    np.testing.assert_allclose(values[:n], 0, atol=1e-12 * values[-1])
    assert (values[n:] > 0).all()
    assert (modes.decay > 0).all()


def test_every_test_that_the_errata_name_exists() -> None:
    named = set(re.findall(r"`(test_\w+)`", (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")))
    defined = {
        name
        for path in (ROOT / "tests").rglob("test_*.py")
        for name in re.findall(r"^def (test_\w+)", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert named
    assert named <= defined
