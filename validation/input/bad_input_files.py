"""Bad files and bad command lines, made at random: see bad_inputs.py, which runs them."""

from __future__ import annotations

import io
import json
import math
import tempfile
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from bad_input_cases import (
    COUNT,
    FLAT,
    IN_SI,
    TOLERANCE,
    Bench,
    Case,
    Rng,
    junk,
    outside,
    pick,
    text,
)

from spectral_contact import Scene, SceneError, Solution, SolutionFileError
from spectral_contact.io.parameters import SCENE

# --- files ----------------------------------------------------------------------------------------


@cache
def stored(solution: Solution, suffix: str) -> bytes:
    """Return the bytes of a saved solution."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"x{suffix}"
        solution.save(path)
        return path.read_bytes()


def damaged(rng: Rng, content: bytes) -> bytes:
    """Return the bytes with a few places changed."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 4))):
        place, length = int(rng.integers(len(data) or 1)), int(2 ** rng.uniform(0, 10))
        other = rng.bytes(length)
        kind = rng.integers(7)
        if kind == 0:
            del data[place:]
        elif kind == 1:
            del data[place : place + length]
        elif kind == 2:
            data[place:place] = other
        elif kind == 3:
            data[place : place + length] = other
        elif kind == 4:
            data[place:place] = data[place : place + length]
        elif kind == 5:
            data[place : place + length] = bytes(length)
        elif data:
            data[place % len(data)] ^= 1 << int(rng.integers(8))
    return bytes(data)


