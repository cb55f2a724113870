"""Other programs as judges of the gallery: growth over a period by SciPy, CyRK and heyoka, beside that of `monodromy`.

``python -m benchmarks.gallery`` writes the table of docs/peers.md; it needs the extra ``bench``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.integrate

from floquet import monodromy
from periodic import AnyFamily, PeriodicSystem, Term, waveforms
from periodic.checks import FloatArray

PAGE = Path(__file__).resolve().parent.parent / "docs" / "peers.md"
PAGE_MARK = "<!-- what follows is written by python -m benchmarks.gallery -->\n"
# All integrate to rounding: it is not their speed that is asked for.
FINEST_TOLERANCE = 1e-13
PEER_PACKAGES = ("scipy", "cyrk", "heyoka")


class Asked(NamedTuple):
    """An example of the gallery, how to make its system, and the point that is asked for."""

    example: str
    make: Callable[[Any], AnyFamily]
    Omega: float
    eps: float


POINTS = (
    Asked("moving.beam", lambda m: m.system(), 10.6315, 0.2),
    Asked("moving.pipe", lambda m: m.Pipe(), 14.7583, 0.3),
    Asked("moving.string", lambda m: m.system(terms=8), 5.8, 0.3),
    Asked("moving.web", lambda m: m.system(), 18.4763, 0.2),
    Asked("oscillators.digital_trap", lambda m: m.system(), 2.0, 0.75),
    Asked("oscillators.kapitza_pendulum", lambda m: m.system(20.0), 20.0, 0.05),
    Asked("oscillators.mathieu", lambda m: m.system(2.0), 2.0, 5.0),
    Asked("oscillators.meissner", lambda m: m.system(), 2.05, 0.3),
    Asked("oscillators.mems_resonator", lambda m: m.system(), 1.85, 0.6),
    Asked("oscillators.quadrupole_trap", lambda m: import_module("periodic.examples").quadrupole_trap(0.3), 2.0, 0.7),
    Asked("oscillators.ship_roll", lambda m: m.system(), 2.0, 0.3),
    Asked("rotors.asymmetric_shaft", lambda m: m.system(), 1.0, 0.3),
    Asked("rotors.blade_flap", lambda m: m.system(), 1.0, 1.5),
    Asked("rotors.gear_mesh", lambda m: m.system(), 3.9156, 0.3),
    Asked("rotors.ground_resonance", lambda m: m.Helicopter(), 27.0, 1.0),
    Asked("rotors.two_bladed_whirl", lambda m: m.Propeller(), 1.3, 0.7),
    Asked("structures.antiresonance", lambda m: m.system(), 0.75, 0.3),
    Asked("structures.beck_column", lambda m: m.system(damping=0.2), 10.0, 0.3),
    Asked("structures.column", lambda m: m.system(), 16.0, 1.0),
    Asked("structures.modulated_chain", lambda m: m.system(), 2.5185803, 0.2),
    Asked("structures.square_plate", lambda m: m.system(), 98.696, 0.4),
)


class Motion:
    """x' = A x of a system at one point, with the part of the period as time, in x = (W, W')."""

    def __init__(self, system: PeriodicSystem, Omega: float, eps: float) -> None:
        self.size, self.period = 2 * system.size, 2 * math.pi / Omega
        self.constant = {
            "mass": system.mass, "damping": system.damping + system.gyroscopic, "stiffness": system.stiffness
        }  # fmt: skip
        short = [
            Term("stiffness", X, wave)
            for j in range(system.harmonics)
            for X, wave in ((system.cosine[j], waveforms.cosine(j + 1)), (system.sine[j], waveforms.sine(j + 1)))
        ]
        named = {"gyroscopic": "damping"}
        self.terms: list[tuple[str, Any, FloatArray]] = [
            (named.get(term.of, term.of), term.waveform, eps**term.power * term.matrix)
            for term in (*system.terms, *short)
        ]
        jumps = {jump for _, waveform, _ in self.terms for jump in waveform.jumps}
        self.smooth = list(pairwise(sorted({0.0, 1.0, *jumps})))

    def matrix(self, phase: float, inside: float) -> FloatArray:
        """Return A at a phase, where nothing jumps between it and the phase ``inside``."""
        now = {name: X.copy() for name, X in self.constant.items()}
        for of, waveform, X in self.terms:
            now[of] += waveform.value_beside(phase, inside) * X
        n = self.size // 2
        below = -np.linalg.solve(now["mass"], np.hstack([now["stiffness"], now["damping"]]))
        return np.asarray(self.period * np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), below]))


def by_scipy(motion: Motion) -> FloatArray:
    """Return the monodromy matrix by SciPy's DOP853."""
    Phi: FloatArray = np.eye(motion.size)
    for a, b in motion.smooth:

        def rate(x: float, y: FloatArray, inside: float = (a + b) / 2) -> FloatArray:
            return np.asarray((motion.matrix(x, inside) @ y.reshape(motion.size, -1)).ravel())

        part = scipy.integrate.solve_ivp(
            rate, (a, b), Phi.ravel(), method="DOP853", rtol=FINEST_TOLERANCE, atol=FINEST_TOLERANCE
        )
        Phi = np.asarray(part.y[:, -1]).reshape(motion.size, -1)
    return Phi


