"""Deliberate faults in proofs."""

from tests.hunt.fault import Fault

GENERAL = "floquet/certified/test_general.py"

FAULTS = (
    Fault(
        "remainder of the series left out of the proof",
        "floquet/certified/steps.py",
        "return around_zero(self.equation.states, bound)",
        "return around_zero(self.equation.states, 0 * bound)",
        "floquet/certified/test_enclosed_monodromy.py",
    ),
    Fault(
        "sign of a moving mass in the remainder of a proof",
        "floquet/certified/steps.py",
        "bounds.rates.integral(length, radius, m) / (1 - change), change",
        "bounds.rates.integral(length, radius, m) / (1 + change), change",
        GENERAL,
    ),
    Fault(
        "sign of a moving mass in the series of a proof",
        "floquet/certified/steps.py",
        "slope = inverse * (slope - E(slopes, k))",
        "slope = inverse * (slope + E(slopes, k))",
        GENERAL,
    ),
    Fault(
        "jumps at the end of the period dropped from a proof",
        "floquet/certified/enclosure.py",
        "factors += _jump(equation, b, inside, after)",
        "factors += _jump(equation, b, inside, after) if b < 1 else []",
        GENERAL,
    ),
    Fault(
        "momentum lost in a proof where the mass jumps",
        "floquet/certified/enclosure.py",
        "inverse * equation.loose_mass(phase, before)",
        "identity(inverse.nrows())",
        GENERAL,
    ),
    Fault(
        "what waveforms leave out left out of the proof",
        "floquet/certified/steps.py",
        "if self.equation.has_rest:\n            unknown",
        "if False:\n            unknown",
        GENERAL,
    ),
    Fault(
        "unsymmetric stiffness taken for a Hamiltonian system in a proof",
        "floquet/certified/structure.py",
        "all(_is_symmetric(X) for X in stiffness)",
        "any(_is_symmetric(X) for X in stiffness)",
        "floquet/certified/test_growth.py",
    ),
    Fault(
        "functions that are odd taken for even ones in a proof",
        "floquet/certified/structure.py",
        "is_cosine = (c != 0) == (quarters.numerator % 2 == 0)",
        "is_cosine = parity > 0",
        GENERAL,
    ),
    Fault(
        "rounding of the derivatives accepted in a proof without a word",
        "floquet/certified/structure.py",
        "return found + (len(parts) + 2) * ROUNDING_OF_DEFECTS if",
        "return 0.0 if",
        GENERAL,
    ),
    Fault(
        "sign of the derivative of a waveform in a proof",
        "floquet/certified/waves.py",
        "(j * Omega * s, -j * Omega * c)",
        "(j * Omega * s, j * Omega * c)",
        GENERAL,
    ),
    Fault(
        "half a jump of the speed in a proof",
        "floquet/certified/reading.py",
        "X * (jump / 2)",
        "X * jump",
        GENERAL,
    ),
)
