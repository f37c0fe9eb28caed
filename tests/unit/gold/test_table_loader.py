"""Reading gold tables: what ships, what a record holds, and what is refused."""

import copy
import json
import re
from importlib import resources

import mpmath
import pytest

from spectral_contact import Scene, SceneError, SolutionFileError, gold

FOLDER = resources.files("spectral_contact.gold") / "tables"
SCENE = ("scenes", 0)
PARAMETERS = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")


def document(name="slip_equal"):
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))


def small():
    """Return a table of one scene with two zones."""
    table = document()
    table["scenes"] = table["scenes"][:1]
    return table


def written(folder, content):
    path = folder / "table.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


def refusal(path):
    with pytest.raises(SolutionFileError) as caught:
        gold.load(path)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 400
    return message


def altered(table, *place, to):
    """Return the table with one entry replaced, removed (to=None) or added."""
    table = copy.deepcopy(table)
    spot = table
    for key in place[:-1]:
        spot = spot[key]
    if to is None:
        del spot[place[-1]]
    else:
        spot[place[-1]] = to
    return table


def test_all_files_are_read_in_order():
    names = sorted(file.name for file in FOLDER.iterdir() if file.name.endswith(".json"))
    assert [f"{table.name}.json" for table in gold.tables()] == names


def test_a_table_is_found_by_name_and_a_solution_by_its_scene():
    table = gold.table("slip_inside")
    assert table == gold.tables()[gold.names().index("slip_inside")] == gold["slip_inside"]
    for one in table.solutions[::7]:
        assert one.table == "slip_inside"
        assert gold.find(one.scene) == one
    with pytest.raises(SceneError, match="did you mean slip_inside"):
        gold.table("slip-insid")
    assert gold.find(Scene(0.3, 0.123)) is None
    # without friction the normal compliance alone decides
    assert gold.find(Scene(0.123, 0.1, 7.0)).scene == Scene(0.3, 0.1)
    si = Scene.from_physical(youngs_modulus=2e11, poisson_ratio=0.3, radius=1e-3, load=1.0)
    assert gold.find(si).scene == Scene(0.3)


def test_records_are_short_to_look_at():
    table = gold.table("slip_inside")
    assert repr(table).startswith("<GoldTable 'slip_inside': 8 scenes, slip in an interior")
    assert repr(table.solutions[0]).startswith("<GoldSolution 'nu=0.246 alpha=0.2")
    assert len(repr(table.solutions[0])) < 120


def test_a_file_is_the_table_that_ships(tmp_path):
    mine = gold.load(str(written(tmp_path, document())))
    [shipped] = [table for table in gold.tables() if table.name == mine.name]
    assert mine == shipped
    assert mine.script == "validation/gold/make_gold.py"


def test_a_record_holds_what_the_file_says():
    body = small()["scenes"][0]
    [found] = [s for table in gold.tables() for s in table.solutions if s.name == body["name"]]
    inputs = [float.fromhex(body["scene"][name]["hex"]) for name in PARAMETERS]
    assert found.scene == Scene(*inputs)
    assert str(found.total_shear) == body["total_shear"]
    assert found.stick_radius == found.zones[0].outer == found.zones[1].inner
    assert str(found.points[1].pressure) == body["points"][1]["pressure"]
    assert found.points[-1].from_edge == 0.0
    assert found.points[-1].pressure == mpmath.inf
    assert found.error.stick_radius == body["error"]["zones"]


def test_numbers_keep_their_digits_in_arithmetic():
    solution = gold.tables()[0].solutions[1]
    assert abs(solution.approach / 3 * 3 - solution.approach) < 1e-29
    assert str(solution.approach) in json.dumps(document(gold.tables()[0].name))


def test_stick_radius_by_zones():
    found = {s.name: s for table in gold.tables() for s in table.solutions}
    assert found["nu=0.3 alpha=0"].stick_radius is None
    assert found["nu=0.3 alpha=0 beta=0 f=inf"].stick_radius == 1
    assert found["nu=0.3 alpha=0.5 beta=0.5 f=0"].stick_radius == 0


def test_zones_below_the_largest_load_have_sense_and_memory(tmp_path):
    table = document("unloading")
    found = gold.load(written(tmp_path, table)).solutions[0]
    assert found.scene.unloaded_to == 0.8
    assert [(zone.sense, zone.memory) for zone in found.zones][1:] == [(1, False), (1, True)]
    for key, to in (("sense", 2), ("memory", 1), ("sense", None)):
        assert "sense" in refusal(written(tmp_path, altered(table, *SCENE, "zones", 1, key, to=to)))


def test_a_coupled_record_has_its_opening():
    body = document("coupled_equal")["scenes"]
    found = {s.name: s for table in gold.tables() for s in table.solutions}
    assert {entry["opening"] is None for entry in body} == {True, False}
    for entry in body:
        solution = found[entry["name"]]
        assert solution.scene.coupling is True
        assert (solution.opening is None) is (entry["opening"] is None)
        assert solution.opening is None or str(solution.opening) in entry["opening"]
    assert {s.opening for s in found.values() if not s.scene.coupling} == {None}


