"""Scenes with adhesion: what they are made of, and what keeps, compares or sweeps them."""

import json
import math
import pickle

import numpy as np
import pytest

from spectral_contact import (
    NotComputedError,
    Scene,
    SceneError,
    Solution,
    adhesion_cycle,
    compare,
    layers,
    plan,
    plotting,
    profiles,
    pull_off,
    solve,
)
from spectral_contact.__main__ import main
from spectral_contact.scene import same_problem
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps import sweep
from spectral_contact.testing import check_solution
from spectral_contact.view.explorer.state import texts_of

BALL = profiles.Parabola(1.0)
#: A flat end with a gentle slope has two stable states.
GENTLE = profiles.TruncatedCone(1.0, math.atan(20.0))
GEL = {"reduced_modulus": 1e4, "profile": profiles.Parabola(1e-5), "work_of_adhesion": 5e-5}


def sticky(**given):
    return Scene(
        0.3, **{"normal_compliance": 1.0, "profile": BALL, "work_of_adhesion": 1.0, **given}
    )


# --- input ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "name", "allowed"),
    [
        ({"work_of_adhesion": 0.0}, "work_of_adhesion", "leave it out"),
        ({"work_of_adhesion": -1.0}, "work_of_adhesion", "in [1e-100, 1e100]"),
        ({"work_of_adhesion": math.inf}, "work_of_adhesion", "in [1e-100, 1e100]"),
        ({"work_of_adhesion": "1"}, "work_of_adhesion", "a real number"),
        ({"friction": 0.0}, "friction", "without friction"),
        ({"friction": 0.3}, "friction", "without friction"),
        ({"coupling": True}, "coupling", "without friction"),
        (
            {"normal_compliance": 0.0, "layer": layers.Linear(1.0)},
            "layer",
            "with a linear layer, normal_compliance",
        ),
        ({"profile": None, "load": None}, "profile", "profiles.Flat"),
        ({"branch": -1}, "branch", "a whole number >= 0"),
        ({"branch": 1.0}, "branch", "a whole number >= 0"),
        ({"load": None, "contact_radius": 1.0, "branch": 1}, "branch", "a radius has one state"),
        ({"work_of_adhesion": None, "branch": 1}, "branch", "there is one state"),
        ({"work_of_adhesion": None, "load": -1.0}, "load", "finite and > 0"),
        ({"load": math.nan}, "load", "finite"),
        ({"load": None, "contact_radius": 0.5, "profile": GENTLE}, "contact_radius", "in [1, inf)"),
        (
            {"profile": profiles.Flat(1.0), "load": None, "contact_radius": 1.0},
            "contact_radius",
            "",
        ),
    ],
)
def test_what_does_not_go_with_adhesion_is_refused_by_name(given, name, allowed):
    with pytest.raises(SceneError) as caught:
        sticky(**{"load": 1.0, **given})
    assert caught.value.parameter == name
    assert allowed in caught.value.allowed


def test_a_flat_profile_takes_a_linear_layer_and_no_friction():
    flat = profiles.Flat(2.0)
    rough = solve(Scene(None, 0.5, profile=flat, load=3.0))
    unit = solve(Scene(None, 0.25))
    assert rough.approach == pytest.approx(1.5 * unit.approach, rel=1e-13)
    assert rough.stiffness == pytest.approx(2.0 / unit.approach, rel=1e-13)
    assert rough.indentation_work == pytest.approx(1.5 * rough.approach, rel=1e-13)
    s = np.linspace(0.0, 1.0, 5)
    assert rough.pressure(s) == pytest.approx(0.75 * unit.pressure(s), rel=1e-10)
    assert check_solution(rough, rough.scene, 1e-10).passed
    smooth = solve(Scene(None, profile=flat, approach=1.0))
    assert smooth.load == pytest.approx(16.0, rel=1e-14)
    with pytest.raises(SceneError, match="leave the profile out"):
        Scene(0.3, profile=flat, load=1.0, friction=0.1)


def test_it_is_part_of_the_problem_and_of_everything_that_keeps_a_scene():
    scene = sticky(load=-3.0, branch=1)
    for other in (scene.replace(work_of_adhesion=2.0), scene.replace(branch=0)):
        assert other != scene
        assert not same_problem(other, scene)
    assert same_problem(scene, scene.replace(poisson_ratio=0.1))
    assert Scene.from_json(scene.to_json()) == scene
    assert eval(repr(scene), {"Scene": Scene, **vars(profiles)}) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert scene.replace(work_of_adhesion=None, branch=0, load=1.0) == Scene(
        0.3, 1.0, profile=BALL, load=1.0
    )
    plain = json.loads(Scene(0.3, 1.0, profile=BALL, load=1.0).to_json())
    assert not {"work_of_adhesion", "branch"} & set(plain)


