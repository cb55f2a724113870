"""A two-bladed propeller on a pylon that pitches and yaws: its inertia changes twice a turn.

Source: W. Johnson, Helicopter Theory, 1980, chapter 12, for such rotors. Numbers: computed by another integrator
(DOP853 with fixed steps, checked by SciPy's), growth rates to 2e-13.
"""

import numpy as np

import floquet_charts as fc


class Propeller:
    """Pitch and yaw; ``J`` is the inertia of the blades, of which eps is the part that two blades make uneven."""

    def __init__(self, pylon=1.0, J=0.6, spin=0.5, damping=0.02, springs=(1.0, 1.3), air=0.01):
        self.pylon, self.J, self.spin, self.damping, self.springs, self.air = pylon, J, spin, damping, springs, air

    def at(self, Omega):
        plus, cross, turn = (
            np.diag([1.0, -1.0]),
            np.array([[0.0, 1.0], [1.0, 0.0]]),
            np.array([[0.0, 1.0], [-1.0, 0.0]]),
        )
        J, air = self.J, self.air * Omega**2
        cosine, sine = fc.waveforms.cosine(2), fc.waveforms.sine(2)
        return fc.PeriodicSystem(
            np.eye(2) * (self.pylon + J / 2),
            gyroscopic=self.spin * Omega * turn,
            damping=self.damping * np.eye(2),
            stiffness=np.diag(self.springs) + air * turn,
            terms=[
                fc.Term("mass", -J / 2 * plus, cosine),
                fc.Term("mass", -J / 2 * cross, sine),
                fc.Term("damping", J * Omega * plus, sine),
                fc.Term("damping", -J * Omega * cross, cosine),
                fc.Term("stiffness", air * cross, cosine),
                fc.Term("stiffness", -air * plus, sine),
            ],
        )


def numbers():
    expected = {(0.6, 1.0): -0.007359071844823104, (1.3, 0.7): 0.11034081431473035, (2.4, 0.5): 0.009926385788726648}
    return [
        (f"growth rate at Omega = {Omega}, eps = {eps}", value, fc.monodromy(Propeller(), Omega, eps).growth_rate)
        for (Omega, eps), value in expected.items()
    ]


def chart():
    return fc.stability_chart(Propeller(), np.linspace(0.5, 2.5, 81), np.linspace(0.0, 1.0, 41), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("two_bladed_whirl.png")
