"""The page of the rules is what the rules say; a consulted rule is heard; perturbing one changes that alone."""

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.rules.judge import Told, harm, moves
from benchmarks.rules.outcomes import Found, Outcome, Run, as_json, from_json, report
from benchmarks.rules.page import FOUND, page, what_moved
from benchmarks.rules.watch import perturbed, watched
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rule import rules_in
from linkwright.core.diagnose.rules.rules import RULES
from tests.diagnose.core_cases import made_arm, recorded

DOCS = Path(__file__).resolve().parents[2] / "docs"
BY_PATH = {each.path: each for each in rules_in(RULES)}


def test_the_page_is_up_to_date():
    """`make rules-docs` writes it."""
    assert (DOCS / "rules.md").read_text(encoding="utf-8") == page()


@pytest.mark.parametrize(
    ("path", "factor", "value"),
    [
        ("search.margin", 1.2, 12.0),
        ("search.sparing", 0.8, 1),
        ("search.sparing", 1.2, 3),
        ("patterns.wanders", 1.2, (7, 14)),
    ],
)
def test_one_rule_is_perturbed(path, factor, value):
    """Whole numbers by one at least; all else stays."""
    changed = {each.path: each.value for each in rules_in(perturbed(RULES, BY_PATH[path], factor))}
    assert changed.pop(path) == pytest.approx(value)
    assert changed == {name: each.value for name, each in BY_PATH.items() if name != path}


def test_consulted_rules_are_heard():
    """Of a small recording of nothing: its tests, and not what only a found form asks."""
    asked: set[str] = set()
    arm = made_arm()
    told = diagnose(arm, recorded(arm), Options(rules=watched(RULES, asked)))
    assert {"search.false_alarm", "fitting.far_tail", "residual.same_angle"} <= asked <= set(BY_PATH)
    assert "answer.form_tells" not in asked
    assert told.verdict == "none"


def test_what_moves_is_said():
    """Verdict, names, sizes beyond their interval; and what turned wrong."""
    before = Told("named", ("backlash [2]",), {"backlash [2] gap_2": (1.0, 0.9, 1.1)}, True)
    assert moves(before, before) == []
    assert moves(before, replace(before, sizes={"backlash [2] gap_2": (1.09, 1.0, 1.2)})) == []
    assert len(moves(before, replace(before, sizes={"backlash [2] gap_2": (1.2, 1.1, 1.3)}))) == 1
    after = replace(before, verdict="none", names=(), sizes={}, right=False)
    assert moves(before, after) == ["verdict named -> none", "names -backlash [2]"]
    assert harm(before, after)
    assert not harm(after, before)


def test_the_run_that_the_page_tells_of_is_possible():
    """Its rules are rules, and nothing is told of more than was tried."""
    found = from_json(FOUND.read_text(encoding="utf-8"))
    assert set(found.moved) <= set(BY_PATH)
    tried = sum(found.tried.values())
    assert len(found.moved) <= tried <= found.run.consulted <= found.run.rules
    assert found.diagnoses <= 2 * found.run.recordings * tried
    assert set(found.tried) <= {each.stage for each in BY_PATH.values()}
    assert all(0 <= turned <= moved <= 2 * found.run.recordings for moved, turned in found.moved.values())


def test_a_run_is_told_in_short_and_in_full():
    """One rule turns a right answer wrong, one only moves something, one is never tried."""
    before = Told("named", ("backlash [2]",), {}, True)
    gone, other = replace(before, verdict="none", names=(), right=False), replace(before, verdict="alias_class")
    outcomes = {
        "search.beside": Outcome().and_one("x 0.8, case 3", before, other).and_one("x 1.2, case 3", before, before),
        "search.margin": Outcome().and_one("x 1.2, case 7", before, gone),
        "answer.local": Outcome(),
    }
    full = report(outcomes)
    assert full.index("search.margin") < full.index("search.beside") < full.index("answer.local")
    assert "- x 1.2, case 7: verdict named -> none; names -backlash [2] **turned wrong**" in full
    assert "In all: 3 diagnoses, 2 moved, 1 turned wrong." in full
    run = Run(seed=8, cases=9, recordings=4, rules=6, consulted=5)
    found = from_json(as_json(run, outcomes))
    assert found == Found(run, {"search": 2}, 3, {"search.beside": (1, 0), "search.margin": (1, 1)})
    told = what_moved(found)
    assert "Only 2 of those 5 were tried (2 of search), in 3 diagnoses: 2 said" in " ".join(told.split())
    assert told.index("| `search.margin` | 1 | 1 |") < told.index("| `search.beside` | 1 | 0 |")
    assert "All 2 were tried" in " ".join(what_moved(replace(found, run=replace(run, consulted=2))).split())
