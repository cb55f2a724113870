"""Kapitza's pendulum: it stands on its head if its base shakes fast enough.

Source: L. D. Landau and E. M. Lifshitz, Mechanics, section 30: it stands where eps Omega exceeds the square root of
2, if Omega is large; eps is the amplitude of the base over the length. Exact: characteristic values of Mathieu's
equation.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

import floquet_charts as fc


def system(Omega=20.0):
    """Return x'' + (-1 + eps Omega^2 cos Omega t) x = 0; time is in units of sqrt(length / g)."""
    return fc.PeriodicSystem([[1.0]], stiffness=[[-1.0]], cosine=[[[Omega**2]]])


def end(Omega, trace, low, high):
    """Return the amplitude between low and high at which the multipliers are both +1 (trace 2) or both -1."""
    return brentq(lambda eps: np.trace(fc.monodromy(system(Omega), Omega, eps).matrix) - trace, low, high, xtol=1e-15)


def numbers():
    a = -4 / 20.0**2
    lower = brentq(lambda q: mathieu_a(0, q) - a, 0.01, 0.5, xtol=1e-15) / 2
    upper = brentq(lambda q: mathieu_b(1, q) - a, 0.5, 1.2, xtol=1e-15) / 2
    return [
        ("Omega = 1000: eps Omega", "1.414", 1000 * end(1000.0, 2.0, 1e-3, 2e-3)),
        ("Omega = 20: stands from eps", lower, end(20.0, 2.0, 0.05, 0.1)),
        ("Omega = 20: stands up to eps", upper, end(20.0, -2.0, 0.4, 0.5)),
    ]


def chart():
    class Pendulum:
        def at(self, Omega):
            return system(Omega)

    return fc.stability_chart(Pendulum(), (2.0, 20.0), (0.0, 0.6), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("kapitza_pendulum.png")
