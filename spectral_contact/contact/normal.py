"""Normal contact, equation (3.5): ``alpha p + N p = delta`` with unit load.

p is the pressure, delta the approach, alpha the normal compliance and N the normal operator of
docs/theory; s is the radius over that of the contact, and ``y = 1 - s**2``. The half-integral of p
is ``F(t) = int_t^1 p s ds / sqrt(s**2 - t**2)``; on a smooth surface it is ``2 delta``.

The equation is solved for unit approach, ``delta = 1``. Then p is scaled to unit load, which gives
the approach.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from spectral_contact.contact.refine import Refinement, SpaceSolution, refine
from spectral_contact.contact.resolution import graded_space, relative_panel_changes
from spectral_contact.contact.tuning import FIELD_ROUNDING, ROUNDING
from spectral_contact.fields.series import Array, EdgeWeight, PressureField
from spectral_contact.spectral.moments import load_vector
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of
from spectral_contact.spectral.tuning import UNCORRECTED_COMPLIANCE

#: The endpoint weight is ``(4/pi) / sqrt(y + WEIGHT_SHIFT * alpha)``. As alpha vanishes its value
#: ``sqrt((4/pi) / alpha)`` at the edge becomes that of the pressure for unit approach.
WEIGHT_SHIFT = 4 / pi


@dataclass(frozen=True, slots=True)
class NormalContact:
    """Solution of the normal problem for unit load. Stars mark quantities without units.

    Attributes
    ----------
    compliance : float
        ``alpha*``.
    approach : float
        ``delta*``.
    pressure : PressureField
        ``p*``.
    panels : LogPanels or None
        Mesh of the series of the pressure; None on a smooth surface, whose pressure is the endpoint
        weight alone.
    coefficients : ndarray
        Coefficients of the series.
    approach_error, pressure_error : float
        Estimates of the relative errors of the approach, and of the pressure pointwise.
    changes : tuple of NormalContact
        Contributions of the top two degrees of every panel, and of the top degree alone, each in
        the form of a contact. Everything tangential is linear in the pressure, so that these show
        how its error propagates; where the signs of two degrees cancel, those of one do not. Empty
        if they are not wanted.
    """

    compliance: float
    approach: float
    pressure: PressureField
    panels: LogPanels | None
    coefficients: Array
    approach_error: float = 0.0
    pressure_error: float = 0.0
    changes: tuple[NormalContact, ...] = ()


class _NormalProblem:
    """The problem of normal contact, for `refine`.

    The pressure for unit approach is a series, plus the endpoint weight if there is one; see
    `solve_normal` for the goals.
    """

    def __init__(self, compliance: float, tolerance: float, goal: str) -> None:
        self.compliance = compliance
        self.tolerance = tolerance
        self.pointwise = goal != "approach"
        self.keeps_changes = goal == "traction"
        has_weight = compliance < UNCORRECTED_COMPLIANCE and self.pointwise
        self.weight = EdgeWeight(4 / pi, WEIGHT_SHIFT * compliance) if has_weight else None

    def start(self) -> DiscreteSpace:
        """Return the first space."""
        # the pressure has a layer of width alpha next to the edge
        layer_depth = max(-log(self.compliance), 0.0)
        # the error of the approach is the square of that of the pressure
        tolerance = self.tolerance if self.pointwise else sqrt(self.tolerance)
        return graded_space(layer_depth, tolerance)

    def attempt(self, space: DiscreteSpace) -> SpaceSolution[NormalContact]:
        """Return the solution in a space, with its error estimates."""
        panels = space.panels
        compliance = self.compliance
        weight = self.weight
        nodal_space = unit_space(panels, space.degrees)
        # The target of F is 2. The weight is the lift of the least-squares problem: its
        # half-integral is taken from the target, and its inner products enter with alpha.
        target: Array | float = 2.0
        weight_moments = None
        weight_load = 0.0  # int of the weight times s ds
        if weight is not None:
            target = weight.deficit(nodal_space.y)
            weight_moments = load_vector(panels, lambda d: 0.5 * weight(d))
            weight_load = weight.amplitude / (sqrt(1.0 + weight.shift) + sqrt(weight.shift))
        factored = nodal_space.factor(compliance)
        solution = factored.solve(target, weight_moments, correct=False)
        change = factored.change(solution)
        # int p s ds = (2/pi) int F dt for unit approach; constant moments are (1/pi) int F dt
        moment = (
            2.0 * float(nodal_space.constant_moments @ solution[nodal_space.index]) + weight_load
        )
        approach = 1.0 / (2.0 * pi * moment)
        coefficients = solution * approach
        weight_of_load = None if weight is None else weight.times(approach)
        pressure = PressureField(weight_of_load, series_of(panels, coefficients))
        # The error of the approach is the energy of that of p. The energy of the tail is left out,
        # which is less than 0.03 of the sum (tests/reference/test_estimates.py).
        energies = change.energies[:-1] / moment
        approach_error = float(energies.sum()) + ROUNDING
        changes = []
        if self.pointwise:
            indicators = relative_panel_changes(
                panels, change.coefficients * approach, pressure.at_ends()
            )
            pressure_error = float(indicators.max()) + FIELD_ROUNDING
            error = pressure_error
            if self.keeps_changes:
                # the contributions of the top two degrees, and of the top one
                for coarse_change in (change, factored.change(solution, degrees=1)):
                    contribution = -coarse_change.coefficients * approach
                    field = PressureField(None, series_of(panels, contribution))
                    changes.append(NormalContact(compliance, 0.0, field, panels, contribution))
        else:
            indicators = energies
            pressure_error = np.inf
            error = approach_error
        contact = NormalContact(
            compliance,
            approach,
            pressure,
            panels,
            coefficients,
            approach_error,
            pressure_error,
            tuple(changes),
        )
        return SpaceSolution(contact, error, indicators, nodal_space.unknowns)


def solve_normal(
    compliance: float, tolerance: float, max_unknowns: int, *, goal: str = "traction"
) -> NormalContact | Refinement[NormalContact]:
    """Solve the normal problem.

    Parameters
    ----------
    compliance : float
        alpha (dimensionless), 0 or positive.
    tolerance : float
        Bound on the relative error of the goal.
    max_unknowns : int
        Most unknowns of a space.
    goal : {"traction", "pressure", "approach"}
        With "approach" the tolerance bounds the error of the approach alone, which needs far fewer
        unknowns. With the other two it bounds that of the pressure at every radius; "traction" also
        keeps the `changes` of the pressure, from which the error of a traction is estimated.

    Returns
    -------
    NormalContact or Refinement
        A `NormalContact` on a smooth surface: the weight ``1/(2 pi sqrt(y))`` is the exact
        solution, Eq. (3.6), with the approach 1/8, and there is nothing to refine. Else a
        `Refinement`.
    """
    if compliance == 0.0:
        pressure = PressureField(EdgeWeight(1.0 / (2.0 * pi), 0.0), None)
        return NormalContact(0.0, 1 / 8, pressure, None, np.zeros(0), ROUNDING, FIELD_ROUNDING)
    return refine(_NormalProblem(compliance, tolerance, goal), tolerance, max_unknowns)


def compliance_derivative(solved: Refinement[NormalContact]) -> NormalContact:
    """Return the derivatives of pressure and approach by alpha, at unit load.

    They are the fields of the `NormalContact` that is returned. At a fixed approach ``(alpha + N)
    dp/dalpha = -p``. A multiple of p is added that makes the derivative of the load vanish; this is
    the change of the approach.
    """
    contact = solved.best.value
    panels = solved.space.panels
    nodal_space = unit_space(panels, solved.space.degrees)
    weight = contact.pressure.weight
    # p, tested with all functions
    tested_pressure = np.zeros(panels.size)
    tested_pressure[nodal_space.index] = nodal_space.mass @ contact.coefficients[nodal_space.index]
    if weight is not None:
        tested_pressure += load_vector(panels, lambda d: 0.5 * weight(d))
    # the right-hand side -p, as that of a lift p / alpha
    lift_moments = tested_pressure / contact.compliance
    derivative = nodal_space.factor(contact.compliance).solve(0.0, lift_moments)
    moment = 2.0 * float(nodal_space.constant_moments @ derivative[nodal_space.index])
    # derivative of the logarithm of the approach, at unit load
    log_approach_rate = -2.0 * pi * moment
    derivative += log_approach_rate * contact.coefficients
    weight_rate = None if weight is None else weight.times(log_approach_rate)
    field = PressureField(weight_rate, series_of(panels, derivative))
    approach_rate = log_approach_rate * contact.approach
    return NormalContact(contact.compliance, approach_rate, field, panels, derivative)
