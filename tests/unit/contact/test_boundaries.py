"""Newton's method for boundaries, on equations whose roots and slopes are known."""

import numpy as np
import pytest

from spectral_contact.contact.boundaries import (
    NoBoundariesError,
    differences,
    find_boundaries,
    zones_error,
)
from spectral_contact.fields.series import Radius

ROOT = np.array([-0.3, 1.1])


def values(x):
    """Return two conditions with their root, and something that follows them."""
    a, b = x - ROOT
    return np.array([np.sinh(a) + 0.2 * b, np.expm1(0.5 * b) - 0.3 * a * b, 2.0 + a - 3.0 * b])


SLOPES = np.array([[1.0, 0.2], [0.0, 0.5], [1.0, -3.0]])


def find(start, slopes=SLOPES, enough=1e-13, near=True):
    trials = []

    def trial_at(x):
        trials.append(x)
        return x

    found = find_boundaries(trial_at, values, start, slopes, 1e-11, enough, near=near)
    assert found.trial is trials[-1] is found.logits
    return found, len(trials)


def test_differences_are_the_slopes():
    assert np.allclose(differences(values, ROOT), SLOPES, rtol=0, atol=1e-6)


@pytest.mark.parametrize("near", [True, False])
def test_the_root(near):
    found, _ = find(ROOT + np.array([0.1, -0.2]), near=near)
    assert np.abs(found.logits - ROOT).max() < 1e-11
    assert np.allclose(found.slopes, SLOPES, rtol=0, atol=0.2)


def test_far_from_the_root_with_the_slopes_there():
    start = ROOT + np.array([2.0, -1.5])
    found, _ = find(start, differences(values, start), near=False)
    assert np.abs(found.logits - ROOT).max() < 1e-11


def test_what_is_left_is_taken_from_the_slopes():
    found, trials = find(ROOT + np.array([1e-7, 2e-7]), enough=1e-6)
    assert trials == 1
    assert not found.known
    assert not found.good
    assert np.abs(found.logits + found.left - ROOT).max() < 1e-13
    shear = values(found.logits)[2] + found.slopes[2] @ found.left
    assert shear == pytest.approx(values(ROOT)[2], abs=1e-13)


def test_slopes_are_learnt_from_the_steps():
    wrong = SLOPES + 0.1 * np.array([[1.0, -1.0], [0.5, 1.0], [1.0, 1.0]])
    found, _ = find(ROOT + np.array([1e-3, -2e-3]), wrong, enough=1e-5)
    assert found.known
    assert found.good
    assert np.abs(found.slopes - SLOPES).max() < 0.02
    # with the right ones there is but one step, and one direction
    found, _ = find(ROOT + np.array([1e-3, -2e-3]), enough=1e-5)
    assert not found.known
    assert np.abs(found.slopes - SLOPES).max() < 0.02


def test_wrong_slopes_from_near_by_are_noticed():
    with pytest.raises(NoBoundariesError):
        find(ROOT + np.array([0.1, 0.1]), -SLOPES)


def test_rounding_does_not_shrink_and_is_no_reason_to_stop():
    noise = np.random.default_rng(0)

    def noisy(x):
        return values(x) + 1e-10 * noise.normal(size=3)

    found = find_boundaries(lambda x: x, noisy, ROOT + 1e-3, SLOPES, 1e-11, 1e-13, near=True)
    assert np.abs(found.logits - ROOT).max() < 1e-8


def test_boundaries_stay_in_order():
    seen = []

    def trial_at(x):
        seen.append(x)
        return x

    # the first step would put the inner boundary beyond the outer one
    flat = SLOPES * np.array([[0.05], [1.0], [1.0]])
    find_boundaries(trial_at, values, ROOT - np.array([1.0, 0.0]), flat, 1e-11, 1e-13, near=False)
    assert all(np.diff(x) > 0.0 for x in seen)


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_zone_narrower_than_the_errors_of_its_ends_may_not_be_there(share):
    inner, outer = Radius.from_logit(0.5), Radius.from_logit(0.5 + 1e-4)
    width = outer.value**2 - inner.value**2
    # d(s^2) is 2 s^2 times the relative error from the centre
    own = [share * width / (2.0 * one.value**2) for one in (inner, outer)]
    found = zones_error((inner, outer), ((own[0], 1.0), (own[1], 1.0)))
    assert found == (1.0 if share < 0.5 else np.inf)
    # from the edge it is y times that
    own = [share * width / one.rest for one in (inner, outer)]
    found = zones_error((inner, outer), ((1.0, own[0]), (1.0, own[1])))
    assert found == (1.0 if share < 0.5 else np.inf)
