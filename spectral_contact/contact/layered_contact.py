"""Contact through a nonlinear layer under a given approach, load or separation.

Under a flat punch, and under a law with pressure at every gap, the contact radius is not an
unknown. The load P is a convex function of the approach, ln P a concave one, and the stiffness is
``dP/d(approach)``. So a step of Newton's method does not overshoot if it is taken for ln P where
the load is too small, and for P where it is too large. The first spaces consist of panels graded to
edges and tips, or of cells.
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
from spectral_contact.errors import ConvergenceError, SceneError
from spectral_contact.fields.series import EDGE
from spectral_contact.layers.layer_base import Layer
from spectral_contact.profiles import Flat, Profile
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels

Contact = Refinement[Indentation]
#: A space, and the fields that solve the problem in it.
LayeredSolution = tuple[Form, LayeredFields]

#: Largest number of Newton steps, and of disks that are tried.
_MAX_STEPS = 100
#: Tolerance of the solutions that estimate the approach under a given load or separation, and the
#: error of the logarithm of the load or pressure at which they end.
_ROUGH_TOLERANCE, _ROUGH_ERROR = 1e-3, 0.01
#: Fraction by which the disk that belongs to the approach of a solution may exceed the disk
#: that was used.
_DISK_MARGIN = 0.01
#: Mean displacement under a uniform pressure, over the displacement at the centre.
_UNIFORM_MEAN_RATIO = 0.85
#: Largest radius of the disk of uniform pressure, and the accuracy of ln radius in the search.
_MAX_RADIUS, _RADIUS_TOLERANCE = 1e12, 0.3
#: Change of a bend, in ``1 - s**2``, that is taken for rounding.
_BEND_ROUNDING = 1e-14
#: How often the sequence of knots in the contact may change before the parts are kept.
_MAX_KNOT_CHANGES = 8
#: Degrees of the first space on a cell for each e-fold of the tolerance.
_DEGREES_PER_EFOLD = 0.55
#: Error of the stiffness by the tail at the edge, over the extent of the tail in widths of the edge
#: layer. It is 8e-4 at most, under a power law of exponent 1.1: the slope of this law goes like a
#: small power of the overclosure, which the tail does not represent.
_TAIL_ERROR = 1e-3


class LayeredProblem(Layered, PartedProblem):
    """The problem of contact through a nonlinear layer, on panels.

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
        """Return the first space of a part whose narrowest feature is at the depth x.

        If the pressure is not wanted, the attribute `tolerance` is the root of the one asked for
        (`PartedProblem`).
        """
        space = super()._first_space(part, depth)
        if not self.setting.smooth[part]:
            if self.pointwise or self.parts.ends[part][0] is not EDGE:
                return space
            # the depth at which _TAIL_ERROR times the extent of the tail is the tolerance asked for
            depth += log(_TAIL_ERROR) - 2.0 * log(self.tolerance)
            more = max(ceil(depth / space.panels.width) - len(space.degrees), 0)
            return DiscreteSpace(space.panels, space.degrees + (space.degrees[-1],) * more)
        # The pressure is smooth in s**2 up to the end, as the tail is: it may begin earlier than in
        # `space`. Errors of integrals go like the square of the distance at which it begins, and a
        # higher degree does not lower them, so that depth follows from the tolerance.
        spare = 2.0 if self.pointwise else 4.0
        depth += -log(self.tolerance) / 2.0 + spare
        count = min(int(depth / space.panels.width) + 1, len(space.degrees))
        return DiscreteSpace(space.panels, space.degrees[:count])

    def _form(self, space: DiscreteSpace) -> PanelForm:
        return PanelForm(self.parts, self.part_spaces(space))


