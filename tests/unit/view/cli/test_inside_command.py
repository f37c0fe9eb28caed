"""``spectral-contact inside``: grids, points of a file, a plot, and what it refuses."""

import csv

import numpy as np
import pytest

from spectral_contact import Scene, solve
from spectral_contact.__main__ import main
from spectral_contact.view.cli import inside_command

FRICTIONLESS = ("--friction", "none", "--normal-compliance", "0", "--poisson-ratio", "0.3")


def run(capsys, *options):
    """Return the exit status, stdout and stderr of ``spectral-contact inside``."""
    status = main(["inside", *FRICTIONLESS, *options])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_a_grid_as_arrays(capsys, tmp_path):
    path = tmp_path / "grid.npz"
    status, out, err = run(capsys, "--r", "0:1:3", "--z", "0,0.5", "--output", str(path))
    assert (status, err) == (0, "")
    assert "surface_tension" in out
    assert "supremum, approached at the edge" in out
    assert "unbounded: the pressure of a smooth surface" in out
    arrays = np.load(path)
    assert arrays["sigma_zz"].shape == (2, 3)
    assert np.isnan(arrays["von_mises"][0, 2])  # at the edge
    stress = solve(Scene(0.3, friction=None)).inside.stress(0.5, 0.5)
    assert arrays["sigma_zz"][1, 1] == pytest.approx(stress.zz, rel=1e-8)


def test_a_grid_as_a_table_is_that_of_arrays(capsys, tmp_path):
    for suffix in (".csv", ".npz"):
        path = tmp_path / f"grid{suffix}"
        status, out, err = run(capsys, "--r", "0:1:3", "--z", "0,0.5", "--output", str(path))
        assert (status, err) == (0, "")
        assert "surface_tension" in out
    rows = list(csv.DictReader((tmp_path / "grid.csv").read_text().splitlines()[1:]))
    arrays = np.load(tmp_path / "grid.npz")
    assert [(float(row["r"]), float(row["z"])) for row in rows[3:5]] == [(0.0, 0.5), (0.5, 0.5)]
    assert float(rows[4]["u_z"]) == arrays["u_z"][1, 1]


def test_the_nodes_of_a_mesh_from_a_file(capsys, tmp_path):
    nodes, output = tmp_path / "nodes.csv", tmp_path / "fields.csv"
    nodes.write_text("# of a mesh\nr,z,number\n0.5,0.25,1\n1.5,0,2\n")
    assert run(capsys, "--points", str(nodes), "--output", str(output))[0] == 0
    rows = list(csv.DictReader(output.read_text().splitlines()[1:]))
    expected = solve(Scene(0.3, friction=None)).inside.displacement([0.5, 1.5], [0.25, 0.0])
    assert np.allclose([float(row["u_r"]) for row in rows], expected.r, rtol=1e-7)


POINT_FILES = {
    "labels first": b"node,r,z\n1,0.5,0.25\n2,1.5,0\n",
    "swapped": b"z,r\n0.25,0.5\n0,1.5\n",
    "a byte-order mark, no names": b"\xef\xbb\xbf0.5,0.25\n1.5,0\n",
    "a blank line at the end": b"r,z\n0.5,0.25\n1.5,0\n\n",
    "tabs": b"r\tz\n0.5\t0.25\n1.5\t0\n",
    "semicolons": b"r;z\n0,5;0,25\n1,5;0\n",
    "UTF-16": "r\tz\n0.5\t0.25\n1.5\t0\n".encode("utf-16"),
}


@pytest.mark.parametrize("content", POINT_FILES.values(), ids=POINT_FILES.keys())
def test_the_points_are_those_of_the_file(capsys, tmp_path, content):
    nodes, output = tmp_path / "nodes.csv", tmp_path / "fields.csv"
    nodes.write_bytes(content)
    status, out, err = run(capsys, "--points", str(nodes), "--output", str(output))
    assert (status, err) == (0, "")
    assert out.startswith(f"{nodes}: 2 rows, r from column ")
    rows = list(csv.DictReader(output.read_text().splitlines()[1:]))
    assert [(row["r"], row["z"]) for row in rows] == [("0.5", "0.25"), ("1.5", "0.0")]
    # what the command writes it reads
    assert run(capsys, "--points", str(output), "--output", str(tmp_path / "again.csv"))[0] == 0
    assert (tmp_path / "again.csv").read_text() == output.read_text()


def test_points_in_millimetres(capsys, tmp_path):
    pytest.importorskip("pint", reason="part of the extra: units")
    nodes, output = tmp_path / "nodes.csv", tmp_path / "fields.csv"
    nodes.write_text("r [mm],z [mm]\n0.5,0.25\n#N/A,1\n")
    scene = ("--youngs-modulus", "2e11", "--radius", "0.01", "--load", "1e3", "--friction", "none")
    command = ["inside", *scene, "--poisson-ratio", "0.3", "--points", str(nodes)]
    assert main([*command, "--output", str(output)]) == 2
    assert "line 3, column 1 (r): #N/A is no value" in capsys.readouterr().err
    assert main([*command, "--output", str(output), "--skip-invalid"]) == 0
    assert "1 rows left out: line 3, column 1 (r): #N/A is no value" in capsys.readouterr().out
    assert output.read_text().splitlines()[2].startswith("0.0005,0.00025,")
    # of a scene without units they are no points
    status, _, err = run(capsys, "--points", str(nodes))
    assert (status, "is in mm: the scene has no units" in err) == (2, True)


def test_columns_of_points_may_be_named(capsys, tmp_path):
    nodes, output = tmp_path / "nodes.csv", tmp_path / "fields.csv"
    nodes.write_text("1 0.5 0.25\n2 1.5 0\n")
    status, _, err = run(capsys, "--points", str(nodes))
    assert status == 2
    assert "say which they are, such as --columns r=1,z=2" in err
    named = ("--points", str(nodes), "--columns", "r=2,z=3")
    assert run(capsys, *named, "--output", str(output))[0] == 0
    assert output.read_text().splitlines()[2].startswith("0.5,0.25,")


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
        (("--points", "p.csv", "--output", "x.nc"), "not for a .nc file"),
        (("--columns", "r,z"), "--columns, --header, --decimal and --skip-invalid need --points"),
        (("--skip-invalid",), "--skip-invalid need --points"),
        (("--points", "absent.csv"), "cannot be read"),
        (("--points", "p.csv", "--header", "9"), "p.csv: has no row of numbers below line 9"),
        (("--r", "1"), "--r, --z and --points need --output"),
        (("--rtol", "1"), "--rtol = 1.0: must be in [1e-13, 1e-2]"),
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
    assert (status, "line 2, column 2 (z): half is not a number" in err) == (2, True)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--punch", "--youngs-modulus", "7e10", "--poisson-ratio", "0.3"), "--punch goes with"),
        (("--reduced-modulus", "7e10"), "do not tell the bodies apart"),
        (("--kappa", "0.1"), "do not tell the bodies apart"),
    ],
)
def test_bodies_that_are_not_told_apart_are_refused_before_anything_is_solved(
    capsys, tmp_path, monkeypatch, options, said
):
    monkeypatch.setattr(inside_command, "solve", None)
    nodes = tmp_path / "nodes.csv"
    nodes.write_text("r,z\n0,1e-4\n")
    ball = ("--profile", "sphere", "--radius", "1e-3", "--load", "10")
    assert main(["inside", *ball, *options, "--points", str(nodes)]) == 2
    assert said in capsys.readouterr().err
