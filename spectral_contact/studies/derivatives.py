"""Derivatives of scalars and fields of a solution by the parameters of its scene.

They follow from the implicit function theorem: one linear solve for each parameter, with the
factorisation of the solution's system (`contact.zone_derivatives`). Every derivative is computed in
two discrete spaces, and their difference is the estimate of the error.
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

#: Scalars that can be differentiated.
QUANTITIES: Final = ("approach", "total_shear", "stick_radius")
#: Tolerances of the two spaces: of the derivatives that are returned, and of those that they are
#: compared with. The second is so much looser that the difference of both is hardly ever smaller
#: than the error of the first by accident.
_TOLERANCES: Final = (1e-12, 1e-11)
#: The error is taken to be this many times the difference; chosen.
_SAFETY: Final = 2.0
#: Relative rounding of a derivative.
_ROUNDING: Final = 1e-13
#: Relative rounding of approach and shear. Times their values it is an absolute error of their
#: derivatives, which counts where they hardly change; up to 1.8e-15 was measured, of the shear.
_ROUNDING_OF_SCALARS: Final = 2e-15
#: Rounding of the boundaries between zones makes errors of derivatives. This is the relative error
#: of those of shear and traction over that of those of the boundaries: 0.01 was measured next to
#: the critical friction, and is doubled.
_SHARE_OF_NOISE: Final = 0.02
_MOST_UNKNOWNS: Final = 20_000
#: A friction is taken for the critical one if it is above it by no more than this, relative, or by
#: no more than the error of the critical one.
_ONSET: Final = 1e-14
#: Errors of a field are relative to its modulus plus this share of its largest one.
_LEAST: Final = 0.01
#: Radii at which the spaces are compared besides those that are asked for, and their distances from
#: the edge.
_PLACES: Final = (np.linspace(0.05, 0.95, 10), 1.0 - np.linspace(0.05, 0.95, 10))
#: On a smooth surface derivatives are closed forms in the stick radius: their error over that of
#: the stick radius; chosen.
_CLOSED_FORM: Final = 10.0
# Notes: why a derivative is what it is.
_NOT_AT_ZERO: Final = "not computed at 0"
_ALL_SLIPS: Final = "everything slips"
_ALL_STICKS: Final = "everything sticks"
_BEGINS: Final = "one-sided, of full stick: slip begins here"
_SLIPS_BACK: Final = "not computed below the largest load: with the first friction all slips back"
_UNKNOWN: Final = "the zones are hardly known here"
_RIGID: Final = "not computed without tangential compliance where zones move"
#: The parameter by which solutions with adhesion are differentiated.
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
        Why it is not finite or not computed, or that it is one-sided; else empty.
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
        As of `Derivative`.
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
        Of scalars, by quantity and parameter: ``derivatives["stick_radius", "friction"]``.
    fields : dict
        Of fields, if radii were given: ``fields["traction", "friction"]``.
    boundaries : dict
        Of the boundaries between zones from the centre on, by parameter:
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

    Parameters and result are those of ``solution.sensitivity``.

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
    """Return the derivatives by w of load, approach and contact radius, those not given of them.

    Under a flat punch the contact radius is not given either, and all of them are 0. Adhesion
    lowers the approach at a given radius by the pull d. With the stiffness S at a fixed radius and
    the stiffness K along the curve of states they are

        dP/dw = -S d/(2 w),  d delta/dw = -d/(2 w)                     at a given radius,
        dP/dw = -d (S - K)/(2 w),  da/dw = d**2 (S - K)/(8 pi a w**2)  at a given approach,

    where ``4 pi a w = d (S - K) d delta/da`` (docs/theory, Adhesion). At a given load the
    derivative of the approach is that of the load over -K, and that of a has a factor ``S/K``.
    """
    scene = solution.scene
    w = scene.work_of_adhesion
    assert w is not None
    others = "load" if scene.load is None else "approach", "contact_radius"
    if isinstance(scene.profile, Flat):  # whose radius does not change
        return {(name, _ADHESION): Derivative(0.0, 0.0) for name in others}
    a = solution.contact_radius
    stiffness = solution.stiffness
    # the approach is that without adhesion less the pull, and its scale is the sum of both
    scales = solution.error_scales
    pull = (scales["approach"] - solution.approach) / 2.0
    errors = {name: getattr(solution.error, name) or 0.0 for name in ("load", "approach")}
    stiffness_error = solution.error.stiffness or 0.0
    # relative error of the derivatives: of the pull, by approach and load, and of the stiffness
    off = errors["approach"] * scales["approach"] / pull + 2.0 * stiffness_error + _ROUNDING
    off += errors["load"] * scales["load"] / (stiffness * pull)
    if scene.contact_radius is not None:
        fixed = {"load": -stiffness * pull / (2.0 * w), "approach": -pull / (2.0 * w)}
        return {(name, _ADHESION): Derivative(one, off) for name, one in fixed.items()}
    try:
        on_branch = solution.stiffness_on_branch
    except NotComputedError as error:
        unknown = Derivative(math.nan, math.inf, error.reason)
        return {(name, _ADHESION): unknown for name in others}
    on_branch_error = (solution.error.stiffness_on_branch or 0.0) * max(abs(on_branch), stiffness)
    # the contact pulls off where a given load, or a given approach, is an extremum of the curve
    at_pull_off = on_branch == 0.0 if scene.approach is None else math.isinf(on_branch)
    if at_pull_off:
        unknown = Derivative(math.nan, math.inf, _PULLS_OFF)
        return {(name, _ADHESION): unknown for name in others}
    factor = pull**2 / (8.0 * math.pi * a * w**2)
    if scene.approach is None:
        excess = stiffness / on_branch - 1.0  # (S - K)/K
        values = pull * excess / (2.0 * w), factor * stiffness * excess
        lost = 0.0 if math.isinf(on_branch) else stiffness / on_branch**2 / abs(excess)
        off += on_branch_error * lost + 2.0 * stiffness_error * (1.0 + 1.0 / abs(excess))
    else:
        softer = stiffness - on_branch
        values = -pull * softer / (2.0 * w), factor * softer
        off += (stiffness_error * stiffness + on_branch_error) / abs(softer)
    return {
        (name, _ADHESION): Derivative(one, 2.0 * off)
        for name, one in zip(others, values, strict=True)
    }


def _of_scene(scene: Scene) -> tuple[str, ...]:
    """Return the parameters of a scene; for two bodies kappa takes the place of Poisson's ratio."""
    last = PARAMETERS[-1] if scene.mismatch is None else "kappa"
    return (*PARAMETERS[:-1], last, *[LOAD_RATIO] * (scene.unloaded_to < 1.0))


