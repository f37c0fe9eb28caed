"""Sphinx configuration."""

import re
from typing import Any

import spectral_contact

project = "spectral_contact"
version = release = spectral_contact.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
default_role = "py:obj"

html_theme = "furo"
html_title = f"spectral_contact {version}"

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say what a type means, not only its name
napoleon_google_docstring = False
napoleon_use_rtype = False

_LITERAL = re.compile(r"(``.*?``)")


def _escape_bars(
    _app: Any, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Keep the bars of a modulus: reStructuredText takes ``|q|`` for a substitution."""
    for i, line in enumerate(lines):
        parts = _LITERAL.split(line)
        lines[i] = "".join(p if p.startswith("``") else p.replace("|", r"\|") for p in parts)


def setup(app: Any) -> None:
    """Register the filter of docstrings."""
    app.connect("autodoc-process-docstring", _escape_bars)
