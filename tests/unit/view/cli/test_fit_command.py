"""``spectral-contact fit``: from the file of an instrument to a modulus, a table and a picture."""

import csv
from pathlib import Path

import pytest

from spectral_contact.__main__ import main

CURVES = Path(__file__).parents[3] / "data" / "curves"
CONE = ("--profile", "cone", "--half-angle", "1.2")
PNG = b"\x89PNG"


@pytest.fixture
def run(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(name, *options):
        status = main(["fit", str(CURVES / name), *options])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


def test_a_curve_is_fitted_without_a_modulus_to_start_from(run, tmp_path):
    pytest.importorskip("matplotlib")
    tip = ("--profile", "sphere", "--radius", "5 um", "--poisson-ratio", "0.5")
    status, out, err = run("excel_unicode.txt", *tip, "--output", "fitted.csv")
    assert (status, err) == (0, "")
    assert "3 rows left out" in out
    assert "part: approach, 177 points" in out
    assert "residuals from" in out
    [modulus] = [line.split() for line in out.splitlines() if line.startswith("reduced_modulus")]
    assert float(modulus[1]) == pytest.approx(2e5, rel=0.03)  # a sphere is no parabola
    assert "Young's modulus" in out
    assert (tmp_path / "excel_unicode_fit.png").read_bytes().startswith(PNG)
    rows = list(csv.DictReader((tmp_path / "fitted.csv").read_text().splitlines()))
    assert len(rows) == 177
    off = float(rows[9]["fitted load [N]"]) - float(rows[9]["load [N]"])
    assert off / float(rows[9]["sigma [N]"]) == pytest.approx(float(rows[9]["residual / sigma"]))


def test_columns_free_parameters_and_no_picture(run, tmp_path):
    tip = ("--profile", "parabola", "--radius", "2.5 um", "--plot", "none")
    columns = ("--columns", "load=1 [N],depth=2 [m]")
    free = ("--free", "reduced-modulus,zero-point,load-offset,tilt")
    status, out, _ = run("afm_extend_retract.txt", *tip, *columns, *free)
    assert status == 0
    assert "load_offset" in out
    assert "N/m" in out
    assert list(tmp_path.iterdir()) == []


def test_a_retraction_with_adhesion(run):
    tip = ("--profile", "parabola", "--radius", "5 um", "--poisson-ratio", "0.5", "--plot", "none")
    curve = ("--columns", "depth=1 [nm],load=2 [nN]", "--part", "retraction")
    free = ("--free", "reduced-modulus,work-of-adhesion,zero-point,load-offset")
    given = ("--work-of-adhesion", "0.1 mJ/m^2")
    status, out, err = run("afm_adhesion.txt", *tip, *curve, *free, *given)
    assert (status, err) == (0, "")
    [adhesion] = [line.split() for line in out.splitlines() if line.startswith("work_of_adhesion")]
    assert float(adhesion[1]) == pytest.approx(2e-4, rel=0.02)
    assert "382 of 500 rows are in contact" in out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((*CONE, "--load", "1"), "--load is no option of a fit: depths and loads"),
        ((*CONE, "--friction", "0.1"), "--friction"),
        ((*CONE, "--free", "modulus"), "free"),
        (("--profile", "cone"), "--profile cone takes --half-angle"),
        (
            ("--profile", "cone", "--half-angle", "1.2", "--columns", "load=9"),
            "--columns 9: there are 3",
        ),
        (("--plot", "x.gif"), "argument --plot: x.gif: the suffix must be one of .png"),
        (("--free", "tilt"), "--profile is missing: it must be one of parabola"),
        ((*CONE, "--layer", "linear", "--layer-compliance", "1"), "--layer needs --youngs-modul"),
        (("--output", "x.txt"), "suffix must be one of .csv"),
    ],
)
def test_what_makes_no_request_is_one_line(run, options, message):
    status, _, err = run("excel_unicode.txt", *options)
    assert status == 2
    assert message in err
    assert err.count("\n") == 1
