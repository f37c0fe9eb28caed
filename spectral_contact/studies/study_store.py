"""Points on disk as they are measured, so that a study that was stopped goes on.

A store is a file of JSON lines, each with its schema and version, the study it belongs to, and one
point. A last line that was cut short is no point, and gives way to the next one.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Final

from spectral_contact.errors import shown
from spectral_contact.io.documents import (
    Refused,
    append_file,
    check_keys,
    check_schema,
    difference,
    path_text,
    reported,
)
from spectral_contact.scene import Scene
from spectral_contact.studies.study_files import point_from_row, point_row
from spectral_contact.studies.study_results import Point

_SCHEMA: Final = "spectral_contact.study.point"
_VERSION: Final = 1
#: Every line begins like this, however short it was cut.
_BEGIN: Final = f'{{"schema": "{_SCHEMA}"'.encode()
_MEMBERS: Final = ("schema", "version", "study", "truth", "point")
_OTHER: Final = "use another store for another study"


class StudyStore:
    """The points of one study; without a path they are kept in memory alone.

    A file that is no store, damaged, or of another study or version is refused.

    Parameters
    ----------
    path : str or os.PathLike or None
        The file; it is made if it is not there.
    study : dict
        What makes it this study, as an object of JSON.
    cases : dict
        What belongs to it: the name of a solver and a scene, and what the scene's truth is as an
        object of JSON.
    """

    def __init__(
        self,
        path: str | os.PathLike[str] | None,
        study: dict[str, Any],
        cases: dict[tuple[str, Scene], Any],
    ) -> None:
        self._source: str | None = None
        self._study, self._cases = study, cases
        self._points: dict[tuple[str, Scene, float], Point] = {}
        if path is None:
            return
        self._source = path_text(path)
        with reported(self._source, "cannot be read or written"):
            file = Path(self._source)
            content = file.read_bytes() if file.exists() else b""
            *lines, cut = content.split(b"\n")
            if cut and cut[: len(_BEGIN)] != _BEGIN[: len(cut)]:
                raise Refused("not a store of a study")
            for number, line in enumerate(lines, 1):
                with reported(f"{self._source}, line {number}", "damaged"):
                    self._take(line)
            # fails now, and not after an hour of work
            append_file(self._source, b"", len(content) - len(cut) if cut else None)

    def _take(self, line: bytes) -> None:
        row = json.loads(line.decode())
        check_schema(row, "store of a study", _SCHEMA, _VERSION)
        check_keys("", row, _MEMBERS)
        if row["study"] != self._study:
            raise Refused(
                f"it is of a study with {difference(row['study'], self._study)}: {_OTHER}"
            )
        point = point_from_row(row["point"])
        case = point.solver, point.scene
        if case not in self._cases:
            asked = f"of solver {point.solver!r} on {point.scene}, which is not asked for"
            raise Refused(f"it is {asked}: {_OTHER}")
        if row["truth"] != self._cases[case]:
            raise Refused(f"it is of another truth, {shown(row['truth'])}: {_OTHER}")
        self._points[point.solver, point.scene, point.resolution] = point

    def get(self, solver: str, scene: Scene, resolution: float) -> Point | None:
        """Return a point, None if it is not there yet."""
        return self._points.get((solver, scene, resolution))

    def add(self, point: Point) -> None:
        """Keep a point, on disk before this returns."""
        if self._source is not None:
            truth = self._cases[point.solver, point.scene]
            members = (_SCHEMA, _VERSION, self._study, truth, point_row(point))
            row = dict(zip(_MEMBERS, members, strict=True))
            with reported(self._source, "cannot be written"):
                line = json.dumps(row, allow_nan=False) + "\n"
                append_file(self._source, line.encode())
        self._points[point.solver, point.scene, point.resolution] = point
