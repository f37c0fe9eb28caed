"""Studies: what a solver must have, whose truth it is, what is measured, what is printed."""

import itertools
import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import peers
import pytest

from spectral_contact import NotComputedError, Scene, SceneError, gold, profiles, solve
from spectral_contact.precise import certified, reference
from spectral_contact.studies import (
    QUANTITIES,
    OwnSolver,
    convergence,
    named_solver,
    this_machine,
    truth_of,
    work_precision,
)
from spectral_contact.studies import study as study_module

NORMAL = Scene(0.1, 0.5)
SLIPPING = Scene(0.1, 0.5, 0.5, 0.1)
#: What `peers.Decaying` converges to.
LIMIT = SimpleNamespace(approach=0.25, pressure=lambda s: 1.0 + np.asarray(s) ** 2)


def decaying(scene, count):
    return peers.Decaying(scene, count)


# --- truth ----------------------------------------------------------------------------------------


def entry(scene):
    [found] = [s for table in gold.tables() for s in table.solutions if s.scene == scene]
    return found


def test_gold_is_the_truth_where_it_is():
    true, table = truth_of(SLIPPING), entry(SLIPPING)
    assert true.source == "gold table slip_equal, 27 digits"
    assert true.quantities == QUANTITIES
    assert true.scalars["approach"] == float(table.approach)
    assert true.scalars["edge_pressure"] == float(table.points[-1].pressure)
    assert list(true.from_edge) == [point.from_edge for point in table.points]
    assert list(true.fields["traction"]) == [float(point.traction) for point in table.points]
    assert true.error["traction"] == table.error.traction
    assert true.error["edge_pressure"] == table.error.pressure


def test_what_is_known_by_definition_is_not_studied():
    assert truth_of(NORMAL).quantities == ("approach", "edge_pressure", "pressure")
    assert "stick_radius" not in truth_of(Scene(0.1, 0.5, 0.5, math.inf)).quantities
    frictionless = truth_of(Scene(0.3, 0.5, 0.5, 0.0))
    assert frictionless.quantities == ("approach", "edge_pressure", "pressure")
    # the pressure under a profile is zero at the edge
    sphere = Scene(0.3, 0.1, profile=profiles.Sphere(1.0), load=0.01)
    assert truth_of(sphere, solve(sphere, 1e-6)).quantities == ("approach", "pressure")
    smooth = truth_of(Scene(0.3, 0.0, 0.0, math.inf))
    assert smooth.quantities == ("approach", "pressure", "traction", "total_shear")


def test_without_friction_the_normal_compliance_alone_matters():
    true = truth_of(Scene(0.45, 0.5, 3.0))
    assert true.source == "gold table frictionless, 27 digits"
    assert true.scene == Scene(0.45, 0.5, 3.0)


def test_si_data_do_not_matter():
    data = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "radius": 1e-3, "load": 1.0}
    assert truth_of(Scene.from_physical(**data)).source.startswith("gold")


def test_other_scenes_are_solved_by_reference(capsys, monkeypatch):
    found, original = [], certified.certified

    def kept(*arguments, **options):
        found.append(original(*arguments, **options))
        return found[0]

    monkeypatch.setattr(certified, "certified", kept)
    true = truth_of(Scene(0.3, 0.7), progress=True)
    assert true.source == "reference, 20 digits"
    assert "100 %" in capsys.readouterr().err
    assert true.error["approach"] <= 1e-18
    own = solve(Scene(0.3, 0.7), 1e-12)
    errors = true.errors(own, true.quantities)
    assert max(errors.values()) < 1e-12
    assert truth_of(Scene(0.3, 0.7), found[0]).scalars == true.scalars


def test_a_scene_that_nobody_solves_needs_a_truth():
    scene = Scene(0.3, friction=Scene(0.3).kappa / 80)  # the stick disk is smaller than 1e-65
    with pytest.raises(NotComputedError, match="reference"):
        truth_of(scene)
    given = truth_of(scene, solve(scene, 1e-11))
    assert given.source == "Solution, given"
    assert given.error["total_shear"] > 0.0


