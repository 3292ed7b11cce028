"""The worked notebooks: run from top to bottom, stored with what they print and draw, and as pages of the site.

`python -m handbook.notebooks` runs all, or those that it names, and writes their outputs into them; plots become
pictures, with Chromium by Playwright.
"""

from __future__ import annotations

import base64
import io
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from PIL import Image
from playwright.sync_api import sync_playwright
from plotly.offline import get_plotlyjs

from .pictures import CHROMIUM
from .sources import NOTEBOOKS, ROOT

MOST_SECONDS = 900
WIDTH, HEIGHT = 900, 480
DRAW = "([data, layout]) => Plotly.newPlot('plot', data, layout, {displayModeBar: false})"
"""A static plot would leave out what is drawn in space."""
_PLOT = "application/vnd.plotly.v1+json"
_TAGS = re.compile(r"<[^>]*>")
_STYLE = re.compile(r"<style.*?</style>", re.DOTALL)


def executed(path: Path, *further: str) -> Any:
    """The notebook with its outputs, run in its own folder by a fresh kernel; `further` cells follow its own.

    Raises `nbclient.exceptions.CellExecutionError` with the cell that failed.
    """
    notebook = nbformat.read(path, as_version=4)
    notebook.cells += [nbformat.v4.new_code_cell(source) for source in further]
    place = {"metadata": {"path": str(path.parent)}}
    NotebookClient(notebook, timeout=MOST_SECONDS, kernel_name="python3", resources=place).execute()
    return notebook


def shown(outputs: list[Any]) -> list[Any]:
    """What of a cell's outputs is for readers: neither bars of progress nor complaints."""
    return [
        output
        for output in outputs
        if output.get("name") != "stderr" and _says(output.get("data", {"text/plain": "-"}))
    ]


def _says(data: dict[str, Any]) -> bool:
    """Whether an output holds a plot, a picture or words; bars of progress end as neither."""
    if "application/vnd.jupyter.widget-view+json" in data:
        return False
    words = "".join(_TAGS.sub("", _STYLE.sub("", data.get(kind, ""))) for kind in ("text/plain", "text/html"))
    return bool(words.strip()) or any(kind in data for kind in (_PLOT, "image/png"))


def notebook_pages(notebooks: dict[str, str]) -> dict[str, str]:
    """Their pages, by their places on the site."""
    return {
        page: as_markdown(nbformat.read(ROOT / source, as_version=4), Path(source).name)
        for source, page in notebooks.items()
    }


def as_markdown(notebook: Any, name: str) -> str:
    """A notebook as Markdown."""
    parts: list[str] = []
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
        else:
            parts.append(f"```python\n{cell.source}\n```")
            parts += [text for output in shown(cell.outputs) if (text := _output(output))]
    return "\n\n".join([*parts, f"[To download]({name})", ""])


def _output(output: Any) -> str:
    """What a cell showed: a picture, a table, or text."""
    if output.output_type == "stream":
        return f"```\n{output.text.rstrip()}\n```"
    data = output.get("data", {})
    if "image/png" in data:
        return f'<img alt="What the cell draws" src="data:image/png;base64,{data["image/png"]}">'
    if _TAGS.sub("", data.get("text/html", "")).strip():
        lines = _STYLE.sub("", data["text/html"]).splitlines()
        return "\n".join(['<div class="output">', *(line for line in lines if line.strip()), "</div>"])
    text = "" if "text/html" in data else data.get("text/plain", "").strip()
    return f"```\n{text}\n```" if text else ""


def with_pictures(notebook: Any) -> Any:
    """The notebook with a picture in the place of each plot."""
    with photographer(WIDTH, HEIGHT) as photograph:
        for cell in notebook.cells:
            if cell.cell_type == "code":
                cell.outputs = shown(cell.outputs)
            for output in cell.get("outputs", ()):
                plot = output.get("data", {}).pop(_PLOT, None)
                if plot:
                    output.data = {"image/png": _small(photograph(plot)), "text/plain": "<Figure>"}
    return notebook


@contextmanager
def photographer(width: int, height: int) -> Iterator[Callable[[Any], bytes]]:
    """What makes a PNG of `width` by `height` pixels of a plotly figure (`data`, `layout`), with Chromium."""
    own = next((path for path in CHROMIUM if Path(path).exists()), None)
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=own, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_content("<body style='margin:0'><div id='plot'></div></body>")
        page.add_script_tag(content=get_plotlyjs())

        def photograph(plot: Any) -> bytes:
            page.evaluate(DRAW, [plot["data"], {**plot["layout"], "width": width, "height": height}])
            return page.locator("#plot").screenshot()

        yield photograph
        browser.close()


def _small(png: bytes) -> str:
    """The picture in few colours, as notebooks hold it."""
    small = io.BytesIO()
    with Image.open(io.BytesIO(png)) as image:
        image.convert("P", palette=Image.Palette.ADAPTIVE, colors=64).save(small, "PNG", optimize=True)
    return base64.b64encode(small.getvalue()).decode()


def main() -> None:
    """Each notebook that the command line names; all where it names none."""
    for path in sorted((ROOT / NOTEBOOKS).glob("*.ipynb")):
        if not sys.argv[1:] or path.stem in sys.argv[1:]:
            made = with_pictures(executed(path))
            for cell in made.cells:
                cell.metadata = {}
            nbformat.write(made, path)
            print(path)


if __name__ == "__main__":
    main()
