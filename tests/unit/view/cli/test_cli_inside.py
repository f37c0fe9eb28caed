"""``spectral-contact inside``: grids, points of a file, a plot, and what it refuses."""

import csv

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.__main__ import main

FRICTIONLESS = ("--friction", "none", "--normal-compliance", "0", "--poisson-ratio", "0.3")


def run(capsys, *options):
    """Return the exit status, stdout and stderr of ``spectral-contact inside``."""
    status = main(["inside", *FRICTIONLESS, *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_a_grid_as_a_table_and_as_arrays(capsys, tmp_path):
    body = solve(Scene(0.3, friction=None)).inside
    for suffix in (".csv", ".npz"):
        path = tmp_path / f"grid{suffix}"
        status, out, err = run(capsys, "--r", "0:1:3", "--z", "0,0.5", "--output", str(path))
        assert (status, err) == (0, "")
        assert "surface_tension" in out
        assert "supremum, approached at the edge" in out
        assert "unbounded: the pressure of a smooth surface" in out
    rows = list(csv.DictReader((tmp_path / "grid.csv").read_text().splitlines()[1:]))
    arrays = np.load(tmp_path / "grid.npz")
    assert [(float(row["r"]), float(row["z"])) for row in rows[3:5]] == [(0.0, 0.5), (0.5, 0.5)]
    assert arrays["sigma_zz"].shape == (2, 3)
    assert np.isnan(arrays["von_mises"][0, 2])  # at the edge
    assert arrays["sigma_zz"][1, 1] == pytest.approx(body.stress(0.5, 0.5).zz, rel=1e-8)
    assert float(rows[4]["u_z"]) == arrays["u_z"][1, 1]


def test_the_nodes_of_a_mesh_from_a_file(capsys, tmp_path):
    nodes, output = tmp_path / "nodes.csv", tmp_path / "fields.csv"
    nodes.write_text("# of a mesh\nr,z,number\n0.5,0.25,1\n1.5,0,2\n")
    assert run(capsys, "--points", str(nodes), "--output", str(output))[0] == 0
    rows = list(csv.DictReader(output.read_text().splitlines()[1:]))
    expected = solve(Scene(0.3, friction=None)).inside.displacement([0.5, 1.5], [0.25, 0.0])
    assert np.allclose([float(row["u_r"]) for row in rows], expected.r, rtol=1e-7)


def test_si_units_are_those_of_the_points(capsys, tmp_path):
    path = tmp_path / "si.csv"
    options = ("--youngs-modulus", "2e11", "--radius", "0.01", "--load", "1e3")
    scene = ("--poisson-ratio", "0.3", "--friction", "none")
    places = ("--r", "0", "--z", "0.005", "--output", str(path))
    assert main(["inside", *scene, *options, *places]) == 0
    capsys.readouterr()
    units, names, row = path.read_text().splitlines()
    values = dict(zip(names.split(","), map(float, row.split(",")), strict=True))
    assert "sigma_zz [Pa]" in units
    stress = solve(Scene(0.3, friction=None)).inside.stress(0.0, 0.5)
    assert values["sigma_zz"] == pytest.approx(stress.zz * 1e3 / 1e-4, rel=1e-8)


def test_a_profile(capsys, tmp_path):
    path = tmp_path / "ball.csv"
    scene = ("--profile", "parabola", "--radius", "1", "--contact-radius", "1")
    assert main(["inside", *scene, "--r", "0", "--z", "0,1", "--output", str(path)]) == 0
    out = capsys.readouterr().out
    assert "0.4808" in out  # depth of the largest von Mises stress
    units, names, *rows = path.read_text().splitlines()
    assert "u_z [L], sigma_rr [E']" in units
    values = dict(zip(names.split(","), map(float, rows[1].split(",")), strict=True))
    assert values["sigma_zz"] == pytest.approx(-4.0 / np.pi, rel=1e-8)  # half of the pressure


def test_a_grid_as_a_dataset_and_a_plot(capsys, tmp_path):
    xarray = pytest.importorskip("xarray", reason="part of the extra: sweep")
    pytest.importorskip("matplotlib", reason="part of the extra: plot")
    path, picture = tmp_path / "grid.nc", tmp_path / "grid.png"
    places = ("--r", "0:2:5", "--z", "0.1:2:4")
    files = ("--output", str(path), "--plot", str(picture), "--quantity", "max_shear")
    assert run(capsys, *places, *files)[0] == 0
    found = xarray.load_dataset(path)
    assert found.max_shear.dims == ("z", "r")
    assert found.sigma_zz.attrs["units"] == "P / a^2"
    assert float(found.u_z.sel(r=1.0, z=0.1)) == pytest.approx(
        solve(Scene(0.3, friction=None)).inside.displacement(1.0, 0.1).z, rel=1e-7
    )
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--points", "p.csv", "--r", "1"), "--points is instead of"),
        (("--points", "p.csv", "--output", "x.nc"), "holds a grid"),
        (("--points", "absent.csv"), "cannot be read"),
        (("--quantity", "tresca"), "tresca"),
        (("--z", "-1", "--output", "x.csv"), "--z"),
        (("--output", "x.txt"), "suffix"),
    ],
)
def test_what_cannot_be_done_is_refused(capsys, tmp_path, monkeypatch, options, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text("0.5,0.5\n")
    status, _, err = run(capsys, *options)
    assert status == 2
    assert said in err
    assert not list(tmp_path.glob("x.*"))


def test_a_file_that_is_no_table_is_refused(capsys, tmp_path):
    path = tmp_path / "nodes.csv"
    path.write_text("r,z\n0.5,half\n")
    status, _, err = run(capsys, "--points", str(path))
    assert (status, "is no table of r and z" in err) == (2, True)
