r"""Friction under a growing contact, by superposition of flat punches over the contact radius.

While the load grows the rates of pressure and traction are those of a flat punch of the radius
``b`` (docs: profiles). So with flat solutions on panels in ``u = ln b``, interpolated between
Chebyshev points, and with the load that `weights` knows,

    q(r) = int q*(r/b; alpha/b, beta/b, f) dP/b^2,      Q = int Q* dP,      c(b) = b c*.

It holds as long as slip reaches the edge and ``c`` does not fall, which is checked at every radius.
Below the radius where slip begins everything sticks; panels are graded to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from spectral_contact.errors import NotComputedError
from spectral_contact.solution import Solution
from spectral_contact.solving.growth_panel import Panel, stage_logs
from spectral_contact.solving.nodes import COUNT, chebyshev_value
from spectral_contact.solving.weights import Weight, Weights
from spectral_contact.threads import cached_property

__all__ = ["Grower", "Growth", "Stage"]

Array = NDArray[np.float64]
#: Of a contact radius: the solution of a flat punch.
Stage = Callable[[float], Solution]

#: A panel of this width in u leaves out so much at most, as measured under a parabola from 1e-6 to
#: 5 compliances; the widest. These are first guesses: what leaves out more is halved.
_WIDTH, _LEAVES, _WIDEST = 1.2, 1e-8, 2.6
#: The first panel past the onset of slip at the tightest tolerance, and how it grows with it.
_AT_ONSET, _TIGHTEST, _POWER = 3e-4, 1e-10, 0.25
#: By how much panels grow away from where something begins: past a break, past the onset at most,
#: and what is singular there.
_RATIO, _MOST, _SINGULAR = 3.5, 8.0, 1e-4
#: By how much a last panel may be longer.
_REST = 0.3
#: What panels may leave out, of the tolerance, as there are some tens; they are not halved below.
_MARGIN, _SHORTEST = 0.02, 1e-4
#: By how much a stick radius may fall, as its own error may make it.
_FALL = 1e-8
#: By how much more than their own errors those of the flat punches count in load and approach,
#: which the Volterra equation amplifies.
_OF_FLATS = 3.0
#: The end of a panel, and how well a place on it is known.
_END, _ROUNDING = np.ones(1), 1e-15
#: From a flat part a history goes back by so much in ``u``, and its load by so much in ``ln P``;
#: how close to it one begins.
_FARTHER_BACK, _CORNER, _NEXT = 1e-10, 6.0, 1e-9
#: Slopes of ``ln P`` below which the history goes on for so much in ``u`` to the centre; how close
#: to that of a tip it is one.
_STEEP, _FARTHER, _LIKE_A_TIP = 2.9, 40.0, 1e-6


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
        """Today's."""
        return float(self.panels[-1].load(_END)[0])

    @cached_property
    def approach(self) -> float:
        """Today's."""
        return math.exp(float(chebyshev_value(self.panels[-1].weights.approaches, _END)[0]))

    @cached_property
    def work(self) -> float:
        """``int P ddelta``."""

        def rates(panel: Panel) -> Callable[[Array], Array]:
            logs = panel.weights.approaches
            return lambda t: panel.load(t) * np.exp(chebyshev_value(logs, t)) * panel.rate(logs, t)

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
        approaches = [one.weights.approaches for one in self.panels]
        begun = math.exp(approaches[0][0] - approaches[-1][-1])
        flats = _OF_FLATS * self._of_flats("pressure", "approach", power=0.0)
        return panels + begun + flats

    @cached_property
    def shear_error(self) -> float:
        """Estimate of the relative error of the shear."""
        panels = sum(one.shear_error * self._share(one) for one in self.panels)
        return panels + 2.0 * self._of_flats("total_shear", "approach", power=0.0)

    @cached_property
    def stick_rate(self) -> float:
        """``dln c*/dln b`` today."""
        last = self.panels[-1]
        return abs(float(last.rate(last.stick, _END)[0])) if last.slips else 0.0

    @cached_property
    def load_rate(self) -> float:
        """``dln P/dln b`` today."""
        last = self.panels[-1]
        return float(last.rate(last.weights.loads, _END)[0])

    @cached_property
    def approach_rate(self) -> float:
        """``dln delta/dln b`` today."""
        last = self.panels[-1]
        return float(last.rate(last.weights.approaches, _END)[0])

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
        last = self.panels[-1]
        rate = float(last.increment(_END)[0] * last.shears[-1])
        return abs(rate / self.total_shear) if self.total_shear else 0.0

    @cached_property
    def error(self) -> float:
        """Estimate of the error of the traction, relative to its largest value."""
        panels = sum(one.error * self._share(one) for one in self.panels)
        flats = self._of_flats("traction", "pressure", power=-2.0)
        return panels + 2.0 * flats + self.begun

    @cached_property
    def slip_error(self) -> float:
        """Estimate of the error of the slip, in its own unit."""
        return sum(one.slip_error for one in self.panels)

    @cached_property
    def log_beginning(self) -> bool:
        """Whether all decades of the beginning count alike at the centre, as at a smooth tip."""
        return abs(self._rise - 2.0) < _LIKE_A_TIP and not self._corner

    @property
    def _rise(self) -> float:
        """``dln P/dln b`` at the beginning."""
        first = self.panels[0]
        return float(first.rate(first.weights.loads, -_END)[0])

    @property
    def _corner(self) -> bool:
        """Whether the history begins at the end of a flat part."""
        low = self.panels[0].low
        return bool(self.breaks) and abs(math.log(self.breaks[0]) - low) < _NEXT

    @cached_property
    def begun(self) -> float:
        """What is missing at the centre, relative to the mean pressure: before `all_panels`."""
        if self.log_beginning:
            return 0.0
        first = self.all_panels[0]
        share = float(first.load(-_END)[0]) / self.load
        return share * math.exp(2.0 * (self.log_radius - first.low))

    @cached_property
    def all_panels(self) -> tuple[Panel, ...]:
        """The panels, after one that goes on to the centre as they begin, where that counts."""
        first, corner = self.panels[0], self._corner
        if self._rise > _STEEP and not corner:
            return self.panels
        # a flat part has its first load before it grows at all
        rise, farther = (_CORNER / _FARTHER_BACK, _FARTHER_BACK) if corner else (0.0, _FARTHER)
        low, flats = first.low - farther, (first.flats[0],) * COUNT
        back = stage_logs(low, first.low) - first.low
        weights = [
            float(chebyshev_value(logs, -_END)[0])
            + (rise or float(first.rate(logs, -_END)[0])) * back
            for logs in (first.weights.loads, first.weights.approaches)
        ]
        begun = Panel(low, first.low, Weights(weights[0], weights[1]), flats, first.fields)
        return (begun, *self.panels)

    def _share(self, panel: Panel) -> float:
        return _share(panel, self.log_radius, self.load)

    def _of_flats(self, *names: str, power: float) -> float:
        """Return what the errors of the flat punches make, weighed with ``b**power dP``."""

        def weights(panel: Panel) -> Callable[[Array], Array]:
            extent = panel.high - panel.low
            return lambda t: (
                panel.increment(t) * np.exp(power * (panel.low + extent * (1.0 + t) / 2.0))
            )

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
            for u, stick in zip(one.logs.tolist(), one.stick.tolist(), strict=True)
        ]

    def log_stick(self, log_radius: float) -> list[float]:
        """Return ``ln c*`` when the contact had a radius; nothing where there was no slip."""
        panels = [one for one in self.panels if one.slips and one.high >= log_radius]
        if not panels or panels[0].low > log_radius + _NEXT:
            return []
        place = panels[0].local(np.array([log_radius]))
        return [float(panels[0].log_stick(place)[0])]

    def radius_of(self, name: str, value: float) -> float | None:
        """Return the logarithm of the radius at which the load, or the approach, had a value.

        None if it has not been reached.
        """
        asked = math.log(value)
        for panel in self.panels:
            logs = getattr(panel.weights, name)

            def off(t: float, logs: Array = logs) -> float:
                return float(chebyshev_value(logs, np.array([t]))[0]) - asked

            if off(1.0) >= 0.0:
                t = float(brentq(off, -1.0, 1.0, xtol=_ROUNDING)) if off(-1.0) < 0.0 else -1.0
                return panel.low + (panel.high - panel.low) * (1.0 + t) / 2.0
        return None


