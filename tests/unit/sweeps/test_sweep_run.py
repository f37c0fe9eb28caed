"""Sweeps: the same numbers as `solve`, in named dimensions, whatever happens to single scenes."""

import itertools
import math

import numpy as np
import pytest

from spectral_contact import QUANTITIES, Scene, SceneError, SolutionFileError, solve
from spectral_contact.gold import tables
from spectral_contact.profiles import Parabola
from spectral_contact.solving.solver import Continuation
from spectral_contact.sweeps import error_maps, lines, shortcuts, sweep, sweep_run
from spectral_contact.sweeps.request import SCALARS
from spectral_contact.sweeps.sweep_parameters import SweepParameters

xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")

ALPHAS, FRICTIONS = [0.0, 0.05, 0.5], [0.05, 0.1, math.inf]
BASE = Scene(0.3, 0.5, 0.5, 0.1)


@pytest.fixture
def always_shared(monkeypatch):
    """Take the spectra for sweeps of any size."""
    monkeypatch.setattr(sweep_run, "_PAIRS_FOR_SPECTRA", 1)


@pytest.fixture
def asked(monkeypatch):
    """Return the list of the scenes that are solved one by one, which grows as they are."""
    scenes = []
    original = Continuation.solve
    monkeypatch.setattr(
        Continuation,
        "solve",
        lambda self, scene: scenes.append(scene) or original(self, scene),
    )
    return scenes


def test_a_grid_has_the_numbers_of_solve_and_their_estimates():
    found = sweep(BASE, normal_compliance=ALPHAS, friction=FRICTIONS)
    assert found.sizes == {"normal_compliance": 3, "friction": 3}
    assert (found.ending == "converged").all()
    assert (found.message == "").all()
    for alpha in ALPHAS:
        for friction in FRICTIONS:
            scene = Scene(0.3, alpha, 0.5, friction)
            solution = solve(scene, 1e-8, SCALARS)
            here = found.sel(normal_compliance=alpha, friction=friction)
            for name in SCALARS:
                value, error = getattr(solution, name), getattr(solution.error, name)
                swept, swept_error = float(here[name]), float(here[f"{name}_error"])
                # boundaries come from another start, and with them the last digits
                assert abs(swept - value) <= (error + swept_error) * abs(value)
                assert swept_error <= 1e-8


def test_coordinates_have_names_units_and_meanings():
    found = sweep(BASE, friction=FRICTIONS, quantities=["stick_radius", "slip"], from_edge=[0, 0.1])
    assert found.slip.dims == ("friction", "from_edge")
    assert np.array_equal(found.s, [1.0, 0.9])
    assert float(found.poisson_ratio) == 0.3
    for name in (*found.coords, *found.data_vars):
        assert found[name].attrs["long_name"]
        assert found[name].attrs.get("units") or name in ("ending", "message")
    assert found.attrs["rtol"] == 1e-8


def test_fields_at_given_places_are_a_dimension():
    s = [0.0, 0.5, 1.0]
    found = sweep(BASE, friction=[0.05, 0.2], quantities=["pressure", "traction"], s=s)
    assert found.pressure.dims == found.traction.dims == ("friction", "s")
    for i, friction in enumerate((0.05, 0.2)):
        solution = solve(Scene(0.3, 0.5, 0.5, friction), 1e-8, ["pressure", "traction"])
        assert np.allclose(found.pressure[i], solution.pressure(s), rtol=1e-13, atol=0)
        assert np.allclose(found.traction[i], solution.traction(s), rtol=1e-13, atol=0)


def test_zones_are_padded():
    scenes = [Scene(0.3, 0.05, 1.0, 0.23 / 7), BASE, Scene(0.3, 0.5, 0.5)]
    found = sweep(scenes, quantities=["zones"], rtol=1e-4)
    assert found.sizes == {"scene": 3, "zone": 3}
    assert found.zone_kind.values.tolist() == [[1, 2, 1], [1, 2, 0], [0, 0, 0]]
    zones = solve(scenes[0], 1e-4, ["zones"]).zones
    expected = [zone.outer for zone in zones]
    assert np.allclose(found.zone_outer[0], expected, rtol=1e-12)
    assert np.isnan(found.zone_outer[2]).all()
    assert found.zone_outer_from_edge[0, -1] == 0.0


