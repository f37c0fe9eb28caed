"""The solver of any number of digits: closed forms, the elliptic equations, and the double one.

The oracles share no code with it: mpmath's own root finding, quadrature and elliptic integrals.
"""

import functools
import itertools
import math
from itertools import pairwise
from unittest import mock

import mpmath
import numpy as np
import pytest
from mpmath.ctx_mp import MPContext

from spectral_contact import NotComputedError, Scene, SceneError, gold, solve
from spectral_contact.closed_forms import (
    coupled_pressure,
    coupled_traction,
    partial_slip_traction,
)
from spectral_contact.fields.series import Radius
from spectral_contact.precise import certified, reference
from spectral_contact.precise.precise_coupled_run import PreciseCoupledRun
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.search import lawful
from spectral_contact.precise.zone_trial import PreciseLayout

DIGITS = 15
NU = 0.3
#: Scenes of the gold tables, which have more digits: they are solved on one mesh, and compared.
GOLD = {
    "slip inside": "nu=0.3 alpha=0.05 beta=1 f=0.0328571429",
    "rough": "nu=0.1 alpha=0.5 beta=0.5 f=0.1",
    "slip inside, no normal compliance": "nu=0.1 alpha=0 beta=0.5 f=0.0888888889",
    "no tangential compliance": "nu=0.1 alpha=0.5 beta=0 f=inf",
    "no normal compliance": "nu=0.3 alpha=0 beta=0.5 f=inf",
    "slip at a rim of no compliance": "nu=0.3 alpha=0.5 beta=0 f=0.142857143",
    "small stick disk": "nu=0.3 alpha=0.5 beta=0.5 f=0.00142857143",
}
TABLES = {one.name: one for table in gold.tables() for one in table.solutions}
#: In this order the tests of one scene follow each other, and it is solved once: `scenes`.
SCENES = {
    **{name: TABLES[GOLD[name]].scene for name in ("slip inside", "rough")},
    "full stick": Scene(NU, 1e-3, 1.0, math.inf),
    "coupled": Scene(0.1, 0.2, 0.5, math.inf, coupling=True),
    **{name: TABLES[known].scene for name, known in list(GOLD.items())[2:]},
    "frictionless": Scene(0.2, 1e-6),
}


def scenes(count):
    """The first so many of them, one after the other for all tests."""
    return pytest.mark.parametrize("name", list(SCENES)[:count], scope="module")


every_scene = scenes(len(SCENES))


def context(digits=40):
    mp = MPContext()
    mp.dps = digits
    return mp


@functools.cache
def solved(name):
    if name not in GOLD:
        return reference(SCENES[name], DIGITS)
    # the mesh that checks is left out: the tables do that
    runs = []

    def first(*arguments):
        runs.append(lawful(*arguments))
        return runs[0]

    with mock.patch.multiple(certified, lawful=first, solved=lambda *_: runs[0]):
        return reference(SCENES[name], DIGITS)


@functools.cache
def tanh_sinh(digits):
    """Nodes of [0, 1] and weights, for functions with roots and logarithms at the ends."""
    mp = context(digits)
    nodes, weights = [], []
    for k in range(-42, 43):
        t = mp.mpf(k) / 12
        u = mp.pi / 2 * mp.sinh(t)
        nodes.append(1 / (1 + mp.exp(-2 * u)))
        weights.append(mp.pi / 4 * mp.cosh(t) / mp.cosh(u) ** 2 / 12)
    return np.array(nodes), np.array(weights)


def integral(function, breaks, digits=30):
    """Integrate a function of arrays, piece by piece; a field takes all nodes at once."""
    nodes, weights = tanh_sinh(digits)
    return sum((b - a) * (function(a + (b - a) * nodes) @ weights) for a, b in pairwise(breaks))


def one_disk(scene, digits):
    """Return the solution on one mesh, whose zones are those of the double one."""
    [boundary] = solve(scene, 1e-9).zones[:-1]
    layout = PreciseLayout((0, 1), (Radius(boundary.outer, boundary.outer_from_edge),))
    return PreciseRun(scene, digits, 2.0, layout)


