"""True errors of contact through layers whose law bends, against their estimates.

A stratum of honesty.py, which `--workers` speeds up. The truth is collocation in the radius with
the elliptic kernel (tests/oracles/bent_collocation.py), which shares no code with the library, on
panels to bends that it finds itself. Laws are tables, and polynomials with kinks or jumps of the
second derivative that are put next to the largest overclosure, on either side of it, next to the
edge, or anywhere. Every scene is solved with a random tolerance, and with a tighter one: claims
that contradict each other are violations, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
from oracles.bent_collocation import FINER_MESHES, MESHES, STILL, BentContact, Law, solved
from scipy.interpolate import PchipInterpolator, PPoly
from strata import Outcome, decade, largest, over_estimates

from spectral_contact import Scene, Solution, layers, profiles, solve

NAMES = ("approach", "load", "contact_radius", "indentation_work", "stiffness")
#: The tighter of the two tolerances of a scene.
TIGHTER = 1e-11
#: Relative error of the truth that its two meshes do not show: its bends come to rest to `STILL`.
#: `layers.Sampled` leaves a fifth of it of a law that is given as functions.
ROUNDING = STILL
#: Distances from what a bend is put next to, as powers of ten of the range of overclosures.
CLOSE = (-9.0, -0.5)


@dataclass(frozen=True)
class Shape:
    """A profile, with the heights and breaks of the function that the library samples."""

    profile: profiles.Profile
    height: Callable[[Any], Any]
    breaks: tuple[float, ...] = ()


@dataclass(frozen=True)
class Drawn:
    """A law and a shape for both sides, and the disk."""

    layer: layers.Layer
    law: Law
    shape: Shape
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


def sampled(
    height: Callable[[Any], Any], slope: Callable[[Any], Any], breaks: tuple[float, ...] = ()
) -> Shape:
    """Return a shape that is given by functions."""
    profile = profiles.Sampled.from_functions(height, slope, reach=6.0, breaks=breaks, rounded=True)
    return Shape(profile, height, breaks)


def shape_of(rng: np.random.Generator) -> Shape:
    """Return a shape."""
    kind = rng.integers(6)
    if kind == 4:
        bend, more = float(rng.uniform(0.2, 0.8)), decade(rng, -1.0, 1.0)
        return sampled(
            lambda r: r**2 / 2.0 + more * np.maximum(r - bend, 0.0) ** 2 / 2.0,
            lambda r: r + more * np.maximum(r - bend, 0.0),
            (bend,),
        )
    if kind == 5:
        return sampled(lambda r: r**2 / 2.0 + r**4 / 8.0, lambda r: r + r**3 / 2.0)
    profile = profiles.Flat(1.0) if kind == 0 else profiles.Parabola(1.0)
    if kind == 3:
        profile = profiles.Cone(float(rng.uniform(0.6, 1.4)))
    return Shape(profile, profile._height)


def table_of(
    rng: np.random.Generator, start: float, top: float, limit: float, size: float, strength: float
) -> tuple[layers.Layer, Law, str]:
    """Return a table up to the largest overclosure or beyond, as SciPy's interpolant, too."""
    count = int(rng.integers(3, 9))
    w = np.append(0.0, np.cumsum(rng.uniform(0.2, 1.0, count)))
    w = start + w / w[-1] * (top - start) * float(rng.uniform(0.6, 2.0))
    w = np.append(w, max(limit, float(w[-1]) + size))
    steps = np.diff(w) * strength * 10.0 ** rng.uniform(-0.7, 0.7, count + 1)
    p = np.append(0.0, np.cumsum(steps))
    table = layers.Table(w.tolist(), p.tolist())
    return table, law_of(PchipInterpolator(w, p)), f"table of {count + 2}"


def bends_of(
    rng: np.random.Generator,
    ends: tuple[float, float],
    within: tuple[float, float],
    size: float,
    linear: float,
) -> tuple[list[tuple[float, float, int]], str]:
    """Return jumps of the slope or of the second derivative next to the overclosures at the ends.

    All lie between the overclosures `within`. What they are is returned, too.
    """
    least, top = ends
    extent = top - least
    jumps: list[tuple[float, float, int]] = []
    about = []
    for _ in range(int(rng.integers(1, 4))):
        place = str(rng.choice(["anywhere", "below the top", "above the top", "next to the least"]))
        off = decade(rng, *CLOSE)
        knot = {
            "anywhere": least + float(rng.uniform(0.0, 1.2)) * extent,
            "below the top": top - off * extent,
            "above the top": top + off * extent,
            "next to the least": least + off * extent,
        }[place]
        apart = all(abs(knot - other) >= 1e-7 * extent for other, _, _ in jumps)
        if not (within[0] < knot < within[1] and apart):
            continue
        power = int(rng.integers(1, 3))
        factor = float(rng.choice([-0.5, 1.0, 4.0] if power == 1 else [1.0, 4.0]))
        if factor < 0.0 and any(jump < 0.0 for _, jump, _ in jumps):
            continue
        jumps.append((knot, factor * linear / (1.0 if power == 1 else size), power))
        about.append(f"{'kink' if power == 1 else 'bend'} {place} ({off:.0e})")
    return jumps, ", ".join(about)


