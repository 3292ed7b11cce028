"""A score as JSON and as Markdown; nothing is computed here."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, fields
from typing import Any

from benchmarks.blind.answers import Rate, Spread
from benchmarks.blind.score import Score


def _clean(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _clean(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_clean(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def as_json(score: Any) -> str:
    """All figures of a score (a dataclass); null where there is nothing to count."""
    return json.dumps(_clean(asdict(score)), indent=1) + "\n"


def as_markdown(score: Score) -> str:
    """One table of single figures, then one table for each breakdown."""
    lines = [f"# Blind proof: {score.half or 'unnamed'} half", "", f"Seal {score.seal or '(none)'}", ""]
    lines += ["Shares: count of cases, 95 % Clopper-Pearson interval.", "", "| figure | result |", "|---|---|"]
    lines.append("| cases | " + ", ".join(f"{name} {count}" for name, count in score.cases) + " |")
    tables: list[tuple[str, Any]] = []
    for field in fields(Score):
        value = getattr(score, field.name)
        label = field.name.replace("_", " ")
        if isinstance(value, Rate | Spread):
            lines.append(f"| {label} | {value.shown()} |")
        elif isinstance(value, float):
            lines.append(f"| {label} | {'-' if math.isnan(value) else f'{value:.2f}'} |")
        elif isinstance(value, tuple) and field.name != "cases":
            tables.append((label, value))
    for label, rows in tables:
        lines += ["", f"## {label[0].upper()}{label[1:]}", "", "| | |", "|---|---|"]
        for key, value in rows:
            text = value.shown() if isinstance(value, Rate) else ", ".join(f"{name} {n}" for name, n in value)
            lines.append(f"| {key} | {text} |")
    return "\n".join(lines) + "\n"
