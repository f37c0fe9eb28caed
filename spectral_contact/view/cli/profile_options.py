"""The profile of a command line: its options, and the scene that they stand for."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, Final, NamedTuple

from spectral_contact.io.columns import Expected, read_columns
from spectral_contact.io.units import in_si
from spectral_contact.profiles import Profile, Sampled, Sum, hull_of_points
from spectral_contact.profiles.control import ALL_CONTROLS, KINDS, SHAPES
from spectral_contact.scene import Scene
from spectral_contact.view.cli.layer_options import add_layer, law, layer_given
from spectral_contact.view.cli.options import (
    UsageError,
    add_option,
    flag,
    measured,
    number,
    whole,
)
from spectral_contact.view.cli.scene_options import (
    MATERIALS,
    add_physical,
    add_scene,
    defaults,
    kappa,
    missing_material,
    scene,
    si_given,
    unloading,
)

#: Profiles that numbers describe, by the name on the command line.
_NAMED: Final = {
    "parabola": "Parabola",
    "sphere": "Sphere",
    "cone": "Cone",
    "power-law": "PowerLaw",
    "rounded-flat": "RoundedFlat",
    "truncated-cone": "TruncatedCone",
    "flat": "Flat",
    "points": "Sampled",
}
#: The one that has its points in a file, and the options of these.
_POINTS: Final = "points"
_OF_FILE: Final = ("profile_file", "profile_columns", "convex_hull")
#: Options of profiles that no other scene has; `radius`, `load` and `approach` are shared with SI.
_OWN: Final = {
    "contact_radius": "radius of the contact; give one of this, --load, --approach, --separation",
    "separation": "gap at the centre, for layer laws without a contact edge",
    "half_angle": "angle of a cone, between its axis and its side [rad]",
    "flat_radius": "radius of the flat end of a rounded flat or truncated cone",
    "coefficient": "coefficient of a power-law profile",
    "exponent": "exponent of a power-law profile",
}
#: What adhesion adds; `branch` is a whole number.
_ADHESION: Final = {
    "work_of_adhesion": "work of adhesion, in E' L or J/m^2; load and approach may be negative",
    "branch": "which of several states: 0 is that reached from a large contact (default: 0)",
}
#: Numbers that may have a unit where the scene is in SI units. An angle may have one in any scene.
_UNITS: Final = {
    "radius": "m",
    "load": "N",
    "approach": "m",
    "contact_radius": "m",
    "separation": "m",
    "flat_radius": "m",
}
_COMPLIANCES: Final = ("normal_compliance", "tangential_compliance")
_SI_ONLY: Final = ("youngs_modulus", *MATERIALS, *(f"{name}_si" for name in _COMPLIANCES))


def add_any_scene(command: argparse.ArgumentParser) -> None:
    """Add the options of every kind of scene."""
    add_scene(command)
    add_physical(command)
    add_profile(command)


class GivenScene(NamedTuple):
    """The scene of the options, and what is to be said of what was read or left out."""

    scene: Scene
    remarks: list[str]


def given_scene(arguments: argparse.Namespace) -> GivenScene:
    """Return the scene of the options: under a profile, in SI units, or dimensionless."""
    if profile_given(arguments):
        return _under_profile(arguments)
    return GivenScene(scene(arguments), defaults(arguments))


def any_scene(arguments: argparse.Namespace) -> Scene:
    """Return the scene of the options without the remarks."""
    return given_scene(arguments).scene


def add_profile(command: argparse.ArgumentParser, control: Callable[[str], Any] = number) -> None:
    """Add the options of a scene with a profile; what is not given is no attribute.

    What tells how far it is pressed in is read by `control`.
    """
    si = control is number  # several values of an option have no units
    units = (
        "With --youngs-modulus everything is in SI units. Without it, --radius, --load and "
        "--approach are numbers: lengths"
        if si
        else "Lengths"
    )
    required = " (in SI units it is required)" if si else ""
    group = command.add_argument_group(
        "scene with a profile",
        f"{units} are in a length L of your choice, loads in E' L^2 with E' = E / (4 (1 - nu^2)), "
        f"and compliances in L / E'. Poisson's ratio defaults to 0.3{required} and the compliances "
        "to 0; there is no friction unless it is given.",
    )
    group.add_argument(
        "--profile",
        choices=_NAMED,
        default=argparse.SUPPRESS,
        help="shape of the punch (default: flat, with its load as the unit); 'points FILE' takes "
        "radii and heights of a text file",
    )
    add_option(group, "profile_file", str, "the same FILE", "FILE")
    of_columns = "of that file: which column is which, as 'r=1 [mm],height=3 [um]'"
    add_option(group, "profile_columns", str, of_columns, "NAMES")
    group.add_argument(
        "--convex-hull",
        action="store_true",
        default=argparse.SUPPRESS,
        help="take the convex hull of noisy points",
    )
    if si:
        group.add_argument(
            "--punch-profile",
            nargs="+",
            metavar=("SHAPE", "NUMBER"),
            default=argparse.SUPPRESS,
            help="shape of the punch where both bodies are curved, with its numbers in the order "
            "of its options, as in 'sphere 20mm'; --profile is that of the other body then",
        )
    add_layer(command, None if si else control)
    for name, meaning in _OWN.items():
        kind: Callable[[str], Any] = measured if name in (*_UNITS, "half_angle") else number
        if name in ALL_CONTROLS and control is not number:
            kind = control
        add_option(group, name, kind, meaning)
    kinds = {"work_of_adhesion": measured if si else control, "branch": whole}
    for name, meaning in _ADHESION.items():
        add_option(group, name, kinds[name], meaning)


def profile_given(arguments: argparse.Namespace) -> bool:
    """Return whether the scene has a profile, or at least an option of one or of a layer."""
    given = vars(arguments)
    own = {"profile", "punch_profile", *_OWN, *_OF_FILE, *_ADHESION}
    return layer_given(given) or not own.isdisjoint(given)


def in_si_units(arguments: argparse.Namespace) -> bool:
    """Return whether the scene is in SI units: with a profile lengths and loads may be any."""
    if profile_given(arguments):
        return not set(_SI_ONLY).isdisjoint(vars(arguments))
    return si_given(arguments)


def profile_scene(arguments: argparse.Namespace) -> Scene:
    """Return the scene of options of a profile."""
    return _under_profile(arguments).scene


def _under_profile(arguments: argparse.Namespace) -> GivenScene:
    """Return the scene of options of a profile, which have to be complete, and of this profile."""
    given, si = vars(arguments), in_si_units(arguments)
    _check_given(given, si)
    values = _numbers(given, si)
    profile, remarks = _profile(given, values, si)
    known: dict[str, Any] = {
        **{name: given.get(f"{name}_si" if si else name, 0.0) for name in _COMPLIANCES},
        **{name: values[name] for name in ALL_CONTROLS if name in values},
        "profile": profile,
        "coupling": arguments.coupling,
        "layer": law(given, si),
        **_adhesion(given, si),
        **unloading(given),
        **_materials(given),
        **({} if si else kappa(given)),
    }
    if "punch_profile" in given:
        punch = _punch_profile(given["punch_profile"], si)
        known |= {"punch_profile": punch} if si else {"profile": Sum(profile, punch)}
    return GivenScene(Scene.from_physical(**known) if si else Scene(**known), remarks)


def _check_given(given: dict[str, Any], si: bool) -> None:
    """Refuse options without a profile, or of a file that is none of its points."""
    of_file = [name for name in _OF_FILE if name in given]
    if of_file and given.get("profile") != _POINTS:
        raise UsageError(f"{flag(of_file[0])} goes with --profile points FILE")
    if "profile" not in given:
        told = "a layer" if layer_given(given) else "a profile"
        raise UsageError(f"give --profile, one of {', '.join(_NAMED)}, with options of {told}")
    if si:
        _check_si(given)


def _materials(given: dict[str, Any]) -> dict[str, Any]:
    """Return friction and what is given of the materials; Poisson's ratio has a default."""
    names = ("youngs_modulus", "poisson_ratio", *MATERIALS, "friction")
    known = {name: given[name] for name in names if name in given}
    return known if "reduced_modulus" in given else {"poisson_ratio": 0.3, **known}


