"""What of the project stands on the site: which file becomes which page, and which is there to download."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[1]
DOCS, EXAMPLES, NOTEBOOKS, GALLERY = "docs", "examples", "examples/notebooks", "examples/gallery"
SINGLE = (
    ("README.md", "index.md"),
    ("CHANGELOG.md", "changelog.md"),
    ("CONTRIBUTING.md", "contributing.md"),
    ("benchmarks/RESULTS.md", "measured.md"),
)
"""Files outside docs/ that are pages, with the page's place."""


@dataclass(frozen=True)
class Sources:
    """Places on the site by places in the project, both relative with slashes.

    `pages` hold Markdown of the project, `examples` folders of examples, `notebooks` and `downloads` files.
    """

    pages: dict[str, str]
    examples: dict[str, str]
    notebooks: dict[str, str]
    downloads: dict[str, str]

    def place(self, path: str) -> str | None:
        """Where a file or folder of the project stands on the site, None where it does not."""
        for kind in (self.pages, self.examples, self.notebooks, self.downloads):
            if path in kind:
                return kind[path]
        return None


def project_files() -> list[str]:
    """The files that git tracks or would."""
    call = ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(call, capture_output=True, text=True, check=True).stdout.split("\0")
    return sorted(name for name in set(listed) if name and (ROOT / name).is_file())


@cache
def sources_here() -> Sources:
    """What of this project goes where."""
    return read_sources(project_files())


def read_sources(files: list[str]) -> Sources:
    """What of these files goes where."""
    pages = {source: page for source, page in SINGLE if source in files}
    notebooks: dict[str, str] = {}
    downloads: dict[str, str] = {}
    examples: dict[str, str] = {}
    for name in files:
        path = PurePosixPath(name)
        if path.is_relative_to(DOCS):
            target = str(path.relative_to(DOCS))
            (pages if path.suffix == ".md" else downloads)[name] = target
        elif path.is_relative_to(NOTEBOOKS):
            if path.suffix == ".ipynb":
                notebooks[name] = f"notebooks/{path.stem}.md"
        elif path.is_relative_to(GALLERY):
            beside = str(path.relative_to(EXAMPLES))
            (pages if path.suffix == ".md" else downloads)[name] = "gallery.md" if path.suffix == ".md" else beside
        elif path.is_relative_to(EXAMPLES):
            folder = "/".join(path.parts[:2])
            examples[folder] = f"{folder}.md"
            if path.name == "README.md":
                pages[name] = f"{folder}.md"
            else:
                downloads[name] = name
    return Sources(pages, examples, notebooks, downloads)


def files_of_example(sources: Sources, folder: str) -> Iterator[str]:
    """The files of an example that can be downloaded."""
    return (name for name in sources.downloads if PurePosixPath(name).is_relative_to(folder))
