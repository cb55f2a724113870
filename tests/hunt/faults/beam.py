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
        "1 + math.pi**2 * self",
        "1 + 10 * self",
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
        "np.multiply.outer(k2, k2) * transport(n)",
        "transport(n) * k2**2",
        "beam/test_matrices.py",
    ),
)
