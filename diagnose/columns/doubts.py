"""All that is doubtful of a recording, a line each, without a diagnosis: for those who publish data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.settings import content_of
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.units.reading import yaml_line

Read = Callable[[Path, Arm, str, Rules], tuple[str, tuple[str, ...], tuple[str, tuple[Mapping[str, Any], ...]] | None]]
_MOST = 8
"""Refusals of one file, each mended before the next shows."""


@dataclass(frozen=True)
class Doubt:
    """What is doubtful: `refused` where no diagnosis is made of the file as it is, `doubted` where it is made and this
    is said beside it."""

    grade: Literal["refused", "doubted"]
    text: str


def doubts_of(file: Path, arm: Arm, settings: str, read: Read, rules: Rules) -> tuple[Doubt, ...]:
    """All that is doubtful of a file as its settings (the text of a recording.yaml) read it.

    What a refusal says to write is written, its first remedy, and the file is read again, until it is read, the same is
    said again, or nothing is known that would do.
    """
    doubts: list[Doubt] = []
    for _ in range(_MOST):
        _, warnings, wrong = read(file, arm, settings, rules)
        if wrong is None:
            return (*doubts, *(Doubt("doubted", text) for text in warnings))
        text, remedies = wrong
        if any(text == doubt.text for doubt in doubts):
            break
        doubts.append(Doubt("refused", text))
        if not remedies:
            break
        settings = _with(settings, remedies[0])
    return tuple(doubts)


def _with(settings: str, remedy: Mapping[str, Any]) -> str:
    """Settings with a remedy written into them."""
    with TemporaryDirectory() as folder:
        place = Path(folder) / "recording.yaml"
        place.write_text(settings, encoding="utf-8")
        held: dict[str, Any] = dict(content_of(place))
    for name, value in remedy.items():
        before = held.get(name)
        if isinstance(before, Mapping) and isinstance(value, Mapping):
            held[name] = dict(before) | dict(value)
        else:
            held[name] = value
    return "".join(f"{name}: {yaml_line(value)}\n" for name, value in held.items())
