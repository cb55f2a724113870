"""A column under a load that pulsates: Euler's case, with Bolotin's region of instability.

Source: V. V. Bolotin, The Dynamic Stability of Elastic Systems, 1964, chapter 1. Numbers: exact, characteristic
values of Mathieu's equation, as each sine is a mode by itself.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

import floquet_charts as fc


def system(steady=0.3, pulsating=0.4, modes=3):
    """Return a column with hinged ends; loads are parts of Euler's, eps multiplies the pulsating one."""
    k = np.pi * np.arange(1, modes + 1)  # lengths in units of the column, time in units of sqrt(rho A / (E I))
    euler = np.pi**2
    return fc.PeriodicSystem(
        np.eye(modes), stiffness=np.diag(k**4 - steady * euler * k**2), cosine=[np.diag(-pulsating * euler * k**2)]
    )


def exact(function, order, mode, steady=0.3, pulsating=0.4):
    """Return the frequency at which x'' + w^2 (1 - 2 mu cos Omega t) x = 0 has a characteristic value."""
    k = mode * np.pi
    square, push = k**4 - steady * np.pi**2 * k**2, pulsating * np.pi**2 * k**2

    def miss(Omega):
        return function(order, 2 * push / Omega**2) - 4 * square / Omega**2

    w = np.sqrt(square)
    return brentq(miss, 1.4 * w, 2.6 * w, xtol=1e-12)


def numbers():
    found = []
    for mode in (1, 2):
        w = np.sqrt(system().stiffness[mode - 1, mode - 1])
        trace = fc.trace_boundary(system(), near=2 * w, eps=[1.0], p=mode, q=mode)
        edges = sorted(exact(function, 1, mode) for function in (mathieu_a, mathieu_b))
        found += [
            (f"2w{mode}: lower edge", edges[0], trace.lower[0]),
            (f"2w{mode}: upper edge", edges[1], trace.upper[0]),
        ]
    return found


def chart():
    return fc.stability_chart(system(), (5.0, 100.0), (0.0, 1.5), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("column.png")
