"""The first unloading in fixed point, for the gold tables.

With q0 the traction at the largest load and q that at the load ratio lambda, the field
``e = (q0 - q)/(1 - lambda)`` obeys the equation of unit load, ``beta e + T e = kappa g``, wherever
the surface sticks at lambda: where it has slipped before, too, since it keeps its displacement
(docs/cycles). Where it slips with the sense sigma, q is ``sigma f lambda p`` and e is given by q0
and p. So no slip of the largest load enters, which `spectral_contact.contact.unloading` solves
with. Fields are those of `spectral_contact.precise`, for ``kappa = 1``.

The zones and first guesses of their boundaries are those of `solve`. The friction law is checked at
all nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from spectral_contact import ConvergenceError, Scene, Solution, solve
from spectral_contact.fields.series import Radius
from spectral_contact.precise.fixed import DoubleFactors, Fixed, Ints
from spectral_contact.precise.precise_run import PreciseRun
from spectral_contact.precise.reference_solution import ReferenceSolution
from spectral_contact.precise.search import lawful
from spectral_contact.precise.zone_trial import PreciseLayout, ZoneProblem, ZoneTrial
from spectral_contact.records import ErrorEstimates, Zone

#: Digits beyond those asked for and panel width, of the solution and of the one that checks it.
SOLUTION, CHECK = (4, 2.0), (2, 1.5)
#: Of first guesses.
CLOSE = 1e-10
#: Steps of the boundaries and of the tractions, at most.
STEPS = 20
#: Slopes are differences ``2**-STEP`` apart.
STEP = 50
#: Where in a zone the tractions are compared.
SHARES = (1e-9, 1e-3, 0.1, 0.25, 0.5, 0.75, 0.9, 0.999, 1.0 - 1e-9)


class UnloadedPart(NamedTuple):
    """A zone of the unloaded state, or a part of one in which the surface did one thing before.

    Attributes
    ----------
    state, before : int
        What it does now, and at the largest load: 0 for stick, or the sense of slip.
    zone_before : int
        Number of the zone at the largest load; what `before` is of, and where q0 is evaluated.
    memory : bool
        Whether it sticks where it has slipped.
    """

    state: int
    before: int
    zone_before: int
    memory: bool


class UnloadedProblem(ZoneProblem):
    """The zones of e, with their meshes.

    Parameters
    ----------
    loaded : PreciseRun
        The state at the largest load.
    load_ratio : float
    parts : sequence of UnloadedPart
        From the centre outward.
    radii : sequence of Radius
        The boundaries between them.
    """

    def __init__(
        self,
        loaded: PreciseRun,
        load_ratio: float,
        parts: Sequence[UnloadedPart],
        radii: Sequence[Radius],
        digits: int,
        width: float,
    ) -> None:
        scene = loaded.scene
        alpha, beta = scene.normal_compliance, scene.tangential_compliance
        layout = PreciseLayout(tuple(part.state for part in parts), tuple(radii))
        super().__init__(loaded.drive, alpha, beta, loaded._friction, layout, digits, width)
        self.loaded, self.parts = loaded, parts
        f = loaded.fixed
        self.load_ratio = f.of(load_ratio)
        self.fall = f.one - self.load_ratio
        #: which boundaries are unknown: those between stick and slip
        self.free = [j for j, (a, b) in enumerate(pairwise(layout.states)) if a == 0 or b == 0]
        self.before_squares = [f.of(1 / (1 + f.mp.exp(-x))) for x in loaded.logits]

    def loaded_over_s(self, zone: int, z: Ints) -> Ints:
        """Return ``q0 / s`` at squares of radii in a zone that sticks at the largest load."""
        f, loaded = self.drive.fixed, self.loaded
        ends = [0 * f.one, *self.before_squares, f.one]
        if loaded._one_disk:
            radius = f.sqrt(ends[1])
            depth = np.clip(f.over(ends[1] - z, ends[1]), 1, f.one)
            return np.asarray(f.over(loaded.stick_disk.traction.at(depth), radius))
        series = loaded.annuli.tractions[zone]
        assert series is not None
        return series.at(np.maximum(z - ends[zone], 1), np.maximum(ends[zone + 1] - z, 1))

    def before(self, number: int, bound: Ints, z: Ints) -> Ints:
        """Return ``q0 / s`` in a part, from ``f p / s``."""
        part = self.parts[number]
        if part.before:
            return np.asarray(part.before * bound)
        return self.loaded_over_s(part.zone_before, z.ravel()).reshape(z.shape)

    def given(self, number: int, bound: Ints, z: Ints) -> Ints:
        """Return ``e / s`` in a part that slips, from ``f p / s``."""
        f = self.drive.fixed
        now = self.parts[number].state * f.times(self.load_ratio, bound)
        return np.asarray(f.over(self.before(number, bound, z) - now, self.fall))


class UnloadedTrial(ZoneTrial):
    """The problem with its boundaries given."""

    problem: UnloadedProblem

    def __init__(self, problem: UnloadedProblem, logits: Sequence[Any]) -> None:
        super().__init__(problem, logits)
        slipping = [k for k, state in enumerate(problem.states) if state]
        self.slip = {k: problem.given(k, self.bound(k), self.z[k]) for k in slipping}

    def _boundaries(self) -> list[tuple[int, int, Any, Any]]:
        """Return, of every free boundary, the part that sticks, its end, e/s outside, and f p/s."""
        f, problem = self._f, self.problem
        found = []
        for j in problem.free:
            stuck, end = (j, 1) if problem.states[j] == 0 else (j + 1, 0)
            z, y = (np.array([one[j + 1]], dtype=object) for one in (self.squares, self.rests))
            bound = f.over(f.times(problem.friction, problem.drive.pressure(y)), f.sqrt(z))
            found.append((stuck, end, problem.given(2 * j + 1 - stuck, bound, z)[0], bound[0]))
        return found

    def mismatch(self, flat: Ints) -> Ints:
        """Return by how much e is discontinuous at the free boundaries, over f p."""
        f, values = self._f, self.problem.split(flat)
        jumps = [
            f.over(self.problem.meshes[stuck].limits(values[stuck])[end] - given, bound)
            for stuck, end, given, bound in self._boundaries()
        ]
        return np.array(jumps, dtype=object)

    def conditions(self) -> Any:
        """Return the matrix of the mismatch in double precision."""
        f, problem = self._f, self.problem
        rows = np.zeros((len(problem.free), problem.offsets[-1]))
        for row, (stuck, end, _, bound) in zip(rows, self._boundaries(), strict=True):
            limit = problem.meshes[stuck].blocks.limit
            values = problem.split(row)[stuck]
            values[-end] = f.floats(f.over(limit[::-1] if end else limit, bound))
        return rows


class UnloadedRun(PreciseRun):
    """A state below the largest load, on meshes of one panel width.

    What `PreciseRun` says of tractions on zones is said of e here: its zones are those of e.

    Parameters
    ----------
    scene : Scene
        With `unloaded_to` below 1 and tangential compliance.
    guess : Solution
        Its solution in double precision.
    digits : int
        Relative accuracy aimed at.
    width : float
        Panel width.
    layout : PreciseLayout
        The zones at the largest load.
    """

    def __init__(
        self, scene: Scene, guess: Solution, digits: int, width: float, layout: PreciseLayout
    ) -> None:
        self.parts, radii = parts_of(guess, layout)
        own = PreciseLayout(tuple(part.state for part in self.parts), radii)
        super().__init__(scene, digits, width, own, held=True)
        self.loaded = PreciseRun(scene.replace(unloaded_to=1.0), digits, width, layout)
        scales = own.decades(scene.normal_compliance, scene.tangential_compliance, digits, width)
        bits = max(self.loaded.fixed.bits, int((scales + 10.0) * 3.33) + 64)
        self.fixed = self.loaded.fixed = Fixed(bits)
        _ = self.loaded.approach, self.loaded.total_shear
        self.load_ratio = self.fixed.mp.mpf(scene.unloaded_to)
        self.problem = UnloadedProblem(
            self.loaded, scene.unloaded_to, self.parts, radii, digits, width
        )
        self._solve([self.fixed.mp.mpf(radius.logit) for radius in radii], digits)

    def _solve(self, logits: list[Any], digits: int) -> None:
        """Find the tractions and the boundaries."""
        f, problem, goal = self.fixed, self.problem, 10.0 ** -(digits + 1)
        for j in range(len(logits)):
            if j not in problem.free:  # where it changes what it did before
                logits[j] = min(self.loaded.logits, key=lambda x: abs(x - logits[j]))
        trial = UnloadedTrial(problem, logits)
        factors = DoubleFactors(trial.matrix())
        flat = np.zeros(problem.offsets[-1], dtype=object)
        flat = _refined(factors, trial, flat, 1e-8)
        slopes = _slopes(factors, trial, flat)
        for _ in range(STEPS):
            flat = _refined(factors, trial, flat, goal)
            if not problem.free:
                break
            shift = -np.linalg.solve(slopes, f.floats(trial.mismatch(flat)))
            if np.abs(shift).max() <= goal:
                break
            logits = list(logits)
            for j, step in zip(problem.free, shift.tolist(), strict=True):
                logits[j] += f.mp.mpf(step)
            trial = UnloadedTrial(problem, logits)
        else:
            raise ConvergenceError("the zones do not settle", "ask for fewer digits")
        self.trial = trial
        self.annuli = trial.outcome(flat)
        self._values = problem.split(flat)

    def breach(self) -> float:
        """Return by how much the friction law is broken at nodes at most, relatively."""
        f, trial, problem = self.fixed, self.trial, self.problem
        moved = trial.displacement(self._values, range(trial.last + 1))
        largest = max(float(abs(f.floats(moved[k])).max()) for k in moved)
        worst = -1.0
        for k, part in enumerate(problem.parts):
            bound = trial.bound(k)
            if part.state:
                if k <= trial.last:
                    worst = max(worst, -float((part.state * f.floats(moved[k])).min()) / largest)
                continue
            q = problem.before(k, bound, trial.z[k]) - f.times(problem.fall, self._values[k])
            ratio = f.over(abs(q), f.times(problem.load_ratio, bound))
            worst = max(worst, float(f.floats(ratio).max()) - 1.0)
        return worst

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The zones, of which neighbouring parts that slip are one."""
        mp = self.fixed.mp
        ends = [(mp.zero, mp.one), *self.radii, (mp.one, mp.zero)]
        free = [0, *(j + 1 for j in self.problem.free), len(ends) - 1]
        found = []
        for a, b in pairwise(free):
            part = self.problem.parts[a]
            kind, sense = ("slip", part.state) if part.state else ("stick", 1)
            (inner, inside), (outer, outside) = ends[a], ends[b]
            found.append(Zone(kind, inner, outer, inside, outside, sense, part.memory))
        return tuple(found)

    @property
    def approach(self) -> Any:
        """``delta*``, in units of the largest load."""
        return self.load_ratio * self.loaded.approach

    @property
    def total_shear(self) -> Any:
        """``Q*``, in units of the largest load."""
        return self.loaded.total_shear - (1 - self.load_ratio) * super().total_shear

    def pressures(self, s: Any, from_edge: Any) -> Any:
        """Return p at mpmath's radii whose distances to the edge are given, too."""
        return self.load_ratio * self.loaded.pressures(s, from_edge)

    def _in_stick(self, zone: int, s: Any, from_edge: Any) -> Any:
        """Return q where a zone sticks, from e."""
        before = self.loaded.tractions(s, from_edge)
        return before - (1 - self.load_ratio) * super()._in_stick(zone, s, from_edge)


