"""The results in validation/ that documentation quotes: whole, and true of today's library."""

import json
import math
from pathlib import Path

import pytest

from spectral_contact.spectral.galerkin import disk_operators
from spectral_contact.spectral.panels import LogPanels

RESULTS = Path(__file__).parents[2] / "validation" / "results"
EPS = 2.0**-52
#: Largest difference of an entry, in eps of its scale.
FEW = 16


@pytest.fixture(scope="module")
def projections():
    return json.loads((RESULTS / "projections.json").read_text(encoding="utf-8"))


def test_projections_are_whole(projections):
    assert projections["schema"] == "spectral_contact.validation.projections"
    assert projections["version"] == 1
    found = projections["entries"]
    assert len(found) >= 300
    assert {e["kernel"] for e in found} == {"K1", "K2"}
    assert {e["mesh"] for e in found} == set(projections["meshes"])
    assert min(e["digits"] for e in found) >= 25
    assert max(abs(e["ulp"]) for e in found) <= FEW


def test_projections_hold_today(projections):
    disks = {
        mesh: disk_operators(LogPanels(**panels)) for mesh, panels in projections["meshes"].items()
    }
    for e in projections["entries"]:
        disk, i, j = disks[e["mesh"]], e["row"], e["column"]
        gram = (disk.normal if e["kernel"] == "K1" else disk.tangential).gram
        scale = math.sqrt(gram[i, i] * gram[j, j])
        assert abs(gram[i, j] - float(e["mpmath"])) <= FEW * EPS * scale
        assert abs(gram[i, j] - float.fromhex(e["double"])) <= FEW * EPS * scale