def test_si_data_keep_it():
    scene = Scene.from_physical(**GEL, load=-1e-9)
    assert scene.work_of_adhesion == 5e-5 / 2500.0
    assert scene.load == -1e-9 / 2500.0
    assert Scene.from_json(scene.to_json()) == scene
    assert scene.replace(load=0.0).load == 0.0
    assert scene.replace(work_of_adhesion="50 uJ/m^2") == scene
    for given in ({"work_of_adhesion": 0.0}, {"work_of_adhesion": "50 mN"}):
        with pytest.raises(SceneError, match="work_of_adhesion"):
            scene.replace(**given)
    with pytest.raises(SceneError, match="load"):
        scene.replace(work_of_adhesion=None)
    found = solve(scene)
    own = solve(scene.replace(physical=None))
    assert found.physical.load == -1e-9
    assert found.physical.stiffness_on_branch == pytest.approx(own.stiffness_on_branch * 2500.0)
    assert found.physical.pressure(from_edge=0.0) == -math.inf
    assert "w = 5e-05 J/m^2" in found.summary()


def test_files_of_solutions_have_all_of_it(tmp_path):
    for k, found in enumerate(
        [
            solve(sticky(load=0.0)),
            solve(sticky(normal_compliance=0.0, profile=profiles.Cone(1.2), approach=0.1)),
            solve(Scene(None, 0.2, profile=profiles.Flat(1.0), load=-0.1, work_of_adhesion=1.0)),
        ]
    ):
        for suffix in ("json", "npz"):
            found.save(path := tmp_path / f"{k}.{suffix}")
            loaded = Solution.load(path)
            assert loaded == found
            assert loaded.stable_under == found.stable_under
            assert loaded.error_scales == found.error_scales
            assert loaded.pressure(0.7) == found.pressure(0.7)


def test_the_plan_has_the_stiffness_on_the_branch_with_adhesion_alone():
    assert "stiffness_on_branch" in plan(sticky(load=0.0)).quantities
    assert "adhesion pulls at the edge" in str(plan(sticky(load=0.0)))
    with pytest.raises(SceneError, match="stiffness_on_branch"):
        plan(Scene(0.3, profile=BALL, load=1.0), ["stiffness_on_branch"])
    with pytest.raises(NotComputedError, match="no adhesion"):
        _ = solve(Scene(0.3, profile=BALL, load=1.0)).stiffness_on_branch
    lean = solve(sticky(load=0.0), quantities=["approach"])
    for name in ("stable_under", "stiffness_on_branch", "load"):
        with pytest.raises(NotComputedError):
            getattr(lean, name)


def test_what_does_not_know_adhesion_says_so():
    scene = sticky(load=0.0)
    with pytest.raises(SceneError, match="does not support adhesion"):
        texts_of(scene)
    with pytest.raises(SceneError, match="a work_of_adhesion"):
        pull_off(Scene(0.3, profile=BALL, load=1.0))


# --- states ---------------------------------------------------------------------------------------


def test_states_beyond_pull_off_are_refused_with_how_far():
    limit = pull_off(sticky(load=0.0)).load
    with pytest.raises(SceneError, match=r"at least -5\.9279.*it is beyond by 1\.07.*0\.181 of it"):
        solve(sticky(load=-7.0))
    assert solve(sticky(load=limit * (1.0 - 1e-9)), rtol=1e-8).converged
    with pytest.raises(SceneError, match="pull-off under control of the approach"):
        solve(sticky(approach=-2.0))
    with pytest.raises(SceneError, match="less than 2, the number of branches"):
        solve(sticky(load=-3.0, branch=2))
    with pytest.raises(SceneError, match=r"at most .*where branch 1 ends"):
        solve(sticky(load=1.0, branch=1))
    flat = Scene(None, 1.0, profile=profiles.Flat(1.0), load=-4.1, work_of_adhesion=1.0)
    with pytest.raises(SceneError, match=r"at least -4\.0354745392"):
        solve(flat)
    with pytest.raises(SceneError, match="one state"):
        solve(flat.replace(load=1.0, branch=1))
    ball = profiles.Sphere(1.0)
    grown = Scene(None, 100.0, profile=ball, load=0.0, work_of_adhesion=1e9)
    for refuse, name in ((solve, "load"), (pull_off, "work_of_adhesion")):
        with pytest.raises(SceneError, match="adhesion makes the contact grow to that end") as told:
            refuse(grown)
        assert told.value.parameter == name


