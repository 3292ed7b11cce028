"""Forms: what describes a displacement that no entry of the library explains. Each says here all that others ask."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from .library import Candidate


@dataclass(frozen=True)
class Form:
    """A form of displacement, which is a description and no cause.

    `sentence` says it in words. It depends on the columns `on`, on the coordinate of one of the joints where it acts
    (`by`, from 0), or on the column that is its shape (`by_column`). A form that is `with_time` goes with the clock or
    the temperature alone, whose course is smooth as a random walk's is; one that `wanders` a walk may look like
    anywhere. A `force` acts through what bends. `shapes` has the values of each that are tried, where these
    are no places or moments of the recording.
    """

    name: str
    sentence: str
    on: tuple[str, ...] = ()
    by: int | None = None
    by_column: bool = False
    with_time: bool = False
    wanders: bool = False
    force: bool = False
    shapes: Mapping[str, tuple[float, ...]] = field(default_factory=dict[str, tuple[float, ...]])

    def of(self, at: tuple[int, ...] = (), shapes: Mapping[str, float] = MappingProxyType({})) -> Candidate:
        """The candidate of this form at some joints (from 0), of these shapes."""
        return Candidate(self.name, at, (), shapes, outside=True)


STEP = Form("step_in_time", "a step in time: something slipped or was moved", ("time",), with_time=True)
JOINT_STEP = Form("joint_step_in_time", "a step in time of one joint: its zero has moved", ("time",), with_time=True)
TOOL_STEP = Form("tool_step_in_time", "a step in time of the tool: it has moved on the hand", ("time",), with_time=True)
LOAD_STEP = Form(
    "load_step_in_time",
    "a step in time of the load at the tip: it has become heavier or lighter",
    ("time", "position"),
    with_time=True,
)
STIFFNESS_STEP = Form(
    "stiffness_step_in_time",
    "a step in time of one joint's stiffness: it gives more or less from then on",
    ("time", "position"),
    with_time=True,
)
PERIODIC = Form("periodic_in_time", "a term that is periodic in time", ("time",), with_time=True)
JOINT_PERIODIC = Form(
    "joint_periodic_in_time", "a motion of one joint that is periodic in time", ("time",), with_time=True
)
TREND = Form("trend_in_time", "a slow curved trend in time", ("time",), with_time=True, wanders=True)
SMOOTH = Form("smooth_in_time", "something that wanders with time", ("time",), with_time=True, wanders=True)
SPRING = Form(
    "spring_to_a_point",
    "a spring to a fixed point (a cable or hose that pulls), acting through what bends",
    ("position",),
    force=True,
)
CONSTANT_FORCE = Form(
    "constant_force", "a constant force at the tip, acting through what bends", ("position",), force=True
)
FORCE_IN_TIME = Form(
    "force_in_time",
    "a force at the tip that wanders with time (a cable or hose), acting through what bends",
    ("time",),
    with_time=True,
    force=True,
    shapes=MappingProxyType({"half_waves": (6.0, 12.0)}),
)
PULL = Form(
    "pull_of_a_point",
    "a pull towards a point (a magnet) that weakens with distance, acting through what bends",
    ("position",),
    force=True,
    shapes=MappingProxyType({"power": (1.0, 3.0), "core": (0.15,)}),
)
FORCE_FIELD = Form(
    "force_field",
    "a force at the tip that varies over the workspace, acting through what bends",
    ("position",),
    force=True,
)
FIELD = Form("field_over_position", "a smooth field over the tip's position", ("position",))
OF_JOINT = Form("smooth_function_of_joint", "a smooth function of one joint's coordinate", by=0)
BY_ANOTHER = Form("joint_by_another", "one joint that is off by where another stands", by=1)
IN_PART = Form("joint_in_part_of_travel", "one joint that is off within a part of its travel", by=0)
WARMTH = Form("temperature", "something that follows the temperature", ("temperature_degC",), with_time=True)
LOADED = Form(
    "payload_and_position",
    "something that grows with the payload and varies over the workspace",
    ("payload_kg", "position"),
)
SIDES = Form("side_of_approach", "something that depends on the side of approach", ("side",))
REGION = Form(
    "region",
    "a displacement within one region of the workspace only",
    ("position",),
    shapes=MappingProxyType({"size": (0.35, 0.7)}),
)
COLUMN = Form("other_column", "something that follows a further column of the recording", by_column=True)
VELOCITY = Form("velocity", "something that follows a joint's velocity", ("velocity",))

FORMS: Mapping[str, Form] = MappingProxyType(
    {
        item.name: item
        for item in (
            *(STEP, JOINT_STEP, TOOL_STEP, LOAD_STEP, STIFFNESS_STEP, PERIODIC, JOINT_PERIODIC, TREND, SMOOTH),
            *(SPRING, CONSTANT_FORCE, FORCE_IN_TIME, PULL, FORCE_FIELD, FIELD, OF_JOINT, BY_ANOTHER, IN_PART),
            *(WARMTH, LOADED, SIDES, REGION, COLUMN, VELOCITY),
        )
    }
)
"""All of them by name."""


def form_of(candidate: Candidate) -> Form:
    """The form of a candidate that is outside the library."""
    return FORMS[candidate.effect]


def sentence_of(candidate: Candidate) -> str:
    """What a form's candidate is, in words; of one that follows a further column, which."""
    form = form_of(candidate)
    return f"something that follows the column {', '.join(candidate.shapes)}" if form.by_column else form.sentence


def followed_by(candidate: Candidate) -> tuple[str, ...]:
    """The columns of the recording that a form's candidate follows."""
    form = form_of(candidate)
    if form.by is not None:
        return (f"q{candidate.at[form.by] + 1}",)
    return tuple(candidate.shapes) if form.by_column else form.on
