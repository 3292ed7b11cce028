"""A report as a PDF: its page, printed by a browser of the machine in the page's style for paper."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from linkwright.core.units.quantities import InputError

_BROWSERS = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "microsoft-edge",
    "chrome",
    "msedge",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
)
_PATIENCE = 120.0
"""How long (s) a browser may take."""


def need_browser() -> str:
    """Path of a browser that prints without a window. Raises `InputError`, one line, where none is installed: before
    anything is computed."""
    path_of_browser = next((path for name in _BROWSERS if (path := shutil.which(name))), None)
    if path_of_browser is None:
        message = "a PDF needs Chromium, Chrome or Edge, and none is installed; open the report of --out and print it"
        raise InputError("", "--pdf", message)
    return path_of_browser


def pdf_of(page: str) -> bytes:
    """A page as the PDF that a browser prints, A4. Raises `InputError` where there is no browser, or it fails."""
    browser = need_browser()
    with TemporaryDirectory(prefix="linkwright-") as folder:
        source, target = Path(folder) / "report.html", Path(folder) / "report.pdf"
        source.write_text(page, encoding="utf-8")
        # A browser refuses its sandbox to root. The virtual time lets the page's script unpack and draw its figures.
        sandbox = ["--no-sandbox"] if getattr(os, "geteuid", lambda: 1)() == 0 else []
        options = ["--headless", "--disable-gpu", "--no-pdf-header-footer", "--virtual-time-budget=20000", *sandbox]
        arguments = [f"--user-data-dir={folder}/profile", f"--print-to-pdf={target}", source.as_uri()]
        try:
            subprocess.run([browser, *options, *arguments], check=True, capture_output=True, timeout=_PATIENCE)
            return target.read_bytes()
        except (OSError, subprocess.SubprocessError) as error:
            raise InputError("", "--pdf", f"{browser} could not print the report: {type(error).__name__}") from None
