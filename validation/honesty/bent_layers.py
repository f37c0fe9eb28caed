"""True errors of contact through layers whose law bends, against their estimates.

A stratum of honesty.py, which `--workers` speeds up. The truth is collocation in the radius with
the elliptic kernel (tests/oracles/bent_collocation.py), which shares no code with the library, on
panels to bends that it finds itself. Laws are tables, and polynomials with kinks or jumps of the
second derivative that are put next to the largest overclosure, on either side of it, next to the
edge, or anywhere. Every scene is solved with a random tolerance, and with a tighter one: claims
that contradict each other are violations, too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from honesty_table import Outcome, Stratum, decade
from scipy.interpolate import PchipInterpolator, PPoly

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "oracles"))

from bent_collocation import FINER_MESHES, MESHES, STILL, BentContact, Law, solved

from spectral_contact import Scene, Solution, layers, profiles, solve

NAMES = ("approach", "load", "contact_radius", "indentation_work", "stiffness", "pressure")
#: The tighter of the two tolerances of a scene.
TIGHTER = 1e-11
#: Relative error of the truth that its two meshes do not show: its bends come to rest to `STILL`.
#: `layers.Sampled` leaves a fifth of it of a law that is given as functions.
ROUNDING = STILL
#: Distances from what a bend is put next to, as powers of ten of the range of overclosures.
CLOSE = (-9.0, -0.5)


@dataclass(frozen=True)
class Drawn:
    """A law and a profile for both sides, and the disk.

    The heights are those of the function that the library samples.
    """

    layer: layers.Layer
    law: Law
    profile: profiles.Profile
    height: Callable[[Any], Any]
    breaks: tuple[float, ...]
    radius: float
    approach: float | None
    about: str


def law_of(curve: PPoly) -> Law:
    """Return a piecewise polynomial as a law, which goes on along its tangent beyond its end."""
    start, end = curve.x[0], curve.x[-1]
    slope, integral = curve.derivative(), curve.antiderivative()

    def within(function: Callable[[Any], Any], at: Any) -> Any:
        return np.where(at < start, 0.0, function(np.clip(at, start, end)))

    return Law(
        lambda at: within(curve, at) + np.maximum(at - end, 0.0) * slope(end),
        lambda at: within(slope, at),
        lambda at: within(integral, at),
        tuple(curve.x[1:-1].tolist()),
    )


def bent_polynomial(
    start: float,
    limit: float,
    linear: float,
    quadratic: float,
    jumps: list[tuple[float, float, int]],
) -> tuple[layers.Layer, Law]:
    """Return a polynomial of degree 2 with jumps of its first or second derivative.

    A jump is a knot, its size, and the power of the distance from the knot that it is a factor of.
    """
    terms = [(start, linear, 1), (start, quadratic, 2), *jumps]
    ends = [start, *sorted(knot for knot, _, _ in jumps), limit]
    coefficients = np.zeros((3, len(ends) - 1))  # of the square, the distance and 1
    for piece, left in enumerate(ends[:-1]):
        for knot, size, power in terms:
            off = left - knot
            if off >= 0.0:
                own = (0.0, 1.0, off) if power == 1 else (1.0, 2.0 * off, off**2)
                coefficients[:, piece] += size * np.array(own)
    law = law_of(PPoly(coefficients, ends))
    layer = layers.Sampled.from_functions(
        law.pressure, law.slope, start=start, limit=limit, knots=list(law.knots)
    )
    return layer, law


def table_law(w: list[float], p: list[float]) -> tuple[layers.Layer, Law]:
    """Return a table, and SciPy's interpolant of it."""
    return layers.Table(w, p), law_of(PchipInterpolator(w, p))


def _bent_height(bend: float, more: float, r: Any) -> Any:
    return r**2 / 2.0 + more * np.maximum(r - bend, 0.0) ** 2 / 2.0


def _bowl_height(r: Any) -> Any:
    return r**2 / 2.0 + r**4 / 8.0


def _sampled(
    height: Callable[[Any], Any], slope: Callable[[Any], Any], breaks: tuple[float, ...]
) -> profiles.Profile:
    return profiles.Sampled.from_functions(height, slope, reach=6.0, breaks=breaks, rounded=True)


