"""What a diagnosis found, in SI: everything that a report says is drawn from here."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array

from .judge.rivals import Rivals
from .recording import Recording, RejectedRow
from .rules.fitting_rules import FittingRules
from .rules.rules import RULES

HALF = 0.5
"""The share from which on most of something is reported."""

Verdict = Literal["none", "named", "alias_class", "unknown", "insufficient_data"]


@dataclass(frozen=True)
class FittedParameter:
    """A parameter's value with its 95 % interval, in the SI unit of `kind` (see materials.quantities).

    `name` is the parameter's own, with the joint's or link's number where the effect acts at one (`compliance_2`).
    `at_bound` says that it stands at a physical bound. `may_hold` is an effect that does the same at this place, of
    which the value may hold a part that nothing tells apart: value and interval are those of both, and with what is
    usual of that effect left out the parameter alone is `between`.
    """

    name: str
    parameter: str
    at: tuple[int, ...]
    kind: str
    value: float
    interval: tuple[float, float]
    at_bound: bool = False
    may_hold: str = ""
    between: tuple[float, float] | None = None

    @property
    def alone(self) -> tuple[float, float]:
        """The 95 % interval of the parameter alone."""
        return self.interval if self.between is None else self.between

    @property
    def largest(self) -> float:
        """The largest of value and interval that is known."""
        return max((abs(item) for item in (self.value, *self.interval) if math.isfinite(item)), default=0.0)

    @property
    def digits(self) -> int:
        """As many digits as the interval's width supports."""
        half = 0.5 * (self.interval[1] - self.interval[0])
        if not (math.isfinite(half) and half > 0.0 and self.largest > 0.0):
            return 3
        return min(7, max(2, 1 + math.floor(math.log10(self.largest)) - math.floor(math.log10(half))))


@dataclass(frozen=True)
class FittedOrigin:
    """A fixed transform that the arm file leaves free, as it was found: in front of which joint (from 1), its shift
    (m, in the frame before it) and fixed-axis roll, pitch and yaw (rad), and the numbers that were free with their
    intervals. `swallowed` is what cannot be distinguished from it, by effect and place."""

    joint: int
    shift: tuple[float, float, float]
    turn: tuple[float, float, float]
    parameters: tuple[FittedParameter, ...]
    swallowed: tuple[tuple[str, tuple[int, ...]], ...] = ()


@dataclass(frozen=True)
class FittedPlacement:
    """What a recording (empty: the only one) left free, where it was found: of a `frame` the base in the measuring
    frame (x, y, z in m and fixed-axis roll, pitch and yaw in rad), of a `tool` the tip in the last link's frame at its
    end (m), as an arm file's `tool` gives it; in a plane what lies in it."""

    of: Literal["frame", "tool"]
    recording: str
    parameters: tuple[FittedParameter, ...]


@dataclass(frozen=True)
class Alternative:
    """What the data cannot tell from a named effect: where it acts (from 1), and how alike the two patterns are.

    `likeness` is the correlation of the two displacement patterns once nuisances and the other findings are projected
    out; `worse` the increase of the criterion (extended BIC) when it takes the named effect's place. `recording` is as
    in a `Finding`.
    """

    effect: str
    at: tuple[int, ...]
    likeness: float
    worse: float
    recording: str = ""


@dataclass(frozen=True)
class Exchange:
    """Causes that together could stand in the place of one or two findings, none of them alone: two zeros for a tool's
    offset, a tilt for two couplings. Each is an effect with the joints or links (from 1) where it acts and the one of
    several recordings (empty: all); `worse` as in an `Alternative`."""

    instead_of: tuple[tuple[str, tuple[int, ...], str], ...]
    effects: tuple[tuple[str, tuple[int, ...], str], ...]
    worse: float


@dataclass(frozen=True)
class Finding:
    """Physics that the model left out: where it acts (joints or links from 1), its parameters, and what it explains.

    `rms_explained` (m) is the RMS length of the displacement that it adds at the recording's poses; `p_value` that of
    its test by permutation among all candidates, given all other findings (beyond three, given those named before
    it; nan where neighbouring readings share what they are off by, so that no p-value holds); `evidence` (nats) how
    much likelier the recording is with it than without, once its coefficients, the choice among candidates and unusual
    sizes are paid for; `may_be_nothing` whether the intervals of all its sizes hold zero; `rms_without` (m) the RMS
    of what remains when it alone is left out and the rest is fitted again, `rms_without_held_out` the same on rows not
    fitted. `reading` is the plain sentence. `recording` names the one of several recordings in which it acts, beside
    what all have (empty: in all). `together` are the other findings, by effect and place, without which it means
    nothing (empty: it does by itself). `small` says that held-out readings hardly need it (see `judge.needed`).
    """

    effect: str
    at: tuple[int, ...]
    alternatives: tuple[Alternative, ...]
    parameters: tuple[FittedParameter, ...]
    rms_explained: float
    p_value: float
    rms_without: float
    rms_without_held_out: float
    reading: str
    recording: str = ""
    together: tuple[tuple[str, tuple[int, ...]], ...] = ()
    evidence: float = math.nan
    may_be_nothing: bool = False
    small: bool = False


