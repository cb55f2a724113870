"""The transition curves of any linear periodic system."""

from __future__ import annotations

from collections.abc import Sequence

from periodic import AnyFamily
from perturb.curve import TransitionCurve
from perturb.general.equations import GeneralExpansion
from perturb.general.resonances import general_resonances
from perturb.general.resonant_states import GeneralStates, first_order_theory
from perturb.resonance import Resonance


def general_transition_curves(
    family: AnyFamily, Omega_range: tuple[float, float], order: int, types: Sequence[str]
) -> list[TransitionCurve]:
    """Return the transition curves of all resonances with centre in ``Omega_range``.

    `perturb.transition_curves` calls this for whatever is not of the form of eq. (11), and says what the arguments are.
    """
    expansion = GeneralExpansion(family)
    blocks = expansion.blocks(Omega_range[1])
    once, twice = ({j for j in series if j > 0} for series in (blocks.first, blocks.second))
    multiples = set(once)
    if order == 2:
        multiples |= twice | {a + sign * b for a in once for b in once for sign in (1, -1) if a + sign * b > 0}
    # two interactions meet at 2 omega_p / (2 j) in a state that does not oscillate
    through = {2 * j for j in once} - multiples if order == 1 else set()
    resonances = general_resonances(expansion, sorted(multiples | through), Omega_range, types)
    curves = []
    for resonance in resonances:
        first = first_order_theory(expansion, resonance, multiples)
        if resonance.j in through and not _meets_a_still_state(first, resonance):
            continue
        second = GeneralStates(expansion, resonance, 2, multiples, first)
        interaction = 1 if resonance.j in once or resonance.j in through else 2
        curves.append(TransitionCurve(resonance, order, interaction, first, second))
    return curves


def _meets_a_still_state(theory: GeneralStates, resonance: Resonance) -> bool:
    """Whether a state that does not oscillate resonates with the two of a main resonance."""
    still = theory.matrix.states[:, 0] >= 2 * theory.matrix.modes
    return resonance.p == resonance.q and resonance.type == "sum" and bool(still.any())
