"""A solve does what its scene calls for and nothing else: by spying on imports and assembly."""

import atexit
import functools
import math
import pkgutil
import subprocess
import sys

import numpy as np
import pytest

from spectral_contact import Scene, cache_sizes, clear_caches, contact, solve
from spectral_contact.contact import ratio
from spectral_contact.spectral import contact_system, spaces

#: Every module of the contact, and those that each kind of scene may load: a module that is new
#: is needed by nothing until it is listed, and a name that is gone is missed.
CONTACT = {module.name for module in pkgutil.iter_modules(contact.__path__)}
NORMAL = {"normal", "refine", "resolution", "tuning"}
ZONES = {
    "error_estimate",
    "free_boundary",
    "layout",
    "pressure_loads",
    "relative_changes",
    "slip_displacement",
    "stick_radius",
    "zone_problem",
    "zone_solution",
    "zone_spaces",
}
FULL_STICK = NORMAL | ZONES | {"full_stick", "ratio"}
SLIP = FULL_STICK | {"friction_law", "slip_outcome", "zone_fields", "zone_search"}
PROFILE = NORMAL | {"contact_radius", "indented", "on_parts", "smooth_indented"}
ADHESION = PROFILE | {"adhesion", "pinned"}
ONSET = FULL_STICK | {"friction_law", "onset"}
LAYERED = PROFILE | {
    "layered",
    "layered_bends",
    "layered_contact",
    "layered_newton",
    "layered_setting",
    "layered_spaces",
}
ALPHAS = (0.0, 1e-8, 0.5, 1e4)


SERVER = """
import os, sys
from math import inf
import spectral_contact as sc
from spectral_contact import Scene, profiles, solve
for line in sys.stdin:
    if os.fork() == 0:
        prefix = "spectral_contact.contact."
        try:
            eval(line)
            print(*(n.removeprefix(prefix) for n in sys.modules if n.startswith(prefix)))
        except Exception as error:
            print(repr(error))
        sys.stdout.flush()
        os._exit(0)
    os.wait()
"""


@functools.cache
def interpreter():
    """One that has loaded the library and solved nothing, and forks for every scene."""
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    atexit.register(server.communicate)
    return server


@functools.cache
def imported_by(scene, rtol=1e-6, quantities=None):
    """Return which modules of `contact` an interpreter loads that solves a scene and no other."""
    server = interpreter()
    print(f"solve({scene}, {rtol}, {quantities})", file=server.stdin, flush=True)
    return set(server.stdout.readline().split())


@pytest.fixture
def assembled(monkeypatch):
    """Names of the operators assembled, in order, from empty caches on."""
    names = []
    each = ("normal", spaces.Space), ("tangential", contact_system.ContactSystem)
    for name, kind in each:

        def spy(one, *form, name=name, original=kind.__init__, **more):
            names.append(name)
            original(one, *form, **more)

        monkeypatch.setattr(kind, "__init__", spy)
    clear_caches()
    yield names
    clear_caches()


@pytest.mark.parametrize(
    "scene", ["Scene(0.1, 0.5)", "Scene(0.1)", "Scene(0.1, 0.5, 0.5)", "Scene(0.1, 0.0, 0.5)"]
)
def test_frictionless_imports_nothing_tangential(scene):
    assert imported_by(scene) == NORMAL


@pytest.mark.parametrize("friction", ["0.1", "0.0", "inf"])
def test_incompressible_imports_nothing_tangential(friction):
    assert imported_by(f"Scene(0.5, 0.5, 0.5, {friction})") == NORMAL


@pytest.mark.parametrize(
    ("friction", "quantities", "looked_for"),
    [
        (math.inf, ("traction", "total_shear"), False),
        (math.inf, ("total_shear",), False),
        (math.inf, ("edge_ratio",), True),
        (math.inf, None, True),
        (0.1, ("total_shear",), True),
    ],
)
def test_the_largest_ratio_is_looked_for_where_it_is_asked_or_decides(
    monkeypatch, friction, quantities, looked_for
):
    calls = []
    original = ratio.largest_ratio
    monkeypatch.setattr(ratio, "largest_ratio", lambda *args: calls.append(1) or original(*args))
    solution = solve(Scene(0.1, 0.5, 0.5, friction), 1e-6, quantities)
    assert bool(calls) == looked_for
    whole = solve(Scene(0.1, 0.5, 0.5, friction), 1e-6)
    for name in {"total_shear", "edge_ratio"} & set(quantities or ()):
        found, expected = getattr(solution, name), getattr(whole, name)
        errors = getattr(solution.error, name), getattr(whole.error, name)
        if friction == math.inf:
            assert found == expected
            assert errors[0] == errors[1]
        else:  # the shear of slip needs less than its fields
            assert abs(found / expected - 1.0) <= sum(errors)
            assert max(errors) <= 1e-6


