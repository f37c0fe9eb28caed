"""Fits of curves with adhesion: formulas of Johnson, Kendall and Roberts, and `solve`."""

import math
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, fit, profiles, pull_off, solve
from spectral_contact.calibration import IndentationData
from spectral_contact.calibration.adhesive_fits import AdhesiveProblem, BranchLoads

CURVES = Path(__file__).parents[2] / "data" / "curves"
RADIUS, MODULUS, ADHESION, TOUCH = 2.5e-6, 4e3, 5e-5, 3e-8
TIP = profiles.Parabola(RADIUS)
DEPTH = np.linspace(-1e-6, 5e-7, 150)
FREE = ("reduced_modulus", "work_of_adhesion", "zero_point")
TRUTH = (MODULUS, ADHESION, TOUCH)


def jkr(modulus, adhesion, radius):
    """Return approaches and loads of contact radii from that of the largest tension on."""
    first = (9.0 * math.pi * adhesion * radius**2 / (8.0 * modulus)) ** (1.0 / 3.0)
    a = first * np.geomspace(1.0, 20.0, 20_001)
    load = 4.0 / 3.0 * modulus * a**3 / radius - np.sqrt(8.0 * np.pi * adhesion * modulus * a**3)
    return a**2 / radius - np.sqrt(2.0 * np.pi * adhesion * a / modulus), load


def measured(noise=0.0, *, depth=DEPTH, sigma=2e-11):
    """Return a retraction that a soft spring ends at the largest tension."""
    approach, load = jkr(MODULUS, ADHESION, RADIUS)
    loads = np.interp(depth - TOUCH, approach, load)
    loads = np.where(depth - TOUCH >= approach[0], loads, 0.0)
    loads = loads + noise * np.random.default_rng(5).standard_normal(len(depth))
    return IndentationData(depth, loads, sigma)


def start(modulus=3e3, adhesion=2e-5, **given):
    known = {"reduced_modulus": modulus, "work_of_adhesion": adhesion, "profile": TIP, "load": 0.0}
    return Scene.from_physical(**known | given)


def test_loads_are_those_of_the_formulas():
    # in E' = E*/4 and R = 1
    w = 0.2
    approach, load = jkr(4.0, w, 1.0)
    some = slice(1, 15_000, 500)
    found = BranchLoads(profiles.Parabola(1.0), 1e-10).loads(approach[some], 0.0, w)
    assert found.value == pytest.approx(load[some], rel=1e-11)
    assert not found.beyond.any()
    slope = np.gradient(load, approach)[some]
    assert found.by_approach[2:] == pytest.approx(slope[2:], rel=1e-5)


@pytest.mark.parametrize(
    ("profile", "layer", "approaches"),
    [
        (profiles.Parabola(1.0), 0.3, (-0.25, 0.0, 0.5)),
        (profiles.RoundedFlat(0.5, 2.0), 0.0, (-0.2, 0.0, 0.3)),
        (profiles.Cone(1.0), 0.1, (-0.1, 0.2)),
        (profiles.Sphere(1.5), 0.0, (-0.1, 0.3)),
    ],
)
def test_loads_and_derivatives_are_those_of_solve(profile, layer, approaches):
    w, step = 0.2, 1e-3

    def load(approach, layer=layer, adhesion=w):
        scene = Scene(0.3, layer, profile=profile, approach=approach, work_of_adhesion=adhesion)
        return solve(scene, 1e-11, ("load",)).load

    found = BranchLoads(profile, 1e-10).loads(np.array(approaches), layer, w)
    assert found.value == pytest.approx([load(one) for one in approaches], rel=1e-9)
    one = approaches[0]
    factors = math.exp(-step), math.exp(step)
    by_adhesion = [load(one, adhesion=w * factor) for factor in factors]
    assert found.by_adhesion[0] == pytest.approx(np.diff(by_adhesion)[0] / 2.0 / step, rel=1e-5)
    by_approach = [load(one - step / 10.0), load(one + step / 10.0)]
    assert found.by_approach[0] == pytest.approx(np.diff(by_approach)[0] / 0.2 / step, rel=1e-4)
    if layer:
        by_layer = [load(one, layer=layer * factor) for factor in factors]
        assert found.by_layer[0] == pytest.approx(np.diff(by_layer)[0] / 2.0 / step, rel=1e-4)
    else:
        assert found.by_layer[0] == 0.0


