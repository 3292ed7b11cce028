"""The worked notebooks: run from top to bottom, and as pages of the site.

They are stored without outputs. `python -m handbook.notebooks` runs them all and leaves them with their outputs where
the site looks for them.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

from .sources import NOTEBOOKS, ROOT

MADE = ROOT / "build" / "notebooks"
MOST_SECONDS = 600
_PLOT = "application/vnd.plotly.v1+json"
_TAGS = re.compile(r"<[^>]*>")
_STYLE = re.compile(r"<style.*?</style>", re.DOTALL)


def executed(path: Path) -> Any:
    """The notebook with its outputs, run in its own folder by a fresh kernel.

    Raises `nbclient.exceptions.CellExecutionError` with the cell that failed.
    """
    notebook = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(path.parent)}}
    NotebookClient(notebook, timeout=MOST_SECONDS, kernel_name="python3", resources=place).execute()
    return notebook


def notebook_pages(notebooks: dict[str, str]) -> dict[str, str]:
    """Their pages, by their places on the site, with outputs where the same cells were run."""
    pages: dict[str, str] = {}
    for source, page in notebooks.items():
        stored = nbformat.read(ROOT / source, as_version=4)
        made = MADE / Path(source).name
        ran = nbformat.read(made, as_version=4) if made.is_file() else stored
        same = [cell.source for cell in ran.cells] == [cell.source for cell in stored.cells]
        pages[page] = as_markdown(ran if same else stored, Path(source).name)
    return pages


def as_markdown(notebook: Any, name: str) -> str:
    """A notebook as Markdown; plots are data for `plots.js`."""
    parts: list[str] = []
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
        else:
            parts.append(f"```python\n{cell.source}\n```")
            parts += [text for output in cell.get("outputs", ()) if (text := _output(output))]
    return "\n\n".join([*parts, f"[To download]({name})", ""])


def _output(output: Any) -> str:
    """What a cell showed: a plot, a table, or text. Bars of progress are left out."""
    if output.output_type == "stream":
        return f"```\n{output.text.rstrip()}\n```" if output.name == "stdout" else ""
    data = output.get("data", {})
    if "application/vnd.jupyter.widget-view+json" in data:
        return ""
    if _PLOT in data:
        text = json.dumps({key: data[_PLOT][key] for key in ("data", "layout")}).replace("</", "<\\/")
        return f'<div class="plot"><script type="application/json">{text}</script></div>'
    if _TAGS.sub("", data.get("text/html", "")).strip():
        lines = _STYLE.sub("", data["text/html"]).splitlines()
        return "\n".join(['<div class="output">', *(line for line in lines if line.strip()), "</div>"])
    text = "" if "text/html" in data else data.get("text/plain", "").strip()
    return f"```\n{text}\n```" if text else ""


def main() -> None:
    """Run all of them, one after the other, and keep them with their outputs."""
    MADE.mkdir(parents=True, exist_ok=True)
    for path in sorted((ROOT / NOTEBOOKS).glob("*.ipynb")):
        nbformat.write(executed(path), MADE / path.name)
        print(MADE / path.name)


if __name__ == "__main__":
    main()
