"""Numbers of a sweep against `solve` at 1e-12: lines of frictions, indentation curves and maps.

Strata of honesty.py. A *line* has one or no compliance that is zero, and frictions that are
equidistant, in equal ratios or random, up to some beyond the critical one. A *curve* has loads or
approaches, spaced likewise, of a random profile with a compliance or none. A *map* has random
compliances from 1e-8 to 1e8 on both axes. Some scenes of each are solved singly; what is counted is
the largest share of its estimate that an error takes, of scenes that the sweep solved and of those
between.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from profiles import drawn
from strata import Outcome, largest, over_estimates

from spectral_contact import Scene, Solution, solve
from spectral_contact.sweeps import sweep

LINE = ("stick_radius", "total_shear")
CURVE = ("contact_radius", "load", "approach", "stiffness", "indentation_work")
MAP = ("approach", "total_shear", "edge_ratio", "critical_friction")
#: Scenes that are solved singly, of a line or curve and of a map, and the size of a map.
CHECKED, CHECKED_OF_MAP, SIZE = 8, 200, 100


def spread(rng: np.random.Generator, highest: float, decades: float) -> np.ndarray:
    """Return some dozen numbers up to one: equidistant, in equal ratios or random."""
    count, kind = int(rng.integers(24, 160)), rng.integers(3)
    if kind == 0:
        return np.linspace(highest / count, highest, count)
    if kind == 1:
        return np.geomspace(highest * 10.0 ** -rng.uniform(0.3, decades), highest, count)
    return np.sort(rng.uniform(0.05 * highest, highest, count))


def shares(
    found: Mapping[str, Any], i: int, truth: Solution, names: Sequence[str]
) -> dict[str, float]:
    """Return errors over their estimates in a scene of a sweep, against its solution."""
    error = SimpleNamespace(**{name: float(found[f"{name}_error"][i]) for name in names})
    one = SimpleNamespace(**{name: float(found[name][i]) for name in names}, error=error)
    return over_estimates(one, truth, names)


def lines(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a line of frictions."""
    alpha, beta = 10.0 ** rng.uniform(-5.0, 2.0, 2) * (rng.random(2) > 0.1)
    base = Scene(rng.uniform(-0.3, 0.45), float(alpha), float(beta), math.inf)
    critical = solve(base, 1e-8, ["critical_friction"]).critical_friction
    frictions = spread(rng, min(critical, 3.0) * 10.0 ** rng.uniform(-0.7, 0.2), 2.5)
    found = sweep(base, friction=frictions, quantities=LINE)
    each = []
    for i in rng.choice(len(frictions), CHECKED, replace=False):
        scene = base.replace(friction=float(frictions[i]))
        each.append(shares(found, i, solve(scene, 1e-12, LINE, strict=False), LINE))
    return Outcome(largest(each), f"{base!r}, {len(frictions)} frictions")


def curves(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of an indentation curve."""
    profile, radius = drawn(rng)
    alpha = radius * 10.0 ** rng.uniform(-6.0, 3.0) * (rng.random() > 0.15)
    rtol = 10.0 ** rng.uniform(-11.0, -4.0)
    given = str(rng.choice(["load", "approach"]))
    base = Scene(0.3, alpha, profile=profile, contact_radius=radius)
    highest = float(getattr(solve(base, 1e-6, [given], strict=False), given))
    values = spread(rng, highest, 4.0)
    found = sweep(base, **{given: values}, quantities=CURVE, rtol=rtol)
    names, each = [one for one in CURVE if one != given], []
    for i in rng.choice(len(values), CHECKED, replace=False):
        one = Scene(0.3, alpha, profile=profile, **{given: float(values[i])})
        each.append(shares(found, i, solve(one, 1e-12, CURVE, strict=False), names))
    label = f"{profile.brief}, alpha = {alpha:.1e}, rtol {rtol:.0e}, {len(values)} of {given}"
    return Outcome(largest(each), label)


def maps(rng: np.random.Generator, _: int) -> Outcome:
    """Return what becomes of a map of full stick."""
    alpha, beta = 10.0 ** rng.uniform(-8.0, 8.0, (2, SIZE))
    base, rtol = Scene(0.3, 1.0, 1.0, math.inf), 10.0 ** rng.uniform(-12.0, -4.0)
    axes = {"normal_compliance": alpha, "tangential_compliance": beta}
    found, each = sweep(base, **axes, quantities=MAP, rtol=rtol), []
    for i, j in rng.integers(SIZE, size=(CHECKED_OF_MAP, 2)):
        here = found.isel(normal_compliance=[i], tangential_compliance=j)
        scene = base.replace(
            normal_compliance=float(alpha[i]), tangential_compliance=float(beta[j])
        )
        each.append(shares(here, 0, solve(scene, 1e-12, MAP, strict=False), MAP))
    return Outcome(largest(each), f"rtol {rtol:.0e}")
