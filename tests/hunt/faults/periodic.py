"""Deliberate faults in `periodic/`."""

from tests.hunt.fault import Fault

FAULTS = (
    Fault(
        "G need not be skew-symmetric",
        "periodic/system.py",
        "gyroscopic, n), -1)",
        "gyroscopic, n), 1)",
        "periodic/test_system.py",
    ),
    Fault(
        "NaN and infinity are accepted",
        "periodic/checks.py",
        "if not np.isfinite(array).all():",
        "if False:",
        "periodic/test_checks.py",
    ),
    Fault(
        "the rotor misses its centrifugal term",
        "periodic/examples.py",
        "np.diag(k - spin * spin)",
        "np.diag(k)",
        "periodic/test_examples.py",
    ),
    Fault(
        "the square wave without alternating signs",
        "periodic/examples.py",
        "(1 if j % 4 == 1 else -1)",
        "1",
        "periodic/test_examples.py",
    ),
    Fault(
        "memory that fades twice as fast",
        "periodic/solid.py",
        "-np.eye(r) / self.time",
        "-2 * np.eye(r) / self.time",
        "periodic/test_solid.py",
    ),
    Fault(
        "a term of the velocity acts on the place",
        "periodic/solid.py",
        "else state(term.matrix, no, none)",
        "else state(no, term.matrix, none)",
        "periodic/test_solid.py",
    ),
    Fault(
        "a web called conservative without the force of its acceleration",
        "periodic/structure.py",
        "and _same(K - K.swapaxes(1, 2), dG, K, dG)",
        "",
        "floquet/oracle/test_general.py",
    ),
    Fault(
        "a mass looked at in a few phases only",
        "periodic/system.py",
        "MASS_SAMPLES, MASS_ZOOMS = 33, 3",
        "MASS_SAMPLES, MASS_ZOOMS = 33, 1",
        "periodic/test_terms.py",
    ),
)
