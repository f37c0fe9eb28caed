"""The work of adhesion of a scene, and what goes with it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import whole
from spectral_contact.io.parameters import SCENE


def checked_adhesion(scene: Mapping[str, Any]) -> float | None:
    """Return the work of adhesion of a scene, None if there is none.

    The scene is a mapping of all that it has, the friction and the layer checked already.

    Raises
    ------
    SceneError
        If it is out of its range, or the scene has friction, coupling, a nonlinear layer or no
        profile.
    """
    value = scene["work_of_adhesion"]
    if value is None:
        return None
    adhesion = float(SCENE["work_of_adhesion"].checked("work_of_adhesion", value))
    if scene["profile"] is None:
        told = "given with work_of_adhesion, as are a load or an approach: without a profile the "
        told += "load is the unit, and with adhesion it may be 0; a flat punch is profiles.Flat"
        raise SceneError("profile", None, told)
    if scene["friction"] is not None:
        told = "None with work_of_adhesion: adhesion is without friction"
        raise SceneError("friction", scene["friction"], told)
    if scene["coupling"]:
        told = "False with work_of_adhesion: adhesion is without friction, which elastic coupling "
        raise SceneError("coupling", True, told + "acts through")
    if scene["layer"] is not None:
        told = "None with work_of_adhesion: adhesion is with a linear layer, normal_compliance"
        raise SceneError("layer", scene["layer"], told)
    return adhesion


def checked_branch(scene: Mapping[str, Any]) -> int:
    """Return the number of the state that is meant, of several with one load or approach.

    They are counted along the curve of states: 0 is the one on the stretch of large contacts, 1
    that on the next stretch to smaller contacts, and so on (`Scene`).

    Raises
    ------
    SceneError
        If it is no whole number, or another than 0 where there is one state.
    """
    branch = whole("branch", scene["branch"], 0)
    if branch and scene["work_of_adhesion"] is None:
        raise SceneError("branch", branch, "0 without work_of_adhesion: there is one state")
    if branch and scene["contact_radius"] is not None:
        raise SceneError("branch", branch, "0 with contact_radius: a radius has one state")
    return branch


def refuse_adhesion(scene: Any, what: str) -> None:
    """Refuse a scene with adhesion, for a function that does not support it."""
    if scene.work_of_adhesion is not None:
        told = f"a scene without work_of_adhesion: {what} does not support adhesion"
        raise SceneError("scene", scene, told)
