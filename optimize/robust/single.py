"""Limits on the error of single load cases and points, held in scenarios."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.figures import Asked, DesignExpressions, DesignValues, Held
from linkwright.core.arm.figures.error import SearchedError, SingleError
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.exchange.scenarios import Scenarios, scenario_column


class ErrorInScenarios(SearchedError):
    """The error of a load case or point in scenarios: the groups of its poses are the load cases that count, scenario
    after scenario."""

    def __init__(self, single: SingleError, scenarios: Scenarios) -> None:
        """`scenarios`: with the model and the search of that load case or point alone."""
        self.single, self.scenarios, self.name = single, scenarios, single.name

    def search(self, arm: Arm, cases: Sequence[LoadCase], workspace: Workspace) -> WorstSearch:
        """That of the arm as it is."""
        return self.single.search(arm, cases, workspace)

    def prepare(self, problem: Asked) -> WorstSearch:
        """That of the scenarios."""
        del problem
        return self.scenarios.search

    def groups(self, problem: Asked) -> int:
        """As many as scenarios, for each load case."""
        del problem
        return len(self.scenarios.held) * len(self.scenarios.model.cases)

    def rows(
        self, prepared: WorstSearch, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The error of the design as its scenario has it."""
        number, case = divmod(group, len(prepared.model.cases))
        column = scenario_column(prepared.arm, design, self.scenarios.held[number])
        return super().rows(prepared, case, pose, replace(design, beam_column=column), held)

    def worst_case(self, prepared: WorstSearch, design: DesignValues) -> WorstCase:
        """The worst over all scenarios."""
        del prepared
        return self.scenarios.worst(design.arm, design.load_cases, certify=False)
