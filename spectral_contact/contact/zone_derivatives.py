r"""How zones and fields change with the parameters: the implicit function theorem, exactly.

At given boundaries the equations are linear in the fields, and linear in each parameter: with
compliances, friction or coupling twice as large their residual is off by the derivative, without
any difference of solutions. One more right-hand side for each parameter, with the factors at hand,
is the derivative of the fields. It solves the equations on zones that stay where they are, and its
traction has a jump at every boundary, as what a boundary moves by is of second order but for that.

What the conditions of the boundaries change by, over their slopes, is by how far these move. The
slopes are those of polynomials through conditions at boundaries near by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from spectral_contact.contact.layout import Layout
from spectral_contact.contact.resolution import ROUNDING, NormalContact
from spectral_contact.contact.zone_assessment import BENT
from spectral_contact.contact.zone_fields import stick_series
from spectral_contact.contact.zone_newton import ZoneState
from spectral_contact.contact.zone_problem import FreeBoundaryProblem
from spectral_contact.fields.series import (
    DiskSeries,
    EdgeWeight,
    ZonalField,
    ZonePiece,
)
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import Factored, factored
from spectral_contact.spectral.jacobi import chebyshev_interpolation
from spectral_contact.spectral.parameters import Parameters

Array = NDArray[np.float64]

#: Places that the conditions are taken at, and how far they are, of the narrowest zone: so near
#: that the factors serve, and polynomials are right to 1e-12.
_PLACES, _WIDTH = 8, 0.06
_NODES, _FIT = chebyshev_interpolation(_PLACES)
#: From values there to the slope in the middle.
_SLOPE = np.array([chebyshev.chebval(0.0, chebyshev.chebder(row)) for row in np.eye(_PLACES)])
_SLOPE = _SLOPE @ _FIT / _WIDTH
#: What corrections leave, and how many there are of derivatives and boundaries.
_LEFT, _CORRECTIONS, _STEPS = 0.5 * float(np.finfo(float).eps), 4, 2


@dataclass(frozen=True, slots=True)
class ZoneDerivatives:
    """Derivatives by some parameters of the system.

    Attributes
    ----------
    logits : ndarray, shape (boundaries, parameters)
        Of ``ln(b**2/(1 - b**2))`` of the boundaries.
    noise : ndarray, shape (boundaries, parameters)
        What rounding of the conditions makes of them.
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
    slopes = np.eye(len(layout.logits))  # they are not needed yet
    zones = Layout(layout.logits, layout.states, slopes)
    problem = FreeBoundaryProblem(parameters, zones, tolerance, known=known[0] if known else None)
    problem.pressures = [one.pressure for one in known]
    return _AtBoundaries(problem, tolerance, names).outcome()


