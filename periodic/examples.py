"""Small systems with known answers: Mathieu, coupled Mathieu, a gyroscopic rotor, Meissner by its Fourier series, a
quadrupole trap, a flapping rotor blade."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, one_of, real_array, real_number, whole_number
from periodic.system import PeriodicSystem
from periodic.terms import Term
from periodic.waveforms import Waveform, cosine, sine

# Harmonics of Meissner's square wave: the matrices of more would fill the memory of a chart.
MAX_MEISSNER_HARMONICS = 1000


def mathieu(delta: float = 1.0, damping: float = 0.0) -> PeriodicSystem:
    """Mathieu's equation, x'' + damping x' + (delta + eps cos Omega t) x = 0.

    Parameters
    ----------
    delta : float
        Mean stiffness, the square of the natural frequency omega; negative values (a Paul trap) are allowed.
    damping : float
        Damping coefficient, >= 0; it multiplies both multipliers by exp(-damping T / 2) and changes delta to
        delta - damping^2 / 4, exactly.

    Returns
    -------
    PeriodicSystem
        n = 1, J = 1.

    Raises
    ------
    ValueError
        If an argument is no finite real number, or damping is negative.

    Notes
    -----
    Undamped, with a = 4 delta / Omega^2 and q = 2 eps / Omega^2, it is the canonical y'' + (a - 2 q cos 2z) y = 0
    (after a shift of time by half a period). The boundaries of the n-th unstable region, near Omega = 2 omega / n, are
    the characteristic values a = a_n(q) and a = b_n(q), ``scipy.special.mathieu_a`` and ``mathieu_b``: DLMF 28.2(v)
    and 28.6, Abramowitz and Stegun section 20.2. The series for a_1 is 1 + q - q^2/8 - q^3/64 - ..., for b_1 the same
    with -q. To first order and with damping the first region is
    Omega = 2 omega ± sqrt((eps / (2 omega))^2 - damping^2); it is closed below eps = 2 omega damping.
    """
    delta = real_number("delta", delta)
    damping = real_number("damping", damping, nonnegative=True)
    return PeriodicSystem([[1.0]], [[0.0]], [[damping]], [[delta]], [[[1.0]]])


def coupled_mathieu(
    type: str = "sum",
    frequencies: ArrayLike = (1.0, 1.7),
    coupling: float = 1.0,
    damping: ArrayLike = (0.0, 0.0),
) -> PeriodicSystem:
    """Two oscillators that only the excitation couples: combination resonance of sum or of difference type.

    x1'' + d1 x1' + omega1^2 x1 + eps b cos(Omega t) x2 = 0,
    x2'' + d2 x2' + omega2^2 x2 + s eps b cos(Omega t) x1 = 0, where s = 1 ("sum") or -1 ("difference").

    Parameters
    ----------
    type : {"sum", "difference"}
        Type of the one first-order region that is open.
    frequencies : array_like, shape (2,)
        omega1, omega2, positive.
    coupling : float
        b.
    damping : array_like, shape (2,)
        d1, d2, >= 0.

    Returns
    -------
    PeriodicSystem
        n = 2, J = 1.

    Raises
    ------
    ValueError
        If an argument has the wrong type, shape or sign, or ``type`` is unknown.

    Notes
    -----
    To first order (Bolotin, The Dynamic Stability of Elastic Systems, 1964; Nayfeh and Mook, Nonlinear Oscillations,
    1979, chapter 5) the region "sum" is Omega = omega1 + omega2 ± eps |b| / (2 sqrt(omega1 omega2)) without damping,
    and Omega = omega1 + omega2 ± (d1 + d2) / 2 sqrt(eps^2 b^2 / (4 omega1 omega2 d1 d2) - 1) with it, which is closed
    below eps = 2 sqrt(d1 d2 omega1 omega2) / |b|; as d1, d2 -> 0 it stays wider than the undamped one by
    (d1 + d2) / (2 sqrt(d1 d2)). "difference" is the same about |omega1 - omega2|. With equal frequencies and damping
    "sum" is exactly two Mathieu equations, for x1 + x2 and x1 - x2.
    """
    one_of("type", type, ("sum", "difference"))
    omega = _pair("frequencies", frequencies)
    if (omega <= 0).any():
        raise ValueError(f"frequencies = {omega.tolist()} must be positive; give two numbers > 0")
    coupling = real_number("coupling", coupling)
    d = _pair("damping", damping)
    if (d < 0).any():
        raise ValueError(f"damping = {d.tolist()} must not be negative; give two numbers >= 0")
    sign = 1.0 if type == "sum" else -1.0
    return PeriodicSystem(
        mass=np.eye(2),
        gyroscopic=np.zeros((2, 2)),
        damping=np.diag(d),
        stiffness=np.diag(omega**2),
        cosine=[[[0.0, coupling], [sign * coupling, 0.0]]],
    )


def gyroscopic_rotor(stiffness: ArrayLike = (4.0, 4.0), spin: float = 0.5, damping: float = 0.0) -> PeriodicSystem:
    """Disc on a rotating massless shaft under a pulsating axial force, in axes that rotate with the shaft.

    x'' - 2 s y' + d x' + (k1 - s^2 + eps cos Omega t) x = 0,
    y'' + 2 s x' + d y' + (k2 - s^2 + eps cos Omega t) y = 0.

    Parameters
    ----------
    stiffness : array_like, shape (2,)
        k1, k2, per mass, positive: the squares of the frequencies of the shaft at rest.
    spin : float
        s, speed of rotation. The stiffness matrix is positive definite below the first critical speed,
        s^2 < min(k1, k2); faster rotors are allowed.
    damping : float
        d, internal (co-rotating) damping, >= 0.

    Returns
    -------
    PeriodicSystem
        n = 2, J = 1.

    Raises
    ------
    ValueError
        If an argument has the wrong type, shape or sign.

    Notes
    -----
    Natural frequencies: omega^4 - (k1 + k2 + 2 s^2) omega^2 + (k1 - s^2)(k2 - s^2) = 0 (Bolotin, Nonconservative
    Problems of the Theory of Elastic Stability, 1963, chapter 3). A round shaft, k1 = k2 = k > s^2, has
    omega = sqrt(k) ± s, and in fixed axes, z = (x + i y) e^{i s t}, it is Mathieu's equation
    z'' + (k + eps cos Omega t) z = 0 exactly (d = 0): the multipliers are Mathieu's times e^{± i s T}, growth rates and
    regions are Mathieu's. So omega1 + omega2 = 2 sqrt(k) is open, with the edges of `mathieu`, and 2 omega1, 2 omega2
    have no width. With d > 0 its modes decay, to first order in d, at the rates d omega_n / (2 sqrt(k)), and its
    first-order region as d -> 0 is wider than Mathieu's by 1 / sqrt(1 - s^2 / k).
    """
    k = _pair("stiffness", stiffness)
    if (k <= 0).any():
        raise ValueError(f"stiffness = {k.tolist()} must be positive; give two numbers > 0")
    spin = real_number("spin", spin)
    damping = real_number("damping", damping, nonnegative=True)
    return PeriodicSystem(
        mass=np.eye(2),
        gyroscopic=[[0.0, -2.0 * spin], [2.0 * spin, 0.0]],
        damping=damping * np.eye(2),
        stiffness=np.diag(k - spin * spin),
        cosine=[np.eye(2)],
    )


def meissner(delta: float = 1.0, damping: float = 0.0, harmonics: int = 9) -> PeriodicSystem:
    """Meissner's equation, x'' + damping x' + (delta + eps sgn(cos Omega t)) x = 0, by its Fourier series.

    sgn(cos u) = (4 / pi) (cos u - cos 3u / 3 + cos 5u / 5 - ...), cut after ``harmonics`` harmonics.

    Parameters
    ----------
    delta : float
        Mean stiffness.
    damping : float
        Damping coefficient, >= 0.
    harmonics : int
        J, highest multiple of Omega kept; even ones are zero.

    Returns
    -------
    PeriodicSystem
        n = 1, J = ``harmonics``.

    Raises
    ------
    ValueError
        If an argument has the wrong type or sign, or ``harmonics`` is above 1000.

    Notes
    -----
    The whole series without damping has, with u = pi sqrt(delta + eps) / Omega, v = pi sqrt(delta - eps) / Omega,
    the discriminant (trace of the monodromy matrix)
    2 cos u cos v - (u / v + v / u) sin u sin v (Meissner, Schweizerische Bauzeitung 72 (1918) 95-98; van der Pol and
    Strutt, Philosophical Magazine 5 (1928) 18-38), real also for |eps| > |delta|; stable where its modulus is below 2.
    """
    delta = real_number("delta", delta)
    damping = real_number("damping", damping, nonnegative=True)
    J = whole_number("harmonics", harmonics, least=1, most=MAX_MEISSNER_HARMONICS)
    cosine = np.zeros((J, 1, 1))
    for j in range(1, J + 1, 2):
        cosine[j - 1] = 4.0 / (math.pi * j) * (1 if j % 4 == 1 else -1)
    return PeriodicSystem([[1.0]], [[0.0]], [[damping]], [[delta]], cosine)


def quadrupole_trap(a: float = 0.0, waveform: Waveform | None = None) -> PeriodicSystem:
    """An ion in a quadrupole mass filter, x'' + (a + 2 eps g(2 xi)) x = 0, y'' - (a + 2 eps g(2 xi)) y = 0; eps is q.

    Parameters
    ----------
    a : float
        Of the steady voltage, dimensionless.
    waveform : Waveform, optional
        g, of the alternating voltage; a cosine if left out, a rectangular wave for a digital trap. If its mean is not
        zero, as with a duty other than one half, that adds 2 eps times the mean to a.

    Returns
    -------
    PeriodicSystem
        n = 2. Take it at Omega = 2: time xi is half the phase of the voltage.

    Raises
    ------
    ValueError
        If ``a`` is no finite real number.

    Notes
    -----
    Both coordinates are Mathieu's equation for a cosine. The first region where both are stable, between a = -a_0(q)
    and a = b_1(q), ends in the apex q = 0.705996, a = 0.236994, which a mass filter works near (R. E. March and
    J. F. J. Todd, Quadrupole Ion Trap Mass Spectrometry, 2005, chapter 2). For a rectangular wave it follows from
    products of two matrices; see `meissner`.
    """
    a = real_number("a", a)
    push = Term("stiffness", np.diag([2.0, -2.0]), cosine(1) if waveform is None else waveform)
    return PeriodicSystem(np.eye(2), stiffness=np.diag([a, -a]), terms=[push])


def blade_flap(gamma: float = 12.0, p: float = 1.0) -> PeriodicSystem:
    """Flapping of a rotor blade in forward flight, with the advance ratio as eps and the azimuth as time.

    b'' + (gamma / 8) (1 + (4/3) eps sin t) b' + [p^2 + (gamma / 8) ((4/3) eps cos t + eps^2 sin 2 t)] b = 0.

    Parameters
    ----------
    gamma : float
        Lock number, >= 0: aerodynamic forces by inertia.
    p : float
        Flapping frequency without air, per revolution, positive; 1 for a hinge without spring on the axis.

    Returns
    -------
    PeriodicSystem
        n = 1. Take it at Omega = 1.

    Raises
    ------
    ValueError
        If an argument is no finite real number, or has the wrong sign.

    Notes
    -----
    W. Johnson, Helicopter Theory, 1980, chapter 12, without reversed flow. All multipliers have the product
    exp(-pi gamma / 4). With gamma = 12 and p = 1 the motion is stable up to eps = 1.4117415.
    """
    gamma = real_number("gamma", gamma, nonnegative=True)
    p = real_number("p", p, positive=True)
    air = gamma / 8
    terms = [
        Term("damping", [[4 / 3 * air]], sine(1)),
        Term("stiffness", [[4 / 3 * air]], cosine(1)),
        Term("stiffness", [[air]], sine(2), power=2),
    ]
    return PeriodicSystem([[1.0]], damping=[[air]], stiffness=[[p * p]], terms=terms)


def _pair(name: str, value: ArrayLike) -> FloatArray:
    array = real_array(name, value, 1)
    if array.shape != (2,):
        raise ValueError(f"{name} has shape {array.shape}; give two numbers")
    return array
