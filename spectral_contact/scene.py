"""The contact to be solved: a `Scene` of dimensionless parameters, and its SI data if it has any.

Dimensionless variables are the paper's, equations (3.4) and (4.4): lengths in punch radii a,
tractions in P/a², displacements in 4(1−ν²)P/(aE), compliances in 4(1−ν²)a/E.
"""

import dataclasses
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Final, Self

from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.io.checks import flag
from spectral_contact.io.choices import Suggesting, one_of, suggesting
from spectral_contact.io.documents import YOUNGER, check_schema, key_complaint, left_out, reported
from spectral_contact.io.kinds import kind_tree
from spectral_contact.io.parameters import SCENE
from spectral_contact.io.physical_data import (
    NO_HALF_SPACE,
    PhysicalData,
    checked_poisson_ratio,
)
from spectral_contact.io.units import Measured, in_si
from spectral_contact.layers import Layer
from spectral_contact.layers.scene_layer import (
    check_layer,
    in_own_units,
    layer_from,
    refuse_user_law,
)
from spectral_contact.profiles import Flat, Profile
from spectral_contact.profiles.control import (
    ALL_CONTROLS,
    checked_controls,
    profile_from,
    simplified,
    summed,
)
from spectral_contact.profiles.work_of_adhesion import checked_adhesion, checked_branch
from spectral_contact.view.output import notebook_table

__all__ = ["PhysicalData", "Scene", "same_problem"]

_SCHEMA: Final = "spectral_contact.scene"
_VERSION: Final = 1

#: Least modulus of the coupling constant κ of two bodies, unless it is 0. (That of one body, from a
#: Poisson's ratio, is 0 or at least 5.5e-17.)
_LEAST_KAPPA: Final = 1e-16


