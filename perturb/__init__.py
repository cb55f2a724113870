"""Gyroscopic modes and multiple scales: analytic transition curves of a `periodic.PeriodicSystem`."""

from perturb.curve import TransitionCurve
from perturb.modes import GyroscopicModes, gyroscopic_modes
from perturb.transition import transition_curves

__all__ = ["GyroscopicModes", "TransitionCurve", "gyroscopic_modes", "transition_curves"]
