"""Arms as other programs' descriptions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.descriptions.formats import Exported as Found
from linkwright.core.arm.descriptions.formats import export_arm as exported
from linkwright.core.arm.descriptions.into import into_file
from linkwright.core.arm.descriptions.read_back import unlike
from linkwright.core.units.quantities import InputError, shown
from linkwright.drawings.parts import listed, parts
from linkwright.face.arm import Arm, arm_of
from linkwright.face.given import File
from linkwright.face.progress import Progress, told
from linkwright.face.result import Result
from linkwright.json.exchange import export_json
from linkwright.output.files import write_file
from linkwright.output.read_back import ReadBack
from linkwright.output.table_file import WAYS, write_table

from .imported import skeleton

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


SUFFIXES: Mapping[str, str] = MappingProxyType(
    {"urdf": ".urdf", "mjcf": ".xml", "dxf": ".dxf", "step": ".step", "bom": "-parts.csv"}
)
"""How the files of each format are called."""


@dataclass(frozen=True, repr=False)
class Export(Result):
    """An arm in another program's format, and what that could not carry; `found` in SI."""

    _command = "export"

    arm: Arm
    found: Found
    into: File | None = None
    """Whose file it is, where that is somebody's own, whose tips have names of their own."""

    @property
    def text(self) -> str:
        """The file."""
        return self.found.text

    @property
    def not_carried(self) -> tuple[str, ...]:
        """What of the arm the format has no place for."""
        return self.found.lost

    @property
    def table(self) -> pd.DataFrame:
        """What is carried, what is not, and what had to be assumed."""
        import pandas as pd

        found = self.found
        rows = [("carried", each) for each in found.carried]
        rows += [("not carried", each) for each in found.lost] + [("assumed", each) for each in found.assumed]
        return pd.DataFrame(rows, columns=["", "what"])

    def plot(self) -> go.Figure:
        """The joints and the tip with all joints at 0."""
        return skeleton(self.arm.model)

    def save(self, folder: File) -> None:
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

    def _content(self) -> Mapping[str, Any]:
        return export_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Carried": self.table}


def export_arm(
    arm: Arm | File, *, to: str | None = None, into: File | None = None, progress: Progress | None = None
) -> Export:
    """The arm as `urdf`, `mjcf` (with all that gives: MuJoCo sags as the arm does), `dxf` (links and sections drawn to
    scale, with dimensions), `step` (links as solid bodies, with the extra `step`) or `bom` (its parts as CSV: sizes,
    masses, centres, inertias, prices). `progress` hears of the bodies as they are made.

    `into` in place of `to` is somebody's own URDF or MJCF file, whose joints the arm names: its text with what
    `effects` say of zeros, lengths and axes (and in MJCF of drives' stiffness), byte for byte as it was otherwise.

    Raises `InputError` for another format, for an arm with absolute angles, which no simulator's format knows, and
    for `step` without build123d; `MissingProperty` for parts of unknown mass.

    >>> import linkwright as lw
    >>> found = lw.export_arm("examples/welding-arm/arm.yaml", to="mjcf")
    >>> found
    <Export: MJCF, nothing left out>
    """
    if into is not None:
        if to is not None:
            raise InputError("", "into", "goes without a format, which is that of its file; leave one out")
        given = arm_of(arm, tips="every")
        return Export(given, into_file(given.model, into), into)
    if to is None:
        raise InputError("", "to", f"is missing; write {', '.join(SUFFIXES)}, or into: a file of your own")
    if to not in SUFFIXES:
        raise InputError("", "to", f"{shown(to)} is no format; write {', '.join(SUFFIXES)}")
    given = arm_of(arm, tips="every")
    if to == "dxf":
        try:
            from linkwright.drawings.dxf import drawn
        except ModuleNotFoundError:
            message = "DXF needs ezdxf, which is not installed: pip install 'linkwright[dxf]'"
            raise InputError("", "to", message) from None

        return Export(given, drawn(given.model))
    if to == "step":
        from linkwright.drawings.step import stepped

        with told(progress) as tell:
            return Export(given, stepped(given.model, tell))
    return Export(given, listed(given.model) if to == "bom" else exported(given.model, to))
