"""Text files that are written whole or not at all, and locks for those that several programs change at once."""

from __future__ import annotations

import os
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from units.quantities import InputError


def write_whole(path: Path | str, text: str, *, flush: bool = False, ending: str = "") -> None:
    """Write a file whole or not at all: to a neighbour first, then renamed into place; its permissions stay.

    With `flush` it is on the disk before this returns, so that it outlives a power cut as well as a kill. The
    neighbour is `.NAME.ENDING`; without an ending (for who holds no lock) one that no other process has. Raises
    `OSError`.
    """
    target = Path(path)
    neighbour = target.with_name(f".{target.name}.{ending or os.getpid()}")
    try:
        with neighbour.open("w", encoding="utf-8", newline="") as stream:
            stream.write(text)
            if flush:
                stream.flush()
                os.fsync(stream.fileno())
        if target.exists():
            neighbour.chmod(target.stat().st_mode & 0o7777)
        neighbour.replace(target)
    except OSError:
        neighbour.unlink(missing_ok=True)
        raise
    if flush and sys.platform != "win32":
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


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
