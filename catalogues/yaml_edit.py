"""Changes to a YAML text by ruamel.yaml's round trip; comments, order, quotes and the spelling of the rest stay.

ruamel.yaml keeps keys, lists and comments, but not how each value is written: it would respell numbers and lay lists in
brackets out anew. So it is shown the text with a stand-in for each value, and the values are put back as they were
written. Then the new text is read, and must hold what the old one held with just those changes, or it is refused.
"""

from __future__ import annotations

import io
import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType
from typing import Any, TypeAlias, cast

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import CommentMark, YAMLError
from ruamel.yaml.nodes import ScalarNode
from ruamel.yaml.resolver import VersionedResolver
from ruamel.yaml.scalarstring import FoldedScalarString, LiteralScalarString, PlainScalarString
from ruamel.yaml.tokens import CommentToken

from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import parse_yaml, yaml_line

Place: TypeAlias = Sequence[str | int]
"""A path into the text: the keys of mappings and the numbers (from 0) of entries of lists on the way."""

_FIRST = 0xF0000
_STAND_IN = re.compile("( ?)([\U000f0000-\U0010ffff])\ue000*")
"""A character for private use, which says which value it stands for, filled up to the value's length."""


class _Words(VersionedResolver):
    """Every plain word is text, keys too, as to `units.reading`."""

    versioned_resolver: Mapping[Any, Any] = MappingProxyType({})  # pyright: ignore[reportIncompatibleMethodOverride]


