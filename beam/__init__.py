"""The axially moving tensioned beam, at zero rigidity the string, with pulsating speed and tension.

`MovingBeam` holds the parameters. Handed a frequency, it returns its `periodic.PeriodicSystem`, which theory and
integration take alike:

>>> from beam import MovingBeam
>>> beam = MovingBeam(speed=2.0, flexural_rigidity=0.64, damping=0.001)
>>> print(f"diverges at v = {beam.critical_speed():.4f}")
diverges at v = 2.7049

Its speed pulsates, v (1 + eps cos Omega t), unless ``speed_amplitude`` is zero. The acceleration v' puts a skew matrix
into the stiffness that grows with Omega, so that the beam is a family:

>>> bool((beam.at(20.0).sine[0] == 2 * beam.at(10.0).sine[0]).all())
True

The files: `matrices` has the integrals of the trial functions, `section` what a section's angle does, `moving_beam` the
beam.
"""

from beam.moving_beam import MovingBeam

__all__ = ["MovingBeam"]
