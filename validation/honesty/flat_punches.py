"""Compare estimated with true errors over random scenes of flat punches.

Strata of honesty.py: ``flat`` writes validation/results/honesty.json, .md and .png, ``coupled``, of
full stick with elastic coupling, where scenes against references are solved at 1e-12,
honesty_coupled. Every scene that is done is a line of the store; the same command goes on where a
run was stopped.

Truth is a solve at rtol = 1e-12 on panels of another width, whose own estimate is allowed for; for
some scenes, of all strata, it is `reference` to 20 digits. The traction is compared up to the
estimated shift of the zone boundaries. A violation is a true error above the estimate, an exception
or a warning, a broken friction law that no estimate explains, and an infinite estimate of the slip
that a closer tolerance makes finite. Scenes cover alpha, beta in {0} and 1e-14 ... 1e14, all nu,
and friction from 1e-3 of the critical to 1e-6 below it; tolerances are 1e-2 ... 1e-9. A quarter
of the scenes is of two elastic bodies with negative kappa.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
from honesty_errors import EPS, violates
from honesty_scenes import by_reference, outcome
from reporting import RESULTS, options, picture, table, write
from strata import kept_rows, store_of


def violations_of(row: dict) -> list[dict]:
    """Return the violations of a scene, as they are listed in the record."""
    begin = {key: row.get(key) for key in ("number", "scene", "rtol")}
    if "raised" in row:
        return [{**begin, "quantity": "solve", "raised": row["raised"]}]
    found = [
        {**begin, "quantity": name, "error": error, "estimate": estimate}
        for name, (error, estimate, own) in row["errors"].items()
        if violates(error, estimate, own)
    ]
    return found + [{**begin, "unexplained": name} for name in row.get("unexplained", ())]


def undecided(row: dict) -> bool:
    """Return whether an error is above its estimate by no more than its truth may be off."""
    found = row.get("errors", {}).values()
    return not violations_of(row) and any(violates(error, bound, 0.0) for error, bound, _ in found)


def collected(rows: list[dict]) -> dict[str, np.ndarray]:
    """Return error, estimate and the truth's own estimate of every quantity, as columns."""
    values = defaultdict(list)
    for row in rows:
        for name, triple in row.get("errors", {}).items():
            values[name].append(triple)
    return {name: np.array(triples).T for name, triples in values.items()}


def record_of(rows: list[dict], seed: int) -> dict:
    """Return the record of the study."""
    summary = {}
    violations = [one for row in rows for one in violations_of(row)]
    for quantity, (error, estimate, _) in collected(rows).items():
        known = np.isfinite(estimate)
        ratio = estimate / np.maximum(error, 10 * EPS)
        low, middle, high = np.percentile(ratio[known], [5, 50, 95])
        summary[quantity] = {
            "scenes": len(error),
            "violations": sum(one.get("quantity") == quantity for one in violations),
            "no_digit_known": int(np.sum(~known)),
            "ratio_percentiles_5_50_95": [float(low), float(middle), float(high)],
            "share_within_100": float(np.mean(ratio <= 100.0)),
        }
    return {
        "scenes": len(rows),
        "seeds": [seed],
        "sources": sorted({row["sources"] for row in rows}),
        "by_reference": sum(row.get("exact", False) for row in rows),
        "unconverged": sum(row.get("unconverged", False) for row in rows),
        "differing_zones": sum(row.get("differing", False) for row in rows),
        "undecided": sum(map(undecided, rows)),
        "summary": summary,
        "violations": violations,
    }


def page(record: dict) -> str:
    """Return the record as Markdown."""
    about = (
        f"{record['scenes']} scenes, seed {', '.join(map(str, record['seeds']))}, "
        f"{record['by_reference']} of them "
        f"against solutions to 20 digits; {record['unconverged']} did not "
        f"converge and said so; in {record['differing_zones']}, at the onset of a zone, the two "
        f"solves differ in zones; in {record['undecided']} an error is above its estimate, but by "
        "no more than the truth may be off. The ratio is that of the estimate to the true error or "
        "ten roundings, whichever is larger; where no digit is known the estimate is infinite."
    )
    cells = []
    for name, s in record["summary"].items():
        low, middle, high = s["ratio_percentiles_5_50_95"]
        counts = s["scenes"], s["violations"], s["no_digit_known"]
        share = f"{100 * s['share_within_100']:.0f} %"
        cells.append((name, *counts, f"{low:.3g}, {middle:.3g}, {high:.3g}", share))
    heading = "quantity | scenes | violations | no digit known | ratio at 5, 50, 95 % | within 100"
    return f"{about}\n\n{table(heading, cells)}"


def draw(rows: list[dict], path: Path) -> None:
    """Draw the estimate against the true error of every quantity."""
    from matplotlib.colors import LogNorm

    values = collected(rows)
    edges = np.linspace(-17.0, 1.0, 73)
    down = -(-len(values) // 3)
    counts = [
        np.histogram2d(*np.log10(np.clip(pair[:2], 10.0**-16.9, 9.0)), bins=(edges, edges))[0]
        for pair in values.values()
    ]
    # a single scene is to be seen, too
    shades = LogNorm(0.2, max(float(count.max()) for count in counts))
    ends = np.array([1e-17, 10.0])
    with picture(path, (9.6, 3.0 * down), down, 3, sharex=True, sharey=True) as axes:
        for axis in axes.flat[len(values) :]:
            axis.set_visible(False)
        for axis, name, count in zip(axes.flat, values, counts, strict=False):
            shown = np.where(count > 0.0, count, np.nan).T
            mesh = axis.pcolormesh(10.0**edges, 10.0**edges, shown, cmap="Greys", norm=shades)
            axis.plot(ends, ends, color="black", linewidth=1.0)
            axis.plot(ends, 100.0 * ends, color="black", linewidth=0.8, linestyle=":")
            axis.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
            axis.set_title(name.replace("_", " "), fontsize=10)
            axis.set_xticks([1e-16, 1e-12, 1e-8, 1e-4, 1])
            axis.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1])
        figure = axes.flat[0].figure
        clipped = "true error; 0 is drawn at the left rim, what is infinite or above 10 at the top"
        figure.supxlabel(clipped, fontsize=10)
        figure.supylabel("estimate (lines: as large as the error, 100 times that)", fontsize=10)
        bar = {"fraction": 0.03, "pad": 0.01, "aspect": 50}
        figure.colorbar(mesh, ax=axes, label="scenes", ticks=[1, 10, 100, 1000, 10000], **bar)


def main(stratum: str, arguments: Sequence[str]) -> bool:
    """Run, or go on, write the results, and return whether an estimate failed."""
    coupled = stratum == "coupled"
    name = "honesty_coupled" if coupled else "honesty"
    counts = {"scenes": 10_000, "seed": 1, "workers": 1, "references": 200}
    asked = options(__doc__, arguments, **counts, store=store_of(name), name=name)
    among = (number for number in range(asked.scenes) if by_reference(asked.seed, number))
    exact = frozenset(islice(among, asked.references))
    work = partial(outcome, seed=asked.seed, coupled=coupled, exact=exact)
    made_with = {"seed": asked.seed, "references": asked.references}
    rows = kept_rows(work, asked.scenes, asked.workers, asked.store, **made_with)
    record = record_of(rows, asked.seed)
    write(asked.name, page(record), record, version=2)
    draw(rows, RESULTS / f"{asked.name}.png")
    print(*record["violations"], sep="\n")
    return bool(record["violations"])
