"""A moving beam, such as a band saw, whose speed pulsates.

Source: L.-Q. Chen and X.-D. Yang, Journal of Sound and Vibration 284 (2005) 879: two natural frequencies. Numbers:
edges computed by another integrator (DOP853 with fixed steps, checked by SciPy's), to 3e-11, with four sines;
frequencies with sixty.
"""

import floquet_charts as fc


def system(terms=4):
    """Return the beam with v_f = 0.8, at the mean speed 2."""
    return fc.MovingBeam(2.0, flexural_rigidity=0.64, terms=terms)


def numbers():
    still = fc.gyroscopic_modes(system(terms=60).at(1.0)).frequencies
    trace = fc.trace_boundary(system(), near=10.74, eps=[0.1])
    return [
        ("frequency 1", "5.3692", still[0]),
        ("frequency 2", "30.1200", still[1]),
        ("eps = 0.1: lower edge of 2w1", 10.064294636338202, trace.lower[0]),
        ("eps = 0.1: upper edge of 2w1", 11.32830885618219, trace.upper[0]),
    ]


def chart():
    return fc.stability_chart(system(), (5.0, 70.0), (0.0, 0.3), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("beam.png")
