"""Deliberate faults in `compare/`."""

from tests.hunt.fault import Fault

FAULTS = (
    Fault(
        "a theory is content with the order below",
        "compare/verdicts.py",
        "wanted = order + 1",
        "wanted = order",
        "compare/test_verdicts.py",
    ),
    Fault(
        "what cannot be told counts as agreement",
        "compare/verdicts.py",
        "kind == Kind.UNDECIDED,",
        "kind > 9,",
        "compare/test_verdicts.py",
    ),
    Fault(
        "damping the same on every rung",
        "compare/verdicts.py",
        "self.factor * system.damping",
        "system.damping",
        "compare/test_verdicts.py",
    ),
    Fault(
        "a claim holds with limits if nothing holds",
        "compare/claims/evidence.py",
        "Verdict.LIMITS if any(throughout)",
        "Verdict.LIMITS if True",
        "compare/claims/test_claims.py",
    ),
    Fault(
        "differences within the errors decide",
        "compare/claims/evidence.py",
        "abs(margin) > 2 * error",
        "True",
        "compare/claims/test_claims.py",
    ),
    Fault(
        "cosines read as sines",
        "compare/files/matrices.py",
        '(("cosine", "c"), ("sine", "s"))',
        '(("cosine", "s"), ("sine", "c"))',
        "compare/files/test_matrices.py",
    ),
    Fault(
        "zip bombs are opened",
        "compare/files/matrices.py",
        "if member.file_size > MAX_MATRIX_BYTES:",
        "if False:",
        "compare/files/test_matrices.py",
    ),
    Fault(
        "MATLAB's columns read as rows",
        "compare/files/matlab_file.py",
        'reshape(shape, order="F")',
        "reshape(shape)",
        "compare/files/test_matrices.py",
    ),
    Fault(
        "skew-symmetric read as symmetric",
        "compare/files/matrix_market.py",
        '"skew-symmetric": -1',
        '"skew-symmetric": 1',
        "compare/files/test_matrices.py",
    ),
    Fault(
        "unknown keys are ignored",
        "compare/files/cases.py",
        'extra="forbid"',
        'extra="ignore"',
        "compare/files/test_cases.py",
    ),
    Fault(
        "half-written results",
        "compare/files/publish.py",
        "stage = Path(name)",
        "stage = target",
        "compare/files/test_publish.py",
    ),
    Fault(
        "slow growth as pale as stability",
        "compare/colours.py",
        "GROWTH_PART = (0.36, 1.0)",
        "GROWTH_PART = (0.0, 1.0)",
        "compare/test_colours.py",
    ),
    Fault(
        "compilation announced again and again",
        "scripts/compiling.py",
        "if not self._said:",
        "if True:",
        "scripts/test_commands.py::test_compilation_is_announced_once",
    ),
    Fault(
        "parameters of the plate left out of the report",
        "compare/study/provenance.py",
        "if isinstance(value, int | float | str | tuple)",
        "if isinstance(value, str)",
        "compare/study/test_provenance.py",
    ),
)
