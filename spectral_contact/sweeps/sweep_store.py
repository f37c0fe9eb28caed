"""A store keeps the chunks of a sweep on disk, so that a sweep that was stopped can go on.

It is a folder: ``sweep.json`` describes the sweep, and every chunk is a file of its own, which is
complete or absent. The file of a chunk has the digest of its sweep, the number of the chunk and a
checksum of its contents: one that was swapped, copied or rewritten is refused.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import shown
from spectral_contact.io.documents import (
    Refused,
    check_schema,
    create_file,
    difference,
    key_complaint,
    path_text,
    read_file,
    remove_leftovers,
    replace_file,
    reported,
)
from spectral_contact.sweeps.request import Outcome

_SCHEMA: Final = "spectral_contact.sweep"
_CHUNK_SCHEMA: Final = "spectral_contact.sweep.chunk"
_VERSION: Final = 2
_MANIFEST: Final = "sweep.json"
_OTHER: Final = "use another store for another sweep"
_AGAIN: Final = "delete this file, and it is solved again"
#: Members of a chunk's file besides its values.
_ENDINGS, _HEADER = ".endings", ".header"
_KEYS: Final = ("schema", "version", "sweep", "number", "messages")
_DIGEST_KEY: Final = "sha256"


class Store:
    """The chunks of one sweep.

    A folder that is no store, or of another sweep or version, is refused.

    Parameters
    ----------
    path : str or os.PathLike
        The folder; it is made if it is not there.
    sweep : dict
        What makes it this sweep, as an object of JSON.
    """

    def __init__(self, path: str | os.PathLike[str], sweep: dict[str, Any]) -> None:
        self._source = path_text(path)
        self._folder = Path(self._source)
        self._sweep = hashlib.sha256(json.dumps(sweep, sort_keys=True).encode()).hexdigest()
        manifest = self._folder / _MANIFEST
        with reported(self._source, "cannot be read or written"):
            self._folder.mkdir(parents=True, exist_ok=True)
            if not manifest.exists():
                self._begin(manifest, sweep)
            remove_leftovers(self._folder)
        # read it even if it was just written: another process may have been faster
        source, content = read_file(manifest)
        with reported(source, "damaged, or not a store of a sweep"):
            document = json.loads(content.decode())
            check_schema(document, "store of a sweep", _SCHEMA, _VERSION)
            if document.get("sweep") != sweep:
                text = difference(document.get("sweep"), sweep)
                if text.startswith("scenes "):  # nobody can read a digest
                    text = "other scenes"
                raise Refused(f"it is of a sweep with {text}: {_OTHER}")

    def _begin(self, manifest: Path, sweep: dict[str, Any]) -> None:
        """Say of which sweep this store is, unless another process has just done so."""
        foreign = any(not one.name.startswith(".") for one in self._folder.iterdir())
        if foreign and not manifest.exists():
            raise Refused("not a store of a sweep, and not empty")
        document = {"schema": _SCHEMA, "version": _VERSION, "sweep": sweep}
        with suppress(FileExistsError):
            create_file(str(manifest), json.dumps(document, allow_nan=False).encode())

    def _file(self, number: int) -> Path:
        return self._folder / f"{number:06d}.npz"

    def has(self, number: int) -> bool:
        """Whether a chunk is there."""
        with reported(self._source, "cannot be read"):
            return self._file(number).exists()

    def put(self, number: int, outcome: Outcome) -> None:
        """Write a chunk to disk; if that fails, the store stays as it was."""
        messages = {str(i): text for i, text in outcome.messages.items()}
        members = {**outcome.values, _ENDINGS: outcome.endings}
        values = (_CHUNK_SCHEMA, _VERSION, self._sweep, number, messages)
        header: dict[str, Any] = dict(zip(_KEYS, values, strict=True))
        text = json.dumps({**header, _DIGEST_KEY: _digest(header, members)})
        members[_HEADER] = np.frombuffer(text.encode(), dtype=np.uint8)
        content = io.BytesIO()
        np.savez(content, **members)  # type: ignore[arg-type]  # of NumPy's stub
        with reported(self._source, "cannot be written"):
            replace_file(str(self._file(number)), content.getvalue())

    def get(self, number: int) -> Outcome:
        """Return a chunk; a file that is damaged, changed, or not this chunk is refused."""
        source, content = read_file(self._file(number))
        with reported(source, f"damaged: {_AGAIN}"):
            values = _members(content)
            header = json.loads(values.pop(_HEADER).tobytes().decode())
            check_schema(header, "chunk of a sweep", _CHUNK_SCHEMA, _VERSION)
            complaint = key_complaint(header, (*_KEYS, _DIGEST_KEY))
            if complaint:
                raise Refused(f"{complaint}: {_AGAIN}")
            if header["sweep"] != self._sweep:
                raise Refused(f"it is of another sweep: {_AGAIN}")
            if header["number"] != number:
                raise Refused(f"it is chunk {shown(header['number'])} of the sweep: {_AGAIN}")
            if header.pop(_DIGEST_KEY) != _digest(header, values):
                raise Refused(f"its contents are not those that were stored: {_AGAIN}")
            endings, messages = values.pop(_ENDINGS), header["messages"]
            return Outcome(values, endings, {int(i): text for i, text in messages.items()})


def _members(content: bytes) -> dict[str, NDArray[Any]]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        if sum(one.file_size for one in archive.infolist()) > len(content):
            raise ValueError("it was compressed")  # a store does not, and it may unpack endlessly
    with np.load(io.BytesIO(content), allow_pickle=False) as members:
        return dict(members)


def _digest(header: dict[str, Any], members: dict[str, NDArray[Any]]) -> str:
    digest = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
    for name, array in sorted(members.items()):
        digest.update(f"{name} {array.dtype.str} {array.shape}".encode() + array.tobytes())
    return digest.hexdigest()
