"""What the audit of a chart found, in a sentence."""

from __future__ import annotations

from floquet.chart import ChartAudit


def audit_sentence(audit: ChartAudit | None) -> str:
    """Return in a sentence whether the cells that were integrated again, by another method, confirm the chart."""
    if audit is None or not audit.compared:
        return "No cell of the chart was integrated again by another method."
    cells, differ = ("1 cell", "differs") if audit.compared == 1 else (f"{audit.compared} cells", "differ")
    found = (
        f"{cells} of the chart, integrated again by another method, {differ} by at most "
        f"{audit.largest_difference:.1e} in log|μ|"
    )
    if audit.contradictions.any():
        return f"{found}; the opposite verdict came out for {audit.contradictions.sum()}: DO NOT TRUST THIS CHART."
    if not audit.ok:
        return f"{found}, up to {audit.largest_ratio:.1f} times the estimated error: DO NOT TRUST THIS CHART."
    return f"{found}, within the estimated error."
