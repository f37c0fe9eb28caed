"""Objects of a known kind in documents: the name of the kind over its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

from spectral_contact.errors import SceneError, shown

T = TypeVar("T")


def kind_tree(known: Any) -> dict[str, Any]:
    """Return an object as strict JSON can hold it: its kind over its parameters."""
    body = {one.name: getattr(known, one.name) for one in fields(known)}
    parts = {k: kind_tree(v) if is_dataclass(v) else v for k, v in body.items()}
    return {type(known).__name__: parts}


def kind_from(name: str, tree: Any, kinds: Mapping[str, type[T]]) -> T:
    """Return the object that `kind_tree` wrote; errors have the name of the parameter.

    Kinds are classes by the name that they have in documents.
    """
    allowed = f"an object with one key, one of {', '.join(kinds)}, over its parameters"
    if not isinstance(tree, Mapping) or len(tree) != 1:
        raise SceneError(name, tree, allowed)
    [(kind, body)] = tree.items()
    if kind not in kinds or not isinstance(body, Mapping):
        raise SceneError(name, shown(tree), allowed)
    names = {one.name for one in fields(kinds[kind])}  # type: ignore[arg-type]
    if names != set(body):
        raise SceneError(name, shown(tree), f"{kind} with {', '.join(sorted(names))}")
    values = {k: tuple(v) if isinstance(v, list) else v for k, v in body.items()}
    for k, v in values.items():
        if isinstance(v, Mapping):  # an object in it, as in a sum; it is not of the same kind
            inner_kinds = {name: one for name, one in kinds.items() if name != kind}
            values[k] = kind_from(f"{name}.{k}", v, inner_kinds)
    return kinds[kind](**values)
