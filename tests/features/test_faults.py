"""Every file operation fails in its turn: nothing that was complete is lost, and work goes on."""

import ast
import functools
import importlib.util
import io
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import peers
import pytest
from matplotlib.figure import Figure
from oracles.faults import FAULTS, every_fault

import spectral_contact
from spectral_contact import Scene, SolutionFileError, solve
from spectral_contact.io import documents
from spectral_contact.studies import convergence
from spectral_contact.sweeps import sweep
from spectral_contact.sweeps.dataset import write
from spectral_contact.sweeps.request import Outcome
from spectral_contact.sweeps.sweep_store import Store
from spectral_contact.view import plotting
from spectral_contact.view.report import write_csv

REPOSITORY = Path(__file__).parents[2]
SCENE = Scene(0.3, 0.5, 0.5, 0.1)
OLD = b"what was there before\n"


@functools.cache
def solution():
    return solve(SCENE, 1e-4)


def study():
    truth = SimpleNamespace(approach=0.25)
    return convergence(peers.Decaying, Scene(0.1, 0.5), (8, 16, 32, 64), truth, repeats=0)


@functools.cache
def dataset():
    return sweep(Scene(0.3, 0.5), quantities=["approach"], rtol=1e-4)


@functools.cache
def drawn(suffix):
    from matplotlib.figure import Figure

    content = io.BytesIO()
    Figure(figsize=(1, 1)).savefig(content, format=suffix)
    return content.getvalue()


class Drawn(Figure):
    """A figure that need not be drawn every time."""

    def savefig(self, where, *, format, **_):
        if hasattr(where, "write"):
            where.write(drawn(format))
        else:
            Path(where).write_bytes(drawn(format))


@functools.cache
def make_gold():
    path = REPOSITORY / "validation" / "gold" / "make_gold.py"
    spec = importlib.util.spec_from_file_location("make_gold", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write_gold(path):
    table = make_gold().Table("no_shear", Path("nowhere"))
    table.path = path
    with documents.reported(str(path), "cannot be written"):
        table.write({"name": make_gold().named(table.scenes[0])})


#: By the name of the file.
SAVERS = {
    "solution.npz": lambda path: solution().save(path),
    "solution.json": lambda path: solution().save(path),
    "fields.csv": lambda path: write_csv(solution(), str(path)),
    "figure.png": lambda path: plotting.save(Drawn(), str(path)),
    "figure.svg": lambda path: plotting.save(Drawn(), str(path)),
    "figure.pdf": lambda path: plotting.save(Drawn(), str(path)),
    "study.json": lambda path: study().save(path),
    "study.csv": lambda path: study().save(path),
    "map.csv": lambda path: write(dataset(), str(path)),
    "map.nc": lambda path: write(dataset(), str(path)),
    "no_shear.json": write_gold,
}
#: Of which a run takes long: there is no space, or Ctrl-C, and once only.
SLOW = ("map.nc", "map.csv")


def same(name, content, whole):
    """Return whether two files say the same; older HDF5 libraries write the time into them."""
    if content == whole or not name.endswith(".nc"):
        return content == whole
    import xarray

    one, other = (xarray.load_dataset(io.BytesIO(x), engine="h5netcdf") for x in (content, whole))
    return one.identical(other)


@pytest.mark.parametrize("name", SAVERS)
def test_a_saved_file_is_complete_or_as_it_was_before(tmp_path, name):
    pytest.importorskip("xarray") if name.startswith("map") else None
    save = SAVERS[name]
    save(tmp_path / name)
    whole = (tmp_path / name).read_bytes()
    runs = tmp_path / "runs"
    runs.mkdir()

    def check(folder, done):
        content = (folder / name).read_bytes()
        assert (not done and content == OLD) or same(name, content, whole)

    done = every_fault(
        runs,
        lambda folder: (folder / name).write_bytes(OLD),
        lambda folder: save(folder / name),
        check,
        **({"faults": FAULTS[::3], "lasting": (False,)} if name in SLOW else {}),
    )
    assert done.count("write") == done.count("fsync") - 1 == 1  # the last one is of the folder
    assert {"replace", "unlink"} <= set(done)


def outcome(number):
    values = {"approach": np.array([number, np.nan]), "approach_error": np.array([1e-9, np.nan])}
    return Outcome(values, np.array([0, 4], dtype=np.int8), {1: f"no {number}"})


def test_a_store_of_a_sweep_loses_nothing(tmp_path):
    description = {"rtol": "1e-8", "chunk": 2}

    def run(folder, count=2):
        store, found = Store(folder / "store", description), []
        for number in range(count):
            if not store.has(number):
                store.put(number, outcome(number))
            found.append(store.get(number))
        return found

    def check(folder, done):
        there = sorted(one.name for one in (folder / "store").glob("[0-9]*"))
        assert there == ["000000.npz", "000001.npz"][: len(there)]
        assert len(there) == 2 if done else len(there) >= started
        for number, one in enumerate(run(folder, len(there))):
            assert (one.messages, one.endings.tolist()) == ({1: f"no {number}"}, [0, 4])
            assert one.values["approach"].tobytes() == outcome(number).values["approach"].tobytes()

    for started, lasting in ((0, (False, True)), (1, (False,))):
        runs = tmp_path / str(started)
        runs.mkdir()
        before = functools.partial(run, count=started) if started else lambda _: None
        done = every_fault(runs, before, run, check, lasting=lasting)
        assert done.count("replace") == 2 - started
        assert done.count("link") == 1 - started


def test_nothing_in_the_library_writes_in_another_way():
    """A writer that is added goes through the ones that are tested here."""
    package = Path(spectral_contact.__file__).parent
    forbidden = {"write_text", "write_bytes", "touch", "rename", "symlink_to", "tofile", "savetxt"}
    forbidden |= {"open", "fdopen"}
    found = []
    for path in sorted(package.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        if path.name == "documents.py" or not any(name in source for name in forbidden):
            continue
        for node in ast.walk(ast.parse(source)):
            if not isinstance(node, ast.Call):
                continue
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if name in forbidden:
                found.append(f"{path.name}: {ast.unparse(node)}")
    assert found == [
        "processes.py: open(os.devnull, 'w', encoding='utf-8')",
        "worker.py: os.fdopen(os.dup(1), 'wb')",  # of the explorer: a pipe
    ]


def test_netcdf_needs_no_temporary_file(tmp_path, monkeypatch):
    """HDF5 may crash where a disk is full."""
    xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nowhere"))
    SAVERS["map.nc"](tmp_path / "map.nc")
    assert xarray.load_dataset(tmp_path / "map.nc").identical(dataset())


def test_a_file_that_is_protected_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / "solution.json"
    path.write_bytes(OLD)
    monkeypatch.setattr(documents.os, "access", lambda *_: False)  # root may write everything
    with pytest.raises(SolutionFileError, match="Permission denied"):
        solution().save(path)
    assert path.read_bytes() == OLD
