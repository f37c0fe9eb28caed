"""The bracket of the approach holds the truth, for good and for bad pressures."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, gold, solve
from spectral_contact.equations.bounds import CoupledTraction, approach_bounds
from spectral_contact.fields.series import PressureField
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.spectral.transforms import series_of

#: Digits of `precise.reference`.
TRUE = {
    0.5: 0.292959796910478141398839,
    1e-12: 0.125000000002324317631376,
    1.0: 0.4527013908697527953262,
    1e-3: 0.1256784699526635521037,
}
every_roughness = pytest.mark.parametrize("alpha", TRUE)


@every_roughness
@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-6])
def test_the_bracket_holds_the_truth(alpha, rtol):
    lower, upper = solve(Scene(0.3, alpha), rtol).approach_bounds
    assert lower <= TRUE[alpha] <= upper
    assert upper - lower <= max(1e-10 * rtol, 1e-13) * upper


@pytest.mark.parametrize("alpha", [1e-3, 0.5])
def test_bad_pressures_widen_it_by_the_square_of_their_error(alpha):
    solution = solve(Scene(0.3, alpha), 1e-3)
    field, widths = solution.pressure_field, []
    rng = np.random.default_rng(3)
    for size in (1e-2, 1e-4):
        noise = 1.0 + size * rng.uniform(-1.0, 1.0, field.series.coefficients.shape)
        series = replace(field.series, coefficients=field.series.coefficients * noise)
        lower, upper = approach_bounds(alpha, solution.approach, replace(field, series=series))
        assert lower <= TRUE[alpha] <= upper
        widths.append(upper / lower - 1.0)
    assert widths[0] >= 1e-7
    assert 1e3 <= widths[0] / widths[1] <= 1e5


def width_of_degree(alpha, degree):
    """Return the relative width with one degree on all panels, which reach through the layer."""
    panels = LogPanels(math.ceil((30.0 - math.log(alpha)) / 2.0), 2.0, 10)
    space = unit_space(panels, (degree,) * panels.count)
    unit = space.factor(alpha).solve(2.0)
    approach = 1.0 / (4.0 * math.pi * float(space.constant_moments @ unit[space.index]))
    pressure = PressureField(None, series_of(panels, unit * approach))
    lower, upper = approach_bounds(alpha, approach, pressure)
    return upper / lower - 1.0


def test_the_bracket_closes_with_the_degree():
    widths = [width_of_degree(1e-4, degree) for degree in (1, 2, 3, 4, 5)]
    assert widths == pytest.approx([2.6e-2, 9.4e-5, 2.8e-7, 5.6e-10, 1.3e-12], rel=0.3)


def coupled(alpha=0.5, beta=0.5):
    return Scene(0.1, alpha, beta, math.inf, coupling=True)


def test_with_coupling_the_bracket_holds_the_truth():
    [true] = [s for t in gold.tables() for s in t.solutions if s.scene == coupled()]
    lower, upper = solve(coupled(), 1e-3).approach_bounds
    assert lower <= true.approach <= upper
    assert upper - lower <= 1e-13 * upper


def test_with_coupling_bad_fields_widen_it_by_the_square_of_their_error():
    solution = solve(coupled(), 1e-2)
    rng, true = np.random.default_rng(3), solve(coupled(), 1e-12).approach
    for name in ("pressure", "traction"):
        widths = []
        for size in (1e-2, 1e-4):
            fields = {"pressure": solution.pressure_field, "traction": solution.traction_field}
            series = fields[name].series
            noise = 1.0 + size * rng.uniform(-1.0, 1.0, series.coefficients.shape)
            series = replace(series, coefficients=series.coefficients * noise)
            fields[name] = replace(fields[name], series=series)
            shear = CoupledTraction(0.5, solution.scene.kappa, fields["traction"])
            lower, upper = approach_bounds(0.5, solution.approach, fields["pressure"], shear)
            assert lower <= true <= upper
            widths.append(upper / lower - 1.0)
        assert widths[0] >= 1e-8
        assert 1e3 <= widths[0] / widths[1] <= 1e5


@pytest.mark.parametrize("scene", [coupled(alpha=0.0), coupled(beta=0.0)])
def test_with_coupling_it_takes_both_compliances(scene):
    with pytest.raises(NotComputedError, match="normal and tangential compliance"):
        _ = solve(scene, 1e-4).approach_bounds


def test_a_wrong_scale_does_not_matter():
    solution = solve(Scene(0.3, 0.5), 1e-3)
    right = approach_bounds(0.5, solution.approach, solution.pressure_field)
    lower, upper = approach_bounds(0.5, 1.001 * solution.approach, solution.pressure_field)
    assert lower <= right[0] <= right[1] <= upper


def test_smooth_surfaces_are_known_exactly():
    assert solve(Scene(0.3)).approach_bounds == (0.125, 0.125)


def test_the_pressure_must_have_been_asked_for():
    solution = solve(Scene(0.3, 0.5), quantities=["approach"])
    with pytest.raises(NotComputedError, match="pressure"):
        _ = solution.approach_bounds
