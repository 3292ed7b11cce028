"""Small pieces of SVG and HTML: elements with escaped attributes, nice scales."""

from __future__ import annotations

import math
from collections.abc import Iterable
from html import escape


def element(tag: str, *children: str, **attributes: object) -> str:
    """An element; `class_` is its class, other underscores in names of attributes become hyphens; None is left out."""
    parts = [tag]
    for name, value in attributes.items():
        if value is not None:
            key = "class" if name == "class_" else name.replace("_", "-")
            key = "viewBox" if key == "view-box" else key
            parts.append(f'{key}="{escape(_attribute(value), quote=True)}"')
    return f"<{' '.join(parts)}>{''.join(children)}</{tag}>"


def _attribute(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def text(content: str) -> str:
    """Text that cannot be taken for markup."""
    return escape(content, quote=False)


def drawing(left: float, top: float, width: float, height: float, label: str, *children: str) -> str:
    """An SVG of the given window; `label` says in words what it shows."""
    window = f"{left:.6g} {top:.6g} {width:.6g} {height:.6g}"
    return element("svg", *children, view_box=window, role="img", aria_label=label)


def path(rings: Iterable[Iterable[tuple[float, float]]], class_: str) -> str:
    """Closed rings as one path; holes stay open by the even-odd rule."""
    pieces = ["M" + "L".join(f"{x:.6g},{y:.6g}" for x, y in ring) + "Z" for ring in rings]
    return element("path", d="".join(pieces), class_=class_, fill_rule="evenodd")


def line(start: tuple[float, float], end: tuple[float, float], class_: str, width: float) -> str:
    """A straight line."""
    return element("line", x1=start[0], y1=start[1], x2=end[0], y2=end[1], class_=class_, stroke_width=width)


def label(x: float, y: float, size: float, content: str, anchor: str = "middle", class_: str = "note") -> str:
    """A line of text."""
    return element("text", text(content), x=x, y=y, font_size=size, text_anchor=anchor, class_=class_)


def nice_below(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above the value; 1 where the value is not positive."""
    if value <= 0.0 or not math.isfinite(value):
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


def scale_bar(left: float, y: float, length: float, height: float, size: float, words: str) -> str:
    """A bar of so many drawn units with its length in words above it."""
    ends = (line((x, y - height), (x, y + height), "rule", height / 2) for x in (left, left + length))
    bar = line((left, y), (left + length, y), "rule", height / 2)
    return bar + "".join(ends) + label(left + length / 2, y - 2.2 * height, size, words)
