"""True errors of contact under random profiles against their estimates.

A stratum of honesty.py. Scenes have random shapes, radii, compliances and tolerances; those with a
layer are solved for their radius, then for their load and their approach. The truth is the same
method with eight degrees more on every panel and two panels more at every end: that the method
converges to the truth is tested against closed forms and by quadrature. Two scenes of ten are on a
smooth surface: of one, which is solved for its load, too, and compared next to corners, the truth
is `reference`, of the other, a cone with a rounded tip, a closed form.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
from strata import Outcome, decade, fields_over_estimates, largest, over_estimates

from spectral_contact import Scene, reference, solve
from spectral_contact import profiles as shapes
from spectral_contact.contact import indented
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import refine
from spectral_contact.spectral.panels import DiscreteSpace

SCALARS = ("approach", "load", "indentation_work", "stiffness")
LEAST, MOST = -7.0, 4.0  # of the compliance in contact radii, decades
FROM_EDGE = np.concatenate([10.0 ** -np.linspace(0.3, 14.0, 40), np.linspace(0.0, 1.0, 60)])
#: Distances from a corner at which the pressure is compared, too. Closer to it, the rounding of r/a
#: counts.
BESIDE = np.array([-0.1, -0.03, -0.01, 0.01, 0.03, 0.1])
#: Of a radius that was given, and of a load or approach found from it.
ROUNDING = 1e-15
#: One scene of so many is on a smooth surface, and one more is a rounded cone on it.
SMOOTH = 10
#: Least radii of a rounded tip over that of the contact, in decades: of a `Sampled` without breaks,
#: and of one with breaks that are graded to the tip.
BLUNT, SHARP = -1.3, -5.0
#: The ratio of one such break to the next.
GRADING = 4.0


class InLargerSpace:
    """A problem with eight degrees more, and two panels more at every end."""

    def _first_space(self, part: int, depth: float) -> DiscreteSpace:
        found = super()._first_space(part, depth)
        return DiscreteSpace(found.panels, (*found.degrees, 2, 2))

    def start(self) -> DiscreteSpace:
        """Return the space."""
        found = super().start()
        degrees = tuple(min(n + 8, 38) for n in found.degrees)
        return DiscreteSpace(replace(found.panels, degree=40), degrees)


class BetterProblem(InLargerSpace, indented._IndentationProblem):
    """The problem itself, in a larger space."""


def drawn(rng: np.random.Generator) -> tuple[shapes.Profile, float]:
    """Return a profile and a contact radius."""
    kind, angle = rng.integers(8), float(rng.uniform(0.1, 1.5))
    size, other = decade(rng, -1.0, 1.0), decade(rng, -1.0, 1.0)
    if kind == 0:
        return shapes.Parabola(size), decade(rng, -2.0, 2.0)
    if kind == 1:
        return shapes.Sphere(size), size * (1.0 - decade(rng, -3.0, -0.02))
    if kind == 2:
        return shapes.Cone(angle), decade(rng, -2.0, 2.0)
    if kind == 3:
        power = float(rng.choice([1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0]))
        return shapes.PowerLaw(size, power), decade(rng, -1.0, 1.0)
    if kind == 4:
        return shapes.RoundedFlat(size, other), size * (1.0 + decade(rng, -4.0, 1.5))
    if kind == 5:
        return shapes.TruncatedCone(size, angle), size * (1.0 + decade(rng, -4.0, 1.5))
    if kind == 6:
        radius = decade(rng, -2.0, 2.0)
        return rounded_cone(rng, radius)[0], radius
    c, d = rng.uniform(0.2, 2.0, 2)
    bowl = shapes.Sampled.from_functions(
        lambda r: c * (np.cosh(d * r) - 1.0), lambda r: c * d * np.sinh(d * r), reach=3.0
    )
    return replace(bowl, rounded=True), decade(rng, -1.0, 0.47)


def rounded_cone(rng: np.random.Generator, radius: float) -> tuple[shapes.Sampled, float]:
    """Return a hyperboloid of unit slope far out, and the radius of its tip; half have breaks."""
    with_breaks = rng.random() < 0.5
    tip = radius * decade(rng, SHARP if with_breaks else BLUNT, 0.0)
    reach = 1.5 * radius
    count = math.ceil(math.log(reach / tip, GRADING)) if with_breaks else 0
    breaks = tip * GRADING ** np.arange(count)
    profile = shapes.Sampled.from_functions(
        lambda r: r**2 / (np.hypot(r, tip) + tip),
        lambda r: r / np.hypot(r, tip),
        reach=reach,
        breaks=breaks[breaks < reach],
        rounded=True,
    )
    return profile, tip


def rounded_tip(rng: np.random.Generator) -> Outcome:
    """Return what becomes of a rounded cone on a smooth surface, against its closed form."""
    radius = decade(rng, -2.0, 2.0)
    profile, tip = rounded_cone(rng, radius)
    tolerance = 10.0 ** rng.uniform(-12.0, -4.0)
    found = solve(Scene(0.3, profile=profile, contact_radius=radius), tolerance, strict=False)
    with mpmath.workdps(30):
        truth = hyperboloid(mpmath.mpf(radius), mpmath.mpf(tip))
    label = f"rounded cone, tip {tip:.3g}, a = {radius:.6g}, smooth, rtol = {tolerance:.1e}"
    return Outcome(over_estimates(found, truth, SCALARS, 0.0), label, found.converged)


def hyperboloid(radius: mpmath.mpf, tip: mpmath.mpf) -> SimpleNamespace:
    """Return the contact of a hyperboloid with a smooth surface, by Abel's integrals of its slope.

    The slope is r/sqrt(r^2 + t^2), the approach a arctan(a/t).
    """

    def load(a: mpmath.mpf) -> mpmath.mpf:
        return 4 * ((a**2 - tip**2) * mpmath.atan(a / tip) + a * tip)

    def work_over_radius(a: mpmath.mpf) -> mpmath.mpf:
        return load(a) * (mpmath.atan(a / tip) + a * tip / (a**2 + tip**2))

    places = [0, *(tip * 10**k for k in range(6) if tip * 10**k < radius), radius]
    return SimpleNamespace(
        approach=float(radius * mpmath.atan(radius / tip)),
        load=float(load(radius)),
        indentation_work=float(mpmath.quad(work_over_radius, places)),
        stiffness=float(8 * radius),
        error=SimpleNamespace(**dict.fromkeys(SCALARS, 0.0)),
    )


def rough(rng: np.random.Generator) -> Outcome:
    """Return what becomes of a radius, its load and its approach, through a layer."""
    profile, radius = drawn(rng)
    compliance = 10.0 ** rng.uniform(LEAST, MOST) * radius
    tolerance = 10.0 ** rng.uniform(-12.0, -4.0)
    better = BetterProblem(profile, radius, compliance, 1e-13, pointwise=True)
    truth = as_solution(refine(better, 1e-11, 20_000).best.value)
    found = [
        solve(Scene(0.3, compliance, profile=profile, **given), tolerance, strict=False)
        for given in (
            {"contact_radius": radius},
            {"load": truth.load},
            {"approach": truth.approach},
        )
    ]
    ratios = [compared(one, truth) for one in found]
    ratios += [over_estimates(one, truth, ("contact_radius",), ROUNDING) for one in found[1:]]
    label = f"{profile.brief}, a = {radius:.6g}, alpha = {compliance:.3g}, rtol = {tolerance:.1e}"
    return Outcome(largest(ratios), label, found[0].converged)


def smooth(rng: np.random.Generator) -> Outcome:
    """Return what becomes of a contact on a smooth surface, against `reference` to 20 digits."""
    profile, radius = drawn(rng)
    while isinstance(profile, shapes.Sampled):  # it is not the shape that it samples
        profile, radius = drawn(rng)
    scene = Scene(0.3, profile=profile, contact_radius=radius)
    found = solve(scene, 1e-10, strict=False)
    exact = reference(scene, 20, progress=False)
    of_load = solve(Scene(0.3, profile=profile, load=float(exact.load)), 1e-4, strict=False)
    corners = [1.0 - b / radius for b in profile.breaks if b < radius]
    places = np.concatenate([FROM_EDGE, *(b + BESIDE for b in corners)])
    # at the tip of a cone the pressure is infinite
    places = places[(places >= 0.0) & (places < 1.0)]
    under_load = compared(of_load, exact, places)
    del under_load["load"]  # the given one, which is the exact one rounded
    ratios = largest([compared(found, exact, places), under_load])
    return Outcome(ratios, f"{profile.brief}, a = {radius:.6g}, smooth", found.converged)


def as_solution(one: Indentation) -> SimpleNamespace:
    """Return a contact with the names that it has in a `Solution`."""
    error = SimpleNamespace(
        approach=one.approach_error,
        load=one.load_error,
        indentation_work=one.work_error,
        stiffness=one.stiffness_error,
        pressure=None if one.pressure is None else one.pressure_error,
        contact_radius=0.0,
    )
    return SimpleNamespace(
        approach=one.approach,
        load=one.load,
        indentation_work=one.work,
        stiffness=one.stiffness,
        pressure=lambda *, from_edge: one.pressure(1.0 - from_edge, from_edge),
        contact_radius=one.radius,
        sizes={"approach": one.approach_size, "load": one.load_size},
        error=error,
    )


def compared(found: Any, truth: Any, from_edge: np.ndarray = FROM_EDGE) -> dict[str, float]:
    """Return true errors over their estimates of all but the radius."""
    sizes = getattr(truth, "sizes", {})
    ratios = over_estimates(found, truth, SCALARS, 0.0, sizes)
    load = sizes.get("load")
    return ratios | fields_over_estimates(found, truth, ("pressure",), from_edge, 0.0, load)


def profiles(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a random scene."""
    if number % SMOOTH == 0:
        return smooth(rng)
    if number % SMOOTH == 1:
        return rounded_tip(rng)
    return rough(rng)
