"""Radii are taken exactly, whatever type and however many digits they have."""

import math
from fractions import Fraction

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext

from spectral_contact import Scene, SceneError, profiles
from spectral_contact.precise import reference
from spectral_contact.precise.indented_smooth import SmoothIndented


@pytest.fixture(scope="module")
def smooth():
    return reference(Scene(0.3, friction=math.inf), 15)


def context():
    mp = MPContext()
    mp.dps = 60
    return mp


def test_radii_with_more_digits_than_the_solution_keep_their_distance_to_the_edge(smooth):
    mp = context()
    s = 1 - mp.mpf(10) ** -40
    exact = 1 / (2 * mp.pi * mp.sqrt(1 - s * s))
    for radius in (s, 1 - Fraction(1, 10**40)):
        assert abs(smooth.pressure(radius) / exact - 1) <= 1e-15
    with pytest.raises(SceneError, match=r"in \[0, 1\]"):
        smooth.pressure(1 + mp.mpf(10) ** -40)


@pytest.mark.parametrize("kind", [float, np.float32, np.longdouble, Fraction])
def test_numbers_of_every_type_are_exact(smooth, kind):
    assert smooth.pressure(kind(1)) == smooth.pressure(np.int8(1)) == math.inf
    assert smooth.pressure(kind(1) / 4) == smooth.pressure(0.25)


def test_pressures_next_to_a_corner_have_their_digits():
    punch = profiles.TruncatedCone(0.5, 1.0)
    found = reference(Scene(0.3, profile=punch, contact_radius=0.7), 15)
    mp = context()
    contact = SmoothIndented(mp, punch, 0.7)
    for past in (1e-12, 1e-6, -1e-6):
        s = mp.mpf(0.5 / 0.7 * (1 + past))
        [truth] = contact.pressures([s], [1 - s])
        assert abs(mp.mpf(found.pressure(s)) / truth - 1) <= found.error.pressure
