"""Random scenes, their truth, and the true errors of every quantity, for honesty.py."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from typing import Any
from unittest import mock

import numpy as np

from spectral_contact import NotComputedError, Scene, Solution, solve
from spectral_contact.contact import resolution, slip_displacement, zone_system
from spectral_contact.precise import ReferenceSolution, reference
from spectral_contact.records import Zone
from spectral_contact.spectral.cache import BoundedCache

EPS = 2.2e-16
#: Where fields are compared, measured from the edge; `places` adds some in every zone.
DISTANCES = 10.0 ** -np.linspace(1e-3, 30.0, 600)
#: Panel width of the true solutions; that of the library is 2.
TRUE_WIDTH = 1.5
_TRUE_SPACES: BoundedCache = BoundedCache("first spaces of the truth", 128)

#: One scene of so many has `reference` to `DIGITS` as its truth.
BLOCK, DIGITS = 40, 20
STRATA = tuple(itertools.product(range(3), (False, True), (False, True)))
SCALARS = ("approach", "total_shear", "stick_radius", "edge_ratio", "critical_friction")


@dataclass(frozen=True)
class Draw:
    """What chance decides of a scene."""

    mode: int
    alpha: float
    beta: float
    nu: float
    rtol: float
    near: bool
    share: float
    gap: float
    free: float

    @classmethod
    def of(cls, seed: int, number: int) -> Draw:
        """Draw scene `number` of a seed; it depends on nothing else."""
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
        mode = int(rng.integers(3))
        alpha, beta = 10.0 ** rng.uniform(-14, 14, 2)
        if mode == 0:
            alpha, beta = 10.0 ** rng.uniform(-4, 1, 2)
        elif mode == 1:
            alpha = float(np.clip(beta * 10.0 ** rng.uniform(-3, 1), 1e-14, 1e14))
        alpha *= rng.random() >= 0.1
        beta *= rng.random() >= 0.1
        nu, rtol = rng.uniform(-0.99, 0.499), 10.0 ** rng.uniform(-9, -2)
        near, share = rng.random() < 0.3, 10.0 ** rng.uniform(-3, 0)
        gap, free = 10.0 ** rng.uniform(-6, -1), 10.0 ** rng.uniform(-2, 1.2)
        return cls(mode, float(alpha), float(beta), float(nu), float(rtol), near, share, gap, free)

    @property
    def stratum(self) -> tuple[int, bool, bool]:
        """How the compliances are drawn, whether one is 0, and whether slip is about to start."""
        return self.mode, self.alpha * self.beta == 0.0, self.near


def random_scene(seed: int, number: int, coupled: bool) -> tuple[Scene, float]:
    """Return scene `number` of a seed, and a tolerance; with coupling it is one of full stick."""
    drawn = Draw.of(seed, number)
    stick = Scene(drawn.nu, drawn.alpha, drawn.beta, math.inf, coupling=coupled)
    if coupled:
        return stick, drawn.rtol
    critical = solve(stick, 1e-9, ("critical_friction",)).critical_friction
    if math.isinf(critical):
        friction = stick.kappa * drawn.free
    else:
        friction = critical * (1.0 - drawn.gap if drawn.near else drawn.share)
    return Scene(drawn.nu, drawn.alpha, drawn.beta, float(friction)), drawn.rtol


def by_reference(seed: int, number: int) -> bool:
    """Return whether `reference` is the truth of a scene: of one in every block of `BLOCK`.

    The strata take turns; the first scene of a block that is in the stratum is taken.
    """
    block, place = divmod(number, BLOCK)
    wanted = STRATA[block % len(STRATA)]
    found = [Draw.of(seed, block * BLOCK + k).stratum == wanted for k in range(place + 1)]
    return found[-1] and not any(found[:-1])


@contextmanager
def other_panels() -> Iterator[None]:
    """Solve on narrower panels than the library's, of which none shares an end but the first."""
    with ExitStack() as stack:
        for module in (resolution, slip_displacement, zone_system):
            stack.enter_context(mock.patch.object(module, "PANEL_WIDTH", TRUE_WIDTH))
        # first spaces are cached by what is asked of them, which leaves out the width
        stack.enter_context(mock.patch.object(resolution, "_FIRST_SPACES", _TRUE_SPACES))
        yield


