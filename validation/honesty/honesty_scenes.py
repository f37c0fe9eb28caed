"""Random scenes and their truth, for flat_punches.py; `honesty_errors` compares."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Set
from contextlib import suppress
from types import SimpleNamespace
from unittest import mock

import numpy as np
from honesty_errors import compare, unexplained, zones_alike

from spectral_contact import ConvergenceError, NotComputedError, Scene, Solution, solve
from spectral_contact.contact import resolution
from spectral_contact.precise import ReferenceSolution, reference
from spectral_contact.records import Zone

#: Panel width of the true solutions; that of the library is 2.
TRUE_WIDTHS = 1.5, 1.75
#: A truth that breaks the friction law by more is none, nor is one whose shear is as uncertain.
BROKEN, UNCERTAIN = 1e-6, 1e-9

#: Share of the scenes that are of two bodies with negative kappa.
TURNED = 0.25
#: One scene of so many has `reference` to `DIGITS` as its truth.
BLOCK, DIGITS = 40, 20
#: Where those are refused, which names what to ask for instead.
OTHER_DIGITS = 25, 15
STRATA = tuple(itertools.product(range(3), (False, True), (False, True)))


def drawn(seed: int, number: int) -> SimpleNamespace:
    """Return what chance decides of scene `number` of a seed; it depends on nothing else."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
    mode = int(rng.integers(3))
    alpha, beta = 10.0 ** rng.uniform(-14, 14, 2)
    if mode == 0:
        alpha, beta = 10.0 ** rng.uniform(-4, 1, 2)
    elif mode == 1:
        alpha = float(np.clip(beta * 10.0 ** rng.uniform(-3, 1), 1e-14, 1e14))
    alpha *= rng.random() >= 0.1
    beta *= rng.random() >= 0.1
    # in this order
    found = {"nu": rng.uniform(-0.99, 0.499), "rtol": 10.0 ** rng.uniform(-9, -2)}
    found |= {"near": rng.random() < 0.3, "share": 10.0 ** rng.uniform(-3, 0)}
    found |= {"gap": 10.0 ** rng.uniform(-6, -1), "free": 10.0 ** rng.uniform(-2, 1.2)}
    turned = bool(rng.random() < TURNED)
    # how the compliances are drawn, whether one is 0, and whether slip is about to start
    stratum = mode, bool(alpha * beta == 0.0), found["near"]
    return SimpleNamespace(
        alpha=float(alpha), beta=float(beta), turned=turned, stratum=stratum, **found
    )


def random_scene(seed: int, number: int, coupled: bool) -> tuple[Scene, float]:
    """Return scene `number` of a seed, and a tolerance; with coupling it is one of full stick."""
    one = drawn(seed, number)
    stick = Scene(one.nu, one.alpha, one.beta, math.inf, coupling=coupled)
    if one.turned:  # two bodies with negative kappa
        stick = stick.replace(kappa=-stick.kappa)
    if coupled:
        return stick, one.rtol
    critical = solve(stick, 1e-9, ("critical_friction",)).critical_friction
    if math.isinf(critical):
        friction = abs(stick.kappa) * one.free
    else:
        friction = critical * (1.0 - one.gap if one.near else one.share)
    return stick.replace(friction=float(friction)), one.rtol


def by_reference(seed: int, number: int) -> bool:
    """Return whether `reference` is the truth of a scene: of one in every block of `BLOCK`.

    The strata take turns; the first scene of a block that is in the stratum is taken.
    """
    block, place = divmod(number, BLOCK)
    wanted = STRATA[block % len(STRATA)]
    found = [drawn(seed, block * BLOCK + k).stratum == wanted for k in range(place + 1)]
    return found[-1] and not any(found[:-1])


def true_solution(scene: Scene) -> Solution:
    """Solve as tightly as doubles allow, on narrower panels: none shares an end but the first."""
    for width in TRUE_WIDTHS:
        with mock.patch.object(resolution, "PANEL_WIDTH", width):
            truth = solve(scene, 1e-12, strict=False)
        violation = truth.error.violation  # none where everything sticks
        if (violation or 0.0) <= BROKEN and truth.error.total_shear <= UNCERTAIN:
            break
    return truth


def rounded(true: ReferenceSolution) -> SimpleNamespace:
    """Return a solution to many digits in doubles, as far as `compare` looks; it has no slip."""
    sides = "inner", "outer", "inner_from_edge", "outer_from_edge"
    found = SimpleNamespace(
        error=true.error,
        zones=[Zone(z.kind, *(float(getattr(z, side)) for side in sides)) for z in true.zones],
        approach=float(true.approach),
        total_shear=float(true.total_shear),
        stick_radius=float(true.stick_radius),
        pressure=lambda *, from_edge: true.pressure(from_edge=from_edge).astype(float),
        traction=lambda s=None, *, from_edge=None: true.traction(s, from_edge=from_edge).astype(
            float
        ),
    )
    if true.scene.couples and true.edge_ratio is not None:
        found.edge_ratio = float(true.edge_ratio)
    return found


def exact_solution(scene: Scene) -> SimpleNamespace | None:
    """Return the solution to many digits; None if doubles do not resolve its zones."""
    with suppress(NotComputedError):
        for digits in (DIGITS, *OTHER_DIGITS):
            with suppress(ConvergenceError):
                return rounded(reference(scene, digits))
    return None


def outcome(number: int, seed: int, coupled: bool, exact: Set[int] = frozenset()) -> dict:
    """Solve a scene and return what there is to keep of it.

    The truth of those in `exact` has many digits, unless doubles do not resolve its zones.
    """
    row: dict = {"number": number}
    by_digits = number in exact
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            scene, rtol = random_scene(seed, number, coupled)
            if coupled and by_digits:  # what doubles can do is seen against many digits alone
                rtol = 1e-12
            row |= {"scene": repr(scene), "rtol": rtol, "by_reference": by_digits}
            solution = solve(scene, rtol, strict=False)
            known = exact_solution(scene) if by_digits else None
            row["exact"] = known is not None
            truth = known or true_solution(scene)
            row["unconverged"] = not solution.converged
            row["differing"] = not zones_alike(solution, truth)
            row["errors"] = compare(solution, truth)
            closest = None if known else truth
            if known and solution.error.slip == math.inf:
                closest = solve(scene, 1e-12, strict=False)
            row["unexplained"] = unexplained(solution, closest)
    except Exception as error:  # whatever it is, it is a violation
        row["raised"] = f"{type(error).__name__}: {error!s:.200}"
    return row
