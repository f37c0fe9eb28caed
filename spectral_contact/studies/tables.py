"""Studies as text."""

from __future__ import annotations

from spectral_contact.scene import Scene
from spectral_contact.studies.study_results import Convergence, Study, WorkPrecision
from spectral_contact.studies.timing import Timing
from spectral_contact.view.report import scene_text, table


def text_of(study: Study) -> str:
    """Return what is printed of a study."""
    parts = _convergence(study) if isinstance(study, Convergence) else _work_precision(study)
    if any(point.times is not None for point in study.points):
        machine = ", ".join(f"{name} {value}" for name, value in study.machine.items())
        parts.append(f"times: medians and quartiles, one BLAS thread; {machine}")
    return "\n\n".join(parts)


def _convergence(study: Convergence) -> list[str]:
    names = {name: name.replace("_", " ") for name in study.quantities}
    timed = any(point.times is not None for point in study.points)
    rows = [("resolution", "unknowns", *names.values(), *["warm [ms]", "cold [ms]"] * timed)]
    for point in study.points:
        unknowns = "-" if point.unknowns is None else str(point.unknowns)
        errors = [f"{point.errors[one]:.1e}" if one in point.errors else "-" for one in names]
        if point.failure:
            errors = [point.failure, *[""] * (len(names) - 1)]
        times = [_spread(getattr(point.times, state, None)) for state in ("warm", "cold")]
        rows.append((f"{point.resolution:g}", unknowns, *errors, *times * timed))
    width = max(map(len, names.values()))
    rates = [f"  {told:<{width}}   {_rate_text(study, name)}" for name, told in names.items()]
    return [
        f"{study.solver}: {scene_text(study.scene)}\ntruth: {study.truth}",
        table(rows),
        "\n".join(["rate, with its interval of 95 per cent", *rates]),
    ]


def _rate_text(study: Convergence, quantity: str) -> str:
    """Return the rate of one error and the points that show it."""
    rate = study.rate(quantity)
    if rate is None:
        return "none: fewer than three points far enough above rounding and the error of the truth"
    used = ", ".join(str(i + 1) for i in rate.used)
    rivals = f" ({' and '.join(rate.rivals)} nearly as well)" if rate.rivals else ""
    return f"{rate}, {rate.kind}{rivals}, points {used} of {len(study.points)}"


def _work_precision(study: WorkPrecision) -> list[str]:
    """Return, for every scene and quantity, the times to reach the accuracies."""
    parts = []
    for scene, truth in zip(study.scenes, study.truths, strict=True):
        parts.append(f"{scene_text(scene)}\ntruth: {truth}")
        parts += [_reach_table(study, scene, quantity) for quantity in study.quantities]
        failed = [one for one in study.points if one.failure and one.scene == scene]
        told = [f"  {one.solver} at {one.resolution:g}: {one.failure}" for one in failed]
        parts += ["\n".join(["failures", *told])] if told else []
    return parts


def _reach_table(study: WorkPrecision, scene: Scene, quantity: str) -> str:
    """Return the warm times to reach each accuracy, and their ratios to the first solver's."""
    first, *others = study.solvers
    heading = [f"{quantity.replace('_', ' ')} to", f"{first} [ms]"]
    for name in others:
        heading += [f"{name} [ms]", "ratio"]
    rows = [tuple(heading)]
    for accuracy in study.accuracies:
        ours, *theirs = (study.reached(one, scene, quantity, accuracy) for one in study.solvers)
        row = [f"{accuracy:.0e}", _milliseconds(ours)]
        for time in theirs:
            ratio = "-" if time is None or ours is None else f"{time / ours:.3g}"
            row += [_milliseconds(time), ratio]
        rows.append(tuple(row))
    return table(rows)


def _spread(taken: Timing | None) -> str:
    if taken is None:
        return "-"
    low, middle, high = map(_milliseconds, (taken.lower, taken.median, taken.upper))
    return f"{middle} [{low}, {high}]"


def _milliseconds(seconds: float | None) -> str:
    return "-" if seconds is None else f"{1e3 * seconds:.3g}"
