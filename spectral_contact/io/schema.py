"""What a stored solution holds, declared: version 1 of the format, as docs/file_format.md tells it.

Tags and keys are the format's own. They are written here as text, and stay when a class, a module
or an annotation changes; a test compares the fields declared here with those of the classes.
"""

from __future__ import annotations

from typing import Final

from spectral_contact import layers, profiles, records
from spectral_contact.fields import series
from spectral_contact.fields.history import ContactHistory
from spectral_contact.io.codecs import (
    Array,
    Choice,
    Either,
    Float,
    Kind,
    Maybe,
    Plain,
    Record,
    Several,
    Values,
)
from spectral_contact.quantities import NUMBERS
from spectral_contact.records import Ending, StepState
from spectral_contact.scene import PhysicalData, Scene
from spectral_contact.solution import Solution

#: Numbers of the first solutions that were stored.
_FIRST = ("approach", "stick_radius", "total_shear", "edge_ratio", "critical_friction")
_FLAG, _INT, _TEXT = Plain(bool, "true or false"), Plain(int, "an int"), Plain(str, "a text")
_FLOAT, _ROW, _TABLE = Float(), Array(1), Array(2)
_ROWS = Several(Several(_FLOAT))


def _floats(names: str) -> dict[str, Kind]:
    return dict.fromkeys(names.split(), _FLOAT)


def _maybe_floats(names: str) -> dict[str, Kind]:
    return dict.fromkeys(names.split(), Maybe(_FLOAT))