def test_beyond_pull_off_the_contact_has_come_off():
    ball = profiles.Parabola(1.0)
    scene = Scene(0.3, profile=ball, load=0.0, work_of_adhesion=0.2)
    last = pull_off(scene, "approach")
    places = last.approach + np.array([-1e-3, -1e-6, 1e-6, 1e-3])
    found = BranchLoads(ball, 1e-10).loads(places, 0.0, 0.2)
    assert found.beyond.tolist() == [True, True, False, False]
    assert np.all(np.diff(found.value[:2]) > 0.0)


@pytest.mark.parametrize("modulus", [1e3, 4e4])
@pytest.mark.parametrize("adhesion", [1e-6, 5e-3])
def test_a_curve_without_noise_is_found_from_afar(modulus, adhesion):
    found = fit(start(modulus, adhesion), measured(), FREE, progress=False)
    assert found.values == pytest.approx(TRUTH, rel=1e-5)
    data = found.scene.physical
    assert data.reduced_modulus == pytest.approx(MODULUS, rel=1e-5)
    assert data.work_of_adhesion == found["work_of_adhesion"]
    assert "have come off" not in str(found)


def test_deviations_cover_the_truth():
    found = fit(start(), measured(2e-11), FREE, progress=False)
    pulls = [
        (found[name] - true) / found.error(name) for name, true in zip(FREE, TRUTH, strict=True)
    ]
    assert 0.01 < max(map(abs, pulls)) < 4.0
    assert 0.5 < found.chi_square / found.degrees_of_freedom < 1.6
    assert "J/m²" in str(found)


def test_a_layer_is_told_apart():
    layer = 5e-10
    scene = start(MODULUS, ADHESION, normal_compliance=layer)
    first = pull_off(scene, "load").physical.approach
    depth = np.linspace(-2e-7, 5e-7, 40)
    loads = [
        solve(scene.replace(load=None, approach=float(one)), 1e-9, ("load",)).physical.load
        if one >= first
        else 0.0
        for one in depth
    ]
    data = IndentationData(depth + TOUCH, loads, 1e-13)
    free = (*FREE, "normal_compliance")
    begin = start(normal_compliance=2e-10)
    found = fit(begin, data, free, rtol=1e-8, progress=False)
    assert found.values == pytest.approx((*TRUTH, layer), rel=1e-3)


def test_rows_in_contact_end_at_the_jump():
    data = measured(2e-11)
    problem = AdhesiveProblem(start(), data, FREE, 1e-8)
    approach, _ = jkr(MODULUS, ADHESION, RADIUS)
    assert problem.touching.tolist() == (approach[0] <= DEPTH - TOUCH).tolist()


def test_without_a_baseline_all_rows_are_in_contact():
    approach, _ = jkr(MODULUS, ADHESION, RADIUS)
    depth = np.linspace(approach[0] + TOUCH + 1e-9, 5e-7, 40)
    data = measured(depth=depth)
    assert AdhesiveProblem(start(), data, FREE, 1e-8).touching.all()
    assert fit(start(), data, FREE, progress=False).values == pytest.approx(TRUTH, rel=1e-5)


def test_a_contact_that_has_come_off_is_said():
    # the modulus and the zero point are held at wrong values
    data = measured(2e-11)
    found = fit(start(2e3, ADHESION), data, ("work_of_adhesion",), progress=False)
    assert any("have come off" in one or "chi square" in one for one in found.remarks)


@pytest.mark.parametrize("part", ["approach", "retraction"])
def test_the_curve_of_an_instrument(part):
    # validation/physics/afm_curve.py: E* = 20 kPa, w = 0.2 mJ/m2, zero at 250 nm, offset 0.3 nN
    data = IndentationData.from_file(
        CURVES / "afm_adhesion.txt", columns="depth=1 [nm], load=2 [nN]", part=part
    )
    begin = start(1e4, 1e-4, profile=profiles.Parabola(5e-6))
    free = (*FREE, "load_offset")
    found = fit(begin, data, free, progress=False)
    for name, true in zip(free, (2e4, 2e-4, 2.5e-7, 3e-10), strict=True):
        assert abs(found[name] - true) < 4.0 * found.error(name)
    assert found.chi_square < 1.3 * found.degrees_of_freedom


