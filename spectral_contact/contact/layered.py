r"""Normal contact through a nonlinear layer: ``w + N F(w) = delta - h`` with ``p = F(w)``.

The unknown is the overclosure ``w`` beyond the start of the law, in which it is regular also where
the pressure begins. On the unit disk, in units of the radius ``a``, Galerkin's equations are
``M w + K p = moments of [H(1) - H(t)] + 2 eps``, as `indented` has them, with p the function
through the law's values; Newton's matrix is ``M + K F'``. Under a law with an edge ``eps`` is what
makes w vanish there; else it is the approach.
"""

from __future__ import annotations

from math import log, pi

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.indented import (
    Indentation,
    PartedProblem,
    Used,
    edge_value,
    first_space,
    pointwise_errors,
    series_on_parts,
)
from spectral_contact.contact.layered_newton import LayeredFields, LayeredNewton, LayeredSetting
from spectral_contact.contact.refine import Attempt, Resolution
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.fields.series import Radius
from spectral_contact.spectral.parted import pressure_space

__all__ = ["LayeredProblem"]

Array = NDArray[np.float64]

#: Of errors of integrals, as in `indented`; of what two spaces differ by, and of the stiffness.
_INTEGRATED, _DIFFERENCE, _STIFFNESS = 2.0, 1.0, 4.0
#: Roundings of what follows from the data, and of the pressure.
_ROUNDINGS, _POINTWISE_ROUNDINGS = 3.0, 60.0


class LayeredProblem(PartedProblem):
    """Spaces for a contact through a nonlinear layer.

    Parameters
    ----------
    setting : LayeredSetting
    tolerance : float
    pointwise : bool
        Whether the pressure is wanted.
    """

    def __init__(self, setting: LayeredSetting, tolerance: float, *, pointwise: bool) -> None:
        self.setting = setting
        self._features = iter(zip(setting.depths, setting.smooth, strict=True))
        super().__init__(setting.parts, tolerance, pointwise=pointwise)
        self._last: tuple[tuple[Used, ...], Array, float] | None = None

    def _first(self, boundary: Radius, sign: int, extent: float) -> Resolution:
        depth, smooth = next(self._features)
        space = first_space(self, boundary, depth)
        if not smooth:
            return space
        # the estimate sees the square of the distance at which the tail begins; integrals are
        # refined by degrees, which do not lower it
        spare = 2.0 if self.pointwise else 4.0
        depth += -log(self.tolerance) / 2.0 + spare
        count = min(int(depth / space.panels.width) + 1, len(space.degrees))
        return Resolution(space.panels, space.degrees[:count])

    def attempt(self, resolution: Resolution) -> Attempt[Indentation]:
        """Solve in a space."""
        used = self.used(resolution)
        space = pressure_space(self.parts, used)
        solver = LayeredNewton(self.setting, space, used)
        fields = solver.solved(*self._begin(used, solver))
        self._last = used, fields.overclosure, fields.shift
        return self._judged(solver, fields)

    def _begin(self, used: tuple[Used, ...], solver: LayeredNewton) -> tuple[Array, float]:
        """Return where to begin: the solution in the space before, or of a local equation."""
        if self._last is None:
            return solver.local()
        before, known, shift = self._last
        rows = []
        start = 0
        for (old, _), (new, degrees) in zip(before, used, strict=True):
            stop = start + old.panels * (old.degree + 1)
            table = np.zeros((new.panels, new.degree + 1))
            terms = min(old.degree, new.degree) + 1
            table[:, :terms] = known[start:stop].reshape(old.panels, -1)[:, :terms]
            table *= np.arange(new.degree + 1) <= np.array(degrees)[:, None]
            rows += [table.ravel(), known[stop : stop + old.tail_terms]]
            start = stop + old.tail_terms
        return np.concatenate(rows), shift

    def _judged(self, solver: LayeredNewton, fields: LayeredFields) -> Attempt[Indentation]:
        """Return the contact with its errors."""
        setting, used, a = self.setting, solver.used, self.setting.radius
        whole, coarse = solver.integrals(fields), solver.coarser(fields)
        less = solver.integrals(coarse)
        change = solver.change(
            fields.pressure, coarse.pressure, fields.overclosure, coarse.overclosure
        )
        flat_change = solver.change(fields.flat, coarse.flat, fields.rate, coarse.rate)
        series = series_on_parts(used, fields.pressure)
        mean = whole.load / (pi * a**2)
        indicators, rates = pointwise_errors(used, series, fields.pressure, change, mean)

        half = float(setting.profile._transform(np.asarray(a))) / 2.0
        approach = setting.origin + half + a * whole.shift
        deepest = solver.deepest(fields)
        size = max(abs(approach), approach - deepest)
        falls = np.append(rates**2, 1.0)
        worst = float(rates[np.argmax(indicators)])
        energies = np.sqrt(change.energies * flat_change.energies)
        own = _INTEGRATED * 2.0 * pi * float(energies @ falls)
        flat = _INTEGRATED * 2.0 * pi * float(flat_change.energies @ falls)
        both = _INTEGRATED * 2.0 * pi * float(change.energies @ falls)
        # it superconverges, but signs may have made it small
        sides = _DIFFERENCE * worst

        shifted, data = 0.0, size - min(setting.origin, 0.0)
        if setting.approach is None:
            lost = float(
                np.abs((fields.overclosure - coarse.overclosure)[-used[-1][0].tail_terms :]).sum()
            )
            shifted = lost / edge_value(used[-1][0], fields.rate)
            shifted = a * (shifted + sides * abs(whole.shift - less.shift))
        shifted += _ROUNDINGS * ROUNDING * data
        moved = whole.stiffness * shifted
        load_error = (
            (moved + a**2 * own + sides * abs(whole.load - less.load)) / whole.load
            + fields.left
            + ROUNDING
        )
        work_error = (
            (whole.load * shifted + a**3 * both + sides * abs(whole.work - less.work)) / whole.work
            + fields.left
            + ROUNDING
        )
        stiff_error = (
            (a * flat + _STIFFNESS * sides * abs(whole.stiffness - less.stiffness))
            / whole.stiffness
            + fields.left
            + 2.0 * ROUNDING
        )
        rounding = solver.sharpest(fields, mean) * ROUNDING * data
        pressure_error = float(indicators.max()) + fields.left
        pressure_error += _POINTWISE_ROUNDINGS * ROUNDING + rounding
        indentation = Indentation(
            a,
            approach,
            whole.load,
            whole.work,
            whole.stiffness,
            solver.growth(fields),
            self.parts.field(series),
            self.parts.field(series_on_parts(used, fields.flat)) if self.pointwise else None,
            shifted / size + ROUNDING,
            load_error,
            work_error,
            stiff_error,
            pressure_error,
            deepest,
        )
        error = max(indentation.approach_error, load_error, work_error, stiff_error)
        if self.pointwise:
            error = max(error, pressure_error)
        else:
            indicators, rates = indicators**2, rates**2
            # what of the error the pressure does not show is where it is worst
            indicators = indicators * max(1.0, error / float(indicators.max()))
        return Attempt(indentation, error, indicators, rates, solver.space.unknowns)