def test_a_truth_must_fit():
    with pytest.raises(SceneError, match="truth"):
        truth_of(SLIPPING, entry(NORMAL))
    with pytest.raises(SceneError, match="approach, edge_pressure"):
        truth_of(NORMAL, object())
    with pytest.raises(SceneError, match="scene"):
        truth_of("steel")
    assert truth_of(NORMAL, truth_of(NORMAL)).scalars == truth_of(NORMAL).scalars


def test_errors_are_relative_and_of_the_worst_point():
    true, own = truth_of(SLIPPING), solve(SLIPPING, 1e-12)

    class Wrong:
        approach = own.approach * (1 + 1e-6)
        total_shear = own.total_shear
        stick_radius = own.stick_radius * (1 - 1e-5)

        def pressure(self, *, from_edge):
            return own.pressure(from_edge=from_edge) * np.where(from_edge == 1e-6, 0.99, 1.0)

        def traction(self, s):
            return own.traction(s) + np.where(s == 0.0, 1e-3, 0.0)

    errors = true.errors(Wrong(), QUANTITIES)
    assert errors["approach"] == pytest.approx(1e-6, rel=1e-6)
    assert errors["stick_radius"] == pytest.approx(1e-5, rel=1e-6)
    assert errors["pressure"] == pytest.approx(1e-2, rel=1e-6)
    assert errors["edge_pressure"] < 1e-13
    assert errors["traction"] == pytest.approx(1e-3, rel=1e-9)  # zero at the centre: absolute
    assert errors["total_shear"] < 1e-13


def test_an_error_that_is_no_number_is_infinite():
    errors = truth_of(NORMAL).errors(
        SimpleNamespace(approach=math.nan, pressure=lambda s: np.where(s > 0.9, np.nan, 1.0)),
        QUANTITIES[:3],
    )
    assert set(errors.values()) == {math.inf}


# --- convergence ----------------------------------------------------------------------------------


def test_the_orders_of_a_solver_are_found():
    study = convergence(decaying, NORMAL, [8, 16, 32, 64], LIMIT, repeats=1)
    assert study.solver == "decaying"
    assert study.quantities == ("approach", "edge_pressure", "pressure")
    assert [point.unknowns for point in study.points] == [24, 48, 96, 192]
    assert [point.errors["approach"] for point in study.points] == pytest.approx(
        [8**-2, 16**-2, 32**-2, 64**-2]
    )
    assert study.rates["approach"].value == pytest.approx(2.0, abs=1e-9)
    assert study.rates["pressure"].value == pytest.approx(1.0, abs=1e-9)
    assert all(point.times.cold is None for point in study.points)


def test_the_library_is_honest_in_its_own_study():
    study = convergence(OwnSolver(), SLIPPING, [1e-2, 1e-5, 1e-8, 1e-11], repeats=0)
    assert study.quantities == QUANTITIES
    for point in study.points:
        assert point.times is None
        for name, error in point.errors.items():
            slack = 2.0 * point.estimates["stick_radius"] if name == "traction" else 0.0
            assert error <= point.estimates[name] + slack + 4 * 2.0**-52
    unknowns = [point.unknowns for point in study.points]
    assert unknowns == sorted(unknowns)


def test_times_are_cold_and_warm():
    study = convergence(OwnSolver(("approach",)), NORMAL, [1e-4], repeats=9)
    [point] = study.points
    assert point.times.cold.median > point.times.warm.median > 0.0
    assert point.times.cold.repeats == 9
    assert point.errors.keys() == {"approach"}
    assert study.quantities == ("approach",)


