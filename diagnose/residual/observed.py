"""A recording set against the model: residuals in every channel, whitened, and the rows that belong together.

Each reading is one row; its columns are the tip's components and whatever further instruments there are (an encoder on
the joint's side, a target on the base, commands beside encoders), each divided by its scatter, so that plain least
squares weighs them rightly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry, FloatVector
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.effects.angles.encoder_offset import ENCODER_OFFSET
from linkwright.core.arm.effects.geometry.instrument_scale import INSTRUMENT_SCALE
from linkwright.core.arm.effects.geometry.link_length import LINK_LENGTH
from linkwright.core.arm.effects.loads.added_weights import weights_added
from linkwright.core.arm.errors.recorded import Asked, Channels, seen
from linkwright.core.diagnose.instruments.camera import Sight
from linkwright.core.diagnose.instruments.registry import turns_with
from linkwright.core.diagnose.instruments.view import View
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.rules import RULES, Rules

from .alignment import Alignment
from .orientation import has_orientation
from .wander import clock, growth, without_wander

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Observed:
    """N readings against the model. `residual` (N, C) holds measured less modelled, m and rad, the tip's D components
    first; `scale` (C,) what each column is divided by; `block` (N,) numbers visits: consecutive readings at one pose.

    `correlation` is that of each reading's noise with the one before, taken out by `whitened`, and so is `wander`: how
    fast the variance of a random walk below the tip's noise grows, per unit of `clock`, of `scale` squared. `about` is
    what was found so large that first order is taken about it: the residual is less by what that moves beyond first
    order.
    `nominal` is the arm undeformed, `state` as its model and `about` deform it: patterns are those about that shape.
    `rules` are those of the whole diagnosis.

    Of several recordings (`Several`) frame and tool are each one's own, and so is how loud its instrument is: `loud`
    (R,) is what `scale` is multiplied by for each recording's readings (None: nothing); where each number is a separate
    reading, for each kind of number as well.

    `view` says what a displacement of the tip shows where something else than its place was measured; the tip's columns
    are those readings then.
    """

    arm: Arm
    unknown_masses: tuple[int, ...]
    recording: Recording
    nominal: PoseState
    state: PoseState
    asked: Asked
    alignment: Alignment
    residual: Array
    scale: Array
    block: NDArray[np.int64]
    correlation: float = 0.0
    about: tuple[EffectEntry, ...] = ()
    rules: Rules = RULES
    loud: Array | None = None
    wander: float = 0.0
    view: View | None = None

    @property
    def loud_with(self) -> NDArray[np.int64]:
        """Which readings (N,), numbered from 0, are as loud as each other."""
        slots = self.recording.slots
        if slots is None or slots.shape[1] > 1 or (slots == slots[0]).all():
            return self.which
        kinds = np.column_stack([self.which, slots])
        return np.unique(kinds, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)

    @property
    def space(self) -> int:
        """How many components a displacement of the tip has, 2 or 3."""
        return self.components if self.view is None else self.view.shown.shape[2]

    def of_tip(self, moved: Array, turned: Array | None = None) -> Array:
        """What the instrument of the tip sees of displacements (N, 3), m, of the tip: (N, W), all of it as a rule; a
        level sees the turns (N, 3), rad, of what it stands on."""
        return moved[:, : self.components] if self.view is None else self.view.of_tip(moved, turned)

    @property
    def which(self) -> NDArray[np.int64]:
        """The recording (N,), from 0, that each reading is from."""
        return self.recording.which

    @property
    def components(self) -> int:
        """How many components of the tip were measured: 2 or 3, or how many numbers an instrument read."""
        return self.recording.tip.shape[1]

    @property
    def rows(self) -> int:
        """The number of readings."""
        return len(self.residual)

    def tip_residual(self) -> Array:
        """The tip's residual (N, D), m."""
        return self.residual[:, : self.components]

    def stacked(self, channels: Channels) -> Array:
        """Channels as (N, C), in the order of `residual`."""
        parts = [self.of_tip(channels.tip, channels.turn if self.reads_turns else channels.level)]
        parts += [part for part in (channels.joint_side, channels.base, channels.command) if part is not None]
        if self.has_turns and channels.turn is not None:
            parts.append(self.turns(channels.turn))
        return np.concatenate(parts, axis=1)

    @cached_property
    def reads_turns(self) -> bool:
        """Whether the instrument's numbers change with how the tool is turned."""
        return turns_with(self.recording.slots) == "tool"

    @property
    def sight(self) -> Sight | None:
        """What a camera sees; None where none was used."""
        return None if self.view is None else self.view.sight

    @property
    def has_turns(self) -> bool:
        """Whether readings say how the tool is turned."""
        return self.asked.turn and bool(has_orientation(self.recording).any())

    @property
    def turn_columns(self) -> slice:
        """Where in a row the turns of the tool stand; nowhere if there are none."""
        count = self.residual.shape[1]
        return slice(count - (turns_measured(self.space) if self.has_turns else 0), count)

    def turns(self, turn: Array) -> Array:
        """Turns about the base's axes (N, 3) as they were measured, (N, 1 or 3), by a camera about its own: zero
        where a row has none."""
        if self.sight is not None:
            turn = np.einsum("nab,na->nb", self.sight.axes, turn)
        shown = turn[:, -turns_measured(self.space) :]
        return shown * has_orientation(self.recording)[:, None]

    def signature(self, effect: str, settings: Settings) -> Array:
        """What an effect moves in every column (N, C), m and rad."""
        pattern = self.stacked(seen(self.state, EFFECTS[effect], settings, self.asked))
        if self.sight is not None and effect == INSTRUMENT_SCALE.id:
            # A target that is not printed to scale: all that is read is too large in proportion.
            pattern[:] = 0.0
            read = self.recording.tip - self.sight.residual
            pattern[:, : self.components] = settings.values.get("scale", 0.0) * read
        elif self.view is not None and effect == INSTRUMENT_SCALE.id:
            # Positions are too far out in proportion; a distance has no origin, and a touch no number.
            pattern[:, : self.components][~self.view.framed] = 0.0
        stretch = settings.values.get("stretch", 0.0) if effect == LINK_LENGTH.id else 0.0
        if self.view is not None and stretch != 0.0:
            # In proportion, touches are what they are told by: an arm of no length would touch anything.
            pattern[:, : self.components] -= stretch * self.view.of_tip(self.view.at - self.view.settled)
        return pattern

    def drive_moved(self, joint: int) -> Array:
        """What one unit of motion (rad, m) of a joint (from 0) moves in every column (N, C), m and rad."""
        unit = Settings((joint,), MappingProxyType({"offset": 1.0}))
        return self.stacked(seen(self.state, ENCODER_OFFSET, unit, self.asked))

    def whitened(self, columns: Array) -> Array:
        """Columns (N, C) or (N, C, d) as (N * C) or (N * C, d) of unit scatter, without the correlation of neighbouring
        rows (the transformation of S. J. Prais & C. B. Winsten, 1954)."""
        scaled = self.without_memory(self.scaled(columns))
        if self.wander > 0.0:
            tip, others = scaled[:, : self.components], scaled[:, self.components :]
            scaled = np.concatenate([without_wander(tip, self.wanders), others], axis=1)
        return scaled.reshape(scaled.shape[0] * scaled.shape[1], *columns.shape[2:])

    def scaled(self, columns: Array) -> Array:
        """Columns (N, C) or (N, C, d) over their scatter."""
        return self.evened(columns) / (self.scale if columns.ndim == 2 else self.scale[:, None])

    def evened(self, columns: Array) -> Array:
        """Columns (N, ...) over how loud each reading's recording is."""
        return columns if self.loud is None else columns / self.loudness.reshape(-1, *(1,) * (columns.ndim - 1))

    @property
    def loudness(self) -> Array:
        """How loud each reading's instrument is (N,), one where all are alike."""
        return np.ones(self.rows) if self.loud is None else self.loud[self.loud_with]

    def without_memory(self, columns: Array, correlation: float | None = None) -> Array:
        """Columns (N, ...) less what each reading shares with the one before in its recording."""
        rho, begins = self.correlation if correlation is None else correlation, np.flatnonzero(np.diff(self.which)) + 1
        if rho == 0.0 or not len(begins):
            return without_memory(columns, rho)
        return np.concatenate([without_memory(part, rho) for part in np.split(columns, begins)])

    @property
    def wanders(self) -> Array:
        """By how much the variance of what wanders grows from each reading to the next (N - 1,), of `scale` squared;
        infinite where another recording begins."""
        return growth(clock(self.recording), self.wander, self.which)

    def still(self, left: Array) -> Array:
        """What is left of the tip (N, D), m, without what wanders: each reading less what those before foretell."""
        if self.wander <= 0.0:
            return left
        scale = self.scale[: self.components] * self.loudness[:, None]
        return without_wander(left / scale, self.wanders) * scale

    @property
    def softening(self) -> tuple[EffectEntry, ...]:
        """The flexibility beyond the arm file's, through which loads act in `signature` (see `softened`)."""
        return softening_of(self.state, self.arm)

    def softened(self, entries: Sequence[EffectEntry]) -> Observed:
        """The same with loads acting through these entries of flexibility too; the residual stays against the file."""
        return replace(self, state=with_effects(self.state, self.arm, entries, self.about))

    @cached_property
    def arm_given(self) -> Arm:
        """The arm as the file says: masses unknown again, and the tool without what was found."""
        links = tuple(
            replace(link, mass=None) if index in self.unknown_masses else link
            for index, link in enumerate(self.arm.links)
        )
        if self.sight is not None:
            return self.arm.with_links(links)
        return replace(self.arm, tool=tool_moved(self.arm.tool, -self.alignment.tool)).with_links(links)


