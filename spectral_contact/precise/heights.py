"""Heights of profiles in many digits, and their transforms H.

On a smooth surface the contact of radius a has the approach H(a)/2 (docs/profiles).

Written anew from the definitions: no digit comes from `profiles`, which is in double precision.
"""

from __future__ import annotations

from bisect import bisect, bisect_left
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from math import ceil
from typing import Any

from spectral_contact.errors import NotComputedError
from spectral_contact.profiles import sampled_profile, shapes, sums
from spectral_contact.profiles.profile_base import Profile

Function = Callable[[Any], Any]

#: Digits that each node of a Chebyshev series adds if no singularity is closer to a panel than its
#: length. With the panel as [-1, 1] the length is 2, and the function is analytic in the ellipse
#: through 2i: the sum of the semi-axes is ``2 + sqrt(5)``, of which this is log10.
_PER_NODE = 0.62


class Heights:
    """A profile to many digits.

    Parameters
    ----------
    mp : MPContext
    profile : Profile

    Attributes
    ----------
    reach : mpf
        Radius at which the profile ends.
    breaks : list of mpf
        Radii at which a derivative jumps.
    order : mpf
        Near the centre the height is ``f(r**2) + r**order g(r**2)`` with smooth functions f and g;
        0 stands for a height without the second term. For pointed tables it is 1, or 2 if the slope
        is 0 at the centre.
    """

    def __init__(self, mp: Any, profile: Profile) -> None:
        self._mp = mp
        self.reach = mp.mpf(profile.reach)
        self.breaks = [mp.mpf(b) for b in profile.breaks]
        self.order = mp.mpf(getattr(profile, "exponent", 1.0)) if profile.pointed else mp.zero

    def height(self, r: Any) -> Any:
        """Return h."""
        raise NotImplementedError

    def transform(self, t: Any) -> Any:
        """Return ``H = 2 t int_0^t h' dr / sqrt(t^2 - r^2)``."""
        raise NotImplementedError

    def rate(self, t: Any) -> Any:
        """Return ``H'(t) root(t)``: H' alone may be infinite at a break."""
        raise NotImplementedError

    def root(self, t: Any) -> Any:
        """Return the root of ``t^2 - b^2``, b the last break up to t; t without a break."""
        # at a break itself t counts as beyond it, as rounding may bring t there
        below = max((b for b in self.breaks if b <= t), default=self._mp.zero)
        return self._mp.sqrt((t - below) * (t + below))


class _PowerHeights(Heights):
    """``h = C r^n``."""

    def __init__(self, mp: Any, profile: Profile, factor: Any, power: Any) -> None:
        super().__init__(mp, profile)
        self._factor = factor
        self._power = mp.mpf(power)
        half = self._power / 2
        self._scaled = factor * power * mp.beta(half, mp.mpf(1) / 2)

    def height(self, r: Any) -> Any:
        return self._factor * r**self._power

    def transform(self, t: Any) -> Any:
        return self._scaled * t**self._power

    def rate(self, t: Any) -> Any:
        return self._power * self.transform(t)


class _FlatHeights(Heights):
    """``h = 0``."""

    def height(self, r: Any) -> Any:
        return 0 * r

    def transform(self, t: Any) -> Any:
        return 0 * t

    def rate(self, t: Any) -> Any:
        return 0 * t


class _SphereHeights(Heights):
    """``h = R - sqrt(R^2 - r^2)``."""

    def __init__(self, mp: Any, profile: shapes.Sphere) -> None:
        super().__init__(mp, profile)
        self._radius = mp.mpf(profile.radius)

    def height(self, r: Any) -> Any:
        whole = self._radius
        return whole - self._mp.sqrt((whole - r) * (whole + r))

    def transform(self, t: Any) -> Any:
        return 2 * t * self._mp.atanh(t / self._radius)

    def rate(self, t: Any) -> Any:
        whole = self._radius
        return self.transform(t) + 2 * t * t * whole / ((whole - t) * (whole + t))


class _TruncatedConeHeights(Heights):
    """``h = (r - b) cot(theta)`` outside b."""

    def __init__(self, mp: Any, profile: shapes.TruncatedCone) -> None:
        super().__init__(mp, profile)
        self._slope = mp.cot(mp.mpf(profile.half_angle))

    def height(self, r: Any) -> Any:
        return max(r - self.breaks[0], 0) * self._slope

    def transform(self, t: Any) -> Any:
        b = self.breaks[0]
        if t < b:
            return self._mp.zero
        return 2 * self._slope * t * self._mp.atan(self.root(t) / b)

    def rate(self, t: Any) -> Any:
        b = self.breaks[0]
        if t < b:
            return self._mp.zero
        root = self.root(t)
        return 2 * self._slope * (root * self._mp.atan(root / b) + b)


