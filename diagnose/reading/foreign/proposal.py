"""What the columns of a foreign file may mean for an arm, and the recording.yaml that says so."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.columns import canonical, looks_like_ours, otherwise_spelled, units_for
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.sections.numeric import Array
from linkwright.core.units.reading import yaml_line

from .any_language import joint_columns
from .clock import clock_of, counted_in, has_stamps
from .header_units import alone_in_unit, name_and_unit, unit_of
from .words import Said, commanded, computed, message_name, said_by, without_names

OTHER = "other"
"""A column of somebody's own: kept, as something that the error may depend on."""
IGNORED = "ignored"
_WHOLE = ("x", "y", "z", "payload", "temperature", "time", "fx", "fy", "fz", "qw", "qx", "qy", "qz")
_PLACES = ("x", "y", "z")
_BARE = ("dir", "qw", "qx", "qy", "qz")
_OF_JOINTS = ("q", "dir", "tau", "current", "voltage", "v", "c", "j")
_PLACE = re.compile(
    r"^(?:tcp|tip|tool|ee|end[\s_-]?effector|pos(?:ition)?|meas(?:ured)?|tracker|laser|point|p)?[\s_.-]*([xyz])$"
)
_LETTER = re.compile(
    r"^(?:.*[\s_.-])?([xyz])(?:[\s_.-]+(?:ist|act|actual|meas|measured|gemessen|mesur[ée]e?|r[ée]el|medid[oa]|"
    r"misurat[oa]|zmierzon[aey]|gemeten|uppmätt))?$",
    re.IGNORECASE,
)
_OF_A_POSE = re.compile(r".*(?:pose|point|transform|target)[./](?:position|translation)?[./]?([xyz])$", re.IGNORECASE)
_WORDS = MappingProxyType(
    {
        "payload": re.compile(
            r"^(payload|load|mass|weight|last|masse|gewicht|traglast|nutzlast|zuladung|charge|poids|carga|masa|peso|"
            r"carico|massa|obciążenie|ładunek|belasting|zátěž)(?: mass| [uú]tile?)?([/.]data)?$"
        ),
        "temperature": re.compile(r"^(temp|temperature?|température|temperatura|t[\s_-]?amb|ambient)([\s_/.].*)?$"),
        "z": re.compile(r"^(height|höhe|hoehe|hauteur|altura|altezza)$"),
        "time": re.compile(r"^(t|time|timestamp|elapsed|zeit|temps|tiempo|tempo|clock)$"),
    }
)
_OF_A_PART = re.compile(r"(?!.*(?:amb|air|room|hall|data))[^\W_]+[\s_/.-].+", re.IGNORECASE)
"""A temperature that need not be that of the room."""
_SIDE = re.compile(
    r"^(?:dir|direction|direcci[oó]n|richtung|side|approach)[\s_.-]*(?:joint|axis|achse|j|q)?[\s_.-]*([0-9]{1,2})$"
)
_TURN = 2.0 * math.pi * 1.05
"""No joint in radians is read beyond."""
_METRES = 20.0
"""No arm in metres reaches farther."""
_KNOWN_UNITS = MappingProxyType({"KUKA's RSI": "deg"})
"""Units of angles of programs that do not write radians."""


@dataclass(frozen=True)
class Meaning:
    """What a column is taken for: one of ours (`q1`, `x`), OTHER or IGNORED; in a unit, `guessed` where its header has
    none. It is `formula` of the file's columns (the header alone where empty) times `factor`, and `zero` added, in its
    unit; `said` is what people should know of it. `rival` is another column that tells of the same joint as plainly.
    `series`: a guess that rests on a whole series, one for each joint, the only one in its unit or of signs."""

    header: str
    what: str
    unit: str = ""
    guessed: bool = False
    formula: str = ""
    said: str = ""
    rival: str = ""
    factor: float = 1.0
    zero: float = 0.0
    series: bool = False

    @property
    def plain(self) -> bool:
        """Whether it is one of ours beyond doubt."""
        return self.named and (self.series or not self.guessed)

    @property
    def made_of(self) -> str:
        """The formula that makes it of the file's columns."""
        made = self.formula or _quoted(self.header)
        if self.factor != 1.0:
            made = f"{self.factor:.12g}*{f'({made})' if self.formula else made}"
        return f"{made} {'+' if self.zero > 0.0 else '-'} {abs(self.zero):.12g}" if self.zero else made

    @property
    def as_it_is(self) -> bool:
        """Whether it is the file's column, under our header, unchanged."""
        return self.ours == self.header and not self.formula and self.factor == 1.0 and not self.zero

    @property
    def ours(self) -> str:
        """Our header for it: `q1_rad`."""
        return f"{self.what}_{self.unit}" if self.unit else self.what

    @property
    def named(self) -> bool:
        """Whether it is one of ours."""
        return self.what not in (OTHER, IGNORED)


