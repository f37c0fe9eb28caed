"""Fields below a contact by independent integrals, for tests.

`stuck` and `bonded` have the half-integrals of a smooth contact, stuck all over, without and with
coupling, in closed form, and integrate elementary complex functions over them in mpmath, at any
depth. `hankel` integrates the
loads of any solution times Bessel functions, twice, at depths that are not small. `ring` adds up
the point forces of Boussinesq and Cerruti along a ring of load, in mpmath, at any distance; and
`over_rings` integrates the library's rings, once they are met, by doubly exponential quadrature.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import mpmath as mp
import numpy as np
from scipy.special import j0, j1

from spectral_contact.equations.interior import ring_loads


class Fields(NamedTuple):
    """Stresses and displacements, as the library's results name them."""

    rr: float
    tt: float
    zz: float
    rz: float
    out: float
    down: float


def assemble(nu, r, loads):
    """Return the fields from the integrals, by name, of the two transforms.

    `loads` holds pairs (of A, of B) of the integrals of ``A exp(-k z) J_n k**l``: keys (n, l),
    and (n, l, "z") with a further factor k z.
    """

    def both(key, of_a, of_b):
        a, b = loads[key]
        return of_a * a + of_b * b

    zz = both((0, 1), -1, 0) + both((0, 1, "z"), -1, 1)
    rz = both((1, 1), 0, -1) + both((1, 1, "z"), -1, 1)
    out = both((1, 0), -(1 - 2 * nu), 2 * (1 - nu)) + both((1, 0, "z"), 1, -1)
    down = both((0, 0), 2 * (1 - nu), -(1 - 2 * nu)) + both((0, 0, "z"), 1, -1)
    slope = both((0, 1), -(1 - 2 * nu), 2 * (1 - nu)) + both((0, 1, "z"), 1, -1) - out / r
    dilation = 2 * nu * both((0, 1), 1, -1)
    shear = 4 * (1 - nu)
    return Fields(slope - dilation, out / r - dilation, zz, rz, out / shear, down / shear)


def _elementary(r, z, t) -> dict[tuple, mp.mpc]:
    """Return ``int exp(-k (z + i t)) J_n k**l dk``, times k z where the key says so."""
    depth = mp.mpc(z, t)
    root = mp.sqrt(r**2 + depth**2)
    return {
        (0, -1): -mp.log(depth + root),
        (0, 0): 1 / root,
        (0, 1): depth / root**3,
        (0, 2): (2 * depth**2 - r**2) / root**5,
        (1, -1): r / (root + depth),
        (1, 0): r / (root * (root + depth)),
        (1, 1): r / root**3,
        (1, 2): 3 * r * depth / root**5,
    }


_RULE = mp.calculus.quadrature.GaussLegendre(mp.mp).calc_nodes(4, 110)
_KEYS = [(n, power) for n in (0, 1) for power in (0, 1)]


def _parts(r, z, t, lower: int, take: Callable[[mp.mpc], mp.mpf]) -> dict[tuple, mp.mpf]:
    table = _elementary(r, z, t)
    parts = {(n, power): take(table[n, power - lower]) for n, power in _KEYS}
    return parts | {(n, power, "z"): z * take(table[n, power + 1 - lower]) for n, power in _KEYS}


def stuck(nu: float, r: float, z: float, from_edge: float | None = None) -> Fields:
    """Return the fields of a smooth contact that is stuck all over, without coupling.

    ``F = 1/4``, so that ``A = sin k / (2 pi k)``, and ``t G = (kappa/pi) artanh t``.
    """
    with mp.workdps(30):
        radius = mp.mpf(r) if from_edge is None else 1 - mp.mpf(from_edge)
        nu, z = mp.mpf(nu), mp.mpf(z)
        kappa = (1 - 2 * nu) / (4 * (1 - nu))
        normal = _parts(radius, z, mp.mpf(1), 1, lambda value: -mp.im(value) / (2 * mp.pi))
        shear = _over_t(radius, z, lambda rest: kappa / mp.pi * mp.log((2 - rest) / rest) / 2, 1)
        loads = {key: (normal[key], shear[key]) for key in normal}
        return Fields(*(float(value) for value in assemble(nu, radius, loads)))


def bonded(nu: float, r: float, z: float, from_edge: float | None = None) -> Fields:
    """Return the fields of a smooth bonded punch, with coupling, at any place but the contact.

    The half-integrals are ``A cos`` and ``A sin`` of ``theta ln((1 + t)/(1 - t))`` (Mossakovskii).
    """
    with mp.workdps(30):
        radius = mp.mpf(r) if from_edge is None else 1 - mp.mpf(from_edge)
        nu, z = mp.mpf(nu), mp.mpf(z)
        theta = mp.log(3 - 4 * nu) / (2 * mp.pi)
        size = mp.sinh(mp.pi * theta) / (4 * mp.pi * theta)

        def wave(of):
            return lambda rest: size * of(theta * mp.log((2 - rest) / rest))

        of_a, of_b = (_over_t(radius, z, wave(of), k) for k, of in enumerate((mp.cos, mp.sin)))
        loads = {key: (of_a[key], of_b[key]) for key in of_a}
        return Fields(*(float(value) for value in assemble(nu, radius, loads)))


