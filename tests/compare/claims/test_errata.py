"""What docs/errata.md says of the paper and no other test holds."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from perturb import gyroscopic_modes
from plate import EdgeLoad, MovingPlate
from plate.basis import kronecker, legendre_derivative, sine_derivative, sine_wavenumbers
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


def test_size_of_the_material_derivative_in_the_damping() -> None:
    # c (d/dt + V d/dx) in place of c d/dt adds c V B, B w = the bending forces of w_X, which is not symmetric. Mode n
    # then decays by omega^2 w^H K_oe w + omega V Im(w^H B w) in place of the first term alone, eq. (26a).
    plate = MovingPlate(inplane="static", axial_terms=10, lateral_terms=9)
    K, lateral, _ = plate.terms
    nu = plate.poisson_ratio
    S, D = sine_derivative(K, plate.aspect_ratio), legendre_derivative(lateral)
    alpha2, D2 = np.diag(sine_wavenumbers(K, plate.aspect_ratio) ** 2), D @ D
    B = (
        kronecker(alpha2 @ S @ alpha2, np.eye(lateral))  # (w_XXX, phi_XX)
        + kronecker(S, D2.T @ D2)  # (w_XYY, phi_YY)
        - nu * (kronecker(S @ alpha2, D2.T) + kronecker(alpha2 @ S, D2))  # nu (w_XXX, phi_YY), nu (w_XYY, phi_XX)
        + 2 * (1 - nu) * kronecker(S @ alpha2, D.T @ D)  # 2 (1 - nu) (w_XXY, phi_XY)
    )
    modes = gyroscopic_modes(plate.at(0.0))
    omega, w = modes.frequencies[:3], modes.vectors[:, :3]
    partial = modes.decay_coefficients(plate.elastic_stiffness)[:3]
    added = plate.speed * omega * np.einsum("in,ij,jn->n", w.conj(), B, w).imag
    np.testing.assert_allclose(added / partial, [0.667, 0.393, 0.145], atol=0.001)  # as docs/errata.md says
