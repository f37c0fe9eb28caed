"""Columns of text files, as other programs write them: what is read, and what is refused."""

import codecs

import numpy as np
import pytest

from spectral_contact import SceneError, SolutionFileError
from spectral_contact.io.columns import Expected, read_columns

POINTS = (Expected("r", at_least=0.0), Expected("z", at_least=0.0))
IN_METRES = (Expected("r", "m"), Expected("z", "m"))
FORCE_CURVE = (
    Expected("depth", "m"),
    Expected("load", "N"),
    Expected("sigma", required=False),
)
NODES = (
    *(Expected("r"), Expected("pressure")),
    *(Expected(name, required=False) for name in ("traction", "slip")),
)


@pytest.fixture
def read(tmp_path):
    """Return a reader of a text, or of bytes, in a file."""

    def reader(content, expected=POINTS, **options):
        path = tmp_path / "nodes.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_columns(path, expected, **options)

    return reader


def values(columns, *names):
    """Return the numbers of quantities as lists."""
    return [columns.values[name].tolist() for name in names or columns.values]


#: Two points, (0.5, 0.25) and (1.5, 0), as they come: all are read as the same numbers.
SAME = {
    "names before a column of labels": "node,r,z\n1,0.5,0.25\n2,1.5,0\n",
    "the other order": "z,r\n0.25,0.5\n0,1.5\n",
    "capitals": "Z;R\n0.25;0.5\n0;1.5\n",
    "words": "Depth,Radial coordinate\n0.25,0.5\n0,1.5\n",
    "ratios": "z/a,s\n0.25,0.5\n0,1.5\n",
    "no headings": "0.5,0.25\n1.5,0\n",
    "a byte-order mark and no headings": "\ufeff0.5,0.25\n1.5,0\n",
    "blank lines": "\n r,z\n\n0.5,0.25\n\n1.5,0\n\n\n",
    "lines of blanks and delimiters' blanks": "r, z\n0.5,  0.25 \n  1.5, 0\n   \n",
    "tabs": "r\tz\n0.5\t0.25\n1.5\t0\n",
    "semicolons": "r;z\r\n0.5;0.25\r\n1.5;0\r\n",
    "German": "Nr.;r;z\r\n1;0,5;0,25\r\n2;1,5;0\r\n",
    "German, quoted": '"r","z"\r\n"0,5","0,25"\r\n"1,5","0"\r\n',
    "decimal commas between blanks": "r z\n0,5 0,25\n1,5 0\n",
    "decimal commas between tabs": "r\tz\n0,5\t0,25\n1,5\t0,\n",
    "Excel's separator": "sep=;\nr;z\n0.5;0.25\n1.5;0\n",
    "a delimiter at each end": "r,z,\n0.5,0.25,\n1.5,0,\n",
    "Excel's Unicode text": codecs.BOM_UTF16_LE
    + "r\tz\r\n0,5\t0,25\r\n1,5\t0\r\n".encode("utf-16-le"),
    "UTF-16 without a mark": "r,z\n0.5,0.25\n1.5,0\n".encode("utf-16-be"),
    "UTF-32": "r,z\n0.5,0.25\n1.5,0\n".encode("utf-32"),
    "line ends of old": "r,z\r0.5,0.25\r1.5,0\r",
    "NumPy's savetxt": "# r z\n5.0e-01 2.5e-01\n1.5e+00 0.0e+00\n",
    "its headings in the other order": "# z r\n2.5e-01 5.0e-01\n0.0e+00 1.5e+00\n",
    "COMSOL": "% Model: a.mph\n% Dimension: 2\n% r   z   u\n0.5  0.25  7\n1.5  0  NaN\n",
    "Fortran": "  0.5D+00   0.25D0\n   1.5D0    0.0\n",
    "a sentence": "# of the mesh\n0.5 0.25\n1.5 0\n",
    "comments anywhere": "r z\n! all\n0.5 0.25 # the first\n// next\n1.5 0\n** end\n",
    "a report": (
        "Field Output Report\n\n Source 1\n---------\n\n"
        "   Node Label      r        z   Part\n"
        "-------------------------------------\n"
        "            1      0.5      0.25   disk_1\n"
        "            2      1.5      0.     disk_2\n\n"
    ),
    "headings of two words": "Node label  Radial coordinate  Depth\n1   0.5   0.25\n2   1.5   0\n",
    "a minus sign": "r,z,u\n0.5,0.25,−1\n1.5,0,−2\n",
    "columns of text": "name,r,z\ncorner A,0.5,0.25\nrim 2,1.5,0\n",
    "a column of no use with gaps": "r,z,t\n0.5,0.25,1\n1.5,0,#N/A\n",
    "our own table": "# r [a], z [a], u_z [L]\nr,z,u_z\n0.5,0.25,1e-3\n1.5,0.0,2e-3\n",
}


