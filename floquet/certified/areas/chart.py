"""A proved chart: what is known of every point of a window, kept in arrays (docs/certify.md, sections 6 to 10)."""

from __future__ import annotations

import hashlib
import io
import json
import math
import os
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from floquet.certified.areas.coefficients import Coefficients
from floquet.certified.areas.models import ROUNDING
from floquet.certified.areas.ranges import OPEN, STABLE, UNSTABLE, open_on_line, open_part, verdicts_at
from floquet.certified.areas.search import Found
from floquet.running import replace_file
from periodic import PeriodicSystem
from periodic.checks import FloatArray, real_array

# What a file says it is, and its version.
CERTIFICATE_FORMAT = "floquet proved chart 1"
# Strips of one line that are nearer to each other than this, as a part of Omega, are one strip.
STRIP_GAP = 1e-12
# What float64 may hide of a sum of areas, as a part of the window.
AREA_ROUNDING = 1e-9


class AreaVerdict(StrEnum):
    """What a proved chart says of a point."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    OPEN = "open"


WORDS = np.array([AreaVerdict.OPEN, AreaVerdict.STABLE, AreaVerdict.UNSTABLE], dtype="U8")


class Strip(NamedTuple):
    """At one eps, lower < Omega < upper is open; ``below`` and ``above`` are the verdicts on either side."""

    eps: float
    lower: float
    upper: float
    below: AreaVerdict
    above: AreaVerdict

    @property
    def thickness(self) -> float:
        """Width in Omega."""
        return self.upper - self.lower


class PartArrays(NamedTuple):
    """What is proved of one subsystem; `floquet.certified.areas` names the arrays.

    Attributes
    ----------
    coordinates : ndarray of int
        Which coordinates of the system these are.
    T1, scale : ndarray, shapes (n, n), (n,)
        W' = T1 z_1, W = T1 diag(1 / scale) z_2.
    quarter : ndarray of bool, shape ()
        Whether the period starts at theta = pi / 2, and not at 0.
    patches : ndarray, shape (p, 4)
        l0, h1, e0, h2.
    degree : int
        Of the patches' models.
    first_leaf : ndarray of int, shape (p + 1,)
    leaves : ndarray, shape (l, 4)
        x0, hx, y0, hy.
    whole : ndarray of bool, shape (l,)
        Whether the signs of the leaf are all that can be negative.
    basis, sizes : ndarray, shapes (l, 2n, 2n), (l, 2n)
        B, and the sizes of its clusters, filled up with zeros.
    first_sign : ndarray of int, shape (l + 1,)
    signs : ndarray of int, shape (s, 3)
        Cluster, number of the sign, degree.
    first_coef, coef, sign_radius : ndarray
        Coefficients of all signs, one after the other; where those of each begin; radii.
    left : ndarray, shape (r, 4)
        Rectangles of which nothing is proved: low, high in 1 / Omega, bottom, top in eps.
    """

    coordinates: Any
    T1: Any
    scale: Any
    quarter: Any
    patches: Any
    degree: Any
    first_leaf: Any
    leaves: Any
    whole: Any
    basis: Any
    sizes: Any
    first_sign: Any
    signs: Any
    first_coef: Any
    coef: Any
    sign_radius: Any
    left: Any


def arrays_of(found: list[Found], coordinates: np.ndarray, equation: Coefficients) -> PartArrays:
    """Return everything that was found of a subsystem, in arrays."""
    patches = [one for each in found for one in each.patches]
    leaves = [leaf for one in patches for leaf in one.leaves]
    proofs = [leaf.proof for leaf in leaves]
    N = 2 * len(coordinates)
    signs = [sign for proof in proofs if proof is not None for sign in proof.signs]
    sizes = np.zeros((len(leaves), N), dtype=np.int64)
    basis = np.tile(np.eye(N), (len(leaves), 1, 1))
    for i, proof in enumerate(proofs):
        if proof is not None:
            sizes[i, : len(proof.sizes)] = proof.sizes
            basis[i] = proof.basis
    return PartArrays(
        coordinates=np.asarray(coordinates),
        T1=equation.T1,
        scale=equation.scale,
        quarter=np.array(equation.quarter),
        patches=np.array([one.patch[:4] for one in patches]).reshape(-1, 4),
        degree=np.array(patches[0].patch.model.degree if patches else 0),
        first_leaf=np.cumsum([0, *(len(one.leaves) for one in patches)]),
        leaves=np.array([leaf.cell for leaf in leaves]).reshape(-1, 4),
        whole=np.array([proof is not None and proof.whole for proof in proofs], dtype=bool),
        basis=basis,
        sizes=sizes,
        first_sign=np.cumsum([0, *(0 if proof is None else len(proof.signs) for proof in proofs)]),
        signs=np.array([(s.cluster, s.number, s.degree) for s in signs], dtype=np.int64).reshape(-1, 3),
        first_coef=np.cumsum([0, *(len(s.coef) for s in signs)]),
        coef=np.concatenate([s.coef for s in signs]) if signs else np.zeros(0),
        sign_radius=np.array([s.radius for s in signs]),
        left=np.array([r for each in found for r in each.left]).reshape(-1, 4),
    )


@dataclass(frozen=True, eq=False)
class ProvedChart:
    """Verdicts that are theorems, for every point of a window.

    Attributes
    ----------
    system : PeriodicSystem
        What is proved is about exactly these float64 numbers.
    Omega_range, eps_range : (float, float)
        The window.
    parts : tuple of PartArrays
        One for each subsystem that exact zeros keep apart and that is excited.
    constant_verdict : AreaVerdict
        Of the subsystems without excitation, at every point; stable if there are none.
    """

    system: PeriodicSystem
    Omega_range: tuple[float, float]
    eps_range: tuple[float, float]
    parts: tuple[PartArrays, ...]
    constant_verdict: AreaVerdict = AreaVerdict.STABLE

    def verdict(self, Omega: ArrayLike, eps: ArrayLike) -> Any:
        """Return the verdict at points of the window.

        Parameters
        ----------
        Omega, eps : float or array_like
            Points; arrays are broadcast. Each is exactly the float64 number given.

        Returns
        -------
        AreaVerdict, or ndarray of str
            "stable", "unstable" or "open".

        Raises
        ------
        ValueError
            If a point lies outside the window.
        """
        Omegas, amplitudes = np.broadcast_arrays(np.asarray(Omega, dtype=float), np.asarray(eps, dtype=float))
        for name, values, (low, high) in (
            ("Omega", Omegas, self.Omega_range),
            ("eps", amplitudes, self.eps_range),
        ):
            outside = values[~((values >= low) & (values <= high))]
            if outside.size:
                raise ValueError(f"{name} = {float(outside[0])!r} is outside the window; give {low!r} to {high!r}")
        codes = self._codes(np.ravel(Omegas).copy(), np.ravel(amplitudes).copy())
        if Omegas.ndim == 0:
            return AreaVerdict(str(WORDS[codes[0]]))
        return WORDS[codes].reshape(Omegas.shape)

    def _codes(self, Omega: FloatArray, eps: FloatArray) -> np.ndarray:
        codes = [np.full(len(Omega), WORDS.tolist().index(self.constant_verdict), dtype=np.int8)]
        for part in self.parts:
            degrees = np.ascontiguousarray(part.signs[:, 2])
            codes.append(
                verdicts_at(
                    Omega,
                    eps,
                    part.patches,
                    part.first_leaf,
                    part.leaves,
                    part.whole,
                    part.first_sign,
                    part.coef,
                    part.first_coef,
                    degrees,
                    part.sign_radius,
                )
            )
        return _together(np.array(codes))

    @property
    def proved_fraction(self) -> float:
        """A lower bound of the part of the window's area that is proved, from the ranges of the polynomials."""
        if self.constant_verdict == AreaVerdict.UNSTABLE:
            return 1.0
        if self.constant_verdict == AreaVerdict.OPEN:
            return 0.0
        (low, high), (bottom, top) = self.Omega_range, self.eps_range
        unproved = sum(_open_area(part) for part in self.parts)
        return max(0.0, 1.0 - unproved / ((high - low) * (top - bottom)) - AREA_ROUNDING)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return sum(len(part.leaves) for part in self.parts)

    def edges(self, eps: ArrayLike) -> list[Strip]:
        """Return the strips of Omega that are open, at amplitudes, in the order of eps and Omega.

        Where the verdicts on either side differ, an edge of stability is proved to lie inside.

        Raises
        ------
        ValueError
            If an amplitude lies outside the window.
        """
        amplitudes = np.atleast_1d(real_array("eps", eps, np.ndim(eps)))
        bottom, top = self.eps_range
        for one in amplitudes:
            if not bottom <= one <= top:
                raise ValueError(f"eps = {float(one)!r} is outside the window; give {bottom!r} to {top!r}")
        return [strip for one in amplitudes.tolist() for strip in self._strips(one)]

    def _strips(self, eps: float) -> list[Strip]:
        """Return the strips at one amplitude."""
        pieces: list[tuple[float, float]] = []
        for part in self.parts:
            pieces += _open_on_line(part, eps)
        low, high = self.Omega_range
        pieces = sorted((max(a, low), min(b, high)) for a, b in pieces if b > low and a < high)
        merged: list[list[float]] = []
        for a, b in pieces:
            if merged and a <= merged[-1][1] * (1 + STRIP_GAP):
                merged[-1][1] = max(merged[-1][1], b)
            else:
                merged.append([a, b])
        ends = [low, *(x for pair in merged for x in pair), high]
        middles = np.array([(a + b) / 2 for a, b in zip(ends[::2], ends[1::2], strict=True)])
        sides = [AreaVerdict(str(word)) for word in WORDS[self._codes(middles, np.full(len(middles), eps))]]
        # where one subsystem is unstable, it does not matter what is open in another
        strips = [Strip(eps, a, b, *sides[i : i + 2]) for i, (a, b) in enumerate(merged)]
        inside = self._codes(np.array([(s.lower + s.upper) / 2 for s in strips]), np.full(len(strips), eps))
        return [s for s, code in zip(strips, inside, strict=True) if code != UNSTABLE or len(self.parts) == 1]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the chart as a compressed .npz file: the certificate that `check` reads."""
        arrays: dict[str, Any] = {name: getattr(self.system, name) for name in MATRICES}
        arrays["window"] = np.array([*self.Omega_range, *self.eps_range])
        arrays["about"] = np.array(
            json.dumps({"format": CERTIFICATE_FORMAT, "parts": len(self.parts), "constant": self.constant_verdict})
        )
        for i, part in enumerate(self.parts):
            arrays |= {f"{name}_{i}": value for name, value in part._asdict().items()}
        arrays = {name: np.ascontiguousarray(value).reshape(np.shape(value)) for name, value in arrays.items()}
        arrays["digest"] = np.array(_digest(arrays))
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)
        replace_file(Path(path), buffer.getvalue())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ProvedChart:
        """Return the chart of a file that `save` wrote. It is not checked: `check` does that.

        Raises
        ------
        ValueError
            If the file holds no proved chart.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                about = json.loads(str(file["about"]))
                if about["format"] != CERTIFICATE_FORMAT:
                    raise KeyError(about["format"])
                system = PeriodicSystem(*(file[name] for name in MATRICES))
                window = file["window"].tolist()
                parts = tuple(
                    PartArrays(*(file[f"{name}_{i}"] for name in PartArrays._fields)) for i in range(about["parts"])
                )
        except (KeyError, TypeError, OSError, ValueError) as error:
            raise ValueError(
                f"{path} holds no proved chart ({error}); give a file that ProvedChart.save wrote"
            ) from None
        return cls(system, tuple(window[:2]), tuple(window[2:]), parts, AreaVerdict(about["constant"]))

    def __repr__(self) -> str:
        (low, high), (bottom, top) = self.Omega_range, self.eps_range
        return (
            f"ProvedChart(Omega {low:g} to {high:g}, eps {bottom:g} to {top:g}: {self.cells} cells, "
            f"{100 * math.floor(1e6 * self.proved_fraction) / 1e6:.4f} % proved)"
        )


