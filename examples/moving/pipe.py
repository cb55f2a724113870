"""A pipe with a pulsating flow.

Source: M. P. Païdoussis and N. T. Issid, Journal of Sound and Vibration 33 (1974) 267, for the equation. Numbers: a
pipe with hinged ends buckles at the flow pi, exactly; edges computed by another integrator (DOP853 with fixed steps,
checked by SciPy's), to 3e-11.
"""

import numpy as np
from scipy.optimize import brentq

import floquet_charts as fc


class Pipe:
    """Hinged ends, flow u (1 + eps cos Omega t), beta the part of the fluid in the mass; in sines."""

    def __init__(self, u=2.0, beta=0.5, terms=4):
        self.u, self.beta, self.terms = u, beta, terms

    def at(self, Omega):
        n = np.arange(1, self.terms + 1)
        k, root, u = n * np.pi, np.sqrt(self.beta), self.u
        with np.errstate(divide="ignore"):
            slope = np.where((n[:, None] + n) % 2 == 1, 4 * n[:, None] * n / (n[:, None] ** 2 - n**2 + 0.0), 0.0)
        square = np.diag(k**2)
        x, weights = (np.polynomial.legendre.leggauss(60) + np.array([[1.0], [0.0]])) / 2  # from -1..1 to 0..1
        waves = np.sqrt(2) * np.sin(np.outer(k, x))
        leaning = -np.einsum("x,x,ix,jx->ij", weights, 1 - x, waves, waves) * k**2
        constant, first, second = fc.waveforms.constant(), fc.waveforms.cosine(), fc.waveforms.cosine(2)
        return fc.PeriodicSystem(
            np.eye(self.terms),
            gyroscopic=2 * root * u * slope,
            stiffness=np.diag(k**4) - u**2 * square,
            terms=[
                fc.Term("gyroscopic", 2 * root * u * slope, first),
                fc.Term("stiffness", -2 * u**2 * square, first),
                fc.Term("stiffness", -(u**2) / 2 * square, constant, power=2),
                fc.Term("stiffness", -(u**2) / 2 * square, second, power=2),
                fc.Term("stiffness", -Omega * root * u * leaning, fc.waveforms.sine()),
            ],
        )


def numbers():
    trace = fc.trace_boundary(Pipe(), near=14.9, eps=[0.1])
    buckles = brentq(lambda u: np.linalg.eigvalsh(Pipe(u).at(1.0).stiffness)[0], 2.0, 4.0, xtol=1e-14)
    return [
        ("flow at which it buckles", np.pi, buckles),
        ("eps = 0.1: lower edge of 2w1", 14.09335066555602, trace.lower[0]),
        ("eps = 0.1: upper edge of 2w1", 15.699131635508028, trace.upper[0]),
    ]


def chart():
    return fc.stability_chart(Pipe(), (10.0, 50.0), (0.0, 0.5), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("pipe.png")
