"""Check whether a solution solves its scene: any object with a pressure and a traction."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, pi, sqrt
from typing import Any

import numpy as np

from spectral_contact.equations.residuals import (
    load,
    normal_displacement,
    outer_displacement,
    shear_lift,
    tangential_displacement,
)
from spectral_contact.errors import SceneError
from spectral_contact.fields import Array
from spectral_contact.io.checks import flag, real, scalar, values_at, within
from spectral_contact.io.choices import instance, listed
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import ALL_CONTROLS, refuse_unloaded
from spectral_contact.scene import Scene
from spectral_contact.testing.attributes import computed
from spectral_contact.testing.layer_conditions import LayerConditions

Field = Callable[[Array], Array]

#: Residuals that quadrature and rounding make of a correct solution, measured on solutions that are
#: right to 1e-13: checks allow this much besides `rtol`.
_FLOOR = 1e-12
#: A pressure may be infinite so close to a tip or corner, and is replaced by 0 there, which changes
#: its integrals by less than rounding.
_CORNER = 1e-14
#: The factor of a pressure that is infinite like ``1/sqrt(1 - s**2)`` is read off next to the edge:
#: this is the distance of that place over that of the nearest other place at which the pressure is
#: not smooth.
_EDGE = 1e-13
#: Distances from the edge at which residuals are computed: at the edge, in the bulk, at the centre.
_PLACES = np.concatenate([10.0 ** -np.linspace(8.0, 1.0, 8), np.linspace(0.15, 0.95, 9), [0.999]])


@dataclass(frozen=True, slots=True)
class Check:
    """One condition, and the error with which it is met.

    Attributes
    ----------
    name : str
        The condition in words.
    error : float
        Largest relative error.
    allowed : float
        Largest error with which the check passes.
    from_edge : float or None
        Distance from the edge at which the error is largest.
    """

    name: str
    error: float
    allowed: float
    from_edge: float | None = None

    @property
    def passed(self) -> bool:
        """Whether the error is allowed; NaN is not."""
        return self.error <= self.allowed


@dataclass(frozen=True, slots=True)
class CheckReport:
    """All checks of a solution; prints as a table.

    Attributes
    ----------
    checks : tuple of Check
    remarks : tuple of str
        What the solution lacks, so that checks are less sharp.
    """

    checks: tuple[Check, ...]
    remarks: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    def __str__(self) -> str:
        lines = [f"{'':5}{'check':44}{'error':>9}{'allowed':>9}   worst at 1 - s"]
        for c in self.checks:
            place = "" if c.from_edge is None else f"{c.from_edge:.3g}"
            mark = "ok" if c.passed else "FAIL"
            lines.append(f"{mark:5}{c.name:44}{c.error:9.1e}{c.allowed:9.1e}   {place}")
        return "\n".join([*(line.rstrip() for line in lines), *self.remarks])


def check_solution(
    solution: Any, scene: Scene, rtol: float, *, breaks: Sequence[float] = (), strict: bool = True
) -> CheckReport:
    """Check a solution against the equations of its scene.

    The residuals of normal contact (3.5), of full stick (4.2) (docs/theory) and of the friction law
    are computed from the fields with the elliptic kernels, by quadrature that shares no code with
    any solver. With elastic coupling (3.5) includes the normal displacement by the traction. A
    field that is right to a relative `rtol` everywhere passes.

    With a profile the pressure must carry the load, press the surface against the punch, vanish at
    the edge (or release the work of adhesion there), and leave the surface outside the contact
    below the punch, or out of the range of the layer; the given load, approach or contact radius
    must be met.
    Friction depends on the history of the load, so only the bound ``f p`` and the total shear are
    checked, and that there is no traction if kappa is 0.

    Parameters
    ----------
    solution : object
        Anything with ``pressure(s)`` and, if the scene has friction, ``traction(s)``: functions of
        arrays of ``s`` in [0, 1], dimensionless as in `Solution`. If they take ``from_edge``, it is
        used; without it layers thinner than 1e-8 are not resolved. ``approach`` and
        ``total_shear`` are checked where they exist; ``zones`` give their boundaries to `breaks`.
        Of a `Solution` these may be left uncomputed.
        If it has an ``opening``, the pressure may be negative within this distance from the edge.
        With a profile ``contact_radius`` is needed if the scene does not give it, or
        ``domain_radius`` for layer laws without an edge; ``load`` is checked where it exists.
    scene : Scene
        The problem that the solution claims to solve.
    rtol : float
        Relative accuracy claimed.
    breaks : sequence of float
        Distances from the edge, in (0, 1), at which the fields are not smooth: nodes of a coarse
        mesh, zone boundaries; those at knots of a layer's law are found. Quadrature across a kink
        has five digits only. Within ``sqrt(rtol)`` times its own distance from the edge of each of
        them, the friction law is checked to ``sqrt(rtol)`` only.
    strict : bool
        Raise if a check fails.

    Returns
    -------
    CheckReport

    Raises
    ------
    AssertionError
        If a check fails; its text is the report.
    SceneError
        If `rtol` or `breaks` are out of range, or `solution` lacks the fields, or its contact
        radius.

    Examples
    --------
    >>> from spectral_contact import Scene, solve
    >>> scene = Scene(poisson_ratio=0.1, normal_compliance=0.5)
    >>> check_solution(solve(scene), scene, 1e-10).passed
    True
    """
    refuse_unloaded(instance("scene", scene, Scene), "check_solution")
    flag("strict", strict)
    rtol = within("rtol", rtol, "in (0, 0.5]")
    cuts = [within("breaks", b, "in (0, 1)") for b in listed("breaks", breaks, "numbers")]
    zones = listed("solution.zones", computed(solution, "zones", ()), "zones")
    ends = [scalar("solution.zones", getattr(zone, "outer_from_edge", None)) for zone in zones]
    boundaries = [*cuts, *(end for end in ends if 0.0 < end < 1.0)]
    # cuts at every decade, as the pressure varies at the edge over the width of the layer
    finest = min([c for c in (scene.normal_compliance, scene.tangential_compliance) if c] or [1.0])
    cuts = [*boundaries, *(10.0**-k for k in range(1, 15) if 10.0**-k > finest / 30.0)]
    pressure = field_of(solution, "pressure")
    rtol = rtol + _FLOOR
    traction = None if scene.friction is None else field_of(solution, "traction")
    with np.errstate(divide="ignore", invalid="ignore"):  # wrong numbers may be 0 or NaN
        if scene.profile is not None:
            checks = _Indented(solution, scene, rtol, cuts).checks(pressure, traction)
        else:
            checks = _normal_checks(solution, scene, pressure, traction, rtol, cuts)
            if traction is not None:
                checks += _friction_checks(
                    solution, scene, pressure, traction, rtol, cuts, boundaries
                )
    report = CheckReport(tuple(checks), _remarks(solution, scene, breaks))
    if strict and not report.passed:
        raise AssertionError(f"the solution does not solve {scene}\n{report}")
    return report


def _remarks(solution: Any, scene: Scene, breaks: Sequence[float]) -> tuple[str, ...]:
    """Return remarks on checks that are less sharp because the solution lacks something."""
    slips = scene.friction is not None and scene.friction < inf
    if slips and not len(breaks) and computed(solution, "zones") is None:
        told = "zones are not known: where slip begins the quadrature sees five digits only"
        return (f"{told}; give that place with breaks",)
    return ()


def field_of(solution: Any, name: str, owner: str = "solution") -> Field:
    """Return a field of any solution as a function of the distance from the edge.

    Parameters
    ----------
    solution : object
        With a method of that name, which takes radii ``s``, or distances ``from_edge``.
    name : str
        ``"pressure"`` or ``"traction"``.
    owner : str
        What the solution is called in an error.

    Returns
    -------
    callable
        Takes an array of distances 1 - s and returns doubles.

    Raises
    ------
    SceneError
        If there is no such method.
    """
    method = getattr(solution, name, None)
    if not callable(method):
        raise SceneError(owner, solution, f"an object with a method {name}(s)")
    return by_distance(f"{owner}.{name}", method)


def by_distance(parameter: str, function: Callable[..., Any], radius: float = 1.0) -> Field:
    """Return a function of radii, or of distances ``from_edge``, as one of the distance.

    Parameters
    ----------
    parameter : str
        What the function is called in an error.
    function : callable
    radius : float
        Of the punch, in the units of the function.
    """
    try:
        by_edge = "from_edge" in inspect.signature(function).parameters
    except (TypeError, ValueError):  # a callable without a signature
        by_edge = False

    def field(d: Array) -> Array:
        if by_edge:
            return values_at(parameter, lambda places: function(from_edge=places), d)
        return values_at(parameter, lambda places: function(radius - places), d)

    return field


def _number(solution: Any, name: str, default: float) -> float:
    """Return a number of any solution, the default if there is none."""
    value = computed(solution, name)
    return default if value is None else scalar(f"solution.{name}", value)


def _worst(name: str, errors: Array, allowed: float, places: Array) -> Check:
    """Return the check of the largest error; NaN is the largest."""
    if not len(errors):
        return Check(name, 0.0, allowed)
    i = int(np.argmax(np.where(np.isnan(errors), inf, errors)))
    return Check(name, float(errors[i]), allowed, float(places[i]))


def _normal_checks(
    solution: Any,
    scene: Scene,
    pressure: Field,
    traction: Field | None,
    rtol: float,
    cuts: list[float],
) -> list[Check]:
    """Return the checks of pressure and approach under a flat punch.

    By reciprocity with the smooth flat punch, whose pressure is ``1/(2 pi sqrt(1 - s**2))`` and
    whose approach is 1/8: the approach is 1/8 plus the integral of that pressure times the
    displacement that layer and traction add.
    """
    alpha = scene.normal_compliance
    p = pressure(_PLACES)
    deflections = np.array([normal_displacement(pressure, float(d), cuts) for d in _PLACES])
    displacement = alpha * p + deflections
    # `load` integrates over s ds: 2 pi of the area and 1/(2 pi) of the pressure cancel
    excess = alpha * load(lambda d: pressure(d) / np.sqrt(d * (2.0 - d)), breaks=cuts)
    if scene.couples and traction is not None:
        lifts = [shear_lift(traction, scene.kappa, float(d), cuts) for d in _PLACES]
        displacement -= np.array(lifts)

        def smooth_load_on_lift(d: Array) -> Array:
            """Return ``q (1 - sqrt(1 - s^2))/s`` without cancellation."""
            return traction(d) * (1.0 - d) / (1.0 + np.sqrt(d * (2.0 - d)))

        excess -= scene.kappa * load(smooth_load_on_lift, breaks=cuts)
    approach = _number(solution, "approach", float(np.mean(displacement)))
    opening = _number(solution, "opening", 0.0)
    negative = np.where(opening > _PLACES, 0.0, np.maximum(-p, 0.0)) / np.mean(np.abs(p))
    return [
        _worst("pressure is not negative", negative, 0.0, _PLACES),
        Check("pressure bears the load", abs(2.0 * pi * load(pressure, breaks=cuts) - 1.0), rtol),
        _worst("normal equation (3.5)", np.abs(displacement / approach - 1.0), rtol, _PLACES),
        Check("approach, by reciprocity", abs(approach / (0.125 + excess) - 1.0), rtol),
    ]


class _Indented:
    """Checks of a contact under a profile."""

    def __init__(self, solution: Any, scene: Scene, rtol: float, cuts: list[float]) -> None:
        profile = scene.profile
        assert profile is not None
        self.solution = solution
        self.scene = scene
        self.rtol = rtol
        self.profile = profile
        self.layered = LayerConditions(scene) if scene.layer is not None else None
        self.pinned = isinstance(profile, Flat)  # the edge of the contact is that of the punch
        self.adhesive = scene.work_of_adhesion is not None
        if self.pinned:
            radius: Any = profile.reach
        elif self.layered is None:
            radius = computed(solution, "contact_radius") or scene.contact_radius
        else:
            radius = self.layered.radius(solution)
        low = profile.flat_part
        high = profile.reach
        limits: dict[str, Any] = {"low": low, "high": high}
        least_open = not (self.pinned or (self.adhesive and low > 0.0))
        limits |= {"low_open": least_open, "high_open": not self.pinned}
        told = f"a number in ({low:.6g}, {high:.6g}), the range of the profile"
        self.radius = real("solution.contact_radius", radius, allowed=told, **limits)
        self.cuts = [*cuts, *self._around_breaks()]

    def _around_breaks(self) -> list[float]:
        """Return cuts at every decade around breaks of the profile, as there are at the edge."""
        profile = self.profile
        a = self.radius
        finest = (self.scene.normal_compliance or a) / a
        steps = 10.0 ** -np.arange(1.0, 15.0)
        steps = np.append(steps[steps > finest / 30.0], 0.0)
        radii = [0.0] if profile.pointed else []
        radii += [b / a for b in profile.breaks if b < a]
        self.corners = 1.0 - np.array(radii)
        around = np.add.outer(self.corners, [-steps, steps]).ravel()
        return [float(d) for d in around if 0.0 < d < 1.0]

    def _integrable(self, pressure: Field) -> Field:
        """Return the pressure, replaced by 0 at tips and corners where it is infinite.

        On a smooth surface it is infinite there, like the logarithm of the distance.
        """
        if self.scene.normal_compliance or self.layered or not len(self.corners):
            return pressure

        def finite(d: Array) -> Array:
            p = pressure(d)
            near = np.abs(np.subtract.outer(d, self.corners)).min(axis=-1) < _CORNER
            return np.where(near & np.isposinf(p), 0.0, p)

        return finite

    def checks(self, pressure: Field, traction: Field | None) -> list[Check]:
        """Return all checks."""
        pressure = self._integrable(pressure)
        scene = self.scene
        a = self.radius
        rtol = self.rtol
        p = pressure(_PLACES)
        if self.layered is not None:
            self.cuts += self.layered.cuts(float(p.max()), a) + self.layered.bends(pressure)
        cuts = self.cuts
        displacement = np.array([normal_displacement(pressure, float(d), cuts) for d in _PLACES])
        heights = self.profile.height(a * (1.0 - _PLACES))
        w = scene.normal_compliance * p  # compression of the layer
        if self.layered is not None:
            w = self.layered.overclosures(p)
        # the approach, at every place
        approaches = w + a * displacement + heights
        own_approach = float(np.mean(approaches))
        if self.layered is not None:
            own_approach = float(approaches[np.argmax(p)])
        approach = _number(self.solution, "approach", own_approach)
        # what errors of displacements and of the load are relative to
        size = abs(approach)
        if self.layered is not None:
            size = max(size, a * displacement.max())
        if self.adhesive:
            size = max(size, a * np.abs(displacement).max(), np.abs(w).max())
        borne_load = 2.0 * pi * a**2 * load(pressure, breaks=cuts)
        stated_load = _number(self.solution, "load", borne_load)
        load_size = abs(stated_load)
        if self.adhesive:
            load_size = 2.0 * pi * a**2 * load(lambda d: np.abs(pressure(d)), breaks=cuts)
        misfits = np.abs(approaches - approach) / size
        if self.layered is not None:
            misfits = self.layered.misfits(p, w, approaches - approach, size)
        load_error = abs(borne_load - stated_load) / (load_size or 1.0)
        checks = [
            Check("pressure bears the load", load_error, rtol),
            _worst("surface follows the punch", misfits, rtol, _PLACES),
        ]
        if self.adhesive:
            checks.append(self._release(pressure, load_size))
        else:
            # the pressure of a layer law may be arbitrarily small, and rounded below 0
            allowed = 0.0 if self.layered is None else _FLOOR
            negative = np.maximum(-p, 0.0) / np.mean(np.abs(p))
            checks.insert(0, _worst("pressure is not negative", negative, allowed, _PLACES))
        if not self.pinned:
            if self.layered is None and not self.adhesive:
                checks.append(self._edge(pressure, borne_load))
            checks.append(self._outside(pressure, approach, size, borne_load / (pi * a**2)))
        found = {"load": borne_load, "approach": approach, "contact_radius": a}
        if self.layered is not None:
            found["separation"] = -self.layered.overclosures(pressure(np.ones(1)))[0]
        scales = {"approach": size, "separation": size, "load": load_size}
        for name in ALL_CONTROLS:
            given = getattr(scene, name)
            if given is not None:
                error = np.divide(abs(found[name] - given), scales.get(name, given))
                checks.append(Check(f"{name} is the one given", float(error), rtol))
        return checks if traction is None else checks + self._friction(pressure, traction)

    def _singularity(self, pressure: Field) -> float:
        """Return ``p sqrt(1 - s**2)`` close to the edge.

        With a normal compliance the pressure is finite: it is that at the edge then.
        """
        if self.scene.normal_compliance:
            return float(pressure(np.zeros(1))[0])
        ends = [] if self.pinned else [self.profile.reach / self.radius - 1.0]
        d = _EDGE * min([1.0, *ends, *self.corners])
        return float(pressure(np.array([d]))[0]) * sqrt(d * (2.0 - d))

    def _edge(self, pressure: Field, borne_load: float) -> Check:
        """Return the check that the pressure falls to zero at an edge inside that of the punch."""
        mean = abs(borne_load) / (pi * self.radius**2)
        error = np.divide(abs(self._singularity(pressure)), mean)
        return Check("pressure vanishes at the edge", float(error), self.rtol)

    def _release(self, pressure: Field, load_size: float) -> Check:
        """Return the check of the energy release rate at the edge, by the pressure there.

        The rate is ``alpha p**2 / 2`` with a normal compliance, and ``pi a p**2 (1 - s**2) / 8`` on
        a smooth surface. Under a flat punch it is at most the work of adhesion, else equal to it.
        """
        alpha = self.scene.normal_compliance
        adhesion = self.scene.work_of_adhesion
        assert adhesion is not None
        suction = sqrt(2.0 * adhesion / alpha if alpha else 8.0 * adhesion / (pi * self.radius))
        # on a smooth surface the rest of the pressure hides a small singularity
        size = suction if alpha else max(suction, load_size / (pi * self.radius**2))
        excess = (-self._singularity(pressure) - suction) / size
        error = max(excess, 0.0) if self.pinned else abs(excess)
        return Check("energy release rate is the work of adhesion", error, self.rtol)

    def _outside(self, pressure: Field, approach: float, size: float, mean: float) -> Check:
        """Return the check of the gap outside, up to twice the radius or to the profile's end."""
        width = min(self.profile.reach / self.radius - 1.0, 1.0)
        beyond = np.array([d * width for d in _PLACES])
        displacement = np.array([outer_displacement(pressure, float(d), self.cuts) for d in beyond])
        height = self.profile.height(self.radius * (1.0 + beyond))
        gap = height - approach + self.radius * displacement
        if self.layered is None:
            overlap = np.maximum(-gap, 0.0) / size
        else:
            overlap = self.layered.outside(-gap, size, mean)
        return _worst("surface is below the punch outside", overlap, self.rtol, -beyond)

    def _friction(self, pressure: Field, traction: Field) -> list[Check]:
        """Return the checks that need no history."""
        scene = self.scene
        p = pressure(_PLACES)
        q = traction(_PLACES)
        checks = []
        if scene.friction is not None and scene.friction < inf:
            mean = scene.friction * np.mean(np.abs(p)) or 1.0
            excess = np.maximum(np.abs(q) - scene.friction * p, 0.0) / mean
            checks.append(_worst("traction within friction", excess, 2.0 * self.rtol, _PLACES))
        if scene.kappa == 0.0:
            checks.append(_no_traction(traction))
        shear = 2.0 * pi * self.radius**2 * load(traction, breaks=self.cuts)
        return [*checks, *_shear_check(self.solution, shear, self.rtol)]


