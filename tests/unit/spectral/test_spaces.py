import threading

import numpy as np
import pytest
from mpmath.ctx_mp import MPContext
from numpy.testing import assert_allclose, assert_array_equal
from oracles.whole_spaces import half_integrals, ordered, whole_space
from scipy import linalg, special

from spectral_contact.fields.series import LogSeries
from spectral_contact.spectral.blocks import disk_shear
from spectral_contact.spectral.cache import cache_sizes, clear_caches
from spectral_contact.spectral.panels import LogPanels
from spectral_contact.spectral.spaces import UNCUT_DISK, Space, unit_space

mp = MPContext()
mp.dps = 30

KINDS = pytest.mark.parametrize("kind", ["normal", "tangential"])
PANELS = [
    LogPanels(6, 2.0, 12),
    LogPanels(1, 1.0, 3),
    LogPanels(20, 2.0, 6),
    LogPanels(4, 2.0, 8, power=-0.5),
    LogPanels(4, 2.0, 8, root_tail=True),
    LogPanels(4, 2.0, 8, power=-0.5, root_tail=True),
]
MESHES = pytest.mark.parametrize("panels", PANELS, ids=str)


def constant(panels):
    """Return the coefficients of ``d**power``."""
    ones = np.zeros(panels.size)
    ones[: panels.count * (panels.degree + 1) : panels.degree + 1] = 1.0
    ones[-panels.tail_terms] = 1.0
    return ones


def series(panels, coefficients):
    table = coefficients[: -panels.tail_terms].reshape(panels.count, -1)
    tail = coefficients[-panels.tail_terms :]
    return LogSeries(table, tail, panels.width, panels.power, panels.root_tail)


def basis_values(panels, d):
    return np.stack([series(panels, row)(d) for row in np.eye(panels.size)], axis=1)


# --- the matrices ---------------------------------------------------------------------------------


@MESHES
@KINDS
def test_gram_is_symmetric_and_positive_definite(panels, kind):
    gram = whole_space(panels, kind).gram
    assert_array_equal(gram, gram.T)
    scale = 1 / np.sqrt(gram.diagonal())
    assert np.linalg.eigvalsh(gram * scale * scale[:, None])[0] > 1e-8


@MESHES
@KINDS
def test_gram_is_the_product_of_half_integrals(panels, kind):
    space = whole_space(panels, kind)
    h, w, gram = half_integrals(space), space.measure, ordered(space, space.gram)
    scale = np.sqrt(gram.diagonal())
    product = h.T @ (w[:, None] * h)
    assert (np.abs(product - gram) / np.outer(scale, scale)).max() < 3e-15


@pytest.mark.parametrize("degree", [1, 2, 4, 8, 12, 16, 20])
@pytest.mark.parametrize(("power", "root"), [(0.0, False), (-0.5, False), (0.0, True)])
@KINDS
def test_quadrature_is_converged_for_every_entry(kind, power, root, degree):
    # the functions are nested: a higher degree brings more nodes for the same entries
    few = LogPanels(4, 2.0, degree, power, root)
    many = LogPanels(4, 2.0, degree + 18, power, root)
    shared = np.concatenate(
        [
            (np.arange(4)[:, None] * (many.degree + 1) + np.arange(degree + 1)).ravel(),
            np.arange(4 * (many.degree + 1), many.size),
        ]
    )
    gram, finer = (ordered(one, one.gram) for one in (whole_space(p, kind) for p in (few, many)))
    finer = finer[np.ix_(shared, shared)]
    scale = np.sqrt(finer.diagonal())
    assert (np.abs(gram - finer) / np.outer(scale, scale)).max() < 3e-14


@MESHES
def test_half_integrals_of_the_constant(panels):
    # 1/2 int dz / sqrt(z - t^2) = sqrt(d); with the weight 1/sqrt(d) it is pi/2
    space = whole_space(panels)
    exact = np.pi / 2 if panels.power else np.sqrt(space.y)
    found = space.half_integral(constant(panels))
    # in the mean: next to the tail the rounding of d stands under a root
    assert space.weights @ np.abs(found / exact - 1) < 2e-15
    assert np.abs(found / exact - 1).max() < 1e-11


@MESHES
@KINDS
def test_energy_of_the_constant(panels, kind):
    space = whole_space(panels, kind)
    # (1/pi) int F^2 t^(0 or 2) dt with F = sqrt(1 - t^2) or pi/2
    fields = {("normal", 0): 2 / 3, ("tangential", 0): 2 / 15}
    weighted = {("normal", 1): np.pi**2 / 4, ("tangential", 1): np.pi**2 / 12}
    exact = (fields | weighted)[kind, int(panels.power != 0)] / np.pi
    ones = constant(panels)
    assert_allclose(ones @ ordered(space, space.gram) @ ones, exact, rtol=3e-15)


