"""What looks like another unit than SI is asked about, in Python as on the command line."""

import pytest

from spectral_contact import Scene, SceneError, profiles, solve
from spectral_contact.__main__ import main

NU = {"poisson_ratio": 0.3}
MODULUS = "E = 210 is in Pa: did you mean 210 GPa?"
RADIUS = "a = 5 is in m: did you mean 5 mm?"


@pytest.mark.parametrize(
    ("given", "asked"),
    [
        ({"youngs_modulus": 210, "radius": 5, "load": 1e3}, (MODULUS, RADIUS)),
        ({"youngs_modulus": 210, "radius": 5e-3, "load": 1e3}, (MODULUS,)),
        ({"youngs_modulus": 210, "radius": 5e-6, "load": 1e3}, (MODULUS,)),
        ({"youngs_modulus": 210e9, "radius": 5, "load": 1e3}, (RADIUS,)),
        (
            {"youngs_modulus": 210e3, "radius": 5, "load": 1e3},
            ("E = 210000 is in Pa: did you mean 210000 MPa?", RADIUS),
        ),
        # a cell under the tip of a microscope, a building on soil, steel under a punch
        ({"youngs_modulus": 210, "radius": 5e-6, "load": 1e-9}, ()),
        ({"youngs_modulus": 50e6, "radius": 5, "load": 1e6}, ()),
        ({"youngs_modulus": 210e9, "radius": 5e-3, "load": 1e3}, ()),
    ],
)
def test_what_looks_like_another_unit_is_asked_about(given, asked):
    assert Scene.from_physical(**NU, **given).remarks == asked


def test_compliances_that_look_like_another_unit():
    given = {"youngs_modulus": 210e9, "radius": 5e-3, "load": 1e3}
    [remark] = Scene.from_physical(**NU, **given, normal_compliance=5e-9).remarks
    assert remark.startswith("alpha* = 5.77e+04 is > 1000: alpha = 5e-09 is in m/Pa (5e+06 nm/MPa)")


def test_a_contact_under_a_profile_is_asked_about_when_its_radius_is_known():
    ball = profiles.Parabola(0.01)
    scene = Scene.from_physical(
        **NU, youngs_modulus=70e9, load=1.0, profile=ball, normal_compliance=1e-9
    )
    assert scene.remarks == ()
    [remark] = solve(scene, 1e-6).remarks
    assert remark.startswith("alpha* = ")
    assert Scene(0.3, 0.5).remarks == ()
    with pytest.raises(SceneError, match=r"^contact_radius = -1\.0"):
        scene.physical.remarks(0.3, -1.0)


def test_python_and_the_command_line_ask_the_same(capsys):
    scene = Scene.from_physical(**NU, youngs_modulus=210, radius=5, load=1e3)
    solution = solve(scene, 1e-6)
    options = "--youngs-modulus 210 --radius 5 --load 1000 --poisson-ratio 0.3 --friction none"
    assert main(["solve", *options.split(), "--rtol", "1e-6"]) == 0
    printed = capsys.readouterr().out
    for remark in (MODULUS, RADIUS):
        assert remark in printed
        assert remark in solution.summary()
        assert remark in repr(solution)
        assert remark in solution._repr_html_()