def test_whole_resolutions_are_unknowns_if_nothing_else_is():
    def bare(scene, count):
        return SimpleNamespace(approach=0.25 + count**-3)

    assert [p.unknowns for p in convergence(bare, NORMAL, [8, 16], LIMIT, repeats=0).points] == [
        8,
        16,
    ]
    [point] = convergence(bare, NORMAL, [8.5], LIMIT, repeats=0).points
    assert point.unknowns is None


def test_what_a_solver_raises_is_kept_and_the_study_goes_on():
    def fragile(scene, count):
        if count == 16:
            raise MemoryError("too\nmuch")
        return peers.Decaying(scene, count)

    study = convergence(fragile, NORMAL, [8, 16, 32, 64], LIMIT, repeats=0)
    assert [bool(point.errors) for point in study.points] == [True, False, True, True]
    assert study.points[1].failure == "MemoryError: too much"
    assert study.rates["approach"].used == (0, 2, 3)
    assert "MemoryError: too much" in str(study)


def test_a_quantity_that_is_asked_for_must_be_there():
    with pytest.raises(SceneError, match=r"solver = 'decaying': must be .* have total_shear"):
        convergence(
            decaying,
            SLIPPING,
            [8],
            quantities=["approach", "total_shear"],
            repeats=0,
        )
    with pytest.raises(SceneError, match="approach or edge_pressure or pressure"):
        convergence(lambda scene, count: None, NORMAL, [8], repeats=0)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"resolutions": []}, "resolutions"),
        ({"resolutions": [8, 8]}, "resolutions"),
        ({"resolutions": [-1]}, "resolutions = -1"),
        ({"resolutions": 8}, "resolutions"),
        ({"resolutions": [True]}, "resolutions"),
        ({"quantities": ["wear"]}, "quantities = 'wear'"),
        ({"quantities": []}, "quantities"),
        ({"quantities": ["traction"]}, "among what the truth has here"),
        ({"quantities": ["aproach"]}, "did you mean approach?"),
        ({"quantities": 1}, "quantities = 1"),
        ({"solver": 3}, "solver = 3"),
        ({"repeats": -1}, "repeats = -1"),
        ({"repeats": 10**9}, "repeats = 1000000000: must be a whole number in"),
        ({"name": 1}, "name = 1"),
        ({"progress": "no"}, "progress = 'no'"),
        ({"resolutions": itertools.count(1)}, "resolutions"),
        ({"scene": None}, "scene"),
    ],
)
def test_bad_requests_are_refused_before_any_work(change, named):
    def never(scene, resolution):
        raise AssertionError

    request = {"solver": never, "scene": NORMAL, "resolutions": [8], **change}
    with pytest.raises(SceneError, match=named):
        convergence(**request)


@pytest.mark.parametrize("estimate", ["none", True, 1j, [0.1]])
def test_an_estimate_that_is_no_number_is_a_failure(estimate):
    solution = SimpleNamespace(approach=0.25, error=SimpleNamespace(approach=estimate))
    study = convergence(lambda scene, count: solution, NORMAL, [8], LIMIT, repeats=0)
    assert study.points[0].errors == {"approach": 0.0}
    assert study.points[0].failure.startswith("SceneError: error.approach = ")


def test_an_estimate_that_is_nan_is_one_of_no_digit():
    said = SimpleNamespace(approach=0.25, error=SimpleNamespace(approach=math.nan))
    study = convergence(lambda scene, count: said, NORMAL, [8], said, repeats=0)
    assert study.points[0].estimates == study.truth_error == {"approach": math.inf}
    assert study.rate("approach") is None


def test_a_negative_estimate_is_refused_by_name():
    said = SimpleNamespace(approach=0.25, error=SimpleNamespace(approach=-1e-3))
    with pytest.raises(SceneError, match=r"^error\.approach = -0\.001: must be at least 0"):
        truth_of(NORMAL, said)


def test_a_study_goes_on_where_an_error_is_zero():
    exact = SimpleNamespace(approach=0.25)
    study = convergence(lambda scene, count: exact, NORMAL, [8, 16, 32], exact, repeats=0)
    assert [point.errors["approach"] for point in study.points] == [0.0, 0.0, 0.0]


