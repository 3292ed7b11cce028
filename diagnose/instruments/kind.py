"""What a kind of instrument is: its numbers, its settings, what it reads of an arm, and how its unknowns are fitted.

A new kind is one file in `instruments/kinds` with a subclass of `InstrumentKind` and, where it models its numbers by
itself, one of `Part`; `steps.instrument_contract` holds both to what they say. Residuals are exact; what displacements,
turns and unknowns show is to first order about where the arm stands.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array
from linkwright.core.units.reading import Mapping as Reader

from .instrument import Instrument, Slots

if TYPE_CHECKING:
    from linkwright.core.diagnose.rules.residual_rules import ResidualRules

    from .level import Stand
    from .look import Look

Marked = NDArray[np.bool_]


@dataclass(frozen=True)
class Number:
    """One number of a reading: its name in messages, the `column` of a recording that holds it (without its unit, empty
    where none does), what it is, and whether an arm that stays in its plane gives one."""

    name: str
    column: str = ""
    quantity: Literal["length", "angle"] = "length"
    in_plane: bool = True


@dataclass(frozen=True)
class Scene:
    """Readings (N) of W numbers each against a modelled arm. `slots` and `read` (N, W) are what each number is and what
    was read (m; of angles the sine), `tips` (N, 3), m, and `directions` (N, 3, 3), the last link's axes in columns, are
    modelled, in the base frame; `stand` is what a level stands on. `touches` (N,) numbers the label touched, -1 none,
    `bar_at` (N,), m, is where along a bar. `frame_free`: the frame in which places are measured stands anywhere, which
    `framed` (N, W) marks. An arm that stays in its plane is `flat`."""

    instrument: Instrument
    slots: Slots
    read: Array
    tips: Array
    directions: Array
    stand: Stand | None
    touches: NDArray[np.int64]
    bar_at: Array | None
    frame_free: bool
    framed: Marked
    flat: bool
    rules: ResidualRules

    @property
    def width(self) -> int:
        """How many components places have."""
        return 2 if self.flat else 3


@dataclass(frozen=True)
class Frame:
    """Where the measuring frame stands: measured to base, (3, 3) and (3,), m."""

    rotation: Array
    translation: Array


@dataclass(frozen=True)
class Modelled:
    """The numbers of one kind (N, k), and what displacements of the tip and turns of what the instrument stands on
    show of them, each about the base's axes (N, k, 3)."""

    values: Array
    shown: Array
    turning: Array

    @classmethod
    def of_place(cls, values: Array, shown: Array) -> Modelled:
        """Numbers that no turn changes."""
        return cls(values, shown, np.zeros(shown.shape))


@dataclass(frozen=True)
class Seen:
    """Readings against a place: `residual` (N, W), `shown` and `turning` (N, W, 3), where the tip is `at` (N, 3)."""

    residual: Array
    shown: Array
    turning: Array
    at: Array

    def rms(self) -> float:
        """The root mean square of the residual."""
        return float(np.sqrt(np.mean(self.residual**2)))


class Change(ABC):
    """What displacements and turns show exactly, of the numbers (N, W) that are marked."""

    mask: Marked

    @abstractmethod
    def exact(self, moved: Array, turned: Array) -> Array:
        """Of displacements (N, 3), m, and turns (N, 3), rad, (N, W)."""


class Part(ABC):
    """One kind's numbers in one fit. What is unknown of it is its state: `own` numbers that the fit steps together with
    frame and tool (`own_columns`, `stepped`), or what follows from where the tips are (`refit`)."""

    own_names: tuple[str, ...] = ()

    def __init__(self, kind: InstrumentKind, first: int, scene: Scene) -> None:
        """`first` is the slot of the kind's first number."""
        self.kind, self.first, self.scene = kind, first, scene
        self.mask: Marked = (scene.slots >= first) & (scene.slots < first + len(kind.numbers))
        self.rows: Marked = np.asarray(self.mask.any(axis=1), dtype=np.bool_)

    def start(self) -> Any:
        """The state to begin with, by the modelled tips."""
        return None

    def rotations(self) -> Iterator[Array]:
        """How the measuring frame may be turned, by these numbers."""
        return iter(())

    def refit(self, state: Any, at: Array) -> Any:
        """The state that fits tips `at` (N, 3) best, where it follows from them alone."""
        return state

    @abstractmethod
    def model(self, state: Any, at: Array, frame: Frame) -> Modelled:
        """The numbers of tips `at` (N, 3)."""

    def in_frame(self) -> Marked:
        """Which numbers move with the measuring frame (N, W)."""
        return self.mask if self.kind.framed else np.zeros(self.mask.shape, dtype=np.bool_)

    def own_columns(self, state: Any, seen: Seen) -> Array:
        """How the residual falls with each of the unknowns that are stepped, (N, W, own)."""
        return np.zeros((*seen.residual.shape, 0))

    def stepped(self, state: Any, step: Array) -> Any:
        """The state after a step (own,)."""
        return state

    def beside(self, state: Any, seen: Seen) -> tuple[list[Array], list[str]]:
        """How readings move with the other unknowns, (N, W, k) each, and the names of these."""
        return [], []

    def also(self, state: Any, seen: Seen) -> tuple[list[Array], list[str]]:
        """The same for unknowns on which neither frame nor tool depends."""
        return [], []

    def settled(self, state: Any, at: Array, settled: Array) -> None:
        """Put tips `settled` (N, 3) where the readings say that they are, if they touch something."""

    def untold(self, shares: Array) -> tuple[str, ...]:
        """Sentences on the unknowns that the readings do not tell, by the share of each in that (own,)."""
        return ()

    def change(self, state: Any, seen: Seen, frame: Frame) -> Change | None:
        """What displacements and turns show exactly; None where that is what they show to first order."""
        return None


