"""Terms of a matrix that depend on time, and the checks that all matrices of a system share."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, is_sparse, one_of, real_array, whole_number
from periodic.waveforms import Impulses, Piecewise, Trigonometric, Waveform, cosine

# By how much two entries that should agree by symmetry may differ, in parts of the largest entry. Assembling and
# transforming a matrix in float64 loses far less; an asymmetry that is meant is far larger.
SYMMETRY_TOLERANCE = 1e-10
# What a term can belong to, with the sign of its symmetry; 0: any real matrix.
SYMMETRY = {"mass": 1, "gyroscopic": -1, "damping": 1, "stiffness": 0, "state": 0}
# Power of eps that a term may have.
MAX_POWER = 16


@dataclass(frozen=True, eq=False)
class Term:
    """eps^power g(Omega t) X, a part of one of the matrices of a system.

    Parameters
    ----------
    of : str
        The matrix that it is added to: "mass", "gyroscopic", "damping" or "stiffness" of a `PeriodicSystem`, "state" of
        a `FirstOrderSystem`.
    matrix : array_like or sparse matrix, shape (n, n)
        X, kept sparse if it is; symmetric for mass and damping, skew-symmetric for gyroscopic, any real matrix for
        stiffness and state. What multiplies W' without symmetry is the sum of a damping and a gyroscopic term.
    waveform : Trigonometric, Piecewise or Impulses
        g, made by a function of `periodic.waveforms`. Pulses are not allowed in the mass.
    power : int
        Power of eps, at least 1.

    Raises
    ------
    ValueError
        If an argument is none of these.
    """

    of: str
    matrix: FloatArray
    waveform: Waveform
    power: int

    def __init__(self, of: str, matrix: ArrayLike, waveform: Waveform | None = None, power: int = 1) -> None:
        one_of("of", of, tuple(SYMMETRY))
        if is_sparse(matrix):
            X = sparse_matrix(f"the {of} term's matrix", matrix, None, SYMMETRY[of])
        else:
            X = square("matrix", real_array("matrix", matrix, 2), None)
            if SYMMETRY[of]:
                X = symmetric(f"the {of} term's matrix", X, SYMMETRY[of])
            X.setflags(write=False)
        g = cosine() if waveform is None else waveform
        if not isinstance(g, Trigonometric | Piecewise | Impulses):
            raise ValueError(f"waveform = {g!r} is no waveform; make one with a function of periodic.waveforms")
        if of == "mass" and isinstance(g, Impulses):
            raise ValueError("waveform of a mass term consists of impulses; a mass is finite, give another waveform")
        object.__setattr__(self, "of", of)
        object.__setattr__(self, "matrix", X)
        object.__setattr__(self, "waveform", g)
        object.__setattr__(self, "power", whole_number("power", power, least=1, most=MAX_POWER))


def checked_terms(terms: Iterable[Any], size: int, allowed: tuple[str, ...]) -> tuple[Term, ...]:
    """Return ``terms`` as a tuple, each of them a dense `Term` of one of the ``allowed`` matrices with ``size`` rows.

    Raises
    ------
    ValueError
        If one is not.
    """
    try:
        found = tuple(terms)
    except TypeError:
        raise ValueError(f"terms = {terms!r} is no sequence; give a list of Term") from None
    for i, term in enumerate(found):
        if not isinstance(term, Term):
            raise ValueError(f"terms[{i}] = {term!r} is no Term; make one with periodic.Term")
        if term.of not in allowed:
            raise ValueError(f"terms[{i}] is of {term.of!r}; here it can be of {', '.join(map(repr, allowed))}")
        if term.matrix.shape != (size, size):
            raise ValueError(f"terms[{i}] has a matrix of shape {term.matrix.shape}; give ({size}, {size})")
    return tuple(
        Term(t.of, real_array("matrix", t.matrix, 2), t.waveform, t.power) if is_sparse(t.matrix) else t for t in found
    )


def absorb(
    cosine: FloatArray | None, sine: FloatArray | None, terms: tuple[Term, ...], size: int, of: str
) -> tuple[FloatArray, FloatArray, tuple[Term, ...]]:
    """Return the short form (J, n, n) twice, with every harmonic of power 1 of the matrix ``of`` in it, and the terms
    that are left."""
    short = [term for term in terms if _is_short(term, of)]
    rest = [term for term in terms if not _is_short(term, of)]
    J = max([1, *(len(x) for x in (cosine, sine) if x is not None), *(_harmonics(term) for term in short)])
    arrays = []
    for given in (cosine, sine):
        array = np.zeros((J, size, size))
        if given is not None:
            array[: len(given)] = given
        arrays.append(array)
    for term in short:
        assert isinstance(term.waveform, Trigonometric)
        for j in range(1, term.waveform.harmonics + 1):
            arrays[0][j - 1] += term.waveform.cosines[j] * term.matrix
            arrays[1][j - 1] += term.waveform.sines[j] * term.matrix
        if term.waveform.cosines[0]:  # a mean that grows with eps is no harmonic
            rest.append(Term(of, term.waveform.cosines[0] * term.matrix, Trigonometric((1.0,), (0.0,))))
    return arrays[0], arrays[1], tuple(rest)


def sum_of(terms: Iterable[Term], of: str, theta: FloatArray, eps: float, size: int) -> FloatArray:
    """Return the sum of the terms of one matrix at the phases ``theta``, shape (*theta.shape, n, n), without pulses."""
    total = np.zeros((*theta.shape, size, size))
    for term in terms:
        if term.of == of and not isinstance(term.waveform, Impulses):
            total += np.multiply.outer(eps**term.power * term.waveform.values(theta), term.matrix)
    return total


def square(name: str, array: FloatArray, n: int | None) -> FloatArray:
    """Return ``array`` if its shape is (n, n); of any n if None.

    Raises
    ------
    ValueError
        If it is not.
    """
    rows = len(array) if n is None else n
    if rows == 0 or array.shape != (rows, rows):
        raise ValueError(f"{name} has shape {array.shape}; give a square matrix")
    return array


def sparse_matrix(name: str, value: Any, n: int | None, sign: int) -> Any:
    """Return a sparse matrix in compressed rows, exactly (skew-)symmetric for ``sign`` 1 and -1.

    Raises
    ------
    ValueError
        If it is not square with ``n`` rows, not real and finite, or its symmetry fails by more than rounding.
    """
    X = value.tocsr()
    rows = X.shape[0] if n is None else n
    if rows == 0 or X.shape != (rows, rows):
        raise ValueError(f"{name} has shape {tuple(X.shape)}; give a square matrix of {rows} rows")
    if X.dtype.kind not in "fiu":
        raise ValueError(f"{name} has entries of type {X.dtype}; give real numbers")
    X = X.astype(float)
    X.eliminate_zeros()
    if not np.isfinite(X.data).all():
        raise ValueError(f"{name} has an entry that is not finite; every entry must be finite")
    if sign and X.nnz:
        if abs(X - sign * X.T).max() > SYMMETRY_TOLERANCE * abs(X).max():
            raise ValueError(f"{name} is not {'symmetric' if sign > 0 else 'skew-symmetric'}")
        X = 0.5 * (X + sign * X.T)
    return X


def symmetric(name: str, array: FloatArray, sign: int) -> FloatArray:
    """Return the exactly (skew-)symmetric matrix next to ``array``; refuse what differs by more than rounding.

    Raises
    ------
    ValueError
        If it differs by more.
    """
    half = 0.5 * array  # halved first: no overflow at the largest numbers
    defect = float(np.abs(half - sign * half.T).max())
    if defect > SYMMETRY_TOLERANCE * np.abs(half).max():
        kind = "symmetric" if sign > 0 else "skew-symmetric"
        raise ValueError(f"{name} is not {kind} (largest defect {2.0 * defect:.3g}); give a {kind} matrix")
    return half + sign * half.T


def harmonics(name: str, value: ArrayLike, n: int) -> FloatArray:
    """Return the matrices of harmonics (J, n, n); one matrix (n, n) is that of the first.

    Raises
    ------
    ValueError
        If the shape is neither.
    """
    if isinstance(value, list | tuple) and any(map(is_sparse, value)):
        value = [real_array(f"{name}[{j}]", matrix, 2) for j, matrix in enumerate(value)]
    array = real_array(name, value, None)
    if array.ndim == 2:
        array = array[None]
    if array.ndim != 3 or array.shape[0] == 0 or array.shape[1:] != (n, n):
        raise ValueError(f"{name} has shape {array.shape}; give (J, {n}, {n}) with J >= 1 harmonics, or ({n}, {n})")
    return array


def _is_short(term: Term, of: str) -> bool:
    g = term.waveform
    return term.of == of and term.power == 1 and isinstance(g, Trigonometric) and g.harmonics > 0 and g.rest == 0


def _harmonics(term: Term) -> int:
    return term.waveform.harmonics if isinstance(term.waveform, Trigonometric) else 0
