"""Changing one value in a YAML text and leaving every other character of it alone: comments, order, quotes, spacing.

ruamel.yaml tells where each key and value stands; the change is a splice between those places. Then the text is read
again and must hold what it held before with just that change, or it is refused.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias, cast

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from materials.quantities import InputError
from materials.reading import parse_yaml

Pair = tuple[Node, Node]

Place: TypeAlias = Sequence[str | int]
"""A path into the text: the keys of mappings and the numbers (from 0) of entries of lists on the way."""


class YamlText:
    """The text of one YAML file whose top level is a mapping, and changes to it.

    `text` is the text so far, `data` what it holds. `file` is for messages. Raises `InputError` for a text that is not
    such YAML.
    """

    def __init__(self, text: str, *, file: object) -> None:
        self.text = text
        self.file = file
        content = parse_yaml(text, file=file)
        if not isinstance(content, dict):
            raise InputError(file, "", "needs keys with values at its top level")
        self.data: dict[str, Any] = cast(dict[str, Any], content)
        self._newline = "\r\n" if "\r\n" in text else "\n"

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
        if isinstance(path[-1], int):
            self._set_entry(path[:-1], path[-1], value)
            return
        depth = self._depth_present(path)
        for key in reversed(path[depth + 1 :]):
            value = {key: value}
        where, key = path[:depth], str(path[depth])
        mapping = self._node(where)
        pair = _find(mapping, key)
        if pair is not None:
            start, end = pair[0].end_mark.index, self._end(pair[1], pair[0].start_mark.column)
            self._splice(start, end, self._after_key(value, mapping, block))
        else:
            self._insert(where, mapping, key, value, block)
        target = self._mapping_at(where)
        target[key] = value
        self._confirm(path)

    def append(self, path: Place, *values: Any) -> None:
        """Put entries at the end of the list at a path, written as the list is: on lines of their own, or inline.

        Raises `InputError` where there is no list.
        """
        node = self._list_node(path)
        entries = cast(list[Node], node.value)
        if not values:
            return
        if node.flow_style and entries:
            self._splice_at(self._end(entries[-1], 0), "".join(f", {flow_text(value)}" for value in values))
        elif node.flow_style:
            self._open_empty_list(node, values)
        else:
            column = node.start_mark.column
            at = self._line_end(self._end(entries[-1], column))
            lines = "".join(self._entry_lines(value, column) for value in values)
            needs_break = at > 0 and not self.text[:at].endswith("\n")
            self._splice_at(at, (self._newline if needs_break else "") + lines)
        cast(list[Any], self.get(path)).extend(values)
        self._confirm(path)

    def extend(self, path: Place, more: Mapping[str, Any]) -> None:
        """Put keys that are not there yet at the end of a mapping, in one go: what `set` would do one by one."""
        rest = dict(more)
        while rest:
            held = self.get(path)
            mapping = self._node(path) if isinstance(held, dict) and held else None
            if mapping is None or mapping.flow_style:
                key = next(iter(rest))
                self.set([*path, key], rest.pop(key), block=True)
                continue
            last_key, last_value = cast(list[Pair], mapping.value)[-1]
            at, column = self._line_end(self._end(last_value, last_key.start_mark.column)), last_key.start_mark.column
            lines = (self._pair_lines(flow_text(key, key=True), value, column, True) for key, value in rest.items())
            self._splice_at(at, ("" if self.text[:at].endswith("\n") else self._newline) + "".join(lines))
            self._mapping_at(path).update(rest)
            rest = {}
        self._confirm(path)

    def remove(self, path: Place) -> None:
        """Take a key and its value, or an entry of a list, away; comments before and after it stay.

        Raises `InputError` for no such key.
        """
        if isinstance(path[-1], int):
            self._remove_entry(path[:-1], path[-1])
            return
        mapping = self._node(path[:-1])
        pairs = cast(list[Pair], mapping.value)
        index = next((i for i, pair in enumerate(pairs) if _key(pair) == path[-1]), None)
        if index is None:
            raise InputError(self.file, shown_path(path), "is not there")
        key_node, value_node = pairs[index]
        start, end = key_node.start_mark.index, self._end(value_node, key_node.start_mark.column)
        if mapping.flow_style:
            if index + 1 < len(pairs):
                end = pairs[index + 1][0].start_mark.index
            elif index > 0:
                start = self._end(pairs[index - 1][1], 0)
            self._splice(start, end, "")
        elif len(pairs) == 1 and len(path) > 1:
            self._splice(start, end, "{}")
        else:
            self._splice(self._line_start(start), self._line_end(end), "")
        del self._mapping_at(path[:-1])[path[-1]]
        self._confirm(path)

    def rename(self, path: Place, name: str) -> None:
        """Give the key at the end of a path another name, at its place. Raises `InputError`."""
        mapping = self._node(path[:-1])
        pair = _find(mapping, str(path[-1]))
        if pair is None:
            raise InputError(self.file, shown_path(path), "is not there")
        self._splice(pair[0].start_mark.index, pair[0].end_mark.index, flow_text(name, key=True))
        holder = self._mapping_at(path[:-1])
        renamed = {name if key == path[-1] else key: value for key, value in holder.items()}
        holder.clear()
        holder.update(renamed)
        self._confirm(path)

    def _mapping_at(self, path: Place) -> dict[str, Any]:
        value: Any = self.data
        for key in path:
            if value[key] is None:
                value[key] = {}
            value = value[key]
        return cast(dict[str, Any], value)

    def _depth_present(self, path: Place) -> int:
        """How many of the path's mappings are there; a null counts as one that is not."""
        for depth in range(1, len(path)):
            value = self.get(path[:depth])
            if value is None:
                return depth - 1
            following = list if isinstance(path[depth], int) else dict
            if not isinstance(value, following):
                raise InputError(self.file, shown_path(path[:depth]), "holds no keys of its own")
        return len(path) - 1

    def _any_node(self, path: Place) -> Any:
        try:
            node: Any = YAML(typ="safe", pure=True).compose(self.text)
        except YAMLError as error:
            raise InputError(self.file, "", f"cannot be edited in place: {error}") from None
        for key in path:
            if isinstance(key, int):
                entries = cast(list[Node], node.value) if isinstance(node, SequenceNode) else []
                node = entries[key] if 0 <= key < len(entries) else None
            else:
                pair = _find(node, key) if isinstance(node, MappingNode) else None
                node = None if pair is None else pair[1]
        return node

    def _node(self, path: Place) -> MappingNode:
        node = self._any_node(path)
        if not isinstance(node, MappingNode):
            raise InputError(self.file, shown_path(path), "holds no keys of its own")
        return node

    def _list_node(self, path: Place) -> SequenceNode:
        node = self._any_node(path)
        if not isinstance(node, SequenceNode):
            raise InputError(self.file, shown_path(path), "is no list")
        return node

    def _entry_of(self, path: Place, index: int) -> tuple[SequenceNode, Node]:
        node = self._list_node(path)
        entries = cast(list[Node], node.value)
        if not 0 <= index < len(entries):
            raise InputError(self.file, shown_path([*path, index]), "is not there")
        return node, entries[index]

    def _set_entry(self, path: Place, index: int, value: Any) -> None:
        node, entry = self._entry_of(path, index)
        self._splice(entry.start_mark.index, self._end(entry, node.start_mark.column), flow_text(value))
        self.get(path)[index] = value
        self._confirm([*path, index])

    def _remove_entry(self, path: Place, index: int) -> None:
        node, entry = self._entry_of(path, index)
        entries = cast(list[Node], node.value)
        start, end = entry.start_mark.index, self._end(entry, node.start_mark.column)
        if node.flow_style:
            if index + 1 < len(entries):
                end = entries[index + 1].start_mark.index
            elif index > 0:
                start = self._end(entries[index - 1], 0)
            self._splice(start, end, "")
        else:
            start = self.text.rfind("-", 0, start)
            if len(entries) == 1:
                self._splice(start, end, "[]")
            else:
                self._splice(self._line_start(start), self._line_end(end), "")
        del self.get(path)[index]
        self._confirm([*path, index])

    def _entry_lines(self, value: Any, column: int) -> str:
        """An entry of a list as lines, from its dash on; a mapping one line a key, lists of lists one line an entry."""
        if not isinstance(value, dict) or not value:
            return " " * column + f"- {flow_text(value)}" + self._newline
        lines: list[str] = []
        for key, inner in cast(dict[str, Any], value).items():
            head = " " * (column + 2) + flow_text(key, key=True) + ":"
            entries = cast(list[Any], inner) if isinstance(inner, list) else []
            if entries and all(isinstance(entry, list) for entry in entries):
                lines += [head, *(" " * (column + 4) + f"- {flow_text(entry)}" for entry in entries)]
            else:
                lines.append(f"{head} {flow_text(inner)}")
        lines[0] = " " * column + "- " + lines[0].lstrip(" ")
        return "".join(line + self._newline for line in lines)

    def _open_empty_list(self, node: SequenceNode, values: Sequence[Any]) -> None:
        """Make lines of an empty `[]`; a comment after it stays."""
        start, end = node.start_mark.index, node.end_mark.index
        alone = not self.text[self._line_start(start) : start].strip()
        column = self._indent_of_line(start) + (0 if alone else 2)
        at = self._line_end(end)
        needs_break = at == end or not self.text[:at].endswith("\n")
        lines = "".join(self._entry_lines(value, column) for value in values)
        self._splice_at(at, (self._newline if needs_break else "") + lines)
        rest = self.text[end : self._line_end(end)].strip()
        if alone:
            self._splice(self._line_start(start), self._line_end(end) if not rest else end, "")
        else:
            self._splice(start if rest else len(self.text[:start].rstrip(" ")), end, "")

    def _insert(self, where: Place, mapping: MappingNode, key: str, value: Any, block: bool) -> None:
        pairs = cast(list[Pair], mapping.value)
        written = flow_text(key, key=True)
        if mapping.flow_style and pairs:
            self._splice_at(self._end(pairs[-1][1], 0), f", {written}: {flow_text(value)}")
        elif mapping.flow_style and block and where:
            self._open_empty(mapping, written, value)
        elif mapping.flow_style:
            self._splice_at(mapping.start_mark.index + 1, f"{written}: {flow_text(value)}")
        else:
            last_key, last_value = pairs[-1]
            at = self._line_end(self._end(last_value, last_key.start_mark.column))
            lines = self._pair_lines(written, value, last_key.start_mark.column, block)
            needs_break = at > 0 and not self.text[:at].endswith("\n")
            self._splice_at(at, (self._newline if needs_break else "") + lines)

    def _open_empty(self, mapping: MappingNode, written: str, value: Any) -> None:
        """Make a block of an empty `{}`, which reads better than one long line; a comment after it stays."""
        start, end = mapping.start_mark.index, mapping.end_mark.index
        column = self._indent_of_line(start)
        alone = not self.text[self._line_start(start) : start].strip()
        lines = self._pair_lines(written, value, column if alone else column + 2, True)
        at = self._line_end(end)
        if at == end or not self.text[:at].endswith("\n"):
            lines = self._newline + lines
        self._splice_at(at, lines)
        rest = self.text[end : self._line_end(end)].strip()
        self._splice(start if rest or alone else len(self.text[:start].rstrip(" ")), end, "")

    def _after_key(self, value: Any, mapping: MappingNode, block: bool) -> str:
        if block and isinstance(value, dict) and value and not mapping.flow_style:
            column = cast(list[Pair], mapping.value)[0][0].start_mark.column
            lines = block_lines(cast(dict[str, Any], value), column + 2)
            return ":" + self._newline + self._newline.join(lines)
        return f": {flow_text(value)}"

    def _pair_lines(self, written: str, value: Any, indent: int, block: bool) -> str:
        head = " " * indent + written + ":"
        if block and isinstance(value, dict) and value:
            lines = [head, *block_lines(cast(dict[str, Any], value), indent + 2)]
        else:
            lines = [f"{head} {flow_text(value)}"]
        return "".join(line + self._newline for line in lines)

    def _end(self, node: Node, key_column: int) -> int:
        """Where a value's own characters end, before any comment or blank after it."""
        if isinstance(node, ScalarNode):
            if node.style in ("|", ">"):
                return self._block_scalar_end(node, key_column)
            return node.end_mark.index
        if cast(Any, node).flow_style or not node.value:
            return node.end_mark.index
        last: Any = node.value[-1]
        if isinstance(last, tuple):
            return self._end(cast(Node, last[1]), cast(Node, last[0]).start_mark.column)
        return self._end(cast(Node, last), node.start_mark.column)

    def _block_scalar_end(self, node: ScalarNode, key_column: int) -> int:
        end = at = self._line_end(node.start_mark.index)
        while at < len(self.text):
            following = self._line_end(at)
            line = self.text[at:following]
            if line.strip() and len(line) - len(line.lstrip(" ")) <= key_column:
                break
            at = following
            end = at if line.strip() else end
        return end - len(self._newline) if self.text[:end].endswith(self._newline) else end

    def _line_start(self, index: int) -> int:
        return self.text.rfind("\n", 0, index) + 1

    def _line_end(self, index: int) -> int:
        found = self.text.find("\n", index)
        return len(self.text) if found < 0 else found + 1

    def _indent_of_line(self, index: int) -> int:
        line = self.text[self._line_start(index) : index]
        return len(line) - len(line.lstrip(" "))

    def _splice(self, start: int, end: int, new: str) -> None:
        self.text = self.text[:start] + new + self.text[end:]

    def _splice_at(self, index: int, new: str) -> None:
        self._splice(index, index, new)

    def _confirm(self, path: Place) -> None:
        """Refuse a splice that did not do exactly what it was for."""
        try:
            now = parse_yaml(self.text, file=self.file)
        except InputError:
            now = None
        if json.dumps(now) != json.dumps(self.data):
            message = "cannot be changed without touching the rest; edit it by hand"
            raise InputError(self.file, shown_path(path), message)