def known_names(arm: Arm) -> tuple[str, ...]:
    """What a column of a recording of this arm can be."""
    first, *others = ([f"{base}{n}" for n in range(1, arm.size + 1)] for base in _OF_JOINTS)
    return (*first, *_WHOLE, *(name for names in others for name in names))


def units_of(what: str, arm: Arm) -> tuple[str, ...]:
    """The units that a column can be in; none for a side or a part of a quaternion."""
    parsed = re.fullmatch(r"([a-z]+)([0-9]+)?", what)
    if parsed is None or what in (OTHER, IGNORED) or parsed[1] in _BARE:
        return ()
    return units_for(parsed[1], arm, None if parsed[2] is None else int(parsed[2]) - 1)


def proposed(table: Table, arm: Arm) -> tuple[Meaning, ...]:
    """A meaning for each column, none twice."""
    plain = without_names(table.names)
    by_header = {header: _of(header, plain[header], table, arm) for header in table.names}
    left = {header: plain[header] for header in table.names if not by_header[header].named}
    by_header |= _of_joints(left, table, arm, {item.what for item in by_header.values()})
    by_header |= _places_left(by_header, arm)
    by_header |= _in_any_language(by_header, table, arm)
    by_header |= _alone_in_unit(by_header, table.names)
    if not any(item.what == "time" for item in by_header.values()):
        by_header |= {item.header: item for item in _clock(table, by_header)}
    return _none_twice([by_header[header] for header in table.names])


def _alone_in_unit(meanings: Mapping[str, Meaning], names: Sequence[str]) -> dict[str, Meaning]:
    """Columns that nothing but their unit says, which no other has."""
    known = {item.what for item in meanings.values()}
    return {
        header: Meaning(header, what, unit, guessed=True, said=f"by its unit, the only one in {unit}")
        for what, (header, unit) in alone_in_unit(names).items()
        if what not in known and meanings[header] == Meaning(header, OTHER) and not commanded(header)
    }


def _none_twice(meanings: Sequence[Meaning]) -> tuple[Meaning, ...]:
    """The same with the first of each kind alone, and what goes together in one file."""
    firsts: dict[str, Meaning] = {}
    for item in meanings:
        if item.named:
            firsts.setdefault(item.what, item)
    once = [item if not item.named or firsts[item.what] is item else Meaning(item.header, OTHER) for item in meanings]
    if any(item.what in _PLACES for item in once):
        # Currents and voltages are of motion logs alone.
        once = [
            replace(item, what=OTHER, unit="") if item.what.startswith(("current", "voltage")) else item
            for item in once
        ]
    if not any(re.fullmatch(r"q[0-9]+", item.what) for item in once):
        # Encoders on the joints themselves (J1) are what a file without others tells the coordinates by.
        once = [replace(item, what=re.sub(r"^j(?=[0-9])", "q", item.what)) for item in once]
    return tuple(once)


def is_motion(meanings: Sequence[Meaning]) -> bool:
    """Whether columns are those of a motion log: a clock, torques, currents or voltages, and nothing of the tip."""
    named = {meaning.what for meaning in meanings}
    drives = any(re.fullmatch(r"(?:tau|current|voltage)[0-9]+", item) for item in named)
    return drives and "time" in named and not named & set(_PLACES)


