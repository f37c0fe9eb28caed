"""Energies below the largest load, and in SI units under a profile."""

import pytest

from spectral_contact import NotComputedError, Scene, profiles, solve


@pytest.mark.parametrize("scene", [Scene(0.3, 0.5), Scene(0.3, 0.5, 0.5, 1.0)])
def test_without_slip_energies_fall_with_the_square_of_the_load(scene):
    whole = solve(scene, 1e-9).inside.energies(progress=False)
    part = solve(scene.replace(unloaded_to=0.7), 1e-9).inside.energies(progress=False)
    for name in ("external", "strain", "layer", "friction", "defect"):
        share = 0.7**2 * getattr(whole, name)
        assert getattr(part, name) == pytest.approx(share, rel=1e-11, abs=0.0)
    assert abs(part.balance) <= part.error * part.external


def test_after_slip_energies_are_refused_below_the_largest_load():
    body = solve(Scene(0.3, 0.5, 0.5, 0.05, unloaded_to=0.9), 1e-6).inside
    with pytest.raises(NotComputedError, match="after slip"):
        body.energies(progress=False)


def test_under_a_profile_energies_in_joules_are_the_work_of_the_load():
    """They were wrong by the square of the contact radius in metres."""
    scene = Scene.from_physical(
        youngs_modulus=70e9,
        poisson_ratio=0.2,
        profile=profiles.Parabola(0.01),
        load=5.0,
        normal_compliance=1e-17,
    )
    found = solve(scene, 1e-9).physical
    energies = found.inside.energies(progress=False)
    assert energies.external == pytest.approx(found.indentation_work, rel=1e-13)
    assert energies.strain + energies.layer == pytest.approx(found.indentation_work, rel=1e-8)
