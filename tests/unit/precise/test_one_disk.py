"""One stick disk in fixed point: the stick radius where the traction has a root at its rim."""

from spectral_contact import Scene
from spectral_contact.fields.series import Radius
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.zone_trial import PreciseLayout


def test_friction_suffices_next_to_a_rim_without_compliance():
    """An error of the radius is felt like its root there: it has to be far below the digits."""
    guess = PreciseLayout((0, 1), (Radius.from_logit(0.98),))
    assert PreciseRun(Scene(0.3, friction=0.25), 10, 2.0, guess).breaches() == []
