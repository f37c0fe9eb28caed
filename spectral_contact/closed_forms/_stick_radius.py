"""The stick radius of the smooth partial slip problem, however close to 0 or to 1 it is."""

import math
from dataclasses import dataclass

from scipy import special

from ._inputs import check_friction, kappa

# Beyond these ratios f/κ the asymptotic laws are exact to double precision: their relative
# corrections are below 1e-18 for c and below 1e-18 for 1 − c.
_SMALL_RATIO = 0.08
_LARGE_RATIO = 30.0
# Below this c, K'(c) = ln(4/c) to rounding; c² would later leave the range of doubles.
_TINY_RADIUS = 1e-9


@dataclass(frozen=True, slots=True)
class StickRadius:
    """The stick radius c of the partial slip problem, where c may be close to 0 or to 1.

    Attributes
    ----------
    radius : float
        c, dimensionless, in [0, 1].
    from_edge : float
        1 − c, the width of the slip annulus, to full relative accuracy.
    log_radius : float
        ln c: finite also where c itself underflows; −inf for f = 0.
    log_from_edge : float
        ln(1 − c): finite also where 1 − c underflows; −inf for full stick.
    """

    radius: float
    from_edge: float
    log_radius: float
    log_from_edge: float

    @property
    def is_tiny(self) -> bool:
        """Whether 1 − c² is 1, and K'(c) is ln(4/c), to double precision."""
        return self.radius < _TINY_RADIUS

    @property
    def edge_coordinate(self) -> float:
        """1 − c², to full relative accuracy."""
        return self.from_edge * (1.0 + self.radius)

    @property
    def complementary_k(self) -> float:
        """K'(c), the complete elliptic integral of the first kind, complementary modulus."""
        if self.is_tiny:
            return math.log(4.0) - self.log_radius
        return float(special.ellipkm1(self.radius**2))

    @property
    def shear_excess(self) -> float:
        """E'(c) − c K'(c), which vanishes like (1 − c)² as c → 1."""
        c = self.radius
        if c < 0.5:
            gap = 0.0 if c == 0.0 else c * self.complementary_k
            return float(2.0 * special.elliprg(0.0, c * c, 1.0)) - gap
        # With the modulus k = (1 − c)/(1 + c) of Landen's transformation this is
        # (1 + c) k² [K − (K − E)/k²]. The bracket does not cancel: it is π/4 at k = 0.
        k = self.from_edge / (1.0 + c)
        k2 = k * k
        remainder = float(special.ellipk(k2) - special.elliprd(0.0, 1.0 - k2, 1.0) / 3.0)
        return (1.0 + c) * k2 * remainder


def stick_radius(poisson_ratio: float, friction: float) -> StickRadius:
    """Return the stick radius c under a smooth punch with friction.

    Parameters
    ----------
    poisson_ratio : float
        ν of the half-space, in (−1, 0.5].
    friction : float
        Coulomb's coefficient f ≥ 0; ``math.inf`` is full stick.

    Returns
    -------
    StickRadius
        c and 1 − c with their logarithms, dimensionless. c = 1 for ν = 0.5, where there is no
        shear to slip, whatever f; otherwise c = 0 for f = 0.

    Raises
    ------
    ValueError
        If ν or f is out of range.

    Notes
    -----
    Spence's condition (1/2c) ln((1 + c)/(1 − c)) = (f/2κ) K'(c), which makes q continuous at c:
    equation (5.9) of the paper for α = β = 0. Limits: c ~ 4 exp(−2κ/f) for f → 0 and
    1 − c ~ 2 exp(−πf/(2κ)) for f → ∞. With the rounding ε of a double the relative error of c is a
    few times ε 2κ/f in the first limit, and that of 1 − c a few times ε πf/(2κ) in the second: a
    relative change of f/κ by ε changes them as much.
    """
    shear = kappa(poisson_ratio)
    f = check_friction(friction)
    if shear == 0.0:
        return StickRadius(1.0, 0.0, 0.0, -math.inf)
    if f == 0.0:
        return StickRadius(0.0, 1.0, -math.inf, 0.0)
    ratio = f / shear
    if ratio < _SMALL_RATIO:
        return _from_log_radius(math.log(4.0) - 2.0 * shear / f)
    if ratio > _LARGE_RATIO:
        return _from_log_edge(math.log(2.0) - 0.5 * math.pi * ratio)
    return _from_log_radius(_solve_inner(ratio)) if ratio < 1.0 else _solve_outer(ratio)


def _from_log_radius(log_radius: float) -> StickRadius:
    c = math.exp(log_radius)
    return StickRadius(c, -math.expm1(log_radius), log_radius, math.log1p(-c))


def _from_log_edge(log_edge: float) -> StickRadius:
    e = math.exp(log_edge)
    return StickRadius(-math.expm1(log_edge), e, math.log1p(-e), log_edge)


def _solve_inner(ratio: float) -> float:
    """Return ln c by Newton's method on 2 artanh(c)/c − ratio K'(c), increasing in ln c."""
    x = min(math.log(4.0) - 2.0 / ratio, math.log(0.5))
    for _ in range(50):
        c = math.exp(x)
        m = 1.0 - c * c
        value = 2.0 * special.elliprc(1.0, m) - ratio * special.ellipkm1(c * c)
        slope = (
            c * c / 3.0 * (4.0 * special.elliprd(1.0, m, m) + ratio * special.elliprd(0, 1, c * c))
        )
        step = float(value / slope)
        x -= step
        if abs(step) <= 1e-16 * abs(x):
            break
    return x


def _solve_outer(ratio: float) -> StickRadius:
    """Return c by Newton's method in ln(1 − c) on ln((1 + c)/(1 − c)) − ratio c K'(c)."""
    x = math.log(2.0) - 0.5 * math.pi * ratio
    for _ in range(50):
        e = math.exp(x)
        c = 1.0 - e
        kprime = special.ellipkm1(c * c)
        value = math.log(2.0 - e) - x - ratio * c * kprime
        # d(cK')/dc = K' − (c²/3) R_D(0, 1, c²), and dc = −e dx
        slope = (
            -e / (2.0 - e) - 1.0 + ratio * e * (kprime - c * c / 3 * special.elliprd(0, 1, c * c))
        )
        step = float(value / slope)
        x -= step
        if abs(step) <= 1e-16 * abs(x):
            break
    return _from_log_edge(x)