def true_solution(scene: Scene) -> Solution:
    """Solve as tightly as doubles allow, on other panels."""
    with other_panels():
        return solve(scene, 1e-12, strict=False)


class Rounded:
    """A solution to many digits in doubles, as far as `compare` looks at it; it has no slip."""

    def __init__(self, true: ReferenceSolution) -> None:
        self._true, self.error = true, true.error
        self.zones = tuple(
            Zone(z.kind, *map(float, (z.inner, z.outer, z.inner_from_edge, z.outer_from_edge)))
            for z in true.zones
        )
        self.approach, self.total_shear = float(true.approach), float(true.total_shear)
        self.stick_radius = float(true.stick_radius)
        if true.scene.couples and true.edge_ratio is not None:
            self.edge_ratio = float(true.edge_ratio)

    def pressure(self, *, from_edge: np.ndarray) -> np.ndarray:
        """Evaluate the pressure."""
        return self._true.pressure(from_edge=from_edge).astype(float)

    def traction(self, s: Any = None, *, from_edge: Any = None) -> np.ndarray:
        """Evaluate the traction."""
        return self._true.traction(s, from_edge=from_edge).astype(float)


def _relative(value: float, truth: float) -> float:
    if value == truth:
        return 0.0
    return abs(value / truth - 1.0) if truth else math.inf


def places(truth: Solution | Rounded) -> np.ndarray:
    """Return the distances from the edge at which fields are compared."""
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(40) + 0.5) / 40)
    inside = [
        zone.outer_from_edge + (zone.inner_from_edge - zone.outer_from_edge) * share
        for zone in truth.zones
    ]
    at = np.concatenate([DISTANCES, *inside])
    return at[at < 1.0]  # at the centre itself there is no traction to compare


def _pointwise(
    solution: Solution, truth: Solution | Rounded, name: str, at: np.ndarray
) -> np.ndarray:
    value, true = (getattr(one, name)(from_edge=at) for one in (solution, truth))
    if solution.scene.couples:
        return np.abs(value - true) / _sizes(solution, truth, at)[name]
    return np.abs(value / true - 1.0)


def _sizes(solution: Solution, truth: Solution | Rounded, at: np.ndarray) -> dict[str, np.ndarray]:
    """Return what errors are relative to with coupling: where signs change, the two together."""
    p, u = truth.pressure(from_edge=at), truth.traction(from_edge=at) / (1.0 - at)
    if solution.opening is not None or min(p.min(), u.min()) <= 0.0:
        p, u = np.hypot(p, u), np.hypot(u, solution.scene.kappa * p)
    return {"pressure": p, "traction": u * (1.0 - at)}


def _moved(truth: Solution | Rounded, at: np.ndarray, shift: float) -> np.ndarray:
    """Return by how much the traction varies where places move by a share of the radius."""
    changes, central = np.zeros(len(at)), at > 0.5
    if np.isfinite(shift):
        s, near = 1.0 - at[central], at[~central]
        changes[central] = truth.traction(s * (1.0 + shift)) / truth.traction(s) - 1.0
        moved = truth.traction(from_edge=near * (1.0 - shift))
        changes[~central] = moved / truth.traction(from_edge=near) - 1.0
    return np.abs(changes)


def _zones_alike(solution: Solution, truth: Solution | Rounded) -> bool:
    return [z.kind for z in solution.zones] == [z.kind for z in truth.zones]


