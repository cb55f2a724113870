"""Damage to any file and to any text, whatever they mean; `fuzz.py` does it to case files and matrices."""

from __future__ import annotations

import re

import numpy as np

Random = np.random.Generator

# --- bytes: nothing is known of the format ---


def flip(data: bytes, random: Random) -> bytes:
    changed = bytearray(data)
    for _ in range(int(random.integers(1, 6))):
        changed[int(random.integers(len(changed)))] ^= 1 << int(random.integers(8))
    return bytes(changed)


def truncate(data: bytes, random: Random) -> bytes:
    return data[: int(random.integers(len(data)))]


def transplant(data: bytes, random: Random) -> bytes:
    """Delete, repeat or move a piece."""
    a, b, c = sorted(int(i) for i in random.integers(len(data) + 1, size=3))
    return [data[:a] + data[b:], data[:b] + data[a:], data[:a] + data[b:c] + data[a:b] + data[c:]][random.integers(3)]


BYTES = {"bytes flipped": flip, "truncated": truncate, "pieces moved": transplant}

# --- words: text with other numbers and words in it ---

WORDS = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "1000000000",
    "-1000000000",
    "99999999999999999999999999",
    "0x1F",
    "1_000",
    "1e5",
    "true",
    "false",
    '"text"',
    '""',
    "[]",
    "[1]",
    "[[1.0,2.0]]",
    "{}",
    "{a=1}",
    "1979-05-27",
    "speed",
    "plate",
    "load",
    "M",
    "K",
    "F1c",
    "%",
    "#",
]
TOKEN = re.compile(rb"[A-Za-z_][\w-]*|[-+]?\d[\w.+-]*|\"[^\"\n]*\"|[\[\]{}=,%]")


def other_word(text: bytes, random: Random) -> bytes:
    found = list(TOKEN.finditer(text))
    one = found[random.integers(len(found))]
    return text[: one.start()] + WORDS[random.integers(len(WORDS))].encode() + text[one.end() :]


def words_swapped(text: bytes, random: Random) -> bytes:
    found = list(TOKEN.finditer(text))
    one, two = sorted((found[i] for i in random.choice(len(found), 2, replace=False)), key=lambda m: m.start())
    return text[: one.start()] + two[0] + text[one.end() : two.start()] + one[0] + text[two.end() :]


def lines_changed(text: bytes, random: Random) -> bytes:
    """Drop, double or swap lines: keys missing or there twice."""
    lines = text.splitlines(keepends=True)
    i, j = random.integers(len(lines), size=2)
    match random.integers(3):
        case 0:
            del lines[i]
        case 1:
            lines.insert(j, lines[i])
        case _:
            lines[i], lines[j] = lines[j], lines[i]
    return b"".join(lines)


TEXT = BYTES | {"another word": other_word, "words swapped": words_swapped, "lines changed": lines_changed}
