"""What can be asked of `solve`: one table that reports, SI units, sweeps, files and plans read."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "ADHESION_QUANTITIES",
    "FIELDS",
    "FLAT_QUANTITIES",
    "FOLLOWING_LOAD",
    "FULL_STICK_RATIOS",
    "NUMBERS",
    "OUTPUTS",
    "PROFILE_QUANTITIES",
    "QUANTITIES",
    "RADIAL",
    "TANGENTIAL_QUANTITIES",
    "UNLOADED_QUANTITIES",
    "OutputQuantity",
]


@dataclass(frozen=True, slots=True)
class OutputQuantity:
    """A quantity that can be asked of `solve`, as reports, SI units, sweeps and files need it.

    Attributes
    ----------
    name : str
        That of the property or method of `Solution`, and of the field of `ErrorEstimates`.
    meaning, unit : str
        In words, and the dimensionless unit, of a flat punch.
    under_profile : tuple of (str, str) or None
        Meaning and unit under a profile, where they are others.
    si_unit : str
        Empty for a quantity without a unit.
    si_factor : str
        What the dimensionless value is multiplied by to be in SI units. Of a flat punch these are
        ``"radius"``, ``"displacement"``, ``"stress"`` and, as ``"force"``, the load. Under a
        profile lengths are in m already: ``"displacement"`` is 1, ``"stress"`` and ``"force"`` are
        E'. ``""`` is 1: of quantities without a unit, and of lengths that only profiles have.
    kind : str
        ``"number"``, ``"field"`` of the radius, or ``"zones"``.
    contact : str
        ``"normal"`` if the pressure is enough for it, unless elastic coupling makes the pressure
        depend on the traction, or ``"tangential"``.
    scenes : str
        Which scenes have it: ``"all"``, those with a ``"profile"``, those with ``"adhesion"``, or
        those with a ``"flat"`` punch, or those that are ``"unloaded"``.
    follows_load : bool
        Whether it is proportional to the load of a flat punch whose zones are given.
    radial : bool
        Whether it has another sign where kappa has.
    """

    name: str
    meaning: str
    unit: str
    under_profile: tuple[str, str] | None = None
    si_unit: str = ""
    si_factor: str = ""
    kind: str = "number"
    contact: str = "tangential"
    scenes: str = "all"
    follows_load: bool = False
    radial: bool = False


#: Everything that can be asked of `solve`, in the order of a report.
OUTPUTS = (
    OutputQuantity(
        "contact_radius",
        "contact radius a",
        "L",
        si_unit="m",
        contact="normal",
        scenes="profile",
    ),
    OutputQuantity(
        "load",
        "load P",
        "E'L²",
        si_unit="N",
        si_factor="force",
        contact="normal",
        scenes="profile",
    ),
    OutputQuantity(
        "stiffness",
        "stiffness dP/dδ",
        "E'L",
        si_unit="N/m",
        si_factor="force",
        contact="normal",
        scenes="profile",
    ),
    OutputQuantity(
        "indentation_work",
        "work of the load",
        "E'L³",
        si_unit="J",
        si_factor="force",
        contact="normal",
        scenes="profile",
    ),
    OutputQuantity(
        "stiffness_on_branch",
        "stiffness dP/dδ along the curve of states",
        "E'L",
        si_unit="N/m",
        si_factor="force",
        contact="normal",
        scenes="adhesion",
    ),
    OutputQuantity(
        "approach",
        "approach δ*",
        "4(1−ν²)P/(aE)",
        under_profile=("approach δ", "L"),
        si_unit="m",
        si_factor="displacement",
        contact="normal",
        follows_load=True,
    ),
    OutputQuantity(
        "pressure",
        "pressure p*",
        "P/a²",
        under_profile=("pressure p", "E'"),
        si_unit="Pa",
        si_factor="stress",
        kind="field",
        contact="normal",
        follows_load=True,
    ),
    OutputQuantity(
        "traction",
        "traction q*",
        "P/a²",
        under_profile=("traction q", "E'"),
        si_unit="Pa",
        si_factor="stress",
        kind="field",
        follows_load=True,
        radial=True,
    ),
    OutputQuantity(
        "slip",
        "slip u_r*",
        "4(1−ν²)P/(aE)",
        under_profile=("slip since first contact u_r", "L"),
        si_unit="m",
        si_factor="displacement",
        kind="field",
        follows_load=True,
        radial=True,
    ),
    OutputQuantity("zones", "boundaries of the zones", "a", kind="zones"),
    OutputQuantity(
        "stick_radius",
        "stick radius c*",
        "a",
        under_profile=("stick radius c/a", "a"),
        si_unit="m",
        si_factor="radius",
    ),
    OutputQuantity(
        "total_shear",
        "total shear Q*",
        "P",
        under_profile=("total shear Q", "E'L²"),
        si_unit="N",
        si_factor="force",
        follows_load=True,
        radial=True,
    ),
    OutputQuantity("edge_ratio", "q/p of full stick at the edge", "1", scenes="flat"),
    OutputQuantity(
        "critical_friction",
        "critical friction, the largest q/p of full stick",
        "1",
        scenes="flat",
    ),
    OutputQuantity(
        "shakedown_ratio",
        "shakedown ratio λ*, the lowest load over the largest of cycles that stop slipping",
        "1",
        scenes="flat",
    ),
    OutputQuantity(
        "reverse_ratio",
        "load over the largest load at which slip back begins",
        "1",
        scenes="unloaded",
    ),
    OutputQuantity(
        "turning_ratio",
        "load over the largest load below which the history counts",
        "1",
        scenes="unloaded",
    ),
)

#: Names of what can be asked of a flat punch, most of it of any scene, in the order of a report.
QUANTITIES = tuple(one.name for one in OUTPUTS if one.scenes in ("all", "flat"))

#: What else there is of a punch that is not flat.
PROFILE_QUANTITIES = tuple(one.name for one in OUTPUTS if one.scenes == "profile")

#: What else there is with adhesion.
ADHESION_QUANTITIES = tuple(one.name for one in OUTPUTS if one.scenes == "adhesion")

#: What else there is below the largest load.
UNLOADED_QUANTITIES = tuple(one.name for one in OUTPUTS if one.scenes == "unloaded")

#: Those that are functions of the radius, and those that are a number.
FIELDS = tuple(one.name for one in OUTPUTS if one.kind == "field")
NUMBERS = tuple(one.name for one in OUTPUTS if one.kind == "number")

#: Those that a flat punch alone has, and those that take the traction.
FLAT_QUANTITIES = frozenset(one.name for one in OUTPUTS if one.scenes == "flat")
TANGENTIAL_QUANTITIES = frozenset(one.name for one in OUTPUTS if one.contact == "tangential")

#: Those that are proportional to the load of a flat punch, and those whose sign is that of kappa.
FOLLOWING_LOAD = frozenset(one.name for one in OUTPUTS if one.follows_load)
RADIAL = frozenset(one.name for one in OUTPUTS if one.radial)

#: Those that take q/p of full stick and nothing of the slip.
FULL_STICK_RATIOS = frozenset({"edge_ratio", "critical_friction", "shakedown_ratio"})
