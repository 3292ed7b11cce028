"""Files read within bounds, written whole or not at all, and locks for those that several programs change at once.

A file of the user's is read over what is shipped: where an environment variable says, or in the configuration folder.
"""

from __future__ import annotations

import os
import re
import select
import stat
import sys
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from platformdirs import user_config_dir

from linkwright.core.units.quantities import InputError

LARGEST_FILE = 64 * 1024 * 1024
"""Bytes of text that are read; people's files have thousands."""
_PIECE = 1024 * 1024
_PATIENCE = 5.0
"""Seconds after which a pipe that nobody writes to is given up."""


def read_bytes(path: Path | str, most: int = LARGEST_FILE) -> bytes:
    """The content of a file of at most `most` bytes; a pipe is read to its end, the null device is empty.

    Every file that people name is opened here. Raises `InputError`, one line, where there is none, where it is a
    folder, a device or a socket, where nothing comes through a pipe, where it is larger (however large it says that it
    is), and where it may not or cannot be read.
    """
    try:
        opened = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except FileNotFoundError:
        raise InputError(path, "", "there is no such file") from None
    except PermissionError:
        message = "is a directory, not a file" if os.path.isdir(path) else "may not be read (permission)"
        raise InputError(path, "", message) from None
    except (OSError, ValueError) as error:
        raise InputError(path, "", f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        kind = os.fstat(opened)
        if stat.S_ISDIR(kind.st_mode):
            raise InputError(path, "", "is a directory, not a file")
        null = stat.S_ISCHR(kind.st_mode) and os.path.samestat(kind, os.stat(os.devnull))
        if not (stat.S_ISREG(kind.st_mode) or stat.S_ISFIFO(kind.st_mode) or null):
            raise InputError(path, "", "is a device, not a file")
        pieces: list[bytes] = []
        left = most + 1
        while left > 0:
            if stat.S_ISFIFO(kind.st_mode) and not select.select([opened], [], [], _PATIENCE)[0]:
                raise InputError(path, "", f"is a pipe through which nothing came for {_PATIENCE:g} s")
            piece = os.read(opened, min(_PIECE, left))
            if not piece:
                break
            pieces.append(piece)
            left -= len(piece)
    except OSError as error:
        raise InputError(path, "", f"cannot be read: {error.strerror or error}") from None
    finally:
        os.close(opened)
    if left <= 0:
        raise InputError(path, "", f"is larger than {most // 1024**2} MB")
    return b"".join(pieces)


def write_whole(path: Path | str, text: str | bytes, *, flush: bool = False, ending: str = "") -> None:
    """Write a file whole or not at all: to a neighbour first, then renamed into place; its permissions stay.

    With `flush` it is on the disk before this returns, so that it outlives a power cut as well as a kill. The
    neighbour is `.NAME.ENDING`; without an ending (for who holds no lock) one that no other process has. Raises
    `OSError`.
    """
    target = Path(path)
    beside = neighbour(target, ending)
    content = text if isinstance(text, bytes) else text.encode()
    try:
        with beside.open("wb") as stream:
            stream.write(content)
            if flush:
                stream.flush()
                os.fsync(stream.fileno())
        if target.exists():
            beside.chmod(target.stat().st_mode & 0o7777)
        beside.replace(target)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
    if flush and sys.platform != "win32":
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def neighbour(target: Path, ending: str = "") -> Path:
    """The file that the next content of `target` is written to first (see `write_whole`)."""
    return target.with_name(f".{target.name}.{ending or os.getpid()}")


def left_over_of(name: str) -> str | None:
    """The file that a kill left the neighbour of behind, None for a name that is no neighbour's."""
    result = re.fullmatch(r"\.(.+)\.[0-9]+", name)
    return None if result is None else result[1]


@contextmanager
def locked(target: Path, *, wait: bool = True) -> Generator[None]:
    """Hold the lock of a file; its folder is made where it is not there.

    The lock is `.NAME.lock`, which the operating system frees when its holder ends, however it ends; the file stays.
    Raises `InputError` where it cannot be made or, without `wait`, where another process holds it.
    """
    import filelock

    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        lock = filelock.FileLock(lock_path(target), timeout=-1 if wait else 0, poll_interval=0.002)
        lock.acquire()
    except filelock.Timeout:
        raise InputError(target, "", "another process is at work in this folder") from None
    except OSError as error:
        raise InputError(target, "", f"cannot be written: {error.strerror or error}") from None
    try:
        yield
    finally:
        lock.release()


def lock_path(target: Path) -> Path:
    """The file whose lock stands for that of `target`."""
    return target.with_name(f".{target.name}.lock")


@dataclass(frozen=True)
class UserFile:
    """A kind of file that users may have: the environment `variable` that names it, and its `name` otherwise."""

    variable: str
    name: str

    @property
    def _named(self) -> str:
        return os.environ.get(self.variable, "").strip()

    def path(self) -> Path:
        """Where it is, or would be."""
        named = self._named
        return Path(os.path.expanduser(named)) if named else Path(user_config_dir("linkwright")) / self.name

    def over(self, paths: Sequence[Path | str], *, user: bool) -> list[Path | str]:
        """The files to read over what is shipped, in order: the user's own (where it exists or is named, and `user` is
        true), then `paths`."""
        user_path = self.path()
        return [*([user_path] if user and (os.path.exists(user_path) or self._named) else []), *paths]
