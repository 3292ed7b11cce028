"""A measured figure with its target."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """What was measured, the figure in words, the target in words ("" for none), whether it is met (None without
    one), and what must be known of it."""

    what: str
    figure: str
    target: str = ""
    met: bool | None = None
    note: str = ""


def at_least(what: str, value: float, target: float | None, note: str = "") -> Row:
    """A ratio that should not fall below a target."""
    asked = "" if target is None else f"at least {target:g}"
    return Row(what, f"{value:.3g} times", asked, None if target is None else value >= target, note)


def at_most(what: str, value: float, unit: str, target: float | None, note: str = "") -> Row:
    """A figure that should not exceed a target."""
    asked = "" if target is None else f"at most {target:g} {unit}".rstrip()
    return Row(what, f"{value:.3g} {unit}".rstrip(), asked, None if target is None else value <= target, note)