@dataclass(frozen=True, slots=True)
class Scene(Suggesting):
    """A punch on a rough elastic half-space, in the paper's dimensionless variables.

    The punch is rigid; a scene of two elastic bodies is made by `from_kappa`.
    Parameters that are left out are not modelled: without ``friction`` the contact is
    frictionless, and with both compliances 0 the surface is smooth. Scenes are immutable,
    hashable, comparable and picklable; `replace` makes a changed copy.

    Parameters
    ----------
    poisson_ratio : float or None
        ν of the half-space, in (−1, 0.5]; None where κ is given in its place or, without friction,
        it is not known.
    normal_compliance : float
        α* = αE/(4(1−ν²)a) of the roughness, equation (3.4); 0 or in [1e-14, 1e14].
    tangential_compliance : float
        β* = βE/(4(1−ν²)a) of the roughness, equation (4.4); 0 or in [1e-14, 1e14].
    friction : float or None
        Coulomb coefficient f >= 0; ``math.inf`` is full stick, None (default) no friction at all.
    physical : PhysicalData or None
        SI data that the compliances come from; keyword only. Use `from_physical` to set it.
    coupling : bool
        Elastic coupling: whether the traction acts back on the pressure, as in an elastic body.
        False, the default, is the paper's model. Keyword only.
    profile : Profile or None
        Shape of the punch, one of `spectral_contact.profiles`; None, the default, is flat.
        With a profile all lengths are in a reference length L, that of the profile's parameters,
        tractions in E' = E/(4(1−ν²)), loads in E'L², and α* is αE'/L. Keyword only.
    contact_radius, load, approach : float or None
        With a profile one of them, finite and > 0; else None. Under a layer the approach is more
        than the overclosure at which its pressure begins, and a contact radius is only given where
        there is an edge that moves. Keyword only.
    separation : float or None
        Instead of them, for layer laws without a contact edge: the gap at the centre between the
        deformed punch and body, w = −separation in the law; finite. Greenwood and Tripp's d.
        Keyword only.
    layer : Layer or None
        The law of a nonlinear layer, one of `spectral_contact.layers`, in place of
        ``normal_compliance``; with a profile, which may be ``profiles.Flat``, without friction
        or, if that is flat, in full stick. None, the default, is the linear layer. Keyword only.
    mismatch : float or None
        κ of two elastic bodies, which `from_kappa` sets. None, the default, is that of
        ``poisson_ratio``. Keyword only.
    work_of_adhesion : float or None
        Energy w per area that separates the surfaces, in E'L, in [1e-100, 1e100]; with a profile,
        which may be ``profiles.Flat``, and without friction (docs/adhesion). Load and approach may
        then be 0 or negative. None, the default, is no adhesion. Keyword only.
    branch : int
        Which of several states with adhesion that have this load, or this approach: 0, the
        default, is the one that is reached by unloading from a large contact, 1 that on the next
        stretch of the curve to smaller contacts, and so on. Keyword only.
    unloaded_to : float
        λ in (0, 1]: the load over the largest load, from which a flat punch is unloaded for the
        first time (docs/cycles). Tractions, approach and Q* stay in units of the largest load. It
        may be below 1 only without elastic coupling, and with finite friction only if there is
        a tangential compliance. 1, the default, is the largest load. Keyword only.

    Raises
    ------
    SceneError
        If a value is not a real number in its range, or the
        compliances are not those that ``physical`` implies.

    Examples
    --------
    >>> scene = Scene(poisson_ratio=0.1, normal_compliance=0.5, friction=0.1)
    >>> scene.tangential_compliance
    0.0
    """

    poisson_ratio: float | None
    normal_compliance: float = 0.0
    tangential_compliance: float = 0.0
    friction: float | None = None
    physical: PhysicalData | None = field(default=None, kw_only=True)
    coupling: bool = field(default=False, kw_only=True, metadata=YOUNGER)
    profile: Profile | None = field(default=None, kw_only=True, metadata=YOUNGER)
    contact_radius: float | None = field(default=None, kw_only=True, metadata=YOUNGER)
    load: float | None = field(default=None, kw_only=True, metadata=YOUNGER)
    approach: float | None = field(default=None, kw_only=True, metadata=YOUNGER)
    layer: Layer | None = field(default=None, kw_only=True, metadata=YOUNGER)
    separation: float | None = field(default=None, kw_only=True, metadata=YOUNGER)
    mismatch: float | None = field(default=None, kw_only=True, metadata=YOUNGER)
    work_of_adhesion: float | None = field(default=None, kw_only=True, metadata=YOUNGER)
    branch: int = field(default=0, kw_only=True, metadata=YOUNGER)
    unloaded_to: float = field(default=1.0, kw_only=True, metadata=YOUNGER)

    def __post_init__(self) -> None:
        put = object.__setattr__  # the way into a frozen dataclass
        if self.mismatch is not None:
            put(self, "mismatch", _checked_kappa("mismatch", self.mismatch))
        if self.poisson_ratio is not None or (self.mismatch is None and self.friction is not None):
            put(self, "poisson_ratio", checked_poisson_ratio(self.poisson_ratio))
        for name in ("normal_compliance", "tangential_compliance"):
            put(self, name, SCENE[name].checked(name, getattr(self, name)))
        if self.friction is not None:
            put(self, "friction", SCENE["friction"].checked("friction", self.friction))
        put(self, "coupling", flag("coupling", self.coupling))
        put(self, "profile", simplified(self.profile))
        given = {name: getattr(self, name) for name in self.__slots__}
        check_layer(given)
        put(self, "work_of_adhesion", checked_adhesion(given))
        put(self, "branch", checked_branch(given))
        put(self, "unloaded_to", _checked_load_ratio(given))
        for name, number in checked_controls(given).items():
            put(self, name, number)
        if self.physical is not None:
            self._check_physical()
        elif self.mismatch is not None and self.poisson_ratio is not None:
            told = "None where kappa is given: it is not that of one body"
            raise SceneError("poisson_ratio", self.poisson_ratio, told)

    @classmethod
    @suggesting()
    def from_kappa(
        cls,
        kappa: float,
        normal_compliance: float = 0.0,
        tangential_compliance: float = 0.0,
        friction: float | None = None,
        *,
        coupling: bool = False,
        profile: Profile | None = None,
        contact_radius: float | None = None,
        load: float | None = None,
        approach: float | None = None,
        layer: Layer | None = None,
        separation: float | None = None,
        work_of_adhesion: float | None = None,
        branch: int = 0,
        unloaded_to: float = 1.0,
    ) -> Self:
        """Make a dimensionless scene of two elastic bodies from their coupling constant κ.

        Two half-spaces in contact are equivalent to one under a rigid punch, with
        1/E' = 1/E'₁ + 1/E'₂ and κ = (κ₁E'₂ − κ₂E'₁)/(E'₁ + E'₂), where E'ᵢ = Eᵢ/(4(1−νᵢ²)) and
        κᵢ = (1−2νᵢ)/(4(1−νᵢ)) (docs/two_bodies). κ is half of Dundurs' β. It is positive where
        under pressure the surface of the half-space below moves inward more than that of the punch.
        Traction and total shear have its sign, slip the opposite one; critical friction and edge
        ratio are positive.

        Parameters
        ----------
        kappa : float
            0, or |κ| in [1e-16, 3/8).
        normal_compliance, tangential_compliance, friction
            As of `Scene`, with E' of both bodies in place of E/(4(1−ν²)).
        coupling, profile, contact_radius, load, approach, layer, separation
            As of `Scene`; the profile is the gap between the two.
        work_of_adhesion, branch, unloaded_to
            As of `Scene`.

        Raises
        ------
        SceneError
            If a value is not a real number in its range.

        Examples
        --------
        >>> scene = Scene.from_kappa(-0.05, normal_compliance=0.5, tangential_compliance=0.5)
        >>> print(scene.kappa, scene.poisson_ratio)
        -0.05 None
        """
        kappa = _checked_kappa("kappa", kappa)
        given = normal_compliance, tangential_compliance, friction
        return cls(
            None,
            *given,
            coupling=coupling,
            profile=profile,
            contact_radius=contact_radius,
            load=load,
            approach=approach,
            layer=layer,
            separation=separation,
            work_of_adhesion=work_of_adhesion,
            branch=branch,
            unloaded_to=unloaded_to,
            mismatch=kappa,
        )

    @classmethod
    @suggesting()
    def from_physical(
        cls,
        *,
        youngs_modulus: Measured | None = None,
        poisson_ratio: float | None = None,
        radius: Measured | None = None,
        load: Measured | None = None,
        approach: Measured | None = None,
        contact_radius: Measured | None = None,
        profile: Profile | None = None,
        normal_compliance: Measured = 0.0,
        tangential_compliance: Measured = 0.0,
        friction: float | None = None,
        coupling: bool = False,
        layer: Layer | None = None,
        separation: Measured | None = None,
        punch_youngs_modulus: Measured | None = None,
        punch_poisson_ratio: float | None = None,
        punch_profile: Profile | None = None,
        reduced_modulus: Measured | None = None,
        work_of_adhesion: Measured | None = None,
        branch: int = 0,
        unloaded_to: float = 1.0,
    ) -> Self:
        """Make a scene from SI data, of which exactly one of load and approach is given.

        The punch is rigid unless its modulus and Poisson's ratio are given; `kappa` and E' are then
        those of both bodies (docs/two_bodies).

        With a profile it is one of load, approach and contact radius, there is no radius, and the
        scene has the lengths in m and loads in E' m², with E' = E/(4(1−ν²)).

        Everything that has a unit may also be a quantity of pint, astropy or unyt and, where pint
        is installed, text, as ``"210 GPa"``, ``"210 N/mm²"`` and ``"50 nm/MPa"``. Plain numbers are
        in SI units; what looks like another unit is in `remarks`.

        Parameters
        ----------
        youngs_modulus : float
            E of the half-space [Pa], finite and > 0.
        poisson_ratio : float
            ν of the half-space, in (−1, 0.5].
        radius : float, optional
            a of a flat punch [m], finite and > 0.
        load : float, optional
            Normal force P [N], finite and > 0.
        approach : float, optional
            Rigid approach δ of the punch [m], finite and > 0.
        contact_radius : float, optional
            a under a profile [m], finite and > 0.
        profile : Profile, optional
            Shape of the punch, its lengths in m; flat by default.
        normal_compliance : float
            α of the roughness [m/Pa], 0 or such that α* = αE/(4(1−ν²)a) is in [1e-14, 1e14].
        tangential_compliance : float
            β of the roughness [m/Pa], 0 or such that β* = βE/(4(1−ν²)a) is in [1e-14, 1e14].
        friction : float or None
            Coulomb coefficient f >= 0; ``math.inf`` is full stick, None (default) no friction.
        coupling : bool
            Whether the traction acts back on the pressure.
        layer : Layer, optional
            The law of a nonlinear layer, its pressures in Pa and its lengths in m, with a profile.
        separation : float, optional
            Gap at the centre [m], finite; for layer laws without a contact edge.
        punch_youngs_modulus, punch_poisson_ratio : float, optional
            E [Pa] and ν of an elastic punch: both or neither. It has a profile, as a flat punch
            with a corner is no half-space outside the contact.
        punch_profile : Profile, optional
            Shape of the punch where ``profile`` is that of the other body, lengths in m; the
            scene's profile is the `profiles.Sum` of both.
        reduced_modulus : float, optional
            E* [Pa], finite and > 0, in place of all moduli and Poisson's ratios, where friction is
            not asked for; 1/E* is the sum of (1−ν²)/E of both bodies.
        work_of_adhesion : float, optional
            w [J/m²], finite and > 0, with a profile and without friction; load and approach may
            then be 0 or negative.
        branch : int
            As of `Scene`.
        unloaded_to : float
            As of `Scene`; load and approach are then the largest ones.

        Raises
        ------
        SceneError
            If a value is not a real number in its range, or not one of load, approach and contact
            radius is given, or too much or too little of the materials.
        MissingDependencyError
            If text has a unit and pint is not installed.

        Examples
        --------
        >>> from spectral_contact import Scene, profiles
        >>> ball = profiles.Parabola(radius=10e-6)
        >>> scene = Scene.from_physical(
        ...     youngs_modulus=70e9, poisson_ratio=0.2, load=5e-3, profile=ball
        ... )
        """
        needed = {"youngs_modulus": youngs_modulus, "poisson_ratio": poisson_ratio}
        if reduced_modulus is not None:
            needed = {}
        if profile is None:
            needed["radius"] = radius
        missing = [name for name, value in needed.items() if value is None]
        if missing:
            told = "given with SI data (a reduced modulus, or a profile, may take their place)"
            raise SceneError(", ".join(missing), None, told)
        if reduced_modulus is None:
            poisson_ratio = checked_poisson_ratio(poisson_ratio)
        elif poisson_ratio is not None:
            told = "None with reduced_modulus, which has it"
            raise SceneError("poisson_ratio", poisson_ratio, told)
        elif friction is not None:
            told = "None with reduced_modulus: friction takes the Poisson's ratios as well"
            raise SceneError("friction", friction, told)
        physical = PhysicalData(
            youngs_modulus=in_si("youngs_modulus", youngs_modulus, "Pa"),
            radius=in_si("radius", radius, "m"),
            load=in_si("load", load, "N"),
            approach=in_si("approach", approach, "m"),
            contact_radius=in_si("contact_radius", contact_radius, "m"),
            normal_compliance=in_si("normal_compliance", normal_compliance, "m/Pa"),
            tangential_compliance=in_si("tangential_compliance", tangential_compliance, "m/Pa"),
            layer=layer,
            separation=in_si("separation", separation, "m"),
            punch_youngs_modulus=in_si("punch_youngs_modulus", punch_youngs_modulus, "Pa"),
            punch_poisson_ratio=punch_poisson_ratio,
            reduced_modulus=in_si("reduced_modulus", reduced_modulus, "Pa"),
            work_of_adhesion=in_si("work_of_adhesion", work_of_adhesion, "J/m^2"),
        )
        profile = summed(profile, punch_profile)
        alpha, beta = physical.dimensionless_compliances(poisson_ratio)
        shape: Any = (
            {} if profile is None else {"profile": profile, **physical.drive(poisson_ratio)}
        )
        if layer is not None:
            shape["layer"] = in_own_units(layer, physical.quarter_modulus(poisson_ratio))
        return cls(
            poisson_ratio,
            alpha,
            beta,
            friction,
            physical=physical,
            coupling=coupling,
            mismatch=physical.kappa(poisson_ratio),
            work_of_adhesion=physical.dimensionless_adhesion(poisson_ratio),
            branch=branch,
            unloaded_to=unloaded_to,
            **shape,
        )

    def replace(self, **changes: Any) -> Self:
        """Return a changed copy, checked anew.

        Parameters
        ----------
        **changes
            Of a dimensionless scene parameters of `Scene` by name, or ``kappa``. A given ``kappa``
            replaces the Poisson's ratio of the scene, and a given ``poisson_ratio`` its kappa. Of a
            scene in SI units parameters of `from_physical`, where a given load replaces the
            approach, and a given approach the load; or ``physical=None``, which leaves a
            dimensionless scene.

        Raises
        ------
        SceneError
            For a name that is unknown, or a value out of its range.

        Examples
        --------
        >>> Scene(0.3, normal_compliance=0.5).replace(friction=0.1)
        Scene(poisson_ratio=0.3, normal_compliance=0.5, friction=0.1)
        """
        if self.physical is None or "physical" in changes:
            for name in changes:
                one_of("the name of a parameter", name, (*_NAMES_OF_SCENE, "kappa"))
            return dataclasses.replace(self, **self._of_one_kappa(changes))
        given = self._arguments()
        for name in changes:
            one_of("the name of a parameter", name, (*given, "punch_profile"))
        if changes.get("punch_profile") is not None and "profile" not in changes:
            told = "given with profile: the scene has the sum of both alone"
            raise SceneError("punch_profile", changes["punch_profile"], told)
        if any(changes.get(name) is not None for name in ALL_CONTROLS):
            changes = {**dict.fromkeys(ALL_CONTROLS), **changes}
        return type(self).from_physical(**{**given, **changes})

    def _of_one_kappa(self, changes: dict[str, Any]) -> dict[str, Any]:
        """Return changes in which κ and Poisson's ratio take the place of each other."""
        changes = dict(changes)
        if "kappa" in changes:
            kappa = changes.pop("kappa")
            if kappa is not None:
                kappa = _checked_kappa("kappa", kappa)
            changes = {"poisson_ratio": None, **changes, "mismatch": kappa}
        elif changes.get("poisson_ratio") is not None:
            changes["mismatch"] = None
        elif changes.get("physical", self) is None and self.mismatch is not None:
            changes["poisson_ratio"] = None  # of the dimensionless scene κ is left
        return changes

    def _arguments(self) -> dict[str, Any]:
        """Return what makes the scene: what `from_physical` takes if it has SI data."""
        own = {name: getattr(self, name) for name in _NAMES_OF_SCENE if name != "physical"}
        if self.physical is None:
            kappa = own.pop("mismatch")
            return own if kappa is None else {"kappa": kappa, **own}
        implied = (*ALL_CONTROLS, "layer", "mismatch", "work_of_adhesion")
        rest = {name: value for name, value in own.items() if name not in implied}
        return {**rest, **{name: getattr(self.physical, name) for name in _names(PhysicalData)}}

    def __repr__(self) -> str:
        made_by = type(self).__name__
        if self.physical is not None:
            made_by += ".from_physical"
        elif self.mismatch is not None:
            made_by += ".from_kappa"
        unknown = made_by == type(self).__name__ and self.poisson_ratio is None
        given = ", ".join(
            f"{name}={value!r}"
            for name, value in self._arguments().items()
            if (unknown and name == "poisson_ratio")
            or not (value is None or value is False or value == _OFF_AT.get(name))
        )
        return f"{made_by}({given})"

    def _repr_html_(self) -> str:
        return notebook_table(self)

    @property
    def kappa(self) -> float:
        """κ = (1−2ν)/(4(1−ν)), the coupling in equation (5.8); in [0, 3/8), 0 at ν = 0.5.

        To a few rounding errors of relative accuracy: near ν = 0.5, where 1−2ν cancels, the
        subtraction of doubles is exact. Of two elastic bodies it is κ of both, in (−3/8, 3/8).

        Raises
        ------
        SceneError
            If neither κ nor ν is known, as may be without friction.
        """
        if self.mismatch is not None:
            return self.mismatch
        if self.poisson_ratio is None:
            raise SceneError("poisson_ratio", None, "given: κ of this scene is not known")
        return (1.0 - 2.0 * self.poisson_ratio) / (4.0 * (1.0 - self.poisson_ratio))

    @property
    def couples(self) -> bool:
        """Whether pressure and traction act on each other, as `coupling` is on and has an effect.

        It has none without friction, where there is no traction, nor where κ is 0.
        """
        return self.coupling and bool(self.friction) and self.kappa != 0.0

    @property
    def remarks(self) -> tuple[str, ...]:
        """Questions about SI data that are likely to be in another unit; empty if there are none.

        A modulus of 210 Pa under a punch of 5 m is one. `Solution.remarks` knows more of a contact
        under a profile; the command line and ``solution.summary()`` print it.
        """
        return () if self.physical is None else self.physical.remarks(self.poisson_ratio)

    def to_dict(self) -> dict[str, Any]:
        """Return the scene as a dictionary that strict JSON can hold, infinity being ``"inf"``.

        Raises
        ------
        SceneError
            If a user wrote the law of its layer.
        """
        refuse_user_law("layer", self.layer, "in a file")
        friction = "inf" if self.friction == math.inf else self.friction
        kinds = {"profile": self.profile, "layer": self.layer}
        trees = {name: None if one is None else kind_tree(one) for name, one in kinds.items()}
        values = {**asdict(self), "friction": friction, **trees}
        if self.physical is not None and self.physical.layer is not None:
            values["physical"]["layer"] = kind_tree(self.physical.layer)
        for whole, part in ((self, values), (self.physical, values["physical"])):
            for one in fields(whole) if whole is not None else ():
                if left_out(one, part[one.name]):
                    del part[one.name]
        return {"schema": _SCHEMA, "version": _VERSION, **values}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Return the scene that `to_dict` wrote, equal to it bit for bit.

        Raises
        ------
        SolutionFileError
            If the schema or version is another, or keys are missing or unknown.
        SceneError
            If a value is out of range.
        """
        with reported("scene", "not a scene"):
            check_schema(data, "scene", _SCHEMA, _VERSION)
        _check_keys(data, Scene, "", "schema", "version")
        values = {key: data[key] for key in _names(cls) if key in data}
        friction = values["friction"]
        if isinstance(friction, str) and friction == "inf":
            values["friction"] = math.inf
        elif isinstance(friction, float) and math.isinf(friction):  # JSON's 1e999 is read so
            raise SceneError("friction", friction, 'finite, or the string "inf"')
        if values["physical"] is not None:
            _check_keys(values["physical"], PhysicalData, 'in "physical", ')
            physical = dict(values["physical"])
            if physical.get("layer") is not None:
                physical["layer"] = layer_from(physical["layer"])
            values["physical"] = PhysicalData(**physical)
        if values.get("profile") is not None:
            values["profile"] = profile_from(values["profile"])
        if values.get("layer") is not None:
            values["layer"] = layer_from(values["layer"])
        return cls(**values)

    def to_json(self) -> str:
        """Return the scene as one line of strict JSON; its numbers are exact."""
        return json.dumps(self.to_dict(), allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the scene that `to_json` wrote, equal to it bit for bit.

        Raises
        ------
        SolutionFileError
            If the text is not JSON, its schema or version is another, or keys are missing or
            unknown.
        SceneError
            If a value is out of range.
        """
        try:
            data = json.loads(text)
        except (TypeError, ValueError, RecursionError) as error:
            raise SolutionFileError("scene", f"not JSON text ({error})") from error
        return cls.from_dict(data)

    def _check_physical(self) -> None:
        # Else dataclasses.replace(scene, normal_compliance=…) would leave SI data of another scene.
        if not isinstance(self.physical, PhysicalData):
            raise SceneError("physical", self.physical, "None or a PhysicalData")
        if (self.physical.radius is None) == (self.profile is None):
            told = "given for a flat punch and None with a profile, whose lengths are in m"
            raise SceneError("radius", self.physical.radius, told)
        if isinstance(self.profile, Flat) and self.physical.punch_youngs_modulus is not None:
            raise SceneError(
                "punch_youngs_modulus", self.physical.punch_youngs_modulus, NO_HALF_SPACE
            )
        compliances = self.physical.dimensionless_compliances(self.poisson_ratio)
        names = ("normal_compliance", "tangential_compliance")
        implied: dict[str, Any] = dict(zip(names, compliances, strict=True))
        implied["mismatch"] = self.physical.kappa(self.poisson_ratio)
        implied["work_of_adhesion"] = self.physical.dimensionless_adhesion(self.poisson_ratio)
        if self.profile is not None:
            implied |= self.physical.drive(self.poisson_ratio)
        law = self.physical.layer
        if law is not None or self.layer is not None:
            modulus = self.physical.quarter_modulus(self.poisson_ratio)
            implied["layer"] = None if law is None else in_own_units(law, modulus)
        for name, number in implied.items():
            if getattr(self, name) != number:
                remedy = "change it by Scene.from_physical, or pass physical=None as well"
                raise SceneError(
                    name, getattr(self, name), f"{number!r}, as the SI data imply; {remedy}"
                )


