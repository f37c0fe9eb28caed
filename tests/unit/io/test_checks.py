import math
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import exactly_one, lengths, radii, real, tolerance, whole

NOT_REAL = [
    pytest.param(value, id=f"{type(value).__name__} {index}")
    for index, value in enumerate(
        [
            None,
            True,
            np.True_,
            "0.3",
            b"0.3",
            1j,
            0.3 + 0j,
            np.complex128(0.3),
            mpmath.mpc(0.3),
            Decimal("0.3"),
            [0.3],
            (0.3,),
            {0.3},
            {"value": 0.3},
            np.array(0.3),
            np.array([0.3]),
            np.timedelta64(1, "s"),
            np.datetime64("2020-01-01"),
            object(),
            float,
            lambda: 0.3,
        ]
    )
]


def plain(value, **limits):
    return real("x", value, allowed="as it should be", **limits)


class Stubborn(float):
    """A real number by type whose conversion fails."""

    def __float__(self):
        raise TypeError("no")


# --- real -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "value",
    [
        0.25,
        np.float64(0.25),
        np.float32(0.25),
        np.float16(0.25),
        np.longdouble(0.25),
        Fraction(1, 4),
        mpmath.mpf("0.25"),
    ],
)
def test_real_takes_real_numbers_of_any_type(value):
    number = plain(value)
    assert type(number) is float
    assert number == 0.25


@pytest.mark.parametrize("value", [3, np.int8(3), np.uint64(3), 3.0])
def test_real_takes_integers(value):
    number = plain(value)
    assert type(number) is float
    assert number == 3.0


@pytest.mark.parametrize("value", NOT_REAL)
def test_real_refuses_what_is_no_real_number(value):
    with pytest.raises(SceneError, match="must be a real number, as it should be") as caught:
        plain(value)
    assert caught.value.parameter == "x"
    assert caught.value.value is value


@pytest.mark.parametrize("infinite_ok", [False, True])
@pytest.mark.parametrize("nan", [math.nan, np.float64("nan"), np.float32("nan"), mpmath.nan])
def test_real_refuses_nan(nan, infinite_ok):
    with pytest.raises(SceneError, match=r"x = .*nan.*: must be as it should be"):
        plain(nan, infinite_ok=infinite_ok)


@pytest.mark.parametrize("value", [math.inf, -math.inf, np.float32("inf"), mpmath.inf])
def test_real_takes_infinity_only_where_told(value):
    with pytest.raises(SceneError):
        plain(value)
    assert plain(value, infinite_ok=True) == value


def test_infinity_must_also_be_inside():
    with pytest.raises(SceneError):
        plain(-math.inf, low=0.0, infinite_ok=True)
    with pytest.raises(SceneError):
        plain(math.inf, high=1.0, infinite_ok=True)


@pytest.mark.parametrize("infinite_ok", [False, True])
@pytest.mark.parametrize(
    "value",
    [10**400, -(10**5000), Fraction(10**400), mpmath.mpf(10) ** 400],
    ids=["int", "int beyond the digit limit", "Fraction", "mpf"],
)
def test_overflow_is_not_infinity(value, infinite_ok):
    with pytest.raises(SceneError):
        plain(value, infinite_ok=infinite_ok)


@pytest.mark.parametrize("value", [Fraction(1, 10**400), mpmath.mpf(10) ** -400])
def test_underflow_is_not_zero(value):
    with pytest.raises(SceneError, match="range of a double"):
        plain(value)


def test_a_failing_conversion_is_a_scene_error():
    with pytest.raises(SceneError):
        plain(Stubborn(0.3))


@pytest.mark.parametrize("zero", [-0.0, np.float64(-0.0), 0, mpmath.mpf(0)])
@pytest.mark.parametrize("low", [0.0, -1.0])
def test_negative_zero_becomes_zero(zero, low):
    assert math.copysign(1.0, plain(zero, low=low)) == 1.0


@pytest.mark.parametrize("kind", [float, Fraction, np.float64])
def test_ends_belong_unless_open(kind):
    low, high = kind(-1), kind(2)
    assert plain(low, low=-1.0, high=2.0) == -1.0
    assert plain(high, low=-1.0, high=2.0) == 2.0
    with pytest.raises(SceneError):
        plain(low, low=-1.0, high=2.0, low_open=True)
    with pytest.raises(SceneError):
        plain(high, low=-1.0, high=2.0, high_open=True)