def _of(header: str, plain: str, table: Table, arm: Arm) -> Meaning:
    """What a header, `plain` without a joint's name, says by itself: one of ours however it is spelled, a place, a
    side, a payload."""
    ours = plain if looks_like_ours(plain) else otherwise_spelled(plain)
    if ours is not None and looks_like_ours(ours):
        what, _, unit = canonical(ours).partition("_")
        if what in known_names(arm) and (not units_of(what, arm) or unit in units_of(what, arm)):
            return Meaning(header, what, unit)
    if computed(header):
        return Meaning(header, OTHER, said="is computed by the controller of its joint angles, not measured")
    name, unit = name_and_unit(header)
    what = _named(name.strip().lower(), arm)
    units = units_of(what, arm)
    if what == OTHER or not units:
        return Meaning(header, what)
    if _OF_A_POSE.fullmatch(name):
        return Meaning(header, what, "m", said="m, as ROS has it")
    unit_known = unit_of(what, unit)
    if unit_known in units:
        part = what == "temperature" and _OF_A_PART.fullmatch(name) is not None
        return Meaning(header, what, unit_known, guessed=part, said="by its first word" if part else "")
    if what == "time" and has_stamps(table, header):
        return Meaning(header, what, "s", said="time stamps")
    guess = (counted_in(table.numbers(header)) or units[0]) if what == "time" else _guessed(table, header, units)
    return Meaning(header, what, guess, guessed=True, said="by the size of its numbers")


def _places_left(meanings: Mapping[str, Meaning], arm: Arm) -> dict[str, Meaning]:
    """A component of the tip that no header says plainly, by the only one that has its letter and a unit of length
    (`Spitze X [mm]`), and is of nothing that was told or computed."""
    taken = {item.what for item in meanings.values()}
    of_letter: dict[str, list[Meaning]] = defaultdict(list)
    for header, meaning in meanings.items():
        name, unit = name_and_unit(header)
        letter = _LETTER.match(name)
        if letter is None or meaning.named or commanded(name) or computed(header):
            continue
        what = letter[1].lower()
        unit_known = unit_of(what, unit)
        if what not in taken and unit_known in units_of(what, arm):
            of_letter[what].append(Meaning(header, what, unit_known, said=f"the only column of {what}"))
    return {items[0].header: items[0] for items in of_letter.values() if len(items) == 1}


def _in_any_language(meanings: Mapping[str, Meaning], table: Table, arm: Arm) -> dict[str, Meaning]:
    """Columns of joints whose words nobody knows, each a guess."""
    headers = [key for key, item in meanings.items() if item == Meaning(key, OTHER) and not commanded(key)]
    taken = {item.what for item in meanings.values()}
    guesses: dict[str, Meaning] = {}
    for header, (what, unit, why) in joint_columns(headers, table, arm, taken).items():
        units = units_of(what, arm)
        series = bool(unit) or not units
        guesses[header] = Meaning(
            header, what, unit or (_guessed(table, header, units) if units else ""), True, said=why, series=series
        )
    return guesses


def _named(name: str, arm: Arm) -> str:
    side = _SIDE.match(name)
    if side is not None and 1 <= int(side[1]) <= arm.size:
        return f"dir{int(side[1])}"
    place = _PLACE.match(name) or _OF_A_POSE.fullmatch(name)
    if place is not None:
        return place[1].lower()
    bare = name.rpartition("/")[2] if name.endswith(("/payload", "/temperature")) else name.strip("/")
    return next((word for word, pattern in _WORDS.items() if pattern.match(bare)), OTHER)


def _of_joints(headers: Mapping[str, str], table: Table, arm: Arm, taken: set[str]) -> dict[str, Meaning]:
    """What headers, each with itself less a joint's name, say of joints: of all that tell of the same, those that
    tell of most joints, plainest."""
    ranked = sorted(_groups(headers, table, arm), key=lambda group: group.rank, reverse=True)
    meanings: dict[str, Meaning] = {}
    home = next((group.of for group in ranked if group.base == "q"), "")
    for base in _OF_JOINTS:
        same_base = [group for group in ranked if group.base == base]
        same_base.sort(key=lambda group: (group.of == home, group.rank), reverse=True)
        if not same_base:
            continue
        first, *others = same_base
        if not first.of or first.of == home or "/" in first.of:  # else somebody's words before it, and no joint's
            free = {joint: header for joint, header in first.at.items() if f"{base}{joint + 1}" not in taken}
            meanings |= _in_units(first, free, table, arm)
        if base == "q" and others and others[0].rank[:2] == first.rank[:2]:
            for joint, header in others[0].at.items():
                rival = first.at.get(joint, next(iter(first.at.values())))
                meaning = f"tells of the same joint as {rival}: two robots in one file?"
                meanings[header] = Meaning(header, OTHER, said=meaning, rival=rival)
    return meanings


