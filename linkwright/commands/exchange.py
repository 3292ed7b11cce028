"""The commands that read and write other programs' files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from linkwright.core.units.quantities import InputError
from linkwright.output.files import DESIGN

from .made import Made, Out, Targets

HOME = "linkwright.api.exchange"


class Written(Made):
    """A command that writes a file whether one is named or not, but over none that is there unasked."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """The file to write, by default a new one."""
        if targets.out is None:
            name = self.named(words)
            if name.exists():
                raise InputError(name, "", "is there already; name the file to write with --out")
            targets = replace(targets, out=name)
        return super().checked(targets, words, inputs)

    def named(self, words: dict[str, Any]) -> Path:
        """What the file is called by default."""
        del words
        return Path(DESIGN)


class Export(Written):
    """`export`: the file is called after the arm's."""

    def named(self, words: dict[str, Any]) -> Path:
        """After the arm file, or after the one that it is written into. Raises `InputError`."""
        from linkwright.face.exchange.exported import SUFFIXES, format_of

        arm, into = words["arm"], words["into"]
        to = format_of(words["to"], into)
        return Path(f"{into.stem}-corrected{into.suffix}") if to is None else Path(arm.stem + SUFFIXES[to])


def commands() -> Mapping[str, Made]:
    """These commands by name."""
    read = Out("The arm file to write; a new arm.yaml by default.", ())
    written = Out("The file to write; a new one called as the arm file by default.", ())
    made = (
        Written("import", HOME, "import_arm", out=read, catalogue=False),
        Export("export", HOME, "export_arm", out=written),
    )
    return {each.name: each for each in made}
