"""Normal contact, equation (3.5): ``alpha p + N p = delta`` with unit load."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np

from spectral_contact.contact.refine import Refinement, SpaceSolution, refine
from spectral_contact.contact.resolution import (
    NormalContact,
    graded_space,
    relative_panel_changes,
)
from spectral_contact.contact.tuning import FIELD_ROUNDING, ROUNDING
from spectral_contact.fields.series import Array, EdgeWeight, PressureField
from spectral_contact.spectral.moments import load_vector
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of
from spectral_contact.spectral.tuning import UNCORRECTED_COMPLIANCE

#: The endpoint weight is ``(4/pi) / sqrt(y + WEIGHT_SHIFT * alpha)``: as alpha vanishes it has the
#: pressure at the edge, ``sqrt((4/pi) / alpha)``, by itself.
WEIGHT_SHIFT = 4 / pi


class _NormalProblem:
    """Normal contact for `refine`.

    The pressure for unit approach is the endpoint weight, if there is one, and a series; see
    `solve_normal` for the goals.
    """

    def __init__(self, compliance: float, tolerance: float, goal: str) -> None:
        self.compliance = compliance
        self.tolerance = tolerance
        self.pointwise = goal != "approach"
        self.changes_wanted = goal == "traction"
        has_weight = compliance < UNCORRECTED_COMPLIANCE and self.pointwise
        self.weight = EdgeWeight(4 / pi, WEIGHT_SHIFT * compliance) if has_weight else None

    def start(self) -> DiscreteSpace:
        layer = max(-log(self.compliance), 0.0)
        # the error of the approach is the square of that of the pressure
        tolerance = self.tolerance if self.pointwise else sqrt(self.tolerance)
        return graded_space(layer, tolerance)

    def attempt(self, resolution: DiscreteSpace) -> SpaceSolution[NormalContact]:
        panels = resolution.panels
        compliance = self.compliance
        weight = self.weight
        space = unit_space(panels, resolution.degrees)
        # the right-hand side is what the weight leaves of 2 delta, tested, and of alpha p
        target: Array | float = 2.0
        lift_products = None
        weight_load = 0.0  # int of the weight times s ds
        if weight is not None:
            target = weight.deficit(space.y)
            lift_products = load_vector(panels, lambda d: 0.5 * weight(d))
            weight_load = weight.amplitude / (sqrt(1.0 + weight.shift) + sqrt(weight.shift))
        factored = space.factor(compliance)
        solution = factored.solve(target, lift_products, correct=False)
        change = factored.change(solution)
        # int p s ds = (2/pi) int F dt, for unit approach
        moment = 2.0 * float(space.constant_moments @ solution[space.index]) + weight_load
        approach = 1.0 / (2.0 * pi * moment)
        coefficients = solution * approach
        weight_of_load = None if weight is None else weight.times(approach)
        pressure = PressureField(weight_of_load, series_of(panels, coefficients))
        energies = change.energies[:-1] / moment
        # without that of the tail, which adds less than 0.03 of it (tests/reference/
        # test_estimates.py)
        approach_error = float(energies.sum()) + ROUNDING
        changes = []
        if self.pointwise:
            indicators = relative_panel_changes(
                panels, change.coefficients * approach, pressure.at_ends()
            )
            pressure_error = float(indicators.max()) + FIELD_ROUNDING
            error = pressure_error
            if self.changes_wanted:
                for coarse_change in (change, factored.change(solution, degrees=1)):
                    top = -coarse_change.coefficients * approach
                    field = PressureField(None, series_of(panels, top))
                    changes.append(NormalContact(compliance, 0.0, field, panels, top))
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
        return SpaceSolution(contact, error, indicators, space.unknowns)


def solve_normal(
    compliance: float, tolerance: float, max_unknowns: int, *, goal: str = "traction"
) -> NormalContact | Refinement[NormalContact]:
    """Solve the normal problem.

    Parameters
    ----------
    compliance : float
        ``alpha*``, 0 or positive.
    tolerance : float
        Bound on the relative error of the goal.
    max_unknowns : int
        Most unknowns of a space.
    goal : {"traction", "pressure", "approach"}
        What the tolerance bounds: the pressure, pointwise, with its `changes` for the tangential
        problem; the pressure without them; or the approach alone, which needs far fewer unknowns.

    Returns
    -------
    NormalContact or Refinement
        On a smooth surface the weight ``1/(2 pi sqrt(y))`` is the exact solution, Eq. (3.6), with
        the approach 1/8, and there is nothing to refine.
    """
    if compliance == 0.0:
        pressure = PressureField(EdgeWeight(1.0 / (2.0 * pi), 0.0), None)
        return NormalContact(0.0, 1 / 8, pressure, None, np.zeros(0), ROUNDING, FIELD_ROUNDING)
    return refine(_NormalProblem(compliance, tolerance, goal), tolerance, max_unknowns)


def compliance_derivative(solved: Refinement[NormalContact]) -> NormalContact:
    """Return the derivative of a normal contact by its compliance, in the form of a contact.

    For unit approach ``(alpha + N) dp/dalpha = -p``; then the load is kept at one.
    """
    contact = solved.best.value
    panels = solved.resolution.panels
    space = unit_space(panels, solved.resolution.degrees)
    weight = contact.pressure.weight
    # p, tested with all functions
    tested_pressure = np.zeros(panels.size)
    tested_pressure[space.index] = space.mass @ contact.coefficients[space.index]
    if weight is not None:
        tested_pressure += load_vector(panels, lambda d: 0.5 * weight(d))
    right_side = tested_pressure / contact.compliance
    derivative = space.factor(contact.compliance).solve(0.0, right_side)
    moment = 2.0 * float(space.constant_moments @ derivative[space.index])
    # relative derivative of the approach that keeps the load
    relative = -2.0 * pi * moment
    derivative += relative * contact.coefficients
    edge = None if weight is None else weight.times(relative)
    field = PressureField(edge, series_of(panels, derivative))
    return NormalContact(contact.compliance, relative * contact.approach, field, panels, derivative)
