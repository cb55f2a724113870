"""The axially moving plate of Young, Huang and Chiu: edge loads, in-plane stress, transverse matrices (section II)."""

from plate.distribution import Distribution
from plate.dynamic import InPlaneResonanceWarning
from plate.inplane import StressField
from plate.loads import EdgeLoad
from plate.moving_plate import MovingPlate

__all__ = ["Distribution", "EdgeLoad", "InPlaneResonanceWarning", "MovingPlate", "StressField"]
