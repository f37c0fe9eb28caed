"""What is said of a parameter once: its meaning, its range and its unit.

The checks of `Scene`, `PhysicalData`, profiles and layers, the options of the command line and the
columns of sweeps read it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final

from spectral_contact.io.checks import within
from spectral_contact.io.choices import one_of

__all__ = ["SCENE", "SI", "Parameter", "check_parameters", "declared", "parameters_of"]

#: Terminals and log files may know no Greek letters.
_ASCII: Final = str.maketrans(
    {"α": "alpha", "β": "beta", "δ": "delta", "κ": "kappa", "λ": "lambda", "ν": "nu"}
    | {"−": "-", "²": "^2", "₂": "2"}
)
_POSITIVE: Final = "finite and > 0"
_COMPLIANCE: Final = "0 or in [1e-14, 1e14]"
_SI_COMPLIANCE: Final = "finite and >= 0 [m/Pa]"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a constructor.

    Attributes
    ----------
    meaning : str
        In words, without a symbol.
    allowed : str
        The range, worded to follow "must be" and read by `checks.within`. If there are `choices`,
        what ``--help`` says besides them.
    unit : str
        The SI unit; empty if there is none. Dimensionless scenes have no units.
    symbol : str
        As in docs/theory, with a definition if there is one.
    headings : tuple of str
        By which headings of a table it is known, besides its name.
    choices : tuple of str
        Names, of which it is one; empty if it is a number.
    kind : type
        float, int or bool; str if there are choices.
    """

    meaning: str
    allowed: str = ""
    unit: str = ""
    symbol: str = ""
    headings: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()
    kind: type = float

    def __post_init__(self) -> None:
        if self.choices:
            object.__setattr__(self, "kind", str)  # into a frozen dataclass

    def __str__(self) -> str:
        """Return all of it on one line of ASCII, as ``--help`` has it."""
        unit = f"[{self.unit}]" if self.unit and self.unit not in self.allowed else ""
        named = " ".join(one for one in (self.meaning, self.symbol, unit) if one)
        told = f"{named}, {self.allowed}" if self.allowed else named
        return told.replace("math.inf", "inf").replace("None", "none").translate(_ASCII)

    def checked(self, name: str, value: object) -> Any:
        """Return a value of the range; an angle may have a unit.

        Raises
        ------
        SceneError
            If the value is another.
        """
        if self.choices:
            return one_of(name, value, self.choices)
        return within(name, value, self.allowed, "rad" if self.unit == "rad" else "")


def declared(*arguments: Any, **options: Any) -> Mapping[str, Parameter]:
    """Return the metadata of a field that is a parameter, from the arguments of `Parameter`."""
    return {"parameter": Parameter(*arguments, **options)}


def parameters_of(kind: Any) -> dict[str, Parameter]:
    """Return the parameters that the fields of a dataclass declare, by name."""
    return {
        one.name: one.metadata["parameter"] for one in fields(kind) if "parameter" in one.metadata
    }


def check_parameters(made: Any) -> None:
    """Check the parameters of a frozen dataclass, as far as they are declared.

    Raises
    ------
    SceneError
        If one is out of its range.
    """
    for name, parameter in parameters_of(made).items():
        object.__setattr__(made, name, parameter.checked(name, getattr(made, name)))


#: What a scene is given by, dimensionless; with a profile in L, E' and E'L².
SCENE: Final[Mapping[str, Parameter]] = {
    "poisson_ratio": Parameter(
        "Poisson's ratio", "in (-1, 0.5]", "", "ν", ("nu", "ν", "poisson's ratio")
    ),
    "kappa": Parameter(
        "coupling constant of two elastic bodies",
        "0, or in (-3/8, 3/8) and of a size of at least 1e-16",
        symbol="κ",
    ),
    "normal_compliance": Parameter(
        "normal compliance", _COMPLIANCE, "", "α* = α E/(4(1−ν²) a)", ("alpha", "α")
    ),
    "tangential_compliance": Parameter(
        "tangential compliance", _COMPLIANCE, "", "β* = β E/(4(1−ν²) a)", ("beta", "β")
    ),
    "friction": Parameter(
        "coefficient of friction",
        ">= 0 (math.inf is full stick, None no friction)",
        symbol="f",
        headings=("f", "mu", "μ", "coefficient of friction"),
    ),
    "unloaded_to": Parameter(
        "load over the largest load", "in (0, 1], 1 being the largest load", symbol="λ"
    ),
    "coupling": Parameter(
        "elastic coupling: whether the traction acts back on the pressure", kind=bool
    ),
    "contact_radius": Parameter("contact radius", _POSITIVE, "m", "a"),
    "load": Parameter("load", _POSITIVE, "N", "P", ("P", "F", "force", "normal force")),
    "approach": Parameter("approach", _POSITIVE, "m", "δ", ("delta", "δ", "depth")),
    "separation": Parameter("separation at the deformed centre", "finite", "m", "d"),
    "work_of_adhesion": Parameter(
        "work of adhesion",
        "None, or in [1e-100, 1e100], in E'L; to switch adhesion off leave it out",
        "J/m^2",
        "w",
    ),
    "branch": Parameter(
        "stretch of the curve of states with adhesion, from large contacts", kind=int
    ),
}
#: The numbers of a scene in SI units that a dimensionless one has not, or not in that range.
SI: Final[Mapping[str, Parameter]] = {
    "youngs_modulus": Parameter("Young's modulus", _POSITIVE, "Pa", "E", ("E", "young's modulus")),
    "reduced_modulus": Parameter(
        "reduced modulus of both bodies", _POSITIVE, "Pa", "E*", ("E*", "Er")
    ),
    "punch_youngs_modulus": Parameter("Young's modulus of the punch", _POSITIVE, "Pa", "E₂"),
    "punch_poisson_ratio": Parameter("Poisson's ratio of the punch", "in (-1, 0.5]", "", "ν₂"),
    "radius": Parameter("radius of a flat punch", _POSITIVE, "m", "a", ("a", "R", "punch radius")),
    "work_of_adhesion": Parameter("work of adhesion", "finite and > 0 [J/m^2]", "J/m^2", "w"),
    "normal_compliance": Parameter(
        "normal compliance", _SI_COMPLIANCE, "m/Pa", "α", ("alpha", "α")
    ),
    "tangential_compliance": Parameter(
        "tangential compliance", _SI_COMPLIANCE, "m/Pa", "β", ("beta", "β")
    ),
}
