"""Layers of scenes: what goes with them, and layers in documents."""

from __future__ import annotations

from collections.abc import Mapping
from math import isinf
from typing import Any, Final

from spectral_contact.errors import SceneError
from spectral_contact.inputs.kinds import kind_from
from spectral_contact.inputs.physical import LARGEST_COMPLIANCE, SMALLEST_COMPLIANCE
from spectral_contact.layers.asperities import GreenwoodWilliamson
from spectral_contact.layers.base import Layer
from spectral_contact.layers.laws import CalculixExponential, Exponential, Linear, PowerLaw
from spectral_contact.layers.sampled import Sampled, Table
from spectral_contact.profiles import Flat

__all__ = ["KINDS", "check_layer", "endless", "in_own_units", "layer_from", "refuse_layer"]

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
    """Check the layer of a scene, and that nothing else of it needs a linear one.

    Parameters
    ----------
    scene : mapping
        What a scene has, by name.

    Raises
    ------
    SceneError
        If it does, or the layer is no layer.
    """
    layer = scene["layer"]
    if layer is None:
        return
    if type(layer) not in KINDS.values():
        raise SceneError("layer", layer, f"None or one of layers: {', '.join(KINDS)}")
    if isinstance(layer, Linear):
        low, high = SMALLEST_COMPLIANCE, LARGEST_COMPLIANCE
        if not low <= layer.compliance <= high:
            raise SceneError("layer", layer, f"of a compliance α E'/L in [{low:g}, {high:g}]")
    if scene["normal_compliance"]:
        told = "0 with a layer, which has a law of its own; one of the two"
        raise SceneError("normal_compliance", scene["normal_compliance"], told)
    if scene["friction"]:
        told = "None or 0 with a layer: the traction of a growing contact is a superposition of "
        told += "flat punches, which holds for linear layers only"
        raise SceneError("friction", scene["friction"], told)
    if scene["tangential_compliance"]:
        told = "0 with a layer, under which there is no friction"
        raise SceneError("tangential_compliance", scene["tangential_compliance"], told)
    if scene["profile"] is None:
        raise SceneError("profile", None, "given with a layer: profiles.Flat is a flat punch")


def in_own_units(law: Any, modulus: float) -> Layer:
    """Return a law in Pa and m as one in E' and m.

    Parameters
    ----------
    law : Layer
    modulus : float
        E' [Pa].

    Raises
    ------
    SceneError
        If it is no law, or a parameter leaves its range.
    """
    if type(law) not in KINDS.values():
        raise SceneError("layer", law, f"None or one of layers: {', '.join(KINDS)}")
    try:
        scaled: Layer = law._over(modulus)
    except SceneError as error:
        told = f"such that its {error.parameter} over E' = {modulus:.6g} Pa is {error.allowed}"
        raise SceneError("layer", law, told) from error
    return scaled


def endless(scene: Any) -> bool:
    """Return whether the contact of a scene has no edge: the layer has pressure at every gap."""
    layer = scene.layer
    return layer is not None and isinf(layer.start) and not isinstance(scene.profile, Flat)


def refuse_layer(scene: Any, what: str) -> None:
    """Refuse a scene with a layer on behalf of what knows linear layers only.

    Raises
    ------
    SceneError
        If it has one.
    """
    if scene.layer is not None:
        told = f"one without layer: {what} knows linear layers only, as normal_compliance"
        raise SceneError("scene", scene, told)


def layer_from(tree: Any) -> Layer:
    """Return the layer that `kind_tree` wrote.

    Raises
    ------
    SceneError
        If it is none, or a parameter is out of range.
    """
    return kind_from("layer", tree, KINDS)
