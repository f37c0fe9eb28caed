"""Studies as text."""

from __future__ import annotations

import math

from spectral_contact.scene import Scene
from spectral_contact.studies.study_results import Convergence, Point, Study, WorkPrecision
from spectral_contact.studies.timing import Timing
from spectral_contact.view.report import scene_text, table


def text_of(study: Study) -> str:
    """Return what is printed of a study."""
    return _convergence(study) if isinstance(study, Convergence) else _work_precision(study)


def _convergence(study: Convergence) -> str:
    timed = study.stopwatch is not None
    heading = ["resolution", "unknowns", *(name.replace("_", " ") for name in study.quantities)]
    if timed:
        heading += ["warm [ms]", "cold [ms]", f"ms per digit of {heading[2]}"]
    rows = [tuple(heading)]
    for point in study.points:
        row = [f"{point.resolution:g}", _whole(point.unknowns)]
        if point.failure:
            rows.append((*row, point.failure, *[""] * (len(heading) - 3)))
            continue
        row += [_error(point, name) for name in study.quantities]
        rows.append((*row, *_times(point, study.quantities[0])) if timed else tuple(row))
    width = max(len(name) for name in study.quantities)
    rates = [
        f"  {name.replace('_', ' '):<{width}}   {_rate_text(study, name)}"
        for name in study.quantities
    ]
    parts = [
        f"{study.solver}: {scene_text(study.scene)}\ntruth: {study.truth}",
        table(rows),
        "\n".join(["rate, with its interval of 95 per cent", *rates]),
    ]
    return "\n\n".join([*parts, *_timing_notes(study)])


def _rate_text(study: Convergence, quantity: str) -> str:
    """Return the rate of one error and the points that show it."""
    rate = study.rate(quantity)
    if rate is None:
        return "none: fewer than three points above rounding and the error of the truth"
    used, total = rate.used, len(study.points)
    if used == tuple(range(used[0], used[-1] + 1)):
        points = f"points {used[0] + 1} to {used[-1] + 1} of {total}"
    else:
        points = f"points {', '.join(str(i + 1) for i in used)} of {total}"
    rivals = f" ({' and '.join(rate.rivals)} nearly as well)" if rate.rivals else ""
    return f"{rate}, {rate.kind}{rivals}, {points}"


def _work_precision(study: WorkPrecision) -> str:
    """Return, for every scene and quantity, the times to reach the accuracies."""
    parts = []
    for scene, truth in zip(study.scenes, study.truths, strict=True):
        parts.append(f"{scene_text(scene)}\ntruth: {truth}")
        parts += [_reach_table(study, scene, quantity) for quantity in study.quantities]
        failures = [
            f"  {point.solver} at {point.resolution:g}: {point.failure}"
            for name in study.solvers
            for point in study.of(name, scene)
            if point.failure
        ]
        if failures:
            parts.append("\n".join(["failures", *failures]))
    return "\n\n".join([*parts, *_timing_notes(study)])


def _reach_table(study: WorkPrecision, scene: Scene, quantity: str) -> str:
    """Return the warm times to reach each accuracy, and their ratios to the first solver's."""
    first, *others = study.solvers
    heading = [f"{quantity.replace('_', ' ')} to", f"{first} [ms]"]
    for name in others:
        heading += [f"{name} [ms]", "ratio"]
    rows = [tuple(heading)]
    for accuracy in study.accuracies:
        times = {name: study.reached(name, scene, quantity, accuracy) for name in study.solvers}
        row = [f"{accuracy:.0e}", _milliseconds(times[first])]
        for name in others:
            row += [_milliseconds(times[name]), _ratio(times[name], times[first])]
        rows.append(tuple(row))
    return table(rows)


def _ratio(theirs: float | None, ours: float | None) -> str:
    return "-" if theirs is None or ours is None else f"{theirs / ours:.3g}"


def _timing_notes(study: Study) -> list[str]:
    """Return how the times were taken, and where."""
    lines = []
    for note in sorted({_note(point) for point in study.points} - {""}):
        lines.append(f"times: {note}")
    return ["\n".join([*lines, f"machine: {study.machine}"])] if lines else []


def _note(point: Point) -> str:
    times = point.times
    if times is None:
        return ""
    threads = times.blas_threads
    said = "BLAS threads unknown" if threads is None else f"BLAS threads: {threads}"
    if times.cold is None:
        return f"{point.solver}, medians and quartiles in this process, {said} ({times.note})"
    return f"{point.solver}, medians and quartiles in fresh processes, {said}"


def _times(point: Point, quantity: str) -> tuple[str, ...]:
    times, each = point.times, point.seconds_per_digit(quantity)
    assert times is not None
    return _spread(times.warm), _spread(times.cold), _milliseconds(each)


def _spread(taken: Timing | None) -> str:
    if taken is None:
        return "-"
    ends = f"{_milliseconds(taken.lower)}, {_milliseconds(taken.upper)}"
    return f"{_milliseconds(taken.median)} [{ends}]"


def _milliseconds(seconds: float | None) -> str:
    return "-" if seconds is None else f"{1e3 * seconds:.3g}"


def _whole(number: int | None) -> str:
    return "-" if number is None else str(number)


def _error(point: Point, quantity: str) -> str:
    error = point.errors.get(quantity)
    if error is None:
        return "-"
    return f"{error:.1e}" if math.isfinite(error) else "inf"
