"""The site is searched as it lies on a disk, without a server and without a network."""

import os
import shutil
import subprocess
import sys

import pytest

from handbook.sources import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Debian's chromium")]


def test_pages_opened_from_a_disk_find_what_is_sought(tmp_path):
    """The search answers, and no page asks for anything that is not a file."""
    sync_api = pytest.importorskip("playwright.sync_api")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": str(ROOT)}
    subprocess.run(command, cwd=ROOT, env=environment, check=True, capture_output=True)
    asked = []
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for name in ("index.html", "start/tutorial.html"):
            page = browser.new_page()
            page.on("request", lambda request: asked.append(request.url))
            page.goto((tmp_path / "site" / name).as_uri())
            page.fill(".md-search__input", "backlash")
            page.wait_for_selector(".md-search-result__item", state="attached", timeout=20_000)
            assert "matching documents" in page.inner_text(".md-search-result__meta")
        browser.close()
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
