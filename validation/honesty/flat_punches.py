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

import argparse
import json
import multiprocessing
import signal
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from hashlib import sha256
from pathlib import Path
from time import perf_counter

import numpy as np
from honesty_errors import EPS, violates
from honesty_scenes import by_reference, outcome

import spectral_contact
from spectral_contact import __version__

RESULTS = Path(__file__).parents[1] / "results"
CHUNK = 10


def sources() -> str:
    """Return a digest of the library's sources, to tell whose results a store holds."""
    digest = sha256()
    for path in sorted(Path(spectral_contact.__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def stored(store: Path, seed: int) -> dict[int, dict]:
    """Return what the store holds of a seed, by number; a line cut short is not counted."""
    rows = {}
    if store.exists():
        for line in store.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except ValueError:
                continue
            if row["seed"] == seed:
                rows[row["number"]] = row
    return rows


def run_chunk(seed: int, numbers: list[int], exact: set[int], coupled: bool) -> list[dict]:
    """Return the outcomes of some scenes; the truth of those in `exact` has many digits."""
    return [outcome(seed, number, number in exact, coupled) for number in numbers]


def outcomes(
    seed: int, numbers: list[int], exact: set[int], coupled: bool, workers: int
) -> Iterator[list[dict]]:
    """Yield the outcomes of all scenes, chunk by chunk as they are done."""
    chunks = [numbers[i : i + CHUNK] for i in range(0, len(numbers), CHUNK)]
    if workers == 1:
        yield from (run_chunk(seed, chunk, exact, coupled) for chunk in chunks)
        return
    # ended from outside, the processes end, too
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped; the same command goes on"))
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        futures = [pool.submit(run_chunk, seed, chunk, exact, coupled) for chunk in chunks]
        try:
            yield from (future.result() for future in as_completed(futures))
        finally:
            pool.shutdown(cancel_futures=True)


def show_progress(done: int, total: int, left: float, violations: int) -> None:
    """Draw the progress bar on stderr."""
    if sys.stderr.isatty() or done == total:
        filled = round(40 * done / max(total, 1))
        text = f"[{'#' * filled}{'.' * (40 - filled)}] {done}/{total}"
        text += f", {left / 60:.0f} min left, {violations} violations "
        print(f"\r{text}", end="\n" if done == total else "", file=sys.stderr, flush=True)


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


def study(
    count: int,
    seed: int,
    references: int,
    workers: int,
    store: Path,
    *,
    stale: bool,
    coupled: bool,
) -> list[dict]:
    """Run what the store does not hold yet, and return the rows of all scenes."""
    current = sources()
    rows = stored(store, seed)
    rows = {n: r for n, r in rows.items() if n < count and (stale or r["sources"] == current)}
    exact = {n for n in range(count) if by_reference(seed, n)}
    exact = set(sorted(exact)[:references])
    rows = {n: r for n, r in rows.items() if r.get("by_reference", False) == (n in exact)}
    missing = [number for number in range(count) if number not in rows]
    violations = sum(len(violations_of(row)) for row in rows.values())
    begin, done = perf_counter(), 0
    store.parent.mkdir(parents=True, exist_ok=True)
    with store.open("a", encoding="utf-8") as file:
        for chunk in outcomes(seed, missing, exact, coupled, workers):
            spent = perf_counter() - begin
            for row in chunk:
                row |= {"seed": seed, "sources": current}
                file.write(json.dumps(row) + "\n")
                rows[row["number"]] = row
                violations += len(violations_of(row))
            file.flush()
            done += len(chunk)
            left = spent / done * (len(missing) - done)
            show_progress(count - len(missing) + done, count, left, violations)
    return [rows[number] for number in sorted(rows)]


def collected(rows: list[dict]) -> dict[str, np.ndarray]:
    """Return error, estimate and the truth's own estimate of every quantity, as columns."""
    values = defaultdict(list)
    for row in rows:
        for name, triple in row.get("errors", {}).items():
            values[name].append(triple)
    return {name: np.array(triples).T for name, triples in values.items()}


def record_of(rows: list[dict], seeds: list[int], name: str) -> dict:
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
        "schema": f"spectral_contact.validation.{name}",
        "version": 2,
        "library": __version__,
        "scenes": len(rows),
        "seeds": seeds,
        "sources": sorted({row["sources"] for row in rows}),
        "by_reference": sum(row.get("exact", False) for row in rows),
        "unconverged": sum(row.get("unconverged", False) for row in rows),
        "differing_zones": sum(row.get("differing", False) for row in rows),
        "undecided": sum(map(undecided, rows)),
        "summary": summary,
        "violations": violations,
    }


def table(record: dict) -> str:
    """Return the record as a Markdown table."""
    lines = [
        f"{record['scenes']} scenes, seeds {', '.join(map(str, record['seeds']))}, "
        f"{record['by_reference']} of them "
        f"against solutions to 20 digits; {record['unconverged']} did not "
        f"converge and said so; in {record['differing_zones']}, at the onset of a zone, the two "
        f"solves differ in zones; in {record['undecided']} an error is above its estimate, but by "
        "no more than the truth may be off. The ratio is that of the estimate to the true error or "
        "ten roundings, whichever is larger; where no digit is known the estimate is infinite.",
        "",
        "| quantity | scenes | violations | no digit known | ratio at 5, 50, 95 % | within 100 |",
        "|---|---|---|---|---|---|",
    ]
    for name, s in record["summary"].items():
        low, middle, high = s["ratio_percentiles_5_50_95"]
        lines.append(
            f"| {name} | {s['scenes']} | {s['violations']} | {s['no_digit_known']} | "
            f"{low:.1f}, {middle:.0f}, {high:.3g} | {100 * s['share_within_100']:.0f} % |"
        )
    return "\n".join(lines) + "\n"


def draw(rows: list[dict], path: Path) -> None:
    """Draw the estimate against the true error of every quantity."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    values = collected(rows)
    edges = np.linspace(-17.0, 1.0, 73)
    down = -(-len(values) // 3)
    layout = {"figsize": (9.6, 3.0 * down), "sharex": True, "sharey": True, "layout": "constrained"}
    figure, axes = plt.subplots(down, 3, **layout)
    for axis in axes.flat[len(values) :]:
        axis.set_visible(False)
    counts = [
        np.histogram2d(*np.log10(np.clip(pair[:2], 10.0**-16.9, 9.0)), bins=(edges, edges))[0]
        for pair in values.values()
    ]
    # a single scene is to be seen, too
    shades = matplotlib.colors.LogNorm(0.2, max(float(count.max()) for count in counts))
    ends = np.array([1e-17, 10.0])
    for axis, name, count in zip(axes.flat, values, counts, strict=False):
        shown = np.where(count > 0.0, count, np.nan).T
        mesh = axis.pcolormesh(10.0**edges, 10.0**edges, shown, cmap="Greys", norm=shades)
        axis.plot(ends, ends, color="black", linewidth=1.0)
        axis.plot(ends, 100.0 * ends, color="black", linewidth=0.8, linestyle=":")
        axis.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
        axis.set_title(name.replace("_", " "), fontsize=10)
        axis.set_xticks([1e-16, 1e-12, 1e-8, 1e-4, 1])
        axis.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1])
    clipped = "true error; 0 is drawn at the left rim, what is infinite or above 10 at the top"
    figure.supxlabel(clipped, fontsize=10)
    figure.supylabel("estimate (lines: as large as the error, 100 times that)", fontsize=10)
    bar = {"fraction": 0.03, "pad": 0.01, "aspect": 50}
    figure.colorbar(mesh, ax=axes, label="scenes", ticks=[1, 10, 100, 1000, 10000], **bar)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)


def main(stratum: str, arguments: Sequence[str]) -> bool:
    """Run, or go on, write the results, and return whether an estimate failed."""
    parser = argparse.ArgumentParser(prog=f"honesty.py {stratum}")
    parser.add_argument("--scenes", type=int, default=10_000, help="number of scenes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--references", type=int, default=200, help="truths of 20 digits")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--store", type=Path, help="file that keeps every scene")
    parser.add_argument("--stale", action="store_true", help="keep scenes of other sources, too")
    parser.add_argument("--also", type=Path, nargs="*", default=[], help="stores that count, too")
    parser.add_argument("--results", type=Path, default=RESULTS, help="folder to write to")
    parser.add_argument("--name", help="of the files that are written")
    options = parser.parse_args(arguments)
    counts = options.scenes, options.seed, options.references, options.workers
    name = "honesty_coupled" if stratum == "coupled" else "honesty"
    store = options.store or Path(tempfile.gettempdir()) / f"spectral_contact_{name}.jsonl"
    rows = study(*counts, store, stale=options.stale, coupled=stratum == "coupled")
    texts = [other.read_text(encoding="utf-8") for other in options.also]
    each = [json.loads(line) for text in texts for line in text.splitlines()]
    rows += {(row["seed"], row["number"]): row for row in each}.values()  # the last of each
    record = record_of(rows, sorted({row["seed"] for row in rows}), name)
    options.results.mkdir(exist_ok=True)
    text, file = json.dumps(record, indent=1), options.results / (options.name or name)
    file.with_suffix(".json").write_text(text + "\n", encoding="utf-8")
    file.with_suffix(".md").write_text(table(record), encoding="utf-8")
    draw(rows, file.with_suffix(".png"))
    print(table(record))
    for violation in record["violations"]:
        print(violation)
    return bool(record["violations"])