#: What is left out of `repr` where it has this value.
_OFF_AT: Final = {
    "normal_compliance": 0.0,
    "tangential_compliance": 0.0,
    "branch": 0,
    "unloaded_to": 1.0,
}
_NAMES_OF_SCENE: Final = tuple(one.name for one in fields(Scene))
_SI: Final = "data in SI units go to Scene.from_physical(...)"
_KAPPA: Final = "scenes of two elastic bodies are made by Scene.from_kappa(...)"
# `dataclass` generates the constructor, so it can only be wrapped here.
Scene.__init__ = suggesting(  # type: ignore[method-assign]
    {"youngs_modulus": _SI, "radius": _SI, "kappa": _KAPPA}
)(Scene.__init__)


def same_problem(one: Scene, other: Scene) -> bool:
    """Return whether two scenes have one solution by definition.

    It does not matter whether κ is given or that of a Poisson's ratio. Without friction normal
    contact decides: the compliance, the profile, how far it is pressed and unloaded, and
    adhesion.
    """
    if one.friction is None and other.friction is None:
        adhesion = "work_of_adhesion", "branch"
        normal = ("normal_compliance", "layer", "profile", *ALL_CONTROLS, *adhesion, "unloaded_to")
        return all(getattr(one, name) == getattr(other, name) for name in normal)
    if one.friction is None or other.friction is None:
        return False
    bare = one.replace(physical=None), other.replace(physical=None)
    if one.mismatch is not None or other.mismatch is not None:
        bare = bare[0].replace(kappa=one.kappa), bare[1].replace(kappa=other.kappa)
    return bare[0] == bare[1]


