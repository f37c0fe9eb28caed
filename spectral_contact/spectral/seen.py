"""Integrals of several parts at the nodes of one: sums of them, and their products."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from spectral_contact.spectral.blocks import Block
    from spectral_contact.spectral.graded import GradedNodes

Array = NDArray[np.float64]
Fields: TypeAlias = Sequence[Array] | Mapping[int, Array]


class PartProduct(NamedTuple):
    """The product of the integrals of two parts."""

    row: int
    column: int
    values: Array


@dataclass(frozen=True, slots=True)
class Seen:
    """Integrals of several parts at the nodes of one."""

    nodes: GradedNodes
    #: by the part that is integrated
    blocks: dict[int, Block]

    def at(self, values: Fields) -> Array:
        """Return integrals at the boundary, of coefficients part by part, as columns."""
        return np.asarray(sum(one.scale * (one.at @ values[k]) for k, one in self.blocks.items()))

    def more(self, values: Fields, *, whole: bool = False) -> Array:
        """Return by how much they are more at the nodes, or what they are there."""
        sums: list[Array | float] = [0.0, 0.0]
        for k, one in self.blocks.items():
            sums[one.sampled] = sums[one.sampled] + one.sums(values[k], whole=whole)
        direct, sampled = sums
        return np.asarray(
            direct if isinstance(sampled, float) else direct + self.nodes.interpolate(sampled)
        )

    def tested(self, weighted: Array) -> Iterable[tuple[int, Array]]:
        """Yield, part by part, the sums of weighted values at the nodes times its integrals."""
        smooth = any(one.sampled for one in self.blocks.values())
        gathered = self.nodes.interpolate_transpose(weighted) if smooth else weighted
        for k, one in self.blocks.items():
            yield k, one.tested(gathered if one.sampled else weighted)

    def _columns(self, *, whole: bool) -> tuple[dict[int, slice], list[Array]]:
        """Return the integrals of all parts side by side, those at nodes and those at samples."""
        places: dict[int, slice] = {}
        parts: tuple[list[Array], list[Array]] = [], []
        ends = [0, 0]
        for k, one in self.blocks.items():
            values = one.dense(whole=whole)
            start, ends[one.sampled] = ends[one.sampled], ends[one.sampled] + values.shape[1]
            places[k] = slice(start, ends[one.sampled])
            parts[one.sampled].append(values)
        shapes = len(self.nodes.d), len(self.nodes.samples)
        return places, [
            each[0] if len(each) == 1 else np.hstack(each or [np.zeros((rows, 0))])
            for each, rows in zip(parts, shapes, strict=True)
        ]

    def products(
        self, other: Seen, weights: Array, *, whole: bool = False, own: Array | None = None
    ) -> Iterable[PartProduct]:
        """Yield, for pairs of parts, the sums over the nodes of these integrals times others.

        Parameters
        ----------
        other : Seen
            At the same nodes; by how much its integrals are more there, or `whole` ones.
        weights : ndarray, shape (nodes,)
        own : ndarray, optional
            The sums of what is given at the nodes themselves, if they are known.
        """
        alike, w = other is self and whole, weights[:, None]
        rows, (direct, sampled) = self._columns(whole=True)
        columns, others = (rows, [direct, sampled]) if alike else other._columns(whole=whole)
        direct_other, sampled_other = others
        if own is not None:
            on_nodes = own
        elif alike:  # of one and its transpose NumPy computes one triangle
            root = np.sqrt(w) * direct
            on_nodes = root.T @ root
        else:
            on_nodes = (w * direct).T @ direct_other
        parts = [[on_nodes]]
        if sampled.shape[1] + sampled_other.shape[1]:  # what is smooth is summed over the samples
            spread, gathered = self.nodes.interpolate, self.nodes.interpolate_transpose
            beside = gathered(w * direct).T @ sampled_other
            below = beside.T if alike else sampled.T @ gathered(w * direct_other)
            parts = [[on_nodes, beside], [below, gathered(w * spread(sampled)).T @ sampled_other]]
        for k, row in rows.items():
            for j, column in columns.items():
                one, two = self.blocks[k], other.blocks[j]
                sums = parts[one.sampled][two.sampled][row, column]
                yield PartProduct(k, j, two.back(one.back(sums).T).T)
