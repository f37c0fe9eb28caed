"""The picture of a layer's law marks what the contact makes use of."""

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, SceneError, layers, profiles, solve

plotting = pytest.importorskip("spectral_contact.view.plotting")
pytest.importorskip("matplotlib", reason="part of the extra: plot")

BALL = profiles.Parabola(1.0)
STEEL = {"youngs_modulus": 200e9, "poisson_ratio": 0.3}


@pytest.mark.parametrize(
    "scene",
    [
        Scene(0.3, layer=layers.Exponential(1.0, 0.1), profile=BALL, approach=0.1),
        Scene(0.3, layer=layers.CalculixExponential(0.3, 0.1), profile=BALL, approach=0.1),
        Scene.from_physical(
            **STEEL, layer=layers.PowerLaw(2e20, 2.0), profile=profiles.Flat(1e-6), approach=1e-8
        ),
    ],
    ids=["edge", "no edge", "SI"],
)
def test_the_pressures_that_are_used_are_marked(scene):
    solution = solve(scene, 1e-5)
    own = solution if scene.physical is None else solution.physical
    figure = plotting.plot_law(solution)
    figure.draw_without_rendering()
    linear = figure.axes[0]
    largest = max(own.pressure(0.0), own.pressure(from_edge=0.0))
    shaded = linear.patches[0].get_extents().transformed(linear.transData.inverted())
    assert shaded.y1 == pytest.approx(largest, rel=1e-4)
    curve, dot = linear.lines[0], linear.lines[-1]
    [w], [mean] = dot.get_data()
    assert np.interp(w, *curve.get_data()) == pytest.approx(mean, rel=1e-3)
    assert 0.0 < mean < largest
    assert ("Pa" in linear.get_ylabel()) == (scene.physical is not None)


def test_what_has_no_law_is_refused():
    with pytest.raises(NotComputedError, match="no nonlinear layer"):
        plotting.plot_law(solve(Scene(0.3, 0.5), 1e-4))
    with pytest.raises(SceneError, match="Solution"):
        plotting.plot_law(3)