@dataclass(frozen=True)
class Rung:
    """One model of the ladder: what it adds, and its RMS, mean and largest residual (m); `held_out` on rows not
    fitted."""

    label: str
    rms: float
    mean: float
    largest: float
    held_out: float


@dataclass(frozen=True)
class Dependence:
    """Whether the mismatch depends on a covariate (`position`, `time`, `payload_kg`, `q2`, ...): p by permutation of
    pose blocks (largest of all tests), and the share of the mismatch's sum of squares that it alone can describe."""

    on: str
    p_value: float
    share: float


@dataclass(frozen=True)
class Location:
    """Where the mismatch sits: the joint (from 1) whose motion describes it best, the direction in which the tip is
    displaced, since when (s), and what it depends on."""

    joint: int | None
    joint_shares: tuple[float, ...]
    depends_on: tuple[str, ...]
    direction: str | None
    since: float | None
    dependences: tuple[Dependence, ...]

    @property
    def share(self) -> float | None:
        """The share of the mismatch that motion of that joint alone could describe."""
        known = self.joint is not None and self.joint <= len(self.joint_shares)
        return self.joint_shares[self.joint - 1] if known and self.joint is not None else None


@dataclass(frozen=True)
class RejectedForm:
    """A candidate that was considered and not taken: how much of the mismatch it explains alone (share of the sum of
    squares), and why not."""

    effect: str
    at: tuple[int, ...]
    share: float
    reason: str


@dataclass(frozen=True)
class Form:
    """A simple form that describes what the library cannot: its name, the share of the remaining sum of squares that it
    explains, on held-out rows too, and a sentence."""

    name: str
    share: float
    share_held_out: float
    sentence: str


@dataclass(frozen=True)
class Unknown:
    """What nothing in the library explains: what it depends on, its amplitude (m, RMS), its shape in words, the forms
    that describe it best, why each near entry was rejected, since when (s), and which recording would decide.

    `predicted` (N, 2 or 3) m is a smooth model of it (a Gaussian process orthogonal to the known physics), good for
    compensation only; `held_out_share` is the share of the sum of squares that it predicts on rows it has not seen.
    """

    depends_on: tuple[str, ...]
    amplitude: float
    shape: str
    forms: tuple[Form, ...]
    rejected: tuple[RejectedForm, ...]
    since: float | None
    decide: str
    predicted: Array | None
    held_out_share: float | None


@dataclass(frozen=True)
class LackOfFit:
    """Whether readings of one pose refute what was named: `ratio` is the F ratio of what visits are off by against pure
    error, `freedom` its degrees of freedom, `p_value` its p-value.

    `against` says what pure error is: `repeats` of a visit, or `returns` where visits of one pose differ by more than
    their readings do. `times` is the RMS of what is left over that of the pure error, `held_out_times` the RMS on parts
    of the workspace held out over what noise alone leaves there (1 with the right model, however many sizes are
    fitted), and `held_out_p` how often noise leaves as much.
    """

    ratio: float
    freedom: tuple[float, float]
    p_value: float
    against: Literal["repeats", "returns"]
    times: float
    held_out_times: float
    held_out_p: float


@dataclass(frozen=True)
class SmallBeside:
    """Causes of the library too small to be named singly, which together are more than noise: how far they move the tip
    (RMS length, m), most likely, and what readings of one pose say of the fit with room for them."""

    moved: float
    lack_of_fit: LackOfFit


