"""Fits through a nonlinear layer: loads of approaches with derivatives by the law's numbers.

The work W of an approach is an extremum, so by a number ``theta`` of the law ``F(w; theta)`` its
derivative is that of the energy that the layer stores, and the load is ``dW/ddelta``:

    dP/dtheta = int dF/dtheta dw/ddelta dA,    dw/ddelta = (dp/ddelta) / F'(w)

The derivatives of the law are in closed form; ``dp/ddelta`` is what Newton's method ends with.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np

from spectral_contact.calibration.indentation_curve import (
    OF_INSTRUMENT,
    CurveProblem,
    beyond_profile,
    cuts,
)
from spectral_contact.calibration.load_curves import CurvePoint, LoadCurve
from spectral_contact.contact.contact_radius import RadiusScale, value_of
from spectral_contact.contact.layered_contact import solve_layered
from spectral_contact.contact.layered_setting import has_edge, setting_at_radius
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.equations.residuals import load as half_load
from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields import Array
from spectral_contact.fields.curves import LEAST
from spectral_contact.layers import GreenwoodWilliamson, Layer
from spectral_contact.layers.scene_layer import in_own_units
from spectral_contact.profiles import Profile
from spectral_contact.scene import Scene
from spectral_contact.solving.through_layer import through_layer

_MOST_UNKNOWNS: Final = 20_000
#: Exponents between which is searched.
_EXPONENTS: Final = 1.0, 10.0
#: Name of the derivative by the logarithm of a factor of all pressures of the law.
UNIT: Final = "unit"
#: Where the pressure is below this share of the largest one, it adds nothing to derivatives; number
#: of points at which the law is evaluated between these two pressures; and number of radii at which
#: the largest pressure is looked for.
_LEAST = 1e-12
_POINTS = 600
_LOOKS = 400
#: Where pressures are cut for quadrature, besides decades from the edge.
_CUTS: Final = tuple(k / 16.0 for k in range(1, 16))


class LayeredLoads(NamedTuple):
    """``L = P/E'`` of many approaches, with derivatives as of `LayeredLoad`."""

    value: Array
    by_approach: Array
    by: dict[str, Array]


class LayeredLoad(NamedTuple):
    """``L = P/E'``, and its derivatives by the approach and by logarithms of the law's numbers."""

    value: float
    by_approach: float
    by: dict[str, float]
    radius: float | None = None


def layered_load(
    profile: Profile, layer: Layer, approach: float, rtol: float, *, near: float | None = None
) -> LayeredLoad:
    """Return the load of an approach, over E', with its derivatives, all to the tolerance.

    Parameters
    ----------
    profile : Profile
    layer : Layer
        In E'.
    approach : float
        At the law's start or before it, there is no contact.
    rtol : float
    near : float or None
        Where the radius of the contact may be.
    """
    if approach <= layer.start:
        return LayeredLoad(0.0, 0.0, dict.fromkeys(_rate_names(layer), 0.0))
    found = _of_approach(profile, layer, approach, rtol, near)
    error = max(found.load_error, found.stiffness_error)
    if error > 10.0 * rtol:
        told = f"load and stiffness of {profile.brief} on {layer.brief} at {approach:.6g} are known"
        raise ConvergenceError(f"{told} to {error:.1e}", "loosen rtol.")
    by = _derivatives(profile, layer, found, _rate_names(layer))
    return LayeredLoad(found.load, found.stiffness, by, found.radius)


def _rate_names(layer: Layer) -> tuple[str, ...]:
    return (UNIT, *layer._rates(np.zeros(1)))


def _of_approach(
    profile: Profile, layer: Layer, approach: float, rtol: float, near: float | None
) -> Indentation:
    try:
        solved, _ = through_layer(
            profile, layer, rtol, _MOST_UNKNOWNS, approach=approach, pointwise=True, near=near
        )
    except SceneError as error:
        if error.parameter != "approach" or math.isinf(profile.reach):
            raise
        raise beyond_profile(profile, approach) from error
    return value_of(solved)