def test_branches_are_states_of_one_load_from_large_contacts_to_small_ones():
    scene = Scene(None, 0.05, profile=GENTLE, load=-0.615, work_of_adhesion=0.005)
    found = [solve(scene.replace(branch=k), rtol=1e-9) for k in range(3)]
    radii = [one.contact_radius for one in found]
    assert radii == sorted(radii, reverse=True)
    assert [one.stable_under for one in found] == [
        ("load", "approach"),
        ("approach",),
        ("load", "approach"),
    ]
    for one in found:
        given = solve(
            scene.replace(load=None, contact_radius=one.contact_radius), quantities=["load"]
        )
        assert given.load == pytest.approx(-0.615, rel=1e-12)
    assert [math.copysign(1.0, one.stiffness_on_branch) for one in found] == [1.0, -1.0, 1.0]


def test_the_stiffness_on_the_branch_has_two_values_at_a_corner_alone():
    """A polynomial through states to both sides of the corner gave one, 55 % off either."""
    cornered = profiles.Sum(profiles.Cone(0.1), profiles.TruncatedCone(1.0, 0.7))
    scene = Scene(None, 0.05, profile=cornered, contact_radius=1.0, work_of_adhesion=0.1)
    found = solve(scene, rtol=1e-8)
    assert found.stable_under == ("load", "approach")
    with pytest.raises(NotComputedError, match="larger contacts have another slope"):
        _ = found.stiffness_on_branch
    rounded = profiles.Sum(profiles.Parabola(2.0), profiles.RoundedFlat(1.0, 1.0))
    found = solve(scene.replace(profile=rounded))
    assert found.error.stiffness_on_branch < 1e-9
    smaller = [solve(scene.replace(profile=rounded, contact_radius=1.0 - k * 1e-3)) for k in (1, 2)]
    load, approach = (
        3.0 * getattr(found, name) - 4.0 * getattr(smaller[0], name) + getattr(smaller[1], name)
        for name in ("load", "approach")
    )
    assert found.stiffness_on_branch == pytest.approx(load / approach, rel=1e-5)


def test_continuations_and_sweeps_solve_what_solve_does():
    scenes = [sticky(load=load) for load in (2.0, 0.0, -3.0)]
    path = Continuation(1e-10, ("contact_radius", "stiffness_on_branch"), 20_000)
    each = [solve(one, rtol=1e-10) for one in scenes]
    for one, other in zip(each, map(path.solve, scenes), strict=True):
        assert other.contact_radius == pytest.approx(one.contact_radius, rel=1e-12)
    found = sweep(sticky(load=1.0), load=[-3.0, 0.0, 2.0], work_of_adhesion=[0.1, 1.0])
    assert dict(found.sizes) == {"load": 3, "work_of_adhesion": 2}
    assert found.ending.values[0].tolist() == ["failed", "converged"]
    assert "pull-off" in str(found.message.values[0, 0])
    for k, one in enumerate(reversed(each)):
        assert float(found.contact_radius[k, 1]) == pytest.approx(one.contact_radius, rel=1e-8)
        assert float(found.stiffness_on_branch[k, 1]) == pytest.approx(
            one.stiffness_on_branch, rel=1e-8
        )
    listed = sweep([sticky(load=-3.0, branch=k) for k in (0, 1)])
    assert listed.branch.values.tolist() == [0, 1]
    assert float(listed.contact_radius[0]) > float(listed.contact_radius[1])
    one = solve(sticky(load=0.0)).to_xarray(s=[0.0, 1.0])
    assert float(one.work_of_adhesion) == 1.0


def test_a_list_may_mix_scenes_with_and_without_it():
    scenes = [sticky(load=2.0), sticky(load=2.0).replace(work_of_adhesion=None)]
    found = sweep(scenes)
    assert found.ending.values.tolist() == ["converged", "converged"]
    without = solve(scenes[1], 1e-8, ["contact_radius"])
    assert float(found.contact_radius[1]) == pytest.approx(without.contact_radius, rel=1e-8)
    assert np.isfinite(found.stiffness_on_branch.values).tolist() == [True, False]


def test_sweeps_tell_errors_relative_to_the_value():
    # at this radius the load is 0 to seven digits, a difference of two larger parts
    scene = Scene(None, profile=profiles.Sphere(1.0), work_of_adhesion=0.01, load=0.0)
    radius = solve(scene, 1e-8).contact_radius
    scene = scene.replace(load=None, contact_radius=radius)
    asked = {"quantities": ["load"], "rtol": 1e-8}
    found = sweep(scene, contact_radius=[radius], progress=False, **asked)
    one = solve(scene, **asked)
    scale = one.error_scales["load"]
    assert abs(one.load) < 1e-7 * scale
    own = one.error.load * scale / abs(one.load)
    assert float(found.load_error[0]) == pytest.approx(own, rel=1e-12)


