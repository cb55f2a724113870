"""TransitionCurve: the two edges of one region of parametric instability, whichever order of theory predicts them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from numpy.typing import ArrayLike

from periodic.checks import FloatArray, points, real_array
from perturb.resonance import Resonance


class Prediction(Protocol):
    """What a theory says about the region of one resonance, in terms of s = j (Omega - centre)."""

    @property
    def slope(self) -> float:
        """d(half width in s) / d eps as eps grows."""
        ...

    @property
    def tip(self) -> float:
        """The eps at which the region opens; infinite where it never does."""
        ...

    def edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the edges in s; NaN where the region is closed."""
        ...

    def growth(self, s: FloatArray, eps: FloatArray) -> FloatArray:
        """Return the largest growth rate among the resonant modes."""
        ...


@dataclass(frozen=True, eq=False)
class TransitionCurve:
    """Transition curves, eqs. (25) and (27), around j Omega = omega_p + omega_q or omega_p - omega_q.

    Made by `transition_curves`. Frequencies are in the units of the system (dimensionless for the plate).

    Attributes
    ----------
    resonance : Resonance
        Modes, multiple, type and centre; ``p``, ``q``, ``j``, ``type`` and ``centre`` of the curve are its entries.
        At second order j reaches twice the number of harmonics, through j = j1 + j2.
    order : {1, 2}
        Order in eps of the theory.
    interaction : {1, 2}
        1 where harmonic j of the excitation couples the modes directly. 2 where the excitation has no harmonic j and
        only two interactions together couple them; such a region opens like eps^2.
    prediction : Prediction
        The theory's description of the region.
    """

    resonance: Resonance
    order: int
    interaction: int
    prediction: Prediction

    @property
    def p(self) -> int:
        """Number of the higher mode, from 1."""
        return self.resonance.p

    @property
    def q(self) -> int:
        """Number of the lower mode, from 1; p itself for a region 2 omega_p."""
        return self.resonance.q

    @property
    def j(self) -> int:
        """Multiple of the excitation frequency that is in resonance."""
        return self.resonance.j

    @property
    def type(self) -> str:
        """ "sum" or "difference"."""
        return self.resonance.type

    @property
    def centre(self) -> float:
        """Frequency (omega_p ± omega_q) / j at which the region starts at eps = 0."""
        return self.resonance.centre

    @property
    def slope(self) -> float:
        """d(half width in Omega) / d eps as eps grows, from the first-order interaction.

        Without damping sqrt(L) / j; 0 where L <= 0 or the interaction is of second order. Infinite where the
        instability does not end at any detuning (`perturb.pair.pair_edges`).
        """
        return float(self.prediction.slope) / self.j

    @property
    def tip(self) -> float:
        """The eps below which damping keeps the region closed: 0 without damping, infinite if it never opens."""
        return float(self.prediction.tip)

    @property
    def label(self) -> str:
        """Name of the resonance: 2ω₁, ω₁+ω₃, ω₃−ω₁, for j > 1 2ω₁/2, (ω₁+ω₃)/2; "(2nd)" marks `interaction` 2."""
        return self.resonance.label if self.interaction == 1 else f"{self.resonance.label} (2nd)"

    def edges(self, eps: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the lower and the upper edge of the region.

        Parameters
        ----------
        eps : array_like, any shape
            Excitation amplitude; its sign does not matter to first order.

        Returns
        -------
        lower, upper : ndarray, shape of ``eps``
            Omega of the edges, NaN where the region is closed, infinite where the theory finds no end. Without damping
            a sum-type region whose modes are not coupled has no width: both edges lie at the centre. Second order gives
            regions that have merged their common edges, and NaN to one that a stronger one has absorbed.

        Raises
        ------
        ValueError
            If ``eps`` is not real or not finite.
        """
        low, high = self.prediction.edges(real_array("eps", eps, None))
        return self.centre + low / self.j, self.centre + high / self.j

    def growth_rate(self, Omega: ArrayLike, eps: ArrayLike) -> FloatArray:
        """Return the largest growth rate among the modes in resonance, negative where both decay.

        Parameters
        ----------
        Omega, eps : array_like
            Excitation frequency and amplitude, shapes that broadcast together.

        Returns
        -------
        ndarray, broadcast shape
            Growth rate per unit of time; a Floquet multiplier has modulus exp(growth rate x period).

        Raises
        ------
        ValueError
            If an argument is not real or not finite, or the shapes do not broadcast.
        """
        frequency, amplitude = points(Omega, eps)
        return self.prediction.growth(self.j * (frequency - self.centre), amplitude)
