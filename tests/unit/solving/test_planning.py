"""The plan of a scene: which steps, which quantities, and why."""

import itertools
import math
import pickle
import subprocess
import sys

import pytest

from spectral_contact import (
    QUANTITIES,
    NotComputedError,
    Scene,
    SceneError,
    StepState,
    cache_sizes,
    clear_caches,
    layers,
    plan,
    profiles,
    solve,
)
from spectral_contact.quantities import FULL_STICK_RATIOS

RUN, IF, NO = StepState.RUN, StepState.CONDITIONAL, StepState.SKIPPED
STEPS = ("normal contact", "full stick", "partial slip", "zone search", "slip displacement")
SCENES = {
    "frictionless": Scene(0.1, 0.5, 0.5),
    "full stick": Scene(0.1, 0.5, 0.5, math.inf),
    "friction zero": Scene(0.1, 0.5, 0.5, 0.0),
    "Coulomb": Scene(0.1, 0.5, 0.5, 0.1),
    "Coulomb, no tangential compliance": Scene(0.1, 0.5, 0.0, 0.1),
    "smooth": Scene(0.1, friction=0.1),
    "incompressible": Scene(0.5, 0.5, 0.5, 0.1),
    "incompressible, frictionless": Scene(0.5, 0.5, 0.5),
    "incompressible, full stick": Scene(0.5, 0.5, 0.5, math.inf),
}
every_scene = pytest.mark.parametrize("name", SCENES)


def read(solution, quantity):
    value = getattr(solution, quantity)
    return value(0.5) if callable(value) else value


def states(scene, quantities=None):
    steps = plan(scene, quantities).steps
    assert tuple(step.name for step in steps) == STEPS
    return tuple(step.state for step in steps)


def reason_of(a_plan, name):
    [reason] = [step.reason for step in a_plan.steps if step.name == name]
    return reason


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("frictionless", (RUN, NO, NO, NO, NO)),
        ("full stick", (RUN, RUN, NO, NO, NO)),
        ("friction zero", (RUN, RUN, NO, NO, RUN)),
        ("Coulomb", (RUN, RUN, IF, IF, IF)),
        ("Coulomb, no tangential compliance", (RUN, RUN, RUN, IF, IF)),
        ("smooth", (RUN, RUN, RUN, IF, IF)),
        ("incompressible", (RUN, NO, NO, NO, NO)),
        ("incompressible, frictionless", (RUN, NO, NO, NO, NO)),
        ("incompressible, full stick", (RUN, NO, NO, NO, NO)),
    ],
)
def test_steps_of_a_scene(name, expected):
    assert states(SCENES[name]) == expected


@pytest.mark.parametrize(
    ("name", "quantities", "expected"),
    [
        ("Coulomb", ("approach",), (RUN, NO, NO, NO, NO)),
        ("Coulomb", ("pressure",), (RUN, NO, NO, NO, NO)),
        ("Coulomb", ("edge_ratio",), (RUN, RUN, NO, NO, NO)),
        ("Coulomb", ("critical_friction", "approach"), (RUN, RUN, NO, NO, NO)),
        ("Coulomb", ("traction",), (RUN, RUN, IF, IF, IF)),
        ("Coulomb", ("zones",), (RUN, RUN, IF, IF, IF)),
        ("Coulomb", (), (NO, NO, NO, NO, NO)),
        ("full stick", ("zones", "stick_radius", "slip"), (NO, NO, NO, NO, NO)),
        ("full stick", ("total_shear",), (RUN, RUN, NO, NO, NO)),
        ("friction zero", ("total_shear", "zones", "traction"), (NO, NO, NO, NO, NO)),
        ("friction zero", ("slip",), (RUN, NO, NO, NO, RUN)),
        ("friction zero", ("critical_friction",), (RUN, RUN, NO, NO, NO)),
        ("frictionless", ("traction", "total_shear"), (NO, NO, NO, NO, NO)),
        ("frictionless", ("slip",), (NO, NO, NO, NO, NO)),
        ("incompressible", ("traction", "zones", "slip"), (NO, NO, NO, NO, NO)),
        ("incompressible", ("approach", "total_shear"), (RUN, NO, NO, NO, NO)),
    ],
)
def test_steps_of_what_is_asked(name, quantities, expected):
    assert states(SCENES[name], quantities) == expected