@pytest.mark.parametrize("content", SAME.values(), ids=SAME.keys())
def test_the_same_points_are_read_whatever_wrote_them(read, content):
    found = read(content)
    assert values(found, "r", "z") == [[0.5, 1.5], [0.25, 0.0]]
    assert found.unread == ()


#: The same points in m; the radius of the first is 0.5 mm.
UNITS = {
    "brackets": "r [mm],z [mm]\n0.5,0.25\n1.5,0\n",
    "round ones": "r (mm)\tz (um)\n0.5\t250\n1.5\t0\n",
    "blanks": "r [mm]  z [mm]\n0.5  0.25\n1.5  0\n",
    "DIN": "r / mm;z / mm\n0,5;0,25\n1,5;0\n",
    "joined": "r_mm,z_mm\n0.5,0.25\n1.5,0\n",
    "said in words": "radius in mm,depth in m\n0.5,0.00025\n1.5,0\n",
    "a line of units": "r,z\nmm,mm\n0.5,0.25\n1.5,0\n",
    "a line of units in brackets": "node,r,z\n[-],[mm],[mm]\n1,0.5,0.25\n2,1.5,0\n",
    "a comment": "# r [mm], z [mm]\n# by hand\n0.5,0.25\n1.5,0\n",
    "a comment above the names": "# r [mm], z [mm]\nr,z\n0.5,0.25\n1.5,0\n",
    "micrometres in Latin letters": "r [µm],z [µm]\n500,250\n1500,0\n".encode("cp1252"),
    "none: SI": "r,z\n0.0005,0.00025\n0.0015,0\n",
    "SI": "r [m],z[m]\n0.0005,0.00025\n0.0015,0\n",
}


@pytest.mark.parametrize("content", UNITS.values(), ids=UNITS.keys())
def test_units_are_converted_exactly(read, content):
    pytest.importorskip("pint", reason="part of the extra: units")
    assert values(read(content, IN_METRES), "r", "z") == [[0.5e-3, 1.5e-3], [0.25e-3, 0.0]]


@pytest.mark.parametrize(
    ("content", "columns"),
    [
        ("1,0.5,7,0.25\n2,1.5,7,0\n", "r=2,z=4"),
        ("1,0.5,7,0.25\n2,1.5,7,0\n", "node,s,-,depth"),
        ("X,Y\n0.25,0.5\n0,1.5\n", "r=Y, z=X"),
        ("X,r,Y\n0.25,7,0.5\n0,8,1.5\n", ["r=Y", "z=X"]),
        ("node,z,r,R\n1,0.25,0.5,7\n2,0,1.5,7\n", "r,z"),
        ("*Node, nset=all\n1,0.5,0.25\n2,1.5,0\n", "r=2,z=3"),
    ],
)
def test_columns_are_what_the_user_says(read, content, columns):
    assert values(read(content, columns=columns), "r", "z") == [[0.5, 1.5], [0.25, 0.0]]


def test_units_may_be_said_with_the_columns(read):
    pytest.importorskip("pint", reason="part of the extra: units")
    for columns in ("r=2 [mm],z=3 [um]", "node,r [mm],z [um]"):
        found = read("1 0.5 250\n2 1.5 0\n", IN_METRES, columns=columns)
        assert values(found, "r", "z") == [[0.5e-3, 1.5e-3], [0.25e-3, 0.0]]
    assert "r from column 2 in mm, z from column 3 in um" in str(found)


def test_a_force_curve_of_an_instrument(read):
    pytest.importorskip("pint", reason="part of the extra: units")
    content = (
        "Instrument: AFM\nDate: today\n\n"
        "Time (s)\tIndentation (nm)\tForce (nN)\n0,1\t-3,5\t0\n0,2\tNaN\t1\n0,3\t12,25\t2,5e1\n"
    )
    with pytest.raises(SolutionFileError, match=r"line 6, column 2 \(depth\): NaN is no value"):
        read(content, FORCE_CURVE)
    found = read(content, FORCE_CURVE, invalid="skip")
    assert values(found, "depth", "load") == [[-3.5e-9, 12.25e-9], [0.0, 25e-9]]
    assert found.lines.tolist() == [5, 7]
    assert found.unread == ("line 6, column 2 (depth): NaN is no value",)
    assert "sigma" not in found.values
    assert str(found).endswith(
        "2 rows, depth from column 2 (Indentation (nm)) in nm, load from column 3 "
        "(Force (nN)) in nN; 1 rows left out: line 6, column 2 (depth): NaN is no value"
    )


