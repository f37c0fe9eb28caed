"""The SI data of a scene, and how they become dimensionless.

Conversions are done in exact rational arithmetic and rounded once, so no intermediate result
overflows, 1−ν² does not cancel, and the same input gives the same bits everywhere.
"""

import decimal
import sys
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import exactly_one, positive, real, within

#: Below this modulus [Pa] there are only the softest gels and cells, which are pressed by less than
#: _SMALL_PUNCH [m] and _SMALL_LOAD [N]; numbers in GPa are below it, too.
_SOFTEST: Final = 1e3
_SMALL_PUNCH: Final = 1e-3
_SMALL_LOAD: Final = 1e-3
#: A punch of this radius [m] is a building's, on ground between these moduli [Pa]: outside, numbers
#: in mm with a modulus in Pa, or in MPa, are likelier.
_BUILDING: Final = 1.0
_GROUND: Final = 1e6, 1e9
#: Of a dimensionless compliance: outside, another unit is likelier than such a surface.
_LEAST_LIKELY: Final = 1e-9
_MOST_LIKELY: Final = 1e3
#: What a dimensionless compliance may be, besides 0.
SMALLEST_COMPLIANCE: Final = 1e-14
LARGEST_COMPLIANCE: Final = 1e14


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicalData:
    """The SI data of a scene, beside its Poisson's ratio, friction and profile.

    One of load and approach is given, or, under a profile, of load, approach and contact radius.

    Parameters
    ----------
    youngs_modulus : float
        E of the half-space [Pa], finite and > 0.
    radius : float or None
        a of a flat punch [m], finite and > 0; None under a profile, whose lengths are in m.
    load : float or None
        Normal force P [N], finite and > 0.
    approach : float or None
        Rigid approach δ of the punch [m], finite and > 0.
    normal_compliance : float
        α, normal displacement of the roughness per pressure [m/Pa], finite and >= 0.
    tangential_compliance : float
        β, radial displacement of the roughness per traction [m/Pa], finite and >= 0.
    contact_radius : float or None
        a under a profile [m], finite and > 0.
    layer : Layer or None
        The law of a nonlinear layer under a profile, pressures in Pa and lengths in m. Under it
        the approach may be any finite number here.
    separation : float or None
        Gap at the centre [m], finite; for layer laws without a contact edge.

    Raises
    ------
    SceneError
        If a value is not a real number in its range, or not one of load, approach and contact
        radius is given.
    """

    youngs_modulus: float
    radius: float | None = None
    load: float | None = None
    approach: float | None = None
    normal_compliance: float = 0.0
    tangential_compliance: float = 0.0
    contact_radius: float | None = field(default=None, metadata={"younger": True})
    layer: Any = field(default=None, metadata={"younger": True})
    separation: float | None = field(default=None, metadata={"younger": True})

    def __post_init__(self) -> None:
        drives = ("contact_radius", "load", "approach", "separation")
        given = [name for name in drives if getattr(self, name) is not None]
        if self.radius is not None:
            for name in ("contact_radius", "separation"):
                if getattr(self, name) is not None:
                    told = "None with a radius, that of a flat punch"
                    raise SceneError(name, getattr(self, name), told)
            exactly_one("load", self.load, "approach", self.approach)
        elif len(given) != 1:
            values = tuple(getattr(self, name) for name in drives)
            raise SceneError(", ".join(drives), values, "one value, the others None: give one")
        for name in ("youngs_modulus", *given, *(() if self.radius is None else ("radius",))):
            signed = name in ("approach", "separation") and self.layer is not None
            value = getattr(self, name)
            value = real(name, value, allowed="finite") if signed else positive(name, value)
            object.__setattr__(self, name, value)
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

        Notes
        -----
        Under a profile a is 1 m here, the unit of its lengths.
        """
        unit = self._length / self._reduced(nu)
        return (
            _dimensionless("normal_compliance", self.normal_compliance, "α* = αE/(4(1−ν²)a)", unit),
            _dimensionless(
                "tangential_compliance", self.tangential_compliance, "β* = βE/(4(1−ν²)a)", unit
            ),
        )

    def drive(self, nu: float) -> dict[str, float]:
        """Return what is given of a contact under a profile, lengths in m, loads in E' m².

        Raises
        ------
        SceneError
            If ν is out of range, or the load is beyond the normal doubles.
        """
        if self.load is not None:
            load = Fraction(self.load) / self._reduced(nu)
            return {"load": _representable("load", self.load, "P/E'", "m²", load)}
        given = {name: getattr(self, name) for name in ("approach", "contact_radius", "separation")}
        return {name: value for name, value in given.items() if value is not None}

    def reduced_modulus(self, nu: float) -> float:
        """Return E' = E/(4(1−ν²)) [Pa], by which p, q and, in m², P under a profile are multiplied.

        Raises
        ------
        SceneError
            If ν is out of range, or the result is beyond the normal doubles.
        """
        told = "E' = E/(4(1−ν²))"
        return _representable("youngs_modulus", self.youngs_modulus, told, "Pa", self._reduced(nu))

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
        approach_star = positive("approach_star", approach_star)
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
        load = positive("load", load)
        scale = Fraction(load) / self._length**2
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
        load = positive("load", load)
        scale = _four_one_minus_square(nu) * Fraction(load) / self._stiffness()
        return _representable("load", load, "the displacement 4(1−ν²)P/(aE)", "m", scale)

    def remarks(self, nu: float, contact_radius: float | None = None) -> tuple[str, ...]:
        """Return a question about every value that is likely to be in another unit.

        Parameters
        ----------
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].
        contact_radius : float, optional
            That of the contact [m] under a profile, if it is known; by default the one given.

        Returns
        -------
        tuple of str
            A sentence each: about the modulus, the radius and the compliances.

        Raises
        ------
        SceneError
            If an argument is out of range.
        """
        if contact_radius is not None:
            contact_radius = positive("contact_radius", contact_radius, "m")
        radius = self.radius or contact_radius or self.contact_radius
        reduced = self._reduced(nu)
        found = self._remarks_on_modulus_and_radius(radius)
        if radius is not None:
            compliances = {"alpha": self.normal_compliance, "beta": self.tangential_compliance}
            for symbol, value in compliances.items():
                found += _remarks_on_compliance(symbol, value, reduced / Fraction(radius))
        return tuple(found)

    def _remarks_on_modulus_and_radius(self, radius: float | None) -> list[str]:
        modulus, meant = self.youngs_modulus, ""
        softest_ground, hardest_ground = _GROUND
        large = radius is not None and radius >= _BUILDING
        firmly = radius is not None and radius >= _SMALL_PUNCH
        firmly |= self.load is not None and self.load >= _SMALL_LOAD
        if modulus < _SOFTEST and firmly:
            meant = "GPa"
        elif modulus < softest_ground and large:
            meant = "MPa"
        found = []
        if meant:
            found.append(f"E = {modulus:.6g} is in Pa: did you mean {modulus:.6g} {meant}?")
        if large and (meant or modulus >= hardest_ground):
            found.append(f"a = {radius:.6g} is in m: did you mean {radius:.6g} mm?")
        return found

    @property
    def _length(self) -> Fraction:
        """The reference length [m]: that of a profile is 1 m."""
        return Fraction(1 if self.radius is None else self.radius)

    def _reduced(self, nu: float) -> Fraction:
        return Fraction(self.youngs_modulus) / _four_one_minus_square(nu)

    def _stiffness(self) -> Fraction:
        return self._length * Fraction(self.youngs_modulus)


def checked_poisson_ratio(value: object, name: str = "poisson_ratio") -> float:
    """Return a Poisson's ratio as a Python float.

    Raises
    ------
    SceneError
        If it is not a real number in (−1, 0.5].
    """
    return within(name, value, "in (-1, 0.5]")


def _four_one_minus_square(nu: object) -> Fraction:
    return 4 * (1 - Fraction(checked_poisson_ratio(nu, "nu")) ** 2)


def _remarks_on_compliance(symbol: str, value: float, unit: Fraction) -> list[str]:
    """Return a remark if a compliance [m/Pa] times the unit is unlikely, else nothing."""
    star = float(min(Fraction(value) * unit, Fraction(sys.float_info.max)))
    if value == 0.0 or _LEAST_LIKELY <= star <= _MOST_LIKELY:
        return []
    limit = f"> {_MOST_LIKELY:g}" if star > _MOST_LIKELY else f"< {_LEAST_LIKELY:g}"
    return [
        f"{symbol}* = {star:.3g} is {limit}: {symbol} = {value!r} is in m/Pa "
        f"({1e15 * value:.3g} nm/MPa), is that what was meant?"
    ]


def _dimensionless(name: str, compliance: float, formula: str, unit: Fraction) -> float:
    """Return compliance/unit if it is 0 or in the range that scenes have."""
    exact = Fraction(compliance) / unit
    if exact == 0 or SMALLEST_COMPLIANCE <= exact <= LARGEST_COMPLIANCE:
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
