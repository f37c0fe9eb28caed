r"""Abel (half-order) integrals of Legendre panels in the logarithm of a distance.

Let ``d = exp(-x)`` be the distance to a boundary (the edge or the end of a zone), in units of the
extent of a part. In ``x`` there are panels ``[j h, (j+1) h]`` of width h, and on each the functions
psi are Legendre polynomials in ``x``, times ``d**power`` where there is an endpoint weight. The
*tail* ``d <= exp(-P h)`` closes the P panels; its functions are Legendre polynomials in ``d``. Only
`abel_right_tail` also takes them in ``sqrt(d)``.
Sources lie at the distance d', points at the distance d before the boundary or e past it:

=========================  =====================================================================
`abel_right`               ``1/2 int_{d' < d} psi dd' / sqrt(d - d')`` (sources at larger ``x``)
`abel_left`                ``1/2 int_{d' > d} psi dd' / sqrt(d' - d)`` (at smaller ``x``)
`exterior_with_decrement`  ``1/2 int psi dd' / sqrt(d' + e)``
=========================  =====================================================================

Next to the boundary the differences to the value there matter. Without cancellation
`left_increment` gives ``abel_left(d) - abel_left(0)``, and the second result of
`exterior_with_decrement` is the integral at the boundary less that at e. `opposite_end_decrement`
is the same with the kernel ``1 / sqrt(2 + e - d')``: the points lie next to the other end of an
annulus, whose two halves have unit extent.

In ``x`` the first two are convolutions, so their blocks depend on the difference of panel numbers
alone. ``u = theta**2`` removes the square-root singularity, where u is the distance in ``x``
between source and point; all else is analytic, and the rules below are converged to rounding
(docs/theory).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.legendre import legendre_sums_between
from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_projection_matrix,
    legendre_values,
    power_rule,
    tail_values,
)
from spectral_contact.spectral.tuning import (
    EXTRA,
    TAIL_TERMS,
)

if TYPE_CHECKING:
    from spectral_contact.spectral.panels import LogPanels

Array = NDArray[np.float64]
#: Indices of the functions that have a column; all have one if there are none.
Functions: TypeAlias = NDArray[np.int_] | None

#: A distance of 0 is replaced by the smallest normal number before its logarithm is taken.
_TINY = float(np.finfo(float).tiny)


class PointSources(Blockwise):
    """Point sources that stand for functions on panels where the kernel is smooth.

    The sources are Gauss points on the panels. This matrix, a block for every panel, maps values of
    a kernel at the sources to ``1/2 int psi kernel dx``: `left_times` takes a matrix whose rows are
    kernels.

    Parameters
    ----------
    width : float
        Width of the panels in ``x``.
    degrees : tuple of int
        Highest Legendre degree on every panel.
    """

    def __init__(self, width: float, degrees: tuple[int, ...]) -> None:
        super().__init__([width / 4 * legendre_projection_matrix(n + EXTRA, n) for n in degrees])
        in_panels = [j + (1.0 + gauss_rule(n + EXTRA)[0]) / 2.0 for j, n in enumerate(degrees)]
        #: distances of the sources from the boundary
        self.d: Array = np.exp(-width * np.concatenate(in_panels))


#: `PointSources`, cached.
point_sources = bounded_cache("point sources")(PointSources)


class Moments(Blockwise):
    """Moments ``1/2 int_0^1 psi density dd`` of functions on panels and tail, for any densities.

    The 1/2 is that of the Abel integrals. The functions psi include the endpoint weight. The
    densities are given at the points `d`.
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        sources = point_sources(panels.width, degrees)
        tail = panels.tail_rule()
        super().__init__([*sources.blocks(), (0.5 * tail.weights)[:, None] * tail.basis])
        #: distances of the points from the boundary
        self.d: Array = np.concatenate([sources.d, tail.points])
        # on the panels dd = d dx
        panel_weights = sources.d ** (1.0 + panels.power)
        self._weights = np.concatenate([panel_weights, tail.points**panels.power])

    def with_densities(self, densities: Array) -> Array:
        """Return moments, (densities, functions), with densities that are rows of values at `d`."""
        return self.left_times(densities * self._weights)