def eigenvalue(degree, order):
    a, b = (degree + order) / 2, (degree - order) / 2
    return special.poch(a + 1, -0.5) * special.poch(b + 1, -0.5) / 4


@pytest.mark.parametrize("root", [False, True])
@KINDS
def test_eigenvalues_are_the_exact_ones(kind, root):
    # N[u] = lambda sqrt(y) u for u = P_l(sqrt y)/sqrt(y), and T[s u] likewise with P_l^1
    panels = LogPanels(16, 2.0, 20, -0.5, root)
    space = whole_space(panels, kind)
    values = basis_values(panels, space.y)
    order = int(kind == "tangential")
    # int phi psi sqrt(y) s^(1 or 3) ds, with ds = dt on the nodes
    density = space.weights * np.sqrt(space.y) * space.t ** (2 * order + 1)
    mass = values.T @ (density[:, None] * values)
    scale = 1 / np.sqrt(mass.diagonal())
    gram = ordered(space, space.gram)
    found = linalg.eigvalsh(gram * scale * scale[:, None], mass * scale * scale[:, None])[::-1]
    exact = [eigenvalue(2 * k + order, order) for k in range(7)]
    assert_allclose(found[:7], exact, rtol=2e-14)


@MESHES
def test_weights_integrate_over_the_radius(panels):
    for kind, exact in (("normal", 1.0), ("tangential", 1 / 3)):
        assert_allclose(whole_space(panels, kind).measure.sum() * np.pi, exact, rtol=3e-15)


@MESHES
def test_shear_moments(panels):
    # 2 pi int s u s ds = pi int u sqrt(1 - d) dd
    moments = disk_shear(panels, (panels.degree,) * panels.count)
    exact = np.pi * special.beta(1 + panels.power, 1.5)
    assert_allclose(moments @ constant(panels), exact, rtol=3e-15)
    end = mp.exp(-mp.mpf(panels.width))
    power = mp.mpf(panels.power)
    for k in (1, panels.degree):

        def integrand(d, k=k):
            x = -2 * mp.log(d) / mp.mpf(panels.width) - 1
            return mp.pi * mp.legendre(k, x) * d**power * mp.sqrt(1 - d)

        exact = float(mp.quad(integrand, mp.linspace(end, 1, 4)))
        assert abs(moments[k] - exact) < 4e-15 * moments[0]


def test_weighted_functions_have_no_mass():
    # 1/sqrt(y) is not square integrable: such panels serve zero compliance alone
    assert not np.any(whole_space(LogPanels(4, 2.0, 8, power=-0.5)).mass)


# --- spaces ---------------------------------------------------------------------------------------


def test_a_space_chooses_degrees():
    panels = LogPanels(4, 2.0, 6)
    space = unit_space(panels, (6, 3, 1, 0))
    expected = [*range(7), *range(7, 11), 14, 15, 21, *range(28, 31)]
    assert space.unknowns == len(expected)
    assert sorted(space.index.tolist()) == expected
    # the coarser space, two degrees less but one function at least, comes first
    coarser = [*range(5), 7, 8, 14, 21, 28, 29]
    assert space.index[: space.coarsest_unknowns].tolist() == coarser


def dense(space, compliance):
    return space.gram + compliance * space.mass


def moments(space, target):
    return (half_integrals(space)[:, space.index].T * space.measure) @ target


DEGREES = (8, 7, 6, 6, 4, 2)


def some_space(kind="normal"):
    return unit_space(LogPanels(6, 2.0, 8), DEGREES, shear=kind == "tangential")


def some_targets():
    d = some_space().y
    return np.stack([np.full(len(d), 2.0), d, np.cos(3 * d)], axis=1)


# --- solving --------------------------------------------------------------------------------------


@KINDS
@pytest.mark.parametrize("compliance", [0.0, 1e-6, 1e-3, 0.5, 1e6])
def test_solve_is_the_regularised_least_squares_problem(kind, compliance):
    space, targets = some_space(kind), some_targets()
    matrix = dense(space, compliance)
    solution = space.factor(compliance).solve(targets[:, 0])
    assert solution.shape == (space.size,)
    expected = np.linalg.solve(matrix, moments(space, targets[:, 0]))
    scale = np.sqrt(matrix.diagonal())
    difference = scale * (solution[space.index] - expected)
    assert np.abs(difference).max() < 1e-11 * np.linalg.norm(scale * expected)
    outside = np.setdiff1d(np.arange(len(solution)), space.index)
    assert len(outside)
    assert_array_equal(solution[outside], 0.0)


