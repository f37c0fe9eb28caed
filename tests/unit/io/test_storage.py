"""Storing, loading, comparing, pickling and copying solutions."""

import copy
import functools
import io
import json
import math
import os
import pickle
import zipfile
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spectral_contact import layers, profiles
from spectral_contact import records as record_classes
from spectral_contact import scene as scene_classes
from spectral_contact import solution as solution_classes
from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.fields import history as history_classes
from spectral_contact.fields import radius as radius_classes
from spectral_contact.fields import series as field_classes
from spectral_contact.fields.history import ContactHistory
from spectral_contact.fields.series import (
    AnnulusSeries,
    DiskSeries,
    EdgeWeight,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.io import physical_data, schema, storage
from spectral_contact.layers import asperity_law, laws, sampled_law, scene_layer
from spectral_contact.profiles import control, sampled_profile, sums
from spectral_contact.profiles import shapes as shape_profiles
from spectral_contact.scene import Scene
from spectral_contact.solution import (
    Ending,
    ErrorEstimates,
    Plan,
    PlannedStep,
    RefinementStep,
    Solution,
    StepState,
    StepWork,
    Work,
    Zone,
)
from spectral_contact.solving.solver import solve

profile_classes = (sampled_profile, shape_profiles, sums)
layer_classes = (asperity_law, laws, sampled_law)
SUFFIXES = (".npz", ".json")
AWKWARD = [math.inf, -math.inf, -0.0, 5e-324, -2.2e-308, 1.7976931348623157e308, 0.1 + 0.2, 1e22]
STEEL = {
    "youngs_modulus": 2.1e11,
    "poisson_ratio": 0.3,
    "radius": 0.013,
    "normal_compliance": 1e-13,
    "tangential_compliance": 3e-14,
}
SCENES = {
    "frictionless": Scene(0.1, 0.5),
    "frictionless smooth": Scene(0.1),
    "full stick": Scene(0.1, 0.5, 0.5, math.inf),
    "full stick smooth": Scene(0.1, friction=math.inf),
    "full stick, smooth normally": Scene(0.1, 0.0, 0.5, math.inf),
    "incompressible": Scene(0.5, 0.5, 0.5, 0.1),
    "above critical friction": Scene(0.1, 0.5, 0.5, 10.0),
    "frictionless by number": Scene(0.1, 0.5, 0.5, 0.0),
    "partial slip": Scene(0.1, 0.5, 0.5, 0.1),
    "SI, load": Scene.from_physical(**STEEL, load=1e3),
    "SI, approach, full stick": Scene.from_physical(**STEEL, approach=1e-6, friction=math.inf),
}


@functools.cache
def solved(name):
    return solve(SCENES[name], rtol=1e-6)


def synthetic(numbers=AWKWARD):
    """Return a solution of every class that can be stored, which no solve would return."""
    series = LogSeries(np.array([numbers, numbers[::-1]]), np.array(numbers), 0.5, -0.5, True)
    other = LogSeries(np.zeros((0, 3)), np.zeros(0), 1.0)
    inner, outer = Radius(5e-324, 1.0), Radius(1.0, 0.0)
    annulus = AnnulusSeries(inner, outer, series, other, -1)
    weight = EdgeWeight(-0.0, 0.0, True)
    return Solution(
        SCENES["SI, load"],
        1e-12,
        Plan(
            ("approach", "zones"),
            (PlannedStep("normal", StepState.CONDITIONAL, "because ν ≠ ½"),),
            (("slip", "not asked"),),
        ),
        ErrorEstimates(approach=-0.0, pressure=math.inf, slip=5e-324),
        False,
        Ending.ROUNDING,
        Work(
            (
                StepWork(
                    "normal",
                    7,
                    (3, 4),
                    (RefinementStep(7, 4, 1e-3, 0.25),),
                    Ending.UNKNOWNS,
                    0.5,
                ),
            )
        ),
        {
            "approach": 0.1 + 0.2,
            "zones": (Zone("slip", 0.0, 1e-40, 1.0, 1.0), Zone("stick", 1e-40, 1.0, 1.0, 0.0)),
            "stick_radius": None,
            "critical_friction": math.inf,
        },
        PressureField(weight, None),
        ZonalField((ZonePiece(inner, annulus, -0.0), ZonePiece(outer, None))),
        DiskSeries(outer, other, weight),
        ContactHistory(np.array(numbers), *([np.array([numbers])] * 5)),
    )


def flat(value):
    """Return everything in a solution, seconds included, bit by bit; independent of storage."""
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.shape, value.tobytes())
    if isinstance(value, Enum):
        return (type(value), value.name)
    if is_dataclass(value):
        slots = type(value).__dataclass_fields__
        return (type(value), *(flat(getattr(value, name)) for name in slots))
    if isinstance(value, tuple):
        return (tuple, *map(flat, value))
    if isinstance(value, dict):
        return (dict, *((key, flat(item)) for key, item in sorted(value.items())))
    value = value.item() if isinstance(value, np.generic) else value
    return (type(value), value.hex() if isinstance(value, float) else value)


