"""Large systems in sparse matrices: the checks of dense ones, and sparse matrices wherever dense ones may be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from periodic import PeriodicSystem, SparseSystem, Term, waveforms

ONE = sp.eye_array(3, format="csr")
SKEW = sp.csr_array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def test_a_sparse_system_is_the_dense_one() -> None:
    terms = [Term("mass", 0.1 * ONE, waveforms.rectangular(), 2)]
    sparse = SparseSystem(ONE, SKEW, 0.1 * ONE, 2 * ONE, [ONE, SKEW], sine=3 * ONE, terms=terms)
    again = sparse.restricted(np.eye(3))
    dense = PeriodicSystem(ONE, SKEW, 0.1 * ONE, 2 * ONE, [ONE, SKEW], [3 * ONE, 0 * ONE], terms=terms)
    for a, b in zip(again.matrices([0.3, 4.0], 0.2), dense.matrices([0.3, 4.0], 0.2), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-15)
    assert sparse.size == 3
    assert "3 coordinates" in repr(sparse)


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"mass": np.eye(3)}, "mass is no sparse matrix"),
        ({"stiffness": None}, "stiffness is missing"),
        ({"stiffness": SKEW}, "stiffness is not symmetric"),
        ({"gyroscopic": ONE}, "gyroscopic is not skew-symmetric"),
        ({"damping": sp.eye_array(2)}, "damping has shape"),
        ({"mass": sp.csr_array([[1.0, 2.0]])}, "mass has shape"),
        ({"mass": ONE.astype(complex)}, "mass has entries of type complex"),
        ({"stiffness": np.inf * ONE}, "stiffness has an entry that is not finite"),
        ({"cosine": 3.0}, "cosine"),
        ({"cosine": [sp.eye_array(2)]}, "cosine.0. has shape"),
        ({"terms": [3]}, "terms.0. = 3 is no Term"),
        ({"terms": [Term("state", ONE)]}, "terms.0."),
        ({"terms": [Term("mass", np.eye(3))]}, "terms.0. is no sparse matrix"),
    ],
)
def test_bad_matrices(arguments: dict[str, Any], wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        SparseSystem(**{"mass": ONE, "stiffness": ONE} | arguments)
