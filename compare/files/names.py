"""Names of matrices in files, such as K, K1c, C2s, G1c_2, K0_1 or A1c, and the system that they make."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import Any, NamedTuple

import numpy as np

from periodic import FirstOrderSystem, PeriodicSystem, SparseSystem, Term, waveforms
from periodic.checks import FloatArray
from periodic.terms import MAX_POWER
from periodic.waveforms import Trigonometric

# Harmonics of a system from a file. With the number of coordinates they bound the memory that a damaged file asks for.
MAX_FILE_HARMONICS = 64
# What each letter stands for; F is the old name of an excited stiffness.
MATRIX_NAMES = {"mass": "M", "gyroscopic": "G", "damping": "C", "stiffness": "K"}
STATE_LETTER, OLD_STIFFNESS_LETTER = "A", "F"
OF_LETTER = {letter: of for of, letter in MATRIX_NAMES.items()} | {STATE_LETTER: "state"}
REQUIRED_MATRICES = ("M", "K")
NAME = re.compile(r"(?P<letter>[MGCKAF])(?:(?P<harmonic>[0-9]{1,9})(?P<wave>[CS]?))?(?:_(?P<power>[0-9]{1,9}))?")
HOW_TO_NAME = (
    "name the constant matrices M, G, C, K (or A alone, for x' = A x), and what the excitation adds to them K1c, K1s, "
    "K2c, C1c, ..., with a power of ε behind an underscore: K1c_2, K0_1"
)
# What to do with the part of a matrix that has the wrong symmetry.
SYMMETRY_HINTS = {
    "C": "; its skew part is gyroscopic: put (C - C')/2 into G and (C + C')/2 into C",
    "G": "; its symmetric part is damping: put (G + G')/2 into C and (G - G')/2 into G",
}


class Part(NamedTuple):
    """One matrix of a file: the part eps^power cos or sin(harmonic Omega t) of the matrix ``letter``."""

    letter: str
    harmonic: int = 0
    wave: str = ""
    power: int = 0

    @property
    def name(self) -> str:
        """What the matrix is called in a file."""
        if self.power == 0:
            return self.letter
        power = "" if self.power == 1 and self.harmonic else f"_{self.power}"
        return f"{self.letter}{self.harmonic}{self.wave}{power}"


def part_of(name: str) -> Part:
    """Return what a name means.

    Raises
    ------
    ValueError
        If it means nothing; the message says which name may have been meant.
    """
    upper = name.upper()
    found = NAME.fullmatch(upper)
    if found is None:
        raise ValueError(f"{name!r} is no matrix of a system{_meant(upper)}; {HOW_TO_NAME}")
    letter = "K" if found["letter"] == OLD_STIFFNESS_LETTER else found["letter"]
    harmonic, wave, power = found["harmonic"], found["wave"] or "", found["power"]
    if harmonic is None and power is None and found["letter"] != OLD_STIFFNESS_LETTER:
        return Part(letter)
    if harmonic is None or bool(int(harmonic)) != bool(wave):
        raise ValueError(f"{name!r} is no matrix of a system{_meant(upper)}; {HOW_TO_NAME}")
    if int(harmonic) > MAX_FILE_HARMONICS:
        raise ValueError(f"{name} is beyond harmonic {MAX_FILE_HARMONICS}; leave it out")
    if power is None and not wave:
        raise ValueError(
            f"{name!r} is a constant without a power of ε; call it {letter}, or {letter}0_1 if it grows with ε"
        )
    if not 1 <= int(power or 1) <= MAX_POWER:
        raise ValueError(f"{name} has the power {power} of ε; give one from 1 to {MAX_POWER}")
    return Part(letter, int(harmonic), wave.lower(), int(power or 1))


def parts_of(names: Iterable[str]) -> dict[str, Part]:
    """Return {name: part} of all names in a file, refusing unknown, repeated and missing ones.

    Raises
    ------
    ValueError
        With what is wrong, and what to do.
    """
    parts: dict[str, Part] = {}
    for name in names:
        part = part_of(name)
        for other, taken in parts.items():
            if taken == part:
                raise ValueError(f"{part.name} is there twice, as {other} and as {name}; keep one")
        parts[name] = part
    letters = {part.letter for part in parts.values()}
    first_order = STATE_LETTER in letters
    if first_order and len(letters) > 1:
        others = ", ".join(sorted(name for name, part in parts.items() if part.letter != STATE_LETTER))
        raise ValueError(f"A stands for x' = A x, which has no {others}; leave them out, or A")
    for letter in (STATE_LETTER,) if first_order else REQUIRED_MATRICES:
        if Part(letter) not in parts.values():
            raise ValueError(f"{letter} is missing; add it")
    if not any(part.power for part in parts.values()):
        wanted = "A1c, A1s, A2c" if first_order else "K1c, K1s, K2c"
        raise ValueError(f"there is no excitation; add at least one of {wanted}, ...")
    return parts


def system_of(matrices: Mapping[Part, FloatArray]) -> PeriodicSystem | FirstOrderSystem:
    """Return the system that the matrices make.

    Raises
    ------
    ValueError
        If one of them is not what its name asks for; the message begins with that name.
    """
    excited = STATE_LETTER if Part(STATE_LETTER) in matrices else "K"  # whose harmonics have a short form
    cosine, sine = _short(matrices, excited)
    terms = [
        _term(part, matrix)
        for part, matrix in matrices.items()
        if part.power and not (part.letter == excited and part.power == 1 and part.wave)
    ]
    if excited == STATE_LETTER:
        return FirstOrderSystem(matrices[Part(STATE_LETTER)], cosine, sine, terms=terms)
    constant: dict[str, Any] = {of: matrices.get(Part(letter)) for of, letter in MATRIX_NAMES.items()}
    try:
        return PeriodicSystem(**constant, cosine=cosine, sine=sine, terms=terms)
    except ValueError as error:
        raise _named(error) from None


def sparse_system_of(matrices: Mapping[Part, Any]) -> SparseSystem:
    """Return the large system that sparse matrices make.

    Raises
    ------
    ValueError
        If one of them is not what its name asks for; the message begins with that name.
    """
    if Part(STATE_LETTER) in matrices:
        raise ValueError("A has too many states: only M, G, C, K can be reduced to their lowest modes; give these")
    constant: dict[str, Any] = {of: matrices.get(Part(letter)) for of, letter in MATRIX_NAMES.items()}
    terms = [_term(part, matrix) for part, matrix in matrices.items() if part.power]
    try:
        return SparseSystem(**constant, terms=terms)
    except ValueError as error:
        raise _named(error) from None


def matrices_of(system: PeriodicSystem | FirstOrderSystem) -> dict[Part, FloatArray]:
    """Return the matrices of a system, without those that are zero and not needed.

    Raises
    ------
    ValueError
        If a waveform is not a finite Fourier sum, or has more harmonics than a file may have.
    """
    if isinstance(system, FirstOrderSystem):
        found, excited = {Part(STATE_LETTER): system.constant}, STATE_LETTER
    else:
        found, excited = {Part(letter): getattr(system, of) for of, letter in MATRIX_NAMES.items()}, "K"
    for j, (cosine, sine) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        found |= {Part(excited, j, "c", 1): cosine, Part(excited, j, "s", 1): sine}
    letters = {of: letter for letter, of in OF_LETTER.items()}
    for term in system.terms:
        wave = term.waveform
        if not isinstance(wave, Trigonometric) or wave.rest:
            raise ValueError(
                f"system has the waveform {type(wave).__name__} in a term of {term.of!r}, which no file of matrices "
                "holds; write the system into a Python file"
            )
        for name, coefficients in (("c", wave.cosines), ("s", wave.sines)):
            for j, coefficient in enumerate(coefficients):
                if coefficient:
                    part = Part(letters[term.of], j, name if j else "", term.power)
                    found[part] = found.get(part, np.zeros_like(term.matrix)) + coefficient * term.matrix
    highest = max(part.harmonic for part in found)
    if highest > MAX_FILE_HARMONICS:
        raise ValueError(f"system has {highest} harmonics; give at most {MAX_FILE_HARMONICS}")
    # The last cosine stays even if zero: it says how many harmonics there are.
    needed = {*map(Part, REQUIRED_MATRICES), Part(STATE_LETTER), Part(excited, len(system.cosine), "c", 1)}
    return {part: matrix for part, matrix in found.items() if part in needed or matrix.any()}


def _short(matrices: Mapping[Part, FloatArray], letter: str) -> tuple[FloatArray | None, FloatArray | None]:
    """Return the harmonics with eps^1 of one matrix as arrays (J, n, n); None if there are none."""
    mine = {part: X for part, X in matrices.items() if part.letter == letter and part.power == 1 and part.wave}
    if not mine:
        return None, None
    J, zero = max(part.harmonic for part in mine), np.zeros_like(next(iter(mine.values())))
    cosine, sine = (
        np.array([mine.get(Part(letter, j, wave, 1), zero) for j in range(1, J + 1)]) for wave in ("c", "s")
    )
    return cosine, sine


def _term(part: Part, matrix: FloatArray) -> Term:
    wave = {"c": waveforms.cosine, "s": waveforms.sine}
    waveform = wave[part.wave](part.harmonic) if part.wave else waveforms.constant()
    try:
        return Term(OF_LETTER[part.letter], matrix, waveform, part.power)
    except ValueError as error:
        fault = str(error).partition("'s matrix ")[2] or str(error)
        raise ValueError(f"{part.name} {fault}{_hint(part.letter, fault)}") from None


def _named(error: ValueError) -> ValueError:
    """Return an error of a system with the letter of the matrix that it is about."""
    field, _, fault = str(error).partition(" ")
    letter = MATRIX_NAMES.get(field, "the system")
    return ValueError(f"{letter} ({field}) {fault}{_hint(letter, fault)}")


def _hint(letter: str, fault: str) -> str:
    return SYMMETRY_HINTS.get(letter, "") if "symmetric" in fault else ""


def _meant(upper: str) -> str:
    """Return a guess at what a wrong name should be; nothing if it is like none."""
    usual = [f"{letter}{ending}" for letter in OF_LETTER for ending in ("", "1c", "1s", "2c", "2s", "0_1", "1c_2")]
    close = [name for name in usual if sorted(name.upper()) == sorted(upper)]  # the same letters in another order
    close += sorted(n for n in usual if n.upper() in get_close_matches(upper, map(str.upper, usual), n=2, cutoff=0.75))
    return f" (did you mean {close[0]}?)" if close else ""
