"""Write the benchmarks to cite: ``python validation/make_benchmarks.py``.

Reads validation/benchmarks.toml, computes the numbers and the fields, and replaces the data of
`spectral_contact.gold.benchmarks` and the pages of docs/benchmarks_to_cite, whose index is
validation/benchmarks.md with a table. Check numbers are closed forms, references to 20 digits, or
solves at 1e-12; it takes some five minutes. With ``--pages`` only pages and figures are written.
"""

from __future__ import annotations

import hashlib
import json
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpmath import mp
from reporting import options

import spectral_contact
from spectral_contact import Scene, Solution, benchmarks, solve
from spectral_contact.gold.benchmarks.benchmark_page import page
from spectral_contact.precise import reference
from spectral_contact.view import plotting
from spectral_contact.view.plotting import graded_radii

HERE = Path(__file__).parent
DATA = Path(benchmarks.__file__).parent / "data"
PAGES = HERE.parent / "docs" / "benchmarks_to_cite"
LINK = "../../spectral_contact/gold/benchmarks/data/"
RATIOS = (0.0, 0.1, 0.2, 0.3, 0.4)
SYMBOLS = {
    **{"approach": "δ*", "total_shear": "Q*", "edge_pressure": "p*(1)", "stick_radius": "c*"},
    **{"slip_from": "s₁", "slip_to": "s₂", "stiffness_ratio": "k/k₀"},
}
RTOL = 1e-12
PENALTY = 1e5  # stiffness of a contact that is meant to be rigid, in E/a


def main() -> None:
    """Write everything, or the pages alone."""
    if not options(__doc__, pages=False).pages:
        write_data(tomllib.loads((HERE / "benchmarks.toml").read_text(encoding="utf-8")))
    write_pages()


def write_data(written: dict[str, Any]) -> None:
    """Compute all numbers and fields, and write them with their checksums."""
    DATA.mkdir(exist_ok=True)
    names = [one["name"] for one in written["problem"]]
    files = {"index.json": as_json({"names": names})}
    for problem in written["problem"]:
        print(problem["name"], flush=True)
        scene = Scene(**problem["scene"])
        solution = solve(scene, RTOL)
        files[f"{problem['name']}.csv"] = table(solution)
        files[f"{problem['name']}.json"] = as_json(document(problem, scene, solution, written))
    for old in DATA.iterdir():
        old.unlink()
    for name, text in files.items():
        (DATA / name).write_bytes(text.encode())
    sums = [f"{hashlib.sha256(text.encode()).hexdigest()}  {name}" for name, text in files.items()]
    (DATA / "SHA256SUMS").write_text("\n".join(sums) + "\n", encoding="ascii")


