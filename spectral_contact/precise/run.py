"""One solution on one mesh; `reference` compares two of them."""

from __future__ import annotations

from functools import cached_property
from math import ceil, log
from typing import Any

import numpy as np

from spectral_contact.precise.disk import Disk, Mesh
from spectral_contact.precise.drive import Drive, RoughDrive, SmoothDrive
from spectral_contact.precise.fixed import Fixed
from spectral_contact.precise.one_disk import OneDisk, solve_one_disk
from spectral_contact.scene import Scene

__all__ = ["Run"]

_LN10 = log(10.0)
#: A mesh with so many panels more than needed is used if it is there.
_SPARE = 12


class Run:
    """A scene solved on meshes of one panel width.

    Parameters
    ----------
    scene : Scene
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width in ``-ln d``.
    stick : tuple of float, optional
        Radius of the stick disk and its distance from the edge, roughly; ``(1, 0)`` in full stick.
        None leaves the tangential problem out.
    """

    def __init__(
        self, scene: Scene, digits: int, width: float, stick: tuple[float, float] | None
    ) -> None:
        self.scene, self.digits, self._width = scene, digits, width
        self._stick = stick
        alpha, beta = scene.normal_compliance, scene.tangential_compliance
        self._layer = _layer(alpha)
        self._rate, self._power = (0.5 if alpha == 0.0 else 1.0), 0.0
        self._stick_layer = self._layer
        scales = digits + abs(log(alpha or 1.0)) / _LN10
        if stick is not None:
            c, from_edge = stick
            rest = from_edge * (1.0 + c)
            if rest == 0.0:
                self._stick_layer = max(self._layer, _layer(beta))
                self._power = -0.5 if beta == 0.0 else 0.0
            else:
                rim = max(alpha, rest) / c**2
                self._stick_layer = max(_layer(min(rim, beta / c or rim)), _layer(rim))
                self._rate = 0.5 if beta == 0.0 else 1.0
                scales += (2.0 * abs(log(rest)) - 4.0 * log(c)) / _LN10
            scales += abs(log(beta / c or 1.0)) / _LN10
        # a diagonal entry of the last panel is as small as exp(-x) (compliance + exp(-x))
        depth = max(self._layer, self._stick_layer) + (digits * _LN10 + 6.0) / self._rate
        bound = _layer(min(alpha or 1.0, beta or 0.0)) if beta else depth
        scales += (depth + min(depth, max(bound, self._stick_layer))) / _LN10
        self.fixed = Fixed(ceil((scales + 10.0) * 3.33) + 64)
        self._disks: list[Disk] = []
        self._smooth = alpha == beta == 0.0 and self._power != 0.0

    def _disk(self, layer: float, rate: float, power: float) -> Disk:
        """Return operators on a mesh fine enough."""
        mesh = Mesh.graded(self.digits, layer, rate=rate, width=self._width, power=power)
        for disk in self._disks:
            have = disk.mesh
            spare = len(have.degrees) - len(mesh.degrees)
            if have.panels.power == power and 0 <= spare <= _SPARE:
                degrees = have.degrees[: len(mesh.degrees)]
                if all(a >= b for a, b in zip(degrees, mesh.degrees, strict=True)):
                    return disk
        self._disks.append(Disk(mesh, self.fixed))
        return self._disks[-1]

    def release(self) -> None:
        """Let go of the operators, which are large; approach, zones and fields stay."""
        self._disks.clear()
        self.drive.release()

    # the normal problem

    @cached_property
    def drive(self) -> Drive:
        """The pressure and its transforms."""
        f, alpha = self.fixed, self.scene.normal_compliance
        if alpha == 0.0:
            return SmoothDrive(f, self.digits)
        layer = self._layer
        if self._stick is not None and self._rate == 1.0 and self._power == 0.0:
            shared = max(layer, self._stick_layer)
            if shared - layer <= _SPARE * self._width:
                layer = shared
        return RoughDrive(self._disk(layer, 1.0, 0.0), f.of(alpha))

    @property
    def approach(self) -> Any:
        """``delta*``."""
        return self.fixed.numbers(self.drive.approach)

    @property
    def depth(self) -> float:
        """``-ln y`` below which the fields of this mesh do not vary."""
        return max(disk.mesh.depth for disk in self._disks) if self._disks else self.digits * _LN10

    @property
    def unknowns(self) -> int:
        """Of the largest space; 0 if closed forms were enough."""
        return max((sum(d.mesh.degrees) + len(d.mesh.degrees) for d in self._disks), default=0)

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii whose distances to the edge are given, too."""
        mp, y = self.fixed.mp, from_edge * (1 + s)
        if self.scene.normal_compliance == 0.0:  # keeps relative accuracy below 2**-bits
            return np.array([1 / (2 * mp.pi * mp.sqrt(v)) if v else mp.inf for v in y])
        return self.fixed.numbers(self.drive.pressure(self.fixed.of(y)))

    # the tangential problem

    @cached_property
    def kappa(self) -> Any:
        """The coupling constant of exactly the given Poisson's ratio."""
        nu = self.fixed.mp.mpf(self.scene.poisson_ratio)
        return (1 - 2 * nu) / (4 * (1 - nu))

    @cached_property
    def disk(self) -> OneDisk:
        """The stick zone, for ``kappa = 1``."""
        f = self.fixed
        assert self._stick is not None
        c, from_edge = self._stick
        beta = f.of(self.scene.tangential_compliance)
        disk = self._disk(self._stick_layer, self._rate, self._power)
        if from_edge == 0.0:
            unit = disk.solve(beta, self.drive.target(disk.d), tangential=True)
            return OneDisk(f.mp.inf, disk.series(unit), disk.shear(unit))
        mp = f.mp
        logit = 2 * mp.log(mp.mpf(c)) - mp.log(mp.mpf(from_edge) * (1 + mp.mpf(c)))
        friction = f.of(mp.mpf(self.scene.friction) / self.kappa)
        return solve_one_disk(self.drive, disk, beta, friction, logit)

    @property
    def total_shear(self) -> Any:
        """``Q*``."""
        if self._stick is None:
            return self.fixed.mp.zero
        if self._smooth:
            return 2 * self.kappa * self.fixed.mp.ln2
        return self.fixed.numbers(self.disk.total_shear) * self.kappa

    @cached_property
    def radius(self) -> tuple[Any, Any]:
        """``c*`` and ``1 - c*``."""
        mp = self.fixed.mp
        if self._stick is None:
            all_slip = self.scene.friction == 0.0 and self.kappa != 0
            return (mp.zero, mp.one) if all_slip else (mp.one, mp.zero)
        if self._stick[1] == 0.0:
            return mp.one, mp.zero
        logit = self.disk.logit
        c = 1 / mp.sqrt(1 + mp.exp(-logit))
        return c, 1 / ((1 + mp.exp(logit)) * (1 + c))

    def tractions(self, s: Any, from_edge: Any) -> Any:
        """Return q at mpmath's radii whose distances to the edge are given, too."""
        mp = self.fixed.mp
        if self._stick is None:
            return np.full(len(s), mp.zero)
        y, (c, edge) = from_edge * (1 + s), self.radius
        values = np.empty(len(s), dtype=object)
        # a small disk shows in s alone
        stuck = np.where(s < 0.5, s <= c, from_edge >= edge).astype(bool)
        if stuck.any():
            values[stuck] = self._in_stick(y[stuck], s[stuck])
        if not stuck.all():
            p = self.pressures(s[~stuck], from_edge[~stuck])
            values[~stuck] = mp.mpf(self.scene.friction) * p
        return values

    def _in_stick(self, y: Any, s: Any) -> Any:
        mp = self.fixed.mp
        if self._smooth:
            ratios = [-mp.log(v) / r if r and v else mp.zero for v, r in zip(y, s, strict=True)]
            return self.kappa / mp.pi**2 * self._singular(np.array(ratios), y)
        c, from_edge = self.radius
        d = np.where(s < 0.5, (c - s) * (c + s), y - from_edge * (1 + c)) / c**2
        values = self.fixed.numbers(self.disk.traction.at(self.fixed.of(d))) * s / c * self.kappa
        return self._singular(values, y) if self._power else values

    def _singular(self, values: Any, y: Any) -> Any:
        """Divide by the root of the distance to the edge."""
        mp = self.fixed.mp
        pairs = zip(values, y, strict=True)
        return np.array([v / mp.sqrt(distance) if distance else mp.inf for v, distance in pairs])

    def edge_ratio(self) -> Any:
        """Return q/p at the edge in full stick; None in partial slip, or without friction."""
        f, scene = self.fixed, self.scene
        if self._stick is None or self.radius[1] != 0:
            return None
        if scene.tangential_compliance == 0.0:
            return f.mp.inf
        if scene.normal_compliance == 0.0:
            return f.mp.zero
        edge = np.array([0], dtype=object)
        ratio = f.over(self.disk.traction.limit, self.drive.pressure(edge)[0])
        return self.kappa * f.numbers(ratio)


def _layer(width: float) -> float:
    """Return ``x`` of a layer of this width; none if it is 0 or wide."""
    return max(-log(width), 0.0) if width else 0.0
