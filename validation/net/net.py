"""The net: does a change of the solver keep everything? python validation/net/net.py [--quick].

In one run, some minutes on one core (with --quick, a part of it in a minute): the gold scenes at
four tolerances, the hard cases, 300 random scenes and 58 at thresholds, whose truths are kept in
validation/net, and the ratios of the times of solves and sweeps to those of one earlier commit,
side by side. Prints one table. Exits with 1 unless all gates on numbers hold:

- no true error above its estimate, and nothing raised but an honest refusal;
- every scene at a threshold is right: no zone is missing beyond the estimates, none is refused; at
  coupled thresholds an estimate by which any zone may be missing counts as refused;
- nothing unconverged that converged at that commit;
- no estimate of a hard case ten times what it was, unless it meets the tolerance.

Ratios of times have limits by kind (`net_cases.LIMITS`). A row above its limit in four runs is
named, and does not fail: no simplification is undone for its speed alone.

``python validation/net/net.py --rebase COMMIT`` compares with another commit from now on: it solves
all scenes with the library of that commit, by the checks of today, and stores what became of them
in validation/net/before.json. Scenes and truths stay as they are. The commit's public API must be
the one that the checks use.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

import net_commit
import net_kept
from net_cases import LIMITS
from net_checks import Finding, sections, worse
from net_commit import COMMIT
from net_speed import Row, speed

#: Of how many kept scenes one is taken, with --quick.
PART = 3
#: What became of a scene that the commit does not know, as one with a profile.
UNKNOWN = {"converged": False, "verdict": "unknown"}
VERDICTS = ("right", "refused", "wrong", "raised")


@dataclass
class Section:
    """What became of the scenes of a section.

    Attributes
    ----------
    name : str
    findings : list of Finding
    before : dict of str to dict
        What became of each at the commit.
    """

    name: str
    findings: list[Finding]
    before: dict[str, dict[str, Any]]

    @property
    def judged(self) -> bool:
        """Whether its findings have a verdict."""
        return self.name in ("thresholds", "coupled thresholds")

    @property
    def failures(self) -> list[str]:
        """What breaks a gate."""
        if self.judged:
            return [f"{one.name}: {one.verdict}" for one in self.findings if one.verdict != "right"]
        return [f"{one.name}: {text}" for one in self.findings for text in self._of(one)]

    def _of(self, one: Finding) -> list[str]:
        before = self.before.get(one.name, UNKNOWN)
        lost = ["does not converge any more"] if before["converged"] > one.converged else []
        return one.violations + lost + (worse(one, before) if self.name == "hard" else [])

    def counts(self) -> str:
        """Return what there is to say in one cell."""
        old = [self.before.get(one.name, UNKNOWN) for one in self.findings]
        if self.judged:
            now = Counter(one.verdict for one in self.findings)
            then = Counter(row["verdict"] for row in old)
            return ", ".join(f"{name} {now[name]} ({then[name]})" for name in VERDICTS)
        violated = sum(bool(one.violations) for one in self.findings)
        converged = sum(one.converged for one in self.findings)
        before = sum(row["converged"] for row in old)
        return f"{violated} violated, {converged} converged ({before})"


def table(found: list[Section], rows: list[Row], failures: list[str], spent: float) -> str:
    """Return everything as Markdown."""
    slow = [row for row in rows if not row.passed]
    lines = [
        f"{sum(len(one.findings) for one in found)} scenes and {len(rows)} rows of benchmarks in "
        f"{spent:.0f} s, in brackets and below as old: commit {COMMIT[:7]}. "
        + ("All gates hold." if not failures else f"**{len(failures)} gates are broken.**")
        + (f" **{len(slow)} rows are slower than their limits.**" if slow else ""),
        "",
        "| scenes | number | | gate |",
        "|---|---|---|---|",
    ]
    for one in found:
        gate = "broken" if one.failures else "holds"
        lines.append(f"| {one.name} | {len(one.findings)} | {one.counts()} | {gate} |")
    lines += [
        "",
        "Times of the processor in U, the shortest of all pairs of alternating processes, and "
        "their ratios. Limits by kind: "
        + ", ".join(f"{kind} {limit:g}" for kind, limit in LIMITS.items())
        + ". A row above its limit, in bold, is reported and breaks no gate.",
        "",
        "| benchmark | problem | rtol | | old [U] | new [U] | ratio | limit | pairs | runs |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        ratio = f"{row.ratio:.2f}" if row.passed else f"**{row.ratio:.2f}**"
        lines.append(
            f"| {row.benchmark} | {row.case} | {row.rtol:g} | {row.mode} | {row.old:.3g} | "
            f"{row.new:.3g} | {ratio} | {row.limit:g} | {row.pairs} | {row.runs} |"
        )
    if failures:
        lines += ["", "Broken:", "", *(f"- {text}" for text in failures)]
    return "\n".join(lines) + "\n"


def progress(text: str) -> None:
    """Say on stderr what is done."""
    print(text, file=sys.stderr, flush=True)


def main() -> int:
    """Run everything, print it, and return how the process ends."""
    parser = argparse.ArgumentParser(description="Does a change of the solver keep everything?")
    parser.add_argument("--quick", action="store_true", help="a part of it, in a minute")
    parser.add_argument("--scenes-only", action="store_true", help="no benchmarks")
    parser.add_argument("--rebase", metavar="COMMIT", help="compare with COMMIT from now on")
    options = parser.parse_args()
    if options.rebase:
        net_commit.rebase(options.rebase)
        return 0
    begin = perf_counter()
    kept = net_kept.load()
    before = net_commit.load()
    found: list[Section] = []
    rows: list[Row] = []
    for name, findings in sections(kept, PART if options.quick else 1):
        found.append(Section(name, findings, before.get(name, {})))
        progress(f"{perf_counter() - begin:4.0f} s  {name}: {found[-1].counts()}")
    for row in [] if options.scenes_only else speed(options.quick):
        rows.append(row)
        progress(f"{perf_counter() - begin:4.0f} s  {row.case}, {row.mode}: {row.ratio:.2f}")
    failures = [f"{one.name}: {text}" for one in found for text in one.failures]
    text = table(found, rows, failures, perf_counter() - begin)
    print(text)
    for row in rows:
        if not row.passed:
            progress(
                f"slower than its limit: {row.benchmark}: {row.case}, {row.mode}: "
                f"{row.ratio:.2f}, the limit is {row.limit:g}"
            )
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
