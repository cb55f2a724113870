"""All claims of a certificate, one after the other."""

from __future__ import annotations

import json
import struct
import zipfile
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, arb_mat, ctx

from floquet.certified.checking.arithmetic import cut, moduli, moved, size, total
from floquet.certified.checking.cells import cell, definite
from floquet.certified.checking.flow import monodromy
from floquet.certified.checking.reading import Array, Refused, demand, digest, read

BALL_BITS = 128
MATRICES = ("mass", "gyroscopic", "damping", "stiffness", "cosine", "sine")
# Degrees of models beyond the certificate's, and what may be cut from one.
MORE_DEGREES, CUT = 2, 1e-14


def tiled(cells: list[tuple[Fraction, ...]], x: Fraction, hx: Fraction, y: Fraction, hy: Fraction) -> bool:
    if cells == [(x, hx, y, hy)]:
        return True
    for axis, (centre, half) in enumerate(((x, hx), (y, hy))):
        sides = [[c for c in cells if (c[2 * axis] - centre) * s >= c[2 * axis + 1]] for s in (-1, 1)]
        if all(sides) and len(sides[0]) + len(sides[1]) == len(cells):
            h = half / 2
            boxes = [(x + s * h, h, y, hy) if axis == 0 else (x, hx, y + s * h, h) for s in (-1, 1)]
            return all(tiled(side, *box) for side, box in zip(sides, boxes, strict=True))
    return False


def covered(boxes: list[tuple[Fraction, ...]], low: Fraction, high: Fraction, bottom: Fraction, top: Fraction) -> bool:
    ends = sorted({low, high, *(x for box in boxes for x in box[:2] if low < x < high)})
    for a, b in pairwise(ends):
        level = bottom
        for _, _, c, d in sorted((box for box in boxes if box[0] <= a and b <= box[1]), key=lambda box: box[2]):
            level = max(level, d) if c <= level else level
        if level < top:
            return False
    return True


def subsystem(arrays: dict[str, Array], i: int, matrices: dict[str, Any], window: list[float]) -> None:
    """Check what is said of the i-th subsystem."""
    get = {name.removesuffix(f"_{i}"): one for name, one in arrays.items() if name.endswith(f"_{i}")}
    scale = get["scale"].flat
    n, T = len(scale), get["T1"].mat()
    slow, zero = (
        arb_mat([[1 / arb(scale[p]) if p == q else arb(0) for q in range(n)] for p in range(n)]),
        [[arb(0)] * n] * n,
    )
    inverse = (matrices["mass"] * T).inv()
    fast = slow.inv().tolist()
    place = (inverse * matrices["stiffness"] * T * slow).tolist()
    speed = (inverse * (matrices["gyroscopic"] + matrices["damping"]) * T).tolist()
    A = arb_mat(
        [[-x for x in (*a, *b)] for a, b in zip(speed, place, strict=True)]
        + [a + b for a, b in zip(fast, zero, strict=True)]
    )
    waves = []
    for j, is_sine, X in matrices["waves"]:
        F = (inverse * X * T * slow).tolist()
        waves.append(
            (j, is_sine, arb_mat([b + [-x for x in a] for a, b in zip(F, zero, strict=True)] + [b + b for b in zero]))
        )
    quarter = get["quarter"].flat[0]
    free = not any(x != 0 for X in (matrices["damping"],) for x in X.entries())
    symmetric = all(X.transpose() == X for X in (matrices["stiffness"], *(X for _, _, X in waves_of(matrices))))
    reversible = (
        free
        and all(x == 0 for x in matrices["gyroscopic"].entries())
        and all(s == (quarter and j % 2) for j, s, _ in waves)
    )
    J = None
    if free and symmetric:
        lower = T * slow
        corner = (T.transpose() * matrices["mass"] * lower).tolist()
        turned = (lower.transpose() * matrices["gyroscopic"] * lower * -1).tolist()
        back = (arb_mat(corner).transpose() * -1).tolist()
        J = arb_mat(
            [a + b for a, b in zip(zero, corner, strict=True)] + [a + b for a, b in zip(back, turned, strict=True)]
        )
    d, boxes = int(get["degree"].flat[0]), [tuple(map(Fraction, get["left"][r].flat)) for r in range(len(get["left"]))]
    firsts = [list(get[name].flat) for name in ("first_leaf", "first_sign", "first_coef")]
    ends = (len(get["leaves"]), len(get["signs"]), len(get["coef"]))
    for one, count, end in zip(firsts, (len(get["patches"]), ends[0], ends[1]), ends, strict=True):
        demand(
            one == sorted(one) and len(one) == count + 1 and one[0] == 0 and one[-1] == end, "lists do not fit together"
        )
    for p in range(len(get["patches"])):
        patch = list(get["patches"][p].flat)
        l0, h1, e0, h2 = map(Fraction, patch)
        demand(l0 > h1 > 0 and h2 > 0, "a patch is no rectangle of positive frequencies")
        boxes.append((l0 - h1, l0 + h1, e0 - h2, e0 + h2))
        Phi = monodromy(A, waves, quarter, patch, d + MORE_DEGREES)
        cells = [tuple(map(Fraction, get["leaves"][k].flat)) for k in range(firsts[0][p], firsts[0][p + 1])]
        demand(tiled(cells, Fraction(0), Fraction(1), Fraction(0), Fraction(1)), "cells do not cover their patch")
        for k in range(firsts[0][p], firsts[0][p + 1]):
            listed = {}
            for s in range(firsts[1][k], firsts[1][k + 1]):
                cluster, number, degree = get["signs"][s].flat
                coef = list(get["coef"].flat[firsts[2][s] : firsts[2][s + 1]])
                demand(
                    len(coef) == size(degree) and (cluster, number) not in listed,
                    "a sign is not as long as it should be",
                )
                listed[cluster, number] = ([arb_mat([[arb(x)]]) for x in coef], get["sign_radius"][s])
            if listed or get["whole"][k]:
                P = moved(Phi, *get["leaves"][k].flat)
                tops = [total([moduli(X) for X in P[size(t) :]], A).entries() for t in range(d + MORE_DEGREES + 1)]
                least = next(t for t, top in enumerate(tops) if t and all(abs(x) < CUT for x in top))
                sizes = [m for m in get["sizes"][k].flat if m]
                cell(cut(P, least), get["basis"][k].mat(), sizes, listed, get["whole"][k], J, reversible)
    low, high, bottom, top = map(Fraction, window)
    demand(0 < low < high and bottom < top, "the window is empty")
    demand(covered(boxes, 1 / high, 1 / low, bottom, top), "patches do not cover the window")


