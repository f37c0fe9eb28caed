"""Results as one ``.npz`` or ``.json`` file, or as JSON text: every double exactly, no pickle.

A result is a solution, or another class with a `Document`.

docs/file_format.md describes the files, `spectral_contact.io.schema` declares what is in them. The
checksum is taken anew from what was loaded, so a file that was changed, by accident or by a
tool that rounds numbers, is refused, and never read as another solution.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import sys
from dataclasses import fields, is_dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SolutionFileError
from spectral_contact.io.codecs import Arrays, Record
from spectral_contact.io.documents import (
    Refused,
    check_keys,
    check_schema,
    npz_members,
    path_text,
    replace_file,
    reported,
)
from spectral_contact.io.schema import SOLUTION
from spectral_contact.solution import Solution

_VERSION: Final = 1
_MEMBERS: Final = ("schema", "version", "library", "sha256")
_SUFFIXES: Final = (".npz", ".json")
_INFINITIES: Final = ("inf", "-inf")


class Document(NamedTuple):
    """What a file holds: the name of the result, which is the tree's key, and the tree's root.

    The schema is ``spectral_contact.`` and the name.
    """

    name: str
    root: Record

    @property
    def schema(self) -> str:
        """The schema's name."""
        return f"spectral_contact.{self.name}"


_SOLUTION: Final = Document("solution", SOLUTION)


def save(result: Any, path: str | os.PathLike[str], document: Document = _SOLUTION) -> None:
    """Store a result as `Solution.save` says."""
    source, suffix = _source(path)
    with reported(source, "cannot be written"):
        written = _npz if suffix == ".npz" else _json
        replace_file(source, written(result, document))


def load(path: str | os.PathLike[str], document: Document = _SOLUTION) -> Any:
    """Return the result that `save` stored, as `Solution.load` says; its arrays are read-only."""
    source, suffix = _source(path)
    with reported(source, "cannot be read"):
        content = Path(source).read_bytes()
    with reported(source, f"damaged, or not a {suffix} file of a {document.name}"):
        if suffix == ".json":
            return _unpack(json.loads(content.decode()), None, document)
        arrays = npz_members(content)
        return _unpack(json.loads(arrays.pop("header").item()), arrays, document)


def to_json(solution: Solution) -> str:
    """Return the text that `Solution.to_json` does, which is also what `save` writes."""
    with reported("solution", "cannot be written as JSON"):
        return _json(solution, _SOLUTION).decode()


def from_json(text: str) -> Solution:
    """Return the solution that `to_json` wrote; its arrays are read-only."""
    with reported("solution", "damaged, or not the JSON text of a solution"):
        solution: Solution = _unpack(json.loads(text), None, _SOLUTION)
    return solution


def comparable(value: Any) -> object:
    """Return a solution, or a part of one, as nested tuples that compare by value.

    Fields that do not count in comparisons (wall-clock seconds) are left out; it is hashable.
    """
    if isinstance(value, np.ndarray):
        return value.shape, (value + 0.0).tobytes()  # -0.0 equals 0.0, as it does among floats
    if isinstance(value, tuple):
        return tuple(map(comparable, value))
    if isinstance(value, dict):
        return frozenset((key, comparable(item)) for key, item in value.items())
    if is_dataclass(value):
        own = (getattr(value, one.name) for one in fields(value) if one.compare)
        return type(value), *map(comparable, own)
    return value


def _source(path: str | os.PathLike[str]) -> tuple[str, str]:
    """Return the path as text, and its suffix, which is one of ours."""
    source = path_text(path)
    suffix = Path(source).suffix.lower()
    if suffix not in _SUFFIXES:
        reason = f"the suffix is {suffix!r}, and must be {' or '.join(_SUFFIXES)}"
        raise SolutionFileError(source, reason)
    return source, suffix


def _json(result: Any, document: Document) -> bytes:
    """Return the content of a ``.json`` file."""
    packed, arrays = _pack(result, document)
    packed["arrays"] = {name: _json_array(array) for name, array in arrays.items()}
    return json.dumps(packed, allow_nan=False).encode()


def _json_array(array: NDArray[np.float64]) -> dict[str, Any]:
    """Return an array as JSON has it: its doubles in a list, infinities as text.

    The repr of a double, which JSON writes too, is a text that reads back as that double. If it did
    not, the checksum of what is read would be another one, and the file refused.
    """
    data = [x if math.isfinite(x) else repr(x) for x in array.ravel().tolist()]
    return {"shape": array.shape, "data": data}


def _from_json_array(body: Any) -> NDArray[np.float64]:
    """Return the array that `_json_array` wrote.

    Whole numbers are refused: another program has written them, and the checksum would not notice.
    """
    check_keys("an array", body, ("shape", "data"))
    if any(type(x) is not float and x not in _INFINITIES for x in body["data"]):
        raise Refused("an array holds something else than doubles")
    return np.array([float(x) for x in body["data"]]).reshape(body["shape"])


def _npz(result: Any, document: Document) -> bytes:
    """Return the content of a ``.npz`` file."""
    packed, arrays = _pack(result, document)
    members: dict[str, Any] = {"header": np.array(json.dumps(packed, allow_nan=False)), **arrays}
    buffer = BytesIO()
    np.savez(buffer, **members)
    return buffer.getvalue()


def _pack(result: Any, document: Document) -> tuple[dict[str, Any], Arrays]:
    """Return the document and the arrays that its tree names."""
    if not document.root.holds(result):
        raise Refused(f"a {type(result).__name__} is not {document.root.what}")
    arrays: Arrays = {}
    tree = document.root.encode(result, "", arrays)
    # Not by an import: the package imports the layers above.
    library = sys.modules["spectral_contact"].__version__
    values = (document.schema, _VERSION, library, _checksum(tree, arrays))
    return {**dict(zip(_MEMBERS, values, strict=True)), document.name: tree}, arrays


def _unpack(packed: Any, arrays: Arrays | None, document: Document) -> Any:
    """Return the result; without `arrays` they are in the document."""
    check_schema(packed, document.name, document.schema, _VERSION)
    if arrays is None:
        arrays = {name: _from_json_array(body) for name, body in packed.pop("arrays", {}).items()}
    check_keys("the header", packed, (*_MEMBERS, document.name))
    tree, used = packed[document.name], Arrays()
    result = document.root.decode(tree, "", arrays, used)
    if _checksum(tree, used) != packed["sha256"] or used.keys() != arrays.keys():
        raise Refused("its checksum is not that of its contents: it was changed or damaged")
    return result


def _checksum(tree: Any, arrays: Arrays) -> str:
    """Return the digest of a tree and of its arrays, in the order of the schema."""
    digest = hashlib.sha256(json.dumps(tree, sort_keys=True).encode())
    for array in arrays.values():
        digest.update(f"{array.shape}".encode() + array.astype("<f8").tobytes())
    return digest.hexdigest()