def _over_t(radius, z, half_integral, odd) -> dict[tuple, mp.mpf]:
    """Integrate over t with Gauss's rule on panels graded to the edge and to the point.

    The half-integral is that of pressure, which is even in t, or of traction times t.
    """
    take = (lambda value: -mp.im(value)) if odd else mp.re
    here = 1 - radius
    places = {mp.mpf(0), mp.mpf(1), here}
    for step in range(-44, 1):
        distance = mp.mpf(10) ** (mp.mpf(step) / 2)
        places |= {distance, here + distance, here - distance}
    ends = sorted(place for place in places if 0 <= place <= 1)
    total: dict[tuple, mp.mpf] = {}
    for low, high in pairwise(ends):
        for node, weight in _RULE:
            rest = low + (high - low) * (1 + node) / 2  # 1 - t, which may be tiny
            share = weight * (high - low) / 2 * half_integral(rest)
            parts = _parts(radius, z, 1 - rest, 0, take)
            for key, value in parts.items():
                total[key] = total.get(key, 0) + share * value
    return {key: 2 / mp.pi * value for key, value in total.items()}


def hankel(solution, r: float, z: float) -> Fields:
    """Return the fields of any solution from Bessel functions; `z` should not be below 0.1."""
    s, from_edge, weight = _over_contact(solution)
    pressure = solution.pressure(from_edge=from_edge) * s * weight
    traction = solution.traction(from_edge=from_edge) * s * weight
    k, dk = _gauss(np.linspace(0.0, 42.0 / z, int(42.0 / z / 2.5) + 6), 14)
    a = np.concatenate([j0(part[:, None] * s) @ pressure for part in np.array_split(k, 20)])
    b = np.concatenate([j1(part[:, None] * s) @ traction for part in np.array_split(k, 20)])
    loads = {}
    for n, bessel in ((0, j0), (1, j1)):
        for power in (0, 1):
            kernel = np.exp(-k * z) * bessel(k * r) * k**power * dk
            loads[n, power] = (kernel @ a, kernel @ b)
            loads[n, power, "z"] = ((kernel * k * z) @ a, (kernel * k * z) @ b)
    return Fields(*(float(value) for value in assemble(solution.scene.poisson_ratio, r, loads)))


def _gauss(ends, order):
    nodes, weights = np.polynomial.legendre.leggauss(order)
    half, middle = np.diff(ends)[:, None] / 2, (ends[1:] + ends[:-1])[:, None] / 2
    return (middle + half * nodes).ravel(), (half * weights).ravel()


def _over_contact(solution):
    """Return nodes graded to every boundary, from both sides, and to the edge."""
    inner = {zone.outer_from_edge for zone in solution.zones if zone.outer_from_edge > 0.0}
    boundaries = sorted({1.0, 0.0, *inner, *_breaks(solution)}, reverse=True)
    ends = set(boundaries)
    for outer, one in pairwise(boundaries):
        half = (outer - one) / 2.0
        steps = half * 0.4 ** np.arange(90 if one == 0.0 else 36)
        ends |= set(one + steps) | set(np.linspace(one, outer, 25)[1:-1])
        ends |= set(outer - steps[:36])
    from_edge, weight = _gauss(np.array(sorted(ends)), 14)
    return 1.0 - from_edge, from_edge, weight


def ring(nu, r, z, s, ahead):
    """Return zz, rz, ``2 G u_r / r``, e and ``2 G u_z`` of unit rings of pressure and of traction.

    `ahead` is ``r - s``. The first five are of pressure; e is a part of the trace of the stress.
    """
    with mp.workdps(25):
        nu, r, z, ahead = (mp.mpf(one) for one in (nu, r, z, ahead))
        s = r - ahead
        scale = mp.hypot(ahead, z) / max(r, s)
        places = [scale * mp.mpf(10) ** k for k in range(18)]
        ends = [mp.mpf(0), *(one for one in places if one < 3), mp.pi]
        terms = [lambda phi, k=k: _point_forces(nu, r, z, s, ahead, phi)[k] for k in range(10)]
        values = [mp.quad(term, ends) / mp.pi for term in terms]
        return np.array([float(value) for value in values]).reshape(2, 5)


