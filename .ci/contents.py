"""Check what a wheel and an sdist hold: ``python .ci/contents.py WHEEL SDIST``.

Every module and data file of the package in this folder, the licence and the metadata; no tests,
and nothing of validation/ or docs/.
"""

import sys
import tarfile
import zipfile
from pathlib import Path

PACKAGE = "spectral_contact"
NEEDED = (f"{PACKAGE}/py.typed", f"{PACKAGE}/gold/tables/slip_unequal.json")


def source() -> set[str]:
    """Return the files of the package here."""
    kinds = ("*.py", "*.json", "*.csv", "SHA256SUMS", "py.typed")
    files = {path for kind in kinds for path in Path(PACKAGE).rglob(kind)}
    return {path.as_posix() for path in files}


def differences(name: str, held: set[str], meta: set[str], others: set[str]) -> list[str]:
    """Return what is missing, and what does not belong there.

    Parameters are the archive's name, the files it holds, those besides the package that it must
    hold, and the beginnings of those that it may hold.
    """
    wanted = source()
    package = {one for one in held if one.startswith(f"{PACKAGE}/")}
    missing = (wanted | meta | set(NEEDED)) - held
    foreign = (package - wanted) | {
        one for one in held - package - meta if not one.startswith(tuple(others))
    }
    return [
        *(f"{name} lacks {one}" for one in sorted(missing)),
        *(f"{name} should not hold {one}" for one in sorted(foreign)),
    ]


def main() -> None:
    """Check both archives."""
    wheel, sdist = sys.argv[1:]
    with zipfile.ZipFile(wheel) as archive:
        in_wheel = {one for one in archive.namelist() if not one.endswith("/")}
    with tarfile.open(sdist) as archive:
        # below the folder that bears name and version
        in_sdist = {one.name.split("/", 1)[1] for one in archive if one.isfile()}
    info = "-".join(Path(wheel).name.split("-")[:2]) + ".dist-info/"
    found = [
        *differences("the wheel", in_wheel, {f"{info}licenses/LICENSE"}, {info}),
        *differences(
            "the sdist",
            in_sdist,
            {"LICENSE", "README.md", "pyproject.toml"},
            {"PKG-INFO", "setup.cfg", f"{PACKAGE}.egg-info/"},
        ),
    ]
    if found:
        sys.exit("\n".join(found))
    print(f"wheel: {len(in_wheel)} files, sdist: {len(in_sdist)} files, as they should be")


if __name__ == "__main__":
    main()