def _profile(
    given: dict[str, Any], values: dict[str, float], si: bool
) -> tuple[Profile, list[str]]:
    """Return the profile of the options, and what is to be said of its file."""
    name = given["profile"]
    if name == _POINTS:
        _check_complete(name, (), values)
        profile, remark = _of_points(given, si)
        return profile, [remark]
    needed = SHAPES.get(_NAMED[name], ("radius",))
    _check_complete(name, needed, values)
    return KINDS[_NAMED[name]](**{one: values[one] for one in needed}), []


def _punch_profile(words: list[str], si: bool) -> Profile:
    """Return the profile of a shape and its numbers."""
    shape, *numbers = words
    shapes = [name for name, kind in _NAMED.items() if kind in SHAPES]
    if shape not in shapes:
        raise UsageError(f"--punch-profile {shape}: must be one of {', '.join(shapes)}")
    kind = _NAMED[shape]
    if len(numbers) != len(SHAPES[kind]):
        needed = " and ".join(SHAPES[kind])
        raise UsageError(f"--punch-profile {shape} needs {needed}; it has {len(numbers)} numbers")
    try:
        given = dict(zip(SHAPES[kind], map(measured, numbers), strict=True))
    except argparse.ArgumentTypeError as error:
        raise UsageError(f"--punch-profile {shape}: {error}") from None
    return KINDS[kind](**_numbers(given, si))


