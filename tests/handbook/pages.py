"""The commands that the project's pages show, in blocks, with what is printed beneath them, and within sentences; and
whether that is what they print."""

import re
import shlex
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from handbook.sources import ROOT, project_files

PAGES = [ROOT / name for name in project_files() if name.endswith(".md") and not name.startswith("benchmarks/")]
FENCED = re.compile(r"^( *)```([^\n]*)\n(.*?)^\1```", re.MULTILINE | re.DOTALL)
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
    """The `linkwright` commands in a page's blocks; what is set three blanks or `#` apart behind one is printed, and so
    are the plain blocks that follow one of which nothing else is."""
    results: list[Shown] = []
    silent = False  # the last block ended with a command beneath which nothing stands
    for _, language, block in FENCED.findall(page.read_text(encoding="utf-8")):
        prompted = bool(re.search(r"^\$ ", block, re.MULTILINE))
        begins = r"^\$ (.*)$" if prompted else r"^(linkwright .*)$"
        parts = re.split(begins, block.replace("\\\n", " "), flags=re.MULTILINE)
        if len(parts) == 1:
            silent &= not language.strip()
            if silent:
                results[-1] = replace(results[-1], printed=(*results[-1].printed, *block.splitlines(), "..."))
            continue
        for typed, after in zip(parts[1::2], parts[2::2], strict=True):
            line, _, beside = typed.partition("   ")
            line = re.sub(r" +# .*", "", typed if "  --" in typed else line)
            if line.startswith("linkwright "):
                words = tuple(shlex.split(line)[1:])
                lines = [beside.strip()] if beside.strip() and "  --" not in typed else []
                results.append(Shown(page, line, words, (*lines, *after.strip("\n").splitlines())))
        silent = bool(results) and not results[-1].printed
    return results


def spoken(page: Path, commands: set[str]) -> list[list[str]]:
    """The words of each command within a sentence, with or without `linkwright` before it."""
    text = FENCED.sub("", page.read_text(encoding="utf-8"))
    results = [span.replace("\\|", "|").removeprefix("linkwright ").split() for span in INLINE.findall(text)]
    named = [span.split()[1:] for span in INLINE.findall(text) if span.startswith("linkwright ")]
    return named + [words for words in results if words[:1] and words[0] in commands and len(words) > 1]


def words(lines: Iterable[str]) -> list[str]:
    """Words and numbers, wherever lines break; rules and bars are none, nor is how long something took."""
    text = re.sub(r"\bin\s+[0-9.]+\s+s\b", "in s", "\n".join(lines))
    return [word for word in text.split() if not set(word) <= set("─█▉▊▋▌▍▎▏")]


def same(word: str, other: str) -> bool:
    """Whether two words are the same, numbers in them within three per cent, which processors may differ by; what is
    nothing but for rounding is alike nothing."""
    one, two = (re.split(r"([0-9]+(?:\.[0-9]+)?(?:e−?[0-9]+)?)", item.rstrip(".,;:")) for item in (word, other))
    numbers = [
        (float(a.replace("−", "-")), float(b.replace("−", "-"))) for a, b in zip(one[1::2], two[1::2], strict=False)
    ]
    return one[::2] == two[::2] and all(abs(a - b) <= max(0.03 * max(abs(a), abs(b)), 1e-8) for a, b in numbers)


def told(printed: Iterable[str], out: str) -> list[str]:
    """The paragraphs of a page that a command does not print, whatever the width; a line `...` leaves lines out."""
    have, missing = words(out.splitlines()), list[str]()
    for part in re.split(r"\n(?: *\n| *\.\.\. *\n)+", "\n" + "\n".join(printed) + "\n"):
        wanted = words([line for line in part.splitlines() if line.strip() != "..."])
        result = any(
            all(same(*pair) for pair in zip(wanted, have[at:], strict=False)) and at + len(wanted) <= len(have)
            for at in range(len(have))
        )
        missing += [] if result or not wanted else [" ".join(wanted)]
    return missing