@dataclass(frozen=True)
class _Group:
    """Headers that tell of one thing (`base`) of joints in one way (`of`): what each means and its unit, and which is
    of which joint (`at`, from 0)."""

    base: str
    of: str
    rank: tuple[int, int, int]
    at: dict[int, str]
    meanings: dict[str, Said]
    units: dict[str, str]


def _groups(headers: Mapping[str, str], table: Table, arm: Arm) -> list[_Group]:
    """The headers that say something of joints, by what and how; rank goes by how many joints, how plainly, and
    which came first."""
    names = [joint.name for joint in arm.joints]
    labels = {key: table.text(item, 0) for item in table.names if (key := message_name(item)) is not None}
    groups: dict[tuple[str, str, int], dict[str, Said]] = defaultdict(dict)
    for header, plain in headers.items():
        meaning = said_by(name_and_unit(plain)[0], names) if not computed(header) else None
        if meaning is not None:
            if meaning.number is not None and (meaning.of, meaning.number) in labels:
                meaning = replace(meaning, label=labels[meaning.of, meaning.number], number=None)
            groups[meaning.base, meaning.of, meaning.rank][header] = meaning
    zero_based = {of for (_, of, _), group in groups.items() if any(item.number == 0 for item in group.values())}
    made: list[_Group] = []
    for (base, of, rank), meanings in groups.items():
        at = _numbered(meanings, arm, zero=of in zero_based)
        units = {header: name_and_unit(headers[header])[1] for header in meanings}
        made.append(_Group(base, of, (len(at), rank, -len(made)), at, meanings, units))
    return made


def _numbered(group: Mapping[str, Said], arm: Arm, *, zero: bool) -> dict[int, str]:
    """The headers of a group by joint (from 0): by the joints' names, by number, or in order where names are others."""
    by_name = {joint.name.casefold(): k for k, joint in enumerate(arm.joints) if joint.name}
    headers: dict[int, str] = {}
    strange: list[str] = []
    for header, said in group.items():
        if said.number is not None:
            joint = said.number - (0 if zero else 1)
            if 0 <= joint < arm.size:
                headers.setdefault(joint, header)
            continue
        label = said.label.casefold()
        ends = [k for name, k in by_name.items() if label.endswith(f"_{name}") or name.endswith(f"_{label}")]
        if label in by_name:
            headers[by_name[label]] = header
        elif len(ends) == 1:
            headers.setdefault(ends[0], header)
        else:
            strange.append(header)
    if not headers and len(strange) == arm.size:
        return dict(enumerate(strange))
    return headers


def _in_units(group: _Group, at: Mapping[int, str], table: Table, arm: Arm) -> dict[str, Meaning]:
    """The columns of one kind with their units: as the header has it, as its program writes it, or by the numbers."""
    base, meanings = group.base, dict[str, Meaning]()
    guess = _by_ranges(base, at, table, arm)
    unnamed = [joint.name for joint in arm.joints if joint.name]
    for joint, header in at.items():
        what = f"{base}{joint + 1}"
        can_be = units_for(base, arm, joint)
        unit_known = unit_of(what, group.units[header])
        meaning = group.meanings[header]
        strange = bool(meaning.label) and not any(
            item.casefold() in meaning.label.casefold() or meaning.label.casefold() in item.casefold()
            for item in unnamed
        )
        order = f"joint {joint + 1} by its place: the arm has no joint {meaning.label}" if strange else ""
        if unit_known in can_be:
            meanings[header] = Meaning(header, what, unit_known, said=order)
        elif meaning.by:
            unit = _usual(can_be, _KNOWN_UNITS.get(meaning.by, "rad"))
            meanings[header] = Meaning(header, what, unit, said=order or f"{unit}, as {meaning.by} has it")
        elif guess is not None and arm.joints[joint].revolute and len(can_be) > 1:
            unit = _usual(can_be, guess[0])
            meanings[header] = Meaning(header, what, unit, guessed=True, said=order or guess[1])
        else:
            unit = _guessed(table, header, can_be) if base in ("q", "c", "j") else _usual(can_be, "m")
            guessed = len(can_be) > 1
            meanings[header] = Meaning(
                header, what, unit, guessed, said=order or ("by the size of its numbers" if guessed else "")
            )
    return meanings


