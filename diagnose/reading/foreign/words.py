"""What other programs call their columns: of which joint, what of it, in which unit.

Sources of names: sensor_msgs/JointState (ROS), PlotJuggler's and `rostopic echo -p`'s exports, UR's RTDE guide
(`actual_q`, `actual_current`), ur_msgs/RobotStateRTMsg (`q_actual`, `i_actual`), libfranka's RobotState (`q`, `tau_J`),
KUKA's RSI (`AIPos.A1`), MuJoCo's mjdata.h (`qpos`, `qvel`, `qfrc_actuator`), LeRobotDataset.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

_KINDS = MappingProxyType(
    {
        "v": frozenset(
            {
                *("velocity", "velocities", "vel", "speed", "speeds", "qd", "dq", "qdot", "qvel", "omega"),
                *("geschwindigkeit", "velocidad", "velocita", "vitesse", "predkosc", "velocidade", "snelheid"),
                *("rychlost", "hastighet"),
            }
        ),
        "tau": frozenset(
            {
                *("effort", "efforts", "eff", "torque", "torques", "tau", "moment", "moments", "drehmoment", "qfrc"),
                *("par", "coppia", "couple", "koppel", "vridmoment", "binario"),
            }
        ),
        "a": frozenset({"acceleration", "accelerations", "acc", "accel", "qdd", "ddq", "qacc"}),
        "q": frozenset(
            {
                *("position", "positions", "pos", "q", "qpos", "angle", "angles", "theta", "th", "coordinate"),
                *("winkel", "angulo", "angolo", "kat", "hoek", "uhel", "vinkel", "posicion", "posizione", "posicao"),
                *("pozycja", "positie", "poloha"),
            }
        ),
        "current": frozenset(
            {"current", "currents", "i", "strom", "corriente", "corrente", "courant", "prad", "stroom", "proud"}
        ),
        "j": frozenset({"secondary", "output", "abs", "absolute"}),
    }
)
"""Words by what they say, as `_words` gives them, in the order in which they are believed: a `current position` is a
position."""
_JOINT_WORDS = frozenset(
    {
        *("joint", "joints", "axis", "axes", "enc", "encoder", "motor", "actuator", "servo", "drive", "robax", "rax"),
        *("achse", "gelenk"),
    }
)
_JOINTS_ABROAD = frozenset(
    {
        *("eje", "articulacion", "asse", "giunto", "axe", "articulation", "os", "przegub", "eixo", "articulacao"),
        *("junta", "gewricht", "osa", "kloub", "axel"),
    }
)
"""The same in languages of which few other words are known: beside what is not known they leave it to units."""
_PLAIN = frozenset(
    {
        *("actual", "act", "ist", "measured", "meas", "state", "states", "observation", "feedback", "fb", "raw"),
        *("gemessen", "medido", "medida", "misurato", "misurata", "mesure", "mesuree", "reel", "reelle"),
        *("zmierzony", "zmierzona", "gemeten", "uppmatt"),
    }
)
_FILLING = frozenset(
    {
        *("filtered", "value", "values", "data", "robot", "arm", "field", "j", "a", "as", "present"),
        *("de", "del", "della", "der", "des", "du", "do", "da", "van"),
    }
)
_COMMANDS = frozenset(
    {
        *("target", "command", "commanded", "cmd", "desired", "reference", "ref", "setpoint", "goal", "action", "d"),
        *("soll", "consigne", "consigna", "comando", "objetivo", "obiettivo", "zadany", "zadana"),
    }
)
_OF_SOMETHING_ELSE = frozenset(
    {
        *("error", "err", "lag", "deviation", "residual", "offset", "limit", "fehler", "abweichung", "grenze"),
        *("erreur", "ecart", "limite", "errore", "scarto", "desviacion", "residuo", "blad", "fel", "fout"),
    }
)
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+|[^\W\d_]+")
_LETTERS = str.maketrans({"ł": "l", "Ł": "L", "ø": "o", "Ø": "O"})
"""Letters that no accent makes."""
_ELIDED = re.compile(r"\b(?:d|l|dell)['’]", re.IGNORECASE)
_BY_LABEL = re.compile(r"(?P<of>.+)/(?P<label>[^/]+)/(?P<what>position|velocity|effort)")
_OF_A_FEATURE = re.compile(
    r"(?:observation\.(?P<feature>[a-z_]+)|action)"
    r"(?:/(?P<label>[^/]+?)(?:\.(?P<what>pos|vel|position|velocity|effort|torque|current))?|\[(?P<k>[0-9]{1,2})\])"
)
_OF_A_MESSAGE = re.compile(
    r"(?P<of>(?:.*[./])?)(?P<what>position|velocity|effort|name)s?(?:\[(?P<k>[0-9]{1,2})\]|[._/]?(?P<l>[0-9]{1,2}))"
)
_NUMBERED = re.compile(r"(.*?)[\[( ._/-]*([0-9]{1,2})[\])]?([^0-9]*)")
_NAMED_BEHIND = re.compile(
    r"(?P<head>.*?[A-Za-z])[ _.-]?(?P<k>[0-9]{1,2})[ _.-]+(?P<name>[^\W\d_][^\d\[(]*?)(?P<unit>\s*[\[(][^\])]*[\])])?"
)
_COMPUTED = re.compile(r"(?:actual|target)[_ ]TCP[_ ].*|O_T_EE.*|.*(?:tcp_pose|current_pose|fk_).*", re.IGNORECASE)
_OF_RSI = MappingProxyType({"AIPos": "position", "ASPos": "setpoint position", "MACur": "current"})
_WAYS = MappingProxyType(
    {
        "UR's RTDE": re.compile(r"(?:actual|target)_(?:q|qd|current)_?\[?[0-9]\]?"),
        "ur_msgs": re.compile(r"(?:.*[./])?(?:q|qd|i)_(?:actual|target)\[?[0-9]\]?"),
        "MuJoCo": re.compile(r"(?:.*[./])?q(?:pos|vel|acc|frc_actuator)_?\[?[0-9]{1,2}\]?"),
        "libfranka": re.compile(r"(?:d?q|q_d|tau_J)\[[0-9]\]"),
        "KUKA's RSI": re.compile(r"(?:AIPos|ASPos|MACur)\b.*"),
        "ROS": re.compile(r".+/(?:position|velocity|effort)/[^/]+"),
    }
)
"""Ways of writing headers that tell units."""


@dataclass(frozen=True)
class Said:
    """What a header says: `base` of our columns (q, v, tau, ..), the joint by `number` (as the header counts) or by
    `label`, whose it is (`of`: a topic, words that nobody knows), and the program whose way of writing it is (`by`,
    which tells the unit), empty where it could be anybody's. The higher its `rank`, the plainer it is."""

    base: str
    of: str
    number: int | None = None
    label: str = ""
    by: str = ""
    rank: int = 0


