"""TransitionCurve: the two edges of one region of parametric instability, whichever order of theory predicts them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from numpy.typing import ArrayLike

from periodic.checks import FloatArray, points, real_array
from perturb.resonance import Resonance


class Prediction(Protocol):
    """What a theory says about the region of one resonance, in terms of x = Omega - centre."""

    @property
    def slope(self) -> float:
        """d(half width) / d eps as eps grows."""
        ...

    @property
    def tip(self) -> float:
        """The eps at which the region opens; infinite where it never does."""
        ...

    @property
    def eps_max(self) -> float:
        """The eps up to which the expansion is meant."""
        ...

    @property
    def coincident(self) -> tuple[str, ...]:
        """Names of the resonances that resonate together with this one."""
        ...

    @property
    def isolated_up_to(self) -> float:
        """The eps up to which the resonance can be looked at by itself."""
        ...

    def edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the edges in x; NaN where the region is closed."""
        ...

    def merged_edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the edges in x of the region and of all that it has merged with."""
        ...

    def growth(self, x: FloatArray, eps: FloatArray) -> FloatArray:
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
    first, second : Prediction
        The region to first and to second order. None for the latter where damping has vanished (eq. (25) at c = 0).
    """

    resonance: Resonance
    order: int
    interaction: int
    first: Prediction
    second: Prediction | None

    def __repr__(self) -> str:
        return (
            f"<TransitionCurve {self.label} at {self.centre:.6g}: order {self.order}, slope {self.slope:.4g}, "
            f"tip {self.tip:.4g}, meant up to eps = {self.eps_max:.4g}>"
        )

    @property
    def prediction(self) -> Prediction:
        """The region to the order of the curve."""
        return self.second if self.order == 2 and self.second is not None else self.first

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
        instability does not end at any detuning (`perturb.pair.pair_edges`). Of resonances that coincide, that of the
        part of their common region that is this one's (`edges`).
        """
        return float(self.prediction.slope)

    @property
    def tip(self) -> float:
        """The eps below which damping keeps the region closed: 0 without damping, infinite if it never opens."""
        return float(self.prediction.tip)

    @property
    def tips(self) -> tuple[float, float]:
        """The tip to first and to second order.

        Where they differ by much, first order is not meant for this region: what second order adds, such as two
        interactions against a direct one, is as strong at the tip as what first order has. With ``vanishing_damping``
        the second one is NaN.
        """
        return float(self.first.tip), float("nan") if self.second is None else float(self.second.tip)

    @property
    def eps_max(self) -> float:
        """The eps up to which the expansion is meant: infinite if the excitation acts on neither mode.

        There the excitation moves 30 % of the energy of mode p or q: eps times the largest sum_j |w_p^H E_j w_m| over
        all modes m. A mode near divergence is soft, so that its eps_max is small.
        """
        return float(self.prediction.eps_max)

    @property
    def coincident(self) -> tuple[str, ...]:
        """Names of the resonances that resonate together with this one; empty for most.

        Their frequencies are equal, or so near that the excitation bridges the difference at some eps below `eps_max`,
        and the excitation or the damping couples them. Theory takes them together.
        """
        return self.first.coincident

    @property
    def isolated_up_to(self) -> float:
        """The eps up to which the resonance can be looked at by itself: 0 if others coincide with it.

        At that eps the excitation moves the frequencies by as much as the nearest of the `coincident` resonances is
        away. Infinite if there are none.
        """
        return float(self.first.isolated_up_to)

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
            a sum-type region whose modes are not coupled has no width: both edges lie at the centre. Regions that have
            merged have their common edges. Of resonances that coincide, the strongest has the whole region, the next
            the part in which a second solution grows as well, and so on; NaN if there is no such part.

        Raises
        ------
        ValueError
            If ``eps`` is not real or not finite.
        """
        low, high = self.prediction.edges(real_array("eps", eps, None))
        return self.centre + low, self.centre + high

    def merged_edges(self, eps: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the edges of the whole region that this one is part of, together with all that has merged with it.

        The same as `edges` unless there are `coincident` resonances. It is one interval: coincident resonances may have
        several with stable gaps between them, and one that is no single resonance's belongs to no curve. `growth_rate`
        knows all of them.

        Parameters
        ----------
        eps : array_like, any shape

        Returns
        -------
        lower, upper : ndarray, shape of ``eps``

        Raises
        ------
        ValueError
            If ``eps`` is not real or not finite.
        """
        low, high = self.prediction.merged_edges(real_array("eps", eps, None))
        return self.centre + low, self.centre + high

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
        return self.prediction.growth(frequency - self.centre, amplitude)
