"""Studies as files: JSON that can be loaded again, CSV for others; and single points as rows."""

from __future__ import annotations

import csv
import json
import math
import os
from dataclasses import asdict, fields
from io import StringIO
from pathlib import Path
from typing import Any, Final

from spectral_contact.errors import SolutionFileError, shown
from spectral_contact.io.documents import (
    Refused,
    check_keys,
    check_schema,
    path_text,
    read_file,
    replace_file,
    reported,
)
from spectral_contact.scene import Scene
from spectral_contact.studies.fitting import Rate
from spectral_contact.studies.machine import Machine
from spectral_contact.studies.study_results import Convergence, Point, Study, WorkPrecision
from spectral_contact.studies.timing import Stopwatch, Times, Timing
from spectral_contact.view.report import scene_text

#: What `save` knows.
SUFFIXES: Final = (".json", ".csv")
_SCHEMA: Final = "spectral_contact.study"
_VERSION: Final = 1
_KINDS: Final[dict[str, type[Study]]] = {
    "convergence": Convergence,
    "work-precision": WorkPrecision,
}


def save(study: Study, path: str | os.PathLike[str]) -> None:
    """Store a study as its ``save`` says; the suffix is one of `SUFFIXES`."""
    source = path_text(path)
    suffix = Path(source).suffix.lower()
    if suffix not in SUFFIXES:
        raise SolutionFileError(source, f"the suffix must be one of {', '.join(SUFFIXES)}")
    text = _json(study) if suffix == ".json" else _csv(study)
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
        return _study(json.loads(content.decode()))


def point_row(point: Point) -> dict[str, Any]:
    """Return a point as an object of JSON."""
    row = asdict(point)
    row["scene"] = point.scene.to_dict()
    for name in ("errors", "estimates"):
        row[name] = {k: _number(v) for k, v in row[name].items()}
    return row


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else "inf"


def point_from_row(row: Any) -> Point:
    """Return the point that `point_row` wrote; whatever is raised says that the row is damaged."""
    check_keys("a point", row, (one.name for one in fields(Point)))
    values = dict(row, scene=Scene.from_dict(row["scene"]))
    for name in ("errors", "estimates"):
        values[name] = {key: float(value) for key, value in row[name].items()}
    if row["times"] is not None:
        parts = dict(row["times"], warm=Timing(**row["times"]["warm"]))
        if parts["cold"] is not None:
            parts["cold"] = Timing(**parts["cold"])
        values["times"] = Times(**parts)
    return Point(**values)


def _json(study: Study) -> str:
    [kind] = [name for name, cls in _KINDS.items() if isinstance(study, cls)]
    body: dict[str, Any] = {"schema": _SCHEMA, "version": _VERSION, "study": kind}
    body |= {one.name: _encoded(getattr(study, one.name)) for one in fields(study)}
    if isinstance(study, Convergence):
        rates = study.rates.items()
        body["rates"] = {name: None if rate is None else _rate(rate) for name, rate in rates}
    return json.dumps(body, indent=1, allow_nan=False) + "\n"


def _encoded(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_encoded(one) for one in value]
    if isinstance(value, Point):
        return point_row(value)
    if isinstance(value, Scene):
        return value.to_dict()
    return asdict(value) if isinstance(value, (Stopwatch, Machine)) else value


def _rate(rate: Rate) -> dict[str, Any]:
    low, high = rate.interval
    ends = [_number(low), _number(high)]
    return {**asdict(rate), "value": _number(rate.value), "interval": ends}


def _study(body: Any) -> Study:
    check_schema(body, "study", _SCHEMA, _VERSION)
    if body.get("study") not in _KINDS:
        raise Refused(f'"study" is {shown(body.get("study"))}, not {" or ".join(_KINDS)}')
    cls = _KINDS[body["study"]]
    derived = ("rates",) if cls is Convergence else ()  # from the points, for other readers
    names = tuple(one.name for one in fields(cls))
    check_keys("", body, ("schema", "version", "study", *names, *derived))
    values = {name: body[name] for name in names}
    for name, value in values.items():
        if name == "points":
            values[name] = tuple(point_from_row(row) for row in value)
        elif name == "scenes":
            values[name] = tuple(Scene.from_dict(scene) for scene in value)
        elif isinstance(value, list):
            values[name] = tuple(value)
    if "scene" in values:
        values["scene"] = Scene.from_dict(values["scene"])
    values["machine"] = Machine(**values["machine"])
    if values["stopwatch"] is not None:
        values["stopwatch"] = Stopwatch(**values["stopwatch"])
    return cls(**values)


def _csv(study: Study) -> str:
    """Return a row for each point; times in seconds."""
    text = StringIO()
    for line in _comments(study):
        text.write(f"# {line}\n")
    writer = csv.writer(text, lineterminator="\n")
    parameters = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")
    kept = ("resolution", "unknowns", "refinements")
    columns = ["solver", *parameters, *kept]
    columns += [f"{kind}_{name}" for kind in ("error", "estimate") for name in study.quantities]
    for state in ("warm", "cold"):
        columns += [f"{state}_{part}" for part in ("median_s", "lower_s", "upper_s", "repeats")]
    writer.writerow([*columns, "blas_threads", "failure"])
    for point in study.points:
        row = [point.solver, *(getattr(point.scene, name) for name in parameters)]
        row += [getattr(point, name) for name in kept]
        row += [d.get(name) for d in (point.errors, point.estimates) for name in study.quantities]
        times = point.times
        for taken in (None, None) if times is None else (times.warm, times.cold):
            row += [None] * 4 if taken is None else list(asdict(taken).values())
        writer.writerow([*row, None if times is None else times.blas_threads, point.failure])
    return text.getvalue()


def _comments(study: Study) -> list[str]:
    """Return what the rows cannot hold."""
    lines = [str(study.machine)]
    if isinstance(study, Convergence):
        lines.append(f"{scene_text(study.scene)}: {study.truth}")
        lines += [f"{name}: {rate or 'no rate'}" for name, rate in study.rates.items()]
    else:
        for scene, truth in zip(study.scenes, study.truths, strict=True):
            lines.append(f"{scene_text(scene)}: {truth}")
    return lines
