"""Parametric roll of a ship in head seas: waves change the metacentric height, the ship rolls at half their frequency.

Source: W. N. France and others, Marine Technology 40 (2003) 1, for the mechanism. Numbers: the classical threshold h
= 4 zeta of first-order theory; computed by SciPy's DOP853.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import floquet_charts as fc

ZETA = 0.05  # damping ratio of roll


def system(zeta=ZETA):
    """Return x'' + 2 zeta x' + (1 + h cos Omega t) x = 0: time in units of the roll period over 2 pi, eps is h."""
    return fc.PeriodicSystem([[1.0]], damping=[[2 * zeta]], stiffness=[[1.0]], cosine=[[[1.0]]])


def growth_by_dop853(Omega, h):
    """Return the growth rate, by another program."""
    period = 2 * np.pi / Omega

    def motion(t, z):
        x, v = z.reshape(2, 2)
        return np.concatenate([v, -2 * ZETA * v - (1 + h * np.cos(Omega * t)) * x])

    end = solve_ivp(motion, (0, period), [1.0, 0.0, 0.0, 1.0], method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    return np.log(np.abs(np.linalg.eigvals(end.reshape(2, 2))).max()) / period


def numbers():
    (curve,) = fc.transition_curves(system(), (1.5, 2.5))
    trace = fc.trace_boundary(system(), near=2.0, eps=[0.3])
    return [
        ("waves that make it roll, h, by theory", 4 * ZETA, curve.tip),
        ("h = 0.3: from Omega", brentq(growth_by_dop853, 1.7, 1.95, args=(0.3,), xtol=1e-12), trace.lower[0]),
        ("h = 0.3: up to Omega", brentq(growth_by_dop853, 2.05, 2.3, args=(0.3,), xtol=1e-12), trace.upper[0]),
    ]


def chart():
    return fc.stability_chart(system(), (0.6, 2.6), (0.0, 0.8), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("ship_roll.png")
