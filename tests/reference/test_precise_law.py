"""The friction law on solutions to many digits: nothing between samples is missed."""

import math

import pytest

from spectral_contact import ConvergenceError, NotComputedError, Scene
from spectral_contact.fields.series import Radius
from spectral_contact.precise import search
from spectral_contact.precise.fixed import Fixed
from spectral_contact.precise.law_breaches import Breach, excesses, obeying
from spectral_contact.precise.precise_coupled_run import PreciseCoupledRun
from spectral_contact.precise.search import lawful
from spectral_contact.precise.zone_trial import PreciseLayout

NU = 0.3
STUCK = PreciseLayout((0,), ())
KAPPA = Scene(NU).kappa


def disk(c):
    return PreciseLayout((0, 1), (Radius(c, 1.0 - c),))


@pytest.fixture(scope="module")
def mesh():
    return STUCK.meshes(Fixed(240), 0.5, 0.5, 25, 2.0)[0]


@pytest.mark.parametrize(
    ("depth", "verdict"), [(1e-18, True), (0.0, False), (-1e-18, None)], ids=["dip", "touch", "gap"]
)
@pytest.mark.parametrize("sense", [1, -1])
def test_dips_far_narrower_than_the_nodes_are_found(mesh, depth, verdict, sense):
    f = mesh.fixed
    centre = f.of(0.7310001)
    offset = mesh.above - centre
    assert abs(offset).min() > f.of(1e-4)  # no node sees it
    margin = f.times(offset, offset) - f.of(depth)
    found = excesses(mesh, 0 * margin + f.one, sense * (f.one - margin), 25)
    if verdict is None:
        assert not found
        return
    [breach] = found
    assert (breach.decided, breach.wanted) == (verdict, sense)
    low, high = (float(1 / (1 + f.mp.exp(-x)) - f.numbers(centre)) for x in breach.ends)
    width = math.sqrt(depth) or 1e-11
    assert -2 * width <= low <= -0.5 * math.sqrt(depth)
    assert 0.5 * math.sqrt(depth) <= high <= 2 * width
    assert "from the edge" in str(breach)


def test_a_breach_at_the_edge_reaches_it(mesh):
    f = mesh.fixed
    margin = mesh.below - f.of(1e-12)
    [breach] = excesses(mesh, f.one + margin, 0 * margin + f.one, 25)
    assert breach.ends[1] == f.mp.inf
    assert breach.from_edge[1] == 0.0
    assert breach.from_edge[0] == pytest.approx(5e-13, rel=0.01)


def test_zones_as_the_law_asks_for_them():
    mp = Fixed(64).mp
    inf, places = mp.inf, (0.0, 0.0)
    inside = Breach(0, (mp.mpf(-2), mp.mpf(-1)), places, 1, 0.1, True)
    up_to_the_edge = Breach(1, (mp.mpf(3), inf), places, 0, 0.1, True)
    whole = Breach(1, (mp.mpf(1), inf), places, 0, 0.1, True)
    assert obeying((0, 1), [mp.mpf(1)], [inside, up_to_the_edge]) == (
        (0, 1, 0, 1, 0),
        (-2, -1, 1, 3),
    )
    assert obeying((0, 1), [mp.mpf(1)], [whole]) == ((0,), ())


def test_the_edge_that_sticks_in_a_hundred_millionth_is_found():
    """With slip up to the edge instead, its sense is wrong by 1e-5."""
    scene = Scene(NU, 0.05, 1.0, 0.02941066)
    run = lawful(scene, 8, 2.0, disk(0.5516847))
    assert run.layout.states == (0, 1, 0)
    assert float(run.radii[1][1]) == pytest.approx(3.691135246730e-8, rel=1e-8)
    assert not run.breaches()
    closer = Scene(NU, 0.05, 1.0, 0.2058735 * KAPPA)  # below the second threshold
    assert lawful(closer, 8, 2.0, disk(0.5516847)).layout.states == (0, 1)


def test_slip_that_double_precision_does_not_resolve():
    # friction is 1.7e-6 below the critical
    scene = Scene(0.04336918462060191, 1.717386608424937, 598.4614790885076, 0.000188084697310428)
    run = lawful(scene, 10, 2.0, STUCK)
    assert run.layout.states == (0, 1)
    assert float(run.radii[0][1]) == pytest.approx(2.36070735531e-5, rel=1e-9)


def test_zones_from_wrong_ones():
    """One zone too many, whose boundaries go nowhere: held, they say what is wrong."""
    wrong = PreciseLayout((0, 1, 0), (Radius(0.5, 0.5), Radius(0.99, 0.01)))
    run = lawful(Scene(NU, 0.05, 1.0, 0.15 * KAPPA), 5, 2.0, wrong)
    assert run.layout.states == (0, 1)
    assert float(run.radii[0][0]) == pytest.approx(0.373443, rel=1e-5)


def test_what_the_digits_do_not_decide_is_refused():
    critical = 0.2618982758102
    with pytest.raises(ConvergenceError, match=r"undecided between 0\.1454.* and 0\.145"):
        lawful(Scene(NU, 0.05, 1.0, critical * KAPPA), 9, 2.0, STUCK)


def test_a_search_that_finds_nothing_says_where_the_law_is_broken(monkeypatch):
    monkeypatch.setattr(search, "_MOST_ROUNDS", 1)
    message = r"\|q\| exceeds f p by 1\..e-02 between 0\.008"
    with pytest.raises(ConvergenceError, match=message):
        lawful(Scene(NU, 0.5, 0.5, 0.1), 6, 2.0, STUCK)


@pytest.mark.parametrize(
    ("alpha", "beta", "friction", "sticks"),
    [
        (0.5, 0.5, 0.1016, True),
        (0.5, 0.5, 0.1015, False),
        (0.0, 0.5, 0.2, True),
        (0.0, 0.5, 0.05, False),
        (1e-6, 1e-6, 3.0, False),  # the pressure is negative at the edge
    ],
)
def test_full_stick_with_coupling(alpha, beta, friction, sticks):
    scene = Scene(NU if alpha else 0.2, alpha, beta, friction, coupling=True)
    assert (not PreciseCoupledRun(scene, 6, 2.0).breaches()) == sticks


def test_coupled_slip_is_told():
    with pytest.raises(NotComputedError, match=r"it slips: \|q\| exceeds f p by 6\.7e-04"):
        lawful(Scene(NU, 0.5, 0.5, 0.1015, coupling=True), 8, 2.0, STUCK)
