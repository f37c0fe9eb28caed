"""States of adhesive contact for what a scene gives, and whether they are stable."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import copysign, inf, pi
from typing import TYPE_CHECKING, NoReturn

from spectral_contact.contact.adhesion import (
    BY_APPROACH,
    BY_LOAD,
    AdhesiveCurve,
    NoState,
)
from spectral_contact.contact.contact_radius import Contact
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.pinned import PinnedContact
from spectral_contact.contact.tuning import ROUNDING
from spectral_contact.errors import SceneError

if TYPE_CHECKING:
    from spectral_contact.scene import Scene

#: What may be held, by the name that a scene has for it.
CONTROLS_HELD = ("load", "approach")


@dataclass(frozen=True, slots=True)
class Stability:
    """Whether a state is stable, and the stiffness along the curve.

    Attributes
    ----------
    stable_under : tuple of str
        Of `CONTROLS_HELD`, those under which the contact stays where it is.
    stiffness : float or None
        ``dP/ddelta`` along the curve. None where it has two values; infinite, with the sign of
        ``dP/da``, where the approach does not change with the radius, within its error.
    error : float
        Error of that, relative to itself or to the stiffness at a fixed radius if that is larger.
    reason : str
        Why there is no stiffness.
    """

    stable_under: tuple[str, ...]
    stiffness: float | None
    error: float = 0.0
    reason: str = ""


def curve_of(scene: Scene, tolerance: float, max_unknowns: int) -> AdhesiveCurve:
    """Return the states of a scene by their contact radius."""
    assert scene.profile is not None
    assert scene.work_of_adhesion is not None
    return AdhesiveCurve(
        scene.profile, scene.normal_compliance, scene.work_of_adhesion, tolerance, max_unknowns
    )


def pinned_of(
    scene: Scene, tolerance: float, max_unknowns: int, *, pointwise: bool
) -> PinnedContact:
    """Return the contact of a scene with a flat punch, whose radius is that of the contact.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Bound on relative errors.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the pressure is wanted, too.
    """
    assert scene.profile is not None
    return PinnedContact(
        scene.profile.reach,
        scene.normal_compliance,
        scene.work_of_adhesion or 0.0,
        tolerance,
        max_unknowns,
        pointwise=pointwise,
    )


def pinned(scene: Scene, tolerance: float, max_unknowns: int, *, pointwise: bool) -> Contact:
    """Return the contact of a flat punch under the load, or at the approach, of a scene.

    Parameters are those of `pinned_of`.

    Raises
    ------
    SceneError
        If the punch has come off at this load, or another branch than 0 is asked for.
    """
    contact = pinned_of(scene, tolerance, max_unknowns, pointwise=pointwise)
    if scene.branch:
        raise SceneError("branch", scene.branch, "0 under a flat punch, which has one state")
    load = scene.load
    if load is None:
        assert scene.approach is not None
        load = contact.load_of(scene.approach)
    # the load of pull-off is negative
    if load < contact.pull_off_load * (1.0 + contact.pull_off_error):
        limit = contact.pull_off_load if scene.approach is None else contact.pull_off_approach
        _refuse(scene, limit)
    return contact.under(load, scene.approach)


def adhesive(
    scene: Scene, tolerance: float, max_unknowns: int, *, pointwise: bool
) -> tuple[Contact, float]:
    """Return the state of a load or an approach, and the relative error of its radius.

    Raises
    ------
    SceneError
        If there is none on the branch.
    """
    curve = curve_of(scene, tolerance, max_unknowns)
    control = BY_LOAD if scene.approach is None else BY_APPROACH
    value = scene.load if scene.approach is None else scene.approach
    assert value is not None
    try:
        return curve.find(control, value, scene.branch, pointwise=pointwise)
    except NoState as missing:
        if missing.stretches == 0:
            refuse_reach(scene, "approach" if scene.load is None else "load")
        if missing.limit is None:
            allowed = f"less than {missing.stretches}, the number of branches"
            raise SceneError("branch", scene.branch, allowed) from None
        _refuse(scene, missing.limit)


def refuse_reach(scene: Scene, name: str) -> NoReturn:
    """Refuse a parameter with which the contact would grow to the end of the profile."""
    assert scene.profile is not None
    allowed = (
        "such that a stable contact is smaller than the profile, which ends at "
        f"{scene.profile.reach:.6g}: adhesion makes the contact grow to that end"
    )
    raise SceneError(name, getattr(scene, name), allowed)


def _refuse(scene: Scene, limit: float) -> NoReturn:
    """Refuse a load or an approach that no state on the branch has."""
    name = "load" if scene.approach is None else "approach"
    value = getattr(scene, name)
    side = "at least" if value < limit else "at most"
    limit_name = f"that of pull-off under control of the {name}"
    if scene.branch:
        limit_name = f"where branch {scene.branch} ends"
    beyond = f"{abs(value - limit):.3g}"
    if limit:
        beyond += f", which is {abs(value - limit) / abs(limit):.3g} of it"
    raise SceneError(name, value, f"{side} {limit:.12g}, {limit_name}: it is beyond by {beyond}")


def stability(curve: AdhesiveCurve, found: Indentation, radius_error: float) -> Stability:
    """Return whether a state on a curve is stable, and the stiffness there.

    Its radius has a relative error, which next to pull-off is much larger than those of the rates
    of load and approach by the radius.

    A state in which load or approach does not change with the radius, within its error, counts as
    stable: it is the last one of a stable branch, such as that of pull-off.

    At a corner of the profile, and at the rim of its flat part, the rates of larger contacts are
    others than those of smaller ones. Such a state is stable if load, or approach, increases
    towards larger contacts. If it increases towards smaller ones, too, the state is that of
    pull-off.
    """
    a = found.radius
    if a in curve.corners:
        rates = curve.rates(curve.next_larger(a))
        stable = tuple(name for name in CONTROLS_HELD if getattr(rates, name) > 0.0)
        reason = "larger contacts have another slope of the curve than smaller ones at this radius"
        return Stability(stable, None, reason=reason)
    local = curve.local(a)
    rates = local.rates(a)
    errors = local.rate_errors(a)
    stable = tuple(name for name in CONTROLS_HELD if getattr(rates, name) >= -getattr(errors, name))
    if abs(rates.approach) <= errors.approach:
        return Stability(stable, copysign(inf, rates.load), inf)
    stiffness = rates.load / rates.approach
    error = (errors.load + abs(stiffness) * errors.approach) / abs(rates.approach)
    second_rates = local.rates(
        a, order=2
    )  # d stiffness = (d load' - stiffness d approach') / approach'
    change = abs(second_rates.load - stiffness * second_rates.approach) / abs(rates.approach)
    error += change * radius_error * a / (a - local.base)
    return Stability(stable, stiffness, error / max(abs(stiffness), found.stiffness) + ROUNDING)


def with_surface_energy(found: Indentation, adhesion: float) -> Indentation:
    """Return a state with the work ``int P ddelta`` along the curve in place of the elastic energy.

    The work is counted from no contact. It is the elastic energy less w times the area of contact,
    and may be negative; its error is relative to the sum of both.
    """
    surface = pi * adhesion * found.radius**2
    error = found.work_error * found.work / (found.work + surface)
    return replace(found, work=found.work - surface, work_error=error)
