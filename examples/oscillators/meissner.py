"""Meissner's equation: a spring that is stiff for half of the period and soft for the other half.

Source: E. Meissner, Schweizerische Bauzeitung 72 (1918) 95. Numbers: exact, from two pieces of constant stiffness.
"""

from math import cos, pi, sin, sqrt

from scipy.optimize import brentq

import floquet_charts as fc


def system():
    """Return x'' + (1 + eps r(t)) x = 0, where r is 1 for half of the period and -1 for the other half."""
    return fc.PeriodicSystem(
        [[1.0]], stiffness=[[1.0]], terms=[fc.Term("stiffness", [[1.0]], fc.waveforms.rectangular(duty=0.5))]
    )


def exact_trace(Omega, eps):
    """Return the trace of the monodromy matrix."""
    stiff, soft, half = sqrt(1 + eps), sqrt(1 - eps), pi / Omega
    ratio = (stiff / soft + soft / stiff) / 2
    return 2 * cos(stiff * half) * cos(soft * half) - 2 * ratio * sin(stiff * half) * sin(soft * half)


def numbers():
    main = fc.trace_boundary(system(), near=2.0, eps=[0.3])
    second = fc.trace_boundary(system(), near=1.0, eps=[0.3])
    return [
        ("region 2w1, lower edge", brentq(lambda w: exact_trace(w, 0.3) + 2, 1.7, 1.9, xtol=1e-14), main.lower[0]),
        ("region 2w1, upper edge", brentq(lambda w: exact_trace(w, 0.3) + 2, 2.1, 2.3, xtol=1e-14), main.upper[0]),
        (
            "region 2w1/2, upper edge",
            brentq(lambda w: exact_trace(w, 0.3) - 2, 1.002, 1.1, xtol=1e-14),
            second.upper[0],
        ),
    ]


def chart():
    return fc.stability_chart(system(), (0.4, 2.6), (0.0, 0.8), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("meissner.png")