def _of_points(given: dict[str, Any], si: bool) -> tuple[Profile, str]:
    """Return the profile through the points of a file, and what was read from it."""
    if "profile_file" not in given:
        raise UsageError("--profile points needs a FILE, as in --profile points tip.csv")
    unit = "m" if si else ""
    expected = (
        Expected("r", unit, at_least=0.0),
        Expected("height", unit, ("height", "h", "z", "Z", "profile", "gap")),
    )
    table = read_columns(
        given["profile_file"],
        expected,
        columns=given.get("profile_columns"),
        option="--profile-columns",
    )
    points = table.values["r"], table.values["height"]
    if "convex_hull" not in given:
        return Sampled.from_points(*points), str(table)
    hull = hull_of_points(*points)
    away = f"the hull lies {hull.largest:.3g} from the points at most, {hull.rms:.3g} rms"
    remark = f"{table}; {away}{f' [{unit}]' if unit else ''}"
    return Sampled.from_points(*points, convex_hull=True), remark


def _adhesion(given: dict[str, Any], si: bool) -> dict[str, Any]:
    """Return what is given of adhesion."""
    found = {name: given[name] for name in _ADHESION if name in given}
    if "work_of_adhesion" in found and not si:
        found["work_of_adhesion"] = _plain("work_of_adhesion", found["work_of_adhesion"])
    return found


def _check_si(given: dict[str, Any]) -> None:
    """Refuse what mixes SI with dimensionless numbers, be they given or defaults."""
    mixed = [name for name in _COMPLIANCES if name in given]
    if mixed:
        raise UsageError(f"{flag(mixed[0])} is dimensionless: use {flag(mixed[0])}-si, in m/Pa")
    missing = missing_material(given)
    if missing:
        raise UsageError(f"SI input needs {' and '.join(missing)}: there is no default material")


def _numbers(given: dict[str, Any], si: bool) -> dict[str, float]:
    """Return what is given of profile and contact; a unit is understood in SI units alone."""
    values = {
        name: in_si(name, given[name], unit) if si else _plain(name, given[name])
        for name, unit in _UNITS.items()
        if name in given
    }
    return {
        **values,
        **{name: given[name] for name in _OWN if name in given and name not in values},
    }


def _check_complete(profile: str, needed: tuple[str, ...], values: dict[str, float]) -> None:
    """Refuse what is missing, or of another profile."""
    missing = [flag(name) for name in needed if name not in values]
    if missing:
        raise UsageError(f"--profile {profile} needs {' and '.join(missing)}")
    alien = [flag(name) for name in values if name not in (*needed, *ALL_CONTROLS)]
    if alien:
        raise UsageError(f"--profile {profile} does not take {alien[0]}")
    if len(values) != len(needed) + 1:
        raise UsageError(f"--profile needs one of {', '.join(map(flag, ALL_CONTROLS))}")


def _plain(name: str, value: object) -> float:
    if not isinstance(value, float):
        raise UsageError(f"{flag(name)} {value}: must be a number without a unit with --profile")
    return value