def test_the_pressure_at_the_edge_may_be_negative():
    scene = Scene(0.0, 1e-4, 1e-4, math.inf, coupling=True)
    study = convergence(OwnSolver(), scene, [1e-4], solve(scene, 1e-10), repeats=0)
    assert solve(scene).pressure(1.0) < 0.0
    assert study.points[0].errors["edge_pressure"] < 1e-4


def test_truths_may_be_infinite_at_the_edge():
    true = truth_of(Scene(0.1), reference(Scene(0.1), 15))
    assert true.fields["pressure"][-1] == math.inf
    assert true.errors(solve(Scene(0.1)), ["pressure"])["pressure"] < 1e-14


@pytest.mark.parametrize(
    "value", [True, "0.25", 0.25 + 0j, [0.25], np.datetime64("NaT", "s"), object()]
)
def test_what_is_no_number_is_a_failure_and_no_error(value):
    found = [
        convergence(lambda scene, count, one=one: one, NORMAL, [8], LIMIT, repeats=0)
        for one in (
            SimpleNamespace(approach=value),
            SimpleNamespace(pressure=lambda s: value),
        )
    ]
    for study, name in zip(found, ("approach", "pressure"), strict=True):
        [point] = study.points
        assert point.errors == {}
        assert point.failure.startswith(f"SceneError: solution.{name} = ")
    with pytest.raises(SceneError, match=r"truth\.approach = "):
        truth_of(NORMAL, SimpleNamespace(approach=value))


def test_a_study_is_asked_for_what_it_has():
    study = convergence(decaying, NORMAL, [8, 16, 32], LIMIT, repeats=0)
    with pytest.raises(SceneError, match=r"quantity = 'aproach'.*did you mean approach"):
        study.rate("aproach")
    compared = work_precision({"mine": decaying}, NORMAL, [0.5], [LIMIT], repeats=1)
    with pytest.raises(SceneError, match=r"solver = 'Mine'.*did you mean mine"):
        compared.of("Mine", NORMAL)
    with pytest.raises(SceneError, match=r"scene = .*: must be a scene of the study"):
        compared.of("mine", Scene(0.2))


def test_a_study_as_text():
    study = convergence(decaying, NORMAL, [8, 16, 32, 64], LIMIT, repeats=1, name="mine")
    text = str(study)
    assert text.startswith("mine: nu = 0.1, alpha* = 0.5, beta* = 0.0, no friction\ntruth: ")
    assert "order 2.000 [2.000, 2.000], algebraic, points 1, 2, 3, 4 of 4" in text
    assert f"numpy {np.__version__}" in text
    assert this_machine()["numpy"] == np.__version__
    assert "1.6e-02" in text
    bare = str(convergence(decaying, NORMAL, [8, 16], LIMIT, repeats=0))
    assert "warm" not in bare
    assert "machine" not in bare
    assert "none: fewer than three points" in bare


# --- work and precision ---------------------------------------------------------------------------


def test_the_time_to_reach_an_accuracy_is_the_least():
    found = work_precision(
        {"mine": (decaying, [8, 16, 32, 64, 128])},
        NORMAL,
        [1e-2, 1e-3, 1e-9],
        [LIMIT],
        quantities=["approach"],
        repeats=1,
    )
    assert found.accuracies == (1e-2, 1e-3, 1e-9)
    assert len(found.points) == 5
    times = [point.times.warm.median for point in found.points]
    assert found.reached("mine", NORMAL, "approach", 1e-2) == min(times[1:])
    assert found.reached("mine", NORMAL, "approach", 1e-3) == min(times[2:])
    assert found.reached("mine", NORMAL, "approach", 1e-9) is None
    assert found.reached("mine", NORMAL, "approach", 1e-2, cold=True) is None


