"""What the contact problems share: first spaces, decay rates, estimates and transforms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, inf, log

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.series import Array, PressureField, Radius
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.panels import LEAST_DEGREE, DiscreteSpace, LogPanels

#: Relative rounding error of an integral quantity, measured (docs/theory).
ROUNDING = 2e-15
#: That of what a closed form gives, of a pressure or a ratio at one place, and of a traction,
#: pointwise: q/s at the centre is the least accurate, 9e-14 in ten scenes. And by how much more it
#: rounds where all sticks and the pressure is unknown or infinite at the edge: two solves on other
#: panels differ by 1.8e-13 at most, of 400 scenes; and where it is unknown, or a disk slips around,
#: and compliance is little: by at most 4.7e-13 in 43 scenes against 20 digits.
CLOSED_FORM_ROUNDING, FIELD_ROUNDING = 4.0 * ROUNDING, 20.0 * ROUNDING
TRACTION_ROUNDING, CENTRE_ROUNDS, MOST_ROUNDS = 60.0 * ROUNDING, 1.8, 4.2
#: The share of a tolerance that counts for nothing: with 0.1 estimates of shear and boundaries are
#: 1.7 and 1.9 times as large, in the mean of 50 random scenes.
TRIFLING = 0.01
#: Tolerance of spaces and steps in which boundaries are found first, and of spaces in which they
#: are looked at by the way, or one disk begins: 0.03 saves it 1 % of its solutions there.
ROUGH, PROBE = 1e-3, 1e-2
#: Relative distance from the critical friction up to which full stick may stand for slip that is
#: not found.
ONSET = 1e-4
#: Next to no divisor.
TINY = float(np.finfo(float).tiny)
#: ``-ln`` of the rounding of doubles: a boundary is not known more closely.
DEEPEST = -log(np.finfo(float).eps)
#: The error of a space is estimated as 1.6 * change * rate: dropping two degrees makes a change of
#: about rate**-2 times the error. Over 4400 random scenes this is 1.1 times the true error or more.
_POINTWISE = 1.6
#: What a change does to a functional or through a linear map, times this and a power of the rate.
#: Of 300 random scenes the largest errors of shear and boundaries are 0.57 and 0.53 of estimates.
SAFETY = 4.5
#: The change of a boundary may be small by accident: it is not taken to fall faster than this.
LEAST_RATE = 0.25
#: Panel width in ``-ln d``; measured to be cheapest at 1e-12 (docs/theory).
PANEL_WIDTH = 2.0
#: Depth in ``-ln y``, past the layer, from which a singular field is its leading term, to 1e-13.
LEADING = 30.0
#: Below a layer by this much in x, ROOT_TERMS powers of sqrt(d) are exact to rounding.
ROOT_DEPTH = 7.0
#: Degrees per ``-ln`` of the tolerance, on any panel and at a bend. With 0.43 four of 46 random
#: scenes of full stick need another space; with 0.15 at bends the critical friction of one was 18
#: times as far off under the same estimate.
_DEGREES, _AT_BEND = 0.45, 0.2
#: Degrees of a slip zone per ``-ln`` of the accuracy: 0.5 makes slip's estimates 6 times as large.
_IN_SLIP = 0.7
#: Panels on either side of a bend up to which it is felt, and over which that falls.
_REACH, _FADING = 2.6, 1.2
#: What rates of decay are taken to be between, and what they are where signs deceive: with these
#: none of 10,000 random scenes had an estimate below its error.
_FASTEST, _SLOWEST, _LIKELY = 0.05, 0.6, 0.3
#: The first place at which a field is looked at: at 0 q/s is 0/0 and rounds like 1/s, here 30.
_FIRST = 1e-3
#: Places at which a function is looked at together, where its sign changes.
_SECTIONS = 65


@dataclass(frozen=True, slots=True)
class NormalContact:
    """Solution of the normal problem for unit load.

    Attributes
    ----------
    compliance : float
        ``alpha*``.
    approach : float
        ``delta*``.
    pressure : PressureField
        ``p*``.
    panels : LogPanels or None
        Where the series lives; None on a smooth surface, which needs none.
    coefficients : ndarray
        Its coefficients, for the transforms of the tangential problem.
    approach_error, pressure_error : float
        Estimates of the relative errors; of the pressure, pointwise.
    changes : tuple of NormalContact
        What the top two degrees of every panel contribute, as a contact of its own: everything
        tangential is linear in the pressure, so this shows how its error propagates. And the same
        of the top degree alone: where signs make the first small by accident, they do not make
        this one. Empty if it is not wanted.
    rate : float
        By what factor one more degree lowers the change.
    """

    compliance: float
    approach: float
    pressure: PressureField
    panels: LogPanels | None
    coefficients: Array
    approach_error: float = 0.0
    pressure_error: float = 0.0
    changes: tuple[NormalContact, ...] = ()
    rate: float = 0.0


def starting_resolution(layer: float, tolerance: float, *, rate: float = 1.0) -> DiscreteSpace:
    """Return the first space for a solution that settles like ``exp(-rate x)`` past `layer`.

    Parameters
    ----------
    layer : float
        ``x`` of the deepest feature, ``ln(1/width)`` of the thinnest layer.
    tolerance : float
        Relative accuracy asked.
    rate : float
        1 for ``y ln y`` terms at the boundary, 1/2 for square roots.
    """
    # like scenes share their spaces
    return _first_space(PANEL_WIDTH, ceil(2.0 * layer) / 2.0, -log(tolerance), rate)


@bounded_cache("first spaces", 128)
def _first_space(width: float, layer: float, digits: float, rate: float) -> DiscreteSpace:
    # few distinct meshes, so that caches are shared
    panels = 4 * ceil((layer + (digits + 2.0) / rate) / width / 4)
    top: Array = np.full(panels, LEAST_DEGREE + ceil(_DEGREES * digits))
    if layer > 1.0:  # a bend takes more, measured 5 degrees at 1e-12
        top = top + _AT_BEND * digits * nearness(panels, layer)
    x = width * np.arange(panels)
    missing = np.clip(1.0 - rate * (x - layer - 2.0) / digits, 0.0, 1.0)
    # what falls like exp(-x) still bends on its panel: two degrees more than its share
    degrees = np.maximum(np.ceil(np.minimum(top * missing + 2.0, top)).astype(int), LEAST_DEGREE)
    capacity = 4 * ceil((int(degrees.max()) + 1) / 4)
    return DiscreteSpace(LogPanels(panels, width, capacity), tuple(degrees.tolist()))


def nearness(panels: int, bend: float) -> Array:
    """Return how near panels are to a bend: 1 around it, 0 from some three of them on."""
    middles = PANEL_WIDTH * (np.arange(panels) + 0.5)
    distance = np.abs(middles - bend) / (_FADING * PANEL_WIDTH)
    return np.asarray(np.clip(_REACH - distance, 0.0, 1.0))


def slip_degree(tolerance: float) -> int:
    """Return the degree of panels toward the ends of a slip zone, for a relative accuracy.

    The far end of a part is a singularity ln 2 before the first panel.
    """
    return 4 * ceil((4 - _IN_SLIP * log(tolerance)) / 4)


def joined(spaces: Sequence[DiscreteSpace]) -> DiscreteSpace:
    """Return the spaces of all parts as one, for `refine`."""
    capacity = max(one.panels.degree for one in spaces)
    degrees = tuple(n for one in spaces for n in one.degrees)
    return DiscreteSpace(replace(spaces[0].panels, degree=capacity), degrees)


def decay_rates(resolution: DiscreteSpace, coefficients: Array) -> Array:
    """Return by what factor a coefficient falls with one degree, panel by panel."""
    return table_rates(resolution.degrees, resolution.panels.table(coefficients))


def table_rates(degrees: tuple[int, ...], table: Array) -> Array:
    """Return by what factor the rows of `table` fall with one degree, in [0.05, 0.6].

    Taken from the larger ones of the last two pairs, so that a parity pattern does not deceive it.
    """
    terms = table.shape[1]
    places, least = _last_places(degrees, terms)
    one, two, three, four = np.abs(table.ravel()[places])
    last, before = np.maximum(one, two), np.maximum(three, four)
    ratio = np.divide(last, before, out=np.ones(len(last)), where=before > 0.0)
    # in a pattern of longer period the larger ones may be three degrees apart
    outer = (one >= two) & (four >= three)
    rate = np.where(outer, np.cbrt(ratio), np.sqrt(ratio))
    rate[rate < least] = _LIKELY
    return np.asarray(np.minimum(np.maximum(rate, _FASTEST), _SLOWEST))


@bounded_cache("last coefficients", 128)
def _last_places(degrees: tuple[int, ...], terms: int) -> tuple[NDArray[np.int_], Array]:
    """Return where the last four coefficients are in a table, (4, rows), and the least rates."""
    highest = np.array(degrees)
    top = terms * np.arange(len(degrees)) + highest
    # exp(-x), the smoothest there is, falls by 1/(2 n - 1): twice as fast is an accident
    least = 0.5 / np.maximum(2.0 * highest - 1.0, 1.0)
    return np.maximum(top - np.arange(4)[:, None], 0), np.where(highest < 4, np.inf, least)


def boundary_error(shift: float, radius: Radius) -> tuple[float, float]:
    """Return the relative errors of a radius and of its distance to the edge.

    Infinite where the shift of the logit is so large that a linear estimate of it means nothing.
    """
    if shift > 0.5:
        return inf, inf
    return shift * radius.rest / 2.0 + ROUNDING, shift * radius.square + ROUNDING


def expected_error(change: Array, rates: Array) -> Array:
    """Return the estimate of the error left on every panel, from the change of two degrees."""
    return np.asarray(_POINTWISE * change * rates)


def places(depth: float, count: int) -> Array:
    """Return depths ``x = -ln d`` to look at: from next to the far end, where q/s is 0/0, on."""
    return np.linspace(_FIRST, depth, count)


def crossing(function: Callable[[Array], Array], low: float, high: float) -> float:
    """Return the first place between two at which a function changes sign, to rounding.

    It is looked at in many places at once. Where signs do not differ that is the second of the two.
    """
    while high - low > np.spacing(high):
        x = np.linspace(low, high, _SECTIONS)
        above = function(x) > 0.0
        first = int(np.argmax(above != above[0])) or _SECTIONS - 1
        if (low, high) == (x[first - 1], x[first]):
            break
        low, high = float(x[first - 1]), float(x[first])
    return high


def share_of_change(
    panels: LogPanels, change: Array, size: Array, *, leading: float = inf, known: float = inf
) -> Array:
    """Return the change on every panel relative to what it changes there, tail included last.

    The sum of the moduli of Legendre coefficients bounds the change on the whole panel.

    Parameters
    ----------
    panels : LogPanels
    change : ndarray, shape (panels.size,)
        Coefficients.
    size : ndarray, shape (panels.panels + 1,)
        Values at the ends of the panels, as `LogSeries.at_ends`; the lesser one of two counts.
    leading : float
        Depth in ``x`` from which on ever less is felt of a singular field.
    known : float
        Depth past which nothing counts, as the boundary is not known so well.
    """
    total = np.abs(panels.table(change)).sum(axis=1)
    tail = sum(map(abs, change[-panels.tail_terms :].tolist()))
    if panels.power != 0.0:
        d = np.exp(-panels.width * np.arange(1, panels.panels + 1))
        total, tail = total * d**panels.power, tail * panels.end**panels.power
    size = np.maximum(np.abs(size), TINY)
    share = total / np.minimum(size[1:], size[:-1])
    share[-1] = max(share[-1], tail / size[-1])
    if min(leading, known) < inf:
        x = panels.width * np.arange(panels.panels)
        share *= np.exp(-np.maximum(x - leading, 0.0))
        share[x > known] = 0.0
    return np.asarray(share)
