"""A disk that fails once, or from then on, at any one of the file operations in a folder."""

import builtins
import errno
import io
import os
from collections.abc import Callable
from contextlib import contextmanager

import pytest

from spectral_contact import SolutionFileError

#: No space, a broken disk, no permission, and Ctrl-C.
FAULTS = (
    lambda: OSError(errno.ENOSPC, "No space left on device"),
    lambda: OSError(errno.EIO, "Input/output error"),
    lambda: OSError(errno.EACCES, "Permission denied"),
    KeyboardInterrupt,
)
_BY_PATH = ("stat", "listdir", "scandir", "mkdir", "rmdir", "open", "replace", "link", "unlink")


class Disk:
    """Counts the operations on paths in a folder, and lets one of them fail."""

    def __init__(self, folder, fail_at=None, fault=None, lasting=False):
        self.folder, self.fail_at = str(folder), fail_at
        self.fault, self.lasting = fault, lasting
        self.done, self.failed = [], []

    def step(self, name):
        """Count an operation, or fail instead."""
        self.done.append(name)
        number = len(self.done) - 1
        if self.fail_at is None or number < self.fail_at:
            return
        if number == self.fail_at or self.lasting:
            self.failed.append(name)
            raise self.fault()

    def concerns(self, path):
        return isinstance(path, (str, os.PathLike)) and os.fspath(path).startswith(self.folder)

    def by_path(self, name, original):
        def operation(path, *rest, **options):
            if self.concerns(path):
                self.step(name)
            return original(path, *rest, **options)

        return operation

    def fsync(self, _):
        self.step("fsync")  # and nothing more, which would take long

    def open(self, original):
        def operation(path, *rest, **options):
            if not self.concerns(path):
                return original(path, *rest, **options)
            self.step("open a file")
            return File(self, original(path, *rest, **options))

        return operation


class File:
    """A file whose every operation counts; a write that fails has written a part."""

    def __init__(self, disk, file):
        self._disk, self._file = disk, file

    def __getattr__(self, name):
        return getattr(self._file, name)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def read(self, *size):
        self._disk.step("read")
        return self._file.read(*size)

    def write(self, content):
        try:
            self._disk.step("write")
        except BaseException:
            self._file.write(content[: len(content) // 2])
            raise
        return self._file.write(content)

    def flush(self):
        self._disk.step("flush")
        self._file.flush()

    def truncate(self, size):
        self._disk.step("truncate")
        return self._file.truncate(size)

    def close(self):
        self._file.close()
        self._disk.step("close")


@contextmanager
def failing(disk):
    """Let the operations of this process go through a disk."""
    with pytest.MonkeyPatch.context() as patch:
        for name in _BY_PATH:
            patch.setattr(os, name, disk.by_path(name, getattr(os, name)))
        patch.setattr(os, "fsync", disk.fsync)
        patch.setattr(io, "open", disk.open(io.open))
        patch.setattr(builtins, "open", disk.open(builtins.open))
        yield


def every_fault(
    folder, before: Callable, work: Callable, check: Callable, faults=FAULTS, lasting=(False, True)
):
    """Let every file operation of some work fail in its turn, and go on afterwards.

    Parameters
    ----------
    folder : Path
        Empty; everything happens in folders in it.
    before : callable
        Of a folder: makes what is there before.
    work : callable
        Of a folder: the work.
    check : callable
        Of a folder, and whether the work was done: looks whether everything is as it should.
    faults : tuple of callable
        What is raised.
    lasting : tuple of bool
        Whether all later operations fail as well.

    Returns
    -------
    list of str
        The operations.
    """
    runs = 0
    for fault in faults:
        for goes_on in lasting:
            number, reached = 0, True
            while reached:
                here = folder / f"run_{runs}"
                here.mkdir()
                with failing(Disk(here)):
                    before(here)
                disk = Disk(here, number, fault, goes_on)
                try:
                    with failing(disk):
                        work(here)
                    done = True
                except (SolutionFileError, KeyboardInterrupt) as error:
                    assert disk.failed, "an error without a fault"
                    interrupted = isinstance(error, KeyboardInterrupt)
                    assert interrupted == (fault is KeyboardInterrupt)
                    done = False
                check(here, done)
                left = [one for one in here.rglob(".spectral_contact-*")]
                assert not left or goes_on or "unlink" in disk.failed
                with failing(Disk(here)):
                    work(here)
                check(here, True)
                reached = bool(disk.failed)
                number, runs = number + 1, runs + 1
    return disk.done
