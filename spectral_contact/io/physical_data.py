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
from spectral_contact.io.checks import exactly_one, flag, positive, real, scalar
from spectral_contact.io.choices import one_of
from spectral_contact.io.parameters import SCENE, SI

#: Only the softest gels and cells have moduli [Pa] below this, and they are pressed by punches and
#: loads below _SMALL_PUNCH [m] and _SMALL_LOAD [N]. Other numbers below it are likely to be in GPa.
_SOFTEST: Final = 1e3
_SMALL_PUNCH: Final = 1e-3
_SMALL_LOAD: Final = 1e-3
#: From this radius [m] on a punch is the foundation of a building, on ground whose modulus is in
#: this range [Pa]. With another modulus, a radius in mm or a modulus in MPa is likelier.
_BUILDING: Final = 1.0
_GROUND: Final = 1e6, 1e9
#: Likely range of a dimensionless compliance. Outside of it, it is likelier that a number is in
#: another unit than that there is such a surface.
_LEAST_LIKELY: Final = 1e-9
_MOST_LIKELY: Final = 1e3
#: A smaller κ of two bodies is what rounding makes of equal ones.
_LEAST_KAPPA: Final = Fraction(1, 10**16)
#: Why a flat punch is rigid.
NO_HALF_SPACE: Final = (
    "None under a flat punch: with a corner it is no half-space outside the contact, which the "
    "formulae of two elastic bodies need; give a profile, as RoundedFlat"
)
#: What a dimensionless compliance may be, besides 0.
SMALLEST_COMPLIANCE: Final = 1e-14
LARGEST_COMPLIANCE: Final = 1e14


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicalData:
    """The SI data of a scene, beside its Poisson's ratio, friction and profile.

    One of load and approach is given, or, under a profile, of load, approach and contact radius.
    Of the materials E of the half-space is given, of an elastic punch E and ν as well, or in their
    place the reduced modulus E* alone.

    Parameters
    ----------
    youngs_modulus : float or None
        E of the half-space [Pa], finite and > 0; None with a reduced modulus.
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
    punch_youngs_modulus : float or None
        E of the punch [Pa], finite and > 0; None if it is rigid. Only under a profile.
    punch_poisson_ratio : float or None
        ν of the punch, in (−1, 0.5]; None if it is rigid.
    reduced_modulus : float or None
        E* [Pa], finite and > 0, with 1/E* the sum of (1−ν²)/E of both bodies.
    work_of_adhesion : float or None
        w [J/m²], finite and > 0; only under a profile. Load and approach may then be any finite
        number here.

    Raises
    ------
    SceneError
        If a value is not a real number in its range, or not one of load, approach and contact
        radius is given, or too much or too little of the materials.
    """

    youngs_modulus: float | None
    radius: float | None = None
    load: float | None = None
    approach: float | None = None
    normal_compliance: float = 0.0
    tangential_compliance: float = 0.0
    contact_radius: float | None = field(default=None, metadata={"younger": True})
    layer: Any = field(default=None, metadata={"younger": True})
    separation: float | None = field(default=None, metadata={"younger": True})
    punch_youngs_modulus: float | None = field(default=None, metadata={"younger": True})
    punch_poisson_ratio: float | None = field(default=None, metadata={"younger": True})
    reduced_modulus: float | None = field(default=None, metadata={"younger": True})
    work_of_adhesion: float | None = field(default=None, metadata={"younger": True})

    def __post_init__(self) -> None:
        moduli = self._check_materials()
        drives = ("contact_radius", "load", "approach", "separation")
        given = [name for name in drives if getattr(self, name) is not None]
        if self.work_of_adhesion is not None:
            adhesion = SI["work_of_adhesion"].checked("work_of_adhesion", self.work_of_adhesion)
            object.__setattr__(self, "work_of_adhesion", adhesion)
        if self.radius is not None:
            for name in ("contact_radius", "separation", "work_of_adhesion"):
                if getattr(self, name) is not None:
                    told = "None with a radius, that of a flat punch"
                    raise SceneError(name, getattr(self, name), told)
            exactly_one("load", self.load, "approach", self.approach)
        elif len(given) != 1:
            values = tuple(getattr(self, name) for name in drives)
            raise SceneError(", ".join(drives), values, "one value, the others None: give one")
        for name in (*moduli, *given, *(() if self.radius is None else ("radius",))):
            signed = name in ("approach", "separation") and self.layer is not None
            signed |= name in ("approach", "load") and self.work_of_adhesion is not None
            value = getattr(self, name)
            value = real(name, value, allowed="finite") if signed else positive(name, value)
            object.__setattr__(self, name, value)
        for name in ("normal_compliance", "tangential_compliance"):
            object.__setattr__(self, name, SI[name].checked(name, getattr(self, name)))

    def _check_materials(self) -> list[str]:
        """Return which moduli are given, if they are those of one body, or two, or a sum."""
        moduli = ("reduced_modulus", "youngs_modulus", "punch_youngs_modulus")
        given = [name for name in moduli if getattr(self, name) is not None]
        if (self.punch_youngs_modulus is None) != (self.punch_poisson_ratio is None):
            missing, there = "punch_poisson_ratio", "punch_youngs_modulus"
            if self.punch_youngs_modulus is None:
                missing, there = there, missing
            told = f"given with {there}: both, or neither for a rigid punch"
            raise SceneError(missing, None, told)
        if given[:1] == ["reduced_modulus"]:
            for name in given[1:]:
                told = "None with reduced_modulus, which is that of both bodies"
                raise SceneError(name, getattr(self, name), told)
        elif self.youngs_modulus is None:
            told = "given, in Pa: that of the half-space, or reduced_modulus in its place"
            raise SceneError("youngs_modulus", None, told)
        if self.punch_poisson_ratio is not None:
            nu = checked_poisson_ratio(self.punch_poisson_ratio, "punch_poisson_ratio")
            object.__setattr__(self, "punch_poisson_ratio", nu)
            if self.radius is not None:
                raise SceneError("punch_youngs_modulus", self.punch_youngs_modulus, NO_HALF_SPACE)
        return given

    def kappa(self, nu: float | None) -> float | None:
        """Return κ = (κ₁E'₂ − κ₂E'₁)/(E'₁ + E'₂) of two elastic bodies; None if the punch is rigid.

        Less than 1e-16 is what rounding makes of equal bodies, and 0.

        Parameters
        ----------
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].

        Raises
        ------
        SceneError
            If ν is out of range.
        """
        if self.reduced_modulus is None:
            checked_poisson_ratio(nu, "nu")
        if self.punch_youngs_modulus is None:
            return None
        first = _quarter(self.youngs_modulus, nu)
        second = _quarter(self.punch_youngs_modulus, self.punch_poisson_ratio)
        difference = _kappa(nu) * second - _kappa(self.punch_poisson_ratio) * first
        kappa = difference / (first + second)
        return 0.0 if abs(kappa) < _LEAST_KAPPA else float(kappa)

    def dimensionless_compliances(self, nu: float | None) -> tuple[float, float]:
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
        unit = self._length / self._quarter(nu)  # of compliances [m/Pa]
        return (
            _dimensionless("normal_compliance", self.normal_compliance, "α* = αE/(4(1−ν²)a)", unit),
            _dimensionless(
                "tangential_compliance", self.tangential_compliance, "β* = βE/(4(1−ν²)a)", unit
            ),
        )

    def dimensionless_adhesion(self, nu: float | None) -> float | None:
        """Return the work of adhesion in E' m; None if there is no adhesion.

        Raises
        ------
        SceneError
            If ν is out of range, or the result is beyond the normal doubles.
        """
        quarter = self._quarter(nu)
        if self.work_of_adhesion is None:
            return None
        adhesion = Fraction(self.work_of_adhesion) / quarter
        return _representable("work_of_adhesion", self.work_of_adhesion, "w/E'", "m", adhesion)

    def drive(self, nu: float | None) -> dict[str, float]:
        """Return what is given of a contact under a profile, lengths in m, loads in E' m².

        Raises
        ------
        SceneError
            If ν is out of range, or the load is beyond the normal doubles.
        """
        if self.load is not None:
            load = Fraction(self.load) / self._quarter(nu)
            if self.load == 0.0:
                return {"load": 0.0}
            return {"load": _representable("load", self.load, "P/E'", "m²", load)}
        given = {name: getattr(self, name) for name in ("approach", "contact_radius", "separation")}
        return {name: value for name, value in given.items() if value is not None}

    def quarter_modulus(self, nu: float | None) -> float:
        """Return E' = E/(4(1−ν²)) [Pa], by which p, q and, in m², P under a profile are multiplied.

        It is a quarter of the reduced modulus E*; of two elastic bodies 1/E' = 1/E'₁ + 1/E'₂.

        Raises
        ------
        SceneError
            If ν is out of range, or the result is beyond the normal doubles.
        """
        name = "youngs_modulus" if self.reduced_modulus is None else "reduced_modulus"
        told = "E' = E/(4(1−ν²))"
        return _representable(name, getattr(self, name), told, "Pa", self._quarter(nu))

    def compliance_share(self, nu: float | None, *, punch: bool = False) -> float:
        """Return E'/E'ᵢ, the share of the half-space or of the punch in what both give way.

        Parameters
        ----------
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].
        punch : bool
            Whether it is that of the punch; 0 if it is rigid.

        Raises
        ------
        SceneError
            If ν is out of range.
        """
        punch = flag("punch", punch)
        checked_poisson_ratio(nu, "nu")
        if self.punch_youngs_modulus is None:
            return 0.0 if punch else 1.0
        own = _quarter(self.youngs_modulus, nu)
        if punch:
            own = _quarter(self.punch_youngs_modulus, self.punch_poisson_ratio)
        return float(self._quarter(nu) / own)

    def load_for(self, approach_star: float, nu: float | None) -> float:
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
        quarter = self._quarter(nu)
        if self.approach is None:
            assert self.load is not None  # __post_init__ saw to it
            return self.load
        load = self._length * quarter * Fraction(self.approach) / Fraction(approach_star)
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

    def displacement_scale(self, load: float, nu: float | None) -> float:
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
        scale = Fraction(load) / (self._length * self._quarter(nu))
        return _representable("load", load, "the displacement 4(1−ν²)P/(aE)", "m", scale)

    def si_factor(self, kind: str, nu: float | None, solved: Any) -> float:
        """Return what dimensionless quantities are multiplied by to be in SI units.

        Parameters
        ----------
        kind : str
            The `si_factor` of the quantity in ``quantities.OUTPUTS``.
        nu : float
            Poisson's ratio ν of the half-space, in (−1, 0.5].
        solved : object
            A solution. Its ``approach`` is read where that is given instead of the load, and its
            ``domain_radius``, else its ``contact_radius``, under a profile if that is not given.

        Raises
        ------
        SceneError
            For another kind, if an argument is out of range, or if the factor is beyond the normal
            doubles.
        """
        kinds = ("radius", "displacement", "stress", "force")
        if one_of("kind", kind, ("", *kinds), f"empty, or one of {', '.join(kinds)}") == "":
            return 1.0
        if kind == "radius":
            known = self.radius or self.contact_radius or getattr(solved, "domain_radius", None)
            return scalar("contact_radius", solved.contact_radius if known is None else known)
        if self.radius is None:  # under a profile lengths are in m
            return 1.0 if kind == "displacement" else self.quarter_modulus(nu)
        load = self.load
        if load is None:
            # tractions are in units of the largest load, from which a scene is unloaded
            ratio = getattr(getattr(solved, "scene", None), "unloaded_to", 1.0)
            load = self.load_for(scalar("approach", solved.approach) / ratio, nu)
        if kind == "force":
            return load
        return self.pressure_scale(load) if kind == "stress" else self.displacement_scale(load, nu)

    def remarks(self, nu: float | None, contact_radius: float | None = None) -> tuple[str, ...]:
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
        quarter = self._quarter(nu)
        found = self._remarks_on_modulus_and_radius(radius)
        if radius is not None:
            compliances = {"alpha": self.normal_compliance, "beta": self.tangential_compliance}
            for symbol, value in compliances.items():
                found += _remarks_on_compliance(symbol, value, Fraction(radius) / quarter)
        return tuple(found)

    def _remarks_on_modulus_and_radius(self, radius: float | None) -> list[str]:
        softest_ground, hardest_ground = _GROUND
        large = radius is not None and radius >= _BUILDING
        firmly = radius is not None and radius >= _SMALL_PUNCH
        firmly |= self.load is not None and self.load >= _SMALL_LOAD
        moduli = {
            "E": self.youngs_modulus,
            "E of the punch": self.punch_youngs_modulus,
            "E*": self.reduced_modulus,
        }
        found, doubtful = [], False
        for symbol, modulus in moduli.items():
            if modulus is None:
                continue
            meant = "MPa" if modulus < softest_ground and large else ""
            meant = "GPa" if modulus < _SOFTEST and firmly else meant
            if meant:
                told = f"{symbol} = {modulus:.6g} is in Pa"
                found.append(f"{told}: did you mean {modulus:.6g} {meant}?")
            doubtful |= large and (bool(meant) or modulus >= hardest_ground)
        if doubtful:
            found.append(f"a = {radius:.6g} is in m: did you mean {radius:.6g} mm?")
        return found

    @property
    def _length(self) -> Fraction:
        """The reference length [m]: that of a profile is 1 m."""
        return Fraction(1 if self.radius is None else self.radius)

    def _quarter(self, nu: float | None) -> Fraction:
        """E' of both bodies."""
        if self.reduced_modulus is not None:
            return Fraction(self.reduced_modulus) / 4
        own = _quarter(self.youngs_modulus, nu)
        if self.punch_youngs_modulus is None:
            return own
        other = _quarter(self.punch_youngs_modulus, self.punch_poisson_ratio)
        return own * other / (own + other)


