r"""Abel integrals of the functions on one part of the contact at the Galerkin nodes of another.

Next to a boundary between zones what counts are small differences of large integrals. So each is
given as its value at the boundary that the nodes are graded to, and by how much it is more at the
nodes: in that nothing cancels. What a part contributes to its own nodes, or one half of an annulus
to those of the other, depends on panels and degrees alone and is kept, in unit extent. What lies
apart is smooth, and known at few samples; farther off than its own extent it is gathered at 24
places.
"""

from __future__ import annotations

from itertools import accumulate, pairwise
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray
from scipy.linalg import block_diag

from spectral_contact.spectral.abel import (
    abel_exterior,
    abel_left,
    abel_regular,
    abel_right,
    abel_right_far_blocks,
    abel_right_near_blocks,
    abel_right_tail,
    exterior_with_decrement,
    left_increment,
    moments_on,
    opposite_end_decrement,
)
from spectral_contact.spectral.cache import bounded_cache
from spectral_contact.spectral.graded import (
    FAR_NODES,
    GradedNodes,
    PlainNodes,
    clustered_rule,
    far_values,
    from_samples,
    graded_nodes,
    highest_degree,
)
from spectral_contact.spectral.jacobi import chebyshev_interpolation, gauss_rule
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, gap
from spectral_contact.spectral.tuning import SAMPLES
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]
Degrees: TypeAlias = tuple[int, ...]
Used: TypeAlias = tuple[int, ...] | LogPanels
Nodes: TypeAlias = GradedNodes | PlainNodes
#: Number of panels, width, degree, power.
Form: TypeAlias = tuple[int, float, int, float]
#: Half-integrals at consecutive nodes: rows and columns, and what is there.
Strip: TypeAlias = tuple[tuple[slice, slice], Array]

#: Distances, in units of a part's extent, up to which a difference is taken as such.
_NEAR = 0.5
#: How far off, of its extent, a part is that few places stand for; rounding may take a little.
_FAR = 1.0 - float(np.sqrt(np.finfo(float).eps))
#: Those places, as distances from its boundary.
_PLACES: Array = (1.0 + FAR_NODES) / 2.0
#: Places, in [-1, 1], that stand for all panels but the first as seen from seven times their extent
#: or farther: the error is 27**-12.
_DEEP_NODES, _DEEP_FIT = chebyshev_interpolation(12)
#: Strips of half-integrals, which have few of their zeros, and how many functions one is worth.
_STRIPS, _WORTH = 8, 24


class Block(NamedTuple):
    """Integrals of the functions of a part at the nodes of another.

    Attributes
    ----------
    at : ndarray, shape (functions,)
        At the boundary of the nodes; zero for the edge.
    more : ndarray or StripMatrix, shape (nodes or samples, functions)
        By how much it is more at the nodes.
    whole : ndarray or StripMatrix, shape (nodes or samples, functions)
        The sum, which may be far less than either.
    sampled : bool
        Whether it is given at the samples of the nodes.
    scale : float
        All three are to be multiplied by it.
    gathered : ndarray, shape (places, functions), optional
        What the functions have at few places, to which the columns of the last two belong then.
    """

    at: Array
    more: Array | StripMatrix
    whole: Array | StripMatrix
    sampled: bool
    scale: float = 1.0
    gathered: Array | None = None

    def of(self, columns: NDArray[np.int_]) -> Block:
        """Return that of some functions."""
        at = self.at[columns]
        if self.gathered is not None:
            return self._replace(at=at, gathered=self.gathered[:, columns])
        whole = self.dense(whole=True)[:, columns]
        more = whole if self.more is self.whole else self.dense(whole=False)[:, columns]
        return self._replace(at=at, more=more, whole=whole)

    def onto(self, values: Array) -> Array:
        """Return coefficients, as columns, times the scale and in the columns of the integrals."""
        values = self.scale * values
        return values if self.gathered is None else self.gathered @ values

    def back(self, sums: Array) -> Array:
        """Return the transpose of `onto`."""
        sums = self.scale * sums
        return sums if self.gathered is None else self.gathered.T @ sums

    def sums(self, values: Array, *, whole: bool = True) -> Array:
        """Return the integrals of coefficients, as columns, or by how much these are more."""
        return np.asarray((self.whole if whole else self.more) @ self.onto(values))

    def tested(self, weighted: Array) -> Array:
        """Return the sums of weighted values, as columns, times whole integrals."""
        if isinstance(self.whole, StripMatrix):
            return self.back(self.whole.tested(weighted))
        return self.back(self.whole.T @ weighted)

    def dense(self, *, whole: bool) -> Array:
        """Return the whole integrals, or by how much they are more, as an array."""
        matrix = self.whole if whole else self.more
        return matrix.dense if isinstance(matrix, StripMatrix) else matrix