@pytest.mark.parametrize("compliance", [1e-6, 1e-2, 2.0])
def test_the_load_of_a_lift(compliance):
    # (c M + K) a = H^T W target - c load
    space, target = some_space(), some_targets()[:, 1]
    load = 1e-3 / (1 + np.arange(space.size))
    solution = space.factor(compliance).solve(target, load)[space.index]
    matrix = dense(space, compliance)
    right = moments(space, target) - compliance * load[space.index]
    scale = np.sqrt(matrix.diagonal())
    assert np.abs((matrix @ solution - right) / scale).max() < 1e-14
    without = space.factor(compliance).solve(target)[space.index]
    assert np.abs(scale * (solution - without)).max() > 1e-10


def test_very_compliant_layers_are_winkler_foundations():
    # alpha p = delta, with relative corrections of 1/alpha
    panels = LogPanels(6, 2.0, 8)
    space = whole_space(panels)
    solution = space.factor(1e14).solve(np.full(len(space.y), 2.0))
    d = np.geomspace(1e-9, 1, 50)
    assert_allclose(1e14 * series(panels, solution)(d), 1.0, rtol=3e-14)


REFERENCE = {  # theory, table 7: delta and p(1)
    0.5: (0.29295979691047814, 0.37980995507974310),
    1.0: (0.452701390869753, 0.35044541816021),
}


@pytest.mark.parametrize("alpha", REFERENCE)
def test_normal_contact_by_hand(alpha):
    panels = LogPanels(18, 2.0, 16)
    space = whole_space(panels)
    unit = space.factor(alpha).solve(np.full(len(space.y), 2.0))
    load = 4 * space.weights @ space.half_integral(unit)  # 2 pi int p s ds
    approach, pressure = 1 / load, unit / load
    edge = series(panels, pressure).limit
    exact_approach, exact_edge = REFERENCE[alpha]
    assert_allclose(approach, exact_approach, rtol=3e-15)
    assert_allclose(edge, exact_edge, rtol=3e-14)
    # 2 pi alpha p(1)^2 = delta + alpha d delta/d alpha, d delta/d alpha = 2 pi int p^2 s ds
    slope = 2 * np.pi * pressure @ ordered(space, space.mass) @ pressure
    assert_allclose(2 * np.pi * alpha * edge**2, approach + alpha * slope, rtol=3e-14)


@pytest.mark.parametrize("alpha", [1e-12, 1e-9])
def test_the_correction_saves_the_edge_where_the_layer_is_stiff(alpha):
    panels = LogPanels(30, 2.0, 16)
    space = whole_space(panels)
    factored, mass = space.factor(alpha), ordered(space, space.mass)
    errors = []
    for correct in (True, False):
        unit = factored.solve(np.full(len(space.y), 2.0), correct=correct)
        approach = 1 / (4 * space.weights @ space.half_integral(unit))
        pressure = unit * approach
        slope = 2 * np.pi * pressure @ mass @ pressure
        edge = series(panels, pressure).limit
        errors.append(abs(2 * np.pi * alpha * edge**2 / (approach + alpha * slope) - 1))
        if alpha == 1e-12 and correct:
            assert_allclose(edge, 141047.39588952, rtol=1e-13)
            assert_allclose(approach, 0.125000000002324, rtol=5e-15)
    assert errors[0] < 2e-14
    assert errors[1] > 1e-12


@pytest.mark.parametrize("alpha", [1e-2, 0.5])
def test_the_approach_falls_as_the_space_grows(alpha):
    found = []
    for degree in (0, 1, 2, 3, 4):
        space = unit_space(LogPanels(10, 2.0, 12), (degree,) * 10)
        unit = space.factor(alpha).solve(np.full(len(space.y), 2.0))
        found.append(1 / (4 * space.weights @ space.half_integral(unit)))
    assert np.all(np.diff(found) < 0)


def test_an_indefinite_matrix_is_refused():
    space = Space(UNCUT_DISK, ((LogPanels(2, 1.0, 3), (3, 3)),))
    space.mass = 1e3 * (1 - np.eye(space.unknowns))
    with pytest.raises(ArithmeticError, match="not positive definite at pivot 2"):
        space.factor(1.0)


# --- the change to the coarser space --------------------------------------------------------------


