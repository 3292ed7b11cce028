"""Reading YAML files key by key, so that every mistake names the file and the key.

`load_yaml` turns a file into plain dictionaries and lists; `Mapping` then reads the known keys of one
dictionary and, at its `close()`, refuses what nobody knows, with the nearest known name.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Generator, Iterable, Iterator, Sequence
from collections.abc import Mapping as MappingLike
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any, cast

import yaml

from linkwright.core.units.files import LARGEST_FILE, read_bytes
from linkwright.core.units.names import Known, meant, nearest
from linkwright.core.units.quantities import (
    Bound,
    InputError,
    kind_of,
    read_bound,
    read_number,
    read_quantity,
    read_range,
    shown,
)
from linkwright.core.units.yaml_mistakes import comma_in_number, in_words

_LARGEST_YAML = 8 * 1024 * 1024
_DEEPEST = 60
_QUITE_ALIKE = 0.75
"""How alike a key that is missing and one that nobody knows are, for the one to be told beside the other."""
_MOST_DIGITS = 100
_WHEN = re.compile(r"[12][0-9]{3}(-(0[1-9]|1[0-2])(-(0[1-9]|[12][0-9]|3[01]))?)?")
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader; refuses a key that occurs twice, tags, aliases that explode and nesting without end.

    Plain words mean what YAML 1.2 says: `on`, `y`, dates and `1:30` are text, `012` is 12 and `1e3` is 1000.
    """

    depth = 0
    yaml_implicit_resolvers = {}  # noqa: RUF012 - PyYAML's table, filled once below

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Compose one node; an alias is refused, because a few lines of them can stand for gigabytes."""
        if self.check_event(yaml.AliasEvent):
            raise _refusal("aliases (*name) are not read", self.peek_event().start_mark)
        if getattr(self.peek_event(), "tag", None) is not None:
            raise _refusal("tags (!name) are not read", self.peek_event().start_mark)
        self.depth += 1
        if self.depth > _DEEPEST:
            raise _refusal("nested too deeply", self.peek_event().start_mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_scalar(self, node: yaml.ScalarNode | yaml.MappingNode) -> Any:
        """The text of a scalar; an integer too long for Python is refused with its line."""
        if node.tag.endswith(":int") and isinstance(node.value, str) and len(node.value) > _MOST_DIGITS:
            raise _refusal(f"a number has {len(node.value)} digits", node.start_mark)
        return super().construct_scalar(node)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Construct a mapping with distinct text keys."""
        seen: set[str] = set()
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise _refusal("a key must be plain text", key_node.start_mark)
            if key_node.tag == "tag:yaml.org,2002:merge":
                raise _refusal("merge keys (<<) are not read", key_node.start_mark)
            if key_node.value in seen:
                raise _refusal(f"the key '{key_node.value}' occurs twice", key_node.start_mark)
            seen.add(key_node.value)
            if node.flow_style and value_node.value == "":
                _refuse_comma(key_node)
            # `y`, `on`, `400` or `2024-01-01` as a key is that text, not a boolean, a number or a date.
            key_node.tag = "tag:yaml.org,2002:str"
        return super().construct_mapping(node, deep)

    def construct_sequence(self, node: yaml.SequenceNode, deep: bool = False) -> list[Any]:
        """Construct a list; `[0 mm, 2,5 mm]` is no list of three."""
        for before, item in zip(node.value, node.value[1:], strict=False):
            number = before.tag.endswith((":int", ":float")) and re.search("[1-9]", before.value)
            if node.flow_style and number and item.tag.endswith(":str") and item.style is None:
                _refuse_comma(item)
        return super().construct_sequence(node, deep)


for _tag, _pattern, _first in (
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("merge", r"<<", "<"),
    ("int", r"[-+]?(?:0|[1-9][0-9]*)", "-+0123456789"),
    (
        "float",
        r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
        "-+.0123456789",
    ),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), list(_first))


class _Dumper(yaml.SafeDumper):
    """Quotes what the loader would not read as the same text, and keeps it on one line."""

    yaml_implicit_resolvers = _Loader.yaml_implicit_resolvers

    def represent_str(self, data: str) -> yaml.ScalarNode:
        """What cannot be printed is written by its number."""
        return self.represent_scalar("tag:yaml.org,2002:str", data, None if data.isprintable() else '"')


