"""Materials as a catalogue file writes them: the entry's own keys and the sources that they name, not yet values.

Edits, imports and exports work on these, so that notes, tables and spreads travel with a material as they are written.
"""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Mapping as MappingLike
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, cast

from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.materials.catalogue import FORMAT_VERSION, Catalogue, read_layer, shipped_layers
from linkwright.core.materials.material import property_kinds
from linkwright.core.units.reading import load_yaml, read_text, shipped_files

NEW_FILE = f"format_version: {FORMAT_VERSION}\nreferences: {{}}\nmaterials: {{}}\n"
"""What a catalogue file begins as."""


@dataclass(frozen=True)
class Entry:
    """A material as a catalogue file writes it: its keys as YAML gives them, and the sources that they name."""

    name: str
    content: MappingLike[str, Any]
    references: MappingLike[str, str] = field(default_factory=dict[str, str])


def entries_text(entries: Iterable[Entry]) -> str:
    """Return the entries as the text of a catalogue file of their own."""
    document = YamlText(NEW_FILE, file="")
    put(document, *entries)
    return document.text


def find_entry(catalogue: Catalogue, name: str) -> Entry:
    """Return the entry of the visible material of that name as its file writes it. Raises `InputError`."""
    catalogue.find(name)
    layer = next(layer for layer in reversed(catalogue.layers) if name in layer.materials)
    found = shipped_entry(name) if layer in shipped_layers() else None
    found = found or next(entry for entry in read_entries(layer.file) if entry.name == name)
    for each in catalogue.layers[catalogue.layers.index(layer) :]:
        if name in each.prices:
            price: dict[str, Any] = dict(load_yaml(each.file).content["prices"][name])  # type: ignore[index]
            source = str(price["source"])
            cost = {**price, "source": "price"}
            found = Entry(name, {**found.content, "cost": cost}, {**found.references, "price": source})
    return found


def shipped_entry(name: str) -> Entry | None:
    """Return the entry of a shipped material as it is written, its family with it; None for no such material."""
    for family, data in _shipped():
        found = entry_in(data, name)
        if found is not None:
            return Entry(name, {"family": family, **found.content}, found.references)
    return None


def read_entries(path: Path | str) -> tuple[Entry, ...]:
    """Return the entries of a catalogue file, checked. Raises `InputError`."""
    read_layer(load_yaml(path), Path(path).stem)
    data = YamlText(read_text(path), file=path).data
    family = str(data.get("family") or Path(path).stem)
    found = (entry_in(data, name) for name in data.get("materials") or {})
    entries = (entry for entry in found if entry is not None)
    return tuple(Entry(each.name, {"family": family, **each.content}, each.references) for each in entries)


def put(document: YamlText, *entries: Entry, under: str = "materials") -> None:
    """Write entries `under` their key; a source key that the file has for another text gets a new name."""
    known: dict[str, str] = dict(document.get(["references"]) or {})
    fresh: dict[str, str] = {}
    contents: dict[str, dict[str, Any]] = {}
    for entry in entries:
        renamed: dict[str, str] = {}
        for key, text in entry.references.items():
            renamed[key] = _free_key(known, key, text)
            if renamed[key] not in known:
                known[renamed[key]] = fresh[renamed[key]] = text
        contents[entry.name] = _with_sources(dict(entry.content), renamed)
    document.extend(["references"], fresh)
    for name in [name for name in contents if document.get([under, name]) is not None]:
        document.set([under, name], contents.pop(name), block=True)
    document.extend([under], contents)


def _with_sources(content: dict[str, Any], renamed: MappingLike[str, str]) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for key, value in content.items():
        if isinstance(value, dict):
            made[key] = _with_sources(cast(dict[str, Any], value), renamed)
        else:
            made[key] = renamed.get(value, value) if key == "source" and isinstance(value, str) else value
    return made


def reference(document: YamlText, key: str, text: str) -> str:
    """Return the key under which the file cites `text`, adding it where it is not there yet."""
    known: dict[str, str] = document.get(["references"]) or {}
    key = _free_key(known, key, text)
    if key in known:
        return key
    if known:
        document.set(["references", key], text)
    else:
        document.set(["references"], {key: text}, block=True)
    return key


def _free_key(known: MappingLike[str, str], key: str, text: str) -> str:
    """Return the key that has `text` already, or else one like `key` that has none yet."""
    for other, written in known.items():
        if written == text:
            return other
    base = found = key or "source"
    number = 1
    while found in known:
        number += 1
        found = f"{base}-{number}"
    return found


def entry_in(data: MappingLike[str, Any], name: str, under: str = "materials") -> Entry | None:
    """The entry of that name in a file's content, `under` its key; None where there is none."""
    content = (data.get(under) or {}).get(name)
    if not isinstance(content, dict):
        return None
    references: dict[str, str] = data.get("references") or {}
    content = cast(dict[str, Any], content)
    used = _sources_of(content)
    found = _found_in(content, data.get("found_in")) if under == "materials" else {}
    told = {**content, "found_in": found} if found else content
    return Entry(name, told, {key: references[key] for key in used if key in references})


def _found_in(content: MappingLike[str, Any], of_file: object) -> dict[str, str]:
    """Where each property of a material was found: what the file says of its sources said of the properties."""
    by_source = cast(dict[str, str], of_file) if isinstance(of_file, dict) else {}
    missing, own = content.get("unconfirmed") or {}, dict[str, str](content.get("found_in") or {})
    for key in (*property_kinds(), "magnetic"):
        if key in content and key not in missing and key not in own:
            value = content[key]
            source = value.get("source") if isinstance(value, dict) else None  # type: ignore[reportUnknownMemberType]
            text = by_source.get(source or content.get("source", ""))  # type: ignore[reportUnknownArgumentType]
            own |= {key: text} if text else {}
    return own


def _sources_of(content: MappingLike[str, Any]) -> dict[str, None]:
    found: dict[str, None] = {}
    for key, value in content.items():
        if isinstance(value, dict):
            found |= _sources_of(cast(dict[str, Any], value))
        elif key == "source" and isinstance(value, str):
            found[value] = None
    return found


@cache
def _shipped() -> list[tuple[str, dict[str, Any]]]:
    found = shipped_files("linkwright.core.materials", "catalogue")
    return [(each.text("family", Path(str(each.file)).stem), each.content) for each in found]
