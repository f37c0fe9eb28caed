"""What Ctrl-C, TERM and a closed stdout do to the command line, and to the workers that it starts.

Only the standard library is imported here: the package imports this before anything else.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from threading import Thread, current_thread, main_thread
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

if TYPE_CHECKING:
    from concurrent.futures import Executor

__all__ = ["PROGRAM", "VERSION", "end_with_parent", "failed", "guarded", "quiet_imports", "workers"]

PROGRAM, VERSION = "spectral-contact", "0.2.0"


class _Terminated(KeyboardInterrupt):
    """The signal TERM has come. It ends everything that an interrupt ends, in the same way."""


# --- the command line -----------------------------------------------------------------------------


def guarded(run: Callable[[], int]) -> int:
    """Return the exit status of what the command line does.

    Ctrl-C and TERM end it with one line on stderr, and a stdout that is closed ends it in silence.
    """
    # a process that was started without stdout or stderr has None
    sys.stdout = sys.stdout or _nowhere()
    sys.stderr = sys.stderr or _nowhere()
    status = 0
    with _handled({signal.SIGINT: signal.default_int_handler, signal.SIGTERM: _terminate}):
        try:
            status = run()
            sys.stdout.flush()
        except _Terminated:
            return failed("terminated", 143)
        except KeyboardInterrupt:
            return failed("interrupted", 130)
        except OSError as error:  # of stdout; files are reported by those who write them
            _silence(sys.stdout)
            if not isinstance(error, BrokenPipeError):  # as in "| head"
                return failed(f"standard output: {error.strerror}", 2)
    return status


def failed(message: str, status: int) -> int:
    """Say on one line of stderr what went wrong, and return the exit status."""
    try:
        sys.stderr.write(f"{PROGRAM}: {' '.join(message.split())}\n")  # a line is flushed
    except OSError:  # the status says it as well
        _silence(sys.stderr)
    return status


def _nowhere() -> TextIO:
    return open(os.devnull, "w", encoding="utf-8")


def _silence(stream: TextIO) -> None:
    """Discard what a stream that can no longer be written still holds, and what is written later.

    Else the interpreter fails once more when it flushes the stream at its end.
    """
    with suppress(OSError), _nowhere() as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())


# --- signals --------------------------------------------------------------------------------------


def quiet_imports() -> None:
    """Let Ctrl-C end the command line without a traceback while it is still importing.

    In other programs, and where Ctrl-C is ignored, nothing is changed. `guarded` takes over
    from here.
    """
    words = [word for word in sys.orig_argv[1:] if not word.startswith("-")]
    command_line = words and Path(words[0]).stem in (PROGRAM, "spectral_contact")  # script, or -m
    is_default = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if command_line and is_default and current_thread() is main_thread():
        # not by an exception: extension modules turn it into a failed import
        signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextmanager
def _handled(handlers: dict[signal.Signals, Any]) -> Iterator[None]:
    """Let the main thread handle signals by these functions.

    A signal that is ignored, or whose handler is not one of Python, is left as it is.
    """
    with ExitStack() as afterwards:
        if current_thread() is main_thread():
            for signum, handler in handlers.items():
                if signal.getsignal(signum) not in (signal.SIG_IGN, None):
                    afterwards.callback(signal.signal, signum, signal.signal(signum, handler))
        yield


def _terminate(*_: object) -> NoReturn:
    raise _Terminated


# --- workers --------------------------------------------------------------------------------------


#: Pools that an error or an interrupt has stopped. They must not be collected (`workers`).
_STOPPED: list[Executor] = []


@contextmanager
def workers(count: int) -> Iterator[Executor | None]:
    """Yield an executor with a number of processes; None if the number is 1.

    The processes do not survive this one, however it ends, and ignore Ctrl-C, which a terminal
    sends to all of them. If an error or an interrupt leaves the context, their work is not waited
    for.
    """
    if count == 1:
        yield None
        return
    # imported late, as Ctrl-C is to be answered before these imports
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import active_children, get_context

    others = active_children()
    pool = ProcessPoolExecutor(count, get_context("spawn"), end_with_parent, (os.getpid(),))
    with _handled({signal.SIGINT: signal.SIG_IGN}):  # the workers inherit this
        pool.map(int, range(count))  # each task starts a process, as long as all others are busy
    try:
        yield pool
    except BaseException:
        # Tasks are cancelled before the workers are ended. The thread that serves the pool then
        # drops the cancelled ones before it notices that a worker is gone; in Python 3.11 it fails
        # with a traceback at a task that has lost its worker and is cancelled as well. That thread
        # asks the pool whether to cancel anything, maybe after this function has returned, so the
        # pool must not be collected.
        _STOPPED.append(pool)
        pool.shutdown(wait=False, cancel_futures=True)
        for process in {*active_children()}.difference(others):
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def end_with_parent(number: int) -> None:
    """End this process when its parent ends, be it by a kill.

    Parameters
    ----------
    number : int
        The process id of the process that waits for this one's work. Nothing is done if it is not
        the parent: a worker of a cluster has another parent, which looks after it.
    """
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None and parent.pid == number:
        _follow(parent)


@cache
def _follow(parent: Any) -> None:
    """Begin to wait for the end of the parent, in a thread.

    That is done once for each parent: a process that is forked from this one has another parent.
    """

    def end_after() -> NoReturn:
        parent.join()
        os._exit(1)

    Thread(target=end_after, daemon=True).start()
