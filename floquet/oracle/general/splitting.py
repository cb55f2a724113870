"""Any linear periodic system as E(t) y' = A(t) y: independent subsystems, each in coordinates that suit it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.oracle.general.coefficients import Coefficients, Part, coefficients
from floquet.oracle.reduction import (
    MAX_SPLIT_COUPLING,
    coordinate_sets,
    driven_scales,
    elastic_basis,
    symmetry_parts,
)
from floquet.oracle.rigid import rigid_motions
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, check_mass, excitation, waveforms
from periodic.checks import FloatArray
from periodic.structure import conserved_form, is_reversible, skew_form


class GeneralSubsystem(NamedTuple):
    """An independent subsystem E(t) y' = A(t) y of N states.

    Attributes
    ----------
    to_q : ndarray, shape (S, N)
        The subsystem contributes to_q @ y to the state: (W', W), or x of a first-order system.
    from_q : ndarray, shape (N, S)
        y = from_q @ state, just after t = 0.
    coefficients : Coefficients
    reciprocal : bool
        True if with mu also 1/conj(mu) is a multiplier: the subsystem is Hamiltonian or reversible.
    form : ndarray, shape (N, N), or None
        Of a Hamiltonian subsystem, the skew-symmetric form that its motion conserves over a period.
    """

    to_q: FloatArray
    from_q: FloatArray
    coefficients: Coefficients
    reciprocal: bool
    form: FloatArray | None


class Split(NamedTuple):
    """A general system at one amplitude: its independent subsystems, and its rigid motions R (n, r), R^T M R = I."""

    subsystems: list[GeneralSubsystem]
    rigid: FloatArray


def split(system: AnySystem, Omega: float, eps: float) -> Split:
    """Return the independent subsystems of ``system`` at one frequency and amplitude.

    Raises
    ------
    ValueError
        If the mass matrix becomes singular within the period.
    """
    if isinstance(system, FirstOrderSystem):
        return Split(list(_first_order(system, eps)), np.zeros((system.size, 0)))
    check_mass(system, eps)
    names, matrices = _all_matrices(system)
    bases, neglected = _independent(names, matrices, Omega)
    subsystems = [_second_order(_projected(system, basis), basis, system, Omega, eps) for basis in bases]
    if neglected:
        charged = [one.coefficients._replace(unknown=one.coefficients.unknown + neglected) for one in subsystems]
        subsystems = [one._replace(coefficients=c) for one, c in zip(subsystems, charged, strict=True)]
    return Split(subsystems, rigid_motions(matrices))


def _independent(names: list[str], matrices: FloatArray, Omega: float) -> tuple[list[FloatArray], float]:
    """Return a basis (n, m) of each independent set of motions, and the norm of what couples them all the same.

    A hidden symmetry is used if what it leaves of couplings is rounding: as a coefficient matrix in energy coordinates,
    per unit of time, at eps = 1.
    """
    found = (elastic_basis(matrices, one) for one in coordinate_sets(np.abs(np.sign(matrices))))
    separate = [basis for basis in found if basis.size]
    symmetric = [part for basis in separate for part in symmetry_parts(matrices, basis)]
    if len(symmetric) == len(separate):
        return separate, 0.0
    basis = np.hstack(symmetric)
    label = np.repeat(np.arange(len(symmetric)), [part.shape[1] for part in symmetric])
    inside = basis.T @ matrices @ basis
    scale = np.sqrt(np.diag(inside[0]))
    w = np.maximum(np.sqrt(np.abs(np.diag(inside[3]))) / scale, Omega / (2 * np.pi))
    couplings = np.where(label[:, None] == label, 0.0, inside) / np.outer(scale, scale)
    acts = {"mass": w, "gyroscopic": 1.0, "damping": 1.0, "stiffness": 1 / w}
    neglected = sum(float(np.linalg.norm(X * acts[of])) for of, X in zip(names, couplings, strict=True))
    return (symmetric, neglected) if neglected <= MAX_SPLIT_COUPLING * w.max() else (separate, 0.0)


def _all_matrices(system: PeriodicSystem) -> tuple[list[str], FloatArray]:
    """Return M, G, C, K and the matrices of everything that depends on time, (p, n, n), and what each belongs to."""
    names = ["mass", "gyroscopic", "damping", "stiffness"]
    constant = [getattr(system, name) for name in names]
    short = [*system.cosine, *system.sine]
    names += [*["stiffness"] * len(short), *(term.of for term in system.terms)]
    return names, np.array([*constant, *short, *(term.matrix for term in system.terms)])


def _projected(system: PeriodicSystem, basis: FloatArray) -> PeriodicSystem:
    """Return the system of the motions W = basis @ q."""
    if basis.shape[0] == basis.shape[1] and (basis == np.eye(len(basis))).all():
        return system
    return system.restricted(basis)


def _second_order(
    system: PeriodicSystem, basis: FloatArray, whole: PeriodicSystem, Omega: float, eps: float
) -> GeneralSubsystem:
    """Write a subsystem in energy coordinates: W = modes @ (y1 / w), W' = modes @ y2."""
    k, modes = sla.eigh(system.stiffness + system.stiffness.T, system.mass)
    m = len(k)
    zero = np.zeros((m, m))
    parts = [
        (of, waveform, eps**power * (modes.T @ matrix @ modes))
        for of, waveform, matrix, power in excitation(system)
        if eps
    ]
    smooth = [X for of, g, X in parts if of == "stiffness" and not isinstance(g, waveforms.Impulses)]
    w = driven_scales(k / 2, np.array(smooth).reshape(-1, m, m), Omega / (2 * np.pi))
    K, V = (modes.T @ S @ modes for S in (system.stiffness, system.gyroscopic + system.damping))

    def rows(of: str, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what X adds to A and to E."""
        if of == "mass":
            return np.zeros((2 * m, 2 * m)), np.block([[zero, zero], [zero, X]])
        left, right = (-X / w, zero) if of == "stiffness" else (zero, -X)
        return np.block([[zero, zero], [left, right]]), np.zeros((2 * m, 2 * m))

    constant = np.block([[zero, np.diag(w)], [-K / w, -V]])
    shapes = basis @ modes
    inverse = shapes.T @ whole.mass
    wide, tall = np.zeros_like(shapes), np.zeros_like(shapes.T)
    to_q = np.block([[wide, shapes], [shapes / w, wide]])
    form = conserved_form(system, Omega, eps)
    within = np.block([[np.zeros_like(modes), modes], [modes / w, np.zeros_like(modes)]])
    return GeneralSubsystem(
        to_q=to_q,
        from_q=np.block([[tall, w[:, None] * inverse], [inverse, tall]]),
        coefficients=coefficients(constant, [Part(g, *rows(of, X)) for of, g, X in parts]),
        reciprocal=form is not None or is_reversible(system, eps),
        form=None if form is None else within.T @ form @ within,
    )


def _first_order(system: FirstOrderSystem, eps: float) -> Iterator[GeneralSubsystem]:
    harmonics = [
        (matrix, waveform(j), 1)
        for given, waveform in ((system.cosine, waveforms.cosine), (system.sine, waveforms.sine))
        for j, matrix in enumerate(given, start=1)
        if matrix.any()
    ]
    parts = [*harmonics, *((term.matrix, term.waveform, term.power) for term in system.terms)]
    matrices = np.array([system.constant, *(matrix for matrix, _, _ in parts)])
    for basis in coordinate_sets(np.abs(np.sign(matrices))):
        inside = basis.T @ matrices @ basis
        # a diagonal scaling by powers of two rounds nothing
        scale = np.diag(sla.matrix_balance(np.abs(inside).sum(axis=0), permute=False, separate=False)[1])
        scaled = inside * scale / scale[:, None]
        constant, *excitation = scaled
        zero = np.zeros_like(constant)
        small = FirstOrderSystem(
            constant, terms=[Term("state", X, g, p) for X, (_, g, p) in zip(excitation, parts, strict=True)]
        )
        form = skew_form(small, eps)
        yield GeneralSubsystem(
            to_q=basis * scale,
            from_q=basis.T / scale[:, None],
            coefficients=coefficients(
                constant, [Part(g, eps**p * X, zero) for X, (_, g, p) in zip(excitation, parts, strict=True) if eps]
            ),
            reciprocal=form is not None,
            form=form,
        )