def assert_identical(loaded, solution):
    assert loaded == solution
    assert hash(loaded) == hash(solution)
    assert flat(loaded) == flat(solution)


def through_file(solution, path):
    solution.save(path)
    return Solution.load(path)


# --- round trips ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCENES)
def test_round_trip_keeps_every_bit(name, tmp_path):
    solution = solved(name)
    radii = np.array([0.0, 1e-300, 0.3, 0.5, 0.9, 1.0 - 2**-53, 1.0])
    depths = np.array([0.0, 1e-300, 1e-20, 1e-3, 0.25, 1.0])
    for suffix in SUFFIXES:
        loaded = through_file(solution, tmp_path / f"a{suffix}")
        assert_identical(loaded, solution)
        for field in ("pressure", "traction", "slip"):
            if field not in solution.plan.quantities:
                continue
            evaluate, again = getattr(solution, field), getattr(loaded, field)
            assert evaluate(radii).tobytes() == again(radii).tobytes()
            assert evaluate(from_edge=depths).tobytes() == again(from_edge=depths).tobytes()
        if solution.scene.physical is not None:
            assert loaded.physical.load == solution.physical.load
            assert loaded.physical.approach == solution.physical.approach
    assert_identical(Solution.from_json(solution.to_json()), solution)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_class_and_awkward_number_round_trips(suffix, tmp_path):
    assert_identical(through_file(synthetic(), tmp_path / f"a{suffix}"), synthetic())
    assert_identical(Solution.from_json(synthetic().to_json()), synthetic())


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=5))
def test_any_doubles_round_trip(numbers):
    solution = replace(synthetic(numbers), rtol=numbers[0])
    assert_identical(Solution.from_json(solution.to_json()), solution)


@pytest.mark.parametrize("name", ["full stick", "SI, load"])
def test_loaded_solutions_can_be_saved_pickled_and_copied(name, tmp_path):
    solution = solved(name)
    for one in (solution, through_file(solution, tmp_path / "a.npz")):
        assert_identical(through_file(one, tmp_path / "b.json"), solution)
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            assert_identical(pickle.loads(pickle.dumps(one, protocol)), solution)
        assert_identical(copy.copy(one), solution)
        assert_identical(copy.deepcopy(one), solution)


def test_loaded_arrays_are_read_only(tmp_path):
    loaded = through_file(solved("frictionless"), tmp_path / "a.npz")
    with pytest.raises(ValueError, match="read-only"):
        loaded.pressure_field.series.tail[0] = 1.0


def test_numpy_scalars_are_stored_as_the_numbers_they_are():
    solution = replace(synthetic(), rtol=np.float64(0.25), converged=np.bool_(False))
    assert_identical(Solution.from_json(solution.to_json()), replace(synthetic(), rtol=0.25))


