"""Results shared by scenes solved one after another: outcomes of steps, and starting points."""

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

#: A scene counts as on a line if its distance from the line is at most this fraction of its
#: distance from the latest scene.
_COLLINEARITY = float(np.sqrt(np.finfo(float).eps))
#: A contact radius is predicted from at most this many earlier scenes.
_RADIUS_POINTS = 5
#: Only those scenes count whose load (or approach) differs from that of the next one by less than
#: this in its logarithm.
_RADIUS_RANGE = 1.0

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
        """Return the outcome of a step, made anew unless the latest one has the same key.

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
    """Return ``(ln alpha, ln beta, ln f)``, with minus infinity where a parameter is 0.

    Without elastic coupling f is the friction over kappa, as in `Parameters`.
    """
    log_alpha, log_beta, log_friction = (
        math.log(x) if x > 0.0 else -math.inf
        for x in (parameters.alpha, parameters.beta, parameters.friction)
    )
    return log_alpha, log_beta, log_friction


class ZonePath:
    """The zones of the latest scenes of a path, and a prediction of those of the next one.

    Between neighbouring scenes the logits of the boundaries are smooth functions of the logarithms
    of compliances and friction, or of the load ratio. Along a line in these, a polynomial through
    up to `PATH_POINTS` scenes is extrapolated. Only scenes whose zones have the states of the
    latest are kept.
    """

    def __init__(self) -> None:
        self._scenes: list[tuple[LogParameters, Layout]] = []

    def predict(self, target: LogParameters) -> Layout | None:
        """Return zones to start from.

        None without a scene, or if a parameter changes by more than a factor of e.

        Parameters
        ----------
        target : tuple of float
            `log_parameters` of the next scene, or ``(ln load ratio,)``.
        """
        if not self._scenes:
            return None
        last, layout = self._scenes[-1]
        step = _difference(last, target)
        largest_step = max(step, key=abs)
        if largest_step == 0.0:
            return layout
        if not abs(largest_step) <= 1.0:  # a factor of e
            return None
        times, layouts = self._collinear_scenes(step)
        predicted = value_at(1.0, times, [np.array(near.logits) for near in layouts])
        if not (np.diff(predicted) > 0.0).all():  # boundaries would cross
            return layout
        # those of the boundary residual by the logits (`Layout.jacobian`), at the latest two scenes
        jacobians = [near.jacobian for near in layouts[:2] if near.jacobian is not None]
        if len(jacobians) == 2:
            layout = layout._replace(jacobian=value_at(1.0, times[:2], jacobians))
        return layout._replace(logits=tuple(predicted.tolist()))

    def _collinear_scenes(self, step: LogParameters) -> tuple[list[float], list[Layout]]:
        """Return times and zones of the latest scenes on the line to the next one, latest first.

        Time is 0 at the last scene, 1 at the next one, and negative before. Scenes that are too
        close to each other are left out (`well_spaced`).
        """
        last, layout = self._scenes[-1]
        largest_step = max(step, key=abs)
        times = [0.0]
        layouts = [layout]
        for parameters, earlier_layout in reversed(self._scenes[:-1]):
            difference = _difference(last, parameters)
            if not all(
                map(math.isfinite, difference)
            ):  # a parameter is 0 in only one of the two scenes
                break
            time = difference[step.index(largest_step)] / largest_step
            off_line = max(abs(b - time * a) for a, b in zip(step, difference, strict=True))
            if off_line > _COLLINEARITY * max(map(abs, difference)) or time >= times[-1]:
                break
            times.append(time)
            layouts.append(earlier_layout)
        chosen = well_spaced(times, 1.0)
        return [times[i] for i in chosen], [layouts[i] for i in chosen]

    def add(self, parameters: LogParameters, layout: Layout | None) -> None:
        """Keep the zones of a scene; without zones all that was kept is dropped."""
        if layout is None:
            self._scenes = []
            return
        same_states = [scene for scene in self._scenes if scene[1].states == layout.states]
        self._scenes = [*same_states, (parameters, layout)][-PATH_POINTS:]


class StickPath:
    """The stick radii of a growing contact, and a prediction at other contact radii.

    ``alpha*`` and ``beta*`` are compliances over the contact radius, so that the coordinate of the
    path is the logarithm of that radius; or, once the onset of slip is known, that of the relative
    distance from the onset. The logit of the stick radius is a smooth function of it.

    Parameters
    ----------
    alpha, beta : float
        Compliances at a contact radius of 1.

    Attributes
    ----------
    onset : float or None
        The contact radius at which slip begins; None or 0 if there is none or it is not known. It
        is set before scenes are added.
    """

    def __init__(self, alpha: float, beta: float) -> None:
        self._log_compliance = math.log(alpha or beta or 1.0)
        self._uses_alpha = alpha > 0.0
        self._layouts: dict[float, Layout] = {}
        self.onset: float | None = None

    def _coordinate(self, parameters: LogParameters) -> float | None:
        """Return the coordinate of a scene; None up to the onset, or without compliance."""
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
        """Return zones to start from; None up to the onset, or with fewer than two scenes."""
        coordinate = self._coordinate(parameters)
        if coordinate is None or len(self._layouts) < 2:
            return None
        kept = list(self._layouts)
        coordinates = [kept[i] for i in well_spaced(kept, coordinate)][:PATH_POINTS]
        nearest = self._layouts[coordinates[0]]
        coordinates = [one for one in coordinates if self._layouts[one].states == nearest.states]
        logits = [np.array(self._layouts[one].logits) for one in coordinates]
        predicted = value_at(coordinate, coordinates, logits)
        if not (np.diff(predicted) > 0.0).all():  # boundaries would cross
            return nearest
        return nearest._replace(logits=tuple(predicted.tolist()))


class RadiusPath:
    """Loads or approaches of the latest scenes, and a prediction of the contact radius.

    The logarithm of the radius is extrapolated as a polynomial in that of the load or approach.
    """

    def __init__(self) -> None:
        self._log_pairs: list[tuple[float, float]] = []

    def add(self, value: float, radius: float) -> None:
        """Keep the contact radius at a load or approach."""
        self._log_pairs = [*self._log_pairs, (math.log(value), math.log(radius))][-_RADIUS_POINTS:]

    def predict(self, value: float) -> float | None:
        """Return a guess of the radius; None with fewer than two scenes that count."""
        log_value = math.log(value)
        # the latest first: of several scenes at one value `well_spaced` takes the first
        log_pairs = [
            pair for pair in self._log_pairs[::-1] if 0.0 < abs(pair[0] - log_value) < _RADIUS_RANGE
        ]
        log_values = [pair[0] for pair in log_pairs]
        log_radii = [np.array(pair[1]) for pair in log_pairs]
        chosen = well_spaced(log_values, log_value)
        if len(chosen) < 2:
            return None
        guess = value_at(log_value, [log_values[i] for i in chosen], [log_radii[i] for i in chosen])
        return math.exp(float(guess))


def _difference(start: LogParameters, end: LogParameters) -> LogParameters:
    """Return end minus start, with 0 for a parameter that is zero in both (minus infinity)."""
    return tuple(0.0 if a == b else b - a for a, b in zip(start, end, strict=True))


def well_spaced(places: list[float], target: float) -> list[int]:
    """Return numbers of places from which to interpolate at a target, nearest first.

    A polynomial through two places close to each other amplifies the errors of the values there,
    the more, the farther away its target is. So a place is left out if its distance from one that
    is chosen already is less than ``1/(2 PATH_POINTS)`` of its distance from the target. This
    leaves out none of the nearest PATH_POINTS places if they are equally spaced.
    """
    chosen: list[int] = []
    for i in sorted(range(len(places)), key=lambda i: abs(places[i] - target)):
        distance = abs(places[i] - target)
        if all(2.0 * PATH_POINTS * abs(places[i] - places[j]) >= distance for j in chosen):
            chosen.append(i)
    return chosen


def value_at(target: float, places: list[float], values: list[Array]) -> Array:
    """Return the value at a target of the polynomial through values at places (Neville)."""
    values = list(values)
    for order in range(1, len(values)):
        for i in range(len(values) - order):
            first = places[i]
            last = places[i + order]
            numerator = (target - last) * values[i] - (target - first) * values[i + 1]
            values[i] = numerator / (first - last)
    return values[0]
