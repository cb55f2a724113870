"""The figures as Markdown tables, and their place in a page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from llvmlite.binding import get_host_cpu_name
from threadpoolctl import threadpool_info

from benchmarks.general import GeneralTiming
from benchmarks.methods import Comparison
from benchmarks.stages import Stages

# What is between these lines of a page is replaced; the rest of the page is kept.
TABLES_BEGIN, TABLES_END = "<!-- begin: benchmarks/__main__.py -->", "<!-- end: benchmarks/__main__.py -->"


def conditions() -> str:
    """Return in one line what was measured on, and how busy it was with other work."""
    libraries = {f"{found['internal_api']} {found.get('architecture', '')}".strip() for found in threadpool_info()}
    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    return f"{get_host_cpu_name()}, {os.cpu_count()} cores, load {load}, {', '.join(sorted(libraries))}."


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Return the figures as a Markdown table."""
    lines = [
        "| n | damping | method | error of | CPU µs per point | spread | times the chart | error | setting |",
        "|--:|--:|:--|:--|--:|--:|--:|--:|--:|",
    ]
    for found in comparisons:
        for timing in (*found.chart, *found.peers):
            start = f"| {found.size} | {found.damping:g} | {timing.method} | {timing.criterion} |"
            if timing.skipped:
                lines.append(f"{start} skipped: {timing.skipped} | | | | |")
                continue
            ratio = timing.median / found.chart[0].median
            setting = "" if np.isnan(timing.setting) else f"{timing.setting:g}"
            lines.append(
                f"{start} {1e6 * timing.median:,.1f} | {timing.spread:.0%} | {ratio:,.0f} | {timing.error:.0e} "
                f"| {setting} |"
            )
    return "\n".join(lines)


def general_table(found: Sequence[GeneralTiming]) -> str:
    """Return the figures of other systems than eq. (11) as a Markdown table."""
    lines = [
        "| chart | points | CPU µs per point | times the cosine (least, largest) | error | DOP853, µs | times | rtol |",
        "|:--|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for one in found:
        ours = float(np.median(one.seconds))
        ratio = ""
        if one.ratios:
            ratio = f"{np.median(one.ratios):.2f} ({min(one.ratios):.2f}, {max(one.ratios):.2f})"
        peer = "no setting reached 1e-08 | | |"
        if np.isfinite(one.peer_seconds):
            peer = f"{1e6 * one.peer_seconds:,.0f} | {one.peer_seconds / ours:,.0f} | {one.peer_setting:g} |"
        lines.append(f"| {one.name} | {one.points:,} | {1e6 * ours:,.1f} | {ratio} | {one.error:.0e} | {peer}")
    return "\n".join(lines)


def stages_table(found: dict[tuple[int, float], Stages]) -> str:
    """Return the shares of the stages of each (n, damping) as a Markdown table."""
    lines = [
        "| n | damping | samples (doubling) | eigenvalues | the rest | products, GFLOP/s | of the peak |",
        "|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for (size, damping), s in found.items():
        parts = np.array([s.sampling, s.eigenvalues, s.rest])
        shares = " | ".join(f"{part:.0%}" for part in parts / parts.sum())
        lines.append(f"| {size} | {damping:g} | {shares} | {s.rate / 1e9:.0f} | {s.rate / s.peak:.0%} |")
    return "\n".join(lines)


def scaling_table(rows: Sequence[tuple[str, float, float]]) -> str:
    lines = ["| n = 28, damped | CPU µs per point | wall s |", "|:--|--:|--:|"]
    lines += [f"| {what} | {cpu:.1f} | {wall:.2f} |" for what, cpu, wall in rows]
    return "\n".join([*lines, f"\nParallel efficiency on two cores: {rows[-2][2] / (2 * rows[-1][2]):.2f}."])


def start_up_table(rows: Sequence[tuple[str, float, float, float]]) -> str:
    lines = ["| in a new process | wall s | CPU s | peak MB |", "|:--|--:|--:|--:|"]
    return "\n".join(lines + [f"| {what} | {wall:.1f} | {cpu:.1f} | {mb:.0f} |" for what, wall, cpu, mb in rows])


def surroundings(path: Path) -> tuple[str, str]:
    """Return what is before and after the marks in the file; nothing if there is no file.

    Raises
    ------
    OSError
        If the file cannot be read, or has no marks.
    """
    if not path.exists():
        return "", "\n"
    head, begun, rest = path.read_text(encoding="utf-8").partition(TABLES_BEGIN)
    _, ended, tail = rest.partition(TABLES_END)
    if not (begun and ended):
        raise OSError(f"{path} has no lines {TABLES_BEGIN} and {TABLES_END}; put them where the tables shall be")
    return head, tail


def write_between(path: Path, text: str) -> None:
    """Put ``text`` between the marks in the file; make the file if there is none."""
    head, tail = surroundings(path)
    path.write_text(f"{head}{TABLES_BEGIN}\n{text}\n{TABLES_END}{tail}", encoding="utf-8")