def test_arrays_of_either_byte_order_and_layout_are_stored():
    plain = LogSeries(np.arange(6.0).reshape(2, 3), np.arange(4.0), 1.0)
    odd = replace(plain, coefficients=np.asfortranarray(plain.coefficients))
    strided = replace(plain, tail=np.arange(8.0)[::2] / 2)
    for one in (odd, strided):
        solution = replace(synthetic(), pressure_field=PressureField(None, one))
        expected = replace(synthetic(), pressure_field=PressureField(None, plain))
        assert solution == expected
        assert Solution.from_json(solution.to_json()) == expected


# --- the files ------------------------------------------------------------------------------------


def test_json_is_strict_and_says_what_it_is():
    def refuse(token):
        raise AssertionError(token)

    document = json.loads(synthetic().to_json(), parse_constant=refuse)
    assert document["schema"] == "spectral_contact.solution"
    assert document["version"] == 1
    assert document["library"]


def test_npz_needs_no_pickle_and_names_its_arrays_by_place(tmp_path):
    solution = solved("full stick")
    solution.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as archive:
        tail = archive["pressure_field.series.tail"]
        header = json.loads(archive["header"].item())
    assert tail.tobytes() == solution.pressure_field.series.tail.tobytes()
    assert header["schema"] == "spectral_contact.solution"


@pytest.mark.parametrize("convert", [str, lambda path: path, os.fsencode])
@pytest.mark.parametrize("name", ["a.npz", "a.json", "A.NPZ", "b.c.JSON", "ü ½.json"])
def test_paths_of_every_kind(convert, name, tmp_path):
    assert_identical(through_file(synthetic(), convert(tmp_path / name)), synthetic())
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_saving_replaces_a_file_and_follows_a_link(tmp_path):
    target, link = tmp_path / "a.json", tmp_path / "b.json"
    target.write_text("old")
    link.symlink_to(target)
    synthetic().save(link)
    assert link.is_symlink()
    assert_identical(Solution.load(target), synthetic())


def test_reordered_and_indented_json_is_still_the_solution():
    document = json.loads(solved("full stick").to_json())
    text = json.dumps(document, indent=2, sort_keys=True)
    assert_identical(Solution.from_json(text), solved("full stick"))


def test_the_schema_declares_every_class_and_every_field():
    """A class or field that is added is to be declared in the schema, and used in `synthetic`."""
    own = (
        *(field_classes, history_classes, radius_classes),
        *(physical_data, record_classes, scene_classes, solution_classes),
    )
    classes = {
        cls
        for module in (*own, *profile_classes, *layer_classes)
        for cls in vars(module).values()
        if isinstance(cls, type) and cls.__module__ == module.__name__
        if is_dataclass(cls) or issubclass(cls, Enum)
    }
    enums = {type(member): one for one in schema.CHOICES for member in one.names}
    assert {one.cls for one in schema.RECORDS} | enums.keys() == classes
    for enum, choice in enums.items():
        assert set(choice.names) == set(enum)
    for record in schema.RECORDS:
        declared = {one.name: one for one in fields(record.cls)}
        assert list(record.kinds) == list(declared)
        assert record.later == {key: declared[key].default for key in record.later}
    shaped = {*schema.PROFILES, *schema.LAYERS}  # those have a test of their own
    others = set(schema.RECORDS) - shaped
    assert all(f'"{one.tag}": ' in synthetic().to_json() for one in others)


def classes_of(package):
    return [one for one in map(package.__dict__.get, package.__all__) if isinstance(one, type)]


def missing_of(words, page):
    text = (Path(__file__).parents[3] / "docs" / page).read_text(encoding="utf-8")
    return sorted(word for word in words if f"`{word}" not in text)


def test_the_page_of_the_format_names_every_record_and_key():
    words = {one.tag for one in schema.RECORDS} | {
        key for one in schema.RECORDS for key in one.kinds
    }
    assert missing_of({f"{word}`" for word in words}, "file_format.md") == []


