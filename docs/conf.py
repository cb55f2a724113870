"""The documentation site, built by `make docs` into site/. Reading it fetches nothing from a network.

Mathematics is written in plain Unicode, as in the code: it needs no script, and reads the same in an editor.
"""

from __future__ import annotations

from typing import Any

project = "floquet-charts"
extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]

html_theme = "furo"
html_title = project
html_copy_source = False
html_show_copyright = False
html_static_path = ["site.css"]
html_css_files = ["site.css"]
smartquotes_action = "D"  # dashes only: W' is a derivative
myst_heading_anchors = 3

default_role = "py:obj"  # `name` in a docstring links to it
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say more: shapes and units
numpydoc_show_class_members = False  # the API pages choose them


def _moduli(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Keep |x| in docstrings a modulus, which reStructuredText would take for a substitution."""
    for i, line in enumerate(lines):
        parts = line.split("``")
        parts[::2] = [text.replace("|", r"\|") for text in parts[::2]]
        lines[i] = "``".join(parts)


def setup(app: Any) -> None:
    app.connect("autodoc-process-docstring", _moduli, priority=999)  # after numpydoc
