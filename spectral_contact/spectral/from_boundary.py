r"""Abel integrals at the nodes of a family, as their value at its boundary and a difference to it.

Next to a boundary between zones what counts are small differences of large integrals. Here nothing
cancels in them: what the family itself contributes has closed differences, and of what lies
apart the kernel has one. At the edge integrals are taken as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.abel import EXTRA, beyond, deeper, fall, far_fall, outer, rise
from spectral_contact.spectral.annulus import Family, gap
from spectral_contact.spectral.cache import BoundedCache
from spectral_contact.spectral.coupled import tail_rule
from spectral_contact.spectral.graded import GradedNodes
from spectral_contact.spectral.jacobi import (
    gauss_rule,
    legendre_interpolation_matrix,
    legendre_values,
)
from spectral_contact.spectral.panels import SAMPLES, LogPanels
from spectral_contact.threads import cached_property

__all__ = ["Charges", "NodeRule", "Seen", "half_integrals", "inner_integrals", "node_rule"]

Array = NDArray[np.float64]

#: Distances, in units of a family's extent, up to which a difference is taken as such.
_NEAR = 0.5

_RULES: BoundedCache[tuple[LogPanels, tuple[int, ...]], NodeRule] = BoundedCache("zone nodes", 24)
_ACROSS: BoundedCache[tuple[LogPanels, LogPanels, tuple[int, ...], int], Seen] = BoundedCache(
    "zone halves", 24
)
_CHARGES: BoundedCache[LogPanels, Charges] = BoundedCache("charges", 24)


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

    def spread(self, nodes: GradedNodes) -> Seen:
        """Return the same at the nodes, of what is known at their samples."""
        return Seen(self.at, nodes.spread(self.more), nodes.spread(self.whole))

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
    degrees : tuple of int
        Highest degrees on the panels.
    """

    def __init__(self, panels: LogPanels, degrees: tuple[int, ...]) -> None:
        self.panels, self.degrees = panels, degrees
        self._form = panels.panels, panels.width, panels.degree
        # the far end of an annulus is as near to the first panel as a centre
        self.nodes = GradedNodes(panels, degrees, centred=True)
        self.d = self.nodes.d

    @cached_property
    def toward(self) -> Seen:
        """What lies between the nodes and the boundary, which vanishes there."""
        return _vanishing(deeper(self.d, *self._form, self.panels.power))

    @cached_property
    def away(self) -> Seen:
        """What lies beyond the nodes; under an endpoint weight it is infinite at the boundary."""
        if self.panels.power != 0.0:
            return _vanishing(outer(self.d, *self._form, self.panels.power))
        whole = outer(self.d, *self._form)
        return Seen(beyond(np.zeros(1), *self._form)[0], rise(self.d, *self._form), whole)


def node_rule(panels: LogPanels, degrees: tuple[int, ...]) -> NodeRule:
    """Return the nodes of a family (cached); parameters are those of `NodeRule`."""
    return _RULES.get((panels, degrees), lambda: NodeRule(panels, degrees))


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
            closer = -side * nodes.sign * nodes.reach / family.reach * rule.nodes.samples
            seen = _apart(family.panels, side * family.sign, apart / family.reach, closer)
            seen = seen.spread(rule.nodes).times(np.sqrt(family.reach))
    return _vanishing(seen.whole) if edge else seen


def _vanishing(matrix: Array) -> Seen:
    return Seen(np.zeros(matrix.shape[1]), matrix, matrix)


def _past(family: Family, nodes: Family, rule: NodeRule) -> Seen:
    """Return what is seen across the boundary that both families have."""
    panels = family.panels
    form = panels.panels, panels.width, panels.degree
    whole, falls = fall(nodes.reach / family.reach * rule.nodes.samples, *form)
    seen = Seen(beyond(np.zeros(1), *form)[0], -falls, whole)
    return seen.spread(rule.nodes).times(np.sqrt(family.reach))


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

    return _ACROSS.get((panels, rule.panels, rule.degrees, 0 if edge else side), seen)


class Charges:
    """Few places on every panel that stand for its functions, as seen from apart.

    Parameters
    ----------
    panels : LogPanels

    Attributes
    ----------
    first, other, tail : ndarray
        Distances of the places on the first panel, whose far end a singularity may be close to,
        on every other, shape (panels - 1, n), and on the tail.
    """

    def __init__(self, panels: LogPanels) -> None:
        h, n = panels.width, panels.degree + EXTRA
        g, w = gauss_rule(n)
        self.first = np.exp(-h * (1.0 + g) / 2.0)
        weights = (0.25 * h * w) * self.first ** (1.0 + panels.power)
        self._first = weights[:, None] * legendre_values(g, panels.degree)
        # a function of few terms on a panel, integrated with all functions there
        local, _ = gauss_rule(SAMPLES)
        starts = np.exp(-h * np.arange(1, panels.panels))
        self.other = starts[:, None] * np.exp(-h * (1.0 + local) / 2.0)
        g, w = gauss_rule(panels.degree + SAMPLES)
        weights = (0.25 * h * w) * np.exp(-(1.0 + panels.power) * h * (1.0 + g) / 2.0)
        between = legendre_interpolation_matrix(g, SAMPLES) * weights[:, None]
        self._other = between.T @ legendre_values(g, panels.degree)
        self._fall = (starts ** (1.0 + panels.power))[:, None]
        self.tail, weights, basis = tail_rule(panels)
        self._tail = (weights / 2.0 * self.tail**panels.power)[:, None] * basis

    def integrals(self, kernels: list[Array]) -> Array:
        """Return ``1/2 int d**power psi kernel dd`` of kernels at the three sets of places."""
        first, other, tail = kernels
        blocks = (other @ self._other * self._fall).reshape(len(first), -1)
        return np.hstack([first @ self._first, blocks, tail @ self._tail])


def _apart(panels: LogPanels, sign: int, distance: float, closer: Array) -> Seen:
    """Return ``1/2 int d'**power psi dd' / sqrt(distance + sign d' + closer)``.

    Its value is that without `closer`, and the difference that to it.
    """
    charges = _CHARGES.get(panels, lambda: Charges(panels))
    kernels: tuple[list[Array], ...] = [], [], []
    for d in (charges.first, charges.other, charges.tail):
        step = closer.reshape(-1, *(1,) * d.ndim)
        root, near = np.sqrt(distance + sign * d), np.sqrt(distance + sign * d + step)
        parts = 1.0 / root[None], -step / (near * root * (near + root)), 1.0 / near
        for kernel, part in zip(kernels, parts, strict=True):
            kernel.append(part)
    at, more, whole = (charges.integrals(one) for one in kernels)
    return Seen(at[0], more, whole)
