"""Tables and the figure of what accuracy costs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd
from reporting import picture, table

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


def frame(record: Record) -> pd.DataFrame:
    """Return the points as rows: unknowns, times in ms, the worst error and the worst estimate."""
    rows = []
    for point in record["points"]:
        warm, cold = _milliseconds(point["times"])
        known = {key: point[key] for key in ("problem", "compliance", "resolution")}
        known |= {"unknowns": all_unknowns(point), "warm": warm, "cold": cold}
        for kind in ("errors", "estimates"):
            known[kind] = max(float(point[kind][one]) for one in BOUNDED if one in point[kind])
        rows.append(known)
    return pd.DataFrame(rows)


def _milliseconds(times: Record) -> tuple[float, float]:
    """Return warm and cold times; nan if there is none."""
    found = (times[state] for state in ("warm", "cold"))
    warm, cold = (math.nan if one is None else 1e3 * float(one["median"]) for one in found)
    return warm, cold


def _number(value: float, digits: int = 2) -> str:
    if not math.isfinite(value):
        return "–"
    return f"{value:.{digits}g}" if abs(value) < 10.0**digits else f"{value:.0f}"


# --- tables ---------------------------------------------------------------------------------------


def tables(record: Record) -> str:
    """Return the Markdown tables, each after a comment by which a page can quote it."""
    points = frame(record)
    parts = {
        "about": _about(record, points),
        "digits": _digits(points),
        "roughness": _roughness(points),
        "growth": _growth(record),
        "monotony": _monotony(record["monotony"]),
        "prices": _prices(record),
    }
    text = f"{record['count']} solves.\n\n"
    return text + "\n".join(f"<!-- {name} -->\n\n{part}\n" for name, part in parts.items())


def _about(record: Record, points: pd.DataFrame) -> str:
    machine = record["machine"]
    taken = "**Times are rough**: one repeat on a busy machine."
    if record["repeats"] > 1:
        taken = (
            f"Warm: the median of {record['repeats']} repeats or more of the same solve; cold: "
            "that of solves with empty caches."
        )
    return (
        f"{points.problem.nunique()} problems at {points.compliance.nunique()} compliances, "
        f"{len(points)} solves. {taken} One BLAS thread. {machine['processor']}, "
        f"Python {machine['python']}, numpy {machine['numpy']}; U, one `numpy.linalg.solve` of "
        f"1000 dense equations there, takes {1e3 * record['dense_solve_seconds']:.0f} ms. Truth: "
        f"{'; '.join(record['truths'])}."
    )


def _digits(points: pd.DataFrame) -> str:
    """Return unknowns and times by tolerance, and what a digit adds."""
    rows = []
    for (problem, compliance), group in points.groupby(["problem", "compliance"], sort=False):
        known = group.set_index("resolution")
        cells = (
            f"{one.unknowns}, {_number(one.warm)} ms" for one in known.loc[[*SHOWN]].itertuples()
        )
        columns = ["unknowns", "warm"]
        more, longer = (known.loc[TO, columns] - known.loc[FROM, columns]) / math.log10(FROM / TO)
        added = f"{more:.0f}, {_number(longer)} ms" if more else "nothing"
        rows.append([problem, f"{compliance:g}", *cells, added])
    heading = ["problem", "α* = β*", *(f"{rtol:g}" for rtol in SHOWN), "a digit adds"]
    return table(" | ".join(heading), rows)


def _roughness(points: pd.DataFrame) -> str:
    """Return what the default tolerance costs, by compliance."""
    default = points[points.resolution == DEFAULT]
    heading = ["α* = β*"]
    for problem in default.problem.unique():
        heading += [f"{problem}: unknowns", "warm [ms]", "cold [ms]"]
    rows = []
    for compliance, group in default.groupby("compliance", sort=False):
        cells = ((one.unknowns, _number(one.warm), _number(one.cold)) for one in group.itertuples())
        rows.append([f"{compliance:g}", *(cell for three in cells for cell in three)])
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


def _monotony(found: Record) -> str:
    """Return where a tighter tolerance had fewer unknowns, or was not met."""
    rows, largest = [], 0
    for one in found["findings"]:
        for name, rtol, before, size in one["falls"]:
            largest += name == "largest"
            finding = f"`rtol={rtol:g}`: {before} → {size} unknowns"
            rows.append([_scene(one["scene"]), name, finding])
    falls = len(rows)
    for one in found["findings"]:
        if one["unmet"]:
            tolerances = ", ".join(f"{rtol:g}" for rtol in one["unmet"])
            rows.append([_scene(one["scene"]), "all", f"not met: `rtol` {tolerances}"])
    text = (
        f"{found['scenes']} gold scenes at {len(found['tolerances'])} tolerances each, "
        f"{found['scenes'] * (len(found['tolerances']) - 1)} "
        f"pairs of neighbours. The largest system is smaller at the tighter tolerance in "
        f"{largest or 'none'} of them, that of a single step in {falls - largest}."
    )
    return f"{text}\n\n{table('scene | system | finding', rows)}" if rows else text


def _scene(scene: Record) -> str:
    symbols = {"ν": "poisson_ratio", "α*": "normal_compliance", "β*": "tangential_compliance"}
    parts = [f"{symbol} = {scene[name]:g}" for symbol, name in symbols.items()]
    friction = scene["friction"]
    shown = friction if isinstance(friction, str) or friction is None else f"{friction:g}"
    parts.append(f"f = {shown}")
    if scene.get("coupling"):
        parts.append("coupled")
    for member in ("profile", "layer"):
        parts.extend(scene.get(member) or {})  # a table whose only key is the name of its kind
    if scene.get("unloaded_to", 1.0) != 1.0:
        parts.append(f"unloaded to {scene['unloaded_to']:g}")
    return ", ".join(parts)


def _prices(record: Record) -> str:
    rows = []
    for price in record["prices"]:
        # many digits have one time
        warm, cold = math.nan, 1e3 * price.get("seconds", math.nan)
        if "times" in price:
            warm, cold = _milliseconds(price["times"])
        unknowns = "–" if price["unknowns"] is None else price["unknowns"]
        in_u = _number(warm / (1e3 * record["dense_solve_seconds"]))
        rows.append([price["item"], unknowns, _time(warm), in_u, _time(cold)])
    return table("what | unknowns | warm | warm [U] | cold", rows)


def _time(milliseconds: float) -> str:
    if math.isnan(milliseconds):
        return "–"
    short = milliseconds < 1e3
    return f"{_number(milliseconds)} ms" if short else f"{_number(milliseconds / 1e3)} s"


# --- the figure -----------------------------------------------------------------------------------


def _power(number: float) -> str:
    if number == 0.0 or number >= 0.1:
        return f"{number:g}"
    return rf"$10^{{{math.log10(number):.0f}}}$"


def draw_errors(record: Record, path: Path) -> None:
    """Draw true errors and estimates over the tolerance: a row a problem, a column a compliance."""
    points = frame(record)
    problems, compliances = points.problem.unique(), points.compliance.unique()
    shape = len(problems), len(compliances)
    with picture(path, (11.0, 5.8), *shape, sharex=True, sharey=True) as rows:
        groups = points.groupby(["problem", "compliance"], sort=False)
        for axes, (_, known) in zip(rows.flat, groups, strict=True):
            rtol = known.resolution
            axes.plot(rtol, rtol, color="0.6", lw=0.8)
            estimates = known.estimates.clip(lower=LEAST)
            axes.plot(rtol, estimates, "s--", color="0.35", mfc="white", ms=4.0, lw=0.8)
            axes.plot(rtol, known.errors.clip(lower=LEAST), "o-", color="black", ms=3.5, lw=0.8)
            axes.set(xscale="log", yscale="log", xlim=(3e-2, 3e-13), ylim=(2e-17, 1.0))
            axes.set_xticks([1e-2, 1e-7, 1e-12])
            axes.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1.0])
            axes.minorticks_off()
        for axes, problem in zip(rows[:, 0], problems, strict=True):
            axes.set_ylabel(problem)
        for axes, compliance in zip(rows[0], compliances, strict=True):
            axes.set_title(rf"$\alpha^* = \beta^* =$ {_power(compliance)}")
        for axes in rows[-1]:
            axes.set_xlabel("rtol")
        figure = rows[0, 0].figure
        names = ["tolerance asked", "estimate"]
        names.append("true relative error, at the worst place (0 at $10^{-16}$)")
        figure.legend(rows[0, 0].get_lines(), names, loc="outside lower center", ncols=3)
        figure.supylabel("the worst of $\\delta^*$, $p^*$, $q^*$, $Q^*$", fontsize=9.0)
