"""From a window to patches, and from each patch to cells of which something is proved."""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np

from floquet.certified.areas.cells import SIGN_RADIUS, Cell, Proof, proof_of
from floquet.certified.areas.coefficients import Coefficients
from floquet.certified.areas.patches import Patch, patch_of
from floquet.certified.areas.ranges import open_part

# Degree of the polynomials of a patch: of small systems, and from `MANY_STATES` states on.
DEGREE, DEGREE_OF_MANY, MANY_STATES = 12, 10, 8
# Largest radius of a patch.
PATCH_RADIUS, PATCH_RADIUS_OF_MANY = 1e-10, 1e-9
# Part of a patch that the polynomials of a cell may leave open; a hundredth of it with a radius above `SIGN_RADIUS`.
OPEN_PART = 3e-6
# At most so many times a rectangle is halved at once whose model has far too large a radius.
MAX_HALVINGS_AT_ONCE = 5


class Rectangle(NamedTuple):
    """low <= 1 / Omega <= high, bottom <= eps <= top."""

    low: float
    high: float
    bottom: float
    top: float

    def halves(self, along_xi: bool) -> tuple[Rectangle, Rectangle]:
        """Return both halves."""
        if along_xi:
            middle = (self.low + self.high) / 2
            return self._replace(high=middle), self._replace(low=middle)
        middle = (self.bottom + self.top) / 2
        return self._replace(top=middle), self._replace(bottom=middle)


class Leaf(NamedTuple):
    """A cell and what is proved of it; None: nothing."""

    cell: Cell
    proof: Proof | None


class ProvedPatch(NamedTuple):
    """A patch with its cells, which cover it."""

    patch: Patch
    leaves: list[Leaf]


class Found(NamedTuple):
    """Patches that are proved, and rectangles that were left."""

    patches: list[ProvedPatch]
    left: list[Rectangle]


def interval(low: float, high: float) -> tuple[float, float]:
    """Return middle and half-width, so that the interval is covered."""
    middle = (low + high) / 2
    half = max(high - middle, middle - low)
    return middle, math.nextafter(half * (1 + 2.0**-50), math.inf)


def search(equation: Coefficients, rectangle: Rectangle, least: tuple[float, float], deadline: float) -> Found:
    """Return what is proved of a rectangle.

    Parameters
    ----------
    equation : Coefficients
    rectangle : Rectangle
    least : (float, float)
        Width of a cell in Omega, height in eps below which it is not halved that way.
    deadline : float
        By `time.monotonic`; what is not done by then is left.
    """
    many = len(equation.A) >= MANY_STATES
    degree, tolerance = (DEGREE_OF_MANY, PATCH_RADIUS_OF_MANY) if many else (DEGREE, PATCH_RADIUS)
    found = Found([], [])
    waiting = [rectangle]
    while waiting:
        here = waiting.pop()
        if time.monotonic() > deadline:
            found.left.append(here)
            continue
        l0, h1 = interval(here.low, here.high)
        e0, h2 = interval(here.bottom, here.top)
        patch = patch_of(equation, l0, h1, e0, h2, degree, tolerance)
        radius = patch.model.radius
        if radius <= tolerance:
            found.patches.append(ProvedPatch(patch, _leaves(patch, equation, least, deadline)))
            continue
        if 2 * h1 / (l0 * l0) < least[0] and 2 * h2 < least[1]:
            found.left.append(here)
            continue
        excess = radius / tolerance if math.isfinite(radius) else math.inf
        halvings = (
            min(max(1, round(math.log2(excess) / (degree + 1))), MAX_HALVINGS_AT_ONCE) if excess < math.inf else 2
        )
        pieces = [here]
        # what each variable contributes to the change of the equation
        f = equation.norms.sum()
        wide, high = h1 * (equation.norm + abs(e0) * f), l0 * h2 * f
        if math.isfinite(radius):
            top = patch.model.coef[-degree - 1 :]
            wide, high = (float(np.linalg.norm(X)) ** (1 / degree) for X in (top[0], top[-1]))
        for _ in range(halvings):
            along_xi = wide >= high
            pieces = [half for piece in pieces for half in piece.halves(along_xi)]
            wide, high = (wide / 2, high) if along_xi else (wide, high / 2)
        waiting += pieces
    return found


def _leaves(patch: Patch, equation: Coefficients, least: tuple[float, float], deadline: float) -> list[Leaf]:
    """Return cells that cover a patch."""
    leaves: list[Leaf] = []
    waiting = [Cell(0.0, 1.0, 0.0, 1.0)]
    lowest = patch.l0 - patch.h1
    while waiting:
        cell = waiting.pop()
        if time.monotonic() > deadline:
            leaves.append(Leaf(cell, None))
            continue
        proof = proof_of(patch, cell, equation)
        wide = 2 * patch.h1 * cell.hx / (lowest * lowest) > least[0]
        high = 2 * patch.h2 * cell.hy > least[1]
        if _is_enough(cell, proof) or not (wide or high):
            leaves.append(Leaf(cell, proof if proof.whole or proof.signs else None))
        else:
            waiting += cell.halves(wide and (proof.along_xi or not high))
    return leaves


def _is_enough(cell: Cell, proof: Proof) -> bool:
    """Return whether a cell need not be halved."""
    if proof.is_stable or proof.is_unstable:
        return True
    if not proof.whole:
        return False
    parts = sum(open_part(sign.coef, sign.degree, sign.radius) for sign in proof.signs)
    return parts * cell.hx * cell.hy <= (OPEN_PART if proof.radius <= SIGN_RADIUS else OPEN_PART / 100)