def _zones_error(solution: Solution, truth: Solution | Rounded) -> float:
    """Return the largest error of a boundary, from the centre and from the edge.

    Where a zone is missing or too many, its ends count as one: they are off by its width.
    """
    if _zones_alike(solution, truth):
        pairs = list(zip(solution.zones[:-1], truth.zones[:-1], strict=True))
        errors = [_relative(z.outer, t.outer) for z, t in pairs]
        errors += [_relative(z.outer_from_edge, t.outer_from_edge) for z, t in pairs]
        return max(errors, default=0.0)
    ends = sorted({(-z.outer_from_edge, z.outer) for one in (solution, truth) for z in one.zones})
    worst, inner = 0.0, (-1.0, 0.0)
    for end in ends:
        middle = 0.5 * (inner[0] + end[0])
        if _kind_at(solution, -middle) != _kind_at(truth, -middle):
            outward = end[1] / inner[1] - 1.0 if inner[1] else math.inf
            worst = max(worst, outward, 1.0 - end[0] / inner[0])
        inner = end
    return worst


def _kind_at(solution: Solution, from_edge: float) -> str:
    return next(z.kind for z in solution.zones if z.outer_from_edge < from_edge)


def _has(solution: Solution | Rounded, name: str) -> bool:
    """Return whether a solution has a scalar; with coupling the edge ratio may have no meaning."""
    try:
        return hasattr(solution, name)
    except NotComputedError:
        return False


def compare(solution: Solution, truth: Solution | Rounded) -> dict[str, tuple[float, float, float]]:
    """Return for each quantity the true error, the estimate, and the estimate of the truth."""
    known = [name for name in SCALARS if _has(solution, name) and _has(truth, name)]
    errors = {n: _relative(getattr(solution, n), getattr(truth, n)) for n in known}
    at = places(truth)
    errors["pressure"] = float(_pointwise(solution, truth, "pressure", at).max())
    errors["zones"] = _zones_error(solution, truth)
    if solution.scene.friction == math.inf:  # by definition
        del errors["zones"], errors["stick_radius"]
    away = np.ones(len(at), dtype=bool)
    for zone in solution.zones[:-1]:  # the traction up to the shift of the boundaries
        shift = solution.error.zones * max(zone.outer_from_edge, 1e-300)
        away &= np.abs(at - zone.outer_from_edge) > 1e3 * shift
    at = at[away]
    traction = _pointwise(solution, truth, "traction", at) - _moved(truth, at, solution.error.zones)
    errors["traction"] = float(traction.max(initial=0.0))
    at = places(truth)
    slip = truth.slip(from_edge=at) if isinstance(truth, Solution) else None
    if slip is not None and np.any(slip):
        difference = np.abs(solution.slip(from_edge=at) - slip)
        errors["slip"] = float(difference.max() / np.abs(slip).max())
    return {
        name: (error, float(getattr(solution.error, name)), float(getattr(truth.error, name)))
        for name, error in errors.items()
    }


def violates(error: float, estimate: float, own: float) -> bool:
    """Return whether a true error is above the estimate; what is no number violates, too."""
    return not error <= estimate + own + 20 * EPS


def outcome(seed: int, number: int, exact: bool, coupled: bool) -> dict:
    """Solve a scene and return what there is to keep of it.

    With `exact` the truth has many digits, unless doubles do not resolve its zones.
    """
    row: dict = {"number": number}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            scene, rtol = random_scene(seed, number, coupled)
            if coupled and exact:  # what doubles can do is seen against many digits alone
                rtol = 1e-12
            row |= {"scene": repr(scene), "rtol": rtol}
            solution = solve(scene, rtol, strict=False)
            truth: Solution | Rounded | None = None
            row["by_reference"] = exact
            if exact:
                with suppress(NotComputedError):
                    truth = Rounded(reference(scene, DIGITS))
            row["exact"] = truth is not None
            truth = truth or true_solution(scene)
            row["unconverged"] = not solution.converged
            row["differing"] = not _zones_alike(solution, truth)
            row["errors"] = compare(solution, truth)
    except Exception as error:  # whatever it is, it is a violation
        row["raised"] = f"{type(error).__name__}: {error!s:.200}"
    return row
