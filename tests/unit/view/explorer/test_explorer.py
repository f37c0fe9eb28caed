"""The explorer: what it shows of a state, its page without a browser, and in one."""

import asyncio
import math
import signal
import socket
import subprocess
import sys
import threading
import time
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import browser
import numpy as np
import pytest

import spectral_contact as sc
from spectral_contact import Scene, SceneError, profiles
from spectral_contact.solving.planning import plan
from spectral_contact.view.explorer.budget import refusal
from spectral_contact.view.explorer.look import look_at, tables_of
from spectral_contact.view.explorer.solver_processes import Solvers
from spectral_contact.view.explorer.state import (
    KNOBS,
    LONGEST_TEXT,
    code_of,
    query_of,
    scene_of,
    texts_from,
    texts_of,
)

SCENES = [
    Scene(0.1, 0.5, 0.5, 0.1),
    Scene(-0.3, 1e-12, 1e9, 0.123456789012345),
    Scene(0.3),
    Scene(0.3, 0.05, 1.0, math.inf, coupling=True),
    Scene(0.3, 0.5, profile=profiles.Sphere(2.0), load=0.7),
    Scene(0.3, profile=profiles.RoundedFlat(0.5, 1.0), contact_radius=0.8),
    Scene(0.5, 0.5, 0.1, 0.3, profile=profiles.PowerLaw(1.0, 3.5), approach=0.2),
]


# --- without a browser, and without Panel ---------------------------------------------------------


@pytest.mark.parametrize("scene", SCENES, ids=repr)
def test_a_link_and_the_python_lines_are_the_scene_again(scene):
    texts = texts_of(scene, 1e-7)
    assert scene_of(texts) == scene
    assert scene_of(texts_from(query_of(texts))) == scene
    lines, names = code_of(texts).splitlines(), {}
    assert lines[-1] == "solution = solve(scene, rtol=1e-07)"
    exec("\n".join(lines[:-1]), names)
    assert names["scene"] == scene


def test_the_python_lines_give_the_numbers_that_are_shown():
    texts = texts_from("?friction=0.07")
    look, names = look_at(texts, sc.solve), {}
    exec(look.code, names)
    assert names["solution"] == look.solution
    assert repr(names["solution"].stick_radius)[:9] in look.tables


def test_what_a_link_leaves_out_is_as_at_the_start():
    assert scene_of(texts_from("?normal_compliance=0.25")) == Scene(0.1, 0.25, 0.5, 0.1)
    assert texts_from("") == texts_of(None) == texts_of(Scene(0.1, 0.5, 0.5, 0.1))


@pytest.mark.parametrize(
    ("query", "complaint"),
    [
        ("?fricton=1", "did you mean friction?"),
        ("?profile=Sphre", "did you mean Sphere?"),
        ("?coupling=perhaps", "must be one of true, false"),
        ("?rtol=1e-20", "rtol = 1e-20: must be in"),
        ("?rtol=small", "rtol = 'small': must be"),
        (f"?friction={'9' * 50_000}", "must be at most 100 characters long"),
        (f"?{'f' * 50_000}=1", "must be at most 100 characters long"),
    ],
)
def test_a_link_that_means_nothing_is_refused(query, complaint):
    with pytest.raises(SceneError, match=complaint.replace("?", r"\?")):
        texts_from(query)


@pytest.mark.parametrize(
    ("query", "wrong"),
    [
        ("?friction=-1", {"friction": -1.0}),
        ("?friction=a lot", {"friction": "a lot"}),
        ("?poisson_ratio=0.7", {"poisson_ratio": 0.7}),
        ("?poisson_ratio=none", {"poisson_ratio": None, "friction": 0.1}),
        ("?normal_compliance=nan", {"normal_compliance": math.nan}),
        ("?normal_compliance=", {"normal_compliance": ""}),
        ("?load=1", {"load": 1.0}),
    ],
)
def test_a_bad_value_is_refused_in_the_words_of_the_library(query, wrong):
    with pytest.raises(SceneError) as refusal:
        Scene(**{"poisson_ratio": 0.1} | wrong)
    look = look_at(texts_from(query), sc.solve)
    assert look.complaint == str(refusal.value)
    assert (look.solution, look.columns, look.tables, look.code) == (None, None, "", "")


