"""What a diagnosis of motion logs identified, in SI: everything that a report says is drawn from here."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.diagnose.judge.rivals import Rivals
from linkwright.core.diagnose.result import FittedParameter, WrittenArm
from linkwright.core.sections.numeric import Array

from .log import MotionLog

Verdict = Literal["none", "named", "alias_class", "unknown", "insufficient_data"]


@dataclass(frozen=True)
class Alternative:
    """A set of effects that the logs cannot tell from a finding: each by id and joints or links (from 1), and how much
    less likely it is (nats; 0: exactly alike)."""

    effects: tuple[tuple[str, tuple[int, ...]], ...]
    worse: float


@dataclass(frozen=True)
class Apart:
    """RMS of what an arm leaves of the difference of a joint's two encoders, an offset and a delay of theirs apart: the
    arm as given (`nominal`) and as it is written (`written`), and on motion held out that with all findings but this
    one (`without`) and with all (`left`), in a `unit`: rad, or m of slides."""

    nominal: float
    written: float
    without: float
    left: float
    unit: Literal["rad", "m"]

    def words(self, value: float) -> str:
        """One of the figures as people read it."""
        return f"{1e3 * value:.3g} {'mrad' if self.unit == 'rad' else 'mm'}"


@dataclass(frozen=True)
class MotionFinding:
    """Physics that the model lacks in the torques: effect, joints or links (from 1), parameters with intervals.

    `rms_explained` (n,) N*m is the RMS of what it adds at each joint; `evidence` (nats) how much likelier the logs are
    with it than without, choice and sizes paid for; `rms_without_held_out` (n,) N*m what held-out motion leaves where
    it alone is left out and the rest fitted again. `p_value` is by circular shifts or sign flips of whole blocks (nan:
    none holds), by so many `draws` (0: it is a bound, by none). `reading` is the plain sentence. `recording` names the
    logs in which alone it acts (empty: all). `small` says that held-out motion hardly needs it (see `judge.needed`).
    `apart` is there of what two encoders show between motor and link: it adds nothing to torques, which follow from
    where both are.
    """

    effect: str
    at: tuple[int, ...]
    parameters: tuple[FittedParameter, ...]
    alternatives: tuple[Alternative, ...]
    rms_explained: tuple[float, ...]
    rms_without_held_out: tuple[float, ...]
    evidence: float
    p_value: float
    reading: str
    recording: str = ""
    small: bool = False
    apart: Apart | None = None
    draws: int = field(kw_only=True)


@dataclass(frozen=True)
class OfJoint:
    """A joint (from 1): RMS of what the model leaves of its torque, N*m (N), on samples where it moves (nan: it never
    does, or its drive was not logged): `before` and `after` what was identified, `held_out` on motion to which sizes
    were not fitted, `floor` what the whole library leaves, and `share` of the torque's RMS that is left (held out).
    `p_unknown` is how often chance leaves as much structure; `depends_on` what that depends on where it is more than
    chance (`q2`, `speed`, `load`, `time`, `temperature_degC`).
    """

    joint: int
    before: float
    after: float
    held_out: float
    floor: float
    share: float
    depends_on: tuple[str, ...] = ()
    p_unknown: float = 1.0


@dataclass(frozen=True)
class Instant:
    """A `time` (s, on a log's clock) with its 95 % `interval`."""

    time: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class Change:
    """An effect and its joints or links (from 1) that acts otherwise in a log from `start` on until its `end` (None:
    the log's), by how much more in `parameters`, with the `share` of the square that it explains of what was left, and
    the RMS `torque` (n,) N*m (N) that it adds at each joint."""

    effect: str
    at: tuple[int, ...]
    parameters: tuple[FittedParameter, ...]
    log: str
    start: Instant
    end: Instant | None
    share: float
    torque: tuple[float, ...]


@dataclass(frozen=True)
class Event:
    """What happens in a log, and is no physics of the arm: its `change`; of a push the `joints` that it loads, and the
    `links` of which one is pushed (from 1). Its rows are set aside."""

    kind: Literal["contact", "collision", "payload taken", "payload left"]
    change: Change
    joints: tuple[int, ...] = ()
    links: tuple[int, ...] = ()


@dataclass(frozen=True)
class MotionUnknown:
    """What no few causes explain: at which joints (from 1), on what it depends, its RMS (N*m) at
    the `worst` of them, its shape in words, and which log would decide; `change` where it begins within a log."""

    joints: tuple[int, ...]
    depends_on: tuple[str, ...]
    amplitude: float
    shape: str
    decide: str
    worst: int
    change: Change | None = None


@dataclass(frozen=True)
class Traces:
    """What is drawn of a log: `time` (M,) s, `q`, `velocity`, `measured`, `before` and `after` (M, n): the torque as
    measured and by the model before and after, N*m (N), and what of the last is `friction`, filtered alike; `moves` (M,
    n) marks the samples that count."""

    log: str
    time: Array
    q: Array
    velocity: Array
    measured: Array
    before: Array
    after: Array
    friction: Array
    moves: NDArray[np.bool_]


@dataclass(frozen=True)
class OfLog:
    """One of several logs: its name, file, unit and date, samples used, and RMS of all joints together (N*m) before,
    after and held out; `rejected` are rows that were set aside. `entries` are entries that hold in it alone, with which
    beside the arm file `rms_with_own` is left of it (None: there are none)."""

    name: str
    file: str
    unit: str
    date: str
    samples: int
    rms_before: float
    rms_after: float
    rms_held_out: float
    rejected: tuple[int, ...]
    entries: tuple[EffectEntry, ...] = ()
    rms_with_own: float | None = None


@dataclass(frozen=True)
class Deviation:
    """RMS of simulated less measured motion of a joint: coordinates over the windows and at their ends (`q`, `q_end`;
    rad, of slides m), and speeds (`velocity`, `velocity_end`; rad/s, m/s)."""

    q: float
    q_end: float
    velocity: float
    velocity_end: float


@dataclass(frozen=True)
class RolloutOfJoint:
    """A joint (from 1): how far the simulated arm is off as given (`before`), as written (`after`), and by fits that
    have not seen the window (`held_out`)."""

    joint: int
    before: Deviation
    after: Deviation
    held_out: Deviation


@dataclass(frozen=True)
class RolloutTraces:
    """What is drawn of a log: `time` (M,) s, and coordinates (M, n) as `measured` and as simulated `before` and
    `after`; windows follow each other, with a row that is not a number between two."""

    log: str
    time: Array
    measured: Array
    before: Array
    after: Array


@dataclass(frozen=True)
class Rollout:
    """The arm simulated by MuJoCo under the logged torques, over windows of so many `seconds` from the logged state on.

    `windows` were simulated; `left` says how many left the joints' ranges, before, after and held out. `beside` are the
    effects, by id, that act beside what MJCF holds. `lacks` says why nothing was simulated (empty: it was).
    """

    seconds: float
    windows: int
    left: tuple[int, int, int]
    per_joint: tuple[RolloutOfJoint, ...]
    traces: tuple[RolloutTraces, ...]
    beside: tuple[str, ...]
    lacks: str = ""


@dataclass(frozen=True)
class MotionDiagnosis:
    """The whole result. RMS figures without a joint are the root of the mean over joints of mean squares, N*m.

    `corrected` is the arm with what was identified among its effects. `split` names how motion was held out, `cutoff`
    (Hz) the low-pass on both sides (None: none), `rates` (Hz) those of the logs. `gate_p` is how often chance alone
    would make any candidate as evident beside the model as given; what is too small or foretells no other motion is not
    named. `sentence` is the plain answer, `notes` what rests on what. `written` says what the corrected arm's file
    leaves of the same motion (N*m; None: not tried), `rivals` which models were tried on held-out motion, and which of
    them `corrected` holds. `beyond` (n,) N*m is the RMS by joint of what else may differ between several logs. Figures
    are of that file alone; where one log has something of its own, `rms_with_own` is what is left beside that: by the
    file, and by what was named on motion that was not fitted. `small_together` (n,) N*m is the RMS of what the small
    findings add at each joint together. Rows of `events` count nowhere. `rollout` is there where it was asked for.
    """

    arm: Arm
    logs: tuple[MotionLog, ...]
    verdict: Verdict
    sentence: str
    per_joint: tuple[OfJoint, ...]
    findings: tuple[MotionFinding, ...]
    unknown: MotionUnknown | None
    rms_before: float
    rms_after: float
    rms_held_out: float
    noise_floor: float
    gate_p: float
    split: str
    cutoff: float | None
    rates: tuple[float, ...]
    traces: tuple[Traces, ...]
    of_logs: tuple[OfLog, ...]
    corrected: Arm
    notes: tuple[str, ...]
    seconds: float = 0.0
    written: WrittenArm | None = None
    rivals: Rivals | None = None
    beyond: tuple[float, ...] = ()
    rms_with_own: tuple[float, float] | None = None
    small_together: tuple[float, ...] = ()
    events: tuple[Event, ...] = ()
    rollout: Rollout | None = None
