"""The explorer served on this machine alone, to pages of its own."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import Callable, Collection
from typing import Any, Final
from urllib.parse import parse_qsl

from spectral_contact.errors import SceneError, optional
from spectral_contact.io.checks import whole
from spectral_contact.scene import Scene
from spectral_contact.view.explorer.page import Page
from spectral_contact.view.explorer.solver_processes import Solvers
from spectral_contact.view.explorer.state import check_length, query_of, texts_from, texts_of

#: The loopback address: nobody else on the network reaches the page.
ADDRESS: Final = "127.0.0.1"
#: What the page's own address may call this machine.
_NAMES: Final = (ADDRESS, "localhost")
#: The longest query of an address. One with every parameter to 17 digits has 400 characters.
_LONGEST_QUERY: Final = 2000
_TEMPLATE: Final = """
{% extends base %}
{% block preamble %}
<meta name="viewport" content="width=device-width, initial-scale=1">
{% endblock %}
{% block contents %}{{ embed(roots.explorer) }}{{ embed(roots.location) }}{% endblock %}
"""


def serve(
    scene: Scene | None = None,
    *,
    started: Callable[[str], object],
    rtol: float | None = None,
    port: int = 0,
    show: bool = True,
) -> None:
    """Serve the explorer on the loopback address until it is interrupted.

    Parameters
    ----------
    scene, rtol
        As of `explore`.
    started : callable
        Is told the address when the page can be opened.
    port : int
        0 is any that is free.
    show : bool
        Whether to open it in the user's browser.

    Raises
    ------
    SceneError
        As `explore` does, and for a port that cannot be had.
    MissingDependencyError
        If Panel is not installed (extra: explore).
    """
    query = query_of(texts_of(scene, rtol))
    panel = optional("panel", "explore")
    port = _free_port(port)
    hosts = [f"{name}:{port}" for name in _NAMES]
    solvers = Solvers(os.cpu_count() or 1)
    server = panel.io.server.get_server(
        {"/": lambda: _session(panel, solvers)},
        port=port,
        address=ADDRESS,
        websocket_origin=hosts,
        title="spectral_contact explorer",
        index=None,
    )
    _refuse_strangers(server, hosts)
    solvers.warm()
    address = f"http://{ADDRESS}:{port}/{query}"
    server.io_loop.asyncio_loop.set_exception_handler(_unless_gone)
    server.start()
    started(address)
    if show:
        import webbrowser

        webbrowser.open_new_tab(address)
    try:
        server.io_loop.start()
    finally:
        server.stop()
        solvers.close()


def _refuse_strangers(server: Any, hosts: Collection[str]) -> None:
    """Let the server answer requests that are not from its own page with a status of 4xx.

    The rule comes before those of Bokeh, so that no session is made for what is refused.
    """
    from tornado.routing import Matcher, Rule
    from tornado.web import RequestHandler

    class Strangers(Matcher):  # type: ignore[misc]
        def match(self, request: Any) -> dict[str, Any] | None:
            refused = _refused(request, hosts)
            return None if refused is None else {"target_kwargs": {"refused": refused}}

    class Refusal(RequestHandler):  # type: ignore[misc]
        def initialize(self, refused: tuple[int, str]) -> None:
            self._refused = refused

        def prepare(self) -> None:
            status, reason = self._refused
            self.set_status(status)
            self.set_header("Content-Type", "text/plain; charset=utf-8")
            self.finish(f"{reason}\n")

        def _log(self) -> None:
            """Write no line: the address may be long, and is a stranger's."""

    server._tornado.add_handlers(".*", [Rule(Strangers(), Refusal)])


def _refused(request: Any, hosts: Collection[str]) -> tuple[int, str] | None:
    """Return the status and the reason of a request that is refused, None of others.

    A page elsewhere can make the user's browser send requests here. It is known by what it calls
    this machine (a name of its own that leads here), by its origin, or by its wish to embed this
    page in its own.
    """
    host = request.host.lower()
    if (host if ":" in host else f"{host}:80") not in hosts:
        return 403, f"the host must be one of {', '.join(hosts)}"
    headers = request.headers
    origin = headers.get("Origin")
    if origin is not None and origin.lower() not in {f"http://{name}" for name in (*hosts, host)}:
        return 403, "requests from other pages are refused"
    embedded = headers.get("Sec-Fetch-Dest", "document") != "document"
    if headers.get("Sec-Fetch-Site") == "cross-site" and embedded:
        return 403, "this page is not to be embedded in others"
    if len(request.query) > _LONGEST_QUERY:
        return 400, f"the query of the address must have at most {_LONGEST_QUERY} characters"
    if request.path.startswith("/static/"):  # with a checksum of Bokeh's as its query
        return None
    try:
        for name, text in parse_qsl(request.query, keep_blank_values=True):
            check_length("the name of a parameter", name)
            check_length(name, text)
            if not f"{name}{text}".isascii():
                raise SceneError(name, text, "plain ASCII text")
    except SceneError as error:
        return 400, str(error)
    return None


def _unless_gone(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Say nothing of a visitor who leaves while he is told something."""
    from tornado.websocket import WebSocketClosedError

    if not isinstance(context.get("exception"), WebSocketClosedError):
        loop.default_exception_handler(context)


def _session(panel: Any, solvers: Solvers) -> Any:
    """Return the page of one visitor, in the state that the address has.

    Nothing is solved for it before a browser has opened the page.
    """
    location = panel.state.location
    complaint = ""
    try:
        texts = texts_from(location.search or "")
    except SceneError as error:
        texts, complaint = texts_of(None), str(error)
    page = Page(texts, solvers, follow=lambda query: setattr(location, "search", query))
    if complaint:
        page.complain(complaint)
    else:
        panel.state.onload(page.begin)
    panel.state.on_session_destroyed(page.close)
    template = panel.Template(_TEMPLATE, location=True)
    template.add_panel("explorer", page.view)
    return template


def _free_port(port: int) -> int:
    """Return a port of the loopback address that is free now."""
    number = whole("port", port, 0)
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((ADDRESS, number))
            return int(probe.getsockname()[1])
    except (OSError, OverflowError) as error:
        raise SceneError("port", port, f"a port of {ADDRESS} that is free ({error})") from error