def parts_of(
    guess: Solution, layout: PreciseLayout
) -> tuple[list[UnloadedPart], tuple[Radius, ...]]:
    """Return the parts of an unloaded state, and roughly where they end.

    Zones that slip are cut where zones at the largest load end.
    """
    parts: list[UnloadedPart] = []
    radii: list[Radius] = []
    for zone in guess.zones:
        cuts = list[Radius]()
        if zone.kind == "slip":
            cuts = [radius for radius in layout.radii if zone.inner < radius.value < zone.outer]
        ends = [zone.inner, *(radius.value for radius in cuts), zone.outer]
        for inner, outer in pairwise(ends):
            middle = (inner + outer) / 2.0
            before = sum(radius.value < middle for radius in layout.radii)
            state = zone.sense if zone.kind == "slip" else 0
            parts.append(UnloadedPart(state, layout.states[before], before, zone.memory))
        radii += [*cuts, Radius(zone.outer, zone.outer_from_edge)]
    return parts, tuple(radii[:-1])


def _refined(factors: DoubleFactors, trial: UnloadedTrial, flat: Ints, goal: float) -> Ints:
    """Return the tractions of a trial to an accuracy."""
    for _ in range(STEPS):
        step = -factors.solved(trial._f.floats(trial.residual(flat)))
        flat = np.asarray(flat + trial._f.of(step))
        if trial.problem.relative_step(step, flat) <= goal:
            return flat
    raise ConvergenceError("the tractions do not settle", "ask for fewer digits")


