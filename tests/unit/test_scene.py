import copy
import dataclasses
import json
import math
import pickle
import sys
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_contact.errors import SceneError, SolutionFileError
from spectral_contact.scene import PhysicalData, Scene

STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "radius": 0.013}
NUMBERS = ("poisson_ratio", "normal_compliance", "tangential_compliance", "friction")

# --- strategies -----------------------------------------------------------------------------------

poisson_ratios = st.floats(-1.0, 0.5, exclude_min=True)
compliances = st.just(0.0) | st.floats(1e-14, 1e14)
frictions = st.none() | st.floats(0.0)
positive = st.floats(0.0, exclude_min=True, allow_infinity=False)


@st.composite
def physical_scenes(draw):
    given_one = draw(st.sampled_from(["load", "approach"]))
    return Scene.from_physical(
        youngs_modulus=draw(st.floats(1e3, 1e13)),
        poisson_ratio=draw(st.floats(-0.99, 0.5)),
        radius=draw(st.floats(1e-6, 10.0)),
        normal_compliance=draw(st.just(0.0) | st.floats(1e-14, 1e-10)),
        tangential_compliance=draw(st.just(0.0) | st.floats(1e-14, 1e-10)),
        friction=draw(frictions),
        **{given_one: draw(positive)},
    )


scenes = st.builds(Scene, poisson_ratios, compliances, compliances, frictions) | physical_scenes()

junk = (
    st.text()
    | st.binary()
    | st.booleans()
    | st.complex_numbers()
    | st.lists(st.floats(), max_size=3)
    | st.dictionaries(st.text(max_size=3), st.floats(), max_size=2)
    | st.floats(0.0, 0.5).map(np.array)
    | st.floats(0.0, 0.5).map(lambda value: np.array([value, value]))
    | st.floats(0.0, 0.5).map(np.complex128)
    | st.decimals()
    | st.sampled_from([math.nan, -math.inf, np.float32("nan"), mpmath.nan, object(), int, ...])
    | st.floats(max_value=-1.0)
    | st.integers(max_value=-1)
)


def bits(scene):
    """The scene's numbers, told apart to the last bit and the sign of zero."""
    numbers = [getattr(scene, name) for name in NUMBERS]
    if scene.physical is not None:
        numbers += dataclasses.astuple(scene.physical)
    return [None if number is None else number.hex() for number in numbers]


# --- what a scene holds ---------------------------------------------------------------------------


def test_absence_is_the_switch():
    scene = Scene(0.3)
    assert (scene.normal_compliance, scene.tangential_compliance) == (0.0, 0.0)
    assert scene.friction is None
    assert scene.physical is None


def test_positional_and_keyword_are_the_same():
    keyword = Scene(
        poisson_ratio=0.1, normal_compliance=0.5, tangential_compliance=0.25, friction=0.2
    )
    assert Scene(0.1, 0.5, 0.25, 0.2) == keyword


def test_physical_is_keyword_only():
    with pytest.raises(TypeError):
        Scene(0.1, 0.5, 0.25, 0.2, None)


@pytest.mark.parametrize(
    "kind", [float, np.float64, np.float32, np.longdouble, Fraction, mpmath.mpf]
)
def test_numbers_are_stored_as_python_floats(kind):
    scene = Scene(*(kind(value) for value in (0.125, 0.5, 2.0, 0.25)))
    assert scene == Scene(0.125, 0.5, 2.0, 0.25)
    assert all(type(getattr(scene, name)) is float for name in NUMBERS)
    assert type(scene.kappa) is float


@pytest.mark.parametrize("kind", [int, np.int64, np.uint8])
def test_integers_are_stored_as_python_floats(kind):
    scene = Scene(kind(0), kind(3), kind(1), kind(0))
    assert bits(scene) == bits(Scene(0.0, 3.0, 1.0, 0.0))


def test_negative_zero_becomes_zero():
    scene = Scene(-0.0, -0.0, -0.0, -0.0)
    assert bits(scene) == bits(Scene(0.0, 0.0, 0.0, 0.0))
    assert hash(scene) == hash(Scene(0.0, 0.0, 0.0, 0.0))
    physical = Scene.from_physical(**STEEL, load=1.0, normal_compliance=-0.0).physical
    assert math.copysign(1.0, physical.normal_compliance) == 1.0