#: `Moments`, cached.
moments_on = bounded_cache("moments with densities")(Moments)


def _kernel_factor(u: Array) -> Array:
    """Return ``sqrt(u / (1 - exp(-u)))``: the Abel kernel in ``x`` without its ``1/sqrt(u)``.

    It is analytic at u = 0.
    """
    safe = np.where(u > 0.0, u, 1.0)
    return np.where(u > 0.0, np.sqrt(safe / -np.expm1(-safe)), 1.0)


def _legendre_sums(values: Array, local: Array, degree: int) -> Array:
    """Return sums of values (n, q) times Legendre polynomials at `local` in [-1, 1], (n, q)."""
    return np.asarray((values[:, None, :] @ legendre_values(local, degree))[:, 0, :])


def _root_rule(lower: Array, upper: Array, nodes: Array, weights: Array) -> tuple[Array, ...]:
    """Return ``u``, ``u - lower``, ``upper - u`` and weights of ``int . du / (2 sqrt(u))``.

    A Gauss rule on [-1, 1], given by its nodes and weights, is applied in ``sqrt(u)`` between the
    limits `lower` and `upper`. All distances keep their digits.
    """
    low_root = np.sqrt(lower)[:, None]
    high_root = np.sqrt(upper)[:, None]
    both = low_root + high_root
    span = (upper - lower)[:, None] / np.where(both > 0.0, both, 1.0)
    step = span * (1.0 + nodes) / 2.0
    root = low_root + step
    to_upper = span * (1.0 - nodes) / 2.0 * (root + high_root)
    return root**2, step * (root + low_root), to_upper, weights * span / 2.0


