"""Random systems of every kind, and their monodromy matrices by SciPy's DOP853, from jump to jump."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.waveforms import Impulses, Waveform

Matrix = NDArray[np.float64]
# Phase, as a part of a period, that tells the two sides of a jump apart.
BESIDE = 1e-12


def random_waveform(rng: np.random.Generator, kinds: int = 7) -> Waveform:
    """One of the first ``kinds`` waveforms; the first three and the last are smooth."""
    return (
        waveforms.cosine(int(rng.integers(1, 4)), rng.random()),
        waveforms.constant(),
        waveforms.function(lambda theta: math.exp(math.cos(theta - 1))),
        waveforms.rectangular(rng.uniform(0.2, 0.8), rng.random()),
        waveforms.triangle(),
        waveforms.sawtooth(),
        waveforms.function(lambda theta: abs(math.sin(theta)), [0, 0.5]),
    )[rng.integers(0, kinds)]


def random_first_order(seed: int, n: int, *, kinds: int = 7, pulses: bool = False) -> FirstOrderSystem:
    """Any size, odd too."""
    rng = np.random.default_rng(seed)

    def matrix(size: float) -> Matrix:
        return size * rng.standard_normal((n, n))

    terms = [
        Term("state", matrix(0.5), random_waveform(rng, kinds), int(rng.integers(1, 3)))
        for _ in range(rng.integers(1, 4))
    ]
    if pulses:
        terms.append(Term("state", matrix(0.3), waveforms.impulses(np.sort(rng.random(2)), [1.0, -0.5])))
    return FirstOrderSystem(matrix(1.0) - 0.3 * np.eye(n), terms=terms)


def random_second_order(
    seed: int, n: int, *, kinds: int = 7, pulses: bool = False, of: Sequence[str] = ("all",)
) -> PeriodicSystem:
    """Terms of all four matrices, or of those that ``of`` names."""
    rng = np.random.default_rng(seed)

    def matrix(size: float, sign: int = 0) -> Matrix:
        X = size * rng.standard_normal((n, n))
        return (X + sign * X.T) / 2 if sign else X

    signs = {"stiffness": 0, "damping": 1, "gyroscopic": -1, "mass": 1}
    names = list(signs) if tuple(of) == ("all",) else list(of)
    terms = []
    for _ in range(rng.integers(1, 5)):
        name = names[rng.integers(0, len(names))]
        X = matrix(0.15 if name == "mass" else 0.5, signs[name])
        terms.append(Term(name, X, random_waveform(rng, kinds), int(rng.integers(1, 3))))
    if pulses:
        where = waveforms.impulses(np.sort(rng.random(2)), [1.0, -0.5])
        terms.append(Term(("stiffness", "damping")[rng.integers(0, 2)], matrix(0.5, 1), where))
    A, B = matrix(0.5), matrix(1.0)
    constant = (A @ A.T + np.eye(n), matrix(1.0, -1), matrix(0.1, 1) + 0.1 * np.eye(n), B @ B.T + np.eye(n))
    return PeriodicSystem(*constant, matrix(0.5) if rng.random() < 0.5 else None, terms=terms)


def coefficient_matrix(system: AnySystem, theta: float, eps: float) -> Matrix:
    """The matrix of q' = A(t) q, q = (W', W) or x, straight from the definition of the system."""
    if isinstance(system, FirstOrderSystem):
        return system.matrix(theta, eps)
    n = system.size
    M, G, C, K = system.matrices(theta, eps)
    return np.vstack([-np.linalg.solve(M, np.hstack([G + C, K])), np.eye(n, 2 * n)])


def dop853(system: AnySystem, Omega: float, eps: float) -> Matrix:
    """Monodromy matrix from just after t = 0; its own error is 1e-13 to 1e-11."""
    period = 2 * np.pi / Omega
    Phi: Matrix = np.eye(len(coefficient_matrix(system, 0.1, eps)))
    jumps = {jump for term in system.terms for jump in term.waveform.jumps}
    for a, b in pairwise(sorted({0.0, 1.0, *jumps})):

        def rate(x: float, q: Matrix, a: float = a, b: float = b, N: int = len(Phi)) -> Matrix:
            A = coefficient_matrix(system, 2 * np.pi * min(max(x, a + BESIDE), b - BESIDE), eps)
            return (period * A @ q.reshape(N, N)).ravel()

        found = solve_ivp(rate, (a, b), Phi.ravel(), method="DOP853", rtol=1e-13, atol=1e-13)
        Phi = jump_matrix(system, b, eps) @ found.y[:, -1].reshape(Phi.shape)
    return Phi


def jump_matrix(system: AnySystem, phase: float, eps: float) -> Matrix:
    """What happens at a phase: the momentum M W' goes on, pulses turn the state by an exponential."""
    n = system.size
    pulses = [
        (term.of, eps**term.power * weight * term.matrix)
        for term in system.terms
        if isinstance(term.waveform, Impulses)
        for place, weight in zip(term.waveform.phases, term.waveform.weights, strict=True)
        if place == phase % 1.0
    ]
    if isinstance(system, FirstOrderSystem):
        return sla.expm(sum((X for _, X in pulses), np.zeros((n, n))))
    before = system.matrices(2 * np.pi * (phase - BESIDE), eps)[0]
    after = system.matrices(2 * np.pi * ((phase + BESIDE) % 1.0), eps)[0]
    kick = np.zeros((2 * n, 2 * n))
    for of, X in pulses:
        kick[:n, slice(n, None) if of == "stiffness" else slice(n)] -= np.linalg.solve(after, X)
    return sla.expm(kick) @ sla.block_diag(np.linalg.solve(after, before), np.eye(n))