def test_a_contact_that_is_not_modelled_is_refused():
    query = "?profile=RoundedFlat&flat_radius=1&radius=1&contact_radius=0.5"
    told = "contact_radius = 0.5: must be finite, and in (1, inf), the range of the profile"
    assert look_at(texts_from(query), sc.solve).complaint == told


def test_the_fields_are_those_of_the_solution():
    look = look_at(texts_of(Scene(0.3, 0.05, 1.0, 0.23 / 7), 1e-6), sc.solve)
    solution = look.solution
    inside = look.columns["s"] < 0.5
    s = look.columns["s"][inside]
    for name, field in (("p", "pressure"), ("q", "traction"), ("slip", "slip")):
        shown = look.columns[name][inside]
        np.testing.assert_array_equal(shown, getattr(solution, field)(s))
    np.testing.assert_array_equal(look.columns["fp"], 0.23 / 7 * look.columns["p"])
    assert look.zones == ((solution.zones[1].inner, solution.zones[1].outer),)
    for word in ("zone search", "critical friction", "error estimate", "<svg"):
        assert word in look.tables
    for name, (low, high) in look.limits.items():
        assert name == "d" or low < high


def test_what_is_infinite_or_absent_is_not_drawn():
    smooth = look_at(texts_of(Scene(0.3)), sc.solve)
    assert np.isnan(smooth.columns["p"][-1])
    assert np.isfinite(smooth.columns["p"][:-1]).all()
    for name in ("q", "fp", "slip"):
        assert np.isnan(smooth.columns[name]).all()
    assert np.isfinite([limit for pair in smooth.limits.values() for limit in pair]).all()


def test_what_is_not_converged_is_said():
    capped = sc.solve(SCENES[0], 1e-12, max_unknowns=20, strict=False)
    assert not capped.converged
    assert "not converged" in tables_of(capped)


def test_a_number_is_refused_if_it_is_longer_than_any_number_needs():
    longest = texts_of(None) | {"friction": "0." + "1" * (LONGEST_TEXT - 2)}
    assert look_at(longest, sc.solve).complaint == ""
    longer = longest | {"friction": longest["friction"] + "1"}
    assert look_at(longer, sc.solve).complaint.endswith("must be at most 100 characters long")


@pytest.mark.parametrize("knob", KNOBS.values(), ids=KNOBS)
def test_a_slider_reaches_its_ends_and_the_start(knob):
    for value in (knob.low, float(knob.start), knob.high):
        assert float(knob.text(knob.place(repr(value)))) == pytest.approx(value, rel=1e-3)
    assert knob.place("no number") == knob.place("-1e9") == knob.place(repr(knob.low))
    assert knob.place("inf") == knob.place(repr(knob.high))
    assert knob.place("nan") == knob.place("1" * 10_000 + "x") == knob.place(repr(knob.low))


# --- solves in processes of their own -------------------------------------------------------------

DEAR = "?profile=PowerLaw&coefficient=1&exponent=3.5&load=1&coupling=true&rtol=1e-12"
#: It takes minutes as well, but nobody knows before it is solved.
SLOW = texts_from("?profile=PowerLaw&coefficient=1&exponent=3.5&load=1&coupling=true&rtol=3e-11")


@pytest.fixture
def solvers():
    """Return solvers whose processes are gone afterwards."""
    found = Solvers()
    yield found
    found.close()


def test_a_scene_that_is_too_dear_is_refused_with_the_lines_that_solve_it(solvers):
    look = solvers.request(texts_from(DEAR)).future.result(timeout=0.0)
    assert look.complaint.startswith("not solved here: the traction is a superposition")
    assert "at rtol = 1e-12 that takes some 600 s" in look.complaint
    assert look.code == code_of(texts_from(DEAR))
    assert (look.columns, look.tables) == (None, "")


@pytest.mark.parametrize("scene", SCENES, ids=repr)
@pytest.mark.parametrize("rtol", [1e-2, 1e-8, 1e-12])
def test_what_is_done_in_seconds_is_not_refused(scene, rtol):
    assert refusal(plan(scene), rtol) == ""


