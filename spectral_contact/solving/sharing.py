"""What scenes that are solved one after another have in common."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

from spectral_contact.fields import Array

if TYPE_CHECKING:
    from spectral_contact.contact.layout import Layout
    from spectral_contact.spectral.parameters import Parameters

_T = TypeVar("_T")
Place: TypeAlias = tuple[float, float, float]

#: Stick radii that another one is interpolated from.
_NEIGHBOURS = 6
#: Scenes that are extrapolated from, and how far in a logarithm.
_POINTS, _FARTHEST = 6, 1.0


class Shared:
    """The latest outcome of steps that several scenes have in common.

    Parameters
    ----------
    progress : bool or None
        Whether what takes seconds shows its progress; None is where somebody watches.
    """

    def __init__(self, progress: bool | None = False) -> None:
        self.progress = progress
        self._steps: dict[str, tuple[tuple[object, ...], Any]] = {}

    def get(self, step: str, key: tuple[object, ...], make: Callable[[], _T]) -> _T:
        """Return the outcome of a step, made anew if the latest one has another key."""
        known = self._steps.get(step)
        if known is None or known[0] != key:
            known = self._steps[step] = key, make()
        outcome: _T = known[1]
        return outcome


def place_of(parameters: Parameters) -> Place:
    """Return where a scene is on a path: ``(ln alpha, ln beta, ln f)``."""
    alpha, beta, _, friction = parameters
    log_alpha, log_beta, log_friction = (
        math.log(x) if x > 0.0 else -math.inf for x in (alpha, beta, friction)
    )
    return log_alpha, log_beta, log_friction


class ZonePath:
    """How the zones move from scene to scene, from the last ones with zones of the same kinds.

    Between neighbours the logarithms of compliances and friction move the logits of the
    boundaries smoothly: a polynomial in them goes through up to `_POINTS` scenes on a line.
    """

    def __init__(self) -> None:
        self._known: list[tuple[Place, Layout]] = []

    def near(self, place: Place) -> Layout | None:
        """Return where the zones may be: at ``(ln alpha, ln beta, ln f/kappa)``."""
        if not self._known:
            return None
        last, layout = self._known[-1]
        ahead = _way(last, place)
        along = max(ahead, key=abs)
        if not 0.0 < abs(along) <= _FARTHEST:
            return layout if along == 0.0 else None
        times, logits = self._on_the_line(ahead, along)
        guess = extrapolated(times, logits)
        if (np.diff(guess) <= 0.0).any():
            return layout
        slopes = [one.jacobian for _, one in self._known[-2:] if one.jacobian is not None]
        if len(times) > 1 and len(slopes) == 2:
            layout = layout._replace(jacobian=extrapolated(times[:2], slopes[::-1]))
        return layout._replace(logits=tuple(guess.tolist()))

    def _on_the_line(self, ahead: Place, along: float) -> tuple[list[float], list[Array]]:
        """Return the latest scenes behind the last one: how far, and their boundaries."""
        last, layout = self._known[-1]
        times, logits = [0.0], [np.array(layout.logits)]
        for other, one in reversed(self._known[:-1]):
            back = _way(last, other)
            time = back[ahead.index(along)] / along
            off = max(abs(b - time * a) for a, b in zip(ahead, back, strict=True))
            if off > 1e-6 * max(map(abs, back)) or time >= times[-1]:
                break
            times.append(time)
            logits.append(np.array(one.logits))
        return times, logits

    def add(self, place: Place, layout: Layout | None) -> None:
        """Keep what a scene has found."""
        if layout is None:
            self._known = []
            return
        alike = [known for known in self._known if known[1].states == layout.states]
        self._known = [*alike, (place, layout)][-_POINTS:]


class StickPath:
    """Where the stick radius may be: between those of radii that are known.

    Its logit goes like the logarithm of the distance from the onset of slip at first.

    Parameters
    ----------
    alpha, beta : float
        Compliances at a contact radius of 1.
    """

    def __init__(self, alpha: float, beta: float) -> None:
        self._compliance, self._first = math.log(alpha or beta or 1.0), alpha > 0.0
        self._known: dict[float, Layout] = {}
        self.onset: float | None = None

    def _along(self, place: Place) -> float | None:
        log_radius = self._compliance - (place[0] if self._first else place[1])
        if not self.onset:
            return log_radius if math.isfinite(log_radius) else None
        past = math.exp(log_radius) / self.onset - 1.0
        return math.log(past) if past > 0.0 else None

    def add(self, place: Place, layout: Layout | None) -> None:
        """Keep what is found."""
        along = self._along(place)
        if along is not None and layout is not None and layout.jacobian is not None:
            self._known[along] = layout

    def near(self, place: Place) -> Layout | None:
        """Return a guess."""
        along = self._along(place)
        if along is None or len(self._known) < 2:
            return None
        near = sorted(self._known, key=lambda one: abs(one - along))[:_NEIGHBOURS]
        logits = [np.array(self._known[one].logits) for one in near]
        logit = extrapolated([1.0 + one - along for one in near], logits)
        return self._known[near[0]]._replace(logits=tuple(logit.tolist()))


def _way(start: Place, end: Place) -> Place:
    """Return the difference of two places; a compliance that stays zero is no way."""
    a, b, c = (0.0 if one == two else two - one for one, two in zip(start, end, strict=True))
    return a, b, c


def extrapolated(times: list[float], values: list[Array]) -> Array:
    """Return the polynomial through values at these times, at the time 1 (Neville)."""
    values = list(values)
    for order in range(1, len(values)):
        for i in range(len(values) - order):
            s, t = times[i], times[i + order]
            values[i] = ((1.0 - t) * values[i] - (1.0 - s) * values[i + 1]) / (s - t)
    return values[0]
