"""The words of a diagnosis: places, parameters with their intervals, what cannot be distinguished."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from types import MappingProxyType
from typing import Protocol

from linkwright.core.arm.effects import EFFECTS, parameter_title
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import (
    HALF,
    Alternative,
    Covered,
    Detectable,
    Diagnosis,
    Finding,
    FittedParameter,
    NextPose,
    WrittenArm,
)
from linkwright.core.units.lists import listed
from linkwright.core.units.quantities import format_quantity
from linkwright.results.document import Cell, Value, amount, share
from linkwright.results.figures_in_words import effect_title, figure, percent, with_unit

MOST_PARAMETERS = 6


class Fitted(Protocol):
    """What was identified: an effect by its id, the joints or links where it acts (from 1), and its parameters."""

    @property
    def effect(self) -> str:
        """Its id."""
        ...

    @property
    def at(self) -> tuple[int, ...]:
        """Joints or links."""
        ...

    @property
    def parameters(self) -> tuple[FittedParameter, ...]:
        """Their values."""
        ...


VERDICTS = (
    ("none", "nothing missing", "nothing missing that this recording could show"),
    ("named", "named", "named"),
    ("alias_class", "one of several", "one of several that the data cannot tell apart"),
    ("unknown", "not explained", "nothing in the library explains it"),
    ("insufficient_data", "cannot say", "the recording cannot say"),
)


def verdict_words(verdict: str, *, short: bool = False) -> str:
    """A verdict as a phrase, or in two words."""
    return next((brief if short else full for name, brief, full in VERDICTS if name == verdict), verdict)


_SAME = 1e-3
"""The share of what the fit promises by which a written arm may differ without a word."""


def written_differs(written: WrittenArm | None) -> bool:
    """Whether a written arm is not what the fit promises, so that a reader must know both."""
    return written is not None and (bool(written.lacks) or not written.keeps(_SAME))


def place_words(effect: str, at: Sequence[int]) -> str:
    """Where an effect acts: `joint 2`, `links 1 and 3`; nothing for base, tip and what acts everywhere."""
    if not at:
        return ""
    place = EFFECTS[effect].place if effect in EFFECTS else "joint"
    place = place if place in ("joint", "link") else "joint"
    return f"{place}{'s' if len(at) > 1 else ''} {listed([str(number) for number in at])}"


def effect_words(effect: str, at: Sequence[int], recording: str = "") -> str:
    """An effect with its place: `compliance of the drives (joint 2)`; of several recordings, in which alone."""
    place = ", ".join(item for item in (place_words(effect, at), f"in {recording} alone" if recording else "") if item)
    return f"{effect_title(effect)} ({place})" if place else effect_title(effect)


def name_words(result: Finding | Alternative) -> str:
    """The findings, or what it may as well be, with its place, and of several recordings in which alone."""
    return effect_words(result.effect, result.at, result.recording)


def main_parameters(finding: Fitted) -> tuple[tuple[FittedParameter, ...], str]:
    """The parameters of a finding to show (of many coefficients the clearest), and words for those left out."""
    if len(finding.parameters) <= MOST_PARAMETERS:
        return finding.parameters, ""

    def clear(fitted: FittedParameter) -> float:
        low, high = fitted.interval
        return abs(fitted.value) / (high - low) if high > low else 0.0

    shown = sorted(finding.parameters, key=clear, reverse=True)[:MOST_PARAMETERS]
    return tuple(shown), f"and {len(finding.parameters) - MOST_PARAMETERS} more (in diagnosis.json)"


def quantity(value: float, kind: str, digits: int = 3, like: float | None = None) -> str:
    """A figure with its unit; `like` chooses the unit by another figure. A dash where it is not known."""
    if not math.isfinite(value):
        return "–"
    unit = None
    if like is not None and math.isfinite(like):
        unit = format_quantity(like, kind).partition(" ")[2] or None
    written = format_quantity(value, kind, unit, digits) if value else f"0 {unit or ''}".strip()
    return written.replace("-", "−").replace("*", "·").replace("^2", "²")


def value(fitted: FittedParameter) -> Value:
    """A fitted value with its unit."""
    return Value(quantity(fitted.value, fitted.kind, fitted.digits, fitted.largest))


def interval(fitted: FittedParameter) -> Value:
    """The 95 % interval, in the unit of the value."""
    if not all(math.isfinite(end) for end in fitted.interval):
        return Value("–")
    low, high = (quantity(end, fitted.kind, fitted.digits, fitted.largest) for end in fitted.alone)
    number, _, unit = low.partition(" ")
    return Value(f"{number} to {high}" if high.partition(" ")[2] == unit else f"{low} to {high}")


def measured(fitted: FittedParameter) -> Value:
    """The value with its 95 % interval beside it."""
    single, ends = value(fitted), interval(fitted)
    number, _, unit = single.text.partition(" ")
    return Value(f"{number} ({ends.text.removesuffix(unit).strip()}) {unit}".strip())


def probability(p: float) -> Value:
    """A probability, without false precision."""
    return Value("–" if math.isnan(p) else "< 0.0001" if p < 1e-4 else figure(p, 2))


def portion(ratio: float) -> Value:
    """A share as a percentage, never below zero; a dash where it is not known."""
    return share(ratio if math.isnan(ratio) else max(0.0, ratio))


def covered(each: Covered) -> Value:
    """A figure of a standard with its unit; 1 m/N is 1000 mm/N."""
    return amount(1e3 * each.value, "mm/N" if each.symbol == "C" else "mm", 3)


def next_pose_words(each: NextPose) -> tuple[str, str]:
    """Payload and side of a pose worth recording."""
    payload = "as in the arm file" if each.payload_mass is None else with_unit(each.payload_mass, "kg")
    side = {1: "from below (+1)", -1: "from above (−1)"}.get(each.side, "either")
    return payload, side


def parameter_meaning(fitted: FittedParameter, effect: str) -> str:
    """A parameter's meaning and where it acts."""
    known = EFFECTS[effect].parameters if effect in EFFECTS else ()
    plain = parameter_title(effect, fitted.parameter)
    meaning = next((item.meaning for item in known if item.name == fitted.parameter), plain)
    place = place_words(effect, fitted.at)
    return f"{meaning}, {place}" if place else meaning


