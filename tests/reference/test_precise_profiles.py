"""Normal contact under profiles to any number of digits.

The oracles share no code with it: numbers of independent codes, closed forms, the flat punch of the
gold tables, and the elliptic equation by mpmath's quadrature.
"""

import functools

import mpmath
import numpy as np
import pytest
from mpmath.ctx_mp import MPContext

from spectral_contact import NotComputedError, Scene, SceneError, gold, profiles, solve
from spectral_contact.precise import indented_rough, reference
from spectral_contact.precise.heights import heights
from spectral_contact.profiles import control

PARABOLA = Scene(0.3, 0.5, profile=profiles.Parabola(1.0), contact_radius=1.0)
CORNER = Scene(0.3, 0.1, profile=profiles.TruncatedCone(0.5, 1.0), contact_radius=1.0)
KINKED = profiles.Sampled((0.0, 0.5, 2.0), ((0.25, 0.25), (1.5,)), rounded=True)
CONE = profiles.Cone(1.1)
SHAPES = [
    profiles.Flat(1.0),
    profiles.Parabola(1.3),
    profiles.Sphere(1.3),
    CONE,
    KINKED,
    profiles.PowerLaw(0.7, 2.5),
    profiles.TruncatedCone(0.4, 1.1),
    profiles.RoundedFlat(0.4, 0.8),
    profiles.Sum(CONE, profiles.Sphere(1.3)),
]
SCALARS = ("approach", "contact_radius", "load", "stiffness", "indentation_work")


@functools.cache
def solved(scene, digits=15):
    return reference(scene, digits, progress=False)


def test_numbers_of_independent_codes():
    found = solved(PARABOLA)
    assert abs(found.approach - 0.6063170022) < 1e-10
    assert abs(found.load - 1.1763284084) < 1e-10
    assert abs(found.stiffness - 3.4134376476) < 1e-10


def test_the_stiffness_is_that_of_the_flat_punch():
    flat = gold.find(Scene(0.3, 0.5))
    assert abs(solved(PARABOLA).stiffness * flat.approach - 1) < 1e-15


@pytest.mark.parametrize("scene", [PARABOLA, CORNER])
def test_the_double_solution_agrees_with_it_within_its_estimates(scene):
    true = solved(scene)
    assert true.converged
    assert max(getattr(true.error, name) for name in (*SCALARS, "pressure")) <= 1e-15
    double = solve(scene, 1e-10)
    for name in SCALARS:
        off = abs(getattr(double, name) / getattr(true, name) - 1)
        assert off <= getattr(double.error, name) + 1e-15
    s = np.array([0.0, 0.25, 0.75, 0.99])
    mean = double.load / (np.pi * double.contact_radius**2)
    off = abs(double.pressure(s) - true.pressure(s))
    assert (off <= double.error.pressure * np.maximum(double.pressure(s), mean)).all()


def test_the_pressure_solves_the_elliptic_equation():
    true, mp = solved(PARABOLA), MPContext()
    mp.dps = 25
    s = mp.mpf(0.5)

    def integrand(eta):  # of K1: eta/hi K(lo/hi), which mpmath takes of the square
        low, high = min(eta, s), max(eta, s)
        p = mp.mpf(true.pressure(eta))
        return p * eta / high * mp.ellipk((low / high) ** 2)

    moved = mp.quad(integrand, [0, s, mp.mpf(0.9), 1], maxdegree=6) / mp.pi
    under = mp.mpf(0.5) * mp.mpf(true.pressure(s)) + moved
    assert abs(under / (mp.mpf(true.approach) - s**2 / 2) - 1) < 1e-14


