"""Measure the size of the house, and hold it to what it was: python validation/size.py.

Prints one table: each figure, what it was at commit c22aa78, what it is today, what it may be at
most (the gate), and the goal. Exits with 1 where a figure is above its gate; one without a gate is
reported. When a figure falls, lower its gate with it, in size.toml. Needs radon and grimp, which
the extra `dev` has.

What is counted, of the flat core unless a figure says more:

flat core
    All modules of contact/ and spectral/ but those that came with profiles, nonlinear layers,
    sensitivities, adhesion and unloading (size.toml).
tokens
    Tokens of Python's `tokenize`: names, keywords, operators, brackets, numbers and strings. Not
    counted are comments, docstrings, ends of lines and indentation. An f-string is one token
    whatever it holds, on every version of Python. A long name costs as much as a short one.
code lines
    Lines on which a counted token begins.
named numeric constants
    Names in capitals that are bound at the top of a module to a value with a number in it, or to
    arithmetic on other such names.
tuned constants
    Numbers other than 0, ±1, 1/2, 2, 3 and 4 at the top of a module, without those of which the
    comment ``#:`` above cites a formula; arithmetic on names alone counts as one number. In the
    tuning tables, the modules named tuning.py, every name counts, of a table every such number.
tuned literals in functions
    The same numbers inside functions and classes, unless the docstring of the function, of what
    encloses it or of the module cites a formula. The goal is none: they become named, or go.
    A citation is docs/theory, Eq., or a year in parentheses as (1974) or (Spence, 1975).
packed assignments
    Statements that bind a tuple of names to a tuple of values, as ``a, b = x, y``.
private words
    How often identifiers use words of private_words.toml, which says what to write instead.
complexity
    Cyclomatic complexity of the functions of the whole library, by radon.
code lines of a room
    Code lines of what is around the core (size.toml): parts of the library, validation and tests.
late imports upwards
    Modules that those in `LATE` import in functions: what makes the output of a solution or of a
    study. They are no links of circles and chains. At c22aa78 their names were strings.
"""

from __future__ import annotations

import ast
import io
import keyword
import re
import sys
import tokenize
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[1]
PRIVATE_WORDS = Path(__file__).parent / "private_words.toml"
NAME = "spectral_contact"
CORE = ("contact", "spectral")
#: What holds the core and what runs it: code that moves from one to the other is no saving.
CORE_AND_SOLVING = ("contact", "spectral", "solving")
#: Numbers that are no tuned ones; signs are no part of a number.
PLAIN = (0, 0.5, 1, 2, 3, 4)
CITATION = re.compile(r"docs/theory|\bEqs?\.|\((?:[^()]*\s)?(?:18|19|20)\d\d[a-z]?(?:,[^()]*)?\)")
MOST_COMPLEX = 25
#: Modules whose methods import what is above them when they are called: output of a solution, and
#: of a study. What they import in functions is no link of a chain, and is counted by itself.
LATE = ("view.output", "studies.study_results")
COMPLEX = 15
#: What has a docstring, but for modules.
DEFINITIONS = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
#: How many of the worst are named.
NAMED = 5
#: Gates, rooms around the core, and what is no part of the flat core.
TABLE = tomllib.loads((Path(__file__).parent / "size.toml").read_text(encoding="utf-8"))
CAME_WITH: dict[str, list[str]] = TABLE["came_with"]
ROOMS = {room["name"]: room for room in TABLE["room"]}


@dataclass(frozen=True)
class Gate:
    """A figure, what it was at commit c22aa78, what it may be, and what it should become.

    A figure without a `limit` is reported, not held.
    """

    figure: str
    before: int
    limit: int | None = None
    goal: int | None = None


GATES = [
    *(Gate(**gate) for gate in TABLE["gate"]),
    *(
        Gate(f"code lines of {name}", room["before"], None, room.get("goal"))
        for name, room in ROOMS.items()
    ),
]


