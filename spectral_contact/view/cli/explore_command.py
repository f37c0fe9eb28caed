"""``spectral-contact explore``: its options, and the page that they begin with."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from spectral_contact.scene import Scene
from spectral_contact.view.cli.options import number, whole
from spectral_contact.view.explorer.server import serve


def add_options(command: argparse.ArgumentParser) -> None:
    """Add the options of the page."""
    group = command.add_argument_group("page")
    group.add_argument(
        "--rtol", type=number, help="bound on relative errors, 1e-12 to 1e-2 (default: 1e-8)"
    )
    group.add_argument(
        "--port",
        type=whole,
        metavar="N",
        default=0,
        help="port of 127.0.0.1 (default: any free one)",
    )
    group.add_argument(
        "--no-browser", action="store_true", help="print the address and open no browser"
    )


def run(arguments: argparse.Namespace, scene: Scene, started: Callable[[str], None]) -> None:
    """Serve the page until it is interrupted; `started` is told its address."""
    serve(
        scene,
        rtol=arguments.rtol,
        port=arguments.port,
        started=started,
        show=not arguments.no_browser,
    )