class _AtBoundaries:
    """A problem at its boundaries, its state there, and the derivatives of that."""

    def __init__(
        self, problem: FreeBoundaryProblem, tolerance: float, names: Sequence[str]
    ) -> None:
        self.problem, self.names = problem, names
        self.spaces = problem.spaces(tolerance)
        self._settle()

    def _settle(self) -> None:
        """Find the state at the boundaries, how it changes with these, and the last digits."""
        problem, steps = self.problem, _STEPS if len(self.problem.logits) else 1
        for step in range(steps):
            system = problem.system(self.spaces, problem.logits)
            factors = factored(system)
            self.state = problem.settled(ZoneState.begin(factors), _LEFT)
            if step == 0:
                self.moved = self._moved(factors)
            if step + 1 < steps:
                problem.logits = problem.logits - np.linalg.solve(
                    self.moved[:, :-2].T, self.state.mismatch
                )
        self.system, self.factors = system, factors

    def _moved(self, factors: Factored) -> Array:
        """Return by how much conditions, approach and shear rise with the boundaries, as rows."""
        problem, begin = self.problem, self.problem.logits
        rows, near = [], 2.0 * problem.far >= _WIDTH
        for own in np.eye(len(begin)):
            values = []
            for node in _NODES:
                logits = begin + _WIDTH * problem.narrowest * node * own
                system = problem.system(self.spaces, logits)
                own_factors = factors if near else factored(system)
                state = replace(self.state, system=system, factored=own_factors)
                state = problem.settled(state, _LEFT)
                shear = state.approach * system.total_shear(state.solution)
                values.append([*state.mismatch, state.approach, shear])
            rows.append(_SLOPE @ np.array(values) / problem.narrowest)
        return np.array(rows).reshape(len(begin), len(begin) + 2)

    def outcome(self) -> ZoneDerivatives:
        """Return the derivatives."""
        system, state, count = self.system, self.state, len(self.names)
        drive, balance = system.boundary_rows
        solved, felt = self._solved()
        values: Array = solved[:, :count]  # where boundaries stay the traction jumps
        responses: Array = solved[:, count:]
        rigid, singular = system.parameters.beta == 0.0, np.zeros(count)
        missed: Array = np.asarray(balance @ values + felt.balances)
        if not rigid:  # it stays continuous where they move
            jumps = system.jump_rows
            missed = np.asarray(np.linalg.solve(jumps @ responses, jumps @ values + felt.jumps))
        missed_there: Array = missed / (drive @ state.solution)[:, None]
        logits: Array = np.asarray(-np.linalg.solve(self.moved[:, :-2].T, missed_there))
        scale = state.approach
        raised = np.array([-state.bearing(one) / state.bearing(state.solution) for one in values.T])
        shear = scale * (
            system.shear_row @ values + felt.shear + raised * system.total_shear(state.solution)
        )
        approach = scale * raised
        if rigid and self.exact:  # what the half-integral m of a disk is that of: a root below
            singular = scale * missed[0]
            shear = shear + np.pi * system.radii[0].square * singular
        elif rigid:  # the jumps are infinite
            approach = approach + logits.T @ self.moved[:, -2]
            shear = shear + logits.T @ self.moved[:, -1]
        vectors = scale * (values + state.solution[:, None] * raised)
        return ZoneDerivatives(
            logits,
            self._noise(logits),
            np.asarray(approach),
            np.asarray(shear),
            *self._fields(vectors, singular),
        )

    def _noise(self, logits: Array) -> Array:
        """Return by how much rounding of the conditions, in slopes and boundaries, moves these."""
        inverse, narrowest = np.abs(np.linalg.inv(self.moved[:, :-2])).T, self.problem.narrowest
        rough = ROUNDING / narrowest * float(np.abs(_SLOPE).sum())
        off = ROUNDING * inverse.sum(axis=1, keepdims=True)  # of the boundaries, and slopes bend
        moved = np.abs(logits)
        return np.asarray(
            rough * inverse.sum(axis=1, keepdims=True) * moved.sum(axis=0)
            + (BENT / narrowest * off * moved)
        )

    @property
    def exact(self) -> bool:
        """Whether the response to a lift without tangential compliance is known: that of a disk."""
        return self.system.pressure_known and len(self.system.radii) == 1

    def _solved(self) -> tuple[Array, _Felt]:
        """Return the derivatives at given boundaries, and the responses to unit imbalances.

        With them what functionals change by, of the same solution.
        """
        system, count = self.system, len(self.names)
        boundaries, given = len(system.radii), system.pressure_known
        right = np.zeros((system.unknowns, count + boundaries))
        values, units = np.zeros_like(right), np.zeros((boundaries, count + boundaries))
        units[:, count:] = np.eye(boundaries)
        jumps, balances = np.zeros((2, boundaries, count))
        felt = _Felt(jumps, balances, np.zeros(count))
        before = self._seen(system)
        for i, name in enumerate(self.names):
            if given and name == "alpha":
                values[1, i] = 1.0  # of the pressure's derivative
                continue
            size = getattr(system.parameters, name)
            after = self._seen(self._with(name, 2.0 * size))
            rise = [(b - a) / size for a, b in zip(before, after, strict=True)]
            right[:, i], felt.jumps[:, i], felt.balances[:, i], felt.shear[i] = rise
        nothing = np.zeros(values.shape[1])
        for _ in range(_CORRECTIONS):
            missed = system.residual(values, nothing, units)
            values += self.factors.step(missed + right)
        return values, felt

    def _with(self, name: str, value: float) -> ContactSystem:
        """Return the system with another value of a parameter."""
        problem, own = self.problem, self.problem.parameters
        problem.parameters = own._replace(**{name: value})
        try:
            return problem.system(self.spaces, problem.logits)
        finally:
            problem.parameters = own

    def _seen(self, system: ContactSystem) -> list[Array]:
        """Return what a system with like parameters makes of the solution."""
        own, imbalance = self.state.solution, self.state.imbalance
        missed = system.residual(own[:, None], np.ones(1), imbalance[:, None])
        functionals = system.jump_rows, system.boundary_rows.shortfall, system.shear_row
        return [missed[:, 0], *(one @ own for one in functionals)]

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


class _Felt(NamedTuple):
    """Derivatives of functionals at the same solution: jumps, balances, and the shear."""

    jumps: Array
    balances: Array
    shear: Array
