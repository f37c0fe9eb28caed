"""Nothing of a sweep is lost: stores that resume, that refuse, and that are never damaged."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import spectral_contact
from spectral_contact import Scene, SolutionFileError
from spectral_contact.io import documents
from spectral_contact.sweeps import chunk, sweep, sweep_store

xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")

#: All of it slips, which takes the solution of normal contact alone.
BASE = Scene(0.3, 0.5, 0.5, 0.0)
ALPHAS = np.linspace(0.1, 1.0, 10)
ASKED = {"normal_compliance": ALPHAS, "quantities": ["approach", "zones"], "chunk": 2}
SLEEPY = """
import signal, sys, time
import numpy as np
from spectral_contact import Scene
from spectral_contact.sweeps import chunk, sweep
signal.signal(signal.SIGINT, signal.default_int_handler)  # where it is ignored, as after nohup
original, begun = chunk.solve_chunk, []
original_solve = original
def slow(*arguments):
    begun.append(1)
    time.sleep(60.0 if len(begun) > 3 else 0.05)  # there it waits to be stopped
    return original(*arguments)
chunk.solve_chunk = slow
{more}
sweep(Scene(0.3, 0.5, 0.5, 0.0), normal_compliance=np.linspace(0.1, 1.0, 10),
      quantities=["approach", "zones"], chunk=2, store=sys.argv[1])
"""


def files(folder):
    return sorted(one.name for one in folder.iterdir() if one.name[0] != ".")


#: The same, ended by TERM without a chance to tidy up, while its third chunk is written.
KILLED = """
import os, signal
from spectral_contact.io import documents
original, written = os.fsync, []
def die(descriptor):
    written.append(1)
    if len(written) > 8:
        os.kill(os.getpid(), signal.SIGTERM)
    original(descriptor)