PROFILES = {
    "parabola": profiles.Parabola(1.3),
    "sphere": profiles.Sphere(1.3),
    "power": profiles.PowerLaw(0.7, 2.5),
    "cone": profiles.Cone(0.8),
    "truncated cone": profiles.TruncatedCone(0.5, 1.1),
    "rounded flat": profiles.RoundedFlat(0.5, 1.0),
    "sum": profiles.Sum(profiles.Cone(0.8), profiles.Sphere(1.3)),
    "points": profiles.Sampled.from_points([0.0, 0.5, 1.0, 1.5], [0.0, 0.125, 0.5, 1.125]),
}


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize("alpha", [0.0, 0.5])
def test_solutions_with_a_profile_round_trip(name, alpha, tmp_path):
    scene = Scene(0.3, alpha, profile=PROFILES[name], load=0.1)
    solution = solve(scene, 1e-6)
    for suffix in SUFFIXES:
        assert_identical(through_file(solution, tmp_path / f"a{suffix}"), solution)
    assert_identical(pickle.loads(pickle.dumps(solution)), solution)
    assert Scene.from_json(scene.to_json()) == scene
    assert hash(Scene.from_json(scene.to_json())) == hash(scene)
    assert Scene.from_dict(scene.to_dict()) == scene
    other = Scene(0.3, alpha, profile=PROFILES[name], load=0.2)
    assert solution != solve(other, 1e-6)


def test_each_profile_is_declared_and_tried():
    tried = {type(one) for one in PROFILES.values()} | {profiles.Flat}
    assert {one.cls for one in schema.PROFILES} == tried == {*control.KINDS.values()}
    assert tried == {*classes_of(profiles)} - {profiles.Profile, profiles.PointHull}
    assert missing_of({one.__name__ for one in tried}, "profiles.md") == []


LAYERS = {
    "linear": layers.Linear(0.5),
    "power": layers.PowerLaw(5.0, 2.0),
    "abaqus": layers.Exponential(0.1, 0.2),
    "calculix": layers.CalculixExponential(0.1, 0.2),
    "asperities": layers.GreenwoodWilliamson(3.0, 0.1, 0.2),
    "table": layers.Table((0.0, 1.0, 2.0, 3.0), (0.0, 2.0, 4.0, 6.0)),
    "sampled": layers.Sampled((0.0, 2.0), ((2.0, 2.0),)),
}


@pytest.mark.parametrize("name", LAYERS)
def test_solutions_with_a_layer_round_trip(name, tmp_path):
    scene = Scene(0.3, layer=LAYERS[name], profile=profiles.Flat(1.5), load=0.1)
    solution = solve(scene, 1e-4)
    for suffix in SUFFIXES:
        assert_identical(through_file(solution, tmp_path / f"a{suffix}"), solution)
    assert Scene.from_json(scene.to_json()) == scene


def test_each_layer_is_declared_and_tried():
    tried = {type(one) for one in LAYERS.values()}
    assert {one.cls for one in schema.LAYERS} == tried == {*scene_layer.KINDS.values()}
    assert tried == {*classes_of(layers)} - {layers.Layer}
    assert missing_of({one.__name__ for one in tried}, "layers.md") == []


def test_flat_scenes_say_nothing_of_profiles():
    assert "profile" not in solved("frictionless").to_json()
    assert "profile" not in SCENES["frictionless"].to_json()


# --- equality -------------------------------------------------------------------------------------


def test_equality_ignores_seconds_and_nothing_else():
    solution = synthetic()
    [step] = solution.work.steps

    def with_step(**changes):
        return replace(solution, work=Work((replace(step, **changes),)))

    assert solution == with_step(seconds=9.0)
    assert solution == with_step(history=(replace(step.history[0], seconds=9.0),))
    assert solution != with_step(history=(replace(step.history[0], error=9.0),))
    assert solution != replace(solution, rtol=1e-11)
    assert solution != replace(solution, values={**solution.values, "approach": 0.3})
    assert solution != replace(solution, slip_field=None)
    assert solution != synthetic([1.0, *AWKWARD[1:]])
    assert solution != "solution"


def test_comparable_is_hashable_and_takes_minus_zero_for_zero():
    assert hash(storage.comparable(synthetic())) == hash(storage.comparable(synthetic()))
    assert synthetic([0.0]) == synthetic([-0.0])


