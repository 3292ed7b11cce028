"""What is said of links one by one: `{1: [circle], 3: [tube], others: [tube, i_section]}`, or once for all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, cast

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.reading import Mapping

Item = TypeVar("Item")
OTHERS = "others"


@dataclass(frozen=True)
class ByLink(Generic[Item]):
    """What holds for each link, None where nothing is said; `alike`: it was said once for all."""

    each: tuple[Item | None, ...]
    alike: bool


def by_link(body: Mapping, key: str, arm: Arm, read: Callable[[Mapping, str], Item]) -> ByLink[Item]:
    """What stands under a key for each link; `read` reads a key of a mapping. Raises `InputError`
    for a link that there is not, or that nothing is said of."""
    if not body.has(key):
        return ByLink((None,) * arm.size, True)
    raw = body.raw(key)
    if not said_by_number(raw):
        return ByLink((read(body, key),) * arm.size, True)
    entries = {str(number): entry for number, entry in cast(dict[object, object], raw).items()}
    elastic = [str(number) for number, link in enumerate(arm.links, start=1) if link.section is not None]
    for number in entries:
        if number != OTHERS and number not in elastic:
            raise body.error(f"{key}.{number}", f"is no link with a section; those are {', '.join(elastic)}")
    lacking = [number for number in elastic if number not in entries]
    if lacking and OTHERS not in entries:
        raise body.error(key, f"says nothing of link {', '.join(lacking)}; add others: [...]")
    if not lacking and OTHERS in entries:
        raise body.error(f"{key}.{OTHERS}", "is of no link; leave it out")
    with Mapping(entries, file=body.file, key=body.path_of(key)).reading() as mapping:
        made = {number: read(mapping, number) for number in entries}
    whole = [str(number) for number in range(1, arm.size + 1)]
    return ByLink(tuple(made.get(number, made.get(OTHERS)) for number in whole), False)


def said_by_number(raw: Any) -> bool:
    """Whether an entry's keys are numbers of links, or `others`."""
    keys = list(cast(dict[object, object], raw)) if isinstance(raw, dict) else []
    return bool(keys) and all(str(name).isdigit() or name == OTHERS for name in keys)
