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
from spectral_contact.contact.layered_bends import (
    BendsChangedError,
    Misplacement,
    bends_of,
    misplacement,
    same_knots,
)
from spectral_contact.contact.layered_newton import LayeredFields, LayeredNewton, LayeredSetting
from spectral_contact.contact.layered_setting import setting_at_approach, with_bends
from spectral_contact.contact.layered_spaces import CellForm, Form, PanelForm
from spectral_contact.contact.on_parts import Indentation, PartedProblem
from spectral_contact.contact.refine import Refinement, refine, within_budget
from spectral_contact.errors import SceneError
from spectral_contact.fields.series import EDGE
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles import Flat, Profile
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels

Contact = Refinement[Indentation]
LayeredSolution = tuple[Form, LayeredFields]

#: Steps in all.
_STEPS = 100
#: Tolerance of the first solutions under a load, and what is near in its logarithm; by how much the
#: disk may be too small.
_ROUGH, _NEAR, _WITHIN = 1e-3, 0.01, 0.01
#: Mean displacement of an even pressure over that at its centre; largest radius that is looked at,
#: and how well one is found, in logarithms.
_BENT, _FAR, _FOUND = 0.85, 1e12, 0.3
#: Distance in ``s**2`` by which bends may still move on, about their rounding; how often other
#: knots are tried.
_STILL, _CHANGES = 1e-14, 8
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

    def _first_space(self, part: int, depth: float) -> DiscreteSpace:
        space = super()._first_space(part, depth)
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

    def _form(self, resolution: DiscreteSpace) -> PanelForm:
        return PanelForm(self.parts, self.part_spaces(resolution))


class BentProblem(LayeredProblem):
    """Log panels to the bends of a law, too, whose radii are found with the solution.

    Parameters
    ----------
    setting, tolerance, pointwise
        As of `LayeredProblem`.
    last : tuple of (Form, LayeredFields) or None
        A solution to begin with.
    final : bool
        Whether bends of other knots than those of the setting are left to the estimate.

    Raises
    ------
    BendsChangedError
        By `attempt`, if a solution meets other knots and that is not final.
    """

    def __init__(
        self,
        setting: LayeredSetting,
        tolerance: float,
        *,
        pointwise: bool,
        last: tuple[Form, LayeredFields] | None = None,
        final: bool = False,
    ) -> None:
        super().__init__(setting, tolerance, pointwise=pointwise)
        self.last, self._final = last, final

    def _solved(self, resolution: DiscreteSpace) -> tuple[LayeredNewton, LayeredFields]:
        """Return the solution with parts that end at its bends, and leave these in the setting.

        A kink that is misplaced by d is an error of the overclosure of about d**2, so that bends
        of one solution after the other converge quadratically.
        """
        before = inf
        while True:
            solver, fields = super()._solved(resolution)
            form = solver.form
            assert isinstance(form, PanelForm)
            uncertain = form.sampling.bounds(solver.last_degrees(fields.overclosure))
            bends = bends_of(self.setting, form, fields.overclosure, uncertain)
            if not same_knots(bends, self.setting.bends):
                if not self._final:
                    raise BendsChangedError(bends, (form, fields))
                return solver, fields
            moved = max(
                (
                    abs(new.radius.rest - old.radius.rest)
                    for new, old in zip(bends, self.setting.bends, strict=True)
                ),
                default=0.0,
            )
            if moved <= _STILL or moved > 0.5 * before:
                return solver, fields
            before = moved
            self.setting = with_bends(self.setting, bends)
            self.parts = self.setting.parts

    def _misplacement(self, form: Form, fields: LayeredFields) -> Misplacement:
        """Return what is left where parts do not end at the bends of the solution."""
        assert isinstance(form, PanelForm)
        return misplacement(self.setting, form, fields)


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
    """Solve normal contact through a nonlinear layer; parameters as of `solve_layered_from`."""
    return solve_layered_from(None, setting, tolerance, max_unknowns, pointwise=pointwise)[0]


def solve_layered_from(
    last: LayeredSolution | None,
    setting: LayeredSetting,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool,
) -> tuple[Contact, LayeredSolution | None]:
    """Solve normal contact through a nonlinear layer, and return what the next one may begin with.

    Parameters
    ----------
    last : tuple of (Form, LayeredFields) or None
        The solution of a contact much like this one, as this function returned it.
    setting : LayeredSetting
    tolerance : float
        Bound on the relative error of approach and load, and of the pressure if that is wanted.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted.
    """
    # what is given at the centre is known as well as the pressure there
    pointwise = pointwise or setting.centre is not None
    if setting.layer.knots:
        return _solve_bent(last, setting, tolerance, max_unknowns, pointwise=pointwise)
    if setting.cells is not None:
        return refine(
            CellProblem(setting, tolerance, pointwise=pointwise), tolerance, max_unknowns
        ), None
    problem = LayeredProblem(setting, tolerance, pointwise=pointwise)
    problem.last = last
    return refine(problem, tolerance, max_unknowns), problem.last


def _solve_bent(
    last: LayeredSolution | None,
    setting: LayeredSetting,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool,
) -> tuple[Contact, LayeredSolution | None]:
    """Solve with a law that bends, on parts that end where it does.

    What knots the contact meets is known from solutions to a few digits, or from a contact like
    it. Where other knots come and go the last parts stay, and the rest is left to the estimate.
    """
    if not setting.bends:
        setting, last = _roughly_bent(setting, tolerance, max_unknowns, pointwise=pointwise)
    for change in range(_CHANGES):
        final = change == _CHANGES - 1
        problem = BentProblem(setting, tolerance, pointwise=pointwise, last=last, final=final)
        try:
            return refine(problem, tolerance, max_unknowns), problem.last
        except BendsChangedError as changed:
            setting, last = with_bends(setting, changed.bends), changed.last
    raise AssertionError("the last attempt is final")


def _roughly_bent(
    setting: LayeredSetting, tolerance: float, max_unknowns: int, *, pointwise: bool
) -> tuple[LayeredSetting, tuple[Form, LayeredFields] | None]:
    """Return the setting with the bends of a solution to a few digits, and the solution."""
    last: tuple[Form, LayeredFields] | None = None
    for _ in range(_CHANGES):
        problem = BentProblem(setting, max(tolerance, _ROUGH), pointwise=pointwise, last=last)
        try:
            problem.attempt(within_budget(problem.start(), max_unknowns))
        except BendsChangedError as changed:
            setting, last = with_bends(setting, changed.bends), changed.last
        else:
            return problem.setting, problem.last
    return setting, last


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