def drawn(rng: np.random.Generator) -> Drawn:
    """Return a scene."""
    kind = rng.integers(6)
    breaks: tuple[float, ...] = ()
    profile: profiles.Profile
    height: Callable[[Any], Any]
    if kind == 0:
        profile = profiles.Flat(1.0)
        height = profile._height
    elif kind <= 2:
        profile = profiles.Parabola(1.0)
        height = profile._height
    elif kind == 3:
        profile = profiles.Cone(float(rng.uniform(0.6, 1.4)))
        height = profile._height
    elif kind == 4:
        bend = float(rng.uniform(0.2, 0.8))
        more = decade(rng, -1.0, 1.0)
        breaks = (bend,)
        height = partial(_bent_height, bend, more)
        profile = _sampled(height, lambda r: r + more * np.maximum(r - bend, 0.0), breaks)
    else:
        height = _bowl_height
        profile = _sampled(height, lambda r: r + r**3 / 2.0, breaks)
    flat = isinstance(profile, profiles.Flat)
    radius = 1.0 if flat else 0.3 + decade(rng, -1.0, 0.3)
    size = 1.0 if flat else float(profile.height(radius))
    start = float(rng.choice([0.0, -0.3 * size, 0.1 * size]))
    approach = start + size * decade(rng, -1.0, 0.5) if flat else None
    strength = decade(rng, -1.0, 2.0) / size
    linear = strength
    quadratic = strength / size * float(rng.choice([0.0, 0.3, 2.0]))
    # no overclosure is larger
    limit = start + 1.5 * (size if approach is None else approach - start)
    smooth, law = bent_polynomial(start, limit, linear, quadratic, [])
    given = {"contact_radius": radius} if approach is None else {"approach": approach}
    found = solve(Scene(0.3, layer=smooth, profile=profile, **given), rtol=1e-6)
    pressures = found.pressure(np.linspace(0.0, 1.0, 201))
    ends = [
        float(smooth.overclosure(p)) if p > 0.0 else start
        for p in (pressures.min(), pressures.max())
    ]
    extent = ends[1] - ends[0]
    if rng.integers(3) == 0:
        count = int(rng.integers(3, 9))
        w = np.append(0.0, np.cumsum(rng.uniform(0.2, 1.0, count)))
        w = start + w / w[-1] * (ends[1] - start) * float(rng.uniform(0.6, 2.0))
        w = np.append(w, max(limit, float(w[-1]) + size))
        steps = np.diff(w) * strength * 10.0 ** rng.uniform(-0.7, 0.7, count + 1)
        p = np.append(0.0, np.cumsum(steps))
        layer, law = table_law(w.tolist(), p.tolist())
        return Drawn(layer, law, profile, height, breaks, radius, approach, f"table of {count + 2}")
    jumps, places = [], []
    for _ in range(int(rng.integers(1, 4))):
        place = str(rng.choice(["anywhere", "below the top", "above the top", "next to the least"]))
        off = decade(rng, *CLOSE)
        knot = {
            "anywhere": ends[0] + float(rng.uniform(0.0, 1.2)) * extent,
            "below the top": ends[1] - off * extent,
            "above the top": ends[1] + off * extent,
            "next to the least": ends[0] + off * extent,
        }[place]
        if not start < knot < limit or any(abs(knot - one[0]) < 1e-7 * extent for one in jumps):
            continue
        n = int(rng.integers(1, 3))
        factor = float(rng.choice([-0.5, 1.0, 4.0])) if n == 1 else float(rng.choice([1.0, 4.0]))
        if factor < 0.0 and any(one[1] < 0.0 for one in jumps):
            continue
        jumps.append((knot, factor * linear / (1.0 if n == 1 else size), n))
        places.append(f"{'kink' if n == 1 else 'bend'} {place} ({off:.0e})")
    layer, law = bent_polynomial(start, limit, linear, quadratic, jumps)
    return Drawn(layer, law, profile, height, breaks, radius, approach, ", ".join(places))


def truth_of(one: Drawn, meshes: Sequence[tuple[int, int]] = MESHES) -> BentContact:
    """Return the contact by collocation."""
    given = {"start": one.layer.start} if one.approach is None else {"approach": one.approach}
    return solved(
        one.law,
        one.height,
        one.radius,
        breaks=[b for b in one.breaks if b < one.radius],
        pointed=one.profile.pointed,
        meshes=meshes,
        **given,
    )