class StripMatrix:
    """A matrix in strips that have few of its zeros.

    Parameters
    ----------
    shape : tuple of int
    strips : list of (tuple of slice, ndarray)
        Rows that follow each other and columns from some on, and what is there.
    """

    def __init__(self, shape: tuple[int, int], strips: list[Strip]) -> None:
        self.shape, self.strips = shape, strips

    def __matmul__(self, values: Array) -> Array:
        return np.concatenate([one @ values[own] for (_, own), one in self.strips])

    def tested(self, weighted: Array) -> Array:
        """Return the transpose times weighted values, as columns."""
        sums = np.zeros((self.shape[1], weighted.shape[1]))
        for (rows, own), one in self.strips:
            sums[own] += one.T @ weighted[rows]
        return sums

    @cached_property
    def dense(self) -> Array:
        """The matrix with its zeros."""
        whole = np.zeros(self.shape)
        for place, values in self.strips:
            whole[place] = values
        return whole


# slip inside has 5 parts in some ten spaces, and 15 more tell of other radii; bytes bound the whole
@bounded_cache("own integrals", 256)
def _own(panels: LogPanels, degrees: Degrees, used: Used, way: str) -> Block:
    """Return the integrals of the functions of a part, of unit extent, at its own nodes (cached).

    Of what lies `toward` the boundary, which vanishes there, or `beyond` the nodes, where the
    boundary is the edge or `away` from it.
    """
    form, functions = (panels.panels, panels.width, panels.degree), panels.functions(degrees)
    nodes = points_of(panels, used)
    d = nodes.d
    if way == "toward" and isinstance(nodes, GradedNodes):
        return _vanishing(half_integrals(panels, degrees, nodes.degrees))
    if way == "toward":
        return _vanishing(abel_right(d, *form, panels.power)[:, functions])
    if way == "beyond":
        return _vanishing(abel_left(d, *form, panels.power, functions))
    whole = _own(panels, degrees, used, "beyond").dense(whole=True)
    at = abel_exterior(np.zeros(1), *form)[0, functions]
    return Block(at, left_increment(whole, functions, d, *form), whole, False)