def error_of(estimate, value, truth):
    """The error may not exceed its estimate, which may not exceed the digits asked for."""
    assert estimate <= 10.0**-DIGITS
    return abs(value / truth - 1) <= estimate


@every_scene
def test_converged(name):
    assert solved(name).converged


@pytest.mark.parametrize("name", GOLD, scope="module")
def test_one_mesh_has_the_digits_of_the_tables(name):
    mine, its = solved(name), TABLES[GOLD[name]]
    for quantity in ("approach", "total_shear", "stick_radius"):
        true = getattr(its, quantity)
        assert abs(getattr(mine, quantity) / true - 1) <= 10.0**-DIGITS
    for one, other in zip(mine.zones, its.zones, strict=True):
        assert one.kind == other.kind
        assert abs(one.inner_from_edge - other.inner_from_edge) <= 10.0**-DIGITS * other.outer
    for point in its.points:
        for field in ("pressure", "traction"):
            value, true = getattr(mine, field)(from_edge=point.from_edge), getattr(point, field)
            assert value == true or abs(value / true - 1) <= 10.0**-DIGITS


@every_scene
def test_the_double_solver_agrees_within_its_estimates(name):
    precise, double = solved(name), solve(SCENES[name], 1e-12)
    estimate = double.error
    assert abs(double.approach / precise.approach - 1) <= estimate.approach
    depths = [*np.linspace(0.03, 0.97, 12), *10.0 ** -np.arange(1.0, 13.0)]
    places = {"from_edge": depths}, {"s": 10.0 ** -np.array([1.0, 4.0, 8.0, 16.0, 30.0, 300.0])}
    for field, place in itertools.product(("pressure", "traction"), places):
        mine = np.array(getattr(double, field)(**place))
        true = np.array(getattr(precise, field)(**place), dtype=float)
        bound = getattr(estimate, field) or 0.0
        assert np.all(np.abs(mine - true) <= bound * np.abs(true) + 4e-16 * np.abs(true))
    if precise.stick_radius is not None:
        shear = abs(double.total_shear / precise.total_shear - 1)
        assert shear <= estimate.total_shear
        assert abs(double.stick_radius - precise.stick_radius) <= estimate.stick_radius
        assert [z.kind for z in double.zones] == [z.kind for z in precise.zones]
        for mine, its in zip(double.zones[:-1], precise.zones, strict=False):
            for side in ("outer", "outer_from_edge"):
                assert abs(getattr(mine, side) / getattr(its, side) - 1) <= estimate.zones


def test_smooth_full_stick_keeps_its_digits_next_to_the_centre():
    stuck = reference(Scene(NU, 0.0, 0.0, math.inf), DIGITS)
    s = 10.0 ** -np.array([5.0, 8.0, 16.0, 300.0])
    kappa = (1 - 2 * context().mpf(NU)) / (4 * (1 - context().mpf(NU)))
    for radius, found in zip(s, stuck.traction(s), strict=True):
        square = context().mpf(radius) ** 2
        exact = kappa / context().pi ** 2 * radius * (1 + square)
        assert abs(found / exact - 1) <= 10.0**-DIGITS


def test_rounding_of_the_double_traction_at_the_centre():
    """Under little compliance q/s at the centre amplifies rounding more than at other places."""
    compliances = 0.03215515306384673, 0.0016621839283741788
    scene = Scene(0.46381748205713325, *compliances, 0.26515145909815147)
    solution, run = solve(scene, 1e-12), one_disk(scene, 14)
    s = np.array([run.fixed.mp.mpf(v) for v in (4e-4, 1e-3, 2.3e-3, 3.4e-3)])
    true = run.tractions(s, 1 - s).astype(float)
    found = solution.traction(s.astype(float))
    # a shift of the rim moves all of it
    estimate = solution.error.traction + solution.error.stick_radius
    assert np.abs(found / true - 1.0).max() <= estimate <= 1e-12


