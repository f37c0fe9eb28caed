"""True errors of steady loops of the load against their estimates.

A stratum of honesty.py. Scenes have random compliances, Poisson's ratios, frictions and lowest
loads, from far below the shakedown ratio to above it, and tolerances. The truth is another
quadrature: over the load, not over the friction, with Gauss points in the cube root of the distance
from where slip begins, each of which is a solve of its own to a tighter tolerance, whose mean slip
is a double exponential rule. Fewer points measure its error, which counts in the room.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from strata import Outcome, decade, over_estimates

from spectral_contact import Scene, Solution, SteadyCycle, solve, steady_cycle

#: Gauss points of the truth of what is dissipated, and of the one that it is compared with.
POINTS, FEWER = 14, 10
#: Of every so many scenes that is compared, which takes some fifty solves.
DISSIPATED = 4
#: The tolerance of its solves, and what they are asked for.
CLOSE = 1e-10
ASKED = "slip", "pressure", "zones", "stick_radius"
#: Every so many scenes have no tangential compliance, no normal one, or a loop that shakes down.
BARE, SMOOTH, SHAKEN = 9, 15, 10
#: Of the slip amplitude, over its largest value.
RADII = 1.0 - np.array([1e-6, 1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.2, 0.4])
ROUNDING = 1e-14


def mean_slip(solution: Solution) -> float:
    """Return ``2 pi int p |u| s ds`` by a double exponential rule in every zone of slip."""
    total = 0.0
    step = 1.0 / 24.0
    t = step * np.arange(-84, 85)
    share = 1.0 / (1.0 + np.exp(-math.pi * np.sinh(t)))
    weight = step * math.pi * np.cosh(t) * share * share[::-1]
    for zone in solution.zones:
        if zone.kind == "slip":
            width = zone.inner_from_edge - zone.outer_from_edge
            inner = zone.inner_from_edge - width * share
            from_edge = np.where(t < 0.0, inner, zone.outer_from_edge + width * share[::-1])
            slip = np.abs(solution.slip(from_edge=from_edge))
            load = solution.pressure(from_edge=from_edge) * (1.0 - from_edge)
            total += 2.0 * math.pi * width * float((weight * load) @ slip)
    return total


def dissipated(
    scene: Scene, lowest: float, critical: float, points: int, mean: Callable[[float], float]
) -> tuple[float, float]:
    """Return what is dissipated while the load falls, and while it rises."""
    f = scene.friction
    x, w = np.polynomial.legendre.leggauss(points)
    v = (x + 1.0) / 2.0
    weight = 3.0 * v**2 * w / 2.0
    whole = (1.0 - lowest) * mean(f * (1.0 + lowest) / (1.0 - lowest))
    ratio = (critical - f) / (critical + f) if critical < math.inf else 1.0
    down = ratio - (ratio - lowest) * v**3
    unloading = [(1.0 - one) * mean(f * (1.0 + one) / (1.0 - one)) for one in down]
    begin = lowest / ratio
    up = begin + (1.0 - begin) * v**3
    reloading = [(one - lowest) * mean(f * (one + lowest) / (one - lowest)) for one in up]
    return (
        f * (lowest * whole + (ratio - lowest) * float(weight @ unloading)),
        f * (whole - (1.0 - begin) * float(weight @ reloading)),
    )


def drawn(rng: np.random.Generator, number: int) -> tuple[Scene, float, float]:
    """Return a scene, its critical friction, and a lowest load."""
    alpha, beta = (decade(rng, -3.0, 1.0) for _ in range(2))
    alpha = 0.0 if number % SMOOTH == 2 else alpha
    beta = 0.0 if number % BARE == 1 else beta
    stick = solve(Scene(rng.uniform(-0.2, 0.45), alpha, beta, math.inf), 1e-11)
    critical = stick.critical_friction
    most = critical if critical < math.inf else 4.0 * stick.scene.kappa
    friction = most * rng.uniform(0.1, 0.95)
    ratio = (critical - friction) / (critical + friction) if critical < math.inf else 0.9
    share = rng.uniform(1.0, 1.5) if number % SHAKEN == 3 else 1.0 - decade(rng, -2.5, 0.0)
    lowest = min(max(share, 0.02) * ratio, 0.98)
    return stick.scene.replace(friction=friction), critical, lowest


def cycles(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a loop."""
    scene, critical, lowest = drawn(rng, number)
    rtol = decade(rng, -7.0, -2.0)
    label = f"{scene!r}, lowest = {lowest:.6g}, rtol = {rtol:.1e}"
    found = steady_cycle(scene, lowest, rtol=rtol, strict=False)
    close = scene.replace(friction=scene.friction * (1.0 + lowest) / (1.0 - lowest))
    truth = solve(close, CLOSE, ASKED, strict=False)
    ratios = over_estimates(found, truth, ("stick_radius",), ROUNDING)
    slip, exact = found.slip_amplitude(RADII), (1.0 - lowest) * np.abs(truth.slip(RADII))
    if exact.max() > 0.0:
        room = (found.error.slip_amplitude or 0.0) + (truth.error.slip or 0.0) + ROUNDING
        size = (1.0 - lowest) * np.abs(truth.slip(np.linspace(0.0, 1.0, 400))).max()
        ratios["slip_amplitude"] = float(np.abs(slip - exact).max()) / (size * room)
    if found.reloading_dissipation == 0.0:
        ratios["nothing_is_lost"] = 0.0 if exact.max() == 0.0 else 2.0
    elif number % DISSIPATED == 0:
        ratios |= dissipation_ratios(found, lowest, critical)
    return Outcome(ratios, label, found.converged)


def dissipation_ratios(found: SteadyCycle, lowest: float, critical: float) -> dict[str, float]:
    """Return the ratios of what is dissipated while the load falls, and while it rises."""

    @cache
    def mean(friction: float) -> float:
        return mean_slip(solve(found.scene.replace(friction=friction), CLOSE, ASKED, strict=False))

    close, other = (
        dissipated(found.scene, lowest, critical, points, mean) for points in (POINTS, FEWER)
    )
    ratios = {}
    for k, name in enumerate(("unloading_dissipation", "reloading_dissipation")):
        value = getattr(found, name)
        if value is not None:
            room = getattr(found.error, name) + abs(other[k] / close[k] - 1.0) + 10.0 * CLOSE
            ratios[name] = abs(value / close[k] - 1.0) / room
    return ratios