@dataclass(frozen=True)
class Left:
    """What is left of the tip's readings (RMS lengths, m): of those that were fitted, and of those `held_out`, beside
    the noise `floor` with what wanders (None: nobody knows it). Every sentence that compares them is drawn from here.
    """

    rms: float
    held_out: float
    floor: float | None
    rules: FittingRules

    @property
    def times(self) -> float:
        """How many times the noise floor is left; nan where nobody knows it."""
        return self.rms / self.floor if self.floor else math.nan

    @property
    def times_held_out(self) -> float:
        """The same of readings that were not fitted."""
        return self.held_out / self.floor if self.floor else math.nan

    @property
    def fits(self) -> bool:
        """Whether what is left of the readings that were fitted is no more than the noise floor."""
        return self.times <= self.rules.at_the_floor

    @property
    def is_noise(self) -> bool:
        """Whether that holds of those that were not fitted too."""
        return self.fits and not self.times_held_out > self.rules.at_the_floor

    @property
    def is_more(self) -> bool:
        """Whether it is more than any noise."""
        return self.times > self.rules.far_above


@dataclass(frozen=True)
class Alike:
    """What rows set aside have most in common, as a clause (`how`), and how often chance makes as much (`p_value`)."""

    how: str
    p_value: float


@dataclass(frozen=True)
class SetAside:
    """Rows set aside beside a model: their number `rows`, what is left with them (RMS length, m), and what they have in
    common where that is more than chance (None: nothing)."""

    rows: int
    rms_with: float
    alike: Alike | None


@dataclass(frozen=True)
class WrittenArm:
    """The corrected arm as its file says it, read back and applied to the recording it stems from: the RMS (m) that it
    leaves, what the fit `promised` (m), and in words what of the findings the file lacks."""

    rms: float
    promised: float
    lacks: tuple[str, ...]

    def keeps(self, tolerance: float) -> bool:
        """Whether it leaves what was promised, to within a share of it."""
        return abs(self.rms - self.promised) <= tolerance * self.promised


@dataclass(frozen=True)
class Mislabelled:
    """Labels that seem to stand beside the wrong readings: `said` in words, what is `named` (effect, joints or links
    from 1) once they are put right, and what that leaves (RMS, m), which is the noise floor."""

    said: str
    named: tuple[tuple[str, tuple[int, ...]], ...]
    rms: float


@dataclass(frozen=True)
class Detectable:
    """The smallest size of an effect at a place that this recording would have shown (power 0.9): the RMS displacement
    of the tip (m), and the value of its parameter in the SI unit of `kind`.

    `visible` is the share of the pattern that remains once nuisances are projected out; 0 where the recording cannot
    show the effect at all.
    """

    effect: str
    at: tuple[int, ...]
    rms: float
    parameter: str
    kind: str
    value: float
    visible: float


@dataclass(frozen=True)
class NextPose:
    """A pose worth recording next: joint coordinates (rad, m), payload (kg, None: as in the arm file), side of approach
    (+1, -1) and what it decides."""

    q: tuple[float, ...]
    payload_mass: float | None
    side: int
    decides: str


@dataclass(frozen=True)
class Covered:
    """A figure in the words of ISO 9283 or ISO 230, where the recording supports it: value (m), number of visits."""

    symbol: str
    name: str
    standard: str
    value: float
    count: int


@dataclass(frozen=True)
class OfRecording:
    """One of several recordings that were diagnosed together: its name, file, unit and date, how many readings were
    used, what is its own (`frame`, `tool`: known or free), and RMS lengths (m).

    `rms_held_out` is on parts of the workspace that the fit has not seen, `rms_from_others` what the model found in the
    other recordings leaves (frame and tool its own), `rms_own` what the same physics leaves with sizes of its own.
    `rejected` are rows of its file that were set aside. Where the recordings are of several arms, `corrected` is the
    arm with what was found in all and in this one, `rms_promised` what the fit says that it leaves, `written` what its
    file leaves (None: not tried).
    """

    name: str
    file: str
    unit: str
    date: str
    rows: int
    frame: str
    tool: str
    noise_floor: float | None
    rms_before: float
    rms_after: float
    rms_held_out: float
    rms_from_others: float
    rms_own: float
    rejected: tuple[int, ...]
    corrected: Arm | None = None
    rms_promised: float = math.nan
    written: WrittenArm | None = None


@dataclass(frozen=True)
class Difference:
    """A parameter that is not the same in several recordings: its value in `each` of them, in their order, and the
    p-value that it is the same."""

    effect: str
    at: tuple[int, ...]
    each: tuple[FittedParameter, ...]
    p_value: float


@dataclass(frozen=True)
class OtherArms:
    """Recordings that seem to be of different arms: the sizes of each one's own that tell them apart, in words, and
    what these would leave (RMS, m)."""

    names: str
    leaves: float


