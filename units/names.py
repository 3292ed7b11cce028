"""What somebody may have meant by a name that is not known."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

_ALIKE = 0.6
"""How alike two names are (`difflib`, 1 for equal ones) from which on one is taken for a slip of the other."""
_MOST = 12
"""How many known names a message lists."""


@dataclass(frozen=True)
class Known:
    """Something that is known by its name alone, and what people call it as well."""

    synonyms: tuple[str, ...] = ()


def meant(name: str, known: Iterable[str], alike: float = _ALIKE) -> str | None:
    """Return the known name that somebody means by another: one that says the same (`synonyms`), or the one most like
    it or like one that says the same; None where there is none.

    `known` are names, or what they stand for by name, which may have `synonyms`: what people call it as well.
    """
    held: Mapping[str, Any] = known if isinstance(known, Mapping) else dict.fromkeys(known)
    by_word: dict[str, str] = {}
    for key, thing in held.items():
        for synonym in getattr(thing, "synonyms", ()):
            by_word.setdefault(_plain(synonym), key)
    by_word |= {_plain(item): item for item in held}
    word = _plain(name)
    close = [word] if word in by_word else difflib.get_close_matches(word, list(by_word), n=1, cutoff=alike)
    return by_word[close[0]] if close else None


def nearest(name: str, known: Iterable[str], alike: float = _ALIKE) -> str:
    """Return `; did you mean 'X'?` for what a name means (see `meant`), the names that hold it as a word
    (`steel`), or a short list of what is known."""
    held: Mapping[str, Any] = known if isinstance(known, Mapping) else dict.fromkeys(known)
    said = meant(name, held, 1.0) is not None
    family = [item for item in held if not said and f"_{_plain(name)}_" in f"_{_plain(item)}_"]
    if len(family) > 1:
        return f"; did you mean one of {', '.join(family[:_MOST])}{', ...' if len(family) > _MOST else ''}?"
    result = meant(name, family or held, alike if not family else 0.0)
    if result is not None:
        return f"; did you mean '{result}'?"
    return f"; known: {', '.join([*held][:_MOST])}{', ...' if len(held) > _MOST else ''}" if held else ""


def _plain(name: str) -> str:
    """A name without what nobody means anything by: case, hyphens, blanks."""
    return re.sub(r"[\s_-]+", "_", name.strip().lower())
