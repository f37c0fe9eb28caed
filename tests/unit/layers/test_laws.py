"""Laws of layers: values against mpmath, their derivatives and integrals, and bad input."""

import math
import pickle
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from spectral_contact import Scene, SceneError, layers, profiles
from spectral_contact.io.parameters import parameters_of
from spectral_contact.layers import scene_layer

TABLE = layers.Table((0.0, 0.1, 0.3, 0.7, 1.5), (0.0, 0.1, 0.5, 2.0, 9.0))
CUBIC = layers.Sampled.from_functions(
    lambda w: w**3 + w, lambda w: 3.0 * w**2 + 1.0, start=0.0, limit=2.0
)
LAWS = {
    "linear": layers.Linear(0.3),
    "power": layers.PowerLaw(2.0, 2.5),
    "abaqus": layers.Exponential(0.1, 0.2),
    "calculix": layers.CalculixExponential(0.1, 0.2),
    "gaussian": layers.GreenwoodWilliamson(3.0, 0.1, 0.2),
    "exponential heights": layers.GreenwoodWilliamson(3.0, 0.1, 0.2, "exponential"),
    "table": TABLE,
    "sampled": CUBIC,
}


@pytest.mark.parametrize("name", LAWS)
def test_stiffness_is_the_derivative_and_energy_the_integral(name):
    law = LAWS[name]
    start = law.start if math.isfinite(law.start) else -0.9
    w, step = np.linspace(start + 0.01, 1.4, 200), 1e-5
    rise = (law._pressure(w + step) - law._pressure(w - step)) / (2.0 * step)
    np.testing.assert_allclose(rise, law.stiffness(w), rtol=1e-6)
    rise = (law._energy(w + step) - law._energy(w - step)) / (2.0 * step)
    np.testing.assert_allclose(rise, law.pressure(w), rtol=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_rates_are_derivatives_by_the_logarithms_of_all_numbers(name):
    """Fits find the numbers that have one."""
    law, w, step = LAWS[name], np.linspace(-0.15, 1.4, 50), 1e-5
    numbers = [one for one, told in parameters_of(type(law)).items() if told.kind is float]
    rates = law._rates(w)
    assert sorted(rates) == sorted(numbers)
    for one in numbers:
        low, high = (replace(law, **{one: getattr(law, one) * (1 + d)}) for d in (-step, step))
        differences = (high._pressure(w) - low._pressure(w)) / (2.0 * step)
        np.testing.assert_allclose(rates[one], differences, rtol=1e-6, atol=1e-9)


def test_every_kind_of_law_is_tried():
    assert {type(law) for law in LAWS.values()} == {*scene_layer.KINDS.values()}


def test_a_linear_layer_is_stiff_from_the_first_touch_on():
    law = layers.Linear(0.25)
    assert law.stiffness([-1.0, -1e-300, 0.0, 1e-300, 1.0]).tolist() == [0.0, 0.0, 4.0, 4.0, 4.0]
    assert law.pressure([-1.0, 0.0, 1.0]).tolist() == [0.0, 0.0, 4.0]


@pytest.mark.parametrize("name", LAWS)
def test_overclosure_is_the_inverse(name):
    law = LAWS[name]
    for pressure in (1e-6, 0.37, 2.0):
        assert law.pressure(law.overclosure(pressure)) == pytest.approx(pressure, rel=1e-12)


def test_abaqus_law_has_the_pressures_that_its_manual_names():
    law = layers.Exponential(0.1, 0.2)
    assert law.pressure(0.0) == pytest.approx(0.1, rel=1e-15)
    assert law.pressure([-0.2, -0.3]).tolist() == [0.0, 0.0]
    x = mpmath.mpf(1) + mpmath.mpf("0.07") / mpmath.mpf("0.2")
    exact = mpmath.mpf("0.1") / (mpmath.e - 1) * x * (mpmath.e**x - 1)
    assert law.pressure(0.07) == pytest.approx(float(exact), rel=1e-14)


def test_calculix_law_has_a_hundredth_left_at_its_clearance():
    law = layers.CalculixExponential(0.1, 0.2)
    assert law.pressure(0.0) == 0.1
    assert law.pressure(-0.2) == pytest.approx(1e-3, rel=1e-14)


@pytest.mark.parametrize("separation", [-40.0, -7.0, -0.3, 0.0, 1.7, 8.0])
@pytest.mark.parametrize("heights", ["gaussian", "exponential"])
def test_asperities_carry_the_integral_over_their_heights(heights, separation):
    law = layers.GreenwoodWilliamson(3.0, 0.1, 0.2, heights)
    d = mpmath.mpf(separation)
    if heights == "gaussian":
        share = mpmath.npdf
        places = [d + k for k in (0, 1, 3, 6)] + [k for k in (-9, -6, -2, 0, 2, 6, 20) if k > d]
    else:
        share = lambda z: mpmath.exp(-z)  # noqa: E731
        places = [max(d, 0) + k for k in (0, 1, 5, 20, 60)]
    places = sorted(set(places))
    carried = mpmath.quad(lambda z: (z - d) ** mpmath.mpf(1.5) * share(z), places)
    exact = mpmath.mpf(16) / 3 * 3 * mpmath.sqrt("0.1") * mpmath.mpf("0.2") ** 1.5 * carried
    assert law.pressure(-0.2 * separation) == pytest.approx(float(exact), rel=2e-12)


def test_a_straight_table_is_a_linear_layer():
    law, w = layers.Table((0, 1, 2, 3), (0, 2, 4, 6)), np.linspace(0.0, 3.0, 50)
    np.testing.assert_allclose(law.pressure(w), layers.Linear(0.5).pressure(w), atol=1e-14)


def test_laws_are_values():
    for law in LAWS.values():
        twin = pickle.loads(pickle.dumps(law))
        assert twin == law
        assert hash(twin) == hash(law)


BAD = {
    "negative": lambda: layers.Linear(-1.0),
    "softening": lambda: layers.PowerLaw(1.0, 0.5),
    "no clearance": lambda: layers.Exponential(1.0, 0.0),
    "text": lambda: layers.CalculixExponential("1", 1.0),
    "heights": lambda: layers.GreenwoodWilliamson(1.0, 1.0, 1.0, "gausian"),
    "three points": lambda: layers.Table((0, 1, 2), (0, 1, 2)),
    "out of order": lambda: layers.Table((0, 2, 1, 3), (0, 1, 2, 3)),
    "falling": lambda: layers.Table((0, 1, 2, 3), (0, 1, 0.5, 3)),
    "not from zero": lambda: layers.Table((0, 1, 2, 3), (1, 2, 3, 4)),
    "lengths": lambda: layers.Table((0, 1, 2, 3), (0, 1, 2)),
    "not monotone": lambda: layers.Sampled.from_functions(
        lambda w: np.sin(3.0 * w), lambda w: 3.0 * np.cos(3.0 * w), start=0.0, limit=2.0
    ),
    "wrong derivative": lambda: layers.Sampled.from_functions(
        lambda w: w**2, lambda w: w, start=0.0, limit=2.0
    ),
    "kinked": lambda: layers.Sampled.from_functions(
        lambda w: np.maximum(w, 2.0 * w - 1.0), lambda w: 1.0 + (w > 1), start=0.0, limit=2.2
    ),
    "jump": lambda: layers.Sampled((0.0, 1.0, 2.0), ((0.5, 0.5), (2.5, 0.5))),
    "beyond the end": lambda: TABLE.pressure(1.6),
    "no pressure": lambda: TABLE.overclosure(10.0),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_laws_are_refused(case):
    with pytest.raises(SceneError):
        BAD[case]()


BALL, POWER = profiles.Parabola(1.0), layers.PowerLaw(5.0, 2.0)
OPEN = layers.CalculixExponential(0.1, 0.2)
SCENES = {
    "normal_compliance": {"normal_compliance": 0.1, "load": 1.0},
    "tangential_compliance": {"tangential_compliance": 0.1, "load": 1.0},
    "friction": {"friction": 0.2, "load": 1.0},
    "profile": {"profile": None, "load": 1.0},
    "contact_radius": {"layer": OPEN, "contact_radius": 1.0},
    "approach": {"approach": -0.1},
    "layer": {"layer": "linear", "load": 1.0},
    "separation": {"separation": 0.1},
    "contact_radius, load, approach, separation": {},
}


@pytest.mark.parametrize("name", SCENES)
def test_scenes_say_what_is_wrong_with_a_layer(name):
    given = {"layer": POWER, "profile": BALL, **SCENES[name]}
    with pytest.raises(SceneError) as caught:
        Scene(0.3, **given)
    assert caught.value.parameter == name


@pytest.mark.parametrize("separation", [1e9, math.nan, "0.1"])
def test_a_separation_without_pressure_is_refused(separation):
    rough = layers.GreenwoodWilliamson(10.0, 1.0, 0.1)
    with pytest.raises(SceneError, match="separation = "):
        Scene(0.3, layer=rough, profile=BALL, separation=separation)
    with pytest.raises(SceneError, match=r"separation = 0\.1: must be None: only a layer"):
        Scene(0.3, profile=BALL, separation=0.1)


def test_friction_is_refused_with_the_reason():
    for friction in (0.1, math.inf):
        with pytest.raises(SceneError, match="superposition"):
            Scene(0.3, friction=friction, layer=POWER, profile=BALL, load=1.0)
    flat = {"layer": POWER, "profile": profiles.Flat(1.0), "load": 1.0}
    with pytest.raises(SceneError, match="slip depends on how"):
        Scene(0.3, friction=0.1, **flat)
    with pytest.raises(SceneError, match="coupling"):
        Scene(0.3, friction=math.inf, coupling=True, **flat)
    with pytest.raises(SceneError, match="no friction"):
        Scene(0.3, tangential_compliance=0.1, **flat)


def test_a_flat_profile_has_no_friction_on_a_linear_layer_and_no_edge_that_moves():
    with pytest.raises(SceneError, match="units"):
        Scene(0.3, profile=profiles.Flat(1.0), load=1.0, friction=0.1)
    with pytest.raises(SceneError, match="edge"):
        Scene(0.3, layer=POWER, profile=profiles.Flat(1.0), contact_radius=0.5)


@pytest.mark.parametrize("name", LAWS)
def test_scenes_with_layers_go_through_documents(name):
    scene = Scene(0.3, layer=LAWS[name], profile=BALL, load=0.5)
    assert Scene.from_json(scene.to_json()) == scene
    assert LAWS[name].brief in repr(scene)


def test_a_layer_of_a_document_is_checked():
    tree = Scene(0.3, layer=POWER, profile=BALL, load=0.5).to_dict()
    for wrong in ({"PowerLaw": {"coefficient": 1.0}}, {"Power": {}}, [], {"PowerLaw": 3}):
        with pytest.raises(SceneError, match="layer"):
            Scene.from_dict({**tree, "layer": wrong})


@pytest.mark.parametrize("name", ["abaqus", "calculix"])
def test_a_pressure_that_a_law_never_reaches_is_refused(name):
    with pytest.raises(SceneError, match=r"pressure = 1e\+308: must be one that the law reaches"):
        LAWS[name].overclosure(1e308)


@pytest.mark.parametrize("name", ["gaussian", "exponential heights"])
def test_pressures_beyond_the_doubles_are_infinite(name):
    assert LAWS[name].pressure(1e308) == math.inf
    assert LAWS[name].pressure(1e80) == pytest.approx(
        16.0 / 3.0 * 3.0 * math.sqrt(0.1) * 1e120, rel=1e-14
    )


def test_the_ends_of_a_sampled_law_are_numbers():
    def made(**ends):
        return layers.Sampled.from_functions(lambda w: w, np.ones_like, **ends)

    with pytest.raises(SceneError, match=r"^start = "):
        made(start=np.array(0.0), limit=1.0)
    with pytest.raises(SceneError, match=r"^limit = "):
        made(start=0.0, limit=np.array(1.0))


@pytest.mark.parametrize(
    ("rate", "limit", "knots"), [(5.0, 10.0, (1.0,)), (2.0, 1.0, ()), (1.0, 1.0, (0.1,))]
)
def test_the_errors_of_sampled_laws_are_bounds(rate, limit, knots):
    """Pieces before a steep one were fitted to a part of the largest pressure of all."""
    law = layers.Sampled.from_functions(
        lambda w: np.expm1(rate * w),
        lambda w: rate * np.exp(rate * w),
        start=0.0,
        limit=limit,
        knots=knots,
    )
    w = np.linspace(0.01, 0.9, 90)
    errors, deepest = law._errors(0.9), rate * np.exp(rate * 0.9)
    assert np.abs(law.pressure(w) - np.expm1(rate * w)).max() < errors.pressure < 1e-11
    off = np.abs(law.stiffness(w) - rate * np.exp(rate * w)).max() / deepest
    assert off < errors.stiffness < 1e-10


def test_the_derivative_of_a_law_next_to_a_pole_has_the_error_that_is_stated():
    law = layers.Sampled.from_functions(
        lambda w: -np.log1p(-w / 1.05), lambda w: 1.0 / (1.05 - w), start=0.0, limit=1.0
    )
    w = np.linspace(0.0, 1.0, 1001)
    off = np.abs(law.stiffness(w) * (1.05 - w[-1]) - (1.05 - w[-1]) / (1.05 - w)).max()
    assert off < law._errors(1.0).stiffness < 1e-9