@pytest.mark.parametrize(
    ("place", "to", "message"),
    [
        (("opening",), "0.125000000000", "has 12 digits of 27: rounded"),
        (("opening",), None, "unknown 'coupling'"),
        (("scene", "coupling"), None, "missing coupling"),
        (("scene", "coupling"), "yes", "coupling = 'yes'"),
    ],
)
def test_altered_coupled_tables_are_refused(place, to, message, tmp_path):
    table = document("coupled_equal")
    table["scenes"] = table["scenes"][:1]
    assert message in refusal(written(tmp_path, altered(table, *SCENE, *place, to=to)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "damaged, or not the JSON text of a gold table"),
        ("[1, 2", "damaged, or not"),
        ("[" * 100_000, "damaged, or not"),
        ("[]", '"schema" is not "spectral_contact.gold"'),
        ('{"schema": "spectral_contact.solution"}', '"schema" is not'),
        ('{"schema": "spectral_contact.gold"}', "version None is not known"),
        ('{"schema": "spectral_contact.gold", "version": true}', "version True"),
        ('{"schema": "spectral_contact.gold", "version": 2}', "version 2 .* reads 1"),
        ('{"schema": "spectral_contact.gold", "version": 1}', "missing table, regime, script"),
    ],
)
def test_other_files_are_refused(content, message, tmp_path):
    assert re.search(message, refusal(written(tmp_path, content)))


@pytest.mark.parametrize(
    ("place", "to", "message"),
    [
        (("scenes",), {}, '"scenes" is {}, and must be a list'),
        (("scenes", 0), 3, "scene 1: an object was expected, not 3"),
        (("more",), 1, "unknown 'more'"),
        (("regime",), "", "\"regime\" is '', and must be a text"),
        ((*SCENE, "approach"), None, "missing approach"),
        ((*SCENE, "approach"), 0.125, 'approach" is 0.125, and must be a decimal number as text'),
        ((*SCENE, "approach"), "nan", "must be a decimal number as text"),
        ((*SCENE, "approach"), "inf", "must be a decimal number as text"),
        ((*SCENE, "approach"), "1e99999999999", "must be a decimal number as text"),
        ((*SCENE, "total_shear"), "0.0713329917281", "has 12 digits of 27: rounded"),
        ((*SCENE, "digits"), True, '"digits" is True, and must be a whole number in [15, 60]'),
        ((*SCENE, "digits"), 10**9, "must be a whole number in [15, 60]"),
        ((*SCENE, "error", "zones"), "1e-29", "\"zones\" is '1e-29', and must be in [0, 1)"),
        ((*SCENE, "error", "zones"), float("nan"), '"zones" is nan'),
        ((*SCENE, "error", "edge_ratio"), 0.0, '"edge_ratio" is 0.0, and there is no value'),
        ((*SCENE, "scene", "friction"), None, "missing friction"),
        ((*SCENE, "scene", "friction"), 0.5, "an object was expected, not 0.5"),
        (
            (*SCENE, "scene", "friction", "decimal"),
            "0.0714",
            '"hex" and "decimal" must be texts of the same double',
        ),
        ((*SCENE, "scene", "friction", "hex"), "one", "texts of the same double"),
        (
            (*SCENE, "scene", "poisson_ratio"),
            {"hex": "0x1p+0", "decimal": "1.0"},
            "poisson_ratio = 1.0: must be in (-1, 0.5]",
        ),
        ((*SCENE, "zones", 0, "kind"), "roll", "\"kind\" is 'roll', not stick or slip"),
        ((*SCENE, "zones", 1), None, "zones do not end at the edge"),
        ((*SCENE, "zones", 0), None, "zone 1: it does not begin where the zone before it ends"),
        ((*SCENE, "points", 3), None, None),
        (
            (*SCENE, "points", 3, "from_edge"),
            {"hex": "0x1p+0", "decimal": "1.0"},
            'point 4: "from_edge" must fall from point to point, in [0, 1]',
        ),
        ((*SCENE, "points", 3, "traction"), None, "missing traction"),
    ],
)
def test_altered_tables_are_refused(place, to, message, tmp_path):
    path = written(tmp_path, altered(small(), *place, to=to))
    if message is None:
        assert len(gold.load(path).solutions) == 1
    else:
        assert message in refusal(path)


@pytest.mark.parametrize("side", ["inner", "inner_from_edge"])
def test_a_zone_begins_where_the_one_before_it_ends_from_the_centre_and_from_the_edge(
    side, tmp_path
):
    table = small()
    zone = table["scenes"][0]["zones"][1]
    zone[side] = zone[side][:-1] + str((int(zone[side][-1]) + 1) % 10)
    assert "zone 2: it does not begin where" in refusal(written(tmp_path, table))


def test_a_number_without_its_last_digits_is_refused_and_zeros_before_it_are_no_digits(tmp_path):
    table = small()
    scene = table["scenes"][0]
    digits = scene["total_shear"].removeprefix("0.0")
    scene["total_shear"] = "0.0" + digits[: scene["digits"]]
    gold.load(written(tmp_path, table))
    scene["total_shear"] = "0.0" + digits[: scene["digits"] - 1]
    assert "has 26 digits of 27: rounded" in refusal(written(tmp_path, table))


@pytest.mark.parametrize("exact", ["0", "0.0", "1", "1.0"])
def test_nought_and_one_need_no_more_digits(exact, tmp_path):
    table = small()
    table["scenes"][0]["total_shear"] = exact
    [scene] = gold.load(written(tmp_path, table)).solutions
    assert scene.total_shear == float(exact)


def test_two_scenes_of_one_name_are_refused(tmp_path):
    table = small()
    table["scenes"] *= 2
    assert "the same name" in refusal(written(tmp_path, table))


@pytest.mark.parametrize("path", ["absent.json", ".", None, 3.5])
def test_bad_paths_are_refused(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert re.search("cannot be read|not a path", refusal(path))
