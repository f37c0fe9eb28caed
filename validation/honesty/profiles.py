"""True errors of contact under random profiles against their estimates.

A stratum of honesty.py. Scenes have random shapes, radii, compliances and tolerances; each is
solved for its radius, then for its load and its approach. The truth is the same method with eight
degrees more on every panel and two panels more at every end: that the method converges to the truth
is tested against closed forms and by quadrature. One scene of ten is on a smooth surface, where the
truth is a quadrature in 30 digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi

import mpmath as mp
import numpy as np
from honesty_table import Outcome, Stratum, command, decade, in_turn

from spectral_contact import profiles
from spectral_contact.contact import indented
from spectral_contact.contact.contact_radius import find_radius
from spectral_contact.contact.indented import solve_indentation, values_only
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.contact.refine import Refinement, refine
from spectral_contact.spectral.panels import DiscreteSpace

LEAST, MOST = -7.0, 4.0  # of the compliance in contact radii, decades
FROM_EDGE = np.concatenate([10.0 ** -np.linspace(0.3, 14.0, 40), np.linspace(0.0, 1.0, 60)])
#: Of a radius that was given, and of a load or approach found from it.
ROUNDING = 1e-15
#: Each such scene is on a smooth surface.
SMOOTH = 10
NAMES = ("radius", "approach", "load", "work", "stiffness", "pressure")


class Better(indented._IndentationProblem):  # the problem itself, in a larger space
    """The problem with eight degrees more, and two panels more at every end."""

    def _first_space(self, part: int, depth: float) -> DiscreteSpace:
        found = super()._first_space(part, depth)
        return DiscreteSpace(found.panels, (*found.degrees, 2, 2))

    def start(self) -> DiscreteSpace:
        """Return the space."""
        found = super().start()
        degrees = tuple(min(n + 8, 38) for n in found.degrees)
        return DiscreteSpace(replace(found.panels, degree=40), degrees)


def drawn(rng: np.random.Generator) -> tuple[profiles.Profile, float]:
    """Return a profile and a contact radius."""
    kind, angle = rng.integers(7), float(rng.uniform(0.1, 1.5))
    size, other = decade(rng, -1.0, 1.0), decade(rng, -1.0, 1.0)
    if kind == 0:
        return profiles.Parabola(size), decade(rng, -2.0, 2.0)
    if kind == 1:
        return profiles.Sphere(size), size * (1.0 - decade(rng, -3.0, -0.02))
    if kind == 2:
        return profiles.Cone(angle), decade(rng, -2.0, 2.0)
    if kind == 3:
        power = float(rng.choice([1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0]))
        return profiles.PowerLaw(size, power), decade(rng, -1.0, 1.0)
    if kind == 4:
        return profiles.RoundedFlat(size, other), size * (1.0 + decade(rng, -4.0, 1.5))
    if kind == 5:
        return profiles.TruncatedCone(size, angle), size * (1.0 + decade(rng, -4.0, 1.5))
    c, d = rng.uniform(0.2, 2.0, 2)
    bowl = profiles.Sampled.from_functions(
        lambda r: c * (np.cosh(d * r) - 1.0), lambda r: c * d * np.sinh(d * r), reach=3.0
    )
    return replace(bowl, rounded=True), decade(rng, -1.0, 0.47)


def ratios(rng: np.random.Generator) -> Outcome:
    """Return the largest true errors over estimates for a radius, its load and its approach."""
    profile, radius = drawn(rng)
    compliance = 10.0 ** rng.uniform(LEAST, MOST) * radius
    tolerance = 10.0 ** rng.uniform(-12.0, -4.0)
    solved = solve_indentation(profile, radius, compliance, tolerance, 20_000)
    assert isinstance(solved, Refinement)
    better = Better(profile, radius, compliance, 1e-13, pointwise=True)
    found, truth = solved.best.value, refine(better, 1e-11, 20_000).best.value
    label = f"{profile.brief}, a = {radius:.6g}, alpha = {compliance:.3g}, rtol = {tolerance:.1e}"
    compared = [_compared(found, truth, 0.0)]

    def at(radius: float, rtol: float, pointwise: bool) -> Indentation | Refinement[Indentation]:
        return solve_indentation(profile, radius, compliance, rtol, 20_000, pointwise=pointwise)

    for load, approach in ((truth.load, None), (None, truth.approach)):
        searched, off = find_radius(
            profile,
            at,
            tolerance,
            load=load,
            approach=approach,
            pointwise=True,
            first=lambda a: values_only(profile, a, compliance, tolerance, 20_000),
        )
        value = searched.best.value if isinstance(searched, Refinement) else searched
        compared.append(_compared(value, truth, off))
    largest = {name: max(one[name] for one in compared) for name in NAMES}
    return Outcome(largest, label, solved.best.error <= tolerance)


@dataclass(frozen=True)
class SmoothTruth:
    """A contact on a smooth surface, by quadrature of its half-integral in many digits.

    With ``H`` the half-integral of the profile, ``delta = H(a)/2``, ``P = 4 int [H(a) - H(t)] dt``
    and ``p(r) = (2/pi) int_r^a H'(t) dt/sqrt(t^2 - r^2)`` (docs: profiles).
    """

    profile: profiles.Profile
    radius: float

    def half(self, t: mp.mpf) -> mp.mpf:
        """Return ``H(t)``."""
        shape = self.profile
        match shape:
            case profiles.Parabola():
                return 2 * t**2 / shape.radius
            case profiles.Sphere():
                return 2 * t * mp.atanh(t / shape.radius)
            case profiles.Cone():
                return mp.pi * t * mp.cot(shape.half_angle)
            case profiles.PowerLaw():
                n = mp.mpf(shape.exponent)
                return shape.coefficient * n * t**n * mp.beta(n / 2, mp.mpf(0.5))
        b = min(mp.mpf(shape.flat_radius), t)
        if isinstance(shape, profiles.TruncatedCone):
            return 2 * t * mp.cot(shape.half_angle) * mp.acos(b / t)
        return 2 * t / shape.radius * (mp.sqrt((t - b) * (t + b)) - b * mp.acos(b / t))

    def rate(self, t: mp.mpf, past: mp.mpf) -> mp.mpf:
        """Return ``H'(t)``, so far past the flat part."""
        shape = self.profile
        match shape:
            case profiles.Parabola():
                return 4 * t / shape.radius
            case profiles.Sphere():
                q = t / shape.radius
                return 2 * mp.atanh(q) + 2 * q / (1 - q**2)
            case profiles.Cone() | profiles.PowerLaw():
                return self.half(t) * getattr(shape, "exponent", 1.0) / t
        b = mp.mpf(shape.flat_radius)
        root = mp.sqrt(past * (t + b))
        if isinstance(shape, profiles.TruncatedCone):
            return 2 * mp.cot(shape.half_angle) * (mp.atan(root / b) + b / root)
        return (4 * root - 2 * b * mp.atan(root / b)) / shape.radius

    def _integral(self, power: int) -> float:
        a, b = mp.mpf(self.radius), mp.mpf(self.profile.flat_part)
        whole = self.half(a)
        return float(mp.quad(lambda t: (whole - self.half(t)) ** power, [mp.mpf(0), b, a]))

    @property
    def approach(self) -> float:
        """The approach."""
        return float(self.half(mp.mpf(self.radius)) / 2)

    @cached_property
    def load(self) -> float:
        """The load."""
        return 4.0 * self._integral(1)

    @property
    def work(self) -> float:
        """The work."""
        return self._integral(2)

    @property
    def stiffness(self) -> float:
        """The stiffness."""
        return 8.0 * self.radius

    def pressure(self, _: object, from_edge: np.ndarray) -> np.ndarray:
        """Return the pressure at distances from the edge."""
        a, b = mp.mpf(self.radius), mp.mpf(self.profile.flat_part)

        def at(e: float) -> float:
            r = a * (1 - mp.mpf(e))
            begin = max(r, b)
            reach = mp.sqrt(a - begin)

            def kernel(v: mp.mpf) -> mp.mpf:  # t = begin + v**2
                t = begin + v**2
                return (
                    2 * v * self.rate(t, begin - b + v**2) / mp.sqrt((begin - r + v**2) * (t + r))
                )

            near = mp.sqrt(abs(b - r))
            places = [mp.mpf(0), near, reach] if 0 < near < reach else [mp.mpf(0), reach]
            return float(2 / mp.pi * mp.quad(kernel, places)) if reach else 0.0

        return np.array([at(e) for e in from_edge.tolist()])