@pytest.mark.parametrize(
    ("parameter", "value"),
    [
        ("poisson_ratio", 0.5),
        ("poisson_ratio", math.nextafter(-1.0, 0.0)),
        ("normal_compliance", 1e-14),
        ("normal_compliance", 1e14),
        ("tangential_compliance", 1e-14),
        ("tangential_compliance", 1e14),
        ("friction", 0.0),
        ("friction", 5e-324),
        ("friction", sys.float_info.max),
        ("friction", math.inf),
        ("friction", np.float32("inf")),
    ],
)
def test_ends_of_the_ranges_belong(parameter, value):
    assert getattr(Scene(**{"poisson_ratio": 0.3, parameter: value}), parameter) == value


# --- what it refuses ------------------------------------------------------------------------------

BAD = {
    "NaN": math.nan,
    "NumPy's NaN": np.float64("nan"),
    "-inf": -math.inf,
    "complex": 0.3j,
    "complex with a real value": 0.3 + 0j,
    "string": "0.3",
    "bytes": b"0.3",
    "list": [0.3],
    "array": np.array([0.3]),
    "0-d array": np.array(0.3),
    "True": True,
    "False": False,
    "Decimal": Decimal("0.3"),
    "object": object(),
    "huge int": 10**400,
    "int beyond the digit limit": 10**5000,
}
NEVER = [pytest.param(value, id=name) for name, value in BAD.items()]


@pytest.mark.parametrize("parameter", NUMBERS)
@pytest.mark.parametrize("value", NEVER)
def test_no_parameter_takes(parameter, value):
    with pytest.raises(SceneError, match=f"^{parameter} = ") as caught:
        Scene(**{"poisson_ratio": 0.3, parameter: value})
    assert caught.value.parameter == parameter
    assert caught.value.value is value


@pytest.mark.parametrize(
    ("parameter", "value", "allowed"),
    [
        ("poisson_ratio", math.inf, "in (-1, 0.5]"),
        ("poisson_ratio", 0.7, "in (-1, 0.5]"),
        ("poisson_ratio", math.nextafter(0.5, 1.0), "in (-1, 0.5]"),
        ("poisson_ratio", -1, "in (-1, 0.5]"),
        ("normal_compliance", None, "a real number, 0 or in [1e-14, 1e14]"),
        ("normal_compliance", math.inf, "0 or in [1e-14, 1e14]"),
        ("normal_compliance", -0.5, "0 or in [1e-14, 1e14]"),
        ("normal_compliance", 9.9e-15, "0 or in [1e-14, 1e14]"),
        ("normal_compliance", 5e-324, "0 or in [1e-14, 1e14]"),
        ("normal_compliance", 1.1e14, "0 or in [1e-14, 1e14]"),
        ("tangential_compliance", math.inf, "0 or in [1e-14, 1e14]"),
        ("tangential_compliance", -0.5, "0 or in [1e-14, 1e14]"),
        ("tangential_compliance", 9.9e-15, "0 or in [1e-14, 1e14]"),
        ("tangential_compliance", 1.1e14, "0 or in [1e-14, 1e14]"),
        ("friction", -0.1, ">= 0 (math.inf is full stick, None no friction)"),
        ("friction", -5e-324, ">= 0 (math.inf is full stick, None no friction)"),
        ("physical", {"load": 1.0}, "None or a PhysicalData"),
    ],
)
def test_out_of_range(parameter, value, allowed):
    with pytest.raises(SceneError) as caught:
        Scene(**{"poisson_ratio": 0.3, parameter: value})
    assert str(caught.value) == f"{parameter} = {value!r}: must be {allowed}"


def test_a_compliance_too_small_for_a_double_is_not_taken_for_a_smooth_surface():
    with pytest.raises(SceneError, match="normal_compliance"):
        Scene(0.3, Fraction(1, 10**400))