def test_a_list_keeps_its_order_and_scenes_without_friction_have_no_ratios():
    scenes = [Scene(0.2, 0.5, 0.3, 0.2), Scene(0.1, 0.1), Scene(0.5, 0.1, 0.1, 0.3), BASE]
    found = sweep(iter(scenes))
    assert np.array_equal(found.normal_compliance, [0.5, 0.1, 0.1, 0.5])
    assert np.isnan(found.friction[1])
    assert np.isnan(found.edge_ratio[1])
    assert np.isnan(found.stick_radius[1])
    assert (found.ending == "converged").all()
    expected = [solve(scene).approach for scene in scenes]
    assert np.allclose(found.approach, expected, rtol=1e-9)
    assert float(found.edge_ratio[2]) == 0.0


def test_one_scene_is_a_dataset_without_dimensions():
    found = sweep(BASE, quantities=["approach"])
    assert found.approach.dims == ()
    assert float(found.approach) == pytest.approx(0.2929597969104781, rel=1e-8)


def test_a_scene_that_fails_is_recorded_and_the_rest_goes_on(monkeypatch):
    original = Continuation.solve

    def failing(self, scene):
        if scene.friction == 0.05:
            raise FloatingPointError("of a kind\nnobody expects")
        return original(self, scene)

    monkeypatch.setattr(Continuation, "solve", failing)
    found = sweep(BASE, friction=[0.03, 0.05, 0.1], quantities=["stick_radius", "zones"])
    assert found.ending.values.tolist() == ["converged", "failed", "converged"]
    assert found.message.values.tolist() == ["", "FloatingPointError: of a kind nobody expects", ""]
    assert np.isnan(found.stick_radius.values).tolist() == [False, True, False]
    assert np.isnan(found.zone_outer.values).all(axis=1).tolist() == [False, True, False]


def test_a_scene_that_does_not_converge_has_what_was_reached_and_the_remedy():
    found = sweep(BASE, friction=[0.1], quantities=["total_shear"], rtol=1e-12, max_unknowns=40)
    assert found.ending.values.tolist() == ["unknowns"]
    assert "Raise max_unknowns" in str(found.message.values[0])
    assert float(found.total_shear_error[0]) > 1e-12
    truth = solve(BASE, 1e-12).total_shear
    assert float(found.total_shear[0]) == pytest.approx(truth, rel=1e-2)


