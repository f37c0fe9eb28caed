"""Names of a module for the stranger's test of docs/contributing.md.

Run as ``python validation/names.py contact.refine [seed]``: prints twenty names that the module
defines (functions, classes, parameters, variables, attributes and constants), drawn at random by
the seed, or all of them if there are fewer, each with the line where it first appears.
"""

from __future__ import annotations

import argparse
import ast
import random
from pathlib import Path

LIBRARY = Path(__file__).parents[1] / "spectral_contact"
ASKED = 20


def defined_names(source: str) -> dict[str, int]:
    """Return the names that a module defines, each with the line of its first definition."""
    lines: dict[str, int] = {}
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                name = node.name
            case ast.arg():
                name = node.arg
            case ast.Name(ctx=ast.Store()):
                name = node.id
            case ast.Attribute(ctx=ast.Store()):
                name = node.attr
            case _:
                continue
        if not name.startswith("__") and name not in {"self", "_", "annotations"}:
            lines[name] = min(node.lineno, lines.get(name, node.lineno))
    return lines


def main() -> None:
    """Draw and print."""
    parser = argparse.ArgumentParser(description="Names of a module of the library, at random.")
    parser.add_argument("module", help="such as contact.unloading; of a package, its __init__")
    parser.add_argument("seed", type=int, nargs="?", default=1)
    module, seed = vars(parser.parse_args()).values()
    path = LIBRARY / module.removeprefix("spectral_contact.").replace(".", "/")
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    if not path.exists():
        parser.error(f"no module {module} in spectral_contact: give one such as contact.refine")
    lines = defined_names(path.read_text())
    names = sorted(lines)
    drawn = random.Random(seed).sample(names, min(ASKED, len(names)))
    print(f"{module}: {len(drawn)} of {len(names)} names, seed {seed}")
    for name in sorted(drawn, key=lambda one: (lines[one], one)):
        print(f"{lines[name]:5d}  {name}")


if __name__ == "__main__":
    main()
