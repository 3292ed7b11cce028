"""What an import comes to: the arm, what was decided, and what its file lacks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.write import arm_to_yaml


@dataclass(frozen=True)
class Lacking:
    """Something that the file does not say: `what`, of which joints or links (from 1; none: of all), what it `shows`
    and what to `add` to the arm file."""

    what: str
    at: tuple[int, ...]
    shows: str
    add: str


@dataclass(frozen=True)
class Imported:
    """An arm from another description: which joints and links of it are the arm's, what was decided, what is lacking.

    `joint_names` and `link_names` are those of the file, from the base out; `notes` say what was folded or held, `lost`
    what of the file an arm file has no place for, `doubts` which of its weights no body of that size has. `unread`
    repeats of the notes those on meshes that are not there, without which weights are unknown or guessed.
    """

    arm: Arm
    file: Path
    base: str
    tip: str
    joint_names: tuple[str, ...]
    link_names: tuple[str, ...]
    notes: tuple[str, ...]
    lacking: tuple[Lacking, ...]
    lost: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()

    def to_yaml(self) -> str:
        """The arm file, with what is lacking, doubtful or not carried as comments."""
        lines = [f"# From {one_line(self.file.name)}, {one_line(self.base)} to {one_line(self.tip)}."]
        lines += [f"# {one_line(note)}." for note in self.notes]
        for heading, said in (("Doubtful:", self.doubts), ("Not carried from it:", self.lost)):
            lines += ["#", f"# {heading}", *(f"# - {one_line(item)}" for item in said)] if said else []
        lines += ["#", "# What it does not say:"]
        lines += [f"# - {item.what}{_at(item.at)}: {item.shows}; add {item.add}" for item in self.lacking]
        return "\n".join(lines) + "\n" + arm_to_yaml(self.arm)


def one_line(text: str) -> str:
    """A text without line breaks and what does not print."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _at(places: tuple[int, ...]) -> str:
    return f" ({', '.join(map(str, places))})" if places else ""
