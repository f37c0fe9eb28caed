"""First spaces and error estimates that all contact problems share.

A field is expanded on panels that are graded to an end: with d the distance to it in units of the
extent, panels have equal widths in the depth ``x = -ln d``. A *space* (`DiscreteSpace`) is such a
mesh with a degree on every panel. The estimate of the error on a panel is what its top two degrees
contribute, the *change*: two, because coefficients of one parity may vanish.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import ceil, inf, log

import numpy as np

from spectral_contact.contact.tuning import (
    DEGREES_PER_EFOLD,
    MIN_SAMPLE_DEPTH,
    PANEL_WIDTH,
    ROUNDING,
    SAMPLES,
    SPARE_DEGREES,
    START_DEGREES_PER_EFOLD,
)
from spectral_contact.fields.series import Array, Radius
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels

#: The smallest normal double: added to, or put in place of, a divisor that may be zero.
TINY = float(np.finfo(float).tiny)
#: Stands for the tangential compliance of a regularising disk, whose traction shall vanish
#: (`little_friction`). It is larger than any compliance of a scene, so that it marks such a disk.
REGULARISING_COMPLIANCE = 1.0 / ROUNDING
#: The depth ``x = -ln d`` at which a distance d is the rounding of a double: no boundary is defined
#: more closely, and so far past a layer a singular field is its leading term.
EPSILON_DEPTH = -log(np.finfo(float).eps)
#: Depth of a tail whose three polynomials in d leave ``d**3``, which is rounding.
CUBIC_TAIL_DEPTH = EPSILON_DEPTH / 3.0
#: Depth of a tail of square roots: a boundary is off by ``d**(3/2)`` then, which is rounding. The
#: top degrees of panels show nothing of it. With 13 in place of 24, at rtol 1e-4, a stick radius
#: had an error of 5e-10 and an estimate of 3e-13.
ROOT_TAIL_DEPTH = 2.0 * CUBIC_TAIL_DEPTH


def graded_space(
    settling_depth: float,
    tolerance: float,
    rate: float = 1.0,
    *,
    power: float = 0.0,
    starts_near_singularity: bool = False,
    min_settling: float = 0.0,
) -> DiscreteSpace:
    """Return the first space for fields that settle like ``exp(-rate (x - settling_depth))``.

    Up to that depth all panels have the degree ``SPARE_DEGREES + DEGREES_PER_EFOLD efolds``, where
    efolds are ``-ln tolerance``; beyond it degrees fall in proportion to those that have not
    settled.

    Parameters
    ----------
    settling_depth : float
        In ``x = -ln d``: the depth of the thinnest layer, for example.
    tolerance : float
        Relative accuracy that is wanted.
    rate : float
        1 for terms ``y ln y`` at the end, 1/2 for square roots; with 0 the mesh ends in a tail of
        powers of ``sqrt(d)``.
    power : float
        Of the endpoint weight.
    starts_near_singularity : bool
        Whether the fields are singular not far beyond ``d = 1``: at the other end of a zone of two
        parts, at ``d = 2``, or across the rim of a disk, at ``d = -1``. The first panel takes
        START_DEGREES_PER_EFOLD a digit more then.
    min_settling : float
        Least depth beyond the settling depth at which the mesh ends.
    """
    # rounded up, so that scenes that are much alike have the same space
    depth = ceil(2.0 * settling_depth) / 2.0
    return _graded_space(
        PANEL_WIDTH, depth, -log(tolerance), rate, power, starts_near_singularity, min_settling
    )


@bounded_cache("first spaces")
def _graded_space(
    width: float,
    settling_depth: float,
    efolds: float,
    rate: float,
    power: float,
    starts_near_singularity: bool,
    min_settling: float,
) -> DiscreteSpace:
    # four more than are wanted: the top degrees of the last panel are hardly determined
    mesh_efolds = efolds + 4.0
    settling = max(mesh_efolds / rate, min_settling) if rate else CUBIC_TAIL_DEPTH
    depth = settling_depth + settling
    panels = 2 * ceil(depth / width / 2.0)
    x = width * np.arange(panels)
    unsettled = np.clip(1.0 - rate * (x - settling_depth) / mesh_efolds, 0.0, 1.0)
    degrees = np.ceil(SPARE_DEGREES + DEGREES_PER_EFOLD * efolds * unsettled).astype(int)
    if starts_near_singularity:
        degrees[0] += ceil(START_DEGREES_PER_EFOLD * efolds)
    # a few degrees more than there are, for refinement
    capacity = 4 * ceil((int(degrees.max()) + 4) / 4)
    mesh = LogPanels(panels, width, capacity, power, root_tail=rate == 0.0)
    return DiscreteSpace(mesh, tuple(degrees.tolist()))


def slip_degree(tolerance: float) -> int:
    """Return the degree of all panels toward the ends of a slip zone, for a relative accuracy.

    It is that of a first panel next to a singularity, rounded up to a multiple of four.
    """
    first_panel = SPARE_DEGREES - (DEGREES_PER_EFOLD + START_DEGREES_PER_EFOLD) * log(tolerance)
    return 4 * ceil(first_panel / 4)


def concatenate_spaces(spaces: Sequence[DiscreteSpace]) -> DiscreteSpace:
    """Return the spaces of all parts, one after the other, as one space for `refine`."""
    capacity = max(space.panels.degree for space in spaces)
    degrees = tuple(degree for space in spaces for degree in space.degrees)
    return DiscreteSpace(replace(spaces[0].panels, degree=capacity), degrees)


def radius_errors(logit_error: float, radius: Radius) -> tuple[float, float]:
    """Return the relative errors of a radius c and of its distance ``1 - c`` from the edge.

    With ``d logit = 2 dc / (c (1 - c**2))``. Infinite where the error of the logit is above 1/2, so
    large that the linear estimate of it is not valid.
    """
    if logit_error > 0.5:
        return inf, inf
    of_radius = logit_error * radius.rest / 2.0
    of_distance = logit_error * radius.value * (1.0 + radius.value) / 2.0
    return of_radius + ROUNDING, of_distance + ROUNDING


def sample_depths(depth: float, count: int) -> Array:
    """Return equidistant depths ``x = -ln d``, from MIN_SAMPLE_DEPTH on."""
    return np.linspace(MIN_SAMPLE_DEPTH, depth, count)


def first_sign_change(function: Callable[[Array], Array], low: float, high: float) -> float:
    """Return the first place between two at which a function changes sign, to rounding.

    Each step evaluates it at SAMPLES points and continues between the first two with
    different signs. If all signs are equal the result is `high`.
    """
    while high - low > np.spacing(high):
        x = np.linspace(low, high, SAMPLES)
        positive = function(x) > 0.0
        first = int(np.argmax(positive != positive[0])) or SAMPLES - 1
        if (low, high) == (x[first - 1], x[first]):
            break
        low = float(x[first - 1])
        high = float(x[first])
    return high


def relative_panel_changes(
    panels: LogPanels,
    change: Array,
    size: Array,
    *,
    leading_depth: float = inf,
    cutoff_depth: float = inf,
) -> Array:
    """Return a bound of the change of a field on every panel, relative to the field there.

    The sum of the moduli of Legendre coefficients bounds the change on its panel. The last entry is
    that of the last panel and of the tail beyond it.

    Parameters
    ----------
    panels : LogPanels
    change : ndarray, shape (panels.size,)
        Coefficients of the change.
    size : ndarray, shape (panels.count + 1,)
        Values of the field at the ends of the panels, as `LogSeries.at_ends` returns them; of the
        two of a panel the one with the lesser modulus is taken.
    leading_depth : float
        Depth from which on a singular field is its leading term, and changes of other terms are
        weighted by ``exp(leading_depth - x)``.
    cutoff_depth : float
        Depth beyond which changes do not count, as the boundary has no more digits.
    """
    total = np.abs(panels.table(change)).sum(axis=1)
    tail = sum(map(abs, change[-panels.tail_terms :].tolist()))
    if panels.power != 0.0:
        d = np.exp(-panels.width * np.arange(1, panels.count + 1))
        total = total * d**panels.power
        tail = tail * panels.end**panels.power
    size = np.maximum(np.abs(size), TINY)
    relative = total / np.minimum(size[1:], size[:-1])
    relative[-1] = max(relative[-1], tail / size[-1])
    x = panels.width * np.arange(panels.count)
    relative *= np.exp(-np.maximum(x - leading_depth, 0.0))
    relative[x > cutoff_depth] = 0.0
    return np.asarray(relative)
