"""A described result as Markdown (CommonMark with the tables of GitHub): all that a page says, without its pictures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from linkwright.results.document import (
    Bars,
    Cell,
    Description,
    Facts,
    Item,
    Lines,
    Paragraph,
    Picture,
    Section,
    Table,
    plain,
    words,
)

MOST_ROWS = 500
_MARKED = re.compile(r"([\\`*_\[\]|~$])")
_OPENING = re.compile(r"^(\s*)([#+=-]+|\d+[.)])(?=\s|$)")


def markdown(description: Description, level: int = 1) -> str:
    """The result as Markdown, ending with a line feed; below the first `level` a part of a page with a title."""
    blocks = [f"# {escaped(description.title)}", f"**{escaped(description.headline)}**"] if level == 1 else []
    return "\n\n".join([*blocks, *_blocks(description.items, level + 1)]) + "\n"


def escaped(text: str) -> str:
    """Text that cannot be taken for markup, on one line."""
    shown = plain(text).strip().replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return _OPENING.sub(_kept, _MARKED.sub(r"\\\1", shown))


def _kept(opening: re.Match[str]) -> str:
    blanks, mark = opening.groups()
    return f"{blanks}{mark[:-1]}\\{mark[-1]}"


def _blocks(items: Iterable[Item], level: int) -> list[str]:
    blocks: list[str] = []
    for item in items:
        if isinstance(item, Section):
            lead = [escaped(item.lead)] if item.lead else []
            inside = _blocks(item.items, level + 1)
            if inside:
                blocks += [f"{'#' * level} {escaped(item.title)}", *lead, *inside]
        elif isinstance(item, Picture):
            continue
        elif isinstance(item, Paragraph):
            text = escaped(item.text)
            blocks.append(f"**Warning:** {text}" if item.tone == "warning" else text)
        elif isinstance(item, Lines):
            blocks.append("\n".join(f"- {escaped(line)}" for line in item.lines))
        else:
            blocks += _table(item.table if isinstance(item, Facts) else item)
    return [block for block in blocks if block]


def _table(given: Table) -> list[str]:
    # A bar repeats what the figures beside it say.
    shown = [k for k in range(len(given.columns)) if not any(isinstance(row[k], Bars) for row in given.rows)]
    heads = [escaped(given.columns[k].heading) for k in shown]
    rule = ["---:" if k in given.numbers else "---" for k in shown]
    rows = [[escaped(words(row[k])) for k in shown] for row in given.rows[:MOST_ROWS]]
    title = [f"**{escaped(given.title)}**"] if given.title else []
    left = len(given.rows) - MOST_ROWS
    return [*title, "\n".join(_row(row) for row in (heads, rule, *rows)), *([f"and {left} more"] if left > 0 else [])]


def _row(cells: Sequence[Cell]) -> str:
    return f"| {' | '.join(words(cell) for cell in cells)} |"
