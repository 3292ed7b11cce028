"""What MkDocs calls while it builds the site: pages from the code are added, links within the project become links of
the site."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from mkdocs.config.config_options import ExtraScriptValue
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from handbook.commands import command_pages
from handbook.examples import example_pages
from handbook.gallery import page as gallery_page
from handbook.links import relinked
from handbook.notebooks import notebook_pages
from handbook.python_face import python_pages
from handbook.sources import DOCS, ROOT, sources_here

WORKER = "assets/iframe-worker.js"
"""What lets pages opened from a disk be searched; `offline` would fetch its like from the network."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the pages that are made into the navigation, where it names the folder that they stand in."""
    folders = {"commands": list(command_pages()), "python": list(python_pages())}
    folders["examples"] = list(sources_here().examples.values())
    folders["notebooks"] = list(sources_here().notebooks.values())
    config.nav = [_expanded(entry, folders) for entry in config.nav or []]
    config.extra["polyfills"] = [ExtraScriptValue(WORKER)]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made, the files to download and the style."""
    sources = sources_here()
    pages = {**command_pages(), **python_pages(), **example_pages(sources), **notebook_pages(sources.notebooks)}
    pages["gallery.md"] = gallery_page()
    for source, page in sources.pages.items():
        if not source.startswith((f"{DOCS}/", "examples/")):
            pages[page] = relinked((ROOT / source).read_text(encoding="utf-8"), source, page, sources.place)
    for page, text in pages.items():
        files.append(File.generated(config, page, content=text))
    for source, page in sources.notebooks.items():
        place = str(PurePosixPath(page).with_suffix(".ipynb"))
        files.append(File.generated(config, place, abs_src_path=str(ROOT / source)))
    for source, place in sources.downloads.items():
        if not source.startswith(f"{DOCS}/"):
            files.append(File.generated(config, place, abs_src_path=str(ROOT / source)))
    own = Path(__file__).parent
    files.append(File.generated(config, "assets/own.css", abs_src_path=str(own / "style.css")))
    files.append(File.generated(config, WORKER, abs_src_path=str(own / "iframe-worker.js")))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:  # noqa: ARG001
    """Turn the links of a page of docs/."""
    sources = sources_here()
    source = f"{DOCS}/{page.file.src_uri}"
    return relinked(markdown, source, page.file.src_uri, sources.place) if source in sources.pages else markdown


def _expanded(entry: object, folders: dict[str, list[str]]) -> object:
    """An entry of the navigation, `Title: folder/` with the pages of that folder in its place."""
    if isinstance(entry, dict):
        return {title: _expanded(inside, folders) for title, inside in entry.items()}
    if isinstance(entry, list):
        pages: list[object] = []
        for inside in entry:
            expanded = _expanded(inside, folders)
            pages += expanded if isinstance(expanded, list) else [expanded]
        return pages
    if isinstance(entry, str) and entry.endswith("/"):
        return folders[entry.rstrip("/")]
    return entry
