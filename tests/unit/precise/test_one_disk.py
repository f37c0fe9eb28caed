"""One stick disk in fixed point: the stick radius where the traction is steep at its rim."""

import pytest

from spectral_contact import Scene
from spectral_contact.fields.series import Radius
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.zone_trial import PreciseLayout


@pytest.mark.parametrize(
    ("scene", "logit"),
    [
        (Scene(0.3, friction=0.25), 0.98),
        (Scene(0.3, 0.5, 1e-14, 0.1428), -2.343190589862708),
    ],
)
def test_friction_suffices_next_to_a_rim_of_little_compliance(scene, logit):
    """The traction feels an error of the radius like its root, or its share of the compliance."""
    guess = PreciseLayout((0, 1), (Radius.from_logit(logit),))
    assert PreciseRun(scene, 10, 2.0, guess).breaches() == []
