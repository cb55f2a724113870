"""A string that runs between two eyes, such as a thread or a belt, with a pulsating tension.

Source: C. D. Mote, Journal of the Franklin Institute 279 (1965) 430. Numbers: exact, the frequencies of a string of
speed v are n pi (1 - v^2); the more sines, the nearer to them.
"""

import numpy as np

import floquet_charts as fc


def system(terms=160, speed=0.3):
    """Return the string; speed is a part of that of waves, eps the pulsating part of the tension."""
    return fc.MovingBeam(speed, flexural_rigidity=0.0, terms=terms, speed_amplitude=0.0, tension_amplitude=1.0)


def numbers():
    frequencies = fc.gyroscopic_modes(system().at(1.0)).frequencies
    return [(f"frequency {n}", n * np.pi * (1 - 0.3**2), frequencies[n - 1]) for n in (1, 2, 3)]


def chart():
    return fc.stability_chart(system(terms=8), (4.0, 20.0), (0.0, 0.6), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("string.png")
