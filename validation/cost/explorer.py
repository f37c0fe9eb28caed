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
from timed import TABLE

from spectral_contact import solve
from spectral_contact.view.explorer.look import look_at
from spectral_contact.view.explorer.page import Page
from spectral_contact.view.explorer.solver_processes import LookRequest, Solvers
from spectral_contact.view.explorer.state import KNOBS, texts_from

MOVES, SECONDS = 30, 4.0
TOLERANCES = ("1e-4", "1e-6", "1e-8", "1e-10", "1e-12")
LONGEST_SOLVE = 600.0
SHOWN = "?poisson_ratio=0.3&normal_compliance=0.05&tangential_compliance=1&friction=0.0328"
IS_READY = "[...Bokeh.documents[0]._all_models.values()].some(one => one.type === 'Slider')"
DRIVE = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")


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
        for case in TABLE["explorer"]:
            await tab.open(address + case["scene"])
            await tab.until(IS_READY)
            await asyncio.sleep(1.0)
            name, *ends = case["moved"]
            low, high = (KNOBS[name].place(repr(one)) for one in ends)
            which = list(KNOBS).index(name)
            rates.append(await tab.run(f"({DRIVE})({which}, {SECONDS}, {low}, {high})"))
        await tab.open(address + SHOWN)
        await tab.until(IS_READY)
        await asyncio.sleep(1.0)
        await tab.picture(DOCS / "explorer.png", whole=False)
    return rates


def budget() -> None:
    """Print the median time of a solve of each kind to each tolerance, in seconds."""
    solvers = Solvers(seconds=LONGEST_SOLVE)
    for kind, queries in TABLE["budget"].items():
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
    cases = TABLE["explorer"]
    times = [in_the_server(case["scene"], *case["moved"]) for case in cases]
    rates = [math.nan] * len(cases)
    if browser.found() is not None:
        with served() as address, browser.browser() as host:
            rates = asyncio.run(in_a_browser(host, address))
    rows = (
        (case["what"], f"{1e3 * median(one):.0f}", f"{1e3 * max(one):.0f}", f"{rate:.0f}")
        for case, one, rate in zip(cases, times, rates, strict=True)
    )
    heading = "what is moved | server, median [ms] | server, worst [ms] | shown in a browser [1/s]"
    write("explorer", table(heading, rows))


if __name__ == "__main__":
    budget() if "--budget" in sys.argv[1:] else main()
