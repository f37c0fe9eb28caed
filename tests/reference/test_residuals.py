"""Fields put into the equations with their elliptic kernels, by independent quadrature.

The points are random, from a fixed seed: some uniform in the contact, some crowded to the edge,
some to the zone boundaries. In stick the tangential displacement vanishes, in slip it is the one
reported.
"""

import functools
import math

import numpy as np
import oracles
import pytest

from spectral_contact import Scene, solve

#: What the solver's tolerance of 1e-12 and the quadrature leave of a residual; 1e-15 is typical.
SMALL = 3e-13
KAPPA = (1 - 2 * 0.3) / (4 * (1 - 0.3))  # at nu = 0.3
SCENES = {
    "smooth": Scene(0.3, friction=0.1),
    "moderately rough": Scene(0.1, 0.5, 0.5, 0.1),
    "nearly smooth": Scene(0.3, 1e-3, 1e-3, 0.2),
    "no tangential compliance": Scene(0.0, 0.5, 0.0, 0.1),
    "no normal compliance": Scene(0.0, 0.0, 0.5, 0.05),
    "slip at the edge, beta above alpha": Scene(0.2, 0.2, 0.5, 0.1),
    "interior slip annulus": Scene(0.3, 0.05, 1.0, 0.23 * KAPPA),
    "full stick": Scene(-0.5, 0.1, 0.02, math.inf),
    "all slip": Scene(0.2, 0.3, 0.1, 0.0),
    "very rough": Scene(0.1, 1e3, 10.0, 1e-3),
}
every_scene = pytest.mark.parametrize("name", SCENES)


@functools.cache
def solved(name):
    return solve(SCENES[name], 1e-12)


def layers(scene):
    """Distances from the edge that keep the layers of the fields apart from their bulk."""
    finest = min([x for x in (scene.normal_compliance, scene.tangential_compliance) if x] or [1.0])
    return tuple(d for d in (0.1, 1e-2, 1e-3, 1e-4) if d > finest / 30)


def points(name, kind=None):
    """Random distances from the edge, in the zones of one kind or anywhere."""
    rng = np.random.default_rng(sum(map(ord, name)))
    found = []
    zones = solved(name).zones if kind else ()
    ranges = [(z.outer_from_edge, z.inner_from_edge) for z in zones if z.kind == kind]
    for near, far in ranges or ([] if kind else [(0.0, 1.0)]):
        share = np.concatenate([rng.uniform(0.02, 0.98, 4), 10 ** rng.uniform(-5, -1, 2)])
        found += list(near + (far - near) * share)
        found += list(far - (far - near) * 10 ** rng.uniform(-3, -1, 1))
    return found


@every_scene
def test_converged(name):
    assert solved(name).converged


@every_scene
def test_normal_equation(name):
    solution = solved(name)
    worst = max(
        abs(oracles.normal_residual(solution, d, layers(SCENES[name]))) for d in points(name)
    )
    assert worst <= SMALL


@pytest.mark.parametrize("name", [name for name in SCENES if name != "all slip"])
def test_no_displacement_in_stick(name):
    solution = solved(name)
    depths = points(name, "stick")
    assert depths
    for d in depths:
        misfit, drive = oracles.displacement(solution, d, layers(SCENES[name]))
        assert abs(misfit) <= SMALL * drive
        assert solution.slip(from_edge=d) == 0.0


@pytest.mark.parametrize("name", [name for name in SCENES if name != "full stick"])
def test_displacement_in_slip_is_the_one_reported(name):
    solution = solved(name)
    depths = points(name, "slip")
    assert depths
    for d in depths:
        displacement, drive = oracles.displacement(solution, d, layers(SCENES[name]))
        assert abs(displacement - solution.slip(from_edge=d)) <= SMALL * drive
        assert solution.slip(from_edge=d) < 0.0


@every_scene
def test_traction_in_slip_is_friction_times_pressure(name):
    solution = solved(name)
    for d in points(name, "slip"):
        limit = SCENES[name].friction * solution.pressure(from_edge=d)
        assert solution.traction(from_edge=d) == pytest.approx(limit, rel=1e-14, abs=0)


@every_scene
def test_traction_in_stick_is_within_the_friction(name):
    solution = solved(name)
    for d in points(name, "stick"):
        limit = SCENES[name].friction * solution.pressure(from_edge=d)
        assert abs(solution.traction(from_edge=d)) < limit


def test_the_annulus_scene_has_one():
    kinds = [zone.kind for zone in solved("interior slip annulus").zones]
    assert kinds == ["stick", "slip", "stick"]