def _point_forces(nu, r, z, s, ahead, phi):
    """Return the fields of a normal and of a radial point force, each over ``1 / (2 pi)``."""
    half = 2 * mp.sin(phi / 2) ** 2  # 1 - cos phi
    x, y = ahead - r * half, -r * mp.sin(phi)  # from the force, along it and across
    across = ahead + s * half  # from the force along r
    distance = mp.sqrt(ahead**2 + 2 * r * s * half + z**2)
    deep = distance + z
    low = 1 - 2 * nu
    cube = distance**3
    flat = z / cube - low / (distance * deep)
    normal = (
        -3 * z**3 / distance**5,
        -3 * z**2 * across / distance**5,
        across * flat / r,
        z / cube,
        z**2 / cube + 2 * (1 - nu) / distance,
    )
    along = 1 / distance + x**2 / cube + low * (1 / deep - x**2 / (distance * deep**2))
    aside = x * y * (1 / cube - low / (distance * deep**2))
    turn = mp.cos(phi), mp.sin(phi)
    radial = (
        -3 * x * z**2 / distance**5,
        -3 * x * z / distance**5 * (x * turn[0] - y * turn[1]),
        (along * turn[0] - aside * turn[1]) / r,
        x / cube,
        x * z / cube + low * x / (distance * deep),
    )
    return (*normal, *radial)


def over_rings(solution, from_edge, z, count=1500):
    """Return the fields of any solution at any point off the surface, and how well they are known.

    The second is the change of each when every second node is left out, and what the rounding of
    the radius of a break of the profile may do on a smooth surface.
    """
    nu, r = solution.scene.poisson_ratio, 1.0 - from_edge
    inner = {(zone.outer_from_edge, zone.outer) for zone in solution.zones}
    inner |= {(one, 1.0 - one) for one in _breaks(solution)}
    ends = {(0.0, 1.0), (1.0, 0.0), *(one for one in inner if 0.0 < one[0] < 1.0)}
    ends = sorted(ends | {(from_edge, r)}) if 0.0 < from_edge < 1.0 else sorted(ends)
    t = np.linspace(-4.3, 4.3, 2 * count + 1)
    step = 4.3 / count
    low, high = (1.0 / (1.0 + np.exp(sign * np.pi * np.sinh(t))) for sign in (-1.0, 1.0))
    slope = np.pi * np.cosh(t) * low * high
    sums = np.zeros((2, 5))
    for first, last in pairwise(ends):
        length = last[0] - first[0] if first[1] > 0.5 else first[1] - last[1]
        d, s = first[0] + length * low, last[1] + length * high
        # from the end that is closer to the point, next to which the difference is exact
        before, behind = (one[0] - from_edge if r > 0.5 else r - one[1] for one in (first, last))
        ahead = before + length * low if abs(before) < abs(behind) else behind - length * high
        near = np.where((s > 0.0) & (d > 0.0), 1.0, 0.0)
        s, d = np.maximum(s, 1e-300), np.maximum(d, 1e-300)
        g = ring_loads.geometry(np.full_like(s, r), np.full_like(s, z), s, ahead)
        five = [
            np.array([*of_stress(g, nu), of_displacement(g, nu)[0]])
            for of_stress, of_displacement in (
                (ring_loads.normal_stress, ring_loads.normal_displacement),
                (ring_loads.radial_stress, ring_loads.radial_displacement),
            )
        ]
        loads = solution.pressure_field, solution.traction_field
        loads = [np.zeros(len(s)) if load is None else load(s, d) for load in loads]
        loads = [np.where(np.isfinite(load), load, 0.0) for load in loads]  # at a break
        for kernel, load in zip(five, loads, strict=True):
            terms = kernel * (load * s * slope * near * length * step)
            sums += np.array([terms.sum(axis=1), 2.0 * terms[:, ::2].sum(axis=1)])
    size = 1.0 if solution.scene.profile is None else solution.contact_radius
    fields = [_fields(nu, r, *one) for one in sums]
    fields = [one._replace(out=size * one.out, down=size * one.down) for one in fields]
    doubt = 0.0
    if solution.scene.normal_compliance == 0.0:  # the pressure may be infinite at a break
        doubt = sum(1e-16 / np.hypot(one - from_edge, z) for one in _breaks(solution))
    return fields[0], Fields(*np.abs(np.subtract(*fields)) + doubt * np.abs(fields[0][:4]).max())


def _breaks(solution):
    """Return how far from the edge the breaks of the profile are."""
    profile = solution.scene.profile
    if profile is None:
        return []
    a = solution.contact_radius
    return [(a - b) / a for b in profile.breaks if b < a]


def _fields(nu, r, zz, rz, hoop, harmonic, down):
    tt = hoop - 2 * nu * harmonic
    shear = 4 * (1 - nu)
    return Fields(-2 * harmonic - zz - hoop, tt, zz, rz, r * hoop / shear, down / shear)