@dataclass(frozen=True)
class Module:
    """One source file of the library."""

    name: str
    text: str
    tree: ast.Module

    @property
    def package(self) -> str:
        """The package at the root that it is in, or the root itself."""
        parts = self.name.split(".")
        is_package = len(parts) == 2 and self.name in packages()
        return parts[1] if len(parts) > 2 or is_package else "(root)"

    @property
    def short_name(self) -> str:
        """Its dotted name without that of the library."""
        return self.name.removeprefix(f"{NAME}.")

    @property
    def is_tuning_table(self) -> bool:
        """Whether it holds the tuned constants of its package."""
        return self.name.endswith(".tuning")


@cache
def packages() -> frozenset[str]:
    """Return the dotted names of all packages."""
    paths = (REPOSITORY / NAME).rglob("__init__.py")
    return frozenset(".".join(path.parent.relative_to(REPOSITORY).parts) for path in paths)


@cache
def files() -> dict[str, Path]:
    """Return the files of all modules by their dotted names."""
    result = {}
    for path in sorted((REPOSITORY / NAME).rglob("*.py")):
        parts = path.relative_to(REPOSITORY).with_suffix("").parts
        result[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return result


@cache
def modules() -> dict[str, Module]:
    """Return all modules by their dotted names."""
    result = {}
    for name, path in files().items():
        text = path.read_text(encoding="utf-8")
        result[name] = Module(name, text, ast.parse(text))
    return result


def modules_of(names: tuple[str, ...]) -> list[Module]:
    """Return the modules of some packages at the root."""
    return [module for module in modules().values() if module.package in names]


def flat_core() -> list[Module]:
    """Return the modules of the core that a flat punch with linear layers needs."""
    excluded = {name for names in CAME_WITH.values() for name in names}
    return [module for module in modules_of(CORE) if module.short_name not in excluded]


def stale_exclusions() -> list[str]:
    """Return the names of `CAME_WITH` that no module has."""
    return [
        name for names in CAME_WITH.values() for name in names if f"{NAME}.{name}" not in files()
    ]


def docstring_starts(tree: ast.Module) -> set[tuple[int, int]]:
    """Return the positions, line and column, at which docstrings begin."""
    starts = set()
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, *DEFINITIONS)):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                starts.add((first.lineno, first.col_offset))
    return starts


def code_tokens(text: str) -> Iterator[tokenize.TokenInfo]:
    """Yield the tokens of a source text that count, of an f-string the first."""
    docstrings = docstring_starts(ast.parse(text))
    layout = ("COMMENT", "NL", "NEWLINE", "INDENT", "DEDENT", "ENDMARKER")
    depth = 0
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        kind = tokenize.tok_name[token.type]
        # a part of an f-string, of Python 3.12 and later
        inside = depth > 0
        depth += kind in ("FSTRING_START", "TSTRING_START")
        depth -= kind in ("FSTRING_END", "TSTRING_END")
        if not inside and kind not in layout and token.start not in docstrings:
            yield token


@cache
def token_count(module: Module) -> int:
    """Count the tokens of a module."""
    return sum(1 for _ in code_tokens(module.text))


def code_line_count(module: Module) -> int:
    """Count the lines of a module on which a token begins."""
    return _code_lines(module.text)


def _code_lines(text: str) -> int:
    return len({token.start[0] for token in code_tokens(text)})


def room_lines(room: str) -> int:
    """Count the code lines of what is around the core."""
    outside = [REPOSITORY / one for one in ROOMS[room].get("without", ())]
    paths = {
        path
        for one in ROOMS[room]["paths"]
        for path in (
            [REPOSITORY / one] if one.endswith(".py") else (REPOSITORY / one).rglob("*.py")
        )
        if not any(map(path.is_relative_to, outside))
    }
    return sum(_code_lines(path.read_text(encoding="utf-8")) for path in paths)


