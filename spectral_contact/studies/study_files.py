"""Studies as files: JSON that can be loaded again, CSV for others."""

from __future__ import annotations

import csv
import json
import math
import os
from dataclasses import fields, is_dataclass
from io import StringIO
from itertools import product
from typing import Any, Final

from spectral_contact.errors import shown
from spectral_contact.io.documents import (
    Refused,
    check_schema,
    checked_path,
    path_text,
    read_file,
    replace_file,
    reported,
)
from spectral_contact.scene import Scene
from spectral_contact.studies.study_results import Convergence, Point, Study, WorkPrecision
from spectral_contact.studies.timing import Times, Timing

#: Suffixes of files that `save` writes.
SUFFIXES: Final = (".json", ".csv")
_SCHEMA: Final = "spectral_contact.study"
#: Version of the format. Files of version 1 are read, too; their further members are left out.
_VERSION: Final = 2
_KINDS: Final[dict[str, type[Study]]] = {
    "convergence": Convergence,
    "work-precision": WorkPrecision,
}
#: Members that are objects of their own, with their classes.
_RECORDS: Final[dict[str, type]] = {"times": Times, "warm": Timing, "cold": Timing}
_PARAMETERS: Final = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")


def save(study: Study, path: str | os.PathLike[str]) -> None:
    """Store a study as its ``save`` says; the suffix is one of `SUFFIXES`."""
    source = checked_path(path_text(path), SUFFIXES)
    text = _json(study) if source.lower().endswith(".json") else _csv(study)
    with reported(source, "cannot be written"):
        replace_file(source, text.encode())


def load(path: str | os.PathLike[str]) -> Study:
    """Return the study that was saved as ``.json``, equal to it.

    Parameters
    ----------
    path : str or os.PathLike

    Returns
    -------
    Convergence or WorkPrecision

    Raises
    ------
    SolutionFileError
        For a file that is not there, no study, damaged, or of another version.
    """
    source, content = read_file(path)
    with reported(source, "damaged, or not the JSON text of a study"):
        body = json.loads(content.decode())
        version = 1 if isinstance(body, dict) and body.get("version") == 1 else _VERSION
        check_schema(body, "study", _SCHEMA, version)
        if body.get("study") not in _KINDS:
            raise Refused(f'"study" is {shown(body.get("study"))}, not {" or ".join(_KINDS)}')
        study: Study = _record(_KINDS[body["study"]], body)
    return study


def _json(study: Study) -> str:
    [kind] = [name for name, cls in _KINDS.items() if isinstance(study, cls)]
    body = {"schema": _SCHEMA, "version": _VERSION, "study": kind, **_encoded(study)}
    if isinstance(study, Convergence):
        body["rates"] = _encoded(study.rates)  # for other readers: `load` computes them again
    return json.dumps(body, indent=1, allow_nan=False) + "\n"


def _encoded(value: Any) -> Any:
    """Return a value as JSON has it; infinity is the text "inf"."""
    if isinstance(value, Scene):
        return value.to_dict()
    if is_dataclass(value):
        return {one.name: _encoded(getattr(value, one.name)) for one in fields(value)}
    if isinstance(value, dict):
        return {name: _encoded(one) for name, one in value.items()}
    if isinstance(value, tuple):
        return [_encoded(one) for one in value]
    return "inf" if value == math.inf else value


def _record(kind: type, body: Any) -> Any:
    """Return the object of a class that `_encoded` made a dictionary of."""
    return kind(**{one.name: _decoded(one.name, body[one.name]) for one in fields(kind)})


def _decoded(name: str, value: Any) -> Any:
    """Return a member of a study as it was before `_encoded`."""
    if name == "points":
        return tuple(_record(Point, one) for one in value)
    if name in ("scene", "scenes"):
        return Scene.from_dict(value) if name == "scene" else tuple(map(Scene.from_dict, value))
    if name in ("errors", "estimates", "truth_error"):  # infinity is a text
        return {key: float(one) for key, one in value.items()}
    if name in _RECORDS:
        return None if value is None else _record(_RECORDS[name], value)
    return tuple(value) if isinstance(value, list) else value


def _csv(study: Study) -> str:
    """Return a row for each point; times in seconds."""
    rows = []
    for point in study.points:
        row: dict[str, Any] = {"solver": point.solver}
        row |= {name: getattr(point.scene, name) for name in _PARAMETERS}
        row |= {"resolution": point.resolution, "unknowns": point.unknowns}
        row |= {f"error_{name}": point.errors.get(name) for name in study.quantities}
        row |= {f"estimate_{name}": point.estimates.get(name) for name in study.quantities}
        for state, part in product(("warm", "cold"), ("median", "lower", "upper")):
            taken = getattr(point.times, state, None)
            row[f"{state}_{part}_s"] = getattr(taken, part, None)
        rows.append({**row, "failure": point.failure})
    text = StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    truths = (study.truth,) if isinstance(study, Convergence) else study.truths
    notes = [f"{name}: {value}" for name, value in study.machine.items()]
    return "".join(f"# {line}\n" for line in (*notes, *truths)) + text.getvalue()
