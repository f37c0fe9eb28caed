"""Sphinx configuration."""

import contextlib
import inspect
import re
from typing import Any

from docutils import nodes
from sphinx.util.nodes import make_refnode

import spectral_contact

project = "spectral_contact"
copyright = "2026, the spectral_contact authors"
version = release = spectral_contact.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
# formulas without a script from elsewhere, and buttons to copy examples
extensions += ["sphinx-mathjax-offline", "sphinx_copybutton"]
exclude_patterns = ["_build"]
# Pages that are notebooks run when the site is built, and stop it where they fail.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_output_stderr = "remove"  # lines of progress
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

# With -n: types are prose unless they begin with a capital, and other packages are not linked.
nitpick_ignore_regex = [
    ("py:class", r"[a-z].*|Path"),
    ("py:obj", r"(dataclasses|matplotlib|mpmath|numpy|os|pathlib|scipy|xarray)\..*"),
]

_LITERAL = re.compile(r"(``.*?``)")


def _escape_bars(
    _app: Any, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Keep the bars of a modulus: reStructuredText takes ``|q|`` for a substitution."""
    for i, line in enumerate(lines):
        parts = _LITERAL.split(line)
        lines[i] = "".join(p if p.startswith("``") else p.replace("|", r"\|") for p in parts)


def _note_parameters(app: Any, _what: str, _name: str, thing: Any, *_rest: Any) -> None:
    """Remember the parameters of what is documented: docstrings quote them like names."""
    known = app.env.__dict__.setdefault("spectral_contact_parameters", set())
    if callable(thing):
        with contextlib.suppress(TypeError, ValueError):
            known.update(inspect.signature(thing).parameters)


def _resolve(app: Any, env: Any, node: Any, content: Any) -> Any:
    """Resolve a name that docstrings give without its module; a parameter is no link."""
    target = node.get("reftarget", "")
    if node.get("refdomain") != "py" or node["reftype"] not in {"obj", "class"}:
        return None
    domain = env.get_domain("py")
    found = [one for one in domain.objects if one == target or one.endswith(f".{target}")]
    if found:
        # a name has one home; what merely passes it on is longer
        name = min(found, key=len)
        place = domain.objects[name]
        return make_refnode(
            app.builder, node["refdoc"], place.docname, place.node_id, content, name
        )
    return content if target in getattr(env, "spectral_contact_parameters", ()) else None


def _mark_cells(_app: Any, document: Any) -> None:
    """Mark the cells of a number, which must not be broken, and those of much text."""
    for cell in document.findall(nodes.entry):
        text = cell.astext()
        if len(text) < 24 and any(one.isdigit() for one in text):
            cell["classes"].append("number")
        elif len(text) > 90:
            cell["classes"].append("prose")


def _join_parameters(_app: Any, document: Any) -> None:
    """List parameters that share type and description as one item: Napoleon repeats these."""
    for field in document.findall(nodes.field):
        # of the item before: its names, and the text that follows them
        names: list[Any] = []
        shared = None
        for item in list(field.findall(nodes.list_item)):
            paragraph = item[0]
            name = paragraph[0]
            text = paragraph.astext().removeprefix(name.astext())
            if not (isinstance(name, nodes.strong) and " – " in text):
                names = []
                shared = None
            elif text == shared:
                first = names[-1].parent
                place = first.index(names[-1]) + 1
                first.insert(place, [nodes.Text(", "), name])
                names.append(name)
                item.parent.remove(item)
            else:
                names = [name]
                shared = text


def setup(app: Any) -> None:
    """Register the filters of docstrings, lists and tables, and the resolution of short names."""
    app.connect("autodoc-process-docstring", _escape_bars)
    app.connect("autodoc-process-docstring", _note_parameters)
    app.connect("doctree-read", _join_parameters)
    app.connect("doctree-read", _mark_cells)
    app.connect("missing-reference", _resolve)