@given(st.sampled_from(NUMBERS), junk)
def test_any_junk_is_a_scene_error_that_names_the_parameter(parameter, value):
    with pytest.raises(SceneError, match=f"^{parameter} = ") as caught:
        Scene(**{"poisson_ratio": 0.3, parameter: value})
    assert caught.value.parameter == parameter
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


@given(st.sampled_from([*NUMBERS, "youngs_modulus", "radius", "load"]), junk)
def test_any_junk_in_si_units_too(parameter, value):
    with pytest.raises(SceneError, match=f"^{parameter} = "):
        Scene.from_physical(**(STEEL | {"load": 1.0, parameter: value}))


# --- what a scene is ------------------------------------------------------------------------------


def test_immutable():
    scene = Scene.from_physical(**STEEL, load=1.0)
    for thing, name in ((scene, "friction"), (scene.physical, "load")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(thing, name, 0.5)
        with pytest.raises(dataclasses.FrozenInstanceError):
            delattr(thing, name)
        assert not hasattr(thing, "__dict__")


@given(scenes)
def test_round_trips(scene):
    again = [
        *(pickle.loads(pickle.dumps(scene, n)) for n in range(pickle.HIGHEST_PROTOCOL + 1)),
        copy.copy(scene),
        copy.deepcopy(scene),
        dataclasses.replace(scene),
        eval(repr(scene), {"Scene": Scene, "PhysicalData": PhysicalData, "inf": math.inf}),
        Scene.from_json(scene.to_json()),
        Scene.from_dict(scene.to_dict()),
    ]
    for other in again:
        assert type(other) is Scene
        assert other == scene
        assert hash(other) == hash(scene)
        assert bits(other) == bits(scene)


def test_scenes_that_differ_are_not_equal():
    scene = Scene(0.1, 0.5, 0.5, 0.1)
    for name in NUMBERS:
        assert dataclasses.replace(scene, **{name: 0.0}) != scene
    smooth = Scene.from_physical(**STEEL, load=1.0)
    assert smooth != Scene(0.3)
    assert smooth != Scene.from_physical(**STEEL, load=2.0)
    assert Scene(0.3, friction=None) != Scene(0.3, friction=0.0)


def test_replace_checks_again():
    with pytest.raises(SceneError, match=r"poisson_ratio = 0.7"):
        dataclasses.replace(Scene(0.3), poisson_ratio=0.7)


def test_kappa_at_known_values():
    assert Scene(0.5).kappa == 0.0
    assert Scene(0.0).kappa == 0.25
    assert Scene(0.1).kappa == pytest.approx(0.8 / 3.6, rel=1e-15)


@given(
    poisson_ratios | st.floats(0.0, 0.1).map(lambda small: 0.5 - small * 2.0**-40),
)
def test_kappa_to_a_few_rounding_errors(nu):
    exact = (1 - 2 * Fraction(nu)) / (4 * (1 - Fraction(nu)))
    assert abs(Fraction(Scene(nu).kappa) - exact) <= exact * Fraction(3, 2**53)


# --- JSON -----------------------------------------------------------------------------------------


def test_schema_is_as_published():
    assert Scene(0.1, 0.5, 0.25, math.inf).to_dict() == {
        "schema": "spectral_contact.scene",
        "version": 1,
        "poisson_ratio": 0.1,
        "normal_compliance": 0.5,
        "tangential_compliance": 0.25,
        "friction": "inf",
        "physical": None,
    }
    physical = Scene.from_physical(**STEEL, approach=1e-6).to_dict()["physical"]
    assert physical == {
        "youngs_modulus": 2.1e11,
        "radius": 0.013,
        "load": None,
        "approach": 1e-6,
        "normal_compliance": 0.0,
        "tangential_compliance": 0.0,
    }


@given(scenes)
def test_json_is_strict(scene):
    def refuse(constant):
        raise AssertionError(constant)

    assert json.loads(scene.to_json(), parse_constant=refuse) == scene.to_dict()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"schema": "spectral_contact.solution"}, 'its "schema" is not "spectral_contact.scene"'),
        ({"schema": None}, "not a scene"),
        ({"version": 2}, "version 2 is not known to this release, which reads 1"),
        ({"version": 0}, "version 0"),
        ({"version": True}, "version True"),
        ({"version": "1"}, "version '1'"),
        ({"version": None}, "version None"),
        ({"colour": "red"}, "keys are unknown 'colour'"),
        ({"physical": []}, 'in "physical", an object was expected'),
        ({"physical": {}}, 'in "physical", keys are missing youngs_modulus, radius, load'),
    ],
)
def test_other_schemas_are_refused(change, message):
    text = json.dumps(Scene(0.3).to_dict() | change)
    with pytest.raises(SolutionFileError) as caught:
        Scene.from_json(text)
    assert message in str(caught.value)


