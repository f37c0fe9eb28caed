"""Measure the size of the house, and hold it to what it was: python validation/size.py.

Prints one table: each figure, what it may be at most, and the goal. Exits with 1 where a figure is
above its gate. The gates are the figures of the day they were written; when one falls, lower its
gate with it. Needs radon, which the extra `dev` has.
"""

from __future__ import annotations

import ast
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
NAME = "spectral_contact"
CORE = ("contact", "spectral")
#: Float literals that are no tuned numbers.
PLAIN = (0.0, 0.5, 1.0, 2.0)
MOST_COMPLEX = 15
#: How many of the worst are named.
NAMED = 5
#: Modules of the core that came with profiles, nonlinear layers and sensitivities. The goals are
#: those of flat punches, without them.
CAME_WITH = {
    "profiles": (
        "contact.contact_radius",
        "contact.indented",
        "contact.on_parts",
        "contact.smooth_indented",
    ),
    "layers": (
        "contact.layered",
        "contact.layered_bends",
        "contact.layered_contact",
        "contact.layered_newton",
        "contact.layered_setting",
        "contact.layered_spaces",
        "spectral.cells",
        "spectral.pointwise",
    ),
    "sensitivities": ("contact.zone_derivatives",),
}
#: The same of the rest of the library: packages and modules that there were not at commit 1534185,
#: of which the goal of 23,000 lines is told, where 27,886 were. What joined a module of before, and
#: what took the place of one, counts.
CAME_ELSEWHERE = {
    "profiles": (
        *("profiles", "closed_forms.indentation", "equations.gap", "fields.history", "io.kinds"),
        *("view.cli.profile", "precise.heights", "precise.indented", "precise.indented_smooth"),
        *("precise.pressed", "sweeps.pressed", "view.history"),
        *("solving.grown_fields", "solving.growth", "solving.growth_history", "solving.outside"),
        *("solving.growth_panel", "solving.profile_run", "solving.stages", "solving.stretch"),
        "solving.weights",
    ),
    "layers": (
        *("layers", "view.cli.layer", "precise.layered", "precise.laws", "solving.layered"),
        *("testing.layered", "view.law"),
    ),
    "sensitivities": ("solving.slopes", "studies.derivatives"),
    "inside": ("equations.interior", "view.cli.inside", "closed_forms.flat_punch", "view.inside"),
    "indentation": ("calibration.indentation", "calibration.layered"),
    "explorer": ("view.cli.explore", "view.explorer"),
    "benchmarks": ("gold.benchmarks", "view.cli.benchmark"),
    "comparison": ("studies.comparison", "view.html"),
    "units": ("io.units",),
    "files": ("io.columns", "io.delimited", "io.headings", "view.cli.files"),
}


@dataclass(frozen=True)
class Gate:
    """A figure, what it may be, and what it should become."""

    figure: str
    most: int
    goal: int


GATES = (
    Gate("lines of the core, flat punches", 9_100, 6_500),
    Gate("lines of the core with all else", 12_400, 6_500),
    Gate("lines in all, flat punches", 31_500, 23_000),
    Gate("lines in all", 50_000, 23_000),
    Gate("float literals of the core, flat punches", 88, 90),
    Gate("float literals of the core with all else", 147, 90),
    Gate("functions above 15", 0, 0),
    Gate("names that several classes bear", 2, 0),
    Gate("results of anonymous tuples of more than two", 0, 0),
    Gate("modules at the root", 9, 10),
    Gate("packages at the root", 16, 15),
    Gate("circles of imports", 0, 0),
    Gate("longest chain of imports", 17, 12),
    Gate("lines of import contracts", 90, 90),
)


@dataclass(frozen=True)
class Module:
    """One source file of the library."""

    name: str
    text: str
    tree: ast.Module

    @property
    def lines(self) -> int:
        """How many lines it has."""
        return self.text.count("\n")

    @property
    def room(self) -> str:
        """The package at the root that it is in, or the root itself."""
        parts = self.name.split(".")
        return parts[1] if len(parts) > 2 or self.is_package else "(root)"

    @property
    def is_package(self) -> bool:
        """Whether it stands for a package at the root."""
        return self.name.count(".") == 1 and self.name in packages()


@cache
def packages() -> frozenset[str]:
    """Return the dotted names of all packages."""
    found = (REPOSITORY / NAME).rglob("__init__.py")
    return frozenset(".".join(path.parent.relative_to(REPOSITORY).parts) for path in found)


@cache
def modules() -> dict[str, Module]:
    """Return all modules by their dotted names."""
    found = {}
    for path in sorted((REPOSITORY / NAME).rglob("*.py")):
        parts = path.relative_to(REPOSITORY).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        text = path.read_text(encoding="utf-8")
        found[name] = Module(name, text, ast.parse(text))
    return found


def core() -> list[Module]:
    """Return the modules of the solver."""
    return [module for module in modules().values() if module.room in CORE]


def later() -> list[Module]:
    """Return those that came with what is more than a flat punch."""
    return [modules()[f"{NAME}.{name}"] for names in CAME_WITH.values() for name in names]


def later_elsewhere() -> list[Module]:
    """Return those of the rest of the library."""
    names = tuple(f"{NAME}.{one}" for several in CAME_ELSEWHERE.values() for one in several)
    assert modules().keys() >= set(names)
    return [
        one
        for one in modules().values()
        if f"{one.name}.".startswith(tuple(f"{n}." for n in names))
    ]


def tuned(module: Module) -> int:
    """Count the float literals that are not plain."""
    values = (node.value for node in ast.walk(module.tree) if isinstance(node, ast.Constant))
    return sum(isinstance(value, float) and value not in PLAIN for value in values)