def layered_loads(
    profile: Profile,
    layer: Layer,
    approaches: Array,
    rtol: float,
    names: tuple[str, ...] | None = None,
) -> LayeredLoads:
    """Return loads of many approaches with their derivatives, each as of `layered_load`.

    Few radii or approaches are solved, and polynomials go through them.

    Parameters
    ----------
    profile : Profile
    layer : Layer
        In E'.
    approaches : ndarray, shape (approaches,)
    rtol : float
    names : tuple of str, optional
        Numbers of the law whose derivatives are wanted; by default all.
    """
    if names is None:
        names = _rate_names(layer)
    result = np.zeros((len(approaches), 2 + len(names)))
    touches = approaches > layer.start
    pressed, places = np.unique(approaches[touches], return_inverse=True)
    if len(pressed) >= LEAST:
        result[touches] = _interpolated(profile, layer, pressed, rtol, names)[places]
    elif len(pressed):
        near: float | None = None
        rows = []
        for approach in pressed.tolist():
            one = layered_load(profile, layer, approach, rtol, near=near)
            near = one.radius
            rows.append([one.value, one.by_approach, *(one.by[name] for name in names)])
        result[touches] = np.array(rows)[places]
    by = {name: result[:, 2 + k] for k, name in enumerate(names)}
    return LayeredLoads(result[:, 0], result[:, 1], by)


def _interpolated(
    profile: Profile, layer: Layer, approaches: Array, rtol: float, names: tuple[str, ...]
) -> Array:
    """Return the rows of rising approaches from those of few.

    Where the contact has an edge, these are of given radii: one solve each, and no search.
    """
    start = layer.start
    width = layer._size
    scale = RadiusScale(profile)

    def point(found: Indentation, abscissa: float, off: float) -> CurvePoint:
        by = _derivatives(profile, layer, found, names)
        shares = [by[name] / found.load for name in names]
        functions = np.array([math.log(found.load), math.log(found.stiffness), *shares])
        error = found.load_error
        errors = np.array([off, error, found.stiffness_error, *[error] * len(names)])
        return CurvePoint(abscissa, functions, errors)

    def at_radius(place: float) -> CurvePoint:
        setting = setting_at_radius(profile, layer, scale.radius(place))
        found = value_of(solve_layered(setting, rtol, _MOST_UNKNOWNS, pointwise=True))
        deep = found.approach - start
        return point(found, math.log(deep), found.approach_error * found.approach_size / deep)

    def of_logarithm(logarithm: float) -> CurvePoint:
        found = _of_approach(profile, layer, start + math.exp(logarithm), rtol, None)
        return point(found, logarithm, 0.0)

    def of_arcsinh(place: float) -> CurvePoint:
        found = _of_approach(profile, layer, width * math.sinh(place), rtol, None)
        return point(found, place, 0.0)

    if has_edge(profile, layer):
        # next to its start a law is a power of the distance from there: so logarithms are smooth
        outer = approaches[[0, -1]].tolist()
        first, last = (_of_approach(profile, layer, one, rtol, None).radius for one in outer)
        breaks = [one for one in profile.breaks if first < one < last]
        places = [scale.place(radius) for radius in (first, *breaks, last)]
        curve = LoadCurve(at_radius, of_logarithm, rtol)
        wanted = np.log(approaches - start)
    elif math.isfinite(start):
        wanted = np.log(approaches - start)
        places = wanted[[0, -1]].tolist()
        curve = LoadCurve(of_logarithm, of_logarithm, rtol)
    else:
        wanted = np.arcsinh(approaches / width)
        places = wanted[[0, -1]].tolist()
        curve = LoadCurve(of_arcsinh, of_arcsinh, rtol)
    load, stiffness, *shares = curve.values(places, wanted).T
    value = np.exp(load)
    return np.stack([value, np.exp(stiffness), *(value * one for one in shares)], axis=1)


def _derivatives(
    profile: Profile, layer: Layer, found: Indentation, names: tuple[str, ...]
) -> dict[str, float]:
    """Return the derivatives of the load by the logarithms of some of the law's numbers."""
    from scipy.interpolate import CubicSpline  # takes long to import

    pressure = found.pressure
    flat = found.flat
    a = found.radius
    assert pressure is not None
    assert flat is not None
    s = np.linspace(0.0, 1.0, _LOOKS)
    most = float(pressure(s, 1.0 - s).max())
    ends = layer._overclosure(_LEAST * most), layer._overclosure(most)
    w = np.linspace(*ends, _POINTS)
    if math.isfinite(layer.start):
        w = layer.start + np.geomspace(ends[0] - layer.start, ends[1] - layer.start, _POINTS)
    p = layer._pressure(w)
    slope = layer._slope(w)
    # ``(dF/dtheta)/F'``: how far the overclosure of a pressure moves with theta. It is interpolated
    # as a function of the logarithm of the pressure.
    moved = {name: rate / slope for name, rate in {UNIT: p, **layer._rates(w)}.items()}
    high = math.log(p[-1])
    places = [*cuts(profile, a, 1.0 / (float(slope.max()) * a)), *_CUTS]

    def integral(values: Array) -> float:
        spline = CubicSpline(np.log(p), values)

        def product(d: Array) -> Array:
            here = pressure(1.0 - d, d)
            seen = here > p[0]
            at = np.minimum(np.log(np.where(seen, here, p[0])), high)
            return np.where(seen, spline(at) * flat(1.0 - d, d), 0.0)

        return 2.0 * math.pi * a * half_load(product, breaks=places)

    return {name: integral(moved[name]) for name in names}


