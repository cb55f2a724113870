"""Ground resonance of a helicopter with four blades, one lag damper of which is out: no frame makes it constant.

Source: C. E. Hammond, Journal of the American Helicopter Society 19 (4) (1974) 14, with its data. Numbers: computed
by another integrator (DOP853 with fixed steps, checked by SciPy's), growth rates to 2e-13.
"""

import numpy as np

import floquet_charts as fc

S, INERTIA, LAG_SPRING = 289.1, 1084.7, 88.11768  # of a blade: moment kg m, kg m2, centrifugal spring over Omega^2
HUB_MASS, HUB_DAMPER, HUB_SPRING = (8406.2, 3663.2), (51078.7, 25539.3), 1240481.8  # along x and y


class Helicopter:
    """Four blades that lag and a hub on its landing gear; take it at eps = 1."""

    def __init__(self, dampers=(0.0, 4067.5, 4067.5, 4067.5)):
        self.dampers = dampers

    def at(self, Omega):
        couple = np.zeros((6, 6)), np.zeros((6, 6))  # with cos and sin Omega t: blade i is at Omega t + i pi / 2
        for blade in range(4):
            c, s = np.cos(blade * np.pi / 2), np.sin(blade * np.pi / 2)
            couple[0][4:, blade] = -S * s, S * c
            couple[1][4:, blade] = -S * c, -S * s
        cosine, sine = fc.waveforms.cosine(), fc.waveforms.sine()
        terms = [fc.Term("mass", couple[0] + couple[0].T, cosine), fc.Term("mass", couple[1] + couple[1].T, sine)]
        # the forces of the blades on the hub: the second derivative of what stands in the mass matrix
        terms += _of_velocity(2 * Omega * couple[1], cosine) + _of_velocity(-2 * Omega * couple[0], sine)
        terms += [
            fc.Term("stiffness", -(Omega**2) * couple[0], cosine),
            fc.Term("stiffness", -(Omega**2) * couple[1], sine),
        ]
        return fc.PeriodicSystem(
            np.diag([INERTIA] * 4 + [*HUB_MASS]),
            damping=np.diag([*self.dampers, *HUB_DAMPER]),
            stiffness=np.diag([LAG_SPRING * Omega**2] * 4 + [HUB_SPRING] * 2),
            terms=terms,
        )


def _of_velocity(matrix, waveform):
    """Return the terms of a matrix of W': its symmetric part is damping, its skew part is gyroscopic."""
    return [
        fc.Term("damping", (matrix + matrix.T) / 2, waveform),
        fc.Term("gyroscopic", (matrix - matrix.T) / 2, waveform),
    ]


def numbers():
    turns = {200: -0.08679510953743944, 240: 0.2864482131207375, 260: 0.3207406432088496, 300: 0.0616221368007848}
    whole = Helicopter((4067.5,) * 4)

    def growth(helicopter, rpm):
        return fc.monodromy(helicopter, rpm * np.pi / 30, 1.0).growth_rate

    return [
        *(
            (f"one damper out, {n} rpm: growth per second", value, growth(Helicopter(), n))
            for n, value in turns.items()
        ),
        ("all dampers, 260 rpm: growth per second", -0.35134965488045355, growth(whole, 260)),
    ]


def chart():
    """Return the chart over the turns, rad/s; eps scales all that the blades do to the hub."""
    return fc.stability_chart(Helicopter(), np.linspace(15.0, 45.0, 121), np.linspace(0.0, 1.0, 41), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("ground_resonance.png")