MATRICES = ("mass", "gyroscopic", "damping", "stiffness", "cosine", "sine")


def _digest(arrays: dict[str, Any]) -> str:
    """Return the SHA-256 of all names, shapes and numbers, as `floquet.certified.checking` reads them."""
    text = ""
    for name, value in sorted(arrays.items()):
        flat = value.ravel().tolist()
        text += f"{name}{value.shape}{[x.hex() if isinstance(x, float) else x for x in flat]}"
    return hashlib.sha256(text.encode()).hexdigest()


def _together(codes: np.ndarray) -> np.ndarray:
    """Return the verdicts of a system from those of its subsystems."""
    unstable, stable = (codes == UNSTABLE).any(axis=0), (codes == STABLE).all(axis=0)
    return np.where(unstable, UNSTABLE, np.where(stable, STABLE, OPEN)).astype(np.int8)


def _open_area(part: PartArrays) -> float:
    """Bound of the area of the window in which a subsystem is not proved."""
    total = float(sum((1 / low - 1 / high) * (top - bottom) for low, high, bottom, top in part.left.tolist()))
    for p, (l0, h1, _, h2) in enumerate(part.patches.tolist()):
        for leaf in range(part.first_leaf[p], part.first_leaf[p + 1]):
            x0, hx, _, hy = part.leaves[leaf].tolist()
            low, high = l0 + h1 * (x0 - hx), l0 + h1 * (x0 + hx)
            open_share = 0.0
            alone = []
            for s in range(part.first_sign[leaf], part.first_sign[leaf + 1]):
                coef = part.coef[part.first_coef[s] : part.first_coef[s + 1]]
                if coef[0] + np.abs(coef[1:]).sum() < -2 * part.sign_radius[s]:
                    break  # unstable everywhere
                alone.append(open_part(coef, int(part.signs[s, 2]), float(part.sign_radius[s])))
            else:
                open_share = min(1.0, sum(alone)) if part.whole[leaf] else 1.0
            # in a cell d Omega = d lambda / lambda^2 is largest at its low end
            shares = (1 / low - 1 / high) if open_share == 1.0 else open_share * (high - low) / (low * low)
            total += shares * 2 * h2 * hy
    return total


