"""Coupled partial slip: the smooth limit, the equations by the elliptic kernels, limits, zones."""

import functools
import math

import numpy as np
import pytest

from spectral_contact import NotComputedError, Scene, StepState, solve
from spectral_contact.contact.coupled_slip import _Problem
from spectral_contact.contact.resolution import series_of
from spectral_contact.equations import (
    load,
    normal_displacement,
    shear_lift,
    tangential_displacement,
)
from spectral_contact.fields import AnnulusSeries, DiskSeries, Radius, ZonalField, ZonePiece

#: nu, friction to 15 digits as this library finds it, and an earlier calculation of friction,
#: approach and shear to nine, for the stick radius 1/2 of smooth surfaces.
SMOOTH = [
    (0.0, 0.298714615961742, 0.298714616, 0.1187973528, 0.2710896535),
    (0.3, 0.15248168678182, 0.152481687, 0.1230967249, 0.140747641),
]
#: Scenes with one stick disk.
ROUGH = [
    Scene(0.1, 0.5, 0.5, 0.1, coupling=True),
    Scene(0.3, 1e-3, 1e-3, 0.2, coupling=True),
    Scene(0.3, 0.5, 0.0, 0.1, coupling=True),
    Scene(-0.5, 0.2, 0.1, 0.2, coupling=True),
]


@functools.cache
def slipping(scene, rtol=1e-6):
    return solve(scene, rtol)


@pytest.mark.parametrize(("nu", "friction", "known", "approach", "shear"), SMOOTH)
def test_smooth_limit_to_twelve_digits(nu, friction, known, approach, shear):
    assert friction == pytest.approx(known, rel=4e-9)
    solution = slipping(Scene(nu, friction=friction, coupling=True), 1e-12)
    assert solution.stick_radius == pytest.approx(0.5, rel=2e-12)
    assert abs(2.0 * solution.stick_radius - 1.0) <= solution.error.stick_radius
    assert solution.approach == pytest.approx(approach, abs=6e-11)
    assert solution.total_shear == pytest.approx(shear, abs=6e-10)
    assert max(solution.error.approach, solution.error.total_shear) <= 1e-12


@pytest.mark.parametrize("scene", [ROUGH[0], *ROUGH[2:], Scene(0.0, friction=0.3, coupling=True)])
@pytest.mark.parametrize("rtol", [1e-4])
def test_estimates_bound_the_errors(scene, rtol):
    solution, truth = slipping(scene, rtol), slipping(scene, 1e-8)
    for name in ("approach", "total_shear", "stick_radius"):
        error = abs(getattr(solution, name) / getattr(truth, name) - 1.0)
        assert error <= getattr(solution.error, name) + getattr(truth.error, name)
    assert max(solution.error.approach, solution.error.total_shear) <= rtol


def fields_of(scene, tolerance):
    """Return pressure and traction of the distance from the edge, the friction, and the rim."""
    problem = _Problem(
        scene.normal_compliance, scene.tangential_compliance, scene.kappa, scene.friction
    )
    rim = slipping(scene).zones[0]
    logit = Radius(rim.outer, rim.outer_from_edge).logit
    trial = problem.trial(logit, tolerance, scene.friction)
    disk, found = trial.disk, trial.solution
    c, edge, (own, *around) = disk.radius, Radius(1.0, 0.0), disk.panels
    outside = [series_of(p, v) for p, v in zip(around, (found.inner, found.outer), strict=True)]
    annulus = AnnulusSeries(c, edge, *outside, power=0)
    p = DiskSeries(c, series_of(own, found.disk), power=0)
    q = DiskSeries(c, series_of(own, found.traction).times(c.value))
    fields = (
        ZonalField((ZonePiece(c, p), ZonePiece(edge, annulus))),
        ZonalField((ZonePiece(c, q), ZonePiece(edge, annulus, trial.friction))),
    )
    pressure, traction = (lambda d, one=one: one(1.0 - d, d) for one in fields)
    return pressure, traction, trial, c.from_edge


