"""All rules of the diagnosis in one frozen object, by the room that asks them."""

from __future__ import annotations

from dataclasses import dataclass, field

from .answer_rules import AnswerRules
from .compare_rules import CompareRules
from .fitting_rules import FittingRules
from .log_rules import LogRules
from .mistake_rules import MistakeRules
from .motion_rules import MotionRules
from .pattern_rules import PatternRules
from .plan_rules import PlanRules
from .reading_rules import ReadingRules
from .residual_rules import ResidualRules
from .search_rules import SearchRules
from .watch_rules import WatchRules


@dataclass(frozen=True)
class Rules:
    """Every threshold of a diagnosis. `dataclasses.replace` makes others for one diagnosis:
    `replace(RULES, search=replace(RULES.search, false_alarm=0.001))`."""

    reading: ReadingRules = field(default_factory=ReadingRules)
    log: LogRules = field(default_factory=LogRules)
    motion: MotionRules = field(default_factory=MotionRules)
    mistakes: MistakeRules = field(default_factory=MistakeRules)
    residual: ResidualRules = field(default_factory=ResidualRules)
    patterns: PatternRules = field(default_factory=PatternRules)
    fitting: FittingRules = field(default_factory=FittingRules)
    search: SearchRules = field(default_factory=SearchRules)
    answer: AnswerRules = field(default_factory=AnswerRules)
    compare: CompareRules = field(default_factory=CompareRules)
    plan: PlanRules = field(default_factory=PlanRules)
    watch: WatchRules = field(default_factory=WatchRules)


RULES = Rules()
"""The rules as they stand; frozen."""
