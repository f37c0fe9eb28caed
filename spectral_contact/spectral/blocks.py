r"""Abel integrals of the functions on one part of the contact at the Galerkin nodes of another.

A part is a mesh that is graded to a boundary (`GradedMesh`): the *source* is the part with the
functions, the *target* the one with the nodes. On its side +1 (outside) of a node t the integral is
the half-integral ``1/2 int_{z > t^2} f dz / sqrt(z - t^2)``, on the side -1 (inside) it is
``1/2 int_{z < t^2} f dz / sqrt(t^2 - z)``, where ``z = s**2``.

Next to a boundary between zones small differences of large integrals decide. So each integral is
given as its value at the boundary that the nodes are graded to, and its increment from there to the
nodes, in which nothing cancels; its values at the nodes are given, too. There are four cases:

==========================  =================================================================
`_self_block`               the source is the target
`_adjacent_block`           the two parts have a boundary in common and lie on its two sides
`_opposite_half_block`      the two halves of an annulus, which meet at their far ends
`_separated_block`          all other parts
==========================  =================================================================

The first and the third depend on panels and degrees alone and are cached, for parts of unit extent.
Integrals over separated parts are smooth, and given at the samples of the nodes (`GradedNodes`); if
the source is farther off than its own extent, values of the kernel at `FAR_NODES` represent it.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray
from scipy.linalg import block_diag

from spectral_contact.spectral.abel import (
    abel_left,
    abel_left_at_boundary,
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
)
from spectral_contact.spectral.jacobi import (
    PANEL_SAMPLES,
    chebyshev_interpolation,
    gauss_rule,
    interpolation_points,
)
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.parts import GradedMesh, z_difference

Array = NDArray[np.float64]
Degrees: TypeAlias = tuple[int, ...]
#: What the points of a part are for: the degrees of Galerkin nodes, or panels with sampling points.
Placement: TypeAlias = tuple[int, ...] | LogPanels
Nodes: TypeAlias = GradedNodes | PlainNodes
#: Number of panels, width, degree, power.
Form: TypeAlias = tuple[int, float, int, float]
#: A part is far off if it is at least this many of its own extents away: values at `FAR_NODES`
#: represent it there. It is 1 less what rounding may take of such a distance.
_FAR_DISTANCE = 1.0 - float(np.sqrt(np.finfo(float).eps))
#: `FAR_NODES` as distances from the boundary of a part, in its extents.
_FAR_DISTANCES: Array = (1.0 + FAR_NODES) / 2.0
#: Chebyshev points in [-1, 1] that represent all panels but the first of one half of an annulus for
#: the nodes on the other half, and the matrix from values there to Chebyshev coefficients. On
#: panels of width 2 those panels reach to exp(-2) of the half, and the nodes are seven times that
#: away or more, at 1 + 2 * 7 where the interval is [-1, 1] (Trefethen, 2013).
_OPPOSITE_NODES, _OPPOSITE_EXPANSION = chebyshev_interpolation(interpolation_points(15.0))


class Block(NamedTuple):
    """Integrals of the functions of a source at the nodes of a target.

    Attributes
    ----------
    boundary_value : ndarray, shape (columns,)
        Integrals at the boundary of the target; zero where increments are values
        (`_increments_are_values`).
    increment : ndarray, shape (nodes or samples, columns)
        Integrals at the nodes less those at the boundary.
    value : ndarray, shape (nodes or samples, columns)
        Integrals at the nodes. They may be far smaller than the two summands.
    sampled : bool
        Whether the rows are those of the samples of the target, else they are those of its nodes.
    scale : float
        Factor of all three.
    reduction : ndarray, shape (columns of `increment` and `value`, functions), optional
        The matrix from coefficients to what `increment` and `value` are applied to, where few
        values of the kernel represent the source. `boundary_value` includes it.
    """

    boundary_value: Array
    increment: Array
    value: Array
    sampled: bool
    scale: float = 1.0
    reduction: Array | None = None

    def reduce(self, coefficients: Array) -> Array:
        """Return what `increment` and `value` are applied to: scaled and reduced coefficients."""
        scaled = self.scale * coefficients
        return scaled if self.reduction is None else self.reduction @ scaled

    def reduce_transpose(self, sums: Array) -> Array:
        """Apply the transpose of `reduce`."""
        scaled = self.scale * sums
        return scaled if self.reduction is None else self.reduction.T @ scaled

    def apply(self, coefficients: Array) -> Array:
        """Return the integrals, at nodes or samples, of functions given as columns."""
        return np.asarray(self.value @ self.reduce(coefficients))

    def apply_increment(self, coefficients: Array) -> Array:
        """Return the increments, at nodes or samples, of functions given as columns."""
        return np.asarray(self.increment @ self.reduce(coefficients))

    def project(self, weighted: Array) -> Array:
        """Return sums over nodes or samples of weighted values, as columns, times integrals."""
        return self.reduce_transpose(self.value.T @ weighted)


@bounded_cache("self blocks")
def _self_block(panels: LogPanels, degrees: Degrees, placement: Placement, direction: str) -> Block:
    """Return the integrals of the functions of a part at its own nodes, for unit extent (cached).

    Parameters
    ----------
    panels, degrees
        The functions.
    placement
        See `block`.
    direction : str
        Which side of a node is integrated: "toward" the boundary, or "away" from it. "values" is
        "away" where increments are values (`_increments_are_values`).
    """
    form = (panels.count, panels.width, panels.degree)
    functions = panels.functions(degrees)
    nodes = points_of(panels, placement)
    d = nodes.d
    if direction == "toward" and isinstance(nodes, GradedNodes):
        return _zero_at_boundary(half_integrals(panels, degrees, nodes.degrees))
    if direction == "toward":
        return _zero_at_boundary(abel_right(d, *form, panels.power)[:, functions])
    if direction == "values":
        return _zero_at_boundary(abel_left(d, *form, panels.power, functions))
    value = _self_block(panels, degrees, placement, "values").value
    boundary_value = abel_left_at_boundary(*form, panels.power)[functions]
    increment = left_increment(value, boundary_value, functions, d, *form, panels.power)
    return Block(boundary_value, increment, value, sampled=False)


@bounded_cache("half-integrals at nodes")
def half_integrals(panels: LogPanels, degrees: Degrees, node_degrees: Degrees) -> Array:
    """Return half-integrals of functions at the Galerkin nodes of their own part (cached).

    A node has integrals of functions on its own panel and on panels nearer the boundary; a node on
    the tail has those of the tail alone. For panels with as many nodes the blocks depend on the
    difference of the panel numbers alone.
    """
    terms = panels.degree + 1
    form = (panels.count, panels.width, panels.degree, panels.power)
    functions = panels.functions(degrees)
    nodes = graded_nodes(panels, node_degrees)
    tail = abel_right_tail(nodes.d, panels.end, panels.tail_terms, panels.power, panels.root_tail)
    tail_column = len(functions) - panels.tail_terms
    matrix = np.zeros((len(nodes.d), len(functions)))
    matrix[:, tail_column:] = tail
    root = nodes.d[:, None] ** (0.5 + panels.power)
    row = 0
    column = 0
    for j, (n, from_start) in enumerate(zip(degrees, nodes.from_start, strict=True)):
        rows = slice(row, row + len(from_start))
        blocks = _panel_half_integrals(len(from_start), form)
        unscaled = blocks[:, functions[column:tail_column] - j * terms]
        np.multiply(unscaled, root[rows], out=matrix[rows, column:tail_column])
        row = rows.stop
        column += n + 1
    return matrix


@bounded_cache("half-integrals")
def _panel_half_integrals(count: int, form: Form) -> Array:
    """Return half-integrals at the nodes of a panel, of the functions of it and of nearer panels.

    There are `count` nodes (cached).
    """
    from_start, _ = clustered_rule(count, form[1])
    # the nodes are symmetric in their panel
    near_panels = abel_right_near_blocks(from_start[::-1], from_start, *form)
    far_panels = np.tensordot(from_samples(count), _far_half_integrals(form), 1)
    return np.concatenate([near_panels, far_panels], axis=1).reshape(count, -1)


@bounded_cache("half-integrals at samples")
def _far_half_integrals(form: Form) -> Array:
    """Return the blocks of all further panels toward the boundary, at the samples of a panel."""
    g, _ = gauss_rule(PANEL_SAMPLES)
    return abel_right_far_blocks(form[1] * (1.0 - g) / 2.0, *form)


def disk_gram(panels: LogPanels, degrees: Degrees, shear: bool) -> Array:
    """Return ``int F_i F_j dt / pi`` on the unit disk, with the half-integral F_i of function i.

    With `shear` the measure is ``t**2 dt / pi``.
    """
    nodes = graded_nodes(panels, degrees)
    t = np.sqrt(nodes.rest)
    root_weights = np.sqrt(nodes.weights / (2.0 * np.pi) * (t if shear else 1.0 / t))[:, None]
    weighted = root_weights * half_integrals(panels, degrees, degrees)
    # NumPy computes one triangle of the product of a matrix and its own transpose
    return np.asarray(weighted.T @ weighted)


#: `disk_gram`, cached, for callers that do not keep the matrix themselves.
cached_disk_gram = bounded_cache("disk Gram", 48)(disk_gram)


@bounded_cache("disk shears")
def disk_shear(panels: LogPanels, degrees: Degrees) -> Array:
    """Return ``2 pi int psi s**2 ds = 2 pi int t G dt`` over the unit disk (cached)."""
    nodes = graded_nodes(panels, degrees)
    integrals = half_integrals(panels, degrees, degrees)
    return np.asarray(np.pi * (nodes.weights @ integrals))


def block(
    source: GradedMesh,
    degrees: Degrees,
    target: GradedMesh,
    placement: Placement,
    side: int,
) -> Block | None:
    """Return the integrals of functions on one part at points of another, over one side of these.

    They are ``1/2 int psi dz / sqrt(|z - t**2|)`` over ``z > t**2`` (outside, +1) or
    ``z < t**2`` (inside, -1).

    Parameters
    ----------
    source, degrees : GradedMesh, tuple of int
        The mesh of the functions psi, and their highest degrees on its panels.
    target : GradedMesh
        The mesh of the points t: the same part or another one.
    placement : tuple of int or LogPanels
        What the points are for: degrees of functions (the points are Galerkin nodes), or panels
        that expand the integrals (the points are their sampling points).
    side : int
        +1 for outside, -1 for inside.

    Returns
    -------
    Block or None
        None if the functions lie on the other side of the points.
    """
    nodes = points_of(target.panels, placement)
    values_only = _increments_are_values(target)
    if (source.boundary, source.sign) == (target.boundary, target.sign):
        direction = "toward"
        if side == source.sign:
            direction = "values" if values_only else "away"
        unit = _self_block(source.panels, degrees, placement, direction)
    else:
        # from the boundary of the target to that of the source, positive on this side
        distance = side * z_difference(target.boundary, source.boundary)
        if distance < 0.0 or (distance == 0.0 and side != source.sign):
            return None
        if distance == 0.0:
            unit = _adjacent_block(source, degrees, target, nodes)
        elif (
            target.sign == side == -source.sign
            and source.extent == target.extent
            and round(distance / source.extent) == 2
        ):
            unit = _opposite_half_block(source.panels, degrees, target.panels, placement)
        else:
            unit = _separated_block(source, degrees, target, nodes, side, distance)
    # with dz = extent dd the integral scales like the square root of the extent
    scale = unit.scale * float(np.sqrt(source.extent))
    if values_only:
        nothing = np.zeros_like(unit.boundary_value)
        return unit._replace(boundary_value=nothing, increment=unit.value, scale=scale)
    return unit._replace(scale=scale)


def _increments_are_values(target: GradedMesh) -> bool:
    """Return whether increments are the values themselves, so that the boundary value is zero.

    They are at the edge of the contact, which is no boundary between zones; but not if the
    functions there have an endpoint weight ``y**power`` with a power above -1/2. Then the normal
    residual vanishes like ``y**(power + 1/2)``, and the rounding of a value of order 1 would exceed
    it.
    """
    return target.boundary.from_edge == 0.0 and not -0.5 < target.panels.power < 0.0


def abel_integral_on(
    target: GradedMesh, source: GradedMesh, coefficients: Array, side: int
) -> Array:
    """Return the Abel integral of functions on a source at the sampling points of a target.

    It is the half-integral (side +1) or the inner integral (-1), (..., points), of functions given
    by all coefficients of the source's panels, (..., size).
    """
    degrees = (source.panels.degree,) * source.panels.count
    integrals = block(source, degrees, target, target.panels, side)
    assert integrals is not None
    return integrals.apply(coefficients.T).T


def points_of(panels: LogPanels, placement: Placement) -> Nodes:
    """Return the points of a part of unit extent; for `placement` see `block`."""
    if isinstance(placement, LogPanels):
        return PlainNodes(placement.sampling_distances)
    return graded_nodes(panels, placement)


def _zero_at_boundary(value: Array) -> Block:
    """Return a block without boundary values, which are zero or not used: increments are values."""
    return Block(np.zeros(value.shape[1]), value, value, sampled=False)


def _adjacent_block(
    source: GradedMesh, degrees: Degrees, target: GradedMesh, nodes: Nodes
) -> Block:
    """Return the integrals over a part that lies on the other side of the target's boundary."""
    # distances past the boundary of the source, in its extents, from the boundary itself on
    e = np.append(0.0, target.extent / source.extent * nodes.samples)
    value, decrement = exterior_with_decrement(e, source.panels.width, degrees)
    return Block(value[0], -decrement[1:], value[1:], sampled=True)