@pytest.mark.parametrize("key", list(Scene(0.3).to_dict()))
def test_every_key_is_required(key):
    data = Scene(0.3).to_dict()
    del data[key]
    with pytest.raises(SolutionFileError, match=key):
        Scene.from_dict(data)


def test_unknown_and_missing_keys_are_both_told():
    data = Scene(0.3).to_dict()
    data["frictoin"] = data.pop("friction")
    with pytest.raises(SolutionFileError, match="missing friction; unknown 'frictoin'"):
        Scene.from_dict(data)


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "0.3", "null", '"scene"', "[" * 100_000, "9" * 5000, b"\xff", None, 3]
)
def test_text_that_is_no_scene(text):
    with pytest.raises(SolutionFileError, match=r"^scene: "):
        Scene.from_json(text)


@pytest.mark.parametrize(
    ("key", "written"),
    [
        ("poisson_ratio", "0.7"),
        ("poisson_ratio", "NaN"),
        ("poisson_ratio", '"0.3"'),
        ("poisson_ratio", "true"),
        ("normal_compliance", "-1"),
        ("normal_compliance", "1e-300"),
        ("normal_compliance", "[0.5]"),
        ("tangential_compliance", "Infinity"),
        ("tangential_compliance", '"inf"'),
        ("friction", "Infinity"),
        ("friction", "-Infinity"),
        ("friction", "1e999"),
        ("friction", '"infinity"'),
        ("friction", "-0.1"),
    ],
)
def test_values_in_json_are_checked(key, written):
    text = json.dumps(Scene(0.3).to_dict() | {key: "HERE"}).replace('"HERE"', written)
    with pytest.raises(SceneError, match=f"^{key} = "):
        Scene.from_json(text)


def test_arrays_in_a_dictionary_are_scene_errors():
    with pytest.raises(SceneError, match="friction"):
        Scene.from_dict(Scene(0.3).to_dict() | {"friction": np.array([0.1, math.inf])})
    with pytest.raises(SolutionFileError, match="schema"):
        Scene.from_dict(Scene(0.3).to_dict() | {"schema": np.array(["a", "b"])})


@pytest.mark.parametrize(
    "change", [{"version": 10**5000}, {"physical": ["a\n"] * 1000}, {"a\nb" * 1000: 0}]
)
def test_what_a_refusal_shows_is_short_and_on_one_line(change):
    with pytest.raises(SolutionFileError) as caught:
        Scene.from_dict(Scene(0.3).to_dict() | change)
    assert len(str(caught.value)) < 200
    assert "\n" not in str(caught.value)


def test_physical_data_in_json_must_agree_with_the_scene():
    data = Scene.from_physical(**STEEL, load=1.0, normal_compliance=1e-13).to_dict()
    with pytest.raises(SceneError, match=r"normal_compliance = 0.5"):
        Scene.from_dict(data | {"normal_compliance": 0.5})


# --- SI units -------------------------------------------------------------------------------------


def test_compliances_become_dimensionless():
    # E = 4(1−ν²) with ν = 0.5 and a = 2: α* is α/2.
    scene = Scene.from_physical(
        youngs_modulus=3.0,
        poisson_ratio=0.5,
        radius=2.0,
        load=1.0,
        normal_compliance=3.0,
        tangential_compliance=5.0,
        friction=0.2,
    )
    assert bits(scene)[:4] == bits(Scene(0.5, 1.5, 2.5, 0.2))
    assert scene.physical == PhysicalData(
        youngs_modulus=3.0, radius=2.0, load=1.0, normal_compliance=3.0, tangential_compliance=5.0
    )


