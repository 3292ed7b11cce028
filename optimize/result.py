"""What an optimisation found, in SI: the design, what it was before, what holds it back, and how it got there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, TypeVar

from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.error_map import ErrorMap
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import FIGURES, KEPT_WITHIN, Figure
from linkwright.core.units.quantities import Relation

from .robust.result import Robust
from .worse import Worse, worse_figures

Status = Literal["certified", "certified_where_reached", "converged", "searched", "stopped", "interrupted", "doubtful"]
"""`certified`: no pose is worse than the bound, within the gap; `certified_where_reached`: none is, but part of the box
or path has no pose that could be; `converged`: no worse pose was found, without proof;
`searched`: there were too many combinations to try every one, so that a better one may exist; `stopped`: the iteration
limit ended the search; `interrupted`: an interrupt did; `doubtful`: a check of the answer failed (`doubts` says
which)."""


def proved(after: Evaluation) -> Status:
    """What a proof of a design's worst case says, as far as the design reaches."""
    return "certified" if after.unreached is None else "certified_where_reached"


@dataclass(frozen=True)
class BindingLimit:
    """A limit that holds the optimum, and its price: the change of the objective for one unit more of it.

    `text` is for people ("mass <= 26 kg"); `value` is what the design has and `limit` what it may have, in `unit`;
    `price` is the objective's change (in `price_unit`, negative is better) for one `unit` more. `assumed`: nobody asked
    for it.
    """

    name: str
    text: str
    value: float
    limit: float
    unit: str
    price: float
    price_unit: str
    assumed: bool = False


@dataclass(frozen=True)
class Iteration:
    """One round of the exchange: the objective over the poses so far (m, kg or EUR), how far the design moved (largest
    relative change of a variable), how many poses bind it, the worst violation found afterwards (relative), and whether
    the certificate agreed."""

    number: int
    objective: float
    design_change: float
    poses: int
    worst_violation: float
    certified: bool


@dataclass(frozen=True)
class Candidate:
    """One combination of shapes and materials: its objective, or why it was left (`outcome`).

    `objective` is a bound from below where `outcome` is `bounded out`, None where `outcome` is `infeasible`, or
    `unsolved`: the solver failed, which proves nothing.
    """

    shapes: tuple[str | None, ...]
    materials: tuple[str | None, ...]
    objective: float | None
    outcome: Literal["best", "solved", "bounded out", "infeasible", "unsolved"]


@dataclass(frozen=True)
class Dropped:
    """A material or a shape of which every combination that was looked at was infeasible: its name, and the limits that
    the design of it that comes nearest to keeping all of them still breaks. Of a material that could not be looked at
    `why` says the reason instead."""

    kind: Literal["material", "section"]
    name: str
    limits: tuple[str, ...]
    why: str = ""


@dataclass(frozen=True)
class NearTie:
    """A combination that comes within a few per cent of the best, solved to the end: its objective and its figures (SI;
    None where not known); its actuators joint by joint (None: the joint keeps its drive)."""

    shapes: tuple[str | None, ...]
    materials: tuple[str | None, ...]
    actuators: tuple[str | None, ...]
    objective: float
    max_error: float
    mass: float
    cost: float | None
    first_frequency: float | None
    arm: Arm


@dataclass(frozen=True)
class DriveCandidate:
    """One choice of actuators, joint by joint (None: the joint keeps its drive): the objective that it allows (SI),
    or why it was left. `objective` is None where `outcome` is not `best` or `solved`."""

    actuators: tuple[str | None, ...]
    objective: float | None
    outcome: Literal["best", "solved", "bounded out", "infeasible"]


@dataclass(frozen=True)
class PlaceCandidate:
    """One combination of motors' places, in words: the objective that it allows (SI), None where it has none better
    than another's."""

    places: tuple[str, ...]
    objective: float | None
    outcome: Literal["best", "solved", "bounded out", "infeasible", "reaches less"]


