"""Structure that holds exactly: what puts multipliers on the unit circle (docs/certify.md, section 3).

Symmetries are read off the float64 numbers: they hold to the last bit or not at all. One sort of identity cannot hold
to the last bit, because it contains the frequency: C = M' and K - K^T = G'. A system that has it but for rounding is
replaced with the one that has it exactly, and what is said of it says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
from flint import fmpq, fmpz_mat

from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, excitation, waveforms
from periodic.checks import FloatArray
from periodic.structure import STRUCTURE_DEFECT

# States of a first-order system up to which a conserved form is looked for: exact elimination takes the sixth power.
MAX_EXACT_FORM_STATES = 8
# What rounding hides of a sum of products of float64 numbers, for each of them, as a part of the largest.
ROUNDING_OF_DEFECTS = 2.0**-51
# The matrices of a function of time, for each of the functions that it is a sum of.
Canonical = dict[tuple[Any, ...], FloatArray]


def hamiltonian_change(system: PeriodicSystem, Omega: float, eps: float) -> float | None:
    """Return a bound of how much C and K have to change for the system to be Hamiltonian; None if it is not.

    Hamiltonian: C = M', K - K^T = G', and pulses of the stiffness alone, with a skew part that is half the jump of G.
    The change is a part of the largest entries that are compared. It is zero for constant M and G: C = 0 and the
    symmetry of K must hold exactly. Otherwise it is above zero: whether a product with Omega is exact is not asked.
    """
    parts = list(excitation(system)) if eps else []
    if any(isinstance(g, waveforms.Impulses) and of != "stiffness" for of, g, _, _ in parts):
        return None
    if not any(of in ("mass", "gyroscopic") for of, _, _, _ in parts):
        damped = system.damping.any() or any(of == "damping" for of, _, _, _ in parts)
        stiffness = [system.stiffness, *(X for of, _, X, _ in parts if of == "stiffness")]
        return 0.0 if not damped and all(_is_symmetric(X) for X in stiffness) else None
    if any(_rest(g) for of, g, _, _ in parts if of != "stiffness"):
        return None
    M, G, C, K = (
        _canonical(getattr(system, of), ((g, eps**power * X) for name, g, X, power in parts if name == of))
        for of in ("mass", "gyroscopic", "damping", "stiffness")
    )
    skew = {key: X - X.T for key, X in K.items()}
    # a jump of G is a pulse of its derivative
    kicks = {key: skew.pop(key) for key in list(skew) if key[0] == "pulse"}
    pairs = [(C, _derivative(M, Omega)), (skew, _derivative(G, Omega)), (kicks, _jumps_of(G))]
    if not any(X.any() for pair in pairs for side in pair for X in side.values()):
        return 0.0
    scales = [C, K, G | kicks]
    found = max(_difference(*pair, scale) for pair, scale in zip(pairs, scales, strict=True))
    return found + (len(parts) + 2) * ROUNDING_OF_DEFECTS if found <= STRUCTURE_DEFECT else None


def is_reversible(system: PeriodicSystem, eps: float) -> bool:
    """Return whether, about one phase, M and K are exactly even in time and V = G + C is exactly odd."""
    if system.damping.any() or system.gyroscopic.any():
        return False  # a constant is not odd
    parts = list(excitation(system)) if eps else []
    if any(_rest(g) or (isinstance(g, waveforms.Impulses) and of != "stiffness") for of, g, _, _ in parts):
        return False
    jumps = next((sorted(map(Fraction, g.jumps)) for _, g, _, _ in parts if g.jumps), [])
    axes = {
        Fraction(0),
        Fraction(1, 4),
        *((jumps[0] + jump) / 2 + half for jump in jumps for half in (0, Fraction(1, 2))),
    }
    odd = ("gyroscopic", "damping")
    return any(all(_has_parity(g, axis, -1 if of in odd else 1) for of, g, _, _ in parts) for axis in axes)


def conserved_form(system: FirstOrderSystem, eps: float) -> tuple[list[list[fmpq]], int] | None:
    """Return a regular matrix J with J A(t) + A(t)^T J = 0 at all times and its sign, J^T = sign J; None without one.

    It is looked for in exact arithmetic, skew before symmetric.
    """
    N = system.size
    if N > MAX_EXACT_FORM_STATES:
        return None
    matrices = [system.constant, *(X for _, _, X, _ in excitation(system) if eps)]
    for sign in (-1, 1):
        places = [*combinations(range(N), 2), *((i, i) for i in range(N) if sign > 0)]
        equations = [row for A in matrices if A.any() for row in _conditions(_integers(A), places, sign)]
        if not places:
            continue
        kernel, rank = fmpz_mat(equations or [[0] * len(places)]).nullspace()
        free = [[int(kernel[i, j]) for i in range(len(places))] for j in range(rank)]
        form = [[0] * N for _ in range(N)]
        for weight, solution in enumerate(free, start=1):
            for (i, j), entry in zip(places, solution, strict=True):
                form[i][j] += weight * weight * entry
                if i != j:
                    form[j][i] += sign * weight * weight * entry
        if free and fmpz_mat(form).det() != 0:
            largest = max(abs(entry) for row in form for entry in row)
            return [[fmpq(entry, largest) for entry in row] for row in form], sign
    return None


def _conditions(A: list[list[int]], places: list[tuple[int, int]], sign: int) -> Iterator[list[int]]:
    """Yield the rows of J A + A^T J = 0 in the entries of J at ``places``."""
    N = len(A)
    index = {place: k for k, place in enumerate(places)}

    def entry(i: int, j: int) -> tuple[int, int]:
        return (index.get((i, j), -1), 1) if (i, j) in index else (index.get((j, i), -1), sign)

    for a in range(N):
        for b in range(N):
            row = [0] * len(places)
            for k in range(N):
                for where, factor, coefficient in ((*entry(a, k), A[k][b]), (*entry(k, b), A[k][a])):
                    if where >= 0:
                        row[where] += factor * coefficient
            if any(row):
                yield row


def _integers(A: FloatArray) -> list[list[int]]:
    """Return a multiple of the matrix, of whole numbers."""
    exact = [[Fraction(x) for x in row] for row in A.tolist()]
    common = math.lcm(*(x.denominator for row in exact for x in row))
    return [[int(x * common) for x in row] for row in exact]


def _is_symmetric(X: FloatArray) -> bool:
    return bool(np.array_equal(X, X.T))


def _rest(g: waveforms.Waveform) -> float:
    return 0.0 if isinstance(g, waveforms.Impulses) else g.rest


def _canonical(constant: FloatArray, parts: Iterable[tuple[waveforms.Waveform, FloatArray]]) -> Canonical:
    """Return the matrices of 1, cos j theta, sin j theta, powers of x in each piece, and pulses."""
    found: Canonical = {("cos", 0): constant}

    def add(key: tuple[Any, ...], X: FloatArray) -> None:
        found[key] = found.get(key, 0.0) + X

    for g, X in parts:
        if isinstance(g, waveforms.Trigonometric):
            for j, (c, s) in enumerate(zip(g.cosines, g.sines, strict=True)):
                add(("cos", j), c * X)
                add(("sin", j), s * X)
        elif isinstance(g, waveforms.Piecewise):
            for i, piece in enumerate(g.pieces):
                for k, c in enumerate(piece):
                    add(("piece", g.jumps, g.lengths[i], i, k), c * X)
        else:
            for phase, weight in zip(g.phases, g.weights, strict=True):
                add(("pulse", phase), weight * X)
    return found


def _derivative(parts: Canonical, Omega: float) -> Canonical:
    found: Canonical = {}
    for key, X in parts.items():
        if key[0] == "cos":
            found["sin", key[1]] = found.get(("sin", key[1]), 0.0) - key[1] * Omega * X
        elif key[0] == "sin":
            found["cos", key[1]] = found.get(("cos", key[1]), 0.0) + key[1] * Omega * X
        elif key[-1]:
            *piece, k = key
            found[(*piece, k - 1)] = k * Omega / (math.pi * key[2]) * X
    return found


def _jumps_of(parts: Canonical) -> Canonical:
    """Return by how much the pieces jump, at each of the phases."""
    found: Canonical = {}
    for key, X in parts.items():
        if key[0] == "piece":
            _, jumps, _, i, k = key
            following = jumps[(i + 1) % len(jumps)]
            found["pulse", jumps[i]] = found.get(("pulse", jumps[i]), 0.0) + (-1) ** k * X
            found["pulse", following] = found.get(("pulse", following), 0.0) - X
    return found


def _difference(one: Canonical, other: Canonical, scale: Canonical) -> float:
    """Return the largest difference, as a part of the largest entry."""
    largest = max((float(np.abs(X).max()) for X in (*scale.values(), *other.values())), default=0.0)
    zero = np.zeros(1)
    defects = [float(np.abs(one.get(key, zero) - other.get(key, zero)).max()) for key in {*one, *other}]
    return max(defects, default=0.0) / largest if largest else 0.0


def _has_parity(g: waveforms.Waveform, axis: Fraction, parity: int) -> bool:
    """Return whether g is exactly even (1) or odd (-1) about the phase ``axis``."""
    if isinstance(g, waveforms.Trigonometric):
        for j, (c, s) in enumerate(zip(g.cosines, g.sines, strict=True)):
            quarters = 4 * j * axis
            if not (c or s):
                continue
            if quarters.denominator > 1:
                return False
            # about the axis, cos and sin turn into +- each other by quarter turns
            is_cosine = (c != 0) == (quarters.numerator % 2 == 0)
            if (c and s) or is_cosine != (parity > 0):
                return False
        return True
    if isinstance(g, waveforms.Impulses):
        pulses = {Fraction(phase): weight for phase, weight in zip(g.phases, g.weights, strict=True)}
        return all(pulses.get((2 * axis - phase) % 1) == parity * weight for phase, weight in pulses.items())
    starts = [Fraction(jump) for jump in g.jumps]
    pieces = {
        (start, end % 1): _stripped(piece)
        for start, end, piece in zip(starts, [*starts[1:], starts[0] + 1], g.pieces, strict=True)
    }
    mirrored = {
        ((2 * axis - end) % 1, (2 * axis - start) % 1): [parity * (-1) ** k * c for k, c in enumerate(piece)]
        for (start, end), piece in pieces.items()
    }
    return mirrored == pieces


def _stripped(piece: tuple[float, ...]) -> list[float]:
    last = max((k for k, c in enumerate(piece) if c), default=0)
    return list(piece[: last + 1])


def coupling(system: AnySystem, eps: float) -> list[FloatArray]:
    """Return the matrices whose zeros tell which coordinates are coupled."""
    constant = (
        [system.constant]
        if isinstance(system, FirstOrderSystem)
        else [system.mass, system.gyroscopic, system.damping, system.stiffness]
    )
    return [*constant, *(X for _, _, X, _ in excitation(system) if eps)]
