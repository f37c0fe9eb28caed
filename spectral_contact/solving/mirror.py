"""Scenes of two bodies with κ < 0: the solver takes |κ|, and what is radial changes its sign.

With pressure p and traction q of a scene, ``(p, -q)`` solves the scene with ``-kappa``, with
elastic coupling and without (docs/two_bodies).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from spectral_contact.quantities import RADIAL
from spectral_contact.scene import Scene
from spectral_contact.solution import Solution


def with_positive_kappa(scene: Scene) -> Scene:
    """Return the scene that is solved: of two bodies that with |κ| and without SI data.

    A scene of one body is returned as it is.
    """
    if scene.mismatch is None:
        return scene
    return scene.replace(kappa=abs(scene.mismatch), physical=None)


def mirrored(solution: Solution, scene: Scene) -> Solution:
    """Return the solution of a scene from that of the scene by `with_positive_kappa`.

    Parameters
    ----------
    solution : Solution
        For |κ|.
    scene : Scene
        The scene that was asked for.
    """
    if solution.scene is scene:
        return solution
    if scene.mismatch is None or scene.mismatch >= 0.0:
        return replace(solution, scene=scene)
    values = {
        name: 0.0 - value if name in RADIAL else value  # 0 does not become -0
        for name, value in solution.values.items()
    }
    grown = solution.grown  # how the contact has grown: of its history only the shear is radial
    return replace(
        solution,
        scene=scene,
        values=values,
        traction_field=_reversed(solution.traction_field),
        slip_field=_reversed(solution.slip_field),
        grown=None if grown is None else replace(grown, shears=-grown.shears),
    )


def _reversed(field: Any) -> Any:
    """Return a field with the opposite sign, if there is one."""
    return None if field is None else field.times(-1.0)
