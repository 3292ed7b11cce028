"""Where a report is from: when it was made, by which version, from which files; its author and what they remark."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from linkwright.report.pictures.svg import element
from linkwright.results.document import plain
from linkwright.version import program_version

from .described import text

_END = "</main>"


@dataclass(frozen=True)
class Origin:
    """`date` (UTC, ISO 8601), the program's `version`, the `files` that were read as names and SHA-256 sums; `author`
    and `comment` are the user's own, and may be empty."""

    date: str
    version: str
    files: tuple[tuple[str, str], ...] = ()
    author: str = ""
    comment: str = ""

    @property
    def rows(self) -> tuple[tuple[str, str], ...]:
        """All of it, as what it is and what it says."""
        rows = [("date", self.date), ("made by", f"linkwright {self.version}")]
        rows += [("author", plain(self.author))] if self.author else []
        rows += [("comment", plain(self.comment))] if self.comment else []
        return (*rows, *((name, f"SHA-256 {total}" if total else "no longer there") for name, total in self.files))


def origin_of(files: Iterable[Path] = (), *, author: str = "", comment: str = "") -> Origin:
    """The origin of a report that is made now; SOURCE_DATE_EPOCH, where it is set, says when now is
    (https://reproducible-builds.org/specs/source-date-epoch/). A file that is gone has no sum."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    now = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdecimal() and len(epoch) < 12 else datetime.now(UTC)
    named = tuple((path.name, _sum_of(path)) for path in dict.fromkeys(Path(file) for file in files))
    return Origin(now.date().isoformat(), program_version(), named, author, comment)


def signed(page: str, origin: Origin) -> str:
    """A page with its origin as the last part."""
    begin, end, rest = page.rpartition(_END)
    return f"{begin}{_part(origin)}{end}{rest}"


def _part(origin: Origin) -> str:
    lines = (
        element("tr", element("th", text(name), scope="row"), element("td", text(said))) for name, said in origin.rows
    )
    return element(
        "section", element("h2", "Where this is from"), element("table", element("tbody", *lines), class_="origin")
    )


def _sum_of(path: Path) -> str:
    """The sum of a file; none of a pipe, which was read and is empty."""
    try:
        if not path.is_file():
            return ""
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""
