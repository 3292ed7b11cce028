"""A column as read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from linkwright.core.sections.numeric import Array

from .columns import ColumnMeaning


@dataclass(frozen=True)
class ReadColumn:
    """A column as read: what it means, its header, its values (SI), and how to say what is wrong with a cell. `ours` is
    our header for it and `formula` what makes it of the file's columns, each empty where that is its header."""

    meaning: ColumnMeaning
    header: str
    values: Array
    fault: Callable[[int], str]
    ours: str = ""
    formula: str = ""