def smooth_ratios(rng: np.random.Generator) -> Outcome:
    """Return likewise of a contact on a smooth surface."""
    profile, radius = drawn(rng)
    while isinstance(profile, profiles.Sampled):  # its half-integral is not known but from itself
        profile, radius = drawn(rng)
    found = solve_indentation(profile, radius, 0.0, 1e-10, 20_000)
    assert isinstance(found, Indentation)
    with mp.workdps(30):
        compared = _compared(found, SmoothTruth(profile, radius), 0.0)
    label = f"{profile.brief}, a = {radius:.6g}, smooth"
    return Outcome(compared, label, found.pressure_error <= 1e-10)


def _compared(found: Indentation, truth: Indentation | SmoothTruth, off: float) -> dict[str, float]:
    errors = {name: abs(getattr(found, name) / getattr(truth, name) - 1.0) for name in NAMES[:-1]}
    assert found.pressure is not None
    assert truth.pressure is not None
    # at the tip of a cone on a smooth surface it is infinite
    from_edge = FROM_EDGE[FROM_EDGE < 1.0] if isinstance(truth, SmoothTruth) else FROM_EDGE
    s = 1.0 - from_edge
    exact = truth.pressure(s, from_edge)
    size = np.maximum(np.abs(exact), truth.load / (pi * truth.radius**2))
    errors["pressure"] = float((np.abs(found.pressure(s, from_edge) - exact) / size).max())
    # the truth is not exact, and what was asked for has no error but a rounding
    room = {
        name: getattr(found, f"{name}_error") + getattr(truth, f"{name}_error", 0.0)
        for name in NAMES[1:]
    }
    room["radius"] = off + ROUNDING
    return {name: error / room[name] for name, error in errors.items()}


def measured(rng: np.random.Generator, number: int) -> Outcome:
    """Return what becomes of a random scene."""
    return (smooth_ratios if number % SMOOTH == 0 else ratios)(rng)


STRATA = {"profiles": Stratum("Honesty of contacts under profiles", 300, in_turn(measured))}


def main(name: str, arguments: Sequence[str]) -> bool:
    """Run the stratum."""
    return command(STRATA, name, arguments)
