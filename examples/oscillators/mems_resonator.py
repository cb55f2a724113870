"""An electrostatic resonator: the voltage that pulls at it takes stiffness away, at once and twice its frequency.

Source: K. L. Turner and others, Nature 396 (1998) 149, for such a device. Numbers: computed by another integrator
(DOP853 with fixed steps, edges to 4e-12), for a scaled model.
"""

import floquet_charts as fc


def system(a=0.1, damping=0.004):
    """Return x'' + 0.004 x' + (1 - a (1 + eps cos Omega t)^2) x = 0."""
    square = [
        fc.Term("stiffness", [[-a / 2]], fc.waveforms.constant(), power=2),
        fc.Term("stiffness", [[-a / 2]], fc.waveforms.cosine(2), power=2),
    ]
    return fc.PeriodicSystem([[1.0]], damping=[[damping]], stiffness=[[1 - a]], cosine=[[[-2 * a]]], terms=square)


def numbers():
    trace = fc.trace_boundary(system(), near=1.9, eps=[0.6, 1.0])
    return [
        ("eps = 0.6: lower edge of 2w1", 1.8142144717894444, trace.lower[0]),
        ("eps = 0.6: upper edge of 2w1", 1.941359812930015, trace.upper[0]),
        ("eps = 1: lower edge of 2w1", 1.7351972181776385, trace.lower[1]),
        ("eps = 1: upper edge of 2w1", 1.9500548505796524, trace.upper[1]),
    ]


def chart():
    return fc.stability_chart(system(), (0.6, 2.2), (0.0, 1.0), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("mems_resonator.png")
