"""A scene with a profile to many digits: its contact radius, and two solutions compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
from mpmath.ctx_mp import MPContext

from spectral_contact.errors import ConvergenceError
from spectral_contact.layers.scene_layer import endless
from spectral_contact.precise.indented_rough import Contact, RoughIndented
from spectral_contact.precise.indented_smooth import SmoothIndented
from spectral_contact.precise.layered_indented import InitialContact, LayeredIndented
from spectral_contact.profiles import Flat
from spectral_contact.profiles.control import CONTROLS
from spectral_contact.records import ErrorEstimates
from spectral_contact.scene import Scene

#: The scalars of a contact under a profile.
PRESSED = ("approach", "contact_radius", "load", "stiffness", "indentation_work")
_MOST_STEPS = 10
#: Relative distance of the first two radii of the secants.
_APART = 1e-9
#: Digits of mpmath beyond those aimed at, on a smooth surface.
_GUARD = 12
#: Where the pressures of two solutions are compared, over the contact radius: distances from the
#: edge, and from the centre. From breaks they are these fractions of the break.
_DEPTHS = np.concatenate([np.linspace(0.02, 0.98, 13), 10.0 ** -np.arange(2.0, 31.0, 2.0)])
_ASIDE = (1e-12, 1e-6, 1e-3)


class PreciseProfileRun:
    """A scene with a profile solved on one mesh, in one precision.

    Parameters
    ----------
    scene : Scene
        Only its normal contact is solved.
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width.
    guess : mpf or float
        Of the unknown: the contact radius or, if that is fixed, as under a flat punch or where
        there is no edge, the approach.
    tell : callable
        Is told every step.
    start : InitialContact, optional
        Of a nonlinear layer: the contact in double precision.

    Raises
    ------
    ConvergenceError
        If the radius does not settle.
    """

    def __init__(
        self,
        scene: Scene,
        digits: int,
        width: float,
        guess: Any,
        tell: Callable[[str], None],
        start: InitialContact | None = None,
    ) -> None:
        self.scene = scene
        self.digits = digits
        self._tell = tell
        profile = scene.profile
        alpha = scene.normal_compliance
        adhesion = scene.work_of_adhesion or 0.0
        assert profile is not None
        #: whether the radius is fixed, so that the approach is the unknown
        self._approach_unknown = isinstance(profile, Flat) or endless(scene)
        # `_solve` takes the unknown and returns the contact
        if scene.layer is not None:
            assert start is not None
            tell("operators")
            layered = LayeredIndented(profile, scene.layer, start, digits, width)
            self.mp = layered.fixed.mp
            self.bits = layered.fixed.bits
            self._solve: Callable[[Any], Contact] = layered.solve
        elif alpha == 0.0:
            mp = self.mp = MPContext()
            mp.dps = digits + _GUARD
            self.bits = mp.prec
            self._solve = lambda a: SmoothIndented(mp, profile, a, adhesion)
        else:
            tell("operators")
            solver = RoughIndented(profile, alpha, float(guess), digits, width, adhesion)
            self.mp = solver.fixed.mp
            self.bits = solver.fixed.bits
            self._solve = solver.solve
        self.contact = self._found(guess)

    @property
    def fixed(self) -> PreciseProfileRun:
        """The run itself: it has `mp` and `bits`, which the `fixed` of other runs has."""
        return self

    def _found(self, guess: Any) -> Contact:
        """Return the contact of the scene, by Newton's method from a guess.

        The unknown is the radius or, if that is fixed, the approach.
        """
        scene = self.scene
        mp = self.mp
        if self._approach_unknown and scene.approach is not None:
            self._tell("contact")
            return self._solve(mp.mpf(scene.approach))
        if scene.contact_radius is not None:
            self._tell("contact")
            return self._solve(mp.mpf(scene.contact_radius))
        if scene.work_of_adhesion is not None:
            return self._by_secants(mp.mpf(guess))
        a = mp.mpf(guess)
        for step in range(_MOST_STEPS):
            self._tell(f"contact radius, step {step + 1}")
            contact = self._solve(a)
            if self._approach_unknown:
                change = (scene.load - contact.load) / contact.stiffness
            elif scene.load is not None:
                change = (scene.load - contact.load) / (contact.stiffness * contact.growth)
            else:
                change = (mp.mpf(scene.approach) - contact.approach) / contact.growth
            if abs(change) <= abs(a) * mp.mpf(10) ** -self.digits:
                return contact
            a += change
        raise ConvergenceError("the contact radius does not settle", "ask for fewer digits")

    def _by_secants(self, a: Any) -> Contact:
        """Return the adhesive contact of a load or an approach, by secants from a guessed radius.

        Derivatives by the radius are not known with adhesion.
        """
        scene = self.scene
        mp = self.mp
        name = "load" if scene.load is not None else "approach"
        before = self._solve(a)
        b = a * (1 + mp.mpf(_APART))
        for step in range(_MOST_STEPS):
            self._tell(f"contact radius, step {step + 1}")
            contact = self._solve(b)
            value = getattr(contact, name)
            other = getattr(before, name)
            if abs(b - a) <= abs(b) * mp.mpf(10) ** -self.digits or value == other:
                return contact
            change = (mp.mpf(getattr(scene, name)) - value) * (b - a) / (value - other)
            a = b
            before = contact
            b = b + change
        raise ConvergenceError("the contact radius does not settle", "ask for fewer digits")

    @property
    def place(self) -> Any:
        """The unknown that was found: the radius or, if that is fixed, the approach."""
        return self.contact.approach if self._approach_unknown else self.contact.radius

    @property
    def values(self) -> dict[str, Any]:
        """Approach, radius, load, stiffness and work."""
        found = self.contact
        mp = self.mp
        work = found.work
        if self.scene.work_of_adhesion is not None and not isinstance(self.scene.profile, Flat):
            work -= mp.pi * mp.mpf(self.scene.work_of_adhesion) * found.radius**2
        of = (found.approach, found.radius, found.load, found.stiffness, work)
        given = {name: getattr(self.scene, name) for name in CONTROLS}
        exact = {name: self.mp.mpf(one) for name, one in given.items() if one is not None}
        values = dict(zip(PRESSED, of, strict=True)) | exact
        if endless(self.scene):
            values["domain_radius"] = values.pop("contact_radius")
        return values

    @property
    def unknowns(self) -> int:
        """Dimension of the discrete space; 0 on a smooth surface."""
        return self.contact.unknowns

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii whose distances to the edge are given, too."""
        return self.contact.pressures(s, from_edge)

    def tractions(self, s: Any, from_edge: Any) -> Any:
        """Return zeros: there is no friction."""
        return np.full(len(s), self.mp.zero)


