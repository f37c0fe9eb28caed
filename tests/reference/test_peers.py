"""The methods that this library is compared with: each converges to gold at its own order."""

import math
from itertools import pairwise
from pathlib import Path

import chebyshev
import compare
import elements
import fem
import fft
import linear
import numpy as np
import nystrom
import pytest
import rings
from scipy import special

from spectral_contact import MissingDependencyError, Scene, SceneError
from spectral_contact.equations.kernels import normal_kernel, tangential_kernel
from spectral_contact.equations.residuals import tangential_displacement
from spectral_contact.studies import OwnSolver, convergence, load, truth_of

#: Version 0.2 has the numbers of 0.1 in other modules.
SAME_NUMBERS = ("0.1.0", "0.2.0")

RESULTS = Path(__file__).parents[2] / "validation" / "results"
NORMAL, THIN = Scene(0.1, 0.5), Scene(0.2, 1e-4)
STICK, SLIP = Scene(0.1, 0.5, 0.5, math.inf), Scene(0.1, 0.5, 0.5, 0.1)
DISKS = {
    "rings": rings.Rings(40, 1.0),
    "uniform": linear.Linear(40, 1.0),
    "graded": linear.Linear(40, 4.0),
    "nystrom": nystrom.Panels(12),
    "chebyshev": chebyshev.Polynomial(24),
}


@pytest.mark.parametrize("own", [True, False])
def test_the_fast_kernels_are_those_of_the_library(own):
    random = np.random.default_rng(1)
    s = np.append(random.random(500), [0.5, 1e-9, 1e-3])
    eta = np.append(random.random(500), [0.5 + 1e-12, 0.7, 1e-3 * math.sqrt(elements.SMALL)])
    fast, true = (
        (elements.normal, normal_kernel) if own else (elements.tangential, tangential_kernel)
    )
    source, target = elements.Places(eta, 1.0 - eta), elements.Places(s, 1.0 - s)
    assert fast(source, target) == pytest.approx(true(eta, s, distance=np.abs(eta - s)), rel=5e-5)
    assert fast(source, target)[:500] == pytest.approx(true(eta, s)[:500], rel=1e-12)


@pytest.mark.parametrize("name", DISKS)
def test_the_normal_matrices_integrate_a_constant(name):
    """The integral of K1 over the disk is E(s)."""
    disk = DISKS[name]
    s = disk.nodes.s
    rough = 1e-5 if name in ("rings", "uniform", "graded") else 1e-10
    bulk = s > 0.1  # the panel at the centre has low order, and no area
    values = disk.normal @ np.ones(len(s))
    assert values[bulk] == pytest.approx(special.ellipe(s[bulk] ** 2) / np.pi, rel=rough)
    assert values == pytest.approx(special.ellipe(s**2) / np.pi, rel=1e-5)


@pytest.mark.parametrize("name", DISKS)
def test_the_tangential_matrices_integrate_a_straight_line(name):
    disk = DISKS[name]
    s = disk.nodes.s
    values = disk.tangential @ s
    for place in (0.3, 0.6):
        i = int(np.argmin(np.abs(s - place)))
        true, _ = tangential_displacement(lambda d: 1.0 - d, np.zeros_like, 0.0, 1.0 - s[i])
        assert values[i] == pytest.approx(true, rel=2e-4 if name == "rings" else 1e-6)


@pytest.mark.parametrize("name", DISKS)
def test_moments_are_integrals(name):
    disk, y = DISKS[name], np.array([1.0, 0.8, 0.3, 1e-3, 0.0])
    ones = np.ones(len(disk.nodes.s))
    assert disk.moment(ones, y) == pytest.approx((1.0 - y) ** 2 / 2.0, abs=1e-14)
    assert disk.at(ones, y) == pytest.approx(1.0, rel=1e-13)
    if name != "rings":
        assert disk.moment(disk.nodes.s, y) == pytest.approx((1.0 - y) ** 3 / 3.0, abs=1e-14)


