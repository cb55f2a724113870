"""The quadrupole mass filter: ions that stay between four rods.

Source: W. Paul, Reviews of Modern Physics 62 (1990) 531: the apex of the first region of stability, and its end at a
= 0.
"""

import numpy as np
from scipy.optimize import brentq, root

import floquet_charts as fc


def traces(a, q):
    """Return the traces of the monodromy matrices of x'' + (a + 2 q cos 2t) x = 0 and y'' - (a + 2 q cos 2t) y = 0."""
    matrix = fc.monodromy(fc.examples.quadrupole_trap(a), 2.0, q).matrix  # coordinates x', y', x, y
    return matrix[0, 0] + matrix[2, 2], matrix[1, 1] + matrix[3, 3]


def numbers():
    # In the apex x has two multipliers -1 and y two multipliers +1.
    a, q = root(lambda z: np.subtract(traces(*z), (-2.0, 2.0)), (0.24, 0.7), tol=1e-13).x
    end = brentq(lambda q: traces(0.0, q)[0] + 2, 0.8, 1.0, xtol=1e-13)
    return [("apex, q", "0.706", q), ("apex, a", "0.237", a), ("end at a = 0, q", "0.908", end)]


def chart():
    """Return the chart of a pure radio-frequency trap over the frequency of the voltage."""
    return fc.stability_chart(fc.examples.quadrupole_trap(0.1), (1.2, 3.0), (0.0, 1.2), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("quadrupole_trap.png")
