"""The Abel integrals of the fields of all parts of a contact at the Galerkin nodes of each.

The residuals of both equations, W(t) of the normal and E(t) of the tangential one (docs/theory,
one formulation), are sums of such integrals. With them come the weights with which W and E are
tested at the nodes. Integrals are given as their value at the boundary that the nodes are graded
to, and an increment from there, in which nothing cancels (`blocks`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.blocks import Block, block
from spectral_contact.spectral.contact_fields import ContactFields, MeshPart
from spectral_contact.spectral.graded import GradedNodes, graded_nodes
from spectral_contact.spectral.node_operators import NodeOperators
from spectral_contact.spectral.parts import GradedMesh

Array = NDArray[np.float64]
#: Highest degree on every panel.
Degrees = tuple[int, ...]


class ContactOperators:
    """Integrals of the fields at the nodes of the parts.

    Where the pressure is known only the parts up to the last one that sticks have nodes.

    Parameters
    ----------
    fields : ContactFields

    Attributes
    ----------
    nodes : list of GradedNodes
    t, from_boundary : list of ndarray
        The radius t of the nodes of each part, and ``t - b`` with the boundary b that its mesh is
        graded to.
    shear_weights : list of ndarray
        Weights of ``t**2 dt / pi``.
    normal_tests, shear_tests : list of ndarray
        Weights with which W and E are tested.
    unweighted_normal, unweighted_shear : bool
        Whether `normal_tests` are the weights of ``dt / pi``, and `shear_tests` those of
        ``t**2 dt / pi``, without `_boundary_weights`.
    outer_pressure, outer_shear : list of NodeOperators
        Half-integrals of p and of u over radii outside of the nodes; without those of p if the
        pressure is known.
    inner_pressure, inner_shear : list of NodeOperators
        The same over radii inside; without those of u if the pressure is known.
    outer_stick : list of NodeOperators
        `outer_shear` of the parts that stick alone.
    """

    def __init__(self, fields: ContactFields) -> None:
        self._parts = fields.parts
        self._pressure_known = fields.pressure_known
        # an equation is tested without boundary weights if it has a compliance or no boundary; then
        # its coupling is a sum of products of loads (`contact_matrix`)
        full_stick = not fields.radii
        self.unweighted_normal = fields.parameters.alpha > 0.0 or full_stick
        self.unweighted_shear = fields.parameters.beta > 0.0 or full_stick or fields.pressure_known
        tested = fields.parts
        if fields.pressure_known:
            tested = tested[: fields.stick_parts[-1] + 1]
        self._place_nodes(tested)
        self._assemble()

    def _place_nodes(self, parts: list[MeshPart]) -> None:
        """Find the Galerkin nodes of parts, and the weights with which W and E are tested."""
        self.nodes: list[GradedNodes] = []
        self.t: list[Array] = []
        self.from_boundary: list[Array] = []
        self.shear_weights: list[Array] = []
        self.normal_tests: list[Array] = []
        self.shear_tests: list[Array] = []
        for part in parts:
            mesh = part.mesh
            b = mesh.boundary
            nodes = graded_nodes(mesh.panels, part.degrees)
            offset = mesh.sign * mesh.extent * nodes.d
            if part.zone == 0:
                t = b.value * np.sqrt(nodes.rest)
            else:
                t = np.sqrt(b.square + offset)
            weights = nodes.weights * mesh.extent / (2.0 * np.pi) * t
            factors = self._boundary_weights(part, offset)
            self.nodes.append(nodes)
            self.t.append(t)
            self.from_boundary.append(offset / (t + b.value))
            self.shear_weights.append(weights)
            self.normal_tests.append(weights / t**2 * (1.0 if self.unweighted_normal else factors))
            self.shear_tests.append(weights * (1.0 if self.unweighted_shear else factors))

    def _boundary_weights(self, part: MeshPart, offset: Array) -> Array | float:
        """Return weights of the nodes, at least 1, that rise like 1/distance next to a boundary.

        An equation without compliance holds only up to the truncation error of the space. Without
        these weights the error far from the boundary would exceed the small values next to it. At
        the edge there are none.
        """
        if part.boundary_number < 0:
            return 1.0
        beside = [p.mesh.extent for p in self._parts if p.boundary_number == part.boundary_number]
        return np.maximum(min(beside) / np.abs(offset), 1.0)

    def _assemble(self) -> None:
        """Find the integrals of the fields of every part at the nodes of every part.

        Parts are numbered outward: part k lies outside of part i if ``k > i``.
        """
        nodes = self.nodes
        self.outer_pressure = [NodeOperators(nodes_of_part, {}) for nodes_of_part in nodes]
        self.outer_shear = [NodeOperators(nodes_of_part, {}) for nodes_of_part in nodes]
        self.inner_pressure = [NodeOperators(nodes_of_part, {}) for nodes_of_part in nodes]
        self.inner_shear = [NodeOperators(nodes_of_part, {}) for nodes_of_part in nodes]
        for i in range(len(nodes)):
            for k in range(len(self._parts)):
                if k >= i:
                    self._add_operators(i, k, 1, self.outer_pressure[i], self.outer_shear[i])
                if k <= i:
                    self._add_operators(i, k, -1, self.inner_pressure[i], self.inner_shear[i])
        self.outer_stick = [
            NodeOperators(
                outer.nodes, {k: b for k, b in outer.blocks.items() if self._parts[k].sticks}
            )
            for outer in self.outer_shear
        ]

    def _add_operators(
        self, i: int, k: int, side: int, of_pressure: NodeOperators, of_shear: NodeOperators
    ) -> None:
        """Add the integrals of the fields of part k at the nodes of part i."""
        part = self._parts[k]
        target = self._parts[i]

        def integrals(mesh: GradedMesh, degrees: Degrees) -> Block:
            of_mesh = block(mesh, degrees, target.mesh, target.degrees, side)
            assert of_mesh is not None
            return of_mesh

        wants_shear = side > 0 or not self._pressure_known
        wants_pressure = side < 0 or not self._pressure_known
        if wants_shear:
            of_shear.blocks[k] = integrals(part.shear_mesh, part.shear_degrees)
        if wants_pressure:
            same = (part.mesh, part.pressure_degrees) == (part.shear_mesh, part.shear_degrees)
            if wants_shear and same:
                of_pressure.blocks[k] = of_shear.blocks[k]
            else:
                of_pressure.blocks[k] = integrals(part.mesh, part.pressure_degrees)
