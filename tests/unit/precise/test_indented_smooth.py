"""Contacts whose edge, or whose point in question, is at a break of the profile."""

import mpmath as mp
import pytest

from spectral_contact import closed_forms, profiles
from spectral_contact.precise.indented_smooth import SmoothIndented


@pytest.fixture
def context():
    found = mp.mp.clone()
    found.dps = 32
    return found


def test_an_edge_at_a_break(context):
    inner, outer = profiles.RoundedFlat(0.5, 1.0), profiles.RoundedFlat(1.0, 1.0)
    contact = SmoothIndented(context, profiles.Sum(inner, outer), 1.0)
    truth = closed_forms.rounded_flat_contact(1.0, 0.5, 1.0)
    assert float(contact.load) == pytest.approx(truth.load, rel=1e-14)
    assert float(contact.growth) > 0.0


def test_a_break_without_a_corner_has_a_finite_pressure(context):
    flat = profiles.RoundedFlat(0.5, 1.0)
    contact = SmoothIndented(context, profiles.Sum(profiles.Parabola(1.0), flat), 1.0)
    half = [context.mpf(0.5)]
    alone = SmoothIndented(context, flat, 1.0).pressures(half, half)[0]
    hertz = 8 / context.pi * context.sqrt(context.mpf(3) / 4)
    assert abs(contact.pressures(half, half)[0] - alone - hertz) < 1e-26
    corner = SmoothIndented(context, profiles.TruncatedCone(0.5, 1.0), 1.0)
    assert corner.pressures(half, half)[0] == context.inf


@pytest.mark.parametrize("past", [1e-12, 1e-6])
def test_a_contact_that_just_exceeds_its_flat_part_has_its_digits(context, past):
    contact = SmoothIndented(context, profiles.RoundedFlat(1.0, 1.0), 1.0 + past)
    with mp.workdps(100):
        a = mp.mpf(1.0 + past)
        angle = mp.acos(1 / a)
        truth = a**2 * (mp.sin(angle) - angle * mp.cos(angle))
        assert abs(contact.approach / truth - 1) < 1e-24
