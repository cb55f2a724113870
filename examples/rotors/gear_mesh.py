"""A geared pair whose mesh is stiff with two teeth in contact and soft with one: a rectangular wave of stiffness.

Source: G. W. Blankenship and A. Kahraman, Journal of Sound and Vibration 185 (1995) 743, for such gears. Numbers:
exact to 5e-12, from products of two matrix exponentials.
"""

import numpy as np

import floquet_charts as fc


def system(contact=0.6, mesh=2.0, shaft=1.0):
    """Return two gears of inertia 1 on their shafts, with two teeth in contact for a part of the period."""
    teeth = np.array([1.0, -0.7])
    pair = np.outer(teeth, teeth)
    stiffness = np.diag([shaft, shaft / 2]) + mesh * pair
    low = -contact / (1 - contact)  # a wave without mean: 1 with two teeth in contact, this with one
    wave = fc.Term("stiffness", mesh * (1 - low) / 2 * pair, fc.waveforms.rectangular(duty=contact))
    mean = fc.Term("stiffness", mesh * (1 + low) / 2 * pair, fc.waveforms.constant())
    return fc.PeriodicSystem(np.eye(2), damping=0.01 * stiffness, stiffness=stiffness, terms=[wave, mean])


def numbers():
    slow, fast = np.sqrt(np.linalg.eigvalsh(system().stiffness))
    main = fc.trace_boundary(system(), near=2 * fast, eps=[0.3])
    both = fc.trace_boundary(system(), near=slow + fast, eps=[0.3])
    return [
        ("eps = 0.3: lower edge of 2w2", 3.5759744348498157, main.lower[0]),
        ("eps = 0.3: upper edge of 2w2", 4.246694280912166, main.upper[0]),
        ("eps = 0.3: lower edge of w1+w2", 2.689057958919528, both.lower[0]),
        ("eps = 0.3: upper edge of w1+w2", 2.7853638516755925, both.upper[0]),
    ]


def chart():
    return fc.stability_chart(system(), (0.9, 4.6), (0.0, 0.6), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("gear_mesh.png")