def _open_on_line(part: PartArrays, eps: float) -> list[tuple[float, float]]:
    """Return intervals of Omega that contain everything that is open at one amplitude."""
    pieces = [(1 / high, 1 / low) for low, high, bottom, top in part.left.tolist() if bottom <= eps <= top]
    for p, (l0, h1, e0, h2) in enumerate(part.patches.tolist()):
        eta = (eps - e0) / h2
        if abs(eta) > 1 + AREA_ROUNDING:
            continue
        for leaf in range(part.first_leaf[p], part.first_leaf[p + 1]):
            x0, hx, y0, hy = part.leaves[leaf].tolist()
            y = (eta - y0) / hy
            if abs(y) > 1 + AREA_ROUNDING:
                continue
            first, last = part.first_sign[leaf], part.first_sign[leaf + 1]
            dy = 16 * ROUNDING * (abs(eps) / h2 + 2) / hy
            found = open_on_line(
                part.coef,
                part.first_coef[first : last + 1],
                np.ascontiguousarray(part.signs[first:last, 2]),
                part.sign_radius[first:last],
                bool(part.whole[leaf]),
                min(max(y, -1.0), 1.0),
                dy,
            )
            for a, b in found:
                low, high = l0 + h1 * (x0 + hx * a), l0 + h1 * (x0 + hx * b)
                pieces.append((1 / high * (1 - 8 * ROUNDING), 1 / low * (1 + 8 * ROUNDING)))
    return pieces
