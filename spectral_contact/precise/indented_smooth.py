r"""Normal contact under a profile on a smooth surface: quadrature in mpmath, and no system.

The half-integral is known, ``F = H(a) - H(t)``, and ``p(r) = (2/pi) int_r^a H'(t) dt /
sqrt(t^2 - r^2)``. The integral is cut at the breaks. On each part the integrand has roots at two
radii: at its start t0, and at a smaller one, r or a break. With w0^2 the difference of their
squares, it is smooth in x, where ``t^2 = t0^2 + w0^2 sinh(x)^2``.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np

from spectral_contact.precise.heights import heights
from spectral_contact.precise.indented_rough import OUTSIDE, Contact
from spectral_contact.profiles import Profile

#: Longest interval in x of one quadrature rule.
_LONGEST = 3
#: The pressure is checked at the multiples of ``a / _INSIDE``.
_INSIDE = 24


class SmoothIndented(Contact):
    """A contact of a radius on a smooth surface.

    Parameters
    ----------
    mp : MPContext
    profile : Profile
    radius : mpf
    adhesion : float
        Work of adhesion, 0 without.
    """

    unknowns = 0

    def __init__(self, mp: Any, profile: Profile, radius: Any, adhesion: float = 0.0) -> None:
        self._mp = mp
        self.radius = mp.mpf(radius)
        self._adhesive = adhesion > 0.0
        #: by how much adhesion lowers the approach, by the theory of Johnson, Kendall and Roberts
        self._pull = mp.sqrt(mp.pi * self.radius * mp.mpf(adhesion) / 2)
        self.heights = heights(mp, profile)
        self._edge_transform = self.heights.transform(self.radius)
        self._breaks = [b for b in self.heights.breaks if b < self.radius]
        self.approach = self._edge_transform / 2 - self._pull
        self.stiffness = 8 * self.radius
        self.load = 4 * self._integral(self.heights.rate) - self.stiffness * self._pull

    @property
    def growth(self) -> Any:
        """``ddelta/da``; if the edge is at a break, where it may jump, just beyond the break."""
        mp = self._mp
        a = self.radius
        if self.heights.root(a) == 0:
            a = a * (1 + mp.sqrt(mp.eps))
        return self.heights.rate(a) / self.heights.root(a) / 2

    @property
    def work(self) -> Any:
        """The work ``int P ddelta``."""
        return self._integral(lambda t: self._half(t) ** 2 * self.heights.root(t) / t)

    def _suction(self, s: Any, from_edge: Any) -> Any:
        """Return what adhesion takes from the pressure."""
        if not self._adhesive:
            return self._mp.zero
        if from_edge == 0:
            return self._mp.inf
        root = self._mp.sqrt(from_edge * (1 + s))
        return 4 * self._pull / (self._mp.pi * self.radius * root)

    def _half(self, t: Any) -> Any:
        """Return F, with that of adhesion."""
        return self._edge_transform - self.heights.transform(t) - 2 * self._pull

    def _integral(self, function: Callable[[Any], Any]) -> Any:
        """Return the integral of a function of t over v, where ``t^2 = b^2 + v^2``.

        On each part between breaks b is its start.
        """
        mp = self._mp
        total = self._mp.zero
        for b, end in pairwise([mp.zero, *self._breaks, self.radius]):
            top = mp.sqrt((end - b) * (end + b))
            total += mp.quad(lambda v, b=b: function(mp.hypot(b, v)), [0, top])
        return total

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii over a, whose distances to the edge are given, too."""
        found = np.empty(len(s), dtype=object)
        pairs = zip(s, from_edge, strict=True)
        found[:] = [self._pressure(v, y) - self._suction(v, y) for v, y in pairs]
        return found

    def _pressure(self, s: Any, from_edge: Any) -> Any:
        """Return the pressure without that of adhesion at one radius."""
        mp = self._mp
        r = self.radius * s
        if r == 0:
            return self._central()
        if from_edge == 0:
            return mp.zero
        total = mp.zero
        starts = [b for b in self._breaks if b > r]
        for low, high in pairwise([r, *starts, self.radius]):
            before = max((b for b in self._breaks if b <= low), default=mp.zero)
            # the integrand has roots at r and at the last break, of which the larger is `low`
            inner, outer = (before, r) if low == r else (r, low)
            scale = mp.sqrt((outer - inner) * (outer + inner))  # w0 of the module's docstring
            extent = mp.sqrt((high - low) * (high + low))
            if high == self.radius and low == r:
                extent = self.radius * mp.sqrt(from_edge * (1 + s))
            if scale == 0:  # r is at a break
                if self.heights.rate(low) > mp.sqrt(mp.eps) * self._edge_transform:
                    return mp.inf  # a corner
                # t is next to the break b, and t^2 - b^2 then has half of its digits only
                with mp.workprec(2 * mp.prec):
                    total += mp.quad(lambda v, b=low: self._over(mp.hypot(b, v), v), [0, extent])
                continue
            if inner == 0 and self.heights.order == 0:  # H'/t is smooth
                total += self._smoothly(low, extent)
                continue
            top = mp.asinh(extent / scale)
            steps = mp.linspace(0, top, max(ceil(top / _LONGEST), 1) + 1)
            total += mp.quad(
                lambda x, low=low, scale=scale: self._over(mp.hypot(low, scale * mp.sinh(x)), 1),
                steps,
                method="gauss-legendre",
            )
        return 2 / mp.pi * total

    def _smoothly(self, low: Any, extent: Any) -> Any:
        """Return the integral of ``H'/t`` over v, with ``t^2 = low^2 + v^2``."""
        hypot = self._mp.hypot

        def value(v: Any) -> Any:
            t = hypot(low, v)
            return self.heights.rate(t) / (t * t)

        return self._mp.quad(value, [0, extent], method="gauss-legendre")

    def _over(self, t: Any, v: Any) -> Any:
        """Return ``H' sqrt(t^2 - b^2) / (t v)``."""
        return self.heights.rate(t) / (t * v)

    def _central(self) -> Any:
        """Return the pressure at the centre."""
        mp = self._mp
        order = self.heights.order
        if order == 1:
            return mp.inf
        first, *others = [*self._breaks, self.radius]
        # it is the integral of H'/t dt. Under a tip of the order n this is not smooth at 0: there
        # the variable is u, with t = u^(1/(n - 1))
        power = 1 / (order - 1) if order else mp.one
        total = mp.quad(
            lambda u: self.heights.rate(u**power) * power / u ** (power + 1),
            [0, first ** (1 / power)],
        )
        for low, high in pairwise([first, *others]):
            top = mp.sqrt((high - low) * (high + low))
            total += mp.quad(lambda v, b=low: self._over(t := mp.hypot(b, v), t), [0, top])
        return 2 / mp.pi * total

    def margins(self) -> tuple[Any, Any]:
        """Return the least pressure inside over its mean, and the least gap over the approach."""
        mp = self._mp
        mean = self.load / (mp.pi * self.radius**2)
        rests = [mp.mpf(k) / _INSIDE for k in range(1, _INSIDE)] + [mp.mpf(10) ** -8]
        inside = min(self._pressure(1 - rest, rest) for rest in rests) / abs(mean or 1)
        gaps = []
        for beyond in OUTSIDE:
            r = self.radius * (1 + mp.mpf(beyond))
            if r >= self.heights.reach:
                break
            lowered = self._integral(partial(self._lowering, r))
            size = self.radius if self._adhesive else self.approach
            gaps.append((self.heights.height(r) - self.approach + lowered / mp.pi) / size)
        return inside, min(gaps, default=mp.one)

    def _lowering(self, r: Any, t: Any) -> Any:
        """Return the integrand, over v, of pi times the depth of the free surface at r by F."""
        return self._half(t) * self.heights.root(t) / t / self._mp.sqrt((r - t) * (r + t))