def compared(run: PreciseProfileRun, check: PreciseProfileRun) -> tuple[ErrorEstimates, float]:
    """Return error estimates: twice the relative differences of two runs.

    None is below the accuracy that the second run aims at. The largest is returned, too.

    Raises
    ------
    ConvergenceError
        If the pressure or the gap is not positive.
    """
    least, gap = run.contact.margins()
    if not (least > -(10.0**-run.digits) and gap > 0):
        told = f"least pressure {float(least):.1e} of its mean, least gap {float(gap):.1e}"
        raise ConvergenceError(f"the solution is no contact: {told}", "report the scene")
    floor = 10.0**-check.digits
    mp = run.mp

    def error(pairs: Any) -> float:
        ratios = [abs((a - mp.mpf(b)) / mp.mpf(b)) for a, b in pairs if a != b]
        return max(2.0 * float(max(ratios, default=0.0)), floor)

    own = run.values
    other = check.values
    errors = {name: error([(own[name], other[name])]) for name in PRESSED if name in own}
    if run.scene.contact_radius is not None or isinstance(run.scene.profile, Flat):
        errors["contact_radius"] = 0.0
    s, rest = _places(run)
    pairs = list(zip(run.pressures(s, rest), check.pressures(s, rest), strict=True))
    # without an edge the pressure falls towards 0: differences are relative to it plus its mean
    if endless(run.scene):
        mean = own["load"] / (mp.pi * own["domain_radius"] ** 2)
        pairs = [(a + mean, mp.mpf(b) + mean) for a, b in pairs]
    errors["pressure"] = error(pairs)
    return replace(ErrorEstimates(), **errors), max(errors.values(), default=inf)


def _places(run: PreciseProfileRun) -> tuple[Any, Any]:
    """Return the radii over a, and distances from the edge, where pressures are compared."""
    mp = run.mp
    a = run.contact.radius
    profile = run.scene.profile
    assert profile is not None
    rests = [mp.mpf(v) for v in _DEPTHS]
    places = [(1 - rest, rest) for rest in rests]
    central = _ASIDE if profile.pointed else (*_ASIDE, 0.0)
    places += [(mp.mpf(v), 1 - mp.mpf(v)) for v in central]
    for b in profile.breaks:
        if b < a:
            at = [mp.mpf(b) / a * (1 + sign * mp.mpf(v)) for v in _ASIDE for sign in (-1, 1)]
            places += [(s, 1 - s) for s in at if s < 1]
    s, rest = (np.array(one, dtype=object) for one in zip(*places, strict=True))
    return s, rest