@given(st.floats(allow_nan=False), st.floats(-1e3, 1e3), st.floats(0.0, 1e3))
def test_real_accepts_exactly_the_interval(value, low, width):
    high = low + width
    if low <= value <= high:
        assert plain(value, low=low, high=high) == value
    else:
        with pytest.raises(SceneError):
            plain(value, low=low, high=high)


# --- whole, tolerance, exactly_one ----------------------------------------------------------------


@pytest.mark.parametrize("value", [1, 7, np.int64(7), np.uint8(7), 10**400])
def test_whole(value):
    number = whole("max_unknowns", value, 1)
    assert type(number) is int
    assert number == value


@pytest.mark.parametrize("value", [*NOT_REAL, 20.0, math.nan, math.inf, Fraction(2), 0, -5])
def test_whole_refuses(value):
    with pytest.raises(SceneError, match="must be a whole number >= 1") as caught:
        whole("max_unknowns", value, 1)
    assert caught.value.parameter == "max_unknowns"


@pytest.mark.parametrize("rtol", [1e-13, 1e-2, 1e-6, np.float32(1e-6), Fraction(1, 1000)])
def test_tolerance(rtol):
    assert tolerance(rtol) == float(rtol)


@pytest.mark.parametrize(
    "rtol", [*NOT_REAL, 0.0, -1e-6, 9.99e-14, 0.0101, 1, math.nan, math.inf, -math.inf]
)
def test_impossible_tolerance(rtol):
    with pytest.raises(SceneError, match=r"rtol = .* in \[1e-13, 1e-2\]"):
        tolerance(rtol)


def test_exactly_one():
    exactly_one("load", 0.0, "approach", None)
    exactly_one("load", None, "approach", False)
    for values in ((None, None), (1.0, 2.0)):
        with pytest.raises(SceneError, match="give either load or approach") as caught:
            exactly_one("load", values[0], "approach", values[1])
        assert caught.value.parameter == "load, approach"
        assert caught.value.value == values


# --- radii ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given_values", "shape"),
    [
        (0.5, ()),
        (1, ()),
        (Fraction(1, 2), ()),
        (mpmath.mpf("0.5"), ()),
        (np.float32(0.5), ()),
        (np.array(0.5), ()),
        ([], (0,)),
        (np.empty((3, 0)), (3, 0)),
        ([0.0, 0.5, 1.0], (3,)),
        ((0, 1), (2,)),
        ([Fraction(1, 3), mpmath.mpf("0.5")], (2,)),
        ([[0.1], [0.2]], (2, 1)),
        (np.full((2, 3, 4), 0.25, dtype=np.float16), (2, 3, 4)),
        (np.array([0, 1], dtype=np.uint8), (2,)),
        (np.linspace(0, 1, 5, dtype=np.longdouble), (5,)),
    ],
)
@pytest.mark.parametrize("side", ["s", "from_edge"])
def test_radii_of_any_shape_and_type(given_values, shape, side):
    pair = dict.fromkeys(("s", "from_edge")) | {side: given_values}
    s, from_edge = radii(**pair)
    for array in (s, from_edge):
        assert type(array) is np.ndarray
        assert array.dtype == np.float64
        assert array.shape == shape
    kept = s if side == "s" else from_edge
    np.testing.assert_array_equal(kept, np.asarray(given_values, dtype=float))
    np.testing.assert_allclose(s + from_edge, 1.0, rtol=3e-16)


@given(st.floats(0.0, 1.0))
def test_what_is_given_is_kept_and_the_other_correctly_rounded(value):
    complement = float(1 - Fraction(value))
    s, from_edge = radii(value, None)
    assert (s, from_edge) == (value, complement)
    s, from_edge = radii(None, value)
    assert (s, from_edge) == (complement, value)


def test_distances_from_the_edge_are_kept_down_to_the_smallest_double():
    tiny = np.array([1e-20, 1e-300, 5e-324, 0.0])
    s, from_edge = radii(None, tiny)
    np.testing.assert_array_equal(from_edge, tiny)
    np.testing.assert_array_equal(s, 1.0)


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="no extended precision here")
def test_long_doubles_are_subtracted_before_they_are_rounded():
    s, from_edge = radii(1 - np.longdouble(2.0) ** -60, None)
    assert s == 1.0
    assert from_edge == 2.0**-60