def places(tree: Any) -> list[tuple[Any, Any]]:
    """Return container and key of every node below a JSON value."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    found = [(tree, key) for key, _ in items]
    for container, key in list(found):
        if isinstance(container[key], (dict, list)):
            found += places(container[key])
    return found


def altered(rng: Rng, document: str) -> str:
    """Return JSON text with one node of the tree replaced, removed or renamed."""
    tree = json.loads(document)
    nodes = places(tree)
    container, key = pick(rng, nodes[:12] if rng.random() < 0.3 else nodes)
    kind = rng.integers(4)
    if kind == 0:
        del container[key]
    elif kind == 1 and isinstance(container, dict):
        container[text(rng)] = container.pop(key)
    else:
        other_container, other_key = pick(rng, nodes)
        values = [None, True, 2, 10**400, 0.5, math.nan, math.inf, text(rng), [], {}, {"x": 1}]
        container[key] = pick(rng, [*values, json.loads(json.dumps(other_container[other_key]))])
    return json.dumps(tree)


def altered_npz(rng: Rng, content: bytes) -> bytes:
    """Return an intact archive with one member replaced, removed or added."""
    with np.load(io.BytesIO(content)) as file:
        members = dict(file)
    name = pick(rng, list(members))
    old, kind = members[name], rng.integers(6)
    if kind == 0:
        del members[name]
    elif kind == 1:
        members[text(rng).replace("\x00", "").replace("\ud800", "") + "x"] = old
    elif kind == 2:
        members["header"] = np.array(altered(rng, members["header"].item()))
    elif kind == 3:
        members[name] = np.array([old.tolist(), None], dtype=object)
    else:
        kinds = [np.float32, complex, ">f8", str, object]
        members[name] = pick(rng, [old.ravel()[:-1], old[None], old + 0 if old.ndim else old])
        if old.dtype.kind == "f":
            members[name] = old.astype(pick(rng, kinds))
    buffer = io.BytesIO()
    np.savez(buffer, **members)
    return buffer.getvalue()


def foreign(rng: Rng) -> bytes:
    """Return the bytes of something else."""
    buffer = io.BytesIO()
    np.savez(buffer, header=np.array("{}"), a=rng.random(3))
    values = [None, True, 1, 1e999, "x", [], {}, [1], {"schema": "spectral_contact.solution"}]
    texts = ["[" * 100_000, '{"a":' * 100_000, "9" * 5000, "", " ", "{", "NaN", text(rng)]
    texts += [json.dumps(value) for value in values] + [Scene(0.1).to_json()]
    own = {"schema": "spectral_contact.solution", "version": pick(rng, [0, 2, 1.0, "1", None])}
    texts.append(json.dumps({**own, "arrays": pick(rng, [{}, [], None, {"a": 1}])}))
    blobs = [rng.bytes(int(rng.integers(500))), b"PK\x03\x04", b"\x93NUMPY", b"\x89PNG\r\n\x1a\n"]
    return pick(
        rng, [*[t.encode(errors="surrogatepass") for t in texts], *blobs, buffer.getvalue()]
    )


def file_case(rng: Rng, bench: Bench) -> Case:
    """Return a file or text that is no longer a solution or a scene."""
    solution = pick(rng, bench.solutions)
    suffix = pick(rng, [".npz", ".json", "text", "scene"])
    kind = pick(rng, ["damaged", "altered", "foreign"])
    if suffix == "scene":
        return scene_text_case(rng, solution.scene, kind)
    content = stored(solution, ".npz" if suffix == ".npz" else ".json")
    if kind == "foreign":
        data = foreign(rng)
    elif kind == "damaged":
        data = damaged(rng, content)
    elif suffix == ".npz":
        data = altered_npz(rng, content)
    else:
        data = altered(rng, content.decode()).encode()
    if suffix == "text":
        value = pick(rng, [data, data.decode(errors="replace")])
        call: Any = partial(Solution.from_json, value)
    else:
        other = {".npz": ".json", ".json": ".npz"}[suffix]
        path = bench.folder / f"x{other if kind == 'foreign' and rng.random() < 0.2 else suffix}"
        call = partial(load_bytes, path, data)
    return Case(f"{suffix}, {kind}", call, (SolutionFileError,), accept=lambda got: got == solution)


def load_bytes(path: Path, data: bytes) -> Solution:
    """Load a solution from a file that holds the data."""
    path.write_bytes(data)
    return Solution.load(path)


def scene_text_case(rng: Rng, scene: Scene, kind: str) -> Case:
    """Return a damaged text of a scene; it has no checksum, so another scene may come of it."""
    source = scene.to_json()
    value: Any = altered(rng, source) if kind == "altered" else damaged(rng, source.encode())
    if kind == "foreign":
        value = pick(rng, [foreign(rng), junk(rng)])
    call: Any = partial(Scene.from_json, value)
    if kind == "foreign" and rng.random() < 0.5:
        parts = [junk(rng), text(rng), 10**5000, np.array([1, 2]), None]
        data = {**scene.to_dict(), pick(rng, ["schema", "version", text(rng)]): pick(rng, parts)}
        call = partial(Scene.from_dict, pick(rng, [data, value]))
    return Case(f"scene, {kind}", call, (SolutionFileError, SceneError), accept=round_trips)


def round_trips(scene: Any) -> bool:
    """Whether the scene read is one that the library can have written."""
    return isinstance(scene, Scene) and Scene.from_json(scene.to_json()) == scene


def path_case(rng: Rng, bench: Bench) -> Case:
    """Return a path from which nothing can be loaded, or to which nothing can be saved."""
    suffix = pick(rng, [".npz", ".json"])
    (bench.folder / f"folder{suffix}").mkdir(exist_ok=True)
    (bench.folder / "file").touch()
    unusable = [f"folder{suffix}", f"none/x{suffix}", f"file/x{suffix}", f"{'x' * 300}{suffix}"]
    unusable += [f"x\x00{suffix}", f"a\nb/x{suffix}", "x.txt", "x", "", f"x{suffix}\n", text(rng)]
    value = junk(rng)
    # an open file's number, and text, are not what this is about
    value = None if isinstance(value, (str, bytes)) else value
    path = pick(rng, [bench.folder / pick(rng, unusable), value])
    if rng.random() < 0.5:
        call: Any = partial(Solution.load, path)
    else:
        call = partial(pick(rng, bench.solutions).save, path)
    return Case("path", call, (SolutionFileError,))


# --- the command line -----------------------------------------------------------------------------

SCENE_OPTIONS = ("--poisson-ratio", "--normal-compliance", "--tangential-compliance", "--friction")
SI_OPTIONS = ("--youngs-modulus", "--radius", "--load", "--normal-compliance-si")
NUMBER_OPTIONS = (*SCENE_OPTIONS, *SI_OPTIONS, "--approach", "--rtol", "--max-unknowns")
OPTIONS = (*NUMBER_OPTIONS, "--quantities", "--output", "--plot")
SI = ("--youngs-modulus=2.1e11", "--radius=0.013")
NO_NUMBERS = ("abc", "", " ", "1,5", "0x10", "1e", "--1", "1 2", "0.1.2", "½", "1j", "nope", "1\n2")
#: Python takes these for numbers; the last two are beyond the doubles.
NO_NUMBERS += ("1_000", "١", "１", "1\u2009", "1e999", "-1e-400")


def argument(rng: Rng) -> str:
    """Return text that a process can be given, and that is neither an option nor a number."""
    return "~" + text(rng).replace("\x00", "").replace("\ud800", "")


def out_of_range(rng: Rng) -> list[str]:
    """Return an option with a number that it must not have."""
    if rng.random() < 0.5:
        ranges = {name: SCENE[name].allowed for name in FLAT}
        ranges |= {"rtol": TOLERANCE, "max_unknowns": COUNT}
        name, allowed = pick(rng, list(ranges.items()))
        return [f"--{name.replace('_', '-')}", repr(outside(rng, allowed))]
    name = pick(rng, ["youngs_modulus", "radius", "load", *FLAT[1:3]])
    ending = "-si" if "compliance" in name else ""
    option = f"--{name.replace('_', '-')}{ending}"
    return [*SI, "--load=1", option, repr(outside(rng, IN_SI[name].allowed))]


def bad_options(rng: Rng, folder: Path) -> tuple[str, list[str]]:
    """Return a kind of mistake, and options that make it."""
    option, word = pick(rng, OPTIONS), argument(rng)
    suffix = pick(rng, [".json", ".csv", ".npz"])
    (folder / f"folder{suffix}").mkdir(exist_ok=True)
    (folder / "file").touch()
    unusable = [f"folder{suffix}", f"none/x{suffix}", f"file/x{suffix}", f"{'x' * 300}{suffix}"]
    unusable += ["x.txt", "x", "", f"x{suffix}~", word, f"{'x/' * 3000}x{suffix}", "x.csv\n"]
    names = pick(rng, ["", word, "approach,", "approach,,zones", "Approach", "approach;zones", "'"])
    mixed = [pick(rng, SCENE_OPTIONS[1:3]), "1", pick(rng, SI_OPTIONS), "1"]
    incomplete = [[SI[0]], [SI[1]], ["--load=1"], [*SI], [*SI, "--load=1", "--approach=1"]]
    incomplete += [["--normal-compliance-si", "0"], [SI[0], "--approach=1e-6"]]
    fields = ["--quantities", "approach", "--output", str(folder / "x.csv")]
    unknown = [f"--{word}", f"{option}x", option[:-1], f"-{word}", "-x", "--colour=red"]
    return pick(
        rng,
        [
            ("unknown option", [pick(rng, unknown)]),
            ("missing value", [option]),
            ("missing value", [option, pick(rng, OPTIONS), "1"]),
            ("no number", [f"{pick(rng, NUMBER_OPTIONS)}={pick(rng, [*NO_NUMBERS, word])}"]),
            ("out of range", out_of_range(rng)),
            ("stray word", [word]),
            ("value of a flag", ["--no-strict=1"]),
            ("mixed units", mixed),
            ("incomplete SI", pick(rng, incomplete)),
            ("quantities", ["--quantities", names]),
            ("file", ["--output", str(folder / pick(rng, unusable))]),
            ("file", ["--plot", str(folder / pick(rng, [*unusable, "x.json", "x.gif"]))]),
            ("table of no field", fields),
        ],
    )


def bad_arguments(rng: Rng, folder: Path) -> tuple[str, list[str]]:
    """Return a kind of mistake, and the arguments of a command line that makes it."""
    kind, options = bad_options(rng, folder)
    if rng.random() < 0.03:
        return "command", pick(rng, [[], [argument(rng)], options, ["Solve"], ["", "solve"]])
    good = ["--rtol=1e-2", "--no-strict", "--friction=none", "--max-unknowns=1000"]
    before = good[: int(rng.integers(len(good) + 1))]
    after = [] if kind == "missing value" else ["--no-strict"] * int(rng.integers(2))
    return kind, ["solve", *before, *options, *after]
