"""What an effect is: a name, its parameters, what a recording must hold to show it, the twists it puts in, and what it
takes of the drives of a moving arm.

An effect displaces and turns the chain a little at some of its nodes; the chain carries that to the tip:
dp_tip = dp_i + dphi_i x (p_tip - p_i). Simulation, optimiser and diagnosis all use the same object.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Literal

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Zones
from linkwright.core.arm.chain.kinematics import carried_unturned
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector, scale
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array

from .traits import DriveTraits, LinkTraits, PlayTraits, RecordingTraits, WatchTraits, nothing

NodeKind = Literal["base", "joint", "link", "tip"]
"""The base's origin, a joint's axis, the far end of a link, or the tip."""

Condition = Literal["time", "warming", "sides", "velocities", "accelerations", "loaded_for", "last_moves", "commanded"]
"""What an effect may ask of the conditions of a reading; the fields of `arm.chain.conditions.Conditions`."""

Only = Literal["joints that turn", "joints that slide", "joints after the first"]
"""Which joints an effect can move, where not all."""

Role = Literal["size", "shape", "given", "torque", "torque_shape"]
"""How a parameter enters: the displacement grows from nothing with a `size`; a `shape` (a lag, a threshold, an order)
changes its pattern and is searched on a grid; what is `given` comes with the arm and is not fitted. With a `torque` the
torque that a motion takes grows from nothing, and no tip moves; a `torque_shape` changes its pattern alone."""


Cause = Literal[
    "geometry",
    "flexibility",
    "loads",
    "play and friction",
    "angle errors",
    "warming",
    "measurement",
    "friction in motion",
    "drives in motion",
]
"""What kind of thing is at work; effects of one cause are summed up together where there are many."""


NO_LOAD = 1e-9
"""A load (N or N*m) that seats no play: rounding of one that is not there."""


@dataclass(frozen=True)
class Twist:
    """A small displacement (m) and rotation (rad), in the base frame, at joint or far end of link `index` (from 0).

    >>> import linkwright as lw
    >>> lw.Twist("link", 0, rotation=(0.0, 0.0, 1e-3)).rotation
    (0.0, 0.0, 0.001)
    """

    node: NodeKind
    index: int
    translation: Vector = ZERO
    rotation: Vector = ZERO


@dataclass(frozen=True)
class Interval:
    """Play along one motion: anything from -1 to 1 times `twists`. `seating` is the load that pushes it one way."""

    twists: tuple[Twist, ...]
    seating: Scalar


@dataclass(frozen=True)
class Kink:
    """A displacement that is piecewise linear in a load: how far a drive of these `zones` winds up under `load`, times
    `twists`. It is among the effect's twists already; this tells where it bends."""

    twists: tuple[Twist, ...]
    load: Scalar
    zones: Zones


@dataclass(frozen=True)
class Disc:
    """Play within a disc of `radius` (m) normal to `normal` (unit), at joint `index`. `seating` is the load carried
    (N)."""

    index: int
    radius: float
    normal: Vector
    seating: Vector


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: its kind of quantity (see materials.quantities), bounds and typical size in SI, source.

    `role` says how a fit treats it (see `Role`), `grid` the values at which a search tries a shape; where the pattern
    depends on how large the loads are, `relative_to_load` makes them shares of the drive's greatest load; a `threshold`
    changes the pattern only where it passes a load. What moves a joint `across` its motion is of the same kind on
    slides. What is `of_all` is tried only where the effect acts everywhere together, and then instead of the other
    sizes. An `optional` size is tried as zero too. A `whole` shape is a whole number and stays on its grid; `default`
    is what a shape is where an entry does not name it. Other than zero a size or shape `requires` these conditions of
    a recording, beside those of its effect. A size that leaves the plane of a planar arm is `out_of_plane`.
    People read its `label`, where the name says too little.

    >>> import linkwright as lw
    >>> lw.Parameter("amplitude", "angle", "amplitude", -1e-2, 1e-2, (1e-5, 1e-3), "encoder makers", role="size").role
    'size'
    """

    name: str
    kind: str
    meaning: str
    lower: float
    upper: float
    typical: tuple[float, float]
    source: str
    role: Role = "given"
    grid: tuple[float, ...] = ()
    relative_to_load: bool = False
    threshold: bool = False
    across: bool = False
    of_all: bool = False
    optional: bool = False
    whole: bool = False
    default: float = 0.0
    requires: tuple[Condition, ...] = ()
    out_of_plane: bool = False
    label: str = ""

    @property
    def title(self) -> str:
        """How tables and sentences call it."""
        return self.label or self.name.replace("_", " ")

    def means(self, meaning: str, source: str) -> Parameter:
        """The parameter with what it means, and where its usual values are from, in words."""
        return replace(self, meaning=meaning, source=source)


def size(name: str, kind: str, lower: float, upper: float, typical: tuple[float, float], **how: Any) -> Parameter:
    """A parameter with which the displacement grows from nothing; `means` is to follow."""
    return Parameter(name, kind, "", lower, upper, typical, "", role="size", **how)


def shape(name: str, kind: str, lower: float, upper: float, typical: tuple[float, float], **how: Any) -> Parameter:
    """A parameter that changes the pattern; `means` is to follow."""
    return Parameter(name, kind, "", lower, upper, typical, "", role="shape", **how)


def torque(name: str, kind: str, lower: float, upper: float, typical: tuple[float, float], **how: Any) -> Parameter:
    """A parameter with which the torque of a motion grows from nothing, and no tip moves; `means` is to follow."""
    return Parameter(name, kind, "", lower, upper, typical, "", role="torque", **how)


def torque_shape(
    name: str, kind: str, lower: float, upper: float, typical: tuple[float, float], **how: Any
) -> Parameter:
    """A parameter that changes the pattern of a motion's torque, and moves no tip; `means` is to follow."""
    return Parameter(name, kind, "", lower, upper, typical, "", role="torque_shape", **how)


