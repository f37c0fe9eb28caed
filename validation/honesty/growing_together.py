"""True errors of contacts that grow with elastic coupling against their estimates.

Strata of honesty.py, of some ten seconds a scene, for kappa of either sign. In ``growing_to_value``
a load or an approach is given instead of the radius, which is next to a break of the profile, so
that the history ends in a short panel; the truth is the contact whose radius is given. In
``growing_together`` scenes take turns:

- smooth surfaces (half of them) under tips: the contact is similar to itself at all times, so that
  its fields are integrals over one flat punch, and its load follows from the normal equation by the
  elliptic kernels. The flat punch is solved to 1e-11; no history and no Volterra equation is used.
- layers against the march in increments (tests/oracles/growing_rings.py), which shares nothing with
  the library. Its three numbers of rings are extrapolated, and what the last extrapolation changes
  counts as its error.
- layers down to 1e-8 of the radius against the same method to a hundredth of the tolerance.
"""

from __future__ import annotations

import math
import sys
from itertools import pairwise
from pathlib import Path

import growing
import numpy as np
from honesty_table import Outcome, Stratum, decade, in_turn

from spectral_contact import NotComputedError, Scene, Solution, profiles, solve
from spectral_contact.equations import residuals
from spectral_contact.spectral.jacobi import graded_rule

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from oracles.growing_rings import march

#: Numbers of rings; how much more than the last change of the extrapolation its error may be.
COUNTS, ROOM = (40, 80, 160), 3.0
#: Tolerance of the flat punch, and a bound on what quadrature makes of the load.
TRUE_RTOL, QUADRATURE = 1e-11, 1e-10
#: Radius at which the normal equation gives the load, over that of the contact.
COLLOCATED = 0.5
SCALARS = "load", "approach", "total_shear", "stick_radius", "stiffness"
FIELDS = "pressure", "traction"
REFUSED = "{} were refused, as they cannot be followed while they grow"
PLACES = np.array([1e-3, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 0.999])


def drawn(rng: np.random.Generator, number: int) -> tuple[Scene, float, float | None]:
    """Return a scene of contact radius 1, a tolerance, and the power of the profile, if smooth."""
    kappa = float(rng.uniform(0.02, 0.37)) * (1.0 if rng.random() < 0.5 else -1.0)
    power = float(rng.choice([1.0, 1.5, 2.0, 3.0]))
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
    return scene, tolerance, None if number % 2 else power


def superposed(flat: Solution, name: str, power: float, r: float) -> float:
    """Return a field for unit load, similar to itself at all times, by quadrature over radii."""
    points, weights = graded_rule(20, 50, 0.2)
    stick, total = flat.stick_radius, 0.0
    # where it slips the traction is a multiple of the pressure
    friction = (flat.scene.friction or 0.0) * math.copysign(1.0, flat.scene.kappa)
    for low, high in ((r, stick), (max(r, stick), 1.0)):
        half = (high - low) / 2.0
        if half <= 0.0:
            continue
        slips = high > stick
        field = flat.pressure_field if slips or name == "pressure" else flat.traction_field
        factor = friction if slips and name == "traction" else 1.0
        for s, from_edge in (
            (low + half * points, 1.0 - low - half * points),
            (high - half * points, 1.0 - high + half * points),
        ):
            values = field(s, from_edge) * (r / s) ** (power - 1.0) / s
            total += factor * half * float(weights @ values)
    return (power + 1.0) * total


