"""Sparse symmetric matrices, factorised once: solutions, and how many eigenvalues are negative."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

# A pivot below this part of the largest entry of its column makes the factorisation worthless.
MIN_PIVOT = 1e-14


class Factor:
    """L D L^H = A of a sparse real symmetric or complex Hermitian matrix, without exchanges that would lose symmetry.

    Parameters
    ----------
    matrix : sparse matrix, shape (n, n)

    Attributes
    ----------
    negative : int
        Number of negative eigenvalues of A (Sylvester's law of inertia).

    Raises
    ------
    ArithmeticError
        If A is singular to working precision.
    """

    def __init__(self, matrix: Any) -> None:
        columns = sp.csc_matrix(matrix)
        try:
            self._lu = spla.splu(
                columns, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError:  # a pivot is exactly zero
            raise ArithmeticError("the matrix is singular") from None
        pivots = self._lu.U.diagonal().real
        scale = float(abs(columns).max())
        if not np.isfinite(pivots).all() or (np.abs(pivots) < MIN_PIVOT * scale).any():
            raise ArithmeticError("the matrix is singular")
        if (self._lu.perm_r != self._lu.perm_c).any():  # an exchange of rows alone: the pivots say nothing any more
            raise ArithmeticError("the matrix has a pivot that is zero")
        self.negative = int((pivots < 0).sum())

    def solve(self, right: NDArray[Any]) -> NDArray[Any]:
        """Return A^-1 ``right``, shape (n,) or (n, k)."""
        return np.asarray(self._lu.solve(np.ascontiguousarray(right)))
