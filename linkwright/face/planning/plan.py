"""Which poses, payloads and sides are worth recording, and what they will show."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.answer.sentences import name_of
from linkwright.core.diagnose.instruments.registry import labels
from linkwright.core.diagnose.plan.planned import Planned
from linkwright.core.diagnose.plan.promise import Shown
from linkwright.core.diagnose.plan.torques import TorquePromise
from linkwright.core.diagnose.plan.written import ALONG_BAR, left_blank, plan_text, read_plan
from linkwright.core.diagnose.reading.read_back import unlike
from linkwright.core.diagnose.reading.write import settings_text
from linkwright.face.arm import Arm
from linkwright.face.plain_input import File
from linkwright.face.recording import recording_columns, saved
from linkwright.face.result import Field, Result, drawn
from linkwright.json.diagnosis import joint_coordinates
from linkwright.json.fields import fields
from linkwright.json.parameters import in_unit, unit_of
from linkwright.output.table_file import frame
from linkwright.results.planning import describe

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Plan(Result):
    """Readings to take, in their order, and what they will show; `found` holds everything in SI."""

    _command = "plan"
    _describe = staticmethod(describe)

    arm: Arm
    found: Planned

    interrupted = Field[bool]("Whether Ctrl-C ended the choice. This is the best plan until then.")

    @property
    def visits(self) -> pd.DataFrame:
        """A row for each visit by the columns of a recording: `q1_deg`, `dir1`, `payload_kg`, ..."""
        import pandas as pd

        visits = self.found.visits
        columns: dict[str, Any] = {
            name: values for name, values, _ in recording_columns(visits, self.arm.model) if name not in left_blank()
        }
        return pd.DataFrame(columns, index=pd.RangeIndex(1, visits.size + 1, name="visit"))

    @property
    def shown(self) -> pd.DataFrame:
        """The smallest size of each cause that will be seen, in `unit`, and what poses at random show (nan: nothing);
        from which size on it is distinguished from other causes, and how many it is not distinguished from."""
        keys = ("effect", "at", "parameter", "unit", "usual", "smallest", "random", "told_from", "not_told")
        rows = [{**item, "not_told": len(item["not_told"])} for item in self._content()["shown"]]
        return frame(rows, keys)

    def text(self) -> str:
        """The plan as CSV: a recording whose tip is still blank."""
        held = bool(self.found.asked.torque_noise)
        return plan_text(self.found.recording, self.arm.model, self.found.axes, torques=held)

    @property
    def settings(self) -> str | None:
        """What stands beside a plan as recording.yaml: of heights or distances what reads them, of several arms on one
        torso whose tip it is; None where it need not."""
        return settings_text(self.found.recording) if self.found.asked.slots or self.arm.model.branches else None

    def save(self, folder: File) -> Sequence[Path]:
        """Write the plan as CSV, and beside it what it reads where that is no place, as `plan --out` does; gives which
        files. Raises `InputError`, also where settings of another's stand beside it."""
        return saved(folder, self.text(), self.settings, self._unlike)

    def _unlike(self, path: Path) -> Iterator[str]:
        """What the plan that is read from a file says otherwise; what it leaves blank says nothing."""
        back = read_plan(path, self.arm.model)
        return unlike(
            self.found.recording, back, self.arm.model, without=(*left_blank(), *labels().values(), ALONG_BAR)
        )

    def plot(self) -> go.Figure:
        """The smallest size of each cause over what is usual at most: this plan, and poses at random."""
        shown = self.found.promise.shown
        random = [self.found.at_random(item) / item.usual for item in shown]
        bars = {
            "planned": [item.smallest / item.usual for item in shown],
            "at random": [share if math.isfinite(share) else None for share in random],
        }
        names = [name_of(item.effect, item.at) for item in shown]
        return drawn(names, bars, "", "smallest size over what is usual", mode="bar", type="log")

    def _content(self) -> Mapping[str, Any]:
        planned, promise = self.found, self.found.promise
        request, arm = planned.asked, planned.arm
        return {
            "arm": arm.name,
            **({"tip": arm.tip} if arm.branches else {}),
            "readings": planned.recording.size,
            **fields(request, "poses", "repeats", "instrument", "frame", "tool", "seed"),
            **_scatter(planned),
            "sees": list(planned.axes),
            "payloads_kg": list(request.payloads),
            "after": None if planned.after is None else planned.after.file,
            "torque_noise": list(request.torque_noise),
            "torques": [_torque(planned, torque) for torque in promise.torques],
            "shown": [_shown(planned, item) for item in promise.shown],
            "unseen": [{"effect": effect, "at": list(at)} for effect, at in promise.unseen],
            **fields(promise, "pairs", "pairs_told=separated"),
            "pairs_random": planned.separated_at_random[1],
            "pairs_told_random": planned.separated_at_random[0],
            "random_plans": len(planned.random),
            "interrupted": planned.interrupted,
            "touches": [
                {**fields(item, "label", "at_mm", "normal"), **({} if item.way is None else fields(item, "way"))}
                for item in planned.touched
            ],
            **fields(planned, "returns", "correlation_with_time=with_time", "tried"),
            "visits": [_visit(planned, row) for row in range(planned.visits.size)],
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Shown": self.shown, "Visits": self.visits}


def _visit(planned: Planned, row: int) -> dict[str, Any]:
    visits = planned.visits
    return {
        "q": joint_coordinates(planned.arm, visits.q[row].tolist()),
        "dir": [] if visits.sides is None else [int(side) for side in visits.sides[row]],
        "payload_kg": None if visits.payload_mass is None else float(visits.payload_mass[row]),
        **({} if visits.touches is None else {"touches": visits.instrument.labels[int(visits.touches[row])]}),
        **({} if visits.bar_at is None else {"bar_mm": 1e3 * float(visits.bar_at[row])}),
    }


def _scatter(planned: Planned) -> dict[str, Any]:
    """What is read scatters by: a length, of a level an angle, of a camera both."""
    request = planned.asked
    if request.instrument == "tilt":
        return fields(request, "sigma_deg")
    if request.instrument != "camera":
        return fields(request, "sigma_mm")
    deep, turns = request.camera_noise
    return {**fields(request, "sigma_mm"), "sigma_depth_mm": 1e3 * deep, "sigma_angle_deg": math.degrees(turns)}


def _torque(planned: Planned, torque: TorquePromise) -> dict[str, Any]:
    """What a drive's torque will tell, half the width of 95 % intervals: shares of the weights, N*m (of slides N)."""
    names = ("links", "payload", "friction")
    bounds = {f"{name}_within": _within(getattr(torque, name)) for name in names}
    random = {f"{name}_within_random": _within(planned.torques_at_random(torque.joint, name)) for name in names}
    return {**fields(torque, "joint", "together"), **bounds, **random}


def _within(error: float | None) -> float | None:
    return None if error is None or not math.isfinite(error) else 1.96 * error


def _shown(planned: Planned, shown: Shown) -> dict[str, Any]:
    def size(value: float) -> float | None:
        return in_unit(value, shown.kind)

    return {
        **fields(shown, "effect", "at", "parameter", "rms_mm"),
        "unit": unit_of(shown.kind),
        "usual": size(shown.usual),
        "smallest": size(shown.smallest),
        "random": size(planned.at_random(shown)),
        "told_from": size(shown.resolved_size),
        "others": len(shown.others),
        "not_told": [
            {**fields(rival, "effect", "at", "likeness"), "told_from": size(rival.resolved_size)}
            for rival in shown.inseparable
        ],
    }