def test_solving_again_gives_an_equal_solution():
    for name in ("full stick", "SI, load"):
        assert solve(SCENES[name], rtol=1e-6) == solved(name)


# --- what is refused ------------------------------------------------------------------------------


def refusal(call, *arguments):
    with pytest.raises(SolutionFileError) as caught:
        call(*arguments)
    assert "\n" not in str(caught.value)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    return caught.value


@pytest.mark.parametrize("name", ["a", "a.csv", "a.npz.txt", ".npz", "a.npy", ""])
def test_other_suffixes_are_refused(name, tmp_path):
    for call in (synthetic().save, Solution.load):
        error = refusal(call, f"{tmp_path}/{name}")
        assert ".npz or .json" in error.reason
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", [None, 3, 1.5, ["a.npz"], object(), 10**5000], ids=type)
def test_what_is_no_path_is_refused(path):
    assert "not a path" in refusal(synthetic().save, path).reason
    assert "not a path" in refusal(Solution.load, path).reason


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("kind", ["missing", "directory", "below a file", "NUL", "long", "loop"])
def test_unusable_paths_are_refused_and_nothing_is_left(kind, suffix, tmp_path):
    (tmp_path / f"dir{suffix}").mkdir()
    (tmp_path / "file").write_text("")
    (tmp_path / f"loop{suffix}").symlink_to(tmp_path / f"loop{suffix}")
    before = sorted(tmp_path.rglob("*"))
    name = {
        "missing": f"none/a{suffix}",
        "directory": f"dir{suffix}",
        "below a file": f"file/a{suffix}",
        "NUL": f"a\0{suffix}",
        "long": "a" * 300 + suffix,
        "loop": f"loop{suffix}",
    }[kind]
    path = f"{tmp_path}/{name}"
    assert refusal(Solution.load, path).source == path
    if kind != "loop":  # a link to itself is replaced: nothing is lost
        assert "cannot be written" in refusal(synthetic().save, path).reason
        assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_directory_without_permission_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    assert "ermission" in refusal(synthetic().save, tmp_path / "a.npz").reason


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_failure_while_writing_leaves_the_old_file(failure, tmp_path, monkeypatch):
    path = tmp_path / "a.json"
    synthetic().save(path)
    old = path.read_bytes()

    def fail(self, target):
        raise failure

    monkeypatch.setattr(type(path), "replace", fail)
    with pytest.raises((SolutionFileError, KeyboardInterrupt)):
        solved("frictionless").save(path)
    assert path.read_bytes() == old
    assert list(tmp_path.iterdir()) == [path]


def with_coefficient(array):
    return replace(synthetic(), pressure_field=PressureField(None, LogSeries(array, array, 1.0)))


@pytest.mark.parametrize(
    "solution",
    [
        replace(synthetic(), rtol=math.nan),
        replace(synthetic(), error=ErrorEstimates(slip=math.nan)),
        with_coefficient(np.array([[1.0, math.nan]])),
        with_coefficient(np.array([[1.0]], dtype=np.float32)),
        with_coefficient(np.array([[None]])),
        with_coefficient([[1.0]]),
        replace(synthetic(), rtol=1),
        replace(synthetic(), rtol="1e-3"),
        replace(synthetic(), converged=1),
        replace(synthetic(), scene="scene"),
        replace(synthetic(), pressure_field=print),
        replace(synthetic(), plan=Plan(["approach"], ())),
        replace(synthetic(), plan=Plan((), (), (("slip", "one", "too many"),))),
        replace(synthetic(), values={"approach": "0.3"}),
        replace(synthetic(), values={"other": 0.3}),
        replace(synthetic(), values={1: 0.3}),
        synthetic().scene,
        "solution",
        None,
    ],
)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_does_not_belong_into_a_solution_is_not_written(solution, suffix, tmp_path):
    refusal(storage.save, solution, tmp_path / f"a{suffix}")
    assert not list(tmp_path.iterdir())
    assert refusal(storage.to_json, solution).source == "solution"


