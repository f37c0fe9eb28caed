"""The friction law in words: what obeys it, what is unknown, and where slip is wrong."""

import math

import numpy as np
import pytest

from spectral_contact.contact.friction_law import (
    inf_if_unresolved,
    missing_stick,
    named_violation,
    slip_error_from_boundaries,
)
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.annulus import Annulus
from spectral_contact.spectral.panels import LogPanels


@pytest.mark.parametrize(
    ("excess", "error", "wrong", "slip_error", "expected"),
    [
        (0.0, 0.0, 0.0, 0.0, True),
        (2e-12, 1e-12, 0.0, 0.0, True),  # that of the traction and that of the pressure
        (3e-12, 1e-12, 0.0, 0.0, False),
        (0.0, 1e-12, 2e-10, 1e-10, False),
        (0.0, 1e-12, 2e-10, 3e-10, True),
        (0.0, 1e-12, 0.5e-10, 0.0, True),
    ],
)
def test_the_law_holds_to_the_errors_or_to_rounding(excess, error, wrong, slip_error, expected):
    assert (not named_violation(excess, error, wrong, slip_error)) is expected


def test_no_digit_is_infinite():
    assert (inf_if_unresolved(0.9), inf_if_unresolved(1.1), inf_if_unresolved(math.nan)) == (
        0.9,
        math.inf,
        math.inf,
    )
    assert (slip_error_from_boundaries(0.0), slip_error_from_boundaries(math.inf)) == (
        0.0,
        math.inf,
    )


def test_intervals_of_the_wrong_sense():
    annulus = Annulus(Radius.from_logit(0.0), EDGE, LogPanels(4, 2.0, 4), LogPanels(4, 2.0, 4))
    y = np.concatenate([one.sampling().y for one in annulus.meshes])
    assert missing_stick(annulus, -np.ones(len(y)), 1.0) == ()
    deep = np.sort(y)
    inside = (y >= deep[3]) & (y <= deep[6])
    at_the_edge = y <= deep[1]
    found = missing_stick(annulus, np.where(inside | at_the_edge, 1.0, -1.0), 1.0, 1.0)
    assert found == ((deep[6], deep[3]), (deep[1], 0.0))


def test_at_the_edge_slip_is_looked_at_past_all_samples():
    annulus = Annulus(Radius.from_logit(0.0), EDGE, LogPanels(4, 2.0, 4), LogPanels(4, 2.0, 4))
    y = np.concatenate([one.sampling().y for one in annulus.meshes])
    assert missing_stick(annulus, -np.ones(len(y)), 1.0, 1e-5) == ((y.min(), 0.0),)


def test_inside_what_errors_make_is_no_zone_and_at_the_edge_it_is():
    annulus = Annulus(Radius.from_logit(0.0), EDGE, LogPanels(4, 2.0, 4), LogPanels(4, 2.0, 4))
    y = np.concatenate([one.sampling().y for one in annulus.meshes])
    deep = np.sort(y)
    sample = np.where(((y >= deep[3]) & (y <= deep[6])) | (y <= deep[1]), 1e-3, -1.0)
    assert missing_stick(annulus, sample, 1.0, 1e-3, excused=1e-2) == ((deep[1], 0.0),)
    # rounding of what slips more elsewhere
    assert missing_stick(annulus, sample, 1e8, 1e-3) == ()