@every_scene
def test_every_step_has_a_reason(name):
    for asked in (None, (), ("approach",), ("traction",), ("edge_ratio", "slip")):
        for step in plan(SCENES[name], asked).steps:
            assert step.reason
            assert step.reason in str(plan(SCENES[name], asked))


@pytest.mark.parametrize(
    ("name", "step", "words"),
    [
        ("frictionless", "full stick", "no friction coefficient"),
        ("full stick", "partial slip", "infinite"),
        ("friction zero", "partial slip", "everything slips"),
        ("Coulomb", "partial slip", "below the critical"),
        ("Coulomb, no tangential compliance", "partial slip", "at any finite friction"),
        ("smooth", "normal contact", "closed form"),
        ("incompressible", "full stick", "nu = 0.5"),
    ],
)
def test_reasons_say_why(name, step, words):
    assert words in reason_of(plan(SCENES[name]), step)


def test_full_stick_decides_on_slip_only_where_something_depends_on_it():
    for asked, reason in (
        (("traction",), "decides whether there is slip"),
        (("critical_friction", "approach"), "a ratio q/p of full stick is asked for"),
    ):
        assert reason_of(plan(SCENES["Coulomb"], asked), "full stick") == reason


@pytest.mark.parametrize(
    ("compliance", "reason"),
    [
        (0.0, "the approach alone; closed form, the surface is smooth"),
        (0.5, "the approach alone, at low degree"),
    ],
)
def test_only_the_series_of_a_surface_that_is_not_smooth_has_a_degree(compliance, reason):
    assert reason_of(plan(Scene(0.1, compliance), ("approach",)), "normal contact") == reason


@every_scene
def test_quantities_and_missing_are_a_partition(name):
    for asked in (None, (), ("zones",), ("slip", "approach")):
        result = plan(SCENES[name], asked)
        missing = [quantity for quantity, _ in result.missing]
        assert sorted([*result.quantities, *missing]) == sorted(QUANTITIES)
        assert all(reason for _, reason in result.missing)
        assert set(result.quantities) <= set(QUANTITIES if asked is None else asked)


def test_only_a_frictionless_scene_lacks_quantities():
    for name, scene in SCENES.items():
        lacking = {quantity for quantity, _ in plan(scene).missing}
        without = scene.friction is None
        assert lacking == ({"slip", *FULL_STICK_RATIOS} if without else set()), name


@pytest.mark.parametrize("name", ["aproach", "APPROACH", " approach", "approaches"])
def test_a_wrong_name_gets_a_suggestion(name):
    with pytest.raises(SceneError, match=r"shakedown_ratio; did you mean approach\?$"):
        plan(SCENES["Coulomb"], [name])


def test_a_name_that_is_like_nothing_gets_none():
    with pytest.raises(SceneError, match=r"shakedown_ratio$"):
        plan(SCENES["Coulomb"], ["wear"])


def test_order_and_repetition_of_the_quantities_do_not_matter():
    scene = SCENES["Coulomb"]
    expected = plan(scene, ("approach", "zones"))
    assert plan(scene, ["zones", "approach", "zones"]) == expected
    assert plan(scene, iter({"zones", "approach"})) == expected


@every_scene
def test_pure(name):
    scene = SCENES[name]
    before = pickle.dumps(scene)
    clear_caches()
    for asked in itertools.combinations(QUANTITIES, 2):
        first, second = plan(scene, asked), plan(scene, asked)
        assert first == second
        assert hash(first) == hash(second)
    assert pickle.dumps(scene) == before
    assert not any(cache_sizes().values())


