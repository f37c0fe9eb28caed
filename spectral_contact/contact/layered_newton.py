r"""Newton's method for contact through a nonlinear layer, in a given space.

The law of the layer is ``p = F(w)``, with the pressure p and the overclosure w. Lengths are in
units of the radius a of the disk, and the unknown w is counted from the *origin*, the overclosure
at which the law begins. With the mass M and the Gram matrix K of a space (`spectral.regularised`)
the equations are ``M w + K p = moments of [H(1) - H(t)] + 2 eps`` (docs/theory, nonlinear layers).
H and ``eps``, the *shift*, are those of `indented`. F is applied at the sampling points, from which
p is expanded. The *rate* ``dw/ddelta``, and with it the pressure of a flat punch ``F'(w)
dw/ddelta``, is the response to one more right-hand side.
"""

from __future__ import annotations

from dataclasses import dataclass
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
#: Steps that are not full ones go to and fro if the change of the pressure is not below this
#: fraction of the last one. Without halving them a table of ten points under a cone had no solution
#: (`test_steps_that_go_to_and_fro_are_halved`).
_SHRINKING = 0.9
#: The iteration ends at a relative change of the pressure of the first number; or at one of the
#: second if the next change, extrapolated from two, is less than the third.
_LAST_CHANGE, _SMALL_CHANGE, _NEXT_CHANGE = 1e-14, 1e-13, 1e-15
#: A relative change of the pressure below this that no longer falls is rounding.
_ROUNDED_CHANGE = 1e-9
#: Largest number of steps for the pointwise equation, and its tolerance.
_POINTWISE_STEPS, _POINTWISE_TOLERANCE = 200, 1e-10
#: If the slope of the law times the compliance of a spring is larger than this, the first steps are
#: taken with the spring in series.
_MAX_SLOPE = 10.0
#: Ratio of the compliances of two springs; most corrections with each; and the relative change of
#: the pressure at which they end.
_SPRING_RATIO, _SPRING_STEPS, _SPRING_CHANGE = 0.2, 12, 0.02
#: Highest degree in the steps with a spring.
_SPRING_DEGREE = 5
#: Distance y from the edge, over the width of the edge layer or the distance to the pole of
#: the half-integral, at which the slope of w is taken.
_SLOPE_DISTANCE = 1e-4
#: A rule that integrates any power of the distance from the edge: number of points, and the power
#: by which they are clustered there.
_EDGE_POINTS, _EDGE_POWER = 24, 8


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
        ``x = -ln d`` of the deepest feature at the end of every part.
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
        """Return the pressure at overclosures beyond the origin, in units of the radius."""
        return self.layer._pressure(self.origin + self.radius * w)

    def slope(self, w: Array) -> Array:
        """Return the derivative of the pressure by the overclosure."""
        return self.radius * self.layer._slope(self.origin + self.radius * w)

    def energy(self, w: Array) -> Array:
        """Return the integral of the pressure over the overclosure, not in units of the radius."""
        return self.layer._energy(self.origin + self.radius * w)


@dataclass(frozen=True, slots=True)
class LayeredFields:
    """A solution: coefficients of fields at the sampling points' panels.

    Attributes
    ----------
    overclosure, pressure : ndarray
    rate, flat : ndarray
        Derivatives of the two by the approach, in units of the radius.
    shift : float
        ``eps``.
    iteration_error : float
        Estimate of the change by the next correction, relative to the largest pressure.
    """

    overclosure: Array
    pressure: Array
    rate: Array
    flat: Array
    shift: float
    iteration_error: float


