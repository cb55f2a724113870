"""All multipliers of a subsystem at the amplitudes of a column, and how far two computations of them differ."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from floquet.engine.eigen import eigenvalues, reciprocal_pairs, reciprocal_sums
from floquet.engine.parts import AnySampler
from floquet.engine.stability import DominantMultiplier, discrepancy, dominant_multiplier, dominant_of_sums
from periodic.checks import ComplexArray, FloatArray

# Largest power of two between the scales of two computations; with more the smaller one would leave the range of
# floats.
MAX_SCALE_SHIFT = 1000


class Multipliers(NamedTuple):
    """The multipliers 2^exponents[c] mu[c, i] of k cells of a subsystem.

    Attributes
    ----------
    mu : complex ndarray, shape (k, N)
    exponents : ndarray, shape (k,)
    losses : ndarray, shape (k,)
        Factor by which cancellation has magnified rounding errors; infinite where an eigenvalue did not converge.
    norms : ndarray, shape (k,)
        Norms of the monodromy matrices at the scale of ``mu``; 1 for a rotation.
    """

    mu: ComplexArray
    exponents: FloatArray
    losses: FloatArray
    norms: FloatArray


class ReciprocalSums(NamedTuple):
    """The sums mu + 1/mu = 2^exponents[c] sums[c, i] of k cells of a symplectic subsystem; ``sums`` is (k, n).

    The other attributes are those of `Multipliers`, with norms at the scale of ``sums``.
    """

    sums: ComplexArray
    exponents: FloatArray
    losses: FloatArray
    norms: FloatArray


Spectra = Multipliers | ReciprocalSums


def spectra(sampler: AnySampler, eps: FloatArray, L: int, tolerance: float) -> Spectra:
    """Return all multipliers at the amplitudes ``eps``, from 2^L steps a period: their sums if they come in pairs."""
    kind, solve = (ReciprocalSums, reciprocal_sums) if sampler.subsystem.symplectic else (Multipliers, eigenvalues)
    parts: list[tuple[Any, ...]] = []
    for piece in sampler.pieces(eps, L, tolerance):
        values = solve(piece.samples, piece.weights)[: piece.norms.size]
        lose_unfinished(values, piece.scale.losses)
        parts.append((values, *piece.scale, piece.norms))
    return kind(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def select(found: Spectra, cells: list[int]) -> Spectra:
    """Return the multipliers of some cells."""
    return found._replace(**{name: part[cells] for name, part in found._asdict().items()})


def dominant(found: Spectra, reversible: bool) -> DominantMultiplier:
    """Return the dominant multiplier of every cell; ``reversible`` is that of the `Subsystem`."""
    if isinstance(found, ReciprocalSums):
        return dominant_of_sums(found.sums, found.exponents, found.norms)
    return dominant_multiplier(found.mu, found.exponents, found.norms, reversible)


def discrepancies(found: Spectra, finer: Spectra) -> FloatArray:
    """Return E (k,), as in `floquet.engine.stability`, from two computations of the multipliers of the same cells.

    It is infinite where an eigenvalue did not converge.
    """
    shift = np.clip(finer.exponents - found.exponents, -MAX_SCALE_SHIFT, MAX_SCALE_SHIFT)
    one, other = found[0], finer[0] * 2.0 ** shift[:, None]
    if isinstance(found, ReciprocalSums) and not found.exponents.any():  # beyond that mu + 1/mu is mu
        one, other = reciprocal_pairs(one), reciprocal_pairs(other)
    return np.where(np.isfinite(found.losses + finer.losses), discrepancy(one, other), np.inf)


@njit(cache=True, nogil=True)
def lose_unfinished(values: ComplexArray, losses: FloatArray) -> None:
    """Make ``losses`` infinite where an eigenvalue did not converge."""
    for c in range(len(values)):
        for i in range(values.shape[1]):
            if not (np.isfinite(values[c, i].real) and np.isfinite(values[c, i].imag)):
                losses[c] = np.inf
