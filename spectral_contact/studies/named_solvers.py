"""Solvers as studies take them: a callable of a scene and a resolution."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from functools import partial
from typing import Any

from spectral_contact.errors import SceneError
from spectral_contact.io.choices import instance
from spectral_contact.scene import Scene

#: ``solver(scene, resolution)`` returns any object with some of the quantities of a study.
Solver = Callable[[Scene, Any], Any]


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
