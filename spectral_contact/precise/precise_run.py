"""One solution on meshes of one panel width; `reference` compares two of them."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, inf, log
from typing import Any

import numpy as np

from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.precise.disk import Disk, PreciseMesh
from spectral_contact.precise.drive import PreciseDrive, RoughDrive, SmoothDrive, coupling_constant
from spectral_contact.precise.fixed import Fixed, Ints
from spectral_contact.precise.law_breaches import Breach, breaches
from spectral_contact.precise.one_disk import PreciseOneDisk, solve_one_disk
from spectral_contact.precise.zone_trial import PreciseLayout, ZoneProblem, Zones, ZoneTrial
from spectral_contact.precise.zones import solve_zones
from spectral_contact.scene import Scene
from spectral_contact.threads import cached_property
from spectral_contact.view.progress import silent

_LN10 = log(10.0)
#: An existing mesh serves for another problem if it has no more than so many panels too many.
_SPARE = 12


class PreciseRun:
    """A scene solved on meshes of one panel width.

    Parameters
    ----------
    scene : Scene
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width in ``-ln d``.
    layout : PreciseLayout, optional
        The zones, with rough boundaries. None leaves the tangential problem out.
    tell : callable
        Is told every step.
    near : PreciseRun, optional
        The solution of the same zones on another mesh, a first guess: none of its digits are used.
    held : bool
        Leave the boundaries where they are.
    """

    #: without coupling the pressure is positive, and nothing opens
    opening = None

    def __init__(
        self,
        scene: Scene,
        digits: int,
        width: float,
        layout: PreciseLayout | None,
        tell: Callable[[str], None] = silent,
        near: PreciseRun | None = None,
        *,
        held: bool = False,
    ) -> None:
        self.scene = scene
        self.digits = digits
        self._width = width
        self.layout = layout
        self._held = held
        self._tell = tell
        self._near = near
        alpha = scene.normal_compliance
        beta = scene.tangential_compliance
        #: ``-ln d`` at which the layer next to the edge begins, for the pressure
        self._layer = _start_of_layer(alpha)
        #: the same next to the rim of the stick disk, for the traction
        self._stick_layer = self._layer
        #: beyond the layer the traction settles like ``exp(-rate x)``; 0.5 if it has a root there
        self._rate = 0.5 if alpha == 0.0 and self._one_disk else 1.0
        #: power of y in the endpoint weight of the traction
        self._power = 0.0
        # how far below 1 the smallest number may be, in decades, with all of its digits
        decades = digits + abs(log(alpha or 1.0)) / _LN10
        if layout is not None and self._one_disk:
            self._grade_to_rim(alpha, beta)
            decades += self._decades_of_rim(beta)
        # the smallest numbers are the matrix's diagonal entries of the last panel, at the depth x:
        # about exp(-x) (compliance + exp(-x))
        depth = max(self._layer, self._stick_layer) + (digits * _LN10 + 6.0) / self._rate
        deepest = _start_of_layer(min(alpha or 1.0, beta)) if beta else depth
        decades += (depth + min(depth, max(deepest, self._stick_layer))) / _LN10
        if layout is not None:
            decades = max(decades, layout.decades(alpha, beta, digits, width))
        # 3.33 bits a decade; ten decades and 64 bits to spare were chosen
        self.fixed = Fixed(ceil((decades + 10.0) * 3.33) + 64)
        self._disks: list[Disk] = []
        # full stick (the endpoint weight is its) without compliances: a closed form
        self._smooth = alpha == beta == 0.0 and self._power != 0.0

    def _grade_to_rim(self, alpha: float, beta: float) -> None:
        """Set layer, rate and endpoint weight of the mesh of one stick disk."""
        c = self._rim.value
        rest = self._rim.rest
        if rest == 0.0:
            self._stick_layer = max(self._layer, _start_of_layer(beta))
            self._power = -0.5 if beta == 0.0 else 0.0
            return
        rim = max(alpha, rest) / c**2
        self._stick_layer = max(_start_of_layer(min(rim, beta / c or rim)), _start_of_layer(rim))
        self._rate = 0.5 if beta == 0.0 else 1.0

    def _decades_of_rim(self, beta: float) -> float:
        """Return the decades that one stick disk adds to the range of the numbers."""
        c = self._rim.value
        rest = self._rim.rest
        decades = abs(log(beta / c or 1.0)) / _LN10
        if rest:
            decades += (2.0 * abs(log(rest)) - 4.0 * log(c)) / _LN10
        return decades

    @property
    def _one_disk(self) -> bool:
        """Whether `one_disk` solves it: at most one stick disk, and its rim is not held."""
        return self.layout is None or (self.layout.states in ((0,), (0, 1)) and not self._held)

    @property
    def _rim(self) -> Radius:
        """The boundary of the one stick disk; the edge in full stick."""
        assert self.layout is not None
        return self.layout.radii[0] if self.layout.radii else EDGE

    def _operators(self, layer: float, rate: float, power: float) -> Disk:
        """Return operators on a mesh that is fine enough, existing ones if there are any."""
        mesh = PreciseMesh.graded(self.digits, layer, rate=rate, width=self._width, power=power)
        for disk in self._disks:
            have = disk.mesh
            spare = len(have.degrees) - len(mesh.degrees)
            if have.panels.power == power and 0 <= spare <= _SPARE:
                degrees = have.degrees[: len(mesh.degrees)]
                if all(a >= b for a, b in zip(degrees, mesh.degrees, strict=True)):
                    return disk
        self._tell("operators of a disk")
        self._disks.append(Disk(mesh, self.fixed))
        return self._disks[-1]

    def release(self) -> None:
        """Let go of the operators, which are large; approach, zones and fields stay."""
        self._disks.clear()
        self.drive.release()
        self.__dict__.pop("_problem", None)

    # the normal problem

    @cached_property
    def drive(self) -> PreciseDrive:
        """The pressure and its transforms."""
        f = self.fixed
        alpha = self.scene.normal_compliance
        if alpha == 0.0:
            return SmoothDrive(f, self.digits)
        self._tell("normal contact")
        layer = self._layer
        if self.layout is not None and self._rate == 1.0 and self._power == 0.0:
            shared = max(layer, self._stick_layer)
            if shared - layer <= _SPARE * self._width:
                layer = shared
        return RoughDrive(self._operators(layer, 1.0, 0.0), f.of(alpha))

    @property
    def approach(self) -> Any:
        """``delta*``."""
        return self.fixed.numbers(self.drive.approach)

    @property
    def depth(self) -> float:
        """``-ln y`` at which the meshes end; nearer to the edge the fields no longer vary."""
        return max(disk.mesh.depth for disk in self._disks) if self._disks else self.digits * _LN10

    @property
    def unknowns(self) -> int:
        """Dimension of the largest space; 0 if closed forms were enough."""
        sizes = [sum(d.mesh.degrees) + len(d.mesh.degrees) for d in self._disks]
        if not self._one_disk:
            sizes.append(self.annuli.unknowns)
        return max(sizes, default=0)

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii whose distances to the edge are given, too."""
        mp = self.fixed.mp
        y = from_edge * (1 + s)
        if self.scene.normal_compliance == 0.0:  # keeps relative accuracy below 2**-bits
            return np.array([1 / (2 * mp.pi * mp.sqrt(v)) if v else mp.inf for v in y])
        return self.fixed.numbers(self.drive.pressure(self.fixed.of(y)))

    # the tangential problem

    @cached_property
    def kappa(self) -> Any:
        """The coupling constant of the scene."""
        return coupling_constant(self.scene, self.fixed)

    @property
    def _friction(self) -> Any:
        """``f / kappa`` in fixed point."""
        return self.fixed.of(self.fixed.mp.mpf(self.scene.friction) / self.kappa)

    @cached_property
    def stick_disk(self) -> PreciseOneDisk:
        """The stick disk and its traction if `_one_disk`, for ``kappa = 1``."""
        f = self.fixed
        rim = self._rim
        beta = f.of(self.scene.tangential_compliance)
        operators = self._operators(self._stick_layer, self._rate, self._power)
        if rim.from_edge == 0.0:
            unit = operators.solve(beta, self.drive.target(operators.d), tangential=True)
            return PreciseOneDisk(f.mp.inf, operators.series(unit), operators.shear(unit), None)
        mp = f.mp
        slope = None
        logit = 2 * mp.log(mp.mpf(rim.value)) - mp.log(mp.mpf(rim.from_edge) * (1 + rim.value))
        if self._near is not None:
            logit = self._near.stick_disk.logit
            slope = self._near.stick_disk.slope
        return solve_one_disk(self.drive, operators, beta, self._friction, logit, self._tell, slope)

    @cached_property
    def _problem(self) -> ZoneProblem:
        """The tangential problem on the zones."""
        assert self.layout is not None
        alpha = self.scene.normal_compliance
        beta = self.scene.tangential_compliance
        return ZoneProblem(
            self.drive, alpha, beta, self._friction, self.layout, self.digits, self._width
        )

    @cached_property
    def annuli(self) -> Zones:
        """The solved zones if `one_disk` does not solve them, for ``kappa = 1``."""
        assert self.layout is not None
        near = None if self._near is None else self._near.annuli
        return solve_zones(self._problem, self.layout.radii, self._tell, held=self._held, near=near)

    @property
    def logits(self) -> tuple[Any, ...]:
        """``ln(b**2/(1 - b**2))`` of the boundaries between zones, outward."""
        if self.layout is None or not self.layout.radii:
            return ()
        return (self.stick_disk.logit,) if self._one_disk else self.annuli.logits

    def breaches(self) -> list[Breach]:
        """Return where the friction law does not hold, or is not known to."""
        if self.layout is None or self.scene.friction == inf:
            return []
        problem = self._problem
        trial = ZoneTrial(problem, self.logits, len(problem.states) - 1)
        sticking = {k: self._over_s(k, trial) for k in problem.sticking}
        return breaches(trial, sticking, self.digits)

    def _over_s(self, zone: int, trial: ZoneTrial) -> Ints:
        """Return ``q / s`` at the nodes of a zone that sticks, for ``kappa = 1``."""
        mesh = trial.problem.meshes[zone]
        f = self.fixed
        below = mesh.below.ravel()
        if self._one_disk:
            values = f.over(self.stick_disk.traction.at(below), f.sqrt(trial.squares[1]))
        else:
            series = self.annuli.tractions[zone]
            assert series is not None
            values = series.at(mesh.above.ravel(), below)
        return np.asarray(values).reshape(mesh.below.shape)

    @property
    def total_shear(self) -> Any:
        """``Q*``."""
        if self.layout is None:
            return self.fixed.mp.zero
        if self._smooth:
            return 2 * self.kappa * self.fixed.mp.ln2
        solved = self.stick_disk if self._one_disk else self.annuli
        return self.fixed.numbers(solved.total_shear) * self.kappa

    @cached_property
    def radii(self) -> tuple[tuple[Any, Any], ...]:
        """The boundaries between zones and their distances from the edge."""
        mp = self.fixed.mp
        logits = self.logits
        values = [1 / mp.sqrt(1 + mp.exp(-x)) for x in logits]
        return tuple(
            (b, 1 / ((1 + mp.exp(x)) * (1 + b))) for b, x in zip(values, logits, strict=True)
        )

    @property
    def radius(self) -> tuple[Any, Any]:
        """``c*`` and ``1 - c*``."""
        if self.radii:
            return self.radii[0]
        mp = self.fixed.mp
        all_slip = self.layout is None and self.scene.friction == 0.0 and self.kappa != 0
        return (mp.zero, mp.one) if all_slip else (mp.one, mp.zero)

    def tractions(self, s: Any, from_edge: Any) -> Any:
        """Return q at mpmath's radii whose distances to the edge are given, too."""
        mp = self.fixed.mp
        if self.layout is None:
            return np.full(len(s), mp.zero)
        # zones: next to the centre told apart by s, next to the edge by the distance from it
        own = np.zeros(len(s), dtype=int)
        for boundary, distance in self.radii:
            own += np.where(s < 0.5, s > boundary, from_edge < distance).astype(int)
        values = np.empty(len(s), dtype=object)
        for k in np.unique(own):
            rows = own == k
            state = self.layout.states[k]
            if state:
                p = self.pressures(s[rows], from_edge[rows])
                values[rows] = state * mp.mpf(self.scene.friction) * p
            else:
                values[rows] = self._in_stick(int(k), s[rows], from_edge[rows])
        return values

    def _in_stick(self, zone: int, s: Any, from_edge: Any) -> Any:
        """Return q at radii in a zone that sticks."""
        mp = self.fixed.mp
        y = from_edge * (1 + s)
        if self._smooth:
            ratios = [
                -(mp.log1p(-r * r) if r < 0.5 else mp.log(v)) / r if r and v else mp.zero
                for v, r in zip(y, s, strict=True)
            ]
            return self.kappa / mp.pi**2 * self._singular(np.array(ratios), y)
        ends = [(mp.zero, mp.one), *self.radii, (mp.one, mp.zero)][zone : zone + 2]
        # how far in s**2 the radii are below the inner end of the zone, and below the outer one
        below = [np.where(s < 0.5, b - s, from_edge - e) * (b + s) for b, e in ends]
        if self._one_disk:
            c = self.radius[0]
            depth = np.minimum(below[1] / c**2, 1)  # rounding may exceed 1 at the centre
            values = self.stick_disk.traction.at(self.fixed.of(depth))
            values = self.fixed.numbers(values) * s / c * self.kappa
            return self._singular(values, y) if self._power else values
        series = self.annuli.tractions[zone]
        assert series is not None
        values = series.at(self.fixed.of(-below[0]), self.fixed.of(below[1]))
        return self.fixed.numbers(values) * s * self.kappa

    def _singular(self, values: Any, y: Any) -> Any:
        """Divide by the root of ``y = 1 - s**2``; infinite at the edge."""
        mp = self.fixed.mp
        pairs = zip(values, y, strict=True)
        return np.array([v / mp.sqrt(distance) if distance else mp.inf for v, distance in pairs])

    def edge_ratio(self) -> Any:
        """Return q/p at the edge in full stick; None in partial slip, or without friction."""
        f = self.fixed
        scene = self.scene
        if scene.friction is not None and self.kappa == 0:
            return f.mp.zero
        if self.layout is None or self.radii:
            return None
        if scene.tangential_compliance == 0.0:
            return f.mp.inf
        if scene.normal_compliance == 0.0:
            return f.mp.zero
        edge = np.array([0], dtype=object)
        ratio = f.over(self.stick_disk.traction.limit, self.drive.pressure(edge)[0])
        return self.kappa * f.numbers(ratio)


def _start_of_layer(width: float) -> float:
    """Return ``x = -ln d`` at the distance ``d = width``; 0 if there is no layer, or it is wide."""
    return max(-log(width), 0.0) if width else 0.0
