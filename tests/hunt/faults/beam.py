"""Deliberate faults in `beam/`."""

from tests.hunt.fault import Fault

FAULTS = (
    Fault(
        "acceleration of the beam left out",
        "beam/moving_beam.py",
        "-Omega * v1 * acceleration",
        "0 * Omega * v1 * acceleration",
        "beam/test_moving_beam.py",
    ),
    Fault(
        "acceleration of the beam of the wrong sign",
        "beam/moving_beam.py",
        "-Omega * v1 * acceleration",
        "Omega * v1 * acceleration",
        "beam/test_string.py",
    ),
    Fault(
        "second harmonic of v^2 with eps^3",
        "beam/moving_beam.py",
        "waveforms.cosine(2), power=2",
        "waveforms.cosine(2), power=3",
        "beam/test_string.py",
    ),
    Fault(
        "divergence speed with 10 for pi^2",
        "beam/moving_beam.py",
        "part / math.pi**2",
        "part / 10",
        "beam/test_moving_beam.py",
    ),
    Fault(
        "tension that accelerates held at the entry",
        "beam/matrices.py",
        "0.5 - held_at",
        "0.5",
        "beam/test_matrices.py",
    ),
    Fault(
        "weak form of the material derivative as the strong",
        "beam/matrices.py",
        "np.pad(np.multiply.outer(k, k) * transport(n), ((1, 0), (1, 0)))",
        "rotation_transport(n) * np.concatenate([[0.0], k**2])",
        "beam/test_matrices.py",
    ),
    Fault(
        "angular momentum of the sections not carried along",
        "beam/section.py",
        "self.turned(R - R.T)",
        "0 * self.turned(R - R.T)",
        "beam/test_timoshenko.py",
    ),
    Fault(
        "shear without the angle of the sections",
        "beam/section.py",
        "@ self._deflection - self._angle",
        "@ self._deflection",
        "beam/test_timoshenko.py",
    ),
)
