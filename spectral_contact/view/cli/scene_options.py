"""The scene of a command line: its options, dimensionless or SI, and what they stand for."""

from __future__ import annotations

import argparse
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.scene import Scene
from spectral_contact.view.cli.options import (
    UsageError,
    add_option,
    flag,
    friction,
    measured,
    number,
)

_COMPLIANCES: Final = ("normal_compliance", "tangential_compliance")
_SI_COMPLIANCES: Final = ("normal_compliance_si", "tangential_compliance_si")
_SI: Final = (
    *("youngs_modulus", "reduced_modulus", "punch_youngs_modulus", "punch_poisson_ratio"),
    *("radius", "load", "approach"),
    *_SI_COMPLIANCES,
)
#: What the materials of SI data are given by besides modulus and Poisson's ratio of the half-space.
MATERIALS: Final = ("reduced_modulus", "punch_youngs_modulus", "punch_poisson_ratio")
#: Dimensionless scene of a bare ``spectral-contact solve``.
_DEFAULTS: Final = {
    "poisson_ratio": 0.1,
    "normal_compliance": 0.5,
    "tangential_compliance": 0.5,
    "friction": 0.1,
}
_SI_NEEDS: Final = ("youngs_modulus", "poisson_ratio", "radius", "friction")


def add_scene(command: argparse.ArgumentParser) -> None:
    """Add the options of a dimensionless scene; what is not given is no attribute."""
    group = command.add_argument_group("scene")
    compliance = "{0}* = {0} E / (4 (1 - nu^2) a), 0 or in [1e-14, 1e14]"
    for name, kind, metavar, meaning in (
        ("poisson_ratio", number, "NU", "Poisson's ratio of the half-space, in (-1, 0.5]"),
        ("normal_compliance", number, "ALPHA", compliance.format("alpha")),
        ("tangential_compliance", number, "BETA", compliance.format("beta")),
        (
            "friction",
            friction,
            "F",
            "coefficient of friction >= 0; inf: full stick, none: no friction",
        ),
    ):
        add_option(group, name, kind, f"{meaning} (default: {_DEFAULTS[name]})", metavar)
    meaning = "instead of --poisson-ratio: kappa of two elastic bodies, in (-3/8, 3/8)"
    add_option(group, "kappa", number, meaning, "KAPPA")
    meaning = "load over the largest load, from which the punch is unloaded (default: 1)"
    add_option(group, "unloaded_to", number, meaning, "RATIO")
    add_coupling(group)


def add_coupling(group: argparse._ArgumentGroup) -> None:
    """Add the switch of elastic coupling."""
    group.add_argument(
        "--coupling",
        action="store_true",
        help="elastic coupling: the traction acts back on the pressure (the paper neglects this)",
    )


def add_physical(command: argparse.ArgumentParser) -> None:
    """Add the options of a scene in SI units."""
    group = command.add_argument_group(
        "scene in SI units",
        "Any of these replaces the dimensionless compliances: modulus, radius, either load or "
        "approach, --poisson-ratio and --friction are then required; a compliance that is "
        "not given is 0, and the output says so. A number may have a unit, as in '210 GPa' or "
        "'50 nm/MPa' (needs the extra: units).",
    )
    for name, metavar, meaning in (
        ("youngs-modulus", "E", "Young's modulus of the half-space [Pa]"),
        ("punch-youngs-modulus", "E2", "that of an elastic punch, under a profile [Pa]"),
        ("punch-poisson-ratio", "NU2", "Poisson's ratio of an elastic punch"),
        ("reduced-modulus", "E*", "in place of all four, without friction: E* of both bodies [Pa]"),
        ("radius", "A", "radius of the punch [m]"),
        ("load", "P", "normal force [N]"),
        ("approach", "DELTA", "rigid approach of the punch [m]"),
        ("normal-compliance-si", "ALPHA", "normal compliance of the roughness [m/Pa]"),
        ("tangential-compliance-si", "BETA", "tangential compliance of the roughness [m/Pa]"),
    ):
        add_option(group, name, measured, meaning, metavar)


def si_given(arguments: argparse.Namespace) -> bool:
    """Return whether the scene is in SI units."""
    return not set(_SI).isdisjoint(vars(arguments))


def scene(arguments: argparse.Namespace) -> Scene:
    """Return the scene of the options, SI or dimensionless; none may be missing or of the other."""
    given = vars(arguments)
    if not si_given(arguments):
        values = {name: given.get(name, default) for name, default in _DEFAULTS.items()}
        return Scene(**{**values, **kappa(given), **unloading(given)}, coupling=arguments.coupling)
    _check_si(arguments)
    known = (*_SI_NEEDS, *MATERIALS, "load", "approach")
    values = {name: given[name] for name in known if name in given}
    compliances = {name: given.get(f"{name}_si", 0.0) for name in _COMPLIANCES}
    values |= unloading(given)
    return Scene.from_physical(**values, **compliances, coupling=arguments.coupling)


def unloading(given: dict[str, Any]) -> dict[str, Any]:
    """Return what a scene takes for a load below the largest one, if that is given."""
    return {"unloaded_to": given["unloaded_to"]} if "unloaded_to" in given else {}


def kappa(given: dict[str, Any]) -> dict[str, Any]:
    """Return what a scene takes for the coupling constant of two bodies, if that is given."""
    if "kappa" not in given:
        return {}
    if "poisson_ratio" in given:
        raise UsageError("--kappa is instead of --poisson-ratio")
    return {"poisson_ratio": None, "mismatch": given["kappa"]}


def missing_material(given: dict[str, Any]) -> list[str]:
    """Return which options of the material of the half-space are missing in SI units."""
    if "kappa" in given:
        raise UsageError("--kappa is dimensionless: give the moduli and Poisson's ratios")
    if "reduced_modulus" in given:
        return []
    return [flag(name) for name in ("youngs_modulus", "poisson_ratio") if name not in given]


def defaults(arguments: argparse.Namespace) -> list[str]:
    """Return a remark for each compliance that an SI scene leaves out; it is taken as 0."""
    if not si_given(arguments):
        return []
    absent = [name for name in _SI_COMPLIANCES if name not in vars(arguments)]
    if len(absent) == len(_SI_COMPLIANCES):
        options = " and ".join(map(flag, absent))
        return [f"{options} were not given: both are taken as 0, a smooth surface"]
    return [f"{flag(name)} was not given: it is taken as 0" for name in absent]


def in_options(error: SceneError, si: bool) -> str:
    """Return the message with the parameter under the name that the command line gives it."""
    names = [
        flag(name + "_si" if si and name in _COMPLIANCES else name)
        for name in error.parameter.split(", ")
    ]
    return ", ".join(names) + str(error).removeprefix(error.parameter)


def _check_si(arguments: argparse.Namespace) -> None:
    """Refuse what mixes SI with dimensionless numbers, be they given or defaults."""
    given = vars(arguments)
    mixed = [name for name in _COMPLIANCES if name in given]
    if mixed:
        raise UsageError(
            f"{flag(mixed[0])} is dimensionless and cannot be mixed with SI input "
            f"({flag(next(name for name in _SI if name in given))}); "
            f"use {flag(mixed[0])}-si, in m/Pa"
        )
    missing = missing_material(given)
    needed = ("radius",) if "reduced_modulus" in given else ("radius", "friction")
    missing += [flag(name) for name in needed if name not in given]
    if missing:
        raise UsageError(f"SI input needs {' and '.join(missing)}: there is no default material")
    if ("load" in given) == ("approach" in given):
        raise UsageError("SI input needs either --load or --approach, not both")
