r"""Load and approach as functions of the contact radius ``b``, over the history of a contact.

The fields of a growing contact are a sum of those of flat punches of the radii ``b``; the
increments ``dP`` of the load are the weights of this sum. Without coupling the load at every radius
is that of normal contact. With coupling it follows from the condition that a point at radius ``r``
comes into contact when ``b = r``: by then the approach less what the surface there has sunk is the
height ``h(r)`` of the profile. With ``omega(b, r)``, the displacement of the surface at ``r > b``
for unit approach of a flat punch of radius ``b``, and ``delta*(b)``, the approach of that punch for
unit load and in units of its radius,

    h(r) = int_0^r [1 - omega(b, r)] d delta(b),        dP = b d delta / delta*(b),

This is a Volterra equation of the first kind for ``d delta``. Its kernel on the diagonal,
``1 - omega(r, r)``, is the compression ``alpha p`` of the layer at the edge, for unit approach. The
equation is collocated on the panels of the history, from the first touch on, at more Radau points
than there are unknowns, which makes it stable. The unknowns are the ratios of ``d delta/du``,
``u = ln b``, to ``dH/du``, at the nodes of a panel; ``H(b)`` is the half-integral of the profile.
The ratio is almost constant, even next to breaks of the profile. Under a flat part the load is 0
until the contact grows beyond it.
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
from spectral_contact.solving.outside import outside_displacement, reached
from spectral_contact.solving.stretch import RadiusStretch, interpolation_weights, left_out
from spectral_contact.spectral.jacobi import graded_rule

if TYPE_CHECKING:
    from spectral_contact.contact.on_parts import Indentation
    from spectral_contact.solution import Solution

#: Arguments of `graded_rule` (points, panels, ratio) for integrals up to the radius at which the
#: equation is collocated. There the kernel has a square root on a smooth surface, so that the rule
#: is in the square root of the distance: loads under a sphere and a cone are off by 1e-13 or less.
#: In the distance itself, with (12, 24, 0.2), they were off by 7e-12, which no estimate covered.
_GRADED = (14, 16, 0.2)
#: Number of Gauss points for a smooth integrand.
_SMOOTH_POINTS = 20
#: Distance in ``u`` from a panel beyond which its kernel is smooth, and Gauss points suffice.
_FAR = 1.0
#: A panel begins at a break if their distance in ``u`` is less than this.
_SAME = 1e-14
#: Number of collocation points for each unknown; the overdetermined system is solved by least
#: squares. The end of the panel is one of the points. With one point for each unknown, errors grow
#: from panel to panel where the pressure oscillates.
_POINTS_PER_UNKNOWN = 1.6
#: Estimated errors of panels below this are rounding errors of the Volterra equation, which shorter
#: panels do not reduce. On a smooth surface, where all flat punches are alike, panels under a
#: sphere and a cone have 3e-12 to 2.5e-11, and halves of them 5e-11 to 1e-10.
_VOLTERRA_ROUNDING = 5e-11


@dataclass(frozen=True, slots=True)
class Weights:
    """Loads and approaches at the nodes of a panel, with their errors.

    Attributes
    ----------
    loads, approaches : ndarray
        Load and approach at each node, counted from the first touch.
    error : float
        Error of the interpolation over the panel, relative to the whole load.
    at_nodes : float
        Relative error of the values at the nodes, where they are those of normal contact.
    """

    loads: Array
    approaches: Array
    error: float = 0.0
    at_nodes: float = 0.0


class NormalWeight:
    """Loads and approaches of normal contact.

    Parameters
    ----------
    contact : callable
        Takes a contact radius, and returns the normal contact of that radius.

    Attributes
    ----------
    rounding : float
        Rounding error of a panel, relative: shorter panels do not reduce the error below it.
    """

    rounding = 0.0

    def __init__(self, contact: Callable[[float], Indentation]) -> None:
        self._contact = contact

    def on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> Weights:
        """Return loads and approaches of the panel that follows the last one kept."""
        contacts = [self._contact(b) for b in np.exp(stretch.logs).tolist()]
        loads = np.array([contact.load for contact in contacts])
        approaches = np.array([contact.approach for contact in contacts])
        error = max(max(contact.load_error, contact.approach_error) for contact in contacts)
        return Weights(loads, approaches, at_nodes=error)

    def keep(self) -> None:
        """Do nothing: normal contact does not depend on the history."""

    def back(self, count: int) -> None:
        """Do nothing: normal contact does not depend on the history."""


class SmoothWeight:
    """Loads on a smooth surface: the integral of ``dP = 8 b d delta`` with ``delta = H/2``.

    It is integrated by parts: ``8 b delta`` less the integral of ``8 delta db``.

    Parameters
    ----------
    profile : Profile
    first : float
        The load where the history begins.

    Attributes
    ----------
    rounding : float
        As in `NormalWeight`.
    """

    rounding = 0.0

    def __init__(self, profile: Profile, first: float) -> None:
        self.profile = profile
        self._rule = graded_rule(_SMOOTH_POINTS, 1, 0.0)
        #: loads where the history begins and at the ends of the panels kept
        self._loads = [first]
        #: load at the end of the panel that was computed last
        self._new_load = first

    def on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> Weights:
        """Return loads and approaches of the panel that follows the last one kept."""
        points, weights = self._rule
        ends = np.append(stretch.logs, stretch.high)
        depths = stretch.depth_of(ends)[:, None] * points
        integrand = self._product(stretch.log_radius(depths)) / stretch.bends(depths)
        boundary = self._product(ends) - self._product(np.array(stretch.low))
        loads = self._loads[-1] + boundary - stretch.depth_of(ends) * (integrand @ weights)
        self._new_load = float(loads[-1])
        approaches = self.profile._transform(np.exp(stretch.logs)) / 2.0
        return Weights(loads[:-1], approaches)

    def keep(self) -> None:
        """Add the panel that was computed last to the history."""
        self._loads.append(self._new_load)

    def back(self, count: int) -> None:
        """Keep only the first `count` panels of the history."""
        del self._loads[count + 1 :]

    def _product(self, u: Array) -> Array:
        """Return ``8 b delta`` at ``u = ln b``."""
        return np.asarray(4.0 * np.exp(u) * self.profile._transform(np.exp(u)))


class _PanelQuadrature(NamedTuple):
    """Quadrature of ``[1 - omega(b, r)] d delta(b)`` over a solved panel, for radii beyond it.

    Attributes
    ----------
    behind : ndarray, shape (points,)
        How far the points are below the upper end of the panel, in ``u``.
    factors : ndarray, shape (points, punches)
        Factors of the flat punches at the nodes in the interpolant at the points.
    increments : ndarray, shape (points,)
        ``d delta`` at the points, with the weights of the quadrature.
    """

    behind: Array
    factors: Array
    increments: Array


@dataclass(frozen=True, slots=True)
class _VolterraPanel:
    """A panel of the Volterra equation, with a flat punch at each of its nodes.

    Attributes
    ----------
    stretch : RadiusStretch
    ratios : ndarray
        The unknowns: ``d delta/du`` over ``dH/du`` at the nodes.
    outside : list of LogSeries
        Displacement of the surface outside each flat punch.
    at_break : bool
        Whether it begins at a break, where ``dH/du`` may behave like a square root.
    quadratures : dict
        The quadratures for radii far beyond the panel (True) and near it (False), once made.
    """

    stretch: RadiusStretch
    ratios: Array
    outside: list[LogSeries]
    at_break: bool
    quadratures: dict[bool, _PanelQuadrature] = field(default_factory=dict)

    def factors(self, depth: Array) -> Array:
        """Return the factors of the punches in the interpolant at depths, (..., punches)."""
        t = self.stretch.place(depth)
        return interpolation_weights(t.ravel(), self.stretch.count).reshape(*t.shape, -1)

    def kernel(self, factors: Array, distance: Array) -> Array:
        """Return ``1 - omega(b, r)`` for points ``b`` of the panel and radii ``r`` beyond them.

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
        omega = reached(self.outside, distance.ravel()).reshape(-1, *distance.shape)
        return np.asarray(1.0 - np.einsum("...nk,k...n->...n", factors, omega))


