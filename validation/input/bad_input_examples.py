"""Good arguments and instances for the callables that bad_input_callables.py calls.

Arguments are found by the parameter's name; those that mean different things in different places,
by the callable's, too. A callable whose parameter is not here gets None for it. Numbers, texts and
lists of them are in good_arguments.toml.
"""

from __future__ import annotations

import inspect
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from spectral_contact import Scene, Solution, calibration, layers, profiles, solve
from spectral_contact.asperities import greenwood_williamson
from spectral_contact.calibration.setting import Setting
from spectral_contact.closed_forms import SmoothContact
from spectral_contact.fields.series import Radius
from spectral_contact.precise import reference
from spectral_contact.studies import OwnSolver, convergence, fit_rate, truth_of, work_precision
from spectral_contact.sweeps import sweep
from spectral_contact.sweeps.steady_cycle import steady_cycle
from spectral_contact.view.plotting import graded_radii

GOOD = tomllib.loads(Path(__file__).with_name("good_arguments.toml").read_text(encoding="utf-8"))
SCENE = Scene(0.1, 0.5, 0.5, 0.1)
NORMAL = Scene(0.1, 0.5)
STICKY = Scene(0.1, 0.5, profile=profiles.Parabola(1.0), load=0.0, work_of_adhesion=0.1)


def one(*_: object, **__: object) -> float:
    """Return a field, or a solver's quantity."""
    return 1.0


class Quarter:
    """A solution of some solver."""

    approach = 0.25


def solver(scene: Scene, resolution: float) -> Quarter:
    """Return a solution; it is timed in this process, as no other can import it."""
    return Quarter()


solver.__qualname__ = "examples.<locals>.solver"

#: A measured surface, of 20 by 20 points.
HEIGHTS = np.add.outer(np.sin(np.arange(20.0)), np.cos(np.arange(20.0)))
#: A fit, made up.
CURVE_FIT = calibration.IndentationFit(
    *(SCENE, ("zero_point",), (0.0,), (0.1,), ((0.01,),), (0.0,), 1),
    calibration.IndentationData([1.0], [1.0], 1.0),
)
#: By name of a parameter.
ARGUMENTS: dict[str, Any] = {
    **GOOD["asperities"],
    **GOOD["arguments"],
    **{"scene": SCENE, "scenes": SCENE, "text": SCENE.to_json(), "data": SCENE.to_dict()},
    **{"solver": solver, "solvers": {"a": solver}, "truth": Quarter()},
    **{"field": one, "traction": one, "derivative": one, "height": lambda r: r**2},
    **{"inner": Radius(0.5, 0.5), "outer": Radius(0.75, 0.25), "layer": {}, "material": None},
    **{"first": profiles.Cone(1.0), "second": profiles.Parabola(1.0)},
    **{"fitted": CURVE_FIT, "contact": SmoothContact(0.5, 1.0)},
}
#: By name of the callable's parameter, where the name alone does not say it.
SPECIAL: dict[str, Any] = {
    **GOOD["special"],
    "adhesion_cycle.scene": STICKY,
    "pull_off.scene": STICKY,
    "asperities.from_height_map.heights": HEIGHTS,
    "asperities.from_profile.heights": HEIGHTS[0],
    "calibration.oliver_pharr.depth": None,
    "layers.Sampled.from_functions.pressure": lambda w: w,
    "layers.Sampled.from_functions.derivative": np.ones_like,
    "calibration.fit.data": calibration.ApproachData([0.3], sigma=0.1),
    "calibration.compare_laws.candidates": dict.fromkeys("ab", (SCENE, "zero_point")),
    "calibration.compare_laws.data": calibration.IndentationData([1, 2, 3], [1, 2, 3], 1.0),
    "profiles.Sampled.from_functions.slope": lambda r: 2.0 * r,
    "view.plotting.Radii.evaluate.field": one,
    **dict.fromkeys(("studies.WorkPrecision.of.scene", "sweeps.sweep.scenes"), NORMAL),
    "studies.WorkPrecision.reached.scene": NORMAL,
    "testing.load.pressure": one,
    "testing.normal_displacement.pressure": one,
    "testing.tangential_displacement.pressure": one,
}
BODY = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3}
TWO_BODIES = {
    **{**BODY, "punch_youngs_modulus": 2.1e11, "punch_poisson_ratio": 0.3},
    **{"load": 1.0, "profile": profiles.Parabola(0.01)},
}
#: What goes along with a parameter, so that it is looked at, or the work is short.
COMPANY: dict[str, dict[str, Any]] = {
    **GOOD["company"],
    "calibration.AreaFunction.coefficients": {"table": None},
    "calibration.oliver_pharr.depth": {"area": calibration.AreaFunction([1.0])},
    "PhysicalData.reduced_modulus": {"youngs_modulus": None, "load": 1.0, "radius": 1e-3},
    **{
        f"Scene.from_physical.{name}": TWO_BODIES
        for name in ("punch_youngs_modulus", "punch_poisson_ratio", "punch_profile")
    },
    "studies.compare": {"approach": 0.3, "truth": Quarter(), "scene": NORMAL},
    **{f"studies.compare.{name}": {"pressure": one} for name in ("s", "from_edge", "r")},
    "studies.compare.displacement": {"r": [0.5], "truth": None},
    "studies.convergence": {"repeats": 0, "truth": Quarter(), "scene": NORMAL},
    "studies.work_precision": {"repeats": 1, "truths": [Quarter()], "scenes": NORMAL},
    "studies.truth_of": {"truth": Quarter(), "scene": NORMAL},
}


