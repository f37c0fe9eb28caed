"""The flat punches of the history of a growing contact, its beginning, and the onset of slip.

The history of a contact is a sum over flat punches of all radii ``b`` up to the contact radius
(docs/theory, Contacts that grow). `Stages` solves the flat punch of any radius. It also chooses the
radius at which the history begins, finds the onset, which is the radius at which slip begins, and
makes the `Grower`, which builds the history.
"""

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
from spectral_contact.solving.weights import LoadSource, NormalLoads, SmoothLoads, VolterraLoads

#: Takes the scene of a flat punch, names of quantities, a tolerance, and the cache with the flat
#: punches solved before, from which the search for the stick radius starts. Returns its solution.
FlatPunches = Callable[[Scene, tuple[str, ...], float, StepCache], Solution]

#: Quantities of every flat punch of a history.
_QUANTITIES = ("pressure", "traction", "total_shear", "zones", "stick_radius", "approach")
#: Tolerance of the flat punches over that of the fields.
_FLAT_RTOL_FACTOR = 0.1
#: Least tolerance of the flat punches.
_LEAST_FLAT_RTOL = 1e-12
#: The mean pressure at the first radius of the history, over today's, is this fraction of the
#: tolerance.
_FIRST_PRESSURE_FRACTION = 0.01
#: In the search for that radius, the length of a step in ``u`` over that of the step before is
#: between these.
_LEAST_STEP_RATIO = 0.1
_LARGEST_STEP_RATIO = 4.0
#: First radius of a history beyond a flat part: distance from the end of this part, relative to it.
_BEYOND_FLAT_PART = 1e-10
#: Distance of the origin ``b_0`` of ``v`` below a break of the profile, relative to the break, on a
#: smooth surface without coupling (`Grower.break_distance`). There the load beyond a break has a
#: term like the power 3/2 of the distance.
_SMOOTH_BREAK_DISTANCE = 1e-7
#: The same with a layer or with coupling.
_BREAK_DISTANCE = 3e-4
#: Distance of the origin ``b_0`` of ``v`` below 0 from the first touch on, over the least
#: compliance. As functions of ``b`` flat punches in full stick have no poles closer to 0: the
#: nearest is at 2.32 without coupling, and at 2.01 with the largest coupling.
_ORIGIN_DISTANCE = 2.0
#: Number of radii at which the power ``dln H/dln b`` of a profile is sampled.
_POWER_SAMPLES = 200
#: Change of this power by which the profile counts as one of different powers near and far. With
#: 0.1 or more, errors of the load next to the first touch were up to 9 times their estimates under
#: sums of a cone and a parabola: validation/honesty/honesty.py growing_thick.
_POWER_CHANGE = 0.05
#: The power n of the first touch is taken at this fraction of the first radius of a history. A
#: power p in place of n leaves ``(n - p) ln b`` to be interpolated, which is singular at 0, and
#: which the coefficients of a panel do not show if it is small. With the power at the first radius
#: itself, loads there were off by up to 27 times their estimates, and with 0.01 by up to 6 times.
_TOUCH_FRACTION = 1e-4
#: Rounding of the radii of a history, relative.
_RADIUS_ROUNDING = 1e-15
#: With coupling the pressure of a flat punch may change sign at some distance from its edge. The
#: contact radius has to be at least so many times this distance away from the radius at which the
#: profile is vertical. Loads had no digits at 75 times the distance, and all digits at 220 times.
_POLE_DISTANCE = 200.0
#: Tolerance of the critical friction.
_CRITICAL_RTOL = 1e-10
#: Tolerance of ``u`` at the onset of slip.
_ONSET_XTOL = 1e-12
#: In the search for the onset, ``ln`` of the critical friction over the given one is limited to
#: this, because the critical friction may be infinite.
_LARGEST_LOG_EXCESS = 5.0


class NoFlatPunchError(ArithmeticError):
    """No zones of a flat punch of the history obey the friction law; the text says why.

    It is raised by the function that solves the flat punch. The run of the scene returns a history
    of full stick instead, with infinite errors.
    """


