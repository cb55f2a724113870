"""First-order systems x' = A(t) x of any size."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, real_array
from periodic.terms import Term, absorb, checked_terms, harmonics, square, sum_of


@dataclass(frozen=True, eq=False)
class FirstOrderSystem:
    """x' = [A + eps sum_j (A_cj cos j Omega t + A_sj sin j Omega t) + sum eps^power g(Omega t) X] x.

    For what has no mass matrix: controllers, memory variables, x' = A(t) x of any size, odd too. Arrays are copied,
    checked and made read-only.

    Parameters
    ----------
    constant : array_like, shape (n, n)
        A, any real matrix.
    cosine, sine : array_like, shape (J, n, n) or (n, n), optional
        A_cj and A_sj for j = 1..J; zero if left out.
    terms : iterable of Term
        Further parts of "state".

    Attributes
    ----------
    size : int
        n, the number of states.
    terms : tuple of Term
        Those that are not harmonics of power 1; these have been added to ``cosine`` and ``sine``.

    Raises
    ------
    ValueError
        If a matrix has the wrong shape or type, an entry is not finite, or a term is of another matrix than "state".
    """

    constant: FloatArray
    cosine: FloatArray
    sine: FloatArray
    terms: tuple[Term, ...]

    def __init__(
        self,
        constant: ArrayLike,
        cosine: ArrayLike | None = None,
        sine: ArrayLike | None = None,
        *,
        terms: Iterable[Term] = (),
    ) -> None:
        A = real_array("constant", constant, 2)
        n = len(A)
        square("constant", A, n)
        given = [None if x is None else harmonics(name, x, n) for name, x in (("cosine", cosine), ("sine", sine))]
        Ac, As, rest = absorb(given[0], given[1], checked_terms(terms, n, ("state",)), n, "state")
        for name, array in {"constant": A, "cosine": Ac, "sine": As}.items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        object.__setattr__(self, "terms", rest)

    @property
    def size(self) -> int:
        """Number of states n."""
        return len(self.constant)

    def at(self, Omega: float) -> FirstOrderSystem:
        """Return the system itself: its matrices do not depend on the frequency (`SystemFamily`)."""
        return self

    def matrix(self, theta: ArrayLike, eps: float) -> FloatArray:
        """Return the coefficient matrix at the phases ``theta`` = Omega t, shape ``(*theta.shape, n, n)``, without
        pulses."""
        phases = np.asarray(theta, dtype=float)
        turned = np.multiply.outer(phases, np.arange(1, len(self.cosine) + 1))
        excitation = np.tensordot(np.cos(turned), self.cosine, 1) + np.tensordot(np.sin(turned), self.sine, 1)
        return np.asarray(self.constant + eps * excitation + sum_of(self.terms, "state", phases, eps, self.size))
