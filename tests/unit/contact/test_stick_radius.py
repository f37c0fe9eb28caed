"""The search for a radius: roots of functions with known ones."""

import math

import pytest

from spectral_contact import Ending, Scene, solve
from spectral_contact.contact.stick_radius import NoStickDiskError, enclosed_root

FUNCTIONS = {
    "line": (lambda x: 2.0 * x + 3.0, -1.5, 2.0),
    "exponential": (lambda x: math.exp(x) - 0.2, math.log(0.2), 0.2),
    "saturating": (lambda x: math.tanh(x) + 0.7, math.atanh(-0.7), 1.0 - 0.49),
    "almost none": (lambda x: 1e-14 - math.exp(-x), 14.0 * math.log(10.0), 1e-14),
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("away", [-0.9, 0.0, 0.4, -20.0])
@pytest.mark.parametrize("error", [1e-5, 1e-13])
def test_a_root_and_its_slope(name, away, error):
    function, root, slope = FUNCTIONS[name]
    found, its_slope = enclosed_root(function, root + away, error)
    assert abs(found - root) <= error + 1e-15 * abs(root)
    assert its_slope == pytest.approx(slope, rel=1e-2)


def test_no_root_is_an_error_that_says_on_which_side():
    with pytest.raises(NoStickDiskError) as above:
        enclosed_root(lambda x: -1.0 + 0.0 * x, 0.0, 1e-5)
    with pytest.raises(NoStickDiskError) as below:
        enclosed_root(lambda x: 1.0 + 0.0 * x, 0.0, 1e-5)
    assert (above.value.at_centre, below.value.at_centre) == (False, True)


def test_a_function_that_only_nears_zero_has_no_root():
    with pytest.raises(NoStickDiskError):
        enclosed_root(lambda x: -math.exp(-x), 11.2, 1e-5)


#: ``1 - c`` at alpha* = 1, beta* = 0.5, nu = 0.3, by `reference` to 20 digits.
NARROW = {
    0.10914739182810274: 2.33094786192146e-9,
    0.10914739290866193: 1.98060598118352e-11,
    0.1091473929184852: 1.84265684462145e-12,
    0.10914739291946753: 1.72284627073148e-13,
}


@pytest.mark.parametrize("friction", NARROW)
@pytest.mark.parametrize("rtol", [1e-6, 1e-10, 1e-12])
def test_slip_that_begins_at_the_edge_is_as_wide_as_the_estimate_allows(friction, rtol):
    found = solve(Scene(0.3, 1.0, 0.5, friction), rtol, ("zones",))
    assert found.converged
    if len(found.zones) == 1:  # a rough space may not tell on which side of the onset it is
        assert (rtol, found.error.zones) == (1e-6, 1.0)
        return
    assert found.error.zones < 0.5
    width = found.zones[-1].inner_from_edge
    assert abs(width / NARROW[friction] - 1.0) <= found.error.zones


@pytest.mark.parametrize(
    "scene",
    [
        Scene(-0.6659276655789166, 1.8751328276289617e-12, 7.4053956977086e-7, 3.278781137646e-60),
        Scene(0.45, 2e-9, 1.1698e-8, 1.0457790202965334e-59),
        Scene(-0.7285895585092464, 0.0, 26.280870036668396, 4.871179186328644e-67),
        Scene(0.3, 0.1, 0.1, 1e-317),
    ],
    ids=["thin layers", "both thin", "smooth", "subnormal"],
)
@pytest.mark.parametrize("rtol", [1e-3, 1e-11])
def test_a_disk_below_all_that_are_looked_for_is_none(scene, rtol):
    """With this little friction all slips; where the stick radius is next to 1e-60 full stick
    was the answer, and called converged.
    """
    solution = solve(scene, rtol, ("stick_radius", "total_shear", "zones"))
    assert solution.converged
    assert solution.stick_radius < 1e-50
    assert solution.total_shear == pytest.approx(scene.friction, rel=1e-14, abs=0.0)


def test_full_stick_is_no_answer_where_friction_bears_far_less(monkeypatch):
    from spectral_contact.contact.zone_search import UncoupledSearch

    monkeypatch.setattr(UncoupledSearch, "_candidates", lambda self: iter(()))
    scene = Scene(0.3, 0.1, 0.1, 0.05)
    solution = solve(scene, 1e-6, strict=False)
    assert solution.ending is Ending.ZONES
    assert not solution.converged
    assert solution.error.violation == pytest.approx(solution.critical_friction / 0.05 - 1.0)


@pytest.mark.parametrize(
    ("scene", "rtol"),
    [
        (Scene(0.486, 2.702e7, 1.0414e7, 9.7912e-11), 1.93e-4),
        (Scene(-0.203, 1.0546e9, 2.138e8, 1.0865e-10), 1.81e-3),
    ],
)
def test_a_radius_is_within_its_estimate_under_huge_compliances(scene, rtol):
    found, truth = solve(scene, rtol), solve(scene, 1e-12)
    assert found.converged
    assert truth.converged
    assert abs(found.stick_radius / truth.stick_radius - 1.0) <= found.error.stick_radius
    assert found.error.stick_radius <= rtol