@dataclass(frozen=True)
class Stood:
    """Where a simulated arm stands: tips (N, 3), m, in the measuring frame; the last link's axes (N, 3, 3); what a
    level stands on; and the joint coordinates."""

    tips: Array
    axes: Array | None
    stand: Stand | None
    arm: Arm


class InstrumentKind(ABC):
    """A kind of instrument.

    Attributes:
        name: in `observes:` and in commands.
        title: what it reads, in a few words.
        blind: what it cannot see, in a sentence.
        numbers: what a reading holds.
        settings: what recording.yaml and callers say of it, by name.
        label: the column that names what is touched; empty where nothing is.
        framed: its numbers are measured in a frame that may stand anywhere.
        alone: a recording holds nothing beside it.
        turns_with: what it stands on, where turns of that change its numbers.
        of_place: its numbers go with the place of the tip.
        elsewhere: what it would read at other poses is known.
        example: a caller's words with which it is simulated, in the plane too where it can be.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    blind: ClassVar[str] = ""
    numbers: ClassVar[tuple[Number, ...]]
    settings: ClassVar[tuple[str, ...]] = ()
    label: ClassVar[str] = ""
    framed: ClassVar[bool] = False
    alone: ClassVar[bool] = False
    turns_with: ClassVar[Literal["", "tool", "link"]] = ""
    of_place: ClassVar[bool] = True
    elsewhere: ClassVar[bool] = False
    example: ClassVar[Mapping[str, Any]] = MappingProxyType({})

    def count(self, *, flat: bool) -> int:
        """How many of its numbers an arm gives; those out of a flat one's plane are the last."""
        return sum(number.in_plane or not flat for number in self.numbers)

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns of a recording that hold its numbers."""
        return tuple(number.column for number in self.numbers if number.column)

    # ---- settings

    def read(self, mapping: Reader) -> Mapping[str, Any]:
        """Fields of `Instrument` by recording.yaml. Raises `InputError`."""
        return {}

    def asked(self, words: Mapping[str, Any], arm: Arm) -> Mapping[str, Any]:
        """Fields of a simulation's plan by a caller's words: `instrument` and what goes with it. Raises
        `InputError`."""
        return {"instrument": Instrument((self.name,))}

    def words(self, instrument: Instrument) -> Mapping[str, Any]:
        """A caller's words for an instrument as recorded."""
        return {}

    def lines(self, instrument: Instrument) -> tuple[str, ...]:
        """The lines of recording.yaml."""
        return ()

    def said(self, instrument: Instrument, *, anchor_free: bool) -> str:
        """What is read, in a sentence of a plan; empty where the numbers say it."""
        return ""

    def recorded(self, instrument: Instrument, *, anchor_free: bool) -> Instrument:
        """The instrument as a simulated recording tells of it."""
        return instrument

    # ---- columns

    def of_file(self, values: Array) -> Array:
        """Numbers (N,) in SI as a file has them, as readings."""
        return values

    def to_file(self, values: Array) -> Array:
        """The other way round."""
        return values

    def impossible(self, values: Array) -> tuple[Marked, str, str]:
        """Which numbers of a file cannot be, and why: of one, and in a sentence where most are so."""
        return np.zeros(len(values), dtype=np.bool_), "", ""

    # ---- fit and simulation

    @abstractmethod
    def part(self, first: int, scene: Scene) -> Part | None:
        """Its numbers in a fit with others; None where it is set against the model by a separate fit."""

    def simulated(self, stood: Stood, instrument: Instrument, random: np.random.Generator) -> Array:
        """What it reads of an arm without noise (N, k), what nobody knows of it drawn; nan where it reads nothing,
        as one that touches what it was led to."""
        return np.full((len(stood.tips), len(self.numbers)), np.nan)

    def refuse(self, look: Look) -> None:
        """Raise `InputError` where its numbers contradict the joints as a whole."""
