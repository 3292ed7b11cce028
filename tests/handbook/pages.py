"""The commands that the project's pages show: in blocks, with what is printed beneath them, and within sentences."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from handbook.sources import ROOT, project_files

PAGES = [ROOT / name for name in project_files() if name.endswith(".md") and not name.startswith("benchmarks/")]
FENCED = re.compile(r"^( *)```[^\n]*\n(.*?)^\1```", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`([^`\n]+)`")


@dataclass(frozen=True)
class Shown:
    """A command of a block as typed, its words after `linkwright`, and the lines beneath it up to the next one."""

    page: Path
    line: str
    words: tuple[str, ...]
    printed: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}: {self.line}"


def shown(page: Path) -> list[Shown]:
    """The `linkwright` commands in a page's blocks; what is set three blanks or `#` apart behind one is printed."""
    found: list[Shown] = []
    for _, block in FENCED.findall(page.read_text(encoding="utf-8")):
        prompted = bool(re.search(r"^\$ ", block, re.MULTILINE))
        begins = r"^\$ (.*)$" if prompted else r"^(linkwright .*)$"
        parts = re.split(begins, block.replace("\\\n", " "), flags=re.MULTILINE)
        for typed, after in zip(parts[1::2], parts[2::2], strict=True):
            line, _, beside = typed.partition("   ")
            line = re.sub(r" +# .*", "", typed if "  --" in typed else line)
            if line.startswith("linkwright "):
                words = tuple(shlex.split(line)[1:])
                lines = [beside.strip()] if beside.strip() and "  --" not in typed else []
                found.append(Shown(page, line, words, (*lines, *after.strip("\n").splitlines())))
    return found


def spoken(page: Path, commands: set[str]) -> list[list[str]]:
    """The words of each command within a sentence, with or without `linkwright` before it."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    found = [span.replace("\\|", "|").removeprefix("linkwright ").split() for span in INLINE.findall(text)]
    named = [span.split()[1:] for span in INLINE.findall(text) if span.startswith("linkwright ")]
    return named + [words for words in found if words[:1] and words[0] in commands and len(words) > 1]
