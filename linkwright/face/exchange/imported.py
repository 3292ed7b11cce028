"""Arms from other programs' descriptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.descriptions.imported import import_urdf
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

    def save(self, folder: File) -> None:
        """Write the arm file, with the names of the description and what is lacking as comments; into a folder as
        `arm.yaml`."""
        place_ = Path(folder)
        text = arm_file(self.found.arm, load_catalogue(), text=self.found.to_yaml())
        write_file(place_ / "arm.yaml" if place_.is_dir() else place_, text)

    def _content(self) -> Mapping[str, Any]:
        return import_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Chain": self.table, "Lacking": self.lacking}


def import_arm(file: File, *, tip: str | Sequence[str] | None = None, base: str | None = None) -> Import:
    """The arm that a URDF file describes, from a link `base` (the root by default) to a link `tip` (the only end by
    default), with a list of what the file does not say. With several tips it is as many arms on the torso that they
    share (`branches`), each named by its tip.

    Lengths, axes, limits and weights are those of the file. Raises `InputError` for what is no URDF, for a tip that is
    ambiguous (the line lists them), and for joints on the way that an arm cannot have.

    >>> import linkwright as lw
    >>> found = lw.import_arm("examples/urdf/tabletop.urdf", tip="tip")
    >>> found
    <Import: 3 joints from base to tip, 2.5 kg that move>
    >>> list(found.lacking["what"][:2])
    ['stiffness of the drives', 'backlash']
    """
    return Import(import_urdf(file, base=base, tip=tip))


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