def drawn(rng: np.random.Generator) -> Drawn:
    """Return a scene; its law bends next to the overclosures of a contact without bends."""
    shape = shape_of(rng)
    flat = isinstance(shape.profile, profiles.Flat)
    radius = 1.0 if flat else 0.3 + decade(rng, -1.0, 0.3)
    size = 1.0 if flat else float(shape.profile.height(radius))
    start = float(rng.choice([0.0, -0.3 * size, 0.1 * size]))
    approach = start + size * decade(rng, -1.0, 0.5) if flat else None
    linear = decade(rng, -1.0, 2.0) / size
    quadratic = linear / size * float(rng.choice([0.0, 0.3, 2.0]))
    # no overclosure is larger
    limit = start + 1.5 * (approach - start if flat else size)
    smooth, _ = bent_polynomial(start, limit, linear, quadratic, [])
    given = {"approach": approach} if flat else {"contact_radius": radius}
    found = solve(Scene(0.3, layer=smooth, profile=shape.profile, **given), rtol=1e-6)
    pressures = found.pressure(np.linspace(0.0, 1.0, 201))
    least, top = (
        float(smooth.overclosure(p)) if p > 0.0 else start
        for p in (pressures.min(), pressures.max())
    )
    if rng.integers(3) == 0:
        layer, law, about = table_of(rng, start, top, limit, size, linear)
    else:
        jumps, about = bends_of(rng, (least, top), (start, limit), size, linear)
        layer, law = bent_polynomial(start, limit, linear, quadratic, jumps)
    return Drawn(layer, law, shape, radius, approach, about)


def truth_of(one: Drawn, meshes: Sequence[tuple[int, int]] = MESHES) -> BentContact:
    """Return the contact by collocation."""
    given = {"start": one.layer.start} if one.approach is None else {"approach": one.approach}
    return solved(
        one.law,
        one.shape.height,
        one.radius,
        breaks=[b for b in one.shape.breaks if b < one.radius],
        pointed=one.shape.profile.pointed,
        meshes=meshes,
        **given,
    )


def bent_layers(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a scene, by the larger ratios of two tolerances."""
    one = drawn(rng)
    controls = ["load", "approach"] + ["contact_radius"] * (one.approach is None)
    control = str(rng.choice(controls))
    rtol = 10.0 ** rng.uniform(-11.0, -4.0)
    asked = None if rng.integers(2) else [*NAMES]
    # the error of a truth is the difference of its two meshes, which may agree by chance
    for meshes in (MESHES, FINER_MESHES):
        truth = truth_of(one, meshes)
        value = one.radius if control == "contact_radius" else getattr(truth, control)
        scene = Scene(0.3, layer=one.layer, profile=one.shape.profile, **{control: value})
        found, tight = (solve(scene, r, asked, strict=False) for r in (rtol, min(rtol, TIGHTER)))
        worst = largest([compared(found, truth, one), compared(tight, truth, one)])
        if max(worst.values()) <= 1.0:
            break
    label = f"{one.shape.profile.brief[:60]}, {one.about}, {control}, rtol {rtol:.1e}"
    return Outcome(worst, label + ", pressure" * (asked is None), bool(found.converged))


def compared(found: Solution, truth: BentContact, one: Drawn) -> dict[str, float]:
    """Return true errors over estimates."""
    known = dict(truth.error)
    # errors of the load at a given radius or approach are those of what is found under that load
    known["contact_radius"] = max(known["load"], known["approach"])
    known["indentation_work"] = known["work"]
    size = max(abs(truth.approach), one.radius * 1e-3)
    if found.scene.load is not None:
        known["approach"] += known["load"] * truth.load / (truth.stiffness * size)
    known["stiffness"] += slope_difference(one, truth)
    exact = SimpleNamespace(
        approach=truth.approach,
        load=truth.load,
        contact_radius=one.radius,
        indentation_work=truth.work,
        stiffness=truth.stiffness,
        error=SimpleNamespace(**known),
    )
    ratios = over_estimates(found, exact, NAMES, ROUNDING, {"approach": size})
    if "pressure" in found.plan.quantities:
        # the disk is as large as the oracle's but for the error of its radius
        own = np.asarray(found.pressure(truth.r / one.radius))
        mean = truth.load / (pi * one.radius**2)
        room = found.error.pressure * np.maximum(truth.pressure, mean)
        room = room + (known["pressure"] + 10.0 * ROUNDING) * truth.pressure.max()
        ratios["pressure"] = float((np.abs(own - truth.pressure) / room).max())
    return ratios


def slope_difference(one: Drawn, truth: BentContact) -> float:
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