@dataclass(frozen=True)
class ChosenBalance:
    """A number (SI) that was chosen of a counterweight or a counterbalance: in words, of which joint or link (from 1),
    the arm's own, and whether it came to the `least` or the `greatest` that was allowed."""

    words: str
    at: int
    field: str
    kind: str
    before: float
    value: float
    bound: Literal["least", "greatest"] | None


@dataclass(frozen=True)
class KeptLimit:
    """A limit with what the optimum had and what the rounded design has of it (SI)."""

    name: str
    text: str
    before: float
    after: float
    relation: Relation
    value: float
    figure: Figure

    @property
    def room(self) -> float:
        """How far inside the limit the rounded design is, relative to it (negative beyond it); zero for an
        equality."""
        if self.relation == "==":
            return 0.0
        ratio = self.after / self.value
        return ratio - 1.0 if self.relation == ">=" else 1.0 - ratio

    @property
    def exceeded(self) -> float:
        """How far beyond the limit the rounded design is, relative to it; zero where it is kept, NaN where unknown."""
        over = abs(self.after / self.value - 1.0) if self.relation == "==" else -self.room
        return over if math.isnan(over) or over > KEPT_WITHIN else 0.0


@dataclass(frozen=True)
class Rounded:
    """The best design of sizes that can be had, near the optimum.

    `to` is `stock` or the grid (`0.5 mm`), `length_step` the grid of the link lengths (m; None where they stay).
    `objective` and `before` are in SI units of what was minimised, of this design and of the optimum. `compared`
    designs were scored, `searched` of them over their whole workspace; `exhaustive`: every combination of the nearest
    sizes was among them.
    """

    to: str
    length_step: float | None
    arm: Arm
    evaluation: Evaluation
    error_map: ErrorMap
    objective: float
    before: float
    limits: tuple[KeptLimit, ...]
    compared: int
    searched: int
    exhaustive: bool
    seconds: float
    interrupted: bool = False
    """Whether an interrupt ended the comparison: this is then the best design that it had."""
    kept: tuple[str, ...] = ()
    """Why links stay as computed, one sentence each: no such size can be had of them."""

    @property
    def certified(self) -> bool:
        """Whether no pose of the workspace is worse than this design's error, within the gap."""
        return self.evaluation.worst.certified


@dataclass(frozen=True)
class NotRounded:
    """Why there is no design of sizes that can be had, and the one that breaks the limits least.

    `to` and `length_step` as in `Rounded`. `excess` is how far `nearest` is beyond the limit that it breaks most,
    relative to it; `limits` are all of them. `proven`: no combination of these sizes breaks them less. None, 0 and
    empty where there is no such design at all.
    """

    to: str
    length_step: float | None
    reason: str
    nearest: Evaluation | None = None
    excess: float = 0.0
    limits: tuple[KeptLimit, ...] = ()
    proven: bool = False
    seconds: float = 0.0


Noted = TypeVar("Noted", Candidate, NearTie, DriveCandidate, PlaceCandidate)


def in_figure(noted: tuple[Noted, ...], figure: Figure) -> tuple[Noted, ...]:
    """What was found with a badness, with the objective itself (SI)."""
    if not figure.more_is_better:
        return noted
    values = (None if item.objective is None else figure.badness(item.objective) for item in noted)
    return tuple(replace(item, objective=value) for item, value in zip(noted, values, strict=True))


