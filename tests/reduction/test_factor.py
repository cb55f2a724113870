"""Solutions and counts of eigenvalues by a symmetric factorisation."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from reduction.factor import Factor


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("hermitian", [False, True])
def test_solution_and_inertia(seed: int, hermitian: bool) -> None:
    rng = np.random.default_rng(seed)
    n = 60
    A = sp.random_array((n, n), density=0.1, rng=rng).toarray()
    A = A + A.T + np.diag(rng.standard_normal(n))
    if hermitian:
        B = sp.random_array((n, n), density=0.1, rng=rng).toarray()
        A = A + 1j * (B - B.T)
    factor = Factor(sp.csr_array(A))
    right = rng.standard_normal((n, 3))
    np.testing.assert_allclose(A @ factor.solve(right.astype(A.dtype)), right, atol=1e-9)
    assert factor.negative == (np.linalg.eigvalsh(A) < 0).sum()


def test_a_singular_matrix_is_refused() -> None:
    with pytest.raises(ArithmeticError, match="singular"):
        Factor(sp.csr_array([[1.0, 1.0], [1.0, 1.0]]))
    with pytest.raises(ArithmeticError):
        Factor(sp.csr_array([[0.0, 1.0], [1.0, 0.0]]))