@pytest.mark.parametrize("friction", ["10.0", "inf"])
def test_above_critical_friction_imports_nothing_of_slip(friction):
    assert imported_by(f"Scene(0.1, 0.5, 0.5, {friction})") == FULL_STICK


def test_slip_imports_nothing_coupled():
    assert imported_by("Scene(0.1, 0.5, 0.2, 0.1)") == SLIP
    assert imported_by("Scene(0.3, 0.05, 1.0, 0.0328)", 1e-2) == SLIP


def test_at_the_critical_friction_slip_is_looked_for_and_not_solved():
    critical = "solve(Scene(0.1, 0.5, 0.5, inf), 1e-3).critical_friction"
    assert imported_by(f"Scene(0.1, 0.5, 0.5, {critical})", 1e-3) == ONSET


def test_a_profile_imports_nothing_tangential():
    given = "profile=profiles.Parabola(1.0), load=1.0"
    assert imported_by(f"Scene(0.3, 0.5, {given})") == PROFILE
    assert imported_by(f"Scene(0.3, 0.0, {given})") == PROFILE


def test_adhesion_imports_its_curve():
    given = "profile=profiles.Parabola(1.0), load=1.0, work_of_adhesion=1.0"
    assert imported_by(f"Scene(0.3, 0.5, {given})") == ADHESION


def test_a_nonlinear_layer_imports_what_solves_it():
    layer = "layer=sc.layers.PowerLaw(1.0, 1.5)"
    assert imported_by(f"Scene(0.3, {layer}, profile=profiles.Parabola(1.0), load=1.0)") == LAYERED


def test_every_module_is_loaded_by_something():
    """Else what is not loaded proves nothing."""
    coupled = imported_by("Scene(0.3, 0.05, 1.0, 0.0328, coupling=True)", 1e-2)
    # derivatives are for fits and sensitivities
    others = {"little_friction", "tuning", "zone_derivatives"}
    unloaded = imported_by("Scene(0.1, 0.5, 0.5, 0.1, unloaded_to=0.9)", 1e-2)
    assert unloaded == SLIP | {"onset", "unloading"}
    assert coupled | unloaded | LAYERED | ADHESION | others == CONTACT


@pytest.mark.parametrize("quantities", [("approach",), ("pressure",), ("approach", "pressure")])
def test_normal_quantities_of_a_frictional_scene_import_nothing_tangential(quantities):
    assert imported_by("Scene(0.1, 0.5, 0.5, 0.1)", quantities=quantities) == NORMAL


@pytest.mark.parametrize("alpha", ALPHAS)
def test_frictionless_assembles_no_tangential_operator(assembled, alpha):
    solve(Scene(0.1, alpha, 0.5), 1e-10)
    assert "tangential" not in assembled


def test_the_spy_sees_tangential_operators(assembled):
    solve(Scene(0.1, 0.5, 0.5, math.inf), 1e-6)
    assert {"normal", "tangential"} <= set(assembled)


def test_smooth_frictionless_assembles_nothing(assembled):
    solve(Scene(0.1), 1e-12)
    assert assembled == []
    assert not any(cache_sizes().values())


def test_smooth_full_stick_assembles_no_normal_operator(assembled):
    solve(Scene(0.1, friction=math.inf), 1e-10)
    assert "normal" not in assembled


def test_nothing_is_solved_for_what_follows_by_definition(assembled):
    solution = solve(Scene(0.1, 0.5, 0.5), 1e-10, ("traction", "total_shear", "zones"))
    assert assembled == []
    assert solution.work.steps == ()
    assert (solution.total_shear, solution.zones, solution.traction(0.5)) == (0.0, (), 0.0)


def test_operators_are_reused_for_other_scenes(assembled):
    solve(Scene(0.1, 0.5, 0.5, math.inf), 1e-10)
    cold, kept = assembled.count("normal"), cache_sizes()
    solve(Scene(0.3, 0.5, 0.5, math.inf), 1e-10)
    assert assembled.count("normal") == cold
    assert cache_sizes() == kept


@pytest.mark.parametrize("alpha", [1e-6, 0.5])
def test_approach_alone_needs_far_fewer_unknowns(alpha):
    scene = Scene(0.1, alpha)
    alone = solve(scene, 1e-10, ("approach",))
    fully = solve(scene, 1e-10)
    assert alone.converged
    # to factor a matrix costs the cube of the unknowns
    assert alone.work.unknowns**3 <= fully.work.unknowns**3 / 4
    assert abs(alone.approach / fully.approach - 1) <= alone.error.approach + fully.error.approach


