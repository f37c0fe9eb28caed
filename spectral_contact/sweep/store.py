"""Chunks on disk as they are done, so that a sweep that was stopped goes on.

A store is a folder: ``sweep.json`` says which sweep it is of, and every chunk is a file of its own,
complete or not there.
"""

from __future__ import annotations

import io
import json
import os
from pathlib import Path
from typing import Any, Final

import numpy as np

from spectral_contact.documents import (
    Refused,
    check_schema,
    path_text,
    read_file,
    replace_file,
    reported,
)
from spectral_contact.errors import shown
from spectral_contact.sweep.chunk import Outcome

__all__ = ["Store"]

_SCHEMA: Final = "spectral_contact.sweep"
_VERSION: Final = 1
_MANIFEST: Final = "sweep.json"
_OTHER: Final = "use another store for another sweep"
#: Members of a chunk's file besides its values.
_ENDINGS, _MESSAGES = ".endings", ".messages"


class Store:
    """The chunks of one sweep.

    Parameters
    ----------
    path : str or os.PathLike
        The folder; it is made if it is not there.
    sweep : dict
        What makes it this sweep, as an object of JSON; chunks of another sweep are refused.

    Raises
    ------
    SolutionFileError
        If the folder is no store, of another sweep or version, or cannot be read or written.
    """

    def __init__(self, path: str | os.PathLike[str], sweep: dict[str, Any]) -> None:
        self._source = path_text(path)
        self._folder = Path(self._source)
        manifest = self._folder / _MANIFEST
        with reported(self._source, "cannot be read or written"):
            self._folder.mkdir(parents=True, exist_ok=True)
            if not manifest.exists():
                if any(not one.name.startswith(".") for one in self._folder.iterdir()):
                    raise Refused("not a store of a sweep, and not empty")
                document = {"schema": _SCHEMA, "version": _VERSION, "sweep": sweep}
                replace_file(str(manifest), json.dumps(document, allow_nan=False).encode())
                return
        source, content = read_file(manifest)
        with reported(source, "damaged, or not a store of a sweep"):
            document = json.loads(content.decode())
            check_schema(document, "store of a sweep", _SCHEMA, _VERSION)
            if document.get("sweep") != sweep:
                raise Refused(f"it is of a sweep with {_difference(document.get('sweep'), sweep)}")

    def _file(self, number: int) -> Path:
        return self._folder / f"{number:06d}.npz"

    def has(self, number: int) -> bool:
        """Whether a chunk is there."""
        return self._file(number).exists()

    def put(self, number: int, outcome: Outcome) -> None:
        """Keep a chunk, on disk before this returns.

        Raises
        ------
        SolutionFileError
            If it cannot be written; the store is as it was before.
        """
        messages = json.dumps({str(i): text for i, text in outcome.messages.items()})
        members = {
            **outcome.values,
            _ENDINGS: outcome.endings,
            _MESSAGES: np.frombuffer(messages.encode(), dtype=np.uint8),
        }
        content = io.BytesIO()
        np.savez(content, **members)  # type: ignore[arg-type]  # of NumPy's stub
        with reported(self._source, "cannot be written"):
            replace_file(str(self._file(number)), content.getvalue())

    def get(self, number: int, count: int) -> Outcome:
        """Return a chunk of `count` scenes.

        Raises
        ------
        SolutionFileError
            If its file is damaged.
        """
        source, content = read_file(self._file(number))
        with reported(source, "damaged: delete this file, and it is solved again"):
            with np.load(io.BytesIO(content), allow_pickle=False) as members:
                values = dict(members)
            endings = values.pop(_ENDINGS)
            messages = json.loads(values.pop(_MESSAGES).tobytes().decode())
            if any(len(one) != count for one in (endings, *values.values())):
                raise ValueError("of another length")
            return Outcome(values, endings, {int(i): text for i, text in messages.items()})


def _difference(theirs: Any, ours: dict[str, Any]) -> str:
    """Return in what another sweep differs from this one."""
    known = theirs if isinstance(theirs, dict) else {}
    for name, value in ours.items():
        if known.get(name) != value:
            if name == "scenes":  # a digest says nothing to anybody
                return f"other scenes: {_OTHER}"
            return f"{name} {shown(known.get(name))}, not {shown(value)}: {_OTHER}"
    return f"other members: {_OTHER}"
