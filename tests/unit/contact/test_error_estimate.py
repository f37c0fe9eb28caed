"""How far boundaries may be off, and which zones are certain."""

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.error_estimate import largest_boundary_error
from spectral_contact.fields.series import Radius


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_zone_narrower_than_the_errors_of_its_ends_may_not_be_there(share):
    inner = Radius.from_logit(0.5)
    outer = Radius.from_logit(0.5 + 1e-4)
    width = outer.value**2 - inner.value**2
    expected = 1.0 if share < 0.5 else np.inf
    # d(s^2) is 2 s^2 times the relative error from the centre
    errors = [share * width / (2.0 * radius.value**2) for radius in (inner, outer)]
    assert largest_boundary_error((inner, outer), ((errors[0], 1.0), (errors[1], 1.0))) == expected
    # from the edge it is y times that
    errors = [share * width / radius.rest for radius in (inner, outer)]
    assert largest_boundary_error((inner, outer), ((1.0, errors[0]), (1.0, errors[1]))) == expected


@pytest.mark.parametrize("rtol", [6.7e-4, 1e-3])
def test_boundaries_of_a_narrow_slip_zone_are_within_their_estimates(rtol):
    # the Jacobian changes within the width of the zone
    scene = Scene(0.0984060925, 0.00142439397751, 0.0164693960596, 0.4559430148132268)
    loose = solve(scene, rtol)
    tight = solve(scene, 1e-12)
    assert [zone.kind for zone in loose.zones] == ["stick", "slip", "stick"]
    error = abs(loose.stick_radius / tight.stick_radius - 1.0)
    assert error <= loose.error.stick_radius + tight.error.stick_radius
