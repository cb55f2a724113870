"""Theory against integration: agreement in numbers, overlays in pictures."""

from compare.pictures import overlay
from compare.verdicts import RegionAgreement, agreement

__all__ = ["RegionAgreement", "agreement", "overlay"]