def test_smooth_surfaces_are_the_closed_forms():
    hertz = solved(Scene(0.3, profile=profiles.Parabola(1.0), load=2.0), 30)
    with mpmath.workdps(40):
        radius = mpmath.cbrt(mpmath.mpf(3) / 8)
        assert abs(hertz.contact_radius / radius - 1) < 1e-30
        assert abs(hertz.approach / radius**2 - 1) < 1e-30
        p = 8 * radius * mpmath.sqrt(3) / 2 / mpmath.pi
        assert abs(hertz.pressure(0.5) / p - 1) < 1e-30
        # 1/cot = tan(theta): delta = pi a / 2, P = 2 pi a^2, p = 2 arcosh(1/s)
        cone = solved(Scene(0.3, profile=profiles.PowerLaw(1.0, 1.0), contact_radius=1.0), 30)
        assert abs(cone.approach * 2 / mpmath.pi - 1) < 1e-30
        assert abs(cone.load / (2 * mpmath.pi) - 1) < 1e-30
        assert abs(cone.indentation_work / (mpmath.pi**2 / 3) - 1) < 1e-30
        assert abs(cone.pressure(0.25) / (2 * mpmath.acosh(4)) - 1) < 1e-30
        assert cone.pressure(0.0) == mpmath.inf


def test_a_kinked_profile_of_its_own_series():
    """A parabola that a cone continues: what a smooth surface asks of it is known from the two."""
    mp = MPContext()
    mp.dps = 30
    found, b = heights(mp, KINKED), mp.mpf("0.5")
    # H = 2 t int h'(t sin phi) dphi, and its derivative, with a jump of h' by 1 at b
    for t in (mp.mpf("0.3"), mp.mpf("0.8"), mp.mpf("1.5")):
        angle = mp.asin(min(b / t, 1))
        rise = t * (1 - mp.cos(angle)) + 1.5 * (mp.pi / 2 - angle)
        assert abs(found.transform(t) / (2 * t * rise) - 1) < 1e-28
        rate = mp.diff(found.transform, t)
        assert abs(found.rate(t) / (rate * found.root(t)) - 1) < 1e-12
    assert found.height(1.0) == b**2 / 2 + 1.5 * b


@pytest.mark.parametrize("kind", control.KINDS.values(), ids=lambda kind: kind.__name__)
def test_heights_of_every_kind_are_those_in_doubles(kind):
    """A kind that `heights` lacks is an `AssertionError`, or a case missing from `SHAPES`."""
    mp, [profile] = MPContext(), [one for one in SHAPES if type(one) is kind]
    mp.dps = 30
    precise = heights(mp, profile)
    for t in (0.3, 0.8):
        last = max((one for one in profile.breaks if one < t), default=0.0)
        past = t**2 - last**2 if last else 0.0
        rate = profile._rate(np.array([t]), np.array([past]))[0] * float(precise.root(mp.mpf(t)))
        expected = profile.height(t), profile._transform(np.array([t]))[0], rate
        found = (one(mp.mpf(t)) for one in (precise.height, precise.transform, precise.rate))
        assert [float(one) for one in found] == pytest.approx(expected, rel=1e-13, abs=1e-15)


def test_a_pulled_sphere_next_to_its_equator_has_no_gap_beyond_it():
    """Meshes were not graded to the pole at the equator, and the gap looked at was the approach."""
    sphere = {"profile": profiles.Sphere(1.0), "contact_radius": 1.0 - 1e-12}
    scene = Scene(0.3, 10.0, work_of_adhesion=0.1, **sphere)
    double = solve(scene, 1e-8)
    for name in ("load", "approach"):
        off = abs(getattr(double, name) - getattr(solved(scene), name))
        assert off <= getattr(double.error, name) * double.error_scales[name]


def test_what_it_does_not_know_is_refused(monkeypatch):
    with pytest.raises(NotComputedError, match="normal contact alone"):
        reference(Scene(0.3, 0.1, 0.1, 0.2, profile=profiles.Parabola(1.0), load=1.0))
    monkeypatch.setattr(indented_rough, "_MOST_NODES", 100)
    with pytest.raises(NotComputedError, match="with 1 breaks it takes"):
        reference(CORNER, 15)
    with pytest.raises(SceneError, match="digits"):
        reference(PARABOLA, 10)


def test_fields_know_their_edges():
    found = solved(CORNER)
    assert found.pressure(1.0) == 0
    deep = found.pressure(from_edge=[1e-30, 1e-20])
    assert abs(deep[1] / deep[0] / mpmath.mpf("1e10") - 1) < 1e-12
    assert found.traction(0.5) == 0
