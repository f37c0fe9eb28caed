"""The contact to be solved: a `Scene` of dimensionless parameters, and its SI data if it has any.

Dimensionless variables are the paper's, equations (3.4) and (4.4): lengths in punch radii a,
tractions in P/a², displacements in 4(1−ν²)P/(aE), compliances in 4(1−ν²)a/E. Conversions are done
in exact rational arithmetic and rounded once, so no intermediate result overflows, 1−ν² does not
cancel, and the same input gives the same bits everywhere.
"""

import decimal
import json
import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields
from fractions import Fraction
from typing import Any, Final, Self

from spectral_contact.errors import SceneError, SolutionFileError, shown
from spectral_contact.inputs.checks import exactly_one, flag, real
from spectral_contact.inputs.units import Measured, in_si
from spectral_contact.io.documents import YOUNGER, key_complaint, left_out

__all__ = ["PhysicalData", "Scene"]

_SCHEMA: Final = "spectral_contact.scene"
_VERSION: Final = 1

_SMALLEST_COMPLIANCE: Final = 1e-14
_LARGEST_COMPLIANCE: Final = 1e14
_COMPLIANCE_RANGE: Final = "0 or in [1e-14, 1e14]"


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicalData:
    """The SI data of a scene, beside its Poisson's ratio and friction.

    Parameters
    ----------
    youngs_modulus : float
        E of the half-space [Pa], finite and > 0.
    radius : float
        a of the punch [m], finite and > 0.
    load : float or None
        Normal force P [N], finite and > 0; None if the approach is given.
    approach : float or None
        Rigid approach δ of the punch [m], finite and > 0; None if the load is given.
    normal_compliance : float
        α, normal displacement of the roughness per pressure [m/Pa], finite and >= 0.
    tangential_compliance : float
        β, radial displacement of the roughness per traction [m/Pa], finite and >= 0.

    Raises
    ------
    SceneError
        If a value is not a real number in its range, or both or neither of load and approach
        are given.
    """

    youngs_modulus: float
    radius: float
    load: float | None = None
    approach: float | None = None
    normal_compliance: float = 0.0
    tangential_compliance: float = 0.0

    def __post_init__(self) -> None:
        exactly_one("load", self.load, "approach", self.approach)
        for name in ("youngs_modulus", "radius", "approach" if self.load is None else "load"):
            object.__setattr__(self, name, _positive(name, getattr(self, name)))
        for name in ("normal_compliance", "tangential_compliance"):
            value = getattr(self, name)
            number = real(name, value, allowed="finite and >= 0 [m/Pa]", low=0.0)
            object.__setattr__(self, name, number)

    def dimensionless_compliances(self, nu: float) -> tuple[float, float]:
        """Return α* = αE/(4(1−ν²)a), equation (3.4), and β* = βE/(4(1−ν²)a), equation (4.4).

        Parameters
        ----------
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].

        Raises
        ------
        SceneError
            If ν is out of range, or one of the results is neither 0 nor in [1e-14, 1e14].
        """
        unit = _four_one_minus_square(nu) * Fraction(self.radius) / Fraction(self.youngs_modulus)
        return (
            _dimensionless("normal_compliance", self.normal_compliance, "α* = αE/(4(1−ν²)a)", unit),
            _dimensionless(
                "tangential_compliance", self.tangential_compliance, "β* = βE/(4(1−ν²)a)", unit
            ),
        )

    def load_for(self, approach_star: float, nu: float) -> float:
        """Return the load P [N]: the one given, or that of the approach given.

        Parameters
        ----------
        approach_star : float
            Dimensionless approach δ* = aδE/(4(1−ν²)P), equation (3.4), of the solution.
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].

        Raises
        ------
        SceneError
            If an argument is out of range, or the load is beyond the normal doubles.
        """
        approach_star = _positive("approach_star", approach_star)
        compliance = _four_one_minus_square(nu)
        if self.approach is None:
            assert self.load is not None  # __post_init__ saw to it
            return self.load
        load = self._stiffness() * Fraction(self.approach) / (compliance * Fraction(approach_star))
        return _representable("approach", self.approach, "the load P = aδE/(4(1−ν²)δ*)", "N", load)

    def pressure_scale(self, load: float) -> float:
        """Return P/a² [Pa], by which p* and q* are multiplied; equations (3.4) and (4.4).

        Parameters
        ----------
        load : float
            Normal force P [N], finite and > 0.

        Raises
        ------
        SceneError
            If the load is out of range, or the scale is beyond the normal doubles.
        """
        load = _positive("load", load)
        scale = Fraction(load) / Fraction(self.radius) ** 2
        return _representable("load", load, "the pressure P/a²", "Pa", scale)

    def displacement_scale(self, load: float, nu: float) -> float:
        """Return 4(1−ν²)P/(aE) [m], by which δ* and u_r* are multiplied; equation (3.4).

        Parameters
        ----------
        load : float
            Normal force P [N], finite and > 0.
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].

        Raises
        ------
        SceneError
            If an argument is out of range, or the scale is beyond the normal doubles.
        """
        load = _positive("load", load)
        scale = _four_one_minus_square(nu) * Fraction(load) / self._stiffness()
        return _representable("load", load, "the displacement 4(1−ν²)P/(aE)", "m", scale)

    def _stiffness(self) -> Fraction:
        return Fraction(self.radius) * Fraction(self.youngs_modulus)


