"""Tables and figure of the hard cases."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from reporting import picture, table

#: What over-refined spaces show.
REFINED = "traction", "zones"
SHORT = {"approach": "δ*", "pressure": "p*", "traction": "q*", "total_shear": "Q*", "zones": "b"}
SYMBOL = {
    "poisson_ratio": "ν",
    "normal_compliance": "α*",
    "tangential_compliance": "β*",
    "friction": "f",
    "all": "all",
}


def _scene(scene: dict[str, Any]) -> str:
    values = (f"{SYMBOL[name]} = {scene[name]:.6g}" for name in list(SYMBOL)[:3])
    friction = scene["friction"]
    text = ", ".join(values) + f", f = {'∞' if friction == 'inf' else f'{friction:.6g}'}"
    return f"{text}, coupled" if scene.get("coupling") else text


def _pair(error: float, estimate: float | None) -> str:
    if not estimate and not error:
        return "–"
    excess = " **!**" if error > (estimate or 0.0) else ""
    return f"{error:.0e} / {estimate:.0e}{excess}"


def tables(record: dict[str, Any]) -> str:
    """Return the Markdown tables."""
    cases = record["cases"]
    scenes = ((c["name"], _scene(c["scene"]), c["why"], c["how"]) for c in cases)
    errors, conditions = [], []
    for c in cases:
        pairs = c["integral"] or {"none": (0.0, 0.0)}
        tight = max(pairs.values(), key=lambda pair: pair[0] / (pair[1] or 1.0))
        cells = (_pair(c["errors"][name], c["estimates"][name]) for name in SHORT)
        errors.append((c["name"], c["ending"].lower(), *cells, _pair(*tight)))
        worst = max(
            (v, f"{out} by {SYMBOL[name]}")
            for name, values in c["conditioning"].items()
            for out, v in values.items()
        )
        largest, ratio = (max(row[key] for row in c["ulps"]) for key in ("moved", "ratio"))
        fine, last = c["overrefined"], ["–"] * 3
        if fine:
            last = [_pair(fine["errors"][one], fine["estimates"][one]) for one in REFINED]
            last.append(str(fine["unknowns"]))
        matrices = ", ".join(f"{k} {v:.0f}" for k, v in c["matrices"].items())
        shifts = f"{largest:.0e}", f"{ratio:.0f}"
        conditions.append((c["name"], matrices, f"{worst[0]:.1e}, {worst[1]}", *shifts, *last))
    parts = [
        f"{len(cases)} cases. The scenes:",
        table("case | scene | what makes it hard | truth", scenes),
        "True relative error / its estimate at `rtol=1e-12`; $p^*$ and $q^*$ at their worst point, "
        "$b$ all zone boundaries and their distances from the edge; the last column is the worst "
        "of $\\delta^*$, $Q^*$, $c^*$ at `rtol=1e-13`. **!** marks an estimate that is exceeded.",
        table(f"case | ending | {' | '.join(SHORT.values())} | at 1e-13", errors),
        "Conditions: of the scaled matrices that are factored, of normal contact (N), of the stick "
        "disk (T), of stick annuli, and of both tractions where they are coupled; of the problem "
        "itself, the largest relative change of an output per relative change of an input, and "
        "which; the largest shift of an output by one ulp of an input, and the largest ratio of a "
        "shift to what conditioning explains: that of the input times its ulp and that of any of "
        "α*, β*, f times ε; and, in over-refined spaces of degree 40 everywhere and 12 more "
        "panels, errors / estimates of $q^*$ and $b$, with the unknowns.",
        table(
            "case | matrices | problem | largest shift | shift / explained | over-refined q* | b | "
            "unknowns",
            conditions,
        ),
    ]
    return "\n\n".join(parts)


def draw(record: dict[str, Any], path: Path) -> None:
    """Draw errors beside estimates, and shifts beside what explains them."""
    bar = {"marker": "|", "ms": 6.0, "color": "0.35", "ls": ""}
    with picture(path, (8.4, 8.0), columns=2, sharey=True, width_ratios=(3, 2)) as axes:
        for row, c in enumerate(record["cases"]):
            for k, (name, mark) in enumerate(zip(SHORT, "os^Dx", strict=True)):
                error, estimate = c["errors"][name], c["estimates"][name]
                if error or estimate:
                    y = row + 0.13 * (k - 2)
                    axes[0].plot(
                        [max(error, 1e-16), estimate], [y, y], color="0.7", lw=1.0, zorder=1
                    )
                    axes[0].plot([max(error, 1e-16)], [y], marker=mark, ms=4.0, color="black")
                    axes[0].plot([estimate], [y], **bar)
            for each in c["ulps"]:
                axes[1].plot([each["explained"]], [row - 0.1], **bar)
                axes[1].plot([max(each["moved"], 1e-17)], [row + 0.1], "k.", ms=3.0)
        for (name, symbol), mark in zip(SHORT.items(), "os^Dx", strict=True):
            label = "boundaries b" if name == "zones" else symbol
            axes[0].plot([], [], marker=mark, ms=4.0, color="black", ls="", label=label)
        axes[0].plot([], [], **bar, label="estimate")
        axes[1].plot([], [], **bar, label="explained by conditioning")
        axes[1].plot([], [], "k.", ms=3.0, label="shift")
        said = "true relative error (0 and less at $10^{-16}$); estimate"
        axes[0].set(xscale="log", xlabel=said, yticks=range(len(record["cases"])))
        axes[0].set_yticklabels([c["name"] for c in record["cases"]])
        axes[0].axvline(1e-12, color="0.5", lw=0.8, ls=":")
        axes[0].invert_yaxis()
        axes[1].set(xscale="log", xlabel="shift by 1 ulp (0 at $10^{-17}$)")
        for ax in axes:
            ax.legend(loc="upper right", fontsize=8)
            ax.grid(axis="x", color="0.9")
