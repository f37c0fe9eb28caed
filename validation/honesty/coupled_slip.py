"""Whether the estimates of coupled partial slip bound the true errors, over random scenes.

Strata of honesty.py: ``coupled_slip``, and ``coupled_annuli``, in whose scenes slip tends to lie in
an interior annulus. Every scene is solved at a random tolerance and again at 1e-12; the second
estimate is allowed for. Fields are compared at equal distances from the ends of the zones, which
have an estimate of their own, down to 1e-12 of a zone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np
from coupled_slip_errors import ratios, sample
from honesty_table import Outcome, Stratum

from spectral_contact import ConvergenceError, NotComputedError, Scene, solve

TRUE_RTOL = 1e-12
#: Share of the scenes that are of two bodies with negative kappa.
TURNED = 0.5


def draw(rng: np.random.Generator, number: int) -> tuple[Scene, float]:
    """Return a scene that slips, and a tolerance."""
    alpha, beta = (10.0 ** rng.uniform(-6.0, 1.0) for _ in range(2))
    kind = number % 8
    if kind == 0:
        alpha, beta = 0.0, 0.0
    elif kind == 1:
        beta = 0.0
    elif kind in (2, 3):
        beta = alpha
    scene = Scene(rng.uniform(-0.5, 0.49), alpha, beta, math.inf, coupling=True)
    critical = solve(scene, 1e-6, ("critical_friction",)).critical_friction
    most = min(0.99 * critical, 6.0 * scene.kappa, 1.0)
    least = 1e-14 if kind == 4 else min(0.02, 0.3 * most)
    friction = math.exp(rng.uniform(math.log(least), math.log(most)))
    rtol = 10.0 ** rng.uniform(-10.0, -3.0)
    return turned(scene.replace(friction=friction), rng), rtol


def turned(scene: Scene, rng: np.random.Generator) -> Scene:
    """Return the scene, or one of two bodies with the negative kappa."""
    return scene.replace(kappa=-scene.kappa) if rng.random() < TURNED else scene


def draw_annuli(rng: np.random.Generator, number: int) -> tuple[Scene, float]:
    """Return a scene that slips where the edge may stick, and a tolerance."""
    beta = 10.0 ** rng.uniform(-5.0, 1.0)
    alpha = 0.0 if number % 3 == 0 else beta * 10.0 ** rng.uniform(-4.0, -0.1)
    nu = rng.uniform(-0.5, 0.49)
    asked = "critical_friction", "edge_ratio"
    # coupling raises both: between those of full stick without it there is slip
    plain = solve(Scene(nu, alpha, beta, math.inf), 1e-6, asked)
    most, least = plain.critical_friction, plain.edge_ratio
    share = rng.uniform(0.02, 0.98)
    friction = most * 10.0 ** (-2.0 * share) if alpha == 0.0 else least + (most - least) * share
    rtol = 10.0 ** rng.uniform(-10.0, -2.0)
    return turned(Scene(nu, alpha, beta, friction, coupling=True), rng), rtol


def outcome(number: int, seed: int, *, annuli: bool) -> Outcome | None:
    """Return what becomes of a scene; None without a solution, without slip, or of other zones."""
    rng = np.random.default_rng([seed, number, 1] if annuli else [seed, number])
    scene, rtol = draw_annuli(rng, number) if annuli else draw(rng, number)
    try:
        solution, truth = solve(scene, rtol), solve(scene, TRUE_RTOL, strict=False)
    except (NotComputedError, ConvergenceError):
        return None
    if truth.zones[-1].outer == truth.stick_radius or len(truth.zones) != len(solution.zones):
        return None
    return Outcome(ratios(sample(solution), sample(truth)), f"{scene!r}, rtol {rtol:.1e}")


def outcomes(seed: int, scenes: int, _: int, *, annuli: bool) -> Iterator[Outcome | None]:
    """Yield what becomes of each scene, which depends on its number alone."""
    for number in range(scenes):
        yield outcome(number, seed, annuli=annuli)


REFUSED = "{} are refused, reach rounding or do not slip"
STRATA = {
    "coupled_slip": Stratum(
        "Honesty of coupled partial slip", 160, partial(outcomes, annuli=False), refused=REFUSED
    ),
    "coupled_annuli": Stratum(
        "Honesty of coupled slip in an interior annulus",
        160,
        partial(outcomes, annuli=True),
        refused=REFUSED,
    ),
}
