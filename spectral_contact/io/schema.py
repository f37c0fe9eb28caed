"""What a stored solution holds, declared: version 1 of the format, as docs/file_format.md tells it.

Tags and keys are the format's own. They are written here as text, and stay when a class, a module
or an annotation changes; a test compares the fields declared here with those of the classes.
"""

from __future__ import annotations

from typing import Final

from spectral_contact import layers
from spectral_contact.fields.history import ContactHistory
from spectral_contact.fields.series import (
    AnnulusSeries,
    DiskSeries,
    EdgeWeight,
    LogSeries,
    PressureField,
    Radius,
    ZonalField,
    ZonePiece,
)
from spectral_contact.io.codecs import (
    Array,
    Choice,
    Either,
    Float,
    Maybe,
    Plain,
    Record,
    Several,
    Values,
)
from spectral_contact.profiles import (
    Cone,
    Flat,
    Parabola,
    PowerLaw,
    RoundedFlat,
    Sampled,
    Sphere,
    TruncatedCone,
)
from spectral_contact.records import (
    PROFILE_QUANTITIES,
    Ending,
    ErrorEstimates,
    Plan,
    PlannedStep,
    RefinementStep,
    StepState,
    StepWork,
    Work,
    Zone,
)
from spectral_contact.scene import PhysicalData, Scene
from spectral_contact.solution import Solution

_FLAG, _INT, _TEXT = Plain(bool, "true or false"), Plain(int, "an int"), Plain(str, "a text")
_FLOAT, _ROW, _TABLE = Float(), Array(1), Array(2)
_MAYBE_FLOAT = Maybe(_FLOAT)