class CoupledWeight:
    """Loads and approaches with coupling, from the Volterra equation of this module.

    Parameters
    ----------
    profile : Profile
    low : float
        Logarithm of the radius where the history begins. Flat punches of smaller radii are taken to
        displace the surface as this one does, in units of their radii.
    first : Solution
        The flat punch of that radius.

    Attributes
    ----------
    rounding : float
        As in `NormalWeight`.
    """

    rounding = _VOLTERRA_ROUNDING

    def __init__(self, profile: Profile, low: float, first: Solution) -> None:
        self.profile = profile
        roots, weights = graded_rule(*_GRADED)
        half_points = roots**2 / 2.0
        half_weights = roots * weights
        #: rules on (0, 1): graded to 0, smooth, and graded to both ends
        self._graded = 2.0 * half_points, 2.0 * half_weights
        self._smooth = graded_rule(_SMOOTH_POINTS, 1, 0.0)
        self._two_sided = (
            np.append(half_points, 1.0 - half_points),
            np.append(half_weights, half_weights),
        )
        self._breaks = np.log(profile.breaks)
        self._flat_part = profile.flat_part > 0.0
        #: the flat punch whose outside displacement was computed last, and that displacement
        self._latest = first, outside_displacement(first)
        self._low = low
        self._first_outside = [self._latest[1]]
        #: quadrature below `low`: distances in u, and d delta with the weights
        self._behind, self._first_increments = self._first_quadrature()
        # d delta is proportional to dH there; the equation at `low` gives the factor
        at_low = np.array([low])
        self._first_increments *= self._height(at_low) / self._from_first(at_low)
        approach = float(self._first_increments.sum())
        # the approach of smaller punches, for unit load, is that of the layer and that of the body
        radii = np.exp(-self._behind)
        layer = first.scene.normal_compliance / math.pi
        softness = (first.approach - layer) * radii + layer
        load = math.exp(low) * float((radii**2 / softness * self._first_increments).sum())
        self._panels: list[_VolterraPanel] = []
        #: load and approach at `low` and at the ends of the panels kept
        self._ends = [(load, approach)]
        #: the panel that was computed last, and load and approach at its end
        self._new_panel: _VolterraPanel | None = None
        self._new_end = load, approach

    def on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> Weights:
        """Return loads and approaches of the panel that follows the last one kept.

        Raises
        ------
        NotComputedError
            If load or approach would not grow with the contact radius.
        """
        at_break = bool(np.abs(self._breaks - stretch.low).min(initial=1.0) < _SAME)
        outside = [self._outside(flat) for flat in flats]
        panel = _VolterraPanel(stretch, np.zeros(stretch.count), outside, at_break)
        # collocation points are rows; the quadrature goes from the lower end up to each of them
        points, weights = self._two_sided if panel.at_break else self._graded
        depth = stretch.depth(_radau(math.ceil(_POINTS_PER_UNKNOWN * stretch.count)))[:, None]
        log_radii = stretch.log_radius(depth)
        quadrature_depth = depth * (1.0 - points)
        distance = -stretch.ahead(depth, -depth * points)
        factors = panel.factors(quadrature_depth)
        rate = self._transform_rate(log_radii - distance)
        integrand = weights * panel.kernel(factors, distance) * rate
        integrand /= stretch.bends(quadrature_depth)
        matrix = depth * np.einsum("rn,rnk->rk", integrand, factors)
        radii = log_radii[:, 0]
        right_side = self._height(radii) - self._from_first(radii)
        for earlier in self._panels:
            right_side -= self._from_panel(earlier, radii)
        ratios = np.linalg.lstsq(matrix, right_side, rcond=None)[0]
        self._new_panel = replace(panel, ratios=ratios, quadratures={})
        return self._weights(self._new_panel, flats)

    def _outside(self, flat: Solution) -> LogSeries:
        """Return the displacement outside a flat punch; the last one is kept.

        On a smooth surface all flat punches are the same object.
        """
        if flat is not self._latest[0]:
            self._latest = flat, outside_displacement(flat)
        return self._latest[1]

    def _weights(self, panel: _VolterraPanel, flats: tuple[Solution, ...]) -> Weights:
        """Return load and approach at the nodes, by integrals from the beginning of the panel."""
        stretch = panel.stretch
        extent = stretch.depth_of(np.append(stretch.logs, stretch.high))[:, None]
        points, weights = self._graded if panel.at_break else self._smooth
        depth = (extent * points).ravel()
        u = stretch.log_radius(depth)
        factors = panel.factors(depth)
        rate = (factors @ panel.ratios) * self._transform_rate(u) / stretch.bends(depth)
        # where a layer is thick for small radii, b delta* is smooth, and delta* is not
        softness = np.exp(stretch.logs) * np.array([flat.approach for flat in flats])
        stiffness = np.exp(2.0 * u) / (factors @ softness)
        scaled_weights = extent * weights
        load, approach = self._ends[-1]
        approaches = approach + (rate.reshape(len(extent), -1) * scaled_weights).sum(axis=1)
        load_rate = (rate * stiffness).reshape(len(extent), -1)
        loads = load + (load_rate * scaled_weights).sum(axis=1)
        self._new_end = float(loads[-1]), float(approaches[-1])
        increments = np.diff(loads, prepend=load), np.diff(approaches, prepend=approach)
        if not np.min(increments) > 0.0:
            text = f"at the contact radius {math.exp(stretch.high):.6g} the load would not grow"
            raise NotComputedError("load", text)
        # next to the edge what a panel adds to the fields goes like the root of what it adds here
        added = 1.0 - min(load / self._new_end[0], approach / self._new_end[1])
        error = left_out(panel.ratios) / float(np.abs(panel.ratios).max())
        error *= math.sqrt(max(added, 0.0))
        return Weights(loads[:-1], approaches[:-1], error)

    def keep(self) -> None:
        """Add the panel that was computed last to the history."""
        assert self._new_panel is not None
        self._panels.append(self._new_panel)
        self._ends.append(self._new_end)

    def back(self, count: int) -> None:
        """Keep only the first `count` panels of the history."""
        del self._panels[count:], self._ends[count + 1 :]

    def _from_first(self, log_radii: Array) -> Array:
        """Return the integral of the equation over radii below `low`, at radii (n,)."""
        distance = log_radii[:, None] - self._low + self._behind
        omega = reached(self._first_outside, distance.ravel())[0].reshape(distance.shape)
        return np.asarray((1.0 - omega) @ self._first_increments)

    def _from_panel(self, panel: _VolterraPanel, log_radii: Array) -> Array:
        """Return the integral of the equation over an earlier panel, at radii (n,)."""
        beyond = log_radii - panel.stretch.high
        far = (beyond > _FAR) & (not panel.at_break)
        added = np.empty(len(beyond))
        for is_far in (False, True):
            rows = far == is_far
            if rows.any():
                behind, factors, increments = self._quadrature_of(panel, is_far)
                added[rows] = panel.kernel(factors, beyond[rows, None] + behind) @ increments
        return added

    def _quadrature_of(self, panel: _VolterraPanel, far: bool) -> _PanelQuadrature:
        """Return the quadrature over a panel for radii near it or far beyond it, made once."""
        if far not in panel.quadratures:
            stretch = panel.stretch
            points, weights = self._smooth if far else self._graded
            if panel.at_break:
                points, weights = self._two_sided
            extent = stretch.extent
            depth = extent * (1.0 - points)
            behind = -stretch.ahead(np.array(extent), -extent * points)
            factors = panel.factors(depth)
            increments = (factors @ panel.ratios) * self._transform_rate(stretch.high - behind)
            increments *= extent * weights / stretch.bends(depth)
            panel.quadratures[far] = _PanelQuadrature(behind, factors, increments)
        return panel.quadratures[far]

    def _height(self, log_radii: Array) -> Array:
        """Return ``h``, the left-hand side of the equation, at logarithms of radii."""
        return self.profile._height(np.exp(log_radii))

    def _first_quadrature(self) -> tuple[Array, Array]:
        """Return points below `low`, as distances in ``u``, and ``dH`` there with the weights.

        The points reach down to the end of a flat part, or to the centre if there is none.
        """
        if self._flat_part:
            points, weights = self._two_sided
            extent = self._low - self._breaks[0]
            behind = extent * points
            scaled_weights = extent * weights
        else:
            points, weights = self._graded
            behind = -np.log1p(-points)
            scaled_weights = weights / (1.0 - points)
        return behind, scaled_weights * self._transform_rate(self._low - behind)

    def _transform_rate(self, log_radii: Array) -> Array:
        """Return ``dH/du`` at logarithms of radii, of any shape."""
        u = log_radii.ravel()
        b = np.exp(u)
        past = np.zeros(len(u))  # as `Profile._rate` takes it
        if len(self._breaks):
            last = np.searchsorted(self._breaks, u, side="right") - 1
            log_break = self._breaks[np.maximum(last, 0)]
            squares = np.exp(2.0 * log_break) * np.expm1(2.0 * (u - log_break))
            past = np.where(last >= 0, squares, 0.0)
        return np.asarray(b * self.profile._rate(b, past)).reshape(log_radii.shape)


#: A source of loads and approaches, panel by panel from the first touch on.
Weight = NormalWeight | SmoothWeight | CoupledWeight


@cache
def _radau(count: int) -> Array:
    """Return the Radau points on (-1, 1], of which the last is 1."""
    return np.append(roots_jacobi(count - 1, 1.0, 0.0)[0], 1.0)
