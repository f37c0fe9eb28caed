"""The net: does a change of the solver keep everything? python validation/net/net.py [--quick].

In one run, some minutes on one core (with --quick, a part of it in a minute): the gold scenes at
four tolerances, the hard cases, 300 random scenes and 58 at thresholds, whose truths are kept in
validation/net, and the ratios of the times of solves and sweeps to those of one earlier commit,
side by side. Prints one table. Exits with 1 unless all gates on numbers hold:

- no true error above its estimate, and nothing raised but an honest refusal;
- every scene converges but those that did not at that commit; at a threshold, where a zone begins
  or ends, every one does, and no zone is missing beyond the estimates; at coupled thresholds an
  estimate by which any zone may be missing counts as not converged;
- no estimate of a hard case ten times what it was, unless it meets the tolerance.

Ratios of times have limits by kind (`net_speed.LIMITS`). A row above its limit in four runs is
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

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

sys.path.append(str(Path(__file__).parents[1]))

import net_baseline
import net_kept
import reporting
from net_baseline import Baseline
from net_checks import Finding, sections, worse
from net_speed import LIMITS, Row, speed

#: Of how many kept scenes one is taken, with --quick.
PART = 3


@dataclass
class Section:
    """What became of the scenes of a section, beside the commit."""

    name: str
    findings: list[Finding]
    before: Baseline

    @property
    def excused(self) -> list[str]:
        """Scenes that need not converge; at thresholds there are none."""
        return [] if "thresholds" in self.name else self.before.unconverged.get(self.name, [])

    @property
    def failures(self) -> list[str]:
        """What breaks a gate."""
        return [f"{one.name}: {text}" for one in self.findings for text in self._of(one)]

    def _of(self, one: Finding) -> list[str]:
        lost = not one.converged and one.name not in self.excused
        found = one.violations + ["does not converge"] * lost
        if one.name in self.before.estimates:
            found += worse(one, self.before.estimates[one.name])
        return found

    def counts(self) -> str:
        """Return what there is to say in one cell."""
        violated = sum(bool(one.violations) for one in self.findings)
        converged = sum(one.converged for one in self.findings)
        required = sum(one.name not in self.excused for one in self.findings)
        return f"{violated} violated, {converged} converged ({required})"


def table(
    found: list[Section], rows: list[Row], failures: list[str], commit: str, spent: float
) -> str:
    """Return everything as Markdown."""
    slow = [row for row in rows if not row.passed]
    about = f"{sum(len(one.findings) for one in found)} scenes and {len(rows)} rows of times in "
    about += f"{spent:.0f} s, beside commit {commit[:7]}. In brackets: how many have to converge. "
    about += "All gates hold." if not failures else f"**{len(failures)} gates are broken.**"
    about += f" **{len(slow)} rows are slower than their limits.**" * bool(slow)
    scenes = (
        (one.name, len(one.findings), one.counts(), "broken" if one.failures else "holds")
        for one in found
    )
    times = []
    for row in rows:
        ratio = f"{row.ratio:.2f}" if row.passed else f"**{row.ratio:.2f}**"
        cells = f"{row.old:.3g}", f"{row.new:.3g}", ratio, f"{row.limit:g}", row.runs
        times.append((row.case, row.mode, *cells))
    limits = ", ".join(f"{kind} {limit:g}" for kind, limit in LIMITS.items())
    parts = [
        about,
        reporting.table("scenes | number | | gate", scenes),
        "Times of the processor in U, the shortest of all pairs of processes that take turns, and "
        f"their ratios. Limits by kind: {limits}. A row above its limit, in bold, is reported and "
        "breaks no gate.",
        reporting.table("problem | | old [U] | new [U] | ratio | limit | runs", times),
    ]
    if failures:
        parts += ["Broken:", "\n".join(f"- {text}" for text in failures)]
    return "\n\n".join(parts)


def progress(text: str) -> None:
    """Say on stderr what is done."""
    print(text, file=sys.stderr, flush=True)


def rebase(revision: str) -> None:
    """Run `record` with the library of a commit, and the modules of the net as they are today."""
    commit = net_baseline.git("rev-parse", "--verify", f"{revision}^{{commit}}").decode().strip()
    with net_baseline.checked_out(commit) as library:
        code = (
            "import spectral_contact, net\n"
            f"assert spectral_contact.__file__.startswith({str(library)!r}), spectral_contact\n"
            f"net.record({commit!r})"
        )
        paths = os.pathsep.join((str(library), str(Path(__file__).parent)))
        # -P: nothing comes before the paths that are given
        command = [sys.executable, "-P", "-c", code]
        subprocess.run(command, check=True, env=os.environ | {"PYTHONPATH": paths})


def record(commit: str) -> None:
    """Store what the library that is imported makes of all scenes, under the name of a commit."""
    before = Baseline(commit)
    for section, findings in sections(net_kept.load(), 1):
        before.unconverged[section] = [one.name for one in findings if not one.converged]
        before.estimates |= {one.name: one.estimates for one in findings if one.estimates}
        progress(f"{section}: {len(findings)} scenes")
    net_baseline.save(before)


def main() -> int:
    """Run everything, print it, and return how the process ends."""
    asked = reporting.options(__doc__, quick=False, scenes_only=False, rebase="")
    if asked.rebase:
        rebase(asked.rebase)
        return 0
    begin = perf_counter()
    before = net_baseline.load()
    found: list[Section] = []
    rows: list[Row] = []
    for name, findings in sections(net_kept.load(), PART if asked.quick else 1):
        found.append(Section(name, findings, before))
        progress(f"{perf_counter() - begin:4.0f} s  {name}: {found[-1].counts()}")
    for row in [] if asked.scenes_only else speed(before.commit, asked.quick):
        rows.append(row)
        limit = "" if row.passed else f", SLOWER than its limit {row.limit:g}"
        progress(f"{perf_counter() - begin:4.0f} s  {row.case}, {row.mode}: {row.ratio:.2f}{limit}")
    failures = [f"{one.name}: {text}" for one in found for text in one.failures]
    print(table(found, rows, failures, before.commit, perf_counter() - begin))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