def test_a_solver_stops_where_the_least_accuracy_is_reached():
    found = work_precision(
        {"mine": (decaying, [8, 16, 32, 64, 128])},
        NORMAL,
        [1e-1, 1e-3],
        [LIMIT],
        quantities=["approach"],
        repeats=1,
    )
    assert [point.resolution for point in found.points] == [8, 16, 32]


def test_solvers_are_compared_on_every_scene():
    scenes = [NORMAL, Scene(0.2, 1e-4)]
    found = work_precision(
        {"ours": OwnSolver(("approach",)), "theirs": (decaying, [8, 16])},
        scenes,
        [1e-6, 1e-2, 1e-1],
        quantities=["approach"],
        repeats=1,
    )
    assert found.solvers == ("ours", "theirs")
    assert found.accuracies == (1e-1, 1e-2, 1e-6)
    assert [len(found.of("ours", scene)) for scene in scenes] == [1, 1]  # superconvergent
    assert all(found.reached("ours", scene, "approach", 1e-6) for scene in scenes)
    text = str(found)
    assert text.count("approach to") == 2
    assert "theirs [ms]" in text
    assert "truth: gold table frictionless, 27 digits" in text
    ours, theirs = (found.reached(name, NORMAL, "approach", 0.2) for name in found.solvers)
    assert theirs is not None
    assert ours is not None


def test_failures_are_listed():
    def failing(scene, count):
        raise ValueError("no")

    found = work_precision({"ours": decaying, "theirs": failing}, NORMAL, [0.5], [LIMIT], repeats=1)
    assert "theirs at 0.5: ValueError: no" in str(found)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"solvers": {}}, "solvers"),
        ({"solvers": [decaying]}, "solvers"),
        ({"solvers": {"a": 3}}, "solvers = 3"),
        ({"solvers": {1: decaying}}, "solvers = 1"),
        ({"solvers": {"a": (decaying, [])}}, "solvers"),
        ({"solvers": {"a": (decaying, itertools.count(1))}}, "solvers"),
        ({"scenes": 1}, "scenes = 1"),
        ({"scenes": [[NORMAL]]}, "scenes"),
        ({"truths": 1}, "truths = 1"),
        ({"quantities": 1}, "quantities = 1"),
        ({"repeats": 2.5}, r"repeats = 2\.5"),
        ({"progress": 1}, "progress = 1"),
        ({"scenes": []}, "scenes"),
        ({"scenes": [NORMAL, NORMAL]}, "scenes"),
        ({"accuracies": [1.0]}, "accuracies = 1.0"),
        ({"accuracies": []}, "accuracies"),
        ({"truths": [None, None]}, "truths"),
        ({"repeats": 0}, "repeats = 0"),
    ],
)
def test_bad_comparisons_are_refused(change, named):
    request = {"solvers": {"a": decaying}, "scenes": [NORMAL], "accuracies": [1e-2], **change}
    with pytest.raises(SceneError, match=named):
        work_precision(**request)


# --- solvers --------------------------------------------------------------------------------------


def test_solvers_by_name():
    assert named_solver("peers:Decaying") is peers.Decaying
    assert named_solver("os:path.join").__name__ == "join"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("peers", "module:function"),
        (":f", "module:function"),
        ("no_such_module:f", "ModuleNotFoundError"),
        ("peers:missing", "AttributeError"),
        ("peers:__doc__", "a callable"),
    ],
)
def test_bad_names_are_refused(name, said):
    with pytest.raises(SceneError, match=said):
        named_solver(name)


def test_solvers_have_names():
    assert study_module._name(OwnSolver()) == "spectral_contact"
    assert study_module._name(peers.Decaying) == "Decaying"
    assert study_module._name(partial(decaying)) == "decaying"
    assert study_module._name(SimpleNamespace(name=3)) == "SimpleNamespace"


def test_the_library_takes_loose_accuracies():
    assert OwnSolver(("approach",))(NORMAL, 0.5).rtol == 1e-2
