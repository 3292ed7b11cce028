"""docs/rules.md: every rule of the diagnosis with its value, unit, reason and source, from the rules themselves."""

from __future__ import annotations

import inspect
import itertools

from linkwright.core.diagnose.rules.rule import Rule, rules_in
from linkwright.core.diagnose.rules.rules import RULES

HEAD = """# The rules of the diagnosis

Look up here the value, reason and source of every threshold by which a recording is judged. `Options(rules=...)` takes
others for one diagnosis. The page is written from `diagnose/rules/` (`make rules-docs`).

A value without a source in the literature was chosen on the proof's disclosed half (see [proof.md](proof.md)), or is
judged, or bounds computing time. What counts readings, visits or poses says why it may take effect at some number of
them. Nothing else changes with one more reading.
"""


def page() -> str:
    """The whole page, Markdown."""
    parts = [HEAD]
    for stage, rules in itertools.groupby(rules_in(RULES), key=lambda rule: rule.stage):
        kind = type(getattr(RULES, stage))
        module = inspect.getmodule(kind)
        about = ((module.__doc__ if module else None) or "").strip()
        parts += [f"## {stage}\n", f"{about}\n", "| rule | value | unit | reason | source |", "|---|---|---|---|---|"]
        parts += [_row(rule) for rule in rules]
        parts.append("")
    return "\n".join(parts).rstrip() + "\n"


def _row(rule: Rule) -> str:
    values = rule.value if isinstance(rule.value, tuple) else (rule.value,)
    value = ", ".join(f"{item:.6g}" for item in values)
    reason = f"{rule.reason} *{rule.rows}*" if rule.rows else rule.reason
    return f"| `{rule.name}` | {value} | {rule.unit} | {reason} | {rule.source} |"
