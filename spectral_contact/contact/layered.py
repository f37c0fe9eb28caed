r"""Normal contact through a nonlinear layer: ``w + N F(w) = delta - h`` with ``p = F(w)``.

The unknown is the overclosure ``w`` beyond the start of the law, in which it is regular also where
the pressure begins. On the unit disk, in units of the radius ``a``, Galerkin's equations are
``M w + K p = moments of [H(1) - H(t)] + 2 eps``, as `indented` has them, with p the function
through the law's values; Newton's matrix is ``M + K F'``. Under a law with an edge ``eps`` is what
makes w vanish there; else it is the approach.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.layered_bends import NO_MISPLACEMENT, Misplacement
from spectral_contact.contact.layered_newton import LayeredFields, LayeredNewton, LayeredSetting
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import SpaceSolution
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.fields.series import central_value
from spectral_contact.spectral.panels import DiscreteSpace

if TYPE_CHECKING:
    from spectral_contact.contact.layered_spaces import Form

Array = NDArray[np.float64]

#: Of errors of integrals, as in `indented`; and of what the stiffness of two spaces differs by.
_INTEGRATED, _STIFFNESS = 2.0, 16.0
#: Roundings of what follows from the data, and of the pressure.
_ROUNDINGS, _POINTWISE_ROUNDINGS = 3.0, 60.0
#: Where growth of the pressure with the load is looked for.
_PLACES = np.linspace(0.0, 1.0, 257)


class Layered(ABC):
    """What is solved in any space.

    Parameters
    ----------
    setting : LayeredSetting
    pointwise : bool
        Whether the pressure is wanted.
    """

    def __init__(self, setting: LayeredSetting, *, pointwise: bool) -> None:
        self.setting, self.pointwise = setting, pointwise
        #: the space before, and the solution there
        self.last: tuple[Form, LayeredFields] | None = None

    @abstractmethod
    def _form(self, resolution: DiscreteSpace) -> Form:
        """Return the space."""

    def attempt(self, resolution: DiscreteSpace) -> SpaceSolution[Indentation]:
        """Solve in a space."""
        return self._judged(*self._solved(resolution))

    def _solved(self, resolution: DiscreteSpace) -> tuple[LayeredNewton, LayeredFields]:
        """Return the solution in a space, after the last one there was."""
        form = self._form(resolution)
        solver = LayeredNewton(self.setting, form)
        fields = None
        if self.last is not None:
            old, last = self.last
            fields = solver.solved(form.carried(last.overclosure, old), last.shift)
        if fields is None or fields.left == inf:
            fields = solver.solved(*solver.local())
        self.last = form, fields
        return solver, fields

    def _misplacement(self, form: Form, fields: LayeredFields) -> Misplacement:
        """Return what bends of the law make at which no part ends: nothing if there are none."""
        return NO_MISPLACEMENT

    def _judged(self, solver: LayeredNewton, fields: LayeredFields) -> SpaceSolution[Indentation]:
        """Return the contact with its errors."""
        setting, form, a = self.setting, solver.form, self.setting.radius
        whole, coarse = solver.integrals(fields), solver.coarser(fields)
        less = solver.integrals(coarse)
        change = solver.change(
            fields.pressure, coarse.pressure, fields.overclosure, coarse.overclosure
        )
        flat_change = solver.change(fields.flat, coarse.flat, fields.rate, coarse.rate)
        mean = whole.load / (pi * a**2)
        indicators = form.errors(fields.pressure, change, mean)

        half = float(setting.profile._transform(np.asarray(a))) / 2.0
        approach = setting.origin + half + a * whole.shift
        deepest = solver.deepest(fields)
        size = max(abs(approach), approach - deepest)
        energies = np.sqrt(change.energies * flat_change.energies)
        own = _INTEGRATED * 2.0 * pi * float(energies.sum())
        flat = _INTEGRATED * 2.0 * pi * float(flat_change.energies.sum())
        both = _INTEGRATED * 2.0 * pi * float(change.energies.sum())

        misplaced = self._misplacement(form, fields)
        shifted, data = 0.0, size - min(setting.origin, 0.0)
        if setting.approach is None:
            lost = form.lost_at_edge(fields.overclosure - coarse.overclosure)
            shifted = lost / form.at_edge(fields.rate)
            shifted = a * (shifted + abs(whole.shift - less.shift))
            shifted += misplaced.load / whole.stiffness
        shifted += _ROUNDINGS * ROUNDING * data
        moved = whole.stiffness * shifted
        load_error = (
            (moved + a**2 * own + abs(whole.load - less.load)) / whole.load
            + misplaced.load / whole.load
            + fields.left
            + ROUNDING
        )
        work_error = (
            (whole.load * shifted + a**3 * both + abs(whole.work - less.work)) / whole.work
            + misplaced.load / whole.load
            + fields.left
            + ROUNDING
        )
        stiff_error = (
            (2.0 * a * flat + _STIFFNESS * abs(whole.stiffness - less.stiffness)) / whole.stiffness
            + (solver.missed(fields) + misplaced.stiffness) / whole.stiffness
            + fields.left
            + 2.0 * ROUNDING
        )
        rounding = solver.sharpest(fields, mean) * ROUNDING * data
        pressure_error = float(indicators.max()) + fields.left
        pressure_error += _POINTWISE_ROUNDINGS * ROUNDING + rounding + misplaced.pressure / mean
        normal = None
        if setting.drives:
            normal = form.driving(fields.pressure, change, solver.thinnest(fields))
        indentation = Indentation(
            a,
            approach,
            whole.load,
            whole.work,
            whole.stiffness,
            solver.growth(fields),
            form.field(fields.pressure),
            form.field(fields.flat) if self.pointwise else None,
            shifted / size + ROUNDING,
            load_error,
            work_error,
            stiff_error,
            pressure_error,
            deepest,
            normal,
            setting.bends,
        )
        if setting.load is not None:
            indentation = _under(indentation, setting.load)
        if setting.centre is not None:
            lost = float(indicators[: form.central].max()) + fields.left
            pressure, rate = at_centre(indentation)
            indentation = _moved(indentation, lost * max(pressure, mean) / rate)
        error = max(
            indentation.approach_error,
            indentation.load_error,
            indentation.work_error,
            indentation.stiffness_error,
        )
        if self.pointwise:
            error = max(error, indentation.pressure_error)
        else:
            shares = _STIFFNESS * np.abs(solver.carried(flat_change.coefficients))
            indicators = np.maximum(indicators**2, shares / whole.stiffness)
        if setting.centre is not None or not self.pointwise or setting.layer.knots:
            # what of the error they do not show is where they are worst
            indicators = indicators * max(1.0, error / float(indicators.max()))
        return SpaceSolution(indentation, error, indicators, form.space.unknowns)


def at_centre(one: Indentation) -> tuple[float, float]:
    """Return the pressure at the centre, and its rate over the approach."""
    assert one.pressure is not None
    assert one.flat is not None
    return central_value(one.pressure), central_value(one.flat) / one.radius


def _under(one: Indentation, load: float) -> Indentation:
    """Return the contact under just this load, whose error is that of the approach."""
    off = one.load_error + 2.0 * abs(one.load / load - 1.0)
    return replace(_moved(one, off * one.load / one.stiffness), load=load, load_error=0.0)


def _moved(one: Indentation, moved: float) -> Indentation:
    """Return the contact where the approach may be off by as much."""
    off = moved * one.stiffness / one.load
    return replace(
        one,
        load_error=one.load_error + off,
        approach_error=one.approach_error + moved / one.approach_size,
        work_error=one.work_error + one.load * moved / one.work,
        # as fast as the pressure itself at most
        stiffness_error=one.stiffness_error + off,
        pressure_error=one.pressure_error + off * _sharper(one),
    )


def _sharper(one: Indentation) -> float:
    """Return by how much the pressure, or its mean, grows with the load, both relative."""
    if one.pressure is None or one.flat is None:
        return inf
    p, flat = one.pressure(_PLACES, 1.0 - _PLACES), one.flat(_PLACES, 1.0 - _PLACES)
    mean = one.load / (pi * one.radius**2)
    moved = flat / one.radius * one.load / one.stiffness
    return float((moved / np.maximum(p, mean)).max())
