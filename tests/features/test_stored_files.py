"""Files that older versions saved load, and say what they said; tests/data/README.md."""

import io
import json
import struct
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from spectral_contact import Scene, SolutionFileError
from spectral_contact.calibration import RoughnessFit
from spectral_contact.solution import Solution
from spectral_contact.studies import load as load_study

DATA = Path(__file__).parents[1] / "data"
FILES = sorted(p for p in (DATA / "solutions").iterdir() if p.name != "expected.json")
EXPECTED = json.loads((DATA / "solutions" / "expected.json").read_text(encoding="utf-8"))
MEGABYTE = 2**20


def document(solution):
    """Return what a solution is saved as, without the library's version."""
    text = json.loads(solution.to_json())
    del text["library"]
    return text


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_old_files_load_and_are_saved_again_as_they_were(path):
    loaded = Solution.load(path)
    again = document(loaded)
    old = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
    del old["library"]
    assert again == old
    assert Solution.from_json(loaded.to_json()) == loaded


@pytest.mark.parametrize("name", EXPECTED["solutions"])
def test_old_files_say_what_they_said(name):
    solution = Solution.load(DATA / "solutions" / f"{name}.json")
    told = EXPECTED["solutions"][name]
    numbers = {key: float.fromhex(text) for key, text in told["values"].items()}
    assert numbers.items() <= solution.values.items()
    zones = solution.values.get("zones", ())
    zones = [[zone.kind, zone.outer.hex(), zone.outer_from_edge.hex()] for zone in zones]
    assert zones == told["zones"]
    for field in ("pressure", "traction", "slip"):
        assert (field in told) == (field in solution.plan.quantities)
        if field in told:
            evaluate = getattr(solution, field)
            found = [*evaluate(EXPECTED["radii"]), *evaluate(from_edge=EXPECTED["from_edge"])]
            expected = list(map(float.fromhex, told[field]))
            assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)  # exp, log vary
    if "load" in told:
        assert solution.physical.load == float.fromhex(told["load"])


def test_the_old_files_have_every_tag():
    text = (DATA / "solutions" / "every_record.json").read_text(encoding="utf-8")
    tags = "PhysicalData Scene Plan PlannedStep StepState ErrorEstimates Ending Work StepWork "
    tags += "RefinementStep Zone PressureField EdgeWeight ZonalField ZonePiece Radius "
    tags += "AnnulusSeries LogSeries DiskSeries Solution"
    assert all(f'{{"{tag}": ' in text for tag in tags.split())


def test_old_scenes_and_fits_load_and_are_saved_again_as_they_were():
    for old in json.loads((DATA / "scenes.json").read_text(encoding="utf-8")):
        assert Scene.from_dict(old).to_dict() == old
    text = (DATA / "fit.json").read_text(encoding="utf-8").strip()
    assert RoughnessFit.from_json(text).to_json() == text


@pytest.mark.parametrize("name", ["convergence.json", "work_precision.json"])
def test_old_studies_load_and_are_saved_again_by_a_newer_version(name, tmp_path):
    old = json.loads((DATA / name).read_text(encoding="utf-8"))
    load_study(DATA / name).save(tmp_path / name)
    new = json.loads((tmp_path / name).read_text(encoding="utf-8"))
    assert (old["version"], new["version"]) == (1, 2)
    for ours, theirs in zip(new.pop("points"), old["points"], strict=True):
        times = ours.pop("times")
        assert ours.items() <= theirs.items()
        assert times is None or times.items() <= theirs["times"].items()
    del new["version"]
    if "rates" in new:
        assert new.pop("rates").keys() == old["rates"].keys()
    assert new.items() <= old.items()


# --- files that inflate ---------------------------------------------------------------------------


def packed(members, method=zipfile.ZIP_DEFLATED):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", method, compresslevel=9) as archive:
        for name, body in members.items():
            archive.writestr(name, body)
    return content.getvalue()


def npy_of_zeros(size):
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        head, {"descr": "<f8", "fortran_order": False, "shape": (size // 8,)}
    )
    return head.getvalue() + bytes(size)


def peak_of_loading(path):
    """Return the largest memory that a refusal took, and its reason."""
    tracemalloc.start()
    try:
        with pytest.raises(SolutionFileError) as caught:
            Solution.load(path)
        return tracemalloc.get_traced_memory()[1], caught.value.reason
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("member", ["header.npy", "extra.npy"])
def test_a_file_that_would_inflate_is_refused_before_it_does(member, tmp_path):
    path = tmp_path / "bomb.npz"
    path.write_bytes(packed({member: npy_of_zeros(16 * MEGABYTE)}))
    assert path.stat().st_size < MEGABYTE // 32
    peak, reason = peak_of_loading(path)
    assert "would inflate from" in reason
    assert peak < MEGABYTE


def test_many_members_that_inflate_are_refused_together(tmp_path):
    path = tmp_path / "bomb.npz"
    path.write_bytes(packed({f"{i}.npy": npy_of_zeros(MEGABYTE) for i in range(16)}))
    peak, reason = peak_of_loading(path)
    assert "would inflate from" in reason
    assert peak < MEGABYTE


def test_a_directory_that_lies_about_sizes_does_not_inflate_more_than_it_says(tmp_path):
    content = bytearray(packed({"header.npy": npy_of_zeros(16 * MEGABYTE)}))
    directory = content.index(b"PK\x01\x02")
    struct.pack_into("<I", content, directory + 24, 1000)
    path = tmp_path / "bomb.npz"
    path.write_bytes(content)
    peak, _ = peak_of_loading(path)
    assert peak < MEGABYTE


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_packings_that_numpy_does_not_use_are_refused(method, tmp_path):
    path = tmp_path / "bomb.npz"
    path.write_bytes(packed({"header.npy": npy_of_zeros(1000)}, method))
    assert "compressed in a way" in peak_of_loading(path)[1]


@pytest.mark.parametrize("name", [path.stem for path in FILES if path.suffix == ".npz"])
def test_files_that_were_compressed_by_others_load(name, tmp_path):
    path = DATA / "solutions" / f"{name}.npz"
    with np.load(path) as members:
        np.savez_compressed(tmp_path / "a.npz", **members)
    assert (tmp_path / "a.npz").stat().st_size < path.stat().st_size
    assert Solution.load(tmp_path / "a.npz") == Solution.load(path)
