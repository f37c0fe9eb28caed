"""``spectral-contact benchmark``: list the benchmarks, show one, or copy them."""

from __future__ import annotations

import argparse
from typing import Annotated

from spectral_contact.gold import benchmarks
from spectral_contact.io.choices import suggestion
from spectral_contact.view.cli.options import Option
from spectral_contact.view.report import table


def _name(text: str) -> str:
    if text not in benchmarks.names():
        meant = suggestion(text, benchmarks.names())
        raise argparse.ArgumentTypeError(f"there is no benchmark {text!r}{meant}")
    return text


def print_list() -> None:
    """List the benchmarks and their check numbers."""
    cells = [("benchmarks", "check number", "within", "problem")]
    for name in benchmarks.names():
        one = benchmarks.load(name)
        check = f"{one.check.symbol} = {one.check.text}"
        cells.append((name, check, f"{one.tolerance:g}", one.title))
    print(f"{table(cells)}\n\nversion {benchmarks.VERSION}")


def show(name: Annotated[str, Option(read=_name)]) -> None:
    """Print the page of a benchmark.

    Parameters
    ----------
    name : NAME
        Name of a benchmark, as `list` prints it.
    """
    print(benchmarks.load(name).page().rstrip("\n"))


def export(names: Annotated[list[str], Option(read=_name, nargs="*")], *, output: str) -> None:
    """Copy benchmarks to a folder: pages, numbers, fields, checksums.

    Parameters
    ----------
    names : NAME
        Which; by default all.
    output : FOLDER
        Folder of the copies; created if needed.
    """
    written = benchmarks.export(output, names or None)
    print(f"{len(written)} files in {output}: {', '.join(written)}")