@dataclass(frozen=True)
class Diagnosis:
    """The whole result. Residuals are (N, 2 or 3), m, in the order of `recording`'s rows, in the base frame.

    `rms` figures are of the length of the error vector, m. `noise_floor` is None where nothing tells it; `noise_source`
    says where it comes from. `null_vectors` are sentences on what the nuisances cannot tell apart among themselves.
    `gate_p` is the p-value that there is any mismatch at all; `split` names how rows were held out; `corrected` is the
    arm file with the findings in it. `sentence` is the plain answer. `lack_of_fit` is None where too few poses were
    read again; `small` are causes too small to be named that are more than noise together (None: none are needed to
    explain what is left), `scatter` says how many times the noise floor readings scatter by from visit to visit, where
    that is more than noise and nothing explains it (None elsewhere). `rms_promised` (m) is what the
    `corrected` arm leaves by `predict`, `written` what the corrected arm's file leaves (None: not tried). `labels`
    says which
    sides or payloads seem to stand beside the wrong readings (None: none). `recordings` are those that were diagnosed
    together (none named: one), `differences` what is not the same in all of them.
    `origins` are fixed transforms that the arm file leaves free, as they were found. `other_arms` says what tells apart
    recordings that seem to be of different arms (None: they do not).
    `placements` are free frames and tools, as they were found.
    `noise_from` says whence the noise floor is known, `wandered` (RMS length, m) is what wanders with the instrument.
    `next_poses_enough` says whether the next poses, recorded once, tell the names that they help to tell; `exchanges`
    are sets of causes that the recording cannot tell from a set of findings. `set_aside` says what all figures leave
    out where rows lie far off what was found (None: none do). `small_together` (RMS length, m) is how far the small
    findings move the tip together.
    `shown` (N, W, D) is what of the tip's displacements the W numbers of a reading show, None where they are its place.
    """

    arm: Arm
    recording: Recording
    verdict: Verdict
    sentence: str
    noise_floor: float | None
    noise_source: str
    rms_before: float
    rms_after: float
    rms_after_held_out: float
    gate_p: float
    findings: tuple[Finding, ...]
    where: Location
    unknown: Unknown | None
    ladder: tuple[Rung, ...]
    rejected_rows: tuple[RejectedRow, ...]
    rejected_forms: tuple[RejectedForm, ...]
    detectable: tuple[Detectable, ...]
    invisible: tuple[tuple[str, tuple[int, ...]], ...]
    next_poses: tuple[NextPose, ...]
    next_poses_note: str
    null_vectors: tuple[str, ...]
    splits: Mapping[str, float]
    figures: tuple[Covered, ...]
    residual_before: Array
    residual_after: Array
    corrected: Arm
    notes: tuple[str, ...]
    seconds: float
    lack_of_fit: LackOfFit | None = None
    small: SmallBeside | None = None
    scatter: float | None = None
    rms_promised: float = math.nan
    written: WrittenArm | None = None
    labels: Mislabelled | None = None
    recordings: tuple[OfRecording, ...] = ()
    differences: tuple[Difference, ...] = ()
    shown: Array | None = None
    origins: tuple[FittedOrigin, ...] = ()
    other_arms: OtherArms | None = None
    next_poses_enough: bool = False
    noise_from: Literal["repeats", "declared", "revisits", "none"] = "repeats"
    wandered: float = 0.0
    exchanges: tuple[Exchange, ...] = ()
    set_aside: SetAside | None = None
    rivals: Rivals | None = None
    small_together: float = 0.0
    placements: tuple[FittedPlacement, ...] = ()

    def in_space(self, residual: Array) -> Array:
        """Residuals as displacements of the tip (N, D), m: along what was measured, where that is but a part."""
        return residual if self.shown is None else np.einsum("nwd,nw->nd", self.shown, residual)

    @property
    def left(self) -> Left:
        """What is left, beside the noise floor."""
        floor = None if self.noise_floor is None else math.hypot(self.noise_floor, self.wandered)
        return Left(self.rms_after, self.rms_after_held_out, floor, RULES.fitting)

    @property
    def unexplained(self) -> bool:
        """Whether there is more than noise that nothing explains: unknown, scatter, or far above the noise floor."""
        return self.verdict == "unknown" or self.scatter is not None or (self.verdict == "none" and self.left.is_more)

    @property
    def describes_most(self) -> bool:
        """Whether what was found, forms included, leaves less than half of the mismatch (sum of squares)."""
        return self.rms_after**2 < HALF * self.rms_before**2

    @property
    def describes_part(self) -> bool:
        """Whether what was found only describes part of the mismatch: the verdict is `unknown`."""
        return self.verdict == "unknown" and bool(self.findings)
