"""The façade: a scene and a number of digits go in, a solution with its error comes out."""

from __future__ import annotations

from typing import Final

from spectral_contact.io.choices import suggesting
from spectral_contact.precise.certified import certified
from spectral_contact.precise.reference_solution import ReferenceSolution
from spectral_contact.scene import Scene
from spectral_contact.solving.solver import solve


@suggesting()
def reference(scene: Scene, digits: int = 30, *, progress: bool | None = None) -> ReferenceSolution:
    """Solve a scene to any number of digits.

    Normal contact (3.5), full stick (4.2) and partial slip (5.8) on any zones; with elastic
    coupling full stick; under a profile normal contact, with adhesion, too.

    Parameters
    ----------
    scene : Scene
        Its parameters are taken as exactly the doubles they are.
    digits : int
        Relative accuracy of everything, from 15 to 60. Unknowns grow like its square.
    progress : bool, optional
        Whether to show progress (extra: progress); by default on a terminal and in notebooks.

    Returns
    -------
    ReferenceSolution

    Raises
    ------
    SceneError
        For an argument out of its range.
    NotComputedError
        With elastic coupling and slip; with a profile and friction, or so many breaks that a
        dense system of 12,000 unknowns will not do; with a nonlinear layer that has bends, or
        pressure at every gap under a tip or a break; if `solve` has slip everywhere as
        the stick disk is so small or, without tangential compliance, stick everywhere as the slip
        zone is so narrow.
    ConvergenceError
        If the digits are not reached; it carries the solution. If no zones are found on which the
        friction law holds, or these digits do not decide whether it does; it says where.

    Notes
    -----
    Two solutions on different meshes are compared, the second with two digits less: twice their
    difference is the error estimate. `solve` guesses which zones there are, and their boundaries;
    no digit of it enters. The friction law is checked everywhere; where it does not hold, the zones
    are changed as it asks, and solved for again.

    Examples
    --------
    >>> from spectral_contact import Scene
    >>> solution = reference(Scene(0.3, normal_compliance=0.5), digits=20)
    >>> print(solution.approach)
    0.29295979691047814140
    """
    return certified(scene, digits, solve, progress=progress)


__test__: Final = {"reference": reference}  # doctest passes over functions that are wrapped
