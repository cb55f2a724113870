"""Flapping of a helicopter's blade in fast forward flight; eps is the advance ratio.

Source: W. Johnson, Helicopter Theory, 1980, chapter 12, without reversed flow. Numbers: exact in hover; computed by
another integrator (DOP853 with fixed steps, checked by SciPy's) in flight, growth rates to 2e-13.
"""

import numpy as np

import floquet_charts as fc


def system(gamma=12.0):
    """Return the flapping blade of Lock number gamma; take it at Omega = 1, where time is the azimuth."""
    return fc.examples.blade_flap(gamma)


def numbers():
    expected = {0.5: -0.49668687573779985, 1.0: -0.75, 1.5: 0.09061360827909941, 2.5: 0.9805073919396903}
    hover = fc.monodromy(system(6.0), 1.0, 0.0).growth_rate
    return [("hover, gamma = 6: growth rate", -6.0 / 16, hover)] + [
        (f"advance ratio {mu}: growth rate", value, fc.monodromy(system(), 1.0, mu).growth_rate)
        for mu, value in expected.items()
    ]


def chart():
    """Return growth over the flapping frequency, by the turns, and the advance ratio."""
    return fc.stability_chart(system(), np.linspace(0.5, 2.0, 121), np.linspace(0.0, 2.5, 61), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("blade_flap.png")
