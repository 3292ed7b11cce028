"""Arms from other programs' descriptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.descriptions.imported_arm import Imported as Found
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.face.arm import Arm
from linkwright.face.given import File
from linkwright.face.result import Result, figure_of
from linkwright.json.exchange import import_json
from linkwright.output.arm_file import arm_file
from linkwright.output.files import write_file

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Import(Result):
    """An arm from another description, what of it an arm file cannot hold, and what it lacks; `found` in SI."""

    _command = "import"

    found: Found

    @property
    def arm(self) -> Arm:
        """The arm."""
        return Arm.of(self.found.arm)

    @property
    def table(self) -> pd.DataFrame:
        """The joints and links, a row each, with their names in the file."""
        import pandas as pd

        return pd.DataFrame(self._content()["joints"])

    @property
    def lacking(self) -> pd.DataFrame:
        """What the description does not say: `what`, `at` which joints or links (none: all), what it `shows`, what to
        `add`."""
        import pandas as pd

        return pd.DataFrame(self._content()["lacking"])

    @property
    def not_carried(self) -> tuple[str, ...]:
        """What of the description an arm file has no place for."""
        return self.found.lost

    @property
    def doubts(self) -> tuple[str, ...]:
        """Weights that no body of that size has, with their figures."""
        return self.found.doubts

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
        return import_json(self.found)

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
