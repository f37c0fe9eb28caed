"""What is declared of parameters is what their checks and their documentation say."""

import inspect
import math
import re
from dataclasses import fields

import pytest

from spectral_contact import PhysicalData, Scene, SceneError
from spectral_contact.io.checks import within
from spectral_contact.io.parameters import SCENE, SI, Parameter, parameters_of
from spectral_contact.layers import scene_layer
from spectral_contact.profiles import Sphere, control

KINDS = [
    one for one in (*control.KINDS.values(), *scene_layer.KINDS.values()) if parameters_of(one)
]


@pytest.mark.parametrize(
    ("allowed", "inside", "outside"),
    [
        ("in (-1, 0.5]", [-0.999, 0.0, 0.5], [-1.0, 0.50001, math.nan]),
        ("in [1, 100]: below 1 it is another", [1, 100.0], [0.999, 101, math.inf]),
        ("0 or in [1e-14, 1e14]", [0, 1e-14, 1e14], [1e-15, -1e-14, 1.1e14]),
        ("in (0, pi/2), in radians", [1e-300, 1.57], [0.0, math.pi / 2, 2.0]),
        ("in (-3/8, 3/8)", [-0.374], [0.375, -0.375]),
        ("finite and > 0", [5e-324, 1e308], [0.0, math.inf, -1.0]),
        (">= 0 (math.inf is full stick)", [0.0, math.inf], [-5e-324, math.nan]),
        ("finite", [-1e308], [math.inf, -math.inf]),
    ],
)
def test_a_range_in_words_is_the_one_that_is_checked(allowed, inside, outside):
    for value in inside:
        assert within("x", value, allowed) == value
    for value in outside:
        with pytest.raises(SceneError, match=r"^x = .*: must be ") as raised:
            within("x", value, allowed)
        assert raised.value.allowed == allowed


def test_a_parameter_is_told_on_one_line_of_ascii():
    one = Parameter("compliance", "0 or in [1, 2]", "m/Pa", "α* = αE/(4(1−ν²)a)")
    assert str(one) == "compliance alpha* = alphaE/(4(1-nu^2)a) [m/Pa], 0 or in [1, 2]"
    assert all(str(each).isascii() for each in (*SCENE.values(), *SI.values()))


@pytest.mark.parametrize("kind", KINDS, ids=lambda one: one.__name__)
def test_profiles_and_laws_declare_all_that_they_take_and_document_the_ranges(kind):
    declared = parameters_of(kind)
    assert list(declared) == [one.name for one in fields(kind)]
    text = " ".join(inspect.getdoc(kind).split()).lower().replace("1e100", "1e+100")
    for name, one in declared.items():
        assert f" {name} : " in text
        ends = re.search(r"in [\[(][^])]*[\])]|finite and > 0", one.allowed)
        assert all(choice in text for choice in one.choices)
        assert one.choices or ends[0] in text


@pytest.mark.parametrize("kind", KINDS, ids=lambda one: one.__name__)
def test_an_error_has_the_declared_range(kind):
    for name, one in parameters_of(kind).items():
        good = {other: 1.0 for other, each in parameters_of(kind).items() if not each.choices}
        with pytest.raises(SceneError) as raised:
            kind(**{**good, name: -1.0})
        assert raised.value.parameter == name
        assert raised.value.allowed.startswith(one.allowed or "one of")


def test_the_numbers_of_scenes_are_declared():
    others = {"physical", "profile", "layer", "mismatch"}
    assert set(SCENE) - {"kappa"} == {one.name for one in fields(Scene)} - others
    of_si = {one.name for one in fields(PhysicalData)} - {"layer"}
    assert of_si <= {*SCENE, *SI}
    assert Sphere(1.0).radius == 1.0