def _by_kappa(found: Sensitivity) -> Sensitivity:
    """Return the derivatives for two bodies, by kappa, from those for the modulus of kappa."""
    assert found.scene.mismatch is not None
    sign = -1.0 if found.scene.mismatch < 0.0 else 1.0

    def renamed(name: str) -> str:
        return "kappa" if name == PARAMETERS[-1] else name

    def signed(quantity: str, name: str, one: _D) -> _D:
        # radial quantities change their sign with kappa, and so do derivatives by kappa
        factor = sign if (quantity in RADIAL) != (name == PARAMETERS[-1]) else 1.0
        return replace(one, value=one.value * factor + 0.0)  # + 0.0: no zero is negative

    def named(pairs: dict[tuple[str, str], _D]) -> dict[tuple[str, str], _D]:
        return {(pair[0], renamed(pair[1])): signed(*pair, one) for pair, one in pairs.items()}

    boundaries = {
        renamed(name): tuple(signed("zones", name, one) for one in several)
        for name, several in found.boundaries.items()
    }
    return Sensitivity(found.scene, named(found.derivatives), named(found.fields), boundaries)


class _Slopes:
    """The derivatives of a scene without adhesion.

    Parameters
    ----------
    scene : Scene
    places : tuple of ndarray, or None
        Radii at which fields are differentiated, and their distances from the edge.
    tell : ProgressLine

    Attributes
    ----------
    scene : Scene
        The dimensionless scene with the modulus of kappa, to which everything here belongs.
    friction : float or None
        None also if kappa is 0, where there is no traction.
    own : Solution
        Its solution.
    kinds : tuple of str
        Kinds of its zones.
    """

    def __init__(
        self, scene: Scene, places: tuple[Array, Array] | None, tell: ProgressLine
    ) -> None:
        self.scene = scene = with_positive_kappa(scene.replace(physical=None))
        self.friction = scene.friction if scene.friction is not None and scene.kappa else None
        self.tell = tell
        self.places = places
        wanted = ["approach", "pressure"]
        if self.friction is not None:
            wanted += ["total_shear", "stick_radius", "zones", "traction"]
            wanted += ["critical_friction"] * (0.0 < self.friction < math.inf)
        tell("solving")
        self.own = Continuation(_TOLERANCES[0], wanted, _MOST_UNKNOWNS).solve(scene)
        zones = () if self.friction is None else self.own.zones
        self.kinds = tuple(zone.kind for zone in zones)
        #: whether all slips but a stick disk at the centre that is too small to be solved for
        self.slips = self.kinds == ("slip",) and self.friction != 0.0
        self._known: tuple[SolutionSlopes, SolutionSlopes] | None = None

    @property
    def note(self) -> str:
        """The note where the friction is the critical one, at which slip begins; else empty."""
        if self.kinds != ("stick",) or self.friction in (None, math.inf):
            return ""
        unsure = max(self.own.error.critical_friction or 0.0, _ONSET)
        begins = self.own.critical_friction * (1.0 + unsure)
        return _BEGINS if self.scene.friction is not None and self.scene.friction <= begins else ""

    def derivatives(self, parameters: Iterable[str]) -> dict[tuple[str, str], Derivative]:
        """Return the derivatives of scalars, by quantity and parameter."""
        found = {}
        for name in parameters:
            for quantity in QUANTITIES if self.friction is not None else QUANTITIES[:1]:
                found[quantity, name] = self._derivative(quantity, name)
        return found

    def boundaries(self, parameters: Iterable[str]) -> dict[str, tuple[Derivative, ...]]:
        """Return the derivatives of all boundaries between zones, by parameter."""
        count = max(len(self.kinds) - 1, 0)
        return {
            name: tuple(self._derivative("stick_radius", name, i) for i in range(count))
            for name in parameters
        }

    def _derivative(self, quantity: str, name: str, boundary: int = 0) -> Derivative:
        """Return the derivative of a scalar, or of a boundary as a stick radius, by a parameter."""
        if quantity == "approach" and not self._couples(name):
            return self._approach(name)
        known = self._known_number(quantity, name)
        if known is not None:
            return known
        best, other = (one.scalar(quantity, name, boundary) for one in self._evaluations())
        if not math.isfinite(best):
            return Derivative(math.nan, math.inf, _UNKNOWN)
        lost = _SAFETY * abs(best - other) + self._inherited(quantity, name)
        if self._evaluations()[0].smooth:  # closed forms in the stick radius
            lost += _CLOSED_FORM * (self.own.error.zones or 0.0) * abs(best)
            # terms of that of the shear cancel
            if quantity == "total_shear":
                lost += _ROUNDING * (1.0 if name == "friction" else self._ratio_slope)
        elif quantity == "stick_radius":
            lost += self._evaluations()[0].noise(name, boundary) * abs(best)
        elif noise := self._noise_of_zones(name):
            lost += noise * float(self._by_boundaries(quantity, name, np.abs(best)))
        error = lost / abs(best) + _ROUNDING if best else math.inf
        return Derivative(best, error, self.note)

    def _inherited(self, quantity: str, name: str) -> float:
        """Return the absolute error of a derivative made by that of the shear and by rounding."""
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
        """Return the relative error of derivatives of shear and fields made by rounding of zones.

        It is large next to a threshold, where a zone is narrow.
        """
        slopes = self._evaluations()[0]
        if not slopes.inner or slopes.smooth:
            return 0.0
        return _SHARE_OF_NOISE * max(slopes.noise(name, i) for i in range(len(slopes.inner)))

    def _by_boundaries(
        self, quantity: str, name: str, size: Array, at: tuple[Array, Array] | None = None
    ) -> Array:
        """Return the modulus of the part of a derivative that comes from moving boundaries.

        It is taken to be the whole derivative, whose modulus is `size`, but for derivatives by
        Poisson's ratio without coupling. The traction is then kappa times a function of
        ``f/kappa``, and the boundaries depend on ``f/kappa`` alone. Their part is the derivative
        by the friction times `_ratio_slope`, the derivative of ``f/kappa`` times kappa.
        """
        if name != "poisson_ratio" or self.scene.couples:
            return size
        slopes = self._evaluations()[0]
        if at is None:
            by_friction = np.asarray(slopes.scalar(quantity, "friction"))
        else:
            by_friction = slopes.field(quantity, "friction", *at)
        return np.asarray(self._ratio_slope * np.abs(by_friction))

    def _parameter_scale(self, name: str) -> float:
        """Return a change of a parameter that changes the approach by its own size, at least 1."""
        own = 0.0 if name == "poisson_ratio" else float(getattr(self.scene, name))
        return max(own, 1.0)

    @property
    def _ratio_slope(self) -> float:
        """The derivative of ``f/kappa`` by Poisson's ratio, times kappa: its modulus."""
        return abs(kappa_slope(self.scene) / self.scene.kappa) * (self.scene.friction or 0.0)

    def _approach(self, name: str) -> Derivative:
        """Return the derivative of the approach without coupling.

        It changes with the load ratio, to which it is proportional, and with the normal compliance,
        by reciprocity as the integral of the square of the pressure.
        """
        if name == LOAD_RATIO:
            value = self.own.approach / self.scene.unloaded_to
            return Derivative(value, (self.own.error.approach or 0.0) + _ROUNDING)
        if name != "normal_compliance":
            return Derivative(0.0, 0.0)
        if self.scene.normal_compliance == 0.0:
            return Derivative(math.nan, math.inf, _AT_ZERO)
        # at a load ratio l pressure and approach are l times those of the largest load: so the
        # integral has the factor l**2, and the derivative of the approach l
        breaks = edge_layer_breaks(self.scene.normal_compliance)
        of_pressure = approach_slope(lambda d: self.own.pressure(from_edge=d), breaks)
        value = of_pressure / self.scene.unloaded_to
        return Derivative(value, 2.0 * (self.own.error.pressure or 0.0) + _ROUNDING)

    def _couples(self, name: str) -> bool:
        """Return whether a parameter changes pressure and approach by elastic coupling.

        At friction 0 there is no traction, and so no coupling yet; but there is with a friction.
        """
        from_zero = name == "friction" and self.friction == 0.0 and self.scene.coupling
        return self.scene.couples or from_zero

    def _by_itself(self, name: str) -> tuple[float, str] | None:
        """Return the value of all derivatives by a parameter and the note, where they are known.

        They are known without a solve where everything sticks or slips; None if they are not.
        """
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
        """Return a derivative that takes no linear solve, with its note; None for all others."""
        if self.friction == 0.0 and name == "friction" and quantity != "approach":
            if self.scene.unloaded_to < 1.0:
                return Derivative(math.nan, math.inf, _SLIPS_BACK)
            # with a small friction all slips, so that Q = f, but for a disk at the centre. In the
            # disk beta q = kappa s p / 2; it ends at the radius c at which this q is f p
            of_radius = 2.0 * self.scene.tangential_compliance / self.scene.kappa
            value = 1.0 if quantity == "total_shear" else of_radius
            return Derivative(value, 0.0, "one-sided")
        if self.slips and quantity == "stick_radius":
            return Derivative(math.nan, math.inf, _UNKNOWN)
        # Q = f, but for the small stick disk at the centre
        if self.slips and quantity == "total_shear":
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
        """Return the derivatives in two spaces, the more accurate ones first."""
        if self._known is None:
            found = []
            for tolerance in _TOLERANCES:
                self.tell(f"derivatives at {tolerance:g}")
                found.append(SolutionSlopes(self.own, tolerance, self._at_largest_load(tolerance)))
            self._known = found[0], found[1]
        return self._known

    def _at_largest_load(self, tolerance: float) -> SolutionSlopes | None:
        """Return the derivatives at the largest load; None if the slip there is not needed.

        It is needed below the largest load, where zones that stick keep the slip that they had.
        """
        if self.scene.unloaded_to == 1.0 or "slip" not in self.kinds or not self.friction:
            return None
        largest = Continuation(tolerance, ("slip", "zones", "traction"), _MOST_UNKNOWNS).solve(
            self.scene.replace(unloaded_to=1.0)
        )
        return SolutionSlopes(largest, tolerance)

    def fields(self, parameters: Iterable[str]) -> dict[tuple[str, str], FieldDerivative]:
        """Return the derivatives of pressure and traction at the radii, by field and parameter."""
        if self.places is None:
            return {}
        found = {}
        for name in parameters:
            found["pressure", name] = self._pressure(name)
            if self.friction is not None:
                found["traction", name] = self._traction(name)
        return found

    def _pressure(self, name: str) -> FieldDerivative:
        """Return the derivative of the pressure by a parameter."""
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
        if couples and self._singular_at_boundaries:
            return self._constant(math.nan, _RIGID)
        return self._compared("pressure", name)

    @property
    def _singular_at_boundaries(self) -> bool:
        """Whether boundaries move and there is no tangential compliance.

        Then derivatives of the fields are singular at the boundaries. `ZoneDerivatives` has only
        their parts at fixed boundaries, except for one stick disk under a known pressure.
        """
        return len(self.kinds) > 1 and self.scene.tangential_compliance == 0.0

    def _traction(self, name: str) -> FieldDerivative:
        """Return the derivative of the traction by a parameter."""
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
        if self._singular_at_boundaries and (smooth or scene.couples):
            return self._constant(math.nan, _RIGID)
        return self._compared("traction", name)

    def _compared(self, quantity: str, name: str) -> FieldDerivative:
        """Return a field of both spaces, with their difference as the error."""
        assert self.places is not None
        # at `_PLACES`, too: at a single place both fields may be equal by accident
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
            by_boundaries = self._by_boundaries(quantity, name, size, (both[0], both[1]))
            inherited = np.add(inherited, noise * by_boundaries)
        error = np.where(known, share * size + inherited, math.inf)
        value = np.where(known, best, math.nan)
        value, error = (a[len(_PLACES[0]) :].reshape(self.places[0].shape) for a in (value, error))
        return FieldDerivative(value, error, self.note)

    def _field_inherited(self, quantity: str, name: str, from_edge: Array) -> Array:
        """Return the absolute error of a derivative that the field in it makes by its own error."""
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
        # where the pressure is infinite the surface sticks, and the derivative is without it
        return factor * error * np.abs(np.where(np.isfinite(field_values), field_values, 0.0))

    def _at_a_boundary(self, s: Array, from_edge: Array) -> NDArray[np.bool_]:
        """Return a mask of the places that are on a boundary of zones, within its error."""
        near = np.zeros(s.shape, dtype=bool)
        unsure = (self.own.error.zones or 0.0) + _ROUNDING
        for zone in self.own.zones[:-1]:
            near |= np.abs(from_edge - zone.outer_from_edge) <= unsure * zone.outer_from_edge
            near |= np.abs(s - zone.outer) <= unsure * zone.outer * zone.outer_from_edge
        return near

    def _constant(self, value: float, note: str = "") -> FieldDerivative:
        """Return a derivative that is the same at all places: exact, or NaN and not known."""
        assert self.places is not None
        error = math.inf if math.isnan(value) else 0.0
        shape = self.places[0].shape
        return FieldDerivative(np.full(shape, value), np.full(shape, error), note)