@bounded_cache("half-integrals in strips", 128)
def half_integrals(panels: LogPanels, degrees: Degrees, used: Degrees) -> StripMatrix:
    """Return half-integrals of functions at the Galerkin nodes for some degrees (cached).

    Nodes see functions on their own panel and deeper ones; those of the tail are with the last. Of
    panels with as many nodes the blocks depend on how much deeper the functions are alone.
    """
    terms, form = panels.degree + 1, (panels.panels, panels.width, panels.degree, panels.power)
    columns, nodes = panels.functions(degrees), graded_nodes(panels, used)
    tail = abel_right_tail(nodes.d, panels.end, panels.tail_terms, panels.power, panels.root_tail)
    root, last = nodes.d[:, None] ** (0.5 + panels.power), len(columns) - tail.shape[1]
    rows = [0, *accumulate(map(len, nodes.from_start[:-1])), len(nodes.d)]
    seen, found = [0, *accumulate(n + 1 for n in degrees)], []
    # of few functions the zeros are not worth it
    count = min(max(len(columns) // _WORTH, 1), _STRIPS)
    for low, high in pairwise(sorted({len(degrees) * k // count for k in range(count + 1)})):
        first, begin = rows[low], seen[low]
        values = np.zeros((rows[high] - first, len(columns) - begin))
        for j in range(low, high):
            start = nodes.from_start[j]
            own = slice(rows[j], rows[j] + len(start))
            highest = highest_degree(len(start)) if used == degrees else panels.degree
            blocks = _deeper(len(start), min(highest, panels.degree), form)
            each = blocks.take(columns[seen[j] : last] - j * terms, axis=1)
            here = values[own.start - first : own.stop - first, seen[j] - begin : last - begin]
            np.multiply(each, root[own], out=here)
        values[:, last - begin :] = tail[first : rows[high]]
        found.append(((slice(first, rows[high]), slice(begin, len(columns))), values))
    return StripMatrix((len(nodes.d), len(columns)), found)


@bounded_cache("half-integrals", 72)
def _deeper(count: int, highest: int, form: Form) -> Array:
    """Return half-integrals at so many nodes of a panel, of it and deeper ones (cached).

    On it and the next functions are of the highest degree that is wanted there.
    """
    panels, width, degree, power = form
    near, blocks = _near(count, highest, width, power), np.zeros((count, panels, degree + 1))
    blocks[:, :2, : highest + 1] = near[:, :panels]
    blocks[:, 2:] = np.tensordot(from_samples(count, width), _far_samples(form), 1)
    return blocks.reshape(count, -1)


@bounded_cache("half-integrals near by", 24)
def _near(count: int, highest: int, width: float, power: float) -> Array:
    """Return those of that panel and of the next, of any number of panels."""
    start, _ = clustered_rule(count, width)
    return abel_right_near_blocks(start[::-1], start, 2, width, highest, power)


@bounded_cache("half-integrals far off", 24)
def _far_samples(form: Form) -> Array:
    """Return those of the panels beyond, which are smooth, at the samples of a panel."""
    g, _ = gauss_rule(SAMPLES)
    return abel_right_far_blocks(form[1] * (1.0 - g) / 2.0, *form)


def disk_gram(panels: LogPanels, degrees: Degrees, shear: bool) -> Array:
    """Return the Gram matrix of half-integrals on a disk, of unit extent and radius.

    With `shear` in the measure ``t**2 dt / pi`` instead of ``dt / pi``.
    """
    nodes, seen = graded_nodes(panels, degrees), half_integrals(panels, degrees, degrees)
    t = np.sqrt(nodes.rest)
    root = np.sqrt(nodes.weights / (2.0 * np.pi) * (t if shear else 1.0 / t))[:, None]
    gram = np.zeros((seen.shape[1],) * 2)
    for (rows, own), values in seen.strips:
        part = root[rows] * values
        # of a matrix and its own transpose NumPy computes one triangle, in half the time
        gram[own, own] += part.T @ part
    return gram


kept_disk_gram = bounded_cache("disk Gram", 48)(disk_gram)


@bounded_cache("disk shears", 96)
def disk_shear(panels: LogPanels, degrees: Degrees) -> Array:
    """Return ``2 pi int psi s**2 ds = 2 pi int t G dt`` over the unit disk (cached)."""
    nodes, seen = graded_nodes(panels, degrees), half_integrals(panels, degrees, degrees)
    return np.asarray(np.pi * seen.tested(nodes.weights[:, None])[:, 0])


def block(
    source: GradedMesh,
    degrees: Degrees,
    target: GradedMesh,
    used: Used,
    side: int,
    *,
    differences: bool = True,
) -> Block | None:
    """Return the integrals of a part at points of one, of what lies on one side of these.

    They are ``1/2 int psi dz / sqrt(|z - t**2|)`` over ``z > t**2`` (outside, +1) or
    ``z < t**2`` (inside, -1).

    Parameters
    ----------
    source, degrees : GradedMesh, tuple of int
        Of the functions psi, and the highest ones on its panels.
    target : GradedMesh
        With the points: the same part or another one.
    used : tuple of int or LogPanels
        What the points are for: functions of these degrees (Galerkin nodes), or an expansion
        (sampling points).
    side : int
        +1 for outside, -1 for inside.
    differences : bool
        Whether more is wanted than whole integrals.

    Returns
    -------
    Block or None
        None if the functions lie on the other side of the points.
    """
    nodes = points_of(target.panels, used)
    if (source.boundary, source.sign) == (target.boundary, target.sign):
        onward = "beyond" if target.boundary.from_edge == 0.0 else "away"
        way = onward if side == source.sign else "toward"
        unit = _own(source.panels, degrees, used, way)
    else:
        apart = side * gap(target.boundary, source.boundary)
        if apart < 0.0 or (apart == 0.0 and side != source.sign):
            return None
        if apart == 0.0:
            unit = _facing(source, degrees, target, nodes, differences)
        elif (  # the other half of an annulus
            target.sign == side == -source.sign
            and source.reach == target.reach
            and round(apart / source.reach) == 2
        ):
            edge = target.boundary.from_edge == 0.0
            unit = _halves(source.panels, degrees, target.panels, used, edge)
        else:
            unit = _apart(source, degrees, target, nodes, side, apart)
    scale = unit.scale * float(np.sqrt(source.reach))
    if target.boundary.from_edge == 0.0:
        return unit._replace(at=np.zeros_like(unit.at), more=unit.whole, scale=scale)
    return unit._replace(scale=scale)


def across(coefficients: Array, half: GradedMesh, other: GradedMesh, side: int) -> Array:
    """Return what a function on a part adds at the sampling points of another, on its `side`.

    To the half-integral (side +1) or the inner integral (-1) there, of functions (..., size).
    """
    degrees = (half.panels.degree,) * half.panels.panels
    seen = block(half, degrees, other, other.panels, side)
    assert seen is not None
    return seen.sums(coefficients.T).T


def points_of(panels: LogPanels, used: Used) -> Nodes:
    """Return the points of a part of unit extent; for `used` see `block`."""
    if isinstance(used, LogPanels):
        return PlainNodes(used.distances)
    return graded_nodes(panels, used)


def _vanishing(matrix: Array | StripMatrix) -> Block:
    return Block(np.zeros(matrix.shape[1]), matrix, matrix, False)


def _facing(
    source: GradedMesh, degrees: Degrees, target: GradedMesh, nodes: Nodes, differences: bool
) -> Block:
    """Return what is seen across the boundary that both parts have."""
    form = source.panels.panels, source.panels.width
    e = target.reach / source.reach * nodes.samples
    if not differences:
        return _vanishing(abel_exterior(e, *form, degrees))._replace(sampled=True)
    whole, falls = exterior_with_decrement(e, form[1], degrees)
    at = abel_exterior(np.zeros(1), *form, degrees)[0]
    return Block(at, -falls, whole, True)


@bounded_cache("halves", 128)
def _halves(
    panels: LogPanels, degrees: Degrees, target: LogPanels, used: Used, edge: bool
) -> Block:
    """Return what one half of an annulus contributes to the other, both of unit extent (cached).

    Few places stand for all panels of it but the first, at whose far end the halves meet.
    """
    count, form = degrees[0] + 1, (1, panels.width, panels.degree, panels.power)
    d = points_of(target, used).d
    # as near as 1.5 a panel takes more points than a low degree has
    on_all, reach = moments_on(panels, (panels.degree,) * panels.panels), np.exp(-panels.width)
    fit = chebvander(2.0 * on_all.d / reach - 1.0, len(_DEEP_NODES) - 1)
    rest = on_all.with_densities((fit @ _DEEP_FIT).T)[:, panels.functions(degrees)[count:]]
    gathered = block_diag(np.eye(count), rest)
    at_end = 2.0 - reach * (1.0 + _DEEP_NODES) / 2.0
    root, whole = np.sqrt(at_end), np.sqrt(at_end - d[:, None])
    near, first = d > reach, np.empty((len(d), count))
    first[near] = abel_right(2.0 - d[near], *form)[:, :count]
    first[~near] = abel_regular(d[~near] - 2.0, *form)[
        :, 0, :count
    ]  # clear of the singularity there
    seen = np.hstack([first, 1.0 / whole])
    if edge:
        return Block(np.zeros(gathered.shape[1]), seen, seen, False, gathered=gathered)
    at = abel_right(np.array([2.0]), *form)[0, :count]
    first, near = first - at, d <= _NEAR
    first[near] = -opposite_end_decrement(-d[near], panels.width, (panels.degree,), panels.power)[
        :, :count
    ]
    more = np.hstack([first, d[:, None] / (whole * root * (whole + root))])
    return Block(np.hstack([at, 1.0 / root]) @ gathered, more, seen, False, gathered=gathered)


def _apart(
    source: GradedMesh, degrees: Degrees, target: GradedMesh, nodes: Nodes, side: int, apart: float
) -> Block:
    """Return what a part contributes whose boundary is another one."""
    outward, onward = side * source.sign * source.reach, side * target.sign * target.reach
    between = apart + min(outward, 0.0) - max(onward, 0.0)
    panels = source.panels
    moments = moments_on(panels, degrees) if between < _FAR * source.reach else None
    places = _PLACES if moments is None else moments.d
    at_end = apart + outward * places
    near = between < _FAR * target.reach
    d = nodes.samples if near else _PLACES
    step = -onward * d[:, None]
    root, whole = np.sqrt(at_end), np.sqrt(at_end + step)
    # over the distance, which is smooth
    more = onward / (whole * root * (whole + root))
    kernels = np.vstack([1.0 / root[None], more, 1.0 / whole])
    gathered = _gathered(panels, degrees) if moments is None else None
    if moments is not None:
        kernels = moments.with_densities(kernels)
    at, more, whole = kernels[0], kernels[1 : 1 + len(d)], kernels[1 + len(d) :]
    if gathered is not None:
        at = at @ gathered
    if not near:
        table = nodes.from_far_nodes
        more, whole = table @ more, table @ whole
    more = nodes.samples[:, None] * more
    return Block(at, more, whole, True, float(np.sqrt(source.reach)), gathered)


@bounded_cache("gathered parts", 128)
def _gathered(panels: LogPanels, degrees: Degrees) -> Array:
    """Return ``1/2 int d**power psi kernel dd`` over the values of a kernel at 24 places."""
    # polynomials of degree 23 take more points than low degrees have
    on_all = moments_on(panels, (panels.degree,) * panels.panels)
    whole = on_all.with_densities(far_values(on_all.d).T)
    return np.ascontiguousarray(whole[:, panels.functions(degrees)])