def abel_right_blocks(
    to_end: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return blocks of the `abel_right` integral for points inside one panel.

    Parameters
    ----------
    to_end : ndarray, shape (n,)
        Distance in ``x`` from each point to the end of its panel next to the boundary, in
        [0, width].
    panels : int
        Number of blocks: block k integrates over the panel k places nearer the boundary than the
        panel of the points.
    width : float
        Panel width in ``x``.
    degree : int
        Highest Legendre degree.
    power : float
        Endpoint weight: the functions are ``d**power`` times Legendre polynomials.

    Returns
    -------
    ndarray, shape (n, panels, degree + 1)
        To be multiplied by ``d**(1/2 + power)`` of the point.
    """
    near_panels = abel_right_near_blocks(to_end, width - to_end, panels, width, degree, power)
    far_panels = abel_right_far_blocks(to_end, panels, width, degree, power)
    return np.concatenate([near_panels, far_panels], axis=1)


def abel_right_near_blocks(
    to_end: Array, from_start: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return the blocks of the panel of the points and of the next, where the kernel is singular.

    Parameters are those of `abel_right_blocks`, and `from_start`, (n,), the distance in ``x`` from
    the other end of the panel to the points: points next to either end keep their digits.
    """
    g, w = gauss_rule(degree + EXTRA)
    blocks = np.empty((len(to_end), min(panels, 2), degree + 1))
    lower = np.zeros(len(to_end))
    upper = to_end
    for k in range(blocks.shape[1]):
        u, start, end, weights = _root_rule(lower, upper, g, w)
        if k == 0:
            start += from_start[:, None]
        values = np.exp(-(1.0 + power) * u) * _kernel_factor(u) * weights
        blocks[:, k] = legendre_sums_between(values, 2.0 * start / width, 2.0 * end / width, degree)
        lower, upper = upper, upper + width
    return blocks


def abel_right_far_blocks(
    to_end: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return the blocks of panels two places nearer the boundary and more: the kernel is smooth.

    Parameters are those of `abel_right_blocks`.
    """
    g, _ = gauss_rule(degree + EXTRA)
    start = to_end[:, None] + width * np.arange(1, max(panels - 1, 1))
    step = width * (1.0 + g) / 2.0
    rate = 1.0 + power
    blocks = _smooth_blocks(start, step, width / 4 * np.exp(-rate * step), degree)
    return np.asarray(np.exp(-rate * start)[:, :, None] * blocks)


def _smooth_blocks(start: Array, step: Array, weights: Array, degree: int) -> Array:
    """Return sums of Legendre polynomials times ``weights / sqrt(1 - exp(-u))`` over Gauss points.

    The distance ``u = start + step`` is so large that ``1 - exp(-u)`` loses no digits, and
    ``exp(-u)`` is a product of two factors.

    Parameters
    ----------
    start : ndarray, shape (n, panels)
        Distance in ``x`` from each point to each panel.
    step, weights : ndarray, shape (degree + EXTRA,)
        Further distance to each Gauss point, and what the kernel is multiplied by there.
    degree : int
        Highest Legendre degree.
    """
    kernel = np.exp(-start)[:, :, None] * np.exp(-step)
    np.sqrt(np.subtract(1.0, kernel, out=kernel), out=kernel)
    np.divide(weights, kernel, out=kernel)
    return np.asarray(kernel @ legendre_projection_matrix(len(step), degree))


def abel_left_blocks(
    from_start: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return blocks of the `abel_left` integral for points inside one panel.

    Parameters
    ----------
    from_start : ndarray, shape (n,)
        Distance in ``x`` to each point from the end of its panel that is far from the boundary. A
        point in the tail counts to the last panel, and its distance exceeds the width.
    panels : int
        Number of blocks: block k integrates over the panel k places farther from the boundary than
        the panel of the points.
    width, degree, power
        As of `abel_right_blocks`.

    Returns
    -------
    ndarray, shape (n, panels, degree + 1)
        To be multiplied by ``exp(-(1/2 + power) x_j)`` of the start ``x_j`` of the source panel.
    """
    g, w = gauss_rule(degree + EXTRA)
    blocks = np.empty((len(from_start), panels, degree + 1))
    lower = np.maximum(from_start - width, 0.0)  # a point in the tail lies past its panel
    upper = from_start
    for k in range(min(panels, 2)):
        u, end, offset, weights = _root_rule(lower, upper, g, w)
        if k == 0:  # the end of the panel lies nearer the boundary than the points
            end += np.maximum(width - from_start, 0.0)[:, None]
        values = np.exp(-(0.5 + power) * offset) * _kernel_factor(u) * weights
        ends = 2.0 * offset / width, 2.0 * end / width
        blocks[:, k] = legendre_sums_between(values, *ends, degree)
        lower, upper = upper, upper + width
    if panels > 2:
        offset = width * (1.0 + g) / 2.0
        start = from_start[:, None] + width * np.arange(2, panels)
        far_weights = width / 4 * np.exp(-(0.5 + power) * offset)
        blocks[:, 2:] = _smooth_blocks(start, -offset, far_weights, degree)
    return blocks


def abel_right_tail(
    d: Array, end: float, terms: int = TAIL_TERMS, power: float = 0.0, root: bool = False
) -> Array:
    """Return the `abel_right` integral of ``d**power`` times the tail polynomials, (n, terms).

    The tail ends at the distance `end`; `root` says that it is polynomial in ``sqrt(d)``.
    """
    exponent = 1.0 + 2.0 * power
    nodes, weights = power_rule(terms + EXTRA, exponent)
    phi = np.arcsin(np.sqrt(np.minimum(end / d, 1.0)))[:, None]
    sine = np.sin(phi * nodes)  # d' = d sin(phi)**2 removes both square roots
    source = np.minimum(d[:, None] * sine**2, end)
    values = weights * phi * (sine / nodes) ** exponent * d[:, None] ** (0.5 + power)
    return np.asarray((values[:, None, :] @ tail_values(source, end, terms, root))[:, 0, :])


def _abel_left_tail(d: Array, end: float, power: float) -> Array:
    """Return the `abel_left` integral of ``d**power`` times the tail polynomials, (n, terms)."""
    if power != 0.0:  # d' = d cosh(phi)**2: with the power -1/2 the integral has a logarithm
        g, w = gauss_rule(TAIL_TERMS + 2 * EXTRA)
        phi = np.arccosh(np.sqrt(np.maximum(end / d, 1.0)))[:, None]
        root = np.sqrt(d)[:, None] * np.cosh(phi * (1.0 + g) / 2.0)
        source = np.minimum(root**2, end)
        values = w * phi / 2.0 * root ** (1.0 + 2.0 * power)
    else:
        g, w = gauss_rule(TAIL_TERMS + 1)
        span = np.sqrt(np.maximum(end - d, 0.0))[:, None]
        source = d[:, None] + (span * (1.0 + g) / 2.0) ** 2
        values = w * span / 2.0
    return _legendre_sums(values, 2.0 * source / end - 1.0, TAIL_TERMS - 1)


def _computed_blocks(
    computed: list[tuple[Array, Array]], local: Array, depth: float
) -> Array | None:
    """Return blocks that were computed for points at the same places in another panel, if any.

    `computed` has the places in their panel of points, and the blocks for them. Places are
    differences of depths, which round as the largest `depth` does. Next to an end of its panel a
    place that was rounded so costs digits: the blocks of one panel serve all that are alike.
    """
    for known_places, blocks in computed:
        same_count = len(known_places) == len(local)
        if same_count and float(np.abs(known_places - local).max()) < 2.0 * np.spacing(depth):
            return blocks
    return None


def abel_right(d: Array, panels: int, width: float, degree: int, power: float = 0.0) -> Array:
    """Return the matrix of the `abel_right` integral at arbitrary distances.

    Parameters
    ----------
    d : ndarray, shape (n,)
        Positive distances; above 1 is allowed (points past the first panel).
    panels, width, degree, power
        The panels, as in `abel_right_blocks`.

    Returns
    -------
    ndarray, shape (n, panels * (degree + 1) + TAIL_TERMS)
    """
    x = -np.log(d)
    panel_of_point = np.minimum(np.floor(x / width).astype(int), panels)
    matrix = np.zeros((len(d), panels, degree + 1))
    computed: list[tuple[Array, Array]] = []
    for i in np.unique(panel_of_point[panel_of_point < panels]):
        rows = np.flatnonzero(panel_of_point == i)
        to_end = np.clip((i + 1) * width - x[rows], 0.0, width)
        blocks = _computed_blocks(computed, to_end, panels * width)
        if blocks is None:
            blocks = abel_right_blocks(to_end, panels - i, width, degree, power)
            computed.append((to_end, blocks))
        root = d[rows, None, None] ** (0.5 + power)
        matrix[rows, max(i, 0) :] = blocks[:, max(-i, 0) : panels - i] * root
    tail = abel_right_tail(d, np.exp(-panels * width), power=power)
    return np.hstack([matrix.reshape(len(d), panels * (degree + 1)), tail])


def abel_left(
    d: Array,
    panels: int,
    width: float,
    degree: int,
    power: float = 0.0,
    functions: Functions = None,
) -> Array:
    """Return the matrix of the `abel_left` integral at arbitrary distances in [0, 1].

    Parameters are those of `abel_right`. With a `power` d must be positive. The matrix has a column
    for each of `functions`, indices that end with the tail's, or for all if there are none.
    """
    end = np.exp(-panels * width)
    terms = degree + 1
    x = -np.log(np.maximum(d, _TINY))
    panel_of_point = np.clip(np.floor(x / width).astype(int), 0, panels + 1)
    on_panels = np.arange(panels * terms) if functions is None else functions[:-TAIL_TERMS]
    panel = on_panels // terms
    # block k of a point in panel i belongs to panel i - k
    reversed_columns = on_panels - 2 * terms * panel
    scale = np.exp(-(0.5 + power) * width * panel)
    matrix = np.zeros((len(d), len(on_panels) + TAIL_TERMS))
    matrix[:, len(on_panels) :] = _abel_left_tail(d, end, power)
    # next to points deep in the tail the kernel is smooth on all panels, and `point_sources` keep
    # the digits of the distances to them
    deep = panel_of_point > panels
    sources = point_sources(width, (degree,) * panels)
    kernels = sources.d ** (1.0 + power) / np.sqrt(sources.d - d[deep, None])
    matrix[deep, : len(on_panels)] = sources.left_times(kernels)[:, on_panels]
    computed: list[tuple[Array, Array]] = []
    points_in_panel = np.bincount(panel_of_point, minlength=1)[: panels + 1]
    for occupied in np.flatnonzero(points_in_panel).tolist():
        rows = np.flatnonzero(panel_of_point == occupied)
        i = min(occupied, panels - 1)
        offset = np.maximum(x[rows] - i * width, 0.0)
        blocks = _computed_blocks(computed, offset, panels * width)
        if blocks is None:
            # enough for the last panel that has the same number of points, and may share them
            last_alike = int(np.flatnonzero(points_in_panel == len(rows))[-1])
            count = min(last_alike + 1, panels)
            blocks = abel_left_blocks(offset, count, width, degree, power).reshape(len(rows), -1)
            computed.append((offset, blocks))
        last = np.searchsorted(panel, i, "right")
        columns = i * terms + reversed_columns[:last]
        matrix[rows, :last] = blocks[:, columns] * scale[:last]
    return matrix


def exterior_tail(e: Array, end: float) -> Array:
    """Return ``1/2 int psi dd' / sqrt(d' + e)`` of the tail polynomials, (n, TAIL_TERMS)."""
    g, w = gauss_rule(TAIL_TERMS + 1)
    low_root = np.sqrt(e)[:, None]
    high_root = np.sqrt(e + end)[:, None]
    # the variable sqrt(d' + e) removes the square root of the kernel
    span = end / (low_root + high_root)
    step = span * (1.0 + g) / 2.0
    source = step * (2.0 * low_root + step)
    return np.asarray(_legendre_sums(w * span / 2.0, 2.0 * source / end - 1.0, TAIL_TERMS - 1))


def exterior_with_decrement(
    e: Array, width: float, degrees: tuple[int, ...]
) -> tuple[Array, Array]:
    """Return ``1/2 int psi dd' / sqrt(d' + e)`` at ``e >= 0``, and its decrement from ``e = 0``.

    In the decrement nothing cancels: its kernel is
    ``1/sqrt(d') - 1/sqrt(d' + e) = e / (sqrt(d') sqrt(d' + e) (sqrt(d') + sqrt(d' + e)))``.
    There are columns for the functions up to the degree of each panel of the given `width` in x.
    """
    end = np.exp(-len(degrees) * width)
    sources = point_sources(width, degrees)
    root_at_boundary = np.sqrt(sources.d)
    # one array, of sqrt(d' + e), becomes the kernel of the decrement; `work` is overwritten
    kernels = sources.d + e[:, None]
    np.sqrt(kernels, out=kernels)
    work = sources.d / kernels
    exterior = np.hstack([sources.left_times(work), exterior_tail(e, end)])
    kernels *= np.add(root_at_boundary, kernels, out=work)
    np.divide(e[:, None], kernels, out=kernels)
    kernels *= root_at_boundary
    decrement = np.hstack([sources.left_times(kernels), exterior_decrement_tail(e, end)])
    return exterior, decrement


def exterior_decrement_tail(e: Array, end: float) -> Array:
    """Return ``exterior_tail(0, end) - exterior_tail(e, end)``, (n, TAIL_TERMS)."""
    tail = exterior_tail(np.zeros(1), end) - exterior_tail(e, end)
    # closed forms of the three polynomials, with d' = e sinh(phi)**2: for e < end/2 these are right
    # to rounding, where the difference above is right to 5e-15 at e = 1e-3 end
    small = (e > 0.0) & (e < 0.5 * end)
    ratio = e[small] / end
    grown = np.exp(np.arcsinh(np.sqrt(end / e[small])))
    # exp(n phi) - 1 at the end of the tail
    plus_1, minus_1, minus_3, minus_5 = (grown ** float(n) - 1.0 for n in (1, -1, -3, -5))
    # decrements of the powers 0, 1 and 2 of d'/end
    zeroth = -minus_1
    first = ratio * (plus_1 / 4 + minus_1 / 2 - minus_3 / 12)
    # ratio**2 times grown**3, which may overflow
    highest = np.sqrt(ratio) * (np.sqrt(ratio) * grown) ** 3
    lower = plus_1 / 4 + 3 * minus_1 / 8 - minus_3 / 12 + minus_5 / 80
    second = (highest - ratio**2) / 48 - ratio**2 * lower
    legendre = [zeroth, 2 * first - zeroth, 6 * (second - first) + zeroth]
    tail[small] = np.sqrt(e[small])[:, None] * np.column_stack(legendre)
    return np.asarray(tail)


def opposite_end_decrement(
    e: Array, width: float, degrees: tuple[int, ...], power: float = 0.0
) -> Array:
    """Return ``1/2 int d'**power psi (1/sqrt(2 - d') - 1/sqrt(2 + e - d')) dd'`` for ``e > -1``.

    The two halves of an annulus have unit extent, so that their boundaries are 2 apart. This is
    the decrement of the integral of one half from the boundary of the other to e past it, for the
    functions on the panels.
    """
    sources = point_sources(width, degrees)
    root_at_boundary = np.sqrt(2.0 - sources.d)
    root = np.sqrt(2.0 - sources.d + e[:, None])
    kernels = e[:, None] / (root_at_boundary * root * (root_at_boundary + root))
    return sources.left_times(sources.d ** (1.0 + power) * kernels)


def abel_left_at_boundary(panels: int, width: float, degree: int, power: float = 0.0) -> Array:
    """Return ``1/2 int d**(power - 1/2) psi dd``, the `abel_left` integral at the boundary itself.

    Of all functions, with ``power > -1/2``.
    """
    sources = point_sources(width, (degree,) * panels)
    end = float(np.exp(-panels * width))
    nodes, weights = power_rule(TAIL_TERMS, power - 0.5)
    tail = end ** (0.5 + power) / 2.0 * weights @ legendre_values(2.0 * nodes - 1.0, TAIL_TERMS - 1)
    return np.append(sources.left_times(sources.d[None] ** (0.5 + power))[0], tail)


def left_increment(
    value: Array,
    boundary_value: Array,
    functions: NDArray[np.int_],
    d: Array,
    panels: int,
    width: float,
    degree: int,
    power: float = 0.0,
) -> Array:
    """Return ``abel_left(d) - abel_left(0)`` at distances `d` in [0, 1].

    `value`, (n, functions), is the matrix `abel_left` at d of these functions, and
    `boundary_value`, (functions,), what `abel_left_at_boundary` gives for them; other parameters
    are those of `abel_right`. On panels at least two places farther from the boundary than a point,
    the difference of the kernels is integrated; on nearer panels neither integral is much larger
    than their difference, which loses no digits.
    """
    increment = value - boundary_value
    x = np.maximum(-np.log(np.maximum(d, _TINY)), 0.0)
    panel_of_point = np.minimum(np.floor(x / width).astype(int), panels + 1)
    sources = point_sources(width, (degree,) * panels).d.reshape(panels, -1)
    projection = legendre_projection_matrix(degree + EXTRA, degree)
    for i in np.unique(panel_of_point[panel_of_point >= 2]).tolist():
        rows = np.flatnonzero(panel_of_point == i)
        far_sources = sources[: min(i - 1, panels)]
        shift = d[rows, None, None]
        root = np.sqrt(far_sources - shift)
        root_at_boundary = np.sqrt(far_sources)
        kernels = shift / (root * root_at_boundary * (root + root_at_boundary))
        blocks = (width / 4 * far_sources ** (1.0 + power) * kernels) @ projection
        last = np.searchsorted(functions, len(far_sources) * (degree + 1))
        increment[rows, :last] = blocks.reshape(len(rows), -1)[:, functions[:last]]
    return np.asarray(increment)
