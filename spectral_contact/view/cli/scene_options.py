"""The scene of a command line: options from what scenes, profiles and layers declare."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Annotated, Any, ClassVar, Final, NamedTuple

from spectral_contact.errors import SceneError, shown
from spectral_contact.io.choices import one_of
from spectral_contact.io.parameters import SCENE, SI, Parameter, parameters_of
from spectral_contact.io.units import in_si
from spectral_contact.layers import Layer, Table, scene_layer
from spectral_contact.profiles import Flat, Profile, Sampled, Sum, control
from spectral_contact.scene import Scene
from spectral_contact.view.cli import options
from spectral_contact.view.cli.command import Parser, add_options
from spectral_contact.view.cli.files import profile_of_points
from spectral_contact.view.cli.options import Option, UsageError, chosen, flag

#: Kinds of profiles and laws that have another name than their class.
_NAMES: Final = {
    "Sampled": "points",
    "CalculixExponential": "calculix",
    "GreenwoodWilliamson": "asperities",
}
#: Options of the kinds that a file describes, and whether each is needed.
_FILE_OPTIONS: Final[Mapping[type, dict[str, bool]]] = {
    Sampled: {"profile_file": True, "profile_columns": False, "convex_hull": False},
    Table: {"layer_table": True, "layer_columns": False},
}
#: What the options of the parameters of a law begin with.
_LAW_PREFIX: Final = "layer_"


def _named(kinds: Iterable[type]) -> dict[str, Any]:
    """Return the classes that numbers or a file describe, by the name on the command line."""
    return {
        _NAMES.get(one.__name__, re.sub("(?<=[a-z])(?=[A-Z])", "-", one.__name__).lower()): one
        for one in kinds
        if parameters_of(one) or one in _FILE_OPTIONS
    }


def _merged(kinds: Mapping[str, type], prefix: str = "") -> dict[str, dict[Parameter, list[str]]]:
    """Return the parameters of some kinds by option, and which kinds declare each."""
    found: dict[str, dict[Parameter, list[str]]] = {}
    for kind, cls in kinds.items():
        for name, parameter in parameters_of(cls).items():
            found.setdefault(prefix + name, {}).setdefault(parameter, []).append(kind)
    return found


PROFILES: Final[dict[str, type[Profile]]] = _named(control.KINDS.values())
LAWS: Final[dict[str, type[Layer]]] = _named(scene_layer.KINDS.values())
SHAPES: Final = _merged(PROFILES)
_OF_LAWS: Final = _merged(LAWS, _LAW_PREFIX)
# in SI units --radius without --profile is that of a flat punch
SHAPES["radius"].setdefault(SI["radius"], []).append("no profile")
#: The compliances: numbers in a dimensionless scene, and in m/Pa in SI units, where their options
#: end in ``-si``.
_COMPLIANCES: Final = tuple(name for name in SI if name in SCENE and not SCENE[name].unit)
#: Parameters of scenes in SI units, by option.
_SI_OPTIONS: Final = {f"{name}_si" if name in _COMPLIANCES else name: SI[name] for name in SI}
#: The type, unit and choices of each option. Kinds of profiles or laws with the same option have
#: them in common.
_DECLARED: Final[Mapping[str, Parameter]] = {
    **{name: next(iter(declared)) for name, declared in (SHAPES | _OF_LAWS).items()},
    **_SI_OPTIONS,
    **SCENE,
}
#: Options of real numbers, which may have units, and of which a sweep takes several values.
NUMBERS: Final = frozenset(name for name, one in _DECLARED.items() if one.kind is float)
#: Parameters that a dimensionless flat punch does not have: how far it is pressed, and adhesion.
_PRESSED: Final = tuple(name for name in SCENE if SCENE[name].unit or name == "branch")
#: Parameters that a flat punch in SI units has as well as a profile.
_OF_FLAT: Final = frozenset({"radius", "load", "approach"})
#: Dimensionless scene of a bare ``spectral-contact solve``.
_DEFAULTS: Final[Mapping[str, Any]] = {
    "poisson_ratio": 0.1,
    "normal_compliance": 0.5,
    "tangential_compliance": 0.5,
    "friction": 0.1,
}
#: What ``--help`` says of each option.
_TEXTS: Final[Mapping[str, str]] = {
    **{name: str(one) for name, one in {**_SI_OPTIONS, **SCENE}.items()},
    **{name: f"{SCENE[name]} (default: {one})" for name, one in _DEFAULTS.items()},
    **{
        name: "; ".join(f"{', '.join(kinds)}: {one}" for one, kinds in declared.items())
        for name, declared in (SHAPES | _OF_LAWS).items()
    },
}


class _PlainScene:
    """Scene.

    Without further options it is a flat punch, and dimensionless.
    """


class _PhysicalOptions:
    """Scene in SI units.

    Any of these replaces the dimensionless compliances: modulus, --radius, either --load or
    --approach, and --poisson-ratio are then required; friction and compliances that are not given
    are left out, and the output says so. A number may have a unit, as in '210 GPa' or '50 nm/MPa'
    (needs the extra: units).
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
    punch_profile : WORDS
        Shape of the punch where both bodies are curved, with its numbers in the order of the
        constructor, as in 'sphere 20mm'; --profile is that of the other body then.
    """

    profile: Annotated[str | None, chosen(*PROFILES)] = None
    profile_file: str | None = None
    profile_columns: str | None = None
    convex_hull: bool = False
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

    layer: Annotated[str | None, chosen(*LAWS)] = None
    layer_table: str | None = None
    layer_columns: str | None = None


#: The option that another option needs, the profile or the layer that it describes.
_NEEDED: Final[Mapping[str, str]] = {
    **{one.name: "profile" for one in fields(_ProfileOptions)},
    **{name: "profile" for name in (*SHAPES, *_PRESSED, "layer") if name not in _OF_FLAT},
    **{name: "layer" for name in ("layer_table", "layer_columns", *_OF_LAWS)},
}
#: Parameters in a message, as "max_unknowns", "s=" or "convex_hull=True".
_PARAMETER: Final = re.compile(r"\b([a-z]+(?=[_=])[a-z_]*)=?(?:True\b)?")
#: Options that have another name than the parameters of the library that they give.
_RENAMED: Final = {"quantity": "plot_quantity"}


class GivenScene(NamedTuple):
    """The scene of the options, and remarks on files that were read and options left out."""

    scene: Scene
    remarks: list[str]


@dataclass(frozen=True)
class FlatOptions:
    """Options of a dimensionless scene of a flat punch, as far as they are given."""

    given: Mapping[str, Any]
    #: Groups of options, by what is said of them.
    groups: ClassVar[Mapping[type, Iterable[str]]] = {
        _PlainScene: [name for name in SCENE if name not in _PRESSED]
    }
    #: How a number is read, and what stands for it in ``--help``.
    number: ClassVar[tuple[Callable[[str], Any], str]] = options.value, "X"

    @classmethod
    def add_options(cls, parser: Parser) -> None:
        """Add the options."""
        read, metavar = cls.number
        for kind, names in cls.groups.items():
            group = add_options(parser, kind)
            for name in names:
                declared = _DECLARED[name]
                keywords: dict[type, dict[str, Any]] = {
                    str: {"choices": declared.choices},
                    bool: {"action": "store_true"},
                    int: {"type": options.whole, "metavar": "N"},
                    float: {"type": read, "metavar": metavar},
                }
                told = {"dest": name, "help": _TEXTS[name]}
                group.add_argument(flag(name), **told, **keywords[declared.kind])

    @property
    def shaped(self) -> bool:
        """Whether the scene has a profile, or at least an option that needs one."""
        return not _NEEDED.keys().isdisjoint(self.given)

    @property
    def of_materials(self) -> bool:
        """Whether a parameter is given that only scenes in SI units have, such as a modulus.

        A radius or a work of adhesion may also be dimensionless.
        """
        return not ({*_SI_OPTIONS} - {"radius", "work_of_adhesion"}).isdisjoint(self.given)

    @property
    def si(self) -> bool:
        """Whether the scene is in SI units.

        With a profile lengths and loads do not tell, as they may be in L and E'L²; without one they
        do, as a dimensionless flat punch has none.
        """
        return self.of_materials or not (self.shaped or _OF_FLAT.isdisjoint(self.given))

    def build(self) -> GivenScene:
        """Return the scene: under a profile, in SI units, or dimensionless."""
        self._check()
        given = _without_units(self.given, self.si)
        values = {name: given[name] for name in (*SCENE, *SI) if name in given}
        remarks: list[str] = []
        if self.shaped:
            values.pop("radius", None)
            values["profile"], remarks = _profile(given, self.si)
            values["layer"] = _law(given, self.si)
        if self.si:
            values |= {name: given.get(f"{name}_si", 0.0) for name in _COMPLIANCES}
            optional = [f"{name}_si" for name in _COMPLIANCES]
            if "reduced_modulus" not in given:  # it excludes friction
                optional.insert(0, "friction")
            absent = [flag(name) for name in optional if name not in given]
            if absent and not self.shaped:
                remarks.append(f"not given, and so left out: {', '.join(absent)}")
            return GivenScene(Scene.from_physical(**values), remarks)
        values = {**({"poisson_ratio": 0.3} if self.shaped else _DEFAULTS), **values}
        if "kappa" in given:
            del values["poisson_ratio"]
            return GivenScene(Scene.from_kappa(**values), remarks)
        return GivenScene(Scene(**values), remarks)

    def _check(self) -> None:
        """Refuse what mixes SI with dimensionless numbers, and options without a profile."""
        given = self.given
        for name in given:
            needed = _NEEDED.get(name, name)
            if needed not in given:
                kinds = LAWS if needed == "layer" else PROFILES
                raise UsageError(f"{flag(name)} needs {flag(needed)}, one of {', '.join(kinds)}")
        if not self.si:
            if "kappa" in given and "poisson_ratio" in given:
                raise UsageError("give one of --kappa, --poisson-ratio: both are given")
            return
        instead = {name: f"{flag(name)}-si, in m/Pa" for name in _COMPLIANCES}
        instead["kappa"] = "the moduli and Poisson's ratios"
        for name in given:
            if name in instead:
                told = f"is dimensionless and cannot be mixed with SI input; use {instead[name]}"
                raise UsageError(f"{flag(name)} {told}")

    def in_options(self, error: SceneError) -> str:
        """Return the message of an error in the words of the command line, which names options."""
        names = error.parameter.split(", ")
        options = [self._option(name) or name for name in names]
        named = ", ".join(options)
        if len(names) > 1 and isinstance(error.value, tuple):
            pairs = zip(options, error.value, strict=True)
            given = [f"{one} {value}" for one, value in pairs if value is not None]
            found = f"{' and '.join(given)} are given" if given else "none of them is given"
            return f"give one of {named}: {found}"
        allowed = re.sub("^(None|False)", "left out", error.allowed)
        if not allowed.startswith("one of"):  # which lists names, not options
            allowed = self.worded(allowed)
        if error.value is None and options[0] not in map(flag, self.given):
            is_missing = "are missing: they" if len(names) > 1 else "is missing: it"
            return f"{named} {is_missing} must be {allowed}"
        value = "none" if error.value is None else shown(error.value)
        return f"{named} = {value}: must be {allowed}"

    def worded(self, text: str) -> str:
        """Return a text in the words of the command line, with options in place of parameters."""
        text = text.replace("math.inf", "inf").replace("None", "none")
        return _PARAMETER.sub(lambda found: self._option(found[1]) or found[0], text)

    def _option(self, name: str) -> str:
        """Return the option of a parameter; nothing if the command has none."""
        known = self.given["options"]  # of the command: `command.add_commands` put them there
        option = name if name in known else _RENAMED.get(name, name)
        if self.si and name in _COMPLIANCES:
            option = f"{name}_si"
        return flag(option) if option in known else ""


class SceneOptions(FlatOptions):
    """Options of every kind of scene."""

    groups: ClassVar = {
        **FlatOptions.groups,
        _PhysicalOptions: [name for name in _SI_OPTIONS if name not in {*SHAPES, *SCENE}],
        _ProfileOptions: [*_PRESSED, *SHAPES],
        _LayerOptions: _OF_LAWS,
    }


def _without_units(given: Mapping[str, Any], si: bool) -> dict[str, Any]:
    """Return options with numbers in place of text with units.

    Only numbers of scenes in SI units may have a unit; angles may in all scenes.
    """
    plain = dict(given)
    for name, value in given.items():
        if name not in NUMBERS or not isinstance(value, str):
            continue
        unit = _DECLARED[name].unit
        # the unit of a power law depends on its exponent, and cannot be converted
        if unit != "rad" and not (si and unit and "exponent" not in unit):
            allowed = "a number without a unit" + ("" if si else ", without --youngs-modulus")
            raise SceneError(name, value, allowed)
        plain[name] = in_si(name, value, unit)
    return plain


def _options_of(kind: Any, prefix: str) -> dict[str, bool]:
    """Return the options that describe an object of a kind, and whether each is needed."""
    needs = {prefix + one.name: one.default is MISSING for one in fields(kind)}
    return _FILE_OPTIONS.get(kind, needs)


def _given_for(
    option: str, kinds: Mapping[str, type], given: Mapping[str, Any], prefix: str = ""
) -> dict[str, Any]:
    """Return the options that describe an object: all that its kind needs, and no other.

    Parameters
    ----------
    option : str
        That which names the kind, as ``profile``.
    kinds : mapping of str to type
        By the names that it may have.
    given : mapping of str to object
        All options that are given.
    prefix : str
        What the options of the parameters of these kinds begin with.

    Raises
    ------
    UsageError
        If one is missing, or belongs to another kind.
    """
    name = given[option]
    takes = _options_of(kinds[name], prefix)
    known = {one for kind in kinds.values() for one in _options_of(kind, prefix)}
    own = {one: given[one] for one in given if one in known}
    faults = [f"{flag(one)} is missing" for one in takes if takes[one] and one not in own]
    faults += [f"{flag(one)} is none of them" for one in own if one not in takes]
    if faults:
        usage = " ".join(flag(one) if takes[one] else f"[{flag(one)}]" for one in takes)
        raise UsageError(f"{flag(option)} {name} takes {usage} and no other: {faults[0]}")
    return own


def _profile(given: Mapping[str, Any], si: bool) -> tuple[Any, list[str]]:
    """Return the profile of the options, and what is to be said of its file."""
    kind, own = PROFILES[given["profile"]], _given_for("profile", PROFILES, given)
    profile: Profile
    remarks: list[str] = []
    if kind is Sampled:
        profile, *remarks = profile_of_points(**own, si=si)
    else:
        profile = kind(**own)
    if "punch_profile" in given:
        profile = Sum(profile, _punch_profile(given["punch_profile"], si))
    return profile, remarks


def _punch_profile(words: list[str], si: bool) -> Profile:
    """Return the profile of a shape and its numbers."""
    shapes = {name: one for name, one in PROFILES.items() if one not in (Flat, Sampled)}
    kind = shapes[one_of("punch_profile", words[0], shapes)]
    names = parameters_of(kind)
    given = f"--punch-profile {' '.join(words)}"
    if len(words) != 1 + len(names):
        raise UsageError(f"{given}: {words[0]} takes {' '.join(names)}")
    try:
        numbers = dict(zip(names, map(options.value, words[1:]), strict=True))
        return kind(**_without_units(numbers, si))
    except ValueError as error:
        raise UsageError(f"{given}: {error}") from None


def _law(given: Mapping[str, Any], si: bool) -> Layer | None:
    """Return the law of the options, None without."""
    if "layer" not in given:
        return None
    kind, own = LAWS[given["layer"]], _given_for("layer", LAWS, given, _LAW_PREFIX)
    if kind is Table:
        columns = own.get("layer_columns")
        return Table.from_file(own["layer_table"], columns, si_units=si, option="--layer-columns")
    try:
        return kind(**{name.removeprefix(_LAW_PREFIX): one for name, one in own.items()})
    except SceneError as error:
        raise SceneError(_LAW_PREFIX + error.parameter, error.value, error.allowed) from error
