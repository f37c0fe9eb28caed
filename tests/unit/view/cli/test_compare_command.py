"""``spectral-contact compare``: nodes as other codes write them, made by closed forms."""

from pathlib import Path

import pytest

from spectral_contact.__main__ import main

NODES = Path(__file__).parents[3] / "data" / "nodes"
STEEL = ("--youngs-modulus", "210e9", "--poisson-ratio", "0.3", "--radius", "5e-3", "--load", "1e3")
STEEL += ("--friction", "none")
ABAQUS = str(NODES / "abaqus_report.rpt")


@pytest.fixture
def run(capsys):
    def run(*options):
        status = main(["compare", *map(str, options)])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


def error_of(out, name):
    [row] = [line.split() for line in out.splitlines() if line.lstrip().startswith(f"{name} ")]
    return float(row[1])


def test_a_report_of_finite_elements_with_prose_above_and_locations_below_the_headings(run):
    columns = ("--columns", "r=2 [mm], pressure=3 [MPa], displacement=4 [mm]")
    status, out, err = run(ABAQUS, *STEEL, *columns, "--at-most", "1e-3")
    assert "11 rows, r from column 2 (COORD.COOR1) in mm" in out
    assert error_of(out, "pressure") < 1e-6
    assert "3 of 11 radii outside the contact" in out
    assert "displacement: the sign is the other one" in out
    assert (status, err.count("\n")) == (1, 1)
    assert "the largest error is 2.0e+00, --at-most is 0.001" in err


def test_a_forgotten_unit_is_named(run):
    columns = ("--columns", "r=2 [mm], pressure=3")
    status, out, _ = run(ABAQUS, *STEEL, *columns)
    assert status == 0
    assert "pressure: all values are too small by 1e+06: units?" in out


def test_a_german_table_with_a_rim_that_rounding_puts_outside_and_a_point_twice(run):
    status, out, err = run(NODES / "bem_german.csv", *STEEL)
    assert (status, err) == (0, "")
    assert error_of(out, "pressure") < 1e-6
    assert "1 of 12 radii outside the contact by rounding: compared as the edge" in out


def test_dimensionless_nodes_and_a_number_beside_them(run):
    scene = ("--poisson-ratio", "0.3", "--normal-compliance", "0", "--friction", "none")
    scene += ("--tangential-compliance", "0")
    file = NODES / "dimensionless.txt"
    status, out, _ = run(file, *scene, "--value", "approach=0.125", "--at-most", "1e-6")
    assert status == 0
    assert error_of(out, "approach") < 1e-12
    status, out, _ = run(*scene, "--value", "approach=0.7854")
    assert "approach: it is too large by 6.283: per radian, or of the whole?" in out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "give a FILE of nodes"),
        ((ABAQUS, *STEEL), "no column of r: the headings are Node, COORD.COOR1, CPRESS, U.U2"),
        ((ABAQUS, *STEEL, "--columns", "r=2 [mm]"), "no column of pressure, traction, slip"),
        (("--value", "aproach=1"), "did you mean approach?"),
        (("--value", "approach"), "is not NAME=X"),
        (("--value", "load=1"), "--value = 'load': must be one of approach, stick_radius, total_s"),
        (("--value", "approach=inf"), "--value approach=inf: the number must be finite"),
        (("--value", "approach=1", "--at-most", "-1"), "--at-most = -1.0: must be >= 0"),
    ],
)
def test_what_makes_no_request_is_one_line(run, options, message):
    status, _, err = run(*options)
    assert status == 2
    assert message in err
    assert err.count("\n") == 1
