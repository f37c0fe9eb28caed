"""One contact system for every case: matrix, residual, rows at boundaries, and coarse spaces."""

import numpy as np
import pytest
from oracles.mesh_integrals import half_integral, inner_integral, sources

from spectral_contact.contact.free_boundary import FieldSolution
from spectral_contact.contact.normal import solve_normal
from spectral_contact.contact.pressure_loads import load_outside
from spectral_contact.contact.refine import Refinement
from spectral_contact.fields.series import EDGE, Radius
from spectral_contact.spectral.contact_matrix import system_matrix
from spectral_contact.spectral.contact_system import ContactSystem
from spectral_contact.spectral.factored import factored
from spectral_contact.spectral.panels import DiscreteSpace, LogPanels
from spectral_contact.spectral.parameters import Parameters
from spectral_contact.spectral.parts import OffsetRadii

PARAMETERS = Parameters(0.1, 0.2, 0.3, 0.4)
FULL_STICK = (0,)
#: Full stick, one disk, slip inside, and three boundaries with slip of either sign.
STATES = [FULL_STICK, (0, 1), (0, 1, 0), (0, 1, 0, -1)]
WITH_BOUNDARIES = STATES[1:]
COMPLIANCES = [(0.1, 0.2), (0.0, 0.2), (0.1, 0.0), (0.0, 0.0)]
#: States, alpha, beta, and whether p is known. Under a known pressure without tangential compliance
#: there is one stick disk at most.
CASES = [
    (states, alpha, beta, known)
    for states in STATES
    for alpha, beta in COMPLIANCES
    for known in (False, True)
    if not known or beta > 0.0 or len(states) < 3
]
every_state = pytest.mark.parametrize("states", STATES)
every_boundary = pytest.mark.parametrize("states", WITH_BOUNDARIES)
known_or_not = pytest.mark.parametrize("known", [False, True], ids=["unknown", "known"])


def known_pressure(alpha, tolerance=1e-8):
    """Return the pressure without friction."""
    solved = solve_normal(alpha, tolerance, 3000)
    contact = solved.best.value if isinstance(solved, Refinement) else solved
    return contact.pressure


def contact_system(states, known, parameters=PARAMETERS, *, moved=0.0, degrees=6, capacity=12):
    """Return zones of given states, with panels to 3e-6 of every boundary."""
    power = 0.0 if parameters.alpha > 0.0 else -0.5
    panels = [LogPanels(6, 2.0, capacity) for _ in range(2 * len(states) - 1)]
    panels[-1] = LogPanels(6, 2.0, capacity, power)
    spaces = [DiscreteSpace(mesh, (degrees,) * 6) for mesh in panels]
    radii = tuple(Radius.from_logit(x) for x in np.linspace(-1.0, 3.0, len(states) - 1) + moved)
    pressures = [known_pressure(parameters.alpha)] if known else []
    return ContactSystem(radii, states, spaces, parameters, pressures)


def random_vector(system):
    """Return a vector whose terms are as large as their functions are small; p as it is known."""
    diagonal = np.abs(system_matrix(system).diagonal())
    values = np.random.default_rng(1).standard_normal(system.unknowns)
    unknown = diagonal > 0.0
    values[unknown] /= np.sqrt(diagonal[unknown])
    if system.pressure_known:
        values[: system.pressure_terms] = 1.0
    return values


def without_pressure(system, values):
    """Return a vector without a known pressure, on which the matrix does not act."""
    values = values.copy()
    if system.pressure_known:
        values[: system.pressure_terms] = 0.0
    return values


def no_defects(system):
    return np.zeros((len(system.radii), 1))


def both_fields(system, values):
    """Return the coefficients of p and of u on every part, for all functions of the panels."""
    fields = []
    for k, part in enumerate(system.parts):
        pressure = np.zeros(part.mesh.panels.size)
        on_part = system.pressure_maps[k].apply(values)
        pressure[part.mesh.panels.functions(part.pressure_degrees)] = on_part
        shear = np.zeros(part.shear_mesh.panels.size)
        on_part = system.shear_maps[k].apply(values)
        shear[part.shear_mesh.panels.functions(part.shear_degrees)] = on_part
        fields.append((pressure, shear))
    return fields


