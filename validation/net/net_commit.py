"""The commit that the net compares with, and what its library made of every scene.

Both are in before.json beside this file, so that they change together:
``python validation/net/net.py --rebase COMMIT`` computes the records anew with the library of
another commit, by the scenes, truths and checks of today.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import tarfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).parent
REPOSITORY = Path(__file__).parents[2]
FILE = HERE / "before.json"
#: Every comparison is with this commit, so that small losses do not add up.
COMMIT: str = json.loads(FILE.read_text(encoding="utf-8"))["commit"]

Records = dict[str, dict[str, dict[str, Any]]]


def load() -> Records:
    """Return what became of every scene at the commit: records by section and name."""
    return dict(json.loads(FILE.read_text(encoding="utf-8"))["before"])


def save(commit: str, before: Records) -> None:
    """Store the records of a commit, one scene a line."""
    sections = [
        f"{json.dumps(section)}: {{\n"
        + ",\n".join(f"{json.dumps(name)}: {json.dumps(row)}" for name, row in rows.items())
        + "\n}"
        for section, rows in before.items()
    ]
    inner = ",\n".join(sections)
    text = f'{{\n"commit": {json.dumps(commit)},\n"before": {{\n{inner}\n}}\n}}\n'
    FILE.write_text(text, encoding="utf-8")


def checked_out(folder: Path, commit: str) -> Path:
    """Put the commit's files into a folder, and return it."""
    run = subprocess.run(
        ["git", "archive", commit], cwd=REPOSITORY, capture_output=True, check=False
    )
    if run.returncode:
        sys.exit(f"no commit {commit[:7]} in this clone: {run.stderr.decode().strip()}")
    with tarfile.open(fileobj=io.BytesIO(run.stdout)) as files:
        files.extractall(folder, filter="data")
    return folder


def run_with_library_of(commit: str, folder: Path, code: str) -> None:
    """Run code with the library of a commit, and the modules of the net as they are today.

    Raises
    ------
    subprocess.CalledProcessError
        If the code fails.
    """
    old = checked_out(folder, commit)
    library = old / "spectral_contact"
    checked = (
        "import sys, spectral_contact\n"
        f"assert spectral_contact.__file__.startswith({str(library)!r}), spectral_contact\n{code}"
    )
    paths = os.pathsep.join(map(str, (old, HERE)))
    # -P: nothing comes before the paths that are given
    command = [sys.executable, "-P", "-c", checked]
    subprocess.run(command, check=True, env=os.environ | {"PYTHONPATH": paths})


def full_hash(commit: str) -> str:
    """Return the full name of a commit."""
    command = ["git", "rev-parse", "--verify", "--quiet", f"{commit}^{{commit}}"]
    run = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    if run.returncode:
        sys.exit(f"no commit {commit} in this clone")
    return run.stdout.strip()


def rebase(commit: str) -> None:
    """Compare with another commit from now on: compute its records and store them."""
    commit = full_hash(commit)
    with TemporaryDirectory() as folder:
        code = f"import net_commit; net_commit.keep_before({commit!r})"
        run_with_library_of(commit, Path(folder), code)


def keep_before(commit: str) -> None:
    """Compute and store the records of a commit, whose library is imported."""
    import net_checks
    import net_kept

    before: Records = {}
    for section, findings in net_checks.sections(net_kept.load(), 1):
        before[section] = {finding.name: finding.to_row() for finding in findings}
        print(f"{section}: {len(findings)} scenes", file=sys.stderr, flush=True)
    save(commit, before)
