"""``spectral-contact benchmark``: list the benchmarks, show one, or copy them."""

from __future__ import annotations

from typing import Annotated, Final

from spectral_contact.gold import benchmarks
from spectral_contact.view.cli.options import chosen
from spectral_contact.view.report import table

_NAMES: Final = benchmarks.names()


def print_list() -> None:
    """List the benchmarks, each with its check number, which another code is to compare first."""
    cells = [("benchmarks", "check number", "within", "problem")]
    for one in map(benchmarks.load, _NAMES):
        check = f"{one.check.symbol} = {one.check.text}"
        cells.append((one.name, check, f"{one.tolerance:g}", one.title))
    print(f"{table(cells)}\n\nversion {benchmarks.VERSION}")


def show(name: Annotated[str, chosen(*_NAMES)]) -> None:
    """Print the page of a benchmark.

    Parameters
    ----------
    name : NAME
        Name of a benchmark, as `list` prints it.
    """
    print(benchmarks.load(name).page().rstrip("\n"))


def export(
    names: Annotated[list[str] | None, chosen(*_NAMES, nargs="*")] = None, *, output: str
) -> None:
    """Copy benchmarks to a folder: pages, numbers, fields, checksums.

    Parameters
    ----------
    names : NAME
        Which; by default all.
    output : FOLDER
        Folder of the copies; created if needed.
    """
    written = benchmarks.export(output, names)
    print(f"{len(written)} files in {output}: {', '.join(written)}")
