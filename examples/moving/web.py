"""A web, such as paper in a press: a moving plate under tension, whose speed pulsates.

Source: T. H. Young, S. J. Huang and Y. S. Chiu, Dynamic Stability of Axially Moving Viscoelastic Plates under Non-
Uniform In-Plane Edge Excitations, for the plate. Numbers: computed by another integrator (DOP853 with fixed steps,
checked by SciPy's), edges to 4e-11, with three sines along and four polynomials across.
"""

import floquet_charts as fc


def system():
    """Return a square web with speed 3, tension 10 and little damping, all dimensionless."""
    return fc.MovingPlate(
        speed=3.0, tension=10.0, damping=0.001, speed_amplitude=1.0, load_amplitude=0.0, axial_terms=3, lateral_terms=4
    )


def numbers():
    trace = fc.trace_boundary(system(), near=18.76, eps=[0.1, 0.2])
    return [
        ("eps = 0.1: lower edge of 2w1", 17.93876076189562, trace.lower[0]),
        ("eps = 0.1: upper edge of 2w1", 19.45367694063758, trace.upper[0]),
        ("eps = 0.2: lower edge of 2w1", 17.00955891141917, trace.lower[1]),
        ("eps = 0.2: upper edge of 2w1", 20.01519704974475, trace.upper[1]),
    ]


def chart():
    return fc.stability_chart(system(), (10.0, 60.0), (0.0, 0.4), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("web.png")
