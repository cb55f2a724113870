"""Deliberate faults in `floquet/`: the oracle and the proofs."""

from tests.hunt.fault import Fault

FAULTS = (
    Fault(
        "errors arrive as they were made",
        "floquet/oracle/period.py",
        "np.sum(np.linalg.norm(after, 2, axis=(1, 2)) * errors",
        "np.sum(errors",
        "floquet/oracle/test_exact_boundary.py",
    ),
    Fault(
        "multipliers lost in their error look known",
        "floquet/oracle/multipliers.py",
        "np.log(max(1 - down / modulus[top], np.finfo(float).tiny))",
        "np.log(max(1 - down / modulus[top], 0.5))",
        "floquet/oracle/test_exact_boundary.py",
    ),
    Fault(
        "Krein's signature ignored",
        "floquet/oracle/multipliers.py",
        "signs[0] * signs[-1] > 0 and",
        "True or",
        "floquet/oracle/test_multipliers.py",
    ),
    Fault(
        "gyroscopic systems called reversible",
        "floquet/oracle/reduction.py",
        "(C.any() or G.any() or sines.any())",
        "(C.any() or sines.any())",
        "floquet/oracle/test_reduction.py",
    ),
    Fault(
        "cosines in place of sines",
        "floquet/oracle/reduction.py",
        "factors[:, :J], factors[:, J:]",
        "factors[:, :J], factors[:, :J]",
        "hunt/test_identities.py",
    ),
    Fault(
        "dropped couplings not charged",
        "floquet/oracle/reduction.py",
        "subsystem.neglected + float(neglected)",
        "subsystem.neglected",
        "floquet/oracle/test_reduction.py",
    ),
    Fault(
        "derivatives of the excitation without sign",
        "floquet/oracle/taylor.py",
        "c, s = -s, c",
        "c, s = s, c",
        "floquet/oracle/test_taylor.py",
        compiled=True,
    ),
    Fault(
        "cancelling terms forgotten in the rounding",
        "floquet/oracle/taylor.py",
        "squares += square",
        "squares += 0.0",
        "floquet/oracle/test_taylor.py",
        compiled=True,
    ),
    Fault(
        "remainder of the series left out of the proof",
        "floquet/certified/enclosure.py",
        "[bound * arb(0, 1)] * size**2",
        "[arb(0)] * size**2",
        "floquet/certified/test_enclosed_monodromy.py",
    ),
)
