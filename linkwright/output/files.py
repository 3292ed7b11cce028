"""Results into files: strict JSON, each file whole or not at all, and never over what is not ours.

Those that the program can read are read back and compared with the result.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from linkwright.core.units.files import left_over_of, neighbour, write_whole
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.core.units.reading import load_json
from linkwright.output.stream import write_result_out

if TYPE_CHECKING:
    from linkwright.results.document import Description

_MOST = 3
"""How many differences a line tells."""


class NotAsWritten(NoAnswer):
    """A file was written, and reading it back does not give the result. Its `path`, and what differs, in words."""

    def __init__(self, path: Path, differs: str) -> None:
        self.path = path
        self.differs = differs
        super().__init__(f"{path}: is written, but does not read back as what was found: {differs}")

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the fields when the error crosses between processes."""
        return NotAsWritten, (self.path, self.differs)


@dataclass(frozen=True)
class ReadBack:
    """The text of a file that the program can read. `differs` reads the file back and describes each difference from
    the result; it is empty where there is none."""

    text: str
    differs: Callable[[Path], Iterable[str]]

    def hold(self, path: Path) -> None:
        """Read the file back. Raises `NotAsWritten` where it cannot be read, or says otherwise."""
        try:
            differences = list(self.differs(path))
        except InputError as error:
            raise NotAsWritten(path, f"{error.key}: {error.message}" if error.key else error.message) from None
        if differences:
            more = f", and {len(differences) - _MOST} more" if len(differences) > _MOST else ""
            raise NotAsWritten(path, "; ".join(differences[:_MOST]) + more)


RESULT, REPORT, DESIGN = "result.json", "report.html", "arm.yaml"
"""The files of an output folder."""
OUTPUT = Path("-")
"""Standard output, where a file to write is asked for."""


def strict(value: Any) -> Any:
    """The value as strict JSON can hold it: mappings and lists of plain values, null for nan and infinities."""
    if isinstance(value, Mapping):
        return {str(key): strict(entry) for key, entry in cast(Mapping[Any, Any], value).items()}
    if isinstance(value, list | tuple):
        return [strict(entry) for entry in cast(list[Any], value)]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def json_text(content: Mapping[str, Any]) -> str:
    """The content as JSON without NaN or Infinity."""
    return json.dumps(strict(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def check_target(path: Path | None, *inputs: Path | None) -> None:
    """Refuse, before any work is done, a file that could not be written or that is one of the inputs.

    Raises `InputError`.
    """
    if path is None or path == OUTPUT:
        return
    if os.path.isdir(path):
        raise InputError(path, "", "is a folder; name a file to write")
    if any(given is not None and _same(path, given) for given in inputs):
        raise InputError(path, "", "is the input; name another file to write")
    try:
        path.stat()
    except FileNotFoundError:
        pass
    except (OSError, ValueError) as error:
        raise InputError(path, "", f"cannot be written: {getattr(error, 'strerror', None) or error}") from None
    else:
        if not os.access(path, os.W_OK):
            raise InputError(path, "", "cannot be written: permission denied")
        return
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise InputError(path, "", f"cannot be written: there is no folder {path.parent}")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise InputError(path, "", "cannot be written: permission denied")
    try:
        os.stat(neighbour(target))
    except FileNotFoundError:
        pass
    except OSError as error:
        raise InputError(path, "", f"cannot be written: {error.strerror or error}") from None


def _same(one: Path, other: Path) -> bool:
    return os.path.exists(one) and os.path.exists(other) and one.samefile(other)


def write_file(path: Path, text: str | bytes | ReadBack) -> None:
    """Write a file whole or not at all, onto the disk before this returns; a device or a pipe is written as it is. What
    the program reads too is read back from there.

    `-` is standard output. Raises `InputError`, and `NotAsWritten` where what is read back is not the result.
    """
    if isinstance(text, ReadBack):
        write_file(path, text.text)
        if os.path.isfile(path):
            text.hold(path)
        return
    if path == OUTPUT and isinstance(text, str):
        write_result_out(text)
        return
    try:
        if os.path.exists(path) and not os.path.isfile(path):
            path.write_bytes(text if isinstance(text, bytes) else text.encode())
        else:
            write_whole(os.path.realpath(path), text, flush=True)
    except (OSError, ValueError) as error:
        raise InputError(path, "", f"cannot be written: {getattr(error, 'strerror', None) or error}") from None


def write_json(path: Path | None, content: Mapping[str, Any]) -> None:
    """Write the content where `--json` names a file. Raises `InputError`."""
    if path is not None:
        write_file(path, json_text(content))


def made_folder(folder: Path) -> set[str]:
    """Make an output folder where there is none; the names of what it holds. Raises `InputError`."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in folder.iterdir()}
    except FileExistsError:
        raise InputError(folder, "", "is a file; name a folder to write to") from None
    except OSError as error:
        raise InputError(folder, "", f"cannot be made: {error.strerror or error}") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(folder, "", "cannot be written: permission denied")
    return names


def refuse_strangers(folder: Path, there: set[str], allowed: Collection[str]) -> None:
    """Refuse a folder that holds anything but a command's files, so that nobody's are written over."""
    strangers = sorted(name for name in there - set(allowed) if left_over_of(name) not in allowed)
    if strangers:
        raise InputError(folder, "", f"holds other files ({strangers[0]}); name a new or empty folder")


def claim_folder(folder: Path, command: str, allowed: Collection[str], result: str = RESULT) -> None:
    """Make the output folder of a command, or take an earlier one of the same command again.

    A folder that holds anything but the `allowed` files is refused, so that nobody's are written over. Raises
    `InputError`.
    """
    names = made_folder(folder)
    refuse_strangers(folder, names, allowed)
    if any(left_over_of(name) is None for name in names) and made_by(folder / result) != command:
        raise InputError(folder, "", f"holds files that are not of `linkwright {command}`; name a new or empty folder")


def made_by(path: Path) -> str | None:
    """The command that wrote a result file, None for anything else."""
    try:
        content = load_json(path)
    except InputError:
        return None
    if not isinstance(content, dict):
        return None
    made_by: object = cast(dict[str, object], content).get("made_by")
    words = made_by.split() if isinstance(made_by, str) else []
    return words[1] if len(words) > 1 and words[0] == "linkwright" else None


def write_folder(folder: Path | None, files: Mapping[str, str | bytes | ReadBack]) -> None:
    """Write a command's files into its folder, `result.json` first. Raises `InputError`, `NotAsWritten`."""
    if folder is not None:
        write_each({folder / name: files[name] for name in sorted(files, key=lambda name: name != RESULT)})


def write_each(files: Mapping[Path, str | bytes | ReadBack]) -> None:
    """Write files in their order, all of them, whatever one of them reads back as. Raises `InputError`, and at the end
    `NotAsWritten` for the first that does not read back as the result."""
    unlike: list[NotAsWritten] = []
    for path, text in files.items():
        try:
            write_file(path, text)
        except NotAsWritten as error:
            unlike.append(error)
    if unlike:
        raise unlike[0]


def write_markdown(path: Path | None, described: Description) -> None:
    """Write a described result where `--markdown` names a file. Raises `InputError`."""
    if path is not None:
        from linkwright.markdown.described import markdown

        write_file(path, markdown(described))
