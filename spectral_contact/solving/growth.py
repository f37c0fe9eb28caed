r"""The history of a contact that grows under friction: its panels, and what they add up to.

While the load grows by ``dP``, pressure and traction grow by those of a flat punch that has the
present contact radius ``b`` (docs/theory, Contacts that grow). So they are sums over the history,
with the dimensionless solution of the flat punch, marked by a star,

    q(r) = int q*(r/b; alpha/b, beta/b, f) dP/b^2,      Q = int Q* dP,      c(b) = b c*  (G.2, G.4)

Flat punches are solved at the nodes of a few panels in ``b`` and interpolated between; the load at
the nodes is from the module `weights`. This holds if slip, where there is any, reaches from the
stick radius ``c`` to the edge, and ``c`` does not fall. Both are checked at all nodes.

``u = ln b``, ``v`` is the coordinate of interpolation (G.10), and the place ``t`` is a linear
function of ``v``, from -1 to 1 on a panel. *Today* is the end of the history. The onset is the
contact radius at which slip begins.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from scipy.optimize import brentq

from spectral_contact.errors import NotComputedError
from spectral_contact.fields import Array
from spectral_contact.solving.growth_panel import Panel, PowerCurve
from spectral_contact.solving.stretch import RadiusStretch, chebyshev_value
from spectral_contact.solving.weights import LoadSource, PanelLoads
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

#: Takes a contact radius, and returns the solution of the flat punch of this radius.
FlatSolver: TypeAlias = "Callable[[float], Solution]"

#: The largest extent of a panel in ``v``.
_LARGEST_EXTENT = 4.5
#: A panel of n nodes has the error ``factor * exp(-gamma n)`` with ``gamma`` of (G.11). This is the
#: measured factor of a panel from the first touch on.
_ERROR_FACTOR = 3000.0
#: The same beyond the onset of slip or a break of the profile other than the first one, which may
#: be the end of a flat part. It is smaller, because little changes on the first part of a panel
#: that begins there.
_ERROR_FACTOR_PAST = 100.0
#: Least number of nodes of a panel, for `interpolation_error` and the interpolation of fields.
_LEAST_COUNT = 6
#: Distance of ``b_0`` below the onset of slip, relative to the onset, for tolerances up to
#: `_ONSET_TOLERANCE`; for looser ones it is multiplied by
#: ``(tolerance / _ONSET_TOLERANCE)**_ONSET_POWER``.
_ONSET_DISTANCE = 1e-3
_ONSET_TOLERANCE = 1e-10
_ONSET_POWER = 0.2
#: Length of panels next to a radius at which the profile ends and the load has a pole, over their
#: distance from it, both in ``u``.
_LENGTH_NEAR_POLE = 2.0
#: Largest error of one panel over the tolerance of the history, which has a few panels.
_PANEL_FRACTION = 0.1
#: Panels of a smaller extent in ``v`` are not halved.
_LEAST_EXTENT = 1e-4
#: If a history is cut off less than this above the lower end of a panel, in ``u``, there is no such
#: short panel: the one before it is lengthened.
_SAME_END = 1e-12
#: Largest relative fall of the stick radius from node to node that is taken for an error. If the
#: estimates of its errors are larger, they are the limit.
_ALLOWED_FALL = 1e-8
#: Errors of load and approach over those of the flat punches: the Volterra equation amplifies them.
_FLAT_ERROR_FACTOR = 3.0
#: The place of the upper end of a panel; that of the lower end is its negative.
_TOP = np.ones(1)
#: Tolerance of a place.
_PLACE_ROUNDING = 1e-15
#: A history from the end of a flat part on gets one panel before its first: it has this length in
#: ``u``, and ``ln P`` grows by so much on it, from next to no load.
_FLAT_PART_LENGTH = 1e-10
_FLAT_PART_LOG_LOAD = 6.0
#: Two radii closer than this in ``u`` are one, where the end of a flat part, a break or the onset
#: is compared with the end of a panel.
_SAME_RADIUS = 1e-9
#: Error of the fields at the centre over what the first part of the history, which is left out,
#: would add there. Series of fields are fitted to rings around the centre, which amplifies it.
_CENTRE_FACTOR = 10.0
#: Rounding of the total shear; it is the largest past the corner of a rounded flat.
_SHEAR_ROUNDING = 5e-13
#: Number of nodes of the panel before the first one.
_COUNT_BEFORE = 10
#: Near the centre ``q/r`` is in proportion to the integral of ``dP/b**3``. If ``P`` begins with a
#: power of ``b`` above 3, this is bounded, and no panel is needed before the first one. The rest is
#: for the error of the power, which is a slope at the first radius.
_BOUNDED_POWER = 3.1
#: Length in ``u`` of the panel before the first one if the power m of the load is 2.5 or less;
#: above, it is ``20/(m - 2)``, on which ``b**(m - 2)`` grows by a factor of ``exp(20)``.
_LENGTH_BEFORE = 40.0
#: Error of the power of the load in the comparison with 2.
_POWER_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Growth:
    """The history of a contact.

    Attributes
    ----------
    panels : tuple of Panel
        They follow each other from a radius at which the load is negligible to today's.
    onset : float or None
        Radius at which slip begins; 0 if there is slip from the first touch, None if there is none.
    breaks : tuple of float
        Radii at which a derivative of the profile jumps, the end of a flat part among them.
    """

    panels: tuple[Panel, ...]
    onset: float | None
    breaks: tuple[float, ...] = ()

    @property
    def log_radius(self) -> float:
        """Logarithm of today's contact radius."""
        return self.panels[-1].high

    def in_contact_radii(self) -> Growth:
        """Return the history with radii over today's contact radius; the loads are the same.

        The logarithm of today's radius is 0 then, so that those of radii next to the edge keep
        their digits.
        """
        u_today = self.log_radius
        radius = math.exp(u_today)
        panels = tuple(
            replace(
                panel,
                stretch=replace(panel.stretch, low=panel.low - u_today, high=panel.high - u_today),
            )
            for panel in self.panels
        )
        # from the first touch on (0), and no slip (None), stay what they are
        onset = self.onset and self.onset / radius
        return Growth(panels, onset, tuple(b / radius for b in self.breaks))

    @cached_property
    def load(self) -> float:
        """Load today."""
        return float(self.panels[-1].load(_TOP)[0])

    @cached_property
    def approach(self) -> float:
        """Approach today."""
        return math.exp(float(self.panels[-1].approaches.at(_TOP)[0]))

    @cached_property
    def work(self) -> float:
        """Work of the load, ``int P ddelta``."""

        def rates(panel: Panel) -> Callable[[Array], Array]:
            approaches = panel.approaches
            return lambda t: panel.load(t) * np.exp(approaches.at(t)) * approaches.rate(t)

        # the work before the first panel is negligible
        return sum(one.integral(rates(one)) for one in self.panels)

    @cached_property
    def total_shear(self) -> float:
        """Total shear today, ``Q = int Q* dP``."""

        def rates(panel: Panel) -> Callable[[Array], Array]:
            return lambda t: chebyshev_value(panel.shears, t) * panel.dload_dv(t)

        return self.first_shear + sum(one.integral(rates(one)) for one in self.panels)

    @property
    def first_shear(self) -> float:
        """Total shear where the first panel begins, before which Q* is taken for constant."""
        first = self.panels[0]
        return float((chebyshev_value(first.shears, -_TOP) * first.load(-_TOP))[0])

    @cached_property
    def load_error(self) -> float:
        """Estimate of the relative error of load and approach today, with coupling."""
        panels = sum(one.shear_error * self._contribution(one) for one in self.panels)
        beginning = math.exp(float(self.panels[0].approaches.at(-_TOP)[0])) / self.approach
        flats = _FLAT_ERROR_FACTOR * self._flat_error("pressure", "approach", power=0.0)
        return panels + beginning + flats

    @cached_property
    def shear_error(self) -> float:
        """Estimate of the relative error of the total shear today."""
        panels = sum(one.shear_error * self._contribution(one) for one in self.panels)
        flats = self._flat_error("total_shear", "approach", power=0.0)
        return panels + 2.0 * flats + _SHEAR_ROUNDING

    @cached_property
    def stick_rate(self) -> float:
        """``dln c*/dln b`` today, without its sign."""
        last = self.panels[-1]
        # a curve of c*, of which `stick` is the logarithm
        stick_curve = PowerCurve(last.stretch, np.exp(last.stick), 0.0)
        return abs(last.rate_today(stick_curve)) if last.slips else 0.0

    @cached_property
    def load_rate(self) -> float:
        """``dln P/dln b`` today."""
        return self.panels[-1].rate_today(self.panels[-1].loads)

    @cached_property
    def approach_rate(self) -> float:
        """``dln delta/dln b`` today."""
        return self.panels[-1].rate_today(self.panels[-1].approaches)

    def radius_error(self, name: str, value: float) -> float:
        """Return the relative error of today's radius if load or approach is given (G.14).

        Parameters
        ----------
        name : str
            What is given, "loads" or "approaches".
        value : float
            Its value.
        """
        by_load = name == "loads"
        reached, rate = (
            (self.load, self.load_rate) if by_load else (self.approach, self.approach_rate)
        )
        return (self.load_error + abs(reached / value - 1.0)) / rate

    @cached_property
    def shear_rate(self) -> float:
        """``dln Q/dln b`` today."""
        rate = self.load_rate * self.load * float(chebyshev_value(self.panels[-1].shears, _TOP)[0])
        return abs(rate / self.total_shear) if self.total_shear else 0.0

    @cached_property
    def error(self) -> float:
        """Estimate of the error of the traction today, relative to its largest value."""
        panels = sum(
            (one.error + one.series_error) * self._contribution(one) for one in self.panels
        )
        flats = self._flat_error("traction", "pressure", power=-2.0)
        return panels + 2.0 * flats + self.beginning_error

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of the slip today, a length."""
        return sum(one.slip_error for one in self.panels)

    @cached_property
    def logarithm_at_centre(self) -> bool:
        """Whether the pressure is logarithmic at the centre: under a cone, where ``P ~ b**2``.

        Then every decade of ``b`` adds the same to ``int dP/b**2``, the pressure at the centre.
        """
        return abs(self._load_power - 2.0) < _POWER_TOLERANCE and not self._starts_at_flat_part

    @property
    def _load_power(self) -> float:
        """``dln P/dln b`` where the history begins."""
        first = self.panels[0]
        return float(first.loads.rate(-_TOP)[0] * first.stretch.low_dv_du)

    @property
    def _starts_at_flat_part(self) -> bool:
        """Whether the history begins at the end of a flat part."""
        low = self.panels[0].low
        return bool(self.breaks) and abs(math.log(self.breaks[0]) - low) < _SAME_RADIUS

    @cached_property
    def beginning_error(self) -> float:
        """Error of the fields at the centre by what is before `all_panels`, over the mean pressure.

        A logarithm has none, as the fields continue it to the centre.
        """
        if self.logarithm_at_centre:
            return 0.0
        first = self.all_panels[0]
        fraction = float(first.load(-_TOP)[0]) / self.load
        return _CENTRE_FACTOR * fraction * math.exp(2.0 * (self.log_radius - first.low))

    @cached_property
    def all_panels(self) -> tuple[Panel, ...]:
        """The panels, and before them one more if the first load counts in the fields.

        On this panel load and approach are powers of the radius, with the slopes of the first panel
        at its lower end or, next to a flat part, a steep one. All flat punches are like the first.
        """
        first = self.panels[0]
        has_flat_part = self._starts_at_flat_part
        if self._load_power > _BOUNDED_POWER and not has_flat_part:
            return self.panels
        # at the centre the pressure of smaller radii is in proportion to b**(power - 2)
        length = _LENGTH_BEFORE / max(1.0, 2.0 * (self._load_power - 2.0))
        slope = 0.0
        if has_flat_part:
            length = _FLAT_PART_LENGTH
            slope = _FLAT_PART_LOG_LOAD / length
        stretch = RadiusStretch(first.low - length, first.low, count=_COUNT_BEFORE)
        values = [
            np.exp(
                float(curve.at(-_TOP)[0])
                + (slope or float(curve.rate(-_TOP)[0] * first.stretch.low_dv_du))
                * (stretch.u_nodes - first.low)
            )
            for curve in (first.loads, first.approaches)
        ]
        flats = (first.flats[0],) * _COUNT_BEFORE
        before = Panel(stretch, PanelLoads(values[0], values[1]), flats, first.fields, first.powers)
        return (before, *self.panels)

    def _contribution(self, panel: Panel) -> float:
        return _contribution(panel, self.log_radius, self.load)

    def _flat_error(self, *names: str, power: float) -> float:
        """Return the mean error of the flat punches over the history, with weight ``b**power dP``.

        The error of a panel is the largest one of its flat punches in the quantities `names`. A
        quantity that is exact has the error None.
        """

        def weights(panel: Panel) -> Callable[[Array], Array]:
            stretch = panel.stretch
            return lambda t: panel.dload_dv(t) * np.exp(power * stretch.u_at(t))

        panel_weights = [one.integral(weights(one)) for one in self.panels]
        panel_errors = [
            max(getattr(one.error, name) or 0.0 for one in panel.flats for name in names)
            for panel in self.panels
        ]
        return float(np.dot(panel_weights, panel_errors)) / math.fsum(panel_weights)

    @cached_property
    def stick_radii(self) -> list[tuple[float, float]]:
        """Pairs of contact radius ``b`` and stick radius ``c(b)`` at all nodes, in this order."""
        return [
            (b := math.exp(u), b * math.exp(stick))
            for one in self.panels
            for u, stick in zip(one.stretch.u_nodes.tolist(), one.stick.tolist(), strict=True)
        ]

    def log_stick(self, log_radius: float) -> list[float]:
        """Return ``ln c*`` at the logarithm of a contact radius; nothing if there was no slip."""
        panels = [one for one in self.panels if one.slips and one.high >= log_radius]
        if not panels or panels[0].low > log_radius + _SAME_RADIUS:
            return []
        place = panels[0].stretch.place_of(np.array([log_radius]))
        return [float(panels[0].log_stick(place)[0])]

    def radius_of(self, name: str, value: float) -> float | None:
        """Return ``u`` where the "loads" or the "approaches" had a positive value.

        None if they have not reached it; the beginning of the history if they were above it there.
        """
        log_value = math.log(value)
        for panel in self.panels:
            curve: PowerCurve = getattr(panel, name)

            def log_excess(t: float, curve: PowerCurve = curve) -> float:
                return float(curve.at(np.array([t]))[0]) - log_value

            if log_excess(1.0) >= 0.0:
                t = -1.0
                if log_excess(t) < 0.0:
                    t = float(brentq(log_excess, t, 1.0, xtol=_PLACE_ROUNDING))
                return float(panel.stretch.u_at(np.array([t]))[0])
        return None


def _contribution(panel: Panel, log_radius: float, load: float) -> float:
    """Return the factor in (G.13) of the error of a panel.

    It is the load at the end of the panel over today's load or, if that is larger, the ratio of
    the mean pressures: the load at the end of the panel is on a smaller disk.
    """
    fraction = float(panel.load(_TOP)[0]) / load
    return fraction * max(1.0, math.exp(2.0 * (log_radius - panel.high)))


@dataclass(frozen=True)
class Grower:
    """Builds the history of a contact, panel by panel.

    Attributes
    ----------
    flat : callable
        Takes a contact radius, and returns the solution of the flat punch of this radius.
    load_source : LoadSource
        Returns load and approach at the nodes of a panel.
    onset : float or None
        As of `Growth`.
    fields : tuple of str
        Names of the fields that are superposed.
    tolerance : float
        Of the fields, relative to their largest values.
    breaks : tuple of float
        As of `Growth`.
    break_distance : float
        Distance of the origin ``b_0`` of ``v`` (G.10) below a break, relative to the break. At the
        end of a flat part ``b_0`` is this end.
    origin_distance : float
        Distance of the origin ``b_0`` of ``v`` below 0, from the first touch on.
    powers : tuple of float
        As of `Panel`.
    log_pole : float
        Logarithm of the radius at which the profile is vertical and the load has a pole; infinity
        if there is none.
    """

    flat: FlatSolver
    load_source: LoadSource
    onset: float | None
    fields: tuple[str, ...]
    tolerance: float
    breaks: tuple[float, ...]
    break_distance: float
    origin_distance: float
    powers: tuple[float, float]
    log_pole: float

    def grown(self, first_radius: float, radius: float, load: float) -> Growth:
        """Return the history.

        Parameters
        ----------
        first_radius : float
            Contact radius at which it begins, with a negligible load.
        radius : float
            Contact radius today.
        load : float
            Load today. Errors are compared with it, so that an approximate value is enough.

        Raises
        ------
        NotComputedError
            If slip does not reach the edge, or if the stick radius falls.
        """
        log_radius = math.log(radius)
        todo = self._stretches(math.log(first_radius), log_radius)[::-1]
        panels = []
        while todo:
            stretch = self._counted(todo.pop(), log_radius)
            panel = self._panel(stretch)
            error = panel.error * _contribution(panel, log_radius, load)
            can_improve = stretch.extent > _LEAST_EXTENT and panel.error > self.load_source.rounding
            if error > _PANEL_FRACTION * self.tolerance and can_improve:
                todo += stretch.cut(2)[::-1]
            else:
                self.load_source.keep()
                panels.append(panel)
        growth = Growth(tuple(panels), self.onset, self.breaks)
        check_stick_radii(growth)
        return growth

    def until(self, growth: Growth, log_radius: float) -> Growth:
        """Return a history that ends earlier, at the logarithm of a contact radius.

        The source of loads forgets what is later, so that `growth` must not be passed again.
        """
        kept = [one for one in growth.panels if one.high < log_radius - _SAME_END]
        stretch = growth.panels[len(kept)].stretch
        self.load_source.cut_back(len(kept))
        last = self._panel(replace(stretch, high=log_radius))
        self.load_source.keep()
        return Growth((*kept, last), self.onset, self.breaks)

    def _stretches(self, low: float, high: float) -> list[RadiusStretch]:
        """Return the stretches between two ``u`` before any is halved, without their nodes.

        A new one begins at every break and at the onset of slip.
        """
        # dv/du at the lower ends of stretches, by their u
        dv_du = {math.log(b): 1.0 / self.break_distance for b in self.breaks}
        if self.onset:
            wider = max(self.tolerance / _ONSET_TOLERANCE, 1.0) ** _ONSET_POWER
            dv_du[math.log(self.onset)] = 1.0 / (_ONSET_DISTANCE * wider)
        dv_du = {u: value for u, value in dv_du.items() if low < u < high}
        dv_du[low] = 1.0 / (1.0 + self.origin_distance * math.exp(-low))
        # at the end of a flat part b_0 is this end: 1/(1 - b_0/b)
        if self.breaks and abs(low - math.log(self.breaks[0])) < _SAME_RADIUS:
            dv_du[low] = -1.0 / math.expm1(math.log(self.breaks[0]) - low)
        stretches: list[RadiusStretch] = []
        for start, stop in pairwise(sorted([*dv_du, high])):
            stretch = RadiusStretch(start, stop, dv_du[start])
            stretches += stretch.cut(math.ceil(stretch.extent / _LARGEST_EXTENT))
        return [piece for stretch in stretches for piece in self._shorter_near_pole(stretch)]

    def _shorter_near_pole(self, stretch: RadiusStretch) -> list[RadiusStretch]:
        """Return the pieces of a stretch, the shorter the closer they are to a pole of the load."""
        # upper ends of the pieces, in u, from that of the last piece down
        highs = [stretch.high]
        while (cut := highs[-1] - _LENGTH_NEAR_POLE * (self.log_pole - highs[-1])) > stretch.low:
            highs.append(cut)
        return stretch.cut_at(stretch.depth_of(np.array([stretch.low, *highs[:0:-1]])))

    def _counted(self, stretch: RadiusStretch, log_radius: float) -> RadiusStretch:
        """Return a stretch with as many nodes as the tolerance asks for, by (G.11).

        `log_radius` is that of today's contact radius.
        """
        # The error of a panel counts by the factor in (G.13), which falls towards the first touch
        # like b**(m - 2) if P is like b**m. So earlier panels may have larger errors; no more than
        # one power of b is made use of. At a flat part, where `powers` is 0, the load falls faster
        # than any power of b. There the power 1 was chosen, and if it allows a panel too large an
        # error, the panel is halved.
        power = min(max(self.powers[0] - 2.0, 0.0), 1.0) if self.powers[0] else 1.0
        allowed = _PANEL_FRACTION * self.tolerance * math.exp(power * (log_radius - stretch.high))
        depth_of_pole = stretch.depth_of(np.array([self.log_pole]))[0]
        to_pole = 2.0 * (float(depth_of_pole) / stretch.extent - 1.0)
        gamma = min(math.asinh(2.0 * math.pi / stretch.extent), math.acosh(1.0 + to_pole))
        events = (self.onset, *self.breaks[1:])
        past = any(math.log(b) < stretch.low + _SAME_RADIUS for b in events if b)
        log_factor = math.log((_ERROR_FACTOR_PAST if past else _ERROR_FACTOR) / allowed)
        return replace(stretch, count=max(math.ceil(log_factor / gamma), _LEAST_COUNT))

    def _panel(self, stretch: RadiusStretch) -> Panel:
        """Return the panel of a stretch, after checking that (G.2) holds at its nodes."""
        radii = np.exp(stretch.u_nodes).tolist()
        solutions = {}
        # First some radii far apart, then those between them, so that the search for a stick radius
        # starts from known ones on both sides: node 0, then the others by the largest power of 2
        # that divides their number, ``k & -k``.
        for k in sorted(range(len(radii)), key=lambda k: -(k & -k) if k else -len(radii)):
            b = radii[k]
            solutions[k] = self.flat(b)
            kinds = [zone.kind for zone in solutions[k].zones]
            if kinds not in (["stick"], ["stick", "slip"]):
                reason = (
                    "slip does not reach the edge in one zone, and the load would have to be "
                    "followed in increments"
                )
                if kinds[0] == "slip":
                    reason = "the stick disk is too small to be followed"
                raise NotComputedError("traction", f"at the contact radius {b:.6g} {reason}")
        flats = tuple(solutions[k] for k in range(len(radii)))
        return Panel(
            stretch, self.load_source.loads_on(stretch, flats), flats, self.fields, self.powers
        )


def check_stick_radii(growth: Growth) -> None:
    """Raise if the stick radius falls by more than its errors: points that stuck would slip."""
    errors = [one.error.stick_radius or 0.0 for panel in growth.panels for one in panel.flats]
    stick_radii = zip(growth.stick_radii, errors, strict=True)
    for ((_, before), error_before), ((b, after), error_after) in pairwise(stick_radii):
        if after < before * (1.0 - max(_ALLOWED_FALL, error_before + error_after)):
            event = f"the stick radius falls at the contact radius {b:.6g}"
            raise NotComputedError("traction", f"{event}: points that stuck would slip again")