class _RoundedFlatHeights(Heights):
    """``h = (r - b)^2 / (2 R)`` outside b."""

    def __init__(self, mp: Any, profile: shapes.RoundedFlat) -> None:
        super().__init__(mp, profile)
        self._radius = mp.mpf(profile.radius)

    def height(self, r: Any) -> Any:
        return max(r - self.breaks[0], 0) ** 2 / (2 * self._radius)

    def transform(self, t: Any) -> Any:
        mp = self._mp
        b = self.breaks[0]
        if t <= b:
            return mp.zero
        # next to the flat part it is about b (root/b)^3/3, which is little of its two terms
        with mp.extraprec(2 * max(-mp.mag(self.root(t) / b), 0) + 10):
            root = self.root(t)
            risen = root - b * mp.atan(root / b)
        return 2 * t / self._radius * risen

    def rate(self, t: Any) -> Any:
        b = self.breaks[0]
        if t < b:
            return self._mp.zero
        root = self.root(t)
        return 2 * root / self._radius * (2 * root - b * self._mp.atan(root / b))


class _SampledHeights(Heights):
    """Chebyshev series of the slope on every piece."""

    def __init__(self, mp: Any, profile: sampled_profile.Sampled) -> None:
        super().__init__(mp, profile)
        self._edges = [mp.mpf(edge) for edge in profile.edges]
        self._rows = [[mp.mpf(c) for c in row] for row in profile.slopes]
        self._rises = [_integrated(row) for row in self._rows]
        self._second_derivatives = [
            [2 * c / (high - low) for c in _derived(row)]
            for (low, high), row in zip(pairwise(self._edges), self._rows, strict=True)
        ]
        self._tables = cache(self._panelled)
        if self.order and _clenshaw(self._rows[0], -mp.one) == 0:
            self.order = mp.mpf(2)

    def height(self, r: Any) -> Any:
        total = self._mp.zero
        for (low, high), row in zip(pairwise(self._edges), self._rises, strict=True):
            if r > low:
                at = _clenshaw(row, _local(min(r, high), low, high))
                total += (high - low) / 2 * (at - _clenshaw(row, -self._mp.one))
        return total

    def _mean(self, t: Any, rows: list[list[Any]], power: int) -> Any:
        """Return the integral of ``f(t sin phi) sin(phi)**power`` over a quarter of a turn."""
        mp = self._mp
        total = self._mp.zero
        for (low, high), row in zip(pairwise(self._edges), rows, strict=True):
            if t <= low:
                break

            def at(phi: Any, low: Any = low, high: Any = high, row: list[Any] = row) -> Any:
                sine = mp.sin(phi)
                return _clenshaw(row, _local(t * sine, low, high)) * sine**power

            ends = [mp.asin(low / t), mp.asin(min(high / t, mp.one))]
            total += mp.quad(at, ends, method="gauss-legendre")
        return total

    def transform(self, t: Any) -> Any:
        return self._tabulated(self._bare_transform, t) if t else self._mp.zero

    def rate(self, t: Any) -> Any:
        return self._tabulated(self._bare_rate, t)

    def _bare_transform(self, t: Any) -> Any:
        """Return H, by quadrature."""
        return 2 * t * self._mean(t, self._rows, 0)

    def _bare_rate(self, t: Any) -> Any:
        """Return the derivative of H times `root`, by quadrature."""
        mp = self._mp
        total = 2 * (self._mean(t, self._rows, 0) + t * self._mean(t, self._second_derivatives, 1))
        for k, b in enumerate(self._edges[1:-1]):
            if b < t:
                jump = _clenshaw(self._rows[k + 1], -mp.one) - _clenshaw(self._rows[k], mp.one)
                total += 2 * jump * b / mp.sqrt((t - b) * (t + b))
        return total * self.root(t)

    def _tabulated(self, function: Function, t: Any) -> Any:
        """Return H or its rate from the series that `_panelled` makes once."""
        piece = min(bisect(self._edges, t), len(self._rows)) - 1
        root = self.root(t)
        ends, table = self._tables(function, piece)
        panel = min(max(bisect_left(ends, root) - 1, 0), len(table) - 1)
        value = _clenshaw(table[panel], _local(root, ends[panel], ends[panel + 1]))
        return value * self._falling(piece, t)

    def _falling(self, piece: int, t: Any) -> Any:
        """Return the power of t that H and its rate fall like towards the centre; else 1."""
        if piece:
            return self._mp.one
        return t if self.order == 1 else t * t

    def _panelled(self, function: Function, piece: int) -> tuple[list[Any], list[list[Any]]]:
        """Return panels in `root` on a piece, and Chebyshev series of a function on them.

        The function is singular at the smaller breaks: no panel is longer, in `root`, than its
        distance from them.
        """
        mp = self._mp
        edges = self._edges
        low = edges[piece]
        high = edges[piece + 1]
        top = mp.sqrt((high - low) * (high + low))
        inner = edges[piece - 1] if piece else mp.zero
        ends = [mp.zero]
        step = mp.sqrt((low - inner) * (low + inner)) if piece else top
        while ends[-1] < top:
            ends.append(min(ends[-1] + max(step, ends[-1]), top))
        count = max(ceil(mp.dps / _PER_NODE), len(self._rows[piece])) + 6
        angles = [mp.pi * (2 * k + 1) / (2 * count) for k in range(count)]
        table = []
        for begin, end in pairwise(ends):
            places = [begin + (end - begin) * (1 + mp.cos(x)) / 2 for x in angles]
            radii = [mp.hypot(low, v) for v in places]
            values = [function(t) / self._falling(piece, t) for t in radii]
            series = [
                2 * mp.fdot((mp.cos(k * x), v) for x, v in zip(angles, values, strict=True)) / count
                for k in range(count)
            ]
            series[0] /= 2
            table.append(series)
        return ends, table