def _friction_checks(
    solution: Any,
    scene: Scene,
    pressure: Field,
    traction: Field,
    rtol: float,
    cuts: list[float],
    boundaries: list[float],
) -> list[Check]:
    """Return the checks of the traction under a flat punch."""
    shear = _shear_check(solution, 2.0 * pi * load(traction, breaks=cuts), rtol)
    if scene.kappa == 0.0:
        return [_no_traction(traction), *shear]
    checks: list[Check] = []
    # The boundary of a zone may be off by rtol. Next to it fields vary like the root of the
    # distance, so that the conditions of either zone hold to the root of rtol only.
    near = np.array([any(abs(d / b - 1.0) <= sqrt(rtol) for b in boundaries) for d in _PLACES])
    for where, suffix, allowed in ((~near, "", rtol), (near, " near a break", sqrt(rtol))):
        if where.any():
            found = _zone_checks(scene, pressure, traction, allowed, cuts, _PLACES[where])
            checks += [replace(check, name=check.name + suffix) for check in found]
    return checks + shear


def _no_traction(traction: Field) -> Check:
    """Return the check that there is no traction."""
    return _worst("no traction at kappa = 0", np.abs(traction(_PLACES)), 0.0, _PLACES)


def _shear_check(solution: Any, shear: float, rtol: float) -> list[Check]:
    """Return the check of the total shear, if the solution has one."""
    if computed(solution, "total_shear") is None:
        return []
    given = _number(solution, "total_shear", 0.0)
    error = abs(given - shear) / max(abs(shear), 1e-300) if given != shear else 0.0
    return [Check("total shear is that of the traction", error, rtol)]