os.fsync = die
chunk.solve_chunk = original_solve
"""


@pytest.fixture
def solved(monkeypatch):
    """Numbers of scenes of the chunks that are solved."""
    counts = []
    original = chunk.solve_chunk

    def counted(columns, *rest):
        counts.append(len(columns))
        return original(columns, *rest)

    monkeypatch.setattr(chunk, "solve_chunk", counted)
    return counts


def start(folder, more=""):
    code = SLEEPY.format(more=more)
    return subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], stderr=subprocess.PIPE, text=True
    )


def wait_for(folder, count):
    end = time.monotonic() + 120
    while time.monotonic() < end:
        if folder.is_dir() and len(files(folder)) >= count:
            return
        time.sleep(0.01)
    raise TimeoutError(f"{folder} has no {count} files")


def test_what_is_in_the_store_is_not_solved_again(tmp_path, solved):
    first = sweep(BASE, **ASKED, store=tmp_path / "a" / "store")
    assert solved == [2] * 5
    again = sweep(BASE, **ASKED, store=tmp_path / "a" / "store")
    assert solved == [2] * 5
    assert again.identical(first)
    assert sweep(BASE, **ASKED).identical(first)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_sweep_that_was_stopped_repeats_one_chunk_at_most(tmp_path, solved, number):
    folder = tmp_path / "store"
    process = start(folder)
    wait_for(folder, 3)  # sweep.json and two chunks
    process.send_signal(number)
    process.communicate()
    assert process.returncode != 0
    there = len(files(folder)) - 1
    assert 2 <= there < 5
    found = sweep(BASE, **ASKED, store=folder)
    assert solved == [2] * (5 - there)
    assert found.identical(sweep(BASE, **ASKED))


@pytest.mark.skipif(sys.platform == "win32", reason="processes are not known by their number")
def test_what_a_killed_sweep_was_writing_is_removed_by_the_next(tmp_path):
    command = [sys.executable, "-c", SLEEPY.format(more=KILLED), str(tmp_path)]
    assert subprocess.run(command, check=False, timeout=120.0).returncode == -signal.SIGTERM
    assert len(list(tmp_path.glob(".spectral_contact-*.tmp"))) == 1
    assert len(files(tmp_path)) > 1
    sweep(BASE, **ASKED, store=tmp_path)
    assert [one.name for one in tmp_path.iterdir() if one.name[0] == "."] == []


@pytest.mark.skipif(sys.platform == "win32", reason="processes are not known by their number")
def test_what_a_process_may_be_writing_is_not_removed(tmp_path):
    sweep(BASE, **ASKED, store=tmp_path)
    own = f"{documents._host()}-{os.getpid()}-0123.tmp"
    other = f"{1 - int(documents._host() == '00000001'):08x}-{2**22 + 1}-0123.tmp"
    old, foreign = "0123456789abcdef.tmp", "notes.tmp"
    paths = [tmp_path / f".spectral_contact-{name}" for name in (own, other, old, foreign)]
    for path in paths:
        path.touch()
    documents.remove_leftovers(tmp_path)
    assert all(path.exists() for path in paths)
    yesterday = time.time() - 100_000.0
    for path in paths:
        os.utime(path, (yesterday, yesterday))
    documents.remove_leftovers(tmp_path)
    assert [path.exists() for path in paths] == [True, False, False, False]


def test_a_full_disk_is_said_and_the_store_goes_on_where_there_is_room(tmp_path, solved):
    folder = tmp_path / "store"
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1500, 1500))"
    process = start(folder, limit)
    _, said = process.communicate()
    assert f"SolutionFileError: {folder}: cannot be written (File too large)" in said
    assert files(folder) == ["sweep.json"]
    assert [one.name for one in folder.iterdir()] == ["sweep.json"]  # no leftovers
    assert sweep(BASE, **ASKED, store=folder).identical(sweep(BASE, **ASKED))


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(SolutionFileError, match="Permission denied"):
        sweep(BASE, **ASKED, store=tmp_path / "store")


def test_a_path_that_is_no_folder(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file", tmp_path / "file" / "store"):
        with pytest.raises(SolutionFileError, match="cannot be read or written"):
            sweep(BASE, **ASKED, store=path)
    with pytest.raises(SolutionFileError, match="not a path"):
        sweep(BASE, **ASKED, store=3.0)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"rtol": 1e-9}, "it is of a sweep with rtol"),
        ({"quantities": ["approach"]}, "it is of a sweep with quantities"),
        ({"chunk": 5}, "it is of a sweep with chunk 2, not 5: use another store"),
        ({"normal_compliance": ALPHAS[::-1]}, "it is of a sweep with other scenes: use another"),
        ({"max_unknowns": 99}, "it is of a sweep with max_unknowns 20000, not 99"),
    ],
)
def test_the_store_of_another_sweep_is_refused_and_left_as_it_is(tmp_path, changed, said):
    first = sweep(BASE, **ASKED, store=tmp_path)
    before = {one.name: one.read_bytes() for one in tmp_path.iterdir()}
    with pytest.raises(SolutionFileError) as caught:
        sweep(BASE, **{**ASKED, **changed}, store=tmp_path)
    assert said in str(caught.value)
    assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == before
    assert sweep(BASE, **ASKED, store=tmp_path).identical(first)


def test_stores_of_another_version_are_refused(tmp_path, monkeypatch):
    version = re.escape(spectral_contact.__version__)
    sweep(BASE, **ASKED, store=tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr("spectral_contact.sweeps.sweep_run.VERSION", "9.9")
        with pytest.raises(SolutionFileError, match=rf"library '{version}', not '9\.9'"):
            sweep(BASE, **ASKED, store=tmp_path)
    manifest = tmp_path / "sweep.json"
    document = json.loads(manifest.read_text())
    manifest.write_text(json.dumps({**document, "version": 3}))
    with pytest.raises(SolutionFileError, match="version 3 is not known to this release"):
        sweep(BASE, **ASKED, store=tmp_path)


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff", b'{"schema": "other"}'])
def test_what_is_no_store_is_refused(tmp_path, content):
    (tmp_path / "sweep.json").write_bytes(content)
    with pytest.raises(SolutionFileError, match="store of a sweep"):
        sweep(BASE, **ASKED, store=tmp_path)
    assert (tmp_path / "sweep.json").read_bytes() == content


def test_a_folder_with_other_things_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("dear")
    with pytest.raises(SolutionFileError, match="not a store of a sweep, and not empty"):
        sweep(BASE, **ASKED, store=tmp_path)
    assert files(tmp_path) == ["thesis.tex"]


@pytest.mark.parametrize("keep", [0, 100, -1])
def test_a_damaged_chunk_is_named_and_solved_again_once_deleted(tmp_path, keep):
    first = sweep(BASE, **ASKED, store=tmp_path)
    chunk = tmp_path / "000003.npz"
    chunk.write_bytes(chunk.read_bytes()[:keep])
    with pytest.raises(SolutionFileError, match=r"000003.npz: damaged: delete this file"):
        sweep(BASE, **ASKED, store=tmp_path)
    chunk.unlink()
    assert sweep(BASE, **ASKED, store=tmp_path).identical(first)


def rewritten(path, change):
    """Write a chunk as a tool would that knows nothing of its header."""
    with np.load(path) as members:
        np.savez(path, **change(dict(members)))


def renamed(members, **changes):
    return {changes.get(name, name): values for name, values in members.items()}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda m: {**m, "approach": m["approach"].astype(str)}, "not those that were stored"),
        (lambda m: {**m, "approach": m["approach"] * 1j}, "not those that were stored"),
        (lambda m: {**m, "approach": m["approach"] * (1 + 1e-15)}, "not those that were stored"),
        (lambda m: {**m, "approach": m["approach"][:1]}, "not those that were stored"),
        (lambda m: {**m, "approach": m["approach"].reshape(2, 1)}, "not those that were stored"),
        (lambda m: {**m, "approach": m["approach"].astype(object)}, "damaged: delete this file"),
        (lambda m: {**m, "more": m["approach"]}, "not those that were stored"),
        (lambda m: renamed(m, approach="slip"), "not those that were stored"),
        (lambda m: {**m, ".endings": m[".endings"] + 1}, "not those that were stored"),
        (lambda m: {**m, ".endings": m[".endings"] + 99}, "not those that were stored"),
        (lambda m: {k: v for k, v in m.items() if k != "approach"}, "not those that were stored"),
        (lambda m: {k: v for k, v in m.items() if k != ".header"}, "no '.header'"),
        (lambda m: {**m, ".header": m[".header"][:-5]}, "damaged: delete this file"),
        (lambda m: {**m, ".header": np.frombuffer(b"[]", np.uint8)}, "not a chunk of a sweep"),
    ],
)
def test_a_chunk_that_was_rewritten_is_refused(tmp_path, change, said):
    first = sweep(BASE, **ASKED, store=tmp_path)
    chunk = tmp_path / "000001.npz"
    rewritten(chunk, change)
    before = {one.name: one.read_bytes() for one in tmp_path.iterdir()}
    with pytest.raises(SolutionFileError, match=r"000001\.npz") as caught:
        sweep(BASE, **ASKED, store=tmp_path)
    assert said in str(caught.value)
    assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == before
    chunk.unlink()
    assert sweep(BASE, **ASKED, store=tmp_path).identical(first)


def test_a_header_that_says_something_else_is_refused(tmp_path):
    sweep(BASE, **ASKED, store=tmp_path)
    with np.load(tmp_path / "000001.npz") as members:
        header = json.loads(members[".header"].tobytes())
    assert header["number"] == 1
    changes = [
        ({"version": 9}, "version 9 is not known"),
        ({"more": 1}, "unknown 'more'"),
        ({"messages": {"0": "nothing"}}, "not those that were stored"),
        ({"messages": None}, "not those that were stored"),
        ({"number": 2}, "it is chunk 2 of the sweep"),
        ({"number": True}, "not those that were stored"),
    ]
    for change, said in changes:
        text = json.dumps(header | change).encode()
        rewritten(
            tmp_path / "000001.npz",
            lambda m, text=text: {**m, ".header": np.frombuffer(text, np.uint8)},
        )
        with pytest.raises(SolutionFileError, match=r"000001\.npz") as caught:
            sweep(BASE, **ASKED, store=tmp_path)
        assert said in str(caught.value)


def test_chunks_that_changed_places_are_refused(tmp_path):
    sweep(BASE, **ASKED, store=tmp_path)
    one, other = tmp_path / "000001.npz", tmp_path / "000002.npz"
    content = one.read_bytes()
    one.write_bytes(other.read_bytes())
    other.write_bytes(content)
    with pytest.raises(SolutionFileError, match=r"000001.npz: it is chunk 2 of the sweep"):
        sweep(BASE, **ASKED, store=tmp_path)


def test_a_chunk_of_another_sweep_is_refused(tmp_path):
    sweep(BASE, **ASKED, store=tmp_path / "one")
    sweep(BASE, **{**ASKED, "rtol": 1e-9}, store=tmp_path / "other")
    content = (tmp_path / "other" / "000001.npz").read_bytes()
    (tmp_path / "one" / "000001.npz").write_bytes(content)
    with pytest.raises(SolutionFileError, match=r"000001.npz: it is of another sweep"):
        sweep(BASE, **ASKED, store=tmp_path / "one")


def test_a_chunk_that_was_compressed_is_refused(tmp_path):
    """Two megabytes of it may be gigabytes of zeros."""
    sweep(BASE, **ASKED, store=tmp_path)
    with np.load(tmp_path / "000001.npz") as members:
        np.savez_compressed(tmp_path / "000001.npz", **members, more=np.zeros(100_000))
    with pytest.raises(SolutionFileError, match=r"damaged: .* [(]it was compressed"):
        sweep(BASE, **ASKED, store=tmp_path)


@pytest.mark.parametrize("other", [(0.1, 1.0), (0.2, 2.0)])
def test_of_two_sweeps_started_at_once_one_is_refused_or_they_are_one(tmp_path, monkeypatch, other):
    both, finished = threading.Barrier(2), threading.Event()
    original = sweep_store.create_file

    def together(path, content):
        if both.wait(60):  # both have seen that there is nothing
            finished.wait(60)  # and one is so slow that the other has done all
        original(path, content)

    def alphas_and_approach(ends, **options):
        alphas = np.linspace(*ends, 4)
        asked = {"normal_compliance": alphas, "quantities": ["approach"], "chunk": 1}
        try:
            return sweep(Scene(0.3), **asked, **options)
        finally:
            finished.set()

    monkeypatch.setattr(sweep_store, "create_file", together)
    ends = [(0.1, 1.0), other]
    with ThreadPoolExecutor(2) as pool:
        begun = [pool.submit(alphas_and_approach, one, store=tmp_path) for one in ends]
    errors = [one.exception() for one in begun]
    assert sum(error is not None for error in errors) == (other != ends[0])
    for one, error, future in zip(ends, errors, begun, strict=True):
        if error is None:
            assert future.result().identical(alphas_and_approach(one))
            assert alphas_and_approach(one, store=tmp_path).identical(future.result())
        else:
            assert isinstance(error, SolutionFileError)
            assert "it is of a sweep with other scenes: use another store" in str(error)


def test_a_store_where_there_are_no_hard_links(tmp_path, monkeypatch):
    def no_link(*_):
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_link)
    first = sweep(BASE, **ASKED, store=tmp_path)
    assert sweep(BASE, **ASKED, store=tmp_path).identical(first)
    with pytest.raises(FileExistsError):
        documents.create_file(str(tmp_path / "sweep.json"), b"")


def test_failures_and_their_messages_survive_the_store(tmp_path):
    asked = {**ASKED, "max_unknowns": 10, "rtol": 1e-10}
    first = sweep(BASE, **asked, store=tmp_path)
    assert (first.ending != "converged").all()
    assert (first.message != "").all()
    assert sweep(BASE, **asked, store=tmp_path).identical(first)


def test_progress_has_the_rate_and_the_time_left(capsys):
    sweep(BASE, **ASKED, progress=True)
    said = capsys.readouterr().err
    assert "scenes/s" in said
    assert "the first scenes" in said
    assert "scenes/s, 0 s left" in said
    assert "100 %" in said


def test_a_dataset_survives_netcdf(tmp_path):
    friction = [0.0, 0.05, np.inf]
    scenes = [Scene(0.3, alpha, 0.5, f) for alpha in (0.0, 0.5) for f in (None, *friction)]
    found = sweep(
        scenes, quantities=["pressure", "zones", "edge_ratio"], from_edge=[0.0, 0.5], rtol=1e-3
    )
    assert np.isinf(found.pressure).any()
    assert np.isnan(found.edge_ratio).any()
    path = tmp_path / "map.nc"
    found.to_netcdf(path)
    loaded = xarray.load_dataset(path)
    assert loaded.identical(found)
    assert loaded.zone_kind.dtype == found.zone_kind.dtype == np.int8
