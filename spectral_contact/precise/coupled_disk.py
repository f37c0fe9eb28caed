"""Normal and tangential contact of a disk as one system in fixed point: elastic coupling.

What pressure and traction do to each other is products of moments, without a kernel. Distances d
are ``1 - s**2``. As ``s ds`` is ``-dd/2``, integrals over two radii are a quarter of those over
distances. *Deeper* is nearer to the edge, as in `disk`. The solution is refined with a
factorisation of the whole system in double precision, as there.
"""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from spectral_contact.errors import ConvergenceError
from spectral_contact.precise.disk import MOST_SWEEPS, Disk
from spectral_contact.precise.fixed import FixedRule, Ints
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.panels import DiscreteSpace
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.tuning import TAIL_TERMS


class CoupledDisk:
    """What a pressure and a traction do to each other, and the solution for both.

    Parameters
    ----------
    normal, tangential : Disk
        For p, and for ``u = q/s``. Their meshes differ in the endpoint weight alone.
    """

    def __init__(self, normal: Disk, tangential: Disk) -> None:
        self.normal = normal
        self.tangential = tangential
        self.fixed = normal.fixed
        self._own = _own(normal, tangential)
        self._tail = _tail(normal, tangential)
        self._first = [_moments(disk) for disk in (normal, tangential)]
        _, weights, psi = _tail_rule(tangential, np.array([tangential.end], dtype=object))
        self._tail_moments = self.fixed.dot(weights[0], psi[0])
        f = self.fixed
        steps = np.arange(normal.panels.count, dtype=object)
        leads = [f.of(1.0 + disk.panels.power) for disk in (normal, tangential)]
        h = f.of(normal.panels.width)
        #: for each of the two, factors of the moments on every panel over those on the first
        self._falls = [f.exp(-f.times(lead, h) * steps) for lead in leads]

    def solve(self, alpha: Any, beta: Any, kappa: Any) -> tuple[Ints, Ints]:
        """Return the coefficients of p and u for unit approach.

        Parameters
        ----------
        alpha, beta, kappa : int
            In fixed point.

        Raises
        ------
        ConvergenceError
            If refinement stalls before the digits of the mesh are reached.
        """
        f = self.fixed
        mesh = self.normal.mesh
        disks = (self.normal, self.tangential)
        given = [float(f.numbers(v)) for v in (alpha, beta, kappa)]
        parameters = Parameters(given[0], given[1], given[2], inf)
        system = ContactSystem(
            (), (0,), [DiscreteSpace(self.normal.panels, mesh.degrees)], parameters
        )
        factors = factored(system)
        used = self.normal.panels.functions(mesh.degrees)
        weights = f.over(self.normal.weights, f.of(f.mp.pi))
        measures = weights, f.times(weights, self.normal.rest)
        wanted = 2 * f.one, 0
        found = [np.zeros(disk.panels.size, dtype=object) for disk in disks]
        for _ in range(MOST_SWEEPS):
            lifts = self._on_normal(found[1]), self._on_tangential(found[0])
            residuals = []
            for k, compliance in enumerate((alpha, beta)):
                misfit = wanted[k] - disks[k].half_integral(found[k])
                residual = disks[k].moments(f.times(measures[k], misfit))
                residual += f.times(kappa, lifts[k])
                if compliance:
                    residual -= f.times(compliance, disks[k].mass(found[k], bool(k)))
                residuals.append(f.floats(residual)[used])
            step = factors.step(np.concatenate(residuals)[:, None])[:, 0]
            steps = tuple(f.of(one.coefficients(step)) for one in system.fields)
            found = [one + step for one, step in zip(found, steps, strict=True)]
            shares = [
                disk.relative_step(*pair) for disk, *pair in zip(disks, steps, found, strict=True)
            ]
            if max(shares) <= 10.0 ** -(mesh.digits + 2):
                return found[0], found[1]
        raise ConvergenceError(
            f"refinement stalls before {mesh.digits} digits", "ask for fewer digits"
        )

    def _on_normal(self, u: Ints) -> Ints:
        """Return the products of ``int_s^1 eta u(eta) deta`` with all functions of the pressure.

        The integral is of the traction: by kappa times this it lifts the surface.
        """
        f = self.fixed
        (table, tail) = self.normal.split(u)
        result = np.zeros(len(u), dtype=object)
        out, out_tail = self.normal.split(result)
        out_tail[:] = f.dot(self._tail, tail)
        deeper = f.dot(self._tail_moments, tail)
        for j in reversed(range(len(table))):
            of_p, of_u = (fall[j] for fall in self._falls)
            out[j] = f.times(of_p, of_u, f.dot(self._own, table[j]))
            out[j] += f.times(of_p, deeper, self._first[0])
            deeper += f.times(of_u, f.dot(self._first[1], table[j]))
        return result // 4

    def _on_tangential(self, p: Ints) -> Ints:
        """Return the products of g with all functions of the traction.

        With ``g = (1/s) int_0^s p eta deta`` the pressure moves the surface inward by kappa g.
        """
        f = self.fixed
        (table, tail) = self.normal.split(p)
        result = np.zeros(len(p), dtype=object)
        shallower = 0
        out, out_tail = self.normal.split(result)
        for j, row in enumerate(table):
            of_p, of_u = (fall[j] for fall in self._falls)
            out[j] = f.times(of_u, of_p, f.dot(self._own.T, row))
            out[j] += f.times(of_u, shallower, self._first[1])
            shallower += f.times(of_p, f.dot(self._first[0], row))
        out_tail[:] = f.dot(self._tail.T, tail) + f.times(shallower, self._tail_moments)
        return result // 4


