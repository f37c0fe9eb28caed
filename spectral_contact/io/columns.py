"""Columns of numbers from text files as other programs write them: the one reader of them.

A caller says which quantities it expects; which column holds each of them is found by the headings,
or said by the user. Nothing is guessed where two readings make sense, and no row is left out
without being named.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import MissingDependencyError, SceneError, SolutionFileError
from spectral_contact.io.checks import whole
from spectral_contact.io.choices import listed, one_of
from spectral_contact.io.delimited import (
    Sheet,
    TextRow,
    decimal_sign,
    is_missing,
    looks_like_a_number,
    number,
    read_sheet,
)
from spectral_contact.io.documents import Refused, read_file, reported
from spectral_contact.io.headings import (
    Expected,
    Source,
    abridged,
    column_count,
    find_sources,
    name_all,
)

__all__ = ["Expected", "NumberTable", "Source", "parse_columns", "read_columns"]

# A comma, but for one in brackets.
_ITEM: Final = re.compile(r",(?![^\[(]*[\])])")
#: Characters of a cell that an error shows.
_LONGEST_CELL: Final = 48


class _NoValue(Refused):
    """A cell has no value where one is expected."""


#: Errors for which a row is left out, by the name of the choice.
_LEFT_OUT: Final[dict[str, tuple[type[Refused], ...]]] = {
    "raise": (),
    "skip": (Refused,),
    "missing": (_NoValue,),
}


@dataclass(frozen=True, slots=True, eq=False)
class NumberTable:
    """Numbers in columns.

    Attributes
    ----------
    path : str
        Of the file.
    values : dict of ndarray
        By the name of the quantity, in SI units, or dimensionless; of one length.
    lines : ndarray of int
        Line of each row in the file, from 1.
    sources : dict of Source
        Where each quantity is from.
    unread : tuple of str
        The fault of each row that was left out, with its line; empty unless rows may be left out.
    """

    path: str
    values: dict[str, NDArray[np.float64]]
    lines: NDArray[np.int64]
    sources: dict[str, Source]
    unread: tuple[str, ...]

    def __str__(self) -> str:
        """Return how the file was read, on one line."""
        read = ", ".join(f"{name} from {source}" for name, source in self.sources.items())
        text = f"{self.path}: {len(self.lines)} rows, {read}"
        if self.unread:
            text += f"; {len(self.unread)} rows left out: {abridged(self.unread, '; ')}"
        return text


def read_columns(
    path: str | os.PathLike[str],
    expected: Sequence[Expected],
    *,
    columns: str | Sequence[str] | None = None,
    header: int | None = None,
    decimal: str | None = None,
    invalid: str = "raise",
    option: str = "columns",
) -> NumberTable:
    """Read columns of numbers from a text file.

    Cells may be parted by tabs, semicolons, commas or white space, with decimal points or commas;
    the text may be UTF-8 or UTF-16, with or without a byte-order mark, or Windows'. Blank lines,
    rules, and comments after ``#``, ``%``, ``!``, ``//`` or ``**`` are passed over.

    Parameters
    ----------
    path : path-like
    expected : sequence of Expected
    columns : str or sequence of str, optional
        Which column is which, in one of two ways. In ``"r=2, z=Depth [mm]"`` every quantity has the
        number of its column, from 1, or its heading; a unit is added if the file has none. A list
        of names such as ``"node, r [mm], z [mm]"`` says, of a file without headings, what all of
        its columns are, in their order; of a file with headings it has those of the columns to be
        read. By default the headings tell, or, without any, the columns are the required quantities
        in order.
    header : int, optional
        Line of the headings; those above are passed over. By default the last line above the
        numbers that names a quantity.
    decimal : str, optional
        ``"."`` or ``","``; by default the one that the numbers have.
    invalid : str
        ``"raise"``, or ``"skip"`` for rows that cannot be read, or have no value where one is
        expected, to be left out and named in `NumberTable.unread`. With ``"missing"`` those
        without a value are left out, and others raise.
    option : str
        Name of the argument or option by which the user gave `columns`, for errors.

    Returns
    -------
    NumberTable

    Raises
    ------
    SolutionFileError
        If the file cannot be read, lacks a quantity, or has two of it; for a row or a cell that is
        not as it should be, with its line and column; for a unit of something else.
    SceneError
        If `header`, `decimal` or `invalid` is something else.
    MissingDependencyError
        If a column has another than its SI unit, and pint is not installed.
    """
    if header is not None:
        whole("header", header, 1)
    if decimal is not None:
        one_of("decimal", decimal, (".", ","))
    one_of("invalid", invalid, tuple(_LEFT_OUT))
    given_columns = None if columns is None else _items(columns)
    source, content = read_file(path)
    return _parsed(source, content, expected, given_columns, header, decimal, invalid, option)


def parse_columns(source: str, content: bytes, expected: Sequence[Expected]) -> NumberTable:
    """Return columns of numbers from the content of a text file, as `read_columns` does.

    Parameters
    ----------
    source : str
        Name of the content in errors.
    content : bytes
    expected : sequence of Expected
    """
    return _parsed(source, content, expected, None, None, None, "raise", "columns")


def _parsed(
    source: str,
    content: bytes,
    expected: Sequence[Expected],
    given_columns: list[str] | None,
    header: int | None,
    decimal: str | None,
    invalid: str,
    option: str,
) -> NumberTable:
    try:
        with reported(source, "cannot be read"):
            sheet = read_sheet(content, lambda cells: name_all(cells, expected), header)
            sources = find_sources(sheet, expected, given_columns, header, option)
            return _values(source, sheet, expected, sources, decimal, _LEFT_OUT[invalid])
    except SolutionFileError as error:
        if isinstance(error.__cause__, MissingDependencyError):
            raise error.__cause__ from None
        raise


def _items(columns: str | Sequence[str]) -> list[str]:
    parts = _ITEM.split(columns) if isinstance(columns, str) else listed("columns", columns, "text")
    for part in parts:
        if not isinstance(part, str):
            raise SceneError("columns", part, "text")
    return [part.strip() for part in parts]


def _values(
    path: str,
    sheet: Sheet,
    expected: Sequence[Expected],
    sources: dict[str, Source],
    decimal: str | None,
    left_out: tuple[type[Refused], ...],
) -> NumberTable:
    """Return the numbers of the columns, converted."""
    width = len(sheet.rows[0].cells)
    used = [source.index for source in sources.values()]
    sign = decimal or decimal_sign(_cells(sheet, used))
    unused_columns = [
        index
        for index, cell in enumerate(sheet.rows[0].cells)
        if index not in used and looks_like_a_number(cell)
    ]
    wanted = [
        (quantity, sources[quantity.name]) for quantity in expected if quantity.name in sources
    ]
    kept: list[list[float]] = []
    lines: list[int] = []
    unread: list[str] = []
    for row in sheet.rows:
        try:
            _check_shape(row, width, unused_columns)
            values = [_value(row, quantity, source, sign) for quantity, source in wanted]
        except left_out as error:
            unread.append(str(error))
        else:
            kept.append(values)
            lines.append(row.line)
    if not kept:
        raise Refused(f"no row can be read: {unread[0]}")
    table = np.array(kept, dtype=np.float64)
    return NumberTable(
        path,
        {quantity.name: table[:, k].copy() for k, (quantity, _) in enumerate(wanted)},
        np.array(lines, dtype=np.int64),
        sources,
        tuple(unread),
    )


def _cells(sheet: Sheet, used: Sequence[int]) -> Iterator[tuple[int, str]]:
    for row in sheet.rows:
        for index in used:
            if index < len(row.cells):
                yield row.line, row.cells[index]


def _check_shape(row: TextRow, width: int, unused_columns: Iterable[int]) -> None:
    """Refuse a row that is unlike the first one, such as a line with sums below the table.

    It has another number of cells, or text in one of the `unused_columns`. These are columns that
    are not read and have a number in the first row.
    """
    if len(row.cells) != width:
        raise Refused(
            f"line {row.line}: {column_count(len(row.cells))}, where there are {width} above"
        )
    for index in unused_columns:
        cell = row.cells[index]
        if not (is_missing(cell) or looks_like_a_number(cell)):
            complaint = "text, where there are numbers above"
            raise Refused(
                f"line {row.line}, column {index + 1}: {cell[:_LONGEST_CELL]} is {complaint}"
            )


def _value(row: TextRow, quantity: Expected, source: Source, decimal: str) -> float:
    cell = row.cells[source.index]
    where = f"line {row.line}, column {source.index + 1} ({quantity.name})"
    if is_missing(cell):
        raise _NoValue(f"{where}: {f'{cell} is' if cell else 'there is'} no value")
    try:
        value, text = number(cell, decimal)
        if value != 0.0 and source.factor != 1:
            value = float(Fraction(text) * source.factor)  # exact, and rounded once
            if value == 0.0:
                raise OverflowError
    except (OverflowError, ValueError) as error:
        complaint = (
            "is not within the range of a double" if isinstance(error, OverflowError) else error
        )
        raise Refused(f"{where}: {cell[:_LONGEST_CELL]} {complaint}") from None
    if value < quantity.at_least:
        raise Refused(f"{where}: {cell} must be at least {quantity.at_least:g}")
    return value
