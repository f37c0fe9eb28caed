"""Full stick: estimates at the edge, and where the ratio of the fields is largest."""

import math

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.contact.ratio import FullStick
from spectral_contact.fields.series import EDGE, DiskSeries, LogSeries, PressureField
from spectral_contact.spectral.panels import LogPanels


@pytest.mark.parametrize(
    ("alpha", "beta", "rtol"), [(0.5, 0.5, 1e-2), (18.0, 0.59, 1e-2), (1.0, 1.0, 3e-3)]
)
def test_a_loose_solution_is_within_its_estimate_at_the_edge(alpha, beta, rtol):
    scene = Scene(0.1, alpha, beta, math.inf)
    edge = 1e-14
    loose = solve(scene, rtol)
    tight = solve(scene, 1e-12)
    error = abs(loose.traction(from_edge=edge) / tight.traction(from_edge=edge) - 1.0)
    assert error + tight.error.traction <= loose.error.traction


def test_an_inward_traction_has_the_same_error_at_the_edge():
    panels = LogPanels(2, 2.0, 2)
    one = LogSeries(np.ones((1, 1)), np.ones(1), 4.0)
    changes = [(panels, np.array([1e-3, 1e-3]))]
    results = [
        FullStick(0.1, 0.2, 0.0, 0.0, PressureField(None, one), DiskSeries(EDGE, one.times(sign)))
        for sign in (1.0, -1.0)
    ]
    outward, inward = (result.with_ratios(4.0, changes, 1e-4) for result in results)
    assert inward.edge_ratio == -outward.edge_ratio == -1.0
    assert inward.edge_error == outward.edge_error > 1e-4


@pytest.mark.parametrize(("alpha", "beta"), [(0.92, 3.7), (1.3, 10.0), (1.37, 5.0)])
def test_the_largest_ratio_is_found_where_a_loose_space_has_no_panels(alpha, beta):
    scene = Scene(0.0, alpha, beta, math.inf)
    loose = solve(scene, 1e-2)
    tight = solve(scene, 1e-12)
    error = abs(loose.critical_friction / tight.critical_friction - 1.0)
    assert error <= loose.error.critical_friction + tight.error.critical_friction
    assert loose.critical_friction > loose.edge_ratio