@pytest.mark.parametrize("parameter", ["normal_compliance", "tangential_compliance"])
@pytest.mark.parametrize("end", [1e-14, 1e14])
def test_the_ends_of_the_range_are_in_it_in_si_units_too(parameter, end):
    """E = 4(1−ν²) with ν = 0.5, a = 1: compliances are what they are in m/Pa."""
    unit = {"youngs_modulus": 3.0, "poisson_ratio": 0.5, "radius": 1.0, "load": 1.0}
    assert getattr(Scene.from_physical(**unit, **{parameter: end}), parameter) == end
    beyond = math.nextafter(end, end * (math.inf if end > 1.0 else 0.0))
    with pytest.raises(SceneError, match=parameter):
        Scene.from_physical(**unit, **{parameter: beyond})


@given(physical_scenes())
def test_compliances_are_correctly_rounded(scene):
    si = scene.physical
    unit = 4 * (1 - Fraction(scene.poisson_ratio) ** 2) * Fraction(si.radius)
    for name in ("normal_compliance", "tangential_compliance"):
        exact = Fraction(getattr(si, name)) * Fraction(si.youngs_modulus) / unit
        assert getattr(scene, name) == float(exact)


def test_no_intermediate_result_overflows():
    scene = Scene.from_physical(
        youngs_modulus=1e200, poisson_ratio=0.0, radius=1e300, load=1.0, normal_compliance=4e110
    )
    assert scene.normal_compliance == pytest.approx(1e10, rel=1e-15)


@pytest.mark.parametrize("parameter", ["normal_compliance", "tangential_compliance"])
@pytest.mark.parametrize(
    ("value", "star"),
    [(1e-300, "4.438e-288"), (5e-324, "2.193e-311"), (1e10, "4.438e+22"), (1e300, "4.438e+312")],
)
def test_si_compliance_out_of_range_names_it_and_the_dimensionless_value(parameter, value, star):
    with pytest.raises(SceneError) as caught:
        Scene.from_physical(**STEEL, load=1.0, **{parameter: value})
    assert caught.value.parameter == parameter
    assert caught.value.value == value
    assert f"{parameter} = {value!r}: must be 0 or have " in str(caught.value)
    assert f"E/(4(1−ν²)a) in [1e-14, 1e14], which is {star} here" in str(caught.value)


def test_dimensionless_value_beyond_doubles_is_still_shown():
    with pytest.raises(SceneError, match=r"which is 3\.3\d*e\+899 here"):
        Scene.from_physical(
            youngs_modulus=1e300,
            poisson_ratio=0.5,
            radius=1e-300,
            load=1.0,
            normal_compliance=1e300,
        )


@pytest.mark.parametrize("both", [{}, {"load": 1.0, "approach": 2.0}, {"load": 0, "approach": 0}])
def test_exactly_one_of_load_and_approach(both):
    with pytest.raises(SceneError, match=r"^load, approach = ") as caught:
        Scene.from_physical(**STEEL, **both)
    assert caught.value.parameter == "load, approach"
    assert caught.value.value == (both.get("load"), both.get("approach"))


@pytest.mark.parametrize("parameter", ["youngs_modulus", "radius", "load", "approach"])
@pytest.mark.parametrize("value", [0.0, -0.0, -1.0, math.inf, *NEVER])
def test_si_data_are_finite_and_positive(parameter, value):
    other = {} if parameter in ("load", "approach") else {"load": 1.0}
    with pytest.raises(SceneError, match=f"^{parameter} = .* finite and > 0"):
        Scene.from_physical(**(STEEL | other | {parameter: value}))


@pytest.mark.parametrize("parameter", ["youngs_modulus", "radius"])
def test_si_data_that_must_be_there(parameter):
    with pytest.raises(SceneError, match=f"^{parameter} = None"):
        Scene.from_physical(**(STEEL | {"load": 1.0, parameter: None}))