@dataclass(frozen=True, slots=True)
class Scene:
    """A rigid flat punch on a rough elastic half-space, in the paper's dimensionless variables.

    What is absent is not modelled: without ``friction`` the contact is frictionless, and a
    compliance of 0 is a smooth surface. Scenes are immutable, hashable, comparable and picklable;
    `dataclasses.replace` makes a changed copy, checked anew.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    normal_compliance : float
        α* = αE/(4(1−ν²)a) of the roughness, equation (3.4); 0 (smooth) or in [1e-14, 1e14].
    tangential_compliance : float
        β* = βE/(4(1−ν²)a) of the roughness, equation (4.4); 0 (smooth) or in [1e-14, 1e14].
    friction : float or None
        Coulomb coefficient f >= 0; ``math.inf`` is full stick, None (default) no friction at all.
    physical : PhysicalData or None
        SI data that the compliances come from; keyword only. Use `from_physical` to set it.
    coupling : bool
        Whether the traction acts back on the pressure, as it does in an elastic body; keyword
        only. False, the default, is the paper's model.

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

    poisson_ratio: float
    normal_compliance: float = 0.0
    tangential_compliance: float = 0.0
    friction: float | None = None
    physical: PhysicalData | None = field(default=None, kw_only=True)
    coupling: bool = field(default=False, kw_only=True, metadata=YOUNGER)

    def __post_init__(self) -> None:
        put = object.__setattr__  # the way into a frozen dataclass
        put(self, "poisson_ratio", _poisson_ratio(self.poisson_ratio))
        for name in ("normal_compliance", "tangential_compliance"):
            value = getattr(self, name)
            number = real(name, value, allowed=_COMPLIANCE_RANGE, low=0.0, high=_LARGEST_COMPLIANCE)
            if 0.0 < number < _SMALLEST_COMPLIANCE:
                raise SceneError(name, value, _COMPLIANCE_RANGE)
            put(self, name, number)
        if self.friction is not None:
            allowed = ">= 0 (math.inf is full stick, None no friction)"
            friction = real("friction", self.friction, allowed=allowed, low=0.0, infinite_ok=True)
            put(self, "friction", friction)
        put(self, "coupling", flag("coupling", self.coupling))
        if self.physical is not None:
            self._check_physical()

    @classmethod
    def from_physical(
        cls,
        *,
        youngs_modulus: Measured,
        poisson_ratio: float,
        radius: Measured,
        load: Measured | None = None,
        approach: Measured | None = None,
        normal_compliance: Measured = 0.0,
        tangential_compliance: Measured = 0.0,
        friction: float | None = None,
        coupling: bool = False,
    ) -> Self:
        """Make a scene from SI data, of which exactly one of load and approach is given.

        Where pint is installed, everything that has a unit may also be text, as ``"210 GPa"`` and
        ``"50 nm/MPa"``, or a quantity of pint.

        Parameters
        ----------
        youngs_modulus : float
            E of the half-space [Pa], finite and > 0.
        poisson_ratio : float
            ν of the half-space, in (−1, 0.5].
        radius : float
            a of the punch [m], finite and > 0.
        load : float, optional
            Normal force P [N], finite and > 0.
        approach : float, optional
            Rigid approach δ of the punch [m], finite and > 0.
        normal_compliance : float
            α of the roughness [m/Pa], 0 or such that α* = αE/(4(1−ν²)a) is in [1e-14, 1e14].
        tangential_compliance : float
            β of the roughness [m/Pa], 0 or such that β* = βE/(4(1−ν²)a) is in [1e-14, 1e14].
        friction : float or None
            Coulomb coefficient f >= 0; ``math.inf`` is full stick, None (default) no friction.
        coupling : bool
            Whether the traction acts back on the pressure.

        Raises
        ------
        SceneError
            If a value is not a real number in its range, or both or neither of load and approach
            are given.
        MissingDependencyError
            If text has a unit and pint is not installed.
        """
        poisson_ratio = _poisson_ratio(poisson_ratio)
        physical = PhysicalData(
            youngs_modulus=in_si("youngs_modulus", youngs_modulus, "Pa"),
            radius=in_si("radius", radius, "m"),
            load=in_si("load", load, "N"),
            approach=in_si("approach", approach, "m"),
            normal_compliance=in_si("normal_compliance", normal_compliance, "m/Pa"),
            tangential_compliance=in_si("tangential_compliance", tangential_compliance, "m/Pa"),
        )
        alpha, beta = physical.dimensionless_compliances(poisson_ratio)
        return cls(poisson_ratio, alpha, beta, friction, physical=physical, coupling=coupling)

    @property
    def kappa(self) -> float:
        """κ = (1−2ν)/(4(1−ν)), the coupling in equation (5.8); in [0, 3/8), 0 at ν = 0.5.

        To a few rounding errors of relative accuracy: near ν = 0.5, where 1−2ν cancels, the
        subtraction of doubles is exact.
        """
        return (1.0 - 2.0 * self.poisson_ratio) / (4.0 * (1.0 - self.poisson_ratio))

    @property
    def couples(self) -> bool:
        """Whether pressure and traction act on each other, which is asked for, and neither is idle.

        Without friction there is no traction, and at ν = 0.5 the one does not move the other.
        """
        return self.coupling and bool(self.friction) and self.poisson_ratio != 0.5

    def to_dict(self) -> dict[str, Any]:
        """Return the scene as a dictionary that strict JSON can hold, infinity being ``"inf"``."""
        friction = "inf" if self.friction == math.inf else self.friction
        values = {**asdict(self), "friction": friction}
        for one in fields(self):
            if left_out(one, values[one.name]):
                del values[one.name]
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
        _check_schema(data)
        values = {key: data[key] for key in _names(cls) if key in data}
        friction = values["friction"]
        if isinstance(friction, str) and friction == "inf":
            values["friction"] = math.inf
        elif isinstance(friction, float) and math.isinf(friction):  # JSON's 1e999 is read so
            raise SceneError("friction", friction, 'finite, or the string "inf"')
        if values["physical"] is not None:
            _check_keys(values["physical"], _names(PhysicalData), 'in "physical", ')
            values["physical"] = PhysicalData(**values["physical"])
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
        implied = self.physical.dimensionless_compliances(self.poisson_ratio)
        for name, number in zip(
            ("normal_compliance", "tangential_compliance"), implied, strict=True
        ):
            if getattr(self, name) != number:
                remedy = "change it by Scene.from_physical, or pass physical=None as well"
                raise SceneError(
                    name, getattr(self, name), f"{number!r}, as the SI data imply; {remedy}"
                )


def _poisson_ratio(value: object, name: str = "poisson_ratio") -> float:
    return real(name, value, allowed="in (-1, 0.5]", low=-1.0, high=0.5, low_open=True)


def _positive(name: str, value: object) -> float:
    return real(name, value, allowed="finite and > 0", low=0.0, low_open=True)


def _four_one_minus_square(nu: object) -> Fraction:
    return 4 * (1 - Fraction(_poisson_ratio(nu, "nu")) ** 2)


def _dimensionless(name: str, compliance: float, formula: str, unit: Fraction) -> float:
    """Return compliance/unit if it is 0 or in the range that scenes have."""
    exact = Fraction(compliance) / unit
    if exact == 0 or _SMALLEST_COMPLIANCE <= exact <= _LARGEST_COMPLIANCE:
        return float(exact)
    allowed = f"0 or have {formula} in [1e-14, 1e14], which is {_short(exact)} here"
    raise SceneError(name, compliance, allowed)


def _representable(name: str, value: float, meaning: str, unit: str, exact: Fraction) -> float:
    """Return the nearest double, refusing what would overflow or lose digits to underflow."""
    if sys.float_info.min <= exact <= sys.float_info.max:
        return float(exact)
    allowed = f"such that {meaning} is a normal double, which is {_short(exact)} {unit} here"
    raise SceneError(name, value, allowed)


def _short(exact: Fraction) -> str:
    # Decimal exponents go far beyond those of doubles; an own context heeds nobody's settings.
    context = decimal.Context(prec=4, traps=[])
    ratio = context.divide(decimal.Decimal(exact.numerator), decimal.Decimal(exact.denominator))
    return f"{ratio:.4g}"


def _names(cls: Any) -> list[str]:
    return [one.name for one in fields(cls)]


def _check_schema(data: Any) -> None:
    schema = data.get("schema") if isinstance(data, Mapping) else None
    if not isinstance(schema, str) or schema != _SCHEMA:  # an array would compare itself by element
        raise SolutionFileError("scene", f'not a scene: its "schema" is not "{_SCHEMA}"')
    version = data.get("version")
    if type(version) is not int or version != _VERSION:
        reason = f"version {shown(version)} is not known to this release, which reads {_VERSION}"
        raise SolutionFileError("scene", reason)
    younger = [one.name for one in fields(Scene) if one.metadata == YOUNGER]
    required = [name for name in _names(Scene) if name not in younger]
    _check_keys(data, ["schema", "version", *required], "", younger)


def _check_keys(data: Any, expected: list[str], where: str, optional: Iterable[str] = ()) -> None:
    complaint = key_complaint(data, expected, optional)
    if complaint:
        raise SolutionFileError("scene", f"{where}{complaint}")
