"""A sweep is solved in chunks of scenes: parameters in, columns of results out, in any process.

Chunks are submitted to an executor, or solved one after another in this process.
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
from spectral_contact.sweeps.indentation_curves import indentation_curves, interpolate_curve
from spectral_contact.sweeps.lines import interpolate_line, lines
from spectral_contact.sweeps.request import Outcome, Request, Rows
from spectral_contact.sweeps.shortcuts import served_by_spectra
from spectral_contact.sweeps.sweep_parameters import Columns, Indices, SweepParameters, changed
from spectral_contact.threads import one_thread

if TYPE_CHECKING:
    from spectral_contact.solving.solver import Continuation
    from spectral_contact.solving.uncoupled_run import RadiusFriction

_LOG = logging.getLogger(__name__)

#: Most chunks that are submitted and not done, a number that was chosen: each of them holds memory.
_MOST_SUBMITTED: Final = 64


@one_thread()
def solve_chunk(
    columns: Columns, request: Request, asker: int, continuation: Callable[..., Continuation]
) -> Outcome:
    """Solve some scenes one after another.

    Parameters
    ----------
    columns : Columns
        Sorted, so that neighbours have steps in common.
    request : Request
    asker : int
        Number of the process that asks. If it is the parent of this process, this one ends with it.
    continuation : callable
        `Continuation`, or what takes its place: called with the tolerance, the quantities and the
        largest number of unknowns, it returns an object that solves one scene after another.
    """
    end_with_parent(asker)
    continued = continuation(request.rtol, request.quantities, request.max_unknowns)
    chunk = _Chunk(columns, request, continued)
    # steps that serve many scenes at once come first; each serves scenes that the ones before left
    if request.shared:
        chunk.rows.put(np.arange(len(columns)), served_by_spectra(columns, request))
    for line in lines(columns, chunk.rows.unsolved, request):
        chunk.rows.put(line, interpolate_line(columns[line], request, OnLine(chunk, line)))
    for curve in indentation_curves(columns, chunk.rows.unsolved, request):
        chunk.rows.put(curve, interpolate_curve(columns[curve], request, OnLine(chunk, curve)))
    for i in chunk.rows.unsolved.tolist():
        chunk.solve(i)
    return chunk.rows.outcome()


class _Chunk:
    """The scenes of a chunk and the results so far; a solve may reuse those of earlier scenes."""

    def __init__(self, columns: Columns, request: Request, path: Continuation) -> None:
        self.rows = Rows(len(columns), request)
        self.columns = columns
        self.path = path

    def solve(self, i: int) -> None:
        """Solve a scene, and keep the solution or the exception."""
        try:
            self.rows.take(i, self.path.solve(self.columns.scene(i)))
        except Exception as error:  # whatever it is, the other scenes go on
            self.rows.fail(i, error)


class OnLine:
    """Solves scenes of a line (`lines`) or of an indentation curve, and scenes between them.

    Those between are its first scene with another contact radius or friction.

    Every method returns None for what fails or does not converge: the scenes are then solved one by
    one, and the failure is recorded there.

    Parameters
    ----------
    work : _Chunk
    line : ndarray of int
        Places in the chunk of the scenes of the line.
    """

    def __init__(self, work: _Chunk, line: Indices) -> None:
        self._work = work
        self._line = line.tolist()
        self._first = work.columns.scene(self._line[0])

    def at_scene(self, i: int, extra_quantities: tuple[str, ...]) -> Solution | None:
        """Solve the scene i of the line, with more quantities than were asked for; keep it."""
        place = self._line[i]
        solution = self._converged(lambda: self._work.columns.scene(place), extra_quantities)
        if solution is not None:
            self._work.rows.take(place, solution)
        return solution

    def with_contact_radius(
        self, radius: float, extra_quantities: tuple[str, ...]
    ) -> Solution | None:
        """Solve the first scene with another contact radius, in L."""
        return self._converged(
            lambda: changed(self._first, {"contact_radius": radius}), extra_quantities
        )

    def _converged(
        self, make_scene: Callable[[], Scene], extra_quantities: tuple[str, ...]
    ) -> Solution | None:
        """Make a scene, which may fail, too, and return its solution if it converges."""
        try:
            solution = self._work.path.solve(make_scene(), extra_quantities)
        except Exception:  # `_Chunk.solve` records it
            return None
        return solution if solution.ending is Ending.CONVERGED else None

    def with_stick_radius(self, logit: float) -> RadiusFriction | None:
        """Return the friction with which the first scene has one stick disk of a given radius.

        Parameters
        ----------
        logit : float
            ``ln(c**2/(1 - c**2))`` of the stick radius c.
        """
        try:
            return self._work.path.given_radius(self._first, logit)
        except Exception:  # `_Chunk.solve` records it
            return None


def outcomes(
    parameters: SweepParameters,
    chunks: dict[int, Indices],
    request: Request,
    executor: Executor | None,
    continuation: Callable[..., Continuation],
) -> Generator[tuple[int, Outcome], None, None]:
    """Yield the number and the outcome of every chunk as it is done.

    If the executor breaks, as when a worker is killed, the chunks that are left are solved in this
    process. If the caller closes the generator, chunks that have not begun are cancelled.

    Parameters
    ----------
    parameters : SweepParameters
    chunks : dict of int to ndarray
        The numbers of the scenes of each chunk, by the number of the chunk.
    request : Request
    executor : Executor or None
        None to solve in this process.
    continuation : callable
        As of `solve_chunk`.
    """
    unfinished = dict(chunks)
    if executor is not None:
        try:
            for number, outcome in _submitted(executor, parameters, chunks, request, continuation):
                del unfinished[number]
                yield number, outcome
        except BrokenExecutor as error:
            _LOG.warning("the executor broke (%s): %d chunks are done here", error, len(unfinished))
    for number, scenes in unfinished.items():
        yield number, solve_chunk(parameters.columns(scenes), request, os.getpid(), continuation)


def _submitted(
    executor: Executor,
    parameters: SweepParameters,
    chunks: dict[int, Indices],
    request: Request,
    continuation: Callable[..., Continuation],
) -> Generator[tuple[int, Outcome], None, None]:
    """Submit chunks to an executor, and yield their numbers and outcomes as they are done."""
    running: dict[Future[Outcome], int] = {}
    queue = iter(chunks.items())
    try:
        while True:
            for number, scenes in queue:
                columns: Columns = parameters.columns(scenes)
                task = executor.submit(solve_chunk, columns, request, os.getpid(), continuation)
                running[task] = number
                if len(running) >= _MOST_SUBMITTED:
                    break
            if not running:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
    finally:
        for future in running:
            future.cancel()
