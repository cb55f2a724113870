"""Mathieu's equation, x'' + (a - 2 q cos 2t) x = 0.

Source: M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964, table 20.1: characteristic values.
"""

import numpy as np
from scipy.optimize import brentq

import floquet_charts as fc


def system(a=1.0):
    """Return the equation; take it at Omega = 2, where eps is q."""
    return fc.PeriodicSystem([[1.0]], stiffness=[[a]], cosine=[[[-2.0]]])


def edge(trace, q, low, high):
    """Return the a between low and high at which both multipliers are +1 (trace 2) or -1 (trace -2)."""
    return brentq(lambda a: np.trace(fc.monodromy(system(a), 2.0, q).matrix) - trace, low, high, xtol=1e-13)


def numbers():
    return [
        ("a_0 at q = 5", "-5.80004602", edge(2.0, 5.0, -6.0, -5.795)),
        ("b_1 at q = 5", "-5.79008060", edge(-2.0, 5.0, -5.795, -5.0)),
        ("a_1 at q = 5", "1.85818754", edge(-2.0, 5.0, 1.0, 2.0)),
        ("b_2 at q = 5", "2.09946045", edge(2.0, 5.0, 2.0, 2.5)),
        ("a_2 at q = 5", "7.44910974", edge(2.0, 5.0, 6.0, 8.0)),
    ]


def chart():
    """Return the chart of a = 1 over the frequency, where the regions at 2 and 1 open."""
    return fc.stability_chart(fc.examples.mathieu(), (0.6, 2.6), (0.0, 0.8), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("mathieu.png")
