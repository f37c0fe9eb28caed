"""The nonlinear layer of a command line: its options, and the law that they stand for."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np

from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.io.columns import Expected, read_columns
from spectral_contact.io.units import in_si
from spectral_contact.layers import (
    CalculixExponential,
    Exponential,
    GreenwoodWilliamson,
    Layer,
    PowerLaw,
    Table,
)
from spectral_contact.view.cli.options import UsageError, add_option, flag, measured

#: Laws by the name on the command line, with what they need and what they may have.
_NAMED: Final[dict[str, tuple[Callable[..., Layer], tuple[str, ...], tuple[str, ...]]]] = {
    "power-law": (PowerLaw, ("coefficient", "exponent"), ()),
    "exponential": (Exponential, ("zero_pressure", "clearance"), ()),
    "calculix": (CalculixExponential, ("zero_pressure", "clearance"), ()),
    "asperities": (
        GreenwoodWilliamson,
        ("density", "tip_radius", "height_deviation"),
        ("heights",),
    ),
    "table": (Table, ("table",), ("columns",)),
}
#: Numbers of laws, with their SI unit and meaning; a power of a unit is not converted.
_NUMBERS: Final = {
    "coefficient": ("", "power law: pressure at overclosure 1"),
    "exponent": ("", "power law: exponent, in [1, 10]"),
    "zero_pressure": ("Pa", "exponential law: pressure at zero overclosure"),
    "clearance": (
        "m",
        "exponential law: gap at which the pressure begins (calculix: is a hundredth)",
    ),
    "density": ("", "asperities: number per area"),
    "tip_radius": ("m", "asperities: radius of their tips"),
    "height_deviation": ("m", "asperities: standard deviation of their heights"),
}
#: The same by the attribute of the options.
LAW_NUMBERS: Final = tuple(f"layer_{name}" for name in _NUMBERS)
_PREFIX: Final = "layer_"


def add_layer(
    command: argparse.ArgumentParser, control: Callable[[str], Any] | None = None
) -> None:
    """Add the options of a nonlinear layer; what is not given is no attribute.

    Numbers are read by `control`; by default they may have a unit.
    """
    group = command.add_argument_group(
        "nonlinear layer",
        "Needs --profile, and replaces --normal-compliance. With --profile flat, --friction inf is "
        "allowed; otherwise there is no friction. Pressures are in E' and lengths in L"
        + (", or in Pa and m with --youngs-modulus." if control is None else "."),
    )
    group.add_argument(
        "--layer",
        choices=_NAMED,
        default=argparse.SUPPRESS,
        help="law of the layer (default: linear)",
    )
    for name, (_, meaning) in _NUMBERS.items():
        add_option(group, _PREFIX + name, control or measured, meaning)
    group.add_argument(
        "--layer-heights",
        choices=("gaussian", "exponential"),
        default=argparse.SUPPRESS,
        help="asperities: distribution of their heights (default: gaussian)",
    )
    of_table = (
        "table: text file with columns overclosure and pressure, in this order or with headings "
        "(see docs/files.md)"
    )
    add_option(group, "layer_table", str, of_table, "FILE")
    of_columns = "of the table: which column is which, overclosure=2,pressure=1 say"
    add_option(group, "layer_columns", str, of_columns, "NAMES")


def layer_given(given: Mapping[str, Any]) -> bool:
    """Return whether there is a layer, or at least an option of one."""
    return "layer" in given or any(name.startswith(_PREFIX) for name in given)


def law(given: Mapping[str, Any], si: bool) -> Layer | None:
    """Return the law of the options, None without; its parameters are called as the options are."""
    if not layer_given(given):
        return None
    if "layer" not in given:
        raise UsageError(f"give --layer, one of {', '.join(_NAMED)}, with options of a layer")
    named = given["layer"]
    kind, needed, possible = _NAMED[named]
    own = {name.removeprefix(_PREFIX): one for name, one in given.items() if _PREFIX in name}
    missing = [flag(_PREFIX + name) for name in needed if name not in own]
    if missing:
        raise UsageError(f"--layer {named} needs {' and '.join(missing)}")
    alien = [flag(_PREFIX + name) for name in own if name not in (*needed, *possible)]
    if alien:
        raise UsageError(f"--layer {named} does not take {alien[0]}")
    if named == "table":
        return _table(own["table"], own.get("columns"), si)
    values = {name: _value(name, one, si) for name, one in own.items()}
    try:
        return kind(**values)
    except SceneError as error:
        raise SceneError(_PREFIX + error.parameter, error.value, error.allowed) from error


def _value(name: str, value: Any, si: bool) -> Any:
    """Return what an option stands for; a unit is understood in SI units alone."""
    if name == "heights" or isinstance(value, float):
        return value
    unit = _NUMBERS[name][0]
    if not (si and unit):
        told = "must be a number without a unit" + ("" if si else ", without --youngs-modulus")
        raise UsageError(f"{flag(_PREFIX + name)} {value}: {told}")
    return in_si(name, value, unit)


def _table(path: str, columns: str | None, si: bool) -> Table:
    """Return the law of a file; in SI units its headings may have units."""
    units = {"overclosure": "m", "pressure": "Pa"}
    expected = [Expected(name, unit if si else "") for name, unit in units.items()]
    found = read_columns(path, expected, columns=columns, option="--layer-columns")
    for name, values in found.values.items():
        falls = np.flatnonzero(np.diff(values) <= 0.0)
        if falls.size:
            line, before = found.lines[falls[0] + 1], found.lines[falls[0]]
            told = f"line {line}: {name} does not increase from line {before}"
            raise SolutionFileError(path, f"{told} ({name} from {found.sources[name]})")
    try:
        return Table(*(tuple(found.values[name].tolist()) for name in units))
    except SceneError as error:
        raise SolutionFileError(path, str(error)) from error
