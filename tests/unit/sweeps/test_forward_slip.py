"""Whether the surface goes on to slip forward: the room for a traction at the largest load."""

import math

import numpy as np
import pytest
from unit.sweeps.test_cycle_result import loop

from spectral_contact.sweeps.forward_slip import (
    admissible_tractions,
    forward_slack,
    slack_rounding,
)


def test_there_is_room_down_to_some_lowest_load():
    found, low = loop(0.1), loop(0.005)
    assert forward_slack(found.states, 0.1) == pytest.approx(0.0, abs=slack_rounding(found.states))
    assert forward_slack(low.states, 0.1) == low.slack < -slack_rounding(low.states)


def test_a_loop_that_goes_lower_leaves_less_room():
    shallow, deep = loop(0.21), loop(0.1)
    from_edge = np.linspace(0.05, 0.95, 30)
    limit = 0.1 * shallow.solution.pressure(from_edge=from_edge)
    low, high = admissible_tractions(shallow.states, 0.1, limit, from_edge)
    inner = admissible_tractions(deep.states, 0.1, limit, from_edge)
    assert (low < high).all()
    assert (high <= limit).all()
    assert (inner[0] >= low - 1e-3 * limit).all()
    assert (inner[1] <= high + 1e-3 * limit).all()


@pytest.mark.parametrize(("friction", "room"), [(0.0, 0.0), (math.inf, 2.0)])
def test_without_slip_or_friction_there_is_room(friction, room):
    assert forward_slack(loop().states, friction) == room
