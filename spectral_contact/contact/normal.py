"""Normal contact, equation (3.5): ``alpha p + N p = delta`` with unit load."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np

from spectral_contact.contact.refine import Attempt, Refinement, refine
from spectral_contact.contact.resolution import (
    CLOSED_FORM_ROUNDING,
    FIELD_ROUNDING,
    ROUNDING,
    NormalContact,
    decay_rates,
    expected_error,
    share_of_change,
    starting_resolution,
)
from spectral_contact.fields.series import Array, EdgeWeight, PressureField
from spectral_contact.spectral.moments import load_vector
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

#: Below this compliance the edge layer is thin and the endpoint weight joins the basis.
SMALL_COMPLIANCE = 1e-2
#: With ``1/sqrt(y + WEIGHT_SHIFT * c)`` the weight alone has the right edge value as c -> 0.
WEIGHT_SHIFT = 4 / pi


class _NormalProblem:
    """Spaces for the normal problem; see `solve_normal` for the goals."""

    def __init__(self, compliance: float, tolerance: float, goal: str) -> None:
        self.compliance = compliance
        self.tolerance = tolerance
        self.pointwise, self.drives = goal != "approach", goal == "drive"
        small = compliance < SMALL_COMPLIANCE and self.pointwise
        self.weight = EdgeWeight(4 / pi, WEIGHT_SHIFT * compliance) if small else None

    def start(self) -> DiscreteSpace:
        layer = max(-log(self.compliance), 0.0)
        # the approach superconverges: its error is the square of the pressure's
        tolerance = self.tolerance if self.pointwise else sqrt(self.tolerance)
        return starting_resolution(layer, tolerance)

    def attempt(self, resolution: DiscreteSpace) -> Attempt[NormalContact]:
        panels, compliance, weight = resolution.panels, self.compliance, self.weight
        space = unit_space(panels, resolution.degrees)
        target: Array | float = 2.0
        load, known = None, 0.0
        if weight is not None:
            target = weight.deficit(space.y)
            load = load_vector(panels, lambda d: 0.5 * weight(d))
            known = weight.amplitude / (sqrt(1.0 + weight.shift) + sqrt(weight.shift))
        factored = space.factor(compliance)
        solution = factored.solve(target, load, correct=self.pointwise and weight is None)
        change = factored.change(solution)
        # int p s ds = (2/pi) int F dt, for unit approach
        moment = 2.0 * float(space.constant_moments @ solution[space.index]) + known
        approach = 1.0 / (2.0 * pi * moment)
        coefficients = solution * approach
        scaled = None if weight is None else weight.times(approach)
        pressure = PressureField(scaled, series_of(panels, coefficients))
        rates = decay_rates(resolution, solution)
        energies = change.energies[:-1] / moment * rates**2
        approach_error = float(energies.sum() + change.energies[-1] / moment) + ROUNDING
        worst, changes = 0.0, []
        if self.pointwise:
            shares = share_of_change(panels, change.coefficients * approach, pressure.at_ends())
            indicators = expected_error(shares, rates)
            error = pressure_error = float(indicators.max()) + FIELD_ROUNDING
            worst = float(rates[indicators.argmax()])
            if self.drives:
                for one in (change, factored.change(solution, degrees=1)):
                    lost = one.coefficients * approach
                    field = PressureField(None, series_of(panels, lost))
                    changes.append(NormalContact(compliance, 0.0, field, panels, lost))
        else:
            indicators, rates = energies, rates**2
            pressure_error, error = np.inf, approach_error
        contact = NormalContact(
            compliance,
            approach,
            pressure,
            panels,
            coefficients,
            approach_error,
            pressure_error,
            tuple(changes),
            worst,
        )
        return Attempt(contact, error, indicators, rates, space.unknowns)


def solve_normal(
    compliance: float, tolerance: float, max_unknowns: int, *, goal: str = "drive"
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
    goal : {"drive", "pressure", "approach"}
        The pointwise pressure with its changes, for what it drives; without them; or the approach
        alone, which needs far fewer unknowns.

    Returns
    -------
    NormalContact or Refinement
        On a smooth surface the weight ``1/sqrt(y)`` is the exact solution (3.6) and there is
        nothing to refine.
    """
    if compliance == 0.0:
        pressure = PressureField(EdgeWeight(1.0 / (2.0 * pi), 0.0), None)
        return NormalContact(
            0.0, 1 / 8, pressure, None, np.zeros(0), ROUNDING, CLOSED_FORM_ROUNDING
        )
    return refine(_NormalProblem(compliance, tolerance, goal), tolerance, max_unknowns)


def by_compliance(solved: Refinement[NormalContact]) -> NormalContact:
    """Return the derivative of a normal contact by its compliance, as a contact of its own.

    For unit approach ``(alpha + N) dp/dalpha = -p``.
    """
    contact, panels = solved.best.value, solved.resolution.panels
    space = unit_space(panels, solved.resolution.degrees)
    known, weight = np.zeros(panels.size), contact.pressure.weight
    known[space.index] = space.mass @ contact.coefficients[space.index]
    if weight is not None:
        known += load_vector(panels, lambda d: 0.5 * weight(d))
    change = space.factor(contact.compliance).solve(0.0, known / contact.compliance)
    # the load stays one
    moment = 2.0 * float(space.constant_moments @ change[space.index])
    raised = -2.0 * pi * moment
    change += raised * contact.coefficients
    edge = None if weight is None else weight.times(raised)
    field, slope = PressureField(edge, series_of(panels, change)), raised * contact.approach
    return NormalContact(contact.compliance, slope, field, panels, change)
