r"""Normal contact through a nonlinear layer, with its error estimates.

The equation is ``w + N F(w) = delta - h`` with ``p = F(w)``: w is the overclosure, F the law of the
layer, N the normal operator, delta the approach and h the height of the punch. The unknown is w
beyond the start of the law, which is regular also where the pressure begins. `layered_newton`
solves for it in a space. Under a law with an edge the shift ``eps`` follows from w = 0 there; under
other laws it follows from the approach.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.layered_bends import NO_MISPLACEMENT, Misplacement
from spectral_contact.contact.layered_newton import (
    RADII,
    TINY,
    LayeredFields,
    LayeredNewton,
    LayeredSetting,
)
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import SpaceSolution
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import central_value
from spectral_contact.spectral.panels import DiscreteSpace

if TYPE_CHECKING:
    from spectral_contact.contact.layered_spaces import Form

Array = NDArray[np.float64]

#: Factors of error estimates: an integral is off by the first one times the energy of the change
#: by the top degrees, as in `indented`; the stiffness by the second one times its change from the
#: coarser space to this one.
_ENERGY_FACTOR, _STIFFNESS_FACTOR = 2.0, 16.0
#: Roundings of lengths, relative to the largest of the data, and of the pressure.
_ROUNDINGS, _FIELD_ROUNDINGS = 3.0, 60.0


class Layered(ABC):
    """The problem of contact through a nonlinear layer, for `refine`; subclasses have the spaces.

    Parameters
    ----------
    setting : LayeredSetting
    pointwise : bool
        Whether the pressure is wanted.
    """

    def __init__(self, setting: LayeredSetting, *, pointwise: bool) -> None:
        self.setting = setting
        self.pointwise = pointwise
        #: the last space, and the solution in it
        self.last: tuple[Form, LayeredFields] | None = None

    @abstractmethod
    def _form(self, space: DiscreteSpace) -> Form:
        """Return the space."""

    def attempt(self, space: DiscreteSpace) -> SpaceSolution[Indentation]:
        """Return the solution in a space, with its error estimates."""
        return self._with_errors(*self._solve(space))

    def _solve(self, space: DiscreteSpace) -> tuple[LayeredNewton, LayeredFields]:
        """Return the solution in a space, from the last one if there is one."""
        form = self._form(space)
        solver = LayeredNewton(self.setting, form)
        fields = None
        if self.last is not None:
            last_form, last = self.last
            fields = solver.solve(form.converted(last.overclosure, last_form), last.shift)
        if fields is None or fields.iteration_error == inf:
            fields = solver.solve(*solver.first_guess())
        self.last = form, fields
        return solver, fields

    def _misplacement(self, form: Form, fields: LayeredFields) -> Misplacement:
        """Return bounds of the errors due to bends of the law that are no end of a part."""
        return NO_MISPLACEMENT

    def _with_errors(
        self, solver: LayeredNewton, fields: LayeredFields
    ) -> SpaceSolution[Indentation]:
        """Return the contact with its error estimates.

        Raises
        ------
        SceneError
            If the pressure is so small that it has no digits.
        """
        setting = self.setting
        form = solver.form
        a = setting.radius
        totals = solver.integrals(fields)
        if min(totals.load, totals.stiffness, totals.work) < TINY:
            given = ("contact_radius", a)
            if setting.approach is not None:
                given = ("approach", setting.approach)
            allowed = f"such that load, stiffness and work are above {TINY:.6g}, not rounding alone"
            raise SceneError(*given, allowed)
        coarse = solver.coarser(fields)
        coarse_totals = solver.integrals(coarse)
        change = solver.change(
            fields.pressure, coarse.pressure, fields.overclosure, coarse.overclosure
        )
        flat_change = solver.change(
            fields.pressure_rate, coarse.pressure_rate, fields.rate, coarse.rate
        )
        mean = totals.load / (pi * a**2)
        indicators = form.errors(fields.pressure, change, mean)

        approach = solver.unshifted_approach + a * fields.shift
        max_overclosure = solver.max_overclosure(fields)
        max_pressure = float(setting.layer._pressure(np.array(max_overclosure)))
        iteration_error = fields.iteration_error * max_pressure / mean
        size = max(abs(approach), approach - max_overclosure)
        # errors of load, stiffness and work at a given shift
        energies = np.sqrt(change.energies * flat_change.energies)
        load_part = _ENERGY_FACTOR * 2.0 * pi * float(energies.sum())
        stiffness_part = _ENERGY_FACTOR * 2.0 * pi * float(flat_change.energies.sum())
        work_part = _ENERGY_FACTOR * 2.0 * pi * float(change.energies.sum())

        misplaced = self._misplacement(form, fields)
        shift_error = 0.0
        largest_length = size - min(setting.origin, 0.0)
        if setting.approach is None:
            edge_error = form.edge_bound(fields.overclosure - coarse.overclosure)
            shift_error = edge_error / form.at_edge(fields.rate)
            shift_error = a * (shift_error + abs(fields.shift - coarse.shift))
            shift_error += misplaced.load / totals.stiffness
        shift_error += _ROUNDINGS * ROUNDING * largest_length
        load_by_shift = totals.stiffness * shift_error
        common_error = misplaced.load / totals.load + iteration_error + ROUNDING
        load_change = abs(totals.load - coarse_totals.load)
        load_error = (load_by_shift + a**2 * load_part + load_change) / totals.load + common_error
        work_change = abs(totals.work - coarse_totals.work)
        work_error = (
            totals.load * shift_error + a**3 * work_part + work_change
        ) / totals.work + common_error
        stiffness_change = abs(totals.stiffness - coarse_totals.stiffness)
        stiffness_error = (
            (2.0 * a * stiffness_part + _STIFFNESS_FACTOR * stiffness_change) / totals.stiffness
            + (solver.edge_stiffness_error(fields) + misplaced.stiffness) / totals.stiffness
            # the relative change of the stiffness by the shift is at most that of the load
            + load_by_shift / totals.load
            + iteration_error
            + 2.0 * ROUNDING
        )
        rounding = solver.condition(fields, mean) * ROUNDING * largest_length
        pressure_error = float(indicators.max()) + iteration_error
        pressure_error += _FIELD_ROUNDINGS * ROUNDING + rounding + misplaced.pressure / mean
        normal = None
        if setting.drives:
            normal = form.known_pressure(fields.pressure, change, solver.min_compliance(fields))
        indentation = Indentation(
            a,
            approach,
            totals.load,
            totals.work,
            totals.stiffness,
            solver.growth(fields),
            form.field(fields.pressure),
            form.field(fields.pressure_rate) if self.pointwise else None,
            shift_error / size + ROUNDING,
            load_error,
            work_error,
            stiffness_error,
            pressure_error,
            max_overclosure,
            normal,
            setting.bends,
        )
        if setting.load is not None:
            indentation = _at_load(indentation, setting.load)
        if setting.centre is not None:
            central_error = float(indicators[: form.central].max()) + iteration_error
            pressure, rate = at_centre(indentation)
            indentation = _with_approach_error(
                indentation, central_error * max(pressure, mean) / rate
            )
        error = indentation.largest_error(pointwise=self.pointwise)
        if not self.pointwise:
            by_panels = solver.stiffness_by_panels(flat_change.coefficients)
            stiffness_indicators = _STIFFNESS_FACTOR * np.abs(by_panels) / totals.stiffness
            indicators = np.maximum(indicators**2, stiffness_indicators)
        if setting.centre is not None or not self.pointwise or setting.layer.knots:
            # where the error is larger than every indicator, all of them are enlarged alike, so
            # that the panels with the largest ones are refined
            indicators = indicators * max(1.0, min(error, 1.0) / float(indicators.max()))
        return SpaceSolution(indentation, error, indicators, form.space.unknowns)


def at_centre(contact: Indentation) -> tuple[float, float]:
    """Return the pressure at the centre, and its derivative by the approach."""
    assert contact.pressure is not None
    assert contact.flat is not None
    return central_value(contact.pressure), central_value(contact.flat) / contact.radius


def _at_load(contact: Indentation, load: float) -> Indentation:
    """Return the contact with exactly this load.

    The error of the load that it had, and how far that was from the given one, become an error of
    the approach.
    """
    error = contact.load_error + 2.0 * abs(contact.load / load - 1.0)
    result = _with_approach_error(contact, error * contact.load / contact.stiffness)
    return replace(result, load=load, load_error=0.0)


def _with_approach_error(contact: Indentation, change: float) -> Indentation:
    """Add to every error what an error `change` of the approach contributes."""
    load_change = change * contact.stiffness / contact.load
    return replace(
        contact,
        load_error=contact.load_error + load_change,
        approach_error=contact.approach_error + change / contact.approach_size,
        work_error=contact.work_error + contact.load * change / contact.work,
        # the relative change of the stiffness is at most that of the load
        stiffness_error=contact.stiffness_error + load_change,
        pressure_error=contact.pressure_error + load_change * _pressure_by_load(contact),
    )


def _pressure_by_load(contact: Indentation) -> float:
    """Return the largest ``(dp/dln P)/p`` of all radii; below its mean, p is replaced by the mean.

    It is infinite if the pressure or its derivative is not at hand.
    """
    if contact.pressure is None or contact.flat is None:
        return inf
    p = contact.pressure(RADII, 1.0 - RADII)
    flat = contact.flat(RADII, 1.0 - RADII)
    mean = contact.load / (pi * contact.radius**2)
    rate = flat / contact.radius * contact.load / contact.stiffness
    return float((rate / np.maximum(p, mean)).max())