def test_planning_imports_nothing_tangential():
    code = (
        "import sys\n"
        "from spectral_contact import Scene, plan\n"
        "plan(Scene(0.1, 0.5, 0.5, 0.1))\n"
        "tangential = ('full_stick', 'drive', 'driven', 'zone_problem')\n"
        "found = [n for n in tangential if f'spectral_contact.contact.{n}' in sys.modules]\n"
        "assert not found, found\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("bad", ["aproach", "", "Pressure", 1, None])
def test_unknown_quantity(bad):
    with pytest.raises(SceneError, match="quantities") as caught:
        plan(SCENES["Coulomb"], ("approach", bad))
    assert caught.value.parameter == "quantities"
    assert caught.value.value == bad
    assert "critical_friction" in str(caught.value)


def test_endless_quantities_are_refused_at_the_first_that_is_none():
    with pytest.raises(SceneError, match="quantities = 0"):
        plan(SCENES["Coulomb"], itertools.count())


def test_one_string_is_not_a_list_of_quantities():
    with pytest.raises(SceneError, match="quantities"):
        plan(SCENES["Coulomb"], "approach")


@pytest.mark.parametrize("bad", [1, 2.5, True])
def test_quantities_that_are_no_list(bad):
    with pytest.raises(SceneError, match="quantities"):
        plan(SCENES["Coulomb"], bad)


@pytest.mark.parametrize("bad", [None, "scene", 0.3])
def test_what_is_no_scene(bad):
    with pytest.raises(SceneError, match="scene"):
        plan(bad)


@pytest.mark.parametrize("quantity", ["slip", *sorted(FULL_STICK_RATIOS)])
def test_missing_without_friction(quantity):
    solution = solve(SCENES["frictionless"], 1e-4)
    reason = dict(solution.plan.missing)[quantity]
    with pytest.raises(NotComputedError) as caught:
        read(solution, quantity)
    assert caught.value.quantity == quantity
    assert caught.value.reason == reason
    assert "friction" in reason


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_missing_because_not_asked(quantity):
    others = [name for name in QUANTITIES if name != quantity]
    solution = solve(SCENES["Coulomb"], 1e-4, others)
    with pytest.raises(NotComputedError) as caught:
        read(solution, quantity)
    assert (caught.value.quantity, caught.value.reason) == (quantity, "it was not asked for")
    assert getattr(solution.error, quantity) is None


def test_solution_tells_what_became_of_conditional_steps():
    def outcome(friction):
        steps = solve(Scene(0.1, 0.5, 0.5, friction), 1e-4).plan.steps
        return tuple(step.state for step in steps)

    assert outcome(0.1) == (RUN, RUN, RUN, NO, RUN)
    assert outcome(10.0) == (RUN, RUN, NO, NO, NO)


@every_scene
def test_solution_holds_what_was_planned(name):
    planned = plan(SCENES[name])
    solution = solve(SCENES[name], 1e-4)
    assert solution.plan.quantities == planned.quantities
    assert solution.plan.missing == planned.missing
    for before, after in zip(planned.steps, solution.plan.steps, strict=True):
        assert after.state is not IF
        if before.state is not IF:
            assert after.state is before.state


# --- elastic coupling -----------------------------------------------------------------------------

STUCK = Scene(0.1, 0.5, 0.5, math.inf, coupling=True)
COUPLED = Scene(0.1, 0.5, 0.5, 0.1, coupling=True)


@pytest.mark.parametrize(
    ("scene", "quantities", "expected"),
    [
        (STUCK, None, (RUN, NO, RUN, NO, NO, NO)),
        (STUCK, ("approach",), (RUN, NO, RUN, NO, NO, NO)),
        (STUCK, ("zones", "stick_radius", "slip"), (NO, NO, NO, NO, NO, NO)),
        (COUPLED, None, (RUN, NO, RUN, IF, IF, IF)),
        (COUPLED, ("approach",), (RUN, NO, RUN, IF, IF, IF)),
        (COUPLED, ("critical_friction",), (RUN, NO, RUN, NO, NO, NO)),
        (COUPLED, (), (NO, NO, NO, NO, NO, NO)),
        (Scene(0.1, 0.5, coupling=True), None, (NO, RUN, NO, NO, NO, NO)),
        (Scene(0.5, 0.5, 0.5, 0.1, coupling=True), None, (NO, RUN, NO, NO, NO, NO)),
        (Scene(0.1, 0.5, 0.5, 0.0, coupling=True), None, (RUN, RUN, RUN, NO, NO, RUN)),
        (Scene(0.1, 0.5, 0.5, 0.0, coupling=True), ("slip",), (NO, RUN, NO, NO, NO, RUN)),
    ],
)
def test_steps_with_coupling(scene, quantities, expected):
    steps = plan(scene, quantities).steps
    assert tuple(step.name for step in steps) == ("elastic coupling", *STEPS)
    assert tuple(step.state for step in steps) == expected
    assert all(step.reason for step in steps)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (STUCK, "one system"),
        (Scene(0.1, 0.5, coupling=True), "no friction coefficient"),
        (Scene(0.5, 0.5, 0.5, 0.1, coupling=True), "nu = 0.5"),
    ],
)
def test_the_plan_says_which_model_runs_and_why(scene, words):
    assert words in plan(scene).steps[0].reason


def test_slip_with_coupling_has_all_fields():
    solution = solve(COUPLED, 1e-3)
    assert set(dict(solution.plan.missing)) == {"shakedown_ratio"}


