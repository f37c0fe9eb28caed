"""Partial slip on any zones in fixed point: one disk in another way, and more zones than occur."""

from itertools import pairwise

import numpy as np
from mpmath.ctx_mp import MPContext

from spectral_contact import Scene, solve
from spectral_contact.fields.series import Radius
from spectral_contact.precise.drive import PreciseDrive
from spectral_contact.precise.fixed import Fixed
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.zone_trial import PreciseLayout, ZoneProblem
from spectral_contact.precise.zones import solve_zones


def test_the_two_ways_to_one_stick_disk_agree():
    """One graded to the rim and refined by Cholesky, one collocated in the odds: no shared step."""
    scene, digits = Scene(0.1, 0.5, 0.5, 0.1), 18
    [boundary] = solve(scene, 1e-9).zones[:-1]
    layout = PreciseLayout((0, 1), (Radius(boundary.outer, boundary.outer_from_edge),))
    run = PreciseRun(scene, digits, 2.0, layout)
    f = run.fixed
    parameters = scene.normal_compliance, scene.tangential_compliance
    friction = f.of(f.mp.mpf(scene.friction) / run.kappa)
    problem = ZoneProblem(run.drive, *parameters, friction, layout, digits, 2.0)
    zones = solve_zones(problem, layout.radii)
    assert abs(zones.logits[0] - run.stick_disk.logit) <= 10.0**-digits
    assert (
        abs(f.mp.mpf(zones.total_shear) / f.mp.mpf(run.stick_disk.total_shear) - 1) <= 10.0**-digits
    )
    c = run.radius[0]
    square, shares = f.of(c * c), [0.01, 0.3, 0.9, 0.999, 1 - 1e-9]
    above = np.array([f.times(square, f.of(share)) for share in shares])
    mine = f.numbers(zones.tractions[0].at(above, square - above)) * c  # q / s, and q / (s / c)
    its = f.numbers(run.stick_disk.traction.at(f.one - f.over(above, square)))
    assert max(abs(mine / its - 1)) <= 10.0**-digits


class Dipped(PreciseDrive):
    """Uniform pressure drives the traction, and another one that dips bounds it in slip."""

    def __init__(self, fixed):
        self.fixed = fixed

    def pressure(self, y, x=None):
        mp = self.fixed.mp
        return self.fixed.map(lambda v: (1 - mp.exp(-20 * (v - mp.mpf("0.6")) ** 2) / 2) / mp.pi, y)

    def load_inside(self, y):
        return self.fixed.over(self.fixed.one - y, 2 * self.fixed.of(self.fixed.mp.pi))


def test_four_zones():
    """No scene is known to have as many: the tangential problem alone, with a made-up bound."""
    fixed, digits, friction = Fixed(240), 12, 0.4
    guess = tuple(Radius(b, 1.0 - b) for b in (0.555809, 0.813785, 0.897012))
    layout = PreciseLayout((0, 1, 0, 1), guess)
    drive = Dipped(fixed)
    zones, check = (
        solve_zones(
            ZoneProblem(drive, 1.0, 1.0, fixed.of(friction), layout, digits + more, width), guess
        )
        for more, width in ((2, 2.0), (0, 1.5))
    )
    assert max(abs(a - b) for a, b in zip(zones.logits, check.logits, strict=True)) <= 1e-12
    mp = MPContext()
    mp.dps = 25
    bounds = [0, *(1 / mp.sqrt(1 + mp.exp(-x)) for x in zones.logits), 1]

    def traction(s):
        zone = max(k for k in range(4) if bounds[k] <= s or k == 0)
        y = fixed.of(np.array([1 - s * s]))
        if zones.tractions[zone] is None:
            return friction * mp.mpf(fixed.numbers(drive.pressure(y)[0]))
        ends = (s - bounds[zone]) * (s + bounds[zone]), (bounds[zone + 1] ** 2 - s * s)
        distances = (fixed.of(np.array([d])) for d in ends)
        return s * mp.mpf(fixed.numbers(zones.tractions[zone].at(*distances)[0]))

    def kernel(eta, s, distance):
        low, high = min(eta, s), max(eta, s)
        return eta * low / (3 * high**2) * mp.elliprd(0, distance * (eta + s) / high**2, 1)

    s = mp.mpf("0.8613")  # in the annulus that sticks
    total = 0
    for sense, ends in ((-1, [*bounds[2::-1]]), (1, bounds[3:])):  # eta = s -+ v^2
        total += mp.quad(
            lambda v, sense=sense: (
                2 * v * traction(s + sense * v * v) * kernel(s + sense * v * v, s, v * v)
            ),
            [0, *(mp.sqrt(sense * (b - s)) * (1 - mp.mpf(10) ** -20) for b in ends)],
        )
    assert abs((traction(s) + total / mp.pi) / (s / (2 * mp.pi)) - 1) <= 1e-11
    shear = sum(mp.quad(lambda r: 2 * mp.pi * traction(r) * r, [a, b]) for a, b in pairwise(bounds))
    assert abs(mp.mpf(fixed.numbers(zones.total_shear)) / shear - 1) <= 1e-11
