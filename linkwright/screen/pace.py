"""When a part of long work ends, by what share of it is behind and how long that took."""

from __future__ import annotations

_ENOUGH = 0.01
"""A share behind from which an end is estimated."""
_ANEW = 0.5
"""Where the share falls below this part of what it was, another part of the work has begun."""


class Pace:
    """Hears shares (0 to 1) with the time of day at which each was reached; parts follow one another."""

    def __init__(self, now: float) -> None:
        self._began, self._before, self.share = now, 0.0, 0.0

    def heard(self, share: float, now: float) -> None:
        """A share that is reached now."""
        if share < _ANEW * self.share:
            self._began, self._before = now, share
        self.share = share

    def left(self, now: float) -> float | None:
        """Seconds until the end of the part; None as long as nothing can be said of it."""
        gone = self.share - self._before
        if gone < _ENOUGH or not self.share < 1.0:
            return None
        return (now - self._began) * (1.0 - self.share) / gone


def in_words(seconds: float | None) -> str:
    """An estimate of a time, as coarse as it is."""
    if seconds is None:
        return ""
    if seconds < 90.0:
        return f"about {max(round(seconds), 1)} s left"
    minutes = seconds / 60.0
    return f"about {minutes:.0f} min left" if minutes < 90.0 else f"about {minutes / 60.0:.0f} h left"