def test_what_is_not_asked_for_is_not_computed():
    found = sweep(BASE, friction=[0.1], quantities=["edge_ratio"])
    assert set(found.data_vars) == {"edge_ratio", "edge_ratio_error", "ending", "message"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"friction": [0.1, -0.2]}, "friction = -0.2: must be >= 0"),
        ({"friction": [0.1, math.nan]}, "friction = nan: must be >= 0"),
        ({"friction": -0.1}, "friction = -0.1: must be >= 0"),
        ({"friction": True}, "friction = True: must be a real number"),
        ({"friction": "0.1"}, "friction = '0.1': must be a real number, a list of real numbers"),
        ({"friction": np.array(0.1)}, "friction = array(0.1): must be a list of at least one"),
        ({"friction": []}, "friction = []: must be a list of at least one number"),
        ({"friction": [[0.1]]}, "friction = [[0.1]]: must be a list of at least one number"),
        ({"friction": ["a"]}, "friction = ['a']: must be a real number, a list of real numbers"),
        ({"friction": [True, 0.2]}, "friction = [True, 0.2]: must be a real number"),
        ({"normal_compliance": [1.0, 1e-15]}, "normal_compliance = 1e-15: must be 0 or in"),
        ({"poisson_ratio": [0.3, 0.6]}, "poisson_ratio = 0.6: must be in (-1, 0.5]"),
        ({"quantities": ["stick"]}, "quantities = 'stick': must be one of approach"),
        ({"quantities": ["aproach"]}, "quantities = 'aproach': must be one of approach"),
        ({"progress": 1}, "progress = 1: must be True or False"),
        ({"quantities": "approach"}, "quantities = 'approach': must be a list of names"),
        ({"quantities": []}, "quantities = []: must be at least one name"),
        (
            {"quantities": ["slip"]},
            "quantities = 'slip': must be given with its radii (s= or from_edge=)",
        ),
        ({"s": [0.5]}, "s = [0.5]: must be None without a field"),
        ({"quantities": ["slip"], "s": 0.5}, "s = 0.5: must be a list of radii"),
        ({"quantities": ["slip"], "s": [2.0]}, "s = 2.0: must be in [0, 1]"),
        ({"rtol": 1e-20}, "rtol = 1e-20: must be in [1e-13, 1e-2]"),
        ({"rtol": 1e-13}, "rtol = 1e-13: must be at least 1e-12 unless"),
        ({"chunk": 0}, "chunk = 0: must be a whole number >= 1"),
        ({"max_unknowns": 0}, "max_unknowns = 0: must be a whole number >= 1"),
        ({"executor": 2}, "executor = 2: must be a concurrent.futures.Executor, or None"),
    ],
)
def test_bad_input_is_named(arguments, message):
    with pytest.raises(SceneError) as caught:
        sweep(BASE, **arguments)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("scenes", "arguments", "message"),
    [
        ([], {}, "scenes = []: must be at least one Scene"),
        ([BASE, 3], {}, "scenes[1] = 3: must be a Scene"),
        (itertools.repeat(3), {}, "scenes[0] = 3: must be a Scene"),  # without end
        (3, {}, "scenes = 3: must be a Scene or a list of them"),
        ([BASE], {"friction": [0.1]}, "friction = [0.1]: must be None with a list of scenes"),
    ],
)
def test_bad_scenes_are_named(scenes, arguments, message):
    with pytest.raises(SceneError) as caught:
        sweep(scenes, **arguments)
    assert str(caught.value).startswith(message)


def test_a_single_number_is_that_of_all_scenes():
    asked = {"quantities": ["approach", "stick_radius"]}
    found = sweep(BASE, normal_compliance=[0.1, 0.5], friction=0.05, **asked)
    assert found.sizes == {"normal_compliance": 2}
    assert found.friction == 0.05
    assert found.identical(sweep(Scene(0.3, 0.5, 0.5, 0.05), normal_compliance=[0.1, 0.5], **asked))
    several = sweep([BASE, Scene(0.3, 0.5, 0.5)], friction=0.05, **asked)
    assert several.identical(sweep([Scene(0.3, 0.5, 0.5, 0.05)] * 2, **asked))


def test_scenes_with_elastic_coupling_are_those_of_solve():
    base, friction = Scene(0.3, 0.5, 0.5, coupling=True), [0.05, math.inf]
    names = ["approach", "total_shear", "stick_radius"]
    found = sweep(base, friction=friction, quantities=names, rtol=1e-4)
    assert bool(found.coupling)
    for i, one in enumerate(friction):
        solution = solve(base.replace(friction=one), 1e-4, names)
        for name in names:
            assert float(found[name][i]) == getattr(solution, name)
            assert float(found[f"{name}_error"][i]) == getattr(solution.error, name)
    plain = sweep(base, friction=friction, quantities=names, rtol=1e-4, coupling=False)
    assert (plain.approach > found.approach).all()
    scenes = [base.replace(friction=one, coupling=on) for on in (False, True) for one in friction]
    mixed = sweep(scenes, quantities=names, rtol=1e-4)
    assert mixed.coupling.values.tolist() == [False, False, True, True]
    np.testing.assert_array_equal(mixed.approach[2:], found.approach)
    np.testing.assert_array_equal(mixed.approach[:2], plain.approach)
    with pytest.raises(SceneError, match="coupling"):
        sweep(base, friction=friction, coupling=[True])


@pytest.mark.parametrize("coupling", [False, True])
def test_stores_know_coupling(coupling, tmp_path):
    asked = {"friction": [0.1], "quantities": ["approach"], "rtol": 1e-3, "store": tmp_path / "a"}
    sweep(Scene(0.3, 0.5, 0.5, coupling=coupling), **asked)
    with pytest.raises(SolutionFileError, match="another sweep"):
        sweep(Scene(0.3, 0.5, 0.5, coupling=not coupling), **asked)


