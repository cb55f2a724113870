"""Deliberate faults, each of which the tests named with it must notice; `test_mutations.py` holds them to it.

A fault is one that somebody could make: a sign, a factor, a term left out, a check that no longer checks. ``old`` must
be in the file exactly once. A test that fails for another reason than the fault would prove nothing, so the same tests
are run first without any fault.
"""

from __future__ import annotations

from typing import NamedTuple


class Fault(NamedTuple):
    """``name`` says what is wrong in ``file`` once ``old`` reads ``new``; ``tests`` below tests/ must find it.

    ``compiled`` faults are in functions that Numba compiles into others, so that they need a compilation from scratch.
    """

    name: str
    file: str
    old: str
    new: str
    tests: str
    compiled: bool = False


TRANSVERSE = "plate/test_transverse.py"
STATIC, DYNAMIC = "plate/test_inplane_static.py", "plate/test_inplane_dynamic.py"
PLATE, BASIS, LOADS = "plate/test_moving_plate.py", "plate/test_plate_basis.py", "plate/test_loads.py"
COUPLING, TRANSITION, SECOND = "perturb/test_coupling.py", "perturb/test_transition.py", "perturb/test_second_order.py"
DOUBLING, ORACLE = "floquet/engine/doubling/test_doubling.py", "floquet/chart/test_chart_oracle.py"
AGREEMENT, CLAIMS, MATRICES = (
    "compare/test_verdicts.py",
    "compare/claims/test_claims.py",
    "compare/files/test_matrices.py",
)

IDENTITIES = "hunt/test_identities.py"

