"""The scene of a command line: options from what scenes, profiles and layers declare."""

from __future__ import annotations

import re
from argparse import SUPPRESS
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Annotated, Any, ClassVar, Final, NamedTuple, Self

from spectral_contact.errors import SceneError
from spectral_contact.io.parameters import SCENE, SI, Parameter, parameters_of
from spectral_contact.io.units import in_si
from spectral_contact.layers import Layer, Table, scene_layer
from spectral_contact.profiles import Flat, Profile, Sampled, Sum, control
from spectral_contact.profiles.control import ALL_CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.view.cli import options
from spectral_contact.view.cli.command import Parser, add_options
from spectral_contact.view.cli.files import profile_of_points
from spectral_contact.view.cli.options import Option, UsageError, flag

#: Kinds of profiles and laws that have another name than their class.
_NAMES: Final = {
    "Sampled": "points",
    "CalculixExponential": "calculix",
    "GreenwoodWilliamson": "asperities",
}


def _named(kinds: Iterable[type], of_file: type) -> dict[str, Any]:
    """Return the classes that numbers or a file describe, by the name on the command line."""
    return {
        _NAMES.get(one.__name__, re.sub("(?<=[a-z])(?=[A-Z])", "-", one.__name__).lower()): one
        for one in kinds
        if parameters_of(one) or one is of_file
    }


PROFILES: Final[dict[str, type[Profile]]] = _named(control.KINDS.values(), Sampled)
LAWS: Final[dict[str, type[Layer]]] = _named(scene_layer.KINDS.values(), Table)


def _merged(kinds: Mapping[str, type], prefix: str = "") -> dict[str, dict[Parameter, list[str]]]:
    """Return the parameters of some kinds by option, and which kinds declare each."""
    found: dict[str, dict[Parameter, list[str]]] = {}
    for kind, cls in kinds.items():
        for name, parameter in parameters_of(cls).items():
            found.setdefault(prefix + name, {}).setdefault(parameter, []).append(kind)
    return found


_LAW: Final = "layer_"
SHAPES: Final = _merged(PROFILES)
_OF_LAWS: Final = _merged(LAWS, _LAW)
#: Numbers without a unit that have one in SI units have an option for these.
_COMPLIANCES: Final = tuple(name for name in SI if name in SCENE and not SCENE[name].unit)
_SI: Final = {f"{name}_si" if name in _COMPLIANCES else name: SI[name] for name in SI}
#: Options of which a sweep takes several values.
NUMBERS: Final = frozenset((*SCENE, *_SI, *SHAPES, *_OF_LAWS)) - {"coupling", "branch"}
_FLAT: Final = tuple(name for name in SCENE if not SCENE[name].unit and name != "branch")
_PRESSED: Final = (*ALL_CONTROLS, "work_of_adhesion", "branch")
#: Dimensionless scene of a bare ``spectral-contact solve``.
_DEFAULTS: Final[Mapping[str, Any]] = {
    "poisson_ratio": 0.1,
    "normal_compliance": 0.5,
    "tangential_compliance": 0.5,
    "friction": 0.1,
}