def test_which_of_like_scenes_is_coupled_makes_another_sweep():
    plain, coupled = (Scene(0.3, 0.5, 0.5, 0.1, coupling=on) for on in (False, True))
    orders = [plain, coupled], [coupled, plain], [plain, plain], [coupled, coupled]
    assert len({sweep_run.listed(scenes).fingerprint() for scenes in orders}) == 4


def test_neither_spectra_nor_lines_take_coupled_scenes_for_others():
    friction = np.geomspace(0.02, 0.2, 30)
    scenes = [Scene(0.3, 0.5, 0.5, f, coupling=True) for f in friction]
    columns = sweep_run.listed(scenes).columns(np.arange(len(scenes)))
    request = sweep_run.requested(["stick_radius"], 1e-4, 1000, None, None)
    assert not shortcuts.served_by_spectra(columns, request).mask.any()
    assert not list(lines.lines(columns, np.arange(len(scenes)), request))
    plain = [one.replace(coupling=False) for one in scenes]
    columns = sweep_run.listed(plain).columns(np.arange(len(scenes)))
    assert list(lines.lines(columns, np.arange(len(scenes)), request))


def test_a_missing_xarray_is_said_before_the_work(monkeypatch):
    import sys

    from spectral_contact import MissingDependencyError

    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(MissingDependencyError, match=r'"\.\[sweep\]"'):
        sweep(BASE)


# --- the spectra ----------------------------------------------------------------------------------


def random_compliances(count, low=-14.0, high=14.0, seed=0):
    return 10.0 ** np.random.default_rng(seed).uniform(low, high, (2, count))


@pytest.mark.parametrize(
    ("alpha", "beta"),
    [
        (1.7898407193182815e-05, 0.000578126341820688),  # errors of a third of the estimate
        (1.355e-08, 6.53e-05),  # the maximum is next to an end of a panel: 6 times what a map says
        (10.0, 1.2e-6),  # degrees 16, 18 and 20 round alike at the edge
        (5.4424555500076804e-08, 6.271459273939012e-06),  # an error of an eighth of the estimate
    ],
)
def test_ratios_are_honest_where_estimates_are_sharp(alpha, beta):
    spectra = error_maps.certified_stick(1e-12)
    (_, [edge]), (_, [edge_error]) = spectra.shear_and_edge(np.array([alpha]), np.array([beta]))
    [critical], [estimate] = spectra.critical(np.array([alpha]), np.array([beta]), np.array([edge]))
    scene = Scene(0.3, alpha, beta, math.inf)
    truth = solve(scene, 1e-12, ["critical_friction", "edge_ratio"])
    assert abs(critical * scene.kappa / truth.critical_friction - 1.0) <= estimate
    assert abs(abs(edge) * scene.kappa / truth.edge_ratio - 1.0) <= edge_error


@pytest.mark.parametrize(
    ("alpha", "beta"),
    [(6.1033578544772e8, 1.863151026216861e-12), (1.328809025646723e-9, 1.809642739524527e-12)],
)
def test_the_edge_ratio_is_honest_where_two_degrees_agree_by_accident(alpha, beta):
    """At the nearest compliances of the lattice they do, and not within a decade around."""
    spectra = error_maps.certified_stick(1e-8)
    (_, [edge]), (_, [estimate]) = spectra.shear_and_edge(np.array([alpha]), np.array([beta]))
    scene = Scene(0.3, alpha, beta, math.inf)
    truth = solve(scene, 1e-12, ["edge_ratio"])
    error = abs(abs(edge) * scene.kappa / truth.edge_ratio - 1.0)
    assert truth.error.edge_ratio < 0.1 * error
    assert error <= estimate


@pytest.mark.parametrize("rtol", [1e-8, 1e-12])
def test_one_decomposition_has_the_approach_and_the_edge_pressure_of_solve(always_shared, rtol):
    alphas = np.sort(random_compliances(40)[0])
    arguments = {"quantities": ["approach", "pressure"], "from_edge": [0.0], "rtol": rtol}
    found = sweep(Scene(0.3), normal_compliance=alphas, **arguments)
    for i, alpha in enumerate(alphas):
        solution = solve(Scene(0.3, alpha), 1e-12)
        limit = 1e-15 + solution.error.approach + found.approach_error[i]
        assert abs(found.approach[i] / solution.approach - 1.0) <= limit
        limit = 1e-15 + solution.error.pressure + found.pressure_error[i]
        assert abs(found.pressure[i, 0] / solution.pressure(1.0) - 1.0) <= limit
    assert found.approach_error.max() < 1e-14
    assert found.pressure_error.max() < 1e-14


