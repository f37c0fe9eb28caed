"""The process that solves for the explorer: reads states, and writes what is to be shown of each.

It is started by `spectral_contact.view.explorer.solver_processes`, and reads pickles from stdin
and writes pickles to stdout. It ends when its stdin ends, as it does when the process that started
it is gone.
"""

from __future__ import annotations

import os
import pickle
import sys
from dataclasses import replace
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any, BinaryIO, Final

from spectral_contact.solving.solver import solve
from spectral_contact.threads import one_thread
from spectral_contact.view.explorer.look import look_at

#: What is written when the library is imported.
READY: Final = "ready"
#: A process that nobody asked anything for so many seconds ends, and frees its memory.
_IDLE_SECONDS: Final = 600.0


def main() -> None:
    """Answer every state that is read with its `Look`, until there are no more."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints must not come between the answers
    requests: SimpleQueue[Any] = SimpleQueue()
    # in a thread, to see the end of stdin during a solve
    Thread(target=_read, args=(sys.stdin.buffer, requests), daemon=True).start()
    _write(answers, READY)
    with one_thread():
        while True:
            try:
                texts = requests.get(timeout=_IDLE_SECONDS)
            except Empty:
                return
            # the page shows the rest, which is less to write
            _write(answers, replace(look_at(texts, solve), solution=None))


def _read(stream: BinaryIO, requests: SimpleQueue[Any]) -> None:
    """Queue what is read; end the process, whatever it is doing, when there is no more."""
    while True:
        try:
            requests.put(pickle.load(stream))
        except (EOFError, OSError, pickle.UnpicklingError):
            os._exit(0)


def _write(stream: BinaryIO, answer: object) -> None:
    pickle.dump(answer, stream)
    stream.flush()


if __name__ == "__main__":
    main()
