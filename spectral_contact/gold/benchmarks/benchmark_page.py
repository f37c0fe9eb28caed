"""The page of a benchmark, as Markdown: everything that an outsider needs to run it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from spectral_contact.scene import Scene

if TYPE_CHECKING:  # a benchmark writes its page when asked to
    from spectral_contact.gold.benchmarks.benchmark_loader import Benchmark, Stiffness

#: The instance in SI units: Young's modulus [Pa], radius [m], load [N].
_E, _A, _P = 210e9, 10e-3, 1e3
_SHORT = {
    "approach": "rigid approach",
    "total_shear": "measure of shear",
    "edge_pressure": "pressure at the edge",
    "stick_radius": "outer radius of the central stick zone",
    "slip_from": "inner radius of the slip annulus",
    "slip_to": "outer radius of the slip annulus",
    "stiffness_ratio": "normal stiffness over that without friction",
}


def page(benchmark: Benchmark, figure: str | None = None, data: str = "") -> str:
    """Return the page of a benchmark.

    Parameters
    ----------
    benchmark : Benchmark
    figure : str, optional
        Path of its figure, for a link.
    data : str
        Folder of its tables, for the links: empty if it is that of the page.
    """
    parts = [
        f"# {benchmark.title}",
        f"`{benchmark.name}`, version {benchmark.version}. {benchmark.about}",
        "## The problem, with dimensions",
        _dimensional(benchmark.scene),
        "## The problem, without dimensions",
        _dimensionless(benchmark.scene),
        "## The number to compare",
        _numbers(benchmark),
        *([_stiffness(benchmark.stiffness)] if benchmark.stiffness else []),
        "## The fields",
        *([f"![The fields]({figure})"] if figure else []),
        _fields(benchmark, data),
        "## In other codes",
        _UNITS.format(modulus=_short(4.0 * (1.0 - _nu(benchmark.scene) ** 2))),
        *(_recipe(one.code, one.tried, one.text) for one in benchmark.recipes),
        "## Source",
        f"{benchmark.source} Cite it as *spectral_contact benchmark {benchmark.name}, version "
        f"{benchmark.version}*.",
    ]
    return "\n\n".join(parts) + "\n"


_UNITS = (
    "With a = 1, P = 1 and E = 4 (1 − ν²) = {modulus}, in consistent units, every number that a "
    "code prints is the dimensionless one. The recipes use these values."
)


def _nu(scene: Scene) -> float:
    """Return Poisson's ratio, which every benchmark has."""
    assert scene.poisson_ratio is not None
    return scene.poisson_ratio


def _dimensional(scene: Scene) -> str:
    unit = 4.0 * (1.0 - _nu(scene) ** 2) * _A / _E
    compliances = {"α": scene.normal_compliance, "β": scene.tangential_compliance}
    given = "".join(f", {one} = {_short(x * unit)} m/Pa" for one, x in compliances.items() if x)
    lines = [
        "A rigid cylinder with a flat end of radius a is pressed by a normal force P on the "
        "half-space z > 0, which is elastic with Young's modulus E and Poisson's ratio ν. "
        "The punch does not tilt, and the surface is free outside of it. p is the pressure, "
        "q the radial traction that pushes the half-space outward, u_z and u_r are displacements "
        "of the half-space's surface, inward into it and away from the axis. For r < a:",
        *_conditions(scene),
        "For example in SI: E = 210 GPa, "
        f"ν = {scene.poisson_ratio!r}, a = 10 mm, P = 1 kN{given}"
        f"; there P/a² = 10 MPa and 4 (1 − ν²) P/(aE) = {_short(unit * _P / _A**2)} m.",
    ]
    return "\n\n".join(lines)


def _conditions(scene: Scene) -> list[str]:
    """Return the boundary conditions, and what the model leaves out."""
    normal = "u_z = δ" if not scene.normal_compliance else "u_z + α p = δ, α being a compliance"
    if scene.friction is None:
        return [f"- {normal};\n- q = 0, there is no friction."]
    held = "u_r = 0" if not scene.tangential_compliance else "u_r + β q = 0"
    lines = [f"- {normal};"]
    if scene.friction == math.inf:
        lines.append(f"- {held} everywhere (bonded).")
    else:
        lines.append(f"- {held} in stick, where |q| ≤ f p;")
        lines.append(
            "- q = f p in slip, where the slip u_r + β q is inward (negative); "
            f"f = {scene.friction!r}."
        )
    effect = (
        "Pressure and traction act on each other in full, as in any elastic body, and the contact "
        "does not open. The load grows from zero, and all fields are proportional to it, so one "
        "load step suffices."
        if scene.coupling
        else "The effect of q on u_z is left out, as in Goodman's approximation; that of p on u_r "
        "is not. So solve for p first, and then for q with p given."
    )
    return ["\n".join(lines), effect]


