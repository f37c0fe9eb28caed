"""The system on any zones: its matrix, its functionals, and what top degrees contribute."""

import numpy as np
import pytest
from oracles.family_integrals import half_integral, inner_integral, sources
from spectral_contact.spectral.system import System

from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.factored import Factored
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import OffsetRadii

PARAMETERS = Parameters(0.1, 0.2, 0.3, 0.4)
STATES = [(0, 1), (0, 1, 0), (0, 1, 0, -1), (0, -1, 0, 1, 0)]


def whole_traction(system, values):
    """Return the coefficients of q/s on every part in the whole bases."""
    whole = []
    for own, part, columns in zip(
        system.traction(values), system.parts, system._columns, strict=True
    ):
        whole.append(np.zeros((part.shear.panels.size, *values.shape[1:])))
        whole[-1][columns] = own
    return whole


def zones(states, degree=6, parameters=PARAMETERS, moved=0.0):
    """Return zones with panels to 3e-6 of every boundary."""
    count = 2 * len(states) - 1
    panels = [LogPanels(6, 2.0, 12) for _ in range(count)]
    panels[-1] = LogPanels(6, 2.0, 12, 0.0 if parameters.alpha else -0.5)
    radii = tuple(Radius.from_logit(x) for x in np.linspace(-1.0, 3.0, len(states) - 1) + moved)
    return System(radii, states, [DiscreteSpace(one, (degree,) * 6) for one in panels], parameters)


def vector(system):
    """Return a random vector, as large as its functions are small."""
    diagonal = np.abs(system.matrix().diagonal())
    return np.random.default_rng(1).standard_normal(system.unknowns) / np.sqrt(diagonal)


@pytest.mark.parametrize("states", STATES)
@pytest.mark.parametrize(("alpha", "beta"), [(0.1, 0.2), (0.0, 0.2), (0.1, 0.0), (0.0, 0.0)])
def test_the_matrix_is_that_of_the_residual(states, alpha, beta):
    system = zones(states, parameters=PARAMETERS._replace(alpha=alpha, beta=beta))
    values = vector(system)
    nothing = np.zeros(1), np.zeros((len(system.radii), 1))
    missed = system.residual(values[:, None], *nothing)[:, 0]
    matrix = system.matrix()
    scale = np.abs(matrix) @ np.abs(values)
    # without weights the coupling is a product of moments, which quadrature meets so far
    normal, tangential = 1e-9 if alpha else 1e-13, 1e-9 if beta else 1e-13
    allowed = np.where(np.arange(system.unknowns) < system.count, normal, tangential)
    assert (np.abs(missed + matrix @ values) <= allowed * scale).all()


@pytest.mark.parametrize("states", STATES)
def test_loads_and_shears_are_those_of_the_fields(states):
    system = zones(states)
    values = vector(system)
    pressure = [one.of(values) for one in system.fields[: len(system.parts)]]
    traction = whole_traction(system, values)
    load = shear = 0.0
    for part, p, q in zip(system.parts, pressure, traction, strict=True):
        points, matrix = sources(part.family)
        # quadrature of a disk has a root at the centre
        load += float((matrix @ p).sum())
        shear += 2.0 * np.pi * float(np.sqrt(points.z) @ (matrix @ q))
    assert system.load @ values[: system.count] == pytest.approx(load, rel=1e-10)
    # p/s has some degrees more than p, which is not all of a rough one
    assert system.total_shear(values) == pytest.approx(shear, abs=5e-3)


@pytest.mark.parametrize("states", STATES)
def test_balances_are_integrals_at_the_boundaries(states):
    system = zones(states)
    values = vector(system)
    kappa = PARAMETERS.kappa
    drive, balance = system.balances
    pressure = [one.of(values) for one in system.fields[: len(system.parts)]]
    traction = whole_traction(system, values)
    for b, radius in enumerate(system.radii):
        at = OffsetRadii(radius, np.zeros(1))
        inner = sum(
            float((inner_integral(part.family, at) @ p)[0])
            for part, p in zip(system.parts, pressure, strict=True)
            if part.zone <= b
        )
        outside = sum(
            float((half_integral(part.family, at) @ q)[0])
            for part, q in zip(system.parts, traction, strict=True)
            if part.zone > b
        )
        assert drive[b] @ values == pytest.approx(2.0 * kappa * inner / radius.value, rel=1e-10)
        assert balance[b] @ values == pytest.approx(
            2.0 * kappa * inner / radius.value - outside, rel=1e-10, abs=1e-12
        )


def test_parts_fill_the_contact():
    system = zones((0, 1, 0, -1))
    assert sum(part.family.reach for part in system.parts) == pytest.approx(1.0, rel=1e-14)
    assert [part.zone for part in system.parts] == [0, 1, 1, 2, 2, 3, 3]
    assert [part.boundary for part in system.parts] == [0, 0, 1, 1, 2, 2, -1]
    assert system.parts[-1].family.boundary == EDGE


@pytest.mark.parametrize("states", STATES)
def test_what_top_degrees_contribute_is_what_a_solve_without_them_lacks(states):
    system = zones(states)
    factored = Factored(system)
    approach, imbalance = np.ones(1), np.full((len(system.radii), 1), 0.1)
    solution = np.zeros((system.unknowns, 1))
    for _ in range(3):
        solution += factored.step(system.residual(solution, approach, imbalance))
    change, _ = factored.change(solution[:, 0], system)
    lesser = solution[:, 0] - change
    shed, _ = system.shed
    kept = np.setdiff1d(np.arange(system.unknowns), shed)
    missed = system.residual(lesser[:, None], approach, imbalance)[:, 0] * factored.scale
    assert np.abs(lesser[shed] / factored.scale[shed]).max() < 1e-12
    assert np.abs(missed[kept]).max() < 1e-12


@pytest.mark.parametrize("states", STATES)
def test_factors_of_boundaries_close_by_correct_to_the_solution(states):
    system = zones(states)
    exact, rough = Factored(system), Factored(zones(states, moved=1e-4))
    approach, imbalance = np.ones(1), np.full((len(system.radii), 1), 0.1)
    solutions = []
    for factored in (exact, rough):
        values = np.zeros((system.unknowns, 1))
        for _ in range(6):
            values += factored.step(system.residual(values, approach, imbalance))
        solutions.append(values[:, 0] / exact.scale)
    assert np.abs(solutions[0] - solutions[1]).max() < 1e-11 * np.abs(solutions[0]).max()


def test_the_misfit_at_sampling_points_is_that_of_the_families():
    system = zones((0, 1, 0, -1))
    values = vector(system)[:, None]
    pressure = [one.of(values) for one in system.fields[: len(system.parts)]]
    traction = whole_traction(system, values)
    annulus = system.slip_zone(1)
    misfits = system.slip_misfit(values, 1, annulus)
    for family, found in zip(annulus.families, misfits, strict=True):
        points = family.sampling()
        wanted = np.zeros((len(points.offset), 1))
        for other, p, q in zip(system.parts, pressure, traction, strict=True):
            inner = 2.0 * PARAMETERS.kappa / np.sqrt(points.z)[:, None]
            wanted += inner * (inner_integral(other.family, points) @ p)
            wanted -= half_integral(other.family, points) @ q
        assert np.abs(found - wanted).max() < 1e-11 * np.abs(wanted).max()