def altered(document, *place, to):
    """Return the document with one entry replaced, removed (to=None) or added."""
    document = copy.deepcopy(document)
    spot = document
    for key in place[:-1]:
        spot = spot[key]
    if to is None:
        del spot[place[-1]]
    else:
        spot[place[-1]] = to
    return document


TREE = ("solution", "Solution")
TAIL = ("arrays", "pressure_field.series.tail")
CHANGES = [
    (("schema",), "spectral_contact.scene", "schema"),
    (("schema",), None, "schema"),
    (("version",), 2, "version 2"),
    (("version",), 1.0, "version 1.0"),
    (("version",), True, "version True"),
    (("version",), None, "version None"),
    (("library",), None, "header: keys are missing library"),
    (("extra",), 1, "header: keys are unknown 'extra'"),
    (("sha256",), "0" * 64, "checksum"),
    (("solution",), 0.5, "not a Solution"),
    (("solution",), {"Radius": {"value": 0.5, "from_edge": 0.5}}, "not a Solution"),
    (("solution",), {"PhysicalSolution": {"solution": 1}}, "PhysicalSolution"),
    (("solution",), {"os.system": "true"}, "os.system"),
    (("solution",), {}, "not a Solution"),
    (("solution",), {"Scene": {}, "Zone": {}}, "not a Solution"),
    ((*TREE, "extra"), 1, "unknown 'extra'"),
    ((*TREE, "rtol"), None, "missing rtol"),
    ((*TREE, "rtol"), "1e-6", "rtol"),
    ((*TREE, "rtol"), 1, "rtol"),
    ((*TREE, "rtol"), [1e-6], "rtol"),
    ((*TREE, "rtol"), 1.1e-6, "checksum"),
    ((*TREE, "rtol"), math.nan, "nan"),
    ((*TREE, "rtol"), {"float": "nan"}, "float"),
    ((*TREE, "rtol"), {"float": ["inf"]}, "float"),
    ((*TREE, "converged"), 1, "converged"),
    ((*TREE, "ending"), {"Ending": "LUCK"}, "LUCK"),
    ((*TREE, "ending"), {"StepState": "RUN"}, "ending"),
    ((*TREE, "scene", "Scene", "poisson_ratio"), 0.7, "poisson_ratio"),
    ((*TREE, "scene", "Scene", "friction"), "inf", "friction"),
    ((*TREE, "values", "dict", "approach"), "0.3", "approach"),
    ((*TREE, "values", "dict", "approach"), None, "checksum"),
    ((*TREE, "values", "dict", "depth"), 0.3, "not a dict of approach"),
    ((*TREE, "values", "dict"), [1], "not a dict of approach"),
    ((*TREE, "pressure_field", "PressureField"), [1], "PressureField: an object was expected"),
    ((*TREE, "pressure_field"), {"array": "nowhere"}, "nowhere"),
    ((*TREE, "pressure_field"), {"array": "pressure_field.series.tail"}, "pressure_field"),
    (("arrays",), None, "coefficients"),
    (("arrays",), [1], "damaged"),
    (("arrays", "more"), {"shape": [0], "data": []}, "checksum"),
    (TAIL, [1.0], "an object was expected"),
    ((*TAIL, "extra"), 1, "unknown 'extra'"),
    ((*TAIL, "data", 0), "0.5", "doubles"),
    ((*TAIL, "data", 0), 1, "doubles"),
    ((*TAIL, "data", 0), math.nan, "NaN"),
    ((*TAIL, "data", 0), 0.12345, "checksum"),
    ((*TAIL, "shape"), [1, 3], "series.tail is 'float64 (1, 3)', not an array"),
    ((*TAIL, "shape"), [10**12, 10**12], "damaged"),
]


