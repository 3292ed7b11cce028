"""An imported arm described: which joints and links it has, what was decided, what its file lacks."""

from __future__ import annotations

from arm.descriptions.imported import Imported
from linkwright.json.exchange import weight

from .document import Description, Item, Lines, Paragraph, Value, count, length, table
from .figures_in_words import coordinate, figure


def describe(found: Imported) -> Description:
    """What was read and what is lacking."""
    arm = found.arm
    rows = [
        (
            count(number + 1),
            found.joint_names[number],
            Value(f"{coordinate(arm, number, joint.range[0])} to {coordinate(arm, number, joint.range[1])}"),
            found.link_names[number],
            length(link.length),
            Value(f"{figure(weight(link))} kg"),
        )
        for number, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True))
    ]
    items: list[Item] = [table(("", "joint", "range", "link", "length", "mass"), rows)]
    if found.notes:
        items.append(Lines(tuple(f"{note}." for note in found.notes)))
    items.append(Paragraph("What the file does not say:", "lead"))
    lacking = [
        (each.what + (f" ({', '.join(map(str, each.at))})" if each.at else ""), each.shows, each.add)
        for each in found.lacking
    ]
    items.append(table(("lacking", "what it would show", "what to add"), lacking))
    size = f"{arm.size} joint{'s' if arm.size > 1 else ''}"
    total = sum(weight(link) for link in arm.links)
    headline = f"{size} from {found.base} to {found.tip}, {figure(total)} kg that move"
    return Description(f"{arm.name}: from {found.file.name}", headline, tuple(items), headline, f"{arm.name}: ")
