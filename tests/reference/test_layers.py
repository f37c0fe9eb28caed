"""Normal contact through nonlinear layers, against what shares no code with the solver.

The oracle solves by collocation in the radius (`oracles.layered_collocation`); Greenwood and
Tripp's numbers are those of docs/theory.
"""

import math

import numpy as np
import pytest
from oracles.layered_collocation import collocated, to_edge

from spectral_contact import NotComputedError, Scene, SceneError, Solution, layers, profiles, solve
from spectral_contact.equations.residuals import load as load_of
from spectral_contact.equations.residuals import tangential_displacement
from spectral_contact.testing import check_solution

BALL = profiles.Parabola(1.0)
E = math.e - 1.0


def abaqus(u):
    x = np.maximum(1.0 + u / 0.2, 0.0)
    return 0.1 / E * x * np.expm1(x)


def abaqus_slope(u):
    x = np.maximum(1.0 + u / 0.2, 0.0)
    return 0.5 / E * (np.expm1(x) + x * np.exp(x))


def calculix(u):
    return 0.1 * 100.0 ** (u / 0.2)


def calculix_slope(u):
    return calculix(u) * math.log(100.0) / 0.2


#: Panels from a half to the edge.
TOWARDS = to_edge(1.0)[1:].tolist()
#: Scene's arguments, and the oracle's: law, slope, height, edges, and what else it takes.
CASES = {
    "power": (
        {"layer": layers.PowerLaw(5.0, 2.0), "profile": BALL, "contact_radius": 1.0},
        (lambda u: 5.0 * np.maximum(u, 0.0) ** 2, lambda u: 10.0 * np.maximum(u, 0.0)),
        (lambda r: r**2 / 2.0, to_edge(1.0)),
        {"start": 0.0},
    ),
    "Abaqus, cone": (
        {
            "layer": layers.Exponential(0.1, 0.2),
            "profile": profiles.Cone(math.atan(2.0)),
            "contact_radius": 1.0,
        },
        (abaqus, abaqus_slope),
        (lambda r: r / 2.0, np.append(0.0, 0.5 * 0.1 ** np.arange(6)[::-1]).tolist() + TOWARDS),
        {"start": -0.2},
    ),
    "CalculiX": (
        {"layer": layers.CalculixExponential(0.1, 0.2), "profile": BALL, "approach": 0.3},
        (calculix, calculix_slope),
        (lambda r: r**2 / 2.0, np.linspace(0.0, 2.0, 9)),
        {"approach": 0.3},
    ),
    "flat": (
        {
            "layer": layers.CalculixExponential(0.1, 0.2),
            "profile": profiles.Flat(1.0),
            "approach": 0.3,
        },
        (calculix, calculix_slope),
        (lambda r: 0.0 * r, to_edge(1.0)),
        {"approach": 0.3},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_collocation_finds_the_same(name):
    given, law, (height, edges), how = CASES[name]
    oracle = collocated(*law, height, edges, **how)
    loose, fine = (solve(Scene(0.3, **given), rtol) for rtol in (1e-5, 1e-11))
    for solution in (loose, fine):
        assert solution.converged
        assert solution.approach == pytest.approx(oracle.approach, rel=1e-11)
        assert solution.load == pytest.approx(oracle.load, rel=1e-11)
    mean = loose.load / (math.pi * loose.domain_radius**2)
    errors = []
    for solution in (loose, fine):
        s = np.minimum(oracle.r / solution.domain_radius, 1.0)
        off = np.abs(solution.pressure(s) - oracle.pressure) / np.maximum(oracle.pressure, mean)
        errors.append(off.max())
    assert errors[0] <= loose.error.pressure
    assert errors[1] <= 5e-10  # the oracle's own, next to the edge


MU, SEPARATION, CENTRE = 24.0425586841, 0.5, 7.705398372318
#: With heights of the deviation 1/2 under a sphere of radius 1 their lengths are ours.
SPHERES = layers.GreenwoodWilliamson(MU / (16.0 / 3.0 * 0.5**1.5), 1.0, 0.5)


def test_greenwood_and_tripp():
    approach = 0.5 * (CENTRE - SEPARATION)
    solution = solve(Scene(0.3, layer=SPHERES, profile=BALL, approach=approach), 1e-11)
    # the separation is known to 5e-13, the load changes thrice as fast
    assert solution.load == pytest.approx(44.168134490717, rel=3e-13)
    assert solution.pressure(0.0) == pytest.approx(4.693194098358, rel=5e-13)
    by_load = solve(Scene(0.3, layer=SPHERES, profile=BALL, load=44.168134490717), 1e-11)
    assert by_load.approach == pytest.approx(approach, rel=3e-12)
    assert by_load.stiffness == pytest.approx(solution.stiffness, rel=1e-11)
    with pytest.raises(NotComputedError, match="no contact edge"):
        solution.contact_radius  # noqa: B018
    assert abs(solution.pressure(1.0)) < solution.error.pressure * solution.pressure(0.0)


def test_greenwood_and_tripp_by_their_separation():
    solution = solve(Scene(0.3, layer=SPHERES, profile=BALL, separation=0.5 * SEPARATION), 1e-11)
    assert solution.converged
    assert solution.load == pytest.approx(44.168134490717, rel=2e-13)
    assert solution.approach == pytest.approx(0.5 * (CENTRE - SEPARATION), rel=2e-13)
    assert -SPHERES.overclosure(solution.pressure(0.0)) == pytest.approx(0.25, abs=1e-13)
    assert 0.0 < solution.error.approach < 1e-11


@pytest.mark.parametrize("profile", [BALL, profiles.Cone(1.2), profiles.Flat(1.0)])
@pytest.mark.parametrize("separation", [-0.3, 0.0, 0.7])
def test_a_separation_and_its_approach_are_one_contact(profile, separation):
    layer = layers.CalculixExponential(0.1, 1.0)
    scene = Scene(0.3, layer=layer, profile=profile, separation=separation)
    solution = solve(scene, 1e-9)
    same = solve(scene.replace(separation=None, approach=solution.approach), 1e-11)
    for name in ("load", "indentation_work", "stiffness"):
        off = abs(getattr(solution, name) / getattr(same, name) - 1.0)
        assert off <= getattr(solution.error, name) + getattr(same.error, name)
    reached = -layer.overclosure(same.pressure(0.0))
    # the logarithm of the pressure changes so much with the overclosure
    off = abs(reached - separation) * math.log(100.0)
    assert off <= solution.error.pressure + same.error.pressure
    assert check_solution(solution, scene, 1e-8).passed


@pytest.mark.parametrize("alpha", [10.0, 0.5, 1e-3, 1e-8])
@pytest.mark.parametrize(
    "law",
    [
        layers.Linear,
        lambda alpha: layers.PowerLaw(1.0 / alpha, 1.0),
        lambda alpha: layers.Table(tuple(alpha * p for p in (0, 1, 2, 8)), (0.0, 1.0, 2.0, 8.0)),
    ],
    ids=["linear", "power", "table"],
)
def test_a_linear_law_is_the_linear_layer(law, alpha):
    for given in ({"contact_radius": 1.0}, {"load": 0.7}, {"approach": 0.6}):
        linear = solve(Scene(0.3, alpha, profile=BALL, **given), 1e-12)
        solution = solve(Scene(0.3, layer=law(alpha), profile=BALL, **given), 1e-12)
        for name in ("contact_radius", "load", "approach", "stiffness", "indentation_work"):
            assert getattr(solution, name) == pytest.approx(getattr(linear, name), rel=1e-13)
        y = np.geomspace(1e-12, 1.0, 40)
        p, known = solution.pressure(from_edge=y), linear.pressure(from_edge=y)
        mean = linear.load / (math.pi * linear.contact_radius**2)
        assert (np.abs(p - known) / np.maximum(known, mean)).max() < 1e-12


def test_a_flat_punch_on_a_linear_law_is_the_flat_punch():
    load, a = 3.0, 2.0
    known = solve(Scene(0.3, 0.25), 1e-12)
    scene = Scene(0.3, layer=layers.Linear(0.5), profile=profiles.Flat(a), load=load)
    solution = solve(scene, 1e-12)
    assert solution.approach == pytest.approx(known.approach * load / a, rel=1e-13)
    assert solution.pressure(from_edge=0.0) == pytest.approx(
        known.pressure(from_edge=0.0) * load / a**2, rel=1e-12
    )
    assert solution.stiffness == pytest.approx(load / solution.approach, rel=1e-12)


#: What differences of the fourth order leave.
WITHIN = 1e-7
#: Edge, flat and endless.
WORKING = {
    "Abaqus": (layers.Exponential(0.1, 0.2), BALL, 0.2),
    "power on a flat": (layers.PowerLaw(3.0, 3.0), profiles.Flat(1.5), 0.4),
    "rough spheres": (SPHERES, BALL, 0.3),
    "exponential heights": (
        layers.GreenwoodWilliamson(30.0, 1.0, 0.1, "exponential"),
        profiles.RoundedFlat(0.5, 1.0),
        -0.1,
    ),
}


@pytest.mark.parametrize("name", WORKING)
def test_work_stiffness_and_load_are_derivatives_of_each_other(name):
    layer, profile, middle = WORKING[name]
    step = 4e-3
    wanted = ("load", "stiffness", "indentation_work")
    at = [
        solve(Scene(0.3, layer=layer, profile=profile, approach=middle + k * step), 1e-9, wanted)
        for k in (-2, -1, 0, 1, 2)
    ]
    weights = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * step)
    work, load = (np.array([getattr(one, n) for one in at]) for n in ("indentation_work", "load"))
    assert weights @ work == pytest.approx(at[2].load, rel=WITHIN)
    assert weights @ load == pytest.approx(at[2].stiffness, rel=WITHIN)


def test_a_thin_layer_of_asperities_tends_to_hertz():
    hertz = 4.0 / 3.0 * 4.0  # of E', radius and contact radius 1
    off = []
    for deviation in (1e-2, 1e-3, 1e-4):
        layer = layers.GreenwoodWilliamson(1.0 / deviation**2, deviation, deviation)
        solution = solve(Scene(0.3, layer=layer, profile=BALL, approach=1.0), 1e-6)
        off.append(abs(solution.load / hertz - 1.0))
    # heights add to the approach
    assert off[0] < 0.05
    assert off[1] < 0.2 * off[0]
    assert off[2] < 0.2 * off[1]


def test_a_stiff_power_law_is_a_rigid_gap():
    """As the coefficient grows all is as if the surfaces were smooth."""
    smooth = solve(Scene(0.3, profile=BALL, contact_radius=1.0), 1e-10)
    stiff = Scene(0.3, layer=layers.PowerLaw(1e16, 2.0), profile=BALL, contact_radius=1.0)
    off = solve(stiff, 1e-10).load / smooth.load - 1.0
    assert -1e-5 < off < 0.0


def test_a_steep_power_law_is_a_gap_that_closes():
    """As the exponent grows the overclosure is 1 wherever there is pressure, to 1/m."""
    smooth = solve(Scene(0.3, profile=BALL, load=5.0), 1e-10)
    off = []
    for exponent in (2.5, 5.0, 10.0):
        layer = layers.PowerLaw(1.0, exponent)
        steep = solve(Scene(0.3, layer=layer, profile=BALL, load=5.0), 1e-10, ("approach",))
        off.append(abs(steep.approach - smooth.approach - 1.0))
    assert off[1] < 0.45 * off[0]
    assert off[2] < 0.45 * off[1]
    assert off[2] < 0.02


def test_beyond_the_end_of_a_table_is_an_error():
    table = layers.Table((0.0, 0.02, 0.04, 0.06), (0.0, 0.1, 0.3, 0.6))
    for given in ({"load": 5.0}, {"approach": 2.0}, {"contact_radius": 1.5}):
        with pytest.raises(SceneError, match="end of the law") as caught:
            solve(Scene(0.3, layer=table, profile=BALL, **given), 1e-6)
        assert caught.value.parameter == next(iter(given))


def test_a_profile_that_ends_before_the_pressure_is_an_error():
    layer = layers.CalculixExponential(0.1, 2.0)
    with pytest.raises(SceneError, match="ends"):
        solve(Scene(0.3, layer=layer, profile=profiles.Sphere(1.0), load=1.0), 1e-6)


@pytest.mark.parametrize("suffix", [".json", ".npz"])
def test_solutions_are_saved_with_their_domain(tmp_path, suffix):
    solution = solve(Scene(0.3, layer=SPHERES, profile=BALL, approach=0.5), 1e-4)
    solution.save(tmp_path / f"a{suffix}")
    loaded = Solution.load(tmp_path / f"a{suffix}")
    assert loaded == solution
    assert loaded.domain_radius == solution.domain_radius


#: Greenwood and Tripp's mu, approaches with the separation at the centre, in deviations.
CORNERS = [(1e-3, -1.4995, 3.0), (1e-3, 0.5, -1.0), (1e3, 1.0, 2.2255), (1e3, 3e5, -1.0)]


@pytest.mark.parametrize(("mu", "approach", "separation"), CORNERS)
def test_rough_spheres_have_twelve_digits_at_the_corners(mu, approach, separation):
    """From a layer that hardly bends the body to one that is a millionth of the approach."""
    layer = layers.GreenwoodWilliamson(mu / (16.0 / 3.0 * 0.5**1.5), 1.0, 0.5)
    solution = solve(Scene(0.3, layer=layer, profile=BALL, approach=approach), 1e-12)
    assert solution.converged
    centre = solution.pressure(0.0)
    assert -layer.overclosure(centre) / 0.5 == pytest.approx(separation, abs=0.05)
    by_load = solve(Scene(0.3, layer=layer, profile=BALL, load=solution.load), 1e-12)
    assert by_load.converged
    assert by_load.approach == pytest.approx(approach, rel=1e-12)
    room = solution.error.pressure + by_load.error.pressure
    assert by_load.pressure(0.0) == pytest.approx(centre, rel=room)


@pytest.mark.parametrize("exponent", [1.003, 1.1, 1.5])
def test_the_stiffness_knows_what_the_edge_leaves_of_it(exponent):
    """Next to the edge the slope of these laws is a small power, which few points integrate."""
    layer = layers.PowerLaw(6.8, exponent)
    scene = Scene(0.3, layer=layer, profile=BALL, contact_radius=0.556)
    best = solve(scene, 1e-12)  # with the pressure there are panels down to 1e-14
    for rtol in (1e-8, 1e-10, 3e-11):
        solution = solve(scene, rtol, ("load", "stiffness"))
        assert solution.converged
        off = abs(solution.stiffness / best.stiffness - 1.0)
        assert off <= solution.error.stiffness + best.error.stiffness


def test_the_tip_of_a_cone_knows_what_its_tail_leaves():
    """A cone on an endless law: the pressure is linear in s next to the tip."""
    layer = layers.CalculixExponential(11.1, 0.118)
    scene = Scene(0.3, layer=layer, profile=profiles.Cone(1.22), approach=0.41)
    best, loose = solve(scene, 1e-10), solve(scene, 7e-5)
    s = np.array([0.0, 1e-9, 1e-7, 1e-5, 1e-3])
    off = np.abs(loose.pressure(s) / best.pressure(s) - 1.0).max()
    assert loose.converged
    assert off <= loose.error.pressure + best.error.pressure


@pytest.mark.parametrize("given", [{"load": 3.0}, {"approach": 0.4}])
@pytest.mark.parametrize("beta", [0.0, 0.3])
def test_full_stick_on_a_linear_law_is_that_of_the_flat_punch(beta, given):
    alpha, a = 0.5, 2.0
    known = solve(Scene(0.3, alpha / a, beta / a, math.inf), 1e-12)
    how = {"profile": profiles.Flat(a), "friction": math.inf, "tangential_compliance": beta}
    solution = solve(Scene(0.3, layer=layers.Linear(alpha), **how, **given), 1e-11)
    assert solution.converged
    assert solution.stick_radius == 1.0
    load = solution.load
    assert solution.total_shear == pytest.approx(known.total_shear * load, rel=1e-13)
    y = np.geomspace(1e-10, 0.99, 30)
    found, expected = solution.traction(from_edge=y), known.traction(from_edge=y)
    assert found == pytest.approx(expected * load / a**2, rel=1e-12)


@pytest.mark.parametrize("beta", [0.0, 0.1])
@pytest.mark.parametrize("approach", [0.05, 1.0])
def test_full_stick_satisfies_its_equation_with_elliptic_kernels(beta, approach):
    """``beta q + T q = kappa g``, under a pressure that the law bends."""
    a = 2.0
    how = {"profile": profiles.Flat(a), "friction": math.inf, "tangential_compliance": beta}
    scene = Scene(0.2, layer=layers.Exponential(0.1, 0.2), approach=approach, **how)
    solution = solve(scene, 1e-11)

    def q(d):
        return solution.traction(from_edge=d)

    def p(d):
        return solution.pressure(from_edge=d)

    for d in (0.9, 0.4, 0.02):
        outward, inward = tangential_displacement(q, p, scene.kappa, d)
        assert beta / a * q(d) + outward == pytest.approx(inward, rel=1e-9)
    assert solution.total_shear == pytest.approx(2.0 * math.pi * a**2 * load_of(q), rel=1e-9)


def test_half_the_digits_of_full_stick_are_right():
    how = {"profile": profiles.Flat(1.0), "friction": math.inf, "tangential_compliance": 0.02}
    scene = Scene(0.0, layer=layers.PowerLaw(300.0, 3.0), load=2.0, **how)
    fine, loose = solve(scene, 1e-11), solve(scene, 1e-4)
    y = np.geomspace(1e-10, 0.99, 60)
    off = loose.traction(from_edge=y) / fine.traction(from_edge=y) - 1.0
    assert np.abs(off).max() <= loose.error.traction <= 1e-4
    shear = loose.total_shear / fine.total_shear - 1.0
    assert abs(shear) <= loose.error.total_shear <= 1e-4