def _dimensionless(scene: Scene) -> str:
    rows = [("ν", scene.poisson_ratio), ("α* = αE/(4(1−ν²)a)", scene.normal_compliance)]
    if scene.friction is not None:
        rows.append(("β* = βE/(4(1−ν²)a)", scene.tangential_compliance))
        rows.append(("f", scene.friction))
    table = "\n".join(
        f"| {label} | {'∞ (bonded)' if value == math.inf else repr(value)} |"
        for label, value in rows
    )
    equations = ["α* p* + N p* = δ*,  2π∫₀¹ p* s ds = 1,  N p = (1/π)∫₀¹ K₁(η, s) p(η) dη"]
    if scene.coupling:
        equations[0] = equations[0].replace(" = δ*", " − κ∫ₛ¹ q* dη = δ*")
    if scene.friction is not None:
        equations.append(
            "β* q* + T q* = κ (1/s)∫₀ˢ η p* dη in stick,  T q = (1/π)∫₀¹ K₂(η, s) q(η) dη,  "
            "κ = (1−2ν)/(4(1−ν))"
        )
    kernels = "K₁ = (η/hi) K(ρ), K₂ = (η/lo) (K(ρ) − E(ρ)), lo and hi the smaller and the larger "
    kernels += "of η and s, ρ = lo/hi the modulus of the complete elliptic integrals."
    return (
        "Lengths in a, tractions in P/a², displacements in 4(1−ν²)P/(aE); s = r/a.\n\n"
        f"| parameter | value |\n|---|---|\n{table}\n\n"
        + "\n".join(f"    {one}" for one in equations)
        + f"\n\n{kernels}"
    )


def _numbers(benchmark: Benchmark) -> str:
    check = benchmark.check
    first = (
        f"**`{check.symbol} = {check.text}`** ({_SHORT[check.quantity]}; {check.where}).\n\n"
        f"A code passes if its relative difference is below {benchmark.tolerance:g}. "
        f"That takes {benchmark.tolerance_of}"
    )
    if not benchmark.values:
        return first
    rows = "\n".join(
        f"| {_SHORT[one.quantity]}, {one.symbol} | {one.text} | {one.where} |"
        for one in benchmark.values
    )
    return f"{first}\n\nFurther numbers:\n\n| quantity | value | from |\n|---|---|---|\n{rows}"


def _stiffness(values: tuple[Stiffness, ...]) -> str:
    """Return the table of k/k₀, a row for each Poisson's ratio."""
    frictions = sorted({one.friction for one in values})
    ratios = sorted({one.poisson_ratio for one in values})
    found = {(one.poisson_ratio, one.friction): one.text for one in values}
    heads = " | ".join("bonded" if f == math.inf else f"f = {f:g}" for f in frictions)
    rows = [f"| {nu:g} | {' | '.join(found[nu, f] for f in frictions)} |" for nu in ratios]
    return (
        "Normal stiffness k = P/δ over k₀ = 2aE/(1−ν²), that of the same punch without friction, "
        "k/k₀ = 1/(8 δ*):\n\n"
        f"| ν | {heads} |\n|---|{'---|' * len(frictions)}\n" + "\n".join(rows)
    )


def _fields(benchmark: Benchmark, data: str) -> str:
    columns = list(benchmark.fields())
    files = [f"[{benchmark.name}{end}]({data}{benchmark.name}{end})" for end in (".csv", ".json")]
    fields = "p* and q*" if "q" in columns else "p*"
    text = (
        f"{files[0]} has the columns `{', '.join(columns)}`: s = r/a; 1 − s without cancellation; "
        f"{fields}"
    )
    if "slip" in columns:
        text += "; slip is u_r* + β* q*, inward negative"
    if benchmark.scene.couples:
        errors = "The errors of p* and q* are below 1e-10 of `√(p*² + (q*/s)²)`"
    else:
        errors = f"The relative error of {fields} is below 1e-10"
    return f"{text}. {errors}. {files[1]} has all other numbers."


def _recipe(code: str, tried: bool, text: str) -> str:
    return f"**{code}** ({'tried' if tried else 'untested starting point'}). {text}"


def _short(number: float) -> str:
    return f"{number:.12g}"