def _checked_load_ratio(scene: Mapping[str, Any]) -> float:
    """Return the load over the largest load, of a scene that can be unloaded if it is below 1."""
    given = scene["unloaded_to"]
    ratio = float(SCENE["unloaded_to"].checked("unloaded_to", given))
    if ratio == 1.0:
        return ratio
    if scene["profile"] is not None:
        raise SceneError("unloaded_to", given, "1 with a profile: flat punches alone are unloaded")
    if scene["coupling"]:
        told = "False where unloaded_to is below 1: unloading is without elastic coupling"
        raise SceneError("coupling", True, told)
    slips = scene["friction"] not in (None, 0.0, math.inf)
    if slips and scene["tangential_compliance"] == 0.0:
        told = (
            "> 0 where unloaded_to is below 1, as slip back begins at once and its history counts"
        )
        raise SceneError("tangential_compliance", 0.0, told)
    return ratio


def _checked_kappa(name: str, value: object) -> float:
    parameter = SCENE["kappa"]
    kappa = float(parameter.checked(name, value))
    if 0.0 < abs(kappa) < _LEAST_KAPPA:
        raise SceneError(name, value, parameter.allowed)
    return kappa


def _names(cls: Any) -> list[str]:
    return [one.name for one in fields(cls)]


def _check_keys(data: Any, cls: Any, where: str, *more: str) -> None:
    """Refuse what does not have the keys of a data class, of which the younger may be missing."""
    younger = [one.name for one in fields(cls) if one.metadata == YOUNGER]
    required = [name for name in _names(cls) if name not in younger]
    complaint = key_complaint(data, [*more, *required], younger)
    if complaint:
        raise SolutionFileError("scene", f"{where}{complaint}")
