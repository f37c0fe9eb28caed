r"""Newton's method for contact through a nonlinear layer, in a given space.

The law of the layer is ``p = F(w)``, with the pressure p and the overclosure w. Lengths are in
units of the radius a of the disk, and the unknown w is counted from the *origin*, the overclosure
at which the law begins. M is the mass matrix of a space, of the inner products of its functions,
and K the Gram matrix, of those of their half-integrals (`spectral.regularised`). The equations are
``M w + K p = moments of [H(1) - H(t)] + 2 eps`` (docs/theory, nonlinear layers), with H and
``eps``, the *shift*, as in `indented`. F is applied at the sampling points, from which p is
expanded. The *rate* ``dw/ddelta``, and with it the pressure of a flat punch ``F'(w) dw/ddelta``, is
the response to one more right-hand side.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from spectral_contact.fields.series import central_value
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.spectral.cells import DiskCells
from spectral_contact.spectral.jacobi import gauss_rule
from spectral_contact.spectral.parts import DiskPartition
from spectral_contact.spectral.regularised import Change

if TYPE_CHECKING:
    from spectral_contact.contact.layered_bends import Bend
    from spectral_contact.contact.layered_spaces import Form

Array = NDArray[np.float64]

#: Displacement by the pressure 1 on the unit disk, at its centre.
_SELF_COMPLIANCE = 0.5
#: Largest number of corrections.
_MAX_STEPS = 80
#: A step is a full one if the pressure at its end differs from its linearisation by less than this
#: fraction of the largest pressure.
_MAX_NONLINEARITY = 0.1
#: A damped step counts as oscillation, and its share is halved, if the change of the pressure has
#: not fallen below this fraction of the last one. Without this a table of ten points under a cone
#: had no solution (`test_steps_that_go_to_and_fro_are_halved`).
_SHRINKING = 0.9
#: Least share of a damped step. After a share s the change is 1 - s of the last one at best. With
#: 1/16 that is above _SHRINKING: every step would count as oscillation, and shares would be halved
#: until nothing moves (`test_shares_of_steps_are_not_halved_without_end`).
_MIN_SHARE = 1.0 / 8.0
#: The iteration ends if the relative change of the pressure is below the first number; or if it is
#: below the second one, and the sum of all further changes, extrapolated from the last two, is
#: below the third one.
_LAST_CHANGE, _SMALL_CHANGE, _REMAINING_CHANGE = 1e-14, 1e-13, 1e-15
#: A relative change of the pressure below this that no longer falls is rounding.
_ROUNDED_CHANGE = 1e-9
#: Largest number of steps for the pointwise equation, and its tolerance, relative to the total.
_POINTWISE_STEPS, _POINTWISE_TOLERANCE = 200, 1e-10
#: If the slope of the law times the compliance of a spring is larger than this, the first steps are
#: taken with the spring in series.
_MAX_SLOPE = 10.0
#: Ratio of the compliances of successive springs; largest number of corrections with each; relative
#: change of the pressure at which they end.
_SPRING_RATIO, _SPRING_STEPS, _SPRING_CHANGE = 0.2, 12, 0.02
#: Highest degree in the steps with a spring.
_SPRING_DEGREE = 5
#: The slope of w is taken at this distance y from the edge, in units of the width of the edge layer
#: or, if that is less, of the distance from the edge to the radius at which H of the profile is
#: infinite, as at the equator of a sphere (`Profile._to_pole`).
_SLOPE_DISTANCE = 1e-4
#: A rule that integrates any power of the distance from the edge: number of points, and the power
#: by which they are clustered there.
_EDGE_POINTS, _EDGE_POWER = 24, 8
#: Radii, from the centre to the edge, at which a field is evaluated for its extremes.
RADII = np.linspace(0.0, 1.0, 257)
#: The least number of full precision. What is below it is rounding.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, slots=True)
class LayeredSetting:
    """A problem: profile and law, the disk on which they meet, and its division.

    Lengths are in the unit of the profile.

    Attributes
    ----------
    profile : Profile
    layer : Layer
    radius : float
        Radius a of the disk: that of the contact, or one beyond which the pressure is rounding.
    approach : float or None
        The approach; None if it follows from the overclosure at the edge, where the law begins.
    load : float or None
        The load, if it is given: then `approach` is a first guess.
    centre : float or None
        The overclosure at the centre, if it is given: then, too, `approach` is a first guess.
    parts : DiskPartition
        The division of the disk into parts with panels, if there are no cells.
    drives : bool
        Whether the pressure, under a flat punch, is needed as the known pressure of a traction.
    cells : DiskCells or None
        The division into cells; None if the pressure is not smooth everywhere.
    depths : tuple of float
        For every part, ``x = -ln d`` of the narrowest feature at its end, where d is the width of
        the feature in ``s**2``.
    smooth : tuple of bool
        Whether the pressure is smooth in ``s**2`` at the end of every part.
    bends : tuple of Bend
        The radii at which the law is assumed to bend, from the centre outward; parts end there.
    """

    profile: Profile
    layer: Layer
    radius: float
    approach: float | None
    parts: DiskPartition
    depths: tuple[float, ...]
    smooth: tuple[bool, ...]
    load: float | None = None
    centre: float | None = None
    drives: bool = False
    cells: DiskCells | None = None
    bends: tuple[Bend, ...] = ()

    @property
    def origin(self) -> float:
        """The overclosure from which the unknown is counted: where the law begins, or 0."""
        return self.layer.start if self.layer.start > -inf else 0.0

    def pressure(self, w: Array) -> Array:
        """Return the pressure, in E', at overclosures w.

        They are counted from the origin in units of the radius.
        """
        return self.layer._pressure(self.origin + self.radius * w)

    def slope(self, w: Array) -> Array:
        """Return the derivative of the pressure by w, which is in units of the radius."""
        return self.radius * self.layer._slope(self.origin + self.radius * w)

    def energy(self, w: Array) -> Array:
        """Return the integral of the pressure over the overclosure, in E' L."""
        return self.layer._energy(self.origin + self.radius * w)


