"""The gold tables: what they cover, exact solutions among them, and the solver against them all.

The oracle was computed in fixed point on other meshes, and its reader knows no solver.
"""

import math

import pytest
from mpmath.ctx_mp import MPContext
from oracles.gold_errors import TOLERANCES, exceeded, unmet

from spectral_contact import gold, solve
from spectral_contact.profiles.control import CONTROLS, KINDS

LARGEST_ERROR = 1e-25
TABLES = {table.name: table for table in gold.tables()}
SOLUTIONS = [solution for table in TABLES.values() for solution in table.solutions]
SCENES = [solution.scene for solution in SOLUTIONS]


def named(name):
    [found] = [solution for solution in SOLUTIONS if solution.name == name]
    return found


def test_there_are_enough_scenes():
    assert len(SOLUTIONS) >= 60
    assert len(set(SCENES)) == len(SCENES)


def test_every_number_has_25_digits_and_18_below_the_largest_load():
    for solution in SOLUTIONS:
        error = solution.error
        errors = [getattr(error, name) for name in error.__slots__]
        digits = 25 if solution.scene.unloaded_to == 1.0 else 18
        assert max(e for e in errors if e is not None) <= 10.0**-digits
        assert solution.digits >= digits


def test_unloading_is_there():
    unloaded = [solution for solution in SOLUTIONS if solution.scene.unloaded_to < 1.0]
    assert len(unloaded) >= 12
    zones = [
        "".join("0" if zone.kind == "stick" else f"{zone.sense:+}"[0] for zone in one.zones)
        for one in unloaded
    ]
    # from the centre outward: stick, forward slip, memory, slip back
    assert {"0+0", "0+0-", "0+0+0", "0+0-0+0"} <= set(zones)
    for one in unloaded:
        assert [zone.memory for zone in one.zones][2:3] == [True] * (len(one.zones) > 2)


def test_profiles_are_there():
    pressed = [solution for solution in SOLUTIONS if solution.scene.profile is not None]
    assert len(pressed) >= 24
    kinds = {type(solution.scene.profile).__name__ for solution in pressed}
    assert kinds == {*KINDS} - {"Sum"}  # which adds up two of the others
    for name in CONTROLS:
        assert any(getattr(solution.scene, name) is not None for solution in pressed)
    for solution in pressed:
        if solution.scene.layer is not None:
            continue
        # the stiffness theorem, on a smooth surface and next to a flat punch of the tables
        scene, a = solution.scene, solution.contact_radius
        if scene.normal_compliance == 0.0:
            assert abs(solution.stiffness / a / 8 - 1) <= LARGEST_ERROR
            continue
        shared = scene.normal_compliance / float(a)
        for flat in TABLES["frictionless"].solutions:
            if flat.scene.normal_compliance != shared:
                continue
            assert abs(solution.stiffness * flat.approach / a - 1) <= LARGEST_ERROR


def test_layers_are_there():
    layered = [solution for solution in SOLUTIONS if solution.scene.layer is not None]
    assert len(layered) >= 16
    kinds = {type(solution.scene.layer).__name__ for solution in layered}
    assert kinds >= {
        *("Linear", "PowerLaw", "Exponential", "CalculixExponential", "GreenwoodWilliamson")
    }
    for name in CONTROLS:
        assert any(getattr(solution.scene, name) is not None for solution in layered)
    # a linear law, whose numbers come from another formulation
    [linear] = [s for s in layered if type(s.scene.layer).__name__ == "Linear"]
    known = {point.from_edge: point.pressure for point in linear.points}
    scene = linear.scene.replace(layer=None, normal_compliance=linear.scene.layer.compliance)
    double = solve(scene, 1e-12)
    assert abs(double.approach / linear.approach - 1) <= double.error.approach
    depths = [*known]
    mean = double.load / (math.pi * double.contact_radius**2)
    for p, depth in zip(double.pressure(from_edge=depths), depths, strict=True):
        assert abs(p - known[depth]) <= double.error.pressure * max(p, mean)


