"""`branches:` several arms on one torso, read and written: the file's chain is the torso, each branch has its own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from linkwright.core.arm.chain.chain import Branch, FloatVector, Joint, Link, LoadCase
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import shown
from linkwright.core.units.reading import Mapping

from .chain_entries import Entry, joined, read_entry
from .origin import read_origin, read_vector

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_FEWEST = 2


@dataclass(frozen=True)
class Branches:
    """What an arm file's `branches` hold: the joints and links of all, one branch after the other, and where each is
    in the whole arm."""

    joints: tuple[Joint, ...]
    links: tuple[Link, ...]
    each: tuple[Branch, ...]


def read_branches(mapping: Mapping, catalogue: Catalogue, torso: int) -> Branches:
    """The branches of a file whose torso has so many joints; none where it has none. The tip is the first branch's."""
    if not mapping.has("branches"):
        return Branches((), (), ())
    for name in ("payload", "tool", "product_of_exponentials"):
        if name in mapping.content:
            raise mapping.error(name, "is each branch's own in a file with branches; write it there")
    bodies = mapping.mappings("branches")
    if len(bodies) < _FEWEST:
        raise mapping.error("branches", "needs two arms or more on the torso; one alone goes on in the chain")
    joints: list[Joint] = []
    links: list[Link] = []
    branches: list[Branch] = []
    for body in bodies:
        with body.reading():
            name = body.text("name")
            if _NAME.fullmatch(name) is None:
                raise body.error("name", f"begins columns such as left_q1_deg: letters and digits, not {shown(name)}")
            if name in (branch.name for branch in branches):
                raise body.error("name", f"{shown(name)} is there twice")
            if body.has("at") and body.integer("at") != torso:
                raise body.error("at", f"can be {torso} only: branches stand on the last link of the torso (chain)")
            entries = _entries(body, catalogue)
            branch_joints, branch_links = joined(body, entries)
            first = torso + len(joints)
            # A branch's joints are numbered within it, as its columns are.
            whole = dict(zip(range(len(branch_joints)), range(first, first + len(branch_joints)), strict=True))
            branch_joints = tuple(
                joint if joint.follows is None else replace(joint, follows=joint.follows.moved(whole))
                for joint in branch_joints
            )
            tool = _tool(body)
            payload = _payload(body)
            branches.append(Branch(name, first, first + len(branch_joints), tool, payload, 1.0 if branches else 0.0))
        joints += branch_joints
        links += branch_links
    return Branches(tuple(joints), tuple(links), tuple(branches))


def _entries(body: Mapping, catalogue: Catalogue) -> list[Entry]:
    chain = body.mappings("chain")
    if not chain:
        raise body.error("chain", "is empty; a branch has at least one joint with its link")
    entries = [read_entry(item, catalogue, number, len(chain)) for number, item in enumerate(chain, start=1)]
    for number, entry in enumerate(entries, start=1):
        if entry.motor is not None:
            message = "is not read in a branch, but in the torso; give its mass as one of a link's masses"
            raise body.error(f"chain[{number}].joint.motor", message)
    if body.has("origin"):
        if entries[0].origin is not None:
            raise body.error("origin", "is given by the branch's first joint already; leave one of them out")
        origin, free = read_origin(body)
        entries[0] = replace(entries[0], origin=origin, joint=replace(entries[0].joint, origin_free=free))
    return entries


def _tool(body: Mapping) -> FloatVector:
    if not body.has("tool"):
        return ZERO
    with body.mapping("tool").reading() as offset:
        return read_vector(offset, "xyz", "length", ZERO)


def _payload(body: Mapping) -> LoadCase:
    if not body.has("payload"):
        return LoadCase()
    with body.mapping("payload").reading() as load:
        return LoadCase(load.not_negative("mass", "mass", 0.0))


def tip_named(mapping: Mapping, branches: Sequence[Branch], tip: str | None) -> str:
    """The branch asked for: the first for an empty name, none where there are no branches. Raises `InputError` where
    there is no such."""
    names = [branch.name for branch in branches]
    if not names:
        if tip:
            raise mapping.error("branches", f"are not in the file, so it has no tip {shown(tip)}; leave it out")
        return ""
    if tip and tip not in names:
        raise mapping.error("branches", f"have no tip {shown(tip)}, but {', '.join(names)}{nearest(tip, names)}")
    return tip or names[0]
