"""Studies on disk: stored whole, refused when foreign."""

import csv
import json
import math
from dataclasses import replace
from types import SimpleNamespace

import peers
import pytest

from spectral_contact import Scene, SolutionFileError
from spectral_contact.studies import OwnSolver, convergence, load, work_precision

NORMAL = Scene(0.1, 0.5)
LIMIT = SimpleNamespace(approach=0.25)
COUNTS = [8, 16, 32, 64]


def counted(scene, count):
    if count == 16:
        raise ValueError("never at 16")
    return peers.Decaying(scene, count)


def study(solver=None, resolutions=COUNTS):
    return convergence(solver or counted, NORMAL, resolutions, LIMIT, repeats=0)


def refusal(call):
    with pytest.raises(SolutionFileError) as caught:
        call()
    assert "\n" not in str(caught.value)
    return str(caught.value)


# --- results --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def both():
    one = convergence(OwnSolver(), Scene(0.1, 0.5, 0.5, math.inf), [1e-3, 1e-6], LIMIT, repeats=0)
    many = work_precision(
        {"counted": (counted, COUNTS[:2]), "ours": OwnSolver(("approach",))},
        NORMAL,
        [1e-3],
        quantities=["approach"],
        repeats=1,
    )
    return {"convergence": one, "work-precision": many}


@pytest.mark.parametrize("kind", ["convergence", "work-precision"])
def test_a_stored_study_is_loaded_again(both, kind, tmp_path):
    path = tmp_path / "study.json"
    both[kind].save(path)
    again = load(str(path))
    assert again == both[kind]
    assert str(again) == str(both[kind])
    document = json.loads(path.read_text(encoding="utf-8"))
    assert (document["study"], document["version"]) == (kind, 2)


def test_infinite_errors_are_stored(tmp_path):
    nothing = study(lambda scene, count: SimpleNamespace(approach=math.nan), [8])
    nothing.save(tmp_path / "x.json")
    assert load(tmp_path / "x.json").points[0].errors == {"approach": math.inf}


def test_truths_of_which_no_digit_is_known_are_stored(tmp_path):
    unknown = replace(study(), truth_error={"approach": math.inf})
    unknown.save(tmp_path / "x.json")
    loaded = load(tmp_path / "x.json")
    assert loaded == unknown
    assert loaded.rate("approach") is None


def test_the_rates_are_stored_for_other_readers(tmp_path):
    def solver(scene, count):
        return peers.Decaying(scene, count)

    study(solver).save(tmp_path / "x.json")
    rate = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))["rates"]["approach"]
    assert (rate["kind"], rate["used"]) == ("algebraic", [0, 1, 2, 3])
    assert rate["value"] == pytest.approx(2.0)


def test_a_table_of_the_points(both, tmp_path):
    path = tmp_path / "study.csv"
    both["work-precision"].save(path)
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    rows = list(csv.DictReader(lines[len(comments) :]))
    assert any("gold table frictionless" in line for line in comments)
    assert any("numpy" in line for line in comments)
    points = both["work-precision"].points
    assert [row["solver"] for row in rows] == [point.solver for point in points]
    assert rows[1]["failure"] == "ValueError: never at 16"
    assert (rows[1]["error_approach"], rows[1]["warm_median_s"]) == ("", "")
    own, point = rows[-1], points[-1]
    assert float(own["error_approach"]) == point.errors["approach"]
    assert float(own["estimate_approach"]) == point.estimates["approach"]
    assert float(own["cold_median_s"]) == point.times.cold.median
    assert int(own["unknowns"]) == point.unknowns
    assert (own["normal_compliance"], own["friction"]) == ("0.5", "")


def test_paths_that_cannot_be(both, tmp_path):
    one = both["convergence"]
    assert "suffix" in refusal(lambda: one.save(tmp_path / "x.npz"))
    assert "its directory does not exist" in refusal(lambda: one.save(tmp_path / "no" / "x.json"))
    assert "cannot be read" in refusal(lambda: load(tmp_path / "missing.json"))
    assert "not a path" in refusal(lambda: load(3.5))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema": "spectral_contact.gold"}, '"schema" is not "spectral_contact.study"'),
        ({"version": 3}, "version 3 is not known"),
        ({"version": True}, "version True"),
        ({"study": "speed"}, "'speed', not convergence or work-precision"),
        ({"points": None}, "damaged"),
        ({"points": [{}]}, "no 'solver'"),
        ({"scene": {}}, "scene"),
    ],
)
def test_what_is_no_study_is_refused(both, tmp_path, change, said):
    path = tmp_path / "study.json"
    both["convergence"].save(path)
    document = json.loads(path.read_text(encoding="utf-8")) | change
    path.write_text(json.dumps(document), encoding="utf-8")
    assert said in refusal(lambda: load(path))


@pytest.mark.parametrize("text", ["", "[]", "{", "\ufeff{}"])
def test_what_is_no_json_is_refused(tmp_path, text):
    path = tmp_path / "study.json"
    path.write_text(text, encoding="utf-8")
    assert "study" in refusal(lambda: load(path))


def test_a_rate_beyond_the_doubles_is_stored(tmp_path):
    found = study(resolutions=[1, 2, 3], solver=peers.Decaying)
    wild = [1e200, 1e130, 1e-13]
    points = tuple(
        replace(point, unknowns=k + 1, errors={"approach": error})
        for k, (point, error) in enumerate(zip(found.points, wild, strict=True))
    )
    found = replace(found, points=points)
    rate = found.rate("approach")
    assert rate.interval[1] == math.inf
    found.save(tmp_path / "x.json")
    assert load(tmp_path / "x.json") == found
    stored = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    assert stored["rates"]["approach"]["interval"][1] == "inf"
    assert str(found)