def test_nodes_of_another_code(read):
    found = read("u,q,p,s\n1,2,3,4\n", NODES)
    assert values(found, "r", "pressure", "traction", "slip") == [[4.0], [3.0], [2.0], [1.0]]
    # a single letter is told by its case: P is a load
    with pytest.raises(SolutionFileError, match="no column of pressure: the headings are s, P"):
        read("s,P\n1,2\n", NODES)


def test_a_line_of_headings_may_be_named(read):
    content = "made 3\nX Y\n0.5 0.25\n1.5 0\n"
    options = {"columns": "r=X,z=Y"}
    with pytest.raises(
        SolutionFileError, match="columns: no column X: there are 2 columns without"
    ):
        read(content, **options)
    assert values(read(content, header=2, **options), "r", "z") == [[0.5, 1.5], [0.25, 0.0]]


def test_a_file_without_headings_is_refused_where_no_column_is_required(read):
    with pytest.raises(SolutionFileError, match="line 1: 2 columns without headings; write a fir"):
        read("0.5,0.25\n", [Expected("load", required=False)])


def test_a_file_without_headings_must_have_the_required_columns_only(read):
    expected = [Expected("r"), Expected("pressure", required=False)]
    with pytest.raises(SolutionFileError, match="without headings, where r is expected; say which"):
        read("0.5,0.25\n", expected)


REFUSED = [
    ("1,0.5,0.25\n", {}, "line 1: 3 columns without headings, where r and z are expected; say wh"),
    ("node,x,y\n1,0.5,0.25\n", {}, "no column of r and z: the headings are node, x, y; say which"),
    ("r,radius,z\n1,0.5,0.25\n", {}, r"column 1 \(r\) and column 2 \(radius\) are both r"),
    ("r,z\n0.5,half\n", {}, r"line 2, column 2 \(z\): half is not a number"),
    ("r,z\n\n0.5,\n", {}, r"line 3, column 2 \(z\): there is no value"),
    ("#N/A,0.5\n0.5,0.25\n", {}, r"line 1, column 1 \(r\): #N/A is no value"),
    ("0.5,0.25\n#DIV/0!,0.5\n", {}, r"line 2, column 1 \(r\): #DIV/0! is no value"),
    ("0.5;0.25\n#NV;0.5\n", {}, r"line 2, column 1 \(r\): #NV is no value"),
    ("r,z\n0.5,inf\n", {}, r"line 2, column 2 \(z\): inf is not a finite number"),
    ("r,z\n0.5,1e999\n", {}, "line 2, column 2 .z.: 1e999 is not within the range of a double"),
    ("r,z\n0.5,1_0\n", {}, "1_0 is not a number"),
    ("r,z\n0.5,-0.25\n", {}, r"line 2, column 2 \(z\): -0.25 must be at least 0"),
    ("r,z\n0.5,0.25\n0.5\n", {}, "line 3: 1 column, where there are 2 above"),
    ("r,z\n0.5,0.25\n0,5,0,25\n", {}, "line 3: 4 columns, where there are 2 above"),
    ("r;z\n0,5;0.25\n", {}, "line 2 has a decimal comma .0,5., line 2 a decimal point"),
    ("r;z\n1.000,5;2\n", {}, r"column 1 \(r\): 1.000,5 is not a number"),
    ("r\tz\n1,000\t2,500\n", {}, "line 2: it is not known whether the comma of 1,000 is a dec"),
    ("node,r,z\n1,0.5,0.25\nMinimum,0.5,0.25\n", {}, "line 3, column 1: Minimum is text, where"),
    ("*Node, r\n0.5,0.25\n", {}, "line 1: text that names no column"),
    ("mesh\n0.5,0.25\n", {}, "line 1: text that names no column, above numbers in 2 columns"),
    ("r,z\nfoo,bar,baz\n0.5,0.25\n", {}, "line 2: text between the headings and the numbers"),
    ("0.5,0.25\nr,z\n1.5,0\n", {}, "line 1: numbers above the headings of line 2"),
    ("r,z\n", {}, "has no row of numbers"),
    ("", {}, "has no row of numbers"),
    (b"PK\x03\x04\x00\x00", {}, "is an archive or a spreadsheet"),
    (b"\x9d\x81\xff", {}, "is no text, or damaged"),
    (codecs.BOM_UTF16_LE + b"1 2", {}, "is no text, or damaged"),
    (b"\x93NUMPY\x01\x00v\x00{'d", {}, "is binary"),
    ("r [mm],z [mm]\n0.5,0.25\n", {}, r"column 1 \(r \[mm\]\) is in mm: the scene has no units"),
    ("r [s],z\n1,2\n", {"expected": IN_METRES}, r"column 1 \(r \[s\]\): s is no unit of r"),
    ("r [foo],z\n1,2\n", {"expected": IN_METRES}, "foo is no unit of r, which is in m"),
    ("r [a],z [a]\n1,2\n", {"expected": IN_METRES}, "is dimensionless, where r in m is expected"),
    ("s,z\n1,2\n", {"expected": IN_METRES}, "s is over the contact radius, where r in m"),
    ("r [m],z\n1,2\n", {"expected": IN_METRES, "columns": "r=1 [mm],z=2"}, "is in m, not in mm"),
    ("1,2\n", {"columns": "r=1,z=3"}, "columns 3: there are 2 columns"),
    ("1,2\n", {"columns": "r=1,z=0"}, "columns 0: there are 2 columns"),
    ("1,2\n", {"columns": "r=1"}, "no column of z"),
    ("1,2\n", {"columns": "r=1,r=2"}, "r is given twice"),
    ("1,2\n", {"columns": "r=1,z=1"}, "column 1 is given twice"),
    ("1,2\n", {"columns": "r=1,depht=2"}, "depht is none of r, z"),
    ("1,2,3\n", {"columns": "r,z"}, "2 names for 3 columns without headings"),
    ("X,Y\n1,2\n", {"columns": "r,z"}, "no column r: the headings are X, Y"),
    ("r,z\n#N/A,1\n", {"invalid": "skip"}, "no row can be read: line 2, column 1"),
]


