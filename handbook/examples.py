"""A page for each example: what its README says, and its files."""

from __future__ import annotations

from pathlib import PurePosixPath

from .links import relinked
from .sources import ROOT, Sources, files_of_example

_SHOWN = {".yaml": "yaml", ".py": "python", ".toml": "toml"}
"""Kinds of files that are shown as well, by what they are written in."""


def example_pages(sources: Sources) -> dict[str, str]:
    """The pages by their places on the site."""
    return {page: _page(sources, folder, page) for folder, page in sources.examples.items()}


def _page(sources: Sources, folder: str, page: str) -> str:
    readme = f"{folder}/README.md"
    if readme in sources.pages:
        text = relinked((ROOT / readme).read_text(encoding="utf-8"), readme, page, sources.place)
    else:
        text = f"# {PurePosixPath(folder).name.replace('-', ' ').capitalize()}\n"
    shown = [name for name in files_of_example(sources, folder) if PurePosixPath(name).suffix in _SHOWN]
    others = [name for name in files_of_example(sources, folder) if name not in shown]
    parts = [text.rstrip(), "", "## Files", ""]
    for name in others:
        parts += [f"- [{name}]({_beside(name, page)})"]
    for name in shown:
        parts += [
            "",
            f'??? example "{name}"',
            "",
            f"    [to download]({_beside(name, page)})",
            "",
            f"    ```{_SHOWN[PurePosixPath(name).suffix]}",
            *(f"    {line}" for line in (ROOT / name).read_text(encoding="utf-8").splitlines()),
            "    ```",
        ]
    return "\n".join([*parts, ""])


def _beside(name: str, page: str) -> str:
    return str(PurePosixPath(name).relative_to(PurePosixPath(page).parent))
