"""Zones in fixed point: the tractions are continuous to the digits that the friction law needs."""

import numpy as np

from spectral_contact import Scene
from spectral_contact.fields.series import Radius
from spectral_contact.precise import precise_run, zones
from spectral_contact.precise.zone_trial import PreciseLayout


def test_tractions_are_continuous_under_little_compliance(monkeypatch):
    """They feel an error of the boundaries many times: both have to be below the digits."""
    left = []

    class Trial(zones.ZoneTrial):
        def outcome(self, flat, slopes=None):
            left.append(np.abs(self.problem.drive.fixed.floats(self.mismatch(flat))).max())
            return super().outcome(flat, slopes)

    monkeypatch.setattr(zones, "ZoneTrial", Trial)
    guesses = Radius(0.8531187812413729, 0.14688121875862717), Radius(1.0, 1.4488742911024438e-27)
    scene, digits = Scene(0.3, 0.0, 1e-14, 0.25), 10
    run = precise_run.PreciseRun(scene, digits, 2.0, PreciseLayout((0, 1, 0), guesses))
    assert len(run.logits) == 2
    assert left[-1] <= 10.0**-digits