@pytest.mark.parametrize(
    ("solver", "scene", "resolutions", "orders"),
    [
        (rings.uniform, NORMAL, (25, 50, 100, 200), {"approach": 1.9, "edge_pressure": 1.0}),
        (rings.graded, NORMAL, (25, 50, 100, 200), {"approach": 2.0, "edge_pressure": 2.0}),
        (rings.uniform, STICK, (25, 50, 100, 200), {"total_shear": 2.0}),
        (linear.uniform, NORMAL, (25, 50, 100, 200), {"approach": 1.8, "edge_pressure": 1.8}),
        (linear.graded, NORMAL, (25, 50, 100, 200), {"approach": 2.0, "edge_pressure": 2.0}),
        (linear.graded, THIN, (25, 50, 100, 200), {"edge_pressure": 2.0}),
        (linear.graded, STICK, (25, 50, 100, 200), {"total_shear": 2.0, "traction": 2.0}),
        (linear.graded, SLIP, (25, 50, 100, 200), {"total_shear": 2.0, "stick_radius": 2.0}),
        (chebyshev.solver, NORMAL, (8, 16, 32, 64), {"approach": 4.2, "edge_pressure": 4.0}),
        (chebyshev.solver, STICK, (16, 32, 64), {"total_shear": 3.5}),
    ],
)
def test_the_order_is_that_of_the_method(solver, scene, resolutions, orders):
    study = convergence(solver, scene, resolutions, quantities=list(orders), repeats=0)
    assert [point.failure for point in study.points] == [""] * len(resolutions)
    for name, order in orders.items():
        rate = study.rate(name)
        assert rate.kind == "algebraic" or "algebraic" in rate.rivals
        first, last = (study.points[i] for i in (0, -1))
        seen = math.log(first.errors[name] / last.errors[name]) / math.log(
            last.resolution / first.resolution
        )
        assert seen == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("scene", [NORMAL, STICK, SLIP])
def test_graded_panels_converge_faster_than_any_power(scene):
    true = truth_of(scene)
    scalars = [name for name in true.scalars if name != "pressure"]
    found = [max(true.errors(nystrom.solver(scene, n), scalars).values()) for n in (4, 8, 12, 16)]
    assert found[0] < 1e-4
    assert [math.log10(a / b) > 1.5 for a, b in pairwise(found)] == [True] * 3
    assert found[-1] < 1e-11


def test_slip_where_friction_is_not_enough_and_stick_where_it_is():
    traction = linear.graded(SLIP, 100)
    c = traction.stick_radius
    y = np.array([1.0 - 0.5 * c, 1.0 - 1.001 * c, 0.01])
    inside, *outside = traction.traction(from_edge=y) / traction.pressure(from_edge=y)
    assert inside < 0.09
    assert outside == pytest.approx([0.1, 0.1], rel=1e-12)


@pytest.mark.parametrize(("module", "package"), [(fft, "tamaas"), (fem, "skfem")])
def test_a_missing_package_is_named(module, package, monkeypatch):
    monkeypatch.setattr(module, package, None)
    with pytest.raises(MissingDependencyError, match=r"\.\[peers\]"):
        module.solver(NORMAL, 4)


def test_pixels_converge():
    pytest.importorskip("tamaas", reason="part of the extra: peers")
    true = truth_of(NORMAL)
    coarse, fine = (
        true.errors(fft.solver(NORMAL, n), ["approach", "edge_pressure"]) for n in (16, 64)
    )
    assert fine["approach"] < 1e-4 < coarse["approach"] < 1e-3
    assert fine["edge_pressure"] < 1e-2 < coarse["edge_pressure"] < 5e-2


@pytest.mark.parametrize("scene", [NORMAL, STICK])
def test_finite_elements_converge_at_order_four(scene):
    pytest.importorskip("skfem", reason="part of the extra: peers")
    names = ["approach"] if scene is NORMAL else ["approach", "total_shear"]
    study = convergence(fem.solver, scene, (4, 6, 9), quantities=names, repeats=0)
    for name in names:
        coarse, _, fine = (point.errors[name] for point in study.points)
        assert math.log(coarse / fine) / math.log(9 / 4) == pytest.approx(4.0, abs=0.5)


def test_finite_elements_refuse_slip():
    with pytest.raises(SceneError, match="no slip"):
        fem.solver(SLIP, 4)


@pytest.mark.parametrize("name", compare.PROBLEMS)
def test_results_that_documentation_shows_are_fresh(name):
    problem = compare.PROBLEMS[name]
    study = load(RESULTS / f"peers_{name}.json")
    assert study.machine["library"] in SAME_NUMBERS
    assert study.solvers == (OwnSolver().name, *problem.peers)
    assert study.scenes == problem.scenes
    assert set(study.quantities) == set(problem.quantities)
    assert [point.failure for point in study.points if point.failure] == []
    assert all(point.times.cold is not None for point in study.points)
    for peer in problem.peers:
        solver, resolutions = compare.PEERS[peer]
        for scene in problem.scenes:
            points = study.of(peer, scene)
            assert [p.resolution for p in points] == list(resolutions[: len(points)])
            if peer not in compare.PACKAGES:
                again = truth_of(scene).errors(solver(scene, resolutions[0]), study.quantities)
                assert again == pytest.approx(points[0].errors, rel=1e-6, abs=1e-13)
    head, _, body = compare.tables(study, "").partition("\n\n")
    shown = (RESULTS / f"peers_{name}.md").read_text(encoding="utf-8")
    assert shown.startswith(head.partition(";")[0])
    assert shown.partition("\n\n")[2] == body
    assert (RESULTS / f"peers_{name}.png").stat().st_size > 10_000
