"""The tangential equation on any zones, driven by a pressure that is known.

What the pressure does is evaluated, and never assembled: its own demand next to every boundary, and
the traction of every slip zone, by quadrature from inside of it, and on the panels of a zone that
has stick outside at its own nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.contact.resolution import ROUNDING
from spectral_contact.contact.slip_source import SlipSource
from spectral_contact.contact.zone_spaces import slip_panels
from spectral_contact.fields.series import EDGE, Array, PressureField, Radius
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.blocks import Block, block
from spectral_contact.spectral.panels import LEAST_DEGREE, Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import Points
from spectral_contact.spectral.seen import Seen
from spectral_contact.spectral.tangential import Misfit, Tangential
from spectral_contact.threads import cached_property


class Driven(Tangential):
    """The tangential equation with a known pressure, for kappa = 1.

    Vectors hold the pressure's coefficient 1, those of its changes, and then the coefficients of
    ``u = q/s`` on the parts that stick.

    Parameters
    ----------
    radii, states, spaces, parameters
        As of `Tangential`. In slip spaces are those of the pressure.
    drives : sequence of Drive
        Of the pressure, and of its changes.
    tolerance : float
        Relative accuracy of the displacement. What slips is known to rounding at any: noise in it
        looks like detail, and digits are cheap.
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        spaces: Sequence[Resolution],
        parameters: Parameters,
        drives: Sequence[Drive],
        tolerance: float,
    ) -> None:
        super().__init__(radii, states, spaces, parameters)
        self.drives, self.count, self.fields = drives, len(drives), []
        self._tolerance = tolerance
        self._plain = True, True  # of one disk G vanishes at its rim
        self.load = np.zeros(self.count)
        self.load[0] = 1.0 / (2.0 * np.pi)
        self._place_shear()
        #: degrees for which there are nodes on every part: what is seen in slip is smooth
        self._felt = [
            (LEAST_DEGREE,) * len(p.degrees) if p.state else p.degrees for p in self.parts
        ]
        self._place_nodes(self._felt[: self.stick[-1] + 1])
        self._shear_tests = self.shear_weights
        self._g = [Seen(one, self._seen(i)) for i, one in enumerate(self.nodes)]

    def _seen(self, i: int) -> dict[int, Block]:
        """Return the half-integrals of what sticks at the nodes of a part."""
        target, found = self.parts[i].family, {}
        for k in self.stick:
            one = block(self.parts[k].shear, self.parts[k].degrees, target, self._felt[i], 1)
            if one is not None:
                found[k] = one
        return found

    # what is known

    @property
    def _pressures(self) -> list[PressureField]:
        return [one.pressure for one in self.drives]

    @cached_property
    def _sources(self) -> dict[int, SlipSource]:
        """The slip zones, as what is inside of them sees them."""
        alpha, found = self.parameters.alpha, {}
        for zone, state in enumerate(self.states):
            if state:
                inner, outer = self.bounds[zone : zone + 2]
                inside = self.parts[2 * zone - 2].family.reach
                form = alpha, ROUNDING, self.nodes[2 * zone - 2], inside
                found[zone] = SlipSource(self._pressures, inner, outer, *form)
        return found

    def _slip(self, zone: int, y: Array, z: Array, count: int) -> Array:
        """Return q/s in a slip zone, under the first of the pressures, as rows."""
        friction = self.states[zone] * self.parameters.friction
        return friction * PressureField.several(self._pressures[:count], y) / np.sqrt(z)

    @cached_property
    def _known(self) -> list[_Known]:
        """What is known of every part with nodes, without what sticks."""
        known = []
        for i, nodes in enumerate(self.nodes):
            family, samples = self.parts[i].family, nodes.samples
            boundary, points = family.boundary, family.points(samples)
            if boundary == EDGE:
                # not interpolated: its rounding, the same over a panel, would show at the centre
                nothing, y = np.zeros(self.count), family.points(nodes.d).y
                known.append(_Known(nothing, nothing, Drive.targets(self.drives, y).T))
                continue
            drive = Drive.targets_from(self.drives, boundary, family.sign * family.reach, samples)
            # far from the boundary noise falls with the size of the parts
            split = drive.far.shape[1]
            at, far, near = drive.at.copy(), drive.far.T.copy(), drive.near.T.copy()
            outside = Points(points.anchor, points.offset[:split])
            for zone, source in self._sources.items():
                if self.parts[i].zone < zone:
                    slip = self.states[zone] * self.parameters.friction
                    at -= slip * source.at(boundary)
                    far -= slip * source.half_integral(outside)
                    near += slip * source.fall(boundary, -points.offset[split:])
            sampled, direct = np.vstack([far - at, near]), np.zeros((len(nodes.d), self.count))
            for one, values in self._own_slip(i):
                at -= one.scale * (one.at @ values)
                (sampled if one.sampled else direct)[:] -= one.sums(values, whole=False)
            known.append(_Known(drive.at, at, nodes.spread(sampled) + direct))
        return known

    def extrapolate(self, others: Sequence[Driven], weights: Sequence[float]) -> None:
        """Take what is known as a sum of that of others; of changes what the last one has."""
        self._known = [
            _Known(*(_sum(each, weights) for each in zip(*parts, strict=True)))
            for parts in zip(*(one._known for one in others), strict=True)
        ]

    def _own_slip(self, i: int) -> Iterator[tuple[Block, Array]]:
        """Yield what a slip zone adds to half-integrals at a part of it."""
        zone, target = self.parts[i].zone, self.parts[i].family
        for part in self.parts[2 * zone - 1 : 2 * zone + 1] if self.states[zone] else ():
            one = block(part.family, part.degrees, target, self._felt[i], 1)
            if one is not None:
                used = part.family.panels.functions(part.degrees)
                points = part.family.sampling()
                values = part.family.expand(self._slip(zone, points.y, points.z, self.count))
                yield one, values[:, used].T

    # the equation

    def _slipping_load(self) -> Array:
        rests = np.array([one.rest for one in self.radii])
        return np.asarray(Drive.loads_outside(self.drives, rests) @ np.diff(self.states))

    def _pressure_at(self, k: int) -> Array:
        y = self.parts[k].family.boundary.rest
        return np.array([one.value(y) for one in self._pressures])

    def _driven_at(self, i: int) -> tuple[Array, Array]:
        drive, balance, _ = self._known[i]
        return drive, balance

    def _driven(self, i: int, values: Array) -> Array:
        return np.asarray(self._known[i][2] @ values[: self.count])

    def misfit(self, values: Array, approach: Array, imbalance: Array) -> Misfit:
        """Return E at the nodes of every part."""
        return Misfit([], self._tangential(values, self.traction(values), imbalance))

    def traction(self, values: Array) -> dict[int, Array]:
        """Return the coefficients of q/s of vectors on the parts that stick; none if all are 0."""
        some = values[self.count :].any()
        return {k: values[own] for k, own in self.shear.items()} if some else {}

    # slip

    def slip_zone(self, zone: int) -> Annulus:
        """Return the panels of the displacement in a slip zone."""
        alpha, beta, _, _ = self.parameters
        panels = slip_panels(self.bounds, zone, alpha, beta, self._tolerance)
        return Annulus(self.bounds[zone], self.bounds[zone + 1], *panels)

    def slip_misfit(self, values: Array, zone: int, annulus: Annulus) -> list[Array]:
        """Return E at the sampling points of a slip zone, of vectors as columns."""
        # the last change is in no vector but its own
        count = 1 + int(np.flatnonzero(values[: self.count].any(axis=1))[-1])
        own, drives, totals = values[:count], self.drives[:count], list[Array]()
        z = np.concatenate([one.sampling().z for one in annulus.families])
        slips = annulus.halves(own.T @ self._slip(zone, annulus.y, z, count))
        demanded = annulus.halves(own.T @ Drive.targets(drives, annulus.y))
        each = zip(annulus.families, demanded, annulus.integrals(slips, 1), strict=True)
        for target, wanted, half in each:
            points, total = target.sampling(), (wanted - half).T
            for outside in (k for k in range(zone + 1, len(self.states)) if self.states[k]):
                slip = self.states[outside] * self.parameters.friction
                total -= slip * self._sources[outside].half_integral(points)[:, :count] @ own
            for k, stuck in self.traction(values).items():
                part = self.parts[k]
                seen = block(part.shear, part.degrees, target, target.panels, 1, differences=False)
                if seen is not None:
                    total -= seen.sums(stuck)
            totals.append(total)
        return totals


def _sum(arrays: Sequence[Array], weights: Sequence[float]) -> Array:
    """Return the last of some arrays, whose first column is a sum of the first ones of all."""
    found = arrays[-1].copy()
    found[..., 0] = sum(w * one[..., 0] for w, one in zip(weights, arrays, strict=True))
    return found


class _Known(NamedTuple):
    """R at the boundary of a part, E there and by how much it is more at the nodes.

    Of the pressure and its changes, as columns.
    """

    drive: Array
    at: Array
    more: Array
