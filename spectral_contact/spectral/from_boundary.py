r"""Abel integrals at the nodes of a family, as their value at its boundary and a difference to it.

Next to a boundary between zones what counts are small differences of large integrals. Here nothing
cancels in them: what the family itself contributes has closed differences, and of what lies
apart the kernel has one. At the edge integrals are taken as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import beyond, deeper, fall, far_fall, outer, rise, tail_values
from spectral_contact.spectral.annulus import Family, gap
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.jacobi import gauss_rule, legendre_projection_matrix
from spectral_contact.spectral.panels import LogPanels

__all__ = ["NodeRule", "Seen", "half_integrals", "inner_integrals", "node_rule"]

Array = NDArray[np.float64]

#: Gauss points on a panel beyond its degree, and on a tail.
_EXTRA, _TAIL_POINTS = 12, 12
#: Distances, in units of a family's extent, up to which a difference is taken as such.
_NEAR = 0.5

_RULES: BoundedCache[tuple[LogPanels, int, bool], NodeRule] = BoundedCache("zone nodes", 24)
_ACROSS: BoundedCache[tuple[LogPanels, LogPanels, int], Seen] = BoundedCache("zone halves", 24)


@dataclass(frozen=True, slots=True)
class Seen:
    """What the functions of a family contribute at the nodes of another.

    Attributes
    ----------
    at : ndarray, shape (size,)
        At the boundary; zero for the edge.
    more : ndarray, shape (nodes, size)
        By how much it is more at the nodes.
    whole : ndarray, shape (nodes, size)
        The sum, which may be far less than either.
    """

    at: Array
    more: Array
    whole: Array

    def times(self, factor: float) -> Seen:
        """Return the same in other units."""
        whole = factor * self.whole
        more = whole if self.more is self.whole else factor * self.more
        return Seen(factor * self.at, more, whole)

    def of(self, columns: NDArray[np.int_]) -> Seen:
        """Return the part of some functions."""
        whole = self.whole[:, columns]
        more = whole if self.more is self.whole else self.more[:, columns]
        return Seen(self.at[columns], more, whole)


class NodeRule:
    """Galerkin nodes of a family of unit extent, and its own integrals there.

    Parameters
    ----------
    panels : LogPanels
    sign : int
        As that of `Family`.
    whole : bool
        Whether the family fills a disk.
    """

    def __init__(self, panels: LogPanels, sign: int, whole: bool) -> None:
        self.panels, self.sign, self.whole = panels, sign, whole
        self._form = panels.panels, panels.width, panels.degree
        if whole:
            nodes = disk_operators(panels).nodes
            self.d, self.rest, self.weights = nodes.d, nodes.rest, nodes.weights
        else:
            self.d, self.weights = panels.distance_nodes(mirrored=sign > 0)
            self.rest = 1.0 - self.d

    @cached_property
    def toward(self) -> Seen:
        """What lies between the nodes and the boundary, which vanishes there."""
        if self.whole:
            return _vanishing(disk_operators(self.panels).half_integral)
        return _vanishing(deeper(self.d, *self._form, self.panels.power))

    @cached_property
    def away(self) -> Seen:
        """What lies beyond the nodes; under an endpoint weight it is infinite at the boundary."""
        if self.panels.power != 0.0:
            return _vanishing(outer(self.d, *self._form, self.panels.power))
        whole = outer(self.d, *self._form)
        return Seen(beyond(np.zeros(1), *self._form)[0], rise(self.d, *self._form), whole)


def node_rule(panels: LogPanels, sign: int, whole: bool = False) -> NodeRule:
    """Return the nodes of a family (cached); parameters are those of `NodeRule`."""
    key = panels, sign, whole
    return _RULES.get(key, lambda: NodeRule(*key))


def half_integrals(family: Family, nodes: Family, rule: NodeRule) -> Seen | None:
    """Return ``1/2 int_{z > t^2} psi dz / sqrt(z - t^2)`` of a family at the nodes of one.

    Parameters
    ----------
    family : Family
        Of the functions psi.
    nodes : Family
        With the nodes: the same or another one.
    rule : NodeRule
        Of the latter.

    Returns
    -------
    Seen or None
        None if the functions lie inside of the nodes.
    """
    return _integrals(family, nodes, rule, 1)


def inner_integrals(family: Family, nodes: Family, rule: NodeRule) -> Seen | None:
    """Return ``1/2 int_{z < t^2} psi dz / sqrt(t^2 - z)``, as `half_integrals` does.

    None if the functions lie outside of the nodes.
    """
    return _integrals(family, nodes, rule, -1)


def _integrals(family: Family, nodes: Family, rule: NodeRule, side: int) -> Seen | None:
    """Return what lies on one side of the nodes: outside for +1, inside for -1."""
    edge = nodes.boundary.from_edge == 0.0
    if family == nodes:
        own = rule.away if side == family.sign else rule.toward
        seen = own.times(np.sqrt(family.reach))
    else:
        apart = side * gap(nodes.boundary, family.boundary)
        if apart < 0.0 or (apart == 0.0 and side != family.sign):
            return None
        if apart == 0.0:
            seen = _past(family, nodes, rule)
        elif family.reach == nodes.reach and apart < 3.0 * family.reach and nodes.sign == side:
            seen = _halves(family, rule, side, edge).times(np.sqrt(family.reach))
        else:
            offset = side * nodes.sign * nodes.reach / family.reach * rule.d
            seen = _apart(family.panels, side * family.sign, apart / family.reach, -offset)
            seen = seen.times(np.sqrt(family.reach))
    return _vanishing(seen.whole) if edge else seen


def _vanishing(matrix: Array) -> Seen:
    return Seen(np.zeros(matrix.shape[1]), matrix, matrix)


def _past(family: Family, nodes: Family, rule: NodeRule) -> Seen:
    """Return what is seen across the boundary that both families have."""
    panels = family.panels
    form = panels.panels, panels.width, panels.degree
    whole, falls = fall(nodes.reach / family.reach * rule.d, *form)
    return Seen(beyond(np.zeros(1), *form)[0], -falls, whole).times(np.sqrt(family.reach))


def _halves(family: Family, rule: NodeRule, side: int, edge: bool) -> Seen:
    """Return what one half of an annulus contributes to the other, both of unit extent."""
    panels = family.panels

    def seen() -> Seen:
        form = panels.panels, panels.width, panels.degree, panels.power
        at, whole = deeper(np.array([2.0]), *form)[0], deeper(2.0 - rule.d, *form)
        if edge:
            return _vanishing(whole)
        near, more = rule.d <= _NEAR, whole - at
        more[near] = -far_fall(-rule.d[near], *form)
        return Seen(at, more, whole)

    return _ACROSS.get((panels, rule.panels, 0 if edge else side), seen)


def _apart(panels: LogPanels, sign: int, distance: float, closer: Array) -> Seen:
    """Return ``1/2 int d'**power psi dd' / sqrt(distance + sign d' + closer)``.

    Its value is that without `closer`, and the difference that to it.
    """
    g, _ = gauss_rule(panels.degree + _EXTRA)
    source = np.exp(-panels.width * (np.arange(panels.panels)[:, None] + (1.0 + g) / 2.0))
    weights = (0.25 * panels.width) * source ** (1.0 + panels.power)
    project = legendre_projection_matrix(len(g), panels.degree)
    v, w = gauss_rule(_TAIL_POINTS)
    v = (1.0 + v) / 2.0
    tail = panels.end * v**2
    tail_weights = w / 2.0 * v * panels.end * tail**panels.power
    basis = tail_values(tail, panels.end, panels.tail_terms, panels.root_tail)

    def rows(kernel: Array, tail_kernel: Array) -> Array:
        blocks = ((weights * kernel) @ project).reshape(len(kernel), -1)
        return np.hstack([blocks, (tail_weights * tail_kernel) @ basis])

    ats, mores, wholes = [], [], []
    for d in (source, tail):
        step = closer.reshape(-1, *(1,) * d.ndim)
        root, near = np.sqrt(distance + sign * d), np.sqrt(distance + sign * d + step)
        ats.append(1.0 / root[None])
        wholes.append(1.0 / near)
        mores.append(-step / (near * root * (near + root)))
    return Seen(rows(*ats)[0], rows(*mores), rows(*wholes))
