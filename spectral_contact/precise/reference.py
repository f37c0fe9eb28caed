"""The function that users call: a scene and a number of digits in, a certified solution out."""

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

    This is normal contact, full stick and partial slip on any zones: equations (3.5), (4.2) and
    (5.8) of docs/theory. With elastic coupling it is full stick alone, and under a profile normal
    contact alone, with or without adhesion.

    Parameters
    ----------
    scene : Scene
        Its parameters are taken as exactly the doubles they are.
    digits : int
        Correct digits of every number of the solution, from 15 to 60. The number of unknowns grows
        like its square.
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
        With elastic coupling and slip. With a profile and friction, or with so many breaks that
        the dense system would have more than 12,000 unknowns. With a nonlinear layer whose law has
        bends, or whose law has pressure at every gap if the profile has a tip or a break. If the
        stick disk is so small that `solve` finds slip everywhere. If there is no tangential
        compliance and the slip zone is so narrow that `solve` finds stick everywhere.
    ConvergenceError
        If the digits are not reached: the error carries the solution. If no zones are found on
        which the friction law holds, or if these digits do not decide whether it holds: the error
        says where.

    Notes
    -----
    Two solutions on different meshes are compared, of which the second aims at two digits fewer:
    twice their difference is the error estimate. `solve` provides a first guess of the zones and
    their boundaries, and none of the digits. The friction law is checked everywhere; where it is
    violated, the zones are changed accordingly and solved for again.

    Examples
    --------
    >>> from spectral_contact import Scene
    >>> solution = reference(Scene(0.3, normal_compliance=0.5), digits=20)
    >>> print(solution.approach)
    0.29295979691047814140
    """
    return certified(scene, digits, solve, progress=progress)


__test__: Final = {"reference": reference}  # doctest passes over functions that are wrapped
