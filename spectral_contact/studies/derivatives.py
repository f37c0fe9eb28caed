"""How scalars and fields of a solution change with the parameters of its scene.

Where there is no closed form, a polynomial goes through solves at Chebyshev points of the logarithm
of the parameter, as far from the scene as its zones stay what they are.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from spectral_contact.equations.residuals import approach_slope
from spectral_contact.errors import NotComputedError
from spectral_contact.inputs.checks import radii
from spectral_contact.inputs.choices import instance, names
from spectral_contact.layers.control import refuse_layer
from spectral_contact.profiles.control import refuse_profile
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import Continuation
from spectral_contact.spectral.jacobi import chebyshev_interpolation
from spectral_contact.view.html import table_html
from spectral_contact.view.progress import ProgressLine
from spectral_contact.view.report import table

__all__ = ["PARAMETERS", "Derivative", "FieldDerivative", "Sensitivity", "sensitivity"]

Array = NDArray[np.float64]

#: What can be differentiated, and by what.
QUANTITIES: Final = ("approach", "total_shear", "stick_radius")
PARAMETERS: Final = ("normal_compliance", "tangential_compliance", "friction", "poisson_ratio")
_RTOL: Final = 1e-12
_POINTS: Final = 10
_NODES, _FIT = chebyshev_interpolation(_POINTS)
#: Half-widths of the interval, in the logarithm of the parameter, and when one is good enough.
_WIDTHS: Final = (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4)
_ENOUGH: Final = 1e-10
#: Where the interval lies, and what is said of it.
_SIDES: Final = ((0, ""), (1, "one-sided, upwards"), (-1, "one-sided, downwards"))
_MOST_UNKNOWNS: Final = 20_000
#: A boundary of zones may not move closer to a radius than half of how far it moves at all.
_MARGIN: Final = 1.5
_NOT_AT_ZERO: Final = "not computed at 0"
_ALL_SLIPS: Final = "everything slips"
_ALL_STICKS: Final = "everything sticks"
_AT_ZERO: Final = "not finite at 0, where it grows like the logarithm"


@dataclass(frozen=True, slots=True)
class Derivative:
    """One derivative.

    Attributes
    ----------
    value : float
        Dimensionless as the quantity and the parameter are; NaN where it is not finite.
    error : float
        Estimate of its relative error; infinite where no digit is known.
    note : str
        What is to be said of it: where it is not finite, or one-sided.
    """

    value: float
    error: float
    note: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class FieldDerivative:
    """The derivative of a field at some radii.

    Attributes
    ----------
    value : ndarray
        Dimensionless, of the shape of the radii; NaN where it is not known.
    error : ndarray
        Estimates of the absolute errors; infinite where no digit is known, as on the boundary of a
        zone, where the derivative of the traction jumps.
    note : str
        What is to be said of it.
    """

    value: Array
    error: Array
    note: str = ""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Derivatives of a scene's quantities; prints as a table of those of scalars.

    Attributes
    ----------
    scene : Scene
    derivatives : dict
        By quantity and parameter: ``derivatives["stick_radius", "friction"]``.
    fields : dict
        Those of fields, if radii were given: ``fields["traction", "friction"]``.
    """

    scene: Scene
    derivatives: dict[tuple[str, str], Derivative]
    fields: dict[tuple[str, str], FieldDerivative] = field(default_factory=dict)

    def __getitem__(self, pair: tuple[str, str]) -> Derivative:
        return self.derivatives[pair]

    def __str__(self) -> str:
        return table(self._cells())

    def _repr_html_(self) -> str:
        return table_html(self._cells())

    def _cells(self) -> list[tuple[str, ...]]:
        cells: list[tuple[str, ...]] = [("derivative of", "by", "value", "error estimate", "")]
        for (quantity, parameter), one in self.derivatives.items():
            words = (quantity.replace("_", " "), parameter.replace("_", " "))
            error = "exact" if one.error == 0.0 else f"{one.error:.1e}"
            cells.append((*words, f"{one.value:.12g}", error, one.note))
        return cells


