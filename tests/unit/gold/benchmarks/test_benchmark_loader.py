import hashlib
import json
import math
import re
import shutil
import subprocess
from importlib import resources

import pytest

from spectral_contact import SceneError, SolutionFileError, benchmarks
from spectral_contact.__main__ import main
from spectral_contact.gold.benchmarks import benchmark_loader

DATA = resources.files("spectral_contact.gold.benchmarks") / "data"


def test_every_file_is_the_one_that_was_published():
    sums = dict(
        reversed(line.split("  ")) for line in (DATA / "SHA256SUMS").read_text().splitlines()
    )
    files = {one.name: one.read_bytes() for one in DATA.iterdir() if one.name != "SHA256SUMS"}
    assert {name: hashlib.sha256(content).hexdigest() for name, content in files.items()} == sums
    expected = {f"{name}{end}" for name in benchmarks.names() for end in (".csv", ".json")}
    assert set(files) == {*expected, "index.json"}
    assert sum(map(len, files.values())) < 300_000  # small enough to vendor


def test_an_altered_file_is_refused(tmp_path, monkeypatch):
    for one in DATA.iterdir():
        (tmp_path / one.name).write_bytes(one.read_bytes())
    monkeypatch.setattr(benchmark_loader, "_folder", lambda: tmp_path)
    path = tmp_path / "smooth_normal.json"
    body = json.loads(path.read_text())
    body["check"]["text"] = "0.126"
    path.write_text(json.dumps(body))
    with pytest.raises(SolutionFileError, match=r"smooth_normal\.json: altered"):
        benchmarks.load("smooth_normal")


@pytest.mark.parametrize("name", ["smoth_normal", "", 3, None])
def test_an_unknown_name_is_refused(name):
    with pytest.raises(SceneError, match="name = "):
        benchmarks.load(name)


@pytest.mark.parametrize("name", benchmarks.names())
def test_a_page_has_all_that_an_outsider_needs(name):
    one = benchmarks.load(name)
    page = one.page()
    assert one.version == benchmarks.VERSION
    # as code, or Markdown takes the star of a symbol for the end of the bold text
    assert f"**`{one.check.symbol} = {one.check.text}`**" in page
    assert "*²" not in re.sub(r"`[^`\n]*`|\n    .*", "", page)
    for heading in ("with dimensions", "without dimensions", "number to compare", "other codes"):
        assert heading in page
    assert all(recipe.text in page for recipe in one.recipes)
    assert all(number.text in page for number in one.values)
    assert f"[{name}.csv]({name}.csv)" in page
    assert 0.0 < one.tolerance < 0.1
    assert one.scene.friction is None or one.scene.friction <= math.inf


def test_two_were_tried():
    tried = [
        r.code for name in benchmarks.names() for r in benchmarks.load(name).recipes if r.tried
    ]
    assert tried == ["tamaas", "scikit-fem"]


def run(capsys, *options):
    status = main(["benchmark", *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_the_list_has_every_check_number(capsys):
    status, out, _ = run(capsys, "list")
    assert status == 0
    for name in benchmarks.names():
        line = next(line for line in out.splitlines() if line.startswith(f"  {name}  "))
        assert benchmarks.load(name).check.text in line


def test_one_is_shown(capsys):
    status, out, _ = run(capsys, "show", "rough_normal")
    assert status == 0
    assert out == benchmarks.load("rough_normal").page()


def test_an_unknown_one_is_one_line(capsys):
    status, out, err = run(capsys, "show", "rough_norml")
    assert (status, out) == (2, "")
    assert "invalid choice: 'rough_norml'" in err
    assert "did you mean rough_normal?" in err
    assert err.count("\n") == 1


def test_they_are_exported_with_checksums(capsys, tmp_path):
    folder = tmp_path / "new" / "folder"
    status, out, _ = run(capsys, "export", "rough_normal", "slip_annulus", "--output", str(folder))
    assert status == 0
    assert out.startswith(f"7 files in {folder}: rough_normal.md, ")
    assert (folder / "rough_normal.csv").read_bytes() == (DATA / "rough_normal.csv").read_bytes()
    if shutil.which("sha256sum"):
        command = ["sha256sum", "--check", "--quiet", "SHA256SUMS"]
        assert subprocess.run(command, cwd=folder, check=False).returncode == 0


def test_all_are_exported_by_default(tmp_path):
    assert len(benchmarks.export(tmp_path)) == 31


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(SolutionFileError, match="cannot be written"):
        benchmarks.export(tmp_path / "file")