@pytest.mark.parametrize("rtol", [1e-8, 1e-12])
@pytest.mark.parametrize(("low", "high"), [(-14.0, 14.0), (-4.0, 1.0)])
def test_two_decompositions_have_the_full_stick_of_solve(always_shared, rtol, low, high):
    names = ["total_shear", "edge_ratio", "critical_friction"]
    alphas, betas = random_compliances(25, low, high)
    scenes = [Scene(0.1, a, b, math.inf) for a, b in zip(alphas, betas, strict=True)]
    found = sweep(scenes, quantities=names, rtol=rtol)
    for i, scene in enumerate(scenes):
        solution = solve(scene, 1e-12, names, strict=False)
        for name in names:
            error = abs(float(found[name][i]) / getattr(solution, name) - 1.0)
            own = float(found[f"{name}_error"][i])
            assert error <= own + getattr(solution.error, name) + 1e-15
            assert own <= rtol or found.ending[i] == "converged"


def test_the_shakedown_ratio_of_the_spectra_is_that_of_solve(always_shared):
    compliances, _ = random_compliances(12, -2.0, 2.0)
    axes = {"tangential_compliance": np.sort(compliances), "friction": [0.0, 0.02, 0.1, np.inf]}
    found = sweep(Scene(0.1, 0.3), **axes, quantities=["shakedown_ratio"])
    for beta in axes["tangential_compliance"]:
        for friction in axes["friction"]:
            own = found.sel(tangential_compliance=beta, friction=friction)
            truth = solve(Scene(0.1, 0.3, beta, friction), 1e-12, ["shakedown_ratio"])
            error = float(own.shakedown_ratio_error) + truth.error.shakedown_ratio + 1e-15
            assert abs(float(own.shakedown_ratio) - truth.shakedown_ratio) <= error


GOLD_NAMES = {"approach": 1e-14, "total_shear": 1e-13, "edge_ratio": 1e-12}


def test_the_spectra_agree_with_the_gold_tables():
    served = dict.fromkeys(GOLD_NAMES, 0)
    solutions = [
        one
        for table in tables()
        for one in table.solutions
        if not one.scene.coupling and one.scene.profile is None and one.scene.unloaded_to == 1.0
    ]
    for solution in solutions:
        sticks = [zone.kind for zone in solution.zones] == ["stick"]
        columns = sweep_run.listed([solution.scene]).columns(np.arange(1))
        for name, allowed in GOLD_NAMES.items():
            if name != "approach" and not sticks:
                continue
            request = sweep_run.requested([name], 1e-12, 100, None, None)
            known = shortcuts.served_by_spectra(columns, request)
            if known.mask[0]:
                error = abs(known.values[name][0] / float(getattr(solution, name)) - 1.0)
                assert error <= known.errors[name][0] <= allowed
                served[name] += 1
    rough = [one for one in solutions if one.scene.normal_compliance > 0.0]
    assert served["approach"] == len(rough)
    assert min(served.values()) >= 3


def test_what_the_spectra_cannot_do_to_the_tolerance_is_solved(always_shared, asked):
    alphas = [0.0, 1e-9, 0.5]
    found = sweep(BASE, normal_compliance=alphas, quantities=["edge_ratio"], rtol=1e-12)
    assert [scene.normal_compliance for scene in asked] == [0.0, 1e-9]
    scenes = [Scene(0.3, alpha, 0.5, 0.1) for alpha in alphas]
    expected = [solve(scene, 1e-12, ["edge_ratio"]).edge_ratio for scene in scenes]
    assert np.allclose(found.edge_ratio, expected, rtol=1e-12)