class _PhysicalOptions:
    """Scene in SI units.

    Any of these replaces the dimensionless compliances: modulus, --radius, either --load or
    --approach, --poisson-ratio and --friction are then required; a compliance that is not given is
    0, and the output says so. A number may have a unit, as in '210 GPa' or '50 nm/MPa' (needs the
    extra: units).
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class _ProfileOptions:
    """Scene with a profile.

    With a modulus everything is in SI units. Without it lengths are in a length L of your choice,
    loads in E' L^2 with E' = E / (4 (1 - nu^2)), and compliances in L / E'; Poisson's ratio
    defaults to 0.3. The compliances default to 0, and there is no friction unless it is given. Give
    one of --contact-radius, --load, --approach, --separation.

    Parameters
    ----------
    profile : SHAPE
        Shape of the punch; 'points FILE' takes radii and heights of a text file.
    profile_file : FILE
        The same FILE.
    profile_columns : NAMES
        Which column of that file is which, as 'r=1 [mm],height=3 [um]'.
    convex_hull : flag
        Take the convex hull of noisy points.
    """

    profile: Annotated[str | None, Option(choices=tuple(PROFILES))] = None
    profile_file: str | None = None
    profile_columns: str | None = None
    convex_hull: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class _PunchOptions:
    """Second curved body.

    Parameters
    ----------
    punch_profile : WORDS
        Shape of the punch where both bodies are curved, with its numbers in the order of the
        constructor, as in 'sphere 20mm'; --profile is that of the other body then.
    """

    punch_profile: Annotated[list[str] | None, Option(nargs="+")] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _LayerOptions:
    """Nonlinear layer.

    Needs --profile, and replaces the normal compliance. With --profile flat, --friction inf is
    allowed; otherwise there is no friction. Without a modulus pressures are in E' and lengths in L.

    Parameters
    ----------
    layer : LAW
        Law of the layer; by default the linear one of the normal compliance.
    layer_table : FILE
        Of a table: text file with columns overclosure and pressure (see docs/files.md).
    layer_columns : NAMES
        Which column of that file is which, overclosure=2,pressure=1 say.
    """

    layer: Annotated[str | None, Option(choices=tuple(LAWS))] = None
    layer_table: str | None = None
    layer_columns: str | None = None


_KINDS: Final = (_ProfileOptions, _PunchOptions, _LayerOptions)
_WORDS: Final = tuple(one.name for kind in _KINDS for one in fields(kind))


class GivenScene(NamedTuple):
    """The scene of the options, and what is to be said of what was read or left out."""

    scene: Scene
    remarks: list[str]


@dataclass(frozen=True, slots=True)
class FlatOptions:
    """Options of a dimensionless scene of a flat punch, as far as they are given."""

    given: Mapping[str, Any]
    #: Whether numbers are lists, those of a sweep.
    several: ClassVar[bool] = False

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Self:
        """Return what is given."""
        words = {name: given[name] for name in _WORDS if given.get(name)}
        return cls({name: one for name, one in given.items() if name not in _WORDS} | words)

    @classmethod
    def add_options(cls, parser: Parser) -> None:
        """Add the options; what is not given is no attribute."""
        group = parser.add_argument_group("scene")
        for name in _FLAT:
            default = f" (default: {_DEFAULTS[name]})" if name in _DEFAULTS else ""
            cls._add(group, name, f"{SCENE[name]}{default}")

    @classmethod
    def _add(cls, group: Any, name: str, told: str, choices: tuple[str, ...] = ()) -> None:
        """Add the option of a parameter."""
        read: Any = options.si_values if cls.several else options.measured
        if name == "friction":
            read = options.frictions if cls.several else options.friction
        kind: dict[str, Any] = {"type": read, "metavar": "VALUES" if cls.several else "X"}
        if choices:
            kind = {"choices": choices}
        elif name == "coupling":
            kind = {"action": "store_true"}
        elif name == "branch":
            kind = {"type": options.whole, "metavar": "N"}
        group.add_argument(flag(name), dest=name, default=SUPPRESS, help=told, **kind)

    @property
    def shaped(self) -> bool:
        """Whether the scene has a profile, or at least an option of one or of a layer."""
        of_profile = {*_WORDS, *SHAPES, *_OF_LAWS, *_PRESSED} - {"radius", "load", "approach"}
        return not of_profile.isdisjoint(self.given)

    @property
    def of_materials(self) -> bool:
        """Whether a modulus or another number is given that only scenes in SI units have."""
        return not ({*_SI} - {"radius", "work_of_adhesion"}).isdisjoint(self.given)

    @property
    def si(self) -> bool:
        """Whether the scene is in SI units: with a profile lengths and loads may be any."""
        of_flat = {"radius", "load", "approach"} if not self.shaped else set[str]()
        return self.of_materials or not of_flat.isdisjoint(self.given)

    def solved(self) -> GivenScene:
        """Return the scene: under a profile, in SI units, or dimensionless."""
        given, si, shaped = self.given, self.si, self.shaped
        self._check()
        values = {name: given[name] for name in (*SCENE, *SI) if name in given}
        remarks: list[str] = []
        if si:
            values |= {name: given.get(f"{name}_si", 0.0) for name in _COMPLIANCES}
            remarks = [] if shaped else self._left_out()
        else:
            values = {**({"poisson_ratio": 0.3} if shaped else _DEFAULTS), **values}
        make: Any = Scene.from_physical if si else Scene
        if "kappa" in values:
            make = Scene.from_kappa
            values.pop("poisson_ratio")
        if shaped:
            values.pop("radius", None)
            profile, remarks = _profile(given, si)
            values |= {"profile": profile, "layer": _law(given, si)}
            if "punch_profile" in given:
                punch = _punch_profile(given["punch_profile"], si)
                values |= {"punch_profile": punch} if si else {"profile": Sum(profile, punch)}
        return GivenScene(make(**values), remarks)

    def _check(self) -> None:
        """Refuse what mixes SI with dimensionless numbers, and what has no default."""
        given, si = self.given, self.si
        if self.shaped and "profile" not in given:
            of = "a layer" if any(name.startswith("layer") for name in given) else "a profile"
            raise UsageError(f"give --profile, one of {', '.join(PROFILES)}, with options of {of}")
        if not si:
            for name in (*SCENE, "radius"):
                _number(name, given.get(name), "", si)
            if "kappa" in given and "poisson_ratio" in given:
                raise UsageError("--kappa is instead of --poisson-ratio")
            return
        for name in (*_COMPLIANCES, "kappa"):
            if name in given:
                instead = f"{flag(name)}-si, in m/Pa"
                if name == "kappa":
                    instead = "the moduli and Poisson's ratios"
                told = f"is dimensionless and cannot be mixed with SI input; use {instead}"
                raise UsageError(f"{flag(name)} {told}")
        reduced = "reduced_modulus" in given
        needed = [] if reduced else ["youngs_modulus", "poisson_ratio"]
        if not self.shaped:
            needed += ["radius"] if reduced else ["radius", "friction"]
        missing = [flag(name) for name in needed if name not in given]
        if missing:
            told = f"SI input needs {' and '.join(missing)}: there is no default material"
            raise UsageError(told if self.of_materials else f"{told}; or give --profile")

    def _left_out(self) -> list[str]:
        """Return a remark on the compliances that a scene in SI units leaves out; they are 0."""
        absent = [flag(f"{one}_si") for one in _COMPLIANCES if f"{one}_si" not in self.given]
        if len(absent) == len(_COMPLIANCES):
            told = "were not given: both are taken as 0, a smooth surface"
            return [f"{' and '.join(absent)} {told}"]
        return [f"{name} was not given: it is taken as 0" for name in absent]

    def in_options(self, error: SceneError) -> str:
        """Return a message with the parameter under the name that the command line gives it."""
        names = (
            flag(f"{name}_si" if self.si and name in _COMPLIANCES else name)
            for name in error.parameter.split(", ")
        )
        told = str(error).removeprefix(error.parameter).replace("math.inf", "inf")
        return ", ".join(names) + told


class SceneOptions(FlatOptions):
    """Options of every kind of scene."""

    __slots__ = ()

    @classmethod
    def add_options(cls, parser: Parser) -> None:
        """Add the options; what is not given is no attribute."""
        super().add_options(parser)
        group = add_options(parser, _PhysicalOptions)
        for name, parameter in _SI.items():
            if name not in SHAPES and name not in SCENE:
                cls._add(group, name, str(parameter))
        group = add_options(parser, _ProfileOptions)
        for name in _PRESSED:
            cls._add(group, name, str(SCENE[name]))
        cls._add_merged(group, SHAPES)
        if not cls.several:
            add_options(parser, _PunchOptions)
        cls._add_merged(add_options(parser, _LayerOptions), _OF_LAWS)

    @classmethod
    def _add_merged(cls, group: Any, merged: Mapping[str, dict[Parameter, list[str]]]) -> None:
        """Add the parameters of several kinds, with what each declares."""
        for name, declared in merged.items():
            told = [f"{', '.join(kinds)}: {one}" for one, kinds in declared.items()]
            told += [f"without a profile: {SI[name]}"] if name in SI else []
            cls._add(group, name, "; ".join(told), next(iter(declared)).choices)


def _number(name: str, value: Any, unit: str, si: bool) -> Any:
    """Return the number of an option; a unit is understood in SI units alone, but for an angle."""
    if not isinstance(value, str):
        return value
    if unit == "rad" or (si and unit and "exponent" not in unit):
        return in_si(name, value, unit)
    told = "must be a number without a unit" + ("" if si else ", without --youngs-modulus")
    raise UsageError(f"{flag(name)} {value}: {told}")


def _made(option: str, kind: Any, own: Mapping[str, Any], si: bool, prefix: str = "") -> Any:
    """Return a profile or a law of the options of its parameters, which must be complete."""
    declared = {prefix + name: one for name, one in parameters_of(kind).items()}
    defaults = {prefix + one.name for one in fields(kind) if one.default is not MISSING}
    _check_complete(option, own, [name for name in declared if name not in defaults], declared)
    values = {
        name.removeprefix(prefix): one
        if declared[name].choices
        else _number(name, one, declared[name].unit, si)
        for name, one in own.items()
    }
    try:
        return kind(**values)
    except SceneError as error:
        raise SceneError(prefix + error.parameter, error.value, error.allowed) from error


def _check_complete(
    option: str, own: Iterable[str], needed: Iterable[str], possible: Iterable[str]
) -> None:
    """Refuse what is missing, or of another kind."""
    missing = [flag(name) for name in needed if name not in own]
    if missing:
        raise UsageError(f"{option} needs {' and '.join(missing)}")
    alien = [flag(name) for name in own if name not in possible]
    if alien:
        raise UsageError(f"{option} does not take {alien[0]}")


def _profile(given: Mapping[str, Any], si: bool) -> tuple[Profile, list[str]]:
    """Return the profile of the options, and what is to be said of its file."""
    option, of_file = f"--profile {given['profile']}", _WORDS[1:4]
    own = {name: given[name] for name in (*SHAPES, *of_file) if name in given}
    if PROFILES[given["profile"]] is not Sampled:
        return _made(option, PROFILES[given["profile"]], own, si), []
    _check_complete(f"{option} FILE", own, of_file[:1], of_file)
    columns = own.get("profile_columns")
    hull = "convex_hull" in own
    profile, remark = profile_of_points(own["profile_file"], columns, convex_hull=hull, si=si)
    return profile, [remark]


def _punch_profile(words: list[str], si: bool) -> Profile:
    """Return the profile of a shape and its numbers."""
    option, shape, numbers = f"--punch-profile {words[0]}", words[0], words[1:]
    shapes = {name: one for name, one in PROFILES.items() if one not in (Flat, Sampled)}
    if shape not in shapes:
        raise UsageError(f"{option}: must be one of {', '.join(shapes)}")
    names = list(parameters_of(shapes[shape]))
    if len(numbers) != len(names):
        told = f"needs {' and '.join(names)}; it has {len(numbers)} numbers"
        raise UsageError(f"{option} {told}")
    try:
        given = dict(zip(names, map(options.measured, numbers), strict=True))
    except ValueError as error:
        raise UsageError(f"{option}: {error}") from None
    profile: Profile = _made(option, shapes[shape], given, si)
    return profile


def _law(given: Mapping[str, Any], si: bool) -> Layer | None:
    """Return the law of the options, None without; its parameters are called as the options are."""
    own = {name: one for name, one in given.items() if name.startswith(_LAW)}
    if not own and "layer" not in given:
        return None
    if "layer" not in given:
        raise UsageError(f"give --layer, one of {', '.join(LAWS)}, with options of a layer")
    option, kind = f"--layer {given['layer']}", LAWS[given["layer"]]
    law: Layer
    if kind is not Table:
        law = _made(option, kind, own, si, _LAW)
        return law
    _check_complete(option, own, ["layer_table"], ["layer_table", "layer_columns"])
    columns = own.get("layer_columns")
    return Table.from_file(own["layer_table"], columns, si_units=si, option="--layer-columns")
