"""The hard cases: honest, finite, silent, stable under one ulp, and under over-refinement.

Scenes and measures are in `hard_cases`; truths to 20 digits, conditioning and the cases that take
too long here are in validation/results/hard_cases.json.
"""

import functools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.hard_cases import CASES, EPS, exceeded, outputs, perturbations, shifts, true_errors
from oracles.hard_inside import overrefined

from spectral_contact import Scene, solve

RESULTS = Path(__file__).parents[2] / "validation" / "results"
RECORD = {
    row["name"]: row
    for row in json.loads((RESULTS / "hard_cases.json").read_text(encoding="utf-8"))["cases"]
}
FAST = [case for case in CASES if not case.slow]
QUICK = [case for case in FAST if len(RECORD[case.name]["truth"]["boundaries"]) < 2]
#: By what a shift may exceed the conditioning times ulp and rounding.
FACTOR = 30.0


def named(cases):
    return pytest.mark.parametrize("case", cases, ids=[case.name for case in cases])


@functools.cache
def solved(case):
    with np.errstate(all="raise"):  # underflow, too
        return solve(case.scene, 1e-12, strict=False)


def test_the_truths_are_of_these_scenes():
    assert {name: Scene.from_dict(row["scene"]) for name, row in RECORD.items()} == {
        case.name: case.scene for case in CASES
    }


@named(FAST)
def test_honest(case):
    assert exceeded(solved(case), RECORD[case.name]["truth"]) == {}


@named(FAST)
def test_converged_or_says_so(case):
    solution = solved(case)
    worst = max(solution.error.traction, solution.error.pressure, solution.error.total_shear)
    assert solution.converged == (worst <= 1e-12)
    assert worst <= 1e-11


@named(QUICK)
def test_integral_quantities_at_the_limit_of_rtol(case):
    quantities = ("approach", "total_shear", "stick_radius")
    solution = solve(case.scene, 1e-13, quantities)
    truth = RECORD[case.name]["truth"]
    assert abs(solution.approach / float(truth["approach"]) - 1.0) <= solution.error.approach
    assert abs(solution.total_shear / float(truth["Q"]) - 1.0) <= solution.error.total_shear


@named(FAST)
def test_finite_everywhere(case):
    solution = solved(case)
    distances = np.concatenate([10.0 ** -np.linspace(0.0, 250.0, 500), [0.0]])
    if (
        case.scene.couples
        and case.scene.normal_compliance == 0.0 == case.scene.tangential_compliance
    ):
        distances = distances[:-1]  # the fields oscillate without a limit
    with np.errstate(all="raise"):
        for field in (solution.pressure, solution.traction, solution.slip):
            assert np.isfinite(field(s=distances[1:])).all()
            assert not np.isnan(field(from_edge=distances)).any()
            inside = np.isfinite(field(from_edge=distances))
            assert inside[:-1].all()
    assert all(math.isfinite(value) for value in outputs(solution).values())


@named(QUICK)
def test_one_ulp_moves_the_outputs_by_what_the_problem_asks_for(case):
    before = outputs(solved(case))
    record = RECORD[case.name]["conditioning"]
    for name, change, scene in perturbations(case.scene):
        after = outputs(solve(scene, 1e-12, strict=False))
        for key, moved in shifts(after, before).items():
            # a solve rounds compliances and friction, too
            by = [values.get(key, 0.0) for k, values in record.items() if k != "poisson_ratio"]
            explained = record[name].get(key, 0.0) * change + max([1.0, *by]) * EPS
            # radii are kept as logits of their squares, which are rounded, too
            small = min(before[key], 0.5) if key.startswith("b") else 0.5
            rounded = np.spacing(-math.log(small))
            assert moved <= FACTOR * explained + rounded, (name, key)


@named([case for case in CASES if case.name in ("ordinary", "thin layers", "incompressible")])
def test_over_refinement_spoils_no_digit(case):
    with overrefined(32, 8):
        larger = solve(case.scene, 1e-12, strict=False)
    used = [max(step.unknowns for step in s.work.steps) for s in (larger, solved(case))]
    assert used[0] > 2 * used[1]
    errors = true_errors(larger, RECORD[case.name]["truth"])
    assert max(errors.values()) <= 1e-12


def test_the_estimate_of_the_traction_holds_at_the_centre():
    # by `precise.reference`; under an infinite edge pressure q/s is least accurate there
    true = {2.0**-6: 0.000405737173920463113219, 2.0**-14: 0.00000158450310877503324945}
    solution = solve(Scene(0.1, 0.0, 0.01, np.inf), 1e-12)
    for s, traction in true.items():
        assert abs(solution.traction(s) / traction - 1) <= solution.error.traction


@pytest.mark.parametrize("ulps", [-11, -3, 3, 6, 8])
def test_inputs_an_ulp_apart_have_zones_within_their_estimates(ulps):
    # the zone is as wide as the root of what f is below critical: an ulp makes 1e-4 of it
    [case] = [one for one in CASES if one.name == "nearly critical, inside"]
    friction = case.scene.friction + ulps * math.ulp(case.scene.friction)
    solution = solve(replace(case.scene, friction=friction), 1e-12, strict=False)
    errors = true_errors(solution, RECORD[case.name]["truth"])
    assert len(solution.zones) == 3
    assert errors["zones"] <= solution.error.zones
    assert solution.converged
