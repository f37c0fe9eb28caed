r"""The discrete equations of a contact whose zones stick or slip: one system for every case.

The disk is cut at the boundaries between zones. On each part the pressure p and the *shear* ``u =
q/s``, q being the traction, are expanded in the functions of a mesh that is graded to a boundary.
Each of the two fields is known or unknown there (u is no displacement; that is u_r):

===================================  =======================  =====================
case                                 p                        u
===================================  =======================  =====================
with elastic coupling                unknown                  unknown where it sticks
without elastic coupling             known                    unknown where it sticks
===================================  =======================  =====================

In slip u follows from p, as ``q = f p`` times the sign of the zone. A known pressure is expanded on
the same parts, so that the same operators act on it. The equations are (docs/theory)

    alpha p + N p - kappa int_s^1 q = delta     where p is unknown,
    beta q + T q - kappa g[p] = u_r             in stick,

where the displacement u_r is zero unless slip that is over has left some (`KnownDisplacement`).

**What Galerkin's method tests.** F and G are the half-integrals of p and q over radii outside of t,
and ``kappa R`` is the value that stick prescribes for G, the *stick target*:

    F(t) = int_t^1 s p ds / sqrt(s^2 - t^2),     G(t) = int_t^1 q ds / sqrt(s^2 - t^2),
    R(t) = (2/t) int_0^t s p ds / sqrt(t^2 - s^2).

At the Galerkin nodes t of each part

    W(t) = 2 delta - F(t) + 2 kappa [int_0^1 q ds - t int_0^t q ds / sqrt(t^2 - s^2)],
    E(t) = kappa R(t) - G(t)

are multiplied with the half-integral of each test function and summed over the nodes. The equations
ask that these sums equal ``alpha p`` and ``beta q - u_r``, tested with the same functions.

**Boundaries.** On a part whose mesh is graded to a boundary b between zones, E is the sum of E(b)
and an increment from there, in which nothing cancels. On a part that is graded to the edge of the
contact (its boundary has the number -1) there is no such value, and the increment is E itself. To
the E(b) that p and q give, a number is added at each boundary, the *defect*: an artificial load
that lets the traction be continuous even where the boundary is misplaced. At given boundaries the
equations are linear in the defects. A boundary is where it should be when its defect is zero.

Without tangential compliance the traction would be singular at b unless E(b) is zero. Then zero
takes the place of E(b) and its defect in the equations. The boundary is where it should be when the
E(b) of the fields (`boundary_rows`) is zero, too.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.blocks import block
from spectral_contact.spectral.blockwise import Blockwise
from spectral_contact.spectral.contact_fields import ContactFields
from spectral_contact.spectral.contact_operators import ContactOperators
from spectral_contact.spectral.node_operators import NodeOperators
from spectral_contact.spectral.parts import GradedMesh
from spectral_contact.spectral.tuning import EXTRA
from spectral_contact.threads import cached_property

Array = NDArray[np.float64]

#: Depth at which the root of the distance to an edge is the rounding of doubles.
_ROOT_DEPTH = -2.0 * log(np.finfo(float).eps)


class PointwiseResidual(NamedTuple):
    """W and E at the nodes of every part, before compliances are subtracted.

    Attributes
    ----------
    normal : list of ndarray, shape (nodes, k)
        W on every part; empty if the pressure is known.
    tangential : list of ndarray, shape (nodes, k)
        E on the parts from the centre to the last one that sticks.
    """

    normal: list[Array]
    tangential: list[Array]


class BoundaryRows(NamedTuple):
    """Values at the boundaries b between zones, as rows that act on vectors.

    Attributes
    ----------
    stick_target : ndarray, shape (boundaries, unknowns)
        ``kappa R(b)``.
    residual : ndarray, shape (boundaries, unknowns)
        ``E(b) = kappa R(b) - G(b)``, without the defect.
    """

    stick_target: Array
    residual: Array


class ContactSystem(ContactFields):
    """The equations of two fields on zones with given boundaries.

    Parameters are those of `ContactFields`. These of its attributes are used here:

    - `states` of the zones, 0 for stick and +1 or -1 for slip with that sign of the traction;
    - `bounds`, the ends of the zones: the centre, the boundaries and the edge, so that zone i lies
      between the entries i and i + 1; `radii` are the boundaries alone;
    - `parameters`: the compliances alpha and beta, the coupling kappa, and the friction f;
    - `unknowns`, the length of a vector, and `pressure_terms`, how many of its first coefficients
      belong to the pressure;
    - `shear_loads`: ``int q ds`` over each part, as a row that acts on the coefficients of u there;
    - `pressure_maps` and `shear_maps`: the maps from vectors to the coefficients of p and of u on
      the parts;
    - `known_variation`: coefficients of known pressures less the value of the pressure at the
      centre, a column for each. A constant has a constant R, so that increments of R are the same.
    """

    @cached_property
    def operators(self) -> ContactOperators:
        """Integrals of the fields of every part at the nodes of every other."""
        return ContactOperators(self)

    @cached_property
    def boundary_rows(self) -> BoundaryRows:
        """``kappa R`` and E at the boundaries between zones, without defects."""
        stick_target = np.zeros((len(self.radii), self.unknowns))
        residual = np.zeros_like(stick_target)
        for i, part in enumerate(self.parts[: len(self.operators.nodes)]):
            if part.boundary_number < 0 or part.mesh.sign > 0:
                continue
            j = slice(part.boundary_number, part.boundary_number + 1)
            factor = 2.0 * self.parameters.kappa / part.mesh.boundary.value
            for k, inner in self.operators.inner_pressure[i].blocks.items():
                at_boundary = factor * inner.scale * inner.boundary_value[None]
                self.pressure_maps[k].add(stick_target[j], at_boundary)
            residual[j] = stick_target[j]
            for k, outer in self.operators.outer_shear[i].blocks.items():
                self.shear_maps[k].add(residual[j], -outer.scale * outer.boundary_value[None])
        return BoundaryRows(stick_target, residual)

    # residuals

    def pointwise_residual(
        self, values: Array, approach: Array, defects: Array
    ) -> PointwiseResidual:
        """Return W and E at the nodes.

        Parameters
        ----------
        values : ndarray, shape (unknowns, k)
            Vectors as columns.
        approach : ndarray, shape (k,)
            ``delta``.
        defects : ndarray, shape (boundaries, k)
            Numbers that are added to the E(b) of the fields (`FieldSolution.without_jumps` finds
            those that make the traction continuous).
        """
        normal: list[Array] = []
        if not self.pressure_known:
            normal = self._normal_residual(values, approach)
        return PointwiseResidual(normal, self._shear_residual(values, defects))

    def _normal_residual(self, values: Array, approach: Array) -> list[Array]:
        """Return W at the nodes of every part."""
        kappa = self.parameters.kappa
        parts = range(len(self.parts))
        p = [self.pressure_maps[k].apply(values) for k in parts]
        u = [self.shear_maps[k].apply(values) for k in parts]
        shear_load = sum(self.shear_loads[k] @ u[k] for k in parts)
        residual: list[Array] = []
        at_boundaries: dict[int, Array] = {}
        for i, part in enumerate(self.parts):
            t = self.operators.t[i][:, None]
            from_boundary = self.operators.from_boundary[i][:, None]
            outer = self.operators.outer_pressure[i]
            inner = self.operators.inner_shear[i]
            inner_at_boundary = inner.boundary_values(u)
            at_boundary = 2.0 * approach - outer.boundary_values(p)
            at_boundary += 2.0 * kappa * (shear_load - part.mesh.boundary.value * inner_at_boundary)
            # The parts on both sides of a boundary get the same value to the last digit. A step by
            # rounding would add to p a multiple of one over the square root of the distance.
            at_boundary = at_boundaries.setdefault(part.boundary_number, at_boundary)
            inner_increment = t * inner.increments(u) + from_boundary * inner_at_boundary
            residual.append(at_boundary - 2.0 * kappa * inner_increment - outer.increments(p))
        return residual

    def _shear_residual(self, values: Array, defects: Array) -> list[Array]:
        """Return E at the nodes of the parts up to the last one that sticks."""
        at_boundaries = np.zeros_like(defects)
        if self.parameters.beta > 0.0:
            at_boundaries = self.boundary_rows.residual @ values + defects
        residual = []
        for i, part in enumerate(self.parts[: self.stick_parts[-1] + 1]):
            increment = self._shear_increment(i, values)
            if part.boundary_number >= 0:
                increment = increment + at_boundaries[part.boundary_number]
            residual.append(increment)
        return residual

    def _shear_increment(self, i: int, values: Array) -> Array:
        """Return ``E(t) - E(b)`` at the nodes of a part, or E(t) where there is no b."""
        if not self.pressure_known:
            outer = self.operators.outer_shear[i]
            traction = {k: self.shear_maps[k].apply(values) for k in outer.blocks}
            inner = self.operators.inner_pressure[i]
            pressure = {k: self.pressure_maps[k].apply(values) for k in inner.blocks}
            return self._target_increment(i, pressure) - outer.increments(traction)
        known_increment = self._known_increments[i] @ values[: self.pressure_terms]
        # with zeros in stick the rest is the response to the known pressure alone
        if not values[self.pressure_terms :].any():
            return np.asarray(known_increment)
        stick = self.operators.outer_stick[i]
        traction = {k: self.shear_maps[k].apply(values) for k in stick.blocks}
        return np.asarray(known_increment - stick.increments(traction))

    @cached_property
    def _known_increments(self) -> list[Array]:
        """``E(t) - E(b)`` at the nodes of the parts by each known pressure, with q = 0 in stick."""
        units = np.eye(self.unknowns, self.pressure_terms)
        known_pressure = [on_part.apply(units) for on_part in self.pressure_maps]
        increments = []
        for i, outer in enumerate(self.operators.outer_shear):
            graded_to_boundary = self.parts[i].boundary_number >= 0
            pressure = self.known_variation if graded_to_boundary else known_pressure
            increment = self._target_increment(i, pressure)
            slips = {k: b for k, b in outer.blocks.items() if not self.parts[k].sticks}
            if slips:
                traction = {k: self.shear_maps[k].apply(units) for k in slips}
                increment = increment - NodeOperators(outer.nodes, slips).increments(traction)
            increments.append(increment)
        return increments

    def _target_increment(self, i: int, pressure: list[Array] | dict[int, Array]) -> Array:
        """Return ``kappa (R(t) - R(b))`` at the nodes of a part; ``kappa R(t)`` without a b.

        With I(t) the inner integral of p, ``R = 2 I/t``, this is ``(2 kappa/t) [I(t) - I(b) -
        (t - b) I(b)/b]``.
        """
        inner = self.operators.inner_pressure[i]
        b = self.parts[i].mesh.boundary.value
        decrements = self.operators.from_boundary[i][:, None] / b * inner.boundary_values(pressure)
        t = self.operators.t[i][:, None]
        factor = 2.0 * self.parameters.kappa / t
        increment = np.asarray(factor * (inner.increments(pressure) - decrements))
        part = self.parts[i]
        if self.pressure_known and part.zone == 0 and part.boundary_number >= 0:
            # Near the centre the increment and the boundary term cancel, and their difference is
            # divided by t. R(t) itself has its digits there.
            at_boundary = 2.0 * self.parameters.kappa / b * inner.boundary_values(pressure)
            direct = factor * inner.values(pressure) - at_boundary
            increment = np.where(t < b / np.sqrt(2.0), direct, increment)
        return increment

    def residual(self, values: Array, approach: Array, defects: Array) -> Array:
        """Return the residual of the equations; parameters are those of `pointwise_residual`."""
        projected = self.project(self.pointwise_residual(values, approach, defects))
        for place, mass in self.masses:
            projected[place] -= mass.times(values[place])
        factors = values[: self.pressure_terms]
        for k, displacement in self.displacement_coefficients.items():
            part = self.parts[k]
            mass = part.shear_mesh.mass(part.degrees, shear=True)
            projected[self.shear_maps[k].place] += mass.times(displacement @ factors)
        return projected

    def project(self, residual: PointwiseResidual) -> Array:
        """Return weighted sums over the nodes of W and E times the half-integrals of all functions.

        The weights are `ContactOperators.normal_tests` and `shear_tests`; the result is (unknowns,
        k).
        """
        projected = np.zeros((self.unknowns, residual.tangential[0].shape[1]))
        for i, values in enumerate(residual.tangential):
            weighted = self.operators.shear_tests[i][:, None] * values
            for k, sums in self.operators.outer_stick[i].project(weighted):
                projected[self.shear_maps[k].place] += sums
        for i, values in enumerate(residual.normal):
            weighted = self.operators.normal_tests[i][:, None] * values
            for k, sums in self.operators.outer_pressure[i].project(weighted):
                projected[self.pressure_maps[k].place] += sums
        return projected

    @cached_property
    def masses(self) -> list[tuple[slice, Blockwise]]:
        """For every unknown field its place in a vector, and its mass times its compliance.

        The residual takes them always, the matrix unless `CholeskyFactoredSystem` has it from the
        unit disk: that matrix has to have the same compliances.
        """
        masses = []
        for field in self.fields:
            part = self.parts[field.part]
            mesh = part.shear_mesh if field.is_shear else part.mesh
            compliance = self.parameters.beta if field.is_shear else self.parameters.alpha
            if compliance > 0.0:
                mass = mesh.mass(field.degrees, compliance, shear=field.is_shear)
                masses.append((field.place, mass))
        return masses

    # displacement in slip

    def slip_annulus(self, zone: int) -> Annulus:
        """Return the meshes of the displacement in a slip zone, the number `zone` from the centre.

        They are those of p, without endpoint weight and with more degrees, because the displacement
        is singular at the other end of its zone, at twice the extent of a half. Where p has the
        weight, at a smooth edge, E goes like a root of the distance: panels reach down to where
        that root is rounding. The central disk is one part, every zone around it is two.
        """
        toward_inner, toward_outer = (
            replace(
                panels,
                power=0.0,
                degree=panels.degree + EXTRA,
                count=max(panels.count, ceil(_ROOT_DEPTH / panels.width) if panels.power else 0),
            )
            for panels in (part.mesh.panels for part in self.parts[2 * zone - 1 : 2 * zone + 1])
        )
        inner, outer = self.bounds[zone : zone + 2]
        return Annulus(inner, outer, toward_inner, toward_outer)

    def residual_on_annulus(self, values: Array, annulus: Annulus) -> list[Array]:
        """Return E at the sampling points of both halves of an annulus, of vectors as columns.

        In slip E is not zero: the displacement is an Abel integral of it
        (`contact.slip_displacement`).
        """
        return [self._residual_at_samples(values, half) for half in annulus.meshes]

    def _residual_at_samples(self, values: Array, target: GradedMesh) -> Array:
        """Return E at the sampling points of a mesh."""
        inner = np.zeros((len(target.panels.sampling_distances), values.shape[1]))
        outer = np.zeros_like(inner)
        for k, part in enumerate(self.parts):
            inside = block(part.mesh, part.pressure_degrees, target, target.panels, -1)
            if inside is not None:
                inner += inside.apply(self.pressure_maps[k].apply(values))
            outside = block(part.shear_mesh, part.shear_degrees, target, target.panels, 1)
            if outside is not None:
                outer += outside.apply(self.shear_maps[k].apply(values))
        t = np.sqrt(target.sampling().z)[:, None]
        return np.asarray(2.0 * self.parameters.kappa / t * inner - outer)