def given(name: str, kind: str, lower: float, upper: float, typical: tuple[float, float], **how: Any) -> Parameter:
    """A parameter that comes with the arm and is not fitted; `means` is to follow."""
    return Parameter(name, kind, "", lower, upper, typical, "", **how)


@dataclass(frozen=True)
class Settings:
    """Where an effect acts (joints or links from 0; empty: everywhere) and the values of its parameters (SI).

    >>> import linkwright as lw
    >>> lw.Settings(at=(1,), values={"offset": 1e-3}).acts_at(0)
    False
    """

    at: tuple[int, ...] = ()
    values: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    @classmethod
    def of(cls, entry: EffectEntry) -> Settings:
        """Those of an entry of an arm's `effects`."""
        return cls(tuple(number - 1 for number in entry.at), MappingProxyType(dict(entry.parameters)))

    def acts_at(self, index: int) -> bool:
        """Whether the effect acts at joint or link `index` (from 0)."""
        return not self.at or index in self.at


_ON_SLIDES: Mapping[str, str] = MappingProxyType(
    {
        "angle": "length",
        "angular_speed": "speed",
        "angle_per_temperature": "length_per_temperature",
        "compliance": "linear_compliance",
        "inertia": "mass",
        "quadratic_friction": "linear_quadratic_friction",
        "torque": "force",
        "torque_per_temperature": "force_per_temperature",
        "torsional_stiffness": "linear_stiffness",
        "viscous_friction": "linear_viscous_friction",
    }
)
"""The kinds of quantity of turning joints and what takes their place along a slide."""


def kind_at(parameter: Parameter, *, slides: bool) -> str:
    """A parameter's kind of quantity where the effect acts on slides: a length for an angle, N/m for N*m/rad."""
    return _ON_SLIDES.get(parameter.kind, parameter.kind) if slides and not parameter.across else parameter.kind


def among(only: Only | None, index: int, *, revolute: bool) -> bool:
    """Whether joint `index` (from 0) is one of those that `only` names; without it all are."""
    if only == "joints after the first":
        return index > 0
    return only is None or revolute == (only == "joints that turn")


LAST_RANK = 1000
"""The rank of an effect that says nothing of how common it is."""


