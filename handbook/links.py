"""Links between the project's Markdown files, turned into links between the site's pages."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Callable

# A link or picture, its text without brackets of its own, its target a path: no scheme, no place on the same page.
_LINK = re.compile(r"(\]\()(?![a-z]+:|#)([^)\s#]+)(#[^)\s]*)?(\))")
_FENCE = re.compile(r"^(```|~~~)")


def relinked(text: str, source: str, page: str, place: Callable[[str], str | None]) -> str:
    """The text of the project's file `source` as it stands on `page`.

    `place` gives where a file or folder of the project stands on the site; a link to what does not stand there is left
    as it is, so that the build names it as broken.
    """
    home, target_home = posixpath.dirname(source), posixpath.dirname(page)

    def target(result: re.Match[str]) -> str:
        path = posixpath.normpath(posixpath.join(home, result[2]))
        there = place(path)
        if there is None:
            return result[0]
        return (
            result[1] + os.path.relpath(there, target_home or ".").replace(os.sep, "/") + (result[3] or "") + result[4]
        )

    lines: list[str] = []
    inside = False
    for line in text.split("\n"):
        inside ^= bool(_FENCE.match(line))
        lines.append(line if inside else _LINK.sub(target, line))
    return "\n".join(lines)
