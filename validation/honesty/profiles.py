"""True errors of contact under random profiles against their estimates.

A stratum of honesty.py. Scenes have random shapes, radii, compliances and tolerances; each is
solved for its radius, then for its load and its approach. The truth is the same method with eight
degrees more on every panel and two panels more at every end: that the method converges to the truth
is tested against closed forms and by quadrature. One scene of ten is on a smooth surface, where the
truth is `reference`.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
from strata import TINY, Outcome, decade, largest

from spectral_contact import Scene, reference
from spectral_contact import profiles as shapes
from spectral_contact.contact import indented
from spectral_contact.contact.contact_radius import find_radius, value_of
from spectral_contact.contact.indented import solve_indentation, values_only
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import refine
from spectral_contact.spectral.panels import DiscreteSpace

LEAST, MOST = -7.0, 4.0  # of the compliance in contact radii, decades
FROM_EDGE = np.concatenate([10.0 ** -np.linspace(0.3, 14.0, 40), np.linspace(0.0, 1.0, 60)])
#: Of a radius that was given, and of a load or approach found from it.
ROUNDING = 1e-15
#: Each such scene is on a smooth surface.
SMOOTH = 10


class Larger:
    """A problem with eight degrees more, and two panels more at every end."""

    def _first_space(self, part: int, depth: float) -> DiscreteSpace:
        found = super()._first_space(part, depth)
        return DiscreteSpace(found.panels, (*found.degrees, 2, 2))

    def start(self) -> DiscreteSpace:
        """Return the space."""
        found = super().start()
        degrees = tuple(min(n + 8, 38) for n in found.degrees)
        return DiscreteSpace(replace(found.panels, degree=40), degrees)


class Better(Larger, indented._IndentationProblem):
    """The problem itself, in a larger space."""


def drawn(rng: np.random.Generator) -> tuple[shapes.Profile, float]:
    """Return a profile and a contact radius."""
    kind, angle = rng.integers(7), float(rng.uniform(0.1, 1.5))
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
    c, d = rng.uniform(0.2, 2.0, 2)
    bowl = shapes.Sampled.from_functions(
        lambda r: c * (np.cosh(d * r) - 1.0), lambda r: c * d * np.sinh(d * r), reach=3.0
    )
    return replace(bowl, rounded=True), decade(rng, -1.0, 0.47)


def rough(rng: np.random.Generator) -> Outcome:
    """Return what becomes of a radius, its load and its approach, through a layer."""
    profile, radius = drawn(rng)
    compliance = 10.0 ** rng.uniform(LEAST, MOST) * radius
    tolerance = 10.0 ** rng.uniform(-12.0, -4.0)
    solved = solve_indentation(profile, radius, compliance, tolerance, 20_000)
    better = Better(profile, radius, compliance, 1e-13, pointwise=True)
    truth = refine(better, 1e-11, 20_000).best.value
    label = f"{profile.brief}, a = {radius:.6g}, alpha = {compliance:.3g}, rtol = {tolerance:.1e}"
    worst = [compared(solved.best.value, truth)]
    for load, approach in ((truth.load, None), (None, truth.approach)):
        searched, off = find_radius(
            profile,
            lambda a, rtol, pointwise: solve_indentation(
                profile, a, compliance, rtol, 20_000, pointwise=pointwise
            ),
            tolerance,
            load=load,
            approach=approach,
            pointwise=True,
            first=lambda a: values_only(profile, a, compliance, tolerance, 20_000),
        )
        found = value_of(searched)
        radius_ratio = abs(found.radius / truth.radius - 1.0) / (off + ROUNDING)
        worst.append({"radius": radius_ratio} | compared(found, truth))
    return Outcome(largest(worst), label, solved.best.error <= tolerance)


def smooth(rng: np.random.Generator) -> Outcome:
    """Return what becomes of a contact on a smooth surface, against `reference` to 20 digits."""
    profile, radius = drawn(rng)
    while isinstance(profile, shapes.Sampled):  # it is not the shape that it samples
        profile, radius = drawn(rng)
    found = solve_indentation(profile, radius, 0.0, 1e-10, 20_000)
    exact = reference(Scene(0.3, profile=profile, contact_radius=radius), 20, progress=False)
    approach = float(exact.approach)
    load = float(exact.load)
    truth = SimpleNamespace(
        radius=radius,
        approach=approach,
        approach_size=approach,
        load=load,
        load_size=load,
        work=float(exact.indentation_work),
        stiffness=float(exact.stiffness),
        pressure=lambda _, from_edge: exact.pressure(from_edge=from_edge).astype(float),
    )
    # at the tip of a cone the pressure is infinite
    ratios = compared(found, truth, FROM_EDGE[FROM_EDGE < 1.0])
    label = f"{profile.brief}, a = {radius:.6g}, smooth"
    return Outcome(ratios, label, found.pressure_error <= 1e-10)


def compared(found: Indentation, truth: Any, from_edge: np.ndarray = FROM_EDGE) -> dict[str, float]:
    """Return true errors over their estimates of all but the radius; the truth is not exact."""
    sizes = {
        "approach": truth.approach_size,
        "load": truth.load_size,
        "work": truth.work,
        "stiffness": truth.stiffness,
    }
    off = {name: abs(getattr(found, name) - getattr(truth, name)) / sizes[name] for name in sizes}
    if found.pressure is not None and truth.pressure is not None:
        s = 1.0 - from_edge
        exact = truth.pressure(s, from_edge)
        size = np.maximum(np.abs(exact), truth.load_size / (pi * truth.radius**2))
        off["pressure"] = float((np.abs(found.pressure(s, from_edge) - exact) / size).max())
    ratios = {}
    for name, error in off.items():
        room = getattr(found, f"{name}_error") + getattr(truth, f"{name}_error", 0.0)
        ratios[name] = error / max(room, TINY)  # what is given has no error
    return ratios


def profiles(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a random scene."""
    return (smooth if number % SMOOTH == 0 else rough)(rng)