def by_cyrk(motion: Motion) -> FloatArray:
    """Return the monodromy matrix by CyRK's DOP853."""
    CyRK: Any = import_module("CyRK")
    Phi: FloatArray = np.eye(motion.size)
    for a, b in motion.smooth:

        def rate(x: float, y: FloatArray, inside: float = (a + b) / 2) -> FloatArray:
            return np.asarray((motion.matrix(x, inside) @ y.reshape(motion.size, -1)).ravel())

        found = CyRK.pysolve_ivp(
            rate, (a, b), Phi.ravel(), method="DOP853", rtol=FINEST_TOLERANCE, atol=FINEST_TOLERANCE
        )
        Phi = np.array(found.y[:, -1]).reshape(motion.size, -1)
    return Phi


def by_heyoka(motion: Motion) -> FloatArray | None:
    """Return the monodromy matrix by heyoka's Taylor series; None where the mass matrix depends on time."""
    hy: Any = import_module("heyoka")
    if any(of == "mass" for of, _, _ in motion.terms):
        return None
    n, inverse = motion.size // 2, np.linalg.inv(motion.constant["mass"])
    x = hy.make_vars(*(f"x{i}" for i in range(motion.size)))
    Phi: FloatArray = np.eye(motion.size)
    for a, b in motion.smooth:
        free = motion.matrix(a, (a + b) / 2)
        parts: list[tuple[Any, FloatArray]] = []
        for of, waveform, X in motion.terms:
            acting = np.zeros((motion.size, motion.size))
            acting[n:, slice(0, n) if of == "stiffness" else slice(n, 2 * n)] = -motion.period * inverse @ X
            if isinstance(waveform, waveforms.Trigonometric):
                free = free - waveform.value_beside(a, (a + b) / 2) * acting
                turns = [2 * math.pi * k * hy.time for k in range(len(waveform.cosines))]
                sums = zip(waveform.cosines, waveform.sines, turns, strict=True)
                parts.append((hy.sum([c * hy.cos(t) + s * hy.sin(t) for c, s, t in sums]), acting))
            elif waveform.value_beside(a, (a + b) / 2) != waveform.value_beside(b, (a + b) / 2):
                return None  # pieces that are not constant
        rows = []
        for i in range(motion.size):
            entries = [float(free[i, k]) * x[k] for k in range(motion.size) if free[i, k]]
            entries += [float(X[i, k]) * wave * x[k] for wave, X in parts for k in range(motion.size) if X[i, k]]
            rows.append(hy.sum(entries))
        integrator = hy.taylor_adaptive(list(zip(x, rows, strict=True)), [0.0] * motion.size)
        for column in range(motion.size):
            integrator.time = a
            integrator.state[:] = Phi[:, column]
            integrator.propagate_until(b)
            Phi[:, column] = integrator.state
    return Phi


PEER_METHODS: dict[str, Callable[[Motion], FloatArray | None]] = {
    "SciPy DOP853": by_scipy, "CyRK DOP853": by_cyrk, "heyoka": by_heyoka
}  # fmt: skip


def table() -> str:
    """Ask all programs and return the table, with their versions."""
    versions = ", ".join(f"{name} {version(name)}" for name in PEER_PACKAGES)
    lines = [f"Versions: {versions}; tolerance {FINEST_TOLERANCE:g}.", ""]
    lines.append(f"| example | Ω | ε | growth here | error | {' | '.join(PEER_METHODS)} |")
    lines.append("|---|" + "--:|" * (4 + len(PEER_METHODS)))
    for example, make, Omega, eps in POINTS:
        family = make(import_module(f"floquet_examples.{example}"))
        found = monodromy(family, Omega, eps)
        motion = Motion(family.at(Omega), Omega, eps)  # type: ignore[arg-type]
        here, cells = found.growth_rate * motion.period, []
        for solve in PEER_METHODS.values():
            Phi = solve(motion)
            there = None if Phi is None else math.log(np.abs(np.linalg.eigvals(Phi)).max())
            cells.append("–" if there is None else f"{abs(there - here):.0e}")
        lines.append(
            f"| {example.partition('.')[2]} | {Omega:g} | {eps:g} | {here:.12g} | {found.log_modulus_error:.0e} | "
            f"{' | '.join(cells)} |"
        )
        print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    head, mark, _ = PAGE.read_text(encoding="utf-8").partition(PAGE_MARK)
    PAGE.write_text(head + mark + "\n" + table(), encoding="utf-8")
