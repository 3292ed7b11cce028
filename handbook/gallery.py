"""The gallery: short scripts of examples/gallery, each with the picture that it draws and the lines that it prints.

`python -m handbook.gallery` runs all, or those that it names, and writes what they draw beside them, with Chromium by
Playwright; what they print is written into the pictures.
"""

from __future__ import annotations

import ast
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path, PurePosixPath
from typing import Any

from PIL import Image
from PIL.PngImagePlugin import PngInfo

from .notebooks import photographer
from .pictures import ANSWER, answer_in
from .sources import GALLERY, ROOT

WIDTH, HEIGHT, COLORS = 720, 400, 64


def scripts() -> list[Path]:
    """All of them, folder by folder."""
    return sorted((ROOT / GALLERY).glob("*/*.py"))


def picture_of(script: Path) -> Path:
    """Where its picture is."""
    return script.with_suffix(".png")


_RUN = "import runpy, sys; print(runpy.run_path(sys.argv[1])['figure'].to_json())"


def run(script: Path) -> tuple[dict[str, Any], str]:
    """The figure that a script leaves (`data`, `layout`), and what it prints: in a process of its own, since scripts
    register effects and shapes, from the project's folder. Raises `CalledProcessError` where it fails."""
    call = [sys.executable, "-c", _RUN, str(script)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    said = subprocess.run(call, cwd=ROOT, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout
    *lines, figure = said.splitlines()
    return json.loads(figure), "\n".join(lines).strip()


def page() -> str:
    """The gallery as a page of the site: what each script does, the script, what it prints and draws."""
    links = re.compile(r"\]\((\w+)\)")
    parts = [links.sub(r"](#\1)", (ROOT / GALLERY / "README.md").read_text(encoding="utf-8")), ""]
    folder = ""
    for script in scripts():
        if script.parent.name != folder:
            folder = script.parent.name
            parts += [f"## {folder.capitalize()}", ""]
        text = script.read_text(encoding="utf-8")
        told = ast.get_docstring(ast.parse(text)) or ""
        place = PurePosixPath(picture_of(script).relative_to(ROOT / "examples").as_posix())
        code = text.partition('"""\n')[2].strip()
        parts += [f"### {script.stem.replace('_', ' ').capitalize()}", "", told, "", f"![{told}]({place})", ""]
        parts += ["```python", code, "```", "", "```text", answer_in(picture_of(script)), "```", ""]
    return "\n".join(parts)


def draw(script: Path) -> None:
    """Run a script, photograph its figure, write."""
    figure, said = run(script)
    in_space = "scene" in figure["layout"]
    figure["layout"]["margin"] = {"t": 40, "r": 0, "b": 0, "l": 0} if in_space else {"t": 40, "r": 20, "b": 50, "l": 70}
    with photographer(WIDTH, HEIGHT) as photograph:
        shot = photograph(figure)
    told = PngInfo()
    told.add_itxt(ANSWER, said)
    with Image.open(io.BytesIO(shot)) as image:
        few = image.convert("P", palette=Image.Palette.ADAPTIVE, colors=COLORS)
        few.save(picture_of(script), pnginfo=told, optimize=True)
    print(picture_of(script))


def main() -> None:
    """Each script that the command line names; all where it names none."""
    for script in scripts():
        if not sys.argv[1:] or script.stem in sys.argv[1:]:
            draw(script)


if __name__ == "__main__":
    main()