def test_sweeps_in_si_units_vary_it_and_have_the_stiffness():
    gel = Scene.from_physical(load=0.0, **GEL)
    found = sweep(gel, work_of_adhesion=["50 uJ/m^2", "0.1 mJ/m^2"])
    assert found.work_of_adhesion_si.values.tolist() == [5e-5, 1e-4]
    assert found.work_of_adhesion_si.units == "J/m^2"
    one = solve(gel.replace(work_of_adhesion=1e-4)).physical
    assert float(found.contact_radius_si[1]) == pytest.approx(one.contact_radius, rel=1e-8)
    stiffness = found.stiffness_on_branch_si
    assert float(stiffness[1]) == pytest.approx(one.stiffness_on_branch, rel=1e-8)
    assert stiffness.units == "N/m"
    table = sweep(gel, table={"load": [0.0, 1e-9], "work_of_adhesion": [5e-5, 1e-4]})
    last = solve(gel.replace(load=1e-9, work_of_adhesion=1e-4))
    assert float(table.contact_radius[1]) == pytest.approx(last.contact_radius, rel=1e-8)


def test_pull_off_of_a_sphere_is_found_where_the_curve_begins_next_to_its_equator():
    """The search began so close to it that radii were rounded to that of the sphere."""
    ball = {"profile": profiles.Sphere(8.28), "normal_compliance": 1060.0, "work_of_adhesion": 0.08}
    scene = Scene(0.3, load=0.0, **ball)
    found = pull_off(scene, rtol=1e-9)
    assert found.converged
    assert found.error.load <= 1e-9
    for factor in (0.98, 1.02):
        radius = factor * found.contact_radius
        beside = solve(scene.replace(load=None, contact_radius=radius), quantities=["load"])
        assert beside.load > found.load * (1.0 - found.error.load)


def test_reports_have_what_a_reader_asks(capsys):
    text = solve(sticky(approach=-0.5)).summary()
    for told in ("w = 1.0", "stiffness on branch", "pressure, edge", "-1.41421356", "taken back"):
        assert told in text
    assert "stable under control of the approach" in text
    zero = solve(sticky(load=None, contact_radius=1.0)).scene
    assert "taken back" in solve(zero).summary()
    options = [
        "--profile",
        "parabola",
        "--radius",
        "1",
        "--normal-compliance",
        "1",
        "--work-of-adhesion",
        "1",
    ]
    assert main(["solve", *options, "--load=-3", "--branch", "1"]) == 0
    assert "0.929219298194" in capsys.readouterr().out
    assert main(["solve", *options, "--load=-9"]) == 2
    assert "it is beyond by" in capsys.readouterr().err
    assert main(["sweep", *options, "--load=-3,1"]) == 0
    told = capsys.readouterr().out
    assert "2 converged" in told
    assert "stiffness_on_branch" in told


def test_comparisons_are_relative_to_both_parts_of_a_load():
    found = solve(sticky(load=0.0), rtol=1e-11)
    agreement = compare(found.scene, load=1e-6, approach=found.approach, pressure=found.pressure)
    by_name = {one.quantity: one for one in agreement.agreements}
    assert by_name["load"].error == pytest.approx(1e-6 / found.error_scales["load"], rel=1e-6)
    assert by_name["pressure"].error < 1e-10
    assert check_solution(found, found.scene, 1e-11).passed
    wrong = check_solution(found, found.scene.replace(work_of_adhesion=1.1), 1e-9, strict=False)
    assert [one.name for one in wrong.checks if not one.passed] == [
        "energy release rate is the work of adhesion"
    ]


# --- pull-off and cycles --------------------------------------------------------------------------


def test_arguments_of_pull_off_and_cycles_are_checked():
    scene = sticky(load=0.0)
    for given, name in (
        ({"control": "force"}, "control"),
        ({"machine_stiffness": 1.0}, "machine_stiffness"),
        ({"control": "approach", "machine_stiffness": 0.0}, "machine_stiffness"),
    ):
        with pytest.raises(SceneError, match=name):
            pull_off(scene, **given)
    for given in ({"points": 1}, {"points": 10**9}, {"rtol": 1.0}):
        with pytest.raises(SceneError, match=next(iter(given))):
            adhesion_cycle(scene, **given)
    with pytest.raises(SceneError, match="not flat"):
        adhesion_cycle(scene.replace(profile=profiles.Flat(1.0)))
    with pytest.raises(NotComputedError, match="shrinks to a point"):
        pull_off(sticky(profile=profiles.Cone(0.7), work_of_adhesion=0.01, load=1.0), "approach")