def test_a_process_solves_what_this_one_does(solvers):
    texts = texts_from("?friction=0.07")
    for _ in range(2):
        look, here = solvers.request(texts).future.result(timeout=60.0), look_at(texts, sc.solve)
        np.testing.assert_array_equal(look.columns["q"], here.columns["q"])
        assert (look.code, look.zones, look.limits) == (here.code, here.zones, here.limits)
        assert look.solution is None
    assert len(solvers._processes) == 1


def test_a_solve_ends_at_its_time_limit_and_the_next_is_solved():
    solvers = Solvers(seconds=2.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("spectral_contact.view.explorer.solver_processes.refusal", lambda *_: "")
        look = solvers.request(SLOW).future.result(timeout=60.0)
    assert look.complaint.startswith("ended after 2 s")
    assert look.code == code_of(SLOW)
    assert solvers.request(texts_of(None)).future.result(timeout=60.0).complaint == ""
    solvers.close()


def test_a_solve_that_is_cancelled_makes_room_for_the_next(solvers):
    slow, waits = solvers.request(SLOW), solvers.request(texts_of(None))
    until_now(lambda: slow._process is not None)
    process = slow._process
    assert not waits.future.done()
    slow.cancel()
    assert slow.future.result(timeout=0.0) is None
    assert waits.future.result(timeout=60.0).complaint == ""
    assert not process.alive
    slow.cancel()  # and does not end what its process would do now
    assert solvers.request(texts_of(None)).future.result(timeout=60.0).complaint == ""


def test_a_process_that_is_lost_is_replaced(solvers):
    request = solvers.request(SLOW)
    until_now(lambda: request._process is not None)
    request._process._process.kill()
    look = request.future.result(timeout=60.0)
    assert look.complaint.startswith("the process that solved this scene has ended")
    assert look.code == code_of(SLOW)

    assert solvers.request(texts_of(None)).future.result(timeout=60.0).complaint == ""
    (idle,) = solvers._processes
    idle._process.kill()
    idle._process.wait()
    assert solvers.request(texts_of(None)).future.result(timeout=60.0).complaint == ""


def test_no_process_outlives_its_solvers():
    solvers = Solvers()
    request = solvers.request(SLOW)
    until_now(lambda: request._process is not None)
    process = request._process._process
    solvers.close()
    assert process.wait(30.0) != 0
    assert request.future.result(timeout=30.0) is None


def until_now(condition):
    """Wait until a condition holds."""
    for _ in range(6000):
        if condition():
            return
        time.sleep(0.01)
    raise AssertionError("it never came")


# --- with Panel -----------------------------------------------------------------------------------


def test_the_page_follows_its_widgets_and_refuses_bad_values(solvers):
    pytest.importorskip("panel", reason="part of the extra: explore")
    from spectral_contact.view.explorer.page import Page

    asyncio.run(moves_the_page(Page, solvers))


async def moves_the_page(page_of, solvers):
    told = []
    page = page_of(texts_of(None), solvers, told.append)
    box, slider = page.controls.boxes["friction"], page.controls.sliders["friction"]
    await page.begin()
    assert "friction=0.1," in page.code.object
    told.clear()
    slider.value = math.log10(0.05)
    assert box.value == "0.05"
    await until(lambda: "friction=0.05" in page.code.object)
    await until(lambda: told)
    assert scene_of(texts_from(told[-1])).friction == 0.05

    box.value = "-3"
    await until(lambda: page.message.visible)
    assert page.message.object.startswith("friction = -3.0: must be &gt;= 0")
    assert "friction=0.05" in page.code.object

    box.value = "0.07"
    await until(lambda: "friction=0.07" in page.code.object)
    assert not page.message.visible
    assert slider.value == pytest.approx(math.log10(0.07))
    await until(lambda: len(told) == 2)
    assert ["friction=0.07" in one for one in told] == [False, True]


def test_a_later_state_ends_the_solve_of_the_one_before(solvers, monkeypatch):
    pytest.importorskip("panel", reason="part of the extra: explore")
    from spectral_contact.view.explorer import page as module

    monkeypatch.setattr(module, "_GRACE", 0.1)

    async def moves_on():
        page = module.Page(SLOW, solvers)
        solve = asyncio.ensure_future(page.begin())
        await until(lambda: page._waits.visible)
        await until(lambda: page._request._process is not None)
        page.controls.boxes["exponent"].value = "3"
        page.controls.boxes["exponent"].value = "none"
        await until(lambda: page.message.visible)
        assert page.message.object.startswith("exponent = None: must be")
        assert not page._waits.visible
        await solve

    asyncio.run(moves_on())


def test_a_page_that_is_left_solves_no_more(solvers):
    pytest.importorskip("panel", reason="part of the extra: explore")
    from spectral_contact.view.explorer.page import Page

    async def leaves():
        page = Page(SLOW, solvers)
        solve = asyncio.ensure_future(page.begin())
        await until(lambda: page._request is not None and page._request._process is not None)
        process = page._request._process
        page.close()
        await solve
        assert not process.alive

    asyncio.run(leaves())


def test_the_page_says_that_it_waits(solvers, monkeypatch):
    pytest.importorskip("panel", reason="part of the extra: explore")
    from spectral_contact.view.explorer.page import Page

    go, look = threading.Event(), solvers._look

    def slow(request):
        assert go.wait(60.0)
        return look(request)

    async def waits(page):
        monkeypatch.setattr(solvers, "_look", slow)
        page.controls.boxes["friction"].value = "0.3"
        await until(lambda: page._waits.visible)
        go.set()
        await until(lambda: "friction=0.3" in page.code.object)
        assert not page._waits.visible

    asyncio.run(waits(Page(texts_of(None), solvers)))


async def until(condition):
    for _ in range(6000):
        if condition():
            return
        await asyncio.sleep(0.01)
    raise AssertionError("it never came")


def test_a_page_begins_with_any_scene(solvers):
    pytest.importorskip("panel", reason="part of the extra: explore")
    from spectral_contact.view.explorer.page import Page

    for scene in SCENES:
        texts = texts_of(scene, 3e-7)
        assert Page(texts, solvers).texts == texts
    bare = Page(texts_of(Scene(0.3)), solvers)
    bare.show(bare.texts, look_at(bare.texts, sc.solve))
    drawn = [key for key, plot in bare._figures._plots.items() if plot.visible]
    assert drawn == [("p", "s"), ("p", "d")]
    with pytest.raises(SceneError, match="rtol"):
        sc.explore(rtol=1.0)
    bowl = profiles.Sampled.from_points([0.0, 0.5, 1.0], [0.0, 0.1, 0.4])
    with pytest.raises(SceneError, match="the profile to explore"):
        sc.explore(Scene(0.3, profile=bowl, contact_radius=0.5))


# --- served, and in a browser ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def address():
    """Return the address of an explorer that runs in another process."""
    pytest.importorskip("panel", reason="part of the extra: explore")
    command = [sys.executable, "-m", "spectral_contact", "explore", "--no-browser"]
    process = subprocess.Popen(
        [*command, "--friction", "0.2"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        yield process.stdout.readline().strip()
        process.send_signal(signal.SIGINT)
        assert process.wait(120) == 0
    finally:
        process.kill()
        process.communicate()


def test_the_page_is_for_this_machine_alone(address):
    """The socket is bound to 127.0.0.1 alone, and pages from elsewhere may not talk to it."""
    from tornado.httpclient import HTTPClientError, HTTPRequest
    from tornado.websocket import websocket_connect

    assert address.startswith("http://127.0.0.1:")
    port = int(address.split(":")[2].split("/")[0])
    socket.create_connection(("127.0.0.1", port), 5.0).close()
    with pytest.raises(OSError):  # noqa: PT011 (refused, or no such place, as systems say)
        socket.create_connection(("127.0.0.2", port), 5.0)

    async def connect(origin):
        request = HTTPRequest(f"ws://127.0.0.1:{port}/ws", headers={"Origin": origin})
        await websocket_connect(request, subprotocols=["bokeh", "no token"])

    with pytest.raises(HTTPClientError, match="403"):
        asyncio.run(connect("http://elsewhere.example"))


def test_what_comes_from_elsewhere_is_refused(address):
    """Pages elsewhere can make a browser send requests here, under a name that leads here, too."""
    host = address.split("/")[2]
    port = host.partition(":")[2]
    assert status(address) == 200
    assert status(address, {"Host": f"localhost:{port}"}) == 200
    for name in ("elsewhere.example", f"elsewhere.example:{port}", "127.0.0.1", "127.0.0.1:1"):
        assert status(address, {"Host": name}) == 403
        assert status(f"http://{host}/static/js/bokeh.min.js", {"Host": name}) == 403
    assert status(address, {"Origin": f"http://{host}"}) == 200
    assert status(address, {"Origin": "http://elsewhere.example"}) == 403
    assert status(address, {"Origin": "null"}) == 403
    cross = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Dest": "iframe"}
    assert status(address, cross) == 403
    assert status(address, cross | {"Sec-Fetch-Dest": "document"}) == 200  # a link


@pytest.mark.parametrize(
    ("query", "reason"),
    [
        ("friction=" + "9" * 50_000, "at most 2000 characters"),
        ("friction=" + "9" * 101, "at most 100 characters long"),
        ("f" * 101 + "=1", "at most 100 characters long"),
        ("friction=%C2%B2", "friction = '²': must be plain ASCII text"),
    ],
    ids=["query", "number", "name", "digit"],
)
def test_an_address_that_nobody_reads_is_refused(address, query, reason):
    with pytest.raises(HTTPError) as refusal:
        urlopen(f"{address.split('?')[0]}?{query}", timeout=60.0)
    assert refusal.value.code == 400
    assert reason in refusal.value.read().decode()


def test_a_dear_address_holds_up_nobody(address):
    start = time.monotonic()
    assert status(address.split("?")[0] + DEAR) == 200
    assert status(address.split("?")[0] + query_of(SLOW)) == 200
    assert status(address) == 200
    assert time.monotonic() - start < 60.0


def status(address, headers=None):
    """Return the status that a server answers with."""
    try:
        with urlopen(Request(address, headers=headers or {}), timeout=60.0) as answer:
            return answer.status
    except HTTPError as refusal:
        return refusal.code


@pytest.mark.skipif(browser.found() is None, reason="no Chromium: not opened in a browser")
def test_in_a_browser_all_of_it_works(address):
    with browser.browser() as host:
        asyncio.run(asyncio.wait_for(opens_the_page(host, address), 300.0))


MODELS = "[...Bokeh.documents[0]._all_models.values()]"
SLIDERS = MODELS + ".filter(one => one.type === 'Slider')"


async def opens_the_page(host, address):
    async with browser.tab(host) as tab:
        await uses_the_page(tab, address)


async def uses_the_page(tab, address):
    await tab.size(*browser.PHONE)
    await tab.open(address)
    await tab.until(f"{SLIDERS}.length > 0")
    assert "friction=0.2" in await said(tab, "critical friction")
    assert await tab.run("document.documentElement.scrollWidth") == browser.PHONE[0]

    await tab.run(f"{SLIDERS}[3].value = Math.log10(0.05)")
    await tab.until("location.search.includes('friction=0.05')")
    text = await said(tab, "friction=0.05,")
    c = sc.solve(Scene(0.1, 0.5, 0.5, 0.05), 1e-8).stick_radius
    assert f"{c:.9f}"[:-1] in text

    await tab.run("navigator.clipboard.writeText = text => { window.copied = text; }")
    await tab.click("copy Python")
    await tab.until("window.copied?.includes('friction=0.05,')")
    await tab.click("copy link")
    await tab.until("window.copied === location.href")

    query = await tab.run("location.search")
    await tab.open(address.split("?")[0] + query.replace("poisson_ratio=0.1", "poisson_ratio=0.7"))
    await said(tab, "poisson_ratio = 0.7: must be in (-1, 0.5]")

    await tab.open(address.split("?")[0] + DEAR)
    await said(tab, "not solved here: the traction is a superposition")
    assert "solution = solve(scene, rtol=1e-12)" in await tab.text()
    assert [one for one in tab.requests if "127.0.0.1" not in one and "data:" not in one] == []


async def said(tab, words):
    """Return what can be read on the page as soon as the words are there."""
    for _ in range(1200):
        text = await tab.text()
        if words in text:
            return text
        await asyncio.sleep(0.05)
    raise AssertionError(f"{words!r} never came: {text}")
