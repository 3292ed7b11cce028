"""One server and one Chromium for all flows, each at the width of a desk and of a phone."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
WIDTHS = (1400, 420)


class Server:
    """`linkwright serve` as a process of its own."""

    def __init__(self, folder, *options, port="0"):
        nowhere = str(folder.parent / "no-configuration")
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CONFIG_HOME": nowhere, "NO_PROXY": "*"}
        for name in ("LINKWRIGHT_CATALOGUE", "LINKWRIGHT_SECTIONS", "LINKWRIGHT_ACTUATORS"):
            environment.pop(name, None)
        self.folder = folder
        self.process = subprocess.Popen(
            [sys.executable, "-m", "linkwright", "serve", str(folder), "--port", port, *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            text=True,
        )
        self.line = self.process.stdout.readline()
        self.url = self.line.partition(" at ")[2].strip()

    @property
    def port(self):
        return int(self.url.split(":")[2].partition("/")[0])

    def end(self, how=signal.SIGINT):
        """Ctrl-C; gives exit status, what was printed, and what was complained of."""
        self.process.send_signal(how)
        out, complaints = self.process.communicate(timeout=40)
        return self.process.returncode, self.line + out, complaints


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("served") / "designs"
    folder.mkdir()
    made = Server(folder)
    yield made
    made.end()


@pytest.fixture(scope="module")
def chromium():
    """A browser for a module at most: while it is there, its own event loop runs in this thread."""
    result = next((path for name in ("chromium", "chromium-browser") if (path := shutil.which(name))), None)
    if result is None:
        pytest.skip("there is no chromium here; `.ci/run` installs it, or: apt-get install chromium")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=result, args=["--no-sandbox"])
        yield browser
        browser.close()


def _ours(said):
    """Not what the sanitiser reports of markup that it reads, and then takes out."""
    return not said.location["url"].endswith("dompurify.mjs")


@pytest.fixture(params=WIDTHS)
def page(chromium, request):
    """A page whose errors and refused loads are failures, and which is nowhere wider than its window."""
    made = chromium.new_page(viewport={"width": request.param, "height": 900})
    made.set_default_timeout(120_000)
    complaints = []
    made.on("pageerror", lambda error: complaints.append(str(error)))
    made.on("framenavigated", lambda frame: print("went to", frame.url))  # shown with a test that fails

    def heard(said):
        print("console:", said.text)
        if said.type == "error" and _ours(said):
            complaints.append(f"{said.text} ({said.location['url']})")

    made.on("console", heard)
    yield made
    wide = made.evaluate("document.documentElement.scrollWidth - window.innerWidth")
    made.close()
    assert complaints == []
    assert wide <= 0
