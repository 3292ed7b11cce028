"""docs/rules.md: every rule of the diagnosis with its value, unit, reason and source, from the rules themselves."""

from __future__ import annotations

import inspect
import itertools
import textwrap
from pathlib import Path

from benchmarks.rules.outcomes import Found, from_json
from linkwright.core.diagnose.rules.rule import Rule, rules_in
from linkwright.core.diagnose.rules.rules import RULES

FOUND = Path(__file__).with_name("found.json")
"""The short of the last run of `make rules`."""

HEAD = """# The rules of the diagnosis

Every threshold by which a recording is judged. The page is generated from `diagnose/rules/` by `make rules-docs`; a
test keeps the two alike. `Options(rules=...)` takes others for one diagnosis.

A value without a source in the literature was chosen on the proof's disclosed half (see [proof.md](proof.md)), or is
judged, or bounds computing time. What counts readings, visits or poses says why it may take effect at some number of
them; nothing else changes with one more reading. `make rules` perturbs each rule by 20 % either way on recordings of
known truth in which it is consulted, and prints what moves.
"""


def page() -> str:
    """The whole page, Markdown."""
    parts = [HEAD]
    for stage, rules in itertools.groupby(rules_in(RULES), key=lambda each: each.stage):
        kind = type(getattr(RULES, stage))
        module = inspect.getmodule(kind)
        about = ((module.__doc__ if module else None) or "").strip()
        parts += [f"## {stage}\n", f"{about}\n", "| rule | value | unit | reason | source |", "|---|---|---|---|---|"]
        parts += [_row(each) for each in rules]
        parts.append("")
    parts.append(what_moved(from_json(FOUND.read_text(encoding="utf-8"))))
    return "\n".join(parts)


def what_moved(found: Found) -> str:
    """What the last run of `make rules` found, and how far it reached."""
    run = found.run
    moved, turned = (sum(each[k] for each in found.moved.values()) for k in (0, 1))
    tried = sum(found.tried.values())
    share = f"All {run.consulted} were tried"
    if tried < run.consulted:
        stages = ", ".join(f"{count} of {stage}" for stage, count in found.tried.items())
        share = f"Only {tried} of those {run.consulted} were tried ({stages})"
    told = (
        f"Each rule times 0.8 and times 1.2, on at most {run.recordings} of {run.cases} recordings (the proof's "
        f"generator, disclosed, seed {run.seed}) in which it is consulted; {run.consulted} of the {run.rules} rules of "
        f"that time are consulted in any of them. {share}, in {found.diagnoses} diagnoses: {moved} said "
        f"something else (verdict, names, or a size beyond its interval), {turned} turned a right answer wrong. So few "
        "recordings can show that a rule matters, not that it does not."
    )
    lines = ["## What moves when a rule does\n", f"{textwrap.fill(told, 120)}\n"]
    if found.moved:
        lines += ["| rule | diagnoses that moved | of them turned wrong |", "|---|---|---|"]
        ranked = sorted(found.moved.items(), key=lambda each: (-each[1][1], -each[1][0], each[0]))
        lines += [f"| `{path}` | {moved} | {turned} |" for path, (moved, turned) in ranked]
        lines.append("")
    return "\n".join(lines)


def _row(rule: Rule) -> str:
    values = rule.value if isinstance(rule.value, tuple) else (rule.value,)
    value = ", ".join(f"{each:.6g}" for each in values)
    reason = f"{rule.reason} *{rule.rows}*" if rule.rows else rule.reason
    return f"| `{rule.name}` | {value} | {rule.unit} | {reason} | {rule.source} |"
