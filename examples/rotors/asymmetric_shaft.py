"""A shaft with two different stiffnesses: it is unstable between its two critical speeds.

Source: F. M. Dimentberg, Flexural Vibrations of Rotating Shafts, 1961. Numbers: exact, because the shaft has constant
coefficients in a frame that turns with it: unstable between sqrt(1 - eps) and sqrt(1 + eps).
"""

import numpy as np

import floquet_charts as fc


def system():
    """Return a disc of mass 1 on a shaft of stiffnesses 1 + eps and 1 - eps that turns at Omega, seen from outside."""
    along = fc.Term("stiffness", np.diag([1.0, -1.0]), fc.waveforms.cosine(2))
    across = fc.Term("stiffness", [[0.0, 1.0], [1.0, 0.0]], fc.waveforms.sine(2))
    return fc.PeriodicSystem(np.eye(2), stiffness=np.eye(2), terms=[along, across])


def numbers():
    trace = fc.trace_boundary(system(), near=1.0, eps=[0.1, 0.3])
    return [
        ("eps = 0.1: lower critical speed", np.sqrt(0.9), trace.lower[0]),
        ("eps = 0.1: upper critical speed", np.sqrt(1.1), trace.upper[0]),
        ("eps = 0.3: lower critical speed", np.sqrt(0.7), trace.lower[1]),
        ("eps = 0.3: upper critical speed", np.sqrt(1.3), trace.upper[1]),
    ]


def chart():
    return fc.stability_chart(system(), (0.6, 1.4), (0.0, 0.5), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("asymmetric_shaft.png")