def test_shear_alone_needs_no_more_unknowns_than_traction():
    scene = Scene(0.1, 0.5, 0.5, math.inf)
    alone = solve(scene, 1e-10, ("total_shear",))
    fully = solve(scene, 1e-10)
    assert alone.converged
    assert alone.work["full stick"].unknowns <= fully.work["full stick"].unknowns
    bound = alone.error.total_shear + fully.error.total_shear
    assert abs(alone.total_shear / fully.total_shear - 1) <= bound


@pytest.mark.parametrize("name", ["pressure", "approach", "total_shear"])
def test_what_is_solved_is_recorded(name):
    solution = solve(Scene(0.1, 0.5, 0.5, 0.1), 1e-6, (name,))
    ran = {step.name for step in solution.plan.steps if step.state.value == "run"}
    assert {step.name for step in solution.work.steps} == ran


@pytest.mark.parametrize("alpha", ALPHAS)
def test_friction_changes_no_digit_of_the_normal_problem(alpha):
    # the pressure drives the traction and is then solved tighter: at 1e-12, to the same space
    s = np.linspace(0.0, 0.99, 7)
    bare = solve(Scene(0.1, alpha), 1e-12)
    for friction in (math.inf, 0.0, 100.0):
        loaded = solve(Scene(0.1, alpha, 1.0, friction), 1e-12)
        bound = bare.error.approach + loaded.error.approach
        assert abs(loaded.approach / bare.approach - 1) <= bound
        bound = bare.error.pressure + loaded.error.pressure
        assert np.max(np.abs(loaded.pressure(s) / bare.pressure(s) - 1)) <= bound


@pytest.mark.parametrize("friction", [None, 0.0, 0.1, math.inf])
def test_explicit_zero_compliance_is_the_default(friction):
    assert solve(Scene(0.1, 0.0, 0.0, friction), 1e-8) == solve(Scene(0.1, friction=friction), 1e-8)


@pytest.mark.parametrize("beta", [0.0, 1e-6, 2.0])
def test_tangential_compliance_without_friction_changes_no_bit(beta):
    plain, other = solve(Scene(0.1, 0.5), 1e-10), solve(Scene(0.1, 0.5, beta), 1e-10)
    s = np.linspace(0.0, 1.0, 9)
    assert plain.approach == other.approach
    assert np.array_equal(plain.pressure(s), other.pressure(s))


def test_poisson_ratio_without_friction_changes_no_bit():
    plain, other = solve(Scene(0.1, 0.5), 1e-10), solve(Scene(0.5, 0.5), 1e-10)
    assert plain.approach == other.approach
    assert plain.pressure(0.3) == other.pressure(0.3)


def test_friction_above_critical_is_full_stick_to_the_bit():
    stuck, held = (solve(Scene(0.1, 0.5, 0.5, f), 1e-10) for f in (math.inf, 10.0))
    s = np.linspace(0.0, 1.0, 9)
    assert held.total_shear == stuck.total_shear
    assert np.array_equal(held.traction(s), stuck.traction(s))
    assert np.all(held.slip(s) == 0.0)


@pytest.mark.parametrize("scene", [Scene(0.1, 1e-14), Scene(0.1, 1e-14, 1e-14, math.inf)])
def test_hardly_any_compliance_changes_no_digit_beyond_the_error(scene):
    smooth = solve(Scene(0.1, friction=scene.friction), 1e-12)
    rough = solve(scene, 1e-12)
    # delta - 1/8 = (alpha/4 pi)(ln(1/alpha) + gamma + 1), 2.7e-14 at alpha = 1e-14
    assert abs(rough.approach - smooth.approach) <= 3e-14
    assert abs(rough.total_shear - smooth.total_shear) <= 1e-12


def test_coupling_alone_imports_what_couples():
    assert imported_by("Scene(0.1, 0.5, 0.5, inf, coupling=True)") == FULL_STICK
    assert imported_by("Scene(0.5, 0.5, 0.5, inf, coupling=True)") == NORMAL


@pytest.mark.parametrize("friction", [None, 0.05, math.inf])
def test_without_coupling_no_coupled_operator_is_assembled(friction):
    clear_caches()
    solve(Scene(0.1, 0.5, 0.5, friction), 1e-6)
    assert cache_sizes().get("full-stick matrices", 0) == 0


def test_with_coupling_they_are():
    clear_caches()
    solve(Scene(0.1, 0.5, 0.5, math.inf, coupling=True), 1e-6)
    assert cache_sizes()["full-stick matrices"] > 0
