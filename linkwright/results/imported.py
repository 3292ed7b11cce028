"""An imported arm described: which joints and links it has, what was decided, what its file lacks."""

from __future__ import annotations

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.imported_arm import Imported
from linkwright.json.exchange import weight

from .document import Description, Item, Lines, Paragraph, Value, amount, count, length, table
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
            amount(weight(link), "kg"),
        )
        for number, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True))
    ]
    items: list[Item] = [table(("", "joint", "range", "link", "length", "mass"), rows)]
    if found.notes:
        items.append(Lines(tuple(f"{note}." for note in found.notes)))
    if found.doubts:
        items.append(Paragraph("Weights to look at:", "lead"))
        items.append(Lines(tuple(f"{doubt}." for doubt in found.doubts)))
    if found.lost:
        items.append(table(("not carried",), [(each,) for each in found.lost]))
    items.append(Paragraph("What the file does not say:", "lead"))
    lacking = [
        (each.what + (f" ({', '.join(map(str, each.at))})" if each.at else ""), each.shows, each.add)
        for each in found.lacking
    ]
    items.append(table(("lacking", "what it would show", "what to add"), lacking))
    size = f"{arm.size} joint{'s' if arm.size > 1 else ''}"
    headline = f"{size} from {found.base} to {found.tip}, {_moving(arm)}"
    return Description(f"{arm.name}: from {found.file.name}", headline, tuple(items), headline, f"{arm.name}: ")


def _moving(arm: Arm) -> str:
    """What of the arm moves weighs, as far as it is known."""
    known = [mass for link in arm.links if (mass := weight(link)) is not None]
    unknown = [str(number) for number, link in enumerate(arm.links, start=1) if weight(link) is None]
    if not known:
        return "nothing of its weight is known"
    said = f"{figure(sum(known))} kg that move"
    return f"{said}, without link{'s' * (len(unknown) > 1)} {', '.join(unknown)} of unknown mass" if unknown else said
