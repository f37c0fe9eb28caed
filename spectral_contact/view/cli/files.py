"""Files of numbers on the command line: the options that say how a file is to be read."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from spectral_contact.io.columns import Expected, NumberTable, read_columns
from spectral_contact.view.cli.options import whole


def add_reading(group: argparse._ArgumentGroup, example: str) -> None:
    """Add the options of a file of columns, with an example of ``--columns``."""
    group.add_argument(
        "--columns",
        metavar="NAMES",
        help=f'which column of the file is which: "{example}" by number or heading, or the names '
        "of all columns in order (default: by the headings; see docs/files.md)",
    )
    group.add_argument(
        "--header", type=whole, metavar="LINE", help="line of the file's headings (default: found)"
    )
    group.add_argument(
        "--decimal",
        choices=(".", ","),
        metavar="SIGN",
        help="point or comma, the decimal sign of the file (default: that of its numbers)",
    )
    group.add_argument(
        "--skip-invalid",
        action="store_true",
        help="leave out rows that cannot be read or have no value, and name them",
    )


def reading_given(arguments: argparse.Namespace) -> list[str]:
    """Return the options that say how a file is to be read, as far as they are given."""
    given = vars(arguments)
    names = ("columns", "header", "decimal", "skip_invalid")
    return [f"--{name.replace('_', '-')}" for name in names if given[name]]


def read(path: str, expected: Sequence[Expected], arguments: argparse.Namespace) -> NumberTable:
    """Return the columns of a file, read as the options say."""
    return read_columns(
        path,
        expected,
        columns=arguments.columns,
        header=arguments.header,
        decimal=arguments.decimal,
        invalid="skip" if arguments.skip_invalid else "raise",
        option="--columns",
    )
