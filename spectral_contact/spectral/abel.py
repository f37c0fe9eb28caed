r"""Abel (half-order) integrals of Legendre panels in the logarithm of a distance.

Let ``d = exp(-x)`` be the distance to a boundary (an edge or the end of a zone), and let ``x`` run
over panels ``[j h, (j+1) h]`` with Legendre polynomials ``psi`` on each, closed by a tail
``d <= exp(-P h)`` with Legendre polynomials in ``d``. Three integrals serve every operator:

==========  =====================================================================
``deeper``  ``1/2 * int_{d' < d} psi dd' / sqrt(d - d')``   (sources nearer the boundary)
``outer``   ``1/2 * int_{d' > d} psi dd' / sqrt(d' - d)``   (sources farther from it)
``beyond``  ``1/2 * int psi dd' / sqrt(d' + e)``            (points past the boundary)
==========  =====================================================================

In ``x`` the first two are convolutions, so their blocks depend on the difference of panel numbers
alone. The square-root singularity is removed by ``u = theta**2``; all else is analytic, and the
rules below are converged to rounding (docs/theory).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from spectral_contact.fields.legendre import legendre_sums_between
from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.jacobi import (
    EXTRA,
    TAIL_EXTRA,
    TAIL_TERMS,
    gauss_rule,
    legendre_projection_matrix,
    legendre_values,
    tail_values,
)

if TYPE_CHECKING:
    from spectral_contact.spectral.panels import LogPanels

Array = NDArray[np.float64]
Places: TypeAlias = NDArray[np.int_] | None

#: Places in ``x`` that are the same to the rounding of an ``x`` of 50.
_SAME = 2e-14
_TINY = float(np.finfo(float).tiny)


class Charges(Blockwise):
    """Functions on panels as charges at points, for what is seen of them beyond a boundary.

    A function is a column, and has the values `of` it at the points; rows are kernels there, and
    `after` them are the integrals over ``1/2 dx`` with functions.
    """

    def __init__(self, width: float, degrees: tuple[int, ...]) -> None:
        super().__init__([width / 4 * legendre_projection_matrix(n + EXTRA, n) for n in degrees])
        middles = [j + (1.0 + gauss_rule(n + EXTRA)[0]) / 2.0 for j, n in enumerate(degrees)]
        #: distances of the points
        self.d: Array = np.exp(-width * np.concatenate(middles))


charges_on = bounded_cache("charges on panels", 128)(Charges)


class Moments(Blockwise):
    """``1/2 int_0^1 psi density dy`` of functions on panels and the tail, over densities at points.

    Psi has the endpoint weight.
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        charges, tail = charges_on(panels.width, degrees), panels.tail_rule()
        super().__init__([*charges.blocks(), (0.5 * tail.weights)[:, None] * tail.basis])
        #: distances of the points
        self.d: Array = np.concatenate([charges.d, tail.points])
        own = charges.d ** (1.0 + panels.power)
        self._weights = np.concatenate([own, tail.points**panels.power])

    def with_densities(self, densities: Array) -> Array:
        """Return them with densities at the points, as rows."""
        return self.after(densities * self._weights)


moments_on = bounded_cache("moments with densities", 128)(Moments)


def _smooth(u: Array) -> Array:
    """Return sqrt(u / (1 - exp(-u))), analytic at u = 0."""
    safe = np.where(u > 0.0, u, 1.0)
    return np.where(u > 0.0, np.sqrt(safe / -np.expm1(-safe)), 1.0)


def _panel(values: Array, local: Array, degree: int) -> Array:
    """Contract quadrature `values` (n, q) with the Legendre polynomials at `local` (n, q)."""
    return np.asarray((values[:, None, :] @ legendre_values(local, degree))[:, 0, :])