class YamlText:
    """The text of one YAML file whose top level is a mapping, and changes to it.

    `data` is what it holds, `file` is for messages. Raises `InputError` for a text that is not such YAML.
    """

    def __init__(self, text: str, *, file: object) -> None:
        self.file = file
        content = parse_yaml(text, file=file)
        if not isinstance(content, dict):
            raise InputError(file, "", "needs keys with values at its top level")
        self.data: dict[str, Any] = cast(dict[str, Any], content)
        self._text: str | None = text
        self._newline = "\r\n" if "\r\n" in text else "\n"
        self._values: list[str] = []
        if re.search("[\ue000\U000f0000-\U0010ffff]", text):
            raise InputError(file, "", "cannot be edited in place: it has characters for private use")
        self._yaml: Any = YAML(pure=True)
        self._yaml.Resolver = _Words
        self._yaml.preserve_quotes = True
        self._yaml.width = 10**6
        self._yaml.indent(mapping=2, sequence=4, offset=2)
        self._yaml.explicit_start = re.search("^---", text, re.MULTILINE) is not None
        self._top: Any = CommentedSeq([self._loaded(text.replace("\r\n", "\n"))])

    @property
    def text(self) -> str:
        """The text so far. Raises `InputError` where it would not hold the old content with just the changes."""
        if self._text is None:
            stream = io.StringIO()
            self._yaml.dump(self._top[0], stream)
            text = _STAND_IN.sub(self._as_written, stream.getvalue())
            now: object = None
            with suppress(InputError):
                now = parse_yaml(text, file=self.file)
            if json.dumps(now) != json.dumps(self.data):
                raise InputError(self.file, "", "cannot be changed without touching the rest; edit it by hand")
            self._text = text.replace("\n", self._newline)
        return self._text

    def get(self, path: Place) -> Any:
        """Return the value at a path, None where there is none."""
        value: Any = self.data
        for key in path:
            if isinstance(value, list) and isinstance(key, int):
                entries = cast(list[Any], value)
                value = entries[key] if 0 <= key < len(entries) else None
            elif isinstance(value, dict) and key in value:
                value = cast(dict[Any, Any], value)[key]
            else:
                return None
        return value

    def set(self, path: Place, value: Any, *, block: bool = False) -> None:
        """Set the value at a path; keys that are missing on the way are put at the end of their mapping.

        A new value is written on one line (`{value: 1 GPa}`), with `block` as lines of its own where its mapping is
        written so. Raises `InputError` where something on the way is no mapping.
        """
        while len(path) > 1 and isinstance(path[-1], str) and self.get(path[:-1]) is None:
            path, value = path[:-1], {path[-1]: value}
        held, holder = self._at(path[:-1], type(path[-1]))
        key = path[-1]
        fresh = isinstance(key, str) and key not in held
        if isinstance(key, int) and not 0 <= key < len(held):
            raise InputError(self.file, shown_path(path), "is not there")
        if not fresh and not block and isinstance(holder[key], PlainScalarString):
            number = ord(holder[key][0]) - _FIRST
            blanks = re.match(" *", self._values[number])
            self._values[number] = (blanks[0] if blanks else "") + yaml_line(value)
            held[key] = value
            return
        place = self._item(path[:-1]) if fresh else (holder, key)
        after = self._cut(*place)
        if not fresh:
            _cut_head(*place)
        if block and not held and len(path) > 1:
            holder.fa.set_block_style()
        holder[key] = self._lines(value) if block else self._stand_in(yaml_line(value))
        held[key] = value
        self._paste(*place, after)

    def append(self, path: Place, *values: Any) -> None:
        """Put entries at the end of the list at a path, written as the list is: on lines of their own, or inline.

        Raises `InputError` where there is no list.
        """
        held, holder = self._at(path, int)
        after = self._cut(*self._item(path))
        if values and not held:
            holder.fa.set_block_style()
        holder.extend(self._lines(value, rows=True) for value in values)
        held.extend(values)
        self._paste(*self._item(path), after)

    def extend(self, path: Place, more: Mapping[str, Any]) -> None:
        """Put keys at the end of a mapping, each on lines of its own."""
        for key, value in more.items():
            self.set([*path, key], value, block=True)

    def remove(self, path: Place) -> None:
        """Take a key and its value, or an entry of a list, away; comments before and after it stay.

        Raises `InputError` for no such key.
        """
        held, holder = self._at(path[:-1], type(path[-1]))
        keys: list[Any] = list(held) if isinstance(held, dict) else list(range(len(held)))
        if path[-1] not in keys:
            raise InputError(self.file, shown_path(path), "is not there")
        before = keys.index(path[-1]) - 1
        after = self._cut(holder, path[-1])
        del holder[path[-1]], held[path[-1]]
        if before >= 0:
            self._paste(holder, keys[before], after)
        else:
            outer, at = self._item(path[:-1])
            if not held:
                outer[at] = self._stand_in(yaml_line(held))
            self._paste(outer, at, _cut_head(outer, at) + after, within=False)

    def _at(self, path: Place, kind: type) -> tuple[Any, Any]:
        """The mapping (`kind` is str) or list (int) at a path: what it holds, and what is written."""
        held = self.get(path)
        if not isinstance(held, dict if kind is str else list):
            raise InputError(self.file, shown_path(path), "holds no keys of its own" if kind is str else "is no list")
        self._text = None
        holder, key = self._item(path)
        return cast(Any, held), holder[key]

    def _item(self, path: Place) -> tuple[Any, Any]:
        """What the value at a path stands in, and under which key; values in brackets on the way are opened."""
        holder, at = self._top, 0
        for key in (*path, None):
            if isinstance(holder[at], str):
                holder[at] = self._loaded(_STAND_IN.sub(self._as_written, holder[at]), part=True)
            if key is not None:
                holder, at = holder[at], key
        return holder, at

    def _loaded(self, text: str, *, part: bool = False) -> Any:
        """The text as the round trip has it, a stand-in for each value."""
        try:
            for start, end in reversed(list(_values(text, self._yaml.compose(text)))):
                begin = start
                while text[begin - 2 : begin] == "  ":
                    begin -= 1
                start = begin if text[begin - 2 : begin] in (": ", "- ") else start
                stand_in = self._stand_in(text[start:end])
                text = text[:start] + (stand_in if end > start else f" {stand_in}") + text[end:]
            if part and re.search(r"(^|\s)#", text):
                raise InputError(self.file, "", "has comments inside brackets, which would be lost; edit it by hand")
            return self._yaml.load(text)
        except YAMLError as error:
            raise InputError(self.file, "", f"cannot be edited in place: {shown(str(error))}") from None

    def _stand_in(self, text: str) -> str:
        """A word for a value as it is written; as long, so that comments behind it keep their distance."""
        if _FIRST + len(self._values) > sys.maxunicode:
            raise InputError(self.file, "", "is too large to be edited in place")
        self._values.append(text)
        return PlainScalarString(chr(_FIRST + len(self._values) - 1).ljust(len(text), "\ue000"))

    def _as_written(self, match: re.Match[str]) -> str:
        text = self._values[ord(match[2]) - _FIRST]
        return match[1] + text if text else ""

    def _lines(self, value: Any, *, rows: bool = False) -> Any:
        """A mapping as lines, one a key; anything else, and what is inside, on one line, `rows` one line each."""
        if not isinstance(value, dict) or not value:
            return self._stand_in(yaml_line(value))
        made = CommentedMap()
        for key, inner in cast(dict[str, Any], value).items():
            entries = cast(list[Any], inner) if isinstance(inner, list) else []
            if rows and entries and all(isinstance(entry, list) for entry in entries):
                made[key] = CommentedSeq([self._stand_in(yaml_line(entry)) for entry in entries])
            else:
                made[key] = self._stand_in(yaml_line(inner))
        return made

    def _cut(self, holder: Any, key: Any) -> str:
        """Take the lines of comments and blanks that follow a value off it."""
        holder, key, slot = _last(holder, key)
        comments: list[Any] = holder.ca.items.get(key) or [None] * 4
        token = comments[slot]
        if token is None:
            return ""
        if isinstance(holder[key], _LINES):
            kept, after = "", " " * token.start_mark.column + token.value
        else:
            kept, _, after = token.value.partition("\n")
        token.value = f"{kept}\n"
        comments[slot] = token if kept else None
        return after

    def _paste(self, holder: Any, key: Any, lines: str, *, within: bool = True) -> None:
        """Put such lines behind a value, or, not `within` it, before its first line."""
        if not lines:
            return
        if within:
            holder, key, _ = _last(holder, key)
        slot = 2 if isinstance(holder, CommentedMap) else 0
        comments: list[Any] = holder.ca.items.setdefault(key, [None] * 4)
        before = comments[slot].value.removesuffix("\n") if comments[slot] is not None else ""
        whole = lines if isinstance(holder[key], _LINES) and not before else f"{before}\n{lines}"
        column = comments[slot].start_mark.column if before else 0
        comments[slot] = CommentToken(whole, CommentMark(column), None)