def unknown_words(header: str) -> bool:
    """Whether a header of a joint has none of our words for joints, which would have been understood, nor one for what
    is neither a coordinate, a speed nor a torque."""
    return not _words(header) & (_JOINT_WORDS | _OF_SOMETHING_ELSE)


def without_number(name: str) -> tuple[str, int | None]:
    """A header's words with a sign in the place of its number, and the number; None where there is none."""
    parsed = _NUMBERED.fullmatch(name)
    return (name, None) if parsed is None else (f"{parsed[1].strip()} # {parsed[3].strip()}".lower(), int(parsed[2]))


def computed(header: str) -> bool:
    """Whether a header is of a place that a controller computes of its joint angles: no measurement of the tip."""
    return _COMPUTED.fullmatch(header) is not None


def said_by(header: str, names: Sequence[str]) -> Said | None:
    """What a header says of a joint; None where it says nothing of one. `names` are those of the arm's joints."""
    parsed = _BY_LABEL.fullmatch(header)
    if parsed is not None:
        base = _base({parsed["what"], *(_COMMANDS & _words(parsed["of"]))}, plain=False)
        return None if base is None else Said(base, parsed["of"], None, parsed["label"], "ROS", 2)
    parsed = _OF_A_FEATURE.fullmatch(header)
    if parsed is not None:
        feature = parsed["feature"] or ""
        what = parsed["what"] or "pos" if feature in ("", "state") else feature
        base = _base({*_words(what), *(() if feature else ("action",))}, plain=False)
        return None if base is None else Said(base, "", _number(parsed["k"]), parsed["label"] or "", "", 2)
    parsed = _OF_A_MESSAGE.fullmatch(header)
    if parsed is not None and parsed["what"] != "name":
        base = _base({parsed["what"], *(_COMMANDS & _words(parsed["of"]))}, plain=False)
        number = _number(parsed["k"] or parsed["l"])
        by = "ROS" if parsed["of"] or parsed["k"] else ""
        return None if base is None else Said(base, parsed["of"], number, "", by, 2)
    name = next((item for item in sorted(names, key=len, reverse=True) if _holds(header, item)), "")
    if name:
        rest = re.sub(rf"(?<![A-Za-z0-9]){re.escape(name)}(?![A-Za-z0-9])", " ", header, count=1, flags=re.IGNORECASE)
        return _by_words(rest, None, name, header)
    numbered = _NUMBERED.fullmatch(header)
    return None if numbered is None else _by_words(f"{numbered[1]} {numbered[3]}", int(numbered[2]), "", header)


