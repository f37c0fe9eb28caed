"""``spectral-contact compare``: fields at the nodes of another code against a solution."""

from __future__ import annotations

import argparse
import math
from typing import Any, Final

from spectral_contact.errors import SpectralContactError
from spectral_contact.io.choices import one_of
from spectral_contact.io.columns import Expected
from spectral_contact.records import PROFILE_QUANTITIES
from spectral_contact.scene import Scene
from spectral_contact.studies.comparison import compare
from spectral_contact.view.cli.files import add_reading, read
from spectral_contact.view.cli.options import UsageError, number
from spectral_contact.view.cli.profile_options import any_scene

#: Numbers that may be compared beside the fields of a file.
_NUMBERS: Final = ("approach", "stick_radius", "total_shear", *PROFILE_QUANTITIES)
#: Fields of a file with their SI units and, where these are not all that are known, headings.
_FIELDS: Final[tuple[tuple[str, str, tuple[str, ...]], ...]] = (
    ("pressure", "Pa", ()),
    ("traction", "Pa", ()),
    ("slip", "m", ()),
    (
        "displacement",
        "m",
        ("displacement", "normal displacement", "surface displacement", "uz", "u_z", "u3", "u2"),
    ),
)


class TooLarge(SpectralContactError):
    """An error is larger than was allowed; the comparison is the `report`."""

    def __init__(self, report: str, told: str) -> None:
        super().__init__(told)
        self.report = report


def add_options(command: argparse.ArgumentParser) -> None:
    """Add what the command takes, but for the scene."""
    command.add_argument(
        "file",
        metavar="FILE",
        nargs="?",
        help="text file with a column r and some of pressure, traction, slip, displacement",
    )
    group = command.add_argument_group("file of the nodes")
    add_reading(group, "r=2,pressure=5 [MPa]")
    group = command.add_argument_group("comparison")
    group.add_argument(
        "--value",
        action="append",
        default=[],
        type=_value,
        metavar="NAME=X",
        help=f"a number beside the fields (repeatable): {', '.join(_NUMBERS)}",
    )
    group.add_argument(
        "--at-most",
        type=number,
        metavar="X",
        help="exit with 1 if an error is larger (default: exit with 0)",
    )


def run(arguments: argparse.Namespace) -> str:
    """Compare, and return what there is to say.

    Raises
    ------
    TooLarge
        With the same, if an error is larger than is allowed.
    """
    scene = any_scene(arguments)
    given: dict[str, Any] = {
        one_of("value", name, _NUMBERS): value for name, value in arguments.value
    }
    if arguments.file is None and not given:
        raise UsageError("give a FILE of nodes, or --value NAME=X")
    told: list[str] = []
    if arguments.file is not None:
        expected = _expected(scene)
        table = read(arguments.file, expected, arguments)
        fields = {name: values for name, values in table.values.items() if name != "r"}
        if not fields:
            names = ", ".join(name for name, *_ in _FIELDS)
            raise UsageError(f"{arguments.file}: no column of {names}; say which is which")
        told.append(str(table))
        is_ratio = expected[0].is_ratio(table.sources["r"].heading)
        given |= {**fields, "s" if is_ratio else "r": table.values["r"]}
    found = compare(scene, **given)
    told.append(str(found))
    if arguments.at_most is not None and not found.error <= arguments.at_most:
        excess = f"the largest error is {found.error:.1e}, --at-most is {arguments.at_most:g}"
        raise TooLarge("\n".join(told), excess)
    return "\n".join(told)


def _expected(scene: Scene) -> tuple[Expected, ...]:
    """Return the columns that a file of nodes may have, radii first."""
    si = scene.physical is not None
    radii = Expected("r", "m" if si else "", at_least=0.0)
    fields = (
        Expected(name, unit if si else "", headings, required=False)
        for name, unit, headings in _FIELDS
    )
    return radii, *fields


def _value(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=X")
    found = number(value)
    if not math.isfinite(found):
        raise argparse.ArgumentTypeError(f"{text!r}: the number must be finite")
    return name.strip().replace("-", "_"), found
