"""Small pieces of SVG and HTML: elements with escaped attributes, nice scales, words apart from each other, plots."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array
from linkwright.results.figures_in_words import figure


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


LETTER = 0.56
"""Width of a letter, of its height."""


def width_of(words: str, size: float) -> float:
    """About how wide words of that size are drawn."""
    return LETTER * size * len(words)


@dataclass
class Levels:
    """Rows of words one above another: each goes to the first row where it is free from `low` to `high`."""

    rows: list[list[tuple[float, float]]] = field(default_factory=list[list[tuple[float, float]]])

    def placed(self, low: float, high: float) -> int:
        """The row that holds a span now."""
        for number, row in enumerate(self.rows):
            if all(high <= left or low >= right for left, right in row):
                row.append((low, high))
                return number
        self.rows.append([(low, high)])
        return len(self.rows) - 1


Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""


def free(box: Box, taken: Sequence[Box]) -> bool:
    """Whether a box overlaps none of the others."""
    return all(
        box[2] <= left or box[0] >= right or box[3] <= top or box[1] >= bottom for left, top, right, bottom in taken
    )


_TEXT = 12.0


@dataclass(frozen=True)
class Plot:
    """A frame of `width` by `height` units on the page that shows `across` and `up` (low, high) in the data's units;
    `logs` says which of the two axes are logarithmic."""

    width: float
    height: float
    across: tuple[float, float]
    up: tuple[float, float]
    left: float = 52.0
    bottom: float = 38.0
    top: float = 8.0
    right: float = 12.0
    logs: tuple[bool, bool] = (False, False)

    def x(self, values: Array) -> Array:
        """Where data stands across the page."""
        return self.left + _shares(values, self.across, log=self.logs[0]) * self.width

    def y(self, values: Array) -> Array:
        """Where data stands down the page."""
        return self.top + (1.0 - _shares(values, self.up, log=self.logs[1])) * self.height

    def drawn(self, about: str, names: tuple[str, str], *children: str, ticks: Sequence[float] | None = None) -> str:
        """The plot with frame, ticks and the axes' names; `ticks` are those across, by default round figures."""
        parts = [*self._ticks(ticks), *children]
        frame = {"x": self.left, "y": self.top, "width": self.width, "height": self.height}
        parts.append(element("rect", **frame, class_="frame"))
        middle = self.left + self.width / 2
        parts.append(label(middle, self.top + self.height + 33.0, _TEXT, names[0]))
        parts.append(self._upright(names[1]))
        full = (self.left + self.width + self.right, self.top + self.height + self.bottom)
        return drawing(0.0, 0.0, full[0], full[1], about, *parts)

    def _upright(self, words: str) -> str:
        x, y = 11.0, self.top + self.height / 2
        return label(x, y, _TEXT, words).replace("<text ", f'<text transform="rotate(-90 {x:g} {y:g})" ', 1)

    def _ticks(self, ticks: Sequence[float] | None) -> list[str]:
        parts, grid, foot = list[str](), list[str](), self.top + self.height
        for value in marks(*self.across, log=self.logs[0]) if ticks is None else ticks:
            x = float(self.x(np.array(value)))
            grid.append(f"M{x:.6g},{self.top:.6g}V{foot:.6g}")
            parts.append(label(x, foot + 15.0, _TEXT, figure(value, 6)))
        for value in marks(*self.up, log=self.logs[1]):
            y = float(self.y(np.array(value)))
            grid.append(f"M{self.left:.6g},{y:.6g}h{self.width:.6g}")
            parts.append(label(self.left - 5.0, y + 4.0, _TEXT, figure(value, 6), "end"))
        return [element("path", d="".join(grid), class_="axis"), *parts]


def _shares(values: Array, span: tuple[float, float], *, log: bool) -> Array:
    """Where values lie between the ends of a span, 0 to 1."""
    ends, shown = np.array(span), np.asarray(values, dtype=float)
    (low, high), shown = (np.log(ends), np.log(shown)) if log else (ends, shown)
    return (shown - low) / (high - low)


def marks(low: float, high: float, *, log: bool) -> list[float]:
    """Values at which an axis is marked: round ones, on an axis in logarithms 1, 2 and 5 times powers of ten."""
    if not log:
        return round_ticks(low, high)
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = (1.0, 2.0, 5.0) if math.log10(high / low) < 2.5 else (1.0,)
    values = [step * 10.0**power for power in powers for step in steps]
    return [value for value in values if low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9)]


def round_ticks(low: float, high: float, most: int = 5) -> list[float]:
    """Round figures within a span, not more than `most`."""
    if not high > low:
        return [low]
    step = nice_below((high - low) / most)
    while (high - low) / step > most:
        step = _next_nice(step)
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [number * step + 0.0 for number in range(first, last + 1)]


def _next_nice(step: float) -> float:
    mantissa = round(step / 10.0 ** math.floor(math.log10(step) + 1e-9))
    return step * (2.5 if mantissa == 2 else 2.0)


def spanned(values: Array, air: float = 0.06, least: float = 0.0) -> tuple[float, float]:
    """The span of values with a little air, never without width."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    width = max(high - low, least, 1e-9 * max(abs(low), abs(high)), 1e-12)
    middle = 0.5 * (low + high)
    return middle - (0.5 + air) * width, middle + (0.5 + air) * width


def dots(x: Array, y: Array, class_: str) -> str:
    """Round dots: lines of no length with round ends, so that many stay one short path."""
    pieces = [f"M{a:.1f},{b:.1f}h0" for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    return element("path", d="".join(pieces), class_=f"dots {class_}")


def course(x: Array, y: Array, class_: str) -> str:
    """A line through points."""
    pieces = [f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    return element("path", d="M" + "L".join(pieces), class_=f"course {class_}") if len(pieces) > 1 else ""


def arrows(starts: Array, ends: Array, class_: str, head: float = 5.0) -> str:
    """Arrows (N, 2) to (N, 2) on the page as one path; one that is too short for a head is a bare line."""
    pieces: list[str] = []
    for (x, y), (u, v) in zip(starts.tolist(), ends.tolist(), strict=True):
        pieces.append(f"M{x:.1f},{y:.1f}L{u:.1f},{v:.1f}")
        length = math.hypot(u - x, v - y)
        if length > 1.5 * head:
            a, b = (u - x) / length * head, (v - y) / length * head
            wings = ((u - a - 0.5 * b, v - b + 0.5 * a), (u - a + 0.5 * b, v - b - 0.5 * a))
            pieces.append(f"M{wings[0][0]:.1f},{wings[0][1]:.1f}L{u:.1f},{v:.1f}L{wings[1][0]:.1f},{wings[1][1]:.1f}")
    return element("path", d="".join(pieces), class_=f"arrows {class_}")


def binned(x: Array, y: Array, bins: int = 12) -> tuple[Array, Array]:
    """Means of y over bins of x that hold equally many readings; one a value where x has few values."""
    values = np.unique(x)
    if len(values) <= bins:
        return values, np.array([float(y[x == value].mean()) for value in values])
    order = np.argsort(x, kind="stable")
    parts: Iterable[NDArray[np.int64]] = np.array_split(order, bins)
    pairs = [(float(x[part].mean()), float(y[part].mean())) for part in parts]
    return np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])