class BentProblem(LayeredProblem):
    """The problem on panels that are also graded to the bends of the law.

    The radii of the bends are those of the solution.

    Parameters
    ----------
    setting, tolerance, pointwise
        As in `LayeredProblem`.
    last : tuple of (Form, LayeredFields) or None
        A solution to begin with.
    final : bool
        Whether a solution that meets other knots than those of the setting is accepted: the
        estimate then includes the error of the misplaced parts.

    Raises
    ------
    BendsChangedError
        By `attempt`, if a solution meets other knots and `final` is false.
    """

    def __init__(
        self,
        setting: LayeredSetting,
        tolerance: float,
        *,
        pointwise: bool,
        last: LayeredSolution | None = None,
        final: bool = False,
    ) -> None:
        super().__init__(setting, tolerance, pointwise=pointwise)
        self.last = last
        self._final = final

    def _solve(self, space: DiscreteSpace) -> tuple[LayeredNewton, LayeredFields]:
        """Return the solution on parts that end at its bends, and store these in the setting.

        If a part ends at a distance d from a bend, the error of the overclosure is about d**2. So
        the bends taken from one solution after another converge quadratically.
        """
        last_move = inf
        while True:
            solver, fields = super()._solve(space)
            form = solver.form
            assert isinstance(form, PanelForm)
            errors = form.sampling.bounds(solver.top_degrees(fields.overclosure))
            bends = bends_of(self.setting, form, fields.overclosure, errors)
            if not same_knots(bends, self.setting.bends):
                if not self._final:
                    raise BendsChangedError(bends, (form, fields))
                return solver, fields
            move = max(
                (
                    abs(new.radius.rest - old.radius.rest)
                    for new, old in zip(bends, self.setting.bends, strict=True)
                ),
                default=0.0,
            )
            if move <= _BEND_ROUNDING or move > 0.5 * last_move:
                return solver, fields
            last_move = move
            self.setting = with_bends(self.setting, bends)
            self.parts = self.setting.parts

    def _misplacement(self, form: Form, fields: LayeredFields) -> Misplacement:
        """Return bounds of the errors by parts that do not end at the bends of the solution."""
        assert isinstance(form, PanelForm)
        return misplacement(self.setting, form, fields)


class CellProblem(Layered):
    """The problem of contact through a nonlinear layer, on cells.

    Parameters are those of `LayeredProblem`.
    """

    def __init__(self, setting: LayeredSetting, tolerance: float, *, pointwise: bool) -> None:
        super().__init__(setting, pointwise=pointwise)
        self._degree = (
            ceil(_DEGREES_PER_EFOLD * -log(tolerance if pointwise else sqrt(tolerance))) + 2
        )

    def start(self) -> DiscreteSpace:
        """Return the first space to try."""
        assert self.setting.cells is not None
        count = len(self.setting.cells.lengths)
        # `refine` raises degrees panel by panel; here a panel stands for a cell
        return DiscreteSpace(LogPanels(count, 1.0, self._degree), (self._degree,) * count)

    def _form(self, space: DiscreteSpace) -> Form:
        assert self.setting.cells is not None
        return CellForm(self.setting.cells, space.degrees)


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
    # with a given overclosure at the centre, the error of the approach follows from that of the
    # central pressure
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
    """Solve with a law that bends, on parts that end at its bends.

    The first bends are those of the setting, if it has them from a similar contact, or of solutions
    to a few digits. If the knots in the contact keep changing, the last parts stay, and the
    estimate then includes the error of the misplaced parts.
    """
    if not setting.bends:
        setting, last = _roughly_bent(setting, tolerance, max_unknowns, pointwise=pointwise)
    for change in range(_MAX_KNOT_CHANGES):
        final = change == _MAX_KNOT_CHANGES - 1
        problem = BentProblem(setting, tolerance, pointwise=pointwise, last=last, final=final)
        try:
            return refine(problem, tolerance, max_unknowns), problem.last
        except BendsChangedError as changed:
            setting, last = with_bends(setting, changed.bends), changed.last
    raise AssertionError("the last attempt is final")