@pytest.mark.parametrize("parameter", ["normal_compliance", "tangential_compliance"])
@pytest.mark.parametrize("value", [-1e-12, math.inf, None, *NEVER])
def test_si_compliances_are_finite_and_not_negative(parameter, value):
    with pytest.raises(SceneError, match=f"^{parameter} = .* finite and >= 0"):
        Scene.from_physical(**STEEL, load=1.0, **{parameter: value})


def test_replace_keeps_si_data_and_scene_in_step():
    scene = Scene.from_physical(**STEEL, load=1.0, normal_compliance=1e-13)
    assert dataclasses.replace(scene, friction=0.3).physical == scene.physical
    with pytest.raises(SceneError, match="as the SI data imply"):
        dataclasses.replace(scene, normal_compliance=0.5)
    with pytest.raises(SceneError, match="as the SI data imply"):
        dataclasses.replace(scene, poisson_ratio=0.2)
    freed = dataclasses.replace(scene, normal_compliance=0.5, physical=None)
    assert freed == Scene(0.3, 0.5)


# --- scales ---------------------------------------------------------------------------------------

# ν = 0.5: 4(1−ν²) = 3, so with E = 3, a = 2 the displacement scale is P/2, the pressure scale P/4.
BY_LOAD = PhysicalData(youngs_modulus=3.0, radius=2.0, load=10.0)
BY_APPROACH = PhysicalData(youngs_modulus=3.0, radius=2.0, approach=0.25)


def test_scales():
    assert BY_LOAD.pressure_scale(10.0) == 2.5
    assert BY_LOAD.displacement_scale(10.0, 0.5) == 5.0


def test_load_is_the_one_given_or_that_of_the_approach():
    assert BY_LOAD.load_for(0.125, 0.5) == 10.0
    # Smooth: δ* = 1/8, so P = 8·δ·E·a/3.
    assert BY_APPROACH.load_for(0.125, 0.5) == 4.0


@given(physical_scenes(), st.floats(1e-9, 1e-3), st.floats(0.125, 1e14))
def test_load_and_displacement_scale_give_the_approach_back(scene, approach, star):
    si = dataclasses.replace(scene.physical, load=None, approach=approach)
    scale = si.displacement_scale(si.load_for(star, scene.poisson_ratio), scene.poisson_ratio)
    assert scale * star == pytest.approx(approach, rel=1e-15)


@given(positive, positive)
def test_pressure_scale_is_correctly_rounded_or_refused(load, radius):
    si = PhysicalData(youngs_modulus=1.0, radius=radius, load=load)
    exact = Fraction(load) / Fraction(radius) ** 2
    if sys.float_info.min <= exact <= sys.float_info.max:
        assert si.pressure_scale(load) == float(exact)
    else:
        with pytest.raises(SceneError, match=r"^load = .* P/a² is a normal double, which is"):
            si.pressure_scale(load)


def test_scales_beyond_doubles_are_refused():
    huge = PhysicalData(youngs_modulus=1e300, radius=1e300, approach=1.0)
    with pytest.raises(SceneError, match=r"^approach = 1\.0: .* which is 2\.667e\+600 N here"):
        huge.load_for(0.125, 0.5)
    with pytest.raises(SceneError, match=r"^load = 1\.0: .* which is 3\.000e-600 m here"):
        huge.displacement_scale(1.0, 0.5)


@pytest.mark.parametrize("data", [BY_LOAD, BY_APPROACH])
@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan, "1", None])
def test_arguments_of_the_scales_are_checked(data, value):
    with pytest.raises(SceneError, match=r"^approach_star = "):
        data.load_for(value, 0.5)
    with pytest.raises(SceneError, match=r"^load = "):
        data.pressure_scale(value)
    with pytest.raises(SceneError, match=r"^load = "):
        data.displacement_scale(value, 0.5)


@pytest.mark.parametrize("nu", [-1.0, 0.6, math.nan, "0.3", None])
def test_poisson_ratio_of_the_scales_is_checked(nu):
    for call in (
        lambda: BY_LOAD.load_for(0.125, nu),
        lambda: BY_APPROACH.load_for(0.125, nu),
        lambda: BY_LOAD.displacement_scale(1.0, nu),
        lambda: BY_LOAD.dimensionless_compliances(nu),
    ):
        with pytest.raises(SceneError, match=r"^nu = "):
            call()