def complexities() -> list[tuple[int, str]]:
    """Return all functions with their cyclomatic complexity, the largest first."""
    try:
        from radon.complexity import cc_visit
        from radon.visitors import Function
    except ImportError:
        sys.exit('radon is missing: pip install -e ".[dev]"')
    found = [
        (block.complexity, f"{module.name.removeprefix(NAME + '.')}.{block.fullname}")
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
                found[node.name.lstrip("_")].append(module.name.removeprefix(NAME + "."))
    return {name: places for name, places in found.items() if len(places) > 1}


def long_tuples() -> list[str]:
    """Return the functions that are annotated to return a tuple of three or more."""
    return [
        f"{module.name.removeprefix(NAME + '.')}.{node.name}"
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


def _statements(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Yield the imports of a module, those in functions too, but not those for types alone."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.Import, ast.ImportFrom)):
            yield child
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            for other in child.orelse:
                yield from _statements(other)
        else:
            yield from _statements(child)


@cache
def imported(name: str) -> tuple[str, ...]:
    """Return the modules of the library that a module imports."""
    found = set()
    for statement in _statements(modules()[name].tree):
        if isinstance(statement, ast.Import):
            found |= {alias.name for alias in statement.names}
        elif statement.module:
            inner = {f"{statement.module}.{alias.name}" for alias in statement.names}
            found |= {one if one in modules() else statement.module for one in inner}
    return tuple(sorted((found & modules().keys()) - {name}))


def circles() -> list[tuple[str, ...]]:
    """Return the sets of modules that reach each other by imports (Tarjan's components)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[tuple[str, ...]] = []

    def visit(name: str) -> None:
        number[name] = low[name] = len(number)
        stack.append(name)
        for other in imported(name):
            if other not in number:
                visit(other)
                low[name] = min(low[name], low[other])
            elif other in stack:
                low[name] = min(low[name], number[other])
        if low[name] == number[name]:
            start = stack.index(name)
            found.append(tuple(sorted(stack[start:])))
            del stack[start:]

    for name in modules():
        if name not in number:
            visit(name)
    return found


def longest_chain() -> list[str]:
    """Return the longest chain of imports; a circle counts with all its modules."""
    circle_of = {name: circle for circle in circles() for name in circle}

    @cache
    def below(circle: tuple[str, ...]) -> tuple[str, ...]:
        others = {circle_of[other] for name in circle for other in imported(name)} - {circle}
        return circle + max(map(below, sorted(others)), key=len, default=())

    return list(max(map(below, set(circle_of.values())), key=len))


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


def figures() -> dict[str, tuple[int, str]]:
    """Return every figure with what there is to say about it."""
    worst = complexities()
    above = sum(count > MOST_COMPLEX for count, _ in worst)
    same, tuples, chain = homonyms(), long_tuples(), longest_chain()
    rounds = [circle for circle in circles() if len(circle) > 1]
    by_module = Counter({module.name: tuned(module) for module in core()})
    rooms: Counter[str] = Counter()
    for module in modules().values():
        rooms[module.room] += module.lines
    top = [name for name in modules() if name.count(".") == 1]
    shorter = [name.removeprefix(NAME + ".") for name in chain]
    return {
        "lines of the core, flat punches": (
            sum(module.lines for module in core()) - sum(module.lines for module in later()),
            ", ".join(f"without {name}" for name in CAME_WITH),
        ),
        "lines of the core with all else": (
            sum(module.lines for module in core()),
            _listed(CORE, rooms),
        ),
        "lines in all, flat punches": (
            rooms.total() - sum(module.lines for module in (*later(), *later_elsewhere())),
            ", ".join(f"without {name}" for name in CAME_ELSEWHERE),
        ),
        "lines in all": (rooms.total(), _listed([room for room, _ in rooms.most_common(7)], rooms)),
        "float literals of the core, flat punches": (
            by_module.total() - sum(map(tuned, later())),
            "",
        ),
        "float literals of the core with all else": (
            by_module.total(),
            ", ".join(f"{n.split('.')[-1]} {k}" for n, k in by_module.most_common(NAMED)),
        ),
        "functions above 15": (above, ", ".join(f"{n} {c}" for c, n in worst[:NAMED])),
        "names that several classes bear": (len(same), ", ".join(sorted(same))),
        "results of anonymous tuples of more than two": (len(tuples), ", ".join(tuples[:NAMED])),
        "modules at the root": (sum(name not in packages() for name in top) + 1, "with `__init__`"),
        "packages at the root": (sum(name in packages() for name in top), ""),
        "circles of imports": (len(rounds), "; ".join(" ".join(one) for one in rounds)),
        "longest chain of imports": (len(chain), " ".join(shorter)),
        "lines of import contracts": (contract_lines(), ""),
    }


def _listed(names: list[str] | tuple[str, ...], counts: Counter[str]) -> str:
    return ", ".join(f"{name} {counts[name]}" for name in names)


def main() -> int:
    """Print the table, and return how the process ends."""
    found, failed = figures(), []
    assert found.keys() == {gate.figure for gate in GATES}
    print("| figure | today | gate | goal | |\n|---|---|---|---|---|")
    for gate in GATES:
        value, remark = found[gate.figure]
        if value > gate.most:
            failed.append(f"{gate.figure}: {value}, the gate is {gate.most}")
        print(f"| {gate.figure} | {value} | {gate.most} | {gate.goal} | {remark} |")
        if value < gate.most:
            print(f"lower the gate of {gate.figure!r} to {value}", file=sys.stderr)
    print(*failed, sep="\n", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