def waves_of(matrices: dict[str, Any]) -> list[tuple[int, bool, arb_mat]]:
    return list(matrices["waves"])


def check(path: str) -> str:
    """Return "" if the certificate is right, else what is wrong with it."""
    try:
        with ctx.workprec(BALL_BITS):
            arrays = read(path)
            demand(arrays["digest"].flat[0] == digest(arrays), "the file was changed")
            about, window = json.loads(arrays["about"].flat[0]), list(arrays["window"].flat)
            demand(about["constant"] == "stable", "subsystems without excitation are checked as stable ones alone")
            left = set(range(len(arrays["mass"])))
            groups = [list(arrays[f"coordinates_{i}"].flat) for i in range(about["parts"])]
            for group in groups:
                demand(group == sorted(set(group)) and left >= set(group), "subsystems share coordinates")
                left -= set(group)
            everything = [arrays[name] for name in MATRICES[:4]] + [
                arrays[name][j] for name in MATRICES[4:] for j in range(len(arrays[name]))
            ]
            for X in everything:
                for group in [*groups, sorted(left)]:
                    others = [q for q in range(len(X)) if q not in group]
                    demand(not any(X[p][q] or X[q][p] for p in group for q in others), "subsystems are coupled")
            for i, group in enumerate([*groups, sorted(left)]):
                some: dict[str, Any] = {
                    name: arb_mat([[arrays[name][p][q] for q in group] for p in group]) for name in MATRICES[:4]
                }
                some["waves"] = [
                    (j + 1, name == "sine", X)
                    for j in range(len(arrays["cosine"]))
                    for name in MATRICES[4:]
                    for X in [arb_mat([[arrays[name][j][p][q] for q in group] for p in group])]
                    if any(x != 0 for x in X.entries())
                ]
                G, C, K, M = some["gyroscopic"], some["damping"], some["stiffness"], some["mass"]
                demand(
                    G.transpose() * -1 == G and C.transpose() == C and M.transpose() == M, "matrices are not symmetric"
                )
                if i < len(groups):
                    subsystem(arrays, i, some, window)
                elif group:  # free motion that cannot gain energy
                    energies = definite(M) and definite(K) and K.transpose() == K and not some["waves"]
                    demand(
                        energies
                        and all(
                            C[p, p] >= sum((abs(C[p, q]) for q in range(len(group)) if q != p), arb(0))
                            for p in range(len(group))
                        ),
                        "free motion is not seen to be stable",
                    )
    except (
        Refused,
        StopIteration,
        KeyError,
        ValueError,
        TypeError,
        IndexError,
        ZeroDivisionError,
        OverflowError,
        struct.error,
        zipfile.BadZipFile,
        OSError,
    ) as error:
        return f"{type(error).__name__}: {error}"
    return ""