def _root_rule(lower: Array, upper: Array, g: Array, w: Array) -> tuple[Array, ...]:
    """Return ``u``, ``u - lower``, ``upper - u`` and weights of ``int . du / (2 sqrt(u))``.

    The rule ``g, w`` is applied in ``sqrt(u)``. The distances keep their digits.
    """
    a, b = np.sqrt(lower)[:, None], np.sqrt(upper)[:, None]
    span = (upper - lower)[:, None] / np.where(a + b > 0.0, a + b, 1.0)
    step = span * (1.0 + g) / 2.0
    root = a + step
    return root**2, step * (root + a), span * (1.0 - g) / 2.0 * (root + b), w * span / 2.0


def deeper_blocks(
    to_end: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return blocks of the `deeper` integral for points inside one panel.

    Parameters
    ----------
    to_end : ndarray, shape (n,)
        Distance in ``x`` from each point to the deep end of its own panel, in [0, width].
    panels : int
        Number of blocks: block k takes the panel k places deeper than the point's own.
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
    near = near_blocks(to_end, width - to_end, panels, width, degree, power)
    return np.concatenate([near, far_blocks(to_end, panels, width, degree, power)], axis=1)


def near_blocks(
    to_end: Array, from_start: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return the blocks of the panel of the points and of the next: ``u = theta**2``.

    Parameters are those of `deeper_blocks`, and the distance from the shallow end.
    """
    g, w = gauss_rule(degree + EXTRA)
    blocks = np.empty((len(to_end), min(panels, 2), degree + 1))
    lower, upper = np.zeros(len(to_end)), to_end
    for k in range(blocks.shape[1]):
        u, start, end, weights = _root_rule(lower, upper, g, w)
        if k == 0:
            start += from_start[:, None]
        values = np.exp(-(1.0 + power) * u) * _smooth(u) * weights
        blocks[:, k] = legendre_sums_between(values, 2.0 * start / width, 2.0 * end / width, degree)
        lower, upper = upper, upper + width
    return blocks


def far_blocks(to_end: Array, panels: int, width: float, degree: int, power: float = 0.0) -> Array:
    """Return the blocks of panels two places deeper and more, which are smooth.

    Parameters are those of `deeper_blocks`.
    """
    g, _ = gauss_rule(degree + EXTRA)
    start = to_end[:, None] + width * np.arange(1, max(panels - 1, 1))
    # far enough for 1 - exp(-u) to lose nothing, and exp(-u) is a product
    step = width * (1.0 + g) / 2.0
    values = np.exp(-start)[:, :, None] * np.exp(-step)
    np.sqrt(np.subtract(1.0, values, out=values), out=values)
    np.divide((width / 4) * np.exp(-(1.0 + power) * step), values, out=values)
    values *= np.exp(-(1.0 + power) * start)[:, :, None]
    return np.asarray(values @ legendre_projection_matrix(len(g), degree))


def outer_blocks(
    from_start: Array, panels: int, width: float, degree: int, power: float = 0.0
) -> Array:
    """Return blocks of the `outer` integral for points inside one panel.

    Parameters
    ----------
    from_start : ndarray, shape (n,)
        Distance in ``x`` from the shallow end of its own panel to each point; may exceed the
        width for points in the tail.
    panels : int
        Number of blocks: block k takes the panel k places shallower than the point's own.
    width, degree, power
        As of `deeper_blocks`.

    Returns
    -------
    ndarray, shape (n, panels, degree + 1)
        To be multiplied by ``exp(-(1/2 + power) x_j)`` of the shallow end ``x_j`` of the source
        panel.
    """
    g, w = gauss_rule(degree + EXTRA)
    blocks = np.empty((len(from_start), panels, degree + 1))
    lower = np.maximum(from_start - width, 0.0)  # a point in the tail lies past its panel
    upper = from_start
    for k in range(min(panels, 2)):
        u, end, offset, weights = _root_rule(lower, upper, g, w)
        if k == 0:  # the panel ends before the point in the tail, or beyond it
            end += np.maximum(width - from_start, 0.0)[:, None]
        values = np.exp(-(0.5 + power) * offset) * _smooth(u) * weights
        ends = 2.0 * offset / width, 2.0 * end / width
        blocks[:, k] = legendre_sums_between(values, *ends, degree)
        lower, upper = upper, upper + width
    if panels > 2:  # as of `far_blocks`
        offset, start = width * (1.0 + g) / 2.0, from_start[:, None] + width * np.arange(2, panels)
        values = np.exp(-start)[:, :, None] * np.exp(offset)
        np.sqrt(np.subtract(1.0, values, out=values), out=values)
        np.divide((width / 4) * np.exp(-(0.5 + power) * offset), values, out=values)
        blocks[:, 2:] = values @ legendre_projection_matrix(len(g), degree)
    return blocks


def deeper_tail(
    d: Array, end: float, terms: int = TAIL_TERMS, power: float = 0.0, root: bool = False
) -> Array:
    """Return the `deeper` integral of ``d**power`` times the tail polynomials, (n, terms)."""
    g, w = gauss_rule(terms + TAIL_EXTRA)
    phi = np.arcsin(np.sqrt(np.minimum(end / d, 1.0)))[:, None]
    sine = np.sin(phi * (1.0 + g) / 2.0)  # d' = d sin(phi)**2 removes both square roots
    source = np.minimum(d[:, None] * sine**2, end)
    values = w * phi / 2.0 * sine ** (1.0 + 2.0 * power) * d[:, None] ** (0.5 + power)
    return np.asarray((values[:, None, :] @ tail_values(source, end, terms, root))[:, 0, :])


def _outer_tail(d: Array, end: float, power: float) -> Array:
    """Return the `outer` integral of ``d**power`` times the tail polynomials, (n, TAIL_TERMS)."""
    if power != 0.0:  # d' = d cosh(phi)**2: with the power -1/2 the integral has a logarithm
        g, w = gauss_rule(TAIL_TERMS + 24)
        phi = np.arccosh(np.sqrt(np.maximum(end / d, 1.0)))[:, None]
        root = np.sqrt(d)[:, None] * np.cosh(phi * (1.0 + g) / 2.0)
        source, values = np.minimum(root**2, end), w * phi / 2.0 * root ** (1.0 + 2.0 * power)
    else:
        g, w = gauss_rule(TAIL_TERMS + 1)
        span = np.sqrt(np.maximum(end - d, 0.0))[:, None]
        source, values = d[:, None] + (span * (1.0 + g) / 2.0) ** 2, w * span / 2.0
    return _panel(values, 2.0 * source / end - 1.0, TAIL_TERMS - 1)


def _alike(found: list[tuple[Array, Array]], places: Array) -> Array | None:
    """Return the blocks of a panel with its points at the same places, if there are any."""
    for own, blocks in found:
        if len(own) == len(places) and float(np.abs(own - places).max()) < _SAME:
            return blocks
    return None


def deeper(d: Array, panels: int, width: float, degree: int, power: float = 0.0) -> Array:
    """Return the matrix of the `deeper` integral at arbitrary distances.

    Parameters
    ----------
    d : ndarray, shape (n,)
        Positive distances; above 1 is allowed (points past the first panel).
    panels, width, degree, power
        The panels, as in `deeper_blocks`.

    Returns
    -------
    ndarray, shape (n, panels * (degree + 1) + TAIL_TERMS)
    """
    x = -np.log(d)
    own = np.minimum(np.floor(x / width).astype(int), panels)
    matrix = np.zeros((len(d), panels, degree + 1))
    clear = np.flatnonzero(own < -1)
    if len(clear):
        matrix[clear] = plain(-d[clear], panels, width, degree, power)
    found: list[tuple[Array, Array]] = []
    for i in np.unique(own[(own < panels) & (own >= -1)]):
        rows = np.flatnonzero(own == i)
        to_end = np.clip((i + 1) * width - x[rows], 0.0, width)
        known = _alike(found, to_end)
        if known is None:
            known = deeper_blocks(to_end, panels - i, width, degree, power)
            found.append((to_end, known))
        blocks = known[:, : panels - i]
        root = np.sqrt(d[rows]) * (d[rows] ** power if power else 1.0)
        matrix[rows, max(i, 0) :] = blocks[:, max(-i, 0) :] * root[:, None, None]
    tail = deeper_tail(d, np.exp(-panels * width), power=power)
    return np.hstack([matrix.reshape(len(d), panels * (degree + 1)), tail])


def outer(
    d: Array, panels: int, width: float, degree: int, power: float = 0.0, functions: Places = None
) -> Array:
    """Return the matrix of the `outer` integral at arbitrary distances in [0, 1].

    Shapes are those of `deeper`, or columns are those of some functions and of the tail; `power` is
    the endpoint weight, with which d must be positive.
    """
    end, terms = np.exp(-panels * width), degree + 1
    x = -np.log(np.maximum(d, _TINY))
    own = np.clip(np.floor(x / width).astype(int), 0, panels + 1)
    inner = np.arange(panels * terms) if functions is None else functions[:-TAIL_TERMS]
    panel = inner // terms
    # a panel is as far from that of a point as it is higher up
    places, scale = inner - 2 * terms * panel, np.exp(-(0.5 + power) * width * panel)
    matrix = np.zeros((len(d), len(inner) + TAIL_TERMS))
    matrix[:, len(inner) :] = _outer_tail(d, end, power)
    # far below the panels the plain rule keeps the distance itself
    clear = own > panels
    far_off = plain(-d[clear], panels, width, degree, power)
    matrix[clear, : len(inner)] = far_off.reshape(-1, panels * terms)[:, inner]
    found: list[tuple[Array, Array]] = []
    number = np.bincount(own, minlength=1)[: panels + 1]
    for place in np.flatnonzero(number).tolist():
        rows, i = np.flatnonzero(own == place), min(place, panels - 1)
        offset = np.maximum(x[rows] - i * width, 0.0)
        known = _alike(found, offset)
        if known is None:
            most = min(int(np.flatnonzero(number == len(rows))[-1]) + 1, panels)
            known = outer_blocks(offset, most, width, degree, power).reshape(len(rows), -1)
            found.append((offset, known))
        last = np.searchsorted(panel, i, "right")
        matrix[rows, :last] = known.take(i * terms + places[:last], axis=1) * scale[:last]
    return matrix


def plain(e: Array, panels: int, width: float, degree: int, power: float = 0.0) -> Array:
    """Return ``1/2 int d'**power psi dd' / sqrt(|d' + e|)`` on the panels, e clear of ``-d'``."""
    source = charges_on(width, (degree,) * panels).d.reshape(panels, -1)
    values = (width / 4) * source / np.sqrt(np.abs(source + e[:, None, None]))
    if power != 0.0:
        values *= source**power
    return np.asarray(values @ legendre_projection_matrix(degree + EXTRA, degree))


def beyond(e: Array, panels: int, width: float, degree: int | tuple[int, ...]) -> Array:
    """Return the matrix of `beyond` at distances `e` >= 0; degrees may be those of each panel."""
    charges = charges_on(width, (degree,) * panels if isinstance(degree, int) else degree)
    kernels = charges.d + e[:, None]
    np.divide(charges.d, np.sqrt(kernels, out=kernels), out=kernels)
    return np.hstack([charges.after(kernels), beyond_tail(e, np.exp(-panels * width))])


def beyond_tail(e: Array, end: float) -> Array:
    """Return the `beyond` integral of the tail polynomials, (n, TAIL_TERMS)."""
    g, w = gauss_rule(TAIL_TERMS + 1)
    a, b = np.sqrt(e)[:, None], np.sqrt(e + end)[:, None]
    span = end / (a + b)
    step = span * (1.0 + g) / 2.0
    source = step * (2.0 * a + step)
    return np.asarray(_panel(w * span / 2.0, 2.0 * source / end - 1.0, TAIL_TERMS - 1))


def fall(e: Array, width: float, degrees: tuple[int, ...]) -> tuple[Array, Array]:
    """Return `beyond`, and by how much it is less than at the boundary, where nothing cancels.

    Only functions up to the highest degree of each panel have columns.
    """
    end, charges = np.exp(-len(degrees) * width), charges_on(width, degrees)
    near, far = np.sqrt(charges.d), charges.d + e[:, None]
    np.sqrt(far, out=far)
    work = charges.d / far
    plain = np.hstack([charges.after(work), beyond_tail(e, end)])
    far *= np.add(near, far, out=work)
    np.divide(e[:, None], far, out=far)
    far *= near
    return plain, np.hstack([charges.after(far), fall_of_tail(e, end)])


def fall_of_tail(e: Array, end: float) -> Array:
    """Return by how much `beyond_tail` is less than at the boundary, (n, TAIL_TERMS)."""
    tail = beyond_tail(np.zeros(1), end) - beyond_tail(e, end)
    # d' = e sinh(phi)**2: below half its end this is right to rounding, the difference to 5e-15 at
    # 1e-3 of it
    small = (e > 0.0) & (e < 0.5 * end)
    ratio = e[small] / end
    grown = np.exp(np.arcsinh(np.sqrt(end / e[small])))
    one, two, three, five = (grown ** float(n) - 1.0 for n in (1, -1, -3, -5))
    # of the powers of d'/end
    zeroth = -two
    first = ratio * (one / 4 + two / 2 - three / 12)
    highest = (grown**3 - 1.0) / 48 - one / 4
    second = ratio**2 * (highest - 3 * two / 8 + three / 12 - five / 80)
    legendre = [zeroth, 2 * first - zeroth, 6 * (second - first) + zeroth]
    tail[small] = np.sqrt(e[small])[:, None] * np.column_stack(legendre)
    return np.asarray(tail)


def far_fall(e: Array, width: float, degrees: tuple[int, ...], power: float = 0.0) -> Array:
    """Return ``1/2 int d'**power psi (1/sqrt(2 - d') - 1/sqrt(2 + e - d')) dd'`` for ``e > -1``.

    It is how this integral falls past the distance 2, of the functions on the panels.
    """
    charges = charges_on(width, degrees)
    near, far = np.sqrt(2.0 - charges.d), np.sqrt(2.0 - charges.d + e[:, None])
    return charges.after(charges.d ** (1.0 + power) * (e[:, None] / (near * far * (near + far))))


def rise(
    whole: Array, functions: NDArray[np.int_], d: Array, panels: int, width: float, degree: int
) -> Array:
    """Return by how much `outer` is more at distances `d` in [0, 1] than at the boundary itself.

    Of these functions, of which it is `whole`. What is far from the boundary contributes a
    difference that is taken as such, what is as near as the point is as small as its distance.
    """
    matrix = whole - beyond(np.zeros(1), panels, width, degree)[0, functions]
    source = charges_on(width, (degree,) * panels).d.reshape(panels, -1)
    x = np.maximum(-np.log(np.maximum(d, _TINY)), 0.0)
    own = np.minimum(np.floor(x / width).astype(int), panels + 1)
    for i in np.unique(own[own >= 2]):
        rows, near = np.flatnonzero(own == i), source[: min(i - 1, panels)]
        e = d[rows, None, None]
        roots = np.sqrt(near - e), np.sqrt(near)
        values = (width / 4) * near * (e / (roots[0] * roots[1] * (roots[0] + roots[1])))
        blocks = values @ legendre_projection_matrix(degree + EXTRA, degree)
        last = np.searchsorted(functions, len(near) * (degree + 1))
        matrix[rows, :last] = blocks.reshape(len(rows), -1)[:, functions[:last]]
    return np.asarray(matrix)
