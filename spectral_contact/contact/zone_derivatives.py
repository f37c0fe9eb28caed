r"""Derivatives of zones and fields by parameters, by the implicit function theorem.

With v the vector of the fields, b the boundaries (as logits) and m a parameter, the equations are

    residual(v, b, m) = 0,      boundary residual(v, b, m) = 0.

E is the residual of the tangential equation. Its *defect* at a boundary is the number that has to
be added to E(b) there for the traction to be continuous. The *boundary residual* is minus the
defect over the stick target ``kappa R(b)``, with R as in docs/theory, symbols
(`contact.free_boundary`).

At given boundaries they are linear in v, and each parameter multiplies a term of them. So the
derivative of a residual by a parameter is its difference to the residual for a larger parameter,
over the increase: this is exact, and takes no second solution. With it as right-hand side, the
factors of the system give ``dv/dm`` for boundaries that do not move. The traction of this
derivative jumps at every boundary, because a moving boundary shifts a kink of the traction. The
boundaries move by ``-J^-1`` times the derivative of the boundary residual. The Jacobian J, of the
boundary residual by the boundaries, is that of polynomials through its values at boundaries nearby.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.contact.error_estimate import stick_zone_sources
from spectral_contact.contact.free_boundary import FieldSolution, correct_to
from spectral_contact.contact.layout import Layout, min_zone_width
from spectral_contact.contact.normal import NormalContact
from spectral_contact.contact.slip_displacement import SlipZone, slip_displacement
from spectral_contact.contact.tuning import DERIVATIVE_CORRECTIONS, JACOBIAN_RANGE, ROUNDING
from spectral_contact.contact.zone_fields import stick_tractions
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import (
    DiskSeries,
    EdgeWeight,
    PressureField,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.contact_fields import KnownDisplacement
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.jacobi import chebyshev_interpolation, interpolation_points
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.tuning import UNCORRECTED_COMPLIANCE

Array = NDArray[np.float64]

#: Name of the logarithm of the factor of a known displacement, as a parameter.
LOG_DISPLACEMENT = "ln displacement"
#: Chebyshev nodes on (-1, 1), and the matrix from values at them to Chebyshev coefficients. A
#: boundary is moved by a node times JACOBIAN_RANGE times the width of the narrowest zone. At the
#: node ``1/JACOBIAN_RANGE``, outside of the interval, that zone would vanish: there the functions
#: are singular, and this distance sets the number of nodes.
_NODES, _FIT = chebyshev_interpolation(interpolation_points(1.0 / JACOBIAN_RANGE))
#: From values at the scaled nodes to the derivative in the middle.
_DERIVATIVE = (
    np.array([chebyshev.chebval(0.0, chebyshev.chebder(row)) for row in np.eye(len(_NODES))])
    @ _FIT
    / JACOBIAN_RANGE
)
#: Relative error to which fields are corrected: half the rounding of a double.
_FIELD_TOLERANCE = 0.5 * float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True)
class ZoneDerivatives:
    """Derivatives by some parameters of the system.

    Attributes
    ----------
    logits : ndarray, shape (boundaries, parameters)
        Derivatives of ``ln(b**2/(1 - b**2))`` of the boundaries b.
    noise : ndarray, shape (boundaries, parameters)
        Errors of these derivatives by rounding of the boundary residual.
    approach, shear : ndarray, shape (parameters,)
        Derivatives of the approach delta, if the pressure is unknown, and of the total shear Q.
    pressure, traction : list of ZonalField
        Derivatives by each parameter of the pressure, if it is unknown, and of the traction in
        stick; in slip the latter is left at 0. Without tangential compliance the effect of moving
        boundaries is not in them, except for one stick disk under a known pressure.
    slip : list of ZonalField
        Derivatives by each parameter of ``u_r / kappa``, if they were asked for.
    """

    logits: Array
    noise: Array
    approach: Array
    shear: Array
    pressure: list[ZonalField]
    traction: list[ZonalField]
    slip: list[ZonalField]


def differentiated(
    parameters: Parameters,
    layout: Layout,
    names: Sequence[str],
    tolerance: float,
    known: Sequence[NormalContact] = (),
    displacement: KnownDisplacement | None = None,
    displaced_by: Mapping[str, KnownDisplacement] | None = None,
    slip: bool = False,
) -> ZoneDerivatives:
    """Return the derivatives of the solution with given zones.

    Parameters
    ----------
    parameters : Parameters
        As for `FreeBoundaryProblem`.
    layout : Layout
        The zones of the solution. A Newton step corrects their boundaries to rounding. If the
        layout has a Jacobian, the boundaries are taken as they are (`layout.fixed_disk`).
    names : sequence of str
        Names of the parameters by which to differentiate, LOG_DISPLACEMENT perhaps among them.
        The parameters must not be 0. Under a known pressure alpha enters through that pressure
        only.
    tolerance : float
        Relative error for which the spaces are made.
    known : sequence of NormalContact
        If the pressure is known, the normal contact and its derivative by alpha.
    displacement : KnownDisplacement, optional
        The displacement u_r that earlier slip has left where the surface sticks; under a known
        pressure only.
    displaced_by : mapping of str to KnownDisplacement, optional
        Its derivatives, by the names of the parameters.
    slip : bool
        Whether to differentiate the displacement in slip, which needs a known pressure.
    """
    logits = np.array(layout.logits)
    problem = FreeBoundaryProblem(parameters, layout, tolerance, known=known[0] if known else None)
    spaces = problem.spaces(tolerance, logits)
    pressures = [contact.pressure for contact in known]

    def system_at(
        parameters: Parameters,
        logits: Array,
        displacement: KnownDisplacement | None = displacement,
    ) -> ContactSystem:
        radii = tuple(map(Radius.from_logit, logits.tolist()))
        return ContactSystem(
            radii, layout.states, spaces, parameters, pressures, displacement=displacement
        )

    solved = _SolutionDerivatives(
        parameters, logits, system_at, names, layout.jacobian, displaced_by or {}
    )
    return solved.outcome(pressures if slip else ())


class _FunctionalDerivatives(NamedTuple):
    """Partial derivatives of functionals by some parameters, for constant fields.

    Attributes
    ----------
    jumps, boundary_residuals : ndarray, shape (boundaries, parameters)
        Derivatives of the jumps of the traction at the boundaries b, and of E(b), the residual of
        the tangential equation there. That is not the boundary residual of the module.
    shear : ndarray, shape (parameters,)
        Derivatives of the total shear.
    """

    jumps: Array
    boundary_residuals: Array
    shear: Array


class _SolutionDerivatives:
    """A solution with its boundaries, and its derivatives.

    Parameters
    ----------
    parameters : Parameters
    logits : ndarray
        Boundaries, which Newton steps correct to rounding.
    system_at : callable
        Returns the system with some parameters and boundaries, and another known displacement if
        one is given.
    names : sequence of str
        Names of the parameters of the derivatives.
    jacobian : ndarray, optional
        Used in place of that of the boundary residual by the logits (`layout.fixed_disk`). The
        boundaries are not corrected then.
    displaced_by : mapping of str to KnownDisplacement
        As of `differentiated`.
    """

    def __init__(
        self,
        parameters: Parameters,
        logits: Array,
        system_at: Callable[..., ContactSystem],
        names: Sequence[str],
        jacobian: Array | None,
        displaced_by: Mapping[str, KnownDisplacement],
    ) -> None:
        self.parameters = parameters
        self.names = names
        self.system_at = system_at
        self.displaced_by = displaced_by
        #: width in the logit of the narrowest zone
        self.min_width = min_zone_width(logits)
        self.fields = self._solution(logits)
        #: rows: derivatives of boundary residual, approach and shear by the logit of a boundary
        if jacobian is None:
            self.by_logits = self._boundary_derivatives(logits)
        else:
            self.by_logits = np.pad(jacobian, ((0, 0), (0, 2)))
        if jacobian is None and len(logits):
            # a Newton step with the Jacobian of these rows
            residual = self.fields.boundary_residual
            logits = logits - np.linalg.solve(self.by_logits[:, :-2].T, residual)
            self.fields = self._solution(logits)
        self.logits = logits
        self.system = self.fields.system

    def _solution(self, logits: Array) -> FieldSolution:
        """Return the fields for given boundaries, to rounding."""
        factors = factored(self.system_at(self.parameters, logits))
        return correct_to(FieldSolution.first(factors), _FIELD_TOLERANCE).fields

    def _boundary_derivatives(self, logits: Array) -> Array:
        """Return the derivatives of boundary residual, approach and shear by every logit.

        They are those of polynomials through values at nodes around the logit. The factors at the
        boundaries that are not moved are the preconditioner for all nodes, unless a compliance of
        the matrix is small.
        """
        compliances = self.parameters[int(self.fields.system.pressure_known) : 2]
        reuse_factors = min(1.0, *compliances) > UNCORRECTED_COMPLIANCE
        rows = []
        for direction in np.eye(len(logits)):
            values = []
            for node in _NODES:
                moved_logits = logits + JACOBIAN_RANGE * self.min_width * node * direction
                system = self.system_at(self.parameters, moved_logits)
                moved = replace(self.fields, system=system)
                if not reuse_factors:
                    moved = moved.refactored()
                moved = correct_to(moved, _FIELD_TOLERANCE).fields
                shear = moved.approach * moved.system.total_shear(moved.values)
                values.append([*moved.boundary_residual, moved.approach, shear])
            rows.append(_DERIVATIVE @ np.array(values) / self.min_width)
        return np.array(rows).reshape(len(logits), len(logits) + 2)

    def outcome(self, slip_under: Sequence[PressureField]) -> ZoneDerivatives:
        """Return the derivatives, and under these known pressures those of the slip."""
        system = self.system
        fields = self.fields
        count = len(self.names)
        derivatives, partial = self._at_given_boundaries()
        values: Array = derivatives[:, :count]  # at fixed boundaries: the traction has jumps
        responses: Array = derivatives[:, count:]
        rigid = system.parameters.beta == 0.0
        singular = np.zeros(count)
        defects: Array = np.asarray(
            system.boundary_rows.residual @ values + partial.boundary_residuals
        )
        if not rigid:  # the defects with which the traction is continuous
            jumps = system.jump_rows
            defects = np.asarray(np.linalg.solve(jumps @ responses, jumps @ values + partial.jumps))
        residual: Array = defects / fields.stick_target[:, None]
        logits: Array = np.asarray(-np.linalg.solve(self.by_logits[:, :-2].T, residual))
        scale = fields.approach
        load = fields.load_integral(fields.values)
        # derivatives of the logarithm of the approach, at unit load
        of_approach = np.array([-fields.load_integral(change) / load for change in values.T])
        total_shear = system.total_shear(fields.values)
        shear = scale * (system.shear_row @ values + partial.shear + of_approach * total_shear)
        approach = scale * of_approach
        if rigid and self._one_known_disk:
            # the response to the defect has a traction with 1/sqrt at the rim, in closed form
            singular = scale * defects[0]
            shear = shear + np.pi * system.radii[0].square * singular
        elif rigid:
            # The jumps are infinite. The change by moving boundaries is taken from the derivatives
            # by the logits.
            approach = approach + logits.T @ self.by_logits[:, -2]
            shear = shear + logits.T @ self.by_logits[:, -1]
        vectors = scale * (values + fields.values[:, None] * of_approach)
        return ZoneDerivatives(
            logits,
            self._noise(logits),
            np.asarray(approach),
            np.asarray(shear),
            *self._fields(vectors, singular),
            self._slip(vectors, slip_under) if slip_under else [],
        )

    def _noise(self, logits: Array) -> Array:
        """Return the errors of the derivatives of the logits by rounding of the boundary residual.

        The first part comes from rounding in the Jacobian. The second comes from the error of the
        boundaries: the Jacobian changes by its own size over JACOBIAN_RANGE of the width of a zone.
        """
        inverse = np.abs(np.linalg.inv(self.by_logits[:, :-2])).T
        in_jacobian = ROUNDING / self.min_width * float(np.abs(_DERIVATIVE).sum())
        by_residual = inverse.sum(axis=1, keepdims=True)
        size = np.abs(logits)
        curvature = 1.0 / (JACOBIAN_RANGE * self.min_width)
        return np.asarray(
            in_jacobian * by_residual * size.sum(axis=0) + curvature * ROUNDING * by_residual * size
        )

    @property
    def _one_known_disk(self) -> bool:
        """Whether one disk sticks under a known pressure: its response has a closed form."""
        return self.system.pressure_known and len(self.system.radii) == 1

    def _at_given_boundaries(self) -> tuple[Array, _FunctionalDerivatives]:
        """Return derivatives of the vector at given boundaries, and partial ones of functionals.

        The columns of the first are the derivatives by the parameters, then the responses to unit
        defects.
        """
        system = self.system
        count = len(self.names)
        boundaries = len(system.radii)
        right_sides = np.zeros((system.unknowns, count + boundaries))
        values = np.zeros_like(right_sides)
        units = np.zeros((boundaries, count + boundaries))
        units[:, count:] = np.eye(boundaries)
        jumps = np.zeros((boundaries, count))
        partial = _FunctionalDerivatives(jumps, np.zeros_like(jumps), np.zeros(count))
        before = self._evaluated(system)
        for i, name in enumerate(self.names):
            if name in self.displaced_by:
                with_change, without = (
                    self._evaluated(self.system_at(self.parameters, self.logits, displacement))[0]
                    for displacement in (self.displaced_by[name], None)
                )
                right_sides[:, i] = with_change - without
            if name == LOG_DISPLACEMENT:
                continue
            if system.pressure_known and name == "alpha":
                # entry 1 of a vector is the coefficient of the second known pressure, dp/dalpha
                values[1, i] = 1.0
                continue
            # the increase is at least 1: the rounding of all other terms is divided by it
            increased, increase = self._increased(name)
            after = self._evaluated(increased)
            residual, jumps_by, residuals_by, shear_by = (
                (increased_value - value) / increase
                for value, increased_value in zip(before, after, strict=True)
            )
            right_sides[:, i] += residual
            partial.jumps[:, i] = jumps_by
            partial.boundary_residuals[:, i] = residuals_by
            partial.shear[i] = shear_by
        # the fields are those of an approach of 1, whatever the parameter: its derivative is 0
        no_approach = np.zeros(values.shape[1])
        for _ in range(DERIVATIVE_CORRECTIONS):
            residual = system.residual(values, no_approach, units)
            values += self.fields.factors.step(residual + right_sides)
        return values, partial

    def _increased(self, name: str) -> tuple[ContactSystem, float]:
        """Return the system with a larger parameter, and the increase."""
        size = getattr(self.parameters, name)
        increase = max(size, 1.0)
        increased = self.parameters._replace(**{name: size + increase})
        return self.system_at(increased, self.logits), increase

    def _slip(self, vectors: Array, pressures: Sequence[PressureField]) -> list[ZonalField]:
        """Return the derivatives of ``u_r / kappa`` in slip, for vectors as columns.

        The displacement is linear in the fields, and at a fixed place these change as if the
        boundaries were fixed (`slip_displacement`). Its term ``beta f p`` depends on beta and on
        the friction directly, too.

        Parameters
        ----------
        vectors : ndarray
            The derivatives of the fields.
        pressures : sequence of PressureField
            The known pressure and its derivative by alpha.
        """
        system = self.system
        states = system.states
        slipping = [zone for zone, state in enumerate(states) if state]
        annuli = [system.slip_annulus(zone) for zone in slipping]
        solution = self.fields.approach * self.fields.values
        fields = []
        for name, vector in zip(self.names, vectors.T, strict=True):
            residual = _tangential_residual(system, vector, annuli)
            parameters = self.parameters
            if name == "friction":
                increased, increase = self._increased(name)
                after = _tangential_residual(increased, solution, annuli)
                before = _tangential_residual(system, solution, annuli)
                residual = [
                    value + (larger - smaller) / increase
                    for value, larger, smaller in zip(residual, after, before, strict=True)
                ]
            # ``beta f p`` is linear in each of its factors: in its derivative 1 takes the place of
            # beta or f, and for alpha the derivative of p that of p. Slip is differentiated at the
            # largest load only, where LOG_DISPLACEMENT is no parameter.
            if name != "alpha":
                parameters = parameters._replace(**{name: 1.0})
            halves = residual[len(residual) - 2 * len(annuli) :]
            zones = [
                SlipZone(annulus, states[zone], halves[2 * i : 2 * i + 2])
                for i, (zone, annulus) in enumerate(zip(slipping, annuli, strict=True))
            ]
            displacement = slip_displacement(
                stick_zone_sources(system, residual),
                zones,
                pressures[int(name == "alpha")],
                parameters.beta,
                parameters.friction,
            )
            pieces = iter(displacement.fields)
            fields.append(
                ZonalField(
                    tuple(
                        ZonePiece(outer, next(pieces) if state else None)
                        for state, outer in zip(states, system.bounds[1:], strict=True)
                    )
                )
            )
        return fields

    def _evaluated(self, system: ContactSystem) -> list[Array]:
        """Return residual, jumps, E(b) and shear of the fields in another system."""
        values = self.fields.values
        defects = self.fields.defects
        residual = system.residual(values[:, None], np.ones(1), defects[:, None])
        rows = system.jump_rows, system.boundary_rows.residual, system.shear_row
        return [residual[:, 0], *(row @ values for row in rows)]

    def _fields(self, vectors: Array, singular: Array) -> tuple[list[ZonalField], list[ZonalField]]:
        """Return pressures, unless they are known, and tractions in stick, for vectors as columns.

        `singular` has, for each vector, the amplitude of the traction that goes like 1/sqrt at the
        rim.
        """
        system = self.system
        bounds = system.bounds
        pressures = []
        tractions = []
        for values, root in zip(vectors.T, singular.tolist(), strict=True):
            pressure, shear = system.series(values)
            if not system.pressure_known:
                pressures.append(ZonalField.on_parts(bounds, pressure))
            sticks = stick_tractions(system.states, bounds, shear)
            disk = sticks[0]
            if root and isinstance(disk, DiskSeries):
                sticks[0] = replace(disk, weight=EdgeWeight(2.0 * root / np.pi, 0.0))
            pieces = [ZonePiece(outer, sticks.get(k)) for k, outer in enumerate(bounds[1:])]
            tractions.append(ZonalField(tuple(pieces)))
        return pressures, tractions


def _tangential_residual(
    system: ContactSystem, values: Array, annuli: Sequence[Annulus]
) -> list[Array]:
    """Return E of a vector without defects: at the nodes of parts, then on halves of annuli."""
    vector = values[:, None]
    no_defects = np.zeros((len(system.radii), 1))
    parts = system.pointwise_residual(vector, np.zeros(1), no_defects).tangential
    halves = [half for annulus in annuli for half in system.residual_on_annulus(vector, annulus)]
    return [residual[:, 0] for residual in (*parts, *halves)]