def test_what_cannot_be_fitted_is_refused():
    with pytest.raises(SceneError, match="not flat"):
        fit(start(profile=profiles.Flat(1e-6)), measured(), FREE)
    with pytest.raises(SceneError, match="free"):
        fit(start(work_of_adhesion=None, load=1e-9), measured(), FREE)
    with pytest.raises(SceneError, match="from_physical"):
        fit(Scene(0.3, profile=TIP, load=0.0, work_of_adhesion=1.0), measured(), FREE)
    with pytest.raises(SceneError, match="branch = 1: must be 0"):
        fit(start(branch=1), measured(), FREE)
    with pytest.raises(SceneError, match="stays inside the profile"):
        fit(start(profile=profiles.Sphere(2e-7), normal_compliance=1e-9), measured(), FREE)


def test_derivatives_at_a_fold_are_finite():
    ball = profiles.Parabola(1.0)
    scene = Scene(0.3, profile=ball, load=0.0, work_of_adhesion=0.2)
    fold = pull_off(scene, "approach").approach
    found = BranchLoads(ball, 1e-10).loads(np.array([fold, fold, 0.1]), 0.0, 0.2)
    assert np.isfinite([found.value, found.by_approach, found.by_adhesion]).all()


def test_few_rows_before_the_contact_do_not_pull_the_fit():
    """They counted as contact: the work of adhesion was off by twelve standard deviations."""
    modulus, radius, adhesion, count = 2e6, 1e-5, 3e-3, 40
    a = np.linspace(0.3e-6, 4e-6, 4000)
    approach = a**2 / radius - np.sqrt(2.0 * np.pi * adhesion * a / modulus)
    load = 4.0 * modulus * a**3 / (3.0 * radius)
    load -= np.sqrt(8.0 * np.pi * adhesion * modulus) * a**1.5
    off = int(np.argmin(approach))
    depth = np.linspace(2.0 * approach[off], 0.95 * approach[-1], count)
    measured = np.interp(depth, approach[off:], load[off:], left=0.0)
    sigma = 4.6e-8
    measured += np.random.default_rng(5).normal(0.0, sigma, count)
    start = Scene.from_physical(
        reduced_modulus=modulus,
        profile=profiles.Parabola(radius),
        load=1e-9,
        work_of_adhesion=adhesion,
    )
    free = ("reduced_modulus", "work_of_adhesion", "zero_point")
    found = fit(start, IndentationData(depth, measured, sigma), free, rtol=1e-6)
    for name, true in zip(free, (modulus, adhesion, 0.0), strict=True):
        assert abs(found[name] - true) < 4.0 * found.error(name)


def test_a_fit_that_has_come_off_at_a_row_knows_no_deviations():
    """They were those of a line that no contact follows: w was off by eleven of them."""
    ball, zero = profiles.Parabola(1e-5), 2e-7
    quarter = 1e9 / 4.0 / 0.91
    rng = np.random.default_rng(5)
    depth = rng.permutation(np.linspace(zero - 2e-8, zero + 3e-7, 40))
    branch = BranchLoads(ball, 1e-9).loads(depth - zero, 0.0, 0.05 / quarter)
    there = ~branch.beyond
    load = np.concatenate([quarter * branch.value[there], np.zeros(20)])
    depth = np.concatenate([depth[there], np.linspace(zero - 4e-7, zero - 1e-7, 20)])
    sigma = 3e-4 * load.max()
    start = Scene.from_physical(
        youngs_modulus=0.8e9, poisson_ratio=0.3, profile=ball, approach=1e-7, work_of_adhesion=0.03
    )
    free = "reduced_modulus", "work_of_adhesion", "zero_point"
    for _ in range(5):
        noise = rng.standard_normal(len(depth))
    found = fit(start, IndentationData(depth, load + sigma * noise, sigma), free, rtol=1e-6)
    assert abs(found["work_of_adhesion"] / 0.05 - 1.0) > 0.2
    assert any("has come off" in one for one in found.remarks)
    assert np.isnan(found.errors).all()
    assert np.isnan(found.covariance).all()