def solved(system):
    """Return the fields of a system, corrected until only rounding is left."""
    fields = FieldSolution.first(factored(system))
    for _ in range(4):
        fields, _ = fields.correct_once()
    return fields


@pytest.mark.parametrize(("states", "alpha", "beta", "known"), CASES)
def test_the_residual_is_the_right_hand_side_less_matrix_times_vector(states, alpha, beta, known):
    system = contact_system(states, known, PARAMETERS._replace(alpha=alpha, beta=beta))
    values = without_pressure(system, random_vector(system))
    residual = system.residual(values[:, None], np.zeros(1), no_defects(system))[:, 0]
    matrix = system_matrix(system)
    scale = np.abs(matrix) @ np.abs(values)
    # without weights the coupling is a product of moments, which the nodes meet to 1e-9
    normal, tangential = 1e-9, 1e-9
    if states != FULL_STICK:
        normal = 1e-9 if alpha else 1e-13
        tangential = 1e-9 if beta else 1e-13
    is_pressure = np.arange(system.unknowns) < system.pressure_terms
    allowed = np.where(is_pressure, normal, tangential)
    assert (np.abs(residual + matrix @ values) <= allowed * scale).all()


@every_state
def test_the_right_hand_side_of_unit_approach_is_the_load_of_the_functions(states):
    system = contact_system(states, known=False)
    nothing = np.zeros((system.unknowns, 1))
    right = system.residual(nothing, np.ones(1), no_defects(system))[:, 0]
    pressure, shear = right[: system.pressure_terms], right[system.pressure_terms :]
    assert pressure == pytest.approx(system.load_row, rel=1e-10, abs=1e-14)
    assert not shear.any()


@known_or_not
@every_state
def test_the_tangential_residual_is_the_drive_less_the_half_integral(states, known):
    system = contact_system(states, known)
    values = random_vector(system)
    residual = system.pointwise_residual(values[:, None], np.ones(1), no_defects(system))
    fields = both_fields(system, values)
    assert len(residual.tangential) == system.stick_parts[-1] + 1
    for i, found in enumerate(residual.tangential):
        points = system.parts[i].mesh.points(system.operators.nodes[i].d[::7])
        expected = np.zeros(len(points.z))
        size = np.zeros(len(points.z))
        for part, (pressure, shear) in zip(system.parts, fields, strict=True):
            inner = inner_integral(part.mesh, points) @ pressure
            drive = 2.0 * PARAMETERS.kappa / np.sqrt(points.z) * inner
            outer = half_integral(part.mesh, points) @ shear
            expected += drive - outer
            size += np.abs(drive) + np.abs(outer)
        assert (np.abs(found[::7, 0] - expected) <= 1e-11 * size.max()).all()


@known_or_not
def test_the_residual_in_slip_is_that_of_all_parts(known):
    system = contact_system((0, 1, 0, -1), known)
    values = random_vector(system)
    fields = both_fields(system, values)
    annulus = system.slip_annulus(1)
    found = system.residual_on_annulus(values[:, None], annulus)
    for mesh, residual in zip(annulus.meshes, found, strict=True):
        points = mesh.sampling()
        expected = np.zeros(len(points.offset))
        for part, (pressure, shear) in zip(system.parts, fields, strict=True):
            inner = inner_integral(part.mesh, points) @ pressure
            expected += 2.0 * PARAMETERS.kappa / np.sqrt(points.z) * inner
            expected -= half_integral(part.mesh, points) @ shear
        assert np.abs(residual[:, 0] - expected).max() < 1e-11 * np.abs(expected).max()


