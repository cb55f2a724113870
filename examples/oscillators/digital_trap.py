"""The digital ion trap, driven by a rectangular wave.

Source: L. Ding and others, Journal of Mass Spectrometry 39 (2004) 471: ions are lost above q = 0.7125 if a = 0.
Exact: q = 2 (s / pi)^2, where cos s cosh s = -1.
"""

import numpy as np
from scipy.optimize import brentq

import floquet_charts as fc


def system(duty=0.5):
    """Return the trap without steady voltage; take it at Omega = 2, where eps is q."""
    return fc.examples.quadrupole_trap(0.0, waveform=fc.waveforms.rectangular(duty=duty))


def numbers():
    def trace(q):
        matrix = fc.monodromy(system(), 2.0, q).matrix  # coordinates x', y', x, y
        return matrix[0, 0] + matrix[2, 2]

    end = brentq(lambda q: trace(q) + 2, 0.5, 0.9, xtol=1e-14)
    s = brentq(lambda s: np.cos(s) * np.cosh(s) + 1, 1.5, 2.0, xtol=1e-15)
    return [("end of stability, q", "0.7125", end), ("end of stability, q, exact", 2 * (s / np.pi) ** 2, end)]


def chart():
    return fc.stability_chart(system(0.54), (1.2, 3.0), (0.0, 1.2), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("digital_trap.png")
