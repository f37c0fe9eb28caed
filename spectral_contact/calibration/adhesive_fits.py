r"""Fits with adhesion: loads of approaches on the branch of large contacts, with derivatives.

A contact radius a has, without adhesion, a load ``P_0``, an approach ``delta_0`` and a stiffness S,
and the work of adhesion w lowers both (docs/theory, Adhesion):

    delta = delta_0 - d,   P = P_0 - S d,   d = sqrt(4 pi a w/S'),   S' = dS/da.

None of ``P_0``, ``delta_0``, S and ``d/sqrt(w)`` depends on w. They are solved at few radii, and
polynomials through their logarithms serve all depths of a curve and all w. Along the curve
``d(U - pi a**2 w) = P ddelta``, so that at a fixed approach

    dP/dw = -d(pi a**2)/ddelta,        dP/ddelta = S - d S' / (ddelta/da),

and by the layer load and approach are differentiated at a fixed radius, by differences.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.calibration.indentation_curve import (
    OF_INSTRUMENT,
    CurveProblem,
    IndentationFit,
    beyond_profile,
)
from spectral_contact.calibration.indentation_data import IndentationData
from spectral_contact.contact.adhesion import BY_APPROACH, BY_LOAD, AdhesiveCurve, NoState
from spectral_contact.contact.contact_radius import RadiusScale, value_of
from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields import Array
from spectral_contact.profiles import Flat, Profile
from spectral_contact.scene import Scene

_MOST_UNKNOWNS: Final = 20_000
#: Numbers of radii of a piece of the curve, which are tried in turn.
_NODES: Final = (16, 24, 36, 54, 80)
#: Radii are solved up to this distance beyond the range that is wanted, in the coordinate of
#: `RadiusScale`.
_MARGIN: Final = 0.3
#: Least distance of a radius from the flat part of a profile, over the flat part.
_NEXT_TO_FLAT: Final = 1e-9
#: Least radius over the largest one, where the contact shrinks to a point without a fold.
_LEAST_RADIUS: Final = 1e-4
#: Relative change of the layer for the differences, whose error is of the order of its square.
_LAYER_CHANGE: Final = 1e-3
#: The pull of adhesion is subtracted from the approach. A difference below this fraction of their
#: sum is rounding, as is such a rate of the difference.
_ROUNDING_FRACTION: Final = 1e-9
#: Number of places at which a branch is sampled.
_SAMPLES: Final = 400
#: Largest number of steps of Newton's method from there.
_MOST_STEPS: Final = 40
#: Slope of the load beyond pull-off, over the stiffness at a fixed radius: data do not follow it,
#: so that the search comes back.
_STEEP: Final = 10.0
#: Number of times that the start is improved.
_ROUNDS: Final = 3
#: Loads of at most this many standard deviations are noise.
_NOISE_DEVIATIONS: Final = 3.0
#: A drop of the load from one row to a shallower one is pull-off if it is more than this many
#: standard deviations.
_DROP_DEVIATIONS: Final = 6.0
#: Without a baseline, a drop of the load is taken for pull-off if more rows than this come before
#: it. Fewer may be the steep end of a branch.
_FEWEST_ROWS_BEFORE: Final = 2


class _FunctionValues(NamedTuple):
    """Functions of the radius at places, without adhesion; rates are by the place.

    Attributes
    ----------
    radius, radius_rate : ndarray, shape (places,)
    load, approach, stiffness, pull : ndarray, shape (places,)
        The last one for a work of adhesion of 1.
    approach_rate, pull_rate : ndarray, shape (places,)
    """

    radius: Array
    radius_rate: Array
    load: Array
    approach: Array
    stiffness: Array
    pull: Array
    approach_rate: Array
    pull_rate: Array


class _ContactFunctions:
    """Polynomials through what some radii have without adhesion, between breaks of the profile.

    Parameters
    ----------
    curve : AdhesiveCurve
        Which solves.
    low, high : float
        Places of the radii (`RadiusScale`), the second one larger.
    rtol : float

    Raises
    ------
    ConvergenceError
        If polynomials through 80 radii do not settle.
    """

    def __init__(self, curve: AdhesiveCurve, low: float, high: float, rtol: float) -> None:
        self.low = low
        self.high = high
        self._curve = curve
        self._rtol = rtol
        self._scale = RadiusScale(curve.profile)
        first, last = map(self._scale.radius, (low, high))
        inside = [b for b in curve.profile.breaks if first < b < last]
        self._piece_ends = [low, *map(self._scale.place, inside), high]
        self._terms = [self._settled(*ends) for ends in pairwise(self._piece_ends)]

    def _settled(self, low: float, high: float) -> Array:
        for count in _NODES:
            nodes = chebyshev.chebpts1(count)
            places = (low + high) / 2.0 + (high - low) / 2.0 * nodes
            radii = list(map(self._scale.radius, places.tolist()))
            root = math.sqrt(self._curve.adhesion)
            rows = []
            error = 0.0
            for state in self._curve.states(radii):
                load = state.load + state.stiffness * state.pull
                approach = state.approach + state.pull
                rows.append([load, approach, state.stiffness, state.pull / root])
                error = max(error, state.load_error, state.approach_error, state.stiffness_error)
            terms = np.linalg.solve(chebyshev.chebvander(nodes, count - 1), np.log(rows))
            if np.abs(terms[-3:]).max() <= max(self._rtol, 4.0 * error):
                return np.asarray(terms)
        cause = f"loads of {self._curve.profile.brief} do not settle with {count} radii"
        raise ConvergenceError(cause, "loosen rtol.")

    def at(self, places: Array) -> _FunctionValues:
        """Return the functions at places."""
        values, rates = np.empty((2, len(places), 4))
        piece = np.searchsorted(self._piece_ends[1:-1], places)
        for k, (low, high) in enumerate(pairwise(self._piece_ends)):
            on_piece = piece == k
            t = (2.0 * places[on_piece] - low - high) / (high - low)
            values[on_piece] = chebyshev.chebval(t, self._terms[k]).T
            slopes = chebyshev.chebval(t, chebyshev.chebder(self._terms[k])).T
            rates[on_piece] = slopes * (2.0 / (high - low))
        load, approach, stiffness, pull = np.exp(values).T
        radii = np.array(list(map(self._scale.radius, places.tolist())))
        steps = np.array(list(map(self._scale.derivative, radii.tolist())))
        scaled_rates = (approach * rates[:, 1], pull * rates[:, 3])
        return _FunctionValues(radii, steps, load, approach, stiffness, pull, *scaled_rates)


class AdhesiveLoads(NamedTuple):
    """``L = P/E'`` of many approaches, with derivatives.

    Attributes
    ----------
    value, by_approach : ndarray, shape (approaches,)
    by_layer, by_adhesion : ndarray, shape (approaches,)
        By the logarithms of ``alpha E'`` and ``w/E'``.
    beyond : ndarray of bool, shape (approaches,)
        Approaches at which the contact has come off. There the load falls on, along a line that is
        steeper than any contact: a search needs somewhere to come back from.
    """

    value: Array
    by_approach: Array
    by_layer: Array
    by_adhesion: Array
    beyond: NDArray[np.bool_]


class BranchLoads:
    """Loads on the branch from large contacts, of a profile on any layer and with any adhesion.

    Parameters
    ----------
    profile : Profile
        Not flat.
    rtol : float
    """

    def __init__(self, profile: Profile, rtol: float) -> None:
        self.profile = profile
        self.rtol = rtol
        self._scale = RadiusScale(profile)
        self._known: dict[float, _ContactFunctions] = {}

    def loads(self, approaches: Array, layer: float, adhesion: float) -> AdhesiveLoads:
        """Return the loads.

        Parameters
        ----------
        approaches : ndarray, shape (approaches,)
        layer, adhesion : float
            ``alpha E'`` and ``w/E'``, lengths.

        Raises
        ------
        SceneError
            If the contact would grow to the end of the profile.
        ConvergenceError
            If the loads are not known to the tolerance.
        """
        curve = self.curve(layer, adhesion)
        low, high = self._range(curve, approaches)
        root = math.sqrt(adhesion)
        functions = self._functions(curve, low, high)
        places = _places(functions, root, approaches, low, high)
        contact = functions.at(places)
        pull = root * contact.pull
        rounding = _ROUNDING_FRACTION * (contact.approach + pull)
        # it is 0 at a fold, where the derivatives have no bound
        rate = np.maximum(contact.approach_rate - root * contact.pull_rate, rounding)
        softening = 4.0 * math.pi * adhesion * contact.radius * contact.radius_rate / pull  # d S'
        beyond = approaches < contact.approach - pull - rounding
        slope = contact.stiffness - softening / rate
        by_adhesion = -2.0 * math.pi * adhesion * contact.radius * contact.radius_rate / rate
        by_layer = np.zeros(len(approaches))
        if layer > 0.0:
            by_layer = self._by_layer(curve, (low, high), places, slope)
        steep = _STEEP * contact.stiffness
        load = contact.load - contact.stiffness * pull
        # Beyond pull-off the load goes on along a straight line. The load at which the contact
        # comes off is about proportional to the adhesion, and the approach there to its power 2/3:
        # from that follows how the line moves with the logarithm of the adhesion.
        load_beyond = load + steep * (approaches - contact.approach + pull)
        rate_beyond = load + 2.0 / 3.0 * steep * (pull - contact.approach)
        return AdhesiveLoads(
            np.where(beyond, load_beyond, load),
            np.where(beyond, steep, slope),
            np.where(beyond, 0.0, by_layer),
            np.where(beyond, rate_beyond, by_adhesion),
            beyond,
        )

    def curve(self, layer: float, adhesion: float) -> AdhesiveCurve:
        """Return the states of a layer and an adhesion by their radius."""
        return AdhesiveCurve(self.profile, layer, adhesion, self.rtol, _MOST_UNKNOWNS)

    def _range(self, curve: AdhesiveCurve, approaches: Array) -> tuple[float, float]:
        """Return the places of radii between which the branch has all of the approaches it has."""
        try:
            high = curve.top(BY_APPROACH, float(approaches.max()))
        except NoState:
            raise beyond_profile(self.profile, float(approaches.max())) from None
        try:
            low, _ = curve.bracket(BY_APPROACH, float(approaches.min()), 0)
        except NoState:
            fold = next(curve.folds(BY_APPROACH), None)
            low = _LEAST_RADIUS * high if fold is None else fold.radius
        low = max(low, self.profile.flat_part * (1.0 + _NEXT_TO_FLAT))
        return self._scale.place(low), self._scale.place(high)

    def _functions(self, curve: AdhesiveCurve, low: float, high: float) -> _ContactFunctions:
        """Return functions of a layer that reach over some places; the last few are kept."""
        layer = curve.compliance
        known = self._known.get(layer)
        if known is None or low < known.low or high > known.high:
            if len(self._known) > 2:
                self._known.clear()
            known = _ContactFunctions(curve, low - _MARGIN, high + _MARGIN, self.rtol)
            self._known[layer] = known
        return known

    def _by_layer(
        self, curve: AdhesiveCurve, ends: tuple[float, float], places: Array, slope: Array
    ) -> Array:
        """Return derivatives of the loads by the logarithm of the layer, at fixed approaches."""
        root = math.sqrt(curve.adhesion)
        load, approach = np.zeros((2, len(places)))
        for sign in (-1.0, 1.0):
            layer = curve.compliance * math.exp(sign * _LAYER_CHANGE)
            changed = self.curve(layer, curve.adhesion)
            contact = _ContactFunctions(changed, *ends, self.rtol).at(places)
            approach += sign * (contact.approach - root * contact.pull) / (2.0 * _LAYER_CHANGE)
            load += (
                sign
                * (contact.load - root * contact.stiffness * contact.pull)
                / (2.0 * _LAYER_CHANGE)
            )
        return np.asarray(load - slope * approach)


def _places(
    functions: _ContactFunctions, root: float, approaches: Array, low: float, high: float
) -> Array:
    """Return the places of approaches; the first one of those that the branch does not have."""
    samples = np.linspace(low, high, _SAMPLES)
    contact = functions.at(samples)
    known_approaches = contact.approach - root * contact.pull
    k = np.clip(np.searchsorted(known_approaches, approaches), 1, _SAMPLES - 1)
    lower = samples[k - 1].copy()
    upper = samples[k].copy()
    fraction = (approaches - known_approaches[k - 1]) / (
        known_approaches[k] - known_approaches[k - 1]
    )
    places = lower + np.clip(fraction, 0.0, 1.0) * (upper - lower)
    for _ in range(_MOST_STEPS):
        contact = functions.at(places)
        excess = contact.approach - root * contact.pull - approaches
        upper = np.where(excess > 0.0, places, upper)
        lower = np.where(excess > 0.0, lower, places)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = places - excess / (contact.approach_rate - root * contact.pull_rate)
        inside = (step >= lower) & (step <= upper)
        next_places = np.where(inside, step, (lower + upper) / 2.0)
        settled = np.abs(next_places - places).max() < 1e-13 * (1.0 + abs(low) + abs(high))
        places = next_places
        if settled:
            break
    return np.where(approaches <= known_approaches[0], low, places)


class AdhesiveProblem(CurveProblem):
    """Residuals and derivatives by ln E*, ln alpha, ln w and the zero point.

    Rows from the deepest one to the jump of the load at pull-off, or at the jump into contact, are
    in contact; those beyond have no load. Of noisy curves with few rows before the contact a search
    tells these (`revises_rows`).
    """

    @staticmethod
    def parameters(scene: Scene) -> tuple[str, ...]:
        """Return what can be free."""
        return ("reduced_modulus", "normal_compliance", "work_of_adhesion", *OF_INSTRUMENT)

    def __init__(
        self, scene: Scene, data: IndentationData, free: tuple[str, ...], rtol: float
    ) -> None:
        super().__init__(scene, data, free, rtol)
        if isinstance(self.profile, Flat):
            allowed = "not flat: the load of a flat punch is a straight line, whatever the adhesion"
            raise SceneError("profile", self.profile, allowed)
        if scene.branch:
            allowed = "0: curves are fitted on the branch of large contacts"
            raise SceneError("branch", scene.branch, allowed)
        self.touching = self.depth >= self._first_depth()
        self.beyond = np.zeros(len(self.depth), dtype=bool)

    def revises_rows(self, y: Array) -> bool:
        """Take rows for no contact that carry no load beyond noise where the fit has come off.

        As rows in contact they would have the load of a line on which the search comes back, and
        pull the fit toward it.
        """
        self.residuals(y)
        quiet = np.abs(self._loads_above_baseline()) <= _NOISE_DEVIATIONS * self.sigma
        revised = self.touching & self.beyond & quiet
        if not revised.any() or int(self.touching.sum() - revised.sum()) <= len(self.free):
            return False
        self.touching = self.touching & ~revised
        self.take_tolerance(self.rtol)
        return True

    def improve_start(self) -> None:
        """Start from the largest tension, the zero of the load and that of the deepest row."""
        for _ in range(_ROUNDS):
            for name, improved in (
                ("work_of_adhesion", self._first_adhesion),
                ("zero_point", self._first_zero),
                ("reduced_modulus", self._first_modulus),
            ):
                if name in self.free:
                    self.start[self.free.index(name)] = improved()

    def take_tolerance(self, rtol: float) -> None:
        """Solve with another tolerance from now on."""
        super().take_tolerance(rtol)
        self.branch = BranchLoads(self.profile, rtol)

    @staticmethod
    def _layer_values(scene: Scene) -> dict[str, float]:
        data = scene.physical
        assert data is not None
        assert data.work_of_adhesion is not None
        return {
            "normal_compliance": data.normal_compliance,
            "work_of_adhesion": data.work_of_adhesion,
        }

    def _first_depth(self) -> float:
        """Return the smallest depth in contact: next to the largest drop, or past the baseline.

        Without a baseline, which needs noise, loads before a drop are those of no contact if they
        differ by less than half of it.
        """
        order = np.argsort(self.depth, kind="stable")
        depth, load, sigma = (column[order] for column in (self.depth, self.load, self.sigma))
        drops = load[:-1] - load[1:]
        k = int(np.argmax(drops)) if len(drops) else 0
        jumps = len(drops) > 0 and drops[k] > _DROP_DEVIATIONS * math.hypot(sigma[k], sigma[k + 1])
        if self.line is None:
            jumps = jumps and k >= _FEWEST_ROWS_BEFORE and np.ptp(load[: k + 1]) < drops[k] / 2.0
        if jumps:
            return float(depth[k + 1])
        return float(depth[0]) if self.line is None else self.line.end

    def _first_adhesion(self) -> float:
        """Return where the search starts for the largest tension measured to be that of pull-off.

        That grows as a power of the work of adhesion, which is taken from two values.
        """
        values = self.values(self.start)
        given = values["work_of_adhesion"]
        start = self.start[self.free.index("work_of_adhesion")]
        measured = -float(self._loads_above_baseline()[self.touching].min())

        def tension(adhesion: float) -> float:
            lengths = self._lengths(values | {"work_of_adhesion": adhesion})
            fold = next(self.branch.curve(*lengths).folds(BY_LOAD), None)
            quarter = values["reduced_modulus"] / 4.0
            return 0.0 if fold is None else -fold.state.load * quarter

        try:
            pulls = tension(given), tension(2.0 * given)
        except NoState:
            return start
        if measured <= 0.0 or not 0.0 < pulls[0] < pulls[1]:
            return start
        power = math.log2(pulls[1] / pulls[0])
        return start + math.log(measured / pulls[0]) / power

    def _loads(self, values: dict[str, float], approach: Array) -> Array:
        loads = self.branch.loads(approach, *self._lengths(values)).value
        return np.asarray(values["reduced_modulus"] / 4.0 * loads)

    def _first_zero(self) -> float:
        """Return the zero point at which the search starts.

        With it the parameters of the start have the load 0 at the depth at which it was measured.
        It is less if the contact would come off before the first row in contact otherwise.
        """
        curve = self.branch.curve(*self._lengths(self.values(self.start)))
        first = float(self.depth[self.touching].min())
        try:
            unloaded_state, _ = curve.find(BY_LOAD, 0.0, 0, pointwise=False)
            fold = next(curve.folds(BY_LOAD), None)
        except NoState:
            return first
        pulled = self.touching & (self._loads_above_baseline() <= 0.0)
        unloaded = float(self.depth[pulled].max()) if pulled.any() else first
        last = value_of(unloaded_state).approach if fold is None else fold.state.approach
        return min(unloaded - value_of(unloaded_state).approach, first - last)

    @staticmethod
    def _lengths(values: dict[str, float]) -> tuple[float, float]:
        """Return ``alpha E'`` and ``w/E'`` [m]."""
        quarter = values["reduced_modulus"] / 4.0
        return values["normal_compliance"] * quarter, values["work_of_adhesion"] / quarter

    def curve(self, values: dict[str, float], approach: Array) -> tuple[Array, Any]:
        """Return the loads of all approaches, and their derivatives by name."""
        quarter = values["reduced_modulus"] / 4.0
        loads = self.branch.loads(approach[self.touching], *self._lengths(values))
        self.beyond = np.zeros(len(approach), dtype=bool)
        self.beyond[self.touching] = loads.beyond

        def spread(column: Array) -> Array:
            all_rows = np.zeros(len(approach))
            all_rows[self.touching] = quarter * column
            return all_rows

        return spread(loads.value), {
            "reduced_modulus": spread(loads.value + loads.by_layer - loads.by_adhesion),
            "normal_compliance": spread(loads.by_layer),
            "work_of_adhesion": spread(loads.by_adhesion),
            "zero_point": -spread(loads.by_approach),
        }

    def best(self, values: dict[str, float]) -> dict[str, Any]:
        """Return layer and adhesion that fit best, as a scene takes them."""
        return {name: values[name] for name in ("normal_compliance", "work_of_adhesion")}

    def outcome(self, y: Array, at_bounds: NDArray[np.int_]) -> IndentationFit:
        """Return the record; its errors are NaN where rows in contact are beyond pull-off.

        These rows have the load of a line that no contact follows, at which a search may end far
        from the best parameters.
        """
        fit = super().outcome(y, at_bounds)
        if not self.beyond.any():
            return fit
        size = len(self.free)
        unknown = (math.nan,) * size
        return replace(fit, errors=unknown, covariance=(unknown,) * size)

    def _remarks_on_fit(self, residuals: Array) -> list[str]:
        """Return what speaks against the fit, and which rows are in contact."""
        remarks = super()._remarks_on_fit(residuals)
        rows = int(self.touching.sum())
        first = float(self.depth[self.touching].min())
        remark = (
            f"{rows} of {len(self.depth)} rows are in contact, from a depth of {first:.6g} m on"
        )
        beyond_count = int(self.beyond.sum())
        if beyond_count:
            remark += (
                f"; at {beyond_count} of them the fitted contact has come off: the deviations of "
                "the parameters are not known"
            )
        return [remark, *remarks]