@known_or_not
@every_boundary
def test_rows_at_boundaries_are_integrals_there(states, known):
    system = contact_system(states, known)
    values = random_vector(system)
    fields = both_fields(system, values)
    rows = system.boundary_rows
    for j, radius in enumerate(system.radii):
        at_boundary = OffsetRadii(radius, np.zeros(1))
        inner = 0.0
        outer = 0.0
        for part, (pressure, shear) in zip(system.parts, fields, strict=True):
            if part.zone <= j:
                inner += float((inner_integral(part.mesh, at_boundary) @ pressure)[0])
            else:
                outer += float((half_integral(part.mesh, at_boundary) @ shear)[0])
        drive = 2.0 * PARAMETERS.kappa * inner / radius.value
        assert rows.stick_target[j] @ values == pytest.approx(drive, rel=1e-10)
        assert rows.residual[j] @ values == pytest.approx(drive - outer, rel=1e-10, abs=1e-12)


@known_or_not
@every_boundary
def test_no_jump_of_a_continuous_traction(states, known):
    """Under the pressure p with u = f p/s in stick, too, q is f p on both sides."""
    system = contact_system(states, known)
    pressure = known_pressure(PARAMETERS.alpha)
    values = np.zeros(system.unknowns)
    if known:
        values[0] = 1.0
    else:
        for part, on_part in zip(system.parts, system.pressure_maps, strict=True):
            coefficients = part.mesh.expand(pressure.evaluate(part.mesh.sampling().y)[None])[0]
            values[on_part.place] = coefficients[part.mesh.panels.functions(part.pressure_degrees)]
    places = {k: system.shear_maps[k].place for k in system.stick_parts}
    for k, place in places.items():
        part = system.parts[k]
        if part.boundary_number < 0:
            continue
        points = part.shear_mesh.sampling()
        sign = system.states[part.boundary_number] + system.states[part.boundary_number + 1]
        traction = sign * PARAMETERS.friction * pressure.evaluate(points.y)
        coefficients = part.shear_mesh.expand((traction / np.sqrt(points.z))[None])[0]
        values[place] = coefficients[part.shear_mesh.panels.functions(part.shear_degrees)]
    jumps = system.jump_rows @ values
    assert np.abs(jumps).max() < 1e-5  # what tails of 3e-6 and degree 6 leave
    # half of the traction in stick is missing: that is the jump
    for place in places.values():
        values[place] *= 0.5
    expected = [
        -0.5
        * (system.states[j] + system.states[j + 1])
        * PARAMETERS.friction
        * pressure.evaluate(r.rest)
        for j, r in enumerate(system.radii)
    ]
    assert system.jump_rows @ values == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("states", "alpha", "beta", "known"), [case for case in CASES if case[0] != FULL_STICK]
)
def test_defects_make_the_traction_continuous_or_the_residual_zero(states, alpha, beta, known):
    system = contact_system(states, known, PARAMETERS._replace(alpha=alpha, beta=beta))
    fields = solved(system)
    residual = system.residual(fields.values[:, None], np.ones(1), fields.defects[:, None])[:, 0]
    matrix = system_matrix(system)
    scale = np.abs(matrix) @ np.abs(fields.values) + 1e-300
    assert (np.abs(residual) <= 1e-9 * scale)[matrix.diagonal() != 0.0].all()
    if beta > 0.0:
        jumps = np.abs(system.jump_rows) @ np.abs(fields.values)
        assert (np.abs(system.jump_rows @ fields.values) <= 1e-12 * jumps).all()
    else:
        expected = system.boundary_rows.residual @ fields.values
        assert fields.defects == pytest.approx(-expected, rel=1e-6, abs=1e-12)


@every_state
def test_with_little_coupling_it_is_the_system_of_a_known_pressure(states):
    kappa = 1e-5
    relative = PARAMETERS.friction
    known = solved(
        contact_system(states, True, PARAMETERS._replace(kappa=1.0), degrees=12, capacity=14)
    )
    coupled_parameters = PARAMETERS._replace(kappa=kappa, friction=kappa * relative)
    coupled = solved(contact_system(states, False, coupled_parameters, degrees=12, capacity=14))
    assert coupled.approach == pytest.approx(
        solve_normal(0.1, 1e-8, 3000).best.value.approach, 1e-8
    )
    shears = [
        fields.system.total_shear(fields.values) * fields.approach / fields.system.parameters.kappa
        for fields in (known, coupled)
    ]
    assert shears[1] == pytest.approx(shears[0], rel=1e-7)
    assert coupled.boundary_residual == pytest.approx(known.boundary_residual, rel=1e-6, abs=1e-8)


