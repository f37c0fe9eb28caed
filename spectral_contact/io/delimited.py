"""Text files of numbers as rows of cells: encodings, comments, delimiters, decimal signs.

What the columns mean is the matter of `spectral_contact.io.columns`.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final

from spectral_contact.io.checks import decimal_number
from spectral_contact.io.documents import Refused

#: Byte-order marks; that of UTF-32 begins with that of UTF-16.
_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
#: Number of bytes by which UTF-16 without a mark is recognised.
_BYTES_SAMPLED: Final = 1000
#: Number of lines by which the delimiter is chosen; a later line with another one is refused.
_LINES_SAMPLED: Final = 1000
#: Delimiters in the order in which they are preferred; a blank stands for any white space.
_DELIMITERS: Final = ("\t", ";", ",", " ")
_LINE_END: Final = re.compile(r"\r\n|\r|\n")
# Spreadsheets write errors that begin as comments do: #N/A, #NV, #DIV/0!, #NAME?, #####.
_SHEET_ERROR: Final = r"#(?:N/?A\b|NV\b|[A-ZÄÖÜ/0]+[!?]|#{2,}(?=\s*[,;\t]))"
_COMMENT: Final = re.compile(rf"\s*(?:(?!{_SHEET_ERROR})#+|%+|//|!|\*\*)(?P<text>.*)")
_TRAILING_COMMENT: Final = re.compile(rf"(?<=\S)\s+(?!{_SHEET_ERROR})#+(?=[\s\w]).*")
_RULE: Final = re.compile(r"[\s|+]*[-=_*+]{3,}[-=_*+|\s]*")
_SEPARATOR: Final = re.compile(r"\s*\"?sep=(.)\"?\s*", re.IGNORECASE)
#: A number with a decimal point or a decimal comma.
_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)(?:[eEdD][+-]?[0-9]+)?")
#: Several numbers in one cell: the delimiter is another one.
_SEVERAL_NUMBERS: Final = re.compile(r"[-+0-9.,eEdD]+(?:\s*[;\s]\s*[-+0-9.,eEdD]+)+")
_THOUSANDS: Final = re.compile(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}")
#: Texts that programs write where there is no value.
_MISSING: Final = frozenset(("", "-", "na", "n/a", "nan", "null", "none", "nv", "--"))
#: Those of them that stand for no unit, too.
_DASHES: Final = frozenset(("", "-", "--"))


@dataclass(frozen=True, slots=True)
class TextRow:
    """The cells of a line.

    Attributes
    ----------
    line : int
        Its number in the file, from 1.
    text : str
        The line, without a comment at its end.
    cells : tuple of str
    """

    line: int
    text: str
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Sheet:
    """A text file of numbers.

    Attributes
    ----------
    delimiter : str
        A tab, a semicolon, a comma, or a blank for any white space.
    comments : tuple of TextRow
        Comments above the first row of numbers, without their mark.
    texts : tuple of TextRow
        Lines of text above the first row of numbers.
    rows : tuple of TextRow
        Every line from the first row of numbers on, but for blank ones, comments and rules.
    """

    delimiter: str
    comments: tuple[TextRow, ...]
    texts: tuple[TextRow, ...]
    rows: tuple[TextRow, ...]


def decoded(content: bytes) -> str:
    """Return the text of a file in UTF-8, UTF-16, UTF-32 or Windows' Latin alphabet.

    Raises
    ------
    Refused
        If the file is an archive (as spreadsheets are) or no text.
    """
    encoding = _encoding(content)
    try:
        return content.decode(encoding)
    except UnicodeDecodeError:
        pass
    if encoding == "utf-8":
        with suppress(UnicodeDecodeError):
            # Only names and units have letters beyond ASCII: "µm" as Excel writes it.
            return content.decode("cp1252")
    raise Refused("is no text, or damaged")


def _encoding(content: bytes) -> str:
    """Return the encoding of a file by its mark, or by the zeros of UTF-16."""
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return encoding
    if content.startswith(b"PK\x03\x04"):
        raise Refused("is an archive or a spreadsheet, no text: save the table as CSV")
    sample = content[:_BYTES_SAMPLED]
    zeros = [sample[start::2].count(0) for start in (0, 1)]
    if any(zeros):
        quarter = len(sample) // 4
        if zeros[0] == 0 and zeros[1] >= quarter:
            return "utf-16-le"
        if zeros[1] == 0 and zeros[0] >= quarter:
            return "utf-16-be"
        raise Refused("is binary, no text")
    return "utf-8"


def read_sheet(
    content: bytes, are_headings: Callable[[tuple[str, ...]], bool], header: int | None = None
) -> Sheet:
    """Return the rows of a text file.

    Rows of numbers begin below the line of headings or, where there is none, with the first line
    that has a number.

    Parameters
    ----------
    content : bytes
    are_headings : callable
        Whether the cells of a line are headings of all that is wanted.
    header : int, optional
        The line of headings, from 1; by default the first without a number that is one.

    Raises
    ------
    Refused
        If there is no row of numbers, or one above the line of headings that was found.
    """
    lines = _LINE_END.split(decoded(content))
    separator = _SEPARATOR.fullmatch(lines[0])  # which Excel reads and writes
    comments: list[tuple[int, str]] = []
    texts: list[tuple[int, str]] = []
    for line, text in enumerate(lines, start=1):
        comment = _COMMENT.fullmatch(text)
        if not text.strip() or _RULE.fullmatch(text) or (line == 1 and separator):
            continue
        if comment:
            comments.append((line, comment["text"].strip()))
        else:
            texts.append((line, _TRAILING_COMMENT.sub("", text)))
    delimiter = separator[1] if separator else _delimiter([text for _, text in texts])
    all_rows = [TextRow(line, text, split(text, delimiter)) for line, text in texts]
    first = _first_row(all_rows, delimiter, are_headings, header)
    rows = _without_empty_ends(all_rows[first:], all_rows[:first])
    if not rows:
        below = "" if header is None else f" below line {header}, that of the headings"
        raise Refused(f"has no row of numbers{below}")
    comments_above = [comment for comment in comments if comment[0] < rows[0].line]
    return Sheet(
        delimiter,
        tuple(TextRow(line, text, split(text, delimiter)) for line, text in comments_above),
        tuple(all_rows[:first]),
        tuple(rows),
    )


def split(text: str, delimiter: str) -> tuple[str, ...]:
    """Return the cells of a line, without blanks around them and without quotes."""
    if delimiter == " ":
        cells = re.findall(r'"[^"]*"|\S+', text)
    else:
        cells = next(csv.reader([text], delimiter=delimiter, skipinitialspace=True), [])
    return tuple(cell.strip().strip('"').strip() for cell in cells)


def heading_cells(text: str, delimiter: str) -> Iterator[tuple[str, ...]]:
    """Yield the ways in which a line may be parted into headings.

    They are parted as the numbers are. If numbers are parted by white space, a unit in brackets may
    also belong to the name before it, and names with single blanks may be parted by two or more.
    Headings in a comment may be parted by commas whatever parts the numbers.
    """
    cells = split(text, delimiter)
    yield cells
    if delimiter == " ":
        joined: list[str] = []
        for cell in cells:
            if joined and cell.startswith(("[", "(")):
                joined[-1] += f" {cell}"
            else:
                joined.append(cell)
        yield tuple(joined)
        yield tuple(re.split(r"\s{2,}|\t+", text.strip()))
    yield split(text, ",")


def split_headings(text: str, delimiter: str, width: int) -> tuple[str, ...] | None:
    """Return the headings of a line if there are as many as columns, else None."""
    for cells in heading_cells(text, delimiter):
        if _filled(cells) <= width <= len(cells):
            return cells[:width]
    return None


def is_missing(text: str) -> bool:
    """Return whether the text of a cell stands for a missing value."""
    return text.lower() in _MISSING or bool(re.match(_SHEET_ERROR, text))


def looks_like_a_number(text: str) -> bool:
    """Return whether a cell holds a number, with a decimal point or a decimal comma."""
    return _is_number(text)


def decimal_sign(cells: Iterable[tuple[int, str]]) -> str:
    """Return the decimal sign of numbers, each with its line: a point or a comma.

    Raises
    ------
    Refused
        If there are both, or if all commas may part thousands.
    """
    points: tuple[int, str] | None = None
    commas: list[tuple[int, str]] = []
    for line, text in cells:
        if "," in text and _is_number(text):
            commas.append((line, text))
        elif points is None and "." in text and _is_number(text):
            points = line, text
    if not commas:
        return "."
    line, text = commas[0]
    if points is not None:
        complaint = f"line {line} has a decimal comma ({text}), line {points[0]} a decimal point"
        raise Refused(f"{complaint} ({points[1]})")
    if all(_THOUSANDS.fullmatch(_with_signs(one)) for _, one in commas):
        complaint = "is a decimal comma or parts thousands: write decimal points, or give decimal"
        raise Refused(f"line {line}: it is not known whether the comma of {text} {complaint}")
    return ","


def number(text: str, decimal: str) -> tuple[float, str]:
    """Return the number of a cell, and how Python writes its text.

    Raises
    ------
    ValueError
        If it is none, not finite, or beyond the doubles; its text follows that of the cell.
    """
    plain = _with_signs(text)
    if decimal == ",":
        plain = plain.replace(".", " ").replace(",", ".")
    plain = re.sub("[dD](?=[+-]?[0-9]+$)", "e", plain)
    value = decimal_number(plain)
    if not math.isfinite(value):
        raise ValueError("is not a finite number")
    return value, plain


def _with_signs(text: str) -> str:
    return text.replace("\u2212", "-")


def _is_number(text: str) -> bool:
    return bool(_NUMBER.fullmatch(_with_signs(text)))


def _delimiter(texts: Sequence[str]) -> str:
    """Return the delimiter by which most lines have several cells, and a number among them."""
    counts = dict.fromkeys(_DELIMITERS, 0)
    for text in texts[:_LINES_SAMPLED]:
        for delimiter in _DELIMITERS:
            if delimiter != " " and delimiter not in text:
                continue
            cells = split(text, delimiter)
            is_table = len(cells) > 1 and any(map(_is_number, cells))
            counts[delimiter] += is_table and not any(map(_SEVERAL_NUMBERS.fullmatch, cells))
    return max(_DELIMITERS, key=counts.__getitem__)


def _first_row(
    all_rows: Sequence[TextRow],
    delimiter: str,
    are_headings: Callable[[tuple[str, ...]], bool],
    header: int | None,
) -> int:
    """Return the place of the first row of numbers, or of marks that there is no value."""
    widths = Counter(len(row.cells) for row in all_rows if any(map(_is_number, row.cells)))
    usual = max(widths, key=widths.__getitem__, default=0)

    def has_number(place: int) -> bool:
        cells = all_rows[place].cells
        # a line of text with a number in it, as a date, has not as many cells as rows have
        is_row = len(cells) == usual or all(map(_is_number, cells))
        return is_row and any(map(_is_number, cells))

    def has_no_value(place: int) -> bool:
        cells = all_rows[place].cells
        # a line of dashes below headings may be a line of units, of numbers that have none
        has_text = not _DASHES.issuperset(cells)
        return has_text and len(cells) == usual and all(map(is_missing, cells))

    heading_row = -1
    for place, row in enumerate(all_rows):
        if header is not None:
            heading_row = place if row.line <= header else heading_row
        elif not has_number(place) and any(map(are_headings, heading_cells(row.text, delimiter))):
            heading_row = place
            break
    if header is None:
        for row in all_rows[: max(heading_row, 0)]:
            if len(row.cells) > 1 and all(map(_is_number, row.cells)):
                headings_line = all_rows[heading_row].line
                raise Refused(
                    f"line {row.line}: numbers above the headings of line {headings_line}"
                )
    # What is below the line of headings may be a line of units.
    below = range(heading_row + 1, len(all_rows))
    rows = (place for place in below if has_number(place) or has_no_value(place))
    return next(rows, len(all_rows))


def _without_empty_ends(rows: Sequence[TextRow], above: Sequence[TextRow]) -> list[TextRow]:
    """Return the rows without the empty cells that a delimiter at the end of each makes.

    Lines of as many cells above the rows are looked at, too: if a heading stands over such a cell,
    it is a missing value and stays.
    """
    counts = {len(row.cells) for row in rows}
    equally_wide = [*rows, *(row for row in above if len(row.cells) in counts)]
    empty_ends = min((len(row.cells) - _filled(row.cells) for row in equally_wide), default=0)
    if not empty_ends:
        return list(rows)
    return [replace(row, cells=row.cells[:-empty_ends]) for row in rows]


def _filled(cells: tuple[str, ...]) -> int:
    return max((place for place, cell in enumerate(cells, start=1) if cell), default=0)