@KINDS
@pytest.mark.parametrize("compliance", [0.0, 1e-3, 0.5])
@pytest.mark.parametrize("degrees", [DEGREES, (8,) * 6, (3, 2, 1, 0, 0, 1)])
@pytest.mark.parametrize("shed", [2, 1])
def test_change_is_the_difference_to_the_coarser_solution(kind, compliance, degrees, shed):
    space = unit_space(LogPanels(6, 2.0, 8), degrees, shear=kind == "tangential")
    target = np.cos(3 * space.y)
    factored = space.factor(compliance)
    solution = factored.solve(target)
    change = factored.change(solution, degrees=shed)
    matrix, right = dense(space, compliance), moments(space, target)
    k = space.coarsest_unknowns if shed == 2 else space.coarse_unknowns
    coarser = np.zeros_like(solution)
    coarser[space.index[:k]] = np.linalg.solve(matrix[:k, :k], right[:k])
    scale = np.sqrt(matrix.diagonal())
    difference = scale * (change.coefficients - (coarser - solution))[space.index]
    assert np.abs(difference).max() < 1e-12 * np.linalg.norm(scale * solution[space.index])
    assert np.linalg.norm(scale * change.coefficients[space.index]) > 0


def test_a_panel_sheds_its_highest_degrees_and_the_tail_one_function():
    space = unit_space(LogPanels(4, 2.0, 5), (5, 2, 1, 0))
    terms, size = 6, space.size
    both = {4, 5, terms + 1, terms + 2, 2 * terms + 1, size - 1}
    assert set(space.index[space.coarsest_unknowns :]) == both
    assert set(space.index[space.coarse_unknowns :]) == both - {4, terms + 1}


def test_energies_of_the_change_are_by_panel():
    space = some_space()
    factored = space.factor(0.5)
    change = factored.change(factored.solve(some_targets()[:, 2]))
    energy = dense(space, 0.5).diagonal() * change.coefficients[space.index] ** 2
    panel = space.index // 9  # 6 is the tail
    expected = [energy[panel == j].sum() for j in range(7)]
    assert_allclose(change.energies, expected, rtol=1e-13)


def test_change_keeps_its_digits_where_the_difference_has_none():
    # converged to rounding: the two solutions agree to 1e-15, and the change is still known
    panels = LogPanels(14, 2.0, 16)
    space = whole_space(panels)
    factored = space.factor(0.5)
    solution = factored.solve(np.full(len(space.y), 2.0))
    change = factored.change(solution)
    shed = np.abs(change.coefficients).max()
    assert 0 < shed < 1e-11 * np.abs(solution).max()


# --- caches ---------------------------------------------------------------------------------------


def test_spaces_are_assembled_once():
    space = unit_space(LogPanels(3, 2.0, 5), (5, 4, 3))
    assert unit_space(LogPanels(3, 2.0, 5), (5, 4, 3)) is space
    assert unit_space(LogPanels(3, 2.0, 5), (5, 4, 3), shear=True) is not space
    assert unit_space(LogPanels(3, 2.0, 5), (5, 4, 2)) is not space
    assert unit_space(LogPanels(3, 2.0, 5, root_tail=True), (5, 4, 3)) is not space


def test_clearing_forgets_the_spaces_but_breaks_none():
    panels = LogPanels(3, 2.0, 5)
    space = whole_space(panels)
    gram = space.gram.copy()
    sizes = cache_sizes()
    assert sizes["spaces"] >= 1
    assert sizes["half-integrals"] >= 1
    clear_caches()
    assert set(cache_sizes()) >= {"spaces", "half-integrals"}
    assert not any(cache_sizes().values())
    again = whole_space(panels)
    assert again is not space
    assert_array_equal(again.gram, gram)
    assert_array_equal(space.gram, gram)


def test_the_cache_of_spaces_is_bounded():
    clear_caches()
    for n in range(1, 121):
        unit_space(LogPanels(1, 0.1 * n, 1), (1,))
    assert 1 <= cache_sizes()["spaces"] < 120


def test_threads_solve_alike():
    clear_caches()
    results = []
    start = threading.Barrier(4)

    def work():
        start.wait()
        space = unit_space(LogPanels(5, 2.0, 10), (10,) * 5)
        results.append(space.factor(0.5).solve(np.full(len(space.y), 2.0)))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 4
    for result in results[1:]:
        assert_array_equal(result, results[0])


def test_assembly_itself_is_repeatable():
    first, second = (Space(UNCUT_DISK, ((LogPanels(3, 2.0, 5), (5, 4, 3)),)) for _ in range(2))
    assert_array_equal(first.gram, second.gram)
