"""Which column of a file holds which quantity, and in which unit: by its headings, or as asked."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.io.delimited import Sheet, TextRow, split_headings
from spectral_contact.io.documents import Refused
from spectral_contact.io.units import has_unit, in_si

#: Headings by which quantities are known. Single letters are told by their case: P is a load, p a
#: pressure. Words may have blanks, hyphens or underscores between them.
_HEADINGS: Final[Mapping[str, tuple[str, ...]]] = {
    "r": ("r", "R", "radius", "radial coordinate", "radial position"),
    "z": ("z", "Z", "depth"),
    "overclosure": ("w", "overclosure", "interference", "penetration"),
    "pressure": ("p", "pressure", "contact pressure", "cpress"),
    "traction": ("q", "traction", "shear traction", "cshear1"),
    "slip": ("u", "slip", "cslip1"),
    "displacement": (
        *("displacement", "normal displacement", "surface displacement"),
        *("uz", "u_z", "u3", "u2"),
    ),
    "height": ("height", "h", "z", "Z", "profile", "gap"),
    "load": (
        *("P", "F", "load", "force", "normal force", "load on sample", "indentation force"),
        *("vertical deflection", "vDeflection", "deflection", "defl"),
        *("Kraft", "Prüfkraft", "Normalkraft", "Last"),
    ),
    "depth": (
        *("h", "d", "z", "Z", "δ", "delta", "depth", "displacement", "indentation", "penetration"),
        *("approach", "indentation depth", "penetration depth", "displacement into surface"),
        *("separation", "tip sample separation", "tip sample distance", "vertical tip position"),
        *("verticalTipPosition", "tipSampleSeparation", "sep"),
        *("Eindringtiefe", "Eindringweg", "Tiefe", "Weg"),
    ),
    "sigma": ("σ", "sigma", "standard deviation", "load error", "force error", "uncertainty"),
    "stiffness": ("S", "stiffness", "harmonic contact stiffness", "contact stiffness"),
    "area": ("A", "area", "contact area", "projected area"),
}
#: Further headings of columns without units: lengths over the contact radius.
_RATIOS: Final[Mapping[str, tuple[str, ...]]] = {
    "r": ("s", "r/a", "r/R"),
    "z": ("z/a", "z/R"),
}
#: Units that dimensionless columns may have: L and E' are those of scenes with a profile.
_DIMENSIONLESS: Final = frozenset(("", "-", "1", "a", "L", "E'"))
#: Part of a heading of a load that may be one in volts or of a length, too.
_DEFLECTION: Final = "defl"
# A comment that says what its cells are, as in "units: m N s", "columns: height vDeflection time".
_LABELLED: Final = re.compile(r"(?P<label>\w+):\s+(?P<cells>\S.*)")
#: What JPK's exports call headings and units in comments.
_HEADING_LABELS: Final = ("columns", "fancyNames")
_UNITS_LABEL: Final = "units"
# As in "r [mm]", "r (mm)".
_IN_BRACKETS: Final = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<square>.*)\]|\((?P<round>.*)\))\s*")
# As in "r / mm", "r, mm", "r in mm", "r_mm".
_APPENDED: Final = re.compile(r"(?P<name>.+?)(?:\s*/\s*|\s*,\s*|\s+in\s+|_|\s+)(?P<unit>[^\s_]+)")
# Names whose unit is followed by the direction of the curve, extended or retracted, as in
# "Separation_nm_Ex", "Force(pN)_Rt".
_DIRECTED: Final = re.compile(r"(?P<front>.+)[\s_](?P<direction>Ex|Rt)")
#: Units of lengths, pressures and forces, as they are appended to a name without brackets.
_PLAIN_UNIT: Final = re.compile(r"[fpnuµμmcdkMG]?(?:m|Pa|N)|Å|psi|bar")
#: Cells of a line of units below headings.
_UNIT_CELL: Final = re.compile(
    r"[\[(]?(?:[fpnuµμmcdkMG]?(?:m|Pa|N|s|V|A|g|J|W|Hz|K)(?:/[fpnuµμmck]?m)?[²2]?|min|h|Å|psi|bar|"
    r"°C|°|deg|rad|%|-|1|)[\])]?"
)
#: Words of a comment that is a sentence and no row of headings.
_PROSE: Final = frozenset(("and", "are", "for", "in", "is", "of", "the", "with"))
_MOST_SHOWN: Final = 12


class NoColumnError(Refused):
    """No heading names a quantity that is required."""


@dataclass(frozen=True, slots=True)
class Expected:
    """A quantity that a file should have a column of.

    Attributes
    ----------
    name : str
        Under which the numbers are returned.
    unit : str
        Its SI unit; empty if it is dimensionless.
    headings : tuple of str
        By which its column is known; by default those of its name.
    required : bool
        Whether a file without it is refused.
    at_least : float
        Smallest value allowed.
    """

    name: str
    unit: str = ""
    headings: tuple[str, ...] = ()
    required: bool = True
    at_least: float = -np.inf

    def is_called(self, heading: str) -> bool:
        """Return whether a heading, without its unit, is one of this quantity."""
        known = self.headings or (self.name, *_HEADINGS.get(self.name, ()))
        if not (self.unit or self.headings):
            known += _RATIOS.get(self.name, ())
        return _plain(heading) in map(_plain, known)

    def toward(self, direction: str) -> Expected:
        """Return the same quantity with a direction behind its headings, as ``Force Ex``."""
        known = self.headings or (self.name, *_HEADINGS.get(self.name, ()))
        return replace(self, headings=tuple(f"{one} {direction}" for one in known))

    def is_ratio(self, heading: str) -> bool:
        """Return whether a heading says that this length is over the contact radius."""
        return _plain(heading) in map(_plain, _RATIOS.get(self.name, ()))


@dataclass(frozen=True, slots=True)
class Source:
    """The column that a quantity is read from.

    Attributes
    ----------
    index : int
        From 0.
    heading : str
        As the file has it; empty if it has none.
    unit : str
        As it is written, or the SI unit; empty if the quantity is dimensionless.
    factor : Fraction
        By which numbers are multiplied.
    """

    index: int
    heading: str
    unit: str
    factor: Fraction

    def __str__(self) -> str:
        heading = f" ({self.heading})" if self.heading else ""
        return f"column {self.index + 1}{heading}{f' in {self.unit}' if self.unit else ''}"


@dataclass(frozen=True, slots=True)
class _Heading:
    """A heading: as it is written, and what it says."""

    text: str
    name: str
    unit: str | None

    @classmethod
    def read(cls, text: str, expected: Sequence[Expected]) -> _Heading:
        """Return what a heading says.

        What is behind a slash or a blank may be a unit, except in a name that is expected as it is,
        such as ``r/a``.
        """
        bracketed = _IN_BRACKETS.fullmatch(text)
        if bracketed and bracketed["name"]:
            unit = bracketed["square"] or bracketed["round"] or ""
            return cls(text, bracketed["name"], unit.strip())
        if any(one.is_called(text) or one.is_ratio(text) for one in expected):
            return cls(text, text, None)
        directed = _DIRECTED.fullmatch(text)
        if directed:
            front = cls.read(directed["front"], expected)
            if front.unit is not None:
                return cls(text, f"{front.name} {directed['direction']}", front.unit)
        appended = _APPENDED.fullmatch(text)
        if appended and _PLAIN_UNIT.fullmatch(appended["unit"]):
            return cls(text, appended["name"], appended["unit"])
        return cls(text, text, None)


def find_sources(
    sheet: Sheet,
    expected: Sequence[Expected],
    given_columns: list[str] | None,
    header: int | None,
    option: str,
) -> dict[str, Source]:
    """Return the column of each quantity, as far as there is one."""
    width = len(sheet.rows[0].cells)
    headings = _headings(sheet, expected, width, header)
    if given_columns is None:
        if headings is None:
            indices = _in_order(sheet, expected, width, option)
        else:
            indices = _by_headings(headings, expected, option)
        units: dict[str, str | None] = {}
    else:
        indices, units = _by_user(given_columns, headings, expected, width, option)
    missing = [
        quantity.name for quantity in expected if quantity.required and quantity.name not in indices
    ]
    if missing:
        complaint = f"no column of {' and '.join(missing)}"
        raise NoColumnError(f"{complaint}: {_shown(headings, width)}; {_advice(expected, option)}")
    sources = {}
    for quantity in expected:
        if quantity.name in indices:
            index = indices[quantity.name]
            heading = None if headings is None else headings[index]
            sources[quantity.name] = _source(quantity, index, heading, units.get(quantity.name))
    return sources


def _headings(
    sheet: Sheet, expected: Sequence[Expected], width: int, header: int | None
) -> list[_Heading] | None:
    """Return the headings of all columns, None if there are none.

    They are in the lowest line of text above the numbers that names a quantity or, if there is no
    text above, in the last comment that does. Their units may be in the line below, or in a comment
    that has the same names.
    """
    texts = [row for row in sheet.texts if header is None or row.line == header]
    for k in range(len(texts) - 1, -1, -1):
        headings = _named(texts[k], sheet.delimiter, expected, width)
        if headings is not None and (header is not None or _name_any(headings, expected)):
            below = texts[k + 1 :]
            if below:
                return _with_units(headings, below, sheet.delimiter)
            return _with_commented_units(headings, sheet, expected, texts[k].line)
    if texts:
        return _unexpected_headings(texts, sheet.delimiter, expected, width)
    return _commented(sheet, expected, width)


def _unexpected_headings(
    texts: Sequence[TextRow], delimiter: str, expected: Sequence[Expected], width: int
) -> list[_Heading] | None:
    """Return the lowest headings, which name nothing expected: the user may choose from them."""
    last = _named(texts[-1], delimiter, expected, width)
    if len(texts) == 1 or last is None or not _are_units(last):
        return last
    above = _named(texts[-2], delimiter, expected, width)
    return last if above is None else _with_units(above, texts[-1:], delimiter)


def _commented(sheet: Sheet, expected: Sequence[Expected], width: int) -> list[_Heading] | None:
    """Return the headings of the last comment that names a quantity."""
    for comment in reversed(sheet.comments):
        label, cells = _label_and_cells(comment)
        named = replace(comment, text=cells) if label in _HEADING_LABELS else comment
        headings = _named(named, sheet.delimiter, expected, width)
        if headings is not None and _name_any(headings, expected) and not _is_prose(headings):
            return _with_labelled_units(headings, sheet)
    return None


def _label_and_cells(comment: TextRow) -> tuple[str, str]:
    """Return the label of the cells of a comment, "" without one, and the cells."""
    match = _LABELLED.fullmatch(comment.text)
    return ("", comment.text) if match is None else (match["label"], match["cells"])


def _with_labelled_units(headings: list[_Heading], sheet: Sheet) -> list[_Heading]:
    """Return headings with the units of the comment that is labelled so, if there is one."""
    for comment in reversed(sheet.comments):
        label, cells = _label_and_cells(comment)
        if label == _UNITS_LABEL:
            units = split_headings(cells, sheet.delimiter, len(headings))
            if units is not None:
                return [replace(one, unit=u) for one, u in zip(headings, units, strict=True)]
    return headings


def _named(
    row: TextRow, delimiter: str, expected: Sequence[Expected], width: int
) -> list[_Heading] | None:
    if row.text.lstrip().startswith("*"):  # a keyword of Abaqus' input files
        return None
    cells = split_headings(row.text, delimiter, width)
    return None if cells is None else [_Heading.read(cell, expected) for cell in cells]


def _name_any(headings: Iterable[_Heading], expected: Sequence[Expected]) -> bool:
    return any(
        one.is_called(heading.name) or one.is_ratio(heading.name)
        for heading in headings
        for one in expected
    )


def name_all(cells: Sequence[str], expected: Sequence[Expected]) -> bool:
    """Whether these are headings of all that is required."""
    names = [_Heading.read(cell, expected).name for cell in cells]
    return all(
        any(one.is_called(name) or one.is_ratio(name) for name in names)
        for one in expected
        if one.required
    )


def _are_units(headings: Iterable[_Heading]) -> bool:
    """Whether a line below the headings has units alone."""
    texts = [heading.text for heading in headings]
    return any(texts) and all(map(_UNIT_CELL.fullmatch, texts))


def _is_prose(headings: Iterable[_Heading]) -> bool:
    return any(heading.name.lower() in _PROSE for heading in headings)


def _with_units(
    headings: list[_Heading], below: Sequence[TextRow], delimiter: str
) -> list[_Heading]:
    """Return headings with the units of the line below them."""
    cells = split_headings(below[0].text, delimiter, len(headings))
    if len(below) > 1 or cells is None:
        raise Refused(f"{_lines(below)}: text between the headings and the numbers")
    # a place of evaluation, "@Loc 1", is no unit
    units = ["" if cell.startswith("@") else cell.strip("[]()").strip() for cell in cells]
    return [
        heading
        if not unit and heading.unit is not None
        else _Heading(heading.text, heading.name, unit)
        for heading, unit in zip(headings, units, strict=True)
    ]


def _with_commented_units(
    headings: list[_Heading], sheet: Sheet, expected: Sequence[Expected], line: int
) -> list[_Heading]:
    """Return headings with the units of a comment above that has the same names with units.

    Files of this library have such a comment.
    """
    names = [heading.name for heading in headings]
    for comment in reversed(sheet.comments):
        commented = _named(comment, sheet.delimiter, expected, len(headings))
        if (
            comment.line < line
            and commented is not None
            and [one.name for one in commented] == names
        ):
            return [
                own if own.unit is not None else replace(own, unit=other.unit)
                for own, other in zip(headings, commented, strict=True)
            ]
    return headings


def _in_order(
    sheet: Sheet, expected: Sequence[Expected], width: int, option: str
) -> dict[str, int]:
    """Return the columns of a file without headings: the required ones in order."""
    required = [one.name for one in expected if one.required]
    if sheet.texts:
        above = f"above numbers in {column_count(width)}"
        complaint = f"{_lines(sheet.texts)}: text that names no column, {above}"
        raise NoColumnError(f"{complaint}; {_advice(expected, option)}")
    if width != len(required) or not required:
        complaint = f"line {sheet.rows[0].line}: {column_count(width)} without headings"
        if not required:
            raise NoColumnError(f"{complaint}; write a first line that names each")
        names = f"{' and '.join(required)} {'is' if len(required) == 1 else 'are'}"
        raise NoColumnError(f"{complaint}, where {names} expected; {_advice(expected, option)}")
    return {name: index for index, name in enumerate(required)}


def _by_headings(
    headings: list[_Heading], expected: Sequence[Expected], option: str
) -> dict[str, int]:
    """Return the columns whose headings name a quantity."""
    indices: dict[str, int] = {}
    for quantity in expected:
        named = [k for k, heading in enumerate(headings) if quantity.is_called(heading.name)]
        if len(named) > 1:
            named = _with_fitting_unit(quantity, headings, named)
        if len(named) > 1:
            candidates = " and ".join(f"column {k + 1} ({headings[k].text})" for k in named)
            raise Refused(f"{candidates} are both {quantity.name}; {_advice(expected, option)}")
        if named:
            indices[quantity.name] = named[0]
        elif quantity.required:
            _refuse_ratio(quantity, headings)
    repeated = _first_repeated(list(indices.values()))
    if repeated is not None:
        names = " and ".join(name for name, index in indices.items() if index == repeated)
        complaint = f"column {repeated + 1} ({headings[repeated].text}) may be {names}"
        raise Refused(f"{complaint}; {_advice(expected, option)}")
    return indices


def _with_fitting_unit(
    quantity: Expected, headings: Sequence[_Heading], named: list[int]
) -> list[int]:
    """Return the only column whose unit is one of the quantity, if the others have other units."""
    units = [headings[k].unit or "" for k in named]
    if not all(units) or not quantity.unit:
        return named
    fitting = [k for k, unit in zip(named, units, strict=True) if _fits(quantity, unit)]
    return fitting if len(fitting) == 1 else named


def _fits(quantity: Expected, unit: str) -> bool:
    """Return whether a unit is one of a quantity."""
    try:
        _factor(quantity, unit, "")
    except Refused:
        return False
    return True


def _refuse_ratio(quantity: Expected, headings: Iterable[_Heading]) -> None:
    """Refuse a column of lengths over the contact radius where one in SI units is expected."""
    for heading in headings:
        if quantity.is_ratio(heading.name):
            complaint = f"{heading.text} is over the contact radius"
            raise Refused(f"{complaint}, where {quantity.name} in {quantity.unit} is expected")


def _first_repeated(places: Sequence[int]) -> int | None:
    return next((place for place in places if places.count(place) > 1), None)


def _by_user(
    given_columns: list[str],
    headings: list[_Heading] | None,
    expected: Sequence[Expected],
    width: int,
    option: str,
) -> tuple[dict[str, int], dict[str, str | None]]:
    """Return the columns that the user has named, and their units where these are given, too."""
    indices: dict[str, int] = {}
    units: dict[str, str | None] = {}
    if (
        headings is None
        and not any("=" in item for item in given_columns)
        and len(given_columns) != width
    ):
        complaint = (
            f"{option}: {len(given_columns)} names for {column_count(width)} without headings"
        )
        raise Refused(f"{complaint}; {_advice(expected, option)}")
    for order, item in enumerate(given_columns):
        name, is_pair, column = (part.strip() for part in item.partition("="))
        given = _Heading.read(column if is_pair else name, expected)
        if is_pair:
            quantity = _quantity(name, expected, f"{option} {item}")
        else:
            quantity = _quantity(given.name, expected)
        if quantity in indices:
            raise Refused(f"{option}: {quantity} is given twice")
        if is_pair or headings is not None:
            index = _column_index(given, headings, width, option, by_number=bool(is_pair))
        else:
            index = order
        if quantity is not None:
            indices[quantity] = index
            units[quantity] = given.unit
    repeated = _first_repeated(list(indices.values()))
    if repeated is not None:
        raise Refused(f"{option}: column {repeated + 1} is given twice")
    return indices, units


def _quantity(name: str, expected: Sequence[Expected], item: str = "") -> str | None:
    """Return which quantity is called so; if none is, None, or an error about an item."""
    for one in expected:
        if one.name == name or one.is_called(name):
            return one.name
    if item:
        known = ", ".join(one.name for one in expected)
        raise Refused(f"{item}: {name} is none of {known}")
    return None


def _column_index(
    given: _Heading, headings: list[_Heading] | None, width: int, option: str, *, by_number: bool
) -> int:
    """Return the place of the column of this number or heading, with or without its unit."""
    if by_number and given.name.isascii() and given.name.isdigit():
        place = int(given.name) - 1
        if not 0 <= place < width:
            raise Refused(f"{option} {given.text}: there are {column_count(width)}")
        return place
    present = headings or []
    places = [k for k, heading in enumerate(present) if heading.text == given.text]
    places = places or [
        k for k, one in enumerate(present) if _plain(one.name) == _plain(given.name)
    ]
    if len(places) != 1:
        count_text = "more than one column" if places else "no column"
        raise Refused(f"{option}: {count_text} {given.text}: {_shown(headings, width)}")
    return places[0]


def _source(
    quantity: Expected, index: int, heading: _Heading | None, given_unit: str | None
) -> Source:
    """Return a column with the factor of its unit, said by the user or by the heading."""
    text, file_unit = ("", None) if heading is None else (heading.text, heading.unit)
    where = f"column {index + 1}{f' ({text})' if text else ''}"
    if given_unit is not None and file_unit and given_unit != file_unit:
        raise Refused(f"{where} is in {file_unit}, not in {given_unit}")
    unit = (given_unit if given_unit is not None else file_unit) or ""
    if heading is not None and not unit and _DEFLECTION in heading.name.lower():
        complaint = "has no unit, and a deflection may be in N, V or m: give it with the column"
        raise Refused(f"{where} {complaint}")
    if quantity.unit:
        is_ratio = heading is not None and quantity.is_ratio(heading.name)
        if is_ratio or unit in _DIMENSIONLESS - {""}:
            complaint = f"is dimensionless, where {quantity.name} in {quantity.unit} is expected"
            raise Refused(f"{where} {complaint}")
        return Source(
            index, text, unit or quantity.unit, _factor(quantity, unit or quantity.unit, where)
        )
    if unit not in _DIMENSIONLESS:
        complaint = f"the scene has no units, and {quantity.name} none of its own"
        raise Refused(f"{where} is in {unit}: {complaint}")
    return Source(index, text, unit, Fraction(1))


def _factor(quantity: Expected, unit: str, where: str) -> Fraction:
    """Return a unit over the SI unit of a quantity."""
    if unit == quantity.unit:
        return Fraction(1)
    measure = f"1 {unit}"
    try:
        if has_unit(measure):
            return Fraction(in_si(quantity.name, measure, quantity.unit))
    except SceneError:  # of another dimension, or no unit
        pass
    raise Refused(f"{where}: {unit} is no unit of {quantity.name}, which is in {quantity.unit}")


def _plain(heading: str) -> str:
    """Return a heading as it is compared: words alike however they are joined and capitalised."""
    text = " ".join(re.split(r"[\s_-]+", heading.strip()))
    return text if len(text) < 2 or "/" in text else text.lower()


def column_count(width: int) -> str:
    """Return a number of columns in words."""
    return f"{width} column{'' if width == 1 else 's'}"


def _lines(rows: Sequence[TextRow]) -> str:
    numbers = abridged([str(row.line) for row in rows], ", ")
    return f"line{'' if len(rows) == 1 else 's'} {numbers}"


def _shown(headings: list[_Heading] | None, width: int) -> str:
    if headings is None:
        return f"there are {column_count(width)} without headings"
    return f"the headings are {abridged([one.text for one in headings], ', ')}"


def abridged(texts: Sequence[str], between: str) -> str:
    """Return joined texts; of very many the first ones, and the number of the others."""
    more = len(texts) - _MOST_SHOWN
    return between.join(texts[:_MOST_SHOWN]) + (f" and {more} more" if more > 0 else "")


def _advice(expected: Sequence[Expected], option: str) -> str:
    pairs = ",".join(f"{one.name}={k}" for k, one in enumerate(expected, 1) if one.required)
    return f"say which they are, such as {option} {pairs}"
