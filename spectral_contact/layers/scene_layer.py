"""Layers of scenes: what goes with them, and layers in documents."""

from __future__ import annotations

from collections.abc import Mapping
from math import isinf
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.io.kinds import kind_from
from spectral_contact.io.physical_data import LARGEST_COMPLIANCE, SMALLEST_COMPLIANCE
from spectral_contact.layers.asperity_law import GreenwoodWilliamson
from spectral_contact.layers.laws import CalculixExponential, Exponential, Linear, PowerLaw
from spectral_contact.layers.layer_base import Layer
from spectral_contact.layers.sampled_law import Sampled, Table
from spectral_contact.layers.user_laws import checked_user_law
from spectral_contact.profiles.shapes import Flat

#: Layers by the name that they have in files.
KINDS: Final[dict[str, type[Layer]]] = {
    one.__name__: one
    for one in (
        Linear,
        PowerLaw,
        Exponential,
        CalculixExponential,
        GreenwoodWilliamson,
        Table,
        Sampled,
    )
}


def check_layer(scene: Mapping[str, Any]) -> None:
    """Check a scene's layer, and that nothing else of the scene needs a linear one."""
    layer = scene["layer"]
    if layer is None:
        return
    checked_law(layer)
    if is_user_law(layer) and scene["friction"]:
        told = "None or 0 with a layer that is none of the library's"
        raise SceneError("friction", scene["friction"], told)
    if isinstance(layer, Linear):
        low = SMALLEST_COMPLIANCE
        high = LARGEST_COMPLIANCE
        if not low <= layer.compliance <= high:
            raise SceneError("layer", layer, f"of a compliance α E'/L in [{low:g}, {high:g}]")
    if scene["normal_compliance"]:
        told = "0 if layer is given, which replaces it"
        raise SceneError("normal_compliance", scene["normal_compliance"], told)
    _check_friction(scene)
    if scene["profile"] is None:
        raise SceneError("profile", None, "given with a layer: profiles.Flat is a flat punch")


def is_user_law(layer: Any) -> bool:
    """Return whether a user wrote the class of a layer."""
    return isinstance(layer, Layer) and type(layer) not in KINDS.values()


def refuse_user_law(parameter: str, layer: Any, where: str) -> None:
    """Refuse a law that a user wrote, where only the library's are known."""
    if is_user_law(layer):
        raise SceneError(parameter, layer, f"one of layers: {', '.join(KINDS)}, {where}")


def checked_law(layer: Any) -> None:
    """Refuse what is no law, or a user's law that is not what it declares."""
    if is_user_law(layer):
        checked_user_law(layer)
    elif type(layer) not in KINDS.values():
        told = f"None, one of layers: {', '.join(KINDS)}, or of a subclass of layers.Layer"
        raise SceneError("layer", layer, told)


def in_own_units(law: Any, modulus: float) -> Layer:
    """Return a law in Pa and m as one in E' and m, where E' is the modulus [Pa]."""
    checked_law(law)
    try:
        scaled: Layer = law._over(modulus)
    except SceneError as error:
        told = f"such that its {error.parameter} over E' = {modulus:.6g} Pa is {error.allowed}"
        raise SceneError("layer", law, told) from error
    return scaled


def _check_friction(scene: Mapping[str, Any]) -> None:
    """Refuse friction, except full stick under a flat punch, whose contact area does not change."""
    flat = isinstance(scene["profile"], Flat)
    friction = scene["friction"]
    if friction and not flat:
        told = "None or 0 with a layer and this profile: the traction of a growing contact is a "
        told += "superposition of flat punches, which holds for linear layers only"
        raise SceneError("friction", friction, told)
    if friction and not isinf(friction):
        told = "None, 0 or infinite with a layer under a flat punch: slip depends on how the "
        told += "pressure has grown, which is not in proportion"
        raise SceneError("friction", friction, told)
    if friction and scene["coupling"]:
        told = "False with friction and a layer: with the traction the pressure is one linear "
        told += "system under linear layers only"
        raise SceneError("coupling", True, told)
    if scene["tangential_compliance"] and not friction:
        told = "0 with a layer and no friction"
        raise SceneError("tangential_compliance", scene["tangential_compliance"], told)


def endless(scene: Any) -> bool:
    """Return whether the contact of a scene has no edge: the layer has pressure at every gap."""
    layer = scene.layer
    return layer is not None and isinf(layer.start) and not isinstance(scene.profile, Flat)


def refuse_layer(scene: Any, what: str) -> None:
    """Refuse a scene with a layer, for a function that supports linear layers only."""
    if scene.layer is not None:
        told = f"a scene without layer: {what} supports only the linear layer, normal_compliance"
        raise SceneError("scene", scene, told)


def layer_from(tree: Any) -> Layer:
    """Return the layer that `kind_tree` wrote."""
    return kind_from("layer", tree, KINDS)
