"""What every reader and writer of files needs: one error for whatever is wrong, one way to write.

Nothing in the library writes a file but `replace_file` and `create_file`.
"""

from __future__ import annotations

import errno
import os
import platform
import secrets
import sys
import time
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from spectral_contact.errors import SolutionFileError, shown

#: Metadata of a dataclass field that came after the first release: documents leave it out where it
#: has its default, so that old files are read, and what does not use it is written as ever.
YOUNGER: Final = {"younger": True}
#: What file systems without hard links say.
_NO_LINKS: Final = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS)


#: How the names of files begin that are written beside their targets.
_BESIDE: Final = ".spectral_contact-"
#: Seconds after which a file is no longer taken for one that is being written, if it is not known
#: whether its process runs: it is of another machine, or on Windows.
_LONGEST_WRITE: Final = 86_400.0
#: The compressions that NumPy uses; and how many times its own size a file may unpack to. Files of
#: this library stay below that, also if another tool has packed them again.
_PACKINGS: Final = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_MOST_INFLATION: Final = 100


class Refused(Exception):
    """What is wrong with a file or a solution, in words that need no prefix."""


@contextmanager
def reported(source: str, failure: str) -> Iterator[None]:
    """Turn whatever is raised inside into a `SolutionFileError`.

    Parameters
    ----------
    source : str
        The file's path, or what the text was meant to be.
    failure : str
        What has failed if something else than `Refused` is raised.
    """
    try:
        yield
    except Refused as error:
        raise SolutionFileError(source, str(error)) from error
    except Exception as error:  # what zip, zlib, JSON and NumPy raise on damage is an open set
        detail = getattr(error, "strerror", None) or str(error) or type(error).__name__
        detail = f"no {detail}" if isinstance(error, KeyError) else " ".join(detail.split())
        raise SolutionFileError(source, f"{failure} ({detail})") from error


def checked_path(path: str, suffixes: Iterable[str]) -> str:
    """Return the path of a file that can be written, before there is any work to lose.

    Raises
    ------
    SolutionFileError
        If its suffix is another, it is a directory or is in none, or permission is denied.
    """
    place = Path(path)
    if place.suffix.lower() not in suffixes:
        raise SolutionFileError(path, f"the suffix must be one of {', '.join(suffixes)}")
    try:
        if place.is_dir():
            raise SolutionFileError(path, "is a directory")
        if not place.parent.is_dir():
            raise SolutionFileError(path, "its directory does not exist")
        # it is replaced by a file made beside it
        needed = [Path(os.path.realpath(place)).parent, *([place] if place.exists() else [])]
        if not all(os.access(one, os.W_OK) for one in needed):
            raise SolutionFileError(path, "cannot be written: permission denied")
    except OSError as error:  # a name too long, or a directory that may not be searched
        raise SolutionFileError(path, f"cannot be written: {error.strerror or error}") from error
    return path


def left_out(field: Any, value: Any) -> bool:
    """Whether a document leaves out the field of a dataclass that has this value."""
    return bool(field.metadata == YOUNGER and value == field.default)


def key_complaint(data: Any, expected: Iterable[str], optional: Iterable[str] = ()) -> str | None:
    """Return what is wrong with the keys of an object; None if they are those expected."""
    if not isinstance(data, Mapping):
        return f"an object was expected, not {shown(data)}"
    names = list(expected)
    missing = [key for key in names if key not in data]
    names += optional
    unknown = [shown(key) for key in data if key not in names]
    complaints = [
        f"{kind} {', '.join(keys)}"
        for kind, keys in (("missing", missing), ("unknown", unknown))
        if keys
    ]
    return f"keys are {'; '.join(complaints)}" if complaints else None


def check_keys(
    where: str, data: Any, expected: Iterable[str], optional: Iterable[str] = ()
) -> None:
    """Check that the keys of an object are those expected; else `Refused` says where it is."""
    complaint = key_complaint(data, expected, optional)
    if complaint:
        raise Refused(f"{where}: {complaint}" if where else complaint)


def check_schema(document: Any, what: str, schema: str, version: int) -> None:
    """Check that a document is what it was meant to be, of a version that this release reads."""
    found = document.get("schema") if isinstance(document, Mapping) else None
    if not isinstance(found, str) or found != schema:
        raise Refused(f'not a {what}: its "schema" is not "{schema}"')
    found = document.get("version")
    if type(found) is not int or found != version:
        known = f"is not known to this release, which reads {version}"
        raise Refused(f"version {shown(found)} {known}")


def difference(theirs: Any, ours: Mapping[str, Any]) -> str:
    """Return in what another object of JSON differs from this one."""
    known = theirs if isinstance(theirs, dict) else {}
    for name, value in ours.items():
        if known.get(name) != value:
            return f"{name} {shown(known.get(name))}, not {shown(value)}"
    return "other members"


