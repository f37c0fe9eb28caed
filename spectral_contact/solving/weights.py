r"""Load and approach of a growing contact, as functions of its contact radius ``b``.

The fields of the contact are sums of those of flat punches of all radii ``b``, and the increments
``dP`` of the load are the weights of these sums (docs/theory, G.4). There are three sources of the
load. Without coupling it is that of normal contact at each radius (`NormalLoads`), on a smooth
surface in closed form but for one integral (`SmoothLoads`). With coupling it depends on the history
(`VolterraLoads`), and follows from the condition that the gap at ``r`` is closed when ``b = r``:

    h(r) = int_0^r [1 - omega(b, r)] d delta(b),        dP = b d delta / delta*(b)         (G.6)

with the height ``h`` of the profile, the approach ``delta``, the displacement ``omega(b, r)`` of
the surface at ``r > b`` for unit approach of the flat punch of radius ``b``, and the approach
``delta*`` of this punch for unit load, in units of ``b``. This is a Volterra equation of the first
kind for ``d delta``. It is solved panel by panel, from the first touch on. The unknowns are

    D = d delta/dH,       H(b) = 2 b int_0^b h'(r) dr/sqrt(b**2 - r**2)                    (G.7)

at the nodes of the panel, because this ratio is almost constant, even next to breaks of the
profile. The equation is required at more points than there are unknowns, in the sense of least
squares, which makes it stable. A flat part bears no load until the contact grows beyond it.

Radii are given by ``u = ln b``. A panel is a `RadiusStretch`, an interval of u, on which a radius
is also given by its depth: the distance from the lower end, in the coordinate v of (G.10).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.special import roots_jacobi

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.fields.series import LogSeries
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.solving.outside import outside_displacement, outside_values
from spectral_contact.solving.stretch import (
    RadiusStretch,
    interpolation_error,
    interpolation_weights,
)
from spectral_contact.spectral.jacobi import graded_rule

if TYPE_CHECKING:
    from spectral_contact.contact.on_parts import Indentation
    from spectral_contact.solution import Solution

#: Arguments of `graded_rule` (points, panels, ratio) for integrals over ``b`` up to ``r``. On a
#: smooth surface the kernel is like a square root there, so the variable of the rule is the root of
#: the distance from ``r``: loads under a sphere and a cone are off by 1e-13 or less. With the
#: distance itself and (12, 24, 0.2) they were off by 7e-12, which no estimate covered.
_GRADED_ARGUMENTS = (14, 16, 0.2)
#: Number of Gauss points for a smooth integrand.
_SMOOTH_POINTS = 20
#: Distance in ``u`` of ``r`` from a panel beyond which the integrand on the panel is smooth and
#: Gauss points are enough.
_SMOOTH_DISTANCE = 1.0
#: A panel begins at a break if their distance in ``u`` is less than this.
_BREAK_ROUNDING = 1e-14
#: Number of points at which the equation is required over that of unknowns. With as many points as
#: unknowns errors grow from panel to panel where the pressure oscillates.
_POINTS_PER_UNKNOWN = 1.6
#: Rounding error of a panel by the Volterra equation. Shorter panels do not reduce it. On a smooth
#: surface, where all flat punches are alike, the estimates of panels under a sphere and a cone are
#: 3e-12 to 2.5e-11, and those of halves of these panels 5e-11 to 1e-10.
_VOLTERRA_ROUNDING = 5e-11


@dataclass(frozen=True, slots=True)
class PanelLoads:
    """Loads and approaches at the nodes of a panel, with their errors.

    Attributes
    ----------
    loads, approaches : ndarray
        Load and approach of the contact when its radius was that of each node.
    error : float
        Error that the interpolation of ``D`` on the panel makes, relative to the load at its end;
        0 without coupling.
    node_error : float
        Relative error of the values at the nodes by the solution of normal contact; 0 with coupling
        and on a smooth surface.
    """

    loads: Array
    approaches: Array
    error: float = 0.0
    node_error: float = 0.0


class NormalLoads:
    """Loads and approaches of normal contact, solved at each radius.

    Parameters
    ----------
    contact : callable
        Takes a contact radius, and returns the normal contact of that radius.

    Attributes
    ----------
    rounding : float
        Relative error of a panel below which shorter panels do not reduce it.
    """

    rounding = 0.0

    def __init__(self, contact: Callable[[float], Indentation]) -> None:
        self._contact = contact

    def loads_on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> PanelLoads:
        """Return loads and approaches of the panel that follows the last one kept."""
        contacts = [self._contact(b) for b in np.exp(stretch.u_nodes).tolist()]
        loads = np.array([contact.load for contact in contacts])
        approaches = np.array([contact.approach for contact in contacts])
        error = max(max(contact.load_error, contact.approach_error) for contact in contacts)
        return PanelLoads(loads, approaches, node_error=error)

    def keep(self) -> None:
        """Do nothing: normal contact does not depend on the history."""

    def cut_back(self, count: int) -> None:
        """Do nothing: normal contact does not depend on the history."""


class SmoothLoads:
    """Loads and approaches on a smooth surface without coupling: (docs/theory, G.5).

    Parameters
    ----------
    profile : Profile
    first_load : float
        The load at the radius at which the history begins.

    Attributes
    ----------
    rounding : float
        As in `NormalLoads`.
    """

    rounding = 0.0

    def __init__(self, profile: Profile, first_load: float) -> None:
        self.profile = profile
        self._rule = graded_rule(_SMOOTH_POINTS, 1, 0.0)
        #: loads at the beginning of the history and at the upper ends of the panels kept
        self._loads = [first_load]
        #: load at the upper end of the panel that was computed last
        self._new_load = first_load

    def loads_on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> PanelLoads:
        """Return loads and approaches of the panel that follows the last one kept."""
        points, weights = self._rule
        ends = np.append(stretch.u_nodes, stretch.high)
        depths = stretch.depth_of(ends)[:, None] * points
        integrand = self._load_of_punch(stretch.u_at_depth(depths)) / stretch.dv_du_at_depth(depths)
        boundary = self._load_of_punch(ends) - self._load_of_punch(np.array(stretch.low))
        loads = self._loads[-1] + boundary - stretch.depth_of(ends) * (integrand @ weights)
        self._new_load = float(loads[-1])
        approaches = self.profile._transform(np.exp(stretch.u_nodes)) / 2.0
        return PanelLoads(loads[:-1], approaches)

    def keep(self) -> None:
        """Add the panel that was computed last to the history."""
        self._loads.append(self._new_load)

    def cut_back(self, count: int) -> None:
        """Keep only the first `count` panels of the history."""
        del self._loads[count + 1 :]

    def _load_of_punch(self, u: Array) -> Array:
        """Return ``8 b delta`` at ``u = ln b``: the load of one flat punch with this approach."""
        return np.asarray(4.0 * np.exp(u) * self.profile._transform(np.exp(u)))


class _PanelQuadrature(NamedTuple):
    """Quadrature of ``[1 - omega(b, r)] d delta(b)`` over a solved panel, for radii beyond it.

    Attributes
    ----------
    below_end : ndarray, shape (points,)
        Distances in ``u`` of the points from the upper end of the panel.
    factors : ndarray, shape (points, punches)
        Factors of the flat punches at the nodes in the interpolant at the points.
    increments : ndarray, shape (points,)
        ``d delta`` at the points, times the weights of the quadrature.
    """

    below_end: Array
    factors: Array
    increments: Array


@dataclass(frozen=True, slots=True)
class _VolterraPanel:
    """A panel of the Volterra equation, with a flat punch at each of its nodes.

    Attributes
    ----------
    stretch : RadiusStretch
    ratios : ndarray
        The unknowns, ``D`` at the nodes.
    outside : list of LogSeries
        ``omega`` of each flat punch, as of `outside_displacement`.
    rough_start : bool
        Whether ``dH/dv`` may be no smooth function at the lower end: beyond a break it may be like
        a square root, and from the first touch on like a power of ``b``.
    quadratures : dict
        The quadratures made so far, for radii near the panel (False) and far beyond it (True).
    """

    stretch: RadiusStretch
    ratios: Array
    outside: list[LogSeries]
    rough_start: bool
    quadratures: dict[bool, _PanelQuadrature] = field(default_factory=dict)

    def factors(self, depth: Array) -> Array:
        """Return the factors of the punches in the interpolant, at depths, (..., punches)."""
        t = self.stretch.place(depth)
        return interpolation_weights(t.ravel(), self.stretch.count).reshape(*t.shape, -1)

    def kernel(self, factors: Array, distance: Array) -> Array:
        """Return ``1 - omega(b, r)`` for contact radii ``b`` on the panel, and larger radii ``r``.

        Parameters
        ----------
        factors : ndarray, shape (..., points, punches)
            Factors of the punches in the interpolant at each ``b``.
        distance : ndarray, shape (radii, points)
            ``ln(r/b)``.

        Returns
        -------
        ndarray, shape (radii, points)
        """
        omega = outside_values(self.outside, distance.ravel()).reshape(-1, *distance.shape)
        return np.asarray(1.0 - np.einsum("...nk,k...n->...n", factors, omega))


class VolterraLoads:
    """Loads and approaches with coupling, from the Volterra equation (docs/theory, G.6 and G.7).

    Parameters
    ----------
    profile : Profile
    low : float
        Logarithm of the radius at which the history begins. For flat punches of smaller radii
        ``omega`` is taken to be the same function of ``r/b``, and ``D`` to be constant.
    first_flat : Solution
        The flat punch of that radius.

    Attributes
    ----------
    rounding : float
        As in `NormalLoads`.
    """

    rounding = _VOLTERRA_ROUNDING

    def __init__(self, profile: Profile, low: float, first_flat: Solution) -> None:
        self.profile = profile
        roots, weights = graded_rule(*_GRADED_ARGUMENTS)
        half_points = roots**2 / 2.0
        half_weights = roots * weights
        #: rules on (0, 1): graded to 0, for smooth integrands, and graded to both ends; a node
        #: graded to 0 is the square of a node of `graded_rule`
        self._graded = 2.0 * half_points, 2.0 * half_weights
        self._smooth = graded_rule(_SMOOTH_POINTS, 1, 0.0)
        self._two_sided = (
            np.append(half_points, 1.0 - half_points),
            np.append(half_weights, half_weights),
        )
        self._log_breaks = np.log(profile.breaks)
        self._flat_part = profile.flat_part > 0.0
        #: the latest flat punch, and its `outside_displacement`
        self._latest = first_flat, outside_displacement(first_flat)
        self._low = low
        self._first_outside = [self._latest[1]]
        #: quadrature over radii below `low`: distances from it in u, and d delta times the weights
        self._below_low, self._first_increments = self._first_quadrature()
        # The method returns dH times the weights. D, the factor that makes it d delta, follows from
        # the equation at `low`.
        at_low = np.array([low])
        self._first_increments *= self._height(at_low) / self._integral_below_low(at_low)
        approach = float(self._first_increments.sum())
        # b/exp(low), and b delta*/exp(low). The part of delta* by the half-spaces is that at `low`;
        # the part by the layer is in proportion to 1/b.
        radii = np.exp(-self._below_low)
        layer = first_flat.scene.normal_compliance / math.pi
        scaled_approaches = (first_flat.approach - layer) * radii + layer
        load = math.exp(low) * float((radii**2 / scaled_approaches * self._first_increments).sum())
        self._panels: list[_VolterraPanel] = []
        #: load and approach at `low` and at the upper ends of the panels kept
        self._ends = [(load, approach)]
        #: the panel that was computed last, and load and approach at its upper end
        self._new_panel: _VolterraPanel | None = None
        self._new_end = load, approach

    def loads_on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> PanelLoads:
        """Return loads and approaches of the panel that follows the last one kept.

        Raises
        ------
        NotComputedError
            If load or approach would not grow with the contact radius.
        """
        at_break = bool(np.abs(self._log_breaks - stretch.low).min(initial=1.0) < _BREAK_ROUNDING)
        rough_start = at_break or not self._panels
        outside = [self._outside(flat) for flat in flats]
        panel = _VolterraPanel(stretch, np.zeros(stretch.count), outside, rough_start)
        # a row for each of the points r at which (G.7) is required, with a quadrature from the
        # lower end of the panel up to r
        points, weights = self._two_sided if panel.rough_start else self._graded
        depth = stretch.depth(_radau(math.ceil(_POINTS_PER_UNKNOWN * stretch.count)))[:, None]
        log_radii = stretch.u_at_depth(depth)
        quadrature_depth = depth * (1.0 - points)
        distance = -stretch.u_increment(depth, -depth * points)
        factors = panel.factors(quadrature_depth)
        transform_rate = self._transform_rate(log_radii - distance)
        integrand = weights * panel.kernel(factors, distance) * transform_rate
        integrand /= stretch.dv_du_at_depth(quadrature_depth)
        matrix = depth * np.einsum("rn,rnk->rk", integrand, factors)
        radii = log_radii[:, 0]
        right_side = self._height(radii) - self._integral_below_low(radii)
        for earlier in self._panels:
            right_side -= self._integral_over(earlier, radii)
        ratios = np.linalg.lstsq(matrix, right_side, rcond=None)[0]
        self._new_panel = replace(panel, ratios=ratios, quadratures={})
        return self._panel_loads(self._new_panel, flats)

    def _outside(self, flat: Solution) -> LogSeries:
        """Return `outside_displacement` of a flat punch; the latest one is kept.

        On a smooth surface all flat punches are the same object.
        """
        if flat is not self._latest[0]:
            self._latest = flat, outside_displacement(flat)
        return self._latest[1]

    def _panel_loads(self, panel: _VolterraPanel, flats: tuple[Solution, ...]) -> PanelLoads:
        """Return load and approach at the nodes, by integrals from the lower end of the panel."""
        stretch = panel.stretch
        # a row for each node, and one for the upper end
        extents = stretch.depth_of(np.append(stretch.u_nodes, stretch.high))[:, None]
        points, weights = self._graded if panel.rough_start else self._smooth
        depth = (extents * points).ravel()
        u = stretch.u_at_depth(depth)
        factors = panel.factors(depth)
        # d delta/dv
        approach_rate = (
            (factors @ panel.ratios) * self._transform_rate(u) / stretch.dv_du_at_depth(depth)
        )
        # b delta* is interpolated, as delta* has a pole at b = 0
        scaled_approaches = np.exp(stretch.u_nodes) * np.array([flat.approach for flat in flats])
        # dP/d delta = b/delta*
        stiffness = np.exp(2.0 * u) / (factors @ scaled_approaches)
        scaled_weights = extents * weights
        load, approach = self._ends[-1]
        approaches = approach + (approach_rate.reshape(len(extents), -1) * scaled_weights).sum(
            axis=1
        )
        load_rate = (approach_rate * stiffness).reshape(len(extents), -1)
        loads = load + (load_rate * scaled_weights).sum(axis=1)
        self._new_end = float(loads[-1]), float(approaches[-1])
        increments = np.diff(loads, prepend=load), np.diff(approaches, prepend=approach)
        if not np.min(increments) > 0.0:
            message = f"at the contact radius {math.exp(stretch.high):.6g} the load would not grow"
            raise NotComputedError("load", message)
        # A panel may add a larger fraction to the fields next to the edge than to load and
        # approach: about the square root of the fraction that it adds to these.
        fraction_added = 1.0 - min(load / self._new_end[0], approach / self._new_end[1])
        error = interpolation_error(panel.ratios) / float(np.abs(panel.ratios).max())
        error *= math.sqrt(max(fraction_added, 0.0))
        return PanelLoads(loads[:-1], approaches[:-1], error)

    def keep(self) -> None:
        """Add the panel that was computed last to the history."""
        assert self._new_panel is not None
        self._panels.append(self._new_panel)
        self._ends.append(self._new_end)

    def cut_back(self, count: int) -> None:
        """Keep only the first `count` panels of the history."""
        del self._panels[count:], self._ends[count + 1 :]

    def _integral_below_low(self, log_radii: Array) -> Array:
        """Return ``int [1 - omega(b, r)] d delta`` over ``b`` below `low`, at radii ``r``, (n,)."""
        distance = log_radii[:, None] - self._low + self._below_low
        omega = outside_values(self._first_outside, distance.ravel())[0].reshape(distance.shape)
        return np.asarray((1.0 - omega) @ self._first_increments)

    def _integral_over(self, panel: _VolterraPanel, log_radii: Array) -> Array:
        """Return ``int [1 - omega(b, r)] d delta`` over an earlier panel, at radii ``r``, (n,)."""
        above_end = log_radii - panel.stretch.high
        far = (above_end > _SMOOTH_DISTANCE) & (not panel.rough_start)
        integrals = np.empty(len(above_end))
        for is_far in (False, True):
            selected = far == is_far
            if selected.any():
                below_end, factors, increments = self._quadrature_of(panel, is_far)
                distance = above_end[selected, None] + below_end
                integrals[selected] = panel.kernel(factors, distance) @ increments
        return integrals

    def _quadrature_of(self, panel: _VolterraPanel, far: bool) -> _PanelQuadrature:
        """Return the quadrature over a panel, for radii near it or far beyond it, made once."""
        if far not in panel.quadratures:
            stretch = panel.stretch
            points, weights = self._smooth if far else self._graded
            if panel.rough_start:
                points, weights = self._two_sided
            extent = stretch.extent
            depth = extent * (1.0 - points)
            below_end = -stretch.u_increment(np.array(extent), -extent * points)
            factors = panel.factors(depth)
            increments = (factors @ panel.ratios) * self._transform_rate(stretch.high - below_end)
            increments *= extent * weights / stretch.dv_du_at_depth(depth)
            panel.quadratures[far] = _PanelQuadrature(below_end, factors, increments)
        return panel.quadratures[far]

    def _height(self, log_radii: Array) -> Array:
        """Return the height ``h`` of the profile at logarithms of radii."""
        return self.profile._height(np.exp(log_radii))

    def _first_quadrature(self) -> tuple[Array, Array]:
        """Return points below `low`, as distances from it in ``u``, and ``dH`` times the weights.

        They reach down to the end of a flat part, or to the centre if there is none.
        """
        if self._flat_part:
            points, weights = self._two_sided
            # in u; from the end of the flat part, the first break, to `low`
            length = self._low - self._log_breaks[0]
            below_low = length * points
            scaled_weights = length * weights
        else:
            points, weights = self._graded
            below_low = -np.log1p(-points)
            scaled_weights = weights / (1.0 - points)
        return below_low, scaled_weights * self._transform_rate(self._low - below_low)

    def _transform_rate(self, log_radii: Array) -> Array:
        """Return ``dH/du`` at logarithms of radii, of any shape."""
        u = log_radii.ravel()
        b = np.exp(u)
        squares_beyond_break = np.zeros(len(u))  # b**2 less the square of the last break below b
        if len(self._log_breaks):
            last = np.searchsorted(self._log_breaks, u, side="right") - 1
            log_break = self._log_breaks[np.maximum(last, 0)]
            squares = np.exp(2.0 * log_break) * np.expm1(2.0 * (u - log_break))
            squares_beyond_break = np.where(last >= 0, squares, 0.0)
        return np.asarray(b * self.profile._rate(b, squares_beyond_break)).reshape(log_radii.shape)


#: A source of loads and approaches, panel by panel from the first touch on. `loads_on` returns
#: those of a panel, and `keep` makes this panel a part of the history; `cut_back` removes the
#: latest panels.
LoadSource = NormalLoads | SmoothLoads | VolterraLoads


@cache
def _radau(count: int) -> Array:
    """Return the Radau points on (-1, 1], of which the last one is 1."""
    return np.append(roots_jacobi(count - 1, 1.0, 0.0)[0], 1.0)
