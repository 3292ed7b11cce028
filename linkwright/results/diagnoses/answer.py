"""The answer of a diagnosis on one screen: a sentence of at most thirty words, and what to do, columns by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import MappingProxyType

from linkwright.core.arm.assumptions import default_gravity
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import Condition, Effect
from linkwright.core.arm.errors.unknown_mass import weighs_nothing
from linkwright.core.diagnose.answer.sentences import WEIGHTLESS, chief, put_right, said_of_no_weight
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Diagnosis, Finding, FittedParameter, Left
from linkwright.core.units.lists import listed
from linkwright.results.figures_in_words import figure, from_to, mm

from .words import covariate_words, name_words, portion, value

SAME = 1.0 - 1e-9
"""Likeness; what is so alike is one thing, not two that these poses hardly tell."""
MOST_WORDS = 30
"""A longer answer is not read on a first screen."""

_COLUMNS: MappingProxyType[Condition, str] = MappingProxyType(
    {
        "time": "time_s",
        "warming": "temperature_degC",
        "sides": "dirN",
        "velocities": "vN_deg_s",
        "accelerations": "time_s and vN_deg_s",
        "loaded_for": "time_s",
        "commanded": "cN_deg",
    }
)
"""What a recording's column is called that gives an effect what it requires; N is the joint's number."""


def answer(diagnosis: Diagnosis) -> str:
    """The answer in at most `MOST_WORDS` words: the largest cause, where it sits, and its share of the mismatch."""
    clauses = _clauses(diagnosis)
    if said_of_no_weight(diagnosis.arm, diagnosis.verdict):
        clauses = [WEIGHTLESS, f". {capital(clauses[0])}", *clauses[1:]]
    return briefly(clauses)


def briefly(clauses: Sequence[str]) -> str:
    """What must be said first, and of what may follow as much as there is room for in `MOST_WORDS` words."""
    sentence = clauses[0]
    for clause in clauses[1:]:
        # What follows belongs to what stands before it: after a clause without room there is no further one.
        if len((sentence + clause).split()) > MOST_WORDS:
            break
        sentence += clause
    words = sentence.split()
    cut = sentence if len(words) <= MOST_WORDS else " ".join(words[: MOST_WORDS - 1]).rstrip(",;") + " …"
    return f"{capital(cut)}."


def capital(words: str) -> str:
    """Words that begin a sentence."""
    return f"{words[:1].upper()}{words[1:]}"


def _clauses(diagnosis: Diagnosis) -> list[str]:
    """What must be said first, and what may follow as far as there is room."""
    mismatch, left = mm(diagnosis.rms_before, 3), mm(diagnosis.rms_after, 3)
    if diagnosis.verdict == "insufficient_data":
        return [diagnosis.sentence.removesuffix(".")]
    if diagnosis.verdict == "none" and diagnosis.labels is None:
        return [_nothing(diagnosis, mismatch)]
    if diagnosis.other_arms is not None:
        leaves = mm(diagnosis.other_arms.leaves, 3)
        return [
            f"the recordings look as if they were of different arms: lasting sizes of each one's own leave {leaves}"
        ]
    if diagnosis.labels is not None:
        return [f"it looks as if {diagnosis.labels.said}", f"; then {put_right(diagnosis.labels)}"]
    largest = _largest(diagnosis)
    if diagnosis.unknown is not None:
        on = [covariate_words(name) for name in diagnosis.unknown.depends_on[:3]]
        opening = f"nothing in the library explains {mm(diagnosis.unknown.amplitude, 3)} of the {mismatch} mismatch"
        explained = "" if largest is None else f". {capital(name_words(largest))} describes part of the rest"
        return [opening, f". It depends on {listed(on)}" if on else "", explained]
    if largest is None:
        return [diagnosis.sentence]
    return _cause(diagnosis, largest, mismatch, left)


def _nothing(diagnosis: Diagnosis, mismatch: str) -> str:
    """That nothing is named, and what is left."""
    if diagnosis.scatter is not None:
        times = figure(diagnosis.scatter, 2)
        return f"Visits scatter by {times} times the noise floor, {mismatch} RMS, and nothing explains it"
    over = _over(diagnosis.left) or "scatter"
    if diagnosis.unexplained:
        return f"More than noise, {mismatch} RMS, {over}, and nothing explains it beyond chance"
    plain = diagnosis.left.floor is None or diagnosis.left.is_noise
    rest = f"the {mismatch} that remain are {over}" if plain else f"{mismatch} remain, {over}"
    return f"Nothing is missing that this recording could show: {rest}"


def _cause(diagnosis: Diagnosis, largest: Finding, mismatch: str, left: str) -> list[str]:
    """The largest cause with its share, and what remains."""
    name = name_words(largest)
    others = [name_words(alternative) for alternative in largest.alternatives[:1]]
    more = len(largest.alternatives) - 1
    either = f" or {others[0]}{f' or {more} more' if more > 0 else ''}" if others else ""
    few = f" or {len(largest.alternatives)} like it" if others else ""
    size = "" if others or not largest.parameters else f", {_size(chief(largest.parameters))}"
    part = _share_of_first(diagnosis)
    does = "" if part is None else f" ({portion(part).text} of the mismatch)"
    rest = len(diagnosis.findings) - 1
    smaller = f" and {rest} smaller {'cause' if rest == 1 else 'causes'}" if rest else ""
    over = _over(diagnosis.left)
    floor = f", {over}" if over else ""
    change = f". Error {from_to(mismatch, left)}"
    opening = f"found: {name}{either}{size}{does}{smaller}"
    if len(f"{opening}{change}".split()) > MOST_WORDS:
        # That there is a further cause, and what remains, matter more than what else the first may be called.
        opening = f"found: {name}{few}{size}{does}{smaller}"
    return [opening, change, floor]


def _size(fitted: FittedParameter) -> str:
    return f"{fitted.parameter.replace('_', ' ')} {value(fitted).text}"


def _over(left: Left) -> str:
    """What is left beside the noise floor; nothing where nobody knows that."""
    if left.floor is None:
        return ""
    if left.is_noise:
        return "the noise floor"
    if left.fits:
        return f"{figure(left.times_held_out, 2)} times the noise floor where not fitted"
    return f"{figure(left.times, 2)} times the noise floor"


def _largest(diagnosis: Diagnosis) -> Finding | None:
    return max(diagnosis.findings, key=lambda finding: finding.rms_explained, default=None)


def _share_of_first(diagnosis: Diagnosis) -> float | None:
    """The share of the mismatch's sum of squares that the largest finding explains by itself: the first rung that has
    it."""
    if len(diagnosis.ladder) < 2 or diagnosis.ladder[0].rms <= 0.0:
        return None
    return max(0.0, 1.0 - (diagnosis.ladder[1].rms / diagnosis.ladder[0].rms) ** 2)


def gravity_guessed(diagnosis: Diagnosis) -> str:
    """That a mismatch was searched for causes under a weight whose direction nobody gave; empty elsewhere."""
    masses = diagnosis.recording.payload_mass
    carries = diagnosis.arm.payload.mass > 0.0 or (masses is not None and bool(masses.any()))
    nothing = diagnosis.verdict in ("none", "insufficient_data") or (weighs_nothing(diagnosis.arm) and not carries)
    said = [] if nothing else default_gravity(diagnosis.arm)
    return f"{capital(said[0])}. What sags under weights cannot be told while that is wrong." if said else ""


def to_do(diagnosis: Diagnosis) -> tuple[str, ...]:
    """What to do next, the most useful first; columns of a recording by their names."""
    lines: list[str] = []
    if gravity_guessed(diagnosis):
        lines.append("Write where gravity acts into the arm file (`gravity`), and diagnose again.")
    if said_of_no_weight(diagnosis.arm, diagnosis.verdict):
        lines.append("Write the links' masses into the arm file, or `mass: unknown` at each, and diagnose again.")
    if diagnosis.labels is not None:
        lines.append(f"Look whether {diagnosis.labels.said}. Correct the recording, and diagnose again.")
    if diagnosis.other_arms is not None:
        return ("Diagnose each recording by itself. For several arms of one type, use --units.",)
    logged = _to_log(diagnosis)
    if logged:
        named = listed([_with_meaning(item) for item in logged])
        lines.append(f"Log {named}: that may tell apart what this recording cannot.")
    lines += _one_geometry(diagnosis)
    if diagnosis.noise_floor is None:
        lines.append("Read some poses twice in a row: repeats say how much of the mismatch is noise.")
    if diagnosis.unknown is not None and diagnosis.unknown.decide:
        lines.append(f"To find the cause, {diagnosis.unknown.decide}.")
    if diagnosis.next_poses:
        number = len(diagnosis.next_poses)
        purpose = "which tell" if diagnosis.next_poses_enough else "each several times, which helps to tell"
        lines.append(f"Record the {number} poses listed below, {purpose} the names apart, and diagnose again.")
    helps = diagnosis.written is None or diagnosis.written.rms < diagnosis.rms_before
    sure = any(not finding.may_be_nothing for finding in diagnosis.findings)
    if diagnosis.unknown is None and sure and helps:
        whose = "these recordings" if diagnosis.recordings else "this recording"
        promised = "" if diagnosis.written is None else f" (it leaves {mm(diagnosis.written.rms, 3)} of {whose})"
        lines.append(f"Use arm.yaml, the arm with what was found in it{promised}, in evaluate, optimize, compensate.")
    return tuple(lines)


def _to_log(diagnosis: Diagnosis) -> list[str]:
    """The columns that would tell a finding from what the data cannot tell it from, as this recording lacks them."""
    names: dict[str, None] = {}
    for finding in diagnosis.findings:
        for other in finding.alternatives:
            for column in _telling(diagnosis.recording, (finding.effect, finding.at), (other.effect, other.at)):
                names.setdefault(column)
    if diagnosis.unknown is not None and "time" in diagnosis.unknown.depends_on:
        names.update(dict.fromkeys(_lacking(diagnosis.recording, "warming", ())))
    return list(names)


def _with_meaning(column: str) -> str:
    """A column by its name; one of a joint with what it holds, which a letter alone does not say."""
    joint = column[1:].partition("_")[0]
    if not joint.isdigit() or column[0] not in "cj":
        return column
    what = f"what joint {joint} was told to reach" if column[0] == "c" else f"an encoder on joint {joint} itself"
    return f"{column} ({what})"


def _telling(
    recording: Recording, one: tuple[str, tuple[int, ...]], other: tuple[str, tuple[int, ...]]
) -> Iterable[str]:
    if one[0] not in EFFECTS or other[0] not in EFFECTS:
        return
    first, second = EFFECTS[one[0]], EFFECTS[other[0]]
    # A joint's number stands in the column's name.
    at = next((places for effect, places in ((first, one[1]), (second, other[1])) if effect.place == "joint"), ())
    if first.drive.before_encoder != second.drive.before_encoder and recording.commanded is None:
        yield from (f"c{number}_deg" for number in at)
    elif _turns_a_joint(first) != _turns_a_joint(second) and recording.joint_side is None:
        yield from (f"j{number}_deg" for number in at)
    if (first.place == "base") != (second.place == "base") and recording.base_target is None:
        yield "basex_mm, basey_mm"
    for condition in sorted(set(first.requires) ^ set(second.requires)):
        yield from _lacking(recording, condition, at)


def _turns_a_joint(effect: Effect) -> bool:
    """Whether an encoder on the joint sees what an effect does there."""
    return effect.place == "joint" and not effect.drive.across


def _one_geometry(diagnosis: Diagnosis) -> list[str]:
    """Findings of geometry with another that does the same at all poses, as sentences: no reading tells these apart."""
    return [
        f"{capital(name_words(finding))} and {name_words(other)} are the same geometrically here: correct either."
        for finding in diagnosis.findings
        for other in finding.alternatives
        if other.likeness > SAME and {_cause_of(finding.effect), _cause_of(other.effect)} == {"geometry"}
    ]


def _cause_of(effect: str) -> str:
    return EFFECTS[effect].cause if effect in EFFECTS else ""


def _lacking(recording: Recording, condition: Condition, at: Sequence[int]) -> Iterable[str]:
    held = {
        "time": recording.time,
        "warming": recording.temperature if recording.temperature is not None else recording.link_temperature,
        "sides": recording.sides,
        "velocities": recording.velocity,
        "accelerations": recording.acceleration,
        "loaded_for": recording.time,
        "commanded": recording.commanded,
    }
    if held.get(condition, recording.q) is None and condition in _COLUMNS:
        name = _COLUMNS[condition]
        yield from [name.replace("N", str(number)) for number in at] if "N" in name and at else [name]
