"""Large systems: the matrices of a finite-element model, kept sparse."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from periodic import waveforms
from periodic.checks import FloatArray, is_sparse
from periodic.system import PeriodicSystem
from periodic.terms import SYMMETRY, Term, sparse_matrix
from periodic.waveforms import Waveform

# The constant matrices, in the order of the arguments, with the signs of their symmetry. That of the stiffness is asked
# for here: modes of a large system are found by a symmetric factorisation.
CONSTANT_SYMMETRY = {"mass": 1, "gyroscopic": -1, "damping": 1, "stiffness": 1}


@dataclass(frozen=True, eq=False)
class SparseSystem:
    """A `PeriodicSystem` of many coordinates; `reduction.reduce_model` makes a small one of its lowest modes.

    Parameters
    ----------
    mass, gyroscopic, damping, stiffness : sparse matrix of SciPy, shape (n, n)
        M, C and K symmetric, G skew-symmetric. All but M and K may be left out: they are zero then.
    cosine, sine : sparse matrix, or a list of J of them, optional
        F_c1, ..., F_cJ and F_s1, ..., F_sJ.
    terms : iterable of Term
        Further parts of the matrices, with sparse matrices.

    Attributes
    ----------
    mass, gyroscopic, damping, stiffness : sparse matrix in compressed rows
    terms : tuple of Term
        All that depends on time, ``cosine`` and ``sine`` included.

    Raises
    ------
    ValueError
        If a matrix is not sparse, has the wrong shape, type or symmetry, or an entry is not finite.
    """

    mass: Any
    gyroscopic: Any
    damping: Any
    stiffness: Any
    terms: tuple[Term, ...]

    def __init__(
        self,
        mass: Any,
        gyroscopic: Any = None,
        damping: Any = None,
        stiffness: Any = None,
        cosine: Any = None,
        sine: Any = None,
        *,
        terms: Iterable[Term] = (),
    ) -> None:
        given = {"mass": mass, "gyroscopic": gyroscopic, "damping": damping, "stiffness": stiffness}
        n = None
        for name, value in given.items():
            if value is None and name in ("mass", "stiffness"):
                raise ValueError(f"{name} is missing; give a sparse matrix")
            matrix = type(self.mass)((n, n)) if value is None else _sparse(name, value, n, CONSTANT_SYMMETRY[name])
            object.__setattr__(self, name, matrix)
            n = self.size
        found = [*_harmonics("cosine", cosine, n, waveforms.cosine), *_harmonics("sine", sine, n, waveforms.sine)]
        for i, term in enumerate(terms):
            if not isinstance(term, Term) or term.of not in CONSTANT_SYMMETRY:
                raise ValueError(f"terms[{i}] = {term!r} is no Term of a second-order system; give one")
            _sparse(f"terms[{i}]", term.matrix, n, 0)
            found.append(term)
        object.__setattr__(self, "terms", tuple(found))

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return int(self.mass.shape[0])

    def at(self, Omega: float) -> Any:
        """Refuse: so large a system is not integrated as it is.

        Raises
        ------
        ValueError
            Always; the message says what to do.
        """
        raise ValueError(
            f"system = {self!r} is too large to be integrated as it is; reduce it to its lowest modes with "
            "reduction.reduce_model"
        )

    def restricted(self, basis: FloatArray) -> PeriodicSystem:
        """Return the dense system of the motions W = basis @ q, ``basis`` of shape (n, m)."""

        def inside(X: Any, sign: int) -> FloatArray:
            found = np.asarray(basis.T @ (X @ basis))
            return np.asarray((found + sign * found.T) / 2 if sign else found)

        constant = [inside(getattr(self, of), sign) for of, sign in CONSTANT_SYMMETRY.items()]
        terms = [Term(t.of, inside(t.matrix, SYMMETRY[t.of]), t.waveform, t.power) for t in self.terms]
        return PeriodicSystem(*constant, terms=terms)

    def __repr__(self) -> str:
        return f"SparseSystem({self.size} coordinates, {self.stiffness.nnz} entries in the stiffness)"


def _harmonics(name: str, value: Any, n: int | None, wave: Callable[[int], Waveform]) -> list[Term]:
    """Return the terms of the stiffness that a list of harmonics makes."""
    if value is None:
        return []
    matrices = [value] if is_sparse(value) or not isinstance(value, list | tuple) else value
    return [
        Term("stiffness", _sparse(f"{name}[{j - 1}]", matrix, n, 0), wave(j))
        for j, matrix in enumerate(matrices, start=1)
        if matrix is not None
    ]


def _sparse(name: str, value: Any, n: int | None, sign: int) -> Any:
    """Return a checked sparse matrix.

    Raises
    ------
    ValueError
        If it is none.
    """
    if not is_sparse(value):
        raise ValueError(f"{name} is no sparse matrix; give one of scipy.sparse, or make a periodic.PeriodicSystem")
    return sparse_matrix(name, value, n, sign)