def _roughly_bent(
    setting: LayeredSetting, tolerance: float, max_unknowns: int, *, pointwise: bool
) -> tuple[LayeredSetting, LayeredSolution | None]:
    """Return the setting with the bends of a solution to a few digits, and that solution."""
    last: LayeredSolution | None = None
    for _ in range(_MAX_KNOT_CHANGES):
        problem = BentProblem(
            setting, max(tolerance, _ROUGH_TOLERANCE), pointwise=pointwise, last=last
        )
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
    """Return the contact under a load, approach or separation, where no radius has to be found.

    Parameters
    ----------
    profile : Profile
    layer : Layer
    tolerance, max_unknowns, pointwise
        As in `solve_layered`.
    load, approach, separation : float or None
        The given one of them; the others are None. The separation is that at the centre, of which
        the law is a function.
    drives : bool
        Whether the pressure, under a flat punch, is needed as the known pressure of a traction.

    Raises
    ------
    SceneError
        If the profile ends before the pressure does.
    ConvergenceError
        If the approach of a load or separation, or the disk, is not found.
    """
    if approach is not None:
        setting = replace(setting_at_approach(profile, layer, approach), drives=drives)
        solved = solve_layered(setting, tolerance, max_unknowns, pointwise=pointwise)
        return _with_exact_approach(solved, approach)

    def rough_contact(approach: float) -> Contact:
        setting = setting_at_approach(profile, layer, approach)
        return solve_layered(setting, _ROUGH_TOLERANCE, max_unknowns, pointwise=load is None)

    central_overclosure = None if separation is None else -separation
    name, value = ("load", load) if separation is None else ("separation", separation)
    try:
        if load is not None:
            start = _first_approach(profile, layer, load)
            guess = _rough_approach(
                rough_contact, start, load, lambda contact: (contact.load, contact.stiffness)
            )
        else:
            # the approach exceeds the overclosure at the centre, so this start is below the answer
            assert central_overclosure is not None
            pressure = float(layer._pressure(np.array(central_overclosure)))
            guess = _rough_approach(rough_contact, central_overclosure, pressure, at_centre)
        for _ in range(_MAX_STEPS):
            setting = setting_at_approach(profile, layer, guess)
            setting = replace(setting, load=load, centre=central_overclosure, drives=drives)
            solved = solve_layered(setting, tolerance, max_unknowns, pointwise=pointwise)
            guess = solved.best.value.approach
            radius = setting_at_approach(profile, layer, guess).radius
            if radius <= (1.0 + _DISK_MARGIN) * setting.radius:
                return solved
    except SceneError as error:
        raise SceneError(name, value, error.allowed) from error
    raise _unsettled("disk that holds the pressure")


def _first_approach(profile: Profile, layer: Layer, load: float) -> float:
    """Return a first approach under a load.

    A uniform pressure on a disk is taken, of the radius for which the approach is least.
    """

    def approach(radius: float) -> float:
        height = 0.0 if flat else float(profile._height(np.array(radius * sqrt(0.5))))
        displacement = _UNIFORM_MEAN_RATIO * load / (2.0 * pi * radius)
        return displacement + height + layer._overclosure(load / (pi * radius**2))

    flat = isinstance(profile, Flat)
    if flat:
        return approach(profile.reach)
    # golden section search in the logarithm of the radius
    high = log(min(profile.reach, _MAX_RADIUS))
    low = high - 2.0 * log(_MAX_RADIUS)
    golden = (sqrt(5.0) - 1.0) / 2.0
    with np.errstate(over="ignore"):
        while high - low > _RADIUS_TOLERANCE:
            left = high - golden * (high - low)
            right = low + golden * (high - low)
            low, high = (low, right) if approach(exp(left)) < approach(exp(right)) else (left, high)
        return approach(exp(0.5 * (low + high)))


def _rough_approach(
    solve: Callable[[float], Contact],
    approach: float,
    given: float,
    value_and_rate: Callable[[Indentation], tuple[float, float]],
) -> float:
    """Return an approach at which a value, load or pressure, is roughly the given one.

    It is found by Newton's method from an approach, with the derivative of the value by it.

    Raises
    ------
    ConvergenceError
        If the method does not end.
    """
    for _ in range(_MAX_STEPS):
        contact = solve(approach).best.value
        value, rate = value_and_rate(contact)
        if not 0.0 < value < inf:
            break
        residual = log(value / given)
        missing = (given - value) if residual > 0.0 else -residual * value
        approach = contact.approach + missing / rate
        if abs(residual) <= _ROUGH_ERROR:
            return approach
    raise _unsettled("approach")


def _unsettled(quantity: str) -> ConvergenceError:
    return ConvergenceError(
        f"the {quantity} does not settle", "give an approach instead, and report the scene"
    )


def _with_exact_approach(solved: Contact, approach: float) -> Contact:
    """Return the contact with the given approach as an exact number."""
    contact = replace(solved.best.value, approach=approach, approach_error=0.0)
    return replace(solved, best=replace(solved.best, value=contact))
