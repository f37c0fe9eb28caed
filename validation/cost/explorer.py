"""Time the explorer, and take its picture: python validation/cost/explorer.py [--budget].

Writes validation/results/explorer.md, and docs/explorer.png if there is a Chromium. Timed is what
the server does for one move of a slider: the solve, the fields, the tables, and the update of the
page, in processor time; and how many scenes a second a browser on the same machine shows.
"""

from __future__ import annotations

import asyncio
import math
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
sys.path.append(str(Path(__file__).parents[2] / "tests"))

import browser
from reporting import DOCS, table, write

from spectral_contact import solve
from spectral_contact.view.explorer.look import look_at
from spectral_contact.view.explorer.page import Page
from spectral_contact.view.explorer.solver_processes import LookRequest, Solvers
from spectral_contact.view.explorer.state import KNOBS, texts_from

#: What is moved, from where to where, in which scene.
CASES = {
    "friction, one stick disk": ("?", "friction", 0.01, 0.3),
    "normal compliance": ("?", "normal_compliance", 1e-3, 10.0),
    "Poisson's ratio": ("?", "poisson_ratio", 0.0, 0.5),
    "friction, slip in an annulus": (
        "?poisson_ratio=0.3&normal_compliance=0.05&tangential_compliance=1",
        "friction",
        0.025,
        0.04,
    ),
    "friction, elastic coupling": ("?coupling=true", "friction", 0.01, 0.3),
    "load of a sphere": ("?profile=Sphere&radius=2&load=1&friction=none", "load", 0.1, 3.0),
    "load of a sphere, friction": ("?profile=Sphere&radius=2&load=1", "load", 0.1, 3.0),
}
MOVES, SECONDS = 30, 4.0
#: The scenes whose times are the budget: a flat punch, and contacts that grow.
BUDGET = {
    "flat": ("?", "?normal_compliance=0.001&tangential_compliance=0.01"),
    "growing": (
        "?profile=Parabola&radius=1&load=1",
        "?profile=Cone&half_angle=1.2&load=1",
        "?profile=PowerLaw&coefficient=1&exponent=3.5&load=1",
    ),
}
TOLERANCES = ("1e-4", "1e-6", "1e-8", "1e-10", "1e-12")
LONGEST_SOLVE = 600.0
SHOWN = "?poisson_ratio=0.3&normal_compliance=0.05&tangential_compliance=1&friction=0.0328"
SLIDERS = "[...Bokeh.documents[0]._all_models.values()].filter(one => one.type === 'Slider')"
#: Moves a slider to and fro at 60 Hz, and counts how often the fields change.
DRIVE = """new Promise(done => {
  const slider = %s[%d], start = performance.now();
  const fields = [...Bokeh.documents[0]._all_models.values()].find(
    one => one.type === "ColumnDataSource" && "slip" in one.data);
  let shown = 0;
  fields.properties.data.change.connect(() => { shown += 1; });
  const move = () => {
    const t = (performance.now() - start) / 1e3;
    if (t > %f) return done(shown / t);
    slider.value = %f + (%f) * (0.5 - 0.5 * Math.cos(1.7 * t));
    setTimeout(move, 16);
  };
  move();
})"""


def in_the_server(query: str, name: str, low: float, high: float) -> list[float]:
    """Return the seconds of each move."""
    texts = texts_from(query)
    page = Page(texts, Solvers())
    page.view.get_root()
    found = []
    for value in np.geomspace(low or 0.01, high, MOVES):
        moved = {**texts, name: f"{value:.4g}"}
        start = process_time()
        page.show(moved, look_at(moved, solve))
        found.append(process_time() - start)
    return found


@contextmanager
def served():
    """Yield the address of an explorer in a process of its own."""
    command = [sys.executable, "-m", "spectral_contact", "explore", "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield process.stdout.readline().split("?")[0]
    finally:
        process.terminate()
        process.communicate()


async def in_a_browser(host: str, address: str) -> list[float]:
    """Return how many scenes a second are shown in each case; take the picture."""
    rates = []
    async with browser.tab(host) as tab:
        await tab.size(1280, 1100)
        for query, name, low, high in CASES.values():
            await tab.open(address + query)
            await tab.until(f"{SLIDERS}.length > 0")
            await asyncio.sleep(1.0)
            low, high = (KNOBS[name].place(repr(one)) for one in (low, high))
            which = list(KNOBS).index(name)
            rates.append(await tab.run(DRIVE % (SLIDERS, which, SECONDS, low, high - low)))
        await tab.open(address + SHOWN)
        await tab.until(f"{SLIDERS}.length > 0")
        await asyncio.sleep(1.0)
        await tab.picture(DOCS / "explorer.png", whole=False)
    return rates


def budget() -> None:
    """Print the median time of a solve of each kind to each tolerance, in seconds."""
    solvers = Solvers(seconds=LONGEST_SOLVE)
    for kind, queries in BUDGET.items():
        for coupling in ("false", "true"):
            for rtol in TOLERANCES:
                seconds = []
                for query in queries:
                    texts = {**texts_from(query), "coupling": coupling, "rtol": rtol}
                    start = perf_counter()
                    # past the refusal that this is measured for
                    solvers.serve(LookRequest(texts))
                    seconds.append(perf_counter() - start)
                print(
                    f"{kind}, coupling={coupling}, rtol={rtol}: {median(seconds):.2f}", flush=True
                )


def main() -> None:
    """Time all cases and write the table."""
    times = [in_the_server(*case) for case in CASES.values()]
    rates = [math.nan] * len(CASES)
    if browser.found() is not None:
        with served() as address, browser.browser() as host:
            rates = asyncio.run(in_a_browser(host, address))
    rows = (
        (name, f"{1e3 * median(one):.0f}", f"{1e3 * max(one):.0f}", f"{rate:.0f}")
        for name, one, rate in zip(CASES, times, rates, strict=True)
    )
    heading = "what is moved | server, median [ms] | server, worst [ms] | shown in a browser [1/s]"
    write("explorer", table(heading, rows))


if __name__ == "__main__":
    budget() if "--budget" in sys.argv[1:] else main()
