"""Files of numbers on the command line: the options that say how a file is to be read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any

from spectral_contact.io.columns import Expected, NumberTable, read_columns
from spectral_contact.profiles import Sampled, hull_of_points
from spectral_contact.view.cli.options import Option, Whole


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """File of numbers.

    Parameters
    ----------
    columns : NAMES
        Which column of the file is which: "r=2,z=3 [mm]" by number or heading, or the names of all
        columns in order; by default the headings tell (see docs/files.md).
    header : LINE
        Line of the file's headings; by default it is found.
    decimal : SIGN
        Decimal sign of the file, "." or ","; by default that of its numbers.
    skip_invalid : flag
        Leave out rows that cannot be read or have no value, and name them.
    """

    columns: str | None = None
    header: Whole | None = None
    decimal: Annotated[str | None, Option(choices=(".", ","))] = None
    skip_invalid: bool = False

    def read(self, path: str, expected: Sequence[Expected]) -> NumberTable:
        """Return the columns of a file."""
        return read_columns(path, expected, **self.arguments("raise"))

    def arguments(self, invalid: str) -> dict[str, Any]:
        """Return the arguments of `read_columns` or `read_curve`.

        Parameters
        ----------
        invalid : str
            What they do with rows without a value if `skip_invalid` is not given.
        """
        given = asdict(self)
        skips = given.pop("skip_invalid")
        return {**given, "invalid": "skip" if skips else invalid, "option": "--columns"}


def profile_of_points(
    profile_file: str, profile_columns: str | None = None, convex_hull: bool = False, *, si: bool
) -> tuple[Sampled, str]:
    """Return the profile through the points of a file, and what was read from it."""
    unit = "m" if si else ""
    expected = Expected("r", unit, at_least=0.0), Expected("height", unit)
    option = "--profile-columns"  # as errors name the argument `columns`
    table = read_columns(profile_file, expected, columns=profile_columns, option=option)
    points = table.values["r"], table.values["height"]
    profile = Sampled.from_points(*points, convex_hull=convex_hull)
    if not convex_hull:
        return profile, str(table)
    hull = hull_of_points(*points)
    away = f"the hull lies {hull.largest:.3g} from the points at most, {hull.rms:.3g} rms"
    return profile, f"{table}; {away}{f' [{unit}]' if unit else ''}"