@dataclass(frozen=True, slots=True)
class LayeredFields:
    """A solution: the coefficients of its fields in the space.

    Attributes
    ----------
    overclosure, pressure : ndarray
    rate, pressure_rate : ndarray
        Derivatives of the two by the approach, in units of the radius.
    shift : float
        ``eps``.
    iteration_error : float
        Estimate of the error that further corrections would remove, relative to the largest
        pressure. It is infinite if the corrections do not become smaller.
    """

    overclosure: Array
    pressure: Array
    rate: Array
    pressure_rate: Array
    shift: float
    iteration_error: float


@dataclass(frozen=True, slots=True)
class Totals:
    """Load P, stiffness dP/ddelta and work of a solution."""

    load: float
    stiffness: float
    work: float


@dataclass(frozen=True, slots=True)
class _Step:
    """Corrections of the overclosure and of the shift, and the rate ``dw/ddelta``."""

    overclosure: Array
    shift: float
    rate: Array


class LayeredNewton:
    """Newton's method in a space.

    Parameters
    ----------
    setting : LayeredSetting
    form : Form
        The space.

    Attributes
    ----------
    unshifted_approach : float
        The approach at which the shift is 0, in the unit of the profile.
    """

    def __init__(self, setting: LayeredSetting, form: Form) -> None:
        self.setting = setting
        self.form = form
        space = form.space
        self.space = space
        self.sampling = form.sampling
        #: the Gram matrix, with columns for all coefficients
        self._gram_rows = np.zeros((space.unknowns, self.sampling.size))
        self._gram_rows[:, space.index] = space.gram
        self._scale = 1.0 / np.sqrt(space.mass.diagonal())
        a = setting.radius
        #: load as a row that acts on the coefficients of a pressure
        self._load_row = 4 * pi * a**2 * space.constant_moments
        self._bracket = setting.profile._bracket(a, space.t, space.y, space.past_break)
        half_transform = float(setting.profile._transform(np.asarray(a))) / 2.0
        self.unshifted_approach = setting.origin + half_transform
        #: the shift of the approach, if that is given or guessed
        self._shift = 0.0
        if setting.approach is not None:
            self._shift = (setting.approach - self.unshifted_approach) / a

    def first_guess(self) -> tuple[Array, float]:
        """Return a first overclosure, and the shift.

        At every radius by itself, the layer, in series with a spring that stands for the body,
        fills the *gap* between the undeformed surfaces. If no approach is given, the gap is taken
        as twice the difference of the heights at the edge and here.
        """
        setting = self.setting
        a = setting.radius
        height = setting.profile._height(a * np.minimum(np.sqrt(self.form.z), 1.0)) / a
        if setting.approach is None:
            edge_height = float(setting.profile._height(np.array(a))) / a
            gap = 2.0 * (edge_height - height)
        else:
            gap = (setting.approach - setting.origin) / a - height
        w = self.sampling.coefficients(series_overclosure(setting, gap, np.minimum(gap, 0.0)))
        if setting.approach is not None:
            with np.errstate(over="ignore", invalid="ignore"):
                w = self._continued(gap, w)
        return w, self._shift

    def _continued(self, gap: Array, w: Array) -> Array:
        """Return the first overclosure on a stiff layer, by continuation.

        The layer is in series with a spring whose compliance is lowered step by step. The unknown
        is the overclosure of both together; by it the derivative of the pressure is at most the
        stiffness of the spring. If a step leaves the range of doubles, the guess is `w`.
        """
        setting = self.setting
        sampling = self.sampling
        spring = _SELF_COMPLIANCE
        max_slope = float(setting.slope(sampling.values(w)).max())
        if max_slope * spring < _MAX_SLOPE:
            return w
        unknowns = np.flatnonzero(sampling.low(_SPRING_DEGREE)[self.space.index])
        total = sampling.coefficients(gap)
        layer_w = np.minimum(gap, 0.0)
        for _ in range(_MAX_STEPS):
            for _ in range(_SPRING_STEPS):
                layer_w = series_overclosure(setting, sampling.values(total), layer_w, spring)
                pressure = setting.pressure(layer_w)
                slope = setting.slope(layer_w)
                slope = slope / (1.0 + spring * slope)
                coefficients = sampling.coefficients(pressure)
                step = self._linear_step(total, coefficients, slope, self._shift, unknowns)
                total = total + step.overclosure
                change = np.abs(slope * sampling.values(step.overclosure)).max()
                if change < _SPRING_CHANGE * pressure.max():
                    break
            if not np.isfinite(total).all():
                return w
            layer_w = series_overclosure(setting, sampling.values(total), layer_w, spring)
            pressure = setting.pressure(layer_w)
            if spring * float(setting.slope(layer_w).max()) < 1.0:
                break
            spring *= _SPRING_RATIO
            total = sampling.coefficients(layer_w + spring * pressure)
        return sampling.coefficients(layer_w)

    def solve(self, w: Array, shift: float) -> LayeredFields:
        """Return the solution, by corrections until these are rounding.

        If the law is far from linear over a step, the step is taken for the total overclosure of
        the layer and a spring in series, from which w follows point by point. Where such steps
        oscillate, only a share of them is taken, which is halved each time. The step of the shift
        is taken in full. That does no harm: either it is 0, as the approach is given, or the next
        correction meets the given load or overclosure from whatever shift it begins with.
        """
        setting = self.setting
        sampling = self.sampling
        start = w
        last_change = change = remaining = inf
        last_nonlinear_change = inf
        step_share = 1.0
        rate = np.zeros(sampling.size)
        for _ in range(_MAX_STEPS):
            values = sampling.values(w)
            with np.errstate(over="ignore", invalid="ignore"):
                step = self._correction(w, values, shift)
                if not np.isfinite(step.overclosure).all():
                    w = start
                    remaining = inf
                    break
                rate = step.rate
                pressure = setting.pressure(values)
                slope = setting.slope(values)
                steps = sampling.values(step.overclosure)
                new_pressure = setting.pressure(values + steps)
                largest = max(float(pressure.max()), float(new_pressure.max()), TINY)
                difference = new_pressure - pressure
                nonlinearity = float(np.abs(difference - slope * steps).max()) / largest
                last_change = change
                change = float(np.abs(difference).max()) / largest
            if not nonlinearity <= _MAX_NONLINEARITY:
                total = values + steps + _SELF_COMPLIANCE * (pressure + slope * steps)
                if change > _SHRINKING * last_nonlinear_change:
                    step_share = max(step_share / 2.0, _MIN_SHARE)
                last_nonlinear_change = change
                moved = series_overclosure(setting, total, values) - values
                w = sampling.coefficients(values + step_share * moved)
                change = inf
            else:
                w = w + step.overclosure
            shift += step.shift
            remaining = change
            if last_change < inf:
                # the sum of all further changes, if they fall by the ratio of the last two
                ratio = change / last_change
                remaining = change * ratio / (1.0 - ratio) if ratio < 1.0 else inf
            rounded = change < _ROUNDED_CHANGE and change >= last_change
            # the rate is that of the w before this step: so the step itself has to be small, too
            small = change < _SMALL_CHANGE and remaining < _REMAINING_CHANGE
            if rounded or small or change < _LAST_CHANGE:
                remaining = min(change, remaining)
                break
        return self._fields(w, rate, shift, remaining)

    def _fields(self, w: Array, rate: Array, shift: float, iteration_error: float) -> LayeredFields:
        """Return the fields of an overclosure and its rate."""
        sampling = self.sampling
        values = sampling.values(w)
        pressure = sampling.coefficients(self.setting.pressure(values))
        pressure_rate = sampling.coefficients(self.setting.slope(values) * sampling.values(rate))
        return LayeredFields(w, pressure, rate, pressure_rate, shift, iteration_error)

    def _correction(self, w: Array, values: Array, shift: float) -> _Step:
        """Return the step of Newton's method at an overclosure with values at sampling points.

        The correction of the shift makes the load, or the overclosure at the centre or at the edge,
        equal to the given value. Under a given approach it is zero.
        """
        pressure = self.sampling.coefficients(self.setting.pressure(values))
        slope = self.setting.slope(values)
        step = self._linear_step(w, pressure, slope, shift, np.arange(self.space.unknowns))
        if self.setting.load is not None:
            missing_load = self.setting.load - float(self._load_row @ pressure[self.space.index])
            missing_load -= self._load_change(slope, step.overclosure)
            shift_step = missing_load / self._load_change(slope, step.rate)
        elif self.setting.centre is not None:
            given = (self.setting.centre - self.setting.origin) / self.setting.radius
            missing = given - central_value(self.form.field(w + step.overclosure))
            shift_step = missing / central_value(self.form.field(step.rate))
        elif self.setting.approach is not None:
            return step
        else:
            shift_step = self._shift_for_zero_edge(w, step)
        return _Step(step.overclosure + shift_step * step.rate, shift_step, step.rate)

    def _shift_for_zero_edge(self, w: Array, step: _Step) -> float:
        """Return the change of the shift with which the overclosure vanishes at the edge."""
        edge_w = self.form.at_edge(w) + self.form.at_edge(step.overclosure)
        return -edge_w / self.form.at_edge(step.rate)

    def _load_change(self, slope: Array, step: Array) -> float:
        """Return the change of the load by a step of the overclosure, to first order."""
        change = self.sampling.coefficients(slope * self.sampling.values(step))
        return float(self._load_row @ change[self.space.index])

    def _linear_step(
        self, w: Array, pressure: Array, slope: Array, shift: float, unknowns: NDArray[np.int_]
    ) -> _Step:
        """Return a correction in the space of some unknowns, for a given shift."""
        space = self.space
        scale = self._scale[unknowns]
        half_residual = self._bracket + 2.0 * shift - space.half_integral(pressure)
        residual = space.moments(half_residual) - space.mass @ w[space.index]
        right_sides = np.column_stack([residual, 2.0 * space.constant_moments])[unknowns]
        matrix = self.sampling.times(self._gram_rows[unknowns], slope)[:, space.index[unknowns]]
        matrix += space.mass[np.ix_(unknowns, unknowns)]
        # scaled so that the mass has a unit diagonal
        matrix *= scale[:, None]
        matrix *= scale
        factors = lu_factor(matrix, overwrite_a=True, check_finite=False)
        solutions = lu_solve(factors, right_sides * scale[:, None], check_finite=False)
        solutions *= scale[:, None]
        step_and_rate = np.zeros((2, self.sampling.size))
        step_and_rate[:, space.index[unknowns]] = solutions.T
        return _Step(step_and_rate[0], 0.0, step_and_rate[1])

    def coarser(self, fields: LayeredFields) -> LayeredFields:
        """Return the solution with two degrees less on every panel, by one correction.

        Under a given load, or overclosure at the centre, it is that of the same approach.
        """
        setting = self.setting
        sampling = self.sampling

        def truncated(coefficients: Array) -> Array:
            return coefficients - self.top_degrees(coefficients)

        slope = setting.slope(sampling.values(fields.overclosure))
        w = truncated(fields.overclosure)
        pressure = truncated(sampling.coefficients(setting.pressure(sampling.values(w))))
        kept = np.arange(self.space.coarsest_unknowns)
        step = self._linear_step(w, pressure, slope, fields.shift, kept)
        shift_step = 0.0
        if setting.approach is None:
            shift_step = self._shift_for_zero_edge(w, step)
        w = w + step.overclosure + shift_step * step.rate
        coarse = self._fields(w, step.rate, fields.shift + shift_step, fields.iteration_error)
        return replace(
            coarse,
            pressure=truncated(coarse.pressure),
            pressure_rate=truncated(coarse.pressure_rate),
        )

    def top_degrees(self, coefficients: Array) -> Array:
        """Return the contribution of the top two degrees of every panel to a function."""
        top = self.space.index[self.space.coarsest_unknowns :]
        contribution = np.zeros_like(coefficients)
        contribution[top] = coefficients[top]
        return contribution

    def integrals(self, fields: LayeredFields) -> Totals:
        """Return load, stiffness and work."""
        a = self.setting.radius
        space = self.space
        weights = space.weights
        half_integral = space.half_integral(fields.pressure)
        energy = self.sampling.coefficients(
            self.setting.energy(self.sampling.values(fields.overclosure))
        )
        layer_energy = 4 * a**2 * float(weights @ space.half_integral(energy))
        return Totals(
            4 * a**2 * float(weights @ half_integral),
            4 * a * float(weights @ space.half_integral(fields.pressure_rate)),
            layer_energy + a**3 * float(weights @ half_integral**2),
        )

    def edge_stiffness_error(self, fields: LayeredFields) -> float:
        """Return the error of the stiffness that is due to interpolation on the tail at the edge.

        There w is zero. Next to the edge the slope of the law falls as a power of the overclosure.
        If that power is small, the four sampling points of the tail do not integrate it accurately.
        """
        if self.setting.approach is not None:
            return 0.0
        g, weights = gauss_rule(_EDGE_POINTS)
        # the distance is the power _EDGE_POWER of a Gauss point on (0, 1)
        density = ((1.0 + g) / 2.0) ** (_EDGE_POWER - 1)
        distances = density * (1.0 + g) / 2.0
        fields_there = np.array([fields.overclosure, fields.rate, fields.pressure_rate])
        w, rate, interpolated = self.form.in_tail(fields_there, distances)
        difference = self.setting.slope(np.maximum(w, 0.0)) * rate - interpolated
        integral = float(weights * _EDGE_POWER / 2.0 * density @ difference)
        return pi * self.setting.radius * self.form.tail_extent * abs(integral)

    def stiffness_by_panels(self, pressure_rate: Array) -> Array:
        """Return the contribution of every panel to the stiffness, the tail's with the last."""
        space = self.space
        contributions = self._load_row * pressure_rate[space.index] / self.setting.radius
        panel = np.minimum(space.panel, space.panels - 1)
        return np.asarray(np.bincount(panel, contributions), dtype=float)

    def change(self, p: Array, coarse_p: Array, w: Array, coarse_w: Array) -> Change:
        """Return the difference of a pressure to that in the coarser space, and its energies.

        The energies are that of the body, and that of the layer: the product of the differences of
        pressure and overclosure.
        """
        space = self.space
        dp = np.abs(p - coarse_p)[space.index]
        dw = np.abs(w - coarse_w)[space.index]
        contributions = dp * (dw * space.mass.diagonal() + dp * space.gram.diagonal())
        energies = np.bincount(space.panel, contributions, space.panels + 1)
        return Change(p - coarse_p, np.asarray(energies, dtype=float))

    def max_overclosure(self, fields: LayeredFields) -> float:
        """Return the largest overclosure, in the unit of the profile.

        It may be at the centre or at the edge, which are no sampling points.
        """
        setting = self.setting
        samples = self.sampling.values(fields.overclosure)
        at_radii = self.form.field(fields.overclosure)(RADII, 1.0 - RADII)
        return setting.origin + setting.radius * max(float(samples.max()), float(at_radii.max()))

    def min_compliance(self, fields: LayeredFields) -> float:
        """Return the least compliance ``1/F'(w)``, in units of the radius."""
        slope = self.setting.slope(self.sampling.values(fields.overclosure))
        return 1.0 / float(slope.max())

    def condition(self, fields: LayeredFields, mean: float) -> float:
        """Return the largest change of the pressure per unit change of a length.

        It is relative to the pressure, or to its mean where that is larger. The length is a height
        or the approach, in the unit of the profile.
        """
        values = self.sampling.values(fields.overclosure)
        slope = self.setting.slope(values)
        rate = slope / (1.0 + _SELF_COMPLIANCE * slope) / self.setting.radius
        return float((rate / np.maximum(self.setting.pressure(values), mean)).max())

    def growth(self, fields: LayeredFields) -> float:
        """Return ``ddelta/da``, from the slope of the overclosure next to the edge."""
        setting = self.setting
        if setting.approach is not None:
            return 0.0
        width = min(self.min_compliance(fields), 1.0, setting.profile._to_pole(setting.radius))
        y = min(_SLOPE_DISTANCE * width, 0.5 * setting.parts.ends[-1][2])
        edge_slope = 2.0 * self.form.next_to_edge(fields.overclosure, y) / y
        return edge_slope / self.form.at_edge(fields.rate)