@pytest.mark.parametrize("side", ["s", "from_edge"])
def test_negative_zero_radii_become_zero(side):
    pair = radii(**(dict.fromkeys(("s", "from_edge")) | {side: [-0.0, 1.0]}))
    assert not np.signbit(pair).any()


@pytest.mark.parametrize("side", ["s", "from_edge"])
def test_the_users_array_is_left_alone(side):
    mine = np.array([0.25, 0.5])
    for array in radii(**(dict.fromkeys(("s", "from_edge")) | {side: mine})):
        assert not np.shares_memory(array, mine)


@pytest.mark.parametrize("side", ["s", "from_edge"])
@pytest.mark.parametrize(
    ("values", "offender"),
    [
        (1.5, 1.5),
        (-1e-300, -1e-300),
        (2, 2),
        (1 + 2**-52, 1 + 2**-52),
        (math.inf, math.inf),
        (-math.inf, -math.inf),
        (np.nextafter(1.0, 2.0), 1 + 2**-52),
        ([0.5, 1.5, -3.0], 1.5),
        (np.array([[0.5, 0.1], [-3.0, 7.0]]), -3.0),
        ([0, 10**400], 10**400),
        ([0.5, Fraction(3, 2)], Fraction(3, 2)),
        ([0.5, None], None),
    ],
)
def test_radii_name_the_first_value_outside(side, values, offender):
    with pytest.raises(SceneError, match=r"in \[0, 1\]") as caught:
        radii(**(dict.fromkeys(("s", "from_edge")) | {side: values}))
    assert caught.value.parameter == side
    assert caught.value.value == offender


@pytest.mark.parametrize("values", [math.nan, [0.5, math.nan, 2.0], np.float32("nan")])
def test_radii_refuse_nan(values):
    with np.errstate(all="raise"), pytest.raises(SceneError, match="s = nan"):
        radii(values, None)


# None means "not given", and arrays are welcome here.
NOT_RADII = [
    parameter
    for parameter in NOT_REAL
    if parameter.values[0] is not None and np.asarray(parameter.values[0]).dtype.kind != "f"
]


@pytest.mark.parametrize("value", NOT_RADII)
@pytest.mark.parametrize("side", ["s", "from_edge"])
def test_radii_refuse_what_is_no_real_number(side, value):
    for values in (value, [value, value]):
        with pytest.raises(SceneError, match="must be a real number") as caught:
            radii(**(dict.fromkeys(("s", "from_edge")) | {side: values}))
        assert caught.value.parameter == side


MASKED = np.ma.masked_array([0.1, 0.2], mask=[False, True])


@pytest.mark.parametrize(
    "values",
    [[0.5, True], ((0.5,), (np.False_,)), MASKED, [MASKED], [0.5, np.ma.masked], np.ma.masked],
)
@pytest.mark.parametrize("side", ["s", "from_edge"])
def test_radii_refuse_what_numpy_would_make_numbers_of(side, values):
    with pytest.raises(SceneError, match=f"^{side} = .*, neither masked nor boolean$"):
        radii(**(dict.fromkeys(("s", "from_edge")) | {side: values}))


def test_masked_arrays_that_hide_nothing_are_radii():
    assert radii(np.ma.masked_array([0.25, 1.0]), None)[0].tolist() == [0.25, 1.0]


def test_radii_refuse_a_list_of_itself():
    endless = []
    endless.append(endless)
    with pytest.raises(SceneError, match="of one shape"):
        radii(endless, None)


@pytest.mark.parametrize("values", [[0.0, 3.5], [4, 10**400], [Fraction(9, 2)], np.float32(3.25)])
def test_lengths_tell_the_range_and_its_unit(values):
    with pytest.raises(SceneError, match=r"^r = .*: must be in \[0, 3\] m$"):
        lengths("r", values, 3.0, "m")


def test_radii_refuse_ragged_lists():
    with pytest.raises(SceneError, match="of one shape"):
        radii([[0.1], [0.2, 0.3]], None)


@pytest.mark.parametrize("pair", [(None, None), (0.5, 0.5), ([], [])])
def test_radii_take_exactly_one(pair):
    with pytest.raises(SceneError, match="give either s or from_edge") as caught:
        radii(*pair)
    assert caught.value.parameter == "s, from_edge"