@bounded_cache("opposite half blocks")
def _opposite_half_block(
    panels: LogPanels, degrees: Degrees, target_panels: LogPanels, placement: Placement
) -> Block:
    """Return the integrals over one half of an annulus at the nodes of the other (cached).

    The functions are those of `panels` and `degrees`, the nodes those of `target_panels`. Both
    halves have unit extent, and the boundaries that they are graded to are 2 apart. The halves meet
    at the far end of the first panel, so that its functions have columns of their own. All further
    panels are represented by the kernel at few points.
    """
    first_count = degrees[0] + 1
    first_panel = (1, panels.width, panels.degree, panels.power)
    d = points_of(target_panels, placement).d

    # from values of the kernel at `_OPPOSITE_NODES` to integrals with the functions on all panels
    # but the first: polynomials in `_OPPOSITE_NODES` take more points than low degrees have
    moments = moments_on(panels, (panels.degree,) * panels.count)
    reach = np.exp(-panels.width)
    chebyshev = chebvander(2.0 * moments.d / reach - 1.0, len(_OPPOSITE_NODES) - 1)
    integrals = moments.with_densities((chebyshev @ _OPPOSITE_EXPANSION).T)
    further_panels = integrals[:, panels.functions(degrees)[first_count:]]
    reduction = block_diag(np.eye(first_count), further_panels)

    # the roots of the kernel from the boundary of the target, and from its nodes
    from_boundary = 2.0 - reach * (1.0 + _OPPOSITE_NODES) / 2.0
    root_at_boundary = np.sqrt(from_boundary)
    root = np.sqrt(from_boundary - d[:, None])

    on_first = abel_right(2.0 - d, *first_panel)[:, :first_count]
    value = np.hstack([on_first, 1.0 / root])
    first_at_boundary = abel_right(np.array([2.0]), *first_panel)[0, :first_count]
    first_increment = on_first - first_at_boundary
    # farther off the difference of the two integrals is right to rounding
    small = d <= 0.5
    first_increment[small] = -opposite_end_decrement(
        -d[small], panels.width, (panels.degree,), panels.power
    )[:, :first_count]
    kernel_increment = d[:, None] / (root * root_at_boundary * (root + root_at_boundary))
    increment = np.hstack([first_increment, kernel_increment])
    boundary_value = np.hstack([first_at_boundary, 1.0 / root_at_boundary]) @ reduction
    return Block(boundary_value, increment, value, sampled=False, reduction=reduction)