class Examples:
    """Good arguments, and an instance of every class that has public methods.

    The file of a law that one of them reads is written into the current folder.

    Parameters
    ----------
    solutions : tuple of Solution
        To be evaluated.
    """

    def __init__(self, solutions: tuple[Solution, ...]) -> None:
        from matplotlib.figure import Figure

        law = GOOD["special"]["layers.Table.from_file.path"]
        Path(law).write_text("overclosure\tpressure\n0\t0\n0.1\t0.5\n0.2\t2\n", encoding="ascii")
        [si, *_] = [one.scene.physical for one in solutions if one.scene.physical]
        own = convergence(solver, NORMAL, [1, 2], Quarter(), repeats=0)
        compared = work_precision({"a": solver}, NORMAL, [0.5], [Quarter()], repeats=1)
        data = calibration.ApproachData([0.3], sigma=0.1)
        rate = fit_rate([10, 20, 40], [1e-2, 2.6e-3, 6e-4])
        self._instances = [
            *solutions,
            *(one.physical for one in solutions if one.scene.physical is not None),
            *(profiles.Parabola(1.0), profiles.Sampled((0.0, 1.0), ((0.5, 0.5),))),
            *(layers.PowerLaw(1.0, 1.5), layers.Sampled((0.0, 1.0), ((0.5, 0.5),))),
            *(SCENE, si, own, own.points[0], own.points, rate),
            *(compared, OwnSolver(), truth_of(NORMAL)),
            *(graded_radii(solutions[0], 20), reference(Scene(0.1), 15)),
            *(data, calibration.PressureData([0.5], [0.3], sigma=0.1)),
            calibration.StickRadiusData([0.5], sigma=0.1),
            *(CURVE_FIT, calibration.AreaFunction([1.0])),
            greenwood_williamson(**GOOD["asperities"]),
            steady_cycle(Scene(0.1, 0.5, 0.5, 0.1), 0.1, rtol=1e-3),
            calibration.fit(NORMAL, data, "normal_compliance", rtol=1e-4),
        ]
        self._instances += [self._instances[-1].parameters[0]]
        self._arguments = {
            **ARGUMENTS,
            "solution": solutions[0],
            "solved": solutions[0],
            "body": solutions[0].inside,
            "plan": solutions[0].plan,
            "figure": Figure(),
            "setting": Setting.of(SCENE, 1e-3, solve),
            "layer": {"normal_compliance": 0.5, "tangential_compliance": 0.5, "friction": 0.1},
        }
        self._special = {
            **SPECIAL,
            "Solution.from_json.text": solutions[0].to_json(),
            "sweeps.plot_slice.dataset": sweep(
                NORMAL, friction=[0.1, 0.2], quantities=["approach"]
            ),
        }

    def instance(self, cls: type) -> Any:
        """Return an instance of a class."""
        found = [one for one in self._instances if isinstance(one, cls)]
        if not found:
            found = [self._made(cls)]
        return found[0]

    def _made(self, cls: type) -> Any:
        parameters = list(inspect.signature(cls).parameters.values())
        return cls(**self.arguments(cls.__name__, parameters))

    def arguments(self, name: str, parameters: list[inspect.Parameter]) -> dict[str, Any]:
        """Return what a callable must be given."""
        return {
            one.name: self._special.get(f"{name}.{one.name}", self._arguments.get(one.name))
            for one in parameters
            if one.default is one.empty and one.kind is not one.VAR_POSITIONAL
        }

    def company(self, name: str, parameter: str) -> dict[str, Any]:
        """Return what else a callable is given while one parameter is looked at."""
        return COMPANY.get(f"{name}.{parameter}", COMPANY.get(name, {}))