#: Profiles of punches.
PROFILES: Final = (
    Record("Parabola", Parabola, radius=_FLOAT),
    Record("Sphere", Sphere, radius=_FLOAT),
    Record("PowerLaw", PowerLaw, coefficient=_FLOAT, exponent=_FLOAT),
    Record("Cone", Cone, half_angle=_FLOAT),
    Record("TruncatedCone", TruncatedCone, flat_radius=_FLOAT, half_angle=_FLOAT),
    Record("Flat", Flat, radius=_FLOAT),
    Record("RoundedFlat", RoundedFlat, flat_radius=_FLOAT, radius=_FLOAT),
    Record(
        "Sampled", Sampled, edges=Several(_FLOAT), slopes=Several(Several(_FLOAT)), rounded=_FLAG
    ),
)
#: Laws of layers.
LAYERS: Final = (
    Record("Linear", layers.Linear, compliance=_FLOAT),
    Record("PowerLaw", layers.PowerLaw, coefficient=_FLOAT, exponent=_FLOAT),
    Record("Exponential", layers.Exponential, zero_pressure=_FLOAT, clearance=_FLOAT),
    Record(
        "CalculixExponential", layers.CalculixExponential, zero_pressure=_FLOAT, clearance=_FLOAT
    ),
    Record(
        "GreenwoodWilliamson",
        layers.GreenwoodWilliamson,
        density=_FLOAT,
        tip_radius=_FLOAT,
        height_deviation=_FLOAT,
        heights=_TEXT,
    ),
    Record("Table", layers.Table, overclosures=Several(_FLOAT), pressures=Several(_FLOAT)),
    Record("Sampled", layers.Sampled, edges=Several(_FLOAT), series=Several(Several(_FLOAT))),
)
_PHYSICAL = Record(
    "PhysicalData",
    PhysicalData,
    dict.fromkeys(("contact_radius", "layer", "separation")),
    youngs_modulus=_FLOAT,
    radius=_MAYBE_FLOAT,
    load=_MAYBE_FLOAT,
    approach=_MAYBE_FLOAT,
    normal_compliance=_FLOAT,
    tangential_compliance=_FLOAT,
    contact_radius=_MAYBE_FLOAT,
    layer=Maybe(Either(*LAYERS)),
    separation=_MAYBE_FLOAT,
)
_SCENE = Record(
    "Scene",
    Scene,
    {
        "coupling": False,
        **dict.fromkeys(("profile", "contact_radius", "load", "approach", "layer", "separation")),
    },
    poisson_ratio=_FLOAT,
    normal_compliance=_FLOAT,
    tangential_compliance=_FLOAT,
    friction=_MAYBE_FLOAT,
    physical=Maybe(_PHYSICAL),
    coupling=_FLAG,
    profile=Maybe(Either(*PROFILES)),
    contact_radius=_MAYBE_FLOAT,
    load=_MAYBE_FLOAT,
    approach=_MAYBE_FLOAT,
    layer=Maybe(Either(*LAYERS)),
    separation=_MAYBE_FLOAT,
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
_PLANNED_STEP = Record("PlannedStep", PlannedStep, name=_TEXT, state=_STATE, reason=_TEXT)
_PLAN = Record(
    "Plan",
    Plan,
    quantities=Several(_TEXT),
    steps=Several(_PLANNED_STEP),
    missing=Several(Several(_TEXT, 2)),
)
_ZONE = Record(
    "Zone",
    Zone,
    kind=Plain(str, '"stick" or "slip"', "stick", "slip"),
    inner=_FLOAT,
    outer=_FLOAT,
    inner_from_edge=_FLOAT,
    outer_from_edge=_FLOAT,
)
_ERRORS = Record(
    "ErrorEstimates",
    ErrorEstimates,
    dict.fromkeys(PROFILE_QUANTITIES),
    approach=_MAYBE_FLOAT,
    pressure=_MAYBE_FLOAT,
    traction=_MAYBE_FLOAT,
    slip=_MAYBE_FLOAT,
    zones=_MAYBE_FLOAT,
    stick_radius=_MAYBE_FLOAT,
    total_shear=_MAYBE_FLOAT,
    edge_ratio=_MAYBE_FLOAT,
    critical_friction=_MAYBE_FLOAT,
    violation=_MAYBE_FLOAT,
    contact_radius=_MAYBE_FLOAT,
    load=_MAYBE_FLOAT,
    stiffness=_MAYBE_FLOAT,
    indentation_work=_MAYBE_FLOAT,
)
_REFINEMENT = Record(
    "RefinementStep",
    RefinementStep,
    unknowns=_INT,
    highest_degree=_INT,
    error=_FLOAT,
    seconds=_FLOAT,
)
_STEP_WORK = Record(
    "StepWork",
    StepWork,
    name=_TEXT,
    unknowns=_INT,
    degrees=Several(_INT),
    history=Several(_REFINEMENT),
    ending=_ENDING,
    seconds=_FLOAT,
)
_WORK = Record("Work", Work, steps=Several(_STEP_WORK))
_RADIUS = Record("Radius", Radius, value=_FLOAT, from_edge=_FLOAT)
_LOG_SERIES = Record(
    "LogSeries",
    LogSeries,
    {"oscillation": 0.0, "logarithm": 0.0},
    coefficients=_TABLE,
    tail=_ROW,
    width=_FLOAT,
    power=_FLOAT,
    root_tail=_FLAG,
    oscillation=_FLOAT,
    logarithm=_FLOAT,
)
_WEIGHT = Record("EdgeWeight", EdgeWeight, amplitude=_FLOAT, shift=_FLOAT, logarithmic=_FLAG)
_PRESSURE = Record("PressureField", PressureField, weight=Maybe(_WEIGHT), series=Maybe(_LOG_SERIES))
_DISK = Record(
    "DiskSeries",
    DiskSeries,
    {"power": 1, "exponent": 0.0},
    outer=_RADIUS,
    series=Maybe(_LOG_SERIES),
    weight=Maybe(_WEIGHT),
    power=_INT,
    exponent=_FLOAT,
)
_ANNULUS = Record(
    "AnnulusSeries",
    AnnulusSeries,
    inner=_RADIUS,
    outer=_RADIUS,
    toward_inner=_LOG_SERIES,
    toward_outer=_LOG_SERIES,
    power=_INT,
)
_PIECE = Record(
    "ZonePiece",
    ZonePiece,
    outer=_RADIUS,
    field=Maybe(Either(_DISK, _ANNULUS, _PRESSURE)),
    factor=_FLOAT,
)
_ZONAL = Record("ZonalField", ZonalField, pieces=Several(_PIECE))
_TANGENTIAL = Maybe(Either(_ZONAL, _DISK))
_HISTORY = Record(
    "ContactHistory",
    ContactHistory,
    ends=_ROW,
    loads=_TABLE,
    approaches=_TABLE,
    shears=_TABLE,
    sticks=_TABLE,
    errors=_TABLE,
)

#: The root of the tree.
SOLUTION: Final = Record(
    "Solution",
    Solution,
    {"grown": None},
    scene=_SCENE,
    rtol=_FLOAT,
    plan=_PLAN,
    error=_ERRORS,
    converged=_FLAG,
    ending=_ENDING,
    work=_WORK,
    values=Values(
        approach=_FLOAT,
        total_shear=_FLOAT,
        edge_ratio=_FLOAT,
        critical_friction=_FLOAT,
        zones=Several(_ZONE),
        stick_radius=_MAYBE_FLOAT,
        opening=_MAYBE_FLOAT,
        contact_radius=_FLOAT,
        load=_FLOAT,
        stiffness=_FLOAT,
        indentation_work=_FLOAT,
        domain_radius=_FLOAT,
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
    *(_PHYSICAL, _SCENE, _PLANNED_STEP, _PLAN, _ZONE, _ERRORS, _REFINEMENT, _STEP_WORK, _WORK),
    *(_RADIUS, _LOG_SERIES, _WEIGHT, _PRESSURE, _DISK, _ANNULUS, _PIECE, _ZONAL, _HISTORY),
)
CHOICES: Final = (_STATE, _ENDING)
