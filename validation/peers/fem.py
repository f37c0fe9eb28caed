"""scikit-fem: axisymmetric finite elements of the half-space, the layer as a Robin condition.

Quadratic elements on a tensor mesh (T. Gustafsson and G. D. McBain, J. Open Source Softw. 5, 2369,
2020), graded to the edge of the contact as the linear peer's is, and geometrically beyond. Full
stick is a second solve, in which the pressure found is a load and the layer is tangential.

Traps: the half-space has to end somewhere. Held fixed there, it is too stiff by the inverse of the
distance; here Boussinesq's point force is prescribed, whose error falls like the inverse cube. The
pressure is the compression of the layer over alpha, so a thin layer costs digits of it. SuperLU
orders for unsymmetric matrices unless it is told otherwise.

Solver: ``fem:solver``; the resolution is the number of elements on the radius of the contact.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from elements import Array
from linear import best_power
from scipy.sparse.linalg import splu

from spectral_contact import MissingDependencyError, Scene, SceneError

try:  # here, for its time is no part of a solve
    import skfem
    from skfem.helpers import ddot, sym_grad, trace
except ImportError:
    skfem = None

#: Radius and depth of the mesh.
FAR = 100.0
#: Elements beyond the unit distance from the edge, for each element on the radius.
BEYOND = 2


class Body:
    """The half-space on a mesh: stiffness, contact line, and a unit point force far away.

    Young's modulus is 4 (1 - nu^2), the unit of the dimensionless displacements.
    """

    def __init__(self, nu: float, count: int, power: float) -> None:
        if skfem is None:
            raise MissingDependencyError("scikit-fem", "peers")
        graded = np.linspace(0.0, 1.0, count + 1) ** power
        beyond = np.geomspace(1.0, FAR, round(BEYOND * count) + 1)[1:]
        depths = np.concatenate([graded, beyond])
        # the edge is the origin, so that the elements there can be as small as they like
        mesh = skfem.MeshQuad.init_tensor(np.concatenate([-graded[:0:-1], depths]), depths)
        element = skfem.ElementVector(skfem.ElementQuad2())
        self.basis = skfem.Basis(mesh, element, intorder=5)
        contact = mesh.facets_satisfying(lambda x: (x[1] == 0.0) & (x[0] < 0.0), True)
        self.line = skfem.FacetBasis(mesh, element, facets=contact, intorder=5)
        x, z = self.basis.doflocs
        parts = (self.basis.nodal_dofs, self.basis.facet_dofs, self.basis.interior_dofs)
        self.radial, self.axial = (
            np.concatenate([dofs[i::2].ravel() for dofs in parts]) for i in (0, 1)
        )
        fixed = (x == FAR) | (z == FAR)
        fixed[self.radial[x[self.radial] == -1.0]] = True
        self.free = np.flatnonzero(~fixed)
        surface = self.axial[(z[self.axial] == 0.0) & (x[self.axial] <= 0.0)]
        self.surface = surface[np.argsort(x[surface])]  # of axial displacements
        self.ends = graded[::-1]
        self._nu = nu

    @cached_property
    def stiffness(self) -> Any:
        """The stiffness matrix."""
        shear = 2.0 * (1.0 - self._nu)
        bulk = 2.0 * shear * self._nu / (1.0 - 2.0 * self._nu)

        def work(u: Any, v: Any, w: Any) -> Any:
            r = 1.0 + w.x[0]
            strain, other = sym_grad(u), sym_grad(v)
            hoop, hoop_other = u[0] / r, v[0] / r
            volume = (trace(strain) + hoop) * (trace(other) + hoop_other)
            return (2.0 * shear * (ddot(strain, other) + hoop * hoop_other) + bulk * volume) * r

        return skfem.BilinearForm(work).assemble(self.basis)

    @cached_property
    def far(self) -> Array:
        """Displacements of a unit point force, at the far ends of the mesh."""
        x, z = self.basis.doflocs
        away = (x == FAR) | (z == FAR)
        found = np.zeros(self.basis.N)
        r, z, radial = 1.0 + x[away], z[away], np.isin(np.flatnonzero(away), self.radial)
        d = np.hypot(r, z)
        outward = r * z / d**3 - (1.0 - 2.0 * self._nu) * r / (d * (d + z))
        downward = 2.0 * (1.0 - self._nu) / d + z**2 / d**3
        found[away] = np.where(radial, outward, downward) / (8.0 * np.pi * (1.0 - self._nu))
        return found

    def layer(self, component: int) -> Any:
        """Return the matrix of the products of displacements on the contact line."""
        form = skfem.BilinearForm(lambda u, v, w: u[component] * v[component] * (1.0 + w.x[0]))
        return form.assemble(self.line)

    def solve(self, matrix: Any, loads: Array) -> Array:
        """Return displacements: columns of nodal loads, those far away given in rows not free."""
        free = self.free
        given = loads.copy()
        given[free] = 0.0
        inner = matrix[free]
        right = loads[free] - inner @ given
        options = {"SymmetricMode": True}
        factor = splu(
            inner[:, free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options=options,
        )
        given[free] = factor.solve(right)
        return given


class Elements:
    """What finite elements make of a scene; a solution as studies take it."""

    def __init__(self, scene: Scene, count: int) -> None:
        if scene.friction not in (None, np.inf):
            raise SceneError("friction", scene.friction, "None or inf: no slip with this peer")
        body = Body(scene.poisson_ratio, count, best_power(scene))
        self._body, self.unknowns = body, len(body.free)
        layer = body.layer(1) / scene.normal_compliance
        pushed = np.zeros(body.basis.N)
        pushed[body.axial] = 1.0
        both = np.column_stack([layer @ pushed, np.zeros(body.basis.N)])
        fixed = np.setdiff1d(np.arange(body.basis.N), body.free)
        both[fixed] = 0.0
        both[fixed, 1] = body.far[fixed]
        unit, far = body.solve(body.stiffness + layer, both).T
        # the load of both states together is that of the point force
        loads = [2.0 * np.pi * pushed @ (layer @ u) for u in (pushed - unit, -far)]
        self.approach = (1.0 - loads[1]) / loads[0]
        displaced = self.approach * unit + far
        compressed = self.approach * pushed - displaced
        self._p = compressed[body.surface] / scene.normal_compliance
        if scene.friction is not None:
            shear = body.layer(0) / scene.tangential_compliance
            right = layer @ compressed
            right[fixed] = body.far[fixed]
            u = body.solve(body.stiffness + shear, right[:, None])[:, 0]
            self._q = -u[body.surface - 1] / scene.tangential_compliance
            along = np.zeros(body.basis.N)
            along[body.radial] = 1.0
            self.total_shear = -2.0 * np.pi * float(along @ (shear @ u))

    def pressure(self, *, from_edge: Array) -> Array:
        """Return the compression of the layer over its compliance."""
        return self._quadratic(self._p, from_edge)

    def traction(self, *, from_edge: Array) -> Array:
        """Return the same of the tangential layer."""
        return self._quadratic(self._q, from_edge)

    def _quadratic(self, values: Array, y: Array) -> Array:
        """Interpolate between the ends and the middles of the elements."""
        ends = self._body.ends
        i = np.clip(np.searchsorted(-ends, -y, side="right") - 1, 0, len(ends) - 2)
        x = (ends[i] - y) / (ends[i] - ends[i + 1])
        inner, middle, outer = (values[2 * i + k] for k in range(3))
        return (
            inner * (1.0 - x) * (1.0 - 2.0 * x)
            + 4.0 * middle * x * (1.0 - x)
            - outer * x * (1 - 2 * x)
        )


solver = Elements