def numbers(node: ast.AST) -> list[ast.Constant]:
    """Return the number literals below a node."""
    return [
        child
        for child in ast.walk(node)
        if isinstance(child, ast.Constant) and type(child.value) in (int, float)
    ]


def tuned_numbers(node: ast.AST) -> int:
    """Count the number literals below a node that are not plain."""
    return sum(literal.value not in PLAIN for literal in numbers(node))


def is_capital(name: str) -> bool:
    """Whether a name is that of a constant."""
    return name.isupper() and len(name.lstrip("_")) > 1


def _is_arithmetic_on_names(value: ast.expr) -> bool:
    return isinstance(value, ast.BinOp) and any(
        isinstance(child, ast.Name) and is_capital(child.id) for child in ast.walk(value)
    )


@dataclass(frozen=True)
class Assignment:
    """A statement at the top of a module that binds names."""

    names: tuple[str, ...]
    value: ast.expr
    line: int

    @property
    def constants(self) -> tuple[str, ...]:
        """The names of numeric constants that it binds."""
        if numbers(self.value) or _is_arithmetic_on_names(self.value):
            return tuple(name for name in self.names if name.isupper())
        return ()

    @property
    def tuned(self) -> int:
        """How many tuned constants it counts for."""
        if numbers(self.value):
            return tuned_numbers(self.value)
        return int(_is_arithmetic_on_names(self.value))


def assignments(module: Module) -> list[Assignment]:
    """Return the assignments at the top of a module."""
    result = []
    for node in module.tree.body:
        if isinstance(node, ast.Assign):
            targets = node.targets
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets = [node.target]
        else:
            continue
        names = tuple(
            child.id
            for target in targets
            for child in ast.walk(target)
            if isinstance(child, ast.Name)
        )
        assert node.value is not None
        result.append(Assignment(names, node.value, node.lineno))
    return result


def comment_above(module: Module, line: int) -> str:
    """Return the comment of documentation, in lines that begin with ``#:``, above a line."""
    lines = module.text.splitlines()[: line - 1]
    comment: list[str] = []
    while lines and lines[-1].startswith("#:"):
        comment.insert(0, lines.pop())
    return "\n".join(comment)


def named_constants(module: Module) -> int:
    """Count the names of numeric constants at the top of a module."""
    return sum(len(assignment.constants) for assignment in assignments(module))


def tuned_constants(module: Module) -> int:
    """Count the tuned constants at the top of a module."""
    total = 0
    for assignment in assignments(module):
        if module.is_tuning_table:
            total += max(len(assignment.names), assignment.tuned)
        elif not CITATION.search(comment_above(module, assignment.line)):
            total += assignment.tuned
    return total


def tuned_literals(module: Module) -> int:
    """Count the numbers inside functions and classes for which no formula is cited."""
    if CITATION.search(ast.get_docstring(module.tree) or ""):
        return 0
    return sum(_uncited_numbers(node) for node in module.tree.body if isinstance(node, DEFINITIONS))


def _uncited_numbers(node: ast.AST) -> int:
    """Count the tuned numbers below a function or class, but for what cites a formula."""
    if isinstance(node, DEFINITIONS):
        if CITATION.search(ast.get_docstring(node) or ""):
            return 0
    elif isinstance(node, ast.Constant):
        return tuned_numbers(node)
    return sum(_uncited_numbers(child) for child in ast.iter_child_nodes(node))


def packed_assignments(module: Module) -> int:
    """Count the statements that bind a tuple of names to a tuple of values."""
    return sum(
        isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Tuple)
        and any(isinstance(target, ast.Tuple) for target in node.targets)
        for node in ast.walk(module.tree)
    )


def identifiers(text: str) -> Iterator[str]:
    """Yield every use of an identifier: names, attributes, arguments, definitions, imports."""
    for token in code_tokens(text):
        if token.type == tokenize.NAME and not keyword.iskeyword(token.string):
            yield token.string