def path_text(path: str | os.PathLike[str]) -> str:
    """Return a path as text; `SolutionFileError` if it is none."""
    with reported(shown(path), "not a path"):
        return os.fsdecode(path)


def read_file(path: str | os.PathLike[str]) -> tuple[str, bytes]:
    """Return a path as text, and what is in the file; `SolutionFileError` if it cannot be read."""
    source = path_text(path)
    with reported(source, "cannot be read"):
        return source, Path(source).read_bytes()


def netcdf(dataset: Any) -> bytes:
    """Return what is in the NetCDF file of an xarray dataset."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    # in memory: on a full disk HDF5 may crash when it closes a file
    content = BytesIO()
    with h5netcdf.File(content, "w") as file:
        dataset.dump_to_store(H5NetCDFStore(file))
    return content.getvalue()


def npz_members(content: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of a ``.npz`` file by name, without pickle.

    Memory stays in proportion to the file: sizes are checked as the directory declares them, before
    anything is inflated, and no member is inflated beyond its own. `Refused` is what would inflate
    out of all proportion, or is packed as NumPy packs nothing; other errors say that it is damaged.
    """
    with zipfile.ZipFile(BytesIO(content)) as archive:
        members = archive.infolist()
        if any(member.compress_type not in _PACKINGS for member in members):
            raise Refused("it is compressed in a way that NumPy does not use")
        size = sum(member.file_size for member in members)
        if size > _MOST_INFLATION * len(content):
            raise Refused(f"it would inflate from {len(content)} bytes to {size}")
        return {member.filename.removesuffix(".npy"): _array(archive, member) for member in members}


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    # Whole members, so that zip has checked their sums before NumPy allocates what they ask for;
    # and with a length, since zipfile inflates all of what is read without.
    with archive.open(member) as packed:
        body = packed.read(member.file_size + 1)
    return np.asarray(np.load(BytesIO(body), allow_pickle=False))


def replace_file(path: str, content: bytes) -> None:
    """Write a file; it is complete or, after any failure, an `OSError`, as it was before."""
    target = Path(os.path.realpath(path))  # else a symbolic link would give way to a file
    # a file that may not be written could be replaced all the same
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
    with _beside(target, content) as temporary:
        temporary.replace(target)
    _settle(target.parent)


def create_file(path: str, content: bytes) -> None:
    """Write a file that is not there yet; it is complete or not there.

    `FileExistsError` is raised if it is there, be it that another process was faster.
    """
    target = Path(path)
    with _beside(target, content) as temporary:
        try:
            os.link(temporary, target)
        except OSError as error:
            if error.errno not in _NO_LINKS:
                raise
            _write_new(target, content)  # as exclusive; a kill may leave it cut short
    _settle(target.parent)


def remove_leftovers(folder: Path) -> None:
    """Remove what processes that were killed have left of files that they wrote in a folder.

    A file that a process may still be writing stays: its process runs on this machine, or it is of
    another machine and younger than a day.
    """
    with suppress(OSError):
        for path in folder.glob(f"{_BESIDE}*.tmp"):
            # another process was faster, or the name is not one of ours
            with suppress(OSError, ValueError, OverflowError):
                if _is_left_over(path):
                    path.unlink()


def _is_left_over(path: Path) -> bool:
    host, *rest = path.name.removeprefix(_BESIDE).split("-")
    if host == _host() and len(rest) == 2 and sys.platform != "win32":
        return not _runs(int(rest[0]))
    return time.time() - path.stat().st_mtime > _LONGEST_WRITE


def _runs(process: int) -> bool:
    """Whether a process of this machine, which is not Windows, runs."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # of another user
        return True
    return True


@cache
def _host() -> str:
    """Return eight digits that tell this machine from others."""
    return f"{zlib.crc32(platform.node().encode()):08x}"


@contextmanager
def _beside(target: Path, content: bytes) -> Iterator[Path]:
    """Yield a complete file in the same folder, which is gone afterwards."""
    name = f"{_BESIDE}{_host()}-{os.getpid()}-{secrets.token_hex(8)}.tmp"
    temporary = target.with_name(name)
    try:
        _write_new(temporary, content)
        yield temporary
    finally:
        with suppress(OSError):  # what has failed before is what has to be said
            temporary.unlink()


def _write_new(path: Path, content: bytes) -> None:
    """Write a file that is not there yet; on disk, or not there, unless the process is killed."""
    file = path.open("xb")
    try:
        with file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())  # else a power failure may leave the name without the content
    except BaseException:
        with suppress(OSError):
            path.unlink()
        raise


def _settle(folder: Path) -> None:
    """Put the names in a folder on disk, where the system can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