def test_smooth_partial_slip_is_the_closed_form():
    mp = context()
    friction = 0.25
    precise = reference(Scene(NU, 0.0, 0.0, friction), DIGITS)
    kappa = (1 - 2 * mp.mpf(NU)) / (4 * (1 - mp.mpf(NU)))
    ratio = friction / kappa

    def balance(c):
        return mp.log((1 + c) / (1 - c)) / (2 * c) - ratio / 2 * mp.ellipk(1 - c * c)

    c = mp.findroot(balance, (0.85, 0.9))
    assert error_of(precise.error.stick_radius, precise.stick_radius, c)
    shear = friction * mp.ellipe(1 - c * c) + kappa * mp.log(1 - c * c)
    assert error_of(precise.error.total_shear, precise.total_shear, shear)
    assert precise.approach == 0.125


def test_traction_in_a_small_stick_disk():
    friction = 2 * Scene(NU).kappa / math.log(4e9)  # c = 1e-9, whose square is 1e-18 of the rest
    run = one_disk(Scene(NU, 0.0, 0.0, friction), 15)
    c = float(run.radius[0])
    s = np.array([run.fixed.mp.mpf(share * c) for share in (0.25, 0.75, 1.5)])
    exact = partial_slip_traction(NU, friction, s.astype(float))
    found = run.tractions(s, 1 - s).astype(float)
    assert np.abs(found / exact - 1.0).max() <= 1e-12


def test_full_stick_on_smooth_surfaces():
    precise = reference(Scene(NU, friction=math.inf), DIGITS)
    mp = context()
    kappa = (1 - 2 * mp.mpf(NU)) / (4 * (1 - mp.mpf(NU)))
    s = mp.mpf(1) / 3
    exact = -kappa / mp.pi**2 * mp.log(1 - s * s) / (s * mp.sqrt(1 - s * s))
    assert abs(precise.traction(s) / exact - 1) <= 10.0 ** -(DIGITS + 1)
    assert abs(precise.total_shear / (2 * kappa * mp.ln2) - 1) <= 10.0**-DIGITS
    assert precise.traction(0) == 0
    assert precise.traction(1) == precise.edge_ratio == mp.inf
    assert precise.pressure(from_edge=0) == mp.inf


def test_values_and_slope_of_the_approach():
    # 2 pi alpha p(1)^2 = delta + alpha d(delta)/d(alpha)
    precise, mp = solved("frictionless"), context()
    alpha, step = precise.scene.normal_compliance, 2.0**-36
    above, below = (
        PreciseRun(Scene(NU, alpha + h), DIGITS, 2.0, None).approach for h in (step, -step)
    )
    slope = (above - below) / (2 * step)
    left = 2 * mp.pi * alpha * precise.pressure(1) ** 2
    assert abs(left / (precise.approach + alpha * slope) - 1) <= 1e-9


@scenes(4)
def test_elliptic_equations_hold(name):
    precise, scene, mp = solved(name), SCENES[name], context(30)
    zone = len(precise.zones) - 1 if len(precise.zones) > 2 else 0
    bounds = [z.outer for z in precise.zones]
    start, end = precise.zones[zone].inner, bounds[zone]
    s = start + (end - start) * mp.mpf("0.7130412")

    def kernels(eta, distance):
        low, high = min(eta, s), max(eta, s)
        complement = distance * (eta + s) / high**2
        first = eta / high * mp.pi / 2 / mp.agm(1, mp.sqrt(complement))
        return first, eta * low / (3 * high**2) * mp.elliprd(0, complement, 1)

    def both(eta, distance):
        """The normal displacement, and the radial one as imaginary part."""
        normal, tangential = np.frompyfunc(kernels, 2, 2)(eta, distance)
        eta = np.minimum(eta, 1)  # nodes are rounded, and may be beyond the edge
        return precise.pressure(eta) * normal + 1j * precise.traction(eta) * tangential

    def near(v, sign):  # eta = s +- v^2 keeps the distance, and blunts the logarithm
        return 2 * v * both(np.maximum(s + sign * v * v, 0), v * v)

    middle = (s + end) / 2
    edges = [1 - mp.mpf(10) ** -k for k in (1, 2, 3, 4, 6)]
    breaks = sorted({middle, *(b for b in (*bounds, *edges) if b > middle)})
    inward = [mp.sqrt(s - b) for b in [*bounds[:zone][::-1], 0]]
    moved = integral(lambda v: near(v, -1), [0, *inward])
    moved += integral(lambda eta: both(eta, eta - s), breaks)
    moved += integral(lambda v: near(v, 1), [0, mp.sqrt(middle - s)])
    kappa = (1 - 2 * mp.mpf(scene.poisson_ratio)) / (4 * (1 - mp.mpf(scene.poisson_ratio)))
    sink = scene.normal_compliance * precise.pressure(s) + moved.real / mp.pi
    if scene.couples:
        sink -= kappa * integral(lambda eta: precise.traction(np.minimum(eta, 1)), [s, *breaks])
    assert abs(sink / precise.approach - 1) <= 10.0 ** -(DIGITS + 1)
    load = integral(lambda eta: precise.pressure(eta) * eta, [0, *bounds[:zone], s])
    outward = scene.tangential_compliance * precise.traction(s) + moved.imag / mp.pi
    assert abs(outward / (kappa * load / s) - 1) <= 10.0 ** -(DIGITS + 1)