@pytest.mark.parametrize(("content", "options", "message"), REFUSED, ids=[r[2] for r in REFUSED])
def test_what_is_not_clear_is_refused_with_its_place(read, content, options, message):
    if "expected" in options:
        pytest.importorskip("pint", reason="part of the extra: units")
    with pytest.raises(SolutionFileError, match=message) as refusal:
        read(content, **options)
    assert "\n" not in str(refusal.value)
    assert "nodes.csv: " in str(refusal.value)


def test_the_decimal_sign_may_be_said(read):
    content = "r\tz\n1,000\t2,500\n"
    assert values(read(content, decimal=","), "r", "z") == [[1.0], [2.5]]
    with pytest.raises(SolutionFileError, match="1,000 is not a number"):
        read(content, decimal=".")


@pytest.mark.parametrize(
    "options",
    [{"header": 0}, {"decimal": "'"}, {"invalid": "drop"}, {"columns": 3}, {"columns": [3]}],
)
def test_options_are_checked(read, options):
    with pytest.raises(SceneError):
        read("0.5,0.25\n", **options)


def test_numbers_survive_a_round_trip(read):
    rng = np.random.default_rng(1)
    points = rng.random((50, 2)) * 10.0 ** rng.integers(-300, 300, (50, 2))
    for sign, delimiter in ((".", ","), (",", ";"), (",", "\t")):
        rows = [delimiter.join(map(repr, row)).replace(".", sign) for row in points.tolist()]
        found = read("\n".join(["r" + delimiter + "z", *rows]))
        assert np.array_equal(np.column_stack([found.values["r"], found.values["z"]]), points)


@pytest.mark.parametrize("first", ["nan,nan", "NaN,", "n/a,-", "#N/A,#N/A"])
def test_a_first_row_without_values_is_no_line_of_units(read, first):
    text = f"r,z\n{first}\n1,2\n3,4\n"
    for invalid in ("skip", "missing"):
        found = read(text, invalid=invalid)
        assert values(found, "r", "z") == [[1.0, 3.0], [2.0, 4.0]]
        assert len(found.unread) == 1
    with pytest.raises(SolutionFileError, match="line 2, column 1"):
        read(text)


def test_dashes_below_headings_are_units_of_numbers_without_one(read):
    assert values(read("r,z\n-,-\n1,2\n"), "r", "z") == [[1.0], [2.0]]


def test_a_number_that_vanishes_in_si_units_is_out_of_range(read):
    with pytest.raises(SolutionFileError, match="1e-320 is not within the range of a double"):
        read("r [nm],z [m]\n1e-320,1\n", IN_METRES)
