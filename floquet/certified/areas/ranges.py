"""Where polynomials with a radius leave the sign open: at points, on lines, and how much of an area (section 10)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from floquet.certified.areas.models import ROUNDING, SAFE, TINY, gamma, moved_coefficients
from periodic.checks import FloatArray

# A box of a cell is halved until less than this part of the cell can be open in it, or so many boxes were looked at.
NEGLIGIBLE, MANY_BOXES = 1e-8, 2000
# Half-width of an interval of a line that is not halved any more, as a part of the cell's.
NARROWEST = 2.0**-40
# Verdicts as numbers.
OPEN, STABLE, UNSTABLE = 0, 1, 2


@njit(cache=True, nogil=True)
def open_part(coef: FloatArray, degree: int, radius: float) -> float:
    """Bound of the part of the cell in which |g| <= radius.

    In a box in which |g| > radius everywhere that is nothing. If g has a slope of at least a in one variable, |g| <=
    radius on at most 2 radius / a of every line; if its second derivative is at least b, on at most 4 sqrt(radius / b).
    """
    most = np.abs(coef).sum()
    radius = (radius + gamma(12 * degree + len(coef) + 8) * most) * SAFE + TINY
    slack = degree * degree * gamma(12 * degree + 8) * most
    boxes = [(0.0, 1.0, 0.0, 1.0)]
    total = 0.0
    seen = 0
    while seen < len(boxes):
        x, hx, y, hy = boxes[seen]
        seen += 1
        c = moved_coefficients(coef.reshape(-1, 1, 1), degree, x, hx, y, hy).reshape(-1)
        rest, sum_x, sum_y, second_x, second_y = 0.0, 0.0, 0.0, 0.0, 0.0
        for t in range(1, degree + 1):
            for k in range(t + 1):
                j, one = t - k, abs(c[t * (t + 1) // 2 + k])
                rest += one
                sum_x += j * one
                sum_y += k * one
                second_x += j * (j - 1) * one
                second_y += k * (k - 1) * one
        if abs(c[0]) > (rest + radius) * SAFE:
            continue
        # of lines with the length 2; where the slope is nearly the same everywhere, halving would gain nothing
        part, settled = 1.0, False
        for slope, most_slope in (
            (2.0 * abs(c[1]) - sum_x * SAFE - slack, sum_x),
            (2.0 * abs(c[2]) - sum_y * SAFE - slack, sum_y),
        ):
            if slope > 0.0:
                part = min(part, radius / slope)
                settled |= slope > most_slope / 2
        if degree > 1:
            for bend in (4.0 * abs(c[3]) - second_x * SAFE - slack, 4.0 * abs(c[5]) - second_y * SAFE - slack):
                if bend > 0.0:
                    part = min(part, 2.0 * np.sqrt(radius / bend))
        if settled or part * hx * hy <= NEGLIGIBLE or len(boxes) >= MANY_BOXES:
            total += part * hx * hy
        elif sum_x >= sum_y:
            boxes.append((x - hx / 2, hx / 2, y, hy))
            boxes.append((x + hx / 2, hx / 2, y, hy))
        else:
            boxes.append((x, hx, y - hy / 2, hy / 2))
            boxes.append((x, hx, y + hy / 2, hy / 2))
    return min(total * SAFE, 1.0)


@njit(cache=True, nogil=True)
def _side(coef: FloatArray, first: int, degree: int, radius: float, x: float, dx: float, y: float, dy: float) -> int:
    """1 if g > radius at every point within dx, dy of (x, y) in the cell, -1 if g < -radius, else 0."""
    value, most, move = 0.0, 0.0, 0.0
    at = first
    for t in range(degree + 1):
        for k in range(t + 1):
            size = abs(coef[at])
            term = coef[at]
            for _ in range(t - k):
                term *= x
            for _ in range(k):
                term *= y
            value += term
            most += size
            move += size * ((t - k) * dx + k * dy)
            at += 1
    error = (radius + move + gamma(degree + (at - first) + 4) * most) * SAFE + TINY
    if value > error:
        return 1
    return -1 if value < -error else 0


@njit(cache=True, nogil=True)
def verdicts_at(
    Omega: FloatArray,
    eps: FloatArray,
    patches: FloatArray,
    first_leaf: Any,
    leaves: FloatArray,
    whole: Any,
    first_sign: Any,
    coef: FloatArray,
    first_coef: Any,
    degrees: Any,
    radii: FloatArray,
) -> Any:
    """Verdicts at points.

    A point next to a border may belong to either cell: all of them have to say the same. ``patches`` has rows l0, h1,
    e0, h2, and ``leaves`` x0, hx, y0, hy.
    """
    out = np.zeros(len(Omega), dtype=np.int8)
    for p in range(len(Omega)):
        found = -1
        z = 1.0 / Omega[p]
        for i in range(len(patches)):
            l0, h1, e0, h2 = patches[i]
            xi, eta = (z - l0) / h1, (eps[p] - e0) / h2
            error_x = 16 * ROUNDING * (z / h1 + 2.0)
            error_y = 16 * ROUNDING * (abs(eps[p]) / h2 + 2.0)
            if abs(xi) > 1.0 + error_x or abs(eta) > 1.0 + error_y:
                continue
            for leaf in range(first_leaf[i], first_leaf[i + 1]):
                x0, hx, y0, hy = leaves[leaf]
                x, y = (xi - x0) / hx, (eta - y0) / hy
                dx, dy = error_x / hx, error_y / hy
                if abs(x) > 1.0 + dx or abs(y) > 1.0 + dy:
                    continue
                x, y = min(max(x, -1.0), 1.0), min(max(y, -1.0), 1.0)
                here = STABLE if whole[leaf] else OPEN
                for s in range(first_sign[leaf], first_sign[leaf + 1]):
                    side = _side(coef, first_coef[s], degrees[s], radii[s], x, dx, y, dy)
                    if side < 0:
                        here = UNSTABLE
                        break
                    if side == 0:
                        here = OPEN
                if found >= 0 and found != here:
                    here = OPEN
                found = here
        out[p] = max(found, 0)
    return out


@njit(cache=True, nogil=True)
def open_on_line(
    coef: FloatArray, first_coef: Any, degrees: Any, radii: FloatArray, whole: bool, y: float, dy: float
) -> list[tuple[float, float]]:
    """Intervals of x in [-1, 1] that contain everything that is open at one y, known to dy; touching ones are joined.

    An interval is halved unless all signs are decided in it, or one is nowhere decided.
    """
    found = [(0.0, 0.0) for _ in range(0)]
    stack = [(0.0, 1.0)]
    while len(stack) > 0:
        x, h = stack.pop()
        stable, unstable, hopeless = whole, False, h <= NARROWEST
        positive = True
        for s in range(len(degrees)):
            value, error, radius = _on_line(coef, first_coef[s], degrees[s], radii[s], x, h, y, dy)
            unstable |= value < -(error + radius) * SAFE
            stable &= value > (error + radius) * SAFE
            positive &= value > error
            hopeless |= abs(value) + error <= radius
        if stable or unstable:
            continue
        if hopeless or (positive and not whole):
            if len(found) > 0 and x - h <= found[-1][1]:
                found[-1] = (found[-1][0], x + h)
            else:
                found.append((x - h, x + h))
            continue
        stack.append((x + h / 2, h / 2))
        stack.append((x - h / 2, h / 2))
    return found


@njit(cache=True, nogil=True)
def _on_line(
    coef: FloatArray, first: int, degree: int, radius: float, x: float, h: float, y: float, dy: float
) -> tuple[float, float, float]:
    """The polynomial at x, by how much it may differ within h of x and dy of y, and the radius."""
    line = np.zeros(degree + 1)
    most, move = 0.0, 0.0
    for t in range(degree + 1):
        for k in range(t + 1):
            term = coef[first + t * (t + 1) // 2 + k]
            most += abs(term)
            move += abs(term) * k * dy
            for _ in range(k):
                term *= y
            line[t - k] += term
    for i in range(degree):
        for j in range(degree - 1, i - 1, -1):
            line[j] += x * line[j + 1]
    rest = 0.0
    power = 1.0
    for j in range(1, degree + 1):
        power *= h
        rest += abs(line[j]) * power
    return line[0], (rest + move + gamma(12 * degree + 60) * most) * SAFE + TINY, radius