def series_overclosure(
    setting: LayeredSetting, total: Array, start: Array, spring: float = _SELF_COMPLIANCE
) -> Array:
    """Return w with ``w + spring F(w) = total`` at every point by itself.

    This is the overclosure of the layer if that of the layer and of a spring in series, with this
    compliance, is given. It is found by Newton's method from `start`, safeguarded by bisection. It
    serves as a guess: after the largest number of steps the last w is returned.
    """
    w = start.copy()
    low = np.full(w.shape, -inf)
    high = np.full(w.shape, inf)
    last_size = np.full(w.shape, inf)
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(_POINTWISE_STEPS):
            residual = w + spring * setting.pressure(w) - total
            low = np.where(residual < 0.0, w, low)
            high = np.where(residual < 0.0, high, w)
            newton = w - residual / (1.0 + spring * setting.slope(w))
            bracketed = np.isfinite(low + high)
            middle = np.where(bracketed, 0.5 * (low + high), np.minimum(w, total))
            # far up an exponential law a step of Newton's method divides the residual by no more
            # than e
            size = np.abs(residual)
            slow = (size > 0.1 * last_size) & bracketed
            last_size = size
            new = np.where((newton > low) & (newton < high) & ~slow, newton, middle)
            # w may be much smaller than the total, so that a small step says nothing
            small = size <= _POINTWISE_TOLERANCE * (np.abs(w) + np.abs(total))
            new = np.where(small, w, new)
            if (new == w).all():
                break
            w = new
    return w
