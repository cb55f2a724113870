"""A ring of six oscillators that are modulated one after the other, as by a wave that runs round it.

Source: N. Swinteck and others, Journal of Applied Physics 118 (2015) 063103, for such chains. Numbers: computed by
another integrator (DOP853 with fixed steps, checked by SciPy's), edges to 2e-11.
"""

import numpy as np

import floquet_charts as fc


def system(coupling=0.3, depth=0.3, damping=0.005, size=6):
    """Return the ring; the spring between i and i + 1 is modulated by cos(Omega t - 2 pi i / 6)."""
    stiffness, parts = np.eye(size), [np.zeros((size, size)), np.zeros((size, size))]
    for i in range(size):
        ends = np.zeros(size)
        ends[i], ends[(i + 1) % size] = 1.0, -1.0
        spring = np.outer(ends, ends)
        stiffness += coupling * spring
        phase = 2 * np.pi * i / size
        parts[0] += depth * np.cos(phase) * spring
        parts[1] += depth * np.sin(phase) * spring
    return fc.PeriodicSystem(
        np.eye(size), damping=damping * np.eye(size), stiffness=stiffness, cosine=[parts[0]], sine=[parts[1]]
    )


def numbers():
    regions = fc.trace_regions(system(), (2.3, 3.2), (0.0, 0.3), progress=False)
    sure = [found for region in regions for found in region.intervals(0.2)]
    traces = [fc.trace_boundary(system(), near=sum(found) / 2, eps=[0.2]) for found in sure]
    edges = [(trace.lower[0], trace.upper[0]) for trace in traces]
    expected = [(2.4773976185670223, 2.5596689201013376), (2.7884800292737317, 2.933499579468558)]
    return [
        (f"eps = 0.2: {side} edge of region {number}", value, found)
        for number, (values, founds) in enumerate(zip(expected, edges, strict=True), 1)
        for side, value, found in zip(("lower", "upper"), values, founds, strict=True)
    ]


def chart():
    return fc.stability_chart(system(), (1.9, 3.2), (0.0, 0.5), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("modulated_chain.png")
