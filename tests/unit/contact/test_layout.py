"""Zones that follow from where slip around one disk has the wrong sense."""

import math

from spectral_contact.contact.layout import Layout
from spectral_contact.fields.series import Radius

DISK = Layout((1.0,), (0, 1))


def rests(layout):
    return [Radius.from_logit(logit).rest for logit in layout.logits]


def test_slip_of_the_wrong_sense_sticks():
    layout = DISK.with_stick(((0.2, 0.1), (1e-3, 0.0)))
    assert layout.states == (0, 1, 0, 1, 0)
    expected = [1.0 / (1.0 + math.e), 0.2, 0.1, 1e-3]
    assert all(abs(a / b - 1.0) < 1e-14 for a, b in zip(rests(layout), expected, strict=True))


def test_what_is_empty_or_not_outside_the_disk_is_left_out():
    tiny = Layout((-40.0,), (0, 1))
    assert DISK.with_stick(((0.9, 0.5), (0.1, 0.1))) == DISK
    assert tiny.with_stick(((1.0, 0.5),)) == tiny


def test_stick_that_crosses_a_zone_on_its_way_to_the_edge_is_left_out():
    # slip from y = 0.27 to 0.018, stick and slip beyond it
    layout = Layout((1.0, 4.0, 5.0), (0, 1, 0, 1))
    assert layout.with_stick(((0.1, 0.0),)) == layout
    assert layout.with_stick(((1e-3, 0.0),)).states == (0, 1, 0, 1, 0)
