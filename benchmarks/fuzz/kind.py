"""What a kind of file is, and where the good ones are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from linkwright.core.sections.section import SectionError
from linkwright.core.units.quantities import InputError, NoAnswer

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
REFUSED = (InputError, SectionError, NoAnswer)
"""What may be said of a file instead of reading it."""


@dataclass(frozen=True)
class Kind:
    """Files by name, each with good ones to begin with; what reads them in a folder; and those that stay good."""

    odd: Mapping[str, tuple[str, ...]]
    read: Callable[[Path], object]
    good: Mapping[str, str]


def example(name: str) -> str:
    """The text of a file of the examples."""
    return (EXAMPLES / name).read_text(encoding="utf-8")


def each_of(*readers: Callable[[], object]) -> None:
    """Read several files, whatever becomes of the others. Raises the first refusal."""
    refused: list[Exception] = []
    for read in readers:
        try:
            read()
        except REFUSED as error:
            refused.append(error)
    if refused:
        raise refused[0]
