"""What the net asks of every scene: did it converge, and is every true error within its estimate.

Nothing here knows more of the library than its public API.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
sys.path.append(str(Path(__file__).parents[1] / "honesty"))

from coupled_slip_errors import Sample, ratios, sample, values
from honesty_errors import compare, violates, zones_error
from net_kept import NEAR, Kept, KeptZone, scene_of
from oracles import gold_errors, hard_cases

from spectral_contact import (
    ConvergenceError,
    NotComputedError,
    Scene,
    Solution,
    clear_caches,
    gold,
    solve,
)

HARD_RTOL = 1e-12
#: By what an estimate of a hard case may grow where the tolerance does not bound it.
WORSE = 10.0
#: Where the friction law is looked at, from the ends of a zone, in its width.
LAW = np.geomspace(1e-6, 0.45, 30)
#: Distance of a solution from the law that rounding explains.
ROUNDING = 1e-14


@dataclass
class Finding:
    """What became of one scene.

    Attributes
    ----------
    name : str
    converged : bool
    violations : list of str
        True errors above their estimates, and exceptions.
    estimates : dict of str to float
        Those of hard cases, at the tightest tolerance.
    """

    name: str
    converged: bool
    violations: list[str] = field(default_factory=list)
    estimates: dict[str, float] = field(default_factory=dict)


Judge = Callable[[Solution], list[str]]


def solved(name: str, scene: Scene, rtol: float, judge: Judge) -> tuple[Finding, Solution | None]:
    """Solve a scene and judge it; what raises is a violation, but for an honest refusal."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            solution = solve(scene, rtol, strict=False)
            return Finding(name, solution.converged, judge(solution)), solution
    except (ConvergenceError, NotComputedError):
        return Finding(name, False), None
    except Exception as error:  # whatever it is, it is a violation
        return Finding(name, False, [f"{type(error).__name__}: {error!s:.120}"]), None


def exceeded(pairs: dict[str, tuple[float, float]]) -> list[str]:
    """Return true errors that are above their estimates as text."""
    return [
        f"{name}: error {error:.2g}, estimate {most:.2g}" for name, (error, most) in pairs.items()
    ]


# --- scenes, with what judges them ----------------------------------------------------------------


def gold_scenes(every: int) -> Iterator[Finding]:
    """Solve the gold scenes at four tolerances, or at the loosest and the tightest."""
    tolerances = gold_errors.TOLERANCES if every == 1 else gold_errors.TOLERANCES[::3]
    for rtol in tolerances:
        for table in gold.tables():
            for true in table.solutions:
                judge = partial(gold_violations, true, rtol)
                yield solved(f"{true.name} at {rtol:g}", true.scene, rtol, judge)[0]


def gold_violations(true: gold.GoldSolution, rtol: float, double: Solution) -> list[str]:
    """Return what is wrong beside a gold solution."""
    unmet = gold_errors.unmet(double, true, rtol) if double.converged else {}
    return exceeded(gold_errors.exceeded(double, true)) + [
        f"{name}: converged with the estimate {estimate:.2g}" for name, estimate in unmet.items()
    ]


def hard_scenes(truths: dict[str, Any], every: int) -> Iterator[Finding]:
    """Solve the hard cases, without those that are slow where not all is asked."""
    for case in hard_cases.CASES:
        if case.slow and every > 1:
            continue
        judge = partial(hard_violations, truths[case.name])
        with np.errstate(all="raise"):  # underflow, too
            finding, solution = solved(case.name, case.scene, HARD_RTOL, judge)
        if solution is not None:
            names = ("approach", "pressure", "traction", "total_shear", "zones")
            finding.estimates = {name: float(getattr(solution.error, name)) for name in names}
        yield finding


def hard_violations(truth: dict[str, Any], solution: Solution) -> list[str]:
    """Return what is wrong with a hard case."""
    return exceeded(hard_cases.exceeded(solution, truth))


def worse(finding: Finding, before: dict[str, float]) -> list[str]:
    """Return in what the estimates of a hard case are worse than they were."""
    return [
        f"{name}: estimate {before[name]:.2g} before, {estimate:.2g} now"
        for name, estimate in finding.estimates.items()
        if not estimate <= max(WORSE * before[name], HARD_RTOL)
    ]


