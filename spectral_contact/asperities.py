"""A rough layer from its asperities, after Greenwood and Williamson: compliance and law.

Spherical asperities of one tip radius R and Gaussian heights of standard deviation σ, independent
of each other, carry at the separation d from the mean of their heights the pressure

    p(d) = (4/3) η E* √R ∫_d^∞ (z − d)^{3/2} φ(z) dz,    E* = E/(1 − ν²),

of Greenwood and Williamson, *Contact of nominally flat surfaces*, Proc. R. Soc. Lond. A 295 (1966)
300–319; the counterface is rigid, as the punch is. E* is four times E', the unit of pressures of a
scene with a profile. The layer of equation (2.1) is linear, and its compliance is α = −dd/dp at one
pressure. The tangential stiffness of every asperity that touches is 2(1 − ν)/(2 − ν) times its
normal one before it slips (Mindlin, *Compliance of elastic bodies in contact*, J. Appl. Mech. 16
(1949) 259–268; Johnson, *Contact Mechanics*, 1985, section 7.2), hence β = α (2 − ν)/(2(1 − ν)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spectral_contact.errors import SceneError
from spectral_contact.io.checks import positive, within
from spectral_contact.io.choices import one_of
from spectral_contact.io.physical_data import checked_poisson_ratio
from spectral_contact.layers import CalculixExponential, GreenwoodWilliamson, Layer, PowerLaw
from spectral_contact.layers.measured_surface import (
    SurfaceStatistics,
    from_height_map,
    from_profile,
)

__all__ = [
    "AsperityLayer",
    "SurfaceStatistics",
    "from_height_map",
    "from_profile",
    "greenwood_williamson",
]

#: Laws that `AsperityLayer.law` makes.
_LAWS = "gaussian", "exponential heights", "uniform heights", "tangent exponential"
#: Separations d/σ that are solved for, far beyond those at which the model means anything.
_NEAREST, _FARTHEST = -10.0, 20.0
#: Range of the products of the inputs, so that nothing overflows.
_SMALLEST, _LARGEST = 1e-100, 1e100
#: Where the model is taken for valid: separations d/σ, and the share of the area that touches.
_VALID_SEPARATIONS = 0.5, 4.0
_VALID_FRACTION = 0.05
#: Greenwood and Williamson call contact with an index above 1 plastic, below 0.6 elastic.
_ELASTIC, _PLASTIC = 0.6, 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AsperityLayer:
    """A layer of asperities under a nominal pressure; made by `greenwood_williamson`.

    Attributes
    ----------
    density, tip_radius, height_deviation, youngs_modulus, poisson_ratio, pressure, hardness
        As given.
    separation : float
        d of the rigid plane from the mean of the heights [m].
    normal_compliance : float
        α = −dd/dp at the pressure [m/Pa].
    tangential_compliance : float
        β = α (2 − ν)/(2(1 − ν)) [m/Pa], without slip at any asperity.
    contact_fraction : float
        Real over nominal area of contact.
    touching_density : float
        Asperities in contact per area [1/m²].
    """

    density: float
    tip_radius: float
    height_deviation: float
    youngs_modulus: float
    poisson_ratio: float
    pressure: float
    hardness: float | None
    separation: float
    normal_compliance: float
    tangential_compliance: float
    contact_fraction: float
    touching_density: float

    @property
    def asperity_pressure(self) -> float:
        """Mean pressure over the real area of contact [Pa]."""
        return self.pressure / self.contact_fraction

    @property
    def asperity_force(self) -> float:
        """Mean force on the asperities that touch [N]."""
        return self.pressure / self.touching_density

    @property
    def plasticity_index(self) -> float | None:
        """(E*/H) √(σ/R) of Greenwood and Williamson; None without hardness."""
        if self.hardness is None:
            return None
        slope = math.sqrt(self.height_deviation / self.tip_radius)
        return _reduced_modulus(self.youngs_modulus, self.poisson_ratio) / self.hardness * slope

    @property
    def remarks(self) -> tuple[str, ...]:
        """Warnings about the range of the model, one sentence each; empty inside it.

        The range is: separations from 0.5 to 4 σ, a contact fraction up to 0.05, and a plasticity
        index up to 0.6, if there is a hardness.
        """
        found = []
        separation = self.separation / self.height_deviation
        low, high = _VALID_SEPARATIONS
        if not low <= separation <= high:
            found.append(f"The separation is {separation:.2f} σ, not in [{low:g}, {high:g}] σ.")
        if self.contact_fraction > _VALID_FRACTION:
            found.append(
                f"The contact fraction is {self.contact_fraction:.2g}, above {_VALID_FRACTION}: "
                "neighbouring asperities are not independent."
            )
        index = self.plasticity_index
        if index is not None and index > _ELASTIC:
            how = "many" if index > _PLASTIC else "some"
            found.append(
                f"The plasticity index is {index:.2g}, above {_ELASTIC}: {how} asperities yield."
            )
        return tuple(found)

    def at(self, pressure: float) -> AsperityLayer:
        """Return the same asperities under another nominal pressure [Pa].

        Raises
        ------
        SceneError
            As `greenwood_williamson`.
        """
        return greenwood_williamson(
            density=self.density,
            tip_radius=self.tip_radius,
            height_deviation=self.height_deviation,
            youngs_modulus=self.youngs_modulus,
            poisson_ratio=self.poisson_ratio,
            pressure=pressure,
            hardness=self.hardness,
        )

    def law(self, kind: str = "gaussian") -> Layer:
        """Return the law of the layer as it is, for ``Scene.from_physical(layer=…)``.

        Parameters
        ----------
        kind : str
            ``"gaussian"``: the same asperities with Gaussian heights, Greenwood and Williamson's.
            ``"exponential heights"``: heights of the same deviation that are distributed
            exponentially. ``"uniform heights"``: heights of the same deviation that are distributed
            evenly over an interval. This is a power law of exponent 5/2 of the overclosure of the
            highest asperity, until the lowest one touches. ``"tangent exponential"``: the
            exponential law with pressure and compliance of the Gaussian one at the nominal
            pressure.

        Returns
        -------
        Layer
            Pressures in Pa, lengths in m. The overclosure is counted from the mean of the heights;
            for exponential heights from the lowest asperity, for uniform ones from the highest.

        Raises
        ------
        SceneError
            For another kind, or if a parameter of the law leaves its range.
        """
        one_of("kind", kind, _LAWS)
        eta, tip, sigma = self.density, self.tip_radius, self.height_deviation
        if kind == "uniform heights":
            span = 2.0 * math.sqrt(3.0) * sigma
            modulus = _reduced_modulus(self.youngs_modulus, self.poisson_ratio)
            # (4/3) eta E* sqrt(R) times the integral of z^(3/2) from 0 to w, over the span
            return PowerLaw(8.0 / 15.0 * eta * modulus * math.sqrt(tip) / span, 2.5)
        if kind == "tangent exponential":
            decay = self.normal_compliance * self.pressure
            at_zero = self.pressure * math.exp(self.separation / decay)
            return CalculixExponential(at_zero, math.log(100.0) * decay)
        heights = "gaussian" if kind == "gaussian" else "exponential"
        return GreenwoodWilliamson(eta, tip, sigma, heights)

    def compliance_change(self, share: float) -> tuple[float, float]:
        """Return the relative change of α at a lower and at a higher pressure.

        If it is small, linearisation holds in between.

        Parameters
        ----------
        share : float
            In (0, 1); the pressures are 1 − share and 1 + share times that of the layer.

        Raises
        ------
        SceneError
            If `share` is out of its range, or a pressure is out of that of the model.
        """
        share = within("share", share, "in (0, 1)")
        low, high = (self.at(self.pressure * factor) for factor in (1.0 - share, 1.0 + share))
        alpha = self.normal_compliance
        return low.normal_compliance / alpha - 1.0, high.normal_compliance / alpha - 1.0


def greenwood_williamson(
    *,
    density: float,
    tip_radius: float,
    height_deviation: float,
    youngs_modulus: float,
    poisson_ratio: float,
    pressure: float,
    hardness: float | None = None,
) -> AsperityLayer:
    """Linearise the compliance of a layer of asperities at a nominal pressure.

    Parameters
    ----------
    density : float
        η, asperities per nominal area [1/m²].
    tip_radius : float
        R of the asperities [m].
    height_deviation : float
        σ, the standard deviation of the heights of their summits [m].
    youngs_modulus : float
        E [Pa] of the rough half-space; the punch is rigid.
    poisson_ratio : float
        ν of it, in (−1, 0.5].
    pressure : float
        Nominal pressure [Pa], say P/(πa²) of a punch.
    hardness : float, optional
        H of the asperities [Pa], for the plasticity index.

    Returns
    -------
    AsperityLayer
        Its `remarks` say what is outside the range in which the model holds.

    Raises
    ------
    SceneError
        If a value is not a real number in its range, or the pressure belongs to a separation that
        is not in [−10, 20] σ.

    Examples
    --------
    >>> layer = greenwood_williamson(
    ...     density=1e10,
    ...     tip_radius=5e-6,
    ...     height_deviation=0.4e-6,
    ...     youngs_modulus=200e9,
    ...     poisson_ratio=0.3,
    ...     pressure=10e6,
    ... )
    >>> print(f"{layer.normal_compliance:.4g} m/Pa, {layer.separation:.4g} m", layer.remarks)
    1.407e-14 m/Pa, 8.137e-07 m ()
    """
    units = {
        "density": (density, "m**-2"),
        "tip_radius": (tip_radius, "m"),
        "height_deviation": (height_deviation, "m"),
        "youngs_modulus": (youngs_modulus, "Pa"),
        "pressure": (pressure, "Pa"),
        "hardness": (hardness, "Pa"),
    }
    given = {
        name: positive(name, value, unit)
        for name, (value, unit) in units.items()
        if value is not None or name != "hardness"
    }
    nu = checked_poisson_ratio(poisson_ratio)
    eta, tip, sigma = (given[name] for name in ("density", "tip_radius", "height_deviation"))
    bearing = math.pi * eta * tip * sigma
    stiffness = 2.0 * eta * _reduced_modulus(given["youngs_modulus"], nu) * math.sqrt(tip * sigma)
    for meaning, value in (("πηRσ", bearing), ("2ηE*√(Rσ)", stiffness), ("σ", sigma)):
        if not _SMALLEST <= value <= _LARGEST:
            allowed = f"such that {meaning} is in [{_SMALLEST:g}, {_LARGEST:g}] in SI units"
            raise SceneError("density, tip_radius, height_deviation", (eta, tip, sigma), allowed)
    h = _separation(given["pressure"], 2.0 / 3.0 * stiffness * sigma)
    touching, overlap = _touching(h)
    alpha = 1.0 / (stiffness * _moment(2, h))
    return AsperityLayer(
        density=eta,
        tip_radius=tip,
        height_deviation=sigma,
        youngs_modulus=given["youngs_modulus"],
        poisson_ratio=nu,
        pressure=given["pressure"],
        hardness=given.get("hardness"),
        separation=h * sigma,
        normal_compliance=alpha,
        tangential_compliance=alpha * (2.0 - nu) / (2.0 * (1.0 - nu)),
        contact_fraction=bearing * overlap,
        touching_density=eta * touching,
    )


def _reduced_modulus(modulus: float, nu: float) -> float:
    """Return E* = E/(1 − ν²)."""
    return modulus / ((1.0 - nu) * (1.0 + nu))


def _moment(power: int, h: float) -> float:
    """Return ``∫_h^∞ (z − h)^{(power − 1)/2} φ(z) dz`` for an even power, φ of unit deviation.

    With z = h + w² it is ``∫ w^power exp(−(h + w²)²/2) dw/√(2π)`` over the real line, of an entire
    function that dies out: the trapezoidal rule converges geometrically, and cancels nothing.
    """
    reach = math.sqrt(math.sqrt(h * h + 80.0) - h)  # there it is e⁻⁴⁰ of what it was
    step = 0.125 / math.sqrt(1.0 + abs(h))
    w = step * np.arange(1.0, reach / step + 1.0)
    values = w**power * np.exp(-0.5 * (h + w * w) ** 2)
    return 2.0 * step / math.sqrt(2.0 * math.pi) * float(values.sum())


def _touching(h: float) -> tuple[float, float]:
    """Return ``∫_h^∞ φ(z) dz`` and ``∫_h^∞ (z − h) φ(z) dz``, φ of unit deviation."""
    from scipy.special import erfcx  # takes long to import

    density = math.exp(-0.5 * h * h) / math.sqrt(2.0 * math.pi)
    ratio = math.sqrt(0.5 * math.pi) * float(erfcx(h / math.sqrt(2.0)))
    return density * ratio, density * (1.0 - h * ratio)


def _separation(pressure: float, scale: float) -> float:
    """Return h = d/σ at which the pressure is ``scale`` times ``∫_h^∞ (z − h)^{3/2} φ(z) dz``."""
    from scipy.optimize import brentq  # takes long to import

    highest, lowest = (scale * _moment(4, h) for h in (_NEAREST, _FARTHEST))
    if not lowest < pressure < highest:
        allowed = f"in ({lowest:.4g}, {highest:.4g}) Pa, from which the separation is "
        allowed += f"{_FARTHEST:g} to {_NEAREST:g} height deviations"
        raise SceneError("pressure", pressure, allowed)
    target = math.log(pressure / scale)
    found = brentq(lambda h: math.log(_moment(4, h)) - target, _NEAREST, _FARTHEST, xtol=1e-14)
    return float(found)