def oscillates(scene):
    """Whether the fields have no limit at the edge."""
    return scene.coupling and scene.normal_compliance == 0.0 == scene.tangential_compliance


def test_points_reach_the_edge():
    for solution in SOLUTIONS:
        depths = {point.from_edge for point in solution.points}
        assert len(depths) >= 20
        assert depths >= {1.0, *(float(f"1e-{k}") for k in range(1, 13))}
        assert (0.0 in depths) is not oscillates(solution.scene)


def test_all_regimes_are_there():
    for name in ("normal_compliance", "tangential_compliance"):
        assert {getattr(scene, name) for scene in SCENES} >= {0.0, 1e-12, 1e-6, 0.5, 1.0, 1e6}
    rough = [s for s in SCENES if s.tangential_compliance and s.normal_compliance]
    decades = [math.log10(s.normal_compliance / s.tangential_compliance) for s in rough]
    assert min(decades) < -17.9
    assert max(decades) > 17.9
    assert min(s.poisson_ratio for s in SCENES) == -0.9
    assert max(s.poisson_ratio for s in SCENES) == 0.5
    ratios = {s.friction / s.kappa for s in SCENES if s.friction and s.kappa}
    assert min(ratios) <= 0.01
    kinds = {}
    for solution in SOLUTIONS:
        scene, kind = solution.scene, tuple(zone.kind for zone in solution.zones)
        smooth = scene.normal_compliance == 0.0, scene.tangential_compliance == 0.0
        limited = scene.friction is not None and math.isfinite(scene.friction)
        kinds.setdefault((kind, limited), set()).add(smooth)
    every = {(False, False), (False, True), (True, False), (True, True)}
    assert kinds[("stick",), False] == every  # friction is infinite
    assert kinds[("stick",), True] >= {(False, False), (True, False)}  # above the critical
    assert kinds[("stick", "slip"), True] == every - {(True, False)}  # there slip is inside
    slipping = [s for s in SOLUTIONS if len(s.zones) == 2]
    assert min(s.zones[1].inner_from_edge for s in slipping) < 1e-9  # slip about to start
    assert kinds[("stick", "slip", "stick"), True] == {(False, False), (True, False)}
    assert kinds[("slip",), True]
    assert kinds[(), False]


def test_all_regimes_of_coupling_are_there():
    coupled = [solution for solution in SOLUTIONS if solution.scene.coupling]
    assert len(coupled) >= 30
    scenes = [solution.scene for solution in coupled]
    pairs = {(s.normal_compliance, s.tangential_compliance) for s in scenes}
    for values in zip(*pairs, strict=True):
        assert set(values) >= {0.0, 1e-12, 1e-6, 0.5, 1.0, 1e3}
    assert any(a == b > 0.0 for a, b in pairs)
    assert any(0.0 < a < b for a, b in pairs)
    assert any(a > b > 0.0 for a, b in pairs)
    assert {s.poisson_ratio for s in scenes} >= {-0.5, 0.0, 0.3, 0.4999}
    assert any(math.isfinite(s.friction) for s in scenes)
    rough = [s for s in coupled if not oscillates(s.scene)]
    assert {solution.opening is None for solution in rough} == {True, False}
    assert all(point.pressure > 0 for s in rough if s.opening is None for point in s.points)