@pytest.mark.parametrize(("place", "to", "reason"), CHANGES)
def test_changed_documents_are_refused_with_the_reason(place, to, reason, tmp_path):
    document = altered(json.loads(solved("full stick").to_json()), *place, to=to)
    error = refusal(Solution.from_json, json.dumps(document))
    assert reason in error.reason
    assert error.source == "solution"
    path = tmp_path / "a.json"
    path.write_text(json.dumps(document))
    assert reason in refusal(Solution.load, path).reason
    if place[0] == "arrays":
        return
    members = {
        name: np.array([float(x) for x in body["data"]]).reshape(body["shape"])
        for name, body in document.pop("arrays").items()
    }
    np.savez(tmp_path / "a.npz", header=np.array(json.dumps(document)), **members)
    assert reason in refusal(Solution.load, tmp_path / "a.npz").reason


@pytest.mark.parametrize(
    "members",
    [
        {"header": None},
        {"header": np.array(b"{}")},
        {"header": np.array(1.0)},
        {"header": np.array(["{}", "{}"])},
        {"header": np.array({"schema": 1})},
        {"pressure_field.series.tail": None},
        {"pressure_field.series.tail": np.zeros(3)},
        {"pressure_field.series.tail": np.zeros(3, dtype=np.float32)},
        {"pressure_field.series.tail": np.zeros(3, dtype=complex)},
        {"pressure_field.series.tail": np.zeros(3, dtype=int)},
        {"pressure_field.series.tail": np.array(["0", "0", "0"])},
        {"pressure_field.series.tail": np.array([print], dtype=object)},
        {"pressure_field.series.tail": np.full(3, math.nan)},
        {"extra": np.zeros(3)},
    ],
)
def test_npz_files_with_changed_members_are_refused(members, tmp_path):
    path = tmp_path / "a.npz"
    solved("frictionless").save(path)
    with np.load(path) as archive:
        changed = {**archive, **members}
    np.savez(path, **{name: array for name, array in changed.items() if array is not None})
    refusal(Solution.load, path)


def content(suffix, name="frictionless smooth"):
    if suffix == ".json":
        return solved(name).to_json().encode()
    return storage._npz(solved(name), storage._SOLUTION)


FOREIGN = {
    "empty": b"",
    "text": b"delta = 0.29",
    "null": b"null",
    "number": b"1",
    "list": b"[]",
    "other JSON": b'{"approach": 0.3}',
    "scene": Scene(0.1).to_json().encode(),
    "deep JSON": b"[" * 100_000,
    "digits": b"1" * 10_000,
    "not UTF-8": b"\xff\xfe\x00",
    "pickle": pickle.dumps({"schema": 1}),
    "npy": b"\x93NUMPY\x01\x00",
    "zip": b"PK\x05\x06" + bytes(18),
}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("foreign", FOREIGN)
def test_foreign_files_are_refused(foreign, suffix, tmp_path):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(FOREIGN[foreign])
    assert refusal(Solution.load, path).source == str(path)


def test_one_format_under_the_suffix_of_the_other_is_refused(tmp_path):
    for suffix, other in (SUFFIXES, SUFFIXES[::-1]):
        (tmp_path / f"a{suffix}").write_bytes(content(other))
        refusal(Solution.load, tmp_path / f"a{suffix}")