def without_names(headers: Sequence[str]) -> dict[str, str]:
    """The headers less what stands behind the number of one joint alone (`J1 base [deg]`, `J2 shoulder [deg]`): where
    headers begin alike, what differs from number to number is what somebody calls that joint, and what is the same says
    what was measured of each."""
    parsed = {header: match for header in headers if (match := _NAMED_BEHIND.fullmatch(header)) is not None}
    numbers: dict[tuple[str, str], set[str]] = {}
    for match in parsed.values():
        numbers.setdefault((match["head"], match["name"].lower()), set()).add(match["k"])
    known = _known_words()
    plain: dict[str, str] = {}
    for header in headers:
        match = parsed.get(header)
        plain[header] = header
        if match is None or _words(match["name"]) & known:
            continue
        others = {name for head, name in numbers if head == match["head"]}
        if len(others) > 1 and len(numbers[match["head"], match["name"].lower()]) == 1:
            plain[header] = f"{match['head']}{match['k']}{match['unit']}"
    return plain


def _known_words() -> frozenset[str]:
    return frozenset().union(*_KINDS.values()) | _JOINT_WORDS | _JOINTS_ABROAD | _PLAIN | _FILLING | _COMMANDS


def commanded(header: str) -> bool:
    """Whether a header says that it is of what was told, not of what came of it."""
    return bool(_words(header) & _COMMANDS)


def message_name(header: str) -> tuple[str, int] | None:
    """The message and the number that a column of names is of (`/joint_states.name[0]`), None for any other column."""
    parsed = _OF_A_MESSAGE.fullmatch(header)
    return (parsed["of"], int(parsed["k"] or parsed["l"])) if parsed is not None and parsed["what"] == "name" else None


def _by_words(rest: str, number: int | None, label: str, header: str) -> Said | None:
    rest = rest.rstrip(" /")
    for word, plain in _OF_RSI.items():
        rest = rest.replace(word, plain)
    path, _, leaf = rest.rpartition("/")
    known = _known_words()
    listed = _listed(leaf)
    which = 2 if len(listed) > 1 and listed[0] in ("robot", "arm") and listed[1].isdecimal() else 0
    first = next((place for place, item in enumerate(listed) if place >= which and item in known), len(listed))
    words = frozenset(listed[first:])
    if not words <= known or (first and (number is None or not words & (_KINDS["q"] | _KINDS["v"] | _KINDS["tau"]))):
        return None
    whole = words & (_JOINT_WORDS | _JOINTS_ABROAD | {"state", "action"})
    base = _base(words, plain=bool(whole or label) or (bool(words) and words <= {"j", "a"}))
    if base is None:
        return None
    by = next((way for way, pattern in _WAYS.items() if pattern.fullmatch(header)), "")
    rank = 2 * bool(words & _PLAIN) + ("theta" not in words)
    return Said(base, " ".join([*path.strip(" /.").split(), *listed[:first]]), number, label, by, rank)


def _base(words: set[str] | frozenset[str], *, plain: bool) -> str | None:
    """The base of our columns that words say; `plain` words of a joint alone are its coordinate."""
    kind = next((base for base, kind_words in _KINDS.items() if words & kind_words), "q" if plain else None)
    if not words & _COMMANDS:
        return kind
    return "c" if kind in ("q", None) and (plain or kind) else None


def _number(text: str | None) -> int | None:
    return None if text is None else int(text)


def _words(text: str) -> frozenset[str]:
    return frozenset(_listed(text))


def _listed(text: str) -> list[str]:
    """The words of a text in small letters without accents and articles, in its order."""
    plain = unicodedata.normalize("NFKD", _ELIDED.sub(" ", text.translate(_LETTERS)))
    return [item.lower() for item in _WORD.findall("".join(c for c in plain if not unicodedata.combining(c)))]


def _holds(header: str, name: str) -> bool:
    whole = rf"(?<![A-Za-z0-9]){re.escape(name)}(?![A-Za-z0-9])"
    return bool(name) and re.search(whole, header, re.IGNORECASE) is not None