def _slopes(factors: DoubleFactors, trial: UnloadedTrial, flat: Ints) -> Any:
    """Return the derivatives of the mismatch by the free boundaries, the tractions following."""
    f, free = trial._f, trial.problem.free
    if not free:
        return np.zeros((0, 0))
    residual, mismatch = trial.residual(flat), trial.mismatch(flat)
    columns, corner = [], []
    for j in free:
        logits = list(trial.logits)
        logits[j] += f.mp.ldexp(1, -STEP)
        moved = UnloadedTrial(trial.problem, logits)
        columns.append(f.floats((moved.residual(flat) - residual) << STEP))
        corner.append(f.floats((moved.mismatch(flat) - mismatch) << STEP))
    return np.array(corner).T - trial.conditions() @ factors.solved(np.array(columns).T)


def reference(scene: Scene, digits: int) -> ReferenceSolution:
    """Return a state below the largest load to many digits, of which two meshes agree.

    The error of the traction is relative to ``f p`` where the surface sticks with memory.

    Raises
    ------
    ConvergenceError
        If the friction law is broken, or digits are missing.
    """
    begin = perf_counter()
    guess = solve(scene, CLOSE, ("zones", "traction", "pressure"), strict=False)
    loaded = scene.replace(unloaded_to=1.0)
    zones = solve(loaded, 1e-9, ("zones", "traction"), strict=False).zones
    states = tuple(zone.sense if zone.kind == "slip" else 0 for zone in zones)
    layout = PreciseLayout(
        states, tuple(Radius(zone.outer, zone.outer_from_edge) for zone in zones[:-1])
    )
    layout = lawful(loaded, 12, 2.0, layout).layout  # the friction law at the largest load
    run, check = (
        UnloadedRun(scene, guess, digits + more, width, layout) for more, width in (SOLUTION, CHECK)
    )
    breach = max(run.breach(), check.breach())
    if breach > 10.0**-digits:
        raise ConvergenceError(f"the friction law is broken by {breach:.1e}", "try other zones")
    run.fixed.mp.dps = digits + 3
    return ReferenceSolution(
        scene=scene,
        digits=digits,
        approach=+run.approach,
        total_shear=+run.total_shear,
        stick_radius=run.zones[0].outer,
        zones=run.zones,
        edge_ratio=run.loaded.edge_ratio(),
        opening=None,
        error=_compared(run, check, digits),
        converged=True,
        unknowns=run.problem.offsets[-1],
        bits=run.fixed.bits,
        seconds=perf_counter() - begin,
        _run=run,
    )


