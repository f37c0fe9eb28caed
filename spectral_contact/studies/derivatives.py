"""How scalars and fields of a solution change with the parameters of its scene.

By the implicit function theorem: one linear solve for each parameter, with the factors of the
solution (`contact.zone_derivatives`). All is done in two spaces, and the difference is the error.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Final, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_contact.equations.residuals import approach_slope, edge_layer_breaks
from spectral_contact.errors import NotComputedError, SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import radii
from spectral_contact.io.choices import instance, names
from spectral_contact.layers.scene_layer import refuse_layer
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import refuse_profile
from spectral_contact.quantities import RADIAL
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.mirror import with_positive_kappa
from spectral_contact.solving.slopes import (
    LOAD_RATIO,
    PARAMETERS,
    SolutionSlopes,
    kappa_slope,
)
from spectral_contact.solving.solver import Continuation
from spectral_contact.threads import one_thread
from spectral_contact.view.html import table_html
from spectral_contact.view.progress import ProgressLine
from spectral_contact.view.report import table

__all__ = ["PARAMETERS", "Derivative", "FieldDerivative", "Sensitivity", "sensitivity"]

#: What can be differentiated.
QUANTITIES: Final = ("approach", "total_shear", "stick_radius")
#: Tolerances of the spaces: of what is returned, and of what it is compared with. That one is less
#: accurate by far, so that hardly any accident makes the difference less than the error.
_TIGHT: Final = (1e-12, 1e-11)
#: How many times the difference the error is taken to be, and what rounding leaves, relative.
_SAFETY, _ROUNDING = 2.0, 1e-13
#: Rounding of approach and shear, relative, which a derivative has as an absolute error where they
#: hardly change: up to 1.8e-15 was measured, of the shear.
_ROUNDING_OF_SCALARS: Final = 2e-15
#: Rounding of the boundaries in derivatives of shear and traction, over that in derivatives of the
#: boundaries. Measured next to the critical friction: 0.01.
_SHARE_OF_NOISE: Final = 0.02
_MOST_UNKNOWNS: Final = 20_000
#: How close to the critical friction slip begins, relative, where its error is less.
_ONSET: Final = 1e-14
#: Errors of a field are relative to its modulus and so much of its largest one.
_LEAST: Final = 0.01
#: Places at which the spaces are compared besides those that are asked for.
_PLACES: Final = (np.linspace(0.05, 0.95, 10), 1.0 - np.linspace(0.05, 0.95, 10))
#: What a closed form makes of the error of its radius.
_SMOOTH: Final = 10.0
_NOT_AT_ZERO: Final = "not computed at 0"
_ALL_SLIPS: Final = "everything slips"
_ALL_STICKS: Final = "everything sticks"
_BEGINS: Final = "one-sided, of full stick: slip begins here"
_SLIPS_BACK: Final = "not computed below the largest load: with the first friction all slips back"
_UNKNOWN: Final = "the zones are hardly known here"
_RIGID: Final = "not computed without tangential compliance where zones move"
#: What solutions with adhesion are differentiated by.
_ADHESION: Final = "work_of_adhesion"
_PULLS_OFF: Final = "not finite at pull-off"
_SINGULAR: Final = "not computed on a smooth surface with coupling"
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


_D = TypeVar("_D", Derivative, FieldDerivative)


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
    boundaries : dict
        Those of the boundaries between zones, outward, by the parameter:
        ``boundaries["friction"][0]`` is that of the stick radius.
    """

    scene: Scene
    derivatives: dict[tuple[str, str], Derivative]
    fields: dict[tuple[str, str], FieldDerivative] = field(default_factory=dict)
    boundaries: dict[str, tuple[Derivative, ...]] = field(default_factory=dict)

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
        If it is no solution, or one under a profile without adhesion; for a parameter that is not
        known, and for radii that are not in [0, 1], or given twice.
    NotComputedError
        With elastic coupling, if no zones are found that obey the friction law.
    """
    scene = instance("solution", solution, Solution).scene
    if scene.work_of_adhesion is not None:
        if parameters is not None:
            names("parameters", parameters, (_ADHESION,))
        if s is not None or from_edge is not None:
            told = "None with adhesion: scalars alone are differentiated"
            raise SceneError("from_edge" if s is None else "s", from_edge if s is None else s, told)
        return Sensitivity(scene, _by_adhesion(solution))
    known = _of_scene(scene)
    asked = known if parameters is None else names("parameters", parameters, known)
    refuse_profile(scene, "sensitivity")
    refuse_layer(scene, "sensitivity")
    places = None if s is None and from_edge is None else radii(s, from_edge)
    with ProgressLine(progress) as tell, one_thread():
        problem = _Slopes(scene, places, tell)
        own = [PARAMETERS[-1] if name == "kappa" else name for name in asked]
        found = Sensitivity(
            scene, problem.derivatives(own), problem.fields(own), problem.boundaries(own)
        )
    return found if scene.mismatch is None else _by_kappa(found)


def _by_adhesion(solution: Solution) -> dict[tuple[str, str], Derivative]:
    """Return the derivatives of what is not given of load, approach and radius, by w.

    With the pull d, the stiffness S at a fixed radius and K along the curve of states, they are

        dP/dw = -S d/(2 w),  d delta/dw = -d/(2 w)                     at a given radius,
        dP/dw = -d (S - K)/(2 w),  da/dw = d**2 (S - K)/(8 pi a w**2)  at a given approach,

    where ``4 pi a w = d (S - K) d delta/da`` (docs/theory, Adhesion). At a given load the
    derivative of the approach is that of the load over -K, and that of a has a factor ``S/K``.
    """
    scene, w = solution.scene, solution.scene.work_of_adhesion
    assert w is not None
    others = "load" if scene.load is None else "approach", "contact_radius"
    if isinstance(scene.profile, Flat):  # whose radius does not change
        return {(name, _ADHESION): Derivative(0.0, 0.0) for name in others}
    a, stiffness, scales = solution.contact_radius, solution.stiffness, solution.error_scales
    pull = (scales["approach"] - solution.approach) / 2.0
    errors = {name: getattr(solution.error, name) or 0.0 for name in ("load", "approach")}
    own = solution.error.stiffness or 0.0
    off = errors["approach"] * scales["approach"] / pull + 2.0 * own + _ROUNDING
    off += errors["load"] * scales["load"] / (stiffness * pull)
    if scene.contact_radius is not None:
        fixed = {"load": -stiffness * pull / (2.0 * w), "approach": -pull / (2.0 * w)}
        return {(name, _ADHESION): Derivative(one, off) for name, one in fixed.items()}
    try:
        along = solution.stiffness_on_branch
    except NotComputedError as error:
        unknown = Derivative(math.nan, math.inf, error.reason)
        return {(name, _ADHESION): unknown for name in others}
    of_along = (solution.error.stiffness_on_branch or 0.0) * max(abs(along), stiffness)
    softer = stiffness - along
    if along == 0.0 if scene.approach is None else math.isinf(along):
        unknown = Derivative(math.nan, math.inf, _PULLS_OFF)
        return {(name, _ADHESION): unknown for name in others}
    by_radius = pull**2 / (8.0 * math.pi * a * w**2)
    if scene.approach is None:
        share = stiffness / along - 1.0
        values = pull * share / (2.0 * w), by_radius * stiffness * share
        lost = 0.0 if math.isinf(along) else stiffness / along**2 / abs(share)
        off += of_along * lost + 2.0 * own * (1.0 + 1.0 / abs(share))
    else:
        values = -pull * softer / (2.0 * w), by_radius * softer
        off += (own * stiffness + of_along) / abs(softer)
    return {
        (name, _ADHESION): Derivative(one, 2.0 * off)
        for name, one in zip(others, values, strict=True)
    }


def _of_scene(scene: Scene) -> tuple[str, ...]:
    """Return what a solution can be differentiated by: of two bodies kappa."""
    last = PARAMETERS[-1] if scene.mismatch is None else "kappa"
    return (*PARAMETERS[:-1], last, *[LOAD_RATIO] * (scene.unloaded_to < 1.0))


def _by_kappa(found: Sensitivity) -> Sensitivity:
    """Return the derivatives for two bodies from those for the size of kappa."""
    assert found.scene.mismatch is not None
    sense = -1.0 if found.scene.mismatch < 0.0 else 1.0

    def renamed(name: str) -> str:
        return "kappa" if name == PARAMETERS[-1] else name

    def turned(quantity: str, name: str, one: _D) -> _D:
        # what is radial changes its sign with kappa
        factor = sense if (quantity in RADIAL) != (name == PARAMETERS[-1]) else 1.0
        return replace(one, value=one.value * factor + 0.0)

    def named(pairs: dict[tuple[str, str], _D]) -> dict[tuple[str, str], _D]:
        return {(pair[0], renamed(pair[1])): turned(*pair, one) for pair, one in pairs.items()}

    boundaries = {
        renamed(name): tuple(turned("zones", name, one) for one in several)
        for name, several in found.boundaries.items()
    }
    return Sensitivity(found.scene, named(found.derivatives), named(found.fields), boundaries)


class _Slopes:
    """A scene and its derivatives, twice: in spaces for more digits, and for fewer."""

    def __init__(
        self, scene: Scene, places: tuple[Array, Array] | None, tell: ProgressLine
    ) -> None:
        self.scene = scene = with_positive_kappa(scene.replace(physical=None))
        self.friction = scene.friction if scene.friction is not None and scene.kappa else None
        self.tell, self.places = tell, places
        wanted = ["approach", "pressure"]
        if self.friction is not None:
            wanted += ["total_shear", "stick_radius", "zones", "traction"]
            wanted += ["critical_friction"] * (0.0 < self.friction < math.inf)
        tell("solving")
        self.own = Continuation(_TIGHT[0], wanted, _MOST_UNKNOWNS).solve(scene)
        zones = () if self.friction is None else self.own.zones
        self.kinds = tuple(zone.kind for zone in zones)
        #: whether all slips, around a stick disk that is too small to be solved for
        self.slips = self.kinds == ("slip",) and self.friction != 0.0
        self._known: tuple[SolutionSlopes, SolutionSlopes] | None = None

    @property
    def note(self) -> str:
        """What is to be said where zones begin."""
        if self.kinds != ("stick",) or self.friction in (None, math.inf):
            return ""
        unsure = max(self.own.error.critical_friction or 0.0, _ONSET)
        begins = self.own.critical_friction * (1.0 + unsure)
        return _BEGINS if self.scene.friction is not None and self.scene.friction <= begins else ""

    def derivatives(self, parameters: Iterable[str]) -> dict[tuple[str, str], Derivative]:
        """Return all there are, by quantity and parameter."""
        found = {}
        for name in parameters:
            for quantity in QUANTITIES if self.friction is not None else QUANTITIES[:1]:
                found[quantity, name] = self._derivative(quantity, name)
        return found

    def boundaries(self, parameters: Iterable[str]) -> dict[str, tuple[Derivative, ...]]:
        """Return those of all boundaries between zones, by parameter."""
        count = max(len(self.kinds) - 1, 0)
        return {
            name: tuple(self._derivative("stick_radius", name, i) for i in range(count))
            for name in parameters
        }

    def _derivative(self, quantity: str, name: str, boundary: int = 0) -> Derivative:
        if quantity == "approach" and not self._couples(name):
            return self._approach(name)
        known = self._known_number(quantity, name)
        if known is not None:
            return known
        best, other = (one.scalar(quantity, name, boundary) for one in self._evaluations())
        if not math.isfinite(best):
            return Derivative(math.nan, math.inf, _UNKNOWN)
        lost = _SAFETY * abs(best - other) + self._inherited(quantity, name)
        if self._evaluations()[0].smooth:  # a closed form, as good as the radius; that of Q cancels
            lost += _SMOOTH * (self.own.error.zones or 0.0) * abs(best)
            if quantity == "total_shear":
                lost += _ROUNDING * (1.0 if name == "friction" else self._ratio_slope)
        elif quantity == "stick_radius":
            lost += self._evaluations()[0].noise(name, boundary) * abs(best)
        elif noise := self._noise_of_zones(name):
            lost += noise * float(self._moved(quantity, name, np.abs(best)))
        error = lost / abs(best) + _ROUNDING if best else math.inf
        return Derivative(best, error, self.note)

    def _inherited(self, quantity: str, name: str) -> float:
        """Return the error of a derivative by that of the shear in it, and by rounding."""
        if quantity == "stick_radius":
            return 0.0
        rounding = _ROUNDING_OF_SCALARS * abs(float(getattr(self.own, quantity)))
        if quantity == "approach":
            return rounding / self._parameter_scale(name)
        off = (self.own.error.total_shear or 0.0) + _ROUNDING
        if name == LOAD_RATIO:
            return off * abs(self.own.total_shear) / self.scene.unloaded_to
        if name != "poisson_ratio" or self.scene.couples:
            return rounding
        slope = abs(kappa_slope(self.scene) / self.scene.kappa * self.own.total_shear)
        return slope * off + rounding

    def _noise_of_zones(self, name: str) -> float:
        """Return the relative error of derivatives of shear and fields by rounding of boundaries.

        It is large next to a threshold, where a zone is narrow.
        """
        slopes = self._evaluations()[0]
        if not slopes.inner or slopes.smooth:
            return 0.0
        return _SHARE_OF_NOISE * max(slopes.noise(name, i) for i in range(len(slopes.inner)))

    def _moved(
        self, quantity: str, name: str, size: Array, at: tuple[Array, Array] | None = None
    ) -> Array:
        """Return the part of a derivative, of this modulus, that comes with moving boundaries.

        Of a derivative by Poisson's ratio without coupling it is that by the friction.
        """
        if name != "poisson_ratio" or self.scene.couples:
            return size
        slopes = self._evaluations()[0]
        if at is None:
            by_friction = np.asarray(slopes.scalar(quantity, "friction"))
        else:
            by_friction = slopes.field(quantity, "friction", *at)
        factor = abs(kappa_slope(self.scene) / self.scene.kappa) * (self.scene.friction or 0.0)
        return np.asarray(factor * np.abs(by_friction))

    def _parameter_scale(self, name: str) -> float:
        """Return the increase of a parameter over which the approach changes as much as it can."""
        own = 0.0 if name == "poisson_ratio" else float(getattr(self.scene, name))
        return max(own, 1.0)

    @property
    def _ratio_slope(self) -> float:
        """Return by how much Poisson's ratio moves ``kappa * f/kappa``, for that alone."""
        return abs(kappa_slope(self.scene) / self.scene.kappa) * (self.scene.friction or 0.0)

    def _approach(self, name: str) -> Derivative:
        """Return that by the load, or by the normal compliance, by reciprocity; no other counts."""
        if name == LOAD_RATIO:
            value = self.own.approach / self.scene.unloaded_to
            return Derivative(value, (self.own.error.approach or 0.0) + _ROUNDING)
        if name != "normal_compliance":
            return Derivative(0.0, 0.0)
        if self.scene.normal_compliance == 0.0:
            return Derivative(math.nan, math.inf, _AT_ZERO)
        # the square of the pressure has that of the load
        breaks = edge_layer_breaks(self.scene.normal_compliance)
        of_pressure = approach_slope(lambda d: self.own.pressure(from_edge=d), breaks)
        value = of_pressure / self.scene.unloaded_to
        return Derivative(value, 2.0 * (self.own.error.pressure or 0.0) + _ROUNDING)

    def _couples(self, name: str) -> bool:
        """Return whether a parameter moves pressure and approach by coupling.

        Friction does so from none on, where there is no coupling yet.
        """
        first = name == "friction" and self.friction == 0.0 and self.scene.coupling
        return self.scene.couples or first

    def _by_itself(self, name: str) -> tuple[float, str] | None:
        """Return what all derivatives by a parameter are and what is said of it, if known."""
        if self.friction == 0.0 and name != "friction":
            return 0.0, _ALL_SLIPS
        uncoupled = name == "poisson_ratio" and not self.scene.couples
        if self.slips and (name == "tangential_compliance" or uncoupled):
            return 0.0, _ALL_SLIPS
        if self.friction == 0.0:
            return None
        if self.kinds == ("stick",) and name == "friction":
            return 0.0, self.note or _ALL_STICKS
        if getattr(self.scene, name) == 0.0 and name != "poisson_ratio":
            return math.nan, _NOT_AT_ZERO
        return None

    def _known_number(self, quantity: str, name: str) -> Derivative | None:
        """Return a derivative that follows without a system, or that there is none."""
        if self.friction == 0.0 and name == "friction" and quantity != "approach":
            if self.scene.unloaded_to < 1.0:
                return Derivative(math.nan, math.inf, _SLIPS_BACK)
            # near the centre beta q = kappa s p / 2, which is f p at the rim
            rim = 2.0 * self.scene.tangential_compliance / self.scene.kappa
            value = 1.0 if quantity == "total_shear" else rim
            return Derivative(value, 0.0, "one-sided")
        if self.slips and quantity == "stick_radius":
            return Derivative(math.nan, math.inf, _UNKNOWN)
        if self.slips and quantity == "total_shear":  # f, less what the disk lacks
            error = self.own.error.total_shear or 0.0
            return Derivative(float(name == "friction"), error, _ALL_SLIPS)
        if quantity == "stick_radius" and self.kinds == ("stick",):
            return Derivative(0.0, 0.0, self.note or _ALL_STICKS)
        known = self._by_itself(name)
        if known is None:
            return None
        value, note = known
        if quantity == "stick_radius" and note == _NOT_AT_ZERO:
            note = _AT_ZERO
        return Derivative(value, math.inf if math.isnan(value) else 0.0, note)

    def _evaluations(self) -> tuple[SolutionSlopes, SolutionSlopes]:
        """Return the derivatives in two spaces, the better one first."""
        if self._known is None:
            found = []
            for tolerance in _TIGHT:
                self.tell(f"derivatives at {tolerance:g}")
                found.append(SolutionSlopes(self.own, tolerance, self._at_largest_load(tolerance)))
            self._known = found[0], found[1]
        return self._known

    def _at_largest_load(self, tolerance: float) -> SolutionSlopes | None:
        """Return the derivatives at the largest load if what has slipped there is kept."""
        if self.scene.unloaded_to == 1.0 or "slip" not in self.kinds or not self.friction:
            return None
        largest = Continuation(tolerance, ("slip", "zones", "traction"), _MOST_UNKNOWNS).solve(
            self.scene.replace(unloaded_to=1.0)
        )
        return SolutionSlopes(largest, tolerance)

    def fields(self, parameters: Iterable[str]) -> dict[tuple[str, str], FieldDerivative]:
        """Return those of pressure and traction at the radii, by quantity and parameter."""
        if self.places is None:
            return {}
        found = {}
        for name in parameters:
            found["pressure", name] = self._pressure(name)
            if self.friction is not None:
                found["traction", name] = self._traction(name)
        return found

    def _pressure(self, name: str) -> FieldDerivative:
        scene = self.scene
        couples = self._couples(name)
        if name == LOAD_RATIO:
            return self._compared("pressure", name)
        if not couples and name != "normal_compliance":
            return self._constant(0.0)
        if scene.normal_compliance == 0.0:
            return self._constant(math.nan, _SINGULAR if couples else _NOT_AT_ZERO)
        known = self._by_itself(name) if couples else None
        if known is not None:
            return self._constant(*known)
        if couples and self._boundaries_move_rigidly:
            return self._constant(math.nan, _RIGID)
        return self._compared("pressure", name)

    @property
    def _boundaries_move_rigidly(self) -> bool:
        """Whether boundaries move without tangential compliance.

        The derivatives of the fields are then singular at the boundary. `ZoneDerivatives` has them
        at fixed boundaries, except for one stick disk under a known pressure.
        """
        return len(self.kinds) > 1 and self.scene.tangential_compliance == 0.0

    def _traction(self, name: str) -> FieldDerivative:
        assert self.places is not None
        scene = self.scene
        if self.friction == 0.0 and name == "friction":
            if scene.unloaded_to < 1.0:
                return self._constant(math.nan, _SLIPS_BACK)
            p = np.where(self.places[0] > 0.0, self.own.pressure(from_edge=self.places[1]), 0.0)
            return FieldDerivative(p, p * (self.own.error.pressure or 0.0), "one-sided")
        known = self._by_itself(name)
        if known is not None:
            return self._constant(*known)
        smooth = scene.normal_compliance == 0.0
        if smooth and scene.couples:
            return self._constant(math.nan, _SINGULAR)
        if self._boundaries_move_rigidly and (smooth or scene.couples):
            return self._constant(math.nan, _RIGID)
        return self._compared("traction", name)

    def _compared(self, quantity: str, name: str) -> FieldDerivative:
        """Return a field of both spaces, with their difference as the error."""
        assert self.places is not None
        # at places of our own, too: at one alone two fields may be alike by accident
        both = [np.concatenate([a, b.ravel()]) for a, b in zip(_PLACES, self.places, strict=True)]
        best, other = (one.field(quantity, name, *both) for one in self._evaluations())
        size = np.abs(best) + _LEAST * float(np.abs(best[np.isfinite(best)]).max(initial=0.0))
        known = np.isfinite(best)
        if quantity == "traction":
            known &= ~self._at_a_boundary(*both)
        differences = np.subtract(best, other, out=np.zeros(best.shape), where=known)
        off = np.abs(differences) / np.where(size > 0.0, size, 1.0)
        share = _SAFETY * float(off[known].max(initial=0.0)) + 10.0 * _ROUNDING
        inherited = self._field_inherited(quantity, name, both[1])
        by_zones = quantity == "traction" or self.scene.couples
        if by_zones and (noise := self._noise_of_zones(name)):
            moved = self._moved(quantity, name, size, (both[0], both[1]))
            inherited = np.add(inherited, noise * moved)
        error = np.where(known, share * size + inherited, math.inf)
        value = np.where(known, best, math.nan)
        value, error = (a[len(_PLACES[0]) :].reshape(self.places[0].shape) for a in (value, error))
        return FieldDerivative(value, error, self.note)

    def _field_inherited(self, quantity: str, name: str, from_edge: Array) -> Array:
        """Return the error of a derivative by those of the pressure or the traction in it."""
        factor = 0.0
        field_in_it = quantity
        if name == LOAD_RATIO:
            factor = 1.0 / self.scene.unloaded_to
        elif quantity == "traction" and name == "friction" and "slip" in self.kinds:
            factor = 1.0
            field_in_it = "pressure"
        elif quantity == "traction" and name == "poisson_ratio" and not self.scene.couples:
            factor = abs(kappa_slope(self.scene)) / self.scene.kappa
        if factor == 0.0:
            return np.zeros(from_edge.shape)
        error = getattr(self.own.error, field_in_it) or 0.0
        field_values = getattr(self.own, field_in_it)(from_edge=from_edge)
        return np.asarray(factor * error * np.abs(field_values))

    def _at_a_boundary(self, s: Array, from_edge: Array) -> NDArray[np.bool_]:
        """Return where a boundary of zones is, as far as it is known."""
        near = np.zeros(s.shape, dtype=bool)
        unsure = (self.own.error.zones or 0.0) + _ROUNDING
        for zone in self.own.zones[:-1]:
            near |= np.abs(from_edge - zone.outer_from_edge) <= unsure * zone.outer_from_edge
            near |= np.abs(s - zone.outer) <= unsure * zone.outer * zone.outer_from_edge
        return near

    def _constant(self, value: float, note: str = "") -> FieldDerivative:
        assert self.places is not None
        error = math.inf if math.isnan(value) else 0.0
        shape = self.places[0].shape
        return FieldDerivative(np.full(shape, value), np.full(shape, error), note)
