r"""How the load grows with the contact radius: the weight of the flat punches of a history.

Without coupling the load at every radius is that of normal contact. With it the approach follows
from what the punch is at the radius where the surface comes to meet it: with ``omega(b, r)``, by
how much a flat punch of the radius ``b`` takes the surface at ``r > b`` down with it,

    h(r) = int_0^r [1 - omega(b, r)] d delta(b),        dP = b d delta / delta*(b),

a Volterra equation of the first kind, whose diagonal is ``alpha p`` at the edge. It is collocated
on panels in ``u = ln b``, from the first touch on, at more Radau points than it has unknowns, which
makes it stable. The unknown is ``d delta/du`` over that of the half-integral ``H(b)`` of the
profile, and almost constant, next to corners, too. A flat part has no load before it grows.
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

#: Quadrature in the root of the distance from the radius in question, where the kernel has a square
#: root on a smooth surface, and far from it: loads under a sphere and a cone are off by 1e-13 or
#: less. In the distance itself, with (12, 24, 0.2), they were off by 7e-12, which no estimate has.
_GRADED, _SMOOTH = (14, 16, 0.2), 20
#: Distance in ``u`` from a panel beyond which its kernel is smooth, and Gauss points suffice.
_FAR = 1.0
#: A panel begins at a break if it is closer to it in ``u``.
_NEXT = 1e-14
#: The equation is collocated, by least squares, at so many places for each unknown: the end of a
#: panel is one of them. With as many as unknowns errors grow from panel to panel where the pressure
#: oscillates.
_PLACES = 1.6
#: Errors of panels below this are rounding of this equation. On a smooth surface, where all flat
#: punches are alike, panels under a sphere and a cone have 3e-12 to 2.5e-11, and halves of them
#: 5e-11 to 1e-10.
_VOLTERRA_ROUNDING = 5e-11


@dataclass(frozen=True, slots=True)
class Weights:
    """Loads and approaches of a panel: the increments of the load weigh the flat punches.

    Attributes
    ----------
    loads, approaches : ndarray
        Total load and approach up to each node; their increments are the weights.
    error : float
        What the panel leaves out, relative to all of the load.
    at_nodes : float
        What the loads and approaches at the nodes are known to, where these are normal contact's.
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
        Of a contact radius.

    Attributes
    ----------
    rounding : float
        Errors of panels that shorter panels do not lower.
    """

    rounding = 0.0

    def __init__(self, contact: Callable[[float], Indentation]) -> None:
        self._contact = contact

    def on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> Weights:
        """Return the weights of a panel, next to the last one kept."""
        contacts = [self._contact(b) for b in np.exp(stretch.logs).tolist()]
        loads, approaches = np.array([(one.load, one.approach) for one in contacts]).T
        known = max(max(one.load_error, one.approach_error) for one in contacts)
        return Weights(loads, approaches, at_nodes=known)

    def keep(self) -> None:
        """Do nothing: normal contact knows no history."""

    def back(self, count: int) -> None:
        """Do nothing."""


class SmoothWeight:
    """Loads on a smooth surface: ``dP = 8 b d delta`` with ``delta = H/2``, by parts.

    Parameters
    ----------
    profile : Profile
    first : float
        The load where the history begins.

    Attributes
    ----------
    rounding : float
        As of `NormalWeight`.
    """

    rounding = 0.0

    def __init__(self, profile: Profile, first: float) -> None:
        self.profile = profile
        self._rule = graded_rule(_SMOOTH, 1, 0.0)
        self._loads, self._end = [first], first

    def on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> Weights:
        """Return the weights of a panel."""
        points, weights = self._rule
        ends = np.append(stretch.logs, stretch.high)
        depths = stretch.depth_of(ends)[:, None] * points
        within = self._carried(stretch.log_radius(depths)) / stretch.bends(depths)
        gained = self._carried(ends) - self._carried(np.array(stretch.low))
        loads = self._loads[-1] + gained - stretch.depth_of(ends) * (within @ weights)
        self._end = float(loads[-1])
        approaches = self.profile._transform(np.exp(stretch.logs)) / 2.0
        return Weights(loads[:-1], approaches)

    def keep(self) -> None:
        """Take the panel that was looked at last as part of the history."""
        self._loads.append(self._end)

    def back(self, count: int) -> None:
        """Forget all panels but the first ones."""
        del self._loads[count + 1 :]

    def _carried(self, u: Array) -> Array:
        """Return ``8 b delta``."""
        return np.asarray(4.0 * np.exp(u) * self.profile._transform(np.exp(u)))


class _PanelPlaces(NamedTuple):
    """Places of a panel: how far behind its end, in shares of its punches, and what they sink."""

    behind: Array
    shares: Array
    growth: Array


@dataclass(frozen=True, slots=True)
class _Span:
    """A panel of the history with ``d delta/du`` over ``dH/du`` at its nodes.

    Attributes
    ----------
    stretch : RadiusStretch
    rates : ndarray
    around : list of LogSeries
        The surface around its punches.
    at_break : bool
        Whether it begins at one, where ``dH/du`` may behave like a square root.
    places : dict
        Its `_PanelPlaces`, as they are taken far away from it (True) and near it (False).
    """

    stretch: RadiusStretch
    rates: Array
    around: list[LogSeries]
    at_break: bool
    places: dict[bool, _PanelPlaces] = field(default_factory=dict)

    def shares(self, depth: Array) -> Array:
        """Return the weights of the punches at depths of any shape, (..., punches)."""
        t = self.stretch.place(depth)
        return interpolation_weights(t.ravel(), self.stretch.count).reshape(*t.shape, -1)

    def kernel(self, shares: Array, ahead: Array) -> Array:
        """Return ``1 - omega`` from places with these shares to radii that are so far ahead.

        Parameters
        ----------
        shares : ndarray, shape (..., places, punches)
        ahead : ndarray, shape (radii, places)
            Logarithms of a radius over that of a place.

        Returns
        -------
        ndarray, shape (radii, places)
        """
        omega = reached(self.around, ahead.ravel()).reshape(-1, *ahead.shape)
        return np.asarray(1.0 - np.einsum("...nk,k...n->...n", shares, omega))


class CoupledWeight:
    """The solution of the Volterra equation.

    Parameters
    ----------
    profile : Profile
    low : float
        Logarithm of the radius where the history begins; before, it is taken as self-similar.
    first : Solution
        The flat punch there.

    Attributes
    ----------
    rounding : float
        As of `NormalWeight`.
    """

    rounding = _VOLTERRA_ROUNDING

    def __init__(self, profile: Profile, low: float, first: Solution) -> None:
        self.profile = profile
        roots, weights = graded_rule(*_GRADED)
        half, shares = roots**2 / 2.0, roots * weights
        self._graded = 2.0 * half, 2.0 * shares
        self._smooth = graded_rule(_SMOOTH, 1, 0.0)
        self._both = np.append(half, 1.0 - half), np.append(shares, shares)
        self._breaks, self._flat_part = np.log(profile.breaks), profile.flat_part > 0.0
        self._last = first, outside_displacement(first)
        self._low, self._around = low, [self._last[1]]
        self._behind, self._first = self._begun()
        at_low = np.array([low])
        self._first *= self._height(at_low) / self._from_first(at_low)
        approach = float(self._first.sum())
        # the approach of smaller punches, for unit load, is that of the layer and that of the body
        radii, layer = np.exp(-self._behind), first.scene.normal_compliance / math.pi
        soft = (first.approach - layer) * radii + layer
        load = math.exp(low) * float((radii**2 / soft * self._first).sum())
        self._panels: list[_Span] = []
        #: load and approach at the ends of the panels, and where they begin
        self._ends = [(load, approach)]
        #: what was looked at last, and its end
        self._looked: _Span | None = None
        self._end = load, approach

    def on(self, stretch: RadiusStretch, flats: tuple[Solution, ...]) -> Weights:
        """Return the weights of a panel."""
        at_break = bool(np.abs(self._breaks - stretch.low).min(initial=1.0) < _NEXT)
        around = [self._surface(one) for one in flats]
        panel = _Span(stretch, np.zeros(stretch.count), around, at_break)
        points, weights = self._both if panel.at_break else self._graded
        depth = stretch.depth(_radau(math.ceil(_PLACES * stretch.count)))[:, None]
        log_radii = stretch.log_radius(depth)
        places = depth * (1.0 - points)
        ahead = -stretch.ahead(depth, -depth * points)
        shares = panel.shares(places)
        growth = weights * panel.kernel(shares, ahead) * self._sinking(log_radii - ahead)
        matrix = depth * np.einsum("rn,rnk->rk", growth / stretch.bends(places), shares)
        radii = log_radii[:, 0]
        right = self._height(radii) - self._from_first(radii)
        for earlier in self._panels:
            right -= self._from_panel(earlier, radii)
        rates = np.linalg.lstsq(matrix, right, rcond=None)[0]
        self._looked = replace(panel, rates=rates, places={})
        return self._weights(self._looked, flats)

    def _surface(self, flat: Solution) -> LogSeries:
        """Return the surface around a punch; on a smooth one all are the same."""
        if flat is not self._last[0]:
            self._last = flat, outside_displacement(flat)
        return self._last[1]

    def _weights(self, panel: _Span, flats: tuple[Solution, ...]) -> Weights:
        """Return load and approach at the nodes, by integrals from the beginning of the panel."""
        stretch = panel.stretch
        extent = stretch.depth_of(np.append(stretch.logs, stretch.high))[:, None]
        points, weights = self._graded if panel.at_break else self._smooth
        depth = (extent * points).ravel()
        u, shares = stretch.log_radius(depth), panel.shares(depth)
        growth = (shares @ panel.rates) * self._sinking(u) / stretch.bends(depth)
        # where a layer is thick for small radii, b delta* is smooth, and delta* is not
        softness = np.exp(stretch.logs) * np.array([one.approach for one in flats])
        stiffness = np.exp(2.0 * u) / (shares @ softness)
        sizes, (load, approach) = extent * weights, self._ends[-1]
        approaches = approach + (growth.reshape(len(extent), -1) * sizes).sum(axis=1)
        loads = load + ((growth * stiffness).reshape(len(extent), -1) * sizes).sum(axis=1)
        self._end = float(loads[-1]), float(approaches[-1])
        grown = [
            np.diff(one, prepend=begun) for one, begun in ((loads, load), (approaches, approach))
        ]
        if not np.min(grown) > 0.0:
            told = f"at the contact radius {math.exp(stretch.high):.6g} the load would not grow"
            raise NotComputedError("load", told)
        # fields next to the edge know a short panel by the root of what it adds
        added = 1.0 - min(load / self._end[0], approach / self._end[1])
        error = left_out(panel.rates) / float(np.abs(panel.rates).max())
        error *= math.sqrt(max(added, 0.0))
        return Weights(loads[:-1], approaches[:-1], error)

    def keep(self) -> None:
        """Take the panel that was looked at last as part of the history."""
        assert self._looked is not None
        self._panels.append(self._looked)
        self._ends.append(self._end)

    def back(self, count: int) -> None:
        """Forget all panels but the first ones."""
        del self._panels[count:], self._ends[count + 1 :]

    def _from_first(self, log_radii: Array) -> Array:
        """Return what the self-similar beginning adds to the height at radii (n,)."""
        ahead = log_radii[:, None] - self._low + self._behind
        omega = reached(self._around, ahead.ravel())[0].reshape(ahead.shape)
        return np.asarray((1.0 - omega) @ self._first)

    def _from_panel(self, panel: _Span, log_radii: Array) -> Array:
        """Return what a panel of the history adds to the height at radii (n,)."""
        beyond = log_radii - panel.stretch.high
        far = (beyond > _FAR) & (not panel.at_break)
        added = np.empty(len(beyond))
        for is_far in (False, True):
            rows = far == is_far
            if rows.any():
                behind, shares, growth = self._places_of(panel, is_far)
                added[rows] = panel.kernel(shares, beyond[rows, None] + behind) @ growth
        return added

    def _places_of(self, panel: _Span, far: bool) -> _PanelPlaces:
        """Return the places of a panel for radii near or far away, made once."""
        if far not in panel.places:
            stretch = panel.stretch
            points, weights = self._smooth if far else self._graded
            if panel.at_break:
                points, weights = self._both
            extent = stretch.extent
            depth = extent * (1.0 - points)
            behind = -stretch.ahead(np.array(extent), -extent * points)
            shares = panel.shares(depth)
            growth = (shares @ panel.rates) * self._sinking(stretch.high - behind)
            growth *= extent * weights / stretch.bends(depth)
            panel.places[far] = _PanelPlaces(behind, shares, growth)
        return panel.places[far]

    def _height(self, log_radii: Array) -> Array:
        return self.profile._height(np.exp(log_radii))

    def _begun(self) -> tuple[Array, Array]:
        """Return how far back places before the panels are, and how ``H`` grows there."""
        if self._flat_part:
            points, weights = self._both
            extent = self._low - self._breaks[0]
            behind, weights = extent * points, extent * weights
        else:
            points, weights = self._graded
            behind, weights = -np.log1p(-points), weights / (1.0 - points)
        return behind, weights * self._sinking(self._low - behind)

    def _sinking(self, u: Array) -> Array:
        """Return ``dH/du`` at logarithms of radii, of any shape."""
        u, shape = u.ravel(), u.shape
        b, last = np.exp(u), np.searchsorted(self._breaks, u, side="right") - 1
        past = np.zeros(len(u))
        if len(self._breaks):
            at = self._breaks[np.maximum(last, 0)]
            past = np.where(last >= 0, np.exp(2.0 * at) * np.expm1(2.0 * (u - at)), 0.0)
        return np.asarray(b * self.profile._rate(b, past)).reshape(shape)


#: Where loads come from, panel by panel from the first touch on.
Weight = NormalWeight | SmoothWeight | CoupledWeight


@cache
def _radau(count: int) -> Array:
    """Return the Radau points with the upper end."""
    return np.append(roots_jacobi(count - 1, 1.0, 0.0)[0], 1.0)