def _separated_block(
    source: GradedMesh,
    degrees: Degrees,
    target: GradedMesh,
    nodes: Nodes,
    side: int,
    distance: float,
) -> Block:
    """Return the integrals over a part that has no point in common with the target, or one end.

    `distance` is from the boundary of the target to that of the source, in ``s**2``. Points are
    measured from the boundary of the target, positive on the given side of it.
    """
    source_extent = side * source.sign * source.extent
    target_extent = side * target.sign * target.extent
    clearance = distance + min(source_extent, 0.0) - max(target_extent, 0.0)
    panels = source.panels

    # a source that is far off is represented by few points
    moments = None
    source_points = _FAR_DISTANCES
    if clearance < _FAR_DISTANCE * source.extent:
        moments = moments_on(panels, degrees)
        source_points = moments.d
    from_boundary = distance + source_extent * source_points

    # and so are the nodes of a target that is far off
    near_target = clearance < _FAR_DISTANCE * target.extent
    d = nodes.samples if near_target else _FAR_DISTANCES
    step = -target_extent * d[:, None]
    root_at_boundary = np.sqrt(from_boundary)
    root = np.sqrt(from_boundary + step)
    # the increment divided by d, which is a smooth function of d
    quotient = target_extent / (root * root_at_boundary * (root + root_at_boundary))

    # the three kernels in one array, as rows
    kernels = np.vstack([1.0 / root_at_boundary[None], quotient, 1.0 / root])
    reduction = _far_reduction(panels, degrees) if moments is None else None
    if moments is not None:
        kernels = moments.with_densities(kernels)
    boundary_value = kernels[0]
    quotient = kernels[1 : 1 + len(d)]
    value = kernels[1 + len(d) :]
    if reduction is not None:
        boundary_value = boundary_value @ reduction
    if not near_target:
        interpolation = nodes.from_far_nodes
        quotient = interpolation @ quotient
        value = interpolation @ value
    increment = nodes.samples[:, None] * quotient
    # the integrals are in units of the source's extent, the kernels are not
    scale = float(np.sqrt(source.extent))
    return Block(boundary_value, increment, value, True, scale, reduction)


@bounded_cache("reductions of far parts")
def _far_reduction(panels: LogPanels, degrees: Degrees) -> Array:
    """Return the matrix from values of a kernel at `FAR_NODES` to its integrals (cached).

    They are ``1/2 int d**power psi kernel dd``. Kernels are rows that it is multiplied by from the
    left; the shape is (far nodes, functions).
    """
    # polynomials in `FAR_NODES` take more points than low degrees have
    moments = moments_on(panels, (panels.degree,) * panels.count)
    integrals = moments.with_densities(far_values(moments.d).T)
    return np.ascontiguousarray(integrals[:, panels.functions(degrees)])