def honesty_scenes(kept: list[dict[str, Any]], every: int) -> Iterator[Finding]:
    """Solve random scenes whose truths are kept."""
    for row in kept[::every]:
        judge = slip_violations if row["kind"] == "coupled slip" else field_violations
        scene = scene_of(row["scene"])
        name = f"{row['kind']} {row['number']}"
        yield solved(name, scene, row["rtol"], partial(judge, row["truth"]))[0]


def field_violations(row: dict[str, Any], solution: Solution) -> list[str]:
    """Return what is wrong beside a kept truth."""
    truth = Kept(row)
    found = compare(solution, truth, truth.at)
    return exceeded({n: (e, most) for n, (e, most, own) in found.items() if violates(e, most, own)})


def slip_violations(row: dict[str, Any], solution: Solution) -> list[str]:
    """Return the same of coupled slip."""
    if len(solution.zones) != len(row["zones"]):
        return zones_missed(row, solution)
    found = ratios(sample(solution, NEAR, centre=False), Sample(**row["sample"]))
    return [f"{n}: {r:.2g} times the estimate" for n, r in found.items() if not r <= 1.0]


def zones_missed(row: dict[str, Any], solution: Solution) -> list[str]:
    """Return the error of the zones, missing ones too, if it is above the estimate.

    An estimate of 1 says that any zone may be missing.
    """
    if solution.error.zones >= 1.0:
        return []
    truth = SimpleNamespace(zones=[KeptZone(*zone) for zone in row["zones"]])
    error, most = zones_error(solution, truth), float(solution.error.zones)
    return exceeded({"zones": (error, most)} if violates(error, most, row["zones_error"]) else {})


def threshold_scenes(
    kept: list[dict[str, Any]], every: int, *, zones_known: bool = False
) -> Iterator[Finding]:
    """Solve scenes where a zone appears, joins or vanishes.

    With `zones_known` a solution whose estimate says that any zone may be missing counts as one
    that has not converged.
    """
    for row in kept[::every]:
        if row["slow"] and every > 1:
            continue
        judge = partial(threshold_violations, row)
        finding, solution = solved(row["name"], scene_of(row["scene"]), row["rtol"], judge)
        if zones_known and solution is not None and not solution.error.zones < 1.0:
            finding.converged = False
        yield finding


def threshold_violations(row: dict[str, Any], solution: Solution) -> list[str]:
    """Return where the law by its own fields, or the zones as far as they are known, are missed."""
    return (zones_missed(row, solution) if row["zones"] else []) + off_the_law(solution)


def off_the_law(solution: Solution) -> list[str]:
    """Return where friction is exceeded in stick, or slip has the wrong sense, beyond estimates."""
    friction = solution.scene.friction
    if friction is None or not np.isfinite(friction):
        return []
    p, q, slip = (values(solution, name, LAW) for name in ("pressure", "traction", "slip"))
    # the centre is an end where it slips
    ends = [1 + (zone.inner > 0.0 or zone.kind == "slip") for zone in solution.zones]
    kinds = np.repeat([zone.kind for zone in solution.zones], len(LAW) * np.array(ends))
    error = solution.error
    room = error.pressure + error.traction + error.zones + ROUNDING
    stick, found = (kinds == "stick") & (p > 0.0), []
    excess = float(np.max(np.abs(q[stick]) / (friction * p[stick]) - 1.0, initial=0.0))
    if not excess <= room:
        found.append(f"stick: friction exceeded by {excess:.2g}, room for {room:.2g}")
    wrong = np.max(slip * np.sign(q), where=kinds == "slip", initial=0.0)
    share = float(wrong / np.max(np.abs(slip), initial=1e-300))
    if not share <= error.slip + ROUNDING:
        found.append(f"slip: {share:.2g} of it in the wrong sense, estimate {error.slip:.2g}")
    return found


def sections(kept: dict[str, Any], every: int) -> Iterator[tuple[str, list[Finding]]]:
    """Yield every section with its findings, each begun with empty caches."""
    coupled = threshold_scenes(kept["coupled thresholds"], every, zones_known=True)
    for name, findings in (
        ("gold", gold_scenes(every)),
        ("hard", hard_scenes(kept["hard"], every)),
        ("honesty", honesty_scenes(kept["honesty"], every)),
        ("thresholds", threshold_scenes(kept["thresholds"], every)),
        ("coupled thresholds", coupled),
    ):
        clear_caches()
        yield name, list(findings)
