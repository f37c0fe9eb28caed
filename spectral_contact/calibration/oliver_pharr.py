"""The modulus from stiffness and area of contact, with the compliance of a layer taken out.

Oliver and Pharr (1992): ``S = 2 beta E* sqrt(A / pi)`` on a smooth half-space, for any punch. With
a linear layer the stiffness is that of a flat punch of the contact's radius ``a`` on the layer,
``S = beta E* a / (4 delta*(alpha E* / (4 a)))`` with the approach ``delta*`` of docs/theory.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import finite, lengths, positive, real
from spectral_contact.io.physical_data import LARGEST_COMPLIANCE, SMALLEST_COMPLIANCE
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve

#: Tolerance of the approaches of flat punches, and the rounding of their logarithms.
_RTOL: Final = 1e-11
_ROUNDING: Final = 1e-14
#: Least relative error of a modulus behind a layer. And the largest: with a larger one the layer
#: takes so much of what was measured that no digit of the half-space is left.
_LEAST_ERROR: Final = 1e-9
_LARGEST_ERROR: Final = 0.1
#: Relative step of the derivative by which deviations are handed on.
_STEP: Final = 1e-3
#: Largest depth of contact [m].
_DEEPEST: Final = 1e6
#: Range of stiffnesses [N/m] and areas [m²].
_RANGE: Final = 1e-100, 1e100
#: Dimensionless compliances below it are taken for 0; those of differences are in range, too.
_LEAST_COMPLIANCE: Final = 10.0 * SMALLEST_COMPLIANCE
_POISSON_RATIO: Final = 0.25  # of no account without friction


@dataclass(frozen=True, slots=True)
class AreaFunction:
    """The area of a tip's cross-section over the distance from its end.

    Parameters
    ----------
    coefficients : sequence of float
        ``A = C0 h^2 + C1 h + C2 h^(1/2) + C3 h^(1/4) + …`` (Oliver and Pharr, 1992), in SI units.
    table : sequence of float, sequence of float
        In its place depths [m], rising from 0 or above, and areas [m²], between which it is linear
        in the depth squared.

    Raises
    ------
    SceneError
        If not one of the two is given, or numbers are not as said.
    """

    coefficients: tuple[float, ...]
    depths: tuple[float, ...]
    areas: tuple[float, ...]

    def __init__(
        self,
        coefficients: ArrayLike | None = None,
        *,
        table: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> None:
        if (coefficients is None) == (table is None):
            given = coefficients, table
            raise SceneError("coefficients, table", given, "one of them, the other None")
        known = np.empty(0) if coefficients is None else finite("coefficients", coefficients)
        depths = areas = np.empty(0)
        if table is not None:
            if not isinstance(table, tuple | list) or len(table) != 2:
                raise SceneError("table", table, "two lists, of depths and of areas")
            depths = finite("table", table[0], unit="m")
            areas = finite("table", table[1], unit="m**2")
            rising = len(depths) > 1 and (np.diff(depths) > 0.0).all() and depths[0] >= 0.0
            if not (rising and len(areas) == len(depths) and (np.diff(areas) > 0.0).all()):
                raise SceneError("table", table, "of two or more depths and areas that rise")
        elif not known.size:
            raise SceneError("coefficients", coefficients, "at least one number")
        for name, values in (("coefficients", known), ("depths", depths), ("areas", areas)):
            object.__setattr__(self, name, tuple(values.tolist()))  # into a frozen dataclass

    def area(self, depth: ArrayLike) -> Array:
        """Return the areas [m²] at depths of contact [m].

        Raises
        ------
        SceneError
            For a depth that is not above 0 or, of a table, outside of it, and where the polynomial
            is not positive.
        """
        h = np.asarray(lengths("depth", depth, _DEEPEST, "m"), dtype=np.float64)
        low, high = (self.depths[0], self.depths[-1]) if self.depths else (0.0, _DEEPEST)
        wrong = ~((h > 0.0) & (h >= low) & (h <= high))
        if wrong.any():
            told = f"finite, > 0 and in [{low:g}, {high:g}] m"
            raise SceneError("depth", float(h[wrong].flat[0]), told)
        if self.depths:
            return np.asarray(np.interp(h**2, np.square(self.depths), self.areas))
        powers = [2.0, *(2.0**-k for k in range(len(self.coefficients) - 1))]
        found = sum(c * h**n for c, n in zip(self.coefficients, powers, strict=True))
        area = np.asarray(found, dtype=np.float64)
        if not (area > 0.0).all():
            told = "such that the polynomial of the area is > 0"
            raise SceneError("depth", float(h[~(area > 0.0)].flat[0]), told)
        return area


@dataclass(frozen=True, slots=True)
class ModulusFromStiffness:
    """Moduli from stiffness and area; made by `oliver_pharr`.

    Attributes
    ----------
    reduced_modulus : tuple of float
        E* [Pa] of the half-space (and of an elastic punch), the layer taken out.
    without_layer : tuple of float
        ``sqrt(pi) S / (2 beta sqrt(A))`` [Pa], Oliver and Pharr's modulus as it is.
    error : tuple of float
        Standard deviations of the former [Pa] by those given, and the error of the computation.
    """

    reduced_modulus: tuple[float, ...]
    without_layer: tuple[float, ...]
    error: tuple[float, ...]

    def __str__(self) -> str:
        lines = [f"{'E* [Pa]':>12} {'deviation':>10} {'without layer':>14}"]
        each = zip(self.reduced_modulus, self.error, self.without_layer, strict=True)
        lines += [f"{one:12.5g} {error:10.2g} {plain:14.5g}" for one, error, plain in each]
        return "\n".join(lines)


def contact_depth(
    depth: ArrayLike, load: ArrayLike, stiffness: ArrayLike, *, epsilon: float = 0.75
) -> Array:
    """Return the depth of contact ``h - epsilon P / S``, at which an area function is taken [m].

    Parameters
    ----------
    depth, load, stiffness : array_like
        At the start of unloading [m, N, N/m]: numbers, or lists of one length.
    epsilon : float
        0.75 of paraboloids and of pyramids, 0.72 of cones, 1 of flat punches (Oliver and Pharr,
        1992).
    """
    h, force, slope = (
        finite(name, value, one_will_do=True, unit=unit)
        for name, value, unit in (
            ("depth", depth, "m"),
            ("load", load, "N"),
            ("stiffness", stiffness, "N/m"),
        )
    )
    _check_positive("stiffness", slope)
    factor = real("epsilon", epsilon, allowed="in [0, 1]", low=0.0, high=1.0)
    for name, values in (("load", force), ("stiffness", slope)):
        if len(values) not in (1, len(h)):
            raise SceneError(name, values, f"one number or {len(h)}, as the depths are")
    return np.asarray(h - factor * force / slope)


def oliver_pharr(
    stiffness: ArrayLike,
    area: ArrayLike | AreaFunction,
    *,
    depth: ArrayLike | None = None,
    normal_compliance: float | str = 0.0,
    shape_factor: float = 1.0,
    stiffness_sigma: ArrayLike = 0.0,
    area_sigma: ArrayLike = 0.0,
) -> ModulusFromStiffness:
    """Return the modulus from the stiffness at the start of unloading and the area of contact.

    It holds for elastic unloading, whatever was plastic before.

    Parameters
    ----------
    stiffness : array_like
        S = dP/dh [N/m], > 0: one number or a list.
    area : array_like or AreaFunction
        The projected area of contact [m²] at each, or the function that has it.
    depth : array_like, optional
        The depth of contact [m], for an area function: see `contact_depth`.
    normal_compliance : float
        Of the layer [m/Pa]; 0 is Oliver and Pharr's method.
    shape_factor : float
        beta, 1 for punches of revolution; about 1.03 … 1.05 is used for pyramids.
    stiffness_sigma, area_sigma : array_like
        Standard deviations, one for all or one each.

    Returns
    -------
    ModulusFromStiffness

    Raises
    ------
    SceneError
        If a number is not as said, or if the layer alone gives way more than was measured.

    Examples
    --------
    >>> from spectral_contact.calibration import oliver_pharr
    >>> print(oliver_pharr([2.0e5], [1e-12], normal_compliance=1e-18, stiffness_sigma=2e3))
         E* [Pa]  deviation  without layer
      2.3255e+11      3e+09     1.7725e+11
    """
    slope = np.atleast_1d(finite("stiffness", stiffness, one_will_do=True, unit="N/m"))
    _check_positive("stiffness", slope)
    if isinstance(area, AreaFunction):
        if depth is None:
            raise SceneError("depth", None, "given, at which the area function is taken")
        place = area.area(finite("depth", depth, one_will_do=True, unit="m"))
    else:
        if depth is not None:
            raise SceneError("depth", depth, "None where areas are given")
        place = finite("area", area, one_will_do=True, unit="m**2")
    _check_positive("area", place)
    if len(place) not in (1, len(slope)):
        told = f"one number or {len(slope)}, as the stiffnesses are"
        raise SceneError("area" if depth is None else "depth", place, told)
    place = np.broadcast_to(place, slope.shape)
    factor = positive("shape_factor", shape_factor)
    compliance = real(
        "normal_compliance", normal_compliance, allowed="finite and >= 0", low=0.0, unit="m/Pa"
    )
    deviations = [
        _deviations(name, values, unit, len(slope)) / size
        for name, values, unit, size in (
            ("stiffness_sigma", stiffness_sigma, "N/m", slope),
            ("area_sigma", area_sigma, "m**2", place),
        )
    ]
    radius = np.sqrt(place / math.pi)
    plain = slope / (2.0 * factor * radius)
    found = []
    errors = []
    each = zip(plain.tolist(), radius.tolist(), *(d.tolist() for d in deviations), strict=True)
    for modulus, a, of_stiffness, of_area in each:
        one = _behind_layer(modulus, a, compliance)
        found.append(one.value)
        parts = (one.growth * of_stiffness, (0.5 - one.growth) * of_area, one.error)
        errors.append(one.value * math.hypot(*parts))
    return ModulusFromStiffness(tuple(found), tuple(plain.tolist()), tuple(errors))


class _Modulus(NamedTuple):
    """E* behind a layer, d ln E*/d ln S with the stiffness S, and the relative error of E*."""

    value: float
    growth: float
    error: float


def _behind_layer(modulus: float, radius: float, compliance: float) -> _Modulus:
    """Return the modulus behind a layer."""
    from scipy.optimize import brentq  # takes long to import

    apparent = compliance * modulus / (4.0 * radius)
    if apparent < _LEAST_COMPLIANCE:  # the layer makes less than rounding
        return _Modulus(modulus, 1.0, _LEAST_ERROR if compliance else 0.0)

    def logarithm(x: float) -> tuple[float, float]:
        """Return ``ln(x / (8 delta*(x)))`` at ``x = exp(.)``, which rises with x, and its error."""
        scene = Scene(_POISSON_RATIO, normal_compliance=math.exp(x))
        found = solve(scene, _RTOL, ("approach",))
        error = found.error.approach
        assert error is not None  # it was asked for
        return x - math.log(8.0 * found.approach), error + _ROUNDING

    wanted = math.log(apparent)
    high = wanted + 1.0
    # as x grows, x/(8 delta*(x)) comes to pi/8, at which the layer alone has the stiffness measured
    stiffest = math.pi * radius / (2.0 * modulus)
    told = f"below {stiffest:.4g} m/Pa: such a layer alone gives way more than was measured"
    while logarithm(high)[0] < wanted:
        high += 2.0
        if high > math.log(LARGEST_COMPLIANCE):
            raise SceneError("normal_compliance", compliance, told)
    x = float(brentq(lambda v: logarithm(v)[0] - wanted, wanted, high, xtol=1e-14, rtol=1e-13))
    rise = logarithm(x + _STEP)[0] - logarithm(x - _STEP)[0]
    error = logarithm(x)[1]
    # `rise` is a difference of two numbers with this error each, and no slope if the error is a
    # tenth of it or more
    if not rise > 2.0 * error / _LARGEST_ERROR:
        told = f"below {stiffest:.4g} m/Pa by more than rounding: such a layer alone gives way by "
        raise SceneError("normal_compliance", compliance, told + "what was measured")
    growth = 2.0 * _STEP / rise
    value = modulus * math.exp(x - wanted)
    return _Modulus(value, growth, max(_LEAST_ERROR, growth * error))


def _deviations(name: str, values: ArrayLike, unit: str, count: int) -> Array:
    array = np.ravel(finite(name, values, one_will_do=True, unit=unit))
    if len(array) not in (1, count) or (array < 0.0).any():
        raise SceneError(name, values, f"finite and >= 0, one number or {count}")
    return np.broadcast_to(array, count)


def _check_positive(name: str, values: Array) -> None:
    """Refuse numbers out of the range in which nothing under- or overflows."""
    low, high = _RANGE
    wrong = values[~((values >= low) & (values <= high))]
    if wrong.size or not values.size:
        told = f"in [{low:g}, {high:g}], at least one number"
        raise SceneError(name, wrong[0].item() if wrong.size else values, told)
