"""The SI data of a scene, and how they become dimensionless.

Conversions are done in exact rational arithmetic and rounded once, so no intermediate result
overflows, 1−ν² does not cancel, and the same input gives the same bits everywhere.
"""

import decimal
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from spectral_contact.errors import SceneError
from spectral_contact.inputs.checks import exactly_one, real

__all__ = ["LARGEST_COMPLIANCE", "SMALLEST_COMPLIANCE", "PhysicalData", "checked_poisson_ratio"]

#: What a dimensionless compliance may be, besides 0.
SMALLEST_COMPLIANCE: Final = 1e-14
LARGEST_COMPLIANCE: Final = 1e14


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


def checked_poisson_ratio(value: object, name: str = "poisson_ratio") -> float:
    """Return a Poisson's ratio as a Python float.

    Raises
    ------
    SceneError
        If it is not a real number in (−1, 0.5].
    """
    return real(name, value, allowed="in (-1, 0.5]", low=-1.0, high=0.5, low_open=True)


def _positive(name: str, value: object) -> float:
    return real(name, value, allowed="finite and > 0", low=0.0, low_open=True)


def _four_one_minus_square(nu: object) -> Fraction:
    return 4 * (1 - Fraction(checked_poisson_ratio(nu, "nu")) ** 2)


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
