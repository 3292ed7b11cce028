"""Arms as other programs' descriptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.descriptions.formats import Exported as Found
from linkwright.core.arm.descriptions.formats import export_arm as exported
from linkwright.core.arm.descriptions.urdf_check import unlike
from linkwright.core.units.quantities import InputError, shown
from linkwright.drawings.parts import listed, parts
from linkwright.face.arm import Arm
from linkwright.face.given import File
from linkwright.face.progress import Progress, told
from linkwright.face.result import Field, Result
from linkwright.json.fields import fields
from linkwright.output.files import write_file
from linkwright.output.read_back import ReadBack
from linkwright.output.table_file import WAYS, frame, write_table
from linkwright.results.document import Description
from linkwright.results.document import table as shown_table

from .imported import skeleton

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


SUFFIXES: Mapping[str, str] = MappingProxyType(
    {"urdf": ".urdf", "mjcf": ".xml", "dxf": ".dxf", "step": ".step", "bom": "-parts.csv"}
)
"""How the files of each format are called."""


def _rows(found: Found) -> list[tuple[str, str]]:
    parts = (("carried", found.carried), ("not carried", found.lost), ("assumed", found.assumed))
    return [(what, each) for what, lines in parts for each in lines]


def describe(found: Found) -> Description:
    """What went into the file and what did not."""
    left = f"{len(found.lost)} not carried" if found.lost else "nothing left out"
    headline, name = f"{found.format.upper()}, {left}", found.arm.name
    items = (shown_table(("", ""), _rows(found)),)
    return Description(f"{name}: as {found.format.upper()}", headline, items, headline, f"{name}: ")


@dataclass(frozen=True, repr=False)
class Export(Result):
    """An arm in another program's format, and what that could not carry; `found` in SI."""

    _command = "export"
    _describe = staticmethod(describe)

    arm: Arm
    found: Found
    into: File | None = None
    """Whose file it is, where that is somebody's own, whose tips have names of their own."""

    text = Field[str]("The file.")
    not_carried = Field[tuple[str, ...]]("What of the arm the format has no place for.", "lost")

    @property
    def table(self) -> pd.DataFrame:
        """What is carried, what is not, and what had to be assumed."""
        return frame(_rows(self.found), ["", "what"])

    def plot(self) -> go.Figure:
        """The joints and the tip with all joints at 0."""
        return skeleton(self.arm.model)

    def save(self, folder: File) -> Sequence[Path]:
        """Write the file; into a folder under the name `arm` with the format's ending. A list of parts is a table, of
        the kind that its name says: .csv, .parquet, .md, .tex."""
        place = Path(folder)
        target = place / f"arm{SUFFIXES[self.found.format]}" if place.is_dir() else place
        if self.found.format == "bom" and target.suffix.lower() in WAYS:
            write_table(parts(self.arm.model), target)
        else:
            text = self.found.text
            read = partial(unlike, self.arm.model) if self.found.format == "urdf" and self.into is None else None
            write_file(target, text if read is None else ReadBack(text, read))
        return [target]

    def _content(self) -> Mapping[str, Any]:
        return fields(self.found, "arm=arm.name", "to=format", "carried", "not_carried=lost", "assumed", "text")

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Carried": self.table}


def format_of(to: str | None, into: File | None) -> str | None:
    """The format to write, None for what somebody's own file is in. Raises `InputError`."""
    if (to is None) == (into is None):
        raise InputError("", "to", "is due, or `into` FILE, but not both; e.g. urdf")
    if to is not None and to not in SUFFIXES:
        raise InputError("", "to", f"{shown(to)} is no format; write {', '.join(SUFFIXES)}")
    return to


def written_as(arm: Arm, to: str, progress: Progress | None) -> Found:
    """The arm in a format. Raises `InputError` for one that needs what is not installed."""
    if to == "dxf":
        try:
            from linkwright.drawings.dxf import drawn
        except ModuleNotFoundError:
            message = "DXF needs ezdxf, which is not installed: pip install 'linkwright[dxf]'"
            raise InputError("", "to", message) from None

        return drawn(arm.model)
    if to == "step":
        from linkwright.drawings.step import stepped

        with told(progress) as tell:
            return stepped(arm.model, tell)
    return listed(arm.model) if to == "bom" else exported(arm.model, to)
