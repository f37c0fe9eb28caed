"""Whether the estimates of coupled partial slip bound the true errors, over random scenes.

Strata of honesty.py: ``coupled_slip``, and ``coupled_annuli``, in whose scenes slip tends to lie in
an interior annulus. Every scene is solved at a random tolerance and again at 1e-12; the second
estimate is allowed for. Fields are compared at equal distances from the ends of the zones, which
have an estimate of their own, down to 1e-12 of a zone.
"""

from __future__ import annotations

import math

import numpy as np
from coupled_slip_errors import ratios, sample
from strata import Outcome, decade

from spectral_contact import Scene, solve

TRUE_RTOL = 1e-12
#: Share of the scenes that are of two bodies with negative kappa.
TURNED = 0.5


def coupled_slip(rng: np.random.Generator, number: int) -> Outcome | None:
    """Return what becomes of a scene that slips."""
    alpha, beta = (decade(rng, -6.0, 1.0) for _ in range(2))
    kind = number % 8
    if kind == 0:
        alpha = beta = 0.0
    elif kind == 1:
        beta = 0.0
    elif kind in (2, 3):
        beta = alpha
    scene = Scene(rng.uniform(-0.5, 0.49), alpha, beta, math.inf, coupling=True)
    critical = solve(scene, 1e-6, ("critical_friction",)).critical_friction
    most = min(0.99 * critical, 6.0 * scene.kappa, 1.0)
    least = 1e-14 if kind == 4 else min(0.02, 0.3 * most)
    friction = math.exp(rng.uniform(math.log(least), math.log(most)))
    return compared(scene.replace(friction=friction), decade(rng, -10.0, -3.0), rng)


def coupled_annuli(rng: np.random.Generator, number: int) -> Outcome | None:
    """Return what becomes of a scene that slips where the edge may stick."""
    beta = decade(rng, -5.0, 1.0)
    alpha = 0.0 if number % 3 == 0 else beta * decade(rng, -4.0, -0.1)
    # coupling raises both: between those of full stick without it there is slip
    plain = Scene(rng.uniform(-0.5, 0.49), alpha, beta, math.inf)
    found = solve(plain, 1e-6, ("critical_friction", "edge_ratio"))
    most = found.critical_friction
    least = found.edge_ratio
    share = rng.uniform(0.02, 0.98)
    friction = most * 10.0 ** (-2.0 * share) if alpha == 0.0 else least + (most - least) * share
    scene = plain.replace(friction=friction, coupling=True)
    return compared(scene, decade(rng, -10.0, -2.0), rng)


def compared(scene: Scene, rtol: float, rng: np.random.Generator) -> Outcome | None:
    """Solve a scene, or that of negative kappa; None without slip, or with other zones."""
    if rng.random() < TURNED:
        scene = scene.replace(kappa=-scene.kappa)
    solution = solve(scene, rtol)
    truth = solve(scene, TRUE_RTOL, strict=False)
    if truth.zones[-1].outer == truth.stick_radius or len(truth.zones) != len(solution.zones):
        return None
    return Outcome(ratios(sample(solution), sample(truth)), f"{scene!r}, rtol {rtol:.1e}")
