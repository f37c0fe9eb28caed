"""How a certificate comes about: the last digit promised, and the comparison of two meshes."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from spectral_contact import ConvergenceError, NotComputedError, Scene, gold, layers, profiles
from spectral_contact.precise import certified, reference
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.zone_trial import PreciseLayout
from spectral_contact.records import ErrorEstimates, Zone


def test_approach_and_shear_are_those_of_the_gold_tables_to_their_last_digits():
    """Both are energies: fields to 13 digits give them to 26."""
    [true] = [
        solution
        for table in gold.tables()
        for solution in table.solutions
        if solution.name == "nu=0.1 alpha=0.5 beta=0.5 f=inf"
    ]
    run = PreciseRun(true.scene, 14, 2.0, PreciseLayout((0,), ()))
    assert abs(run.approach / true.approach - 1) <= 1e-26
    assert abs(run.total_shear / true.total_shear - 1) <= 1e-26


@pytest.fixture
def second_mesh_off(monkeypatch):
    """Return a function that makes the approach of the second mesh wrong by a share."""

    def off(share):
        runs, own = [], PreciseRun.approach.fget

        def approach(run):
            if run not in runs:
                runs.append(run)
            value = own(run)
            return value + value * share * runs.index(run)

        monkeypatch.setattr(PreciseRun, "approach", property(approach))

    return off


def test_twice_the_difference_of_two_meshes_is_the_estimate(second_mesh_off):
    second_mesh_off(2.0**-54)
    solution = reference(Scene(0.3), 15)
    assert solution.approach == 0.125
    assert solution.error.approach == pytest.approx(2.0**-53, rel=1e-3, abs=0)


def test_digits_that_are_not_reached_are_not_certified(second_mesh_off):
    second_mesh_off(1e-12)
    with pytest.raises(ConvergenceError, match=r"2\.0e-12 does not meet 15 digits") as caught:
        reference(Scene(0.3), 15)
    assert not caught.value.solution.converged
    assert caught.value.solution.error.approach == pytest.approx(2e-12, rel=1e-3, abs=0)
    assert math.isfinite(caught.value.solution.approach)


def test_nothing_is_promised_beyond_what_the_check_aims_at():
    """Where both meshes have the closed form they agree in all digits."""
    solution = reference(Scene(0.3), 15)
    assert solution.approach == 0.125
    assert 1e-18 <= solution.error.approach <= 1e-16


def doubles(*zones):
    """Return a stand-in for `solve`, which finds these zones and no digit of them."""
    found = SimpleNamespace(
        zones=zones,
        error=ErrorEstimates(zones=math.inf),
        traction=lambda from_edge: np.ones(len(from_edge)),
    )
    return lambda *_, **__: found


def test_a_guess_of_a_narrow_slip_zone_without_digits_will_do():
    """On a smooth surface slip never vanishes: a trial at a wrong radius says where it is."""
    scene, edge = Scene(0.3, friction=8.6), 1e-41
    solve = doubles(Zone("stick", 0.0, 1.0, 1.0, edge), Zone("slip", 1.0, 1.0, edge, 0.0))
    layout = certified._layout(scene, solve)
    assert layout.states == (0, 1)
    assert [radius.from_edge for radius in layout.radii] == [edge]
    with pytest.raises(NotComputedError, match="does not resolve"):
        certified._layout(scene, doubles(Zone("stick", 0.0, 1.0, 1.0, 0.0)))


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_the_edge_ratio_of_an_incompressible_body_is_zero(friction):
    """As that of `solve` is: all of it sticks, and has no traction."""
    assert reference(Scene(0.5, friction=friction), 15).edge_ratio == 0


@pytest.mark.parametrize("unit", [1e12, 1e-14])
def test_the_domain_without_an_edge_does_not_depend_on_the_unit_of_length(unit):
    def domain(unit):
        """In this unit, of a law that is exponential in its overclosure."""
        layer, profile = layers.CalculixExponential(1.0, 0.1 * unit), profiles.Parabola(unit)
        scene = Scene(0.3, layer=layer, profile=profile, load=unit**2)
        return certified._domain(scene, 0.3 * unit, 0.2 * unit, 15) / unit

    assert domain(unit) == pytest.approx(domain(1.0), rel=1e-9)


@pytest.mark.parametrize(
    ("poisson_ratio", "friction", "kind"),
    [(0.3, 0.0, "slip"), (0.5, math.inf, "stick")],
)
def test_a_profile_without_traction_has_one_zone_as_a_flat_punch_has(poisson_ratio, friction, kind):
    flat = Scene(poisson_ratio, friction=friction)
    scene = flat.replace(profile=profiles.Parabola(1.0), contact_radius=1.0)
    pressed, other = reference(scene, 15), reference(flat, 15)
    assert [zone.kind for zone in pressed.zones] == [kind]
    assert pressed.zones == other.zones
    assert pressed.stick_radius == other.stick_radius
    assert pressed.edge_ratio == other.edge_ratio
    assert pressed.total_shear == pressed.traction(0.5) == 0