@dataclass(frozen=True)
class OptimizationResult:
    """The best design found, with the arm as given for comparison.

    `limits` are the limits and ranges kept, `choices` what each link could be, both as people write them. `iterations`
    is the whole log: exchanges of one choice after another, numbered through.
    `objective` and `lower_bound` are in SI units of what was minimised (m, kg, EUR), or maximised: the bound is then
    one from above. `bound_of` says what `lower_bound`
    is: under `binding_poses` the optimum over the binding poses alone, from several starts: the design's objective
    lies above it by no more than the certificate's gap, and only where `optimum` is `global` is it a bound for every
    design. Under `all_designs` no design of any combination goes below it (see `optimize.choice.at_once.relaxation`).
    """

    problem_file: str
    minimize: str
    limits: tuple[str, ...]
    choices: tuple[str, ...]
    status: Status
    arm: Arm
    before: Evaluation
    after: Evaluation
    objective: float
    lower_bound: float
    binding: tuple[BindingLimit, ...]
    iterations: tuple[Iteration, ...]
    candidates: tuple[Candidate, ...]
    exhaustive: bool
    seconds: float
    before_map: ErrorMap
    after_map: ErrorMap
    optimum: Literal["global", "local"] = "local"
    """`global`: no allowed design does better, within the gap; `local`: none near it, nor any that the search met."""
    doubts: tuple[str, ...] = ()
    """The checks that the answer failed, in words (see `optimize.trust`)."""
    combinations: int = 1
    """How many combinations of shapes and materials there were; `candidates` are those that were looked at alone."""
    gap: float | None = 0.0
    """How much better (relative) a combination that was not solved could be at most, but for those that are `unsolved`;
    None where nothing tells."""
    bound_of: Literal["binding_poses", "all_designs"] = "binding_poses"
    near_ties: tuple[NearTie, ...] = ()
    """Combinations within 3 % of the best, best first."""
    near_ties_left: int = 0
    """How many more could come as near, by their bounds, and were not solved, at most."""
    drives: tuple[DriveCandidate, ...] = ()
    """The choices of actuators that were looked at, best first; none where the problem chooses no actuators."""
    drives_exhaustive: bool = True
    interrupted: bool = False
    """Whether an interrupt ended the search: this is then the best design that it had."""
    start: str | None = None
    """Why `before` is not the arm as given but one with other lengths, where that does not reach what is asked."""
    rounded: Rounded | None = None
    """The design of sizes that can be had, where that was asked for and there is one."""
    not_rounded: NotRounded | None = None
    """Why there is none, where that was asked for."""
    listed: bool = False
    """Whether sections were chosen from lists: limits then have no price."""
    dropped: tuple[Dropped, ...] = ()
    """The materials and shapes of which nothing could be made, with the limits that stand in the way."""
    balance: tuple[ChosenBalance, ...] = ()
    motor_places: tuple[PlaceCandidate, ...] = ()
    base: FloatVector | None = None
    """Where the base stands (m), where that was chosen; the arm's first joint stands there."""
    figures: Mapping[str, Figure] = field(default_factory=lambda: FIGURES)
    robust: Robust | None = None
    """The same for what is uncertain, where the problem asks for that: `objective` is then the robust error, and
    `after` the design as it is."""
    """What the problem could limit, by name."""

    @property
    def lower_bound_gap(self) -> float:
        """By how much (relative) the objective is worse than its bound."""
        if not self.objective:
            return 0.0
        badness = self.minimised.badness
        return max(0.0, 1.0 - badness(self.lower_bound) / badness(self.objective))

    @property
    def unsolved(self) -> tuple[Candidate, ...]:
        """The combinations on which the solver failed: they may be better for all that is known."""
        return tuple(candidate for candidate in self.candidates if candidate.outcome == "unsolved")

    @property
    def basis(self) -> Literal["certified", "bounded", "local"]:
        """What "the best" rests on: no allowed design does better, within the gaps of the certificates; none does by
        more than `lower_bound_gap`; or none near it, nor any that the search met."""
        if self.optimum == "global":
            return "certified"
        return "bounded" if self.bound_of == "all_designs" else "local"

    @property
    def minimised(self) -> Figure:
        """What was minimised, or maximised where more of it is better."""
        return self.figures[self.minimize]

    @property
    def worse(self) -> tuple[Worse, ...]:
        """What the arm to build does worse than the arm as given, in the order of `figures`."""
        return worse_figures(self.figures, self.before, self.as_built)

    @property
    def built(self) -> Arm:
        """The arm to build: the rounded one where there is one."""
        return self.arm if self.rounded is None else self.rounded.arm

    @property
    def as_built(self) -> Evaluation:
        """What is known of the arm to build."""
        return self.after if self.rounded is None else self.rounded.evaluation

    @property
    def map_as_built(self) -> ErrorMap:
        """The errors of the arm to build over the workspace."""
        return self.after_map if self.rounded is None else self.rounded.error_map
