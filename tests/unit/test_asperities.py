"""Greenwood and Williamson's layer: against integrals in mpmath, and its own derivative."""

import mpmath as mp
import pytest

from spectral_contact import Scene, SceneError
from spectral_contact.asperities import greenwood_williamson

STEEL = {
    "density": 1e10,
    "tip_radius": 5e-6,
    "height_deviation": 0.4e-6,
    "youngs_modulus": 200e9,
    "poisson_ratio": 0.3,
}


def heights(power, separation):
    """Return ∫_d^∞ (z − d)^power φ(z) dz with its own quadrature, in the unit of the heights."""
    d, sigma = mp.mpf(separation), mp.mpf(STEEL["height_deviation"])

    def scaled(t):  # by φ(d), or mpmath would take the integral of a far tail for zero
        return t**power * mp.exp(-t * (d + t / 2) / sigma**2) / sigma**power

    ends = [sigma * end for end in (0, 0.1, 0.5, 2, 6, 12, 20, 60)]
    return sigma**power * mp.npdf(d, 0, sigma) * mp.quad(scaled, ends, maxdegree=10)


def pressure_at(separation):
    modulus = STEEL["youngs_modulus"] / (1 - mp.mpf(STEEL["poisson_ratio"]) ** 2)
    scale = mp.mpf(4) / 3 * STEEL["density"] * modulus * mp.sqrt(STEEL["tip_radius"])
    return scale * heights(mp.mpf(3) / 2, separation)


@pytest.mark.parametrize("deviations", [-9.0, -1.0, 0.5, 2.0, 4.0, 12.0])
def test_every_field_is_that_of_the_defining_integrals(deviations):
    with mp.workdps(25):
        separation = deviations * STEEL["height_deviation"]
        pressure = pressure_at(separation)
        layer = greenwood_williamson(**STEEL, pressure=float(pressure))
        assert layer.separation == pytest.approx(separation, rel=1e-13)
        slope = mp.diff(pressure_at, separation, h=mp.mpf("1e-15"))
        assert layer.normal_compliance == pytest.approx(float(-1 / slope), rel=1e-12, abs=0)
        area = mp.pi * STEEL["density"] * STEEL["tip_radius"] * heights(1, separation)
        assert layer.contact_fraction == pytest.approx(float(area), rel=1e-12, abs=0)
        touching = STEEL["density"] * heights(0, separation)
        assert layer.touching_density == pytest.approx(float(touching), rel=1e-12, abs=0)
        assert layer.asperity_pressure * layer.contact_fraction == pytest.approx(
            layer.pressure, rel=1e-14, abs=0
        )
        assert layer.asperity_force * layer.touching_density == pytest.approx(
            layer.pressure, rel=1e-14, abs=0
        )


@pytest.mark.parametrize(
    ("nu", "ratio"), [(0.5, 1.5), (0.0, 1.0), (0.3, 1.7 / 1.4), (-0.5, 2.5 / 3)]
)
def test_tangential_compliance_is_mindlins(nu, ratio):
    layer = greenwood_williamson(**{**STEEL, "poisson_ratio": nu}, pressure=1e7)
    assert layer.tangential_compliance / layer.normal_compliance == pytest.approx(ratio, rel=1e-15)


def test_the_compliance_is_the_slope_of_the_separations():
    layer = greenwood_williamson(**STEEL, pressure=1e7)
    below, above = layer.at(1e7 * (1 - 1e-5)), layer.at(1e7 * (1 + 1e-5))
    slope = (below.separation - above.separation) / 200.0
    assert slope == pytest.approx(layer.normal_compliance, rel=1e-8, abs=0)
    lower, higher = layer.compliance_change(1e-5)
    assert lower == below.normal_compliance / layer.normal_compliance - 1
    assert higher == above.normal_compliance / layer.normal_compliance - 1
    assert higher < 0 < lower


def test_units_do_not_matter():
    """In millimetres and megapascals the same layer has a compliance a billion times as large."""
    metres = greenwood_williamson(**STEEL, pressure=1e7)
    changed = {"density": 1e4, "tip_radius": 5e-3, "height_deviation": 0.4e-3}
    millimetres = greenwood_williamson(
        **changed, youngs_modulus=200e3, poisson_ratio=0.3, pressure=10.0
    )
    ratio = millimetres.normal_compliance / metres.normal_compliance
    assert ratio == pytest.approx(1e9, rel=1e-12)
    assert millimetres.contact_fraction == pytest.approx(metres.contact_fraction, rel=1e-12, abs=0)


def test_remarks_say_what_is_out_of_range():
    assert greenwood_williamson(**STEEL, pressure=1e7).remarks == ()
    assert greenwood_williamson(**STEEL, pressure=1e7, hardness=200e9).remarks == ()
    [yields] = greenwood_williamson(**STEEL, pressure=1e7, hardness=5e9).remarks
    assert yields == "The plasticity index is 12, above 0.6: many asperities yield."
    [far] = greenwood_williamson(**STEEL, pressure=1e3).remarks
    assert far.startswith("The separation is 4.42 σ")
    near, crowded = greenwood_williamson(**STEEL, pressure=1e10).remarks
    assert near.startswith("The separation is -3.24 σ")
    assert crowded.startswith("The contact fraction is 0.2,")


def test_hardness_gives_the_plasticity_index_of_the_paper():
    layer = greenwood_williamson(**STEEL, pressure=1e7, hardness=2e9)
    expected = 200e9 / 0.91 / 2e9 * (0.4 / 5) ** 0.5
    assert layer.plasticity_index == pytest.approx(expected, rel=1e-14)
    assert layer.at(2e7).hardness == 2e9
    assert greenwood_williamson(**STEEL, pressure=1e7).plasticity_index is None


def test_a_scene_takes_the_compliances():
    layer = greenwood_williamson(**STEEL, pressure=1e7)
    scene = Scene.from_physical(
        youngs_modulus=200e9,
        poisson_ratio=0.3,
        radius=1e-3,
        load=1e7 * 3.14159e-6,
        normal_compliance=layer.normal_compliance,
        tangential_compliance=layer.tangential_compliance,
    )
    expected = layer.normal_compliance * 200e9 / (4 * 0.91 * 1e-3)
    assert scene.normal_compliance == pytest.approx(expected, rel=1e-14, abs=0)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("density", 0.0),
        ("tip_radius", -1e-6),
        ("height_deviation", float("nan")),
        ("youngs_modulus", float("inf")),
        ("poisson_ratio", 0.6),
        ("pressure", "10 MN"),
        ("pressure", 1e-90),
        ("pressure", 1e12),
        ("hardness", 0.0),
        ("hardness", True),
    ],
)
def test_bad_input_is_refused_by_name(name, value):
    with pytest.raises(SceneError) as caught:
        greenwood_williamson(**{**STEEL, "pressure": 1e7, name: value})
    assert caught.value.parameter == name


def test_inputs_without_a_representable_layer_are_refused():
    with pytest.raises(SceneError, match="πηRσ"):
        greenwood_williamson(**{**STEEL, "density": 1e300}, pressure=1e7)


@pytest.mark.parametrize("share", [0.0, 1.0, -0.1, float("nan")])
def test_shares_are_between_none_and_all(share):
    with pytest.raises(SceneError, match="share"):
        greenwood_williamson(**STEEL, pressure=1e7).compliance_change(share)
