"""Nonlinear layers to any number of digits: the laws, and a contact.

The oracles share no code with it: the laws in doubles, mpmath's derivatives and quadrature, and the
solver in doubles. Contacts with an edge, and flat punches, are in the gold tables (test_gold).
"""

import math

import pytest
from mpmath.ctx_mp import MPContext

from spectral_contact import NotComputedError, Scene, layers, profiles, solve
from spectral_contact.layers import scene_layer
from spectral_contact.precise import reference
from spectral_contact.precise.layer_laws import law_of

BALL = profiles.Parabola(1.0)
TABLE = layers.Table((0.0, 0.2, 0.4, 0.6), (0.0, 0.1, 0.3, 0.6))
POWER, OPEN = layers.PowerLaw(5.0, 1.7), layers.CalculixExponential(0.1, 0.2)
LAWS = [
    layers.Linear(0.3),
    POWER,
    layers.Exponential(0.1, 0.2),
    OPEN,
    layers.GreenwoodWilliamson(9.0, 1.5, 0.5),
    layers.GreenwoodWilliamson(9.0, 1.5, 0.5, "exponential"),
    layers.Sampled.from_functions(
        lambda w: w + w**3, lambda w: 1.0 + 3.0 * w**2, start=0.0, limit=2.0
    ),
]


@pytest.mark.parametrize("layer", LAWS, ids=lambda layer: type(layer).__name__)
def test_laws_with_derivatives_and_integrals(layer):
    mp = MPContext()
    mp.dps = 40
    law = law_of(mp, layer)
    shift = layer.start if layer.start > -math.inf else 0.0
    starts = (0.3, 1.2) if layer.start > -math.inf else (-0.7, 0.3)
    for w in map(mp.mpf, starts):
        assert float(law.pressure(w)) == pytest.approx(layer.pressure(float(w) + shift), rel=3e-15)
        assert mp.almosteq(law.slope(w), mp.diff(law.pressure, w), rel_eps=1e-15)
        between = mp.quad(law.pressure, [w, w + 0.25])
        assert mp.almosteq(law.energy(w + 0.25) - law.energy(w), between, rel_eps=1e-25)


def test_every_kind_of_law_without_bends_is_tried():
    assert {type(law) for law in LAWS} == {*scene_layer.KINDS.values()} - {layers.Table}


def test_the_energy_of_a_small_overclosure_keeps_its_digits():
    mp = MPContext()
    mp.dps = 30
    law, w = law_of(mp, layers.Exponential(0.1, 0.2)), mp.mpf("1e-25")
    # p0 x^2/(e - 1), whose integral is c0 p0 x^3/(3 (e - 1)), and the next term is x/8 of it
    x = w / mp.mpf(0.2)
    leading = mp.mpf(0.2) * mp.mpf(0.1) / (mp.e - 1) * x**3 / 3
    assert abs(law.energy(w) / leading - 1) < x


def test_a_contact_without_edge():
    scene = Scene(0.3, layer=OPEN, profile=BALL, approach=0.05)
    true, double = reference(scene, 15, progress=False), solve(scene, 1e-11)
    assert true.contact_radius is None
    for name in ("load", "stiffness", "indentation_work"):
        off = abs(getattr(double, name) / getattr(true, name) - 1)
        assert off <= getattr(double.error, name) + 1e-15
    mean = double.load / (math.pi * double.domain_radius**2)
    for r in (0.0, 0.3, 0.9):
        p = float(true.pressure(r / true.domain_radius))
        found = double.pressure(r / double.domain_radius)
        assert abs(found - p) <= double.error.pressure * max(p, mean) + 1e-13 * p


def test_what_it_does_not_know_of_layers_is_refused():
    with pytest.raises(NotComputedError, match="without a contact edge"):
        reference(Scene(0.3, layer=OPEN, profile=profiles.Cone(1.2), load=1.0), 15)
    with pytest.raises(NotComputedError, match="bends"):
        reference(Scene(0.3, layer=TABLE, profile=BALL, load=0.01), 15)
    flat = {"layer": POWER, "profile": profiles.Flat(1.0), "load": 1.0}
    with pytest.raises(NotComputedError, match="normal contact alone"):
        reference(Scene(0.3, friction=math.inf, **flat), 15)
