"""What structure a system has: multipliers come in reciprocal pairs only where it is there.

A second-order system M W'' + V W' + K W = 0, with all matrices depending on time, is Hamiltonian if its symmetric
damping is M' and the skew part of its stiffness is half the derivative of the skew part of V: it then follows from the
Lagrangian W'^T M W' / 2 + W'^T B W - W^T P W / 2 with V = M' + 2 B, K = P + B', B skew, and conserves dW ^ dp with
p = M W' + B W. It is reversible if, seen from some instant on, M and K are even in time and V is odd. A first-order
system is Hamiltonian if a constant, regular, skew matrix J has J A(t) + A(t)^T J = 0 at all times.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from periodic import waveforms
from periodic.checks import FloatArray
from periodic.first_order import FirstOrderSystem
from periodic.system import PeriodicSystem
from periodic.terms import Term

# Defect of a symmetry that counts as rounding, as a part of the largest entries that it compares.
STRUCTURE_DEFECT = 1e-13
# Phases looked at in each period of the fastest harmonic, or in each segment between jumps.
PHASES_PER_HARMONIC, PHASES_PER_SEGMENT = 8, 5
# States of a first-order system up to which a conserved form is looked for: the search takes the sixth power.
MAX_FORM_STATES = 12
# Condition number above which a skew form counts as singular.
MAX_FORM_CONDITION = 1e6
# Axes of reflection in time that are tried.
MAX_AXES = 64


def conserved_form(system: PeriodicSystem, Omega: float, eps: float) -> FloatArray | None:
    """Return the skew form (2n, 2n) in (W', W) just after t = 0 that a Hamiltonian system conserves; None if it is
    not Hamiltonian."""
    pulses = [term for term in system.terms if isinstance(term.waveform, waveforms.Impulses)]
    if any(term.of != "stiffness" for term in pulses):
        return None
    phases = _phases(system)
    M, G, C, K = system.matrices(phases, eps)
    dM, dG = (Omega * _derivative(system, of, phases, eps) for of in ("mass", "gyroscopic"))
    if not (_same(C, dM, C, dM, G) and _same(K - K.swapaxes(1, 2), dG, K, dG)):
        return None
    insides = _insides(system)
    sides = zip(insides, [*insides[1:], insides[0]], _jumps(system)[1:], strict=True)
    for before, after, jump in sides:
        here, there = _one_sided(system, jump, before, eps), _one_sided(system, jump % 1.0, after, eps)
        kick = np.zeros_like(system.mass)
        for term in pulses:
            for phase, weight in zip(term.waveform.phases, term.waveform.weights, strict=True):  # type: ignore[union-attr]
                kick += (phase == jump % 1.0) * weight * eps**term.power * term.matrix
        if not _same(kick - kick.T, there[1] - here[1], kick, here[1]):
            return None
    M, G = _one_sided(system, 0.0, insides[0], eps)
    return np.block([[np.zeros_like(M), -M], [M, G]])


def is_reversible(system: PeriodicSystem, eps: float) -> bool:
    """Return whether, seen from some instant on, M and K are even in time and V is odd."""
    pulses = [term for term in system.terms if isinstance(term.waveform, waveforms.Impulses)]
    if any(term.of != "stiffness" for term in pulses) or system.damping.any() or system.gyroscopic.any():
        return False  # a constant is not odd
    phases = _phases(system)
    for axis in _axes(system):
        ahead, back = (system.matrices(2 * np.pi * axis + sign * phases, eps) for sign in (1, -1))
        pairs = zip(ahead, back, (1, -1, -1, 1), strict=True)
        if all(_same(x, sign * y, x) for x, y, sign in pairs) and all(_mirrored(term, axis) for term in pulses):
            return True
    return False


def skew_form(system: FirstOrderSystem, eps: float) -> FloatArray | None:
    """Return a regular skew matrix J with J A(t) + A(t)^T J = 0 at all times, if there is one and the system small."""
    N = system.size
    if N > MAX_FORM_STATES or N % 2:
        return None
    matrices = [system.constant, *system.cosine, *system.sine, *(term.matrix for term in system.terms)]
    rows, columns = np.triu_indices(N, 1)
    units = np.zeros((len(rows), N, N))
    places = np.arange(len(rows))
    units[places, rows, columns], units[places, columns, rows] = 1.0, -1.0
    conditions = [
        (units @ (A / np.abs(A).max()) + (A / np.abs(A).max()).T @ units).reshape(len(units), -1).T
        for A in matrices
        if A.any()
    ]
    if not conditions:
        return None
    _, sizes, vectors = np.linalg.svd(np.concatenate(conditions))
    sizes = np.pad(sizes, (0, len(units) - len(sizes)))
    kernel = vectors[sizes <= STRUCTURE_DEFECT * sizes[0]]
    if not len(kernel):
        return None
    weights = np.random.default_rng(0).uniform(1, 2, len(kernel))
    form = np.tensordot(weights @ kernel, units, 1)
    return form if np.linalg.cond(form) < MAX_FORM_CONDITION else None


def _same(one: FloatArray, other: FloatArray, *scale: FloatArray) -> bool:
    """Return whether two arrays agree but for rounding of the entries of ``scale``."""
    size = max(float(np.abs(part).max()) for part in scale)
    return bool(np.abs(one - other).max() <= STRUCTURE_DEFECT * size)


def _jumps(system: PeriodicSystem) -> list[float]:
    return sorted({0.0, 1.0, *(jump for term in system.terms for jump in term.waveform.jumps)})


def _insides(system: PeriodicSystem) -> list[float]:
    """Return a phase inside each segment between jumps, as a part of a period."""
    return [(a + b) / 2 for a, b in pairwise(_jumps(system))]


def _phases(system: PeriodicSystem) -> FloatArray:
    """Return phases, in radians, enough to tell all functions apart and none at a jump."""
    sums = [term.waveform.harmonics for term in system.terms if isinstance(term.waveform, waveforms.Trigonometric)]
    harmonics = max([system.harmonics, *sums])
    # irrational parts: a symmetry that holds at these phases does not hold by chance
    everywhere = (np.arange(PHASES_PER_HARMONIC * harmonics) + 1 / np.pi) / (PHASES_PER_HARMONIC * harmonics)
    between = [
        a + (b - a) * (np.arange(PHASES_PER_SEGMENT) + 1 / np.e) / PHASES_PER_SEGMENT
        for a, b in pairwise(_jumps(system))
    ]
    return np.asarray(2 * np.pi * np.concatenate([everywhere, *between]))


def _derivative(system: PeriodicSystem, of: str, phases: FloatArray, eps: float) -> FloatArray:
    """Return d/dtheta of the mass or the gyroscopic matrix, without jumps."""
    total = np.zeros((len(phases), system.size, system.size))
    for term in system.terms:
        if term.of == of and not isinstance(term.waveform, waveforms.Impulses):
            total += np.multiply.outer(eps**term.power * term.waveform.derivative(phases), term.matrix)
    return total


def _one_sided(system: PeriodicSystem, phase: float, inside: float, eps: float) -> tuple[FloatArray, FloatArray]:
    """Return M and G at a phase, by the formulas that hold at the phase ``inside`` beside it (parts of a period)."""
    found = {"mass": system.mass.copy(), "gyroscopic": system.gyroscopic.copy()}
    for term in system.terms:
        g = term.waveform
        if term.of not in found:
            continue
        assert not isinstance(g, waveforms.Impulses)  # pulses of M and G have been refused
        found[term.of] += g.value_beside(phase, inside) * eps**term.power * term.matrix
    return found["mass"], found["gyroscopic"]


def _axes(system: PeriodicSystem) -> list[float]:
    """Return phases, as parts of a period, about which the excitation might be even: all axes of one function."""
    for j, (c, s) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        if c.any() or s.any():
            largest = np.unravel_index(np.maximum(np.abs(c), np.abs(s)).argmax(), c.shape)
            return _axes_of_harmonic(j, float(np.arctan2(s[largest], c[largest])))
    for term in system.terms:
        g = term.waveform
        if isinstance(g, waveforms.Trigonometric):
            for j in range(1, g.harmonics + 1):
                if g.cosines[j] or g.sines[j]:
                    return _axes_of_harmonic(j, float(np.arctan2(g.sines[j], g.cosines[j])))
        else:
            found = [(g.jumps[0] + other) / 2 + half for other in g.jumps for half in (0.0, 0.5)]
            return found if len(found) <= MAX_AXES else []
    return [0.0]


def _axes_of_harmonic(j: int, angle: float) -> list[float]:
    """Return the axes of cos(j theta - angle), and those about which it is odd."""
    found = [(angle + k * np.pi / 2) / (2 * np.pi * j) for k in range(4 * j)]
    return found if len(found) <= MAX_AXES else []


def _mirrored(term: Term, axis: float) -> bool:
    g = term.waveform
    assert isinstance(g, waveforms.Impulses)
    mirrored = sorted(
        (((2 * axis - phase + 0.5) % 1.0 - 0.5) % 1.0, w) for phase, w in zip(g.phases, g.weights, strict=True)
    )
    close = (
        abs((a - b + 0.5) % 1.0 - 0.5) <= STRUCTURE_DEFECT and v == w
        for (a, v), (b, w) in zip(mirrored, zip(g.phases, g.weights, strict=True), strict=True)
    )
    return all(close)