_Dumper.add_representer(str, _Dumper.represent_str)


def yaml_line(value: object, *, quoted: bool = False) -> str:
    """Return a value as one line of YAML that reads back as it; text is `quoted`, or only where it must be."""
    style = '"' if quoted else None
    lines = yaml.dump(
        [value],
        None,
        _Dumper,
        default_flow_style=True,
        default_style=style,
        width=10**9,
        allow_unicode=True,
        sort_keys=False,
    )
    return lines[1:-2]


def refusal(file: object, key: str, message: str, *remedies: MappingLike[str, Any]) -> InputError:
    """Wrong input, with the settings of recording.yaml of which any would do, said as they are written there."""
    write = f"; write {' or '.join(map(written, remedies))} in recording.yaml" if remedies else ""
    return InputError(file, key, message + write, *remedies)


def written(settings: MappingLike[str, Any]) -> str:
    """Settings as they are written, in a sentence."""
    return " and ".join(f"`{name}: {yaml_line(value)}`" for name, value in settings.items())


def _refuse_comma(node: yaml.Node) -> None:
    if cut := comma_in_number(node):
        raise _refusal(
            f"the comma ends the number in {shown(cut)}; write a decimal point, and thousands without a mark",
            node.start_mark,
        )


def _refusal(problem: str, mark: yaml.Mark) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=mark)


