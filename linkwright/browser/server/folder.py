"""The one folder that is served: its files by kind, and no way out of it."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from importlib.resources import files
from itertools import zip_longest
from pathlib import Path, PurePosixPath
from typing import Any, Literal, cast

import linkwright as lw
from linkwright.core.units.files import read_bytes, write_whole
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import parse_yaml, read_text
from linkwright.face.arm import DESCRIPTIONS

Kind = Literal["arm", "problem", "description"]
"""A `description` is a URDF or MJCF, which the commands take in place of an arm file."""
_ARM = re.compile(r"^chain\s*:", re.MULTILINE)
_NAME = re.compile(r"^name\s*:\s*(.*?)\s*$", re.MULTILINE)
_PROBLEM = re.compile(r"^arm\s*:", re.MULTILINE)
_ROBOT = re.compile(r"\s*(?:<\?.*?\?>\s*|<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*<(?:robot|mujoco)\b", re.DOTALL)
_FILE = re.compile(r"""\b(?:file|meshdir|assetdir)\s*=\s*["']([^"']+)["']""")
_LARGEST = 1024 * 1024
"""Bytes of an arm or a problem that can be edited here."""
_DEEPEST, _MOST = 4, 2000
_LONGEST = 1000
"""Letters of a name in the folder."""
_ENDINGS = (".yaml", ".yml")
_ALL = (*_ENDINGS, *DESCRIPTIONS)


class Occupied(InputError):
    """The file of that name holds what its writer has not seen."""


class Folder:
    """A folder; names in it are relative, with slashes. Everything raises `InputError` for a name that leaves it."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        if not self.root.is_dir():
            raise InputError(root, "", "is no folder; name the one whose files shall be shown")
        if not os.access(self.root, os.W_OK):
            raise InputError(root, "", "cannot be written to, so no result could be kept there")

    def place(self, name: str) -> Path:
        """Where a file of the folder stands, links followed."""
        parts = PurePosixPath(name.replace("\\", "/"))
        try:
            path = (self.root / parts).resolve()
        except (OSError, ValueError, RuntimeError):  # a NUL, or links in a circle
            path = None
        outside = len(name) > _LONGEST or path is None or path == self.root or not path.is_relative_to(self.root)
        if path is None or outside or parts.is_absolute() or any(part.startswith(".") for part in parts.parts):
            raise InputError("", shown(name), "is not in the folder that is served; name a file within it")
        return path

    def names(self, *kinds: Kind) -> list[str]:
        """The files of these kinds in their order, at most so many, folders first looked into to a few levels."""
        result: dict[Kind | None, list[str]] = {kind: [] for kind in kinds}
        for name in self._looked_at():
            result.get(self._kind(name), []).append(name)
        return [name for names in result.values() for name in names]

    def _looked_at(self) -> Generator[str]:
        seen = 0
        for at, folders, names in os.walk(self.root):
            here = Path(at)
            deep = len(here.relative_to(self.root).parts)
            folders[:] = sorted(folder for folder in folders if not folder.startswith(".") and deep < _DEEPEST)
            for name in sorted(item for item in names if item.endswith(_ALL) and not item.startswith(".")):
                seen += 1
                if seen > _MOST:
                    return
                yield (here / name).relative_to(self.root).as_posix()

    def _kind(self, name: str) -> Kind | None:
        try:
            path = self.place(name)
            if not path.is_file():
                return None
            text = read_bytes(path, _LARGEST).decode("utf-8", errors="replace")
        except InputError:
            return None
        if is_description(name):
            return "description" if _ROBOT.match(text.removeprefix("\ufeff")) else None
        return "arm" if _ARM.search(text) else "problem" if _PROBLEM.search(text) else None

    def read(self, name: str) -> str:
        """The text of a file."""
        path = self.place(name)
        try:
            return read_text(path, _LARGEST)
        except InputError as error:
            raise InputError(name, "", error.message) from None

    def write(self, name: str, text: str, *, known: str | None = None, whatever: bool = False) -> None:
        """Write an arm or a problem, whole or not at all; a folder on the way must be there.

        Over a file only where that holds the text `known` (or this one already), or `whatever` it holds: another
        program may have changed it. Raises `Occupied`, an `InputError`, where it holds another one.
        """
        path = self.place(name)
        if path.suffix not in _ENDINGS:
            raise InputError("", shown(name), "needs a name that ends in .yaml")
        if not whatever and path.exists() and (there := self.read(name)) not in (known, text):
            reason = "is there already" if known is None else f"was changed by another program{_lines(known, there)}"
            raise Occupied(name, "", f"{reason}; save under another name, or write over it")
        try:
            write_whole(path, text, flush=True)
        except OSError as error:
            raise InputError(name, "", f"cannot be written: {error.strerror or error}") from None

    def with_named(self, name: str, text: str) -> dict[str, bytes]:
        """A problem's text and the files that it names, its arm and its table of poses, by their names in the
        folder."""
        result = {name: text.encode()}
        self.place(name)
        content = cast("dict[str, Any]", parsed) if isinstance(parsed := parse_yaml(text, file=name), dict) else {}
        space = content.get("workspace")
        for key, file in (
            ("arm", content.get("arm")),
            ("workspace.poses", cast("dict[str, Any]", space).get("poses") if isinstance(space, dict) else None),
        ):
            if isinstance(file, str):
                within = os.path.normpath(PurePosixPath(name).parent / file.replace("\\", "/"))
                if Path(file).is_absolute() or within.startswith(".."):
                    raise InputError(name, key, f"{shown(file)} is not in the folder that is served; put it there")
                result[Path(within).as_posix()] = self.read(Path(within).as_posix()).encode()
        return result

    def arm(self, name: str) -> dict[str, bytes]:
        """An arm's file and what it is read with, by their names in the folder: of an MJCF included files and the
        meshes that weigh."""
        result, folders = {name: self.read(name).encode()}, [""]
        pending = [name] if is_description(name) else []
        while pending:
            said = _FILE.findall(result[pending.pop()].decode(errors="replace"))
            folders += [item for item in said if not PurePosixPath(item).suffix]
            for place in (PurePosixPath(name).parent / folder / file for folder in folders for file in said):
                other = os.path.normpath(place)
                if other not in result and other.lower().endswith((*DESCRIPTIONS, ".stl")):
                    with suppress(InputError):
                        result[other] = read_bytes(self.place(other))
                        pending += [other] if is_description(other) else []
        return result

    def add_examples(self) -> list[str]:
        """Put the examples that are not there yet into the folder; gives the names of all."""
        names: list[str] = []
        for starter in sorted(files("linkwright.browser").joinpath("starters").iterdir(), key=lambda item: item.name):
            names.append(starter.name)
            if not self.place(starter.name).exists():
                self.write(starter.name, starter.read_text(encoding="utf-8"))
        return names