def shown_path(path: Place) -> str:
    """A path for messages: `tables[2].rows[14]`, entries counted from 1."""
    parts = "".join(f"[{key + 1}]" if isinstance(key, int) else f".{key}" for key in path)
    return parts.removeprefix(".")


def _key(pair: Pair) -> str:
    return str(pair[0].value)


def _find(mapping: MappingNode, key: str) -> Pair | None:
    return next((pair for pair in cast(list[Pair], mapping.value) if _key(pair) == key), None)


def flow_text(value: Any, *, key: bool = False) -> str:
    """Return a value as one line of YAML; text is quoted only where it must be."""
    if isinstance(value, dict):
        pairs = cast(dict[Any, Any], value).items()
        return "{" + ", ".join(f"{flow_text(str(name), key=True)}: {flow_text(entry)}" for name, entry in pairs) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(flow_text(entry) for entry in cast(Sequence[Any], value)) + "]"
    if isinstance(value, str):
        return _text(value, key)
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return repr(value)


def block_lines(mapping: dict[str, Any], indent: int) -> list[str]:
    """Return a mapping as lines, one a key, what is inside each on one line."""
    return [" " * indent + f"{flow_text(name, key=True)}: {flow_text(value)}" for name, value in mapping.items()]


def _text(text: str, key: bool) -> str:
    if text == text.strip() and text.isprintable() and not set(text) & set("\"'`{}[],&*!|>%@#"):
        probe = f"{{{text}: 1}}" if key else f"[{text}]"
        try:
            if parse_yaml(probe, file="") == ({text: 1} if key else [text]):
                return text
        except InputError:
            pass
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(char if char.isprintable() else f"\\U{ord(char):08x}" for char in escaped) + '"'
