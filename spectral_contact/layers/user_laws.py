"""Laws that users write: a subclass of `Layer` is held to what it declares before it is solved."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from math import inf, isfinite
from typing import Any, Final, NoReturn

import numpy as np

from spectral_contact.errors import SceneError, SpectralContactError
from spectral_contact.fields import Array
from spectral_contact.layers.layer_base import Layer

#: Overclosures at which a law is looked at, over its size: beyond its start, or about 0.
_DECADES: Final = np.geomspace(1e-3, 1e3, 61)
_SIZES: Final = np.linspace(-30.0, 30.0, 121)
#: Nodes of the quadrature between two of these overclosures, and the relative difference that an
#: energy may have from it.
_NODES: Final = 16
_ENERGY: Final = 1e-7
#: Step of differences, over the distance from the start or, without one, over the size of the law;
#: and the relative difference that a slope may have from them.
_STEP: Final = 1e-4
_SLOPE: Final = 1e-4
#: The relative difference that pressures may have in another unit.
_UNIT: Final = 1e-12


def checked_user_law(law: Any) -> Layer:
    """Return a law that a user wrote.

    It is looked at from a thousandth to a thousand of its size beyond its start, or to thirty
    sizes about zero if it has none: where its start, limit and knots
    are, whether the pressure rises, whether slope and energy are its derivative and its integral,
    and whether `_over` changes the unit of pressures alone.

    Raises
    ------
    SceneError
        If one of these is not so; the error names the member and the overclosure.
    """
    try:
        return _checked(law)
    except SpectralContactError:
        raise
    except Exception as error:  # whatever a member of a user's class raises
        told = (
            f"a law that can be evaluated, and compared and hashed as frozen dataclasses: {error}"
        )
        raise SceneError("layer", law, told) from error


@lru_cache(maxsize=256)
def _checked(law: Layer) -> Layer:
    if law != law or hash(law) != hash(law):
        _refuse(law, "equal to itself")
    _check_range(law)
    w = _places(law)
    with np.errstate(all="ignore"):
        p = law._pressure(w)
        slope = law._slope(w)
        for name, values in (("_pressure", p), ("_slope", slope)):
            if np.shape(values) != w.shape or np.asarray(values).dtype != np.float64:
                _refuse(law, f"one whose {name} takes and returns arrays of doubles")
        some = np.isfinite(p) & (p < 1e150) & (p > 1e-150)
    w = w[some]
    p = p[some]
    slope = slope[some]
    if len(w) < 4:
        _refuse(law, "one with a pressure at overclosures that go with its _size")
    wrong = np.flatnonzero(~(np.diff(p) > 0.0))
    if len(wrong):
        _refuse(law, f"one whose pressure rises, also at the overclosure {w[wrong[0] + 1]:.6g}")
    if isfinite(law.start):
        before = law._pressure(np.array([law.start - law._size, law.start - 1e-3 * law._size]))
        if not (np.asarray(before) == 0.0).all():
            _refuse(law, f"one without pressure below its start, {law.start:.6g}")
    _check_slope(law, w, slope)
    _check_energy(law, w, p)
    _check_unit(law, w, p)
    return law


def _check_range(law: Layer) -> None:
    size = law._size
    if not (isinstance(size, float) and 0.0 < size < inf):
        _refuse(law, f"one with a _size that is finite and > 0, not {size!r}")
    ends = law.start, law.limit
    if not (ends[0] < inf and ends[0] < ends[1]):
        _refuse(law, f"one with start < limit, not {ends[0]!r} and {ends[1]!r}")
    within = [law.start, *law.knots, law.limit]
    if not all(a < b for a, b in pairwise(within)):
        _refuse(law, f"one with knots that rise between start and limit, not {law.knots!r}")


def _places(law: Layer) -> Array:
    """Return overclosures at which there is a pressure, none of them a knot."""
    if isfinite(law.start):
        around = law.start + law._size * _DECADES
    else:
        around = law._size * _SIZES
    inside = around[around < min(law.limit, inf)]
    return np.array([one for one in inside.tolist() if one not in law.knots])


def _check_slope(law: Layer, w: Array, slope: Array) -> None:
    """Compare with differences, where no knot and no end is near."""
    # a law with a start goes like powers of the distance from it, a law without one like
    # exponentials of the overclosure over its size
    step = np.full(len(w), _STEP * law._size)
    if isfinite(law.start):
        step = _STEP * (w - law.start)
    far = np.ones(len(w), dtype=bool)
    for knot in (*law.knots, law.limit, law.start):
        far &= np.abs(w - knot) > 2.0 * step if isfinite(knot) else far
    w = w[far]
    slope = slope[far]
    step = step[far]
    with np.errstate(all="ignore"):
        rise = law._pressure(w + step) - law._pressure(w - step)
        off = np.abs(rise / (2.0 * step) - slope)
        # what rounding and the third derivative leave of a difference
        allowed = _SLOPE * np.abs(slope) + 1e-11 * law._pressure(w + step) / step
        wrong = np.flatnonzero(~(off <= allowed) & np.isfinite(rise))
    if len(wrong):
        told = "one whose _slope is the derivative of its _pressure, also at the overclosure"
        _refuse(law, f"{told} {w[wrong[0]]:.6g}")


def _check_energy(law: Layer, w: Array, p: Array) -> None:
    """Compare differences of the energy with quadrature of the pressure, piece by piece."""
    x, weights = np.polynomial.legendre.leggauss(_NODES)
    energy = np.asarray(law._energy(w))
    for i, (low, high) in enumerate(pairwise(w.tolist())):
        cuts = [low, *(knot for knot in law.knots if low < knot < high), high]
        total = 0.0
        for a, b in pairwise(cuts):
            half = (b - a) / 2.0
            total += half * float(weights @ law._pressure(a + half * (1.0 + x)))
        scale = max(total, float(np.finfo(float).eps * abs(energy[i + 1]) / _ENERGY))
        if not abs(float(energy[i + 1] - energy[i]) - total) <= _ENERGY * scale:
            told = "one whose _energy is the integral of its _pressure, also between the"
            _refuse(law, f"{told} overclosures {low:.6g} and {high:.6g}")


def _check_unit(law: Layer, w: Array, p: Array) -> None:
    other = law._over(2.0)
    if type(other) is not type(law):
        _refuse(law, f"one whose _over returns a {type(law).__name__}")
    if not np.allclose(2.0 * other._pressure(w), p, rtol=_UNIT, atol=0.0):
        _refuse(law, "one whose _over(2.0) has half its pressures")


def _refuse(law: Layer, told: str) -> NoReturn:
    raise SceneError("layer", law, told)