@scenes(5)
def test_tractions_are_continuous_at_the_boundaries(name):
    precise, mp = solved(name), context()
    friction = mp.mpf(SCENES[name].friction)
    assert len(precise.zones) == (3 if "slip inside" in name else 2 if name == "rough" else 1)
    for zone in precise.zones[:-1]:
        for sense in (-1, 1):  # a distance that q varies over by less than the error
            from_edge = zone.outer_from_edge * (1 + sense * mp.mpf(10) ** -(DIGITS + 6))
            ratio = precise.traction(from_edge=from_edge) / precise.pressure(from_edge=from_edge)
            assert abs(ratio / friction - 1) <= 10.0**-DIGITS


def test_load_within_a_radius():
    for name in ("frictionless", "no normal compliance"):
        run = solved(name)._run
        f, mp = run.fixed, context()
        s = [mp.mpf(v) for v in ("0.1", "0.75", "0.9999999")]
        found = f.numbers(run.drive.load_inside(f.of(np.array([1 - v * v for v in s]))))
        pressure = solved(name).pressure
        edges = [1 - mp.mpf(10) ** -k for k in (1, 2, 3, 4, 5, 6)]
        for value, radius in zip(found, s, strict=True):
            breaks = [0, *(e for e in edges if e < radius), radius]
            load = integral(lambda eta, p=pressure: p(eta) * eta, breaks, 40)
            assert abs(value / load - 1) <= 10.0**-DIGITS


def test_conventions_without_shear():
    sliding = reference(Scene(NU, 0.0, 0.5, 0.0), 15)
    assert [z.kind for z in sliding.zones] == ["slip"]
    assert sliding.stick_radius == sliding.total_shear == sliding.traction(0.5) == 0
    incompressible = reference(Scene(0.5, 0.0, 0.5, 0.1), 15)
    assert [z.kind for z in incompressible.zones] == ["stick"]
    assert incompressible.total_shear == 0
    assert incompressible.stick_radius == 1
    free = solved("frictionless")
    assert free.zones == ()
    assert free.stick_radius is None
    assert free.edge_ratio is None


def test_fields_take_any_shape_and_exact_numbers():
    precise = solved("frictionless")
    grid = precise.pressure(np.full((2, 3), 0.25))
    assert grid.shape == (2, 3)
    assert grid[1, 2] == precise.pressure(mpmath.mpf(0.25)) == precise.pressure(from_edge=0.75)
    assert precise.pressure([]).shape == (0,)


@pytest.mark.parametrize("bad", [-0.1, 1.5, math.nan, "0.5", 1j, True])
def test_bad_radii_are_refused(bad):
    with pytest.raises(SceneError, match=r"in \[0, 1\]"):
        solved("rough").pressure(bad)
    with pytest.raises(SceneError, match="from_edge"):
        solved("rough").traction(from_edge=bad)


@pytest.mark.parametrize("bad", [14, 61, 20.0, "30", None])
def test_bad_digits_are_refused(bad):
    with pytest.raises(SceneError, match="digits"):
        reference(Scene(0.3), bad)