def without_memory(columns: Array, correlation: float) -> Array:
    """Columns (N, ...) less what each reading shares with the one before (Prais & Winsten, see `Observed.whitened`)."""
    if correlation == 0.0:
        return columns
    left = np.empty_like(columns)  # in place: columns of a long recording are megabytes each
    left[0] = columns[0]
    np.multiply(columns[:-1], -correlation, out=left[1:])
    left[1:] += columns[1:]
    left[1:] /= np.sqrt(1.0 - correlation * correlation)
    return left


def kept(recording: Recording, keep: NDArray[np.bool_] | NDArray[np.int64]) -> Recording:
    """The recording with only the rows of `keep`."""
    changed: dict[str, object] = {}
    for name, value in vars(recording).items():
        if isinstance(value, np.ndarray) and len(value) == recording.size:
            changed[name] = value[keep]
    changed["other"] = {name: values[keep] for name, values in recording.other.items()}
    return replace(recording, **changed)  # pyright: ignore[reportArgumentType]


def with_effects(
    state: PoseState, arm: Arm, softening: Sequence[EffectEntry], about: Sequence[EffectEntry]
) -> PoseState:
    """The state of an arm through whose `softening` loads act too; the weights `about` hang from where plumb is."""
    effects = (*arm.effects, *softening, *weights_added(about))
    return replace(state, arm=replace(state.arm, effects=effects))


def softening_of(state: PoseState, arm: Arm) -> tuple[EffectEntry, ...]:
    """The flexibility of a state beyond that of the arm."""
    beyond = state.arm.effects[len(arm.effects) :]
    return tuple(entry for entry in beyond if entry not in weights_added(beyond))


def tool_moved(tool: FloatVector, by: Array) -> FloatVector:
    """A tool moved by (D,), m, of the plane or of space."""
    x, y, z = [*by.tolist(), 0.0][:3]
    return (tool[0] + x, tool[1] + y, tool[2] + z)


def turns_measured(components: int) -> int:
    """About how many axes the tool can be turned: one in the plane."""
    return 1 if components == 2 else 3


def rms_length(vectors: Array) -> float:
    """The root mean square length of vectors (N, D)."""
    return float(np.sqrt(np.mean(np.sum(vectors * vectors, axis=1)))) if len(vectors) else 0.0
