"""Good arguments and instances for the callables that bad_input_callables.py calls.

Arguments are found by the parameter's name; those that mean different things in different places,
by the callable's, too. A callable whose parameter is not here gets None for it.
"""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
from bad_input_cases import Bench

from spectral_contact import Scene, SpectralContactError, calibration, layers, profiles, solve
from spectral_contact.asperities import greenwood_williamson
from spectral_contact.calibration.setting import Setting
from spectral_contact.closed_forms import SmoothContact
from spectral_contact.fields.series import Radius
from spectral_contact.precise import reference
from spectral_contact.studies import OwnSolver, convergence, fit_rate, truth_of, work_precision
from spectral_contact.sweeps import sweep
from spectral_contact.sweeps.steady_cycle import steady_cycle
from spectral_contact.view.plotting import graded_radii

SCENE = Scene(0.1, 0.5, 0.5, 0.1)
NORMAL = Scene(0.1, 0.5)
STICKY = Scene(0.1, 0.5, profile=profiles.Parabola(1.0), load=0.0, work_of_adhesion=0.1)


class Enough(SpectralContactError):
    """Ends a long work as soon as it begins."""


def stop(*_: object) -> None:
    """Do so."""
    raise Enough("the work has begun")


def one(*_: object, **__: object) -> float:
    """Return a field, or a solver's quantity."""
    return 1.0


class Quarter:
    """A solution of some solver."""

    approach = 0.25


