"""Contact through a nonlinear layer, of an approach, under a load, or of a separation.

Where the contact has no radius of its own, which is under a flat punch or a law with pressure at
every gap, the load is a function of the approach, with the stiffness as derivative: its logarithm
bends down and itself up, so that Newton's method comes from either side without overshooting.
The first spaces are panels to edges and tips, or cells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, exp, inf, log, pi, sqrt

import numpy as np

from spectral_contact.contact.layered import Layered, at_centre
from spectral_contact.contact.layered_newton import LayeredSetting
from spectral_contact.contact.layered_setting import setting_at_approach
from spectral_contact.contact.layered_spaces import CellForm, Form, PanelForm
from spectral_contact.contact.on_parts import Indentation, PartedProblem
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import EDGE
from spectral_contact.layers.base import Layer
from spectral_contact.profiles import Flat, Profile
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels

Contact = Refinement[Indentation]

#: Steps in all.
_STEPS = 100
#: Tolerance of the first solutions under a load, and what is near in its logarithm; by how much the
#: disk may be too small.
_ROUGH, _NEAR, _WITHIN = 1e-3, 0.01, 0.01
#: Mean displacement of an even pressure over that at its centre; largest radius that is looked at,
#: and how well one is found, in logarithms.
_BENT, _FAR, _FOUND = 0.85, 1e12, 0.3
#: First degree on a cell for a digit (base e).
_DEGREES = 0.55
#: What the stiffness may lack in the tail at the edge, over the distance at which that begins: at
#: most 8e-4 at the exponent 1.1 of a power law, less at others.
_MISSED = 1e-3


class LayeredProblem(Layered, PartedProblem):
    """Log panels for a contact through a nonlinear layer.

    Parameters
    ----------
    setting : LayeredSetting
    tolerance : float
    pointwise : bool
        Whether the pressure is wanted.
    """

    def __init__(self, setting: LayeredSetting, tolerance: float, *, pointwise: bool) -> None:
        Layered.__init__(self, setting, pointwise=pointwise)
        PartedProblem.__init__(self, setting.parts, setting.depths, tolerance, pointwise=pointwise)

    def _first(self, part: int, depth: float) -> DiscreteSpace:
        space = super()._first(part, depth)
        if not self.setting.smooth[part]:
            if self.pointwise or self.parts.ends[part][0] is not EDGE:
                return space
            depth += log(_MISSED) - 2.0 * log(self.tolerance)
            more = max(ceil(depth / space.panels.width) - len(space.degrees), 0)
            return DiscreteSpace(space.panels, space.degrees + (space.degrees[-1],) * more)
        # the estimate sees the square of the distance at which the tail begins; integrals are
        # refined by degrees, which do not lower it
        spare = 2.0 if self.pointwise else 4.0
        depth += -log(self.tolerance) / 2.0 + spare
        count = min(int(depth / space.panels.width) + 1, len(space.degrees))
        return DiscreteSpace(space.panels, space.degrees[:count])

    def _form(self, resolution: DiscreteSpace) -> Form:
        return PanelForm(self.parts, self.used(resolution))


class CellProblem(Layered):
    """Cells for a contact through a nonlinear layer; parameters as of `LayeredProblem`."""

    def __init__(self, setting: LayeredSetting, tolerance: float, *, pointwise: bool) -> None:
        super().__init__(setting, pointwise=pointwise)
        self._degree = ceil(_DEGREES * -log(tolerance if pointwise else sqrt(tolerance))) + 2

    def start(self) -> DiscreteSpace:
        """Return the first space to try."""
        assert self.setting.cells is not None
        count = len(self.setting.cells.lengths)
        # the refinement counts degrees on panels, which cells have none of
        return DiscreteSpace(LogPanels(count, 1.0, self._degree), (self._degree,) * count)

    def _form(self, resolution: DiscreteSpace) -> Form:
        assert self.setting.cells is not None
        return CellForm(self.setting.cells, resolution.degrees)


def solve_layered(
    setting: LayeredSetting, tolerance: float, max_unknowns: int, *, pointwise: bool = True
) -> Contact:
    """Solve normal contact through a nonlinear layer in a setting.

    Parameters
    ----------
    setting : LayeredSetting
    tolerance : float
        Bound on the relative error of approach and load, and of the pressure if that is wanted.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted.
    """
    kind = LayeredProblem if setting.cells is None else CellProblem
    # what is given at the centre is known as well as the pressure there
    problem = kind(setting, tolerance, pointwise=pointwise or setting.centre is not None)
    return refine(problem, tolerance, max_unknowns)


def layered_contact(
    profile: Profile,
    layer: Layer,
    tolerance: float,
    max_unknowns: int,
    *,
    load: float | None,
    approach: float | None,
    separation: float | None,
    pointwise: bool,
    drives: bool = False,
) -> Contact:
    """Return the contact of what is given, where it has no radius of its own.

    Parameters
    ----------
    profile : Profile
    layer : Layer
    tolerance, max_unknowns, pointwise
        As of `solve_layered`.
    load, approach, separation : float or None
        One of them; the separation is that at the centre, of which the law is a function.
    drives : bool
        Whether the pressure, under a flat punch, has to drive a traction.

    Raises
    ------
    SceneError
        If the profile ends before the pressure does.
    """
    if approach is not None:
        setting = replace(setting_at_approach(profile, layer, approach), drives=drives)
        found = solve_layered(setting, tolerance, max_unknowns, pointwise=pointwise)
        return _exactly(found, approach)

    def roughly(approach: float) -> Contact:
        setting = setting_at_approach(profile, layer, approach)
        return solve_layered(setting, _ROUGH, max_unknowns, pointwise=load is None)

    centre = None if separation is None else -separation
    name, value = ("load", load) if centre is None else ("separation", separation)
    try:
        if load is not None:
            begin = _begin(profile, layer, load)
            near = _searched(roughly, begin, load, lambda one: (one.load, one.stiffness))
        else:
            assert centre is not None  # the approach is larger than it, at least
            known = float(layer._pressure(np.array(centre)))
            near = _searched(roughly, centre, known, at_centre)
        for _ in range(_STEPS):
            setting = setting_at_approach(profile, layer, near)
            setting = replace(setting, load=load, centre=centre, drives=drives)
            found = solve_layered(setting, tolerance, max_unknowns, pointwise=pointwise)
            near = found.best.value.approach
            domain = setting_at_approach(profile, layer, near).radius
            if domain <= (1.0 + _WITHIN) * setting.radius:
                break
    except SceneError as error:
        told = f"what the profile carries before it ends: {error.allowed}"
        raise SceneError(name, value, told) from error
    return found


def _begin(profile: Profile, layer: Layer, load: float) -> float:
    """Return an approach to begin with: that of an even pressure on the disk where it is least."""
    if layer.limit < inf:
        return layer.start + layer._size

    def of_radius(radius: float) -> float:
        height = 0.0 if flat else float(profile._height(np.array(radius * sqrt(0.5))))
        bent = _BENT * load / (2.0 * pi * radius)
        return bent + height + layer._overclosure(load / (pi * radius**2))

    flat = isinstance(profile, Flat)
    if flat:
        return of_radius(profile.reach)
    # golden sections in the logarithm
    high = log(min(profile.reach, _FAR))
    low, step = high - 2.0 * log(_FAR), (sqrt(5.0) - 1.0) / 2.0
    with np.errstate(over="ignore"):
        while high - low > _FOUND:
            one, two = high - step * (high - low), low + step * (high - low)
            low, high = (low, two) if of_radius(exp(one)) < of_radius(exp(two)) else (one, high)
        return of_radius(exp(0.5 * (low + high)))


def _searched(
    solve: Callable[[float], Contact],
    approach: float,
    asked: float,
    measured: Callable[[Indentation], tuple[float, float]],
) -> float:
    """Step until a value, load or pressure, is near to what is asked, and return the approach.

    Its logarithm bends down over the approach. It is measured with its rate.
    """
    for _ in range(_STEPS):
        one = solve(approach).best.value
        value, rate = measured(one)
        off = log(value / asked)
        missing = (asked - value) if off > 0.0 else -off * value
        approach = one.approach + missing / rate
        if abs(off) <= _NEAR:
            break
    return approach


def _exactly(found: Contact, approach: float) -> Contact:
    """Return the contact of just this approach."""
    one = replace(found.best.value, approach=approach, approach_error=0.0)
    return replace(found, best=replace(found.best, value=one))