def _zone_checks(
    scene: Scene,
    pressure: Field,
    traction: Field,
    rtol: float,
    cuts: list[float],
    places: Array,
) -> list[Check]:
    """Return the checks of the friction law at some places.

    A place counts as slipping where the traction has the modulus ``f p`` within the tolerance, and
    as sticking elsewhere.
    """
    friction = scene.friction
    beta = scene.tangential_compliance
    kappa = scene.kappa
    assert friction is not None
    p = pressure(places)
    q = traction(places)
    parts = [tangential_displacement(traction, pressure, kappa, float(d), cuts) for d in places]
    outward, inward = np.array(parts).T
    # the left side of (4.2), relative: `inward` has the sign of kappa, and u_r that of displacement
    # times kappa
    displacement = (beta * q + outward - inward) / inward
    with np.errstate(invalid="ignore"):
        fraction = np.abs(q) / (friction * p) if friction else np.full(len(q), inf)
    slip = fraction > 1.0 - 4.0 * rtol
    stick = ~slip  # and where a traction is NaN
    # without friction the surface moves inward if kappa > 0
    sense = np.sign(q) * np.sign(kappa) if friction else np.ones(len(q))
    checks = [
        _worst("no displacement in stick (4.2)", np.abs(displacement[stick]), rtol, places[stick]),
        _worst(
            "slip opposes the traction",
            np.maximum(displacement[slip] * sense[slip], 0.0),
            rtol,
            places[slip],
        ),
    ]
    if friction < inf:
        excess = np.maximum(np.abs(q) - friction * p, 0.0) / np.maximum(friction * p, 1e-300)
        checks.insert(0, _worst("traction within friction", excess, 2.0 * rtol, places))
    return checks