class Stages:
    """The flat punches of a history, its beginning, and the onset of slip.

    Parameters
    ----------
    scene : Scene
        With a profile and friction.
    rtol, max_unknowns
        As of `spectral_contact.solve`; the number of unknowns is that of normal contact.
    tell : callable
        Takes a message about the progress.
    fields : tuple of str
        Names of the fields that are superposed, "slip" among them if it is asked for.
    solve : FlatPunches
        Solves a flat punch.
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
        self.scene = scene
        self.rtol = rtol
        self.max_unknowns = max_unknowns
        self.profile = scene.profile
        self._tell = tell
        self._fields = fields
        self._flat_rtol = max(_FLAT_RTOL_FACTOR * rtol, _LEAST_FLAT_RTOL)
        # a flat punch has no profile, no given load, approach or radius, and no physical data
        absent: dict[str, Any] = dict.fromkeys(("physical", "profile", *CONTROLS))
        self._flat_scene = replace(scene, **absent)
        self._cache = StepCache()
        # the stick radii solved for so far; flat punches find them in the cache, to start from
        self._path = StickPath(scene.normal_compliance, scene.tangential_compliance)
        self._cache.get(COUPLING if scene.couples else PARTIAL_SLIP, (), lambda: self._path)
        self._solve = solve
        #: the scene and the solution of the latest flat punch
        self._last: tuple[Scene, Solution] | None = None

    def contact(self, radius: float) -> Indentation:
        """Return normal contact, without friction, of a contact radius."""
        indent = indenter(self.profile, self.scene.normal_compliance, self.max_unknowns)
        return value_of(indent(radius, self._flat_rtol, False))

    def _scene(self, radius: float) -> Scene:
        """Return the scene of the flat punch of a radius, in units of the radius."""
        unscaled = self._flat_scene
        return replace(
            unscaled,
            normal_compliance=unscaled.normal_compliance / radius,
            tangential_compliance=unscaled.tangential_compliance / radius,
        )

    def flat(self, radius: float) -> Solution:
        """Return the solution of the flat punch of a radius, in units of the radius."""
        scene = self._scene(radius)
        if self._last is None or self._last[0] != scene:  # on a smooth surface all scenes are equal
            self._tell(f"as the contact grew: radius {radius:.4g}")
            quantities = (*_QUANTITIES, *self._fields)
            self._last = scene, self._solve(scene, quantities, self._flat_rtol, self._cache)
        return self._last[1]

    def critical_friction(self, radius: float) -> float:
        """Return the least friction with which the flat punch of a radius sticks everywhere."""
        quantities = ("critical_friction",)
        flat = self._solve(self._scene(radius), quantities, _CRITICAL_RTOL, self._cache)
        return flat.critical_friction

    def load_source(self, first_radius: float) -> LoadSource:
        """Return the source of load and approach along a history that begins at a radius."""
        if self.scene.couples:
            return VolterraLoads(self.profile, math.log(first_radius), self.flat(first_radius))
        if self.scene.normal_compliance == 0.0:
            return SmoothLoads(self.profile, self.contact(first_radius).load)
        return NormalLoads(self.contact)

    def grower(self, first_radius: float, radius: float) -> Grower:
        """Return the builder of the history between two contact radii."""
        self._check_digits(radius)
        onset = self._path.onset = self._onset(first_radius, radius)
        # `_SMOOTH_BREAK_DISTANCE`, the smaller one, makes the panels next to a break shorter. With
        # coupling, panels as short as these would add differences of nearly equal numbers.
        smooth = self.scene.normal_compliance == 0.0 and not self.scene.couples
        self._check_pole(radius)
        return Grower(
            flat=self.flat,
            load_source=self.load_source(first_radius),
            onset=onset,
            fields=self._fields,
            tolerance=self.rtol,
            breaks=self.profile.breaks,
            break_distance=_SMOOTH_BREAK_DISTANCE if smooth else _BREAK_DISTANCE,
            origin_distance=self._origin_distance(first_radius, radius),
            powers=self._powers(first_radius),
            log_pole=math.log(self.profile._pole),
        )

    def _origin_distance(self, first_radius: float, radius: float) -> float:
        """Return the distance of the origin ``b_0`` of ``v`` below 0, from the first touch on.

        As functions of ``b``, flat punches in full stick have poles at negative ``b`` at distances
        in proportion to the least compliance (docs/theory, G.10). The load has zeros there, too, if
        the profile has different powers near and far, as the sum of a cone and a parabola: they are
        about as far from 0 as the radius where the power of ``H`` changes. The distance is at most
        the radius at which it has changed by `_POWER_CHANGE`.
        """
        compliances = self.scene.normal_compliance, self.scene.tangential_compliance
        distance = _ORIGIN_DISTANCE * min((c for c in compliances if c > 0.0), default=0.0)
        if self.profile.flat_part > 0.0:  # the origin is its end
            return distance
        end = min((b for b in self.profile.breaks if b > first_radius), default=radius)
        u = np.linspace(math.log(first_radius), math.log(min(end, radius)), _POWER_SAMPLES)
        powers = np.diff(np.log(self.profile._transform(np.exp(u)))) / np.diff(u)
        changed = np.flatnonzero(np.abs(powers - powers[0]) > _POWER_CHANGE)
        return min(distance, math.exp(u[changed[0]])) if changed.size else distance

    def _check_digits(self, radius: float) -> None:
        """Raise if a radius is so close to a flat part or a pole that the load has too few digits.

        The load is a power of the distance from the end of the flat part. The pole is where the
        profile is vertical; next to it the load contains the logarithm of the distance from it.
        """
        flat_part = self.profile.flat_part
        pole = self.profile._pole
        distance = min(radius - flat_part, pole - radius) / radius
        if distance < max(_RADIUS_ROUNDING / self.rtol, 10.0 * _BEYOND_FLAT_PART):
            raise NotComputedError(
                "traction",
                f"the contact radius is within {distance:.1e}, relative, of the end of the flat "
                f"part or of a vertical surface, too close for rtol = {self.rtol:g}",
            )

    def _check_pole(self, radius: float) -> None:
        """Raise if a radius is so close to a pole that a contact with coupling would not grow.

        It would not grow if the zone at the edge in which the pressure changes sign is not far
        smaller than the distance to the pole.
        """
        distance_to_pole = 1.0 - radius / self.profile._pole
        # The distance from the edge at which the pressure changes sign; False or None if it does
        # not. Without a pole no flat punch has to be solved.
        opening = (
            distance_to_pole < 1.0
            and self.scene.couples
            and self.flat(radius).values.get("opening")
        )
        if opening and distance_to_pole < _POLE_DISTANCE * opening:
            raise NotComputedError(
                "load",
                f"at the contact radius {radius:.6g} the surface next to the edge would sink more "
                "than the punch",
            )

    def _powers(self, first_radius: float) -> tuple[float, float]:
        """Return the powers of the radius that load and approach begin with; 0 at a flat part.

        They are those of (docs/theory, G.8 and G.9) with the power ``n = dln H/dln b`` of the
        profile at `_TOUCH_FRACTION` of the first radius. If n at the first radius itself differs by
        `_POWER_CHANGE` or more, as next to a tip far smaller than this radius, that one is taken.
        """
        if self.profile.flat_part > 0.0:
            return 0.0, 0.0
        b = first_radius * np.array([_TOUCH_FRACTION, 1.0])
        # below the first break; `_rate` is the derivative of H, `_transform` is H
        with np.errstate(all="ignore"):  # H may underflow
            powers = b * self.profile._rate(b, np.zeros(2)) / self.profile._transform(b)
        at_touch, power = powers.tolist()
        if abs(at_touch - power) < _POWER_CHANGE:
            power = at_touch
        return power + (2.0 if self.scene.normal_compliance > 0.0 else 1.0), power

    def first_radius(self, radius: float, load: float) -> float:
        """Return the first radius of the history.

        Up to there load and traction are negligible: the mean pressure over today's is the
        tolerance times `_FIRST_PRESSURE_FRACTION`. Beyond a flat part the history begins next to
        its end.

        The first radius is larger in two cases: where smaller flat punches would have compliances
        that no scene may have, and where the mean pressure falls more slowly than the radius. In
        the second case contacts of smaller radii are similar to each other, and fields are
        continued.

        Parameters
        ----------
        radius, load : float
            Today's.
        """
        if self.profile.flat_part > 0.0:
            return self.profile.flat_part * (1.0 + _BEYOND_FLAT_PART)
        log_negligible = math.log(_FIRST_PRESSURE_FRACTION * self.rtol)
        # logarithm of the mean pressure over today's
        log_pressure_ratio = 0.0
        # of the search, in u; negative, as it goes to smaller radii
        u_step = -math.log(2.0)
        u = math.log(radius)
        compliance = max(self.scene.normal_compliance, self.scene.tangential_compliance)
        # flat punches of smaller radii have compliances that no scene may have
        lowest = math.log(2.0 * compliance / LARGEST_COMPLIANCE) if compliance else -math.inf
        while log_pressure_ratio > log_negligible and u > lowest:
            u = max(u + u_step, lowest)
            b = math.exp(u)
            previous_log_pressure_ratio = log_pressure_ratio
            log_pressure_ratio = math.log(self.contact(b).load / load * (radius / b) ** 2)
            # The pressure falls more slowly than b: it would be negligible only at radii that are
            # far too small.
            if log_pressure_ratio + math.log(radius / b) > 0.0 and b < 1e-9 * radius:
                break
            # the next step is the secant's, as the ratio is like a power of the radius
            if log_pressure_ratio < previous_log_pressure_ratio:
                step_ratio = (log_pressure_ratio - log_negligible) / (
                    previous_log_pressure_ratio - log_pressure_ratio
                )
                u_step *= min(max(step_ratio, _LEAST_STEP_RATIO), _LARGEST_STEP_RATIO)
        return math.exp(u)

    def _onset(self, first_radius: float, radius: float) -> float | None:
        """Return the radius at which slip begins; 0 if at the first touch, None if there is none.

        There is slip where the critical friction of the flat punch is above the given one. It is
        taken to rise with the radius, so that there is slip at all larger radii, too.
        """
        friction = self.scene.friction
        assert friction is not None
        if friction == math.inf:
            return None
        if self.scene.tangential_compliance == 0.0:
            return 0.0

        def log_excess(u: float) -> float:
            # infinite where the pressure of full stick changes sign
            excess = math.log(self.critical_friction(math.exp(u)) / friction)
            return min(excess, _LARGEST_LOG_EXCESS)

        low = math.log(first_radius)
        high = math.log(radius)
        if log_excess(high) <= 0.0:
            return None
        if log_excess(low) >= 0.0:
            return 0.0
        return math.exp(float(brentq(log_excess, low, high, xtol=_ONSET_XTOL)))
