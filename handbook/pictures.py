"""The picture of a diagnosis in README: the head of the report, with what the report answers written into the file.

`python -m handbook.pictures` makes it, with Chromium by Playwright.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from PIL.PngImagePlugin import PngInfo
from playwright.sync_api import sync_playwright

import linkwright as lw
from linkwright.face.diagnosis import Diagnosis

from .sources import ROOT

PICTURE = ROOT / "docs" / "pictures" / "diagnosis.png"
EXAMPLE = ROOT / "examples" / "hidden-backlash"
ANSWER = "Description"
WIDTH, HEIGHT = 1000, 1150
CHROMIUM = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")


def diagnosed() -> Diagnosis:
    """The example's diagnosis."""
    return lw.diagnose(EXAMPLE / "arm.yaml", EXAMPLE / "recording.csv")


def answer_in(picture: Path) -> str:
    """What the report answered from which a picture was taken; nothing where the file does not say."""
    with Image.open(picture) as image:
        return str(image.info.get(ANSWER, ""))


def main() -> None:
    """Diagnose, photograph, write."""
    found = diagnosed()
    own = next((path for path in CHROMIUM if Path(path).exists()), None)
    with TemporaryDirectory() as place, sync_playwright() as play:
        folder = Path(place) / "result"
        found.save(folder)
        browser = play.chromium.launch(executable_path=own, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.goto((folder / "report.html").as_uri())
        page.wait_for_timeout(1500)
        page.screenshot(path=str(Path(place) / "head.png"))
        browser.close()
        with Image.open(Path(place) / "head.png") as image:
            told = PngInfo()
            told.add_itxt(ANSWER, found.sentence)
            image.convert("P", palette=Image.Palette.ADAPTIVE, colors=128).save(PICTURE, pnginfo=told, optimize=True)
    print(PICTURE)


if __name__ == "__main__":
    main()
