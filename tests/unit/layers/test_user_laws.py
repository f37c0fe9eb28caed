"""Laws that users write: solved like the library's, held to what they declare, and not stored."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
import pytest
from oracles.bent_collocation import Law, solved
from oracles.user_laws import Ending, Hardening, Softplus, TwoStages

import spectral_contact as sc
from spectral_contact import NotComputedError, Scene, SceneError, layers, profiles, solve


@dataclass(frozen=True)
class Quadratic(layers.Layer):
    """``c w²``: `PowerLaw` once more."""

    c: float

    @property
    def _size(self):
        return 1.0

    def _over(self, unit):
        return replace(self, c=self.c / unit)

    def _pressure(self, w):
        return self.c * np.maximum(w, 0.0) ** 2

    def _slope(self, w):
        return 2.0 * self.c * np.maximum(w, 0.0)

    def _energy(self, w):
        return self.c * np.maximum(w, 0.0) ** 3 / 3.0


def pressed(law, **more):
    return Scene(0.3, layer=law, profile=profiles.Parabola(1.0), load=0.5, **more)


def test_the_same_law_has_the_same_digits():
    own, known = (solve(pressed(law), 1e-10) for law in (Quadratic(5.0), layers.PowerLaw(5.0, 2.0)))
    assert own.converged
    assert own.approach == pytest.approx(known.approach, rel=1e-13)
    assert own.pressure(0.3) == pytest.approx(known.pressure(0.3), rel=1e-12)


@pytest.mark.parametrize(
    ("law", "known"),
    [
        (TwoStages(2.0, 0.1, 0.0), layers.Linear(0.05)),  # a knot where nothing bends
        (TwoStages(2.0, 0.1, 3.0), None),
        (Softplus(2.0, 0.1), None),
        (Hardening(2.0, 0.1, -0.02), None),
    ],
    ids=lambda one: type(one).__name__,
)
def test_laws_with_knots_without_a_start_and_with_another(law, known):
    """Against a coarser tolerance, the balance of work, and a linear layer."""
    scene = pressed(law)
    fine, coarse = solve(scene, 1e-9), solve(scene, 1e-5)
    assert fine.converged
    # without a start the error is relative to the displacement, if that exceeds the approach
    size = max(abs(fine.approach), fine.approach - law.overclosure(fine.pressure(0.0)))
    off = abs(coarse.approach - fine.approach)
    assert off <= (coarse.error.approach + fine.error.approach) * size
    step = 1e-4
    work = [
        solve(pressed(law).replace(load=0.5 * f), 1e-11, ("indentation_work", "approach"))
        for f in (1 - step, 1 + step)
    ]
    rise = work[1].indentation_work - work[0].indentation_work
    assert rise == pytest.approx(0.5 * (work[1].approach - work[0].approach), rel=1e-6)
    if known is not None:
        linear = solve(pressed(known), 1e-9)
        assert fine.approach == pytest.approx(linear.approach, rel=1e-8)


@pytest.mark.parametrize("profile", [profiles.Parabola(1.0), profiles.Flat(1.0)])
@pytest.mark.parametrize("load", [0.1, 1e-60])
def test_a_law_with_a_limit_and_without_a_start_is_solved_under_a_load(profile, load):
    ending, known = Ending(1.0, 0.1, 0.5), layers.CalculixExponential(1.0, 0.1 * np.log(100.0))
    found, same = (
        solve(Scene(0.3, layer=law, profile=profile, load=load), 1e-9) for law in (ending, known)
    )
    assert found.approach == pytest.approx(same.approach, rel=1e-12)


def test_a_law_with_a_knot_inside_the_contact_is_that_of_a_collocation():
    """Which shares no code with the library, and finds the radius of the knot itself."""
    law, radius = TwoStages(0.12, 0.17, 0.4), 1.3
    truth = solved(
        Law(law._pressure, law._slope, law._energy, law.knots),
        lambda r: r**2 / 2.0,
        radius,
        start=0.0,
    )
    scene = Scene(0.3, layer=law, profile=profiles.Parabola(1.0), contact_radius=radius)
    found = solve(scene, 1e-9, ("approach", "load", "stiffness"))
    assert len(truth.bends) == 1
    for name in ("approach", "load", "stiffness"):
        error = abs(getattr(found, name) / getattr(truth, name) - 1.0)
        assert error < 1e-9
        assert error <= getattr(found.error, name) + truth.error[name] + 5e-14


def test_they_are_converted_to_si_units_and_swept():
    body = {"youngs_modulus": 1e9, "poisson_ratio": 0.3, "profile": profiles.Parabola(1e-3)}
    own, known = (
        solve(Scene.from_physical(**body, layer=law, load=1.0), 1e-9).physical.approach
        for law in (Quadratic(1e21), layers.PowerLaw(1e21, 2.0))
    )
    assert own == pytest.approx(known, rel=1e-12)


def test_files_certificates_and_friction_refuse_them(tmp_path):
    scene = pressed(Quadratic(5.0))
    with pytest.raises(SceneError, match=r"layer = .*: must be one of layers: .* in a file"):
        scene.to_json()
    with pytest.raises((SceneError, sc.SolutionFileError), match="layer"):
        solve(scene, 1e-6).save(tmp_path / "solution.json")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(NotComputedError, match="laws that users write"):
        sc.reference(scene, 15)
    pytest.importorskip("xarray")
    with pytest.raises(SceneError, match=r"store = .*: must be None with a layer"):
        sc.sweep(scene, load=[0.1, 0.2], store=tmp_path / "store")
    found = sc.sweep(scene, load=[0.1, 0.5], quantities=["approach"])
    assert found.approach.values[1] == pytest.approx(solve(scene).approach, rel=1e-7)
    with pytest.raises(SceneError, match="friction = inf"):
        Scene(0.3, layer=Quadratic(5.0), profile=profiles.Flat(1.0), load=0.5, friction=inf)


def broken(**members):
    """Return the law with other members."""
    return type("Broken", (Quadratic,), members)(5.0)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (broken(_slope=lambda self, w: 2.1 * self.c * np.maximum(w, 0.0)), "_slope is the deriv"),
        (broken(_energy=lambda self, w: self.c * np.maximum(w, 0.0) ** 3), "_energy is the integ"),
        (broken(_pressure=lambda self, w: self.c * np.abs(w)), "without pressure below its start"),
        (broken(_pressure=lambda self, w: self.c * np.sin(w)), "pressure rises"),
        (broken(_pressure=lambda self, w: 3.0), "takes and returns arrays"),
        (broken(_over=lambda self, unit: self), "half its pressures"),
        (broken(_over=lambda self, unit: layers.PowerLaw(1.0, 2.0)), "_over returns"),
        (broken(_size=0.0), "_size"),
        (broken(knots=(2.0, 1.0)), "knots that rise"),
        (broken(limit=-1.0), "start < limit"),
        (broken(_pressure=lambda self, w: 1 / 0), "can be evaluated"),
        (broken(__hash__=None), "can be evaluated"),
    ],
    ids=lambda one: one if isinstance(one, str) else "",
)
def test_a_law_that_is_not_what_it_declares_is_refused(law, message):
    with pytest.raises(SceneError, match=f"layer = .*{message}"):
        pressed(law)


def test_what_is_no_layer_is_refused():
    with pytest.raises(SceneError, match=r"or of a subclass of layers\.Layer"):
        pressed("soft")