def test_a_stiffer_machine_comes_off_later():
    scene = sticky(load=0.0)
    ends = [pull_off(scene).contact_radius]
    for stiffness in (1.0, 10.0, 1e3):
        ends.append(pull_off(scene, "approach", machine_stiffness=stiffness).contact_radius)
    ends.append(pull_off(scene, "approach").contact_radius)
    assert ends == sorted(ends, reverse=True)
    soft = pull_off(scene, "approach", machine_stiffness=1e-9)
    assert soft.contact_radius == pytest.approx(ends[0], rel=1e-8)


def test_cycles_in_si_are_those_without_units():
    scene = Scene.from_physical(**GEL, load=1e-9, normal_compliance=1e-10)
    own = adhesion_cycle(scene, "approach", machine_stiffness=0.01, points=20)
    bare = adhesion_cycle(
        scene.replace(physical=None), "approach", machine_stiffness=0.01 / 2500.0, points=20
    )
    assert np.array_equal(own.load, bare.load)
    si = own.in_si()
    assert np.array_equal(si.load, own.load * 2500.0)
    assert si.machine_stiffness == pytest.approx(0.01, rel=1e-15)
    assert si.dissipated == own.dissipated * 2500.0
    assert si.in_si() is si
    with pytest.raises(NotComputedError, match="from_physical"):
        bare.in_si()


def test_a_contact_that_finds_its_hold_again_jumps_twice():
    soft = profiles.TruncatedCone(1.0, math.atan(1.0 / 0.06))
    scene = Scene(None, profile=soft, load=0.0, work_of_adhesion=0.005)
    cycle = adhesion_cycle(scene, "load", points=40)
    first, landed, last = cycle.jump_out
    assert landed.load == pytest.approx(first.load, rel=1e-12)
    assert 1.0 < landed.contact_radius < first.contact_radius
    assert pull_off(scene).contact_radius == last.contact_radius == 1.0
    assert last.load == pytest.approx(-4.0 * math.sqrt(2.0 * math.pi * 0.005), rel=1e-14)
    assert (cycle.dissipated, cycle.dissipated_error) == (None, None)
    # through a stiff machine it comes off at once
    assert len(adhesion_cycle(scene, "approach", points=40).jump_out) == 2


@pytest.mark.parametrize("control", ["load", "approach"])
def test_cycles_are_drawn_with_their_stable_part_and_both_jumps(control):
    pytest.importorskip("matplotlib")
    cycle = adhesion_cycle(sticky(load=1.0), control, points=30)
    [axes] = plotting.plot_adhesion_cycle(cycle).axes
    lines = {line.get_label(): line for line in axes.get_lines()}
    assert {"stable", "not stable", "jump into contact", "jump out of contact"} <= set(lines)
    drawn = lines["stable"].get_ydata()
    assert np.array_equal(drawn[cycle.stable], cycle.load[cycle.stable])
    assert np.isnan(drawn[~cycle.stable][1:]).all()
    with pytest.raises(SceneError, match="cycle"):
        plotting.plot_adhesion_cycle(cycle.scene)


@pytest.mark.parametrize("adhesion", [1e-100, 1e100])
def test_a_radius_of_pull_off_out_of_range_is_said_of_the_work_of_adhesion(adhesion):
    """The error was about a contact radius, which nobody had given."""
    scene = Scene(0.3, 1.0, profile=BALL, load=0.0, work_of_adhesion=adhesion)
    with pytest.raises(SceneError, match=r"^work_of_adhesion = .* contact_radius of pull-off"):
        pull_off(scene, quantities=("load",))


def test_pull_off_under_the_thinnest_layer_is_that_of_a_smooth_surface():
    """The rate of the load was rounding, and a root finder raised a ValueError."""
    scene = Scene(0.3, 1e-3, profile=BALL, load=0.0, work_of_adhesion=1e30)
    last = pull_off(scene, quantities=("load",))
    assert last.load == pytest.approx(-1.5e30 * math.pi, rel=1e-10)


def test_a_machine_whose_compliance_is_infinite_is_refused():
    """It was said that the contact shrinks to a point before it comes off."""
    with pytest.raises(SceneError, match=r"machine_stiffness = .* in \[1e-308"):
        pull_off(sticky(load=0.0), "approach", machine_stiffness=1e-310)