def test_the_coupled_smooth_punch_is_the_closed_form():
    nu = -0.9
    run, mp = PreciseCoupledRun(Scene(nu, friction=math.inf, coupling=True), 12, 2.0), context()
    theta = mp.log(3 - 4 * mp.mpf(nu)) / (2 * mp.pi)
    approach = (1 - 2 * mp.mpf(nu)) / (16 * (1 - mp.mpf(nu)) * mp.pi * theta)
    # the error of an energy is the square of that of the fields
    assert abs(run.approach / approach - 1) <= 1e-22
    beta = (mp.digamma(1 + 0.5j * theta) - mp.digamma(0.5 + 0.5j * theta)) / 2
    assert abs(run.total_shear / (mp.sinh(mp.pi * theta) * beta.real) - 1) <= 1e-22
    # from the centre to where only the oscillation is left
    depths = np.concatenate([np.linspace(0.01, 0.9, 9), 10.0 ** -np.arange(2.0, 300.0, 7.0)])
    exact = np.array([mp.mpf(d) for d in depths])
    p, q = run.pressures(1 - exact, exact), run.tractions(1 - exact, exact)
    true = coupled_pressure(nu, from_edge=depths), coupled_traction(nu, from_edge=depths)
    for field, expected in zip((p, q), true, strict=True):
        assert np.max(np.abs(field.astype(float) - expected) / np.hypot(*true)) <= 3e-13
    opening = run.opening
    assert abs(coupled_pressure(nu, from_edge=float(opening))) <= 1e-12 * abs(
        coupled_traction(nu, from_edge=float(opening))
    )
    assert run.edge_ratio() is None
    edge = np.array([mp.one]), np.array([mp.zero])
    assert mp.isnan(run.pressures(*edge)[0])


def test_the_opening_of_a_thin_layer():
    scene = Scene(0.0, 1e-6, 1e-6, math.inf, coupling=True)
    run, double = PreciseCoupledRun(scene, 8, 2.0), solve(scene, 1e-12)
    assert abs(run.opening / double.opening - 1) <= 1e-9
    at = np.array([run.opening])
    assert abs(run.pressures(1 - at, at)[0]) <= 1e-12
    assert run.edge_ratio() is None


def test_the_other_edges_with_coupling():
    smooth = PreciseCoupledRun(Scene(0.3, 0.0, 0.5, math.inf, coupling=True), 4, 2.0)
    mp = smooth.fixed.mp
    edge = np.array([mp.one]), np.array([mp.zero])
    assert smooth.edge_ratio() == 0
    assert smooth.opening is None
    assert smooth.pressures(*edge)[0] == mp.inf
    assert mp.isfinite(smooth.tractions(*edge)[0])
    thin = PreciseCoupledRun(Scene(-0.9, 0.0, 1e-3, math.inf, coupling=True), 4, 2.0)
    assert thin.opening is not None
    assert thin.pressures(*edge)[0] == solve(thin.scene).pressure(1.0) == -mp.inf
    rough = PreciseCoupledRun(Scene(0.3, 0.5, 0.0, math.inf, coupling=True), 4, 2.0)
    assert rough.edge_ratio() == rough.tractions(*edge)[0] == mp.inf
    assert mp.isfinite(rough.pressures(*edge)[0])


def test_coupled_slip_is_refused():
    with pytest.raises(NotComputedError, match=r"needs friction of 0\.1015505"):
        reference(Scene(NU, 0.5, 0.5, 0.1015, coupling=True), 15)


def test_bad_scenes_are_refused():
    with pytest.raises(SceneError, match="a Scene"):
        reference({"poisson_ratio": 0.3})


def test_a_vanishing_stick_disk_is_refused():
    with pytest.raises(NotComputedError, match="its zones are slip"):
        reference(Scene(NU, friction=Scene(NU).kappa / 80), 15)


def test_progress_is_shown_when_wanted(capsys):
    reference(Scene(NU), 15)
    assert capsys.readouterr().err == ""
    reference(Scene(NU), 15, progress=True)
    assert "100 %" in capsys.readouterr().err