def _usual(units: Sequence[str], of_angles: str) -> str:
    """The unit of those that a program with radians (or degrees) and metres writes."""
    return next((unit for unit in units if unit.split("_")[0] in (of_angles, "m")), units[0])


def _by_ranges(base: str, at: Mapping[int, str], table: Table, arm: Arm) -> tuple[str, str] | None:
    """Radians or degrees, for all columns of a kind alike, and why: beyond a turn, or beyond the joints' ranges."""
    turning = [(joint, header) for joint, header in at.items() if arm.joints[joint].revolute]
    if base not in ("q", "c", "j", "v") or not turning:
        return None
    if max(_largest(table, header) for _, header in turning) > _TURN:
        return "deg", "by the size of its numbers"
    if base == "v":
        return "rad", "by the size of its numbers"
    beyond = [
        joint for joint, header in turning if _share_beyond(table.numbers(header), *arm.joints[joint].range) > 0.5
    ]
    if beyond:
        return "deg", f"as radians joint {beyond[0] + 1} would be beyond its range"
    return "rad", "by the size of its numbers, which are within the joints' ranges"


def _largest(table: Table, header: str) -> float:
    numbers = table.numbers(header)
    return float(np.max(np.abs(numbers[np.isfinite(numbers)]), initial=0.0))


def _share_beyond(numbers: Array, low: float, high: float) -> float:
    there = numbers[np.isfinite(numbers)]
    slack = 0.1 * (high - low)
    return float(np.mean((there < low - slack) | (there > high + slack))) if len(there) else 0.0


def _guessed(table: Table, header: str, units: Sequence[str]) -> str:
    """The unit that the numbers can be in, where the header has none: by their size."""
    largest = _largest(table, header)
    if "rad" in units and largest <= _TURN:
        return "rad"
    if "m" in units and "mm" in units:
        return "m" if largest <= _METRES else "mm"
    return units[0]


def _clock(table: Table, meanings: Mapping[str, Meaning]) -> list[Meaning]:
    """The clock of a file that has none by our names."""
    of = next((meaning.header for meaning in meanings.values() if re.fullmatch(r"q[0-9]+", meaning.what)), "")
    clock = clock_of(table, of)
    if clock is None:
        return []
    return [Meaning(clock.header, "time", clock.unit, clock.guessed, clock.formula, clock.said)]


def settings_text(meanings: Sequence[Meaning], extra: Mapping[str, object], *, comments: bool = False) -> str:
    """The recording.yaml that says so; `extra` are further keys, empty ones left out. `comments`: what is a guess is
    said beside it."""
    lines = [f"{name}: {yaml_line(_number(name, value))}" for name, value in extra.items() if value != ""]
    if any(meaning.named and not meaning.as_it_is for meaning in meanings):
        lines.append("columns:")
        lines += [
            f"  {meaning.ours}: {yaml_line(meaning.made_of, quoted=True)}" + (_comment(meaning) if comments else "")
            for meaning in meanings
            if meaning.named
        ]
    ignored = [meaning.header for meaning in meanings if meaning.what == IGNORED]
    if ignored:
        lines.append("ignore: [" + ", ".join(yaml_line(header, quoted=True) for header in ignored) + "]")
    return "\n".join(lines) + "\n"


def _comment(meaning: Meaning) -> str:
    comment = f"a guess {meaning.said}".strip() if meaning.guessed else meaning.said
    return f"  # {' '.join(comment.split())}" if comment.isprintable() and comment else ""


def _number(name: str, value: object) -> object:
    """A setting that is a number as one; what is none is left for the reader to refuse."""
    number = name == "skip_rows" and isinstance(value, str) and value.isascii() and value.isdecimal()
    return int(str(value)) if number and len(str(value)) < 10 else value


def _quoted(header: str) -> str:
    return header if "`" in header else f"`{header}`"