def _local(r: Any, low: Any, high: Any) -> Any:
    """Return the coordinate of a radius in a piece, from -1 to 1."""
    return 2 * (r - low) / (high - low) - 1


def _clenshaw(row: list[Any], x: Any) -> Any:
    """Return the value of a Chebyshev series."""
    ahead = beyond = 0 * x
    for c in row[:0:-1]:
        ahead, beyond = 2 * x * ahead - beyond + c, ahead
    return x * ahead - beyond + row[0]


def _integrated(row: list[Any]) -> list[Any]:
    """Return the series of an integral of a Chebyshev series."""
    more = [2 * row[0], *row[1:], 0 * row[0], 0 * row[0]]
    return [0 * row[0], *((more[k - 1] - more[k + 1]) / (2 * k) for k in range(1, len(row) + 1))]


def _derived(row: list[Any]) -> list[Any]:
    """Return the series of the derivative of a Chebyshev series."""
    slopes = [0 * row[0]] * (len(row) + 1)
    for k in range(len(row) - 1, 0, -1):
        slopes[k - 1] = slopes[k + 1] + 2 * k * row[k]
    slopes[0] /= 2
    return slopes[: max(len(row) - 1, 1)]


class _SumHeights(Heights):
    """The sum of two."""

    def __init__(self, mp: Any, profile: sums.Sum) -> None:
        super().__init__(mp, profile)
        self._both = heights(mp, profile.first), heights(mp, profile.second)
        orders = sorted(one.order for one in self._both if one.order)
        self.order = orders[0] if orders else mp.zero
        if orders and (orders[-1] - orders[0]) % 2:
            told = f"with powers of the radius {orders[0]} and {orders[-1]} at the tip it has none"
            raise NotComputedError("the reference", told)

    def height(self, r: Any) -> Any:
        return sum(one.height(r) for one in self._both)

    def transform(self, t: Any) -> Any:
        return sum(one.transform(t) for one in self._both)

    def rate(self, t: Any) -> Any:
        whole = self.root(t)
        total = self._mp.zero
        for one in self._both:
            # 0 only if t is a break of this one; then t is the last break of the sum, too
            own = one.root(t)
            total += one.rate(t) * (whole / own if own else 1)
        return total


def heights(mp: Any, profile: Profile) -> Heights:
    """Return a profile to as many digits as the context has.

    Raises
    ------
    NotComputedError
        For a sum whose tip is no power of the radius times a smooth function of its square, and
        for a profile that has no form to many digits here.
    """
    if isinstance(profile, shapes.Parabola):
        return _PowerHeights(mp, profile, 1 / (2 * mp.mpf(profile.radius)), 2)
    if isinstance(profile, shapes.PowerLaw):
        return _PowerHeights(mp, profile, mp.mpf(profile.coefficient), mp.mpf(profile.exponent))
    if isinstance(profile, shapes.Cone):
        return _PowerHeights(mp, profile, mp.cot(mp.mpf(profile.half_angle)), 1)
    for kind, made in _KINDS.items():
        if isinstance(profile, kind):
            return made(mp, profile)
    told = f"{type(profile).__name__} has no form to so many digits"
    raise NotComputedError("the reference", told)


_KINDS: dict[type[Profile], Callable[[Any, Any], Heights]] = {
    shapes.Flat: _FlatHeights,
    shapes.Sphere: _SphereHeights,
    shapes.TruncatedCone: _TruncatedConeHeights,
    shapes.RoundedFlat: _RoundedFlatHeights,
    sampled_profile.Sampled: _SampledHeights,
    sums.Sum: _SumHeights,
}
