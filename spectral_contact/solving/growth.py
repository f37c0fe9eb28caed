r"""Friction under a growing contact, by superposition of flat punches over the contact radius.

While the load grows the rates of pressure and traction are those of a flat punch of the radius
``b`` (docs: profiles). So with flat solutions on panels, interpolated between Chebyshev points
(`stretch`), and with the load that `weights` knows,

    q(r) = int q*(r/b; alpha/b, beta/b, f) dP/b^2,      Q = int Q* dP,      c(b) = b c*.

It holds as long as slip reaches the edge and ``c`` does not fall, which is checked at every radius.
Below the radius where slip begins everything sticks; points are dense next to it. In a panel ``u =
ln b``, ``x`` is the coordinate of its stretch, and t in [-1, 1] the place.
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
from spectral_contact.solving.weights import Weight, Weights
from spectral_contact.threads import cached_property

if TYPE_CHECKING:
    from spectral_contact.solution import Solution

#: Of a contact radius: the solution of a flat punch.
Stage: TypeAlias = "Callable[[float], Solution]"

#: The largest extent of a panel in ``x``, and the factors of ``exp(-n gained)``, which a panel of n
#: points leaves out (`Grower._counted`), as measured: from the first touch on, and past the onset
#: of slip or a break, where little changes at first.
_WIDEST, _LEAVES, _LEAVES_PAST = 4.5, 3000.0, 100.0
#: As functions of ``b`` flat solutions have poles at negative radii, no closer to 0 than so many
#: times the least compliance: those of full stick at 2.2 or beyond.
_POLES = 2.0
#: The least points of a panel: those that the estimate of what is left out takes.
_FEWEST = 6
#: How far past the onset of slip points are dense, relative, at the tightest tolerance, and how it
#: grows with it.
_AT_ONSET, _TIGHTEST, _POWER = 1e-3, 1e-10, 0.2
#: How long panels are next to the end of a profile, in their distance from it.
_BESIDE = 2.0
#: What panels may leave out, of the tolerance, as there are a few; they are not halved below.
_MARGIN, _SHORTEST = 0.1, 1e-4
#: A history that ends by less than this past a panel, in ``u``, ends with it.
_SAME = 1e-12
#: By how much a stick radius may fall, relative, beside what its errors make of it.
_FALL = 1e-8
#: By how much more than their own errors those of the flat punches count in load and approach,
#: which the Volterra equation amplifies.
_OF_FLATS = 3.0
#: The place t of the upper end of a panel (its negative is the lower one), and its rounding.
_END, _ROUNDING = np.ones(1), 1e-15
#: Before a history that begins at a flat part goes a panel of this length in ``u``, in which
#: ``ln P`` grows by so much. A radius is at the end of the flat part, or at a break, if it is
#: closer in ``u`` than the last number.
_FARTHER_BACK, _CORNER, _NEXT = 1e-10, 6.0, 1e-9
#: Error of the fields at the centre over what is missing there, before the history begins: their
#: series are interpolated from rings around it.
_RINGS = 10.0
#: Rounding of the shear: 5e-13 past the corner of a rounded flat.
_SUMMED = 5e-13
#: Points of the panel before the first one.
_BEFORE = 10
#: Slopes of ``ln P`` below which the history goes on for so much in ``u`` to the centre; how close
#: to that of a tip it is one.
_STEEP, _FARTHER, _LIKE_A_TIP = 3.1, 40.0, 1e-6


@dataclass(frozen=True)
class Growth:
    """The history of a contact.

    Attributes
    ----------
    panels : tuple of Panel
        From where the load is negligible to today.
    onset : float or None
        Radius at which slip begins; 0 if there is slip from the first touch, None if there is none.
    breaks : tuple of float
        Of the profile.
    """

    panels: tuple[Panel, ...]
    onset: float | None
    breaks: tuple[float, ...] = ()

    @property
    def log_radius(self) -> float:
        """Logarithm of today's contact radius."""
        return self.panels[-1].high

    @cached_property
    def load(self) -> float:
        """Load today."""
        return float(self.panels[-1].load(_END)[0])

    @cached_property
    def approach(self) -> float:
        """Approach today."""
        return math.exp(float(self.panels[-1].approaches.at(_END)[0]))

    @cached_property
    def work(self) -> float:
        """``int P ddelta``."""

        def rates(panel: Panel) -> Callable[[Array], Array]:
            sunk = panel.approaches
            return lambda t: panel.load(t) * np.exp(sunk.at(t)) * sunk.rate(t)

        # before the first panel there is next to none
        return sum(one.integral(rates(one)) for one in self.panels)

    @cached_property
    def total_shear(self) -> float:
        """``Q = int Q* dP``."""

        def rates(panel: Panel) -> Callable[[Array], Array]:
            return lambda t: chebyshev_value(panel.shears, t) * panel.increment(t)

        first = self.panels[0]
        # before the first panel there is next to no load
        begun = first.flats[0].total_shear * float(first.load(-_END)[0])
        return begun + sum(one.integral(rates(one)) for one in self.panels)

    @cached_property
    def weight_error(self) -> float:
        """Estimate of the relative error of load and approach, as the panels leave it."""
        panels = sum(one.shear_error * self._share(one) for one in self.panels)
        begun = math.exp(float(self.panels[0].approaches.at(-_END)[0])) / self.approach
        flats = _OF_FLATS * self._of_flats("pressure", "approach", power=0.0)
        return panels + begun + flats

    @cached_property
    def shear_error(self) -> float:
        """Estimate of the relative error of the shear."""
        panels = sum(one.shear_error * self._share(one) for one in self.panels)
        return panels + 2.0 * self._of_flats("total_shear", "approach", power=0.0) + _SUMMED

    @cached_property
    def stick_rate(self) -> float:
        """``dln c*/dln b`` today."""
        last = self.panels[-1]
        sticks = PowerCurve(last.stretch, np.exp(last.stick), 0.0)
        return abs(last.rate_today(sticks)) if last.slips else 0.0

    @cached_property
    def load_rate(self) -> float:
        """``dln P/dln b`` today."""
        return self.panels[-1].rate_today(self.panels[-1].loads)

    @cached_property
    def approach_rate(self) -> float:
        """``dln delta/dln b`` today."""
        return self.panels[-1].rate_today(self.panels[-1].approaches)

    def moved(self, name: str, value: float) -> float:
        """Return the relative error of today's radius, where load or approach has a value."""
        by_load = name == "loads"
        found, rate = (
            (self.load, self.load_rate) if by_load else (self.approach, self.approach_rate)
        )
        return (self.weight_error + abs(found / value - 1.0)) / rate

    @cached_property
    def shear_rate(self) -> float:
        """``dln Q/dln b`` today."""
        rate = self.load_rate * self.load * float(self.panels[-1].shears[-1])
        return abs(rate / self.total_shear) if self.total_shear else 0.0

    @cached_property
    def error(self) -> float:
        """Estimate of the error of the traction, relative to its largest value."""
        panels = sum((one.error + one.lost) * self._share(one) for one in self.panels)
        flats = self._of_flats("traction", "pressure", power=-2.0)
        return panels + 2.0 * flats + self.begun

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of the slip, in its own unit."""
        return sum(one.slip_error for one in self.panels)

    @cached_property
    def log_beginning(self) -> bool:
        """Whether all decades of the beginning count alike at the centre: under a cone, P ~ b^2."""
        return abs(self._rise - 2.0) < _LIKE_A_TIP and not self._corner

    @property
    def _rise(self) -> float:
        """``dln P/dln b`` at the beginning."""
        first = self.panels[0]
        return float(first.loads.rate(-_END)[0] * first.stretch.bend)

    @property
    def _corner(self) -> bool:
        """Whether the history begins at the end of a flat part."""
        low = self.panels[0].low
        return bool(self.breaks) and abs(math.log(self.breaks[0]) - low) < _NEXT

    @cached_property
    def begun(self) -> float:
        """Error of fields at the centre by what was before `all_panels`, over the mean pressure."""
        if self.log_beginning:
            return 0.0
        first = self.all_panels[0]
        share = float(first.load(-_END)[0]) / self.load
        return _RINGS * share * math.exp(2.0 * (self.log_radius - first.low))

    @cached_property
    def all_panels(self) -> tuple[Panel, ...]:
        """The panels, after one that goes on to the centre as they begin, where that counts."""
        first, corner = self.panels[0], self._corner
        if self._rise > _STEEP and not corner:
            return self.panels
        # what is missing falls with the power of the radius that is above 2
        farther = _FARTHER / max(1.0, 2.0 * (self._rise - 2.0))
        # a flat part has its first load before it grows at all
        rise, farther = (_CORNER / _FARTHER_BACK, _FARTHER_BACK) if corner else (0.0, farther)
        back = RadiusStretch(first.low - farther, first.low, count=_BEFORE)
        weights = [
            np.exp(
                float(curve.at(-_END)[0])
                + (rise or float(curve.rate(-_END)[0] * first.stretch.bend))
                * (back.logs - first.low)
            )
            for curve in (first.loads, first.approaches)
        ]
        flats = (first.flats[0],) * _BEFORE
        begun = Panel(back, Weights(weights[0], weights[1]), flats, first.fields, first.powers)
        return (begun, *self.panels)

    def _share(self, panel: Panel) -> float:
        return _share(panel, self.log_radius, self.load)

    def _of_flats(self, *names: str, power: float) -> float:
        """Return the mean error of the flat punches over the history, weighed with ``b**power dP``.

        An estimate that is None is that of what is exact.
        """

        def weights(panel: Panel) -> Callable[[Array], Array]:
            radii = panel.stretch
            return lambda t: panel.increment(t) * np.exp(power * radii.log_radius_at(t))

        sizes = [one.integral(weights(one)) for one in self.panels]
        worst = [
            max(getattr(one.error, name) or 0.0 for one in panel.flats for name in names)
            for panel in self.panels
        ]
        return float(np.dot(sizes, worst)) / math.fsum(sizes)

    @cached_property
    def stages(self) -> list[tuple[float, float]]:
        """Contact radii ``b`` with the stick radii ``c(b)``."""
        return [
            (b := math.exp(u), b * math.exp(stick))
            for one in self.panels
            for u, stick in zip(one.stretch.logs.tolist(), one.stick.tolist(), strict=True)
        ]

    def log_stick(self, log_radius: float) -> list[float]:
        """Return ``ln c*`` at the logarithm ``u`` of a radius; nothing where there was no slip."""
        panels = [one for one in self.panels if one.slips and one.high >= log_radius]
        if not panels or panels[0].low > log_radius + _NEXT:
            return []
        place = panels[0].stretch.place_of(np.array([log_radius]))
        return [float(panels[0].log_stick(place)[0])]

    def radius_of(self, name: str, value: float) -> float | None:
        """Return ``u`` at which the "loads" or the "approaches" had a value above zero.

        None if it has not been reached; where the history begins if it was less all the time.
        """
        asked = math.log(value)
        for panel in self.panels:
            curve: PowerCurve = getattr(panel, name)

            def off(t: float, curve: PowerCurve = curve) -> float:
                return float(curve.at(np.array([t]))[0]) - asked

            if off(1.0) >= 0.0:
                t = float(brentq(off, -1.0, 1.0, xtol=_ROUNDING)) if off(-1.0) < 0.0 else -1.0
                return float(panel.stretch.log_radius_at(np.array([t]))[0])
        return None


def _share(panel: Panel, log_radius: float, load: float) -> float:
    """Return what a panel contributes to load or traction at most, relative to all of it."""
    share = float(panel.weights.loads[-1]) / load
    return share * max(1.0, math.exp(2.0 * (log_radius - panel.high)))


@dataclass(frozen=True)
class Grower:
    """Builds the history of a contact, panel by panel.

    Attributes
    ----------
    stage : callable
        Returns the solution of a flat punch, of its radius.
    weight : Weight
        Where the loads come from.
    onset : float or None
        As of `Growth`.
    fields : tuple of str
        Those that are superposed.
    tolerance : float
        Panels are halved until what they leave out is less, relative to all.
    breaks : tuple of float
        Of the profile.
    at_break : float
        How far past one that is no end of a flat part points are dense, relative.
    layer : float
        The least compliance, unless there is none: poles are beyond it.
    powers : tuple of float
        As of `Panel`.
    end : float
        Logarithm of the radius at which the profile ends in a pole of its load, or infinite.
    """

    stage: Stage
    weight: Weight
    onset: float | None
    fields: tuple[str, ...]
    tolerance: float
    breaks: tuple[float, ...]
    at_break: float
    layer: float
    powers: tuple[float, float]
    end: float

    def grown(self, least: float, radius: float, load: float) -> Growth:
        """Return the history, if slip reaches the edge and the stick radius does not fall.

        Parameters
        ----------
        least : float
            Where the load is negligible.
        radius, load : float
            Today's; the load is a measure only.
        """
        today = math.log(radius)
        todo, panels = self._stretches(math.log(least), today)[::-1], []
        while todo:
            stretch = self._counted(todo.pop(), today)
            panel = self._panel(stretch)
            off = panel.error * _share(panel, today, load)
            can_improve = stretch.extent > _SHORTEST and panel.error > self.weight.rounding
            if off > _MARGIN * self.tolerance and can_improve:
                todo += stretch.cut(2)[::-1]
            else:
                self.weight.keep()
                panels.append(panel)
        found = Growth(tuple(panels), self.onset, self.breaks)
        check_stick_radii(found)
        return found

    def until(self, growth: Growth, log_radius: float) -> Growth:
        """Return a history that ends earlier, in the panel that contains a radius."""
        kept = [one for one in growth.panels if one.high < log_radius - _SAME]
        cut = growth.panels[len(kept)].stretch
        self.weight.back(len(kept))
        last = self._panel(replace(cut, high=log_radius))
        self.weight.keep()
        return Growth((*kept, last), self.onset, self.breaks)

    def _stretches(self, low: float, high: float) -> list[RadiusStretch]:
        """Return the first panels: where something begins the origin of ``x`` is next to it."""
        bends = {math.log(b): 1.0 / self.at_break for b in self.breaks}
        if self.onset:
            wider = max(self.tolerance / _TIGHTEST, 1.0) ** _POWER
            bends[math.log(self.onset)] = 1.0 / (_AT_ONSET * wider)
        bends = {u: bend for u, bend in bends.items() if low < u < high}
        bends[low] = 1.0 / (1.0 + _POLES * self.layer * math.exp(-low))
        if self.breaks and abs(low - math.log(self.breaks[0])) < _NEXT:
            bends[low] = -1.0 / math.expm1(math.log(self.breaks[0]) - low)
        stretches: list[RadiusStretch] = []
        for start, stop in pairwise(sorted([*bends, high])):
            whole = RadiusStretch(start, stop, bends[start])
            stretches += whole.cut(math.ceil(whole.extent / _WIDEST))
        return [piece for whole in stretches for piece in self._toward_the_end(whole)]

    def _toward_the_end(self, stretch: RadiusStretch) -> list[RadiusStretch]:
        """Return the pieces of a stretch, the shorter the closer to a pole of the load they are."""
        tops = [stretch.high]
        while (cut := tops[-1] - _BESIDE * (self.end - tops[-1])) > stretch.low:
            tops.append(cut)
        return stretch.cut_at(stretch.depth_of(np.array([stretch.low, *tops[:0:-1]])))

    def _counted(self, stretch: RadiusStretch, today: float) -> RadiusStretch:
        """Return a stretch with as many points as leave out little enough."""
        # by how much less than today's an early load counts at the centre, where it counts most
        power = min(max(self.powers[0] - 2.0, 0.0), 1.0) if self.powers[0] else 1.0
        allowed = _MARGIN * self.tolerance * math.exp(power * (today - stretch.high))
        room = 2.0 * (self.end - stretch.high) / stretch.extent
        gained = min(math.asinh(2.0 * math.pi / stretch.extent), math.acosh(1.0 + room))
        past = any(math.log(b) < stretch.low + _NEXT for b in (self.onset, *self.breaks[1:]) if b)
        digits = math.log((_LEAVES_PAST if past else _LEAVES) / allowed)
        return replace(stretch, count=max(math.ceil(digits / gained), _FEWEST))

    def _panel(self, stretch: RadiusStretch) -> Panel:
        radii, found = np.exp(stretch.logs).tolist(), {}
        # first few radii far apart, then those between: stick radii are known on both sides then
        for k in sorted(range(len(radii)), key=lambda k: -(k & -k) if k else -len(radii)):
            b = radii[k]
            found[k] = self.stage(b)
            kinds = [zone.kind for zone in found[k].zones]
            if kinds not in (["stick"], ["stick", "slip"]):
                reason = "slip does not reach the edge in one zone, and the load would have to be "
                reason += "followed in increments"
                if kinds[0] == "slip":
                    reason = "the stick disk is too small to be followed"
                raise NotComputedError("traction", f"at the contact radius {b:.6g} {reason}")
        flats = tuple(found[k] for k in range(len(radii)))
        return Panel(stretch, self.weight.on(stretch, flats), flats, self.fields, self.powers)


def check_stick_radii(growth: Growth) -> None:
    """Raise if the stick radius falls by more than its errors: what stuck would slip again."""
    errors = [one.error.stick_radius or 0.0 for panel in growth.panels for one in panel.flats]
    stages = zip(growth.stages, errors, strict=True)
    for ((_, before), error_before), ((b, after), error_after) in pairwise(stages):
        if after < before * (1.0 - max(_FALL, error_before + error_after)):
            told = f"the stick radius falls at the contact radius {b:.6g}"
            raise NotComputedError("traction", f"{told}: points that stuck would slip again")