# --- elastic coupling -----------------------------------------------------------------------------


@pytest.mark.parametrize("bad", [1, 0, "no", None, 1.0, [True]])
def test_coupling_is_true_or_false(bad):
    with pytest.raises(SceneError, match=r"^coupling = .*: must be True or False"):
        Scene(0.3, coupling=bad)


def test_a_coupled_scene_is_another_scene_and_survives_json():
    coupled = Scene(0.1, 0.5, 0.25, math.inf, coupling=np.True_)
    assert coupled.coupling is True
    assert coupled != Scene(0.1, 0.5, 0.25, math.inf)
    assert coupled.to_dict()["coupling"] is True
    for again in (Scene.from_json(coupled.to_json()), pickle.loads(pickle.dumps(coupled))):
        assert again == coupled
        assert again.coupling is True
    with pytest.raises(SceneError, match="coupling"):
        Scene.from_dict(coupled.to_dict() | {"coupling": 1})


def test_coupling_in_si_units():
    scene = Scene.from_physical(**STEEL, load=1.0, friction=0.1, coupling=True)
    assert scene.coupling
    assert scene.couples
    assert Scene.from_json(scene.to_json()) == scene


@pytest.mark.parametrize(
    ("scene", "couples"),
    [
        (Scene(0.3, friction=0.1, coupling=True), True),
        (Scene(0.3, friction=math.inf, coupling=True), True),
        (Scene(0.3, friction=math.inf), False),
        (Scene(0.5, friction=math.inf, coupling=True), False),
        (Scene(0.3, friction=0.0, coupling=True), False),
        (Scene(0.3, coupling=True), False),
    ],
)
def test_what_couples(scene, couples):
    assert scene.couples is couples


# --- changed copies, and how scenes show themselves -----------------------------------------------


def test_a_replacement_is_checked_anew():
    scene = Scene(0.3, 0.5, friction=0.1)
    assert scene.replace(friction=None, coupling=True) == Scene(0.3, 0.5, coupling=True)
    assert scene.replace() == scene
    with pytest.raises(SceneError, match=r"poisson_ratio = 0\.7"):
        scene.replace(poisson_ratio=0.7)
    with pytest.raises(SceneError, match="did you mean friction"):
        scene.replace(fricton=0.2)
    with pytest.raises(SceneError, match="radius"):
        scene.replace(radius=1.0)


def test_a_scene_in_si_units_is_changed_in_si_units():
    given = {**STEEL, "friction": 0.1}
    scene = Scene.from_physical(**given, load=1000.0)
    assert scene.replace(radius=0.02) == Scene.from_physical(
        **{**given, "radius": 0.02}, load=1000.0
    )
    assert scene.replace(approach=1e-6) == Scene.from_physical(**given, approach=1e-6)
    assert scene.replace(approach=1e-6).replace(load=1000.0) == scene
    bare = scene.replace(physical=None, normal_compliance=0.25)
    assert (bare.physical, bare.normal_compliance, bare.friction) == (None, 0.25, 0.1)
    assert bare.tangential_compliance == scene.tangential_compliance
    with pytest.raises(SceneError, match="load, approach"):
        scene.replace(load=1.0, approach=1.0)
    with pytest.raises(SceneError, match="did you mean youngs_modulus"):
        scene.replace(young_modulus=1.0)


@pytest.mark.parametrize("friction", [None, 0.0, 0.1, math.inf])
def test_the_repr_is_short_and_makes_the_scene(friction):
    names = {"Scene": Scene, "inf": math.inf}
    scene = Scene(0.0, 0.5, friction=friction)
    assert repr(scene).startswith("Scene(poisson_ratio=0.0, normal_compliance=0.5")
    assert "tangential" not in repr(scene)
    assert "None" not in repr(scene)
    steel = Scene.from_physical(**STEEL, approach=1e-6, friction=friction, coupling=True)
    assert repr(steel).startswith("Scene.from_physical(")
    for one in (scene, steel):
        assert eval(repr(one), names) == one