@pytest.mark.parametrize(
    "scene", [*ROUGH[:2], Scene(0.0, friction=0.298714615961742, coupling=True)]
)
def test_fields_satisfy_the_equations_of_the_elliptic_kernels(scene):
    pressure, traction, trial, rim = fields_of(scene, 1e-9)
    kappa, alpha, beta = scene.kappa, scene.normal_compliance, scene.tangential_compliance
    assert trial.friction == pytest.approx(scene.friction, rel=1e-9)
    cuts = [rim, rim / 2.0, *(10.0**-k for k in range(1, 12))]
    assert 2.0 * math.pi * load(pressure, breaks=cuts) == pytest.approx(1.0, rel=1e-9)
    for share in (0.02, 0.3, 0.7, 0.95):
        for d in (rim * share, rim + (1.0 - rim) * share):
            at = np.array([d])
            p, q = float(pressure(at)[0]), float(traction(at)[0])
            deflection = normal_displacement(pressure, d, cuts)
            under = alpha * p + deflection - shear_lift(traction, kappa, d, cuts)
            assert under == pytest.approx(trial.solution.approach, rel=2e-8)
            outward, inward = tangential_displacement(traction, pressure, kappa, d, cuts)
            moved = (beta * q + outward - inward) / inward
            if d > rim:
                assert abs(moved) < 2e-8
                assert q < scene.friction * p
            else:
                assert moved < 0.0
                assert q == pytest.approx(scene.friction * p, rel=1e-8)


@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 0.5), (0.5, 0.0)])
def test_the_effect_of_coupling_falls_like_the_square_of_kappa(alpha, beta):
    changes = []
    for kappa in (8e-3, 4e-3):
        nu = (1.0 - 4.0 * kappa) / (2.0 - 4.0 * kappa)
        pair = [
            solve(
                Scene(nu, alpha, beta, 0.4 * kappa, coupling=coupling),
                1e-9,
                ("approach", "total_shear", "stick_radius"),
            )
            for coupling in (False, True)
        ]
        changes.append(
            [
                getattr(pair[1], name) / getattr(pair[0], name) - 1.0
                for name in ("approach", "total_shear", "stick_radius")
            ]
        )
    for first, second in zip(*changes, strict=True):
        assert first / second == pytest.approx(4.0, rel=0.02)


def test_slip_begins_at_the_critical_friction():
    critical = solve(Scene(0.3, 0.5, 0.2, math.inf, coupling=True), 1e-10)
    just = slipping(Scene(0.3, 0.5, 0.2, 0.999 * critical.critical_friction, coupling=True))
    assert 0.95 < just.stick_radius < 1.0
    assert just.total_shear < critical.total_shear
    assert just.total_shear == pytest.approx(critical.total_shear, rel=1e-4)


def test_what_is_there_and_what_is_not():
    solution = slipping(ROUGH[0])
    assert [zone.kind for zone in solution.zones] == ["stick", "slip"]
    assert solution.zones[0].outer == solution.stick_radius
    states = {step.name: step.state for step in solution.plan.steps}
    assert states["partial slip"] is StepState.RUN
    assert not any(state is StepState.CONDITIONAL for state in states.values())
    for name in ("pressure", "traction", "slip"):
        assert name not in solution.plan.quantities
        assert getattr(solution.error, name) is None
        with pytest.raises(NotComputedError, match="with coupling and slip"):
            getattr(solution, name)(0.5)
    assert solution.work["partial slip"].unknowns > 300
    assert type(solution).from_json(solution.to_json()) == solution


@pytest.mark.parametrize(
    "scene",
    [Scene(0.3, 0.05, 1.0, 0.23 / 7, coupling=True), Scene(0.3, friction=1e-3, coupling=True)],
)
def test_other_zones_are_refused(scene):
    with pytest.raises(NotComputedError, match="coupled partial slip"):
        solve(scene, 1e-4)