LAYER = {
    **{"density": 1e10, "tip_radius": 5e-6, "height_deviation": 4e-7},
    **{"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "pressure": 1e7},
}


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
    "scene": SCENE,
    "scenes": SCENE,
    "rtol": 1e-3,
    **{"poisson_ratio": 0.3, "normal_compliance": 0.5, "friction": 0.1, "nu": 0.3},
    **{"youngs_modulus": 2.1e11, "radius": 0.013, "load": 1.0, "approach_star": 0.3},
    **{**LAYER, "hardness": 1e9},
    **{"degree": 2, "order": 0, "count": 20, "digits": 15, "share": 0.5, "confidence": 0.9},
    **{"sigma": 0.1, "approach": [0.3], "stick_radius": [0.5], "r": [0.5], "slip": [0.1]},
    **{"quantity": "approach", "accuracy": 0.5, "name": "approach", "kind": "stick"},
    **{"path": "x.json", "folder": "made", "text": SCENE.to_json(), "data": SCENE.to_dict()},
    **{"x": [1, 2, 3], "y": [1, 2, 4], "unknowns": [1, 2, 3], "errors": [0.1, 0.01, 0.001]},
    **{"resolutions": [8], "accuracies": [0.5], "solver": solver, "solvers": {"a": solver}},
    **{"seconds": [0.1], "wanted": ["approach"], "field": one, "truth": Quarter()},
    **{"from_edge": 0.5, "kappa": 0.2, "traction": one, "low": -1.0, "high": 1.0},
    **{"contact_radius": 0.9, "half_angle": 0.8, "flat_radius": 0.5, "exponent": 2.0},
    **{"coefficient": 0.4, "edges": (0.0, 1.0), "slopes": ((0.5, 0.5),), "reach": 2.0},
    **{"height": lambda r: r**2, "radii": [0.0, 0.5, 1.0], "heights": [0.0, 0.125, 0.5]},
    **{"inner": Radius(0.5, 0.5), "outer": Radius(0.75, 0.25), "layer": {}},
    **{"zero_pressure": 1.0, "clearance": 0.1, "overclosures": [0.0, 0.1, 0.2, 0.4]},
    **{"pressures": [0.0, 0.1, 0.3, 0.9], "compliance": 0.5, "start": 0.0, "limit": 1.0},
    **{"spacing": 0.1, "cutoff": 0.4},
    **{"depth": [0.3], "stiffness": [1.0], "area": [1.0], "fitted": CURVE_FIT},
    **{"first": profiles.Cone(1.0), "second": profiles.Parabola(1.0), "material": None},
    **{"series": ((0.5, 0.5),), "derivative": one, "knots": ()},
    **{"work_of_adhesion": 0.1, "contact": SmoothContact(0.5, 1.0), "points": 20},
    **{"lowest": 0.9, "sense": 1, "memory": False},
}
#: By name of the callable's parameter, where the name alone does not say it.
SPECIAL: dict[str, Any] = {
    "adhesion_cycle.scene": STICKY,
    "pull_off.scene": STICKY,
    "damping_map.lowest": [0.9],
    "asperities.greenwood_williamson.pressure": 1e7,
    "calibration.IndentationData.load": [1.0],
    "calibration.contact_depth.load": [1.0],
    "asperities.from_height_map.heights": HEIGHTS,
    "asperities.from_profile.heights": HEIGHTS[0],
    "calibration.oliver_pharr.depth": None,
    "calibration.AreaFunction.table": ([1.0, 2.0], [1.0, 4.0]),
    "calibration.IndentationFit.error.name": "zero_point",
    "layers.Sampled.from_functions.pressure": lambda w: w,
    "layers.Sampled.from_functions.derivative": np.ones_like,
    "asperities.AsperityLayer.at.pressure": 1e7,
    "calibration.PressureData.pressure": [0.3],
    "calibration.fit.data": calibration.ApproachData([0.3], sigma=0.1),
    "calibration.fit.free": "normal_compliance",
    "calibration.compare_laws.candidates": dict.fromkeys("ab", (SCENE, "zero_point")),
    "calibration.compare_laws.data": calibration.IndentationData([1, 2, 3], [1, 2, 3], 1.0),
    "calibration.RoughnessFit.from_json.text": "{}",
    "profiles.Sampled.from_functions.slope": lambda r: 2.0 * r,
    "view.plotting.Radii.evaluate.field": one,
    "gold.table.name": "slip_equal",
    "PhysicalData.si_factor.kind": "displacement",
    "studies.named_solver.name": "os:getcwd",
    "studies.WorkPrecision.of.solver": "a",
    "studies.WorkPrecision.of.scene": NORMAL,
    "studies.WorkPrecision.reached.solver": "a",
    "studies.WorkPrecision.reached.scene": NORMAL,
    "sweeps.sweep.scenes": NORMAL,
    "testing.load.pressure": one,
    "testing.normal_displacement.pressure": one,
    "testing.tangential_displacement.pressure": one,
}
BALL = profiles.Parabola(0.01)
BODY = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3}
PUNCH = {f"punch_{name}": value for name, value in BODY.items()}
#: What goes along with a parameter, so that it is looked at, or the work is short.
INSIDE = "equations.interior.Inside"
COMPANY: dict[str, dict[str, Any]] = {
    "calibration.AreaFunction.coefficients": {"table": None},
    "calibration.oliver_pharr.depth": {"area": calibration.AreaFunction([1.0])},
    "PhysicalData": {"load": 1.0, "radius": 1e-3},
    "PhysicalData.approach": {"radius": 1e-3},
    "PhysicalData.reduced_modulus": {"youngs_modulus": None, "load": 1.0, "radius": 1e-3},
    "PhysicalData.punch_youngs_modulus": {"punch_poisson_ratio": 0.3, "load": 1.0},
    "PhysicalData.punch_poisson_ratio": {"punch_youngs_modulus": 1e9, "load": 1.0},
    "Scene.from_physical": {**BODY, "load": 1.0, "radius": 1e-3},
    "Scene.from_physical.approach": {**BODY, "radius": 1e-3},
    "Scene.from_physical.reduced_modulus": {"load": 1.0, "radius": 1e-3},
    **{
        f"Scene.from_physical.{name}": {**BODY, **PUNCH, "load": 1.0, "profile": BALL}
        for name in ("punch_youngs_modulus", "punch_poisson_ratio", "punch_profile")
    },
    "studies.compare": {"approach": 0.3, "truth": Quarter(), "scene": NORMAL},
    "studies.compare.truth": {"approach": 0.3},
    **{f"studies.compare.{name}": {"pressure": one} for name in ("s", "from_edge", "r")},
    "studies.compare.displacement": {"r": [0.5], "truth": None},
    **{f"studies.compare.{name}": {"s": [0.5]} for name in ("pressure", "traction", "slip")},
    "studies.convergence": {"repeats": 0, "truth": Quarter(), "scene": NORMAL},
    "studies.work_precision": {"repeats": 1, "truths": [Quarter()], "scenes": NORMAL},
    "studies.truth_of": {"truth": Quarter(), "scene": NORMAL},
    **{f"{INSIDE}.{name}.rtol": {"r": [0.5]} for name in ("displacement", "stress", "surface")},
    **{f"{INSIDE}.{name}.rtol": {"r": [0.5], "z": [0.5]} for name in ("to_table", "to_xarray")},
    f"{INSIDE}.save": {"path": "x.csv"},
    f"{INSIDE}.save.rtol": {"path": "x.csv", "r": [0.5], "z": [0.5]},
    "testing.check_solution": {"strict": False},
    "sweeps.sweep": {"quantities": ["approach"]},
    "sweeps.sweep.table": {"quantities": ["approach"]},
    "sweeps.sweep.s": {"quantities": ["pressure"]},
    "sweeps.sweep.from_edge": {"quantities": ["pressure"]},
    "sweeps.sweep.quantities": {},
}


