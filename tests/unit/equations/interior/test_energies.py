"""Energies below the largest load."""

import pytest

from spectral_contact import NotComputedError, Scene, solve


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
