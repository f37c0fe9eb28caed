"""Solvers as studies take them: a callable of a scene and a resolution."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.inputs.checks import real
from spectral_contact.inputs.choices import instance
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution
from spectral_contact.solving.solver import solve

__all__ = ["OwnSolver", "Solver", "named_solver", "solver_name"]

#: The loosest tolerance that `solve` takes; a looser solve would not be cheaper.
_LOOSEST: Final = 1e-2

#: ``solver(scene, resolution)`` returns any object with some of the quantities of a study.
Solver = Callable[[Scene, Any], Any]


@dataclass(frozen=True, slots=True)
class OwnSolver:
    """`solve` of this library; the resolution is its ``rtol``, at most 1e-2.

    What cannot meet the tolerance is returned as far as it got, with its estimates.

    Parameters
    ----------
    quantities : tuple of str, optional
        What `solve` is asked for; the default is everything.
    """

    quantities: tuple[str, ...] | None = None

    @property
    def name(self) -> str:
        """The name in tables and figures."""
        return "spectral_contact"

    def __call__(self, scene: Scene, rtol: float) -> Solution:
        """Solve a scene to a tolerance."""
        asked = real("rtol", rtol, allowed=">= 1e-13", low=1e-13, infinite_ok=True)
        return solve(scene, min(asked, _LOOSEST), self.quantities, strict=False)


def named_solver(name: str) -> Solver:
    """Return the solver of that name.

    Parameters
    ----------
    name : str
        ``"module:function"``, or ``"module:Class"`` whose constructor takes scene and resolution.

    Raises
    ------
    SceneError
        If there is no such module or callable in it.
    """
    module, colon, path = instance("name", name, str).partition(":")
    if not (module and colon and path):
        raise SceneError("solver", name, "written module:function")
    try:
        found: Any = importlib.import_module(module)
        for part in path.split("."):
            found = getattr(found, part)
    except Exception as error:  # a user's module may raise anything when it is imported
        reason = f"a callable that can be imported ({type(error).__name__}: {error})"
        raise SceneError("solver", name, reason) from error
    if not callable(found):
        raise SceneError("solver", name, "a callable")
    solver: Solver = found
    return solver


def solver_name(solver: Solver) -> str:
    """Return what a solver is called: its ``name``, or that of the function or class."""
    if isinstance(solver, partial):
        return solver_name(solver.func)
    for place in (solver, type(solver)):
        for attribute in ("name", "__name__"):
            found = getattr(place, attribute, None)
            if isinstance(found, str):
                return found
    return "solver"
