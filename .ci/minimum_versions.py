"""Print what pyproject.toml says at least of every dependency, as constraints for pip.

The arguments are extras: ``python .ci/minimum_versions.py test``.
"""

import re
import sys
import tomllib
from pathlib import Path

REQUIREMENT = re.compile(r"([A-Za-z0-9._-]+)(?:\[([^]]*)\])?(?:>=([0-9.]+))?")


def minima(project: dict, requirements: list[str]) -> dict[str, str]:
    """Return name and smallest version of each, those of the extras that they name included."""
    found = {}
    for text in requirements:
        name, extras, version = REQUIREMENT.match(text).groups()
        if name == project["name"]:
            for extra in extras.split(","):
                found |= minima(project, project["optional-dependencies"][extra])
        elif version is None:
            sys.exit(f"pyproject.toml: {text!r} has no smallest version")
        else:
            found[name] = version
    return found


project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
own = f"{project['name']}[{','.join(sys.argv[1:])}]"
for name, version in minima(project, [*project["dependencies"], own]).items():
    print(f"{name}=={version}")