#: Profiles of punches.
PROFILES: tuple[Record, ...] = (
    Record("Parabola", profiles.Parabola, radius=_FLOAT),
    Record("Sphere", profiles.Sphere, radius=_FLOAT),
    Record("PowerLaw", profiles.PowerLaw, **_floats("coefficient exponent")),
    Record("Cone", profiles.Cone, half_angle=_FLOAT),
    Record("TruncatedCone", profiles.TruncatedCone, **_floats("flat_radius half_angle")),
    Record("Flat", profiles.Flat, radius=_FLOAT),
    Record("RoundedFlat", profiles.RoundedFlat, **_floats("flat_radius radius")),
    Record("Sampled", profiles.Sampled, edges=Several(_FLOAT), slopes=_ROWS, rounded=_FLAG),
)
_PART = Either(*PROFILES)
PROFILES = (*PROFILES, Record("Sum", profiles.Sum, first=_PART, second=_PART))
_EXPONENTIAL = _floats("zero_pressure clearance")
_ASPERITIES = _floats("density tip_radius height_deviation")
#: Laws of layers.
LAYERS: Final = (
    Record("Linear", layers.Linear, compliance=_FLOAT),
    Record("PowerLaw", layers.PowerLaw, **_floats("coefficient exponent")),
    Record("Exponential", layers.Exponential, **_EXPONENTIAL),
    Record("CalculixExponential", layers.CalculixExponential, **_EXPONENTIAL),
    Record("GreenwoodWilliamson", layers.GreenwoodWilliamson, **_ASPERITIES, heights=_TEXT),
    Record("Table", layers.Table, overclosures=Several(_FLOAT), pressures=Several(_FLOAT)),
    Record("Sampled", layers.Sampled, edges=Several(_FLOAT), series=_ROWS),
)
_LAYER, _PROFILE = Maybe(Either(*LAYERS)), Maybe(Either(*PROFILES))
_PHYSICAL = Record(
    "PhysicalData",
    PhysicalData,
    dict.fromkeys(
        (
            *("contact_radius", "layer", "separation"),
            *("punch_youngs_modulus", "punch_poisson_ratio", "reduced_modulus", "work_of_adhesion"),
        )
    ),
    **_maybe_floats("youngs_modulus radius load approach"),
    **_floats("normal_compliance tangential_compliance"),
    contact_radius=Maybe(_FLOAT),
    layer=_LAYER,
    **_maybe_floats("separation punch_youngs_modulus punch_poisson_ratio reduced_modulus"),
    work_of_adhesion=Maybe(_FLOAT),
)
SCENE: Final = Record(
    "Scene",
    Scene,
    {
        "coupling": False,
        **dict.fromkeys(("profile", "contact_radius", "load", "approach", "layer", "separation")),
        **dict.fromkeys(("mismatch", "work_of_adhesion")),
        "branch": 0,
        "unloaded_to": 1.0,
    },
    poisson_ratio=Maybe(_FLOAT),
    **_floats("normal_compliance tangential_compliance"),
    friction=Maybe(_FLOAT),
    physical=Maybe(_PHYSICAL),
    coupling=_FLAG,
    profile=_PROFILE,
    **_maybe_floats("contact_radius load approach"),
    layer=_LAYER,
    **_maybe_floats("separation mismatch work_of_adhesion"),
    branch=_INT,
    unloaded_to=_FLOAT,
)
_STATE = Choice(
    "StepState", RUN=StepState.RUN, CONDITIONAL=StepState.CONDITIONAL, SKIPPED=StepState.SKIPPED
)
_ENDING = Choice(
    "Ending",
    CONVERGED=Ending.CONVERGED,
    UNKNOWNS=Ending.UNKNOWNS,
    ROUNDING=Ending.ROUNDING,
    ZONES=Ending.ZONES,
)
_PLANNED_STEP = Record("PlannedStep", records.PlannedStep, name=_TEXT, state=_STATE, reason=_TEXT)
_PLAN = Record(
    "Plan",
    records.Plan,
    quantities=Several(_TEXT),
    steps=Several(_PLANNED_STEP),
    missing=Several(Several(_TEXT, 2)),
)
_ZONE = Record(
    "Zone",
    records.Zone,
    {"sense": 1, "memory": False},
    kind=Plain(str, '"stick" or "slip"', "stick", "slip"),
    **_floats("inner outer inner_from_edge outer_from_edge"),
    sense=_INT,
    memory=_FLAG,
)
#: Numbers that are younger than version 1 of the format; old files do not have them.
_YOUNGER = tuple(name for name in NUMBERS if name not in _FIRST)
_ERRORS = Record(
    "ErrorEstimates",
    records.ErrorEstimates,
    dict.fromkeys(_YOUNGER),
    **_maybe_floats("approach pressure traction slip zones stick_radius total_shear edge_ratio"),
    **_maybe_floats("critical_friction violation"),
    **dict.fromkeys(_YOUNGER, Maybe(_FLOAT)),
)
_REFINEMENT = Record(
    "RefinementStep",
    records.RefinementStep,
    unknowns=_INT,
    highest_degree=_INT,
    **_floats("error seconds"),
)
_STEP_WORK = Record(
    "StepWork",
    records.StepWork,
    name=_TEXT,
    unknowns=_INT,
    degrees=Several(_INT),
    history=Several(_REFINEMENT),
    ending=_ENDING,
    seconds=_FLOAT,
)
_WORK = Record("Work", records.Work, steps=Several(_STEP_WORK))
_RADIUS = Record("Radius", series.Radius, **_floats("value from_edge"))
_LOG_SERIES = Record(
    "LogSeries",
    series.LogSeries,
    {"oscillation": 0.0, "logarithm": 0.0},
    coefficients=_TABLE,
    tail=_ROW,
    **_floats("width power"),
    root_tail=_FLAG,
    **_floats("oscillation logarithm"),
)
_WEIGHT = Record("EdgeWeight", series.EdgeWeight, **_floats("amplitude shift"), logarithmic=_FLAG)
_PRESSURE = Record(
    "PressureField", series.PressureField, weight=Maybe(_WEIGHT), series=Maybe(_LOG_SERIES)
)
_DISK = Record(
    "DiskSeries",
    series.DiskSeries,
    {"power": 1, "exponent": 0.0},
    outer=_RADIUS,
    series=Maybe(_LOG_SERIES),
    weight=Maybe(_WEIGHT),
    power=_INT,
    exponent=_FLOAT,
)
_ANNULUS = Record(
    "AnnulusSeries",
    series.AnnulusSeries,
    inner=_RADIUS,
    outer=_RADIUS,
    toward_inner=_LOG_SERIES,
    toward_outer=_LOG_SERIES,
    power=_INT,
)
_PIECE = Record(
    "ZonePiece",
    series.ZonePiece,
    outer=_RADIUS,
    field=Maybe(Either(_DISK, _ANNULUS, _PRESSURE)),
    factor=_FLOAT,
)
_ZONAL = Record(
    "ZonalField",
    series.ZonalField,
    {"weight": None},
    pieces=Several(_PIECE),
    weight=Maybe(_WEIGHT),
)
_TANGENTIAL = Maybe(Either(_ZONAL, _DISK))
_HISTORY = Record(
    "ContactHistory",
    ContactHistory,
    ends=_ROW,
    **dict.fromkeys(("loads", "approaches", "shears", "sticks", "errors"), _TABLE),
)

#: The root of the tree.
SOLUTION: Final = Record(
    "Solution",
    Solution,
    {"grown": None},
    scene=SCENE,
    rtol=_FLOAT,
    plan=_PLAN,
    error=_ERRORS,
    converged=_FLAG,
    ending=_ENDING,
    work=_WORK,
    values=Values(
        **_floats("approach total_shear edge_ratio critical_friction"),
        zones=Several(_ZONE),
        **_maybe_floats("stick_radius opening"),
        **dict.fromkeys(_YOUNGER, _FLOAT),
        **_floats("domain_radius load_scale approach_scale indentation_work_scale"),
        **_floats("stiffness_on_branch_scale"),
        stable_under=Several(_TEXT),
    ),
    pressure_field=Maybe(Either(_PRESSURE, _ZONAL)),
    traction_field=_TANGENTIAL,
    slip_field=_TANGENTIAL,
    grown=Maybe(_HISTORY),
)
#: Everything that has a tag.
RECORDS: Final = (
    SOLUTION,
    *PROFILES,
    *LAYERS,
    *(_PHYSICAL, SCENE, _PLANNED_STEP, _PLAN, _ZONE, _ERRORS, _REFINEMENT, _STEP_WORK, _WORK),
    *(_RADIUS, _LOG_SERIES, _WEIGHT, _PRESSURE, _DISK, _ANNULUS, _PIECE, _ZONAL, _HISTORY),
)
CHOICES: Final = (_STATE, _ENDING)
