"""One solution of full stick with elastic coupling on one mesh; `reference` compares two."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, inf, log
from typing import Any

import numpy as np

from spectral_contact.precise.coupled_disk import CoupledDisk
from spectral_contact.precise.disk import Disk, PreciseMesh
from spectral_contact.precise.drive import coupling_constant
from spectral_contact.precise.fixed import Fixed
from spectral_contact.precise.law_breaches import Breach, excesses
from spectral_contact.precise.zone_trial import PreciseLayout
from spectral_contact.scene import Scene
from spectral_contact.threads import cached_property
from spectral_contact.view.progress import silent

_LN10 = log(10.0)
#: An opening closer to the edge than this is none: doubles cannot express the distance.
_CLOSEST = 1e-300


class PreciseCoupledRun:
    """A scene solved on meshes of one panel width, with the interface of `precise_run.PreciseRun`.

    Parameters
    ----------
    scene : Scene
        With coupling, and enough friction for full stick.
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width in ``-ln d``.
    tell : callable
        Is told every step.
    """

    layout = PreciseLayout((0,), ())

    def __init__(
        self, scene: Scene, digits: int, width: float, tell: Callable[[str], None] = silent
    ) -> None:
        self.scene = scene
        self.digits = digits
        self._width = width
        compliances = scene.normal_compliance, scene.tangential_compliance
        layers = [max(-log(c), 0.0) for c in compliances if c]
        self._smooth = not layers
        # with one compliance alone the fields have roots at the edge. On a smooth surface they
        # oscillate up to the end of the mesh: degrees stay high, and the end perturbs the fields
        # by an error that falls like exp(-x) with the distance x from it
        rate = 1.0 if len(layers) == 2 else 0.5
        powers = [0.0 if c else -0.5 for c in compliances]
        meshes = [
            PreciseMesh.graded(
                digits,
                max(layers, default=0.0),
                rate=rate,
                width=width,
                power=power,
                lowest=ceil(0.4 * digits) + 6 if self._smooth else 4,
            )
            for power in powers
        ]
        self.depth = meshes[0].depth
        self.unknowns = 2 * (sum(meshes[0].degrees) + len(meshes[0].degrees))
        # a diagonal entry of the last panel is as small as exp(-x) (compliance + exp(-x))
        decades = digits + sum(abs(log(c)) for c in compliances if c) / _LN10
        decades += (self.depth + min(self.depth, max(layers, default=0.0))) / _LN10
        self.fixed = Fixed(ceil((decades + 10.0) * 3.33) + 64)
        tell("operators of a disk")
        disks = [Disk(meshes[0], self.fixed)]
        disks.append(disks[0] if powers[0] == powers[1] else Disk(meshes[1], self.fixed))
        tell("pressure and traction")
        self._solve(*disks)

    def _solve(self, normal: Disk, tangential: Disk) -> None:
        """Set approach, shear and the series of the fields."""
        f = self.fixed
        scene = self.scene
        alpha, beta = f.of([scene.normal_compliance, scene.tangential_compliance])
        pair = CoupledDisk(normal, tangential).solve(alpha, beta, f.of(self.kappa))
        # the load is 2 pi int p s ds = 4 int F dt
        approach = f.over(f.one, 4 * f.dot(normal.weights, normal.half_integral(pair[0])))
        p, u = (f.times(one, approach) for one in pair)
        self.approach = f.numbers(approach)
        self.total_shear = f.numbers(tangential.shear(u))
        #: p and q/s, without their endpoint weights
        self._series = normal.series(p), tangential.series(u)

    def release(self) -> None:
        """Let go of the operators; none are kept."""

    def breaches(self) -> list[Breach]:
        """Return where |q| exceeds f p, which is everywhere if p < 0, or is not known not to."""
        f = self.fixed
        scene = self.scene
        if scene.friction == inf:
            return []
        compliances = scene.normal_compliance, scene.tangential_compliance
        [mesh] = self.layout.meshes(f, *compliances, self.digits, self._width)
        y = mesh.below
        p, u = (one.at(y) for one in self._series)
        if not compliances[0]:  # the series is sqrt(y) p: q is multiplied by the same root
            u = f.times(u, f.sqrt(y))
        bound = f.times(f.of(f.mp.mpf(scene.friction)), p)
        return excesses(mesh, bound, f.times(f.sqrt(mesh.above), u), self.digits)

    @property
    def kappa(self) -> Any:
        """The coupling constant of the scene."""
        return coupling_constant(self.scene, self.fixed)

    @property
    def radii(self) -> tuple[tuple[Any, Any], ...]:
        """The boundaries between zones: there are none."""
        return ()

    @property
    def radius(self) -> tuple[Any, Any]:
        """``c*`` and ``1 - c*``."""
        return self.fixed.mp.one, self.fixed.mp.zero

    # the fields

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii whose distances to the edge are given, too."""
        return self._field(0, s, from_edge)

    def tractions(self, s: Any, from_edge: Any) -> Any:
        """Return q at mpmath's radii whose distances to the edge are given, too."""
        return self._field(1, s, from_edge) * s

    def _field(self, k: int, s: Any, from_edge: Any) -> Any:
        """Return p or q/s."""
        f = self.fixed
        mp = self.fixed.mp
        y = from_edge * (1 + s)
        if self.scene.normal_compliance if k == 0 else self.scene.tangential_compliance:
            return f.numbers(self._series[k].at(f.of(y)))
        edge = mp.nan if self._smooth else mp.sign(f.numbers(self._series[k].limit)) * mp.inf
        values = np.array([edge] * len(y), dtype=object)
        deep = np.array(
            [self._smooth and 0 < v < mp.exp(-self._oscillation_start) for v in y], dtype=bool
        )
        values[deep] = [self._oscillating(-mp.log(v))[k] for v in y[deep]]
        rest = np.array([v > 0 for v in y], dtype=bool) & ~deep
        values[rest] = f.numbers(self._series[k].at(f.of(y[rest])))
        return np.array([v / mp.sqrt(d) if d else v for v, d in zip(values, y, strict=True)])

    @property
    def _oscillation_start(self) -> float:
        """``-ln y`` beyond which fields on a smooth surface are those of `_oscillating`."""
        return self.depth / 2.0

    @cached_property
    def _amplitude_and_phase(self) -> tuple[Any, Any]:
        """Amplitude and phase at `_oscillation_start` of ``sqrt(y) (p + i q)``."""
        f = self.fixed
        mp = self.fixed.mp
        at = f.of([mp.exp(-mp.mpf(self._oscillation_start))])
        p, u = (f.numbers(one.at(at))[0] for one in self._series)
        return mp.hypot(p, u), mp.atan2(u, p)

    @property
    def _theta(self) -> Any:
        """``ln(3 - 4 nu)/(2 pi)``."""
        return self.fixed.mp.atanh(2 * self.kappa) / self.fixed.mp.pi

    def _oscillating(self, x: Any) -> tuple[Any, Any]:
        """Return p and q, times ``sqrt(y)``, near the edge of a smooth surface."""
        mp = self.fixed.mp
        (size, phase) = self._amplitude_and_phase
        angle = phase + self._theta * (x - self._oscillation_start)
        return size * mp.cos(angle), size * mp.sin(angle)

    # the edge

    @cached_property
    def opening(self) -> Any:
        """The largest distance from the edge at which p changes sign; None if it does not.

        The sign is taken at four places in each unit of ``x = -ln y``.
        """
        f = self.fixed
        mp = self.fixed.mp
        series = self._series[0]
        last = self._oscillation_start if self._smooth else self.depth
        x = np.linspace(1e-3, last, ceil(4.0 * last))
        signs = np.sign(f.floats(series.at(f.exp(-f.of(x)), f.of(x))))
        negative = np.flatnonzero(signs <= 0.0)
        if len(negative):
            ends = x[negative[0] - 1], x[negative[0]]
            root = mp.findroot(
                lambda v: f.numbers(series.at(f.of([mp.exp(-v)])))[0],
                [mp.mpf(float(end)) for end in ends],
                solver="anderson",
                maxsteps=100,
                verify=False,  # the comparison of two meshes is more
            )
        elif self._smooth:
            phase = self._amplitude_and_phase[1]
            root = self._oscillation_start + (mp.pi / 2 - phase) / self._theta
        else:
            return None
        y = mp.exp(-root)
        distance = y / (1 + mp.sqrt(1 - y))
        return distance if distance > _CLOSEST else None

    def edge_ratio(self) -> Any:
        """Return q/p at the edge; None where it has no limit or no meaning."""
        mp = self.fixed.mp
        scene = self.scene
        if self._smooth or self.opening is not None:
            return None
        if scene.normal_compliance == 0.0:
            return mp.zero
        p, u = (self.fixed.numbers(one.limit) for one in self._series)
        return u / p if scene.tangential_compliance else mp.sign(u) * mp.inf
