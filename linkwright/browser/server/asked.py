"""What an answer is of: the file that was asked about, it and what it names as they were, and the settings."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from types import MappingProxyType
from typing import Any

from pydantic import TypeAdapter, ValidationError
from typing_extensions import TypedDict

from linkwright.browser.server.folder import Folder
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml

ASKED = "asked.json"
"""The file of an answer that holds it."""
_YAML = (".yaml", ".yml")


class _Kept(TypedDict):
    file: str
    texts: dict[str, str]
    settings: dict[str, Any]


@dataclass(frozen=True)
class Asked:
    """A question: the name of the arm's or problem's `file` in the folder, the `texts` of it and of all YAML files that
    it was answered from, by name, and the `settings` of the page."""

    file: str
    texts: Mapping[str, str]
    settings: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def text(self) -> str:
        """The file as it was."""
        return self.texts.get(self.file, "")

    def content(self) -> bytes:
        """As it is kept beside an answer."""
        kept: _Kept = {"file": self.file, "texts": dict(self.texts), "settings": dict(self.settings)}
        return json.dumps(kept).encode()

    def differs(self, name: str, text: str, folder: Folder) -> str:
        """Why an answer is not of the file `name` with this text: the file that it is of, or that has changed. Empty
        where it is of that; comments do not count."""
        if name != self.file:
            return f"This answer is of {self.file}."
        if not _same(self.text, text):
            return f"This answer is of {self.file} as it was before it was changed."
        for other, before in self.texts.items():
            if other != self.file and not _same(before, _there(folder, other)):
                return f"This answer is of {other} as it was before it was changed."
        return ""


def asked_of(kind: str, inputs: Mapping[str, bytes], request: Mapping[str, Any]) -> Asked:
    """What a page asks: its inputs and its request."""
    file = str(request.get("problem") or request.get("arm") or next(iter(inputs), ""))
    texts = {
        name: content.decode(errors="replace")
        for name, content in inputs.items()
        if name == file or (PurePosixPath(name).suffix in _YAML and kind != "diagnose")
    }
    return Asked(file, texts, request)


def asked_from(content: bytes | None) -> Asked | None:
    """What an answer's file holds; None where it has none, or none of this program's."""
    if content is None:
        return None
    try:
        kept = TypeAdapter(_Kept).validate_json(content)
    except ValidationError:
        return None
    return Asked(kept["file"], kept["texts"], kept["settings"])


def _same(one: str, other: str | None) -> bool:
    if one == other or other is None:
        return other is not None
    try:
        return parse_yaml(one, file="") == parse_yaml(other, file="")
    except InputError:
        return False


def _there(folder: Folder, name: str) -> str | None:
    try:
        return folder.read(name)
    except InputError:
        return None
