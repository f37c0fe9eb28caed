"""The picture of an adhesion cycle: its axes have the units of its numbers."""

import pytest

from spectral_contact import Scene, adhesion_cycle, profiles

plotting = pytest.importorskip("spectral_contact.plotting")
pytest.importorskip("matplotlib")


def test_units_are_those_of_the_cycle():
    ball = {"profile": profiles.Parabola(1e-6), "load": 0.0}
    body = {"youngs_modulus": 1e9, "poisson_ratio": 0.3, "work_of_adhesion": 0.1}
    cycle = adhesion_cycle(Scene.from_physical(**body, **ball), rtol=1e-4)
    told = [
        plotting.plot_adhesion_cycle(one).axes[0].get_ylabel() for one in (cycle, cycle.in_si())
    ]
    assert told == ["load $P$ [$E'$ m²]", "load $P$ [N]"]
