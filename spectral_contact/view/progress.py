"""A line of progress on stderr or in a notebook."""

from __future__ import annotations

import multiprocessing
import sys
import threading
import warnings
from typing import Any, Self

from spectral_contact.errors import MissingDependencyError
from spectral_contact.io.checks import flag


class ProgressLine:
    """A bar, the share that is done, the time so far and the present step; by tqdm.

    It appears with the first step, and is removed when the work is done; as a context manager also
    if the work raises an exception.

    Parameters
    ----------
    wanted : bool or None
        Whether to show anything. None to show it on a terminal and in a notebook, if tqdm is
        installed, but not in a worker process.

    Raises
    ------
    SceneError
        If `wanted` is something else; it is called ``progress``.
    MissingDependencyError
        If it is wanted and tqdm is not installed (extra: progress).
    """

    def __init__(self, wanted: bool | None) -> None:
        self._make: Any = None
        self._bar: Any = None
        if _watched() if wanted is None else flag("progress", wanted):
            try:
                self._make = _bars()
            except ImportError as error:
                if wanted:
                    raise MissingDependencyError("tqdm", "progress") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None

    def __call__(self, step: str, share: float | None = None) -> None:
        """Show the step and the share in [0, 1] that is done; a share of 1 removes the line.

        If the share is None, the share that is shown does not change. If the first one is None, the
        line has only the time and the step, without a bar and a percentage.
        """
        if self._make is None:
            return
        if self._bar is None:
            bar = "" if share is None else "{percentage:3.0f} %|{bar:20}| "
            form = bar + "{elapsed}  {desc}"  # steps differ too much to tell the time left
            self._bar = self._make(total=1.0, bar_format=form, leave=False, file=sys.stderr)
        if share is not None:
            self._bar.n = share
        self._bar.set_description_str(step)
        if share == 1.0:
            self.__exit__()


def silent(step: str) -> None:
    """Do nothing. It is called with each step where there is no `ProgressLine`."""


def _watched() -> bool:
    """Whether somebody may watch what this process writes; false in a worker process."""
    if multiprocessing.parent_process() is not None:
        return False
    return _in_notebook() or (sys.stderr is not None and sys.stderr.isatty())


def _in_notebook() -> bool:
    """Whether this process runs a notebook."""
    module = sys.modules.get("IPython")
    shell = None if module is None else module.get_ipython()
    return shell is not None and "IPKernelApp" in shell.config


def _bars() -> Any:
    """Return a class of tqdm's bars without its monitoring thread, which makes forks unsafe."""
    if _in_notebook():
        with warnings.catch_warnings():  # without widgets tqdm warns, and works
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    else:
        from tqdm.std import tqdm

    class Bars(tqdm):  # type: ignore[misc]
        monitor_interval = 0

    Bars.set_lock(threading.RLock())
    return Bars
