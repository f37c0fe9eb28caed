"""Contours of a stress below the surface: what is drawn, and where the largest is marked."""

import numpy as np
import pytest

from spectral_contact import Scene, SceneError, profiles, solve

pytest.importorskip("matplotlib", reason="part of the extra: plot")
from spectral_contact.view.plotting import plot_inside


def test_the_largest_von_mises_stress_is_marked_where_it_is():
    body = solve(Scene(0.3, 0.5, friction=None), 1e-3).inside
    figure = plot_inside(body, r_max=1.5)
    main, found = figure.axes[1], body.largest("von_mises")
    (mark,) = (line for line in main.lines if line.get_marker() == "x")
    assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (found.r, found.z)
    assert main.get_title() == "von Mises equivalent stress"
    assert f"largest: {found.value:.6g}, at the cross" in main.texts[0].get_text()
    assert main.get_xlim() == (0.0, 1.5)


def test_without_bound_a_note_says_why_and_the_surface_meets_the_punch():
    solution = solve(Scene(0.3))
    figure = plot_inside(solution.inside, "max_shear")
    assert "unbounded: the pressure of a smooth" in figure.axes[1].texts[0].get_text()
    surface = figure.axes[0].lines[-1].get_xydata()
    under = surface[surface[:, 0] <= 1.0]
    np.testing.assert_allclose(under[:, 1], solution.approach, rtol=1e-6)


def test_under_a_profile_the_punch_is_drawn_where_it_is():
    ball = profiles.Sphere(1.0)
    solution = solve(Scene(0.3, profile=ball, contact_radius=0.8))
    top = plot_inside(solution.inside, "u_z").axes[0]
    r, face = top.lines[0].get_xydata().T
    assert r[-1] == pytest.approx(1.25, abs=0.02)  # where the sphere ends
    np.testing.assert_allclose(face, solution.approach - ball.height(0.8 * r), atol=1e-6)
    assert "[$L$]" in top.get_ylabel()


def test_a_punch_that_adhesion_holds_back_is_drawn():
    ball = profiles.Parabola(1.0)
    scene = Scene(0.3, 0.05, profile=ball, work_of_adhesion=0.05, contact_radius=0.3)
    solution = solve(scene, 1e-3)
    assert solution.approach < 0.0
    r, face = plot_inside(solution.inside, "u_z").axes[0].lines[0].get_xydata().T
    assert r[0] == 0.0
    assert r[-1] > 1.0
    np.testing.assert_allclose(face, solution.approach - ball.height(0.3 * r), atol=1e-3)


@pytest.mark.parametrize(
    ("parameters", "name"),
    [
        ({"quantity": "tresca"}, "quantity"),
        ({"r_max": -1.0}, "r_max"),
        ({"r_max": np.nan}, "r_max"),
    ],
)
def test_bad_parameters_are_refused_by_name(parameters, name):
    with pytest.raises(SceneError) as caught:
        plot_inside(solve(Scene(0.3)).inside, **parameters)
    assert caught.value.parameter == name
