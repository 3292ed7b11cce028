"""What a serial arm is: joints, links, loads and the physics that its model holds.

Everything here is SI and plain data; `arm.files.read` reads it from arm.yaml, `arm.chain.kinematics` places it in
space.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

from .balance import Counterbalance, PointMass
from .following import Following, coordinates
from .vectors import IDENTITY, ZERO, Rotation, Scalar

if TYPE_CHECKING:
    from linkwright.core.arm.actuators import Actuator
    from linkwright.core.arm.avoid.obstacle import Obstacle
    from linkwright.core.arm.bodies.inertia import Moving
    from linkwright.core.materials.material import Material
    from linkwright.core.sections.section import Section

FloatVector = tuple[float, float, float]

STANDARD_GRAVITY: FloatVector = (0.0, -9.81, 0.0)

JointType = Literal["revolute", "prismatic"]
PlayMode = Literal["worst", "loaded", "statistical"]
AngleConvention = Literal["relative", "absolute"]

OriginPart = Literal["x", "y", "z", "roll", "pitch", "yaw"]
"""A number of a fixed transform: a shift (m) in the frame before it, or an angle (rad) of its turn about fixed axes."""

Zones = tuple[tuple[float, float], ...]
"""Zones of load, each with the load at which it ends (the last: infinite) and the stiffness within it."""


@dataclass(frozen=True)
class DhRow:
    """A joint's Denavit-Hartenberg parameters as an arm file has them: a, d (m), alpha, theta (rad), and whether they
    are the modified (proximal, Craig's) ones."""

    a: float
    d: float
    alpha: float
    theta: float
    modified: bool


@dataclass(frozen=True)
class GuideBeam:
    """The beam along which the carriage of an arm's first slide runs, held at both ends: of a `length` (m), from the
    coordinate `begins_at` (m) on, as one of so many `rails` that share the load. `height_direction` is where its
    section's height lies, in the joint's frame; `section_name` the stock size that the section was named by."""

    length: float
    section: Section
    material: Material
    supports: Literal["simple", "clamped"] = "simple"
    rails: Literal[1, 2] = 1
    begins_at: float = 0.0
    height_direction: FloatVector = (0.0, 1.0, 0.0)
    section_name: str | None = None

    @property
    def mass(self) -> float:
        """The mass of all rails, kg."""
        area = float(self.section.properties(0.3).area)
        return self.rails * self.length * area * self.material.at(REFERENCE_TEMPERATURE).need("density")


@dataclass(frozen=True)
class Joint:
    """A joint and its drive. Angles in rad, lengths in m; a prismatic joint's range and backlash are lengths.

    `axis` is a unit vector in the joint's frame, which stands at the end of the previous link, turned by
    `origin_rotation` and shifted by `origin_translation` (both in the previous link's frame). `zero` is added to
    the coordinate. `stiffness` is in N*m/rad (revolute) or N/m (prismatic); None is a rigid drive. `backlash` is
    the total lost motion, `clearance` the radius of the disc in which the pin's centre can lie. `spans` is how many of
    the following links make up the body that the drive turns: one, unless a link was cut into segments. `actuator` is
    the catalogue's entry that the drive was named by: its rated torque and cost count with it. `zones` are those of a
    drive that is stiffer under more load, each the load (N*m) at which it ends and its stiffness; `stiffness` is then
    that of the softest. None: the same under any load. `counterbalance` takes load off the drive, `motor_on_base` (kg)
    is the mass of a motor of the joint that stands on the base. `follows` is what of other joints' coordinates moves
    it. `cost` (EUR) is what the joint costs with its drive, as of `cost_date` (`2026-01`); None: what its drive does.
    `passive` says that it has no drive: it is turned by hand, or by what holds the tip, and an encoder reads it.
    `tilting_stiffness` (N*m/rad) is that of the bearing of a joint that turns, across its axis; None: rigid.
    `origin_free` names what nobody knows of where its frame stands on the link before (see `OriginPart`): a diagnosis
    finds it, and the figures here are a guess. `name` is what other programs call it; `effort` (N*m or N) and
    `velocity` (rad/s or m/s) are the greatest that its drive gives, which they ask for and no figure here rests on.
    `dh` are the parameters by which the file says where it stands. `rated_torque` and `peak_torque` (N*m; N for a
    slide) are what the drive gives at the joint for long and for a moment; None: those of its `actuator`. `guide` is
    the beam along which a slide runs; None: a rigid one.
    """

    type: JointType = "revolute"
    axis: FloatVector = (0.0, 0.0, 1.0)
    range: tuple[float, float] = (-math.pi, math.pi)
    clearance: float = 0.0
    backlash: float = 0.0
    stiffness: float | None = None
    mass: float = 0.0
    zero: float = 0.0
    spans: int = 1
    origin_rotation: Rotation = IDENTITY
    origin_translation: FloatVector = ZERO
    actuator: Actuator | None = None
    zones: Zones = ()
    counterbalance: Counterbalance | None = None
    motor_on_base: float = 0.0
    follows: Following | None = None
    cost: float | None = None
    cost_date: str = ""
    balancer_chosen: str = field(default="", compare=False)
    passive: bool = False
    tilting_stiffness: float | None = None
    origin_free: tuple[OriginPart, ...] = ()
    name: str = ""
    effort: float | None = None
    velocity: float | None = None
    dh: DhRow | None = field(default=None, compare=False)
    rated_torque: float | None = None
    peak_torque: float | None = None
    guide: GuideBeam | None = None

    @property
    def rating(self) -> tuple[float | None, float | None]:
        """What the drive gives for long and for a moment, N*m (N for a slide); None where it is not known."""
        actuator = self.actuator
        rated = self.rated_torque if actuator is None else self.rated_torque or actuator.rated_torque
        peak = self.peak_torque if actuator is None else self.peak_torque or actuator.peak_torque
        return rated, peak

    @property
    def greatest_static_load(self) -> float | None:
        """What the drive can hold at rest: its rated torque, or the peak that the file gives where only that is
        known. (What a catalogue's servo stalls at is nothing that it holds.)"""
        rated, _ = self.rating
        return self.peak_torque if rated is None else rated

    @property
    def driven(self) -> bool:
        """Whether the joint has an independent coordinate; one that only follows has none."""
        return self.follows is None or self.follows.driven

    @property
    def revolute(self) -> bool:
        """Whether the joint turns (a prismatic one slides)."""
        return self.type == "revolute"


_ASKEW = 1e-9
"""Of a direction's component, what rounding makes of zero."""
_OFF = 1e-6
"""A shear centre this near to the centroid, as a share of width and height together, is at it."""


@dataclass(frozen=True)
class Asymmetry:
    """What a section lacks of symmetry: whether it is `askew` (it bends out of the load's plane), whether its shear
    centre is off its centroid along its height and along its width (a load at the centroid twists it), and whether it
    `warps` where it is twisted."""

    askew: bool = False
    off_height: bool = False
    off_width: bool = False
    warps: bool = False

    @property
    def eccentric(self) -> bool:
        """Whether some load at the centroid twists it."""
        return self.off_height or self.off_width

    def with_that(self, other: Asymmetry) -> Asymmetry:
        """What either lacks."""
        pairs = ((getattr(self, item.name), getattr(other, item.name)) for item in fields(Asymmetry))
        return Asymmetry(*(one or two for one, two in pairs))

    def covers(self, other: Asymmetry) -> bool:
        """Whether it lacks all that another lacks."""
        return self.with_that(other) == self


SYMMETRIC = Asymmetry()
"""Of a section with two axes of symmetry, along its height and its width."""


@lru_cache(maxsize=256)
def asymmetry_of(section: Section) -> Asymmetry:
    """What a section, of plain numbers, lacks of symmetry."""
    properties = section.properties(0.3)
    moments = float(properties.second_moment_y) + float(properties.second_moment_z)
    # Boundary elements place the shear centre of a symmetric polygon within rounding of its centroid.
    size = _OFF * (float(properties.width) + float(properties.height))
    return Asymmetry(
        abs(float(properties.product_moment_yz)) > 1e-12 * moments,
        abs(float(properties.shear_centre_z)) > size,
        abs(float(properties.shear_centre_y)) > size,
        float(properties.warping_constant) != 0.0,
    )


@dataclass(frozen=True)
class Flange:
    """What gives at a link's far end: stiffness (N*m/rad) against tilting across the link, and against torsion about
    it; None: rigid."""

    tilting_stiffness: float | None = None
    torsional_stiffness: float | None = None


Matrix = tuple[tuple[float, ...], ...]
"""Rows of numbers."""
_UNCOUPLED = 1e-9
"""Of a compliance, against those of its row and column: what rounding makes of zero."""


@dataclass(frozen=True)
class Link:
    """A straight link: `length` m along the unit vector `direction` of its frame, then `end_rotation`.

    The link is elastic where it has a section and a material; a rigid one has a `mass` (kg, None where unknown)
    at `center_of_mass` m from its joint (the middle by default). `height_direction` is the direction in the
    link's frame along which the section's height lies; None takes the plane in which the joint turns the link, and
    `height_up` says that the file called it `up`.
    `section_name` is the stock size that the section was named by, for writing it back. `masses` hang on its ends.
    `cost` (EUR) is for the part beside its material: machining, fittings; for a rigid link all of it; `cost_date` is
    when (`2026-01`). One that `runs_out` slides along itself out of a sleeve where its joint, a slide, stands at zero:
    it is a cantilever as long as its joint's coordinate (with its `zero`), and what has not run out stays in the sleeve
    and weighs there. `name` is what other programs call it. `inertia` of a rigid link (kg*m^2; xx, yy, zz, xy, xz, yz
    along the axes of its frame) is that of all that weighs on it (`mass` and `masses`, but motors of joints) about
    their common centre; None: not known. `may_lack` is what the sections that may be chosen for it lack of symmetry.
    `flange` is what gives at its far end. `compliance` (6, 6), of a link without a section, is how its far end moves
    (m) and turns (rad) under a force (N) and a moment (N*m) there, along the axes of its frame; None: rigid.
    """

    length: float
    direction: FloatVector = (1.0, 0.0, 0.0)
    end_rotation: Rotation = IDENTITY
    section: Section | None = None
    material: Material | None = None
    mass: float | None = None
    center_of_mass: float | None = None
    height_direction: FloatVector | None = None
    height_up: bool = field(default=False, compare=False)
    section_name: str | None = None
    masses: tuple[PointMass, ...] = ()
    cost: float | None = None
    cost_date: str = ""
    runs_out: bool = False
    name: str = ""
    inertia: tuple[float, float, float, float, float, float] | None = None
    may_lack: Asymmetry = SYMMETRIC
    flange: Flange | None = None
    compliance: Matrix | None = None

    @property
    def asymmetry(self) -> Asymmetry:
        """What its section lacks of symmetry, with what those that may be chosen for it lack."""
        if self.compliance is not None and _leaves_plane(self.compliance):
            return replace(self.may_lack, askew=True)
        return self.may_lack if self.section is None else self.may_lack.with_that(asymmetry_of(self.section))

    def chosen(self, section: Section, name: str | None, material: Material | None) -> Link:
        """The link with what was chosen for it; what others might have lacked of symmetry is no longer of it."""
        return replace(self, section=section, section_name=name, material=material, may_lack=SYMMETRIC)

    @property
    def elastic(self) -> bool:
        """Whether the link has what it takes to bend."""
        return self.section is not None

    @property
    def given_by(self) -> tuple[str, ...]:
        """The numbers that say where its far end is: its `length` alone, or, where it runs along no axis of its frame
        (a and d of one Denavit-Hartenberg row, an origin of several components), those of x, y and z that are not
        zero."""
        components = zip(("x", "y", "z"), self.direction, strict=True)
        entries = tuple(name for name, share in components if abs(share) > _ASKEW)
        return entries if len(entries) > 1 else ("length",)


def _leaves_plane(compliance: Matrix) -> bool:
    """Whether loads in the x-y plane of a link's frame move its far end out of that."""
    return any(
        abs(compliance[row][column]) > _UNCOUPLED * math.sqrt(compliance[row][row] * compliance[column][column])
        for row in (0, 1, 5)
        for column in (2, 3, 4)
    )


@dataclass(frozen=True)
class LoadCase:
    """What acts at the tip: a payload mass in kg, a force in N and a moment in N*m, both in the base frame.

    `leaves_off` (kg) is the arm's payload where the case replaces it without naming one.
    `relative_to` is the calibrated state that the error counts from; None counts the whole error. Of several arms on
    one torso `tip` names the one at whose tip it acts and whose error counts; empty: the arm's own. `moving` is the
    instant of a motion at which it acts, at that pose and with its accelerations; None: at rest, at any pose.
    `acceleration` (m/s^2, base frame) is that of the base, on a vehicle or a lift.
    """

    mass: float = 0.0
    force: FloatVector = ZERO
    moment: FloatVector = ZERO
    relative_to: Calibrated | None = None
    tip: str = ""
    leaves_off: float = field(default=0.0, compare=False)
    moving: Moving | None = None
    acceleration: FloatVector = ZERO

    @property
    def when_calibrated(self) -> LoadCase | None:
        """What acts at the tip in the calibrated state; None where the whole error counts."""
        if self.relative_to is None:
            return None
        calibrated = replace(self, relative_to=None, acceleration=ZERO)
        return calibrated if self.relative_to.payload is None else replace(self.relative_to.payload, tip=self.tip)


@dataclass(frozen=True)
class Calibrated:
    """The state in which an arm was calibrated, so that only what changes from it counts: its `payload` (None: that of
    the load case) and `temperature` in K (None: that at which the arm works)."""

    payload: LoadCase | None = None
    temperature: float | None = None


@dataclass(frozen=True)
class EffectEntry:
    """One line of an arm file's `effects`: which effect, at which joints or links (from 1), with what parameters
    (SI)."""

    effect: str
    at: tuple[int, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True)
class Statistics:
    """How `play: statistical` counts: the quantile `level` of the error over `draws` seeded draws of all the play."""

    level: float = 0.95
    draws: int = 1000
    seed: int = 20


@dataclass(frozen=True)
class Machining:
    """What work on every link that has a section costs, and when (`date`: `2026-01`): `per_kilogram` (EUR/kg) of the
    finished part, where its material does not say itself; `per_metre` (EUR/m) of it; and `per_part` (EUR)."""

    per_kilogram: float = 0.0
    per_metre: float = 0.0
    per_part: float = 0.0
    date: str = ""


@dataclass(frozen=True)
class Branch:
    """One of the arms on a torso: its joints and links are those from `first` to before `end` (from 0), `tool` (m) and
    `payload` its own. `away` is 0 where the tip asked for is its own, 1 where that is another's: its joints then move
    nothing, and its weight loads the torso. Of readings of several tips it is a column of 0 and 1.
    """

    name: str
    first: int
    end: int
    tool: FloatVector = ZERO
    payload: LoadCase = LoadCase()
    away: Scalar = 0.0


@dataclass(frozen=True)
class Arm:
    """A serial arm with the loads it carries and the physics its model holds.

    Several arms on one torso are one `Arm` too: the torso's joints, then those of each of its `branches`. It is a
    serial arm to one tip, `tip`; `on` another makes it that to another. With `every_tip` the errors of all of them
    count, each a load case of its own (`cases`).

    `temperature` in K is where it works: materials are evaluated there. `play` says how clearance and backlash
    count. `leave_out` names physics that the model does without; `effects` adds some. `machining` is what work on the
    links costs. `gravity_given` says that `gravity` is no default. `avoid` are regions into which no pose that is
    proposed puts any of it.
    """

    name: str
    joints: tuple[Joint, ...]
    links: tuple[Link, ...]
    gravity: FloatVector = STANDARD_GRAVITY
    angles: AngleConvention = "relative"
    temperature: float = REFERENCE_TEMPERATURE
    payload: LoadCase = LoadCase()
    play: PlayMode = "worst"
    statistics: Statistics = Statistics()
    leave_out: frozenset[str] = frozenset()
    effects: tuple[EffectEntry, ...] = ()
    tool: FloatVector = ZERO
    machining: Machining = Machining()
    branches: tuple[Branch, ...] = ()
    every_tip: bool = False
    avoid: tuple[Obstacle, ...] = ()
    gravity_given: bool = field(default=True, compare=False)

    def __post_init__(self) -> None:
        if len(self.joints) != len(self.links) or not self.joints:
            raise ValueError("an arm has at least one joint, and a link for each")

    @property
    def size(self) -> int:
        """The number of joints."""
        return len(self.joints)

    @property
    def lengths(self) -> tuple[float, ...]:
        """The lengths of the links, m."""
        return tuple(link.length for link in self.links)

    def planar(self, load: LoadCase | None = None) -> bool:
        """Whether everything stays in the x-y plane: axes, links, gravity and, with `load`, what acts then too."""
        case = self.payload if load is None else load
        return self._flat and case.force[2] == case.acceleration[2] == 0.0 and case.moment[:2] == (0.0, 0.0)

    def gravity_felt(self, load: LoadCase | None = None) -> FloatVector:
        """Gravity less the acceleration of the base under a load (by default the arm's payload), m/s^2."""
        moved = (self.payload if load is None else load).acceleration
        return (self.gravity[0] - moved[0], self.gravity[1] - moved[1], self.gravity[2] - moved[2])

    @cached_property
    def _flat(self) -> bool:
        """Whether axes, links, gravity and tool stay in the x-y plane, and no load leaves it (asked at every pose)."""
        return self.flat and not any(link.asymmetry.askew or link.asymmetry.off_width for link in self.links)

    @cached_property
    def flat(self) -> bool:
        """Whether axes, links, gravity and tool stay in the x-y plane, wherever sections may bend or twist to."""
        for joint in self.joints:
            if joint.revolute != (joint.axis[:2] == (0.0, 0.0)) or (not joint.revolute and joint.axis[2] != 0.0):
                return False
            if joint.origin_translation[2] != 0.0 or not _about_z(joint.origin_rotation):
                return False
        for link in self.links:
            if link.direction[2] != 0.0 or not _about_z(link.end_rotation):
                return False
            if link.height_direction is not None and link.height_direction[2] != 0.0:
                return False
        return self.gravity[2] == 0.0 and self.tool[2] == 0.0

    @property
    def unknown_origins(self) -> tuple[int, ...]:
        """The joints (from 0) in front of which stands a fixed transform that nobody knows, or not all of it."""
        return tuple(index for index, joint in enumerate(self.joints) if joint.origin_free)

    @property
    def carried_mass(self) -> float:
        """The masses beside links and payload, kg: joints, motors wherever they stand, what hangs on links, and the
        payloads of other branches than the tip's."""
        hung = sum(mass.mass for link in self.links for mass in link.masses)
        hung += sum(branch.payload.mass for branch in self.branches if branch.name != self.tip)
        guides = sum(joint.guide.mass for joint in self.joints if joint.guide is not None)
        return hung + guides + sum(joint.mass + joint.motor_on_base for joint in self.joints)

    @property
    def tip(self) -> str:
        """The branch whose tip counts; empty for an arm without branches."""
        return next(
            (branch.name for branch in self.branches if isinstance(branch.away, float) and branch.away == 0.0), ""
        )

    def on(self, tip: str) -> Arm:
        """The same as an arm to the tip of a branch, with that branch's payload and tool; as it is where it is that
        already, or has no branches."""
        branch = next((item for item in self.branches if item.name == tip), None)
        if branch is None or (self.tip == tip and not self.every_tip):
            return self
        seen = tuple(replace(item, away=0.0 if item is branch else 1.0) for item in self.branches)
        return replace(self, branches=seen, tool=branch.tool, payload=branch.payload, every_tip=False)

    @property
    def cases(self) -> tuple[LoadCase, ...]:
        """The load cases that count where nobody names others: the arm's payload; with `every_tip` each branch's."""
        if not self.every_tip:
            return (self.payload,)
        return tuple(replace(branch.payload, tip=branch.name) for branch in self.branches)

    def payloads(self, load: LoadCase) -> tuple[float, ...]:
        """What hangs at the tips (kg) under a load case, branch by branch; of an arm without any the load's mass."""
        tip = load.tip or self.tip
        return tuple(load.mass if branch.name == tip else branch.payload.mass for branch in self.branches) or (
            load.mass,
        )

    def away(self, index: int) -> Scalar:
        """Whether a joint (from 0) is of another branch than the tip: 0, 1 or a column of both."""
        return next((branch.away for branch in self.branches if branch.first <= index < branch.end), 0.0)

    def column(self, base: str, index: int) -> str:
        """What a column of a joint (from 0) is called in a recording: `q2`, of a branch `left_q1`."""
        branch = next((item for item in self.branches if item.first <= index < item.end), None)
        return f"{base}{index + 1}" if branch is None else f"{branch.name}_{base}{index - branch.first + 1}"

    def entry(self, index: int) -> str:
        """Where a joint (from 0) and its link stand in an arm file: `chain[2]`, of a branch `branches[1].chain[2]`."""
        for number, branch in enumerate(self.branches, start=1):
            if branch.first <= index < branch.end:
                return f"branches[{number}].chain[{index - branch.first + 1}]"
        return f"chain[{index + 1}]"

    @property
    def to_tip(self) -> tuple[int, ...]:
        """The joints (from 0) on the way from the base to the tip."""
        if not self.branches:
            return tuple(range(self.size))
        return tuple(index for index in range(self.size) if not self.away_wholly(index))

    def away_wholly(self, index: int) -> bool:
        """Whether a joint (from 0) moves nothing of what counts at any reading."""
        away = self.away(index)
        return isinstance(away, float) and away == 1.0

    def whole_pose(self, q: Sequence[float]) -> tuple[float, ...]:
        """A pose with the coordinates of joints that only follow others as they are."""
        return tuple(float(coordinate) for coordinate in coordinates(self, q))

    def with_links(self, links: tuple[Link, ...]) -> Arm:
        """The same arm with other links."""
        return replace(self, links=links)


def _about_z(rotation: Any) -> bool:
    return rotation[2] == (0.0, 0.0, 1.0)