def test_at_friction_0_the_ratios_are_those_of_coupled_full_stick():
    frictionless = Scene(0.3, 0.5, 0.5, 0.0, coupling=True)
    for asked in (None, ("critical_friction",)):
        reason = reason_of(plan(frictionless, asked), "elastic coupling")
        assert reason == "the ratios q/p are those of coupled full stick"
    assert "no traction acts back" in reason_of(plan(frictionless, ("slip",)), "elastic coupling")


# --- profiles -------------------------------------------------------------------------------------


def sphere(poisson_ratio, friction, **options):
    profile = profiles.Sphere(1.0)
    return Scene(poisson_ratio, 0.5, 0.5, friction=friction, profile=profile, load=0.01, **options)


@pytest.mark.parametrize("friction", [0.0, 0.3, math.inf])
@pytest.mark.parametrize("coupling", [False, True])
def test_where_the_pressure_drives_no_traction_no_contact_grows_with_friction(friction, coupling):
    planned = plan(sphere(0.5, friction, coupling=coupling))
    reason = "at nu = 0.5 the pressure drives no traction: all stick, q = 0"
    assert reason_of(planned, "growing contact") == reason
    assert planned.steps[-1].state is NO
    assert {"traction", "zones"} <= set(planned.quantities)


def test_a_growing_contact_says_why_friction_is_skipped():
    assert "everything slips" in reason_of(plan(sphere(0.3, 0.0)), "growing contact")
    alone = plan(sphere(0.3, 0.3), ("approach",))
    assert "depends on the traction" in reason_of(alone, "growing contact")
    assert plan(sphere(0.3, 0.3)).steps[-1].state is RUN


def test_slip_of_a_growing_contact_is_missing_at_friction_0_alone():
    missing = dict(plan(sphere(0.3, 0.0)).missing)
    assert missing["slip"] == "it is not computed at friction 0 under a profile"
    assert missing["edge_ratio"] == "it is not computed for growing contacts"
    assert "slip" in plan(sphere(0.3, 0.3)).quantities


def test_a_flat_punch_given_as_a_profile_has_no_slip():
    layer = layers.Exponential(1.0, 0.1)
    scene = Scene(0.3, friction=math.inf, profile=profiles.Flat(1.0), load=0.01, layer=layer)
    missing = dict(plan(scene).missing)
    reason = "it is not computed under a flat punch that is given as a profile"
    assert missing["slip"] == missing["critical_friction"] == reason


# --- below the largest load -----------------------------------------------------------------------


@pytest.mark.parametrize("step", ["unloading", "load ratios"])
def test_only_what_is_proportional_to_the_load_is_multiplied_by_the_load_ratio(step):
    scene = Scene(0.3, 0.5, 0.5, 0.05, unloaded_to=0.5)
    reason = "nothing asked for depends on slip"
    assert reason_of(plan(scene, ("critical_friction",)), step) == reason
    both = reason_of(plan(scene, ("critical_friction", "approach")), step)
    assert both == f"{reason}; what is proportional to the load is multiplied by the load ratio"


@pytest.mark.parametrize("friction", [0.0, math.inf])
def test_without_a_limit_of_stick_no_load_ratio_takes_a_solve(friction):
    scene = Scene(0.3, 0.5, 0.5, friction, unloaded_to=0.5)
    planned = plan(scene, ("reverse_ratio",))
    assert {step.state for step in planned.steps} == {NO}
    solution = solve(scene, 1e-4, ("reverse_ratio",))
    assert not solution.work.steps
    assert "reverse_ratio" in dict(solution.plan.missing)


def test_at_friction_0_there_is_no_unloading_although_the_slip_is_asked_for():
    planned = plan(Scene(0.3, 0.5, 0.5, 0.0, unloaded_to=0.5), ("slip", "reverse_ratio"))
    assert reason_of(planned, "slip displacement") == "the slip is asked for"
    for name in ("unloading", "load ratios"):
        assert reason_of(planned, name).startswith("at friction 0 everything slips")


def test_the_load_ratios_are_planned_where_they_are_asked_for():
    scene = Scene(0.3, 0.5, 0.5, 0.05, unloaded_to=0.5)
    assert reason_of(plan(scene), "load ratios") == "no load ratio is asked for"
    asked = plan(scene, ("turning_ratio",)).steps[-1]
    assert asked.state is IF
    assert "a slip zone begins to shrink" in asked.reason