def as_json(body: dict[str, Any]) -> str:
    """Return a document as text."""
    return json.dumps(body, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def document(
    problem: dict[str, Any], scene: Scene, solution: Solution, written: dict[str, Any]
) -> dict[str, Any]:
    """Return what is stored of a problem, but for the fields."""
    numbers = Numbers(scene, solution)
    check, *values = (numbers.stored(one) for one in problem["quantities"])
    friction = "inf" if scene.friction == math.inf else scene.friction
    names = ("poisson_ratio", "normal_compliance", "tangential_compliance")
    return {
        "schema": "spectral_contact.benchmark",
        "version": benchmarks.VERSION,
        "name": problem["name"],
        "script": "validation/make_benchmarks.py",
        "library": spectral_contact.__version__,
        "scene": {
            **{one: getattr(scene, one) for one in names},
            "friction": friction,
            "coupling": scene.coupling,
        },
        **{one: problem[one] for one in ("title", "about", "source")},
        "check": check,
        **{one: problem[one] for one in ("tolerance", "tolerance_of")},
        "values": values,
        "stiffness": [stiffness(nu, f) for f in problem.get("stiffness", []) for nu in RATIOS],
        "recipes": [recipe(one, written, scene) for one in problem["recipes"]],
    }


class Numbers:
    """The scalars of a scene, each from the best source there is."""

    def __init__(self, scene: Scene, solution: Solution) -> None:
        self._scene, self._solution = scene, solution
        smooth = scene.normal_compliance == scene.tangential_compliance == 0.0
        slips = scene.friction not in (None, math.inf)
        self._precise = None
        if not (smooth and not slips) and not (scene.coupling and slips):
            self._precise = reference(scene, 20)

    def stored(self, quantity: str) -> dict[str, str]:
        """Return a number as it is stored."""
        closed = self._closed(quantity)
        where, found = self._computed(quantity) if closed is None else ("closed form", closed)
        digits = 18
        if where.startswith("solve"):
            digits = math.floor(-math.log10(self._error(quantity)))
        text = mp.nstr(found, digits, strip_zeros=where == "closed form")
        return {"quantity": quantity, "symbol": SYMBOLS[quantity], "text": text, "where": where}

    def _closed(self, quantity: str) -> Any:
        """Return the value at a smooth surface, if there is a formula."""
        scene = self._scene
        nu = mp.mpf(scene.poisson_ratio)
        if scene.normal_compliance or scene.tangential_compliance:
            return None
        if not scene.coupling:
            shear = 2 * kappa(nu) * mp.log(2) if scene.friction == math.inf else None
            return {"approach": mp.mpf(1) / 8, "total_shear": shear}.get(quantity)
        if scene.friction != math.inf:
            return None
        ratio = bonded_ratio(nu)
        return {"stiffness_ratio": ratio, "approach": 1 / (8 * ratio)}.get(quantity)

    def _computed(self, quantity: str) -> tuple[str, Any]:
        if self._precise is None:
            return f"solve at {RTOL:g}", self._read(quantity, self._solution)
        return "reference to 20 digits", self._read(quantity, self._precise)

    def _read(self, quantity: str, found: Any) -> Any:
        readers: dict[str, Callable[[], Any]] = {
            "stiffness_ratio": lambda: 1 / (8 * found.approach),
            "edge_pressure": lambda: found.pressure(from_edge=0.0),
            "stick_radius": lambda: found.zones[0].outer,
            "slip_from": lambda: found.zones[1].inner,
            "slip_to": lambda: found.zones[1].outer,
        }
        return mp.mpf(readers.get(quantity, lambda: getattr(found, quantity))())

    def _error(self, quantity: str) -> float:
        name = {"stiffness_ratio": "approach"}.get(quantity, quantity)
        return float(getattr(self._solution.error, name))


def kappa(nu: Any) -> Any:
    """Return (1 - 2 nu)/(4 (1 - nu))."""
    return (1 - 2 * nu) / (4 * (1 - nu))


def bonded_ratio(nu: Any) -> Any:
    """Return k/k0 of the bonded smooth punch, Mossakovskij's."""
    return (1 - nu) * mp.log(3 - 4 * nu) / (1 - 2 * nu)


def stiffness(nu: float, friction: float) -> dict[str, Any]:
    """Return an entry of the table k(f, nu)/k0."""
    if friction == math.inf:
        text = mp.nstr(bonded_ratio(mp.mpf(nu)), 15, strip_zeros=False)
    else:
        found = solve(Scene(nu, friction=friction, coupling=True), 1e-11, ["approach"])
        text = f"{0.125 / found.approach:#.11g}"
    stored = "inf" if friction == math.inf else friction
    return {"poisson_ratio": nu, "friction": stored, "text": text}


def recipe(name: str, written: dict[str, Any], scene: Scene) -> dict[str, Any]:
    """Return a recipe with the numbers of a scene, and the words for its contact."""
    nu, alpha, beta = scene.poisson_ratio, scene.normal_compliance, scene.tangential_compliance
    modulus = 4 * (1 - nu**2)
    numbers = {
        **{"nu": nu, "alpha": alpha, "beta": beta, "friction": scene.friction},
        **{"modulus": f"{modulus:.12g}", "shear": f"{2 * (1 - nu):.12g}"},
        "slope": 1 / alpha if alpha else PENALTY * modulus,
        "stick_slope": 1 / beta if beta else math.inf,
        "penalty": PENALTY * modulus,
    }
    kinds = (
        "rough" if alpha else "smooth",
        "tangential" if beta else "not tangential",
        {None: "without friction", math.inf: "bonded"}.get(scene.friction, "slips"),
    )
    words = {}
    for kind in kinds:
        words |= {key: text.format(**numbers) for key, text in written["words"][kind].items()}
    one = written["recipe"][name]
    text = one["text"].format(**numbers, **words)
    return {"code": one.get("code", name), "tried": one.get("tried", False), "text": text}


def table(solution: Solution) -> str:
    """Return the fields as csv, to 13 digits; infinite at the edge where they are."""
    radii = graded_radii(solution, 100)
    scene = solution.scene
    columns = {"s": radii.s, "one_minus_s": radii.from_edge, "p": radii.evaluate(solution.pressure)}
    if scene.friction is not None:
        columns["q"] = radii.evaluate(solution.traction)
        if scene.friction != math.inf:
            columns["slip"] = radii.evaluate(solution.slip)
    lines = [f"# spectral_contact benchmark, version {benchmarks.VERSION}", ",".join(columns)]
    # between zones the traction has a vertical tangent: no digits there are worth comparing
    between = {zone.outer_from_edge for zone in solution.zones} - {0.0}
    for s, d, *values in zip(*(column.tolist() for column in columns.values()), strict=True):
        # with coupling there is no limit at a smooth edge
        if d not in between and not any(map(math.isnan, values)):
            lines.append(",".join([repr(s), repr(d), *(f"{one:.13g}" for one in values)]))
    return "\n".join(lines) + "\n"


def write_pages() -> None:
    """Write a page and a figure for each benchmark."""
    PAGES.mkdir(exist_ok=True)
    for name in benchmarks.names():
        one = benchmarks.load(name)
        figure = plotting.plot_solution(solve(one.scene, 1e-8))
        plotting.save(figure, PAGES / f"{name}.png")
        text = page(one, f"{name}.png", LINK)
        (PAGES / f"{name}.md").write_text(text, encoding="utf-8")
    rows = [index_row(benchmarks.load(name)) for name in benchmarks.names()]
    index = (HERE / "benchmarks.md").read_text(encoding="utf-8")
    (PAGES / "index.md").write_text(index.replace("{table}", "\n".join(rows)), encoding="utf-8")


def index_row(one: benchmarks.Benchmark) -> str:
    """Return a benchmark in the table of all."""
    check = f"{one.check.symbol} = {one.check.text}"
    return f"| [{one.name}]({one.name}.md) | {one.title} | {check} | {one.tolerance:g} |"


if __name__ == "__main__":
    main()
