"""Sphinx configuration."""

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert

import spectral_contact

project = "spectral_contact"
version = release = spectral_contact.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
html_math_renderer = "mathml"  # below: browsers draw it themselves, without a script from elsewhere
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
default_role = "py:obj"

html_theme = "furo"
html_title = f"spectral_contact {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]

# What is copied runs: no prompts, no output.
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

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


def _inline(self: Any, node: Any) -> None:
    """Write a formula within a line as MathML."""
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _display(self: Any, node: Any) -> None:
    """Write a displayed formula as MathML, in a box that scrolls if it is wider than the page."""
    formula = convert(node.astext(), display="block")
    self.body.append(f'<div class="math">{formula}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> None:
    """Register the filter of docstrings and the renderer of formulas."""
    app.connect("autodoc-process-docstring", _escape_bars)
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
