"""Tables and the figure of what accuracy costs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from reporting import table

from spectral_contact.view.plotting import save, style

#: What `rtol` bounds; the edge is one of the places of the pressure.
BOUNDED = ("approach", "pressure", "traction", "total_shear")
#: Errors of zero, and what doubles do not tell from it, are drawn here.
LEAST = 1e-16
SHOWN = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: A digit is priced between these.
FROM, TO = 1e-2, 1e-12
DEFAULT = 1e-10

Record = dict[str, Any]


def growth_argument(rtol: float, compliance: float, power: float = 1.0) -> float:
    """Return ``log(1/rtol) log(1/(alpha rtol**power))``."""
    return math.log(rtol) * (math.log(compliance) + power * math.log(rtol))


def all_unknowns(point: Record) -> int:
    """Return the unknowns of all systems together."""
    return sum(point["systems"].values())


def worst(point: Record, kind: str) -> float:
    """Return the largest of the errors, or estimates, that `rtol` bounds."""
    return max(float(point[kind][name]) for name in BOUNDED if name in point[kind])


def series(record: Record, problem: str, compliance: float) -> list[Record]:
    """Return the points of one scene, tolerance by tolerance."""
    case = problem, compliance
    return [p for p in record["points"] if (p["problem"], p["compliance"]) == case]


def _cases(record: Record) -> tuple[list[str], list[float]]:
    problems = dict.fromkeys(point["problem"] for point in record["points"])
    return list(problems), list(dict.fromkeys(point["compliance"] for point in record["points"]))


def _warm(point: Record) -> float:
    """Return the warm time in ms."""
    return 1e3 * float(point["times"]["warm"]["median"])


def _cold(point: Record) -> float:
    """Return the cold time in ms, nan if there is none."""
    cold = point["times"]["cold"]
    return math.nan if cold is None else 1e3 * float(cold["median"])


def _number(value: float, digits: int = 2) -> str:
    if not math.isfinite(value):
        return "–"
    return f"{value:.{digits}g}" if abs(value) < 10.0**digits else f"{value:.0f}"


# --- tables ---------------------------------------------------------------------------------------


def tables(record: Record) -> str:
    """Return the Markdown tables, each after a comment by which a page can quote it."""
    parts = {
        "about": _about,
        "digits": _digits,
        "roughness": _roughness,
        "growth": _growth,
        "monotony": _monotony,
        "prices": _prices,
    }
    text = f"{record['count']} solves.\n\n"
    return text + "\n".join(f"<!-- {name} -->\n\n{make(record)}\n" for name, make in parts.items())


def _about(record: Record) -> str:
    machine = record["machine"]
    problems, compliances = _cases(record)
    over = record["exceeded"]
    taken = "**Times are rough**: one repeat on a busy machine."
    if record["repeats"] > 1:
        taken = (
            f"Warm: the median of {record['repeats']} repeats or more of the same solve; cold: "
            "that of solves with empty caches."
        )
    about = (
        f"{len(problems)} problems at {len(compliances)} compliances, {record['count']} solves. "
        f"{taken} One BLAS thread. {machine['processor']}, "
        f"Python {machine['python']}, numpy {machine['numpy']}; U, one `numpy.linalg.solve` of "
        f"1000 dense equations there, takes {1e3 * record['dense_solve_seconds']:.0f} ms. Truth: "
        f"{'; '.join(record['truths'])}."
    )
    lines = [about, "", f"True errors above their estimates: {len(over) or 'none'}."]
    lines += [
        f"{p['problem']} at {p['compliance']:g}, `rtol={p['resolution']:g}`: {p['quantity']}, "
        f"error {p['errors'][p['quantity']]:.1e}, estimate {p['estimates'][p['quantity']]:.1e}."
        for p in over
    ]
    return "\n".join(lines)


def _digits(record: Record) -> str:
    """Return unknowns and times by tolerance, and what a digit adds."""
    problems, compliances = _cases(record)
    heading = ["problem", "α* = β*", *(f"{rtol:g}" for rtol in SHOWN), "a digit adds"]
    rows = []
    for problem in problems:
        for compliance in compliances:
            points = {p["resolution"]: p for p in series(record, problem, compliance)}
            cells = [f"{all_unknowns(points[r])}, {_number(_warm(points[r]))} ms" for r in SHOWN]
            count = math.log10(FROM / TO)
            more = (all_unknowns(points[TO]) - all_unknowns(points[FROM])) / count
            longer = (_warm(points[TO]) - _warm(points[FROM])) / count
            added = f"{more:.0f}, {_number(longer)} ms" if more else "nothing"
            rows.append([problem, f"{compliance:g}", *cells, added])
    return table(" | ".join(heading), rows)


def _roughness(record: Record) -> str:
    """Return what the default tolerance costs, by compliance."""
    problems, compliances = _cases(record)
    heading = ["α* = β*"]
    for problem in problems:
        heading += [f"{problem}: unknowns", "warm [ms]", "cold [ms]"]
    rows = []
    for compliance in compliances:
        row = [f"{compliance:g}"]
        for problem in problems:
            [point] = [p for p in series(record, problem, compliance) if p["resolution"] == DEFAULT]
            row += [str(all_unknowns(point)), _number(_warm(point)), _number(_cold(point))]
        rows.append(row)
    return table(" | ".join(heading), rows)


def _growth(record: Record) -> str:
    """Return the fitted growth with intervals of 95 per cent."""
    heading = ["problem", "points", "N = a + b L", "N = a + b L′", "N ~ L^k: k", "time ~ N^m: m"]
    rows = []
    for problem, fit in record["fits"].items():
        laws = [
            f"{line['intercept']:.0f} + {_span(line)}, ± {line['residual']:.0f}"
            for line in (fit["unknowns"], fit["unknowns_tapered"])
        ]
        powers = [_span(fit[name]) for name in ("unknowns_power", "time_power")]
        rows.append([problem, str(fit["unknowns"]["count"]), *laws, *powers])
    return table(" | ".join(heading), rows)


def _span(line: Record) -> str:
    """Return a slope with its interval."""
    low, high = line["interval"]
    return f"{line['slope']:.3g} [{low:.3g}, {high:.3g}]"


def _monotony(record: Record) -> str:
    """Return where a tighter tolerance had fewer unknowns, or was not met."""
    found = record["monotony"]
    falls = [(one["scene"], *fall) for one in found["findings"] for fall in one["falls"]]
    unmet = [one for one in found["findings"] if one["unmet"]]
    pairs = found["scenes"] * (len(found["tolerances"]) - 1)
    largest = sum(name == "largest" for _, name, *_ in falls)
    text = (
        f"{found['scenes']} gold scenes at {len(found['tolerances'])} tolerances each, {pairs} "
        f"pairs of neighbours. The largest system is smaller at the tighter tolerance in "
        f"{largest or 'none'} of them, that of a single step in {len(falls) - largest}."
    )
    rows = [
        [_scene(scene), name, f"`rtol={rtol:g}`: {before} → {size} unknowns"]
        for scene, name, rtol, before, size in falls
    ]
    for one in unmet:
        tolerances = ", ".join(f"{rtol:g}" for rtol in one["unmet"])
        rows.append([_scene(one["scene"]), "all", f"not met: `rtol` {tolerances}"])
    return f"{text}\n\n{table('scene | system | finding', rows)}" if rows else text


def _scene(scene: Record) -> str:
    symbols = {"ν": "poisson_ratio", "α*": "normal_compliance", "β*": "tangential_compliance"}
    parts = [f"{symbol} = {scene[name]:g}" for symbol, name in symbols.items()]
    friction = scene["friction"]
    shown = friction if isinstance(friction, str) or friction is None else f"{friction:g}"
    return ", ".join([*parts, f"f = {shown}"])


def _prices(record: Record) -> str:
    heading = ["what", "unknowns", "warm", "warm [U]", "cold"]
    unit = record["dense_solve_seconds"]
    rows = []
    for price in record["prices"]:
        warm, cold = _price_seconds(price)
        unknowns = "–" if price["unknowns"] is None else str(price["unknowns"])
        cells = [_seconds(warm), _number(warm / unit), _seconds(cold)]
        rows.append([price["item"], unknowns, *cells])
    return table(" | ".join(heading), rows)


def _price_seconds(price: Record) -> tuple[float, float]:
    """Return warm and cold seconds, nan if there are none; many digits have one time."""
    if "seconds" in price:
        return math.nan, float(price["seconds"])
    return _warm(price) / 1e3, _cold(price) / 1e3


# --- the figure -----------------------------------------------------------------------------------


def _power(number: float) -> str:
    if number == 0.0 or number >= 0.1:
        return f"{number:g}"
    return rf"$10^{{{math.log10(number):.0f}}}$"


def draw_errors(record: Record, path: Path) -> None:
    """Draw true errors and estimates over the tolerance: a row a problem, a column a compliance."""
    problems, compliances = _cases(record)
    with style():
        figure = Figure(figsize=(11.0, 5.8), layout="constrained")
        rows = figure.subplots(len(problems), len(compliances), sharex=True, sharey=True)
        for row, problem in zip(rows, problems, strict=True):
            for axes, compliance in zip(row, compliances, strict=True):
                points = series(record, problem, compliance)
                rtol = [p["resolution"] for p in points]
                axes.plot(rtol, rtol, color="0.6", lw=0.8)
                estimates = [max(worst(p, "estimates"), LEAST) for p in points]
                axes.plot(rtol, estimates, "s--", color="0.35", mfc="white", ms=4.0, lw=0.8)
                errors = [max(worst(p, "errors"), LEAST) for p in points]
                axes.plot(rtol, errors, "o-", color="black", ms=3.5, lw=0.8)
                axes.set(xscale="log", yscale="log", xlim=(3e-2, 3e-13), ylim=(2e-17, 1.0))
                axes.set_xticks([1e-2, 1e-7, 1e-12])
                axes.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1.0])
                axes.minorticks_off()
            row[0].set_ylabel(problem)
        for axes, compliance in zip(rows[0], compliances, strict=True):
            axes.set_title(rf"$\alpha^* = \beta^* =$ {_power(compliance)}")
        for axes in rows[-1]:
            axes.set_xlabel("rtol")
        names = ["tolerance asked", "estimate"]
        names.append("true relative error, at the worst place (0 at $10^{-16}$)")
        figure.legend(rows[0][0].get_lines(), names, loc="outside lower center", ncols=3)
        figure.supylabel("the worst of $\\delta^*$, $p^*$, $q^*$, $Q^*$", fontsize=9.0)
    save(figure, str(path))


def _seconds(seconds: float) -> str:
    if math.isnan(seconds):
        return "–"
    return f"{_number(1e3 * seconds)} ms" if seconds < 1.0 else f"{_number(seconds)} s"