FAULTS = (
    # periodic
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
    # plate
    Fault(
        "wrong sign in G",
        "plate/transverse.py",
        "kronecker(2 * sine_derivative",
        "kronecker(-2 * sine_derivative",
        TRANSVERSE,
    ),
    Fault(
        "Poisson's ratio missing in bending",
        "plate/transverse.py",
        "- nu * kronecker(alpha2",
        "- 0 * kronecker(alpha2",
        TRANSVERSE,
    ),
    Fault("twist without 1 - nu", "plate/transverse.py", "2 * (1 - nu) * kronecker", "2 * kronecker", TRANSVERSE),
    Fault(
        "transport stiffness of the wrong sign",
        "plate/transverse.py",
        "return -kronecker(np.diag(sine",
        "return kronecker(np.diag(sine",
        TRANSVERSE,
    ),
    Fault("N_yy left out of F", "plate/transverse.py", "integral(N_yy, (s, s)", "0 * integral(N_yy, (s, s)", STATIC),
    Fault("N_xy counted once", "plate/transverse.py", "integral(N_xy, (s, s_X)", "0 * integral(N_xy, (s, s_X)", STATIC),
    Fault("missing V^2", "plate/moving_plate.py", "self.speed**2 * K_og", "self.speed * K_og", PLATE),
    Fault(
        "damping in proportion to all of K",
        "plate/moving_plate.py",
        "self.damping * self.elastic_stiffness",
        "self.damping * self._stiffness",
        PLATE,
    ),
    Fault("dropped sine part of the stress", "plate/moving_plate.py", "sine=-F.imag", "sine=0 * F.imag", DYNAMIC),
    Fault(
        "only the first harmonic of the load",
        "plate/moving_plate.py",
        "self._stress.stiffness(j, Omega)",
        "self._stress.stiffness(1, Omega)",
        PLATE,
    ),
    Fault("wave speed without the root", "plate/moving_plate.py", "math.sqrt(12) / self", "12 / self", DYNAMIC),
    Fault(
        "wrong Legendre normalisation",
        "plate/basis.py",
        "np.arange(1.0, 2.0 * terms, 2.0)",
        "np.arange(2.0, 2.0 * terms + 1, 2.0)",
        BASIS,
    ),
    Fault("derivative of sines with the wrong sign", "plate/basis.py", "(i**2 - k**2)", "(k**2 - i**2)", BASIS),
    Fault("shear modulus with 1 + nu", "plate/inplane.py", "shear = (1 - nu) / 2", "shear = (1 + nu) / 2", STATIC),
    Fault(
        "shear coupling of the wrong sign", "plate/inplane.py", "nu * D - shear * D.T", "nu * D + shear * D.T", STATIC
    ),
    Fault("N_yy without Poisson's ratio", "plate/inplane.py", "v_Y + nu * u_X", "v_Y + u_X", STATIC),
    Fault(
        "in-plane transport terms left out",
        "plate/inplane.py",
        "1j * kappa * mach * self.gyroscopic",
        "0j * self.gyroscopic",
        DYNAMIC,
    ),
    Fault(
        "in-plane inertia of the wrong sign",
        "plate/inplane.py",
        "- kappa**2 * self.inertia",
        "+ kappa**2 * self.inertia",
        DYNAMIC,
    ),
    Fault(
        "viscous part of the stress left out",
        "plate/inplane.py",
        "return (1 + 1j * loss) * coefficients",
        "return coefficients",
        DYNAMIC,
    ),
    Fault(
        "wrong harmonic of the stress",
        "plate/dynamic.py",
        "*self._at(harmonic * Omega)) - self",
        "*self._at(Omega)) - self",
        DYNAMIC,
    ),
    Fault(
        "membrane load without its sine part",
        "plate/stress.py",
        "- 1j * self._stiffness(f_s)",
        "- 0j * self._stiffness(f_s)",
        PLATE,
    ),
    Fault("sawtooth upside down", "plate/loads.py", "(-1) ** (j + 1)", "(-1) ** j", LOADS),
    Fault("triangle with 1/j", "plate/loads.py", "8 / (math.pi * j) ** 2", "8 / (math.pi * j)", LOADS),
    Fault(
        "quadrature of the load too coarse",
        "plate/distribution.py",
        "self._gauss_values(2 * terms - 2)",
        "self._gauss_values(terms - 1)",
        "plate/test_distribution.py",
    ),
    Fault("D with 1 - nu", "plate/si.py", "12 * (1 - nu**2)", "12 * (1 - nu)", PLATE),
    Fault(
        "the plate moves one way only",
        "plate/moving_plate.py",
        "gyroscopic=self.speed * self._gyroscopic",
        "gyroscopic=abs(self.speed) * self._gyroscopic",
        IDENTITIES,
    ),
    # perturb
    Fault("missing 1/4 in L", "perturb/coupling.py", "forward = 0.5j * modes", "forward = 1j * modes", COUPLING),
    Fault(
        "difference resonances like sums",
        "perturb/coupling.py",
        'sign = 1 if type == "sum" else -1',
        "sign = 1",
        COUPLING,
    ),
    Fault(
        "dropped sine of the excitation",
        "perturb/coupling.py",
        "- 1j * system.sine[j - 1]",
        "- 0j * system.sine[j - 1]",
        COUPLING,
    ),
    Fault(
        "(28b) as printed",
        "perturb/coupling.py",
        "- g11 - 1j * g12)  # eq. (28b)",
        "- g12 - 1j * g12)  # eq. (28b)",
        COUPLING,
    ),
    Fault(
        "swapped p and q",
        "perturb/transition.py",
        "TransitionCurve(p + 1, q + 1",
        "TransitionCurve(q + 1, p + 1",
        TRANSITION,
    ),
    Fault(
        "harmonic j at the frequency of the first",
        "perturb/transition.py",
        "/ np.array(multiples)[:, None]",
        "/ np.ones(len(multiples))[:, None]",
        TRANSITION,
    ),
    Fault(
        "harmonics meet only themselves",
        "perturb/transition.py",
        "{a + b for a in direct for b in direct}",
        "{2 * a for a in direct}",
        SECOND,
    ),
    Fault(
        "elastic limit used for damped pairs",
        "perturb/pair.py",
        "root = S * np.sqrt(imag**2 + 4 * product * (real - product))",
        "root = 2 * product * np.sqrt(real)",
        "perturb/test_pair.py",
    ),
    Fault(
        "tip without its factor",
        "perturb/pair.py",
        "np.sqrt(2 * C_p * C_q / reach)",
        "np.sqrt(C_p * C_q / reach)",
        "perturb/test_pair.py",
    ),
    Fault(
        "vanishing damping widens nothing",
        "perturb/pair.py",
        "(C_p + C_q) / (2 * np.sqrt(C_p * C_q)), 1.0)",
        "1.0, 1.0)",
        TRANSITION,
    ),
    Fault(
        "modes normalised to 1, not 2",
        "perturb/modes.py",
        "np.sqrt(2.0 / norm)",
        "np.sqrt(1.0 / norm)",
        "perturb/test_modes.py",
    ),
    Fault(
        "decay in proportion to omega",
        "perturb/modes.py",
        "self.frequencies**2 * _forms(self.vectors",
        "self.frequencies * _forms(self.vectors",
        "perturb/test_modes.py",
    ),
    Fault(
        "sign of the detuning",
        "perturb/expansion.py",
        "- x * np.diag(self.states[:, 1])",
        "+ x * np.diag(self.states[:, 1])",
        SECOND,
    ),
    Fault(
        "second-order sum without one harmonic",
        "perturb/expansion.py",
        "range(min(h) - J, max(h) + J + 1)",
        "range(min(h) - J + 1, max(h) + J + 1)",
        SECOND,
    ),
    Fault(
        "second-order sum counted twice", "perturb/expansion.py", "np.divide(-0.5j, gap", "np.divide(-1j, gap", SECOND
    ),
    Fault("E of -j as of +j", "perturb/expansion.py", "omega[:, None] * downward", "omega[:, None] * upward", SECOND),
    Fault("edges without 1/j", "perturb/curve.py", "self.centre + high / self.j", "self.centre + high", TRANSITION),
    # floquet: the chart
    Fault("weakened step rule", "floquet/engine/column.py", "LEAST_STEPS = 16.0", "LEAST_STEPS = 2.0", ORACLE),
    Fault(
        "processor term dropped",
        "floquet/engine/doubling/step.py",
        "h**3 * eps[i] ** 2 / 12.0",
        "0.0 * eps[i]",
        DOUBLING,
        True,
    ),
    Fault("sign of the excitation", "floquet/engine/doubling/step.py", "-h * eps[i]", "h * eps[i]", DOUBLING, True),
    Fault(
        "dropped sine in the steps",
        "floquet/engine/doubling/step.py",
        "sine * Fs[j, r, c]",
        "0.0 * Fs[j, r, c]",
        DOUBLING,
        True,
    ),
    Fault(
        "sines at half their size",
        "floquet/engine/doubling/step.py",
        "sine * Fs[j, r, c]",
        "0.5 * sine * Fs[j, r, c]",
        IDENTITIES,
        True,
    ),
    Fault(
        "half of G in the symplectic coordinates",
        "floquet/engine/coordinates.py",
        "half = subsystem.G / 2",
        "half = subsystem.G / 4",
        ORACLE,
    ),
    Fault(
        "damping drives",
        "floquet/engine/coordinates.py",
        "-subsystem.G - subsystem.C]",
        "-subsystem.G + subsystem.C]",
        DOUBLING,
    ),
    Fault(
        "second factor at the wrong phase",
        "floquet/engine/doubling/schedule.py",
        "np.concatenate([first, first + 2 * np.pi / B])",
        "np.concatenate([first, first - 2 * np.pi / B])",
        DOUBLING,
    ),
    Fault(
        "factors in the wrong order",
        "floquet/engine/doubling/doubling.py",
        "multiply(P, begin, end, result, i)",
        "multiply(P, end, begin, result, i)",
        DOUBLING,
        True,
    ),
    Fault(
        "samples chosen for half of the excitation",
        "floquet/engine/doubling/schedule.py",
        "np.arange(1, len(x) + 1))) * (x / 2)",
        "np.arange(1, len(x) + 1))) * (x / 4)",
        DOUBLING,
    ),
    Fault(
        "Chebyshev series with all of its constant",
        "floquet/engine/doubling/interpolation.py",
        "coefficients[0] /= 2",
        "coefficients[0] /= 1",
        DOUBLING,
    ),
    Fault(
        "weak couplings are no couplings",
        "floquet/engine/decoupling.py",
        "COUPLING = 1e-11",
        "COUPLING = 1e-2",
        "floquet/engine/test_decoupling.py",
    ),
    Fault(
        "gap margin removed",
        "floquet/engine/verdict.py",
        "(found.gap > APART * np.sqrt(E))",
        "(found.gap >= 0)",
        "floquet/engine/test_verdict.py",
    ),
    Fault(
        "eigenvectors that become parallel are no warning",
        "floquet/engine/krein.py",
        "shifts = condition * (E",
        "shifts = np.sign(condition) * (E",
        "floquet/engine/test_krein.py",
    ),
    Fault(
        "errors relative to the multiplier, not to the matrix",
        "floquet/engine/column.py",
        "np.abs(eps) * nu\n    roundings",
        "np.abs(eps) * np.ones_like(nu)\n    roundings",
        ORACLE,
    ),
    Fault(
        "rounding in a large matrix forgotten",
        "floquet/engine/column.py",
        "* (nu if subsystem.symplectic else nu**2)",
        "* np.ones_like(nu)",
        "floquet/oracle/test_exact_boundary.py::test_chart_decides_nothing_on_a_boundary",
    ),
    Fault(
        "an eigenvalue that did not converge is not missed",
        "floquet/engine/column.py",
        "losses[c] = np.inf",
        "losses[c] = 1.0",
        ORACLE,
    ),
    Fault(
        "a reflection applied late without its second half",
        "floquet/engine/eigen/reflections.py",
        "a1 = fma(v1, w_j, fma(u1, v_j, load(A, i + 1, j)))",
        "a1 = fma(v1, w_j, load(A, i + 1, j))",
        "floquet/engine/eigen/test_hessenberg.py",
        compiled=True,
    ),
    Fault(
        "row and column of the rotation reflected twice",
        "floquet/engine/eigen/symplectic.py",
        "store(x, row, r, spread(0.0))",
        "store(x, row, r, load(x, row, r))",
        "floquet/engine/eigen/test_hessenberg.py",
        compiled=True,
    ),
    Fault(
        "tongues as steep as if of first order",
        "floquet/regions/tongues.py",
        "self.slope = -candidate.name.j * np.pi * candidate.balance",
        "self.slope = -np.pi * candidate.balance",
        "floquet/regions/test_tongues.py",
    ),
    Fault(
        "narrow regions go on within wide ones",
        "floquet/regions/stretches.py",
        "met & (home < 0)",
        "met",
        "floquet/regions/test_stretches.py",
    ),
    Fault(
        "subsystems of a family in an order of chance",
        "floquet/engine/decoupling.py",
        "return sorted(found, key=lambda basis: float(np.linalg.norm(direction @ basis)))",
        "return found",
        "floquet/engine/test_decoupling.py",
    ),
    Fault(
        "rounding taken for damping",
        "floquet/regions/widths.py",
        "slightest = -NO_DECAY * subsystem.rate",
        "slightest = 0.0",
        "floquet/regions/test_widths.py",
    ),
    Fault(
        "instability with a third mode taken for that of two",
        "floquet/regions/detuning.py",
        "shift > ALONE * gain",
        "shift > 1e9",
        "floquet/regions/test_detuning.py",
    ),
    Fault(
        "undecided counted as stable",
        "floquet/engine/verdict.py",
        "np.where(log_modulus < -error, Kind.STABLE",
        "np.where(log_modulus < error, Kind.STABLE",
        "floquet/engine/test_verdict.py",
    ),
    Fault(
        "audit disabled",
        "floquet/chart/chart.py",
        "return chart if audit == 0 else",
        "return chart if audit >= 0 else",
        "floquet/chart/test_chart.py::test_audit",
    ),
    Fault(
        "audit overlooks contradictions",
        "floquet/chart/audit.py",
        "return not self.contradictions.any() and not",
        "return not",
        "floquet/chart/test_chart.py::test_contradiction_is_not_ok",
    ),
    Fault(
        "cache key without eps",
        "floquet/chart/checkpoint.py",
        "for array in (Omega, eps, np.array(steps)):",
        "for array in (Omega, np.array(steps)):",
        "floquet/chart/test_checkpoint.py",
    ),
    Fault(
        "damaged tiles are trusted",
        "floquet/chart/checkpoint.py",
        "if hashlib.sha256(content).digest() != digest:",
        "if False:",
        "floquet/chart/test_checkpoint.py",
    ),
    # floquet: the single point, the boundaries, the proofs
    Fault(
        "errors arrive as they were made",
        "floquet/oracle/point.py",
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
        IDENTITIES,
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
        True,
    ),
    Fault(
        "cancelling terms forgotten in the rounding",
        "floquet/oracle/taylor.py",
        "squares += square",
        "squares += 0.0",
        "floquet/oracle/test_taylor.py",
        True,
    ),
    Fault(
        "lower edge above the upper",
        "floquet/boundary/boundary.py",
        "for side in (-1, 1))",
        "for side in (1, -1))",
        "floquet/boundary/test_boundary.py",
    ),
    Fault(
        "sum resonances sought as differences",
        "floquet/boundary/resonance.py",
        "second.conj() if resonance",
        "second if resonance",
        "floquet/boundary/test_boundary.py",
    ),
    Fault(
        "even tongues of the kind of odd ones",
        "floquet/boundary/resonance.py",
        "if self.j % 2 == 0",
        "if self.j % 2 == 1",
        "floquet/regions/test_regions.py",
    ),
    Fault(
        "remainder of the series left out of the proof",
        "floquet/certified/enclosure.py",
        "[bound * arb(0, 1)] * size**2",
        "[arb(0)] * size**2",
        "floquet/certified/test_enclosed_monodromy.py",
    ),
    # compare
    Fault(
        "a theory is content with the order below",
        "compare/verdicts.py",
        "wanted = order + 1",
        "wanted = order",
        AGREEMENT,
    ),
    Fault(
        "what cannot be told counts as agreement",
        "compare/verdicts.py",
        "kind == Kind.UNDECIDED,",
        "kind > 9,",
        AGREEMENT,
    ),
    Fault(
        "damping the same on every rung",
        "compare/verdicts.py",
        "self.factor * system.damping",
        "system.damping",
        AGREEMENT,
    ),
    Fault(
        "a claim holds with limits if nothing holds",
        "compare/claims/evidence.py",
        "Verdict.LIMITS if any(throughout)",
        "Verdict.LIMITS if True",
        CLAIMS,
    ),
    Fault(
        "differences within the errors decide", "compare/claims/evidence.py", "abs(margin) > 2 * error", "True", CLAIMS
    ),
    Fault(
        "cosines read as sines",
        "compare/files/matrices.py",
        '(("cosine", "c"), ("sine", "s"))',
        '(("cosine", "s"), ("sine", "c"))',
        MATRICES,
    ),
    Fault(
        "zip bombs are opened", "compare/files/matrices.py", "if member.file_size > MOST_BYTES:", "if False:", MATRICES
    ),
    Fault(
        "MATLAB's columns read as rows",
        "compare/files/matlab_file.py",
        'reshape(shape, order="F")',
        "reshape(shape)",
        MATRICES,
    ),
    Fault(
        "skew-symmetric read as symmetric",
        "compare/files/matrix_market.py",
        '"skew-symmetric": -1',
        '"skew-symmetric": 1',
        MATRICES,
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
)