@dataclass(frozen=True)
class Effect:
    """One kind of physics that moves the tip, or loads the drives of a moving arm.

    `automatic`: in the model wherever the arm file has its data, unless `leave_out` names it; otherwise only where
    `effects` names it. `needs` says what a recording must hold to show it, `aliases` what it cannot be distinguished
    from. `twists` gives what it does at a pose. `torques` gives what a motion takes of the drives beyond the rigid
    arm's torque: by joint (from 0) an array (N,), N*m (N for slides), positive where the drive must push towards
    increasing q; joints that it leaves alone are absent. They are linear in the sizes (`torque_sizes`) at fixed shapes,
    or have a `slope` by their one size (`arm.effects.torques.Bent`).
    `together` marks physics that all links or joints usually share (one material, one air): a diagnosis then also
    tries one parameter for all of them. `requires` names the conditions without which it moves nothing, `enough` the
    sets of parameters of which an entry must hold one to say anything (none named: any one parameter that is a size),
    `only` the joints outside which it moves nothing.
    `rank` says which name goes first where data cannot tell effects apart: the lower, the commoner cause, the simpler.
    (Stiffness of drives and geometry lead in the surveys of robot calibration, e.g. B. W. Mooring, Z. S. Roth & M. R.
    Driels, Fundamentals of Manipulator Calibration, Wiley 1991, ch. 1.)
    `linear` promises displacements in proportion to the sizes, which fits may then rely on.

    `synonyms` is what people call it as well, for who is told its name.

    What only some effects have stands by subject: `play` what is left free, `drive` what is of a drive, `link` what is
    of links and of what gives, `recording` what a diagnosis goes by, `watch` how long it lasts (see `traits`).

    >>> import linkwright as lw
    >>> bending = lw.effects["link_bending"]
    >>> isinstance(bending, lw.Effect), bending.place, bending.automatic
    (True, 'link', True)
    """

    id: str
    title: str
    formula: str
    place: Literal["joint", "link", "base", "tip"]
    cause: Cause
    needs: str
    aliases: tuple[str, ...]
    source: str
    automatic: bool = False
    parameters: tuple[Parameter, ...] = ()
    twists: Callable[[PoseState, Settings], Iterable[Twist]] = nothing
    together: bool = False
    requires: tuple[Condition, ...] = ()
    enough: tuple[tuple[str, ...], ...] = ()
    only: Only | None = None
    rank: int = LAST_RANK
    linear: bool = False
    play: PlayTraits = field(default_factory=PlayTraits)
    drive: DriveTraits = field(default_factory=DriveTraits)
    link: LinkTraits = field(default_factory=LinkTraits)
    recording: RecordingTraits = field(default_factory=RecordingTraits)
    watch: WatchTraits = field(default_factory=WatchTraits)
    torques: Callable[[Motion, Settings], Mapping[int, Array]] | None = None
    synonyms: tuple[str, ...] = ()

    @property
    def belongs_to_link(self) -> bool:
        """Whether it goes with a link as it was built."""
        return self.place == "link" if self.link.built_in is None else self.link.built_in

    def can_act(self, index: int, *, revolute: bool, passive: bool = False) -> bool:
        """Whether the effect can move anything at joint `index` (from 0), or at the link it carries; no drive does at a
        passive joint."""
        if passive and self.drive.needed:
            return False
        return among(self.only, index, revolute=revolute)

    @property
    def sizes(self) -> tuple[Parameter, ...]:
        """The parameters with which the displacement grows from nothing."""
        return tuple(parameter for parameter in self.parameters if parameter.role == "size")

    def sizes_here(self, arm: Arm, at: Sequence[int]) -> tuple[Parameter, ...]:
        """The sizes that it has at these joints or links (from 0) of an arm; at several at once those `of_all`, where
        it has such."""
        if len(at) > 1:
            return tuple(parameter for parameter in self.sizes if parameter.of_all) or self.sizes
        here = None if self.recording.sizes_at is None or not at else self.recording.sizes_at(arm, at[0])
        entries = [parameter for parameter in self.sizes if not parameter.of_all]
        return tuple(parameter for parameter in entries if here is None or parameter.name in here)

    @property
    def torque_sizes(self) -> tuple[Parameter, ...]:
        """The parameters with which the torque of a motion may grow from nothing."""
        return tuple(
            parameter
            for parameter in self.parameters
            if self.torques is not None and parameter.role in ("size", "torque")
        )

    @property
    def moves_tip(self) -> bool:
        """Whether it moves a tip at all, and not only loads the drives of a moving arm."""
        return self.torques is None or self.twists is not nothing

    @property
    def shapes(self) -> tuple[Parameter, ...]:
        """The parameters that change the pattern, and are searched on their grids."""
        return tuple(parameter for parameter in self.parameters if parameter.role == "shape")

    @property
    def torque_shapes(self) -> tuple[Parameter, ...]:
        """The parameters that change the pattern of a motion's torque, and are searched on their grids."""
        return tuple(parameter for parameter in self.parameters if parameter.role in ("shape", "torque_shape"))

    def lacking(self, given: Collection[str]) -> str | None:
        """What parameters named `given` lack for the effect to move anything, as words; None where they do."""
        sets = self.enough or tuple(
            (parameter.name,) for parameter in self.parameters if parameter.role in ("size", "torque")
        )
        if self.automatic or not sets or any(set(item) <= set(given) for item in sets):
            return None
        return ", or ".join(" and ".join(item) for item in sets)


def drive_motion(state: PoseState, index: int, amount: Scalar) -> tuple[Twist, ...]:
    """What the arm does when drive `index` moves by `amount` (rad or m).

    In a serial arm with relative angles all that follows turns; where angles are absolute (the drive holds its link
    against the base) only the link itself turns, up to the next axis that turns, and carries the rest along.

    >>> import linkwright as lw
    >>> def twists(state, settings):
    ...     yield from lw.drive_motion(state, 0, settings.values["offset"])
    """
    joint = state.joints[index]
    moved = scale(amount, joint.axis)
    if not joint.revolute:
        return (Twist("joint", index, translation=moved),)
    following = carried_unturned(state.arm.joints, index)
    turned = Twist("joint", index, rotation=moved)
    if state.absolute and following < state.arm.size:
        return (turned, Twist("joint", following, rotation=scale(-1.0, moved)))
    return (turned,)


@dataclass(frozen=True)
class OfDrives:
    """The twists of an effect that moves each drive where it acts.

    `amount` (rad, m) is that of a state, the effect's settings and a joint (from 0); a plain zero moves nothing. With
    `only` some joints, the others stay.
    """

    amount: Callable[[PoseState, Settings, int], Scalar]
    only: Only | None = None

    def __call__(self, state: PoseState, settings: Settings) -> Iterable[Twist]:
        """The twists of all drives."""
        for index, joint in enumerate(state.joints):
            fits = among(self.only, index, revolute=joint.revolute) and settings.acts_at(index)
            amount = self.amount(state, settings, index) if fits else 0.0
            if not (isinstance(amount, float) and amount == 0.0):
                yield from drive_motion(state, index, amount)
