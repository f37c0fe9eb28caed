"""The work of a sweep, cut in chunks: scenes in, columns of results out; any process can do it.

Chunks go through an executor, or one after another in this process. What solves their scenes is
handed in.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Generator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from typing import TYPE_CHECKING, Final

import numpy as np

from spectral_contact.processes import end_with_parent
from spectral_contact.scene import Scene
from spectral_contact.solution import Ending, Solution
from spectral_contact.sweeps.indentation_curves import along, indentation_curves
from spectral_contact.sweeps.lines import between, lines
from spectral_contact.sweeps.request import Outcome, Request, Rows
from spectral_contact.sweeps.shortcuts import served
from spectral_contact.sweeps.sweep_parameters import Columns, Indices, SweepParameters, changed
from spectral_contact.threads import one_thread

if TYPE_CHECKING:
    from spectral_contact.solving.solver import Continuation
    from spectral_contact.solving.uncoupled_run import RadiusFriction

_LOG = logging.getLogger(__name__)

#: Chunks that wait for a worker at any time; more would only hold memory.
_AHEAD: Final = 64


@one_thread()
def solve_chunk(
    columns: Columns, request: Request, asker: int, path_of: Callable[..., Continuation]
) -> Outcome:
    """Solve some scenes one after another.

    Parameters
    ----------
    columns : Columns
        Sorted, so that neighbours share what they can.
    request : Request
    asker : int
        The process that asks; if it is the parent of this one, this one ends with it.
    path_of : callable
        Makes what solves one scene after another, of tolerance, quantities and most unknowns.
    """
    end_with_parent(asker)
    path = path_of(request.rtol, request.quantities, request.max_unknowns)
    work = _Chunk(columns, request, path)
    if request.shared:
        work.rows.put(np.arange(len(columns)), served(columns, request))
    for line in lines(columns, work.rows.left, request):
        work.rows.put(line, between(columns[line], request, OnLine(work, line)))
    for curve in indentation_curves(columns, work.rows.left, request):
        work.rows.put(curve, along(columns[curve], request, OnLine(work, curve)))
    for i in work.rows.left.tolist():
        work.solve(i)
    return work.rows.outcome()


class _Chunk:
    """The scenes of a chunk as they are solved, each with what the one before it hands on."""

    def __init__(self, columns: Columns, request: Request, path: Continuation) -> None:
        self.rows = Rows(len(columns), request)
        self.columns, self.path = columns, path

    def solve(self, i: int) -> None:
        """Solve a scene."""
        try:
            self.rows.take(i, self.path.solve(self.columns.scene(i)))
        except Exception as error:  # whatever it is, the other scenes go on
            self.rows.fail(i, error)


class OnLine:
    """Solves what a line or a curve asks for; None for what did not converge."""

    def __init__(self, work: _Chunk, line: Indices) -> None:
        self._work, self._line = work, line.tolist()
        self._first = work.columns.scene(self._line[0])

    def at_scene(self, i: int, more: tuple[str, ...]) -> Solution | None:
        """Solve a scene of the line, with more quantities."""
        number = self._line[i]
        found = self._converged(lambda: self._work.columns.scene(number), more)
        if found is not None:
            self._work.rows.take(number, found)
        return found

    def of_radius(self, radius: float, more: tuple[str, ...]) -> Solution | None:
        """Solve the first scene with another contact radius."""
        return self._converged(lambda: changed(self._first, {"contact_radius": radius}), more)

    def _converged(self, scene: Callable[[], Scene], more: tuple[str, ...]) -> Solution | None:
        try:
            solution = self._work.path.solve(scene(), more)
        except Exception:  # the scenes are left to `solve`
            return None
        return solution if solution.ending is Ending.CONVERGED else None

    def at_radius(self, logit: float) -> RadiusFriction | None:
        """Solve for the friction with which the first scene has one disk of this radius."""
        try:
            return self._work.path.given_radius(self._first, logit)
        except Exception:  # the scenes are left to `solve`
            return None


def outcomes(
    parameters: SweepParameters,
    chunks: dict[int, Indices],
    request: Request,
    executor: Executor | None,
    path_of: Callable[..., Continuation],
) -> Generator[tuple[int, Outcome], None, None]:
    """Yield the number and the outcome of every chunk as it is done.

    What a broken executor (a worker that was killed) leaves is done in this process. When the
    consumer stops, chunks that have not begun are called off.

    Parameters
    ----------
    parameters : SweepParameters
    chunks : dict of int to ndarray
        The scenes of each, by its number.
    request : Request
    executor : Executor or None
        None is this process.
    path_of : callable
        As of `solve_chunk`.
    """
    left = dict(chunks)
    if executor is not None:
        try:
            for number, outcome in _through(executor, parameters, chunks, request, path_of):
                del left[number]
                yield number, outcome
        except BrokenExecutor as error:
            _LOG.warning("the executor broke (%s): %d chunks are done here", error, len(left))
    for number, scenes in left.items():
        yield number, solve_chunk(parameters.columns(scenes), request, os.getpid(), path_of)


def _through(
    executor: Executor,
    parameters: SweepParameters,
    chunks: dict[int, Indices],
    request: Request,
    path_of: Callable[..., Continuation],
) -> Generator[tuple[int, Outcome], None, None]:
    """Keep the executor busy, and yield what it has done."""
    running: dict[Future[Outcome], int] = {}
    queue = iter(chunks.items())
    try:
        while True:
            for number, scenes in queue:
                columns: Columns = parameters.columns(scenes)
                task = executor.submit(solve_chunk, columns, request, os.getpid(), path_of)
                running[task] = number
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