def _compared(run: UnloadedRun, check: UnloadedRun, digits: int) -> ErrorEstimates:
    """Return twice the differences of two solutions, and no less than the check aims at."""
    mp, floor = run.fixed.mp, 10.0 ** -(digits + CHECK[0])

    def error(a: Sequence[Any], b: Sequence[Any], sizes: Sequence[Any]) -> float:
        ratios = [
            abs((v - mp.mpf(w)) / mp.mpf(size)) for v, w, size in zip(a, b, sizes, strict=True)
        ]
        return max(2.0 * float(max(ratios, default=0.0)), floor)

    ends = [mp.zero, *(b for b, _ in run.radii), mp.one]
    places = [a + (b - a) * mp.mpf(share) for a, b in pairwise(ends) for share in SHARES]
    s = np.array(places)
    p, q = run.pressures(s, 1 - s), run.tractions(s, 1 - s)
    zones = run.zones
    friction = mp.mpf(run.scene.friction)
    memory = [next(zone.memory for zone in zones if one <= zone.outer) for one in s]
    sizes = [friction * v if kept else abs(u) for v, u, kept in zip(p, q, memory, strict=True)]
    boundaries = [error(mine, its, its) for mine, its in zip(run.radii, check.radii, strict=True)]
    worst = max(boundaries, default=0.0)
    return ErrorEstimates(
        approach=error([run.approach], [check.approach], [run.approach]),
        pressure=error(p, check.pressures(s, 1 - s), p),
        traction=error(q, check.tractions(s, 1 - s), sizes),
        zones=worst,
        stick_radius=worst,
        total_shear=error([run.total_shear], [check.total_shear], [run.total_shear]),
    )
