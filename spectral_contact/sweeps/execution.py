"""Chunks through an executor, or one after another in this process."""

from __future__ import annotations

import logging
import os
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from typing import Final

from spectral_contact.sweeps.chunk import Outcome, solve_chunk
from spectral_contact.sweeps.parameters import Columns, Indices, SweepParameters
from spectral_contact.sweeps.request import Request

__all__ = ["outcomes"]

_LOG = logging.getLogger(__name__)

#: Chunks that wait for a worker at any time; more would only hold memory.
_AHEAD: Final = 64


def outcomes(
    parameters: SweepParameters,
    chunks: Sequence[tuple[int, Indices]],
    request: Request,
    executor: Executor | None,
) -> Generator[tuple[int, Outcome], None, None]:
    """Yield the number and the outcome of every chunk as it is done.

    What a broken executor (a worker that was killed) leaves is done in this process. When the
    consumer stops, chunks that have not begun are called off.

    Parameters
    ----------
    parameters : SweepParameters
    chunks : sequence of (int, ndarray)
        Number and scenes of each.
    request : Request
    executor : Executor or None
        None is this process.
    """
    left = dict(chunks)
    if executor is not None:
        try:
            for number, outcome in _through(executor, parameters, chunks, request):
                del left[number]
                yield number, outcome
        except BrokenExecutor as error:
            _LOG.warning("the executor broke (%s): %d chunks are done here", error, len(left))
    for number, scenes in left.items():
        yield number, solve_chunk(parameters.columns(scenes), request, os.getpid())


def _through(
    executor: Executor,
    parameters: SweepParameters,
    chunks: Sequence[tuple[int, Indices]],
    request: Request,
) -> Generator[tuple[int, Outcome], None, None]:
    """Keep the executor busy, and yield what it has done."""
    running: dict[Future[Outcome], int] = {}
    queue = iter(chunks)
    try:
        while True:
            for number, scenes in queue:
                columns: Columns = parameters.columns(scenes)
                running[executor.submit(solve_chunk, columns, request, os.getpid())] = number
                if len(running) >= _AHEAD:
                    break
            if not running:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
    finally:
        for future in running:
            future.cancel()
