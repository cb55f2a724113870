"""A square plate with hinged edges under a pulsating load along one side: modes (1,2) and (2,1) have one frequency.

Source: V. V. Bolotin, The Dynamic Stability of Elastic Systems, 1964, on plates. Numbers: computed by another method
(characteristic values of Mathieu's equation, to 1e-11).
"""

import numpy as np

import floquet_charts as fc

WAVES = np.array([(1, 1), (1, 2), (2, 1), (2, 2)])  # half waves along x and y


def system():
    """Return the four lowest modes; eps is the pulsating load, 1 for 0.3 of the buckling load of mode (1, 1)."""
    m, n = WAVES.T
    load = -0.3 * np.pi**4 * 4
    return fc.PeriodicSystem(
        np.eye(4), stiffness=np.diag(np.pi**4 * (m**2 + n**2) ** 2.0), cosine=[np.diag(load * m**2)]
    )


def numbers():
    first = fc.trace_boundary(system(), near=4 * np.pi**2, eps=[0.4])
    twins = fc.trace_boundary(system(), near=10 * np.pi**2, eps=[0.4])
    return [
        ("eps = 0.4: lower edge of 2w(1,1)", 38.28556413282786, first.lower[0]),
        ("eps = 0.4: upper edge of 2w(1,1)", 40.6535964122493, first.upper[0]),
        ("eps = 0.4: lower edge of 2w(2,1)", 96.79222228172357, twins.lower[0]),
        ("eps = 0.4: upper edge of 2w(2,1)", 100.5817120080602, twins.upper[0]),
    ]


def chart():
    return fc.stability_chart(system(), (30.0, 110.0), (0.0, 1.0), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("square_plate.png")