def read_text(path: Path | str, most: int = LARGEST_FILE) -> str:
    """Return the text of a UTF-8 file of at most `most` bytes; raises `InputError` where it is missing, no file
    (see `units.files.read_bytes`), too large or not UTF-8."""
    try:
        return read_bytes(path, most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(path, "", f"is not UTF-8 text (byte {error.start}); save it as UTF-8") from None


def load_json(path: Path | str) -> object:
    """Return what a JSON file holds; raises `InputError` for anything else."""
    try:
        return json.loads(read_text(path))
    except (ValueError, RecursionError):
        raise InputError(path, "", "is not JSON") from None


def parse_yaml(text: str, *, file: object) -> object:
    """Return what the YAML `text` holds; raises `InputError` with the line number where it is not YAML."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        raise InputError(file, "", in_words(error, text)) from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(file, "", f"is not YAML: {shown(str(error))}") from None


def parse_bundled_yaml(text: str) -> object:
    """What a YAML file of the program holds. It is read by the C parser, ten times as fast, which lets pass what
    `parse_yaml` refuses; plain words mean the same, and the tests read the same files by both."""
    fast: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    meaning = {"yaml_implicit_resolvers": _Loader.yaml_implicit_resolvers}
    return yaml.load(text, Loader=cast(Any, type("_OwnLoader", (fast,), meaning)))


def load_yaml(path: Path | str) -> Mapping:
    """Return the mapping that a YAML file holds; raises `InputError` for anything else, always in one line.

    Refused: a missing, unreadable, empty or non-UTF-8 file, a directory, a syntax error (with its line), a
    key that occurs twice, aliases and merge keys, and a file whose top level is not a mapping.
    """
    content = parse_yaml(read_text(path, _LARGEST_YAML), file=path)
    if content is None:
        raise InputError(path, "", "is empty")
    return Mapping(content, file=path)


def shipped_files(package: str, folder: str = "") -> Iterator[Mapping]:
    """The mappings that the YAML files of a package hold, or those of a folder in it, in the order of their names."""
    for item in sorted(files(package).joinpath(folder).iterdir(), key=lambda entry: entry.name):
        if item.name.endswith(".yaml"):
            name = f"{folder or package.rpartition('.')[2]}/{item.name}"
            yield Mapping(parse_bundled_yaml(item.read_text(encoding="utf-8")), file=name)


class Mapping:
    """One mapping of a file, read key by key.

    Each reader remembers its key as known; `close()` (or leaving `with mapping.reading():`) refuses every key
    that no reader asked for. `file` and `key` say where the mapping stands, for messages. A default is
    returned where the key is absent; without one, absence is an `InputError`. `null` counts as absent.
    """

    def __init__(self, content: object, *, file: object, key: str = "") -> None:
        if not isinstance(content, dict):
            raise InputError(file, key, f"needs keys with values (key: value), not {shown(content)}")
        self.content = {str(name): value for name, value in cast(dict[object, object], content).items()}
        self.file = file
        self.key = key
        self._asked: dict[str, None] = {}
        self._synonyms: dict[str, Known] = {}
        self._elsewhere: dict[str, str] = {}

    def path_of(self, name: str) -> str:
        """Return the full key of the entry `name`, such as `chain[2].joint.range`."""
        return f"{self.key}.{name}" if self.key else name

    def error(self, name: str, message: str) -> InputError:
        """Return the error for the entry `name` (or for the mapping itself where `name` is empty)."""
        return InputError(self.file, self.path_of(name) if name else self.key, message)

    def has(self, name: str) -> bool:
        """Tell whether the entry is there (and not null); the key counts as known from then on."""
        self._asked[name] = None
        return self.content.get(name) is not None

    def raw(self, name: str, would_do: str = "a value") -> object:
        """Return the entry as YAML gave it; raises `InputError` where it is missing, saying what would do."""
        if not self.has(name):
            known = {item: self._synonyms.get(item) for item in (*self._asked, name)}
            others = (item for item in self.content if item not in self._asked)
            near = next((item for item in others if meant(item, known, _QUITE_ALIKE) == name), None)
            hint = "" if near is None else f" ('{near}' is not a key known here; did you mean '{name}'?)"
            state = "is empty" if name in self.content else "is missing"
            raise self.error(name, f"{state}; write {would_do}{hint or self._of_this_entry(name)}")
        return self.content[name]

    def _of_this_entry(self, name: str) -> str:
        """What an entry of a list holds alone, for a key that may stand in the one before or after."""
        if not self.key.endswith("]") or name in self.content or len(self.content) > 1:
            return ""
        return f" (this entry holds {''.join(self.content) or 'nothing'} alone; each '- ' begins another)"

    def also_called(self, synonyms: MappingLike[str, tuple[str, ...]]) -> None:
        """Say what people call the entries of some names as well, so that they are told the names known here."""
        self._synonyms.update({name: Known(synonym) for name, synonym in synonyms.items()})

    def elsewhere(self, names: Iterable[str], where: str) -> None:
        """Say where names stand that people may write here; those that are read here are read here."""
        self._elsewhere |= dict.fromkeys(names, where)

    def version(self, known: int) -> None:
        """Refuse another `format_version` than the one that is known."""
        version = self.raw("format_version", f"format_version: {known}")
        if isinstance(version, bool) or version != known:
            message = f"{shown(version)} is not known here; this program reads {known}"
            raise self.error("format_version", message)

    def quantity(self, name: str, kind: str, default: float | None = None) -> float:
        """Return a quantity in SI."""
        if default is not None and not self.has(name):
            return default
        return read_quantity(self.raw(name, _example(kind)), kind, file=self.file, key=self.path_of(name))

    def positive(self, name: str, kind: str) -> float:
        """Return a quantity in SI that is above zero."""
        value = self.quantity(name, kind)
        if value <= 0.0:
            raise self.error(name, f"must be positive, not {shown(self.content[name])}")
        return value

    def not_negative(self, name: str, kind: str, default: float | None = None) -> float:
        """Return a quantity in SI that is not below zero."""
        value = self.quantity(name, kind, default)
        if value < 0.0:
            raise self.error(name, f"cannot be negative, not {shown(self.content[name])}")
        return value

    def optional_quantity(self, name: str, kind: str) -> float | None:
        """Return a quantity in SI, None where it is absent."""
        return self.quantity(name, kind) if self.has(name) else None

    def number(self, name: str, default: float | None = None) -> float:
        """Return a pure, finite number."""
        if default is not None and not self.has(name):
            return default
        return read_number(self.raw(name, "a number"), file=self.file, key=self.path_of(name))

    def integer(self, name: str, default: int | None = None) -> int:
        """Return a whole number."""
        if default is not None and not self.has(name):
            return default
        value = self.raw(name, "a whole number")
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.error(name, f"needs a whole number, not {shown(value)}")
        return int(value)

    def text(self, name: str, default: str | None = None) -> str:
        """Return a text that is not empty; a number or a date in its place is refused (quote it), and so is what a
        terminal would obey (escape sequences)."""
        if default is not None and not self.has(name):
            return default
        value = self.raw(name, "a text")
        if not isinstance(value, str) or not value.strip():
            quoted = f"; write '{value}' in quotes" if isinstance(value, int | float) else ""
            raise self.error(name, f"needs a text, not {shown(value)}{quoted}")
        if result := _CONTROL.search(value):
            raise self.error(name, f"holds the control character {shown(result[0])}; take it out")
        return value

    def when(self, name: str, default: str | None = None) -> str:
        """Return a year, month or day: `2026`, `2026-01`, `2026-01-31`, quoted or not."""
        if default is not None and not self.has(name):
            return default
        value = self.raw(name, "a year, month or day, e.g. 2026-01")
        if isinstance(value, bool) or not _WHEN.fullmatch(str(value)):
            raise self.error(name, f"is a year, month or day, e.g. 2026-01, not {shown(value)}")
        return str(value)

    def boolean(self, name: str, default: bool | None = None) -> bool:
        """Return true or false."""
        if default is not None and not self.has(name):
            return default
        value = self.raw(name, "true or false")
        if not isinstance(value, bool):
            raise self.error(name, f"needs true or false, not {shown(value)}")
        return value

    def choice(self, name: str, choices: Collection[str], default: str | None = None) -> str:
        """Return one of the names in `choices`: those, or what they stand for by name (see `units.names.meant`)."""
        if default is not None and not self.has(name):
            return default
        value = self.raw(name, f"one of {', '.join(choices)}")
        if not isinstance(value, str) or value not in choices:
            hint = nearest(value, choices) if isinstance(value, str) and meant(value, choices) is not None else ""
            raise self.error(name, f"{shown(value)} is not one of {', '.join(choices)}{hint}")
        return value

    def items(self, name: str, default: Sequence[object] | None = None, would_do: str = "") -> list[object]:
        """Return a list; a single value in its place is refused."""
        if default is not None and not self.has(name):
            return list(default)
        value = self.raw(name, would_do or "a list, e.g. [a, b]")
        if not isinstance(value, list):
            written = would_do or f"a list, e.g. [{value if isinstance(value, str) else 'a, b'}]"
            raise self.error(name, f"needs {written}, not {shown(value)}")
        return cast(list[object], value)

    def mapping(self, name: str) -> Mapping:
        """Return the mapping under `name`."""
        return Mapping(self.raw(name, f"{name}: with its own keys and values"), file=self.file, key=self.path_of(name))

    def mappings(self, name: str) -> list[Mapping]:
        """Return the list of mappings under `name`, their keys numbered from 1."""
        entries = enumerate(self.items(name, would_do="a list of entries that each begin with '- '"), start=1)
        path = self.path_of(name)
        return [Mapping(entry, file=self.file, key=f"{path}[{number}]") for number, entry in entries]

    def bound(self, name: str, kind: str) -> Bound:
        """Return a limit such as `<= 26 kg`."""
        return read_bound(self.raw(name, "a limit"), kind, file=self.file, key=self.path_of(name))

    def range(self, name: str, kind: str) -> tuple[float, float]:
        """Return `[low, high]` in SI."""
        return read_range(self.raw(name, "a range [low, high]"), kind, file=self.file, key=self.path_of(name))

    def vector(self, name: str, kind: str, length: int | None = None) -> tuple[float, ...]:
        """Return `length` quantities of one kind (None: however many), in SI."""
        example = kind_of(kind).example
        values = self.items(name, would_do=f"a list, e.g. [{', '.join([example] * (length or 2))}]")
        if length not in (None, len(values)):
            raise self.error(name, f"needs {length} values, not {len(values)}")
        path = self.path_of(name)
        return tuple(
            read_quantity(value, kind, file=self.file, key=f"{path}[{number}]")
            for number, value in enumerate(values, start=1)
        )

    def close(self, *also_known: str) -> None:
        """Refuse the keys that nobody asked for; `also_known` names keys that are read elsewhere."""
        known = {name: self._synonyms.get(name) for name in (*self._asked, *also_known)}
        for name in self.content:
            if name not in known:
                hint = f"; {self._elsewhere[name]}" if name in self._elsewhere else nearest(name, known)
                raise self.error("", f"unknown key '{name}'{hint}")

    @contextmanager
    def reading(self, *also_known: str) -> Generator[Mapping]:
        """Read inside `with`; at its end the keys that nobody asked for are refused."""
        yield self
        self.close(*also_known)


def _example(kind: str) -> str:
    return f"e.g. '{kind_of(kind).example}'"