@dataclass(frozen=True, slots=True)
class Totals:
    """Load P, stiffness dP/ddelta and work of a solution, and its shift."""

    load: float
    stiffness: float
    work: float
    shift: float


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
    """

    def __init__(self, setting: LayeredSetting, form: Form) -> None:
        self.setting = setting
        self.form = form
        space = form.space
        self.functions = space
        self.sampling = form.sampling
        #: the Gram matrix, with columns for all coefficients
        self._rows = np.zeros((len(self.functions.index), self.sampling.size))
        self._rows[:, self.functions.index] = self.functions.gram
        self._scale = 1.0 / np.sqrt(self.functions.mass.diagonal())
        #: load as a row that acts on the coefficients of a pressure
        self._load = 4 * pi * setting.radius**2 * self.functions.constant_moments
        self._bracket = setting.profile._bracket(setting.radius, space.t, space.y, space.past_break)
        a = setting.radius
        smooth_approach = float(setting.profile._transform(np.asarray(a))) / 2.0
        self._fixed = setting.approach is not None
        approach = (
            setting.origin + smooth_approach if setting.approach is None else setting.approach
        )
        self._shift = (approach - setting.origin - smooth_approach) / a

    def first_guess(self) -> tuple[Array, float]:
        """Return a first overclosure, and the shift.

        At every radius by itself, the layer and a spring in series for the body fill the distance
        between the undeformed surfaces, the *gap*.
        """
        setting = self.setting
        a = setting.radius
        height = setting.profile._height(a * np.minimum(np.sqrt(self.form.z), 1.0)) / a
        if setting.approach is None:
            edge_height = float(setting.profile._height(np.array(a))) / a
            gap = 2.0 * (edge_height - height)
        else:
            gap = (setting.approach - setting.origin) / a - height
        w = self.sampling.coefficients(balanced(setting, gap, np.minimum(gap, 0.0)))
        return (self._continued(gap, w) if self._fixed else w), self._shift

    def _continued(self, gap: Array, w: Array) -> Array:
        """Return the first overclosure on a stiff layer, by continuation.

        A spring is in series with the layer, and becomes stiffer. The unknown is the overclosure of
        both together, over which the slope of the pressure is at most that of the spring.
        """
        setting = self.setting
        sampling = self.sampling
        spring = _SELF_COMPLIANCE
        max_slope = float(setting.slope(sampling.values(w)).max())
        if max_slope * spring < _MAX_SLOPE:
            return w
        chosen = np.flatnonzero(sampling.low(_SPRING_DEGREE)[self.functions.index])
        total = sampling.coefficients(gap)
        layer_w = np.minimum(gap, 0.0)
        while True:
            for _ in range(_SPRING_STEPS):
                layer_w = balanced(setting, sampling.values(total), layer_w, spring)
                pressure = setting.pressure(layer_w)
                slope = setting.slope(layer_w)
                slope = slope / (1.0 + spring * slope)
                coefficients = sampling.coefficients(pressure)
                step = self._linear_step(total, coefficients, slope, self._shift, chosen)
                total = total + step.overclosure
                change = np.abs(slope * sampling.values(step.overclosure)).max()
                if change < _SPRING_CHANGE * pressure.max():
                    break
            layer_w = balanced(setting, sampling.values(total), layer_w, spring)
            pressure = setting.pressure(layer_w)
            if spring * float(setting.slope(layer_w).max()) < 1.0:
                return sampling.coefficients(layer_w)
            spring *= _SPRING_RATIO
            total = sampling.coefficients(layer_w + spring * pressure)

    def solve(self, w: Array, shift: float) -> LayeredFields:
        """Return the solution, by corrections until these are rounding.

        If a step is so long that the law is not nearly linear over it, the step is taken for the
        overclosure of the layer and a spring in series, and w is what the layer has of it. Where
        such steps go to and fro, a smaller and smaller share of them is taken.
        """
        setting = self.setting
        sampling = self.sampling
        start = w
        last_change = change = next_change = inf
        last_nonlinear_change = inf
        step_share = 1.0
        rate = np.zeros(sampling.size)
        for _ in range(_MAX_STEPS):
            values = sampling.values(w)
            with np.errstate(over="ignore", invalid="ignore"):
                step = self._correction(w, values, shift)
                if not np.isfinite(step.overclosure).all():
                    w = start
                    next_change = inf
                    break
                rate = step.rate
                pressure = setting.pressure(values)
                slope = setting.slope(values)
                steps = sampling.values(step.overclosure)
                new_pressure = setting.pressure(values + steps)
                largest = max(float(pressure.max()), float(new_pressure.max()))
                difference = new_pressure - pressure
                nonlinearity = float(np.abs(difference - slope * steps).max()) / largest
                last_change = change
                change = float(np.abs(difference).max()) / largest
            if not nonlinearity <= _MAX_NONLINEARITY:
                total = values + steps + _SELF_COMPLIANCE * (pressure + slope * steps)
                if change > _SHRINKING * last_nonlinear_change:
                    step_share /= 2.0
                last_nonlinear_change = change
                moved = balanced(setting, total, values) - values
                w = sampling.coefficients(values + step_share * moved)
                change = inf
            else:
                w = w + step.overclosure
            shift += step.shift
            next_change = change
            if last_change < inf:
                next_change = change * min(change / last_change, 1.0)
            # the rate belongs to the w before the step: so the change has to be small, too
            if change < _LAST_CHANGE or (change < _SMALL_CHANGE and next_change < _NEXT_CHANGE):
                break
            if change < _ROUNDED_CHANGE and change > 0.5 * last_change:
                break
        values = sampling.values(w)
        flat = sampling.coefficients(setting.slope(values) * sampling.values(rate))
        return LayeredFields(
            w,
            sampling.coefficients(setting.pressure(values)),
            rate,
            flat,
            shift,
            next_change if next_change == inf else min(change, next_change),
        )

    def _correction(self, w: Array, values: Array, shift: float) -> _Step:
        """Return the step of Newton's method at an overclosure with values at sampling points.

        The correction of the shift is that for which load, overclosure at the centre, or at the
        edge have the given value.
        """
        pressure = self.sampling.coefficients(self.setting.pressure(values))
        slope = self.setting.slope(values)
        step = self._linear_step(w, pressure, slope, shift, np.arange(len(self.functions.index)))
        if self.setting.load is not None:
            missing_load = self.setting.load - float(self._load @ pressure[self.functions.index])
            missing_load -= self._load_change(slope, step.overclosure)
            shift_step = missing_load / self._load_change(slope, step.rate)
        elif self.setting.centre is not None:
            given = (self.setting.centre - self.setting.origin) / self.setting.radius
            missing = given - central_value(self.form.field(w + step.overclosure))
            shift_step = missing / central_value(self.form.field(step.rate))
        elif self.setting.approach is not None:
            return step
        else:
            shift_step = self._shift_to_edge(w, step)
        return _Step(step.overclosure + shift_step * step.rate, shift_step, step.rate)

    def _shift_to_edge(self, w: Array, step: _Step) -> float:
        """Return the change of the shift with which the overclosure vanishes at the edge."""
        edge_w = self.form.at_edge(w) + self.form.at_edge(step.overclosure)
        return -edge_w / self.form.at_edge(step.rate)

    def _load_change(self, slope: Array, step: Array) -> float:
        """Return the change of the load by a step of the overclosure, to first order."""
        change = self.sampling.coefficients(slope * self.sampling.values(step))
        return float(self._load @ change[self.functions.index])

    def _linear_step(
        self, w: Array, pressure: Array, slope: Array, shift: float, chosen: NDArray[np.int_]
    ) -> _Step:
        """Return a correction in the space of some functions, for a given shift."""
        space = self.functions
        scale = self._scale[chosen]
        half_residual = self._bracket + 2.0 * shift - space.half_integral(pressure)
        residual = space.moments(half_residual) - space.mass @ w[space.index]
        right_sides = np.column_stack([residual, 2.0 * space.constant_moments])[chosen]
        matrix = self.sampling.times(self._rows[chosen], slope)[:, space.index[chosen]]
        matrix += space.mass[np.ix_(chosen, chosen)]
        # scaled so that the mass has a unit diagonal
        matrix *= scale[:, None]
        matrix *= scale
        factors = lu_factor(matrix, overwrite_a=True, check_finite=False)
        solutions = lu_solve(factors, right_sides * scale[:, None], check_finite=False)
        solutions *= scale[:, None]
        step, rate = np.zeros((2, self.sampling.size))
        step[space.index[chosen]] = solutions[:, 0]
        rate[space.index[chosen]] = solutions[:, 1]
        return _Step(step, 0.0, rate)

    def coarser(self, fields: LayeredFields) -> LayeredFields:
        """Return the solution with two degrees less on every panel, by one correction.

        Under a given load it is that of the same approach.
        """
        setting = self.setting
        sampling = self.sampling

        def truncated(coefficients: Array) -> Array:
            return coefficients - self.top_degrees(coefficients)

        slope = setting.slope(sampling.values(fields.overclosure))
        w = truncated(fields.overclosure)
        pressure = truncated(sampling.coefficients(setting.pressure(sampling.values(w))))
        kept = np.arange(self.functions.coarsest_unknowns)
        step = self._linear_step(w, pressure, slope, fields.shift, kept)
        shift_step = 0.0
        if setting.approach is None:
            shift_step = self._shift_to_edge(w, step)
        w = w + step.overclosure + shift_step * step.rate
        values = sampling.values(w)
        return LayeredFields(
            w,
            truncated(sampling.coefficients(setting.pressure(values))),
            step.rate,
            truncated(sampling.coefficients(setting.slope(values) * sampling.values(step.rate))),
            fields.shift + shift_step,
            fields.iteration_error,
        )

    def top_degrees(self, coefficients: Array) -> Array:
        """Return the contribution of the top two degrees of every panel to a function."""
        top = self.functions.index[self.functions.coarsest_unknowns :]
        contribution = np.zeros_like(coefficients)
        contribution[top] = coefficients[top]
        return contribution

    def integrals(self, fields: LayeredFields) -> Totals:
        """Return load, stiffness and work."""
        a = self.setting.radius
        space = self.functions
        weights = space.weights
        half_integral = space.half_integral(fields.pressure)
        energy = self.sampling.coefficients(
            self.setting.energy(self.sampling.values(fields.overclosure))
        )
        layer_energy = 4 * a**2 * float(weights @ space.half_integral(energy))
        return Totals(
            4 * a**2 * float(weights @ half_integral),
            4 * a * float(weights @ space.half_integral(fields.flat)),
            layer_energy + a**3 * float(weights @ half_integral**2),
            fields.shift,
        )

    def edge_stiffness_error(self, fields: LayeredFields) -> float:
        """Return the error of the stiffness by the tail at the edge, where w vanishes.

        Next to the edge the slope of a law falls as some power of the overclosure, and three
        sampling points do not integrate a small one.
        """
        if self._fixed:
            return 0.0
        g, weights = gauss_rule(_EDGE_POINTS)
        # the distance is the power _EDGE_POWER of a Gauss point on (0, 1)
        density = ((1.0 + g) / 2.0) ** (_EDGE_POWER - 1)
        distances = density * (1.0 + g) / 2.0
        fields_there = np.array([fields.overclosure, fields.rate, fields.flat])
        w, rate, flat = self.form.in_tail(fields_there, distances)
        difference = self.setting.slope(np.maximum(w, 0.0)) * rate - flat
        integral = float(weights * _EDGE_POWER / 2.0 * density @ difference)
        return pi * self.setting.radius * self.form.tail_extent * abs(integral)

    def stiffness_by_panels(self, flat: Array) -> Array:
        """Return the contribution of every panel to the stiffness."""
        space = self.functions
        contributions = 4 * self.setting.radius * space.constant_moments * flat[space.index]
        by_panels = np.bincount(space.panel, contributions, space.panels + 1)
        return np.asarray(by_panels[:-1], dtype=float)

    def change(self, p: Array, coarse_p: Array, w: Array, coarse_w: Array) -> Change:
        """Return the difference of a pressure to that in the coarser space, and its energies.

        They are those of the body, and of the layer with the difference of the overclosures.
        """
        space = self.functions
        dp = np.abs(p - coarse_p)[space.index]
        dw = np.abs(w - coarse_w)[space.index]
        contributions = dp * (dw * space.mass.diagonal() + dp * space.gram.diagonal())
        energies = np.bincount(space.panel, contributions, space.panels + 1)
        return Change(p - coarse_p, np.asarray(energies, dtype=float))

    def max_overclosure(self, fields: LayeredFields) -> float:
        """Return the largest overclosure, in the unit of the profile."""
        setting = self.setting
        return setting.origin + setting.radius * float(
            self.sampling.values(fields.overclosure).max()
        )

    def min_compliance(self, fields: LayeredFields) -> float:
        """Return the least compliance ``1/F'(w)``, in units of the radius."""
        slope = self.setting.slope(self.sampling.values(fields.overclosure))
        return 1.0 / float(slope.max())

    def condition(self, fields: LayeredFields, mean: float) -> float:
        """Return the largest relative change of the pressure, or of its mean, by one of a length.

        The length is a height or the approach, in the unit of the profile.
        """
        values = self.sampling.values(fields.overclosure)
        slope = self.setting.slope(values)
        rate = slope / (1.0 + _SELF_COMPLIANCE * slope) / self.setting.radius
        return float((rate / np.maximum(self.setting.pressure(values), mean)).max())

    def growth(self, fields: LayeredFields) -> float:
        """Return ``ddelta/da``, from the slope of the overclosure next to the edge."""
        if self._fixed:
            return 0.0
        slope = float(self.setting.slope(self.sampling.values(fields.overclosure)).max())
        setting = self.setting
        width = min(1.0 / max(slope, 1.0), setting.profile._to_pole(setting.radius))
        y = min(_SLOPE_DISTANCE * width, 0.5 * setting.parts.ends[-1][2])
        edge_slope = 2.0 * self.form.next_to_edge(fields.overclosure, y) / y
        return edge_slope / self.form.at_edge(fields.rate)


def balanced(
    setting: LayeredSetting, total: Array, start: Array, spring: float = _SELF_COMPLIANCE
) -> Array:
    """Return w with ``w + spring F(w) = total`` at every point by itself.

    This is the overclosure of the layer if that of the layer and of a spring in series, with this
    compliance, is given. Newton's method starts at `start`, and is bracketed.
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
            # far up an exponential law a step of Newton's method reduces the residual by e only
            slow = (np.abs(residual) > 0.1 * last_size) & bracketed
            new = np.where((newton > low) & (newton < high) & ~slow, newton, middle)
            last_size = np.abs(residual)
            tolerance = _POINTWISE_TOLERANCE * (np.abs(new) + np.abs(total))
            converged = np.abs(new - w) <= tolerance
            w = new
            if converged.all():
                break
    return w