def _panel_rule(disk: Disk) -> FixedRule:
    """Return ``x = -ln d``, weights of ``d**power dd``, and polynomials on the first panel."""
    f = disk.fixed
    h = disk.fixed.of(disk.panels.width)
    g, w = f.gauss(disk.rule_points)
    x = f.times(h, f.one + g) // 2
    lead = f.of(1.0 + disk.panels.power)
    weights = f.times(w, h, f.exp(-f.times(lead, x))) // 2
    return FixedRule(x, weights, f.legendre(g, disk.panels.degree))


def _moments(disk: Disk) -> Ints:
    """Return ``int psi dd`` of the functions on the first panel."""
    _, weights, basis = _panel_rule(disk)
    return np.asarray(disk.fixed.dot(weights, basis))


def _own(normal: Disk, tangential: Disk) -> Ints:
    """Return ``int phi(d) int_0^d psi(d') dd' dd`` on the first panel."""
    f = normal.fixed
    h = normal.fixed.of(normal.panels.width)
    x, weights, basis = _panel_rule(normal)
    g, w = f.gauss(tangential.rule_points)
    lead = f.of(1.0 + tangential.panels.power)
    within = []
    for start in x:
        deeper = start + f.times(h - start, f.one + g) // 2
        values = f.times(w, h - start, f.exp(-f.times(lead, deeper))) // 2
        local = 2 * f.over(deeper, h) - f.one
        within.append(f.moments(values, local, tangential.panels.degree))
    return np.asarray(f.dot(f.times(basis, weights[:, None]).T, np.array(within)))


def _tail_rule(disk: Disk, upper: Ints) -> FixedRule:
    """Return points d, weights of ``d**power dd`` from 0 to `upper`, and the tail polynomials."""
    f = disk.fixed
    g, w = f.gauss(2 * TAIL_TERMS + 2)
    v = (f.one + g) // 2
    d = f.times(upper[:, None], v, v)
    # d = upper v^2: the factor v of dd cancels the root of the endpoint weight, if there is one
    power = disk.panels.power
    weights = f.times(w, f.sqrt(upper)[:, None]) if power else f.times(w, v, upper[:, None])
    values = f.legendre(2 * f.over(d, disk.end) - f.one, TAIL_TERMS - 1)
    return FixedRule(d, weights, values)


def _tail(normal: Disk, tangential: Disk) -> Ints:
    """Return ``int phi(d) int_0^d psi(d') dd' dd`` on the tail."""
    f = normal.fixed
    d, weights, phi = _tail_rule(normal, np.array([normal.end], dtype=object))
    _, inner, psi = _tail_rule(tangential, d[0])
    within = np.array([f.dot(v, m) for v, m in zip(inner, psi, strict=True)])
    return np.asarray(f.dot(f.times(phi[0], weights[0][:, None]).T, within))
