r"""How zones and fields change with the parameters: the implicit function theorem, exactly.

At given boundaries the equations are linear in the fields, and linear in each parameter: with
compliances, friction or coupling twice as large their residual is off by the derivative, without
any difference of solutions. One more right-hand side for each parameter, with the factors at hand,
is the derivative of the fields. It solves the equations on zones that stay where they are, and its
traction has a jump at every boundary, as what a boundary moves by is of second order but for that.

The boundaries move by the change of the boundary residual over its Jacobian, which is that of
polynomials through residuals at boundaries near by.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.contact.error_estimate import relative_size
from spectral_contact.contact.free_boundary import FieldSolution, corrected
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import NormalContact
from spectral_contact.contact.tuning import JACOBIAN_CURVATURE, ROUNDING, SMALL_COMPLIANCE
from spectral_contact.contact.zone_fields import stick_series
from spectral_contact.contact.zone_problem import min_zone_width
from spectral_contact.contact.zone_spaces import edge_power, first_spaces, known_pressure_spaces
from spectral_contact.fields.series import (
    DiskSeries,
    EdgeWeight,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.jacobi import chebyshev_interpolation
from spectral_contact.spectral.parameters import Parameters

Array = NDArray[np.float64]

#: Nodes, and half the width of their interval over that of the min_zone_width zone: so near that the
#: factors of the middle serve, and polynomials are right to 1e-12.
_PLACES, _WIDTH = 8, 0.06
_NODES, _FIT = chebyshev_interpolation(_PLACES)
#: From values at the nodes to the derivative in the middle.
_SLOPE = np.array([chebyshev.chebval(0.0, chebyshev.chebder(row)) for row in np.eye(_PLACES)])
_SLOPE = _SLOPE @ _FIT / _WIDTH
#: Relative error that corrections of the fields leave; corrections of derivatives; Newton steps of
#: the boundaries.
_FIELD_TOLERANCE = 0.5 * float(np.finfo(float).eps)
_CORRECTIONS, _STEPS = 4, 2


@dataclass(frozen=True, slots=True)
class ZoneDerivatives:
    """Derivatives by some parameters of the system.

    Attributes
    ----------
    logits : ndarray, shape (boundaries, parameters)
        Of ``ln(b**2/(1 - b**2))`` of the boundaries.
    noise : ndarray, shape (boundaries, parameters)
        What rounding of the boundary residual makes of them.
    approach, shear : ndarray, shape (parameters,)
        Of ``delta*``, if the pressure is unknown, and of ``Q*``.
    pressure, traction : list of ZonalField
        One for each parameter: of the pressure, if it is unknown, and of the traction in stick;
        in slip that is 0 here.
    """

    logits: Array
    noise: Array
    approach: Array
    shear: Array
    pressure: list[ZonalField]
    traction: list[ZonalField]


def differentiated(
    parameters: Parameters,
    layout: Layout,
    names: Sequence[str],
    tolerance: float,
    known: Sequence[NormalContact] = (),
) -> ZoneDerivatives:
    """Return the derivatives of a solution on known zones.

    Parameters
    ----------
    parameters : Parameters
        With what `FreeBoundaryProblem` takes.
    layout : Layout
        The zones, to as many digits as there are.
    names : sequence of str
        Fields of the parameters, those above zero; under a pressure that is given alpha is that of
        the pressure.
    tolerance : float
        Of the spaces.
    known : sequence of NormalContact
        With the pressure and with its derivative by alpha, if it is known.
    """
    logits = np.array(layout.logits)
    radii = tuple(map(Radius.from_logit, layout.logits))
    alpha, beta, _, _ = parameters
    geometry = alpha, beta, radii, layout.states, tolerance
    if known:
        spaces = known_pressure_spaces(*geometry)
    else:
        spaces = first_spaces(*geometry, edge_power(parameters, layout.states))
    pressures = [contact.pressure for contact in known]

    def system_at(parameters: Parameters, logits: Array) -> ContactSystem:
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        return ContactSystem(radii, layout.states, spaces, parameters, pressures)

    return _AtBoundaries(parameters, logits, system_at, names).outcome()


class _FunctionalDerivatives(NamedTuple):
    """Partial derivatives by some parameters, at fields that stay as they are.

    Attributes
    ----------
    jumps, shortfalls : ndarray, shape (boundaries, parameters)
        Of the jumps of the traction and of E(b).
    shear : ndarray, shape (parameters,)
        Of the total shear.
    """

    jumps: Array
    shortfalls: Array
    shear: Array


class _AtBoundaries:
    """A solution on its boundaries, and its derivatives.

    Parameters
    ----------
    parameters : Parameters
    logits : ndarray
        Of the boundaries.
    system_at : callable
        Returns the system with other parameters and boundaries.
    names : sequence of str
        Of the parameters.
    """

    def __init__(
        self,
        parameters: Parameters,
        logits: Array,
        system_at: Callable[[Parameters, Array], ContactSystem],
        names: Sequence[str],
    ) -> None:
        self.parameters, self.names = parameters, names
        self.system_at = system_at
        self.narrowest = min_zone_width(logits)
        self.fields = self._solution(logits)
        #: derivatives of boundary residual, approach and shear by the logits, as rows
        self.moved = self._boundary_derivatives(logits)
        for _ in range(_STEPS - 1 if len(logits) else 0):
            residual = self.fields.boundary_residual
            logits = logits - np.linalg.solve(self.moved[:, :-2].T, residual)
            self.fields = self._solution(logits)
        self.logits = logits
        self.system = self.fields.system

    def _solution(self, logits: Array) -> FieldSolution:
        """Return the fields on boundaries, to rounding."""
        factors = factored(self.system_at(self.parameters, logits))
        return corrected(FieldSolution.first(factors), _FIELD_TOLERANCE, relative_size).fields

    def _boundary_derivatives(self, logits: Array) -> Array:
        compliances = self.parameters[int(self.fields.system.pressure_known) : 2]
        factors_serve = min(1.0, *compliances) > SMALL_COMPLIANCE
        rows = []
        for direction in np.eye(len(logits)):
            values = []
            for node in _NODES:
                at = logits + _WIDTH * self.narrowest * node * direction
                moved = replace(self.fields, system=self.system_at(self.parameters, at))
                if not factors_serve:
                    moved = moved.refactored()
                moved = corrected(moved, _FIELD_TOLERANCE, relative_size).fields
                shear = moved.approach * moved.system.total_shear(moved.values)
                values.append([*moved.boundary_residual, moved.approach, shear])
            rows.append(_SLOPE @ np.array(values) / self.narrowest)
        return np.array(rows).reshape(len(logits), len(logits) + 2)

    def outcome(self) -> ZoneDerivatives:
        """Return the derivatives."""
        system, fields, count = self.system, self.fields, len(self.names)
        solved, partial = self._at_given_boundaries()
        values: Array = solved[:, :count]  # where boundaries stay the traction jumps
        responses: Array = solved[:, count:]
        rigid = system.parameters.beta == 0.0
        singular = np.zeros(count)
        shortfall = system.boundary_rows.shortfall
        defects: Array = np.asarray(shortfall @ values + partial.shortfalls)
        if not rigid:  # it stays continuous where they move
            jumps = system.jump_rows
            defects = np.asarray(np.linalg.solve(jumps @ responses, jumps @ values + partial.jumps))
        residual: Array = defects / fields.drive[:, None]
        logits: Array = np.asarray(-np.linalg.solve(self.moved[:, :-2].T, residual))
        scale = fields.approach
        load = fields.load_integral(fields.values)
        raised = np.array([-fields.load_integral(change) / load for change in values.T])
        own_shear = system.total_shear(fields.values)
        shear = scale * (system.shear_row @ values + partial.shear + raised * own_shear)
        approach = scale * raised
        if rigid and self._root_is_known:  # the traction of the defect has a root at the rim
            singular = scale * defects[0]
            shear = shear + np.pi * system.radii[0].square * singular
        elif rigid:  # the jumps are infinite
            approach = approach + logits.T @ self.moved[:, -2]
            shear = shear + logits.T @ self.moved[:, -1]
        vectors = scale * (values + fields.values[:, None] * raised)
        return ZoneDerivatives(
            logits,
            self._noise(logits),
            np.asarray(approach),
            np.asarray(shear),
            *self._fields(vectors, singular),
        )

    def _noise(self, logits: Array) -> Array:
        """Return what rounding of the boundary residual makes of the derivatives of the logits.

        It enters their Jacobian, and the boundaries, over whose width the Jacobian changes.
        """
        inverse = np.abs(np.linalg.inv(self.moved[:, :-2])).T
        in_jacobian = ROUNDING / self.narrowest * float(np.abs(_SLOPE).sum())
        by_residual = inverse.sum(axis=1, keepdims=True)
        size = np.abs(logits)
        curvature = JACOBIAN_CURVATURE / self.narrowest
        return np.asarray(
            in_jacobian * by_residual * size.sum(axis=0) + curvature * ROUNDING * by_residual * size
        )

    @property
    def _root_is_known(self) -> bool:
        """Whether the response to a defect without tangential compliance is known: on one disk."""
        return self.system.pressure_known and len(self.system.radii) == 1

    def _at_given_boundaries(self) -> tuple[Array, _FunctionalDerivatives]:
        """Return the derivatives at given boundaries, and the responses to unit defects.

        With them the partial derivatives of functionals.
        """
        system, count = self.system, len(self.names)
        boundaries = len(system.radii)
        right = np.zeros((system.unknowns, count + boundaries))
        values = np.zeros_like(right)
        units = np.zeros((boundaries, count + boundaries))
        units[:, count:] = np.eye(boundaries)
        jumps = np.zeros((boundaries, count))
        partial = _FunctionalDerivatives(jumps, np.zeros_like(jumps), np.zeros(count))
        before = self._evaluated(system)
        for i, name in enumerate(self.names):
            if system.pressure_known and name == "alpha":
                values[1, i] = 1.0  # of the pressure's derivative
                continue
            size = getattr(system.parameters, name)
            doubled = self.parameters._replace(**{name: 2.0 * size})
            after = self._evaluated(self.system_at(doubled, self.logits))
            rise = [(b - a) / size for a, b in zip(before, after, strict=True)]
            right[:, i], partial.jumps[:, i], partial.shortfalls[:, i], partial.shear[i] = rise
        nothing = np.zeros(values.shape[1])
        for _ in range(_CORRECTIONS):
            residual = system.residual(values, nothing, units)
            values += self.fields.factors.step(residual + right)
        return values, partial

    def _evaluated(self, system: ContactSystem) -> list[Array]:
        """Return residual, jumps, shortfalls and shear of the solution in another system."""
        values, defects = self.fields.values, self.fields.defects
        residual = system.residual(values[:, None], np.ones(1), defects[:, None])
        rows = system.jump_rows, system.boundary_rows.shortfall, system.shear_row
        return [residual[:, 0], *(row @ values for row in rows)]

    def _fields(self, vectors: Array, singular: Array) -> tuple[list[ZonalField], list[ZonalField]]:
        """Return pressures, unless they are given, and tractions in stick."""
        system = self.system
        bounds, pressures, tractions = system.bounds, [], []
        for values, root in zip(vectors.T, singular.tolist(), strict=True):
            pressure, shear = system.series(values)
            if not system.pressure_known:
                pressures.append(ZonalField.on_parts(bounds, pressure))
            sticks = stick_series(system.states, bounds, shear)
            disk = sticks[0]
            if root and isinstance(disk, DiskSeries):
                sticks[0] = replace(disk, weight=EdgeWeight(2.0 * root / np.pi, 0.0))
            pieces = [ZonePiece(outer, sticks.get(k)) for k, outer in enumerate(bounds[1:])]
            tractions.append(ZonalField(tuple(pieces)))
        return pressures, tractions
