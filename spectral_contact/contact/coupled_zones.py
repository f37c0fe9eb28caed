"""Elastic coupling with any zones of stick and slip: the solution to a tolerance."""

from __future__ import annotations

import numpy as np

from spectral_contact.contact.coupled_problem import ROUGH, UNFELT, CoupledProblem, CoupledZones
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.solution import Ending
from spectral_contact.spectral.parameters import Parameters

__all__ = ["find_coupled_zones", "solve_coupled_slip", "solve_coupled_zones"]

#: Friction that is as little as nothing.
_FRICTIONLESS = 1e-14
#: A slope of a condition so steep that its boundary does not move.
_FIXED = 1e300
#: Shares of the tolerance that first spaces are for, one after the other where the estimate does
#: not fall any more: what is added to a space here and there may not help, a better one does. And
#: the least tolerance.
_FINER, _TIGHTEST = (1.0, 0.1, 0.01), 1e-12


def find_coupled_zones(parameters: Parameters, layout: Layout) -> Layout:
    """Return the boundaries of zones like these, to some digits, with what starts their solution.

    Parameters and errors are those of `solve_coupled_zones`.
    """
    return CoupledProblem(parameters, layout, ROUGH).layout


def solve_coupled_zones(
    parameters: Parameters,
    layout: Layout,
    tolerance: float,
    max_unknowns: int,
    *,
    pointwise: bool = True,
) -> Refinement[CoupledZones]:
    """Solve the coupled contact with the zones of a layout.

    Parameters
    ----------
    parameters : Parameters
    layout : Layout
        The states of the zones; the boundaries as `find_coupled_zones` returns them, or a guess.
    tolerance : float
        Bound on the relative errors of both fields, pointwise.
    max_unknowns : int
        Most unknowns of a space.
    pointwise : bool
        Whether the fields are wanted; approach and shear alone, which the tolerance bounds then,
        need far fewer unknowns.

    Returns
    -------
    Refinement
        Whether the friction law holds is for the caller to check.

    Raises
    ------
    NoBoundariesError
        If there are no such boundaries.
    """
    best: Refinement[CoupledZones] | None = None
    for finer in _FINER:
        aim = max(finer * tolerance, _TIGHTEST)
        problem = CoupledProblem(parameters, layout, aim, pointwise=pointwise)
        found = refine(problem, tolerance, max_unknowns // 2)
        if best is None or found.best.error < best.best.error:
            best = found
        if best.ending is not Ending.ROUNDING or aim == _TIGHTEST:
            break
    assert best is not None
    return best


def solve_coupled_slip(
    parameters: Parameters, tolerance: float, max_unknowns: int
) -> Refinement[CoupledZones]:
    """Solve with slip everywhere but in a disk too small to be felt, whose radius is given.

    Parameters are those of `solve_coupled_zones`.
    """
    alpha, beta, kappa, friction = parameters
    felt = Parameters(alpha, beta, kappa, max(friction, _FRICTIONLESS))
    disk = Layout((UNFELT,), (0, 1), np.array([[_FIXED]]))
    return solve_coupled_zones(felt, disk, tolerance, max_unknowns)
