"""The tangential equation on any zones, driven by a pressure that is known.

What the pressure does is evaluated, and never assembled: its own demand next to every boundary, and
the traction of every slip zone, which is expanded on the panels of that zone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from spectral_contact.contact.drive import Drive
from spectral_contact.fields.series import EDGE, Array, PressureField, Radius
from spectral_contact.spectral.blocks import Block, across, block
from spectral_contact.spectral.panels import LEAST_DEGREE, Resolution
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import Family
from spectral_contact.spectral.seen import Seen
from spectral_contact.spectral.tangential import Misfit, Tangential
from spectral_contact.threads import cached_property

Degrees = tuple[int, ...]


class Driven(Tangential):
    """The tangential equation with a known pressure, for kappa = 1.

    Vectors hold the pressure's coefficient 1, those of its changes, and then the coefficients of
    ``u = q/s`` on the parts that stick.

    Parameters
    ----------
    radii, states, spaces, parameters
        As of `Tangential`; with tangential compliance. In slip they are those of the pressure.
    drives : sequence of Drive
        Of the pressure, and of its changes.
    """

    def __init__(
        self,
        radii: tuple[Radius, ...],
        states: tuple[int, ...],
        spaces: Sequence[Resolution],
        parameters: Parameters,
        drives: Sequence[Drive],
    ) -> None:
        super().__init__(radii, states, spaces, parameters)
        self.drives, self.count, self.fields = drives, len(drives), []
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

    @cached_property
    def _slipping(self) -> dict[int, Array]:
        """Coefficients of q/s on the parts that slip."""
        pressures, found = [one.pressure for one in self.drives], {}
        for k, part in enumerate(self.parts):
            if part.state:
                points = part.family.sampling()
                over = PressureField.several(pressures, points.y) / np.sqrt(points.z)
                used = part.family.panels.functions(part.degrees)
                slip = part.state * self.parameters.friction
                found[k] = slip * np.array([part.family.expand(one)[used] for one in over]).T
        return found

    @cached_property
    def _known(self) -> list[_Known]:
        """What is known of every part with nodes, without what sticks."""
        known = []
        for i, nodes in enumerate(self.nodes):
            family, d = self.parts[i].family, nodes.samples
            drive, sampled = self._demanded(family, d)
            at, direct = drive.copy(), np.zeros((len(nodes.d), self.count))
            for k, values in self._slipping.items():
                part = self.parts[k]
                form = part.family, part.degrees, family, self._felt[i]
                if part.boundary == self.parts[i].boundary and k > i:
                    own, more = across(*form, values)
                    at -= own
                    sampled -= more
                    continue
                one = block(*form, 1)
                if one is not None:
                    own = one.onto(values)
                    at -= one.scale * (one.at @ values)
                    (sampled if one.sampled else direct)[:] -= one.more @ own
            known.append(_Known(drive, at, nodes.spread(sampled) + direct))
        return known

    def _demanded(self, family: Family, d: Array) -> tuple[Array, Array]:
        """Return R at the boundary of a part, and by how much it is more at distances."""
        if family.boundary == EDGE:
            return np.zeros(self.count), Drive.targets(self.drives, family.points(d).y).T
        at, far, near = Drive.targets_from(
            self.drives, family.boundary, family.sign * family.reach, d
        )
        return at, np.hstack([far - at[:, None], near]).T

    # the equation

    def _slipping_load(self) -> Array:
        load, bounds = np.zeros(self.count), (*self.radii, EDGE)
        for state, inner, outer in zip(self.states[1:], bounds, bounds[1:], strict=False):
            for k, drive in enumerate(self.drives) if state else ():
                ends = drive.load_outside(np.array([inner.rest, outer.rest]))
                load[k] += state * float(ends[0] - ends[1])
        return load

    def _pressure_at(self, k: int) -> Array:
        y = np.array([self.parts[k].family.boundary.rest])
        return PressureField.several([one.pressure for one in self.drives], y)[:, 0]

    def _driven_at(self, i: int) -> tuple[Array, Array]:
        drive, balance, _ = self._known[i]
        return drive, balance

    def _driven(self, i: int, values: Array) -> Array:
        return np.asarray(self._known[i][2] @ values[: self.count])

    def misfit(self, values: Array, approach: Array, lifts: Array) -> Misfit:
        """Return E at the nodes of every part."""
        return Misfit([], self._tangential(values, self.traction(values), lifts))

    def traction(self, values: Array) -> dict[int, Array]:
        """Return the coefficients of q/s of vectors on the parts that stick."""
        return {k: values[own] for k, own in self.shear.items()}

    def matrix(self) -> Array:
        """Return the matrix of `residual`, but for roundings: the pressure is given."""
        matrix = np.zeros((self.unknowns, self.unknowns))
        self._add_tangential(matrix)
        matrix = self._with_masses(matrix)
        matrix[: self.count] = np.eye(self.count, self.unknowns)
        return matrix

    def slip_misfit(self, values: Array, target: Family) -> Array:
        """Return E at the sampling points of a half of a slip zone, of vectors as columns."""
        points = target.sampling()
        total = Drive.targets(self.drives, points.y).T @ values[: self.count]
        known = {k: one @ values[: self.count] for k, one in self._slipping.items()}
        for k, own in (self.traction(values) | known).items():
            part = self.parts[k]
            seen = block(part.shear, part.degrees, target, target.panels, 1, differences=False)
            if seen is not None:
                total -= seen.whole @ seen.onto(own)
        return np.asarray(total)


class _Known(NamedTuple):
    """R at the boundary of a part, E there and by how much it is more at the nodes.

    Of the pressure and its changes, as columns.
    """

    drive: Array
    at: Array
    more: Array
