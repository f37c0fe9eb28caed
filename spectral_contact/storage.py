"""Solutions as one ``.npz`` or ``.json`` file, or as JSON text: every double exactly, no pickle.

A document has a schema, a version, the library's version, a checksum, the solution as a tree, and
its arrays, named by their place. In the tree a tuple is a list, and what JSON lacks is an object
with one key: ``{"float": "inf"}``, ``{"dict": {...}}``, ``{"array": name}``, or the name of a class
of `_CLASSES` over its fields (a record) or over the name of its member (an enum). A ``.npz`` file
has the arrays as members, and the rest as JSON text in the member ``header``.

The checksum is taken anew from what was loaded, so a file that was changed, by accident or by a
tool that rounds numbers, is refused, and never read as another solution.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import sys
import zipfile
from dataclasses import fields, is_dataclass
from enum import Enum
from io import BytesIO
from pathlib import Path
from types import UnionType
from typing import Any, Final, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from spectral_contact import fields as field_classes
from spectral_contact import records as record_classes
from spectral_contact import scene as scene_classes
from spectral_contact import solution as solution_classes
from spectral_contact.documents import (
    YOUNGER,
    Refused,
    check_schema,
    left_out,
    path_text,
    replace_file,
    reported,
)
from spectral_contact.errors import SolutionFileError, shown
from spectral_contact.records import Zone
from spectral_contact.solution import Solution

__all__ = ["comparable", "from_json", "load", "save", "to_json"]

Arrays = dict[str, NDArray[Any]]

_SCHEMA: Final = "spectral_contact.solution"
_VERSION: Final = 1
_MEMBERS: Final = ("schema", "version", "library", "sha256", "solution")
_SUFFIXES: Final = (".npz", ".json")
_INFINITIES: Final = ("inf", "-inf")

_STORED: Final[tuple[tuple[Any, str], ...]] = (
    (scene_classes, "PhysicalData Scene"),
    (record_classes, "Ending ErrorEstimates Plan PlannedStep RefinementStep StepState StepWork"),
    (record_classes, "Work Zone"),
    (solution_classes, "Solution"),
    (field_classes, "AnnulusSeries DiskSeries EdgeWeight LogSeries PressureField Radius"),
    (field_classes, "ZonalField ZonePiece"),
)
#: All that a file may name, and the types of the fields.
_CLASSES: Final[dict[str, Any]] = {
    name: getattr(module, name) for module, names in _STORED for name in names.split()
}
_HINTS: Final = {cls: get_type_hints(cls) for cls in _CLASSES.values() if is_dataclass(cls)}
#: `Solution.values` is annotated as a dict of anything; this is what may be in it.
_VALUES: Final[dict[str, Any]] = {
    **dict.fromkeys(("approach", "total_shear", "edge_ratio", "critical_friction"), float),
    "zones": tuple[Zone, ...],
    "stick_radius": float | None,
    "opening": float | None,
}


def save(solution: Solution, path: str | os.PathLike[str]) -> None:
    """Store a solution; the file is complete or, after any failure, as it was before.

    Parameters
    ----------
    solution : Solution
    path : str or os.PathLike
        Ends in ``.npz`` or ``.json``, which chooses the format. A file there is replaced.

    Raises
    ------
    SolutionFileError
        For another suffix, a path that cannot be written, or a solution that holds NaN or
        anything else that does not belong into one.
    """
    source, suffix = _source(path)
    with reported(source, "cannot be written"):
        replace_file(source, _npz(solution) if suffix == ".npz" else _json(solution).encode())


def load(path: str | os.PathLike[str]) -> Solution:
    """Return the solution that `save` stored, equal bit for bit; its arrays are read-only.

    Raises
    ------
    SolutionFileError
        For another suffix, or a file that is not there, not ours, changed, damaged, or of another
        version.
    """
    source, suffix = _source(path)
    with reported(source, "cannot be read"):
        content = Path(source).read_bytes()
    with reported(source, f"damaged, or not a {suffix} file of a solution"):
        if suffix == ".json":
            return _unpack(json.loads(content.decode()), None)
        arrays = _npz_members(content)
        return _unpack(json.loads(arrays.pop("header").item()), arrays)


def to_json(solution: Solution) -> str:
    """Return the solution as one line of strict JSON, which is also what `save` writes.

    Raises
    ------
    SolutionFileError
        If the solution holds NaN or anything else that does not belong into one.
    """
    with reported("solution", "cannot be written as JSON"):
        return _json(solution)


def from_json(text: str) -> Solution:
    """Return the solution that `to_json` wrote, equal bit for bit; its arrays are read-only.

    Raises
    ------
    SolutionFileError
        If the text is not JSON, not a solution, changed, damaged, or of another version.
    """
    with reported("solution", "damaged, or not the JSON text of a solution"):
        return _unpack(json.loads(text), None)


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


def _json(solution: Solution) -> str:
    document, arrays = _pack(solution)
    document["arrays"] = {name: _json_array(array) for name, array in arrays.items()}
    return json.dumps(document, allow_nan=False)


def _json_array(array: NDArray[np.float64]) -> dict[str, Any]:
    # The repr of a double, which JSON writes too, is a text that reads back as that double.
    data = [x if math.isfinite(x) else repr(x) for x in array.ravel().tolist()]
    return {"shape": array.shape, "data": data}


def _from_json_array(body: Any) -> NDArray[np.float64]:
    _check_names("an array", body, ("shape", "data"))
    if any(type(x) is not float and x not in _INFINITIES for x in body["data"]):
        raise Refused("an array holds something else than doubles")
    return np.array([float(x) for x in body["data"]]).reshape(body["shape"])


def _npz(solution: Solution) -> bytes:
    document, arrays = _pack(solution)
    members: dict[str, Any] = {"header": np.array(json.dumps(document, allow_nan=False)), **arrays}
    buffer = BytesIO()
    np.savez(buffer, **members)
    return buffer.getvalue()


def _npz_members(content: bytes) -> Arrays:
    # Whole members, so that zip has checked their sums before NumPy allocates what they ask for.
    with zipfile.ZipFile(BytesIO(content)) as archive:
        return {
            name.removesuffix(".npy"): np.load(BytesIO(archive.read(name)), allow_pickle=False)
            for name in archive.namelist()
        }


def _pack(solution: Solution) -> tuple[dict[str, Any], Arrays]:
    """Return the document and the arrays that its tree names."""
    arrays: Arrays = {}
    tree = _encode(solution, arrays, "")
    if not isinstance(solution, Solution):
        raise Refused(f"a {type(solution).__name__} is not a Solution")
    digest = hashlib.sha256(json.dumps(tree, sort_keys=True).encode())
    for array in arrays.values():  # in the order of the tree, which has their names
        digest.update(f"{array.shape}".encode() + array.astype("<f8").tobytes())
    # Not by an import: the package imports the layers above.
    library = sys.modules["spectral_contact"].__version__
    values = (_SCHEMA, _VERSION, library, digest.hexdigest(), tree)
    return dict(zip(_MEMBERS, values, strict=True)), arrays


def _unpack(document: Any, arrays: Arrays | None) -> Solution:
    """Return the solution; without `arrays` they are in the document."""
    check_schema(document, "solution", _SCHEMA, _VERSION)
    if arrays is None:
        arrays = {name: _from_json_array(body) for name, body in document.pop("arrays", {}).items()}
    _check_names("the header", document, _MEMBERS)
    solution: Solution = _decode(document["solution"], arrays)
    again, named = _pack(solution)
    if again["sha256"] != document["sha256"] or named.keys() != arrays.keys():
        raise Refused("its checksum is not that of its contents: it was changed or damaged")
    return solution


def _encode(value: Any, arrays: Arrays, place: str) -> Any:
    """Return the tree of a value, checked; its arrays are added to `arrays`, named by place."""
    value = value.item() if isinstance(value, np.generic) else value
    cls, name = type(value), type(value).__name__
    if value is None or cls in (bool, int, str) or (cls is float and math.isfinite(value)):
        return value
    if cls is float and math.isinf(value):
        return {"float": repr(value)}
    if cls is np.ndarray and value.dtype == np.float64:
        if np.isnan(value).any():
            raise Refused(f"{place} holds NaN")
        arrays[place] = value
        return {"array": place}
    if cls is tuple:
        return [_encode(item, arrays, f"{place}.{i}") for i, item in enumerate(value)]
    if cls is dict:
        return {"dict": {key: _encode(item, arrays, key) for key, item in value.items()}}
    if _CLASSES.get(name) is not cls:
        raise Refused(f"{place}: {value!r:.40} ({name}) does not belong into a solution")
    if isinstance(value, Enum):
        return {name: value.name}
    body = {
        one.name: getattr(value, one.name)
        for one in fields(value)
        if not left_out(one, getattr(value, one.name))
    }
    wrong = [key for key, item in body.items() if not _fits(item, _HINTS[cls][key])]
    if cls is Solution and not wrong:
        wrong = [k for k, item in value.values.items() if not _fits(item, _VALUES.get(k))]
    if wrong:
        raise Refused(f"{name} has fields of the wrong type or name: {', '.join(map(str, wrong))}")
    prefix = f"{place}." if place else ""
    return {name: {key: _encode(item, arrays, prefix + key) for key, item in body.items()}}


def _decode(tree: Any, arrays: Arrays) -> Any:
    """Return the value of a tree, of allowed classes; `_encode` checks the rest."""
    if isinstance(tree, list):
        return tuple(_decode(item, arrays) for item in tree)
    if not isinstance(tree, dict):
        return tree
    [(tag, body)] = tree.items()
    if tag == "float" and body in _INFINITIES:
        return float(body)
    if tag == "dict":
        return {key: _decode(item, arrays) for key, item in body.items()}
    if tag == "array":
        array = arrays[body].astype(np.float64, casting="equiv")  # of either byte order
        array.flags.writeable = False
        return array
    cls = _CLASSES.get(tag)
    if cls is None:
        raise Refused(f"{tag!r} is not a class of which solutions are made")
    if issubclass(cls, Enum):
        return cls[body]
    younger = [one.name for one in fields(cls) if one.metadata == YOUNGER]
    _check_names(tag, body, _HINTS[cls].keys() - set(younger), younger)
    return cls(**{key: _decode(item, arrays) for key, item in body.items()})


def _check_names(what: str, body: Any, expected: Any, optional: Any = ()) -> None:
    if not isinstance(body, dict) or body.keys() - set(optional) != set(expected):
        raise Refused(f"{what} must have {', '.join(expected)}, and has {shown(body)}")


def _fits(value: Any, hint: Any) -> bool:
    """Whether a value is of a type as annotated, for the types that occur; no int is a float."""
    kind, inner = get_origin(hint) or hint, get_args(hint)
    value = value.item() if isinstance(value, np.generic) else value
    if kind in (Union, UnionType):
        return any(_fits(value, one) for one in inner)
    if kind is tuple and type(value) is tuple:
        types = inner[:1] * len(value) if inner[-1] is ... else inner
        return len(value) == len(types) and all(map(_fits, value, types))
    return type(value) is kind