def _share(panel: Panel, log_radius: float, load: float) -> float:
    """Return what a panel contributes to load or traction at most, relative to all of it."""
    share = math.exp(float(panel.weights.loads[-1])) / load
    return share * max(1.0, math.exp(2.0 * (log_radius - panel.high)))


@dataclass(frozen=True)
class Grower:
    """What follows a contact while it grows.

    Attributes
    ----------
    stage : callable
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
        Width of the first panel past one that is no end of a flat part.
    """

    stage: Stage
    weight: Weight
    onset: float | None
    fields: tuple[str, ...]
    tolerance: float
    breaks: tuple[float, ...]
    at_break: float

    def grown(self, least: float, radius: float, load: float) -> Growth:
        """Return the history of a contact.

        Parameters
        ----------
        least : float
            Where the load is negligible.
        radius, load : float
            Today's; the load is a measure only.

        Raises
        ------
        NotComputedError
            If slip does not reach the edge at some radius, or the stick radius falls.
        """
        todo, panels = self._ends(math.log(least), math.log(radius))[::-1], []
        while todo:
            low, high = todo.pop()
            panel = self._panel(low, high)
            off = panel.error * _share(panel, math.log(radius), load)
            if off > _MARGIN * self.tolerance and high - low > _SHORTEST:
                middle = (low + high) / 2.0
                todo += [(middle, high), (low, middle)]
            else:
                self.weight.keep()
                panels.append(panel)
        found = Growth(tuple(panels), self.onset, self.breaks)
        _check(found)
        return found

    def until(self, growth: Growth, log_radius: float) -> Growth:
        """Return a history that ends earlier."""
        kept = [one for one in growth.panels if one.high < log_radius - _SHORTEST]
        low = kept[-1].high if kept else growth.panels[0].low
        self.weight.back(len(kept))
        last = self._panel(low, log_radius)
        self.weight.keep()
        return Growth((*kept, last), self.onset, self.breaks)

    def _ends(self, low: float, high: float) -> list[tuple[float, float]]:
        """Return the ends of the first panels, which grow away from where something begins."""
        starts = {math.log(b): self.at_break for b in self.breaks if low < math.log(b) < high}
        if self.onset and low < math.log(self.onset) < high:
            wider = max(self.tolerance / _TIGHTEST, 1.0) ** _POWER
            starts[math.log(self.onset)] = _AT_ONSET * wider
        if self.breaks and abs(low - math.log(self.breaks[0])) < _NEXT:
            starts[low] = low - math.log(self.breaks[0])
        ends: list[tuple[float, float]] = []
        for start, stop in pairwise(sorted({low, high, *starts})):
            at_onset = start == (math.log(self.onset) if self.onset else None)
            step, cuts = starts.get(start, math.inf), [start]
            while (room := stop - cuts[-1]) > 0.0:
                widest = self._widest(cuts[-1] - high)
                # all the same, where there is room for a few
                widest = min(step, room / math.ceil(room / widest))
                cuts.append(stop if room < (1.0 + _REST) * widest else cuts[-1] + widest)
                step *= self._ratio if at_onset else _RATIO
            ends += pairwise(cuts)
        return ends

    def _widest(self, below: float) -> float:
        """Return the width of a panel that may leave out enough, so far below today in ``u``."""
        # loads grow at least like the third power of the radius, where flat punches differ
        allowed = _MARGIN * self.tolerance * math.exp(-min(below, 0.0)) / _LEAVES
        return float(min(_WIDTH * allowed ** (1.0 / COUNT), _WIDEST))

    @property
    def _ratio(self) -> float:
        """Return by how much panels may grow away from the onset of slip."""
        rho: float = max(_SINGULAR / (_MARGIN * self.tolerance), 1.0) ** (1.0 / COUNT)
        beyond = (rho + 1.0 / rho) / 2.0 - 1.0
        return min(1.0 + 2.0 / beyond, _MOST) if beyond > 0.0 else _MOST

    def _panel(self, low: float, high: float) -> Panel:
        flats: tuple[Solution, ...] = ()
        for b in np.exp(stage_logs(low, high)).tolist():
            flats = (*flats, self.stage(b))
            if [zone.kind for zone in flats[-1].zones] not in (["stick"], ["stick", "slip"]):
                told = f"at the contact radius {b:.6g} slip does not simply reach the edge"
                raise NotComputedError("traction", f"{told}: it takes increments of the load")
        return Panel(low, high, self.weight.on(low, high, flats), flats, self.fields)


def _check(growth: Growth) -> None:
    """Raise if what has stuck would slip again."""
    for (_, before), (b, after) in pairwise(growth.stages):
        if after < before * (1.0 - _FALL):
            told = f"the stick radius falls at the contact radius {b:.6g}"
            raise NotComputedError("traction", f"{told}: what has stuck slips again")
