"""A headless Chromium for tests and pictures, spoken to by its debugging protocol.

Needs Chromium, and tornado, which Bokeh brings.
"""

import base64
import json
import re
import shutil
import subprocess
import tempfile
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
DESK, PHONE = (1280, 800), (390, 844)


def found():
    """Return the path of a browser, None if there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Tab:
    """A page that is open. Its methods are coroutines."""

    def __init__(self, socket):
        self._socket = socket
        self._count = 0
        self.requests = []

    async def call(self, method, **parameters):
        """Send a command and return its result; requests that are told meanwhile are kept."""
        self._count += 1
        number = self._count
        await self._socket.write_message(
            json.dumps({"id": number, "method": method, "params": parameters})
        )
        while True:
            text = await self._socket.read_message()
            assert text is not None, "the browser has gone"
            told = json.loads(text)
            if told.get("method") == "Network.requestWillBeSent":
                self.requests.append(told["params"]["request"]["url"])
            if told.get("id") == number:
                assert "error" not in told, told
                return told["result"]

    async def size(self, width, height):
        """Set the size of the window, in pixels of CSS."""
        await self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )

    async def open(self, address):
        """Go to an address, without waiting for more than the answer."""
        await self.call("Network.enable")
        await self.call("Page.enable")
        await self.call("Page.navigate", url=address)

    async def run(self, script):
        """Return the value of an expression of JavaScript; a promise is waited for."""
        found = await self.call(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    async def until(self, condition, seconds=120.0):
        """Wait until an expression is true, and return its value."""
        return await self.run(
            "new Promise((done, fail) => {"
            f" const end = Date.now() + {1e3 * seconds:.0f};"
            " const look = () => { let one = null;"
            f"  try {{ one = {condition}; }} catch (error) {{ one = null; }}"
            "  if (one) done(one);"
            f"  else if (Date.now() > end) fail(Error({json.dumps('never ' + condition)}));"
            "  else setTimeout(look, 20); };"
            " look(); })"
        )

    async def text(self):
        """Return what can be read on the page, its components included."""
        return await self.run(
            "(function read(node) {"
            " if (node.nodeType === 3) return node.data;"
            " if (['STYLE', 'SCRIPT'].includes(node.nodeName)) return '';"
            " const roots = [...(node.shadowRoot ? [node.shadowRoot] : []), node];"
            " return roots.flatMap(one => [...one.childNodes].map(read)).join(' ');"
            "})(document.body || document)"
        )

    async def click(self, words):
        """Click the button that says so."""
        await self.run(
            "(function click(root) {"
            " for (const one of root.querySelectorAll('*')) {"
            f"  if (one.nodeName === 'BUTTON' && one.innerText.trim() === {json.dumps(words)})"
            "    one.click();"
            "  if (one.shadowRoot) click(one.shadowRoot); }"
            "})(document)"
        )

    async def picture(self, path, whole=True):
        """Write what is seen as a PNG file, or the whole page."""
        shot = await self.call("Page.captureScreenshot", captureBeyondViewport=whole)
        Path(path).write_bytes(base64.b64decode(shot["data"]))


@contextmanager
def browser():
    """Yield the address of a browser to debug; it is gone afterwards."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        command = [
            found(),
            "--headless=new",
            "--no-sandbox",  # of root, as in a container
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--no-first-run",
            "--hide-scrollbars",
            "--remote-debugging-port=0",
            f"--user-data-dir={folder}",
            "about:blank",
        ]
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        try:
            for line in process.stderr:
                told = re.search(r"DevTools listening on ws://([^/]+)/", line)
                if told:
                    yield told[1]
                    break
        finally:
            process.terminate()
            process.stderr.close()
            process.wait()


@asynccontextmanager
async def tab(host):
    """Yield the first tab of a browser."""
    from tornado.httpclient import AsyncHTTPClient
    from tornado.websocket import websocket_connect

    answer = await AsyncHTTPClient().fetch(f"http://{host}/json")
    pages = [one for one in json.loads(answer.body) if one["type"] == "page"]
    socket = await websocket_connect(pages[0]["webSocketDebuggerUrl"], max_message_size=2**28)
    try:
        yield Tab(socket)
    finally:
        socket.close()
        await socket.read_message()  # None, when it is closed
