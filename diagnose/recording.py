"""A recording of a real arm: joint coordinates, what held, and where instruments saw the tip; SI throughout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text

from .instruments.instrument import Instrument, Slots
from .instruments.registry import kind_at


@dataclass(frozen=True)
class RejectedRow:
    """A row set aside: its number in the file (`Table.row`) and why, for people; `off` is how far its
    tip lies off what is known of the arm, m, where a model says."""

    row: int
    reason: str
    off: tuple[float, ...] = ()


@dataclass(frozen=True)
class Earlier:
    """What an arm had been through before a recording that goes on from others: `time` (M,) of their readings on its
    clock, s, the earliest first; what they do not hold is None: `payload_mass` (M,) kg, `temperature` (M,) K and
    `link_temperature` (M, n) K, absolute."""

    time: Array
    payload_mass: Array | None = None
    temperature: Array | None = None
    link_temperature: Array | None = None


@dataclass(frozen=True)
class Recording:
    """N readings in the order of the file, less those set aside.

    `q` (N, n) encoder readings in rad (m for slides); `tip` (N, 2 or 3) measured in the base frame, m. What the file
    does not hold is None: `orientation` (N, 3, 3) rotation matrices of the tool; `time` (N,) s from the first reading;
    `sides` (N, n) of +1, -1 (0 where unknown); `payload_mass` (N,) kg; `temperature` (N,) K and `link_temperature`
    (N, n) K, absolute; `velocity` (N, n) rad/s or m/s; `acceleration` (N, n); `last_moves` (N, n) how far each joint
    had gone since the reading before, be that set aside or not; `commanded` (N, n) and `joint_side` (N, n) like q;
    `torque` (N, n) N*m; `force` (N, 3) N and `moment` (N, 3) N*m at the tip in the base frame; `base_target` (N, 3) m.
    `row` (N,) is each reading's number in the file (`Table.row`). `sigma` (m, for each component) is declared, `frame`
    and `tool` say what is a nuisance, and so does `seat` of how the target is turned on the tool (unused: orientations
    are left alone); `other` holds further numeric columns as they are, by name. `warnings` are sentences
    for the report. `settings` is the recording.yaml that was used. `unit` says which arm of a type it is of (a serial
    number), `date` when it was made (`2026-05-16`), `branch` whose tip was measured of several arms on one torso, empty
    where nobody said. `started` is what the file's clock showed at the first reading, s; `earlier` what the arm had
    been through before it, where another recording tells. `avoid` are regions out of which proposed poses keep the arm.
    `names` says what the recordings that it is made of are called, where they are several, and `units` whether these
    are of several arms of one type.

    Where something else than the whole place was measured, `tip` (N, W) holds what the `instrument` read, and `slots`
    (N, W) say what each number is (see `instruments.instrument`); `touches` (N,) which of the instrument's labels was
    touched, -1 none, and `bar_at` (N,) m how far along its bar (zero elsewhere). Where rows
    hold different things, each number is a separate reading (W = 1) of the same `row`. A camera's `orientation` is
    that of the target in its frame; `sigma_axes` (m) and `sigma_angle` (rad) are what was declared of its axes.
    """

    file: str
    q: Array
    tip: Array
    row: NDArray[np.int64]
    orientation: Array | None = None
    time: Array | None = None
    sides: Array | None = None
    payload_mass: Array | None = None
    temperature: Array | None = None
    link_temperature: Array | None = None
    velocity: Array | None = None
    acceleration: Array | None = None
    commanded: Array | None = None
    last_moves: Array | None = None
    joint_side: Array | None = None
    torque: Array | None = None
    force: Array | None = None
    moment: Array | None = None
    base_target: Array | None = None
    sigma: float | None = None
    frame: Literal["known", "free"] = "known"
    tool: Literal["known", "free"] = "known"
    seat: Literal["unused", "free"] = "unused"
    rejected: tuple[RejectedRow, ...] = ()
    warnings: tuple[str, ...] = ()
    other: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    settings: str = ""
    unit: str = ""
    date: str = ""
    slots: Slots | None = None
    touches: Slots | None = None
    bar_at: Array | None = None
    sigma_axes: tuple[float, ...] | None = None
    sigma_angle: float | None = None
    instrument: Instrument = field(default_factory=Instrument)
    branch: str = ""
    started: float | None = None
    earlier: Earlier | None = None
    avoid: tuple[Obstacle, ...] = ()
    names: tuple[str, ...] = ("",)
    units: bool = False

    @property
    def observed_as(self) -> Slots | None:
        """What each reading is of (N, W + 1): slots and label; None where all are of the tip's place."""
        if self.slots is None:
            return None
        touched = np.full(self.size, -1) if self.touches is None else self.touches
        return np.column_stack([self.slots, touched])

    def names_of_readings(self) -> list[tuple[int, ...]]:
        """What no other reading has: the row in the file, and what the numbers are."""
        rows = self.row[:, None] if self.slots is None else np.column_stack([self.row, self.slots])
        return [tuple(row) for row in rows.tolist()]

    @property
    def component_names(self) -> tuple[str, ...]:
        """What the numbers in a row of `tip` are called."""
        if self.slots is None:
            return ("x", "y", "z")[: self.tip.shape[1]]
        if len(self.slots) and (self.slots == self.slots[0]).all():
            return tuple(kind_at(slot)[1].name.replace(" ", "_") for slot in self.slots[0].tolist())
        return ("reading",)

    @property
    def singles(self) -> tuple[Recording, ...]:
        """The recordings that it is made of: one is made of itself."""
        return (self,)

    def parts(self) -> tuple[Recording, ...]:
        """The recordings that it is made of, each with the readings that are left of it here."""
        return (self,)

    @property
    def which(self) -> NDArray[np.int64]:
        """The recording (N,), from 0, of those that it is made of, that each reading is from."""
        return np.zeros(self.size, dtype=np.int64)

    @property
    def tips(self) -> NDArray[np.int64]:
        """A number (N,) for the tip that each reading is of, of several arms on one torso, by its name."""
        numbers = np.unique([item.branch for item in self.singles], return_inverse=True)[1].reshape(-1)
        return numbers[self.which].astype(np.int64)

    def place_of(self, row: int) -> tuple[int, int]:
        """The recording (from 0) and the row in its file of a reading by its number in `row`."""
        return 0, row

    def of_parts(self, parts: Sequence[Recording], arm: Arm, rules: ResidualRules) -> Recording:
        """What is made of other `parts` of an arm as this is of its own."""
        del arm, rules
        return parts[0]

    def rows_of(self, rows: Sequence[int]) -> str:
        """Readings by their numbers in `row`, as words."""
        return rows_text(rows)

    @property
    def size(self) -> int:
        """The number of readings."""
        return len(self.q)

    def kept(self, keep: NDArray[np.bool_]) -> Recording:
        """The readings that `keep` (N) marks; `rejected` and `warnings` stay as they are."""
        if keep.all():
            return self
        chosen = {name: value[keep] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        other = MappingProxyType({name: values[keep] for name, values in self.other.items()})
        return replace(self, **chosen, other=other)

    def without(self, rejected: Sequence[RejectedRow]) -> Recording:
        """The readings less some more, which join `rejected` in the order of the file; a row is rejected once."""
        known = {item.row for item in self.rejected}
        more: dict[int, RejectedRow] = {}
        for each in rejected:
            if each.row not in known:
                more.setdefault(each.row, each)
        if not more:
            return self
        remaining = self.kept(np.array([row not in more for row in self.row.tolist()], dtype=bool))
        return replace(remaining, rejected=tuple(sorted((*self.rejected, *more.values()), key=lambda item: item.row)))


def since_the_reading_before(q: Array) -> Array:
    """How far each joint had gone (N, n) from the row before; zero at the first, and where either is not known."""
    return np.nan_to_num(np.diff(q, axis=0, prepend=q[:1]))