def parameter_rows(finding: Fitted, name: str, rest: Sequence[Cell]) -> list[list[Cell]]:
    """The rows of a finding in a table: its `name`, parameter, meaning, value and 95 % interval, and the `rest`; of
    several parameters the first row alone has name and rest."""
    blank: list[Cell] = [""] * len(rest)
    if not finding.parameters:
        return [[name, "", "", "", "", *rest]]
    parameters, further = main_parameters(finding)
    rows: list[list[Cell]] = []
    for index, fitted in enumerate(parameters):
        place = place_words(finding.effect, fitted.at) if fitted.at != finding.at else ""
        title = f"{parameter_title(finding.effect, fitted.parameter)} {place}".strip()
        shown = Value(f"{value(fitted).text} (at its bound)") if fitted.at_bound else value(fitted)
        first: list[Cell] = ["" if index else name, title, parameter_meaning(fitted, finding.effect)]
        rows.append([*first, shown, interval(fitted), *(blank if index else rest)])
    return [*rows, ["", further, "", "", "", *blank]] if further else rows


def explained_share(diagnosis: Diagnosis) -> float | None:
    """The share of the mismatch's sum of squares that the findings explain; None where there was nothing."""
    if diagnosis.unknown is not None or not diagnosis.findings or diagnosis.rms_before <= 0.0:
        return None
    return max(0.0, 1.0 - (diagnosis.rms_after / diagnosis.rms_before) ** 2)


COVARIATES = (
    ("position", "where the tip is"),
    ("time", "time"),
    ("payload_kg", "the payload"),
    ("temperature_degC", "the temperature"),
)