def graded(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points and weights of a rule between two radii that is graded to both."""
    points, weights = graded_rule(12, 40, 0.2)
    half = (high - low) / 2.0
    places = np.concatenate([low + half * points, high - half * points])
    return places, half * np.concatenate([weights, weights])


def self_similar(scene: Scene, power: float) -> tuple[dict[str, float], dict[str, np.ndarray]]:
    """Return the true numbers and fields of a contact on a smooth surface."""
    flat = solve(scene.replace(profile=None, contact_radius=None), TRUE_RTOL, strict=False)

    def field(name: str, radii: np.ndarray) -> np.ndarray:
        values = [superposed(flat, name, power, float(r)) for r in np.ravel(radii)]
        return np.array(values).reshape(np.shape(radii))

    def pressure(from_edge: np.ndarray) -> np.ndarray:
        return field("pressure", 1.0 - from_edge)

    stick = flat.stick_radius
    breaks = [1.0 - stick] if stick < 1.0 else []
    sunk = residuals.normal_displacement(pressure, 1.0 - COLLOCATED, breaks)
    pulled = 0.0
    for low, high in pairwise(sorted({COLLOCATED, max(stick, COLLOCATED), 1.0})):
        places, weights = graded(low, high)
        pulled += float(weights @ field("traction", places))
    # P = n/(n + 1) a delta/delta*, as dP/ddelta = a/delta* at all times
    approach = (power + 1.0) / power * flat.approach
    assert scene.profile is not None
    load = float(scene.profile.height(COLLOCATED)) / (approach - sunk + scene.kappa * pulled)
    numbers = {
        "load": load,
        "approach": approach * load,
        "total_shear": flat.total_shear * load,
        "stick_radius": flat.stick_radius,
        "stiffness": 1.0 / flat.approach,
    }
    return numbers, {name: load * field(name, PLACES) for name in FIELDS}


def against_self_similarity(scene: Scene, rtol: float, power: float) -> dict[str, float]:
    """Return true errors over estimates on a smooth surface."""
    found = solve(scene, rtol, strict=False)
    numbers, fields = self_similar(scene, power)
    worst = {}
    for name, truth in numbers.items():
        off = abs(getattr(found, name) / truth - 1.0)
        room = 0.0 if name in ("stick_radius", "stiffness") else QUADRATURE
        worst[name] = off / (getattr(found.error, name) + room + 1e-10)
    mean = found.load / math.pi
    for name, truth in fields.items():
        off = np.abs(getattr(found, name)(PLACES) - truth)
        # a pressure's error is relative to the larger of itself and the mean, a traction's to all
        size = np.maximum(np.abs(truth), mean) if name == "pressure" else np.abs(truth).max()
        worst[name] = float((off / size).max()) / (getattr(found.error, name) + QUADRATURE)
    return worst


def against_march(scene: Scene, rtol: float) -> dict[str, float]:
    """Return true errors over estimates and the error of the march, with layers.

    The march slips outward; with negative kappa the traction has the other sign.
    """
    found = solve(scene, rtol, strict=False)
    assert scene.profile is not None
    assert scene.friction is not None
    layers = scene.normal_compliance, scene.tangential_compliance
    steps = [
        march(scene.profile.height, *layers, abs(scene.kappa), scene.friction, n, coupled=True)
        for n in COUNTS
    ]
    worst = {}
    for name, its in (("load", "load"), ("approach", "approach"), ("total_shear", "shear")):
        sign = math.copysign(1.0, scene.kappa) if its == "shear" else 1.0
        first, second, third = (sign * getattr(one, its) for one in steps)
        linear = 2.0 * third - second
        truth = (8.0 * third - 6.0 * second + first) / 3.0
        left = ROOM * abs(truth - linear)
        size = abs(truth)
        off = abs(getattr(found, name) - truth) / size
        worst[f"{name}, march"] = off / (getattr(found.error, name) + left / size)
    return worst


def against_itself(scene: Scene, rtol: float) -> dict[str, float]:
    """Return errors over estimates, of a solution and one to a hundredth of its tolerance."""
    found, truth = growing.solved_twice(scene, rtol)
    worst = growing.ratios(found, truth, SCALARS, (*FIELDS, "slip"), PLACES)
    return {f"{name}, thin": ratio for name, ratio in worst.items()}


def measured_of_value(rng: np.random.Generator, number: int) -> Outcome:
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
    worst = growing.ratios(found, truth, (*SCALARS, "contact_radius"), FIELDS, PLACES)
    return Outcome(worst, f"{given!r}, radius {radius!r}, rtol {rtol:.1e}")


def measured(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a random scene."""
    scene, rtol, power = drawn(rng, number)
    if power is not None:
        ratios = against_self_similarity(scene, rtol, power)
    else:
        ratios = (against_march if number % 4 == 1 else against_itself)(scene, rtol)
    return Outcome(ratios, f"{scene!r}, rtol {rtol:.1e}")


STRATA = {
    "growing_together": Stratum(
        "Honesty of contacts that grow with elastic coupling",
        100,
        in_turn(measured, (NotComputedError,)),
        refused=REFUSED,
        every=5,
    ),
    "growing_to_value": Stratum(
        "Honesty of contacts that grow with elastic coupling to a load or an approach",
        60,
        in_turn(measured_of_value, (NotComputedError,)),
        refused=REFUSED,
        every=5,
    ),
}
