"""What the charts of a search say of their coordinates, against differences of points."""

import numpy as np
import pytest

from spectral_contact.equations.interior.charts import Polar, Toroidal
from spectral_contact.fields.series import CENTRE, Radius

STEP = 1e-6
CHARTS = {
    "toroidal": Toroidal(centre=False),
    "at a boundary": Polar(Radius(0.6, 0.4), 0.2),
    "at the centre": Polar(CENTRE, 0.5),
}


@pytest.mark.parametrize("name", CHARTS)
def test_no_unit_of_a_coordinate_is_longer_than_its_scale(name):
    """Errors of the places of extremes are steps of coordinates times the scale."""
    chart = CHARTS[name]
    u, v = (grid.ravel() for grid in np.meshgrid(chart.net[0][1:], chart.net[1][::4]))
    near_enough = u < 12.0  # farther in, differences of distances lose their digits
    u = u[near_enough]
    v = v[near_enough]
    to_edge = chart.points(u, v).to_edge
    scale = np.array([chart.scale(*pair) for pair in zip(u.tolist(), v.tolist(), strict=True)])
    for du, dv in ((STEP, 0.0), (0.0, STEP)):
        ahead = chart.points(u + du, v + dv)
        behind = chart.points(u - du, v - dv)
        moved = np.hypot(ahead.from_edge - behind.from_edge, ahead.z - behind.z)
        unit = moved / (2.0 * STEP) / to_edge
        assert np.all(unit <= scale * (1.0 + 1e-4))
        assert np.all(scale <= np.maximum(2.5 * unit, 1.0))