def sensitivity(
    solution: Solution,
    parameters: Iterable[str] | None = None,
    *,
    s: ArrayLike | None = None,
    from_edge: ArrayLike | None = None,
    progress: bool | None = None,
) -> Sensitivity:
    """Return the derivatives of approach, total shear and stick radius, and those of fields.

    As ``solution.sensitivity`` does.

    Raises
    ------
    SceneError
        If it is no solution, or one under a profile; for a parameter that is not known, and for
        radii that are not in [0, 1], or given twice.
    NotComputedError
        With elastic coupling.
    """
    asked = PARAMETERS if parameters is None else names("parameters", parameters, PARAMETERS)
    scene = instance("solution", solution, Solution).scene
    refuse_profile(scene, "sensitivity")
    refuse_layer(scene, "sensitivity")
    if scene.couples:
        raise NotComputedError("the sensitivity", "with elastic coupling there is none yet")
    places = None if s is None and from_edge is None else radii(s, from_edge)
    with ProgressLine(progress) as tell:
        problem = _Differentiated(scene, places, tell)
        return Sensitivity(scene, problem.derivatives(asked), problem.fields(asked))


class _Differentiated:
    """A scene and those around it; radii and distances from the edge if fields are asked for."""

    def __init__(
        self, scene: Scene, places: tuple[Array, Array] | None, tell: ProgressLine
    ) -> None:
        self._tell = tell
        self.scene, self.places = scene.replace(physical=None), places
        self.friction = scene.friction if scene.kappa else None
        wanted = (*QUANTITIES, "zones")
        own = (*wanted, "pressure", *["traction"] * (places is not None))
        self._path = Continuation(_RTOL, wanted if places is None else own, _MOST_UNKNOWNS)
        self._intervals: dict[tuple[str, float, int], _Interval | None] = {}
        self.own = Continuation(_RTOL, own, _MOST_UNKNOWNS).solve(self.scene)
        self.kinds = _kinds(self.own)

    def derivatives(self, parameters: Iterable[str]) -> dict[tuple[str, str], Derivative]:
        """Return all there are, by quantity and parameter."""
        found: dict[tuple[str, str], Derivative] = {}
        for name in parameters:
            approach = Derivative(0.0, 0.0)
            if name == "normal_compliance":
                approach = self._approach()
            found["approach", name] = approach
            if self.friction is not None:
                by = self._by_poisson_ratio() if name == "poisson_ratio" else self._by(name)
                found |= {(quantity, name): one for quantity, one in by.items()}
        return found

    def _approach(self) -> Derivative:
        """Return that by the normal compliance, by reciprocity."""
        if self.scene.normal_compliance == 0.0:
            return Derivative(math.nan, math.inf, _AT_ZERO)
        value = approach_slope(lambda d: self.own.pressure(from_edge=d))
        return Derivative(value, 2.0 * (self.own.error.pressure or 0.0) + 1e-14)

    def _by(self, name: str) -> dict[str, Derivative]:
        """Return the derivatives of shear and stick radius by one parameter."""
        value = getattr(self.scene, name)
        if name == "friction" and value == 0.0:
            # near the centre beta q = kappa s p / 2, which is f p at the rim
            slope = 2.0 * self.scene.tangential_compliance / self.scene.kappa
            return {
                "total_shear": Derivative(1.0, 0.0, "one-sided"),
                "stick_radius": Derivative(slope, 0.0, "one-sided"),
            }
        if name == "friction" and (value == math.inf or self.kinds == ("stick",)):
            still = Derivative(0.0, 0.0, _ALL_STICKS)
            return {"total_shear": still, "stick_radius": still}
        if self.scene.friction == 0.0:
            return {q: Derivative(0.0, 0.0, _ALL_SLIPS) for q in QUANTITIES[1:]}
        if value == 0.0:
            found = {
                "total_shear": Derivative(math.nan, math.inf, _NOT_AT_ZERO),
                "stick_radius": Derivative(math.nan, math.inf, _AT_ZERO),
            }
        else:
            found = self._interpolated(name, value)
        if self.kinds == ("stick",):
            found["stick_radius"] = Derivative(0.0, 0.0, _ALL_STICKS)
        return found

    def _by_poisson_ratio(self) -> dict[str, Derivative]:
        """Return those by nu, which enters by kappa alone, and friction as f/kappa."""
        kappa, f = self.scene.kappa, self.friction or 0.0
        slope = -0.25 / (1.0 - self.scene.poisson_ratio) ** 2  # of kappa
        by = self._by("friction")
        factor = f if math.isfinite(f) else 0.0
        radius, shear = by["stick_radius"], by["total_shear"]
        whole, part = self.own.total_shear, factor * shear.value
        rest = whole - part
        known = abs(whole) * (self.own.error.total_shear or 0.0) + abs(part) * shear.error
        error = known / abs(rest) if rest else 0.0
        return {
            "total_shear": Derivative(slope * rest / kappa + 0.0, error, shear.note),
            "stick_radius": Derivative(
                -slope * factor / kappa * radius.value + 0.0, radius.error, radius.note
            ),
        }

    def _interpolated(self, name: str, value: float) -> dict[str, Derivative]:
        """Return the derivatives from scenes around this one, or on one side of it."""
        best: dict[str, Derivative] = {}
        for side, note in _SIDES:
            for width in _WIDTHS:
                interval = self._interval(name, value, width, side)
                if interval is None:
                    continue
                settled = True
                for quantity in QUANTITIES[1:]:
                    one, rough = interval.derivative(quantity, note)
                    settled = settled and (one.error <= _ENOUGH or not rough)
                    if quantity not in best or one.error < best[quantity].error:
                        best[quantity] = one
                if settled:  # narrower ones have but more noise
                    return best
            if best:
                return best
        unknown = Derivative(math.nan, math.inf, "the zones change here")
        return dict.fromkeys(QUANTITIES[1:], unknown)

    # --- fields -------------------------------------------------------------------------------

    def fields(self, parameters: Iterable[str]) -> dict[tuple[str, str], FieldDerivative]:
        """Return those of pressure and traction at the radii, by quantity and parameter."""
        if self.places is None:
            return {}
        found = {}
        for name in parameters:
            found["pressure", name] = self._pressure_by(name)
            if self.friction is not None:
                found["traction", name] = self._traction_by(name)
        return found

    def _pressure_by(self, name: str) -> FieldDerivative:
        if name != "normal_compliance":
            return self._constant(0.0, 0.0)
        if self.scene.normal_compliance == 0.0:
            return self._constant(math.nan, math.inf, _NOT_AT_ZERO)
        return self._field("pressure", name)

    def _traction_by(self, name: str) -> FieldDerivative:
        """Return those of the traction; by nu they follow from those by friction, as above."""
        assert self.places is not None
        friction = self.scene.friction
        if name == "poisson_ratio":
            kappa, slope = self.scene.kappa, -0.25 / (1.0 - self.scene.poisson_ratio) ** 2
            by = self._traction_by("friction")
            factor = friction if friction is not None and math.isfinite(friction) else 0.0
            q = self.own.traction(from_edge=self.places[1])
            error = np.abs(q) * (self.own.error.traction or 0.0) + factor * by.error
            change = slope * (q - factor * by.value) / kappa
            return FieldDerivative(change, abs(slope) / kappa * error, by.note)
        if friction == 0.0:  # f p as soon as there is any
            if name != "friction":
                return self._constant(0.0, 0.0, _ALL_SLIPS)
            p = np.where(self.places[0] > 0.0, self.own.pressure(from_edge=self.places[1]), 0.0)
            return FieldDerivative(p, p * (self.own.error.pressure or 0.0), "one-sided")
        if name == "friction" and self.kinds == ("stick",):
            return self._constant(0.0, 0.0, _ALL_STICKS)
        if getattr(self.scene, name) == 0.0:
            return self._constant(math.nan, math.inf, _NOT_AT_ZERO)
        return self._field("traction", name)

    def _constant(self, value: float, error: float, note: str = "") -> FieldDerivative:
        assert self.places is not None
        shape = self.places[0].shape
        return FieldDerivative(np.full(shape, value), np.full(shape, error), note)

    def _field(self, quantity: str, name: str) -> FieldDerivative:
        """Return a derivative from scenes around this one, at each radius from the best of them."""
        assert self.places is not None
        best = self._constant(math.nan, math.inf, "the zones change here")
        for side, note in _SIDES:
            for width in _WIDTHS:
                interval = self._interval(name, getattr(self.scene, name), width, side)
                if interval is None:
                    continue
                one, rough = interval.field(quantity, self.places, note)
                better = one.error < best.error
                best = FieldDerivative(
                    np.where(better, one.value, best.value),
                    np.where(better, one.error, best.error),
                    note,
                )
                largest = np.nanmax(np.abs(best.value), initial=0.0)
                if np.all((best.error <= _ENOUGH * largest) | np.logical_not(rough)):
                    return best
            if np.isfinite(best.error).any():
                return best
        return best

    # --- solutions around the scene -----------------------------------------------------------

    def _interval(self, name: str, value: float, width: float, side: int) -> _Interval | None:
        key = name, width, side
        if key not in self._intervals:
            self._intervals[key] = self._solved(name, value, width, side)
        return self._intervals[key]

    def _solved(self, name: str, value: float, width: float, side: int) -> _Interval | None:
        """Return the solutions in one interval; None if the zones change within it."""
        middle, half = (0.0, width) if side == 0 else (0.5 * side * width, 0.5 * width)
        factors, rows = np.exp(middle + half * _NODES), dict[int, Solution]()
        for i in np.argsort(-np.abs(_NODES)).tolist():  # the ends show soonest that zones change
            self._tell(f"by {name.replace('_', ' ')}")
            changed = self.scene.replace(**{name: value * float(factors[i])})
            rows[i] = self._path.solve(changed)
            if _kinds(rows[i]) != self.kinds:
                return None
        return _Interval(half * value, -float(side), [rows[i] for i in range(_POINTS)])


