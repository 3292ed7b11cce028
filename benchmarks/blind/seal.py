"""Seals: the SHA-256 of each truth and of the whole list, written before any tool has run, checked before scoring."""

from __future__ import annotations

import hashlib
from pathlib import Path

SEAL = "seal.txt"


class BrokenSealError(ValueError):
    """A truth is not the one that was sealed."""


def digest(data: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def write_seal(root: Path, half: str) -> str:
    """Seals all truths under root; returns the digest of the whole list."""
    lines = [f"{digest(path.read_bytes())}  {path.name}" for path in sorted((root / "truth").glob("*.json"))]
    body = "\n".join([f"half {half}", *lines]) + "\n"
    whole = digest(body.encode())
    (root / SEAL).write_text(body + f"whole {whole}\n", encoding="utf-8", newline="\n")
    return whole


def half_of(root: Path) -> str:
    """Whether these cases are disclosed or sealed."""
    return (root / SEAL).read_text(encoding="utf-8").split("\n", 1)[0].removeprefix("half ")


def check_seal(root: Path) -> str:
    """Raises BrokenSealError where a truth was changed, added or lost; returns the digest of the whole."""
    text = (root / SEAL).read_text(encoding="utf-8")
    body, _, whole = text.rstrip("\n").rpartition("\nwhole ")
    if digest((body + "\n").encode()) != whole:
        raise BrokenSealError(f"{root / SEAL}: the list is not the one that was sealed")
    listed = {line[66:]: line[:64] for line in body.split("\n")[1:]}
    there = {path.name: digest(path.read_bytes()) for path in (root / "truth").glob("*.json")}
    if there != listed:
        names = sorted(name for name in {*there, *listed} if there.get(name) != listed.get(name))
        raise BrokenSealError(f"{root}: {len(names)} truths differ from their seal, first {names[0]}")
    return whole
