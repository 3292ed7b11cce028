"""The report's picture as SVG, readable on light and dark pages: power curves."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from html import escape

from benchmarks.blind.answers import Rate

COLOURS = ("#1f6fb4", "#d1661f")
_GREY, _INK = "#8a8a8a", "#3a3a3a"
_FONT = 'font-family="sans-serif"'


def _svg(width: float, height: float, label: str, parts: Sequence[str]) -> str:
    window = f'viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" height="{height:.0f}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {window} role="img" aria-label="{escape(label)}">'
    ground = f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>'
    return "\n".join([head, ground, *parts, "</svg>"]) + "\n"


def _text(x: float, y: float, words: str, *, anchor: str = "middle", size: float = 11.0, colour: str = _INK) -> str:
    where = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    return f'<text {where} font-size="{size:g}" fill="{colour}" {_FONT}>{escape(words)}</text>'


def _line(x1: float, y1: float, x2: float, y2: float, colour: str, width: float = 1.0, dash: str = "") -> str:
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    ends = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
    return f'<line {ends} stroke="{colour}" stroke-width="{width:g}"{dashed}/>'


def power(curves: Mapping[str, Sequence[tuple[float, Rate]]], targets: Sequence[tuple[float, float]]) -> str:
    """Shares against projected signal to noise (logarithmic), 95 % intervals as bars, targets as rings."""
    left, top, wide, high = 56.0, 14.0, 480.0, 260.0
    doses = sorted({dose for curve in curves.values() for dose, _ in curve})
    low, span = math.log(doses[0]), math.log(doses[-1]) - math.log(doses[0])

    def x(dose: float) -> float:
        return left + 20.0 + (wide - 40.0) * (math.log(dose) - low) / max(span, 1e-9)

    def y(share: float) -> float:
        return top + high * (1.0 - share)

    parts: list[str] = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        parts += [_line(left, y(share), left + wide, y(share), "#dddddd")]
        parts += [_text(left - 6.0, y(share) + 4.0, f"{100 * share:.0f} %", anchor="end")]
    parts += [_text(x(dose), top + high + 16.0, f"{dose:g}") for dose in doses]
    parts.append(_text(left + wide / 2.0, top + high + 34.0, "projected signal over noise"))
    for dose, share in targets:
        parts.append(
            f'<circle cx="{x(dose):.1f}" cy="{y(share):.1f}" r="6" fill="none" stroke="{_INK}" stroke-width="1.5"/>'
        )
    for k, (name, curve) in enumerate(curves.items()):
        colour, aside = COLOURS[k % 2], 3.0 * (k - (len(curves) - 1) / 2.0)
        known = [(dose, item) for dose, item in curve if item.total]
        for dose, each in known:
            at = x(dose) + aside
            parts.append(_line(at, y(each.low), at, y(each.high), colour, 1.5))
            parts.append(f'<circle cx="{at:.1f}" cy="{y(each.share):.1f}" r="3.5" fill="{colour}"/>')
        for (one, first), (two, second) in itertools.pairwise(known):
            ends = (x(one) + aside, y(first.share), x(two) + aside, y(second.share))
            parts.append(_line(*ends, colour, 2.0, "5 3" if k >= 2 else ""))
        key, line = left + wide - 190.0, y(0.2) + 16.0 * k
        parts.append(_line(key, line, key + 25.0, line, colour, 2.0, "5 3" if k >= 2 else ""))
        parts.append(_text(key + 32.0, line + 4.0, name, anchor="start"))
    parts.append(_text(left + wide - 158.0, y(0.2) + 16.0 * len(curves) + 4.0, "rings: targets", anchor="start"))
    return _svg(left + wide + 16.0, top + high + 46.0, "share of effects whose class is named, by size", parts)
