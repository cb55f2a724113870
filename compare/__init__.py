"""Theory against integration: agreement in numbers, overlays in pictures."""

from compare.agreement import RegionAgreement, agreement
from compare.overlay import overlay

__all__ = ["RegionAgreement", "agreement", "overlay"]