def words_of(identifier: str) -> list[str]:
    """Return the words of an identifier in snake_case or CamelCase, in small letters."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", identifier)]


@cache
def private_words() -> dict[str, dict[str, str]]:
    """Return what is not to be used: parts of identifiers, and whole names."""
    return tomllib.loads(PRIVATE_WORDS.read_text(encoding="utf-8"))


def private_uses(module: Module) -> Counter[str]:
    """Return the private words of a module with how often its identifiers use them."""
    lists = private_words()
    uses: Counter[str] = Counter()
    for identifier in identifiers(module.text):
        name = identifier.lstrip("_")
        parts = [word for word in words_of(identifier) if word in lists["parts"]]
        uses.update(parts)
        if not parts and name in lists["names"]:
            uses[name] += 1
    return uses


def complexities() -> list[tuple[int, str]]:
    """Return all functions with their cyclomatic complexity, the largest first."""
    from radon.complexity import cc_visit
    from radon.visitors import Function

    found = [
        (block.complexity, f"{module.short_name}.{block.fullname}")
        for module in modules().values()
        for block in cc_visit(module.text)
        if isinstance(block, Function)
    ]
    return sorted(found, reverse=True)


def homonyms() -> dict[str, list[str]]:
    """Return the names that classes of several modules bear, but for a leading underscore."""
    found = defaultdict(list)
    for module in modules().values():
        for node in ast.walk(module.tree):
            if isinstance(node, ast.ClassDef):
                found[node.name.lstrip("_")].append(module.short_name)
    return {name: places for name, places in found.items() if len(places) > 1}


def long_tuples() -> list[str]:
    """Return the functions that are annotated to return a tuple of three or more."""
    return [
        f"{module.short_name}.{node.name}"
        for module in modules().values()
        for node in ast.walk(module.tree)
        if isinstance(node, ast.FunctionDef) and node.returns and _is_long_tuple(node.returns)
    ]


def _is_long_tuple(annotation: ast.expr) -> bool:
    return any(
        isinstance(node, ast.Subscript)
        and isinstance(node.value, ast.Name)
        and node.value.id == "tuple"
        and isinstance(node.slice, ast.Tuple)
        and len(node.slice.elts) > 2
        for node in ast.walk(annotation)
    )


@cache
def import_graph() -> Any:
    """Return grimp's graph of what imports what, in functions too, but not for types alone."""
    import grimp  # of the extra `dev`, as radon is: most of this module needs neither

    return grimp.build_graph(NAME, exclude_type_checking_imports=True, cache_dir=None)


def is_late(importer: str, imported: str) -> bool:
    """Whether a module of those in `LATE` imports another one in functions alone."""
    if modules()[importer].short_name not in LATE:
        return False
    top = {statement.lineno for statement in modules()[importer].tree.body}
    details = import_graph().get_import_details(importer=importer, imported=imported)
    return not any(one["line_number"] in top for one in details)


@cache
def links() -> dict[str, tuple[str, ...]]:
    """Return the modules of the library that each module imports, without those that are late."""
    return {
        name: tuple(
            other
            for other in sorted(import_graph().find_modules_directly_imported_by(name))
            if not is_late(name, other)
        )
        for name in modules()
    }


def late_imports() -> Counter[str]:
    """Return how many modules are imported in functions of those in `LATE`."""
    found: Counter[str] = Counter()
    for name in (f"{NAME}.{late}" for late in LATE):
        every = import_graph().find_modules_directly_imported_by(name)
        found[modules()[name].short_name] = len(every) - len(links()[name])
    return found


def circle_of_imports() -> list[str]:
    """Return the modules of a circle of imports, if there is one."""
    try:
        TopologicalSorter(links()).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def longest_chain() -> tuple[str, ...]:
    """Return the longest chain of imports; there is none if imports go in a circle."""
    chains: dict[str, tuple[str, ...]] = {}
    for name in TopologicalSorter(links()).static_order():
        below = (chains[other] for other in links()[name])
        chains[name] = (name, *max(below, key=len, default=()))
    return max(chains.values(), key=len)


