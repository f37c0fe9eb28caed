"""Times of a solver: repeats, cold and warm, one thread, and where they were taken."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from spectral_contact import Scene, SceneError
from spectral_contact.studies import Timing, this_machine, timing

SCENE = Scene(0.3, 0.5)


class Clock:
    """A clock that goes on only when work is done."""

    def __init__(self, costs):
        self.now, self.costs, self.calls = 0.0, iter(costs), 0

    def __call__(self):
        return self.now

    def solve(self, scene, resolution):
        self.calls += 1
        self.now += next(self.costs)


@pytest.fixture
def times(monkeypatch):
    def taken(costs, repeats):
        clock = Clock(costs)
        monkeypatch.setattr(timing.Timer.__init__, "__defaults__", ("pass", "pass", clock, None))
        found = timing.times_of(clock.solve, SCENE, 4, repeats).warm
        assert clock.calls == found.repeats
        return found

    return taken


def test_repeats_are_as_many_as_asked_for(times):
    assert times([1.0, 2.0, 6.0], 3) == Timing(2.0, 1.5, 4.0, 3)


def test_short_solves_are_repeated_for_a_while_and_not_for_ever(times):
    assert times([0.05] * 9, 2).repeats == 4
    assert times([0.03] * 20, 3).repeats == 12
    assert 1000 <= times([1e-9] * 2000, 5).repeats < 2000


def test_median_and_quartiles():
    one = Timing.of([5.0, 1.0, 2.0, 4.0, 30.0])
    assert one == Timing(4.0, 2.0, 5.0, 5)


@pytest.mark.parametrize("seconds", [[], [-1.0], [np.nan], "now"])
def test_times_are_numbers(seconds):
    with pytest.raises(SceneError, match="seconds"):
        Timing.of(seconds)


def test_a_solver_is_cold_if_it_can_empty_its_caches():
    class Solver:
        state = "warm"

        def clear_caches(self):
            self.state = "cold"

        def __call__(self, scene, resolution):
            told.append(self.state)
            self.state = "warm"

    told = []
    found = timing.times_of(Solver(), SCENE, 4, 3)
    assert told[:4] == ["cold", "cold", "cold", "warm"]
    assert "cold" not in told[4:]
    assert found.cold.repeats == 3
    assert timing.times_of(lambda scene, resolution: None, SCENE, 4, 3).cold is None


def test_every_solver_has_one_thread():
    held = []

    def own(*_):
        held.extend(one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas")

    with threadpool_limits(3, "blas"):
        timing.times_of(own, SCENE, 4, 1)
    assert set(held) == {1}


def test_a_machine_is_text_and_versions():
    found = this_machine()
    assert found["numpy"] == np.__version__
    assert found["cores"] >= 1
    assert all(found.values())
