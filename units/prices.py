"""A price as a catalogue or a list of prices holds it: worth something only with its date and where it is from."""

from __future__ import annotations

from dataclasses import dataclass

from .reading import Mapping


@dataclass(frozen=True)
class Price:
    """A price (`value`, EUR or EUR/kg), the lowest and highest to expect (None: not known), when it was such
    (`2026-01`), where it is from, and what a reader should know."""

    value: float
    spread: tuple[float, float] | None
    date: str
    source: str
    note: str = ""


def read_prices(keys: Mapping, kind: str) -> dict[str, Price]:
    """The `prices` of a catalogue file by the names of what they are for, none without that key: prices alone, which
    replace those of other catalogues. `kind` is their kind of quantity. Raises `InputError`."""
    if not keys.has("prices"):
        return {}
    listed = keys.mapping("prices")
    prices: dict[str, Price] = {}
    for name in listed.content:
        with listed.mapping(name).reading() as price:
            value = price.quantity("value", kind)
            if value < 0.0:
                raise price.error("value", "must not be negative")
            spread = price.range("spread", kind) if price.has("spread") else None
            if spread is not None and not 0.0 <= spread[0] <= value <= spread[1]:
                raise price.error("spread", "must hold the value, and nothing below zero")
            note = price.text("note", "")
            prices[name] = Price(value, spread, price.when("date"), price.text("source"), note)
    return prices
