"""True errors of adhesive contact under random profiles against their estimates.

A stratum of honesty.py. Scenes have random shapes, radii, compliances, works of adhesion and
tolerances; each is solved for its radius, for its load and its approach on the stretch of the curve
that it is on, with its stiffness there, and one in three at both ends of stability. The truth is
the same in a space with eight degrees more on every panel and two panels more at every end: that
the method converges to the truth is tested against closed forms and by elliptic integrals. One
scene of ten is a power law on a smooth surface, whose pull-off is a closed form.
"""

from __future__ import annotations

import numpy as np
from profiles import LEAST, MOST, ROUNDING, BetterProblem, as_solution, compared, drawn
from strata import Outcome, decade, largest

from spectral_contact import Scene, closed_forms, pull_off
from spectral_contact import profiles as shapes
from spectral_contact.contact.adhesion import BY_APPROACH, BY_LOAD, AdhesiveCurve, Control, NoState
from spectral_contact.contact.contact_radius import Contact, value_of
from spectral_contact.contact.indented import solve_indentation
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import refine
from spectral_contact.solving.adhesive import stability

#: Each such scene is on a smooth surface, and each such one is followed to pull-off.
SMOOTH, PULLED = 10, 3
#: Of scenes with breaks each such one is followed along the curve.
BROKEN = 40
#: Of the pull over the approach without adhesion, decades.
PULL = 2.0
#: The truth's own tolerance.
CLOSE = 1e-13


class Truth(AdhesiveCurve):
    """The curve, of states in larger spaces."""

    def at(self, radius: float, *, pointwise: bool = False) -> Contact:
        """Return the state of a radius."""
        given = self.profile, radius, self.compliance, CLOSE
        problem = BetterProblem(*given, pointwise=pointwise, adhesion=self.adhesion)
        return refine(problem, 1e-11, 20_000)

    def values_only(self, radius: float) -> Indentation:
        """Return the state of a radius."""
        known = self._values_only.get(radius)
        if known is None:
            known = self._values_only[radius] = value_of(self.at(radius))
        return known


def on_its_branch(
    curve: AdhesiveCurve, control: Control, truth: Indentation
) -> tuple[Contact, float] | None:
    """Return the state with the truth's load or approach next to it, if a stretch has it."""
    for branch in range(3):
        try:
            found, off = curve.find(control, control.value(truth), branch, pointwise=True)
        except NoState:
            continue
        if abs(value_of(found).radius / truth.radius - 1.0) < 1e-3:
            return found, off
    return None


def rough(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a scene with a layer."""
    profile, radius = drawn(rng)
    compliance = 10.0 ** rng.uniform(LEAST, MOST) * radius
    tolerance = 10.0 ** rng.uniform(-12.0, -4.0)
    share = decade(rng, -PULL, PULL)
    bare = value_of(solve_indentation(profile, radius, compliance, 1e-6, 20_000, adhesion=1.0))
    adhesion = (share * (bare.approach + bare.pull) / bare.pull) ** 2
    label = f"{profile.brief}, a = {radius:.6g}, alpha = {compliance:.3g}, w = {adhesion:.3g}"
    label += f", rtol = {tolerance:.1e}"
    given = profile, compliance, adhesion, tolerance, 20_000
    curve = AdhesiveCurve(*given)
    better = Truth(*given)
    solved = curve.at(radius, pointwise=True)
    truth = value_of(better.at(radius, pointwise=True))
    exact = as_solution(truth)
    worst = [compared(as_solution(value_of(solved)), exact)]
    # every radius has operators of its own under a profile with breaks
    whole = not profile.breaks or number % BROKEN == 0
    for control in (BY_LOAD, BY_APPROACH) if whole else (BY_LOAD,):
        searched = on_its_branch(curve, control, truth)
        if searched is not None:
            found, off = value_of(searched[0]), searched[1]
            moved = abs(found.radius / radius - 1.0) / (off + ROUNDING)
            worst.append(compared(as_solution(found), exact) | {"radius": moved})
    if whole:
        worst.append(stiffness_on_branch(curve, value_of(solved), better, truth))
        if number % PULLED == 0:
            worst += [at_pull_off(curve, better, control) for control in (BY_LOAD, BY_APPROACH)]
    label += "" if whole else ", in part"
    return Outcome(largest(worst), label, solved.best.error <= tolerance)


def stiffness_on_branch(
    curve: AdhesiveCurve, found: Indentation, better: AdhesiveCurve, truth: Indentation
) -> dict[str, float]:
    """Return the ratio of the stiffness along the curve, if there is one, at a given radius."""
    along = stability(curve, found, 0.0)
    known = stability(better, truth, 0.0)
    if along.stiffness is None or known.stiffness is None:
        return {}
    size = max(abs(known.stiffness), truth.stiffness)
    off = abs(along.stiffness - known.stiffness) / size
    return {"stiffness on branch": off / (along.error + known.error)}


def at_pull_off(curve: AdhesiveCurve, better: AdhesiveCurve, control: Control) -> dict[str, float]:
    """Return the ratios of the first end of stability, if both curves have one."""
    try:
        first = next(curve.folds(control), None)
        last = next(better.folds(control), None)
    except NoState:  # adhesion pulls the contact to the end of the profile
        return {}
    if first is None or last is None:
        return {}
    moved = abs(first.radius / last.radius - 1.0) / (first.error + last.error + ROUNDING)
    off = abs(control.value(first.state) - control.value(last.state))
    room = control.error(first.state) + control.error(last.state)
    if first.curve is not None:  # what `pull_off` adds for the radius
        room += abs(control.rate(curve.rates(first.state))) * first.error
    return {"pull-off radius": moved, "pull-off value": off / room}


def smooth(rng: np.random.Generator) -> Outcome:
    """Return what becomes of the pull-off of a power law on a smooth surface."""
    exponent = float(rng.choice([1.0, 1.5, 2.0, 3.0, 4.0, 8.0]))
    coefficient, adhesion = decade(rng, -2.0, 2.0), decade(rng, -6.0, 2.0)
    profile = shapes.PowerLaw(coefficient, exponent)
    scene = Scene(None, profile=profile, load=0.0, work_of_adhesion=adhesion)
    worst = []
    for control in ("load", "approach"):
        found = pull_off(scene, control)
        true = closed_forms.power_law_pull_off(
            coefficient, exponent, adhesion, by_approach=control == "approach"
        )
        off = abs(found.contact_radius / true.contact_radius - 1.0)
        one = {"pull-off radius": off / (found.error.contact_radius + ROUNDING)}
        for name in ("load", "approach"):
            moved = abs(getattr(found, name) - getattr(true, name)) / found.error_scales[name]
            one[name] = moved / (getattr(found.error, name) + ROUNDING)
        worst.append(one)
    return Outcome(largest(worst), f"{profile.brief}, w = {adhesion:.3g}, smooth")


def adhesion(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a random scene."""
    return smooth(rng) if number % SMOOTH == 1 else rough(rng, number)
