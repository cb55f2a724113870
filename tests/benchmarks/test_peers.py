"""The peers find the multipliers, each by its own method."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from benchmarks import PEERS, Peer, plate
from benchmarks.peers import Equations, mixed_equations, modal_equations, rk4
from floquet import monodromy


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_peer_finds_the_multipliers(peer: Peer) -> None:
    """At a fine setting every method gives the trace and the largest modulus that `monodromy` gives."""
    if peer.missing:
        pytest.skip(peer.missing)
    family = plate(12, 0.0)
    fine = 4096.0 if peer.package == "numba" else 1e-10
    matrix = peer.prepare(modal_equations(family.at(36.0)), fine)(36.0, 0.9)
    expected = monodromy(family, 36.0, 0.9).multipliers
    found = np.linalg.eigvals(matrix)
    assert abs(found.sum() - expected.sum()) < 1e-7
    assert abs(np.abs(found).max() - np.abs(expected).max()) < 1e-7


def test_runge_kutta_has_order_four() -> None:
    """Without excitation the matrix is exp(A T)."""
    equations = Equations(
        np.array([[0.1, 1.0], [-1.0, 0.2]]), np.diag([1.0, 3.0]), np.zeros((1, 2, 2)), np.zeros((1, 2, 2))
    )
    zero, one = np.zeros((2, 2)), np.eye(2)
    A = np.block([[zero, one], [-equations.stiffness, -equations.velocity]])
    exact = scipy.linalg.expm(A * 2 * np.pi / 3.0)
    errors = [np.linalg.norm(rk4(*equations, 3.0, 0.5, steps) - exact) for steps in (64, 128)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


def test_mixed_equations_are_the_same_system_without_zeros() -> None:
    modal = modal_equations(plate(12, 0.0).at(36.0))
    mixed = mixed_equations(modal)
    assert (modal.velocity == 0).mean() > 0.5
    beside = ~np.eye(12, dtype=bool)  # the diagonal of gyroscopic forces is zero in any coordinates
    for matrix in (mixed.velocity, mixed.stiffness, mixed.cosine[0]):
        assert (matrix[beside] != 0).all()
    one, other = (np.trace(rk4(*equations, 36.0, 0.9, 2048)) for equations in (modal, mixed))
    assert other == pytest.approx(one, abs=1e-9)