@every_state
def test_loads_and_shears_are_those_of_the_fields(states):
    system = contact_system(states, known=False)
    values = random_vector(system)
    load = 0.0
    shear = 0.0
    for part, (p, u) in zip(system.parts, both_fields(system, values), strict=True):
        points, matrix = sources(part.mesh)
        # the quadrature of a disk has a root at the centre, which costs the shear its digits
        load += float((matrix @ p).sum())
        shear += 2.0 * np.pi * float(np.sqrt(points.z) @ (matrix @ u))
    assert system.load_row @ values[: system.pressure_terms] == pytest.approx(load, rel=1e-10)
    assert system.total_shear(values) == pytest.approx(shear, abs=5e-3)


def test_under_a_known_pressure_slip_bears_its_load():
    system = contact_system((0, 1, 0, -1), known=True, degrees=12, capacity=14)
    pressure = known_pressure(PARAMETERS.alpha)
    values = np.zeros(system.unknowns)
    values[0] = 1.0
    assert 2.0 * np.pi * system.load_row[0] == 1.0
    outside = 2.0 * np.pi * load_outside(pressure, np.array([one.rest for one in system.radii]))
    slipping = (outside[0] - outside[1]) - outside[2]
    assert system.total_shear(values) == pytest.approx(PARAMETERS.friction * slipping, rel=1e-7)


def test_parts_fill_the_contact():
    system = contact_system((0, 1, 0, -1), known=False)
    assert sum(part.mesh.extent for part in system.parts) == pytest.approx(1.0, rel=1e-14)
    assert [part.zone for part in system.parts] == [0, 1, 1, 2, 2, 3, 3]
    assert [part.boundary_number for part in system.parts] == [0, 0, 1, 1, 2, 2, -1]
    assert system.stick_parts == [0, 3, 4]
    assert system.parts[-1].mesh.boundary == EDGE


@known_or_not
@every_state
def test_a_coarse_difference_is_what_a_solve_without_top_degrees_lacks(states, known):
    system = contact_system(states, known)
    factors = factored(system)
    scale = 1.0 / np.sqrt(np.maximum(np.abs(system_matrix(system).diagonal()), 1e-300))
    defects = np.full((len(system.radii), 1), 0.1)
    solution = np.zeros((system.unknowns, 1))
    solution[0] = float(known)
    for _ in range(3):
        solution += factors.step(system.residual(solution, np.ones(1), defects))
    for change, top in zip(
        factors.coarse_differences(solution[:, 0], system), system.top_degree_indices, strict=True
    ):
        coarse = solution[:, 0] - change
        kept = np.setdiff1d(np.arange(system.unknowns), top)
        residual = system.residual(coarse[:, None], np.ones(1), defects)[:, 0] * scale
        assert np.abs(coarse[top] / scale[top]).max() < 1e-12
        assert np.abs(residual[kept[int(known) :]]).max() < 1e-8


@known_or_not
@every_boundary
def test_factors_of_boundaries_close_by_correct_to_the_solution(states, known):
    system = contact_system(states, known)
    scale = np.sqrt(np.abs(system_matrix(system).diagonal()))
    defects = np.full((len(system.radii), 1), 0.1)
    solutions = []
    for factors in (factored(system), factored(contact_system(states, known, moved=1e-4))):
        values = np.zeros((system.unknowns, 1))
        values[0] = float(known)
        for _ in range(6):
            values += factors.step(system.residual(values, np.ones(1), defects))
        solutions.append(values[:, 0] * scale)
    assert np.abs(solutions[0] - solutions[1]).max() < 1e-11 * np.abs(solutions[0]).max()