def ratios(rng: np.random.Generator) -> tuple[dict[str, float], str, bool]:
    """Return true errors over estimates for a scene, what it is, and whether it converged."""
    one = drawn(rng)
    controls = ["load", "approach"] + ["contact_radius"] * (one.approach is None)
    control = str(rng.choice(controls))
    rtol = 10.0 ** rng.uniform(-11.0, -4.0)
    asked = None if rng.integers(2) else [*NAMES[:-1]]
    worst, converged = _solved_and_compared(one, truth_of(one), control, rtol, asked)
    if max(worst.values()) > 1.0:
        # the error of a truth is the difference of its two meshes, which may agree by chance
        truth = truth_of(one, FINER_MESHES)
        worst, converged = _solved_and_compared(one, truth, control, rtol, asked)
    label = f"{one.profile.brief[:60]}, {one.about}, {control}, rtol {rtol:.1e}"
    label += ", pressure" * (asked is None)
    return worst, label, converged


def _solved_and_compared(
    one: Drawn, truth: BentContact, control: str, rtol: float, asked: list[str] | None
) -> tuple[dict[str, float], bool]:
    """Return the larger ratios of two tolerances, and whether the looser solution converged."""
    values = {"load": truth.load, "approach": truth.approach, "contact_radius": one.radius}
    scene = Scene(0.3, layer=one.layer, profile=one.profile, **{control: values[control]})
    found = solve(scene, rtol, asked, strict=False)
    tight = solve(scene, min(rtol, TIGHTER), asked, strict=False)
    worst = _compared(found, truth, one)
    for name, ratio in _compared(tight, truth, one).items():
        worst[name] = max(worst[name], ratio)
    return worst, bool(found.converged)


def _compared(found: Solution, truth: BentContact, one: Drawn) -> dict[str, float]:
    exact = {
        "approach": truth.approach,
        "load": truth.load,
        "indentation_work": truth.work,
        "stiffness": truth.stiffness,
        "contact_radius": one.radius,
    }
    known = {**truth.error, "indentation_work": truth.error["work"], "contact_radius": 0.0}
    # errors of the load at a given radius or approach are those of what is found under that load
    known["contact_radius"] = max(truth.error["load"], truth.error["approach"])
    if found.scene.load is not None:
        size = max(abs(truth.approach), one.radius * 1e-3)
        known["approach"] += truth.error["load"] * truth.load / (truth.stiffness * size)
    known["stiffness"] += _slope_difference(one, truth)
    ratio = dict.fromkeys(NAMES, 0.0)
    for name, value in exact.items():
        own = getattr(found, name)
        size = abs(value) if name != "approach" else max(abs(value), one.radius * 1e-3)
        room = getattr(found.error, name) * size + (known[name] + ROUNDING) * size
        ratio[name] = abs(own - value) / room
    if "pressure" in found.plan.quantities:
        # the disk is as large as the oracle's but for the error of its radius
        s = truth.r / one.radius
        own = np.asarray(found.pressure(s))
        mean = truth.load / (pi * one.radius**2)
        room = found.error.pressure * np.maximum(truth.pressure, mean)
        room = room + (truth.error["pressure"] + 10.0 * ROUNDING) * truth.pressure.max()
        ratio["pressure"] = float((np.abs(own - truth.pressure) / room).max())
    return ratio


def _slope_difference(one: Drawn, truth: BentContact) -> float:
    """Return the largest relative difference in the contact of the two slopes of the law.

    The layer of the library samples a law that is given as functions, and its slope is a derivative
    of the series. The stiffness is a monotone function of the slope, and its relative change at
    most that of the slope.
    """
    ends = sorted({one.layer.start, *one.law.knots, one.layer.limit})
    inside = (np.arange(200) + 0.5) / 200.0
    overclosures = np.concatenate([low + (high - low) * inside for low, high in pairwise(ends)])
    overclosures = overclosures[one.law.pressure(overclosures) <= truth.pressure.max()]
    slope = one.law.slope(overclosures)
    difference = np.abs(one.layer._slope(overclosures) - slope)[slope > 0.0] / slope[slope > 0.0]
    return float(difference.max(initial=0.0))


def scene_of(seed: int, scene: int) -> Outcome | None:
    """Return what becomes of a scene; None where the oracle does not know the bends."""
    try:
        return Outcome(*ratios(np.random.default_rng([seed, scene])))
    except AssertionError:
        return None


def outcomes(seed: int, scenes: int, workers: int) -> Iterator[Outcome | None]:
    """Yield what becomes of each scene, in order."""
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(partial(scene_of, seed), range(scenes))


STRATA = {
    "bent_layers": Stratum(
        "Honesty of contacts through layers that bend",
        1000,
        outcomes,
        refused="of {} the oracle does not know the bends",
        compared="true error over its estimate, the larger of two tolerances",
        every=5,
    )
}