def is_description(name: str) -> bool:
    """Whether a file's name is that of a URDF or MJCF."""
    return name.lower().endswith(DESCRIPTIONS)


def templates() -> dict[str, str]:
    """The shipped arms that a new one can begin as: their texts by name."""
    texts = (item.read_text(encoding="utf-8") for item in files("linkwright.browser").joinpath("templates").iterdir())
    return dict(sorted((named[1], text) for text in texts if (named := _NAME.search(text))))


def arm_of_urdf(name: str, files: Mapping[str, bytes], tip: str) -> tuple[str, str]:
    """The arm file that a URDF among files makes, to a `tip` (empty: its only one), and the result in a line. Raises
    `InputError`."""
    with staged(files) as root:
        imported = lw.import_arm(root / name, tip=tip or None)
        (root / "made").mkdir()
        imported.save(root / "made" / "arm.yaml")
        return (root / "made" / "arm.yaml").read_text(encoding="utf-8"), repr(imported)[1:-1]


def _lines(before: str, after: str) -> str:
    """Where two texts differ first."""
    pairs = zip_longest(before.splitlines(), after.splitlines())
    first = next((number for number, (one, other) in enumerate(pairs, start=1) if one != other), None)
    return "" if first is None else f" from line {first} on"


@contextmanager
def staged(inputs: Mapping[str, bytes]) -> Generator[Path]:
    """A folder of its that holds these files for as long as it is needed; errors name them as they are called."""
    with tempfile.TemporaryDirectory(prefix="linkwright-") as made:
        root = Path(made)
        put(root, inputs)
        try:
            yield root
        except InputError as error:
            raise called_plainly(error, root) from None


def arm_from_text(name: str, text: str) -> lw.Arm:
    """The arm of a file's text as it is being edited; errors name the file `name`. Raises `InputError`."""
    return arm_among(name, {name: text.encode()})


def arm_among(name: str, files: Mapping[str, bytes]) -> lw.Arm:
    """The arm of a file among those that it is read with; errors name the file `name`. Raises `InputError`."""
    with staged(files) as root:
        return lw.read_arm(root / name)


def put(root: Path, inputs: Mapping[str, bytes]) -> None:
    """Write files by their relative names."""
    for name, content in inputs.items():
        target = root / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)


def called_plainly(error: InputError, root: Path) -> InputError:
    """The error with files of a passing folder by their names alone."""
    prefix = f"{root}{os.sep}"
    return InputError(error.file.replace(prefix, ""), error.key, error.message.replace(prefix, ""), *error.remedies)