class Examples:
    """Good arguments, and an instance of every class that has public methods.

    Parameters
    ----------
    bench : Bench
    """

    def __init__(self, bench: Bench) -> None:
        from matplotlib.figure import Figure

        [si, *_] = [one.scene.physical for one in bench.solutions if one.scene.physical]
        own, self.bench = convergence(solver, NORMAL, [1, 2], Quarter(), repeats=0), bench
        compared = work_precision({"a": solver}, NORMAL, [0.5], [Quarter()], repeats=1)
        data = calibration.ApproachData([0.3], sigma=0.1)
        rate = fit_rate([10, 20, 40], [1e-2, 2.6e-3, 6e-4])
        self._instances = [
            *bench.solutions,
            *(one.physical for one in bench.solutions if one.scene.physical is not None),
            *(profiles.Parabola(1.0), profiles.Sampled((0.0, 1.0), ((0.5, 0.5),))),
            *(layers.PowerLaw(1.0, 1.5), layers.Sampled((0.0, 1.0), ((0.5, 0.5),))),
            *(SCENE, si, own, own.points[0], own.points, rate),
            *(compared, OwnSolver(), truth_of(NORMAL)),
            *(graded_radii(bench.solutions[0], 20), reference(Scene(0.1), 15)),
            *(data, calibration.PressureData([0.5], [0.3], sigma=0.1)),
            calibration.StickRadiusData([0.5], sigma=0.1),
            *(CURVE_FIT, calibration.AreaFunction([1.0])),
            greenwood_williamson(**LAYER),
            steady_cycle(Scene(0.1, 0.5, 0.5, 0.1), 0.1, rtol=1e-3),
            calibration.fit(NORMAL, data, "normal_compliance", rtol=1e-4),
        ]
        self._instances += [self._instances[-1].parameters[0]]
        self._arguments = {
            **ARGUMENTS,
            "solution": bench.solutions[0],
            "solved": bench.solutions[0],
            "body": bench.solutions[0].inside,
            "plan": bench.solutions[0].plan,
            "figure": Figure(),
            "setting": Setting.of(SCENE, 1e-3, solve),
            "layer": {"normal_compliance": 0.5, "tangential_compliance": 0.5, "friction": 0.1},
        }
        self._special = {
            **SPECIAL,
            "Solution.from_json.text": bench.solutions[0].to_json(),
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
