"""Which zones partial slip with elastic coupling has: guesses are solved for until one fits.

No search is known to be sure, as uniqueness is not proved. The zones without coupling come first;
those that break the friction law show in places what others to try.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import exp
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_contact.contact.active_set import ring_layout
from spectral_contact.contact.boundaries import NoBoundariesError
from spectral_contact.contact.coupled_problem import (
    CoupledProblem,
    find_coupled_zones,
    solve_coupled_slip,
    solve_coupled_zones,
)
from spectral_contact.contact.coupled_radii import scanned, stick_radii
from spectral_contact.contact.layout import Layout
from spectral_contact.contact.onset import exceeded, is_narrow
from spectral_contact.contact.ratio import FullStick
from spectral_contact.contact.slip_outcome import PartialSlip, everywhere, zones_outcome
from spectral_contact.contact.stick_radius import NoStickDiskError
from spectral_contact.fields.series import Radius
from spectral_contact.records import PARTIAL_SLIP, SLIP_FIELD
from spectral_contact.spectral.parameters import Parameters

__all__ = ["CoupledSearch", "NoCoupledSlipError", "lawful"]

Array = NDArray[np.float64]
Record = Callable[[str, Any, float], Any]


class NoCoupledSlipError(ArithmeticError):
    """Zones do not obey the friction law; the text says what is amiss.

    Attributes
    ----------
    further : Layout or None
        Zones that may do so: the same, and stick where slip has the wrong sense.
    """

    def __init__(self, text: str, further: Layout | None = None) -> None:
        super().__init__(text)
        self.further = further


def lawful(outcome: PartialSlip) -> PartialSlip:
    """Return what obeys the friction law, but for rounding, and raise `NoCoupledSlipError` else."""
    if outcome.amiss:
        raise NoCoupledSlipError(outcome.amiss, outcome.mended)
    return outcome


#: Tolerance at which guesses are tried before they are solved for to a tighter one.
_PROBE = 1e-3
#: One stick disk; where nothing is known of its radius slip is narrow.
_DISK, _NOWHERE = Layout((3.0,), (0, 1)), Layout((), (0,))
#: From where on another stick radius is looked for, and in which steps, as logits; on smooth
#: surfaces they are 10 apart and more, measured.
_CLEAR, _APART = 1.0, 3.0
#: Square of friction times compliance, which is about how wide a smooth surface sticks at the edge,
#: below which no digit of it is found, measured.
_RESOLVED = 1e-29
#: Friction that lacks as little as this lets no more slip than where full stick exceeds it: to 0.01
#: in the logit, measured; as much is seen of the difference to where rough spaces have slip.
_ABOUT, _SEEN = 1e-2, 0.02
#: An estimate of the fields' errors from which on they are none.
_UNKNOWN = 0.1
#: The first and the least step of the coupling by which zones are followed.
_STEP, _LEAST_STEP = 0.25, 0.05
#: What a guess of the zones ends in, if they do not fit, or one of them has no width.
_MISFITS = (NoCoupledSlipError, NoBoundariesError, np.linalg.LinAlgError, ArithmeticError)


@dataclass(slots=True)
class CoupledSearch:
    """The zones of coupled partial slip below the critical friction.

    Parameters
    ----------
    parameters : Parameters
    stick : FullStick
        Full stick, with its fields.
    plain : callable
        Returns the zones without coupling.
    tolerance : float
        Bound on the relative errors of both fields.
    max_unknowns : int
        Most unknowns of a space.
    record : callable
        Takes the name of a step, its outcome and its beginning, returns the value.
    near : Layout, optional
        Zones with slopes, as a like scene has them: they come first.
    """

    parameters: Parameters
    stick: FullStick
    plain: Callable[[], Layout]
    tolerance: float
    max_unknowns: int
    record: Record
    near: Layout | None = None

    def outcome(self) -> PartialSlip:
        """Return the first solution that obeys the friction law.

        Raises
        ------
        NoCoupledSlipError
            If none does.
        """
        alpha, beta, _, friction = self.parameters
        edge = (friction * beta) ** 2
        if alpha == 0.0 < beta and edge < _RESOLVED:
            raise NoCoupledSlipError(f"the edge sticks over some {edge:.0e}, too little to resolve")
        reasons = []
        for first, far in self._layouts():
            layout: Layout | None = first
            while layout is not None:
                try:
                    return self._solved(layout, far)
                except NoStickDiskError as missing:
                    if missing.at_centre:
                        return self._all_slip()
                    reasons.append(f"{len(layout.states)} zones: {missing}")
                    layout = None
                except _MISFITS as missing:
                    reasons.append(f"{len(layout.states)} zones: {missing}")
                    further = getattr(missing, "further", None)
                    layout = further if further and self._possible(further) else None
        raise NoCoupledSlipError("; ".join(reasons))

    def others(self, logit: float) -> list[float]:
        """Return what other stick radii than that of a solution there may be, roughly.

        Where full stick slips at the edge there is an even number of them; none, as far as seen.
        So they are looked for where the edge sticks in full stick, or opens. Only larger ones are:
        from small disks on, which is where friction, or the load, begins, the first is reached.
        """
        ratio = self.stick.edge_ratio
        if not self._possible(_DISK) or (ratio is not None and ratio >= self.parameters.friction):
            return []
        problem = CoupledProblem(self.parameters, _DISK, _PROBE)
        further = scanned(problem, logit + _CLEAR, _APART)
        found = stick_radii(problem, further, contacts=True)
        return [Radius.from_logit(one.logit).value for one in found if one.possible]

    def _layouts(self) -> Iterator[tuple[Layout, bool]]:
        """Guess zones, of every kind once; the last ones are far from those without coupling."""
        seen: set[tuple[int, ...]] = set()
        if self.near is not None:
            yield self.near, False
        for layout in self._guesses():
            if self._possible(layout) and layout.states not in seen:
                seen.add(layout.states)
                yield layout, False
        if len(layout.states) > 2 and self._possible(layout):
            yield layout, True

    def _guesses(self) -> Iterator[Layout]:
        """Yield what rings, one disk, full stick and the contact without coupling tell.

        Full stick comes first where it is narrow slip: rings miss it, or its place.
        """
        violated = exceeded(self.stick, self.parameters)
        if is_narrow(violated):
            yield violated
        yield self._on_rings()
        yield replace(_DISK, logits=violated.logits[:1]) if violated.logits else _DISK
        yield violated
        yield self.plain()

    def _on_rings(self) -> Layout:
        """Return what an active set finds on rings."""
        alpha, beta, kappa, friction = self.parameters
        found = ring_layout(alpha, beta, friction, kappa, True)
        if not (found.settled and found.positive) or found.centre_unseen:
            return _NOWHERE
        return Layout(tuple(one.logit for one in found.boundaries), found.states)

    def _possible(self, layout: Layout) -> bool:
        """Return whether there is slip, and the edge may be as it is.

        That of a smooth surface sticks with tangential compliance.
        """
        alpha, beta, _, _ = self.parameters
        if len(layout.states) == 2:
            return alpha > 0.0 or beta == 0.0
        return len(layout.states) > 2 and beta > 0.0

    def _solved(self, layout: Layout, far: bool) -> PartialSlip:
        """Solve on zones like these, and record the solution if the friction law holds."""
        parameters, most = self.parameters, self.max_unknowns
        # the search for boundaries that are not there ends at the edge, past rounding
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if layout is not self.near:
                layout = self._narrowed(self._found(layout, far))
            if len(layout.states) > 2 and self.tolerance < _PROBE:
                rough = solve_coupled_zones(parameters, layout, _PROBE, most)
                lawful(zones_outcome(rough.best.value, parameters))
            begin = perf_counter()
            zones = solve_coupled_zones(parameters, layout, self.tolerance, most)
            if not zones.best.error < _UNKNOWN:
                raise NoCoupledSlipError("no digit of the fields is known")
            solved = perf_counter()
            outcome = lawful(zones_outcome(zones.best.value, parameters))
        self.record(PARTIAL_SLIP, zones, begin + perf_counter() - solved)
        self.record(SLIP_FIELD, outcome, solved)
        return outcome

    def _narrowed(self, layout: Layout) -> Layout:
        """Return a slip annulus that is narrower than rough spaces see, as full stick shows it.

        Next to the onset all slips where full stick exceeds friction, and hardly anything more.
        """
        lack = 1.0 - self.parameters.friction / self.stick.critical
        if layout.states != _DISK.states or lack >= _ABOUT:
            return layout
        near = exceeded(self.stick, self.parameters)
        if near.states != layout.states or near.logits[0] < layout.logits[0] + _SEEN:
            return layout
        assert layout.slopes is not None
        # conditions rise as the distance from the edge does
        narrower = exp(layout.logits[0] - near.logits[0])
        return replace(layout, logits=near.logits, slopes=narrower * layout.slopes)

    def _all_slip(self) -> PartialSlip:
        """Return slip everywhere but in a disk too small to be felt."""
        begin = perf_counter()
        zones = solve_coupled_slip(self.parameters, self.tolerance, self.max_unknowns)
        self.record(PARTIAL_SLIP, zones, begin)
        begin = perf_counter()
        point = lawful(zones_outcome(zones.best.value, self.parameters, felt=False))
        outcome = everywhere(point, self.parameters.friction)
        self.record(SLIP_FIELD, outcome, begin)
        return outcome

    def _found(self, layout: Layout, far: bool) -> Layout:
        """Find the boundaries, with coupling that grows from none if they are far."""
        alpha, beta, kappa, friction = self.parameters
        share, step = 0.0, _STEP if far else 1.0
        while share < 1.0:
            part = min(share + step, 1.0)
            try:
                layout = find_coupled_zones(
                    Parameters(alpha, beta, part * kappa, part * friction),
                    replace(layout, slopes=None),
                )
            except NoBoundariesError:
                step /= 4.0
                if not far or step < _LEAST_STEP:
                    raise
            else:
                share = part
        return layout
