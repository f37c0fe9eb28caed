"""Types of the methods that evaluate fields: a number for a number, an array for an array."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

_Radii: TypeAlias = Sequence[Any] | NDArray[Any]
_OneRadius: TypeAlias = float | np.number[Any]
_Values: TypeAlias = NDArray[np.float64]


class OverS(Protocol):
    """A field at radii ``s`` over that of the contact, or at distances 1 - s from the edge."""

    @overload
    def __call__(self, s: _OneRadius) -> float: ...
    @overload
    def __call__(self, s: None = None, *, from_edge: _OneRadius) -> float: ...
    @overload
    def __call__(self, s: _Radii) -> _Values: ...
    @overload
    def __call__(self, s: None = None, *, from_edge: _Radii) -> _Values: ...


class OverR(Protocol):
    """A field at radii ``r`` [m], or at distances from the edge [m]."""

    @overload
    def __call__(self, r: _OneRadius) -> float: ...
    @overload
    def __call__(self, r: None = None, *, from_edge: _OneRadius) -> float: ...
    @overload
    def __call__(self, r: _Radii) -> _Values: ...
    @overload
    def __call__(self, r: None = None, *, from_edge: _Radii) -> _Values: ...


class _MethodOverS(Protocol):
    def __get__(self, instance: object, owner: type | None = None) -> OverS: ...


class _MethodOverR(Protocol):
    def __get__(self, instance: object, owner: type | None = None) -> OverR: ...


def over_s(method: Callable[..., Any]) -> _MethodOverS:
    """Give a method the types of a field that is evaluated at ``s``; it is returned unchanged."""
    return method


def over_r(method: Callable[..., Any]) -> _MethodOverR:
    """Give a method the types of a field that is evaluated at ``r``; it is returned unchanged."""
    return method
