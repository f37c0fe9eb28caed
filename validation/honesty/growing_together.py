"""True errors of contacts that grow with elastic coupling against their estimates.

Strata of honesty.py, of some ten seconds a scene, for kappa of either sign. In ``growing_to_value``
a load or an approach is given instead of the radius, which is next to a break of the profile, so
that the history ends in a short panel; the truth is the contact whose radius is given. In
``growing_together`` scenes take turns:

- smooth surfaces (half of them) under tips: the contact is similar to itself at all times, so that
  its fields are integrals over one flat punch, and its load follows from the normal equation by the
  elliptic kernels. The flat punch is solved to 1e-11; no history and no Volterra equation is used.
- layers against the march in increments (tests/oracles/growing_rings.py), which shares nothing with
  the library. Marches with three numbers of rings are extrapolated, and the change of that by a
  fourth one counts as its error.
- layers down to 1e-8 of the radius against the same method to a hundredth of the tolerance.

The first two are solved with another unit of length, from 1e-6 to 1e6 contact radii.
"""

from __future__ import annotations

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from growing import solved_twice
from oracles.growing_rings import march
from oracles.self_similar import superposed
from strata import Outcome, decade, fields_over_estimates, over_estimates

from spectral_contact import Scene, profiles, solve
from spectral_contact.equations import residuals
from spectral_contact.spectral.jacobi import graded_rule

#: Numbers of rings. Twice as many leave a quarter of the error of the extrapolation, so that its
#: last change is about three times as large as its error.
COUNTS = 20, 40, 80, 160
#: What is compared with the march, and how it is called there.
MARCHED = {"load": "load", "approach": "approach", "total_shear": "shear"}
#: Tolerance of the flat punch, and a bound on what quadrature makes of the load.
TRUE_RTOL, QUADRATURE = 1e-11, 1e-10
#: Error of the numbers that are those of the flat punch.
FLAT = 1e-10
#: Radius at which the normal equation gives the load, over that of the contact.
COLLOCATED = 0.5
SCALARS = "load", "approach", "total_shear", "stick_radius", "stiffness"
FIELDS = "pressure", "traction"
FROM_EDGE = 1.0 - np.array([1e-3, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 0.999])


def drawn(rng: np.random.Generator, number: int) -> tuple[Scene, float, float]:
    """Return a scene of contact radius 1, a tolerance, and the power of the profile."""
    kappa = float(rng.uniform(0.02, 0.37)) * (1.0 if rng.random() < 0.5 else -1.0)
    power = float(rng.choice([1.0, 1.2, 1.5, 2.0, 2.5, 3.0]))
    profile = {1.0: profiles.Cone(1.2), 2.0: profiles.Parabola(1.0)}.get(
        power, profiles.PowerLaw(1.0, power)
    )
    ratio = decade(rng, -0.5, 0.7)
    sticks = rng.random() < 0.25
    tolerance = decade(rng, -6.0 if number % 2 else -8.0, -3.0)
    layer, share = rng.random(), float(rng.uniform(0.05, 1.0))
    alpha = beta = 0.0
    if number % 4 == 1:
        alpha, tolerance = 10.0 ** (1.3 * layer - 1.3), decade(rng, -3.0, -2.0)
        beta = share * alpha
    elif number % 4 == 3:
        alpha = 10.0 ** (8.0 * layer - 8.0)
        beta = share * alpha
    friction = math.inf if sticks else ratio * abs(kappa)
    scene = Scene.from_kappa(
        kappa, alpha, beta, friction, coupling=True, profile=profile, contact_radius=1.0
    )
    return scene, tolerance, power


def self_similar(scene: Scene, power: float) -> SimpleNamespace:
    """Return the true numbers and fields of a contact on a smooth surface."""
    flat = solve(scene.replace(profile=None, contact_radius=None), TRUE_RTOL, strict=False)
    stick = flat.stick_radius

    def field(name: str, radii: np.ndarray) -> np.ndarray:
        values = [superposed(flat, name, power, float(r)) for r in np.ravel(radii)]
        return np.array(values).reshape(np.shape(radii))

    sunk = residuals.normal_displacement(
        lambda from_edge: field("pressure", 1.0 - from_edge),
        1.0 - COLLOCATED,
        [1.0 - stick] if stick < 1.0 else [],
    )
    pulled = 0.0
    points, weights = graded_rule(12, 40, 0.2)
    for low, high in pairwise(sorted({COLLOCATED, max(stick, COLLOCATED), 1.0})):
        half = (high - low) / 2.0
        places = np.concatenate([low + half * points, high - half * points])
        pulled += half * float(np.tile(weights, 2) @ field("traction", places))
    # P = n/(n + 1) a delta/delta*, as dP/ddelta = a/delta* at all times
    approach = (power + 1.0) / power * flat.approach
    load = float(scene.profile.height(COLLOCATED)) / (approach - sunk + scene.kappa * pulled)
    error = dict.fromkeys(("load", "approach", "total_shear"), QUADRATURE + FLAT)
    error |= dict.fromkeys(("stick_radius", "stiffness"), FLAT) | dict.fromkeys(FIELDS, QUADRATURE)
    return SimpleNamespace(
        contact_radius=1.0,
        load=load,
        approach=approach * load,
        total_shear=flat.total_shear * load,
        stick_radius=stick,
        stiffness=1.0 / flat.approach,
        pressure=lambda *, from_edge: load * field("pressure", 1.0 - from_edge),
        traction=lambda *, from_edge: load * field("traction", 1.0 - from_edge),
        error=SimpleNamespace(**error),
    )


