"""The shape of the library: layers, exports, imports, size of the modules, silence."""

import ast
import functools
import importlib
import io
import re
import subprocess
import sys
import tokenize
from pathlib import Path

import pytest

import spectral_contact

REPOSITORY = Path(__file__).parents[2]
PACKAGE = Path(spectral_contact.__file__).parent
#: Lines of code in a module, without docstrings, comments and blank lines.
LONGEST_MODULE = 450
#: Tokens that are no code.
LAYOUT = {
    tokenize.COMMENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
    tokenize.INDENT,
    tokenize.NEWLINE,
    tokenize.NL,
}

SOURCES = sorted(PACKAGE.rglob("*.py"))


@functools.cache
def tree_of(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def trees():
    """Return (path, syntax tree) of each module."""
    return [(path, tree_of(path)) for path in SOURCES]


def dotted(path):
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


NAMES = {dotted(path): path for path in SOURCES}
API = (REPOSITORY / "docs" / "api.md").read_text(encoding="utf-8")
#: What users import from: packages, modules at the root, and those of docs/api.md. The others list
#: nothing: underscores mark the private.
PUBLIC = [
    name
    for name, path in NAMES.items()
    if path.name == "__init__.py"
    or (path.parent == PACKAGE and path.name[0] != "_")
    or re.search(rf":: {re.escape(name)}\b", API)
]


def exports(name):
    return importlib.import_module(name).__all__


def defined(tree):
    """Return the public functions and classes that a module defines itself."""
    kinds = ast.FunctionDef, ast.ClassDef
    return {node.name for node in tree.body if isinstance(node, kinds) and node.name[0] != "_"}


def imported_between_modules():
    """Return (importer, module, name) of every import of a name from a module of the package."""
    return [
        (dotted(path), node.module, alias.name)
        for path, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module in NAMES
        for alias in node.names
        if f"{node.module}.{alias.name}" not in NAMES
    ]


def sorting_key(name):
    """Constants, then classes, then functions: the order that ruff's RUF022 keeps."""
    rank = 0 if name.isupper() else 1 if name[0].isupper() else 2
    return rank, name


@functools.cache
def python(code):
    """Run code in a fresh interpreter, and return what it prints."""
    command = [sys.executable, "-c", code]
    run = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


def test_the_import_contracts_hold():
    pytest.importorskip("importlinter", reason="part of the extra: dev")
    code = (
        "from importlinter.cli import lint_imports; raise SystemExit(lint_imports(no_cache=True))"
    )
    assert "0 broken" in python(code)


@pytest.mark.parametrize("name", PUBLIC)
def test_exports_exist_are_sorted_and_complete(name):
    names = list(exports(name))
    assert names == sorted(set(names), key=sorting_key)
    module = importlib.import_module(name)
    assert [one for one in names if not hasattr(module, one)] == []
    assert defined(tree_of(NAMES[name])) - set(names) == set()


def test_modules_import_from_each_other_only_what_is_exported():
    private = [
        found
        for found in imported_between_modules()
        if (found[2] not in exports(found[1]) if found[1] in PUBLIC else found[2][0] == "_")
    ]
    assert private == []


def test_the_records_are_exported_by_solution():
    assert (
        set(exports("spectral_contact.records")) - set(exports("spectral_contact.solution"))
        == set()
    )


def loaded_modules():
    """Return what the import of the library loads, and what that of its closed forms after it."""
    code = "import sys, spectral_contact; print(*sys.modules); "
    code += "import spectral_contact.closed_forms; print(*sys.modules)"
    return [line.split() for line in python(code).splitlines()]


@pytest.mark.parametrize("absent", ["matplotlib", "mpmath", "spectral_contact.closed_forms"])
def test_the_import_of_the_library_does_not_import(absent):
    loaded, _ = loaded_modules()
    assert "spectral_contact.solving.solver" in loaded
    assert absent not in loaded


def test_closed_forms_do_not_plot():
    _, loaded = loaded_modules()
    assert "spectral_contact.closed_forms.smooth" in loaded
    assert "matplotlib" not in loaded


def test_what_reaches_up_does_so_in_functions_alone():
    """The contracts let view.output import everything: at its top it imports what is below."""
    [tree] = [tree for path, tree in trees() if dotted(path) == "spectral_contact.view.output"]
    at_the_top = {node.module for node in tree.body if isinstance(node, ast.ImportFrom)}
    library = {name for name in at_the_top if name.startswith("spectral_contact")}
    assert library == {"spectral_contact.io.choices"}


def test_modules_of_the_library_are_imported_by_statements():
    """A module whose name is a string is an arrow that no checker sees."""
    by_name = [
        dotted(path)
        for path, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and ast.unparse(node.func).endswith("import_module")
        and "spectral_contact" in ast.unparse(node)
    ]
    assert by_name == []


def test_the_library_is_silent():
    """Results are returned and progress is logged: only the command line prints."""
    prints = [
        f"{dotted(path)}:{node.lineno}"
        for path, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and getattr(node.func, "id", None) == "print"
    ]
    command_line = "spectral_contact.__main__:", "spectral_contact.view.cli."
    assert [place for place in prints if not place.startswith(command_line)] == []


def docstring_lines(tree):
    """Return the lines of all docstrings of a module."""
    documented = ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef
    lines = set()
    for node in ast.walk(tree):
        if isinstance(node, documented) and ast.get_docstring(node) is not None:
            docstring = node.body[0]
            lines.update(range(docstring.lineno, docstring.end_lineno + 1))
    return lines


def code_lines(source):
    """Return the number of lines of code, without docstrings, comments and blank lines."""
    lines = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in LAYOUT:
            lines.update(range(token.start[0], token.end[0] + 1))
    return len(lines - docstring_lines(ast.parse(source)))


def test_docstrings_comments_and_blank_lines_are_no_code():
    source = '''"""A module.

    It has one function.
    """

# a comment
def function(x):  # another one
    """Return x,

    unchanged.
    """

    text = """two
lines"""
    return x
'''
    assert code_lines(source) == 4


def test_modules_fit_a_sitting():
    sources = {dotted(path): path.read_text(encoding="utf-8") for path in SOURCES}
    # code has to be counted where there are so many lines at all
    long = {name: one for name, one in sources.items() if one.count("\n") >= LONGEST_MODULE}
    assert long
    assert [name for name, one in long.items() if code_lines(one) > LONGEST_MODULE] == []


def test_every_module_says_what_it_is_for():
    assert [dotted(path) for path, tree in trees() if not ast.get_docstring(tree)] == []


def test_unit_tests_are_of_the_module_that_their_path_names():
    """`unit/a/test_b.py` is the test of `a/b.py`, `unit/a/test_a.py` that of `a/__init__.py`."""
    unit = REPOSITORY / "tests" / "unit"
    strays = []
    for path in sorted(unit.rglob("*.py")):
        folder = PACKAGE / path.parent.relative_to(unit)
        name = path.stem.removeprefix("test_")
        modules = [folder / f"{name}.py", folder / f"__{name}__.py"]
        if folder.name == name:
            modules.append(folder / "__init__.py")
        if not any(module in SOURCES for module in modules):
            strays.append(str(path.relative_to(REPOSITORY)))
    assert strays == []
