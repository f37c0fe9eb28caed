"""Abel integrals of the functions on several parts at the Galerkin nodes of one of them.

`blocks` has the integrals of one part at the nodes of another, either at these nodes or, where they
are smooth, at fewer samples that are interpolated to the nodes. Here integrals are summed over the
parts (`values`), projected on the functions of each part (`project`, its transpose), and integrated
against each other (`products`).
"""

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
#: Coefficients of the functions, as columns, by the number of the part.
Fields: TypeAlias = Sequence[Array] | Mapping[int, Array]


class PartProduct(NamedTuple):
    """Sums over nodes of products of the integrals of two parts.

    Attributes
    ----------
    row, column : int
        Numbers of the parts of the first and of the second factor.
    values : ndarray, shape (functions of part `row`, functions of part `column`)
    """

    row: int
    column: int
    values: Array


class SideBySide(NamedTuple):
    """Matrices of all parts side by side: those at the nodes, and those at the samples.

    Attributes
    ----------
    columns : dict of slice
        Columns of every part: in `on_samples` if its block is sampled, else in `on_nodes`.
    on_nodes : ndarray, shape (nodes, columns)
    on_samples : ndarray, shape (samples, columns)
    """

    columns: dict[int, slice]
    on_nodes: Array
    on_samples: Array


@dataclass(frozen=True, slots=True)
class NodeOperators:
    """Integrals of the functions on several parts at the nodes of one.

    Attributes
    ----------
    nodes : GradedNodes
    blocks : dict of Block
        The integrals, by the number of the part that is integrated.
    """

    nodes: GradedNodes
    blocks: dict[int, Block]

    def boundary_values(self, fields: Fields) -> Array:
        """Return the integrals of the fields at the boundary of the nodes, (columns,)."""
        return np.asarray(
            sum(b.scale * (b.boundary_value @ fields[k]) for k, b in self.blocks.items())
        )

    def increments(self, fields: Fields) -> Array:
        """Return the integrals at the nodes less those at their boundary, (nodes, columns)."""
        each = [(b.sampled, b.apply_increment(fields[k])) for k, b in self.blocks.items()]
        return self._sum(each)

    def values(self, fields: Fields) -> Array:
        """Return the integrals of the fields at the nodes, (nodes, columns)."""
        each = [(b.sampled, b.apply(fields[k])) for k, b in self.blocks.items()]
        return self._sum(each)

    def _sum(self, each: list[tuple[bool, Array]]) -> Array:
        """Return the sum of integrals at the nodes and of integrals at the samples."""
        total = sum(integrals for sampled, integrals in each if not sampled)
        on_samples = [integrals for sampled, integrals in each if sampled]
        if on_samples:
            total = total + self.nodes.interpolate(np.asarray(sum(on_samples)))
        return np.asarray(total)

    def project(self, weighted: Array) -> Iterable[tuple[int, Array]]:
        """Yield, for each part, the sums over the nodes of weighted values times its integrals.

        The weighted values are (nodes, columns), the sums are (functions of the part, columns).
        """
        any_sampled = any(b.sampled for b in self.blocks.values())
        at_samples = self.nodes.interpolate_transpose(weighted) if any_sampled else weighted
        for k, integrals in self.blocks.items():
            yield k, integrals.project(at_samples if integrals.sampled else weighted)

    def _side_by_side(self, *, increments: bool) -> SideBySide:
        """Return the increments of all parts, or the values."""
        columns: dict[int, slice] = {}
        on_nodes: list[Array] = []
        on_samples: list[Array] = []
        for k, integrals in self.blocks.items():
            matrix = integrals.increment if increments else integrals.value
            group = on_samples if integrals.sampled else on_nodes
            start = sum(earlier.shape[1] for earlier in group)
            columns[k] = slice(start, start + matrix.shape[1])
            group.append(matrix)
        return SideBySide(
            columns,
            _stacked(on_nodes, len(self.nodes.d)),
            _stacked(on_samples, len(self.nodes.samples)),
        )

    def products(
        self,
        other: NodeOperators,
        weights: Array,
        *,
        other_values: bool = False,
        node_sums: Array | None = None,
    ) -> Iterable[PartProduct]:
        """Yield, for all pairs of parts, sums over the nodes of the integrals of both.

        The first factors are the values of these operators.

        Parameters
        ----------
        other : NodeOperators
            The second factors, at the same nodes.
        weights : ndarray, shape (nodes,)
            Weights of the sums, not negative.
        other_values : bool
            Whether the second factors are the values of `other`, else they are its increments.
        node_sums : ndarray, optional
            The sums for all parts whose integrals are given at the nodes, if they are known: those
            of the only such part, a disk.
        """
        same = other is self and other_values
        w = weights[:, None]
        left = self._side_by_side(increments=False)
        right = left if same else other._side_by_side(increments=not other_values)
        if node_sums is not None:
            on_nodes = node_sums
        elif same:  # NumPy computes one triangle of the product of a matrix and its own transpose
            root = np.sqrt(w) * left.on_nodes
            on_nodes = root.T @ root
        else:
            on_nodes = (w * left.on_nodes).T @ right.on_nodes
        # sums[i][j]: whether the first (i) and the second factor (j) are given at the samples
        sums = [[on_nodes]]
        if left.on_samples.shape[1] + right.on_samples.shape[1]:
            interpolate = self.nodes.interpolate
            transpose = self.nodes.interpolate_transpose
            node_sample = transpose(w * left.on_nodes).T @ right.on_samples
            if same:
                sample_node = node_sample.T
            else:
                sample_node = left.on_samples.T @ transpose(w * right.on_nodes)
            sample_sample = transpose(w * interpolate(left.on_samples)).T @ right.on_samples
            sums = [[on_nodes, node_sample], [sample_node, sample_sample]]
        for k, rows in left.columns.items():
            for j, columns in right.columns.items():
                first = self.blocks[k]
                second = other.blocks[j]
                product = sums[first.sampled][second.sampled][rows, columns]
                reduced = first.reduce_transpose(product)
                yield PartProduct(k, j, second.reduce_transpose(reduced.T).T)


def _stacked(matrices: list[Array], rows: int) -> Array:
    """Return matrices side by side; without a copy if there is one, with `rows` rows if none."""
    if len(matrices) == 1:
        return matrices[0]
    return np.hstack(matrices or [np.zeros((rows, 0))])
