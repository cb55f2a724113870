"""Anti-resonance: a spring that pulsates at a difference of two frequencies quenches a self-excited vibration.

Source: A. Tondl, Acta Technica CSAV 43 (1998) 109, for the effect. Numbers: computed by SciPy's DOP853.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import floquet_charts as fc

MASS, DAMPING = np.diag([1.0, 0.5]), np.array([[0.0, -0.06], [-0.06, 0.06]])
STIFFNESS, SPRING = np.array([[1.6, -0.6], [-0.6, 0.6]]), np.diag([1.0, 0.0])


def system():
    """Return two masses, one of which is self-excited, on a spring that pulsates."""
    return fc.PeriodicSystem(MASS, damping=DAMPING, stiffness=STIFFNESS, cosine=[SPRING])


def growth_by_dop853(Omega, eps):
    """Return the growth rate, by another program."""
    period = 2 * np.pi / Omega

    def motion(t, z):
        x, v = z.reshape(2, 2, 4)
        force = DAMPING @ v + (STIFFNESS + eps * np.cos(Omega * t) * SPRING) @ x
        return np.concatenate([v, -np.linalg.solve(MASS, force)]).ravel()

    end = solve_ivp(motion, (0, period), np.eye(4).ravel(), method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return np.log(np.abs(np.linalg.eigvals(end.reshape(4, 4))).max()) / period


def numbers():
    trace = fc.trace_boundary(system(), near=0.7752, eps=[0.3], type="difference")
    low, high = trace.lower[0], trace.upper[0]  # a window in which it is stable
    return [
        ("eps = 0.3: quenched from Omega", brentq(growth_by_dop853, low - 0.01, low + 0.01, (0.3,), 1e-11), low),
        ("eps = 0.3: quenched up to Omega", brentq(growth_by_dop853, high - 0.01, high + 0.01, (0.3,), 1e-11), high),
    ]


def chart():
    return fc.stability_chart(system(), (0.4, 1.2), (0.0, 0.6), progress=False)


if __name__ == "__main__":
    for what, reference, found in numbers():
        print(f"{what}: {found:.10g} here, {reference} there")
    fc.plot(chart()).savefig("antiresonance.png")