def marched(scene: Scene) -> SimpleNamespace:
    """Return load, approach and shear of the march, with layers, and their errors.

    It slips outward; with negative kappa the traction has the other sign.
    """
    layers = scene.normal_compliance, scene.tangential_compliance
    steps = [
        march(scene.profile.height, *layers, abs(scene.kappa), scene.friction, n, coupled=True)
        for n in COUNTS
    ]
    found = SimpleNamespace(error=SimpleNamespace())
    for name, its in MARCHED.items():
        values = [getattr(one, its) for one in steps]
        # without the errors of first and second order
        before, best = (
            (8.0 * third - 6.0 * second + first) / 3.0
            for first, second, third in zip(values, values[1:], values[2:], strict=False)
        )
        setattr(found, name, best)
        setattr(found.error, name, abs(best - before) / abs(best))
    found.total_shear *= math.copysign(1.0, scene.kappa)
    return found


def growing_to_value(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a contact whose load or approach is given, next to a break."""
    kappa = float(rng.uniform(0.02, 0.37)) * (1.0 if rng.random() < 0.5 else -1.0)
    alpha = 0.0 if rng.random() < 0.2 else decade(rng, -4.0, 0.5)
    friction = math.inf if rng.random() < 0.25 else decade(rng, -0.5, 0.7) * abs(kappa)
    corner = [profiles.TruncatedCone(0.5, 0.7), profiles.RoundedFlat(0.5, 0.3)][rng.integers(2)]
    side = 1.0 if rng.random() < 0.8 else -1.0
    radius = 0.5 * (1.0 + side * decade(rng, -12.0, -1.0))
    scene = Scene.from_kappa(
        kappa,
        alpha,
        alpha * float(rng.uniform(0.05, 1.0)),
        friction,
        coupling=True,
        profile=profiles.Sum(profiles.Parabola(1.0), corner),
        contact_radius=radius,
    )
    rtol = decade(rng, -6.0, -3.0)
    truth = solve(scene, rtol, strict=False)
    control = ("load", "approach")[number % 2]
    given = scene.replace(contact_radius=None, **{control: getattr(truth, control)})
    found = solve(given, rtol, strict=False)
    ratios = over_estimates(found, truth, (*SCALARS, "contact_radius"))
    ratios |= fields_over_estimates(found, truth, FIELDS, FROM_EDGE)
    return Outcome(ratios, f"{given!r}, radius {radius!r}, rtol {rtol:.1e}")


def solved(scene: Scene, rtol: float, unit: float, power: float) -> SimpleNamespace:
    """Solve a scene with another unit of length, and return the solution in that of the scene."""
    profile = scene.profile
    if isinstance(profile, profiles.Parabola):
        profile = profiles.Parabola(unit * profile.radius)
    elif isinstance(profile, profiles.PowerLaw):
        profile = profiles.PowerLaw(unit ** (1.0 - power) * profile.coefficient, power)
    scaled = scene.replace(
        profile=profile,
        contact_radius=unit * scene.contact_radius,
        normal_compliance=unit * scene.normal_compliance,
        tangential_compliance=unit * scene.tangential_compliance,
    )
    found = solve(scaled, rtol, strict=False)
    powers = {"load": 2, "approach": 1, "total_shear": 2, "stick_radius": 0, "stiffness": 1}
    numbers = {name: getattr(found, name) / unit**n for name, n in powers.items()}
    return SimpleNamespace(
        **numbers, pressure=found.pressure, traction=found.traction, error=found.error
    )


def growing_together(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a random scene."""
    scene, rtol, power = drawn(rng, number)
    unit = decade(rng, -6.0, 6.0)
    if number % 4 == 3:
        found, truth = solved_twice(scene, rtol)
        ratios = over_estimates(found, truth, SCALARS)
        ratios |= fields_over_estimates(found, truth, (*FIELDS, "slip"), FROM_EDGE)
        told = ", thin"
    elif number % 4 == 1:
        ratios = over_estimates(solved(scene, rtol, unit, power), marched(scene), MARCHED)
        told = ", march"
    else:
        found, truth = solved(scene, rtol, unit, power), self_similar(scene, power)
        ratios = over_estimates(found, truth, SCALARS)
        ratios |= fields_over_estimates(found, truth, FIELDS, FROM_EDGE)
        told = ""
    ratios = {f"{name}{told}": ratio for name, ratio in ratios.items()}
    return Outcome(ratios, f"{scene!r}, in units of {unit:.3g}, rtol {rtol:.1e}")
