"""What scenes that are solved one after another reuse: outcomes of steps, and first zones."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

from spectral_contact.contact.tuning import PATH_POINTS
from spectral_contact.fields import Array

if TYPE_CHECKING:
    from spectral_contact.contact.layout import Layout
    from spectral_contact.spectral.parameters import Parameters

#: Scenes are on one line if they are off it by less than this part of their largest distance.
_COLLINEARITY = float(np.sqrt(np.finfo(float).eps))

_T = TypeVar("_T")
LogParameters: TypeAlias = tuple[float, ...]


class StepCache:
    """The latest outcome of each step, for scenes that have steps in common.

    Parameters
    ----------
    progress : bool or None
        Whether steps that take seconds show their progress; with None they do on a terminal.
    """

    def __init__(self, progress: bool | None = False) -> None:
        self.progress = progress
        self._steps: dict[str, tuple[tuple[object, ...], Any]] = {}

    def get(self, step: str, key: tuple[object, ...], make: Callable[[], _T]) -> _T:
        """Return the outcome of a step, made anew if the latest one has another key.

        Parameters
        ----------
        step : str
            Name of the step.
        key : tuple
            All that the outcome depends on.
        make : callable
            Makes the outcome.
        """
        entry = self._steps.get(step)
        if entry is None or entry[0] != key:
            entry = (key, make())
            self._steps[step] = entry
        outcome: _T = entry[1]
        return outcome


def log_parameters(parameters: Parameters) -> LogParameters:
    """Return ``(ln alpha, ln beta, ln f)``, with minus infinity for 0."""
    alpha, beta, _, friction = parameters
    log_alpha, log_beta, log_friction = (
        math.log(x) if x > 0.0 else -math.inf for x in (alpha, beta, friction)
    )
    return log_alpha, log_beta, log_friction


class ZonePath:
    """The zones of the latest scenes of a path, and a prediction of those of the next one.

    Between neighbouring scenes the logits of the boundaries are smooth functions of the logarithms
    of compliances and friction, or of the load ratio: along a line in these, a polynomial through
    up to `PATH_POINTS` scenes is extrapolated. Only scenes with zones of the same states are kept.
    """

    def __init__(self) -> None:
        self._scenes: list[tuple[LogParameters, Layout]] = []

    def predict(self, target: LogParameters) -> Layout | None:
        """Return zones to start from, or None if no scene is close enough.

        Parameters
        ----------
        target : tuple of float
            Of the next scene: ``(ln alpha, ln beta, ln f/kappa)``, or ``(ln load ratio,)``.
        """
        if not self._scenes:
            return None
        last, layout = self._scenes[-1]
        step = _difference(last, target)
        longest = max(step, key=abs)
        if longest == 0.0:
            return layout
        if not abs(longest) <= 1.0:  # a factor of e
            return None
        times, logits = self._collinear_scenes(step)
        predicted = extrapolate(times, logits)
        if (np.diff(predicted) <= 0.0).any():  # boundaries would cross
            return layout
        jacobians = [scene.jacobian for _, scene in self._scenes[-2:] if scene.jacobian is not None]
        if len(times) > 1 and len(jacobians) == 2:
            layout = layout._replace(jacobian=extrapolate(times[:2], jacobians[::-1]))
        return layout._replace(logits=tuple(predicted.tolist()))

    def _collinear_scenes(self, step: LogParameters) -> tuple[list[float], list[Array]]:
        """Return times and boundaries of the latest scenes on the line of the next step, backward.

        Time is 0 at the last scene, 1 at the next one, and negative before.
        """
        last, layout = self._scenes[-1]
        longest = max(step, key=abs)
        times = [0.0]
        logits = [np.array(layout.logits)]
        for parameters, earlier in reversed(self._scenes[:-1]):
            back = _difference(last, parameters)
            time = back[step.index(longest)] / longest
            off_line = max(abs(b - time * a) for a, b in zip(step, back, strict=True))
            if off_line > _COLLINEARITY * max(map(abs, back)) or time >= times[-1]:
                break
            times.append(time)
            logits.append(np.array(earlier.logits))
        return times, logits

    def add(self, parameters: LogParameters, layout: Layout | None) -> None:
        """Keep the zones of a scene; without zones all that was kept is dropped."""
        if layout is None:
            self._scenes = []
            return
        same_states = [scene for scene in self._scenes if scene[1].states == layout.states]
        self._scenes = [*same_states, (parameters, layout)][-PATH_POINTS:]


class StickPath:
    """The stick radii of a growing contact, and a prediction of others between them.

    A contact that grows changes ``alpha*`` and ``beta*``, which are compliances over the contact
    radius, so that the coordinate of the path is the logarithm of the contact radius; once the
    onset of slip is known, that of the distance from the onset. The logit of the stick radius is a
    smooth function of it.

    Parameters
    ----------
    alpha, beta : float
        Compliances at a contact radius of 1.

    Attributes
    ----------
    onset : float or None
        The contact radius at which slip begins, if it is known.
    """

    def __init__(self, alpha: float, beta: float) -> None:
        self._log_compliance = math.log(alpha or beta or 1.0)
        self._uses_alpha = alpha > 0.0
        self._layouts: dict[float, Layout] = {}
        self.onset: float | None = None

    def _coordinate(self, parameters: LogParameters) -> float | None:
        """Return the coordinate of a scene; None before the onset, or if there is no compliance."""
        log_radius = self._log_compliance - (parameters[0] if self._uses_alpha else parameters[1])
        if not self.onset:
            return log_radius if math.isfinite(log_radius) else None
        past = math.exp(log_radius) / self.onset - 1.0
        return math.log(past) if past > 0.0 else None

    def add(self, parameters: LogParameters, layout: Layout | None) -> None:
        """Keep the zones of a scene, if they have a Jacobian."""
        coordinate = self._coordinate(parameters)
        if coordinate is not None and layout is not None and layout.jacobian is not None:
            self._layouts[coordinate] = layout

    def predict(self, parameters: LogParameters) -> Layout | None:
        """Return zones to start from, or None if fewer than two scenes are kept."""
        coordinate = self._coordinate(parameters)
        if coordinate is None or len(self._layouts) < 2:
            return None
        chosen: list[float] = []
        for other in sorted(self._layouts, key=lambda other: abs(other - coordinate)):
            # a polynomial through radii that differ by their errors alone leads anywhere
            distance = abs(other - coordinate)
            if all(4.0 * abs(other - nearer) >= distance for nearer in chosen):
                chosen.append(other)
        chosen = chosen[:PATH_POINTS]
        logits = [np.array(self._layouts[other].logits) for other in chosen]
        predicted = extrapolate([1.0 + other - coordinate for other in chosen], logits)
        return self._layouts[chosen[0]]._replace(logits=tuple(predicted.tolist()))


def _difference(start: LogParameters, end: LogParameters) -> LogParameters:
    """Return end minus start, with 0 for a parameter that is zero in both (minus infinity)."""
    return tuple(0.0 if a == b else b - a for a, b in zip(start, end, strict=True))


def extrapolate(times: list[float], values: list[Array]) -> Array:
    """Return the polynomial through values at these times, at the time 1 (Neville)."""
    values = list(values)
    for order in range(1, len(values)):
        for i in range(len(values) - order):
            first = times[i]
            last = times[i + order]
            numerator = (1.0 - last) * values[i] - (1.0 - first) * values[i + 1]
            values[i] = numerator / (first - last)
    return values[0]
