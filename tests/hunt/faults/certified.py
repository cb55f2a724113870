"""Deliberate faults in proofs."""

from tests.hunt.fault import Fault

GENERAL = "floquet/certified/test_general.py"
MODELS, CHARTS, CHECKER = (
    f"floquet/certified/areas/{name}.py" for name in ("test_models", "test_prove_chart", "test_checking")
)

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
    Fault(
        "radius of the second factor forgotten in a product of models",
        "floquet/certified/areas/models.py",
        "radius = ra * two_b.sum() + two_a.sum() * rb + ra * rb",
        "radius = ra * two_b.sum() + ra * rb",
        MODELS,
        compiled=True,
    ),
    Fault(
        "what is cut from a product of models forgotten",
        "floquet/certified/areas/models.py",
        "radius += two_a[i] * frob_b[j]",
        "radius += 0.1 * two_a[i] * frob_b[j]",
        MODELS,
        compiled=True,
    ),
    Fault(
        "rounding of a moved polynomial forgotten",
        "floquet/certified/areas/models.py",
        "(self.radius + gamma(6 * self.degree + 4) * self.frobenius()) * SAFE + TINY",
        "self.radius * SAFE + TINY",
        MODELS,
    ),
    Fault(
        "tail of the parameters from one degree too far",
        "floquet/certified/areas/patches.py",
        "        if k > degree:",
        "        if k > degree + 1:",
        MODELS,
    ),
    Fault(
        "sign of the excitation over a patch",
        "floquet/certified/areas/patches.py",
        "e0 * V[c, row, column]",
        "-e0 * V[c, row, column]",
        CHARTS,
        compiled=True,
    ),
    Fault(
        "start at a quarter of the period with the wrong signs",
        "floquet/certified/areas/coefficients.py",
        "X * (-1.0) ** (j // 2)",
        "X * (-1.0) ** j",
        CHARTS,
    ),
    Fault(
        "a form called definite without its radius",
        "floquet/certified/areas/isolation.py",
        "math.sqrt(len(V)) * D.radius + rounding",
        "0 * math.sqrt(len(V)) * D.radius + rounding",
        MODELS,
    ),
    Fault(
        "open area along a slope half as wide",
        "floquet/certified/areas/ranges.py",
        "part = min(part, radius / slope)",
        "part = min(part, 0.5 * radius / slope)",
        MODELS,
        compiled=True,
    ),
    Fault(
        "an unstable subsystem outvoted",
        "floquet/certified/areas/chart.py",
        "(codes == UNSTABLE).any(axis=0)",
        "(codes == UNSTABLE).all(axis=0)",
        CHARTS,
    ),
    Fault(
        "checker content with polynomials out of their radius",
        "floquet/certified/checking/cells.py",
        "len(coef) <= len(own) and off <= radius",
        "len(coef) <= len(own)",
        CHECKER,
    ),
)
