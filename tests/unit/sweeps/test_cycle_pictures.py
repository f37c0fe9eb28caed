"""Pictures of steady loops: what is drawn, and what is not known is not."""

import numpy as np
from unit.sweeps.test_cycle_result import STEEL, loop

from spectral_contact.view.plotting import save


def test_a_loop_has_two_ways_and_the_slip(tmp_path):
    figure = loop().plot()
    ways, slip = figure.axes
    assert [one.get_label() for one in ways.lines] == ["unloading", "reloading"]
    down, up = (one.get_ydata() for one in ways.lines)
    assert np.isclose(down[0], up[0])
    assert np.isclose(down[-1], up[-1])
    assert (up >= down - 1e-12).all()
    assert slip.lines[0].get_ydata().max() == loop().slip_amplitude(1.0)
    save(figure, tmp_path / "loop.png")
    assert loop(0.2, STEEL).plot().axes


def test_a_way_down_that_is_not_known_is_not_drawn():
    assert [one.get_label() for one in loop(0.005).plot().axes[0].lines] == ["reloading"]
