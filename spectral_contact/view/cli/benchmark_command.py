"""``spectral-contact benchmark``: list the benchmarks, show one, or copy them."""

from __future__ import annotations

import argparse
from typing import Final

from spectral_contact.gold import benchmarks
from spectral_contact.io.choices import suggestion
from spectral_contact.view.report import table

#: What can be done with benchmarks.
KINDS: Final = {
    "list": "list the benchmarks and their check numbers",
    "show": "print the page of a benchmark",
    "export": "copy benchmarks to a folder: pages, numbers, fields, checksums",
}


def add_options(command: argparse.ArgumentParser, kind: str) -> None:
    """Add what a kind takes."""
    if kind == "show":
        command.add_argument(
            "name", type=_name, metavar="NAME", help="name of a benchmark, as `list` prints it"
        )
    if kind == "export":
        command.add_argument(
            "names", nargs="*", type=_name, metavar="NAME", help="which (default: all)"
        )
        command.add_argument(
            "--output",
            metavar="FOLDER",
            required=True,
            help="folder of the copies; created if needed",
        )


def run(arguments: argparse.Namespace) -> str:
    """Do what is asked, and return what to print."""
    if arguments.kind == "show":
        return benchmarks.load(arguments.name).page().rstrip("\n")
    if arguments.kind == "export":
        written = benchmarks.export(arguments.output, arguments.names or None)
        return f"{len(written)} files in {arguments.output}: {', '.join(written)}"
    cells = [("benchmarks", "check number", "within", "problem")]
    for name in benchmarks.names():
        one = benchmarks.load(name)
        check = f"{one.check.symbol} = {one.check.text}"
        cells.append((name, check, f"{one.tolerance:g}", one.title))
    return f"{table(cells)}\n\nversion {benchmarks.VERSION}"


def _name(text: str) -> str:
    if text not in benchmarks.names():
        meant = suggestion(text, benchmarks.names())
        raise argparse.ArgumentTypeError(f"there is no benchmark {text!r}{meant}")
    return text