@dataclass(frozen=True, slots=True, eq=False)
class _Slope:
    """Derivatives, and what the polynomial lacks and noise adds of each."""

    value: Array
    lacking: Array
    noise: Array

    @property
    def error(self) -> Array:
        """Estimates of absolute errors."""
        return self.lacking + self.noise

    @property
    def rough(self) -> NDArray[np.bool_]:
        """Whether what the polynomial lacks is more than noise."""
        return self.lacking > self.noise


@dataclass(frozen=True, slots=True, eq=False)
class _Interval:
    """Solutions at Chebyshev points, and where between -1 and 1 the derivative is taken."""

    scale: float
    place: float
    solutions: list[Solution]

    def derivative(self, quantity: str, note: str) -> tuple[Derivative, bool]:
        """Return a derivative, and whether what the polynomial lacks is more than noise."""
        values = np.array([float(getattr(one, quantity)) for one in self.solutions])
        found = self._slope(values, self._relative(quantity) * np.abs(values))
        error = float(found.error / abs(found.value)) if found.value else math.inf
        return Derivative(float(found.value), error, note), bool(found.rough)

    def field(
        self, quantity: str, places: tuple[Array, Array], note: str
    ) -> tuple[FieldDerivative, NDArray[np.bool_]]:
        """Return the derivative of a field, and where what the polynomial lacks is not noise."""
        s, from_edge = places
        values = np.array([getattr(one, quantity)(from_edge=from_edge) for one in self.solutions])
        finite = np.isfinite(values).all(axis=0)
        values = np.where(finite, values, 0.0)
        relative = self._relative(quantity).reshape(-1, *[1] * s.ndim)
        slope = self._slope(values, relative * np.abs(values))
        known = np.asarray(finite)
        if quantity == "traction":
            known = known & ~self._near_a_boundary(s)
        found = FieldDerivative(
            np.where(known, slope.value, math.nan), np.where(known, slope.error, math.inf), note
        )
        return found, slope.rough | ~known

    def _relative(self, quantity: str) -> Array:
        """Return the estimates of relative errors."""
        return np.array([float(getattr(one.error, quantity) or 0.0) for one in self.solutions])

    def _slope(self, values: Array, errors: Array) -> _Slope:
        """Return derivatives along the first axis."""
        own = [chebyshev.chebval(self.place, chebyshev.chebder(row)) for row in np.eye(_POINTS)]
        weights = np.array(own) @ _FIT / self.scale
        last = np.abs(np.tensordot(_FIT[-2:], values, 1) / self.scale)
        # of the slopes of the last two, the largest there are
        orders = np.arange(_POINTS - 2, _POINTS) ** (2.0 if self.place else 1.0)
        return _Slope(
            np.tensordot(weights, values, 1),
            np.tensordot(orders, last, 1),
            np.tensordot(np.abs(weights), errors, 1),
        )

    def _near_a_boundary(self, s: Array) -> NDArray[np.bool_]:
        """Return where a boundary of zones passes by, or nearly."""
        near = np.zeros(s.shape, dtype=bool)
        for zones in zip(*(one.zones[:-1] for one in self.solutions), strict=True):
            places = [zone.outer for zone in zones]
            middle, half = (max(places) + min(places)) / 2.0, (max(places) - min(places)) / 2.0
            near |= np.abs(s - middle) <= _MARGIN * half
        return near


def _kinds(solution: Solution) -> tuple[str, ...]:
    return tuple(zone.kind for zone in solution.zones)
