"""The friction law on a solution in fixed point: everywhere, and not at samples only.

The quantity that has to be positive is a Legendre series on every cell of a zone's mesh. No
Legendre polynomial exceeds 1 in modulus, so the coefficients bound it; where these bounds do not
decide its sign, the cell is halved. At a boundary between zones the quantity is zero, so that next
to it bounds never decide. There the sign is taken from the next place where they do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any, NamedTuple

from spectral_contact.precise.annulus_mesh import AnnulusMesh
from spectral_contact.precise.fixed import Fixed, Ints
from spectral_contact.precise.zone_trial import ZoneTrial

#: A cell is halved at most so many times.
_MOST_HALVINGS = 60
#: How many of the digits aimed at, the last ones, are not trusted.
_UNTRUSTED = 2


@dataclass(frozen=True)
class Breach:
    """An interval in which the law does not hold, or is not known to hold.

    Attributes
    ----------
    zone : int
    ends : tuple of mpf
        ``ln(s**2/(1 - s**2))``, infinite at the centre and at the edge.
    from_edge : tuple of float
        Distances of the ends from the edge.
    wanted : int
        The state that the law asks for: 0 for stick, +1 or -1 for slip with that sign.
    amount : float
        The violation, relative to the largest value in the zone of the quantity that has to be
        positive.
    decided : bool
        Whether the law is known not to hold.
    """

    zone: int
    ends: tuple[Any, Any]
    from_edge: tuple[float, float]
    wanted: int
    amount: float
    decided: bool

    def __str__(self) -> str:
        what = "|q| exceeds f p" if self.wanted else "slip has the wrong sense"
        amount = f"by {self.amount:.1e}" if self.decided else "or not: it is undecided"
        places = " and ".join(f"{place:.6g}" for place in self.from_edge)
        return f"{what} {amount} between {places} from the edge"


class _Piece(NamedTuple):
    """Part of a cell, from `low` to `high` of its coordinate on [-1, 1].

    The verdict is +1 where the function is positive, -1 where it is negative, else 0.
    """

    cell: int
    low: Any
    high: Any
    verdict: int
    value: Any


def breaches(trial: ZoneTrial, sticking: dict[int, Ints], digits: int) -> list[Breach]:
    """Return where the law does not hold on zones, outward.

    Parameters
    ----------
    trial : ZoneTrial
        Up to the last zone.
    sticking : dict of int to ndarray
        ``q / (kappa s)`` at the nodes of the zones that stick.
    digits : int
        Relative accuracy of the solution.
    """
    problem = trial.problem
    f = trial.problem.drive.fixed
    displacements: dict[int, Ints] = {}
    noise = 0
    if any(problem.states):
        displacements = trial.displacement(sticking, range(len(problem.states)))
        # in stick the displacement is zero: what is computed there is its error
        noise = 4 * max(abs(displacements[k]).max() for k in sticking)
    found = []
    for k, (state, mesh) in enumerate(zip(problem.states, problem.meshes, strict=True)):
        zone = _LawZone(k, mesh, trial.ends[k], trial.ends[k + 1])
        if state:
            found += zone.below_zero(-state * displacements[k], 0, digits, noise)
            continue
        bound = trial.bound(k)
        q = sticking[k]
        # both are times s, and a pressure that is infinite at the edge times the root sqrt(y), too
        weight = f.sqrt(trial.z[k])
        if problem.drive.singular:
            weight = f.times(weight, f.sqrt(trial.y[k]))
        for sense in (1, -1):
            found += zone.below_zero(f.times(weight, bound - sense * q), sense, digits)
    return sorted(found, key=lambda one: one.ends[0])


def excesses(mesh: AnnulusMesh, bound: Ints, traction: Ints, digits: int) -> list[Breach]:
    """Return where |q| exceeds a bound on the whole contact, from values at the nodes of a mesh."""
    mp = mesh.fixed.mp
    zone = _LawZone(0, mesh, -mp.inf, mp.inf)
    margins = ((sense, bound - sense * traction) for sense in (1, -1))
    return [one for sense, margin in margins for one in zone.below_zero(margin, sense, digits)]


def obeying(
    states: Sequence[int], logits: Sequence[Any], found: Sequence[Breach]
) -> tuple[tuple[int, ...], tuple[Any, ...]]:
    """Return the states and boundaries of zones that have in every breach the state it wants."""
    inf = found[0].ends[0].context.inf
    ends = [-inf, *logits, inf]
    parts: list[tuple[int, Any]] = []  # states, and where each begins
    for k, (state, (start, stop)) in enumerate(zip(states, pairwise(ends), strict=True)):
        at = start
        for one in found:
            if one.zone == k:
                if one.ends[0] > at:
                    parts.append((state, at))
                parts.append((one.wanted, one.ends[0]))
                at = one.ends[1]
        if at < stop:
            parts.append((state, at))
    joined = [next(group) for _, group in groupby(parts, key=lambda part: part[0])]
    return tuple(state for state, _ in joined), tuple(start for _, start in joined[1:])


@dataclass(frozen=True)
class _LawZone:
    """A zone and the logits of its ends; at those that are finite the law is an equality."""

    number: int
    mesh: AnnulusMesh
    start: Any
    stop: Any

    def below_zero(self, values: Ints, wanted: int, digits: int, noise: Any = 0) -> list[Breach]:
        """Return where a function is below zero, or is not known to be positive.

        Its values are those at the nodes.
        Values within the noise count as undecided.
        """
        f = self.mesh.fixed
        largest = abs(values).max() or f.one
        noise = max(noise, f.times(f.of(f.mp.mpf(10) ** (_UNTRUSTED - digits)), largest))
        pieces = self._judged(values, noise)
        found = []
        for positive, group in groupby(enumerate(pieces), key=lambda each: each[1].verdict > 0):
            if positive:
                continue
            run = list(group)
            (first, inner) = run[0]
            (last, outer) = run[-1]
            ends = (
                self._logit(inner.cell, inner.low) if first else self.start,
                self._logit(outer.cell, outer.high) if last < len(pieces) - 1 else self.stop,
            )
            worst = float(f.numbers(-min(piece.value for _, piece in run)) / f.numbers(largest))
            decided = any(piece.verdict < 0 for _, piece in run)
            places = _from_edge(ends[0]), _from_edge(ends[1])
            found.append(Breach(self.number, ends, places, wanted, max(worst, 0.0), decided))
        return found

    def _judged(self, values: Ints, noise: Any) -> list[_Piece]:
        """Return the zone in pieces with their verdicts, outward."""
        f = self.mesh.fixed
        outermost = self.mesh.panels + 1
        divide = _Division(f, self.mesh.blocks.points)
        pieces = []
        for cell, row in enumerate(self.mesh.series(values).table):
            # the truncation error is taken for at most four times the last two coefficients
            left_out = 4 * (abs(row[-1]) + abs(row[-2]))
            part = list(divide(_Piece(cell, -f.one, f.one, 0, row[0]), row, max(noise, left_out)))
            if cell == outermost:  # its coordinate rises inward
                part = [one._replace(low=one.high, high=one.low) for one in part[::-1]]
            pieces += part
        if f.mp.isfinite(self.start):
            pieces = _decided_by_the_next(pieces)
        closed = f.mp.isfinite(self.stop)
        return _decided_by_the_next(pieces[::-1])[::-1] if closed else pieces

    def _logit(self, cell: int, local: Any) -> Any:
        """Return ``ln(s**2/(1 - s**2))`` at a place of a cell."""
        f = self.mesh.fixed
        mesh = self.mesh
        mp = f.mp
        share = f.numbers(f.one + local) / 2
        if cell == 0:
            odds = f.numbers(mesh.inner_end) * share**2
        elif cell <= mesh.panels:
            odds = mp.exp((cell - 1 - mesh.before + share) * mp.mpf(mesh.blocks.width))
        else:
            odds = 1 / (f.numbers(mesh.outer_end) * share**2)
        start, stop = (1 / (1 + mp.exp(-x)) for x in (self.start, self.stop))
        rest = 1 / (1 + mp.exp(self.stop))
        square = (start + stop * odds) / (1 + odds)
        return mp.log(square) - mp.log(rest + (stop - start) / (1 + odds))


class _Division:
    """Halving of cells until the sign of a series on them is known.

    Parameters
    ----------
    fixed : Fixed
    terms : int
        Of the series.
    """

    def __init__(self, fixed: Fixed, terms: int) -> None:
        self._bits = fixed.bits
        g, _ = fixed.gauss(terms)
        expand = fixed.expansion(terms)
        self._halves = [
            fixed.dot(expand, fixed.legendre((g + sense * fixed.one) // 2, terms - 1))
            for sense in (-1, 1)
        ]

    def __call__(self, piece: _Piece, row: Ints, noise: Any, depth: int = 0) -> Iterator[_Piece]:
        """Yield the parts of a piece with their verdicts, in the order of the cell's coordinate."""
        spread = abs(row[1:]).sum()
        least = row[0] - spread
        most = row[0] + spread
        verdict = 1 if least > noise else -1 if most < -noise else 0
        if verdict or max(-least, most) <= 2 * noise or depth == _MOST_HALVINGS:
            yield piece._replace(verdict=verdict, value=row[0])
            return
        middle = (piece.low + piece.high) // 2
        parts = piece._replace(high=middle), piece._replace(low=middle)
        for part, half in zip(parts, self._halves, strict=True):
            yield from self(part, (half @ row) >> self._bits, noise, depth + 1)


def _decided_by_the_next(pieces: list[_Piece]) -> list[_Piece]:
    """Return the pieces; the first ones, if undecided, get the verdict of the next decided one."""
    first = next((k for k, piece in enumerate(pieces) if piece.verdict), 0)
    verdict = pieces[first].verdict
    return [piece._replace(verdict=verdict) for piece in pieces[:first]] + pieces[first:]


def _from_edge(logit: Any) -> float:
    """Return the distance from the edge."""
    mp = logit.context
    rest = 1 / (1 + mp.exp(logit))
    return float(rest / (1 + mp.sqrt(1 - rest)))