def checked_poisson_ratio(value: object, name: str = "poisson_ratio") -> float:
    """Return a Poisson's ratio as a Python float.

    Raises
    ------
    SceneError
        If it is not a real number in (−1, 0.5].
    """
    return float(SCENE["poisson_ratio"].checked(name, value))


def _quarter(modulus: float | None, nu: object) -> Fraction:
    """Return E' = E/(4(1−ν²)) of one body."""
    assert modulus is not None  # __post_init__ saw to it
    return Fraction(modulus) / (4 * (1 - Fraction(checked_poisson_ratio(nu, "nu")) ** 2))


def _kappa(nu: object) -> Fraction:
    """Return (1−2ν)/(4(1−ν)) of one body."""
    exact = Fraction(checked_poisson_ratio(nu, "nu"))
    return (1 - 2 * exact) / (4 * (1 - exact))


def _remarks_on_compliance(symbol: str, value: float, unit: Fraction) -> list[str]:
    """Return a remark if a compliance over its unit, both in m/Pa, is unlikely, else nothing."""
    star = float(min(Fraction(value) / unit, Fraction(sys.float_info.max)))
    if value == 0.0 or _LEAST_LIKELY <= star <= _MOST_LIKELY:
        return []
    limit = f"> {_MOST_LIKELY:g}" if star > _MOST_LIKELY else f"< {_LEAST_LIKELY:g}"
    return [
        f"{symbol}* = {star:.3g} is {limit}: {symbol} = {value!r} is in m/Pa "
        f"({1e15 * value:.3g} nm/MPa), is that what was meant?"
    ]


def _dimensionless(name: str, compliance: float, formula: str, unit: Fraction) -> float:
    """Return a compliance over its unit, both in m/Pa, if it is 0 or in the range of scenes."""
    exact = Fraction(compliance) / unit
    if exact == 0 or SMALLEST_COMPLIANCE <= exact <= LARGEST_COMPLIANCE:
        return float(exact)
    allowed = f"0 or have {formula} in [1e-14, 1e14], which is {_short(exact)} here"
    raise SceneError(name, compliance, allowed)


def _representable(name: str, value: float, meaning: str, unit: str, exact: Fraction) -> float:
    """Return the nearest double, refusing what would overflow or lose digits to underflow."""
    if sys.float_info.min <= abs(exact) <= sys.float_info.max:
        return float(exact)
    allowed = f"such that {meaning} is a normal double, which is {_short(exact)} {unit} here"
    raise SceneError(name, value, allowed)


def _short(exact: Fraction) -> str:
    # Decimal exponents go far beyond those of doubles; an own context heeds nobody's settings.
    context = decimal.Context(prec=4, traps=[])
    ratio = context.divide(decimal.Decimal(exact.numerator), decimal.Decimal(exact.denominator))
    return f"{ratio:.4g}"
