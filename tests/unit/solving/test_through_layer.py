"""Contacts through a nonlinear layer whose radius is found."""

import pytest

from spectral_contact import Scene, layers, profiles, solve
from spectral_contact.contact.layered_newton import LayeredNewton

#: A law that is steep at first, with two bends inside the contact.
OVERCLOSURES = (-0.122, -0.12, -0.1108, 0.488)
PRESSURES = (0.0, 0.714, 1.048, 28.29)


@pytest.fixture
def corrections(monkeypatch):
    """Return a list that takes the size of every linear system of Newton's method."""
    sizes = []
    linear_step = LayeredNewton._linear_step

    def counted(self, *arguments):
        sizes.append(len(arguments[-1]))
        return linear_step(self, *arguments)

    monkeypatch.setattr(LayeredNewton, "_linear_step", counted)
    return sizes


def test_newton_begins_at_the_contact_of_the_radius_before(corrections):
    """Each radius by itself, from the pressure of every point alone, took 60 corrections."""
    scene = Scene(
        0.3,
        layer=layers.Table(OVERCLOSURES, PRESSURES),
        profile=profiles.Parabola(1.0),
        load=3.54,
    )
    solution = solve(scene, 1e-6, ("approach",))
    assert solution.converged
    assert len(corrections) < 50
