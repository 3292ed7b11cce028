"""Lists in sentences: `a, b and c`, `rows 4, 7 to 12 and 30`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

_MOST = 6


def listed(words: Sequence[str], last: str = "and") -> str:
    """`a, b and c`; nothing of none."""
    return f"{', '.join(words[:-1])} {last} {words[-1]}" if len(words) > 1 else "".join(words)


def rows_text(rows: Iterable[int]) -> str:
    """Rows by number, runs as `7 to 12`; a long list ends with how many more there are."""
    numbers = sorted({int(row) for row in rows})
    runs: list[tuple[int, int]] = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1] = (runs[-1][0], number)
        else:
            runs.append((number, number))
    parts = [str(first) if first == last else f"{first} to {last}" for first, last in runs[:_MOST]]
    more = sum(last - first + 1 for first, last in runs[_MOST:])
    if more:
        parts.append(f"{more} more")
    return f"row{'s' if len(numbers) > 1 else ''} {listed(parts)}"