def contract_lines() -> int:
    """Count the lines of the import contracts in pyproject.toml that are no comments."""
    text = (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
    assert "importlinter" in tomllib.loads(text)["tool"]
    section, count = "", 0
    for line in text.splitlines():
        if line.startswith("["):
            section = line
        count += "importlinter" in section and bool(line.strip()) and line[0] != "#"
    return count


#: What is counted of each module of the flat core.
COUNTS = {
    "tokens of the flat core": token_count,
    "code lines of the flat core": code_line_count,
    "named numeric constants": named_constants,
    "tuned constants": tuned_constants,
    "tuned literals in functions": tuned_literals,
    "packed assignments": packed_assignments,
}


def figures() -> dict[str, tuple[int, str]]:
    """Return every figure with what there is to say about it."""
    counts = {
        figure: Counter({module.short_name: count(module) for module in flat_core()})
        for figure, count in COUNTS.items()
    }
    counts["tokens of contact, spectral and solving"] = by_package = Counter()
    for module in modules_of(CORE_AND_SOLVING):
        by_package[module.package] += token_count(module)
    counts["private words"] = sum(map(private_uses, flat_core()), Counter())
    counts["late imports upwards"] = late_imports()
    worst = complexities()
    top = [name for name in modules() if name.count(".") == 1]
    at_the_root = [name for name in top if name in packages()]
    circle = circle_of_imports()
    chain = () if circle else longest_chain()
    return {
        **{figure: (count.total(), _most(count)) for figure, count in counts.items()},
        "functions above complexity 25": (
            sum(complexity > MOST_COMPLEX for complexity, _ in worst),
            ", ".join(f"{name} {complexity}" for complexity, name in worst[:NAMED]),
        ),
        "functions above complexity 15": (sum(complexity > COMPLEX for complexity, _ in worst), ""),
        "names that several classes bear": (len(homonyms()), ", ".join(sorted(homonyms()))),
        "results of anonymous tuples of more than two": (
            len(long_tuples()),
            ", ".join(long_tuples()[:NAMED]),
        ),
        "modules at the root": (len(top) - len(at_the_root) + 1, "with `__init__`"),
        "packages at the root": (len(at_the_root), ""),
        "circles of imports": (int(bool(circle)), " ".join(circle)),
        "longest chain of imports": (
            len(chain),
            " ".join(name.removeprefix(f"{NAME}.") for name in chain),
        ),
        "lines of import contracts": (contract_lines(), ""),
        **{f"code lines of {room}": (room_lines(room), "") for room in ROOMS},
    }


def _most(counts: Counter[str]) -> str:
    """Return the largest counts as text."""
    return ", ".join(f"{name} {count}" for name, count in counts.most_common(NAMED) if count)


def main() -> int:
    """Print the table, and return how the process ends."""
    measured = figures()
    assert measured.keys() == {gate.figure for gate in GATES}
    failures = []
    print("| figure | at c22aa78 | today | gate | goal | |\n|---|---|---|---|---|---|")
    for gate in GATES:
        value, remark = measured[gate.figure]
        limit = "reported" if gate.limit is None else str(gate.limit)
        goal = "" if gate.goal is None else str(gate.goal)
        print(f"| {gate.figure} | {gate.before} | {value} | {limit} | {goal} | {remark} |")
        if gate.limit is None:
            continue
        if value > gate.limit:
            failures.append(f"{gate.figure}: {value}, the gate is {gate.limit}")
        elif value < gate.limit:
            print(f"lower the gate of {gate.figure!r} to {value}", file=sys.stderr)
    for name in stale_exclusions():
        print(f"no module {name}: take it out of CAME_WITH", file=sys.stderr)
    print(*failures, sep="\n", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