class LawProblem(CurveProblem):
    """Residuals and derivatives by ln E*, the law's numbers, and the zero point."""

    @staticmethod
    def parameters(scene: Scene) -> tuple[str, ...]:
        """Return what can be free."""
        law = tuple(_numbers_of(scene.layer))
        return ("reduced_modulus", *law, *OF_INSTRUMENT)

    @staticmethod
    def _layer_values(scene: Scene) -> dict[str, float]:
        assert scene.physical is not None
        law = scene.physical.layer
        return {name: getattr(law, name) for name in _numbers_of(law)}

    def bounds(self) -> tuple[list[float], list[float]]:
        """Return between which values is searched."""
        lows, highs = super().bounds()
        if "exponent" in self.free:
            k = self.free.index("exponent")
            start = self.known["exponent"]
            lows[k], highs[k] = (math.log(end / start) for end in _EXPONENTS)
            room = 0.1 * (highs[k] - lows[k])
            self.start[k] = min(max(0.0, lows[k] + room), highs[k] - room)  # at no end
        return lows, highs

    def look(self) -> None:
        """Refuse parameters that no data can separate, as density and tip radius of asperities."""
        self.covariance(self.at(tuple(self.start))[1])

    @property
    def _pivot(self) -> float:
        """The logarithm of an overclosure [m] at which a power law is held by its coefficient."""
        return math.log(float(np.ptp(self.depth)) or 1.0)

    def values(self, x: Sequence[float]) -> dict[str, float]:
        """Return the parameters.

        If coefficient and exponent of a power law are both free, x has the pressure at the pivot in
        place of the coefficient. With the coefficient itself, in Pa/m^exponent, a search would take
        very many small steps, as a change of the exponent is made up for by one of it.
        """
        found = super().values(x)
        if {"coefficient", "exponent"} <= set(self.free):
            moved = self._pivot * (self.known["exponent"] - found["exponent"])
            found["coefficient"] *= math.exp(moved)
        return found

    def turned(self, jacobian: Array, x: Sequence[float], sense: float) -> Array:
        """Return a Jacobian by the logarithms of the parameters as one by x, or the reverse."""
        if not {"coefficient", "exponent"} <= set(self.free):
            return jacobian
        found = jacobian.copy()
        k = self.free.index("exponent")
        more = self._pivot * self.values(x)["exponent"]
        found[:, k] -= sense * more * jacobian[:, self.free.index("coefficient")]
        return found

    def _law(self, values: dict[str, float]) -> Any:
        assert self.scene.physical is not None
        law = self.scene.physical.layer
        return replace(law, **{name: values[name] for name in _numbers_of(law)})

    def curve(self, values: dict[str, float], approach: Array) -> tuple[Array, Any]:
        """Return the loads of all approaches, and their derivatives by name."""
        quarter = values["reduced_modulus"] / 4.0
        own = in_own_units(self._law(values), quarter)
        # A pressure in Pa is a smaller multiple of E' if E' is larger, so the law in units of E'
        # changes with it (UNIT). That of asperities is given in units of E' and does not.
        in_moduli = isinstance(own, GreenwoodWilliamson)
        names = tuple(name for name in self.free if name in _rate_names(own))
        names += (UNIT,) * (not in_moduli and "reduced_modulus" in self.free)
        loads = layered_loads(self.profile, own, approach, self.rtol, names)
        value = quarter * loads.value
        by_approach = quarter * loads.by_approach
        by = {name: quarter * one for name, one in loads.by.items()}
        by["reduced_modulus"] = value - by.get(UNIT, 0.0)
        return value, {**by, "zero_point": -by_approach}

    def best(self, values: dict[str, float]) -> dict[str, Any]:
        """Return the layer that fits best, as a scene takes it."""
        return {"layer": self._law(values)}


def _numbers_of(law: Any) -> list[str]:
    """Return the names of the numbers of a law, by which there are derivatives."""
    return list(law._rates(np.zeros(1)))
