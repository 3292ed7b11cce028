"""The pictures of reports in README: a head or a section, with what the reports answer written into the files.

`python -m handbook.pictures` makes them, with Chromium by Playwright; names (`welding-arm`) choose some.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from PIL.PngImagePlugin import PngInfo
from playwright.sync_api import sync_playwright

import linkwright as lw
from linkwright.face.design import Optimization
from linkwright.face.diagnosis import Diagnosis
from linkwright.results.optimization import headline

from .sources import ROOT

ANSWER = "Description"
CHROMIUM = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")


def diagnosed() -> Diagnosis:
    """The example's diagnosis."""
    example = ROOT / "examples" / "hidden-backlash"
    return lw.diagnose(example / "arm.yaml", example / "recording.csv")


def designed() -> Optimization:
    """The optimum of the example."""
    return lw.optimize(ROOT / "examples" / "welding-arm" / "problem.yaml")


@dataclass(frozen=True)
class Photographed:
    """A part of a report: its head, `height` pixels of it, or the section whose heading has `heading` in it. `found`
    makes the result, `answer` is its sentence."""

    name: str
    height: int
    found: Callable[[], Diagnosis | Optimization]
    heading: str = ""

    @property
    def path(self) -> Path:
        """Where the picture is."""
        return ROOT / "docs" / "pictures" / f"{self.name}.png"

    def answer(self) -> str:
        """What a fresh result answers."""
        return answer_of(self.found())


PICTURES = (
    Photographed("diagnosis", 1150, diagnosed),
    Photographed("welding-arm", 1650, designed, heading="Before and after"),
)
WIDTH = 1000


def answer_of(found: Diagnosis | Optimization) -> str:
    """A result in a sentence."""
    return found.sentence if isinstance(found, Diagnosis) else headline(found.found)


def answer_in(picture: Path) -> str:
    """What the report answered from which a picture was taken; nothing where the file does not say."""
    with Image.open(picture) as image:
        return str(image.info.get(ANSWER, ""))


def photograph(picture: Photographed) -> None:
    """Ask anew, photograph, write."""
    result = picture.found()
    own = next((path for path in CHROMIUM if Path(path).exists()), None)
    with TemporaryDirectory() as place, sync_playwright() as play:
        folder = Path(place) / "result"
        result.save(folder)
        browser = play.chromium.launch(executable_path=own, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": WIDTH, "height": picture.height})
        page.goto((folder / "report.html").as_uri())
        page.wait_for_timeout(1500)
        page.add_style_tag(content=".save { display: none !important }")  # buttons that nobody can press
        part = page.locator("section", has=page.get_by_role("heading", name=picture.heading))
        (part if picture.heading else page).screenshot(path=str(Path(place) / "part.png"))
        browser.close()
        with Image.open(Path(place) / "part.png") as image:
            told = PngInfo()
            told.add_itxt(ANSWER, answer_of(result))
            few = image.convert("P", palette=Image.Palette.ADAPTIVE, colors=128)
            few.save(picture.path, pnginfo=told, optimize=True)
    print(picture.path)


def main() -> None:
    """Each picture that the command line names; all where it names none."""
    for picture in PICTURES:
        if not sys.argv[1:] or picture.name in sys.argv[1:]:
            photograph(picture)


if __name__ == "__main__":
    main()
