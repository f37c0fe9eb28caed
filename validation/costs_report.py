"""Tables and figures of what accuracy costs."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from spectral_contact.plotting import save, style

#: What `rtol` bounds; the edge is one of the places of the pressure.
BOUNDED = ("approach", "pressure", "traction", "total_shear")
#: Errors of zero are drawn here.
LEAST = 1e-17
MARKERS = "osD^vP"
SHOWN = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
#: A digit is priced between these.
FROM, TO = 1e-2, 1e-12
DEFAULT = 1e-10

Record = dict[str, Any]


def growth_argument(rtol: float, compliance: float) -> float:
    """Return ``log(1/rtol) log(1/(alpha rtol))``."""
    return math.log(rtol) * math.log(compliance * rtol)


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
    return 1e3 * float(point["times"]["cold"]["median"])


# --- tables ---------------------------------------------------------------------------------------


def tables(record: Record) -> str:
    """Return the Markdown tables, each after a comment by which a page can quote it."""
    parts = [
        ("about", _about(record)),
        ("digits", _digits(record)),
        ("roughness", _roughness(record)),
        ("growth", _growth(record)),
        ("monotony", _monotony(record)),
        ("prices", _prices(record)),
        ("steps", _steps(record)),
        ("points", _points(record)),
    ]
    text = f"{record['count']} solves.\n\n"
    return text + "\n".join(f"<!-- {name} -->\n\n{part}\n" for name, part in parts)


def _table(heading: list[str], rows: list[list[str]]) -> str:
    lines = [heading, ["---"] * len(heading), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _about(record: Record) -> str:
    watch, machine = record["stopwatch"], record["machine"]
    problems, compliances = _cases(record)
    over = record["exceeded"]
    most = max(watch["repeats"], 1)
    lines = [
        f"{len(problems)} problems at {len(compliances)} compliances and "
        f"{record['count'] // len(problems) // len(compliances)} tolerances, "
        f"{record['count']} solves. Warm: the median of {most} repeats or more; cold: the median "
        f"of first solves in {watch['processes']} fresh processes, imports not counted; one BLAS "
        f"thread. {machine['processor']}, Python {machine['python']}, numpy {machine['numpy']}; "
        "there `numpy.linalg.solve` of 1000 dense equations, U, takes "
        f"{1e3 * record['dense_solve_seconds']:.0f} ms.",
        "",
        f"True errors above their estimates: {len(over) or 'none'}.",
    ]
    lines += [
        f"{p['problem']} at {p['compliance']:g}, `rtol={p['resolution']:g}`: {p['quantity']}, "
        f"error {p['error']:.1e}, estimate {p['estimate']:.1e}."
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
            cells = [f"{points[r]['unknowns']}, {_warm(points[r]):.2g} ms" for r in SHOWN]
            count = math.log10(FROM / TO)
            more = (points[TO]["unknowns"] - points[FROM]["unknowns"]) / count
            longer = (_warm(points[TO]) - _warm(points[FROM])) / count
            added = f"{more:.0f}, {max(longer, 0.0):.2g} ms" if more else "nothing"
            rows.append([problem, f"{compliance:g}", *cells, added])
    return _table(heading, rows)


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
            row += [str(point["unknowns"]), f"{_warm(point):.2g}", f"{_cold(point):.3g}"]
        rows.append(row)
    return _table(heading, rows)


def _growth(record: Record) -> str:
    """Return the fitted growth with intervals of 95 per cent."""

    def span(line: Record) -> str:
        low, high = line["interval"]
        return f"{line['slope']:.3g} [{low:.3g}, {high:.3g}]"

    heading = ["problem", "points", "N = a + b L", "within", "N ~ L^k: k", "time ~ N^m: m"]
    rows = []
    for problem, fit in record["fits"].items():
        line = fit["unknowns"]
        law = f"a = {line['intercept']:.0f}, b = {span(line)}"
        rest = f"{line['residual']:.0f} unknowns"
        powers = [span(fit[name]) for name in ("unknowns_power", "time_power")]
        rows.append([problem, str(line["count"]), law, rest, *powers])
    return _table(heading, rows)


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
    return f"{text}\n\n{_table(['scene', 'system', 'finding'], rows)}" if rows else text


def _scene(scene: Record) -> str:
    symbols = {"ν": "poisson_ratio", "α*": "normal_compliance", "β*": "tangential_compliance"}
    parts = [f"{symbol} = {scene[name]:g}" for symbol, name in symbols.items()]
    friction = scene["friction"]
    shown = friction if isinstance(friction, str) or friction is None else f"{friction:g}"
    return ", ".join([*parts, f"f = {shown}"])


def _prices(record: Record) -> str:
    heading = ["what", "unknowns", "warm [ms]", "warm [U]", "cold [ms]"]
    unit = record["dense_solve_seconds"]
    rows = []
    for price in record["prices"]:
        warm, cold = _price_seconds(price)
        cells = ["–", "–"] if warm is None else [f"{1e3 * warm:.2g}", f"{warm / unit:.2g}"]
        last = f"{1e3 * cold:.3g}" if cold < 1.0 else f"{cold:.2g} s"
        unknowns = price["unknowns"]
        rows.append([price["item"], "–" if unknowns is None else str(unknowns), *cells, last])
    return _table(heading, rows)


def _price_seconds(price: Record) -> tuple[float | None, float]:
    """Return warm and cold seconds; many digits have one time."""
    if "seconds" in price:
        return None, float(price["seconds"])
    return float(price["warm"]["median"]), float(price["cold"]["median"])


def _steps(record: Record) -> str:
    solves = list(dict.fromkeys(row["solve"] for row in record["steps"]))
    names = list(dict.fromkeys(row["step"] for row in record["steps"]))
    taken = {(row["solve"], row["step"]): row["median"] for row in record["steps"]}
    totals = {s: sum(v for (one, _), v in taken.items() if one == s) for s in solves}
    rows = []
    for name in names:
        cells = [
            f"{1e3 * taken[s, name]:.2g} ms, {100 * taken[s, name] / totals[s]:.0f} %"
            if (s, name) in taken
            else "–"
            for s in solves
        ]
        rows.append([name, *cells])
    rows.append(["all", *(f"{1e3 * totals[s]:.2g} ms" for s in solves)])
    return _table(["step", *solves], rows)


def _points(record: Record) -> str:
    """Return every point."""
    heading = ["problem", "α* = β*", "rtol", "error", "estimate", "unknowns", "spaces"]
    heading += ["warm [ms]", "cold [ms]"]
    rows = [
        [
            p["problem"],
            f"{p['compliance']:g}",
            f"{p['resolution']:g}",
            f"{worst(p, 'errors'):.0e}",
            f"{worst(p, 'estimates'):.0e}",
            str(p["unknowns"]),
            str(p["refinements"]),
            f"{_warm(p):.3g}",
            f"{_cold(p):.3g}",
        ]
        for p in record["points"]
    ]
    text = "Errors and estimates are the largest of those that `rtol` bounds.\n\n"
    return text + _table(heading, rows)


# --- figures --------------------------------------------------------------------------------------


def _power(number: float) -> str:
    exponent = math.log10(number) if number > 0.0 else math.nan
    return rf"$10^{{{exponent:.0f}}}$" if number < 0.1 and number > 0.0 else f"{number:g}"


def draw_errors(record: Record, path: Path) -> None:
    """Draw true errors and estimates over the tolerance: a row a problem, a column a compliance."""
    problems, compliances = _cases(record)
    with style():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(11.0, 5.8), layout="constrained")
        rows = figure.subplots(len(problems), len(compliances), sharex=True, sharey=True)
        for row, problem in zip(rows, problems, strict=True):
            for axes, compliance in zip(row, compliances, strict=True):
                points = series(record, problem, compliance)
                rtol = [p["resolution"] for p in points]
                axes.plot(rtol, rtol, color="0.6", lw=0.8, label="tolerance")
                estimates = [max(worst(p, "estimates"), LEAST) for p in points]
                axes.plot(rtol, estimates, "s--", color="0.35", mfc="white", ms=4.0, lw=0.8)
                errors = [max(worst(p, "errors"), LEAST) for p in points]
                axes.plot(rtol, errors, "o-", color="black", ms=3.5, lw=0.8)
                axes.set(xscale="log", yscale="log", xlim=(3e-2, 3e-13), ylim=(5e-18, 1.0))
                axes.set_xticks([1e-2, 1e-7, 1e-12])
                axes.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1.0])
                axes.minorticks_off()
            row[0].set_ylabel(problem)
        for axes, compliance in zip(rows[0], compliances, strict=True):
            axes.set_title(rf"$\alpha^* = \beta^* =$ {_power(compliance)}")
        for axes in rows[-1]:
            axes.set_xlabel("rtol")
        handles = rows[0][0].get_lines()
        names = ["tolerance asked", "estimate", "true relative error, at the worst place"]
        figure.legend(handles, names, loc="outside lower center", ncols=3)
        figure.supylabel("the worst of $\\delta^*$, $p^*$, $q^*$, $Q^*$", fontsize=9.0)
    save(figure, str(path))


def draw_growth(record: Record, path: Path) -> None:
    """Draw unknowns over the logarithms with the fitted line, and times over unknowns."""
    problems, compliances = _cases(record)
    rough = [c for c in compliances if c > 0.0]
    with style():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(9.4, 6.4), layout="constrained")
        top, bottom = figure.subplots(2, len(problems), sharey="row")
        for axes, below, problem in zip(top, bottom, problems, strict=True):
            for marker, compliance in zip(MARKERS, rough, strict=False):
                points = series(record, problem, compliance)
                x = [growth_argument(p["resolution"], compliance) for p in points]
                unknowns = [p["unknowns"] for p in points]
                mark = {"marker": marker, "ls": "", "ms": 4.0, "color": "black"}
                label = rf"$\alpha^* =$ {_power(compliance)}"
                axes.plot(x, unknowns, **mark, label=label)
                below.plot(unknowns, list(map(_warm, points)), **mark)
                below.plot(unknowns, list(map(_cold, points)), **mark | {"mfc": "white"}, mew=0.6)
            _draw_line(axes, record["fits"][problem]["unknowns"], lambda x: x, 0.0, _reach(axes))
            fit = record["fits"][problem]["time_power"]
            span = [p["unknowns"] for p in record["points"] if p["problem"] == problem]
            low = min(n for n in span if n > 0)
            _draw_line(below, fit, np.log, float(low), float(max(span)), scale=1e3)
            axes.set(title=problem, xlabel=r"$\ln(1/rtol)\;\ln(1/(\alpha^*\,rtol))$")
            below.set(xscale="log", yscale="log", xlabel="unknowns $N$")
        top[0].set_ylabel("unknowns $N$ of the largest system")
        bottom[0].set_ylabel("time [ms]: full warm, open cold")
        handles, names = top[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=len(rough))
    save(figure, str(path))


def _reach(axes: Any) -> float:
    return float(axes.dataLim.x1)


def _draw_line(
    axes: Any,
    line: Record,
    scale_of: Callable[[Any], Any],
    low: float,
    high: float,
    scale: float = 1.0,
) -> None:
    """Draw a fitted line with its law; over logarithms it is a power."""
    logarithmic = scale_of is np.log
    x = np.geomspace(low, high, 50) if logarithmic else np.linspace(low, high, 2)
    y = line["intercept"] + line["slope"] * scale_of(x)
    axes.plot(x, scale * np.exp(y) if logarithmic else y, color="0.45", lw=1.0)
    ends = "[{:.3g}, {:.3g}]".format(*line["interval"])
    law = rf"$t \sim N^m$, $m$ = {line['slope']:.3g} {ends}"
    if not logarithmic:
        law = rf"$N = {line['intercept']:.0f} + b\,L$, $b$ = {line['slope']:.3g} {ends}"
    axes.text(0.03, 0.95, law, transform=axes.transAxes, va="top", fontsize=8.0)


def draw_prices(record: Record, path: Path) -> None:
    """Draw the price list as bars."""
    prices = record["prices"]
    with style():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7.6, 0.9 + 0.36 * len(prices)), layout="constrained")
        axes = figure.subplots()
        for row, price in enumerate(prices):
            warm, cold = _price_seconds(price)
            axes.barh(row, 1e3 * cold, height=0.7, color="0.82", edgecolor="0.4", lw=0.5)
            if warm is not None:
                axes.barh(row, 1e3 * warm, height=0.4, color="0.25")
            shown = cold if warm is None else warm
            end = 1e3 * max(cold, warm or 0.0)
            axes.text(1.25 * end, row, _seconds(shown), va="center", fontsize=8.0)
        axes.set_yticks(range(len(prices)), [price["item"] for price in prices])
        axes.invert_yaxis()
        axes.set(xscale="log", xlabel="time [ms]: dark and number warm, light cold")
        low, high = axes.get_xlim()
        axes.set_xlim(min(low, 0.05), 5.0 * high)
        axes.grid(visible=False, axis="y")
    save(figure, str(path))


def _seconds(seconds: float) -> str:
    return f"{1e3 * seconds:.2g} ms" if seconds < 1.0 else f"{seconds:.2g} s"
