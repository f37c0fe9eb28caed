"""The stages of a growing contact: flat punches, and what normal contact is, at every radius."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from spectral_contact.contact.contact_radius import indenter, value_of
from spectral_contact.contact.on_parts import Indentation
from spectral_contact.errors import NotComputedError
from spectral_contact.io.physical_data import LARGEST_COMPLIANCE
from spectral_contact.profiles.control import CONTROLS
from spectral_contact.scene import Scene
from spectral_contact.solution import COUPLING, PARTIAL_SLIP, Solution
from spectral_contact.solving.growth import Grower
from spectral_contact.solving.sharing import StepCache, StickPath
from spectral_contact.solving.weights import CoupledWeight, NormalWeight, SmoothWeight, Weight

FlatPunches = Callable[[Scene, tuple[str, ...], float, StepCache], Solution]

#: Quantities of every flat punch of a history.
_FLAT = ("pressure", "traction", "total_shear", "zones", "stick_radius", "approach")
#: Tolerance of the flat punches over that asked for, and the tightest one.
_TIGHTER, _TIGHTEST = 0.1, 1e-12
#: A history may begin where load and traction are this share of the tolerance.
_NEGLIGIBLE = 0.01
#: A step to smaller radii over the last one: the least ratio and the largest.
_LEAST_STRIDE, _STRIDE = 0.1, 4.0
#: How far past a flat part the history begins, relative. The load of that radius is its first one.
_PAST = 1e-10
#: Width of the first panel past a break, relative: on a smooth surface without coupling, where the
#: load goes on like the power 3/2 of the distance, and elsewhere.
_AT_SMOOTH_BREAK, _AT_BREAK = 1e-7, 3e-4
#: Rounding of the radii of a history, relative.
_RADIUS_ROUNDING = 1e-15
#: How close to where a profile is vertical, over the distance from the edge at which the flat punch
#: pulls: loads have no digits at 75 times that, and all at 220 times.
_PULLED = 200.0
#: Tolerances of the critical friction and of the radius at which slip begins.
_CRITICAL, _ONSET = 1e-10, 1e-12
#: Largest logarithm of the critical over the given friction that the search for the onset sees: the
#: critical friction may be infinite.
_LACKING = 5.0


class NoFlatPunchError(ArithmeticError):
    """No zones of a flat punch of the history obey the friction law; the text says why.

    The run of the scene answers with a history of full stick whose errors are infinite.
    """


class Stages:
    """The flat punches of a history, and the loads of normal contact.

    Parameters
    ----------
    scene : Scene
        With a profile and friction.
    rtol, max_unknowns
        As of `spectral_contact.solve`; the number of unknowns limits normal contact.
    tell : callable
        Takes what is worked on.
    fields : tuple of str
        Fields of the contact that are superpositions of those of flat punches.
    solve : callable
        Returns the solution of a flat punch: of its scene, quantities, a tolerance, and the cache
        with the solutions of flat punches before it, from which it starts.
    """

    def __init__(
        self,
        scene: Scene,
        rtol: float,
        max_unknowns: int,
        tell: Callable[[str], None],
        fields: tuple[str, ...],
        solve: FlatPunches,
    ) -> None:
        assert scene.profile is not None
        self.scene, self.rtol, self.max_unknowns = scene, rtol, max_unknowns
        self.profile, self._tell, self._fields = scene.profile, tell, fields
        self._tight = max(_TIGHTER * rtol, _TIGHTEST)
        without: dict[str, Any] = dict.fromkeys(("physical", "profile", *CONTROLS))
        self._flat = replace(scene, **without)
        self._shared = StepCache()
        # stick radii so far, from which the search for the next one begins
        self._path = StickPath(scene.normal_compliance, scene.tangential_compliance)
        self._shared.get(COUPLING if scene.couples else PARTIAL_SLIP, (), lambda: self._path)
        self._solve = solve
        self._last: tuple[Scene, Solution] | None = None

    def contact(self, radius: float) -> Indentation:
        """Return normal contact of a radius."""
        solve = indenter(self.profile, self.scene.normal_compliance, self.max_unknowns)
        return value_of(solve(radius, self._tight, False))

    def _scene(self, radius: float) -> Scene:
        flat = self._flat
        return replace(
            flat,
            normal_compliance=flat.normal_compliance / radius,
            tangential_compliance=flat.tangential_compliance / radius,
        )

    def flat(self, radius: float) -> Solution:
        """Return the solution of a flat punch."""
        scene = self._scene(radius)
        if self._last is None or self._last[0] != scene:  # on a smooth surface all are the same
            self._tell(f"as the contact grew: radius {radius:.4g}")
            asked = (*_FLAT, *self._fields)
            self._last = scene, self._solve(scene, asked, self._tight, self._shared)
        return self._last[1]

    def critical(self, radius: float) -> float:
        """Return the least friction with which a flat punch sticks everywhere."""
        asked = ("critical_friction",)
        return self._solve(self._scene(radius), asked, _CRITICAL, self._shared).critical_friction

    def weight(self, least: float) -> Weight:
        """Return the weight of a history that begins at a radius."""
        if self.scene.couples:
            return CoupledWeight(self.profile, math.log(least), self.flat(least))
        if self.scene.normal_compliance == 0.0:
            return SmoothWeight(self.profile, self.contact(least).load)
        return NormalWeight(self.contact)

    def grower(self, least: float, radius: float) -> Grower:
        """Return what builds the history between two radii."""
        self._check_digits(radius)
        onset = self._path.onset = self._onset(least, radius)
        compliances = self.scene.normal_compliance, self.scene.tangential_compliance
        # with coupling what a short panel adds is a difference of nearly equal numbers
        smooth = self.scene.normal_compliance == 0.0 and not self.scene.couples
        at_break = _AT_SMOOTH_BREAK if smooth else _AT_BREAK
        self._check_pole(radius)
        return Grower(
            stage=self.flat,
            weight=self.weight(least),
            onset=onset,
            fields=self._fields,
            tolerance=self.rtol,
            breaks=self.profile.breaks,
            at_break=at_break,
            layer=min((one for one in compliances if one > 0.0), default=0.0),
            powers=self._powers(least),
            end=math.log(self.profile._pole),
        )

    def _check_digits(self, radius: float) -> None:
        """Raise if a radius is so close to a flat part or a pole that it has too few digits.

        The load is a power of the distance from the one, and a logarithm of that from the other.
        """
        flat, pole = self.profile.flat_part, self.profile._pole
        distance = min(radius - flat, pole - radius) / radius
        if distance < max(_RADIUS_ROUNDING / self.rtol, 10.0 * _PAST):
            told = f"the contact radius is within {distance:.1e}, relative, of the end of the flat "
            told += f"part or of a vertical surface, too close for rtol = {self.rtol:g}"
            raise NotComputedError("traction", told)

    def _check_pole(self, radius: float) -> None:
        """Raise if a contact with coupling is so close to where its profile is vertical."""
        room = 1.0 - radius / self.profile._pole
        # without a pole no flat punch has to be solved
        pulls = room < 1.0 and self.scene.couples and self.flat(radius).values.get("opening")
        if pulls and room < _PULLED * pulls:
            told = f"at the contact radius {radius:.6g} the surface next to the edge"
            raise NotComputedError("load", f"{told} would sink more than the punch")

    def _powers(self, least: float) -> tuple[float, float]:
        """Return the powers of the radius that load and approach begin with at a tip."""
        if self.profile.flat_part > 0.0:
            return 0.0, 0.0
        b, past = np.array([least]), np.zeros(1)
        power = least * float((self.profile._rate(b, past) / self.profile._transform(b))[0])
        return power + (2.0 if self.scene.normal_compliance > 0.0 else 1.0), power

    def least(self, radius: float, load: float) -> float:
        """Return a radius at which load and traction are negligible; just past a flat part.

        It is a larger one where flat punches would have compliances that are out of range, or where
        mean pressures do not fall towards the tip: from there on the contact is similar to itself.
        """
        if self.profile.flat_part > 0.0:
            return self.profile.flat_part * (1.0 + _PAST)
        wanted = math.log(_NEGLIGIBLE * self.rtol)
        share, step, at = 0.0, -math.log(2.0), math.log(radius)
        softest = max(self.scene.normal_compliance, self.scene.tangential_compliance)
        # flat punches of smaller radii have compliances that no scene may have
        deepest = math.log(2.0 * softest / LARGEST_COMPLIANCE) if softest else -math.inf
        while share > wanted and at > deepest:
            at = max(at + step, deepest)
            b = math.exp(at)
            before, share = share, math.log(self.contact(b).load / load * (radius / b) ** 2)
            if share + math.log(radius / b) > 0.0 and b < 1e-9 * radius:
                break
            # shares fall like powers of the radius, the faster the smaller it is
            if share < before:
                step *= min(max((share - wanted) / (before - share), _LEAST_STRIDE), _STRIDE)
        return math.exp(at)

    def _onset(self, least: float, radius: float) -> float | None:
        """Return the radius at which slip begins; 0 if it is always there, None if never.

        The critical friction rises while a contact grows: there is slip at all larger radii.
        """
        friction = self.scene.friction
        assert friction is not None
        if friction == math.inf:
            return None
        if self.scene.tangential_compliance == 0.0:
            return 0.0

        def excess(log_radius: float) -> float:
            # infinite where the pressure of full stick changes sign
            return min(math.log(self.critical(math.exp(log_radius)) / friction), _LACKING)

        low, high = math.log(least), math.log(radius)
        if excess(high) <= 0.0:
            return None
        if excess(low) >= 0.0:
            return 0.0
        return math.exp(float(brentq(excess, low, high, xtol=_ONSET)))