def test_above_the_critical_friction_there_is_nothing_to_solve(always_shared, asked):
    critical = solve(BASE, 1e-12).critical_friction
    frictions = critical * np.array([0.5, 1.0 - 1e-14, 1.0 + 1e-14, 2.0, math.inf])
    found = sweep(BASE, friction=frictions, quantities=["stick_radius", "total_shear"])
    assert [scene.friction for scene in asked] == frictions[:3].tolist()  # two are too close
    for i, friction in ((0, frictions[0]), (3, frictions[3]), (4, math.inf)):
        solution = solve(Scene(0.3, 0.5, 0.5, friction), 1e-8)
        assert float(found.total_shear[i]) == pytest.approx(solution.total_shear, rel=1e-10)
        assert float(found.stick_radius[i]) == pytest.approx(solution.stick_radius, rel=1e-9)


def test_the_estimates_of_the_spectra_are_about_their_errors():
    """A finer decomposition shows the true error of a rough one, all over the plane."""
    fine, rough = error_maps.certified_stick(1e-12), error_maps.CertifiedStick(8)
    alpha, beta = random_compliances(2000, -6.0, 6.0, seed=3)
    truth, left = fine.shear_and_edge(alpha, beta)
    values, estimates = rough.shear_and_edge(alpha, beta)
    shares = []
    for k in (0, 1):
        error = np.abs(values[k] / truth[k] - 1.0)
        assert (error <= estimates[k] + left[k]).all()
        shares.append((error / estimates[k]).max())
    assert min(shares) > 1e-3  # an estimate that were huge would tell nothing


def test_quantities_that_the_spectra_do_not_know_are_left_to_solve():
    request = sweep_run.requested(["zones"], 1e-8, 100, None, None)
    columns = sweep_run.grid(BASE, {"friction": [0.1, math.inf]}).columns(np.arange(2))
    assert not shortcuts.eligible(columns, request).any()
    assert set(QUANTITIES) >= set(SCALARS)


def test_the_spectra_are_taken_for_many_compliances_alone():
    assert sweep_run.grid(BASE, {"friction": np.linspace(0.1, 0.2, 700)}).pairs == 1
    axes = {"normal_compliance": [0.1, 0.2], "tangential_compliance": [0.1, 0.2, 0.3]}
    assert sweep_run.grid(BASE, axes | {"friction": [0.1, 0.2]}).pairs == 6
    assert sweep_run.listed([BASE, Scene(0.1, 0.5, 0.5), Scene(0.1, 0.5, 0.4)]).pairs == 2


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({}, "number of scenes, 10000 x 10000 x 10000 = 1000000000000: must be at most"),
        ({"quantities": ["pressure"], "s": np.zeros(10**6)}, "at most 999 with 1000002 values of"),
    ],
)
def test_a_grid_beyond_memory_is_refused_before_it_is_made(monkeypatch, asked, said):
    def made(*_):
        raise AssertionError("made")

    monkeypatch.setattr(SweepParameters, "order", made)
    monkeypatch.setattr(SweepParameters, "columns", made)
    axis = np.linspace(0.1, 0.3, 10_000)
    with pytest.raises(SceneError) as refusal:
        sweep(BASE, friction=axis, poisson_ratio=axis, normal_compliance=axis, **asked)
    assert said in str(refusal.value)


def test_a_list_with_kappa_and_with_poissons_ratios_is_told_by_kappa():
    scenes = [Scene(0.3, 0.5, 0.5, 0.1), Scene.from_kappa(-0.1, 0.5, 0.5, 0.1)]
    found = sweep(scenes, quantities=["total_shear"])
    assert found.kappa.values.tolist() == [one.kappa for one in scenes]
    assert "poisson_ratio" not in found.coords


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ({"kappa": 0.1, "poisson_ratio": [0.3, 0.4]}, "kappa"),
        ({"load": 2.0, "approach": [1.0, 2.0]}, "load"),
    ],
)
def test_a_number_is_not_replaced_in_silence_by_a_list(given, name):
    scene = Scene(0.3, 0.5, profile=Parabola(1.0), load=1.0)
    with pytest.raises(SceneError, match=f"^{name}"):
        sweep(scene, **given)
    in_si = Scene.from_physical(youngs_modulus=2e11, poisson_ratio=0.3, radius=5e-3, load=1e3)
    with pytest.raises(SceneError, match=f"^{name}"):
        sweep(in_si, **given)
