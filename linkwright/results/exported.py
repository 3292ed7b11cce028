"""An exported arm described: what the file carries and what it does not."""

from __future__ import annotations

from linkwright.core.arm.descriptions.formats import Exported

from .document import Description, Item, table


def describe(found: Exported) -> Description:
    """What went into the file and what did not."""
    rows = [("carried", each) for each in found.carried]
    rows += [("not carried", each) for each in found.lost]
    rows += [("assumed", each) for each in found.assumed]
    items: tuple[Item, ...] = (table(("", ""), rows),)
    left = f"{len(found.lost)} not carried" if found.lost else "nothing left out"
    headline = f"{found.format.upper()}, {left}"
    return Description(f"{found.arm.name}: as {found.format.upper()}", headline, items, headline, f"{found.arm.name}: ")
