"""Beck's column: a cantilever whose load follows its end, and pulsates. It flutters, it does not buckle.

Source: M. Beck, Zeitschrift für angewandte Mathematik und Physik 3 (1952) 225: the load is 20.05 E I / l^2.
"""

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from scipy.optimize import bisect

import floquet_charts as fc


def system(load=15.0, terms=7, damping=0.0):
    """Return the column in polynomials; eps is the pulsating part of the load."""
    x = Polynomial([0.0, 1.0])
    shapes = [x**2 * Legendre.basis(k, domain=[0, 1]).convert(kind=Polynomial) for k in range(terms)]

    def gram(order):
        parts = [shape.deriv(order) if order else shape for shape in shapes]
        return np.array([[(one * other).integ()(1.0) for other in parts] for one in parts])

    ends = np.outer([shape(1.0) for shape in shapes], [shape.deriv()(1.0) for shape in shapes])
    mass, bending, push = gram(0), gram(2), gram(1) - ends  # the load follows the slope at the end
    return fc.PeriodicSystem(mass, damping=damping * mass, stiffness=bending - load * push, cosine=[-load * push])


def numbers():
    def flutters(load):
        return 1.0 if fc.monodromy(system(load), 10.0, 0.0).growth_rate > 1e-3 else -1.0

    return [("load at which it flutters", "20.05", bisect(flutters, 15.0, 25.0, xtol=1e-7))]


def chart():
    return fc.stability_chart(system(damping=0.2), (4.0, 30.0), (0.0, 0.6), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("beck_column.png")
