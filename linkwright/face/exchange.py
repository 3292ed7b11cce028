"""Arms from and for other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.chain import Link
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.corrections import CORRECTIONS
from linkwright.core.arm.descriptions.exported import unlike
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.descriptions.formats import export_arm as exported
from linkwright.core.arm.descriptions.imported_arm import Imported as ImportedResult
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError, shown
from linkwright.drawings.parts import listed, parts
from linkwright.face.arm import Arm
from linkwright.face.plain_input import File
from linkwright.face.progress import Progress, reporting
from linkwright.face.result import Field, Result, figure_of
from linkwright.json.fields import fields, in_joint_unit, joint_unit
from linkwright.output.arm_file import arm_file
from linkwright.output.files import ReadBack, write_file
from linkwright.output.table_file import WAYS, frame, write_table
from linkwright.results.document import Description, Item, Lines, Paragraph, Value, amount, count, length, table
from linkwright.results.document import table as shown_table
from linkwright.results.figures_in_words import coordinate, figure

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


def describe(result: ImportedResult) -> Description:
    """What was read and what is lacking."""
    arm = result.arm
    rows = [
        (
            count(number + 1),
            result.joint_names[number],
            Value(f"{coordinate(arm, number, joint.range[0])} to {coordinate(arm, number, joint.range[1])}"),
            result.link_names[number],
            length(link.length),
            amount(weight(link), "kg"),
        )
        for number, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True))
    ]
    items: list[Item] = [table(("", "joint", "range", "link", "length", "mass"), rows)]
    if result.notes:
        items.append(Lines(tuple(f"{note}." for note in result.notes)))
    if result.doubts:
        items.append(Paragraph("Weights to look at:", "lead"))
        items.append(Lines(tuple(f"{doubt}." for doubt in result.doubts)))
    if result.lost:
        items.append(table(("not carried",), [(item,) for item in result.lost]))
    items.append(Paragraph("What the file does not say:", "lead"))
    lacking = [
        (item.what + (f" ({', '.join(map(str, item.at))})" if item.at else ""), item.shows, item.add)
        for item in result.lacking
    ]
    items.append(table(("lacking", "what it would show", "what to add"), lacking))
    size = f"{arm.size} joint{'s' if arm.size > 1 else ''}"
    headline = f"{size} from {result.base} to {result.tip}, {_moving(arm)}"
    return Description(f"{arm.name}: from {result.file.name}", headline, tuple(items), headline, f"{arm.name}: ")


def _moving(arm: Model) -> str:
    """What of the arm moves weighs, as far as it is known."""
    known = [mass for link in arm.links if (mass := weight(link)) is not None]
    unknown = [str(number) for number, link in enumerate(arm.links, start=1) if weight(link) is None]
    if not known:
        return "nothing of its weight is known"
    text = f"{figure(sum(known))} kg that move"
    return f"{text}, without link{'s' * (len(unknown) > 1)} {', '.join(unknown)} of unknown mass" if unknown else text


def weight(link: Link) -> float | None:
    """The mass (kg) of an imported link; None where it is not known."""
    return None if link.mass is None else link.mass + sum(mass.mass for mass in link.masses)


@dataclass(frozen=True, repr=False)
class Import(Result):
    """An arm from another description, what of it an arm file cannot hold, and what it lacks; `found` in SI."""

    _command = "import"
    _describe = staticmethod(describe)

    found: ImportedResult

    @property
    def arm(self) -> Arm:
        """The arm."""
        return Arm.of(self.found.arm)

    @property
    def table(self) -> pd.DataFrame:
        """The joints and links, a row each, with their names in the file."""
        return frame(self._content()["joints"])

    @property
    def lacking(self) -> pd.DataFrame:
        """What the description does not say: `what`, `at` which joints or links (none: all), what it `shows`, what to
        `add`."""
        return frame(self._content()["lacking"])

    not_carried = Field[tuple[str, ...]]("What of the description an arm file has no place for.", "lost")
    doubts = Field[tuple[str, ...]]("Weights that no body of that size has, with their figures.")

    def plot(self) -> go.Figure:
        """The joints and the tip with all joints at 0."""
        return skeleton(self.found.arm)

    def save(self, folder: File) -> Sequence[Path]:
        """Write the arm file, with the names of the description and what is lacking as comments; into a folder as
        `arm.yaml`."""
        place_ = Path(folder)
        text = arm_file(self.found.arm, load_catalogue(), text=self.found.to_yaml())
        target = place_ / "arm.yaml" if place_.is_dir() else place_
        write_file(target, text)
        return [target]

    def _content(self) -> Mapping[str, Any]:
        imported = self.found
        return {
            **fields(imported, "arm=arm.name"),
            "file": str(imported.file),
            **fields(imported, "base", "tip"),
            "joints": [self._joint(index) for index in range(imported.arm.size)],
            **fields(imported, "notes", "doubts", "not_carried=lost"),
            "lacking": [fields(item, "what", "at", "shows", "add") for item in imported.lacking],
        }

    def _joint(self, index: int) -> dict[str, Any]:
        """A joint and its link, in degrees (mm for slides) and kg."""
        imported, arm = self.found, self.found.arm
        joint, link, unit = arm.joints[index], arm.links[index], joint_unit(arm, index)
        speed = None if joint.velocity is None else in_joint_unit(arm, index, joint.velocity)
        return {
            "joint": imported.joint_names[index],
            "link": imported.link_names[index],
            "type": joint.type,
            f"range_{unit}": [in_joint_unit(arm, index, end) for end in joint.range],
            "length_mm": 1e3 * link.length,
            "mass_kg": weight(link),
            **fields(link, "inertia_kg_m2=inertia"),
            "effort_Nm" if joint.revolute else "effort_N": joint.effort,
            f"velocity_{unit}_per_s": speed,
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Chain": self.table, "Lacking": self.lacking}


def skeleton(arm: Model) -> go.Figure:
    """The joints and the tip of an arm with all joints at 0, mm."""
    frames = place(arm, [0.0] * arm.size)
    points: list[tuple[float, ...]] = [(0.0, 0.0, 0.0)]
    for joint, link in zip(frames.joints, frames.links, strict=True):
        for step in (joint.lead, link.vector):
            points.append(tuple(a + float(b) for a, b in zip(points[-1], step, strict=True)))
    points.append(tuple(a + float(b) for a, b in zip(points[-1], frames.tool, strict=True)))
    x, y, z = ([1e3 * value for value in axis] for axis in zip(*points, strict=True))
    return figure_of({"data": [{"type": "scatter3d", "mode": "lines+markers", "x": x, "y": y, "z": z}]})


SUFFIXES: Mapping[str, str] = MappingProxyType(
    {
        "urdf": ".urdf",
        "mjcf": ".xml",
        "dxf": ".dxf",
        "step": ".step",
        "bom": "-parts.csv",
        "ros2-offsets": "-transmissions.xml",
        "klipper": ".cfg",
        "csv": "-corrections.csv",
    }
)
"""How the files of each format are called."""


def _rows(result: Exported) -> list[tuple[str, str]]:
    parts = (("carried", result.carried), ("not carried", result.lost), ("assumed", result.assumed))
    return [(what, line) for what, lines in parts for line in lines]


def describe_export(result: Exported) -> Description:
    """What went into the file and what did not."""
    left = f"{len(result.lost)} not carried" if result.lost else "nothing missing"
    headline, name = f"{result.format.upper()}, {left}", result.arm.name
    items = (shown_table(("", ""), _rows(result)),)
    return Description(f"{name}: as {result.format.upper()}", headline, items, headline, f"{name}: ")


@dataclass(frozen=True, repr=False)
class Export(Result):
    """An arm in another program's format, and what that could not carry; `found` in SI."""

    _command = "export"
    _describe = staticmethod(describe_export)

    arm: Arm
    found: Exported
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
        the kind that its name says: .csv, .parquet, .md."""
        place = Path(folder)
        ending = SUFFIXES[self.found.format] if self.into is None else Path(self.into).suffix
        target = place / f"arm{ending}" if place.is_dir() else place
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
    """The format to write, None for what somebody's file is in. Raises `InputError`."""
    if (to is None) == (into is None):
        raise InputError("", "to", "is due, or `into` FILE, but not both; e.g. urdf")
    if to is not None and to not in SUFFIXES:
        raise InputError("", "to", f"{shown(to)} is no format; write {', '.join(SUFFIXES)}")
    return to


def written_as(arm: Arm, to: str, progress: Progress | None) -> Exported:
    """The arm in a format. Raises `InputError` for one that needs what is not installed."""
    if to == "dxf":
        try:
            from linkwright.drawings.dxf import drawn
        except ModuleNotFoundError:
            raise InputError("", "to", not_installed("DXF", "ezdxf", "dxf")) from None

        return drawn(arm.model)
    if to == "step":
        from linkwright.drawings.step import stepped

        with reporting(progress) as tell:
            return stepped(arm.model, tell)
    if to in CORRECTIONS:
        return CORRECTIONS[to](arm.model)
    return listed(arm.model) if to == "bom" else exported(arm.model, to)