def covariate_words(name: str) -> str:
    """A covariate in words: `q2` is joint 2's coordinate, `dir2` the side from which it came."""
    known = dict(COVARIATES)
    if name in known:
        return known[name]
    for prefix, words in (("q", "the coordinate of joint {}"), ("dir", "the side that joint {} came from")):
        if name.startswith(prefix) and name[len(prefix) :].isdigit():
            return words.format(name[len(prefix) :])
    return name.replace("_", " ")


DIRECTIONS = (
    ("radial", "mostly towards the base or away from it (radially)"),
    ("tangential", "mostly around the base (tangentially)"),
    ("vertical", "mostly up or down (vertically)"),
    ("mixed", "in no one direction"),
)


def where_sentences(diagnosis: Diagnosis) -> list[str]:
    """Where the mismatch sits: joint, direction, what it depends on, since when."""
    where = diagnosis.where
    sentences: list[str] = []
    if where.joint is not None and (share := where.share) is not None:
        could = f"could describe {percent(share)} of it"
        sentences.append(
            f"The mismatch sits at joint {where.joint}: its motion alone {could}."
            if share >= HALF
            else f"The mismatch sits at no single joint: motion of joint {where.joint} alone, where most of what is "
            f"described sits, {could}."
        )
    if where.direction and diagnosis.describes_most:
        words = dict(DIRECTIONS).get(where.direction, f"mostly {where.direction}")
        sentences.append(f"The tip is displaced {words}.")
    if where.depends_on:
        sentences.append(f"The mismatch depends on {listed([covariate_words(name) for name in where.depends_on])}.")
    if where.since is not None:
        sentences.append(f"It is there since {time_words(where.since)} into the recording.")
    return sentences


def time_words(seconds: float) -> str:
    """A time in s, and in minutes or hours where that reads better."""
    if abs(seconds) < 120.0:
        return with_unit(seconds, "s", 3)
    if abs(seconds) < 7200.0:
        return f"{with_unit(seconds, 's', 5)} ({with_unit(seconds / 60.0, 'min', 3)})"
    return f"{with_unit(seconds, 's', 6)} ({with_unit(seconds / 3600.0, 'h', 3)})"


_PER_HOUR = MappingProxyType({"speed": (1e6, "um/h"), "angular_speed": (1e6, "urad/h")})


def detectable_words(detectable: Detectable) -> str:
    """The smallest value of the effect's parameter that would have been found; drifts by the hour."""
    if detectable.kind in _PER_HOUR:
        factor, unit = _PER_HOUR[detectable.kind]
        return with_unit(3600.0 * factor * detectable.value, unit, 3)
    return quantity(detectable.value, detectable.kind)


def least_visible(diagnosis: Diagnosis) -> list[Detectable]:
    """Of each effect that can be seen at all, the place where its parameter must be largest to be found."""
    by_effect: dict[str, Detectable] = {}
    for item in diagnosis.detectable:
        known = by_effect.get(item.effect)
        more = known is None or (item.kind == known.kind and item.value > known.value)
        if item.visible > 0.0 and more:
            by_effect[item.effect] = item
    return list(by_effect.values())


def spoken(sentence: str) -> str:
    """A sentence with the names of parameters and the units as people write them."""
    return re.sub(r"(?<=[a-z])_(?=[a-z])", " ", sentence).replace("*", "·").replace("^2", "²")


def row_words(recording: Recording, row: int) -> str:
    """A reading by its number in `row`: `row 5`, or of several recordings `row 5 of august.csv`."""
    index, place = recording.place_of(row)
    name = recording.names[index]
    return f"row {place}" + (f" of {name}" if name else "")


def whole_sentence(words: str) -> str:
    """Words that begin with a capital and end with a full stop."""
    return f"{words[:1].upper()}{words[1:]}" + ("" if words.endswith((".", "!", "?")) else ".")
