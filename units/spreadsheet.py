"""Text in cells of comma-separated values that spreadsheets open: what begins like a formula is no formula."""

from __future__ import annotations

import re
from typing import Any

_FORMULA = re.compile(r"'*\s*[=+\-@\t\r]")
_FIGURE = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?: ?[A-Za-z%°µ][A-Za-z0-9%°µ/*^() ]*)?")


def defused(cell: Any) -> Any:
    """The cell with an apostrophe before a text that a spreadsheet would compute (`=1+1`, `@cmd`); numbers, quantities
    (`-40 degC`) and all else as they are.

    Source: OWASP, CSV Injection (https://owasp.org/www-community/attacks/CSV_Injection).
    """
    if not isinstance(cell, str) or not _FORMULA.match(cell) or _FIGURE.fullmatch(cell):
        return cell
    return f"'{cell}"


def fused(cell: str) -> str:
    """What `defused` was given: the text without the apostrophe that it put before."""
    return cell[1:] if cell.startswith("'") and defused(cell[1:]) == cell else cell
