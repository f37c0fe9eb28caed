r"""States of adhesive contact, and the curve on which they lie.

Each contact radius has one state, which `indented` solves, with a suction at the edge. Over the
radius, load and approach make a curve. What is held, the *control*, is the load, the approach or,
with a machine in between, a sum of both. The states for a value of the control are the points of
the curve where it has this value, and they are stable where it grows with the radius. The curve is
followed from large contacts, which are stable, to smaller ones. *Folds*, where the control has a
maximum or a minimum over the radius, cut it into *stretches*; on each of these the control has
every value once. Branch k of a scene is stretch k, counted from large contacts.

Derivatives by the radius, the *rates*, are not solved for. Two digits of them follow from the slope
of the pressure next to the edge and from a formula for the flat punch; many digits follow from a
polynomial through states nearby, on which folds are located, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import exp, inf, isinf, log, pi, sqrt
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.optimize import brentq

from spectral_contact.contact.contact_radius import Contact, value_of
from spectral_contact.contact.indented import solve_indentation, values_only
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import Refinement
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.profiles.profile_base import Profile
from spectral_contact.profiles.turns import turning_radii

Array = NDArray[np.float64]

#: A piece of the curve is a polynomial through so many states, in the logarithm x of the distance
#: of the radius from the last break before it. The states span twice the second number if the curve
#: grows with the third power of the distance or more slowly: the terms of ``exp(3 x)`` fall to
#: 1e-14 then. If it grows with a higher power, they span less in proportion.
_NODES, _HALF_WIDTH, _THIRD_POWER = 10, 0.12, 3.0
#: The distance from the equator of a sphere, where its slope is infinite, is at least so many times
#: half of the radii that the states span.
_ROOM = 12.0
#: Longest step along the curve, in the same logarithm, and most steps of any search.
_STEP, _MOST_STEPS = 0.5, 200
#: Of so many states one is solved with estimates.
_SAMPLED = 25
#: Shares of that span which are tried where a polynomial does not resolve the curve on it, and the
#: error by what the polynomial leaves out, relative, at which it does.
_SPANS, _UNRESOLVED = (1.0, 0.25, 0.06, 0.015), 1e-11
#: Accuracy to which a fold is first located, in the same logarithm, and how far from the middle of
#: a piece of the curve it may be, over half its length.
_NEARLY, _OFF_CENTRE = 0.02, 0.5
#: Pieces on which it is looked for.
_PIECES = 8
#: A rate that is less than this share of the value is rounding: it has no digits
#: (`AdhesiveCurve.rates` at layers 1e10 times as soft as the half-space).
_RATE_ROUNDING = 1e-9
#: Below a fold and all corners, other folds are looked for down to this share of its radius.
_FEWER = 1e-2
#: After so many steps towards a corner, each step is longer than the one before by a factor.
_EVEN, _LONGER = 6, 1.25
#: Beyond a radius at which the approach without adhesion is so many times the pull, the curve is
#: taken for stable (`AdhesiveCurve.top`).
_STABLE_RATIO = 2.5
#: Logarithms of the radius between which the modelled curve is sampled.
_REACH = 250.0
#: How far, relatively, from a corner or the end of the profile the curve is looked at next to it.
_NEXT = 1e-9
#: A break is a corner if the half-integral is steeper just past it by more than this share, and by
#: this many times as much at a thousandth of the distance. Past a jump of the slope it rises like a
#: root, its derivative 31 times as much there; where the slope only bends, the derivative falls.
_STEEPER, _LIKE_A_ROOT = 1e-3, 10.0
#: Share of the tolerance that the control may be off.
_SHARE = 0.02
#: Safety factor of the error of a radius, which is that of the control over its rate: the rate is
#: known to some digits only.
_RADIUS_SAFETY = 1.5
#: A control that changes with the logarithm of the radius by less than this share of its size is
#: next to a fold.
_NEAR_FOLD = 0.3


@dataclass(frozen=True, slots=True)
class Control:
    """What is held: the load, the approach, or by a machine of stiffness k ``delta + P/k``.

    Attributes
    ----------
    of_load, of_approach : float
        Factors of load and approach in it.
    """

    of_load: float
    of_approach: float

    def value(self, one: Indentation) -> float:
        """Return it in a state."""
        return self.of_load * one.load + self.of_approach * one.approach

    def size(self, one: Indentation) -> float:
        """Return what errors of it are relative to."""
        return self.of_load * one.load_size + self.of_approach * one.approach_size

    def error(self, one: Indentation) -> float:
        """Return the absolute error of it."""
        load = self.of_load * one.load_error * one.load_size
        return load + self.of_approach * one.approach_error * one.approach_size

    def rate(self, rates: Rates) -> float:
        """Return its rate."""
        return self.of_load * rates.load + self.of_approach * rates.approach


BY_LOAD = Control(1.0, 0.0)
BY_APPROACH = Control(0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Rates:
    """Derivatives of load and approach along the curve.

    By the logarithm of the radius (`AdhesiveCurve.rates`), or by that of its distance from the base
    of a piece (`LocalCurve.rates`).
    """

    load: float
    approach: float


@dataclass(frozen=True, slots=True)
class Fold:
    """Where a control turns, or where the curve ends.

    Attributes
    ----------
    radius : float
    error : float
        Relative error of the radius.
    state : Indentation
    curve : LocalCurve or None
        The curve around it, on which the control has a horizontal tangent; None at a corner of the
        profile, or at the rim of its flat part.
    """

    radius: float
    error: float
    state: Indentation
    curve: LocalCurve | None = None


class NoState(Exception):
    """The control does not have a value on a stretch of the curve.

    Parameters
    ----------
    stretches : int
        Number of stretches that were found, up to the one asked for; 0 if no contact that is
        smaller than the profile is stable.
    limit : float or None
        Value of the control at the end of the stretch that is nearer to the value asked for; None
        if there is no such stretch.
    """

    def __init__(self, stretches: int, limit: float | None = None) -> None:
        super().__init__(stretches, limit)
        self.stretches, self.limit = stretches, limit


class LocalCurve:
    """Load and approach near a radius, as polynomials in the logarithm of its distance from a base.

    Parameters
    ----------
    states_at : callable
        Returns the states of some radii.
    radius : float
    profile : Profile
        The base is its last break before the radius, or 0.
    growth : float
        The derivative by the radius of the logarithm of the approach without adhesion.
    share : float
        Of the usual span.
    """

    def __init__(
        self,
        states_at: Callable[[Sequence[float]], list[Indentation]],
        radius: float,
        profile: Profile,
        growth: float,
        share: float,
    ) -> None:
        breaks = (profile.flat_part, *profile.breaks, profile.reach)
        self.base = base = max((b for b in breaks if b < radius), default=0.0)
        # at a break the piece is that of smaller radii
        limit = min(b for b in breaks if b >= radius)
        place = log(radius - base)
        # the piece ends before the limit: the states are moved to smaller radii where it is near
        room = (limit - radius) / (radius - base)
        self._power = max(_THIRD_POWER, growth * (radius - base))
        half = _HALF_WIDTH * _THIRD_POWER / self._power
        self._half = share * min(half, (profile._pole - radius) / (radius - base) / _ROOM)
        self._middle = place + min(0.0, room / 2.0 - self._half)
        nodes = chebyshev.chebpts1(_NODES)
        states = states_at((base + np.exp(self._middle + self._half * nodes)).tolist())
        self._to_terms = np.linalg.inv(chebyshev.chebvander(nodes, _NODES - 1))
        values = np.array([[one.load, one.approach] for one in states])
        known = np.array([[one.load_error, one.approach_error] for one in states])
        sizes = np.array([[one.load_size, one.approach_size] for one in states])
        self._errors = (known + ROUNDING) * sizes
        #: by the error of the profile, which is smooth along the piece
        self._profile_errors = profile._relative_error(radius) * sizes.max(axis=0)
        self._terms = self._to_terms @ values
        # The first term left out follows from how the last ones of the same parity fall.
        last, before = np.abs(self._terms[-1]), np.abs(self._terms[-3])
        self._left_out = last * np.sqrt(last / np.maximum(before, last))
        noise = _UNRESOLVED * sizes.max(axis=0) + self._errors.max(axis=0)
        self.resolved = bool((self._left_out <= noise).all())

    def offset(self, radius: float) -> float:
        """Return where a radius is on the piece, from -1 to 1."""
        return (log(radius - self.base) - self._middle) / self._half

    def rates(self, radius: float, order: int = 1) -> Rates:
        """Return derivatives of an order in the logarithm."""
        t = self.offset(radius)
        found: Any = chebyshev.chebval(t, chebyshev.chebder(self._terms, order))
        slopes = found / self._half**order
        return Rates(float(slopes[0]), float(slopes[1]))

    def rate_errors(self, radius: float, order: int = 1) -> Rates:
        """Return the absolute errors of the derivatives of an order."""
        t = self.offset(radius)
        powers = chebyshev.chebder(np.eye(_NODES), order)
        # the derivative is the sum of the values at the nodes with these weights
        weights = chebyshev.chebval(t, powers) @ self._to_terms / self._half**order
        # The slope of the first term left out is at most its degree over sqrt(1 - t**2), by
        # Bernstein's inequality.
        steepest = _NODES / max(sqrt(1.0 - min(t**2, 1.0)), 1.0 / _NODES)
        slopes = self._left_out * (2.0 * steepest / self._half) ** order
        errors = np.abs(weights) @ self._errors + slopes + self._power**order * self._profile_errors
        return Rates(float(errors[0]), float(errors[1]))

    def fold(self, control: Control, radius: float) -> float | None:
        """Return the radius at which a control turns next to one, None if not on this piece."""
        terms = self._terms @ np.array([control.of_load, control.of_approach])
        roots = chebyshev.chebroots(chebyshev.chebder(terms))
        real = roots.real[(np.abs(roots.imag) < ROUNDING) & (np.abs(roots.real) <= 1.0)]
        if not len(real):
            return None
        nearest = float(real[np.argmin(np.abs(real - self.offset(radius)))])
        return self.base + exp(self._middle + self._half * nearest)


class AdhesiveCurve:
    """The states of a profile on a surface, by their contact radius.

    Parameters
    ----------
    profile : Profile
        Not flat.
    compliance : float
        ``alpha*``.
    adhesion : float
        Work of adhesion.
    tolerance : float
    max_unknowns : int
        Most unknowns of a space.
    """

    def __init__(
        self,
        profile: Profile,
        compliance: float,
        adhesion: float,
        tolerance: float,
        max_unknowns: int,
    ) -> None:
        self.profile, self.compliance, self.adhesion = profile, compliance, adhesion
        self.tolerance, self.max_unknowns = tolerance, max_unknowns
        self._values_only: dict[float, Indentation] = {}
        self.corners = _corners(profile)

    def at(self, radius: float, *, pointwise: bool = False) -> Contact:
        """Return the state of a radius, with the pressure or without."""
        given = self.profile, radius, self.compliance, self.tolerance, self.max_unknowns
        return solve_indentation(*given, pointwise=pointwise, adhesion=self.adhesion)

    def values_only(self, radius: float) -> Indentation:
        """Return the state of a radius in the first space, without estimates."""
        known = self._values_only.get(radius)
        if known is None:
            given = self.profile, radius, self.compliance, self.tolerance, self.max_unknowns
            known = self._values_only[radius] = values_only(*given, adhesion=self.adhesion)
        return known

    def rates(self, one: Indentation) -> Rates:
        r"""Return derivatives in the logarithm of the radius, to 2 % of their parts.

        With the stiffness S at a fixed radius and the pull d, ``dP = S d(delta) - d dS``, where
        ``dS/dln a = 4 pi w a**2 / d**2`` since the energy release rate is w (docs/theory,
        adhesion). How the pull grows follows from the pressure of a flat punch of unit load at its
        edge, whose square is ``1/pi**2 + 1/(16 pi c)`` to 2 %, where c is the compliance over the
        radius.
        """
        a, pull = one.radius, one.pull
        stiffening = 4.0 * pi * self.adhesion * (a / pull) ** 2
        edge = 1.0 / (2.0 + 32.0 / pi * self.compliance / a)
        pulling = pull * (2.0 - edge - stiffening / one.stiffness)
        approach = a * one.growth - pulling
        return Rates(one.stiffness * approach - stiffening * pull, approach)

    def states(self, radii: Sequence[float]) -> list[Indentation]:
        """Return the states of some radii, with estimates of their errors.

        A sample of them is solved with estimates. Where the first space that is tried meets the
        tolerance for all of the sample, the others are solved in it without estimates, and have
        those of the last sampled radius before.
        """
        sample = range(0, len(radii), _SAMPLED)
        solved = [self.at(radii[k]) for k in sample]
        if any(isinstance(one, Refinement) and len(one.history) > 1 for one in solved):
            return [value_of(self.at(one)) for one in radii]
        found = []
        for k, radius in enumerate(radii):
            nearest = value_of(solved[k // _SAMPLED])
            one = nearest if k % _SAMPLED == 0 else self.values_only(radius)
            names = ("load_error", "approach_error", "work_error", "stiffness_error")
            found.append(replace(one, **{name: getattr(nearest, name) for name in names}))
        return found

    def local(self, radius: float) -> LocalCurve:
        """Return the curve near a radius, over a span on which a polynomial resolves it."""
        one = self.values_only(radius)
        growth = one.growth / (one.approach + one.pull)
        for share in _SPANS:
            found = LocalCurve(self.states, radius, self.profile, growth, share)
            if found.resolved:
                break
        return found

    def next_larger(self, corner: float) -> Indentation:
        """Return a state at a radius just above that of a corner, whose rates are one-sided."""
        return self.values_only(corner * (1.0 + _NEXT))

    def top(self, control: Control, value: float = -inf) -> float:
        """Return a radius beyond which a control grows with the radius, and is above a value.

        Let ``delta_0`` be the approach without adhesion, S the stiffness and d the pull, by which
        adhesion lowers the approach, so that ``dP/da = S ddelta_0/da - d(S d)/da``. On a smooth
        surface S grows like a and d like its root; ``delta_0 / a`` grows, since profiles are
        convex. So the load grows where ``delta_0`` is above 3/2 of the pull. With a layer S grows
        like ``a**2`` at most, and the load grows where ``delta_0`` is above 5/2 of the pull if
        ``delta_0 / a`` still grows, which is not proved.

        Raises
        ------
        NoState
            If the profile ends before.
        """
        radius = self._modelled_top(control, value)
        flat_part, reach = self.profile.flat_part, self.profile.reach
        for _ in range(_MOST_STEPS):
            one = self.values_only(radius)
            stable = control.rate(self.rates(one)) > 0.0 and control.value(one) > value
            at_end = not isinf(reach) and reach - radius <= _NEXT * reach
            if stable and (at_end or one.approach + one.pull >= _STABLE_RATIO * one.pull):
                return radius
            if at_end:
                break
            if isinf(reach):
                radius = flat_part + exp(_STEP) * (radius - flat_part)
            else:
                radius = reach - exp(-_STEP) * (reach - radius)
        raise NoState(0)

    def _modelled_top(self, control: Control, value: float) -> float:
        """Return where `top` may be, from a model of the curve.

        Its stiffness is that of the half-space, 8 a, and of a layer alone, pi a / c, in series; the
        approach without adhesion is the mean of both, weighted by their softness.
        """
        rim, reach = self.profile.flat_part, self.profile.reach
        v = np.arange(-_REACH, _REACH, _STEP / 2.0)
        with np.errstate(all="ignore"):
            a = rim + np.exp(v) if isinf(reach) else rim + (reach - rim) / (1.0 + np.exp(-v))
            # nearer to its end radii round to it
            a = a[(a > rim) & (a < reach * (1.0 - _NEXT))]
            c = self.compliance / a
            softness = 1.0 / 8.0 + c / pi
            half = self.profile._transform(a) / 16.0
            weighted = half if self.compliance == 0.0 else half + self.profile._height(a) * c / pi
            unpulled, stiffness = weighted / softness, a / softness
            # the square of what a flat punch per unit load has at the edge, times the compliance
            edge = c / pi**2 + 1.0 / (16.0 * pi)
            pull = softness * np.sqrt(2.0 * self.adhesion * a / edge)
            gained = stiffness[1:] * np.diff(unpulled)
            load = np.concatenate([[0.0], np.cumsum(gained)]) - stiffness * pull
            held = control.of_load * load + control.of_approach * (unpulled - pull)
            enough = (unpulled >= _STABLE_RATIO * pull) & (held > value)
        return float(a[np.argmax(enough)] if enough.any() else a[-1])

    def _downward(self, radius: float) -> Iterator[float]:
        """Yield smaller and smaller radii, to both sides of every corner, to the flat part.

        Where the curve may have several folds, their places are between these radii.
        """
        bends = turning_radii(self.profile, radius)[::-1]
        for one in self._radii_in_steps(radius):
            while bends and bends[-1] > one:
                yield bends.pop()
            yield one

    def _radii_in_steps(self, radius: float) -> Iterator[float]:
        """Yield the radii of `_downward` but for those of the turns.

        Steps towards a corner become longer: what happens there does so on a scale of logarithms.
        """
        ends = [b for b in (0.0, *self.corners) if b < radius]
        for base in reversed(ends):
            distance, step = radius - base, _STEP
            for k in range(_MOST_STEPS):
                distance *= exp(-step)
                if distance < _NEXT * base:
                    break
                yield base + distance
                if base > 0.0 and k >= _EVEN:
                    step *= _LONGER
            if base == 0.0:
                return
            yield base * (1.0 + _NEXT)
            yield base
            radius = base
            if base == self.profile.flat_part:
                return

    def folds(self, control: Control) -> Iterator[Fold]:
        """Yield the folds of a control, from large contacts to small ones, and where it ends.

        Below a fold and all places where the curve may turn again no more are looked for.

        Raises
        ------
        NoState
            If no contact smaller than the profile is stable.
        """
        before, sign = self.top(control), 1.0
        last_place = min((*self.corners, *turning_radii(self.profile, before)), default=inf)
        least = 0.0
        for radius in self._downward(before):
            if radius == self.profile.flat_part:
                yield Fold(radius, 0.0, value_of(self.at(radius)))
                return
            if radius < least or self._settled(control, radius):
                return
            if sign * control.rate(self.rates(self.values_only(radius))) <= 0.0:
                fold = self._fold(control, before, radius)
                yield fold
                sign = -sign
                if last_place >= radius:
                    least = _FEWER * fold.radius
            before = radius

    def _settled(self, control: Control, radius: float) -> bool:
        """Return whether the control changes no more to smaller radii, but for rounding."""
        flat_part = self.profile.flat_part
        # at one radius alone it may be that of a fold
        states = map(self.values_only, (radius, flat_part + exp(-_STEP) * (radius - flat_part)))
        return all(
            abs(control.rate(self.rates(one))) <= _RATE_ROUNDING * control.size(one)
            for one in states
        )

    def _fold(self, control: Control, high: float, low: float) -> Fold:
        """Return the fold between two radii at which the rates have opposite signs."""
        if low in self.corners:
            return Fold(low, 0.0, value_of(self.at(low)))
        below = control.rate(self.rates(self.values_only(low)))

        def sign(radius: float) -> float:
            return below * control.rate(self.rates(self.values_only(radius)))

        # between breaks the curve is smooth in the logarithm of the distance from the lower one
        while breaks_between := [b for b in self.profile.breaks if low < b < high]:
            b = breaks_between[len(breaks_between) // 2]
            low, high = (b, high) if sign(b) > 0.0 else (low, b)
        base = max((b for b in self.profile.breaks if b <= low), default=0.0)
        places = log(max(low - base, _NEXT * base)), log(high - base)
        radius = base + exp(places[0])
        if sign(radius) > 0.0:
            find = brentq(lambda x: sign(base + exp(x)), *places, xtol=_NEARLY, rtol=_NEARLY)
            radius = base + exp(find)
        turns: float | None = None
        for _ in range(_PIECES):
            curve = self.local(radius)
            turns = curve.fold(control, radius)
            if turns is not None and abs(curve.offset(turns)) <= _OFF_CENTRE:
                radius = turns
                break
            nearer = turns
            if nearer is None:  # the rates to some digits were wrong: a step of Newton's
                slope, bend = (control.rate(curve.rates(radius, k)) for k in (1, 2))
                step = min(max(-slope / bend if bend else 0.0, -_STEP), _STEP)
                nearer = curve.base + exp(step) * (radius - curve.base)
            radius = min(max(nearer, low), high)
        bend = abs(control.rate(curve.rates(radius, 2)))
        bend -= control.rate(curve.rate_errors(radius, 2))
        missed = abs(control.rate(curve.rates(radius)))
        missed += control.rate(curve.rate_errors(radius))
        # on the last piece there may be no fold
        off = missed / bend if turns is not None and bend > 0.0 else inf
        error = off * (radius - curve.base) / radius + ROUNDING
        return Fold(radius, error, value_of(self.at(radius)), curve)

    def bracket(self, control: Control, value: float, branch: int) -> tuple[float, float]:
        """Return two radii between which the control has a value, on a stretch of the curve.

        Parameters
        ----------
        control : Control
        value : float
        branch : int
            The stretch: 0 from large contacts to the first fold, 1 to the second, and so on.

        Raises
        ------
        NoState
            If the stretch does not have the value.
        """
        above = self.top(control, value if branch == 0 else -inf)
        number, sign = 0, 1.0
        for radius in self._downward(above):
            pinned = radius == self.profile.flat_part
            one = value_of(self.at(radius)) if pinned else self.values_only(radius)
            fold = None
            if not pinned and self._settled(control, radius):
                break
            if not pinned and sign * control.rate(self.rates(one)) <= 0.0:
                fold = self._fold(control, above, radius)
                one = fold.state
            if number == branch:
                if sign * (control.value(one) - value) <= control.error(one):
                    return one.radius, above
                if pinned or fold is not None:
                    raise NoState(number + 1, control.value(one))
            if fold is not None:
                number, sign = number + 1, -sign
                if number == branch and sign * (control.value(one) - value) < 0.0:
                    raise NoState(number + 1, control.value(one))
            above = one.radius
        raise NoState(number + 1, control.value(one) if number == branch else None)

    def find(
        self, control: Control, value: float, branch: int, *, pointwise: bool
    ) -> tuple[Contact, float]:
        """Return the state of a value on a stretch, and the relative error of its radius.

        `pointwise` says whether the pressure is wanted.

        Raises
        ------
        NoState
            If there is none.
        """
        low, high = self.bracket(control, value, branch)
        root = _Root(self, control, value, low, high)
        root.run(self.values_only, with_errors=False)
        root.run(lambda a: value_of(self.at(a)), with_errors=True)
        found = self.at(root.radius, pointwise=pointwise)
        one = value_of(found)
        off = control.error(one) + abs(control.value(one) - value)
        off += self.profile._relative_error(one.radius) * control.size(one)
        rates, error = self._radius_error(control, one, off)
        # what is stored grows by P ddelta + w dA
        stored = abs(one.load * rates.approach) + 2.0 * pi * self.adhesion * one.radius**2
        added = {**radius_effects(one, rates, error), "work": stored * error / one.work}
        errors = {f"{name}_error": getattr(one, f"{name}_error") + added[name] for name in added}
        best = replace(one, **errors)
        if control == BY_LOAD:
            best = replace(best, load=value, load_error=0.0)
        if control == BY_APPROACH:
            best = replace(best, approach=value, approach_error=0.0)
        if isinstance(found, Refinement):
            found = replace(found, best=replace(found.best, value=best))
            return found, error
        return best, error

    def _radius_error(self, control: Control, one: Indentation, off: float) -> tuple[Rates, float]:
        """Return the rates of a state, and the relative error of its radius.

        Next to a fold the rates to 2 % of their parts have no digits: they are taken from the local
        polynomial, and the error of the radius is also bounded by that of a parabola.

        Parameters
        ----------
        control : Control
        one : Indentation
        off : float
            By how much the control may be wrong.
        """
        rates, bend, a = self.rates(one), 0.0, one.radius
        slope = abs(control.rate(rates))
        if slope < _NEAR_FOLD * control.size(one) and a > self.profile.flat_part:
            local = self.local(a)
            per_logarithm = a / (a - local.base)
            rates = local.rates(a)
            rates = Rates(rates.load * per_logarithm, rates.approach * per_logarithm)
            slope = abs(control.rate(rates)) - control.rate(local.rate_errors(a)) * per_logarithm
            bend = abs(control.rate(local.rates(a, 2))) * per_logarithm**2
        error = off / slope if slope > 0.0 else inf
        if bend > 0.0:
            error = min(error, sqrt(2.0 * off / bend))
        return rates, _RADIUS_SAFETY * error + ROUNDING


def radius_effects(one: Indentation, rates: Rates, error: float) -> dict[str, float]:
    """Return what a relative error of the radius adds to those of a state, by quantity.

    The stiffness grows with the radius to a power of 2 at most. The pressure without adhesion grows
    like the load and its rate, that of the flat punch like the stiffness; the factor 2 is a margin.

    Parameters
    ----------
    one : Indentation
    rates : Rates
        In the logarithm of the radius.
    error : float
    """
    unpulled = one.radius * one.growth * one.stiffness
    pressure_rate = 2.0 * (1.0 + (unpulled + abs(rates.load)) / one.load_size)
    return {
        "load": abs(rates.load) * error / one.load_size,
        "approach": abs(rates.approach) * error / one.approach_size,
        "stiffness": 2.0 * error,
        "pressure": pressure_rate * error,
    }


class _Root:
    """Newton's method for the radius at which a control has a value, between two radii."""

    def __init__(
        self, curve: AdhesiveCurve, control: Control, value: float, low: float, high: float
    ) -> None:
        self._curve, self._control, self._value = curve, control, value
        self._base = max((b for b in (0.0, *curve.corners) if b <= low), default=0.0)
        least = _NEXT * (self._base or low)
        self._ends = log(max(low - self._base, least)), log(high - self._base)
        states = [curve.values_only(low), curve.values_only(high)]
        misses = [control.value(one) - value for one in states]
        self._sign = 1.0 if misses[1] > misses[0] else -1.0
        # where it is not between, for rounding, the nearer end is next to it
        share = misses[0] / (misses[0] - misses[1]) if misses[0] != misses[1] else 0.5
        self._place = self._ends[0] + min(max(share, 0.0), 1.0) * (self._ends[1] - self._ends[0])

    @property
    def radius(self) -> float:
        """The radius that was last."""
        return self._base + exp(self._place)

    def run(self, state_of: Callable[[float], Indentation], *, with_errors: bool) -> None:
        """Step until the control has the value, as far as it is known, or is wanted.

        Parameters
        ----------
        state_of : callable
            Returns the state of a radius.
        with_errors : bool
            Whether the states have estimates of their errors. Then the control may be off by a
            share of the tolerance.
        """
        low, high = self._ends
        before: tuple[float, float] | None = None
        for _ in range(_MOST_STEPS):
            one = state_of(self.radius)
            off = self._control.value(one) - self._value
            share = _SHARE * self._curve.tolerance if with_errors else 0.0
            enough = max(share, ROUNDING) * self._control.size(one)
            if abs(off) <= max(enough, self._control.error(one) / 2.0):
                return
            if self._sign * off > 0.0:
                high = min(high, self._place)
            else:
                low = max(low, self._place)
            distance = self.radius - self._base
            rates = self._curve.rates(one)
            slope = self._control.rate(rates) * distance / self.radius
            if before is not None and before[0] != self._place:
                secant = (off - before[1]) / (self._place - before[0])
                slope = secant if self._sign * secant > 0.0 else slope
            before = self._place, off
            place = self._place - off / slope if self._sign * slope > 0.0 else inf
            self._place = place if low < place < high else (low + high) / 2.0
            if self._place in (low, high) or high - low <= ROUNDING * abs(high):
                return


def _corners(profile: Profile) -> tuple[float, ...]:
    """Return the radii, increasing, at which the slope of a profile jumps, and of its flat part.

    The half-integral rises like a root past a jump of the slope.
    """
    flat_part = profile.flat_part
    found = [flat_part] if flat_part > 0.0 else []
    for b in profile.breaks:
        if b > flat_part:
            # the rate of a profile takes the square of the radius less that of the last break, 0
            # if there is none, without cancellation
            last = max((c for c in profile.breaks if c < b), default=0.0)
            past = b * np.array([_NEXT, 1e-3 * _NEXT])
            squares = np.array([(b - last) * (b + last) * bool(last), *(past * (2.0 * b + past))])
            before, near, next_to_it = profile._rate(np.array([b, *(b + past)]), squares).tolist()
            rise = next_to_it - before
            if rise > max(_STEEPER * before, _LIKE_A_ROOT * (near - before)):
                found.append(b)
    return tuple(found)
