"""What grows with what: nested spaces, tolerances, friction; and effects of no strength.

That c* and Q* increase with friction is expected and not proved: a counterexample is a finding.
"""

import dataclasses
import math

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles.property_settings import few

from spectral_contact import Scene, solve
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import unit_space
from spectral_contact.testing.strategies import (
    frictionless_scenes,
    full_stick_scenes,
    partial_slip_scenes,
    poisson_ratios,
    powers_of_ten,
)

#: Unknowns on the panels that a mesh in use may have too many: eight, three on each.
BORROWED = 24

meshes = st.builds(
    LogPanels,
    count=st.integers(2, 14),
    width=st.sampled_from([1.0, 1.5, 2.0]),
    degree=st.integers(3, 16),
)


@few
@given(meshes, powers_of_ten(-10, 6), st.data())
def test_projections_are_symmetric_and_definite(panels, compliance, data):
    shear = data.draw(st.booleans())
    space = unit_space(panels, (panels.degree,) * panels.count, shear=shear)
    gram, mass = space.gram, space.mass
    scale = 1 / np.sqrt(gram.diagonal())
    assert np.all(np.abs(gram - gram.T) * scale * scale[:, None] <= 1e-14)
    matrix = compliance * mass + gram
    scale = 1 / np.sqrt(matrix.diagonal())
    assert np.linalg.eigvalsh(matrix * scale * scale[:, None])[0] > 0
    degrees = tuple(data.draw(st.integers(0, panels.degree)) for _ in range(panels.count))
    unit_space(panels, degrees, shear=shear).factor(compliance)  # raises if it is not


@few
@given(powers_of_ten(-8, 6))
def test_the_approach_of_nested_spaces_decreases(compliance):
    panels = LogPanels(max(math.ceil((20 - math.log(compliance)) / 2), 2), 2.0, 10)
    approaches = []
    for degree in range(0, 10):
        space = unit_space(panels, (degree,) * panels.count)
        unit = space.factor(compliance).solve(2.0)
        moment = 2.0 * float(space.constant_moments @ unit[space.index])
        approaches.append(1.0 / (2.0 * math.pi * moment))
    exact = solve(Scene(0.3, compliance), 1e-12, ["approach"]).approach
    assert np.all(np.diff(approaches) <= 4e-15 * exact)
    assert approaches[-1] >= exact * (1 - 4e-15)


@few
@given(partial_slip_scenes(), st.floats(1.02, 3.0))
def test_stick_radius_and_shear_increase_with_friction(scene, factor):
    more = dataclasses.replace(scene, friction=scene.friction * factor)
    less, more = solve(scene, 1e-8), solve(more, 1e-8)
    assert less.stick_radius <= more.stick_radius
    assert less.total_shear <= more.total_shear * (1 + 1e-12)


@few
@given(partial_slip_scenes())
def test_tighter_tolerances_have_smaller_estimates(scene):
    loose, tight = solve(scene, 1e-3), solve(scene, 1e-8)
    for name in ("approach", "pressure", "traction", "total_shear"):
        assert getattr(tight.error, name) <= getattr(loose.error, name) + 1e-13, name


@few
@given(
    st.one_of(frictionless_scenes(), full_stick_scenes(), partial_slip_scenes()),
    st.floats(2.0, 11.9),
    st.floats(0.1, 3.0),
)
def test_tighter_tolerances_need_no_fewer_unknowns(scene, digits, more):
    loose = solve(scene, 10.0**-digits, strict=False)
    tight = solve(scene, max(10.0 ** -(digits + more), 1e-12), strict=False)
    assume(loose.converged and tight.converged)
    assert loose.work.unknowns <= tight.work.unknowns
    # a step alone may be larger by the panels of a mesh that it borrows
    before = {step.name: step.unknowns for step in loose.work.steps}
    for step in tight.work.steps:
        assert before.get(step.name, 0) <= step.unknowns + BORROWED, step.name


@few
@given(full_stick_scenes(), st.floats(1.001, 100.0))
def test_friction_above_critical_is_full_stick_to_the_bit(scene, factor):
    stuck = solve(scene, 1e-8)
    assume(math.isfinite(stuck.critical_friction))
    enough = dataclasses.replace(scene, friction=factor * stuck.critical_friction)
    solution, s = solve(enough, 1e-8), np.linspace(0.0, 1.0, 9)
    assert solution.total_shear == stuck.total_shear
    assert np.array_equal(solution.traction(s), stuck.traction(s))
    assert [zone.kind for zone in solution.zones] == ["stick"]


@few
@given(poisson_ratios(), powers_of_ten(-6, 6), powers_of_ten(-6, 6))
def test_effects_of_no_strength_change_no_digit(nu, alpha, beta):
    alone = solve(Scene(nu, alpha), 1e-8)
    for scene in (
        Scene(nu, alpha, beta),  # tangential roughness without friction
        Scene(nu, alpha, beta, 0.0),  # no friction that resists
        Scene(0.5, alpha, beta, 0.1),  # nothing that pulls
    ):
        solution = solve(scene, 1e-8)
        change = abs(solution.approach / alone.approach - 1)
        assert change <= solution.error.approach + alone.error.approach
        change = abs(solution.pressure(0.7) / alone.pressure(0.7) - 1)
        assert change <= solution.error.pressure + alone.error.pressure
        assert solution.total_shear == 0.0


@few
@given(powers_of_ten(-8, 6), st.sampled_from([1e-2, 1e-4, 1e-6]))
def test_bounds_hold_the_approach(alpha, rtol):
    lower, upper = solve(Scene(0.3, alpha), rtol).approach_bounds
    approach = solve(Scene(0.3, alpha), 1e-12, ["approach"]).approach
    assert lower <= approach <= upper
    assert upper / lower - 1 <= 1e-12
