"""`check_solution` and `compare` of contacts under profiles."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import spectral_contact as sc
from spectral_contact import Scene, SceneError, closed_forms, profiles, solve
from spectral_contact.testing import check_solution

BALL = profiles.Parabola(1.0)
HERTZ = Scene(0.3, profile=BALL, contact_radius=1.0)
SCENES = {
    "ball": Scene(0.3, 0.5, profile=BALL, load=1.0),
    "smooth cone": Scene(0.3, profile=profiles.Cone(1.0), load=1.0),
    "smooth corner": Scene(0.3, profile=profiles.TruncatedCone(0.5, 1.0), load=1.0),
    "corner": Scene(0.3, 1e-3, profile=profiles.TruncatedCone(0.5, 1.0), approach=0.1),
    "tip on a layer": Scene(0.3, 1e-3, profile=profiles.Cone(1.0), contact_radius=1.0),
}


def hertz(factor=1.0, radius=1.0, **more):
    """Hertz's contact, spoilt by a factor or a wrong radius: no solver."""

    def pressure(s):
        r = radius * np.asarray(s)
        return factor * closed_forms.parabola_pressure(radius, 1.0, np.minimum(r, radius))

    return SimpleNamespace(pressure=pressure, contact_radius=radius, **more)


@pytest.mark.parametrize("name", SCENES)
def test_solutions_pass(name):
    scene = SCENES[name]
    report = check_solution(solve(scene, 1e-10), scene, 1e-9)
    assert len(report.checks) == 6
    assert report.passed


def failed(solution, scene=HERTZ, rtol=1e-8):
    return {
        one.name
        for one in check_solution(solution, scene, rtol, strict=False).checks
        if not one.passed
    }


def test_closed_forms_pass_and_what_is_wrong_fails():
    assert not failed(hertz(load=16.0 / 3.0, approach=1.0))
    assert "pressure bears the load" in failed(hertz(load=5.0))
    assert "surface follows the punch" in failed(hertz(1.001, approach=1.0))
    assert "contact_radius is the one given" in failed(hertz(radius=1.001))
    pushed = Scene(0.3, profile=BALL, load=5.0)
    assert failed(hertz(), pushed) == {"load is the one given"}
    with pytest.raises(AssertionError, match="does not solve"):
        check_solution(hertz(1.01), HERTZ, 1e-3)


def test_a_flat_punch_s_pressure_is_too_much_at_the_edge():
    """Added to Hertz's it follows the punch, and the surface outside would have to be inside it."""

    def pressure(s):
        s = np.asarray(s)
        with np.errstate(divide="ignore"):
            added = -0.1 / np.sqrt((1 - s) * (1 + s))
        return closed_forms.parabola_pressure(1.0, 1.0, s) + np.where(s < 1, added, 0)

    wrong = SimpleNamespace(pressure=pressure, contact_radius=1.0)
    assert "pressure is not negative" in failed(wrong)
    too_small = SimpleNamespace(
        pressure=lambda from_edge: solve(Scene(0.3, 0.5)).pressure(from_edge=from_edge),
        contact_radius=1.0,
    )
    scene = Scene(0.3, 0.5, profile=profiles.PowerLaw(1e-9, 2.0), contact_radius=1.0)
    assert "surface is below the punch outside" in failed(too_small, scene)


def test_of_friction_only_its_bound_is_checked():
    scene = Scene(0.3, 0.2, 0.2, math.inf, profile=BALL, contact_radius=1.0)
    found = solve(scene, 1e-3)
    report = check_solution(found, scene, 1e-3)
    assert [one.name for one in report.checks][-1] == "total shear is that of the traction"
    limited = scene.replace(friction=1e-3)
    wrong = check_solution(found, limited, 1e-3, strict=False)
    assert "traction within friction" in {one.name for one in wrong.checks if not one.passed}


def test_a_contact_radius_is_needed():
    with pytest.raises(SceneError, match="contact_radius"):
        check_solution(SimpleNamespace(pressure=lambda s: s), SCENES["ball"], 1e-3)


def test_compare_knows_what_a_profile_adds():
    agreement = sc.compare(HERTZ, load=5.0, contact_radius=1.0, stiffness=8.0, indentation_work=2.0)
    assert agreement["load"].error == pytest.approx(1 - 15 / 16)
    assert agreement["stiffness"].error < 1e-14
    assert agreement["contact_radius"].error == 0.0
    assert agreement["indentation_work"].truth == pytest.approx(32 / 15)


def test_pressures_are_compared_by_their_mean_where_they_vanish():
    off = lambda s: closed_forms.parabola_pressure(1.0, 1.0, s) + 1e-6  # noqa: E731
    agreement = sc.compare(HERTZ, pressure=off, s=[0.5, 1.0 - 1e-14, 1.0])
    mean = 16 / 3 / math.pi
    assert agreement["pressure"].error == pytest.approx(1e-6 / mean, rel=1e-3)


def test_compare_in_si_units():
    scene = Scene.from_physical(
        youngs_modulus=70e9, poisson_ratio=0.2, profile=profiles.Parabola(1e-5), load=5e-3
    )
    here = solve(scene).physical
    agreement = sc.compare(scene, stiffness=here.stiffness, load=5e-3, contact_radius=2e-6)
    assert agreement["stiffness"].error < 1e-12
    assert agreement["load"].error < 1e-12
    assert agreement["contact_radius"].truth == pytest.approx(here.contact_radius)


@pytest.mark.parametrize("off", [1e-9, -1e-9])
def test_a_contact_radius_that_is_a_billionth_off_fails(off):
    a, load = 1.0 + off, 16.0 / 3.0
    extra = load - closed_forms.parabola_contact(a, 1.0).load

    class Punched:
        """The contact of another radius, with a flat punch for the rest of the load."""

        contact_radius = a

        def pressure(self, *, from_edge):
            y = from_edge * (2.0 - from_edge)
            return 8.0 * a / np.pi * np.sqrt(y) + extra / (2.0 * np.pi * a**2 * np.sqrt(y))

    scene = Scene(0.3, profile=profiles.Parabola(1.0), load=load)
    report = check_solution(Punched(), scene, 1e-11, strict=False)
    assert [c.name for c in report.checks if not c.passed] == ["pressure vanishes at the edge"]


def test_the_adhesion_of_another_work_fails_on_a_smooth_surface():
    scene = Scene(0.3, profile=profiles.Parabola(1.0), load=1.0, work_of_adhesion=1.0)
    assert check_solution(solve(scene, 1e-10), scene, 1e-9).passed
    report = check_solution(solve(scene.replace(work_of_adhesion=1.001)), scene, 1e-6, strict=False)
    missed = [c.name for c in report.checks if not c.passed]
    assert missed == ["energy release rate is the work of adhesion"]


def test_a_traction_between_equal_materials_fails():
    law = {"profile": profiles.Parabola(1.0), "load": 1.0, "friction": 0.1}
    scene = Scene.from_kappa(0.0, tangential_compliance=0.5, **law)
    solution = solve(scene)

    class Sheared:
        contact_radius = solution.contact_radius
        pressure = solution.pressure

        def traction(self, *, from_edge):
            return 0.05 * solution.pressure(from_edge=from_edge)

    report = check_solution(Sheared(), scene, 1e-9, strict=False)
    assert [c.name for c in report.checks if not c.passed] == ["no traction at kappa = 0"]