def test_the_opening_is_where_the_solver_has_it():
    for true in SOLUTIONS:
        if true.opening is not None:
            double = solve(true.scene, 1e-6)
            assert abs(double.opening / true.opening - 1) <= 100.0 * double.error.pressure


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.4999])
def test_coupled_smooth_scenes_are_the_closed_forms(nu):
    true = named(f"nu={nu:g} alpha=0 beta=0 f=inf coupled")
    mp = MPContext()
    mp.dps = 45
    nu = mp.mpf(nu)
    theta = mp.log(3 - 4 * nu) / (2 * mp.pi)
    approach = (1 - 2 * nu) / (8 * (1 - nu) * mp.log(3 - 4 * nu))
    beta = (mp.digamma(1 + 0.5j * theta) - mp.digamma(0.5 + 0.5j * theta)) / 2
    assert abs(true.approach / approach - 1) <= LARGEST_ERROR
    assert abs(true.total_shear / (mp.sinh(mp.pi * theta) * beta.real) - 1) <= LARGEST_ERROR
    for point in true.points[3:18:10]:
        s, y = 1 - mp.mpf(point.from_edge), point.from_edge * (2 - mp.mpf(point.from_edge))

        def abel(x, s=s, y=y):  # inverse transforms of cos and sin over t, with v = tanh x
            t = mp.sqrt(s * s + y * mp.tanh(x) ** 2)
            angle = theta * mp.log((1 + t) ** 2 / (y * mp.sech(x) ** 2))
            sine, cosine = mp.sin(angle), mp.cos(angle)
            both = cosine + 2 * theta / t * sine + 1j * s / t**2 * (sine / t - 2 * theta * cosine)
            return both * mp.sech(x) ** 2

        size = mp.sinh(mp.pi * theta) / (2 * mp.pi**2 * theta) / mp.sqrt(y)
        both = size * mp.quad(abel, [0, 2, 4, 8, 16, 40])
        assert abs(point.pressure - both.real) <= LARGEST_ERROR * abs(both)
        assert abs(point.traction - both.imag) <= LARGEST_ERROR * max(
            abs(both.imag), theta * abs(both)
        )


def test_smooth_scenes_are_the_closed_forms():
    stick, slip = (
        named("nu=0.3 alpha=0 beta=0 f=inf"),
        named("nu=-0.9 alpha=0 beta=0 f=0.736842105"),
    )
    mp = stick.approach.context
    assert stick.approach == slip.approach == 0.125
    for solution in (stick, slip):
        nu = mp.mpf(solution.scene.poisson_ratio)
        kappa = (1 - 2 * nu) / (4 * (1 - nu))
        for point in solution.points[:-1]:
            y = point.from_edge * (2 - mp.mpf(point.from_edge))
            assert abs(point.pressure * 2 * mp.pi * mp.sqrt(y) - 1) <= LARGEST_ERROR
        if solution is stick:
            assert abs(stick.total_shear / (2 * kappa * mp.ln2) - 1) <= LARGEST_ERROR
            continue
        c, rest = slip.stick_radius, slip.zones[0].outer_from_edge * (1 + slip.stick_radius)
        ratio = mp.mpf(slip.scene.friction) / kappa
        balance = mp.log((1 + c) / (1 - c)) / c / (ratio * mp.ellipk(rest)) - 1
        assert abs(balance) <= LARGEST_ERROR
        shear = slip.scene.friction * mp.ellipe(rest) + kappa * mp.log(rest)
        assert abs(slip.total_shear / shear - 1) <= LARGEST_ERROR


@pytest.mark.parametrize("rtol", TOLERANCES)
@pytest.mark.parametrize("table", TABLES)
def test_no_error_exceeds_its_estimate_nor_that_the_tolerance(table, rtol):
    asked = rtol
    if table.startswith(("profiles", "layers", "adhesion")):
        rtol = max(rtol, 1e-11)  # a tip on a layer of 1e-4 is known to 1.2e-12
    if table == "unloading":
        rtol = max(rtol, 1e-9)  # five zones at 0.7 are known to 1.8e-12, narrow ones to 3e-10
    wrong = []
    # between the tolerances at the ends, of which all scenes are solved, two samples do
    sample = {1e-6: slice(0, None, 3), 1e-9: slice(1, None, 3)}.get(rtol, slice(None))
    if table == "unloading":  # each at one tolerance: they take ten times as long
        sample = slice(TOLERANCES.index(asked), None, len(TOLERANCES))
    for true in TABLES[table].solutions[sample]:
        double = solve(true.scene, rtol)  # raises if it does not converge
        wrong += [(true.name, exceeded(double, true), unmet(double, true, rtol))]
    assert [one for one in wrong if one[1] or one[2]] == []
