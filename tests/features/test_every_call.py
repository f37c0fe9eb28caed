"""What is asked of a solution works for every kind of scene, or is refused by name.

Parts that were written apart met here: scenes of all kinds, and all that a solution can do.
"""

import math

import pytest

import spectral_contact as sc
from spectral_contact import (
    Scene,
    Solution,
    SpectralContactError,
    layers,
    plotting,
    profiles,
    solve,
)
from spectral_contact.view.explorer.state import texts_of

pytest.importorskip("matplotlib", reason="part of the extra: plot")
pytest.importorskip("xarray", reason="part of the extra: sweep")

STEEL = {"youngs_modulus": 70e9, "poisson_ratio": 0.2}
LAYER = {"normal_compliance": 2e-18, "tangential_compliance": 2e-18}
BALL = profiles.Parabola(1.0)
SCENES = {
    "smooth": Scene(0.3),
    "slip inside": Scene(0.3, 0.05, 1.0, 0.23 / 7),
    "coupled": Scene(0.3, 0.5, 0.5, 0.1, coupling=True),
    "SI": Scene.from_physical(**STEEL, radius=1e-6, load=1e-3, friction=0.1, **LAYER),
    "SI, approach": Scene.from_physical(**STEEL, radius=1e-6, approach=1e-8, **LAYER),
    "ball, sticking": Scene(0.3, 0.2, 0.2, math.inf, profile=BALL, contact_radius=1.0),
    "ball, coupled": Scene(
        0.3, 0.2, 0.2, math.inf, profile=BALL, contact_radius=1.0, coupling=True
    ),
    "smooth cone": Scene(0.3, profile=profiles.Cone(1.0), load=1.0),
    "smooth corner": Scene(0.3, profile=profiles.TruncatedCone(0.5, 1.0), load=3.0),
    "ball in SI": Scene.from_physical(
        **STEEL, profile=profiles.Parabola(1e-5), load=5e-3, normal_compliance=2e-18
    ),
    "power layer": Scene(0.3, layer=layers.PowerLaw(5.0, 2.0), profile=BALL, contact_radius=1.0),
    "rough spheres": Scene(
        0.3, layer=layers.GreenwoodWilliamson(9.0, 1.0, 0.5), profile=BALL, approach=0.5
    ),
    "flat on a layer": Scene(
        0.3, layer=layers.CalculixExponential(0.1, 0.2), profile=profiles.Flat(2.0), load=1.0
    ),
    "layer in SI": Scene.from_physical(
        **STEEL,
        layer=layers.Exponential(1e8, 1e-7),
        profile=profiles.Parabola(1e-5),
        approach=-1e-8,
    ),
    "flat, sticking on a layer": Scene(
        *(0.3, 0.0, 0.2, math.inf),
        layer=layers.PowerLaw(5.0, 2.0),
        profile=profiles.Flat(2.0),
        approach=0.5,
    ),
}


def kept(solution, folder, suffix):
    solution.save(folder / f"a{suffix}")
    assert Solution.load(folder / f"a{suffix}").scene == solution.scene


def shown(figure):
    figure.draw_without_rendering()


def own(solution):
    """The solution in its scene's units."""
    return solution.physical if solution.scene.physical is not None else solution


def points(solution):
    scale = own(solution).inside.radius
    return [0.0, 0.5 * scale, 2.0 * scale], [0.5 * scale, 0.1 * scale, scale]


CALLS = {
    "summary": lambda x, _: x.summary(),
    "plot": lambda x, _: shown(x.plot()),
    "to_csv": lambda x, folder: x.to_csv(folder / "a.csv"),
    "to_xarray": lambda x, _: x.to_xarray(),
    "tables": lambda x, _: (x._repr_html_(), x.scene._repr_html_(), x.plan._repr_html_()),
    "json": lambda x, folder: kept(x, folder, ".json"),
    "npz": lambda x, folder: kept(x, folder, ".npz"),
    "inside": lambda x, _: own(x).inside.to_table(*points(x)),
    "inside, dataset": lambda x, _: own(x).inside.to_xarray(*points(x)),
    "inside, picture": lambda x, _: shown(plotting.plot_inside(own(x).inside)),
    "largest": lambda x, _: own(x).inside.largest("von_mises"),
    "energies": lambda x, _: own(x).inside.energies(),
    "compare": lambda x, _: sc.compare(x.scene, pressure=own(x).pressure, truth=x),
    "gold": lambda x, _: sc.gold.find(x.scene),
    "numbers": lambda x, _: [getattr(own(x), n) for n in ("approach", "total_shear", "zones")],
    "indentation": lambda x, _: (x.stiffness, x.indentation_work, x.gap(s=[1.0, 2.0])),
    "sweep": lambda x, _: sc.sweep([x.scene], rtol=1e-3),
}
#: What takes a second is tried where kinds differ.
SLOW = {"inside, picture", "energies", "largest"}
SLOWLY = {"ball, coupled", "coupled", "SI", "smooth corner", "ball in SI", "power layer"}
#: What is refused: everything else is done.
FLAT_HAVE_NONE = {"indentation"}
NOT_UNDER_LAYERS = {
    *("inside", "inside, dataset", "inside, picture", "largest", "energies"),
}
REFUSED = {
    **dict.fromkeys(("smooth", "slip inside", "SI", "SI, approach"), FLAT_HAVE_NONE),
    "coupled": FLAT_HAVE_NONE,
    "ball, sticking": {"energies"},
    "ball, coupled": {"energies"},
    "power layer": NOT_UNDER_LAYERS,
    "rough spheres": NOT_UNDER_LAYERS | {"indentation", "compare"},  # there is no edge
    "flat on a layer": NOT_UNDER_LAYERS | {"indentation"},
    "layer in SI": NOT_UNDER_LAYERS,
    "flat, sticking on a layer": NOT_UNDER_LAYERS | {"indentation"},
}


@pytest.mark.parametrize("name", SCENES)
def test_every_call_does_its_work_or_is_refused(name, tmp_path):
    scene = SCENES[name]
    solution = solve(scene, 1e-3 if scene.friction and scene.profile else 1e-6)
    refused = set()
    for call, use in CALLS.items():
        if call in SLOW and name not in SLOWLY:
            continue
        try:
            use(solution, tmp_path)
        except SpectralContactError:
            refused.add(call)
    expected = REFUSED.get(name, set())
    assert refused == (expected if name in SLOWLY else expected - SLOW)


@pytest.mark.parametrize("name", ["power layer", "rough spheres", "flat on a layer"])
def test_what_knows_linear_layers_only_says_so(name):
    scene = SCENES[name]
    solution = solve(scene, 1e-6)
    measured = sc.calibration.ApproachData([0.1, 0.2], 0.01)
    calls = (
        lambda: sc.studies.sensitivity(solution),
        lambda: texts_of(scene),
        lambda: sc.fit(scene, measured, "normal_compliance"),
        lambda: solution.inside,
    )
    for call in calls:
        with pytest.raises(SpectralContactError, match=r"layer|profile"):
            call()