@pytest.mark.parametrize("text", [None, 1, "", "{", "nan", b"\xff", ["{}"]])
def test_what_is_no_json_text_is_refused(text):
    assert refusal(Solution.from_json, text).source == "solution"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_truncated_files_are_refused(suffix, tmp_path):
    whole, path = content(suffix, "full stick"), tmp_path / f"a{suffix}"
    for length in {0, 1, 3, 30, 100, *range(200, len(whole), len(whole) // 25), len(whole) - 1}:
        path.write_bytes(whole[:length])
        refusal(Solution.load, path)


def test_a_member_that_asks_for_too_much_memory_is_refused(tmp_path):
    npy = io.BytesIO()
    np.save(npy, np.zeros(3))
    greedy = npy.getvalue().replace(b"(3,)", b"(%d,)" % 10**17)
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("header.npy", greedy)
    refusal(Solution.load, path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(max_examples=12 * settings().max_examples, deadline=None)
@given(data=st.data())
def test_flipped_bytes_are_refused_or_change_nothing(suffix, data, tmp_path_factory):
    damaged = bytearray(content(suffix))
    spots = st.tuples(st.integers(0, len(damaged) - 1), st.integers(1, 255))
    for spot, mask in data.draw(st.lists(spots, min_size=1, max_size=4)):
        damaged[spot] ^= mask
    is_refused_or_unchanged(bytes(damaged), tmp_path_factory.getbasetemp() / f"flipped{suffix}")


def is_refused_or_unchanged(damaged, path):
    path.write_bytes(damaged)
    try:
        loaded = Solution.load(path)
    except SolutionFileError:
        return
    assert_identical(loaded, solved("frictionless smooth"))


@pytest.mark.parametrize("suffix", SUFFIXES)
@given(data=st.data())
def test_cut_and_pasted_bytes_are_refused_or_change_nothing(suffix, data, tmp_path_factory):
    damaged = bytearray(content(suffix))
    for _ in range(data.draw(st.integers(1, 3))):
        begin = data.draw(st.integers(0, len(damaged)))
        end = begin + data.draw(st.sampled_from([0, 1, 30, 1000, len(damaged)]))
        own = damaged[begin:end]
        pasted = st.sampled_from([b"", bytes(len(own)), own + own]) | st.binary(max_size=100)
        damaged[begin:end] = data.draw(pasted)
    is_refused_or_unchanged(bytes(damaged), tmp_path_factory.getbasetemp() / f"cut{suffix}")


def places(tree):
    """Return container and key of every node below a JSON value."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    found = [(tree, key) for key, _ in items]
    for container, key in list(found):
        if isinstance(container[key], (dict, list)):
            found += places(container[key])
    return found


@pytest.mark.parametrize("kind", [Solution, Scene])
@given(data=st.data())
def test_a_changed_node_of_a_document_is_refused_or_changes_nothing(kind, data):
    whole = solved("partial slip")
    tree = json.loads((whole if kind is Solution else whole.scene).to_json())
    nodes = st.sampled_from(places(tree))
    container, key = data.draw(nodes)
    elsewhere, other = data.draw(nodes)
    constants = st.sampled_from([None, True, 2, 10**400, math.nan, math.inf, [], {}, {"x": 1}])
    changes = constants | st.text(max_size=9) | st.just(copy.deepcopy(elsewhere[other]))
    if data.draw(st.booleans()):
        container[key] = data.draw(changes)
    else:
        del container[key]
    try:
        loaded = kind.from_json(json.dumps(tree))
    except (SolutionFileError, SceneError):
        return
    if kind is Solution:
        assert_identical(loaded, whole)
    else:  # it has no checksum, so it may be another one
        assert Scene.from_json(loaded.to_json()) == loaded


@pytest.mark.parametrize("suffix", SUFFIXES)
@given(junk=st.binary(max_size=60))
def test_junk_is_refused(suffix, junk, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / f"junk{suffix}"
    path.write_bytes(junk)
    with pytest.raises(SolutionFileError):
        Solution.load(path)


@pytest.mark.parametrize("suffix", [".npz", ".json"])
@pytest.mark.parametrize("compliances", [(0.0, 0.0), (0.2, 0.5), (0.0, 0.5)])
def test_coupled_solutions_are_stored_whole(tmp_path, suffix, compliances):
    solution = solve(Scene(0.0, *compliances, math.inf, coupling=True), 1e-6)
    path = tmp_path / f"coupled{suffix}"
    solution.save(path)
    again = Solution.load(path)
    assert again == solution
    assert again.opening == solution.opening
    depths = [1e-300, 1e-20, 1e-3, 0.5]
    assert np.array_equal(again.pressure(from_edge=depths), solution.pressure(from_edge=depths))


def test_files_know_nothing_of_what_a_solution_does_not_use():
    text = solve(Scene(0.1, 0.5, 0.5, math.inf), 1e-4).to_json()
    assert "coupling" not in text
    assert "oscillation" not in text