_LINES = (LiteralScalarString, FoldedScalarString)


def _values(text: str, node: Any, *, key: Any = None) -> Iterator[tuple[int, int]]:
    """Where the values stand: what is in brackets as a whole but at the top, and words but for those in lines."""
    start, end = node.start_mark.index, node.end_mark.index
    if isinstance(node, ScalarNode):
        if start == end and isinstance(key, ScalarNode):  # nothing stands right behind its key's colon
            start = end = text.find(":", key.end_mark.index) + 1
            if text[key.end_mark.index : end].strip() != ":":
                raise YAMLError(f"{key.value} has no colon")
        if node.style not in ("|", ">"):
            yield start, end
    elif node.flow_style and key is not None:
        yield start, end
    else:
        for child in node.value:
            inner_key, inner = child if isinstance(child, tuple) else (node, child)
            yield from _values(text, inner, key=inner_key)


def _cut_head(holder: Any, key: Any) -> str:
    """Take the lines of comments between a key and the first line of what it holds off it."""
    comments = holder.ca.items.get(key) or [None] * 4
    tokens, comments[3] = comments[3] or (), None
    return "".join(" " * token.start_mark.column + token.value for token in tokens)


def _last(holder: Any, key: Any) -> tuple[Any, Any, int]:
    """Where the last word of a value stands: in what, under which key, and where comments behind it are kept."""
    while isinstance(holder[key], CommentedMap | CommentedSeq) and holder[key] and not holder[key].fa.flow_style():
        holder = holder[key]
        key = next(reversed(holder)) if isinstance(holder, CommentedMap) else len(holder) - 1
    return holder, key, 2 if isinstance(holder, CommentedMap) else 0


def shown_path(path: Place) -> str:
    """A path for messages: `tables[2].rows[14]`, entries counted from 1."""
    parts = "".join(f"[{key + 1}]" if isinstance(key, int) else f".{key}" for key in path)
    return parts.removeprefix(".")
