"""Over what a claim is judged."""

from __future__ import annotations

from enum import StrEnum


class Scope(StrEnum):
    """Over what a claim is judged, and by which theory.

    The paper's figures are those plates that it draws. Its authors plotted eq. (25), and where they say "elastic" they
    can have taken it as it is printed, with a damping that vanishes: regions of two modes then are wider than those of
    the undamped plate. The wider range asks whether the claim is a rule.
    """

    PAPER = "paper's figures"
    LITERAL = "figures by (25) as printed"
    WIDER = "wider range"
