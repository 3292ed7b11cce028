"""A chain of a robot's tree (URDF, MJCF) as an arm: frames, limits and weights, and what the arm file still lacks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from linkwright.core.arm.chain.chain import Arm, Branch, EffectEntry, Joint
from linkwright.core.arm.chain.vectors import Vector, add, scale, subtract
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown

from .imported_arm import Imported, Lacking
from .reading.elements import read_elements
from .reading.mjcf import mjcf_tree
from .reading.tree import Robot, TreeJoint
from .reading.urdf import urdf_tree
from .way import INERTIAL, Way, plain, way_to


def import_robot(path: Path | str, *, base: str | None = None, tip: str | Sequence[str] | None = None) -> Imported:
    """The arm from a link `base` (the root by default) to a link `tip` of a URDF or MJCF file (of the latter a body or
    a site); to several tips, as many arms on the torso that they share.

    Raises `InputError` for a file that is neither, for a tip that is ambiguous or not beyond the base, for joints on
    the way that an arm cannot have, and for tips that share no joint that moves or part at several places.
    """
    top = read_elements(path)
    robot = mjcf_tree(top) if top.tag == "mujoco" else urdf_tree(top)
    start = _named(robot, base, "base") if base is not None else robot.root
    tips = [tip] if isinstance(tip, str) else list(tip or ())
    only, note = ("", "") if tips else _only_tip(robot, start)
    ends = [_named(robot, item, "tip") for item in tips] or [only]
    if len(set(ends)) < len(ends):
        raise InputError(robot.file, "tip", "names a link twice; name each tip once")
    chains = [way_to(robot, start, end) for end in ends]
    if len(ends) == 1:
        made = Way(robot, start, ends[0], chains[0]).made()
        return replace(made, notes=(*made.notes, note)) if note else made
    return _several(robot, start, ends, chains)


def weight_to_write(path: Path, link: str) -> str:
    """What to write into a URDF or MJCF that does not say what a link weighs. Raises `InputError`."""
    top = read_elements(path)
    if top.tag != "mujoco":
        return f'write <inertial> <mass value="1.2"/> ... </inertial> (kg) into link {link}'
    robot = mjcf_tree(top)
    files = ", ".join(dict.fromkeys(robot.links[link].unread if link in robot.links else ()))
    return f"write {INERTIAL} into body {link}{f' ({files} is not there as a closed STL)' if files else ''}"


def _several(robot: Robot, start: str, ends: Sequence[str], chains: Sequence[Sequence[TreeJoint]]) -> Imported:
    """Several arms on one torso: each way read by itself, without the weights of the others, and put together."""
    ways = _ways(robot, start, ends, chains)
    shared = _shared(robot, ends, [way.joint_names for way in ways])
    first = ways[0].arm
    joints, links = list(first.joints), list(first.links)
    foot = scale(first.links[shared - 1].length, first.links[shared - 1].direction)
    numbers = [list(range(first.size))]
    effects = list(first.effects)
    branches = [Branch(_branch_name(ends[0], ()), shared, first.size, first.tool)]
    for end, way in zip(ends[1:], ways[1:], strict=True):
        at, number = len(joints), way.arm
        _check_torso(robot, way, shared)
        places = {k: at + k - shared for k in range(shared, number.size)}
        joints += _onward(number, shared, foot, places)
        links += number.links[shared:]
        numbers.append([*range(shared), *places.values()])
        effects += _beyond(number, numbers[-1], shared)
        branches.append(
            Branch(_branch_name(end, [branch.name for branch in branches]), at, len(joints), number.tool, away=1.0)
        )
    _check_torso(robot, ways[0], shared)
    arm = replace(
        first,
        joints=tuple(joints),
        links=tuple(links),
        branches=tuple(branches),
        every_tip=True,
        effects=tuple(effects),
    )
    names = [(way.joint_names, way.link_names) for way in ways]
    return Imported(
        arm,
        robot.file,
        start,
        ", ".join(ends),
        (*names[0][0], *(name for item, _ in names[1:] for name in item[shared:])),
        (*names[0][1], *(name for _, item in names[1:] for name in item[shared:])),
        tuple(dict.fromkeys(note for way in ways for note in way.notes)),
        _together([way.lacking for way in ways], numbers),
        tuple(dict.fromkeys(said for way in ways for said in way.lost)),
        tuple(dict.fromkeys(doubt for way in ways for doubt in way.doubts)),
        tuple(dict.fromkeys(said for way in ways for said in way.unread)),
    )


def _onward(arm: Arm, shared: int, foot: Vector, places: Mapping[int, int]) -> list[Joint]:
    """A way's joints beyond those that it shares, the first from the `foot` (m) of all; `places` are in the whole."""
    before = arm.links[shared - 1]
    place = add(scale(before.length, before.direction), arm.joints[shared].origin_translation)
    first, *rest = (
        joint if joint.follows is None else replace(joint, follows=joint.follows.moved(places))
        for joint in arm.joints[shared:]
    )
    return [replace(first, origin_translation=plain(subtract(place, foot))), *rest]


def _beyond(arm: Arm, numbers: Sequence[int], shared: int) -> list[EffectEntry]:
    """What a way's effects say of joints beyond those that it shares, by their numbers in the whole arm."""
    effects = [replace(effect, at=tuple(numbers[k - 1] + 1 for k in effect.at if k > shared)) for effect in arm.effects]
    return [effect for effect in effects if effect.at]


def _ways(robot: Robot, start: str, ends: Sequence[str], chains: Sequence[Sequence[TreeJoint]]) -> list[Imported]:
    """Each way by itself, without the weights of the others."""
    moving = [{joint.name for joint in chain if joint.kind != "fixed"} for chain in chains]
    imports: list[Imported] = []
    for number, (end, chain) in enumerate(zip(ends, chains, strict=True)):
        beyond = frozenset[str]().union(*(names for k, names in enumerate(moving) if k != number))
        imports.append(Way(robot, start, end, list(chain), beyond).made())
    return imports


def _shared(robot: Robot, ends: Sequence[str], names: Sequence[Sequence[str]]) -> int:
    """How many joints several ways have in common, all of them the same; raises `InputError` for none, and for more."""
    count = 0
    while all(len(item) > count + 1 for item in names) and len({item[count] for item in names}) == 1:
        count += 1
    listed = ", ".join(map(shown, ends))
    if not count:
        message = f"{listed} share no joint that moves, so that none loads another; import each by itself"
        raise InputError(robot.file, "tip", message)
    if len({item[count] for item in names}) < len(names):
        raise InputError(robot.file, "tip", f"{listed} part at several places; name tips that part at one")
    return count


def _check_torso(robot: Robot, way: Imported, shared: int) -> None:
    """Refuse a joint beyond the shared ones that mimics one of them."""
    for joint, name in list(zip(way.arm.joints, way.joint_names, strict=True))[shared:]:
        if joint.follows is not None and joint.follows.ties[0].joint < shared:
            message = "mimics a joint that its arm shares with others, which no branch can; import its arm by itself"
            raise robot.joints[name].element.error(message)


def _branch_name(link: str, taken: Sequence[str]) -> str:
    """A branch's name, which begins columns: letters and digits of the link's."""
    plain = "".join(c if c.isascii() and c.isalnum() else "_" for c in link).strip("_")
    plain = plain if plain[:1].isalpha() else f"arm_{plain}"
    return plain if plain not in taken else f"{plain}_{len(taken) + 1}"


def _together(lists: Sequence[Sequence[Lacking]], numbers: Sequence[Sequence[int]]) -> tuple[Lacking, ...]:
    """What several ways lack, said once, with the numbers of joints and links in the whole arm."""
    results: dict[tuple[str, str], Lacking] = {}
    for item, places in zip(lists, numbers, strict=True):
        for one in item:
            at = tuple(places[number - 1] + 1 for number in one.at)
            before = results.get((one.what, one.shows))
            merged = at if before is None else tuple(sorted({*before.at, *at}))
            results[one.what, one.shows] = replace(one, at=merged)
    return tuple(results.values())


def _named(robot: Robot, name: str, option: str) -> str:
    if name not in robot.links:
        raise InputError(robot.file, option, f"there is no link {shown(name)}{nearest(name, list(robot.links))}")
    return name


def _only_tip(robot: Robot, start: str) -> tuple[str, str]:
    """The end of the tree that joints move, and what is to be said where several ends move with the same joints. Raises
    `InputError` with all of them where ends move with different ones."""
    ends, ways = _ends(robot, start)
    if not ends:
        raise InputError(robot.file, "", f"no joint beyond {shown(start)} moves; an arm has at least one that does")
    listed = sorted(ends, key=lambda name: (-len(ends[name]), name))
    example = next((name for name in listed if robot.links[name].mass == 0.0), None)
    if len(set(ends.values())) == 1:
        chosen = example or listed[0]
        others = ", ".join(name for name in listed if name != chosen)
        note = f"The tip is {chosen}. With it move {others}, and torques are the same for each: --tip names another"
        return chosen, note if others else ""
    parting = [names[0] for names in zip(*ways, strict=False) if len(set(names)) == 1][-1]
    if example is None and any(joint.moves for joint in way_to(robot, start, parting)):
        example = f"{parting}, where they part"  # an arm with a gripper's fingers
    words = ", ".join(f"{name} ({len(ends[name])} joint{'s' if len(ends[name]) > 1 else ''})" for name in listed[:12])
    more = f" and {len(listed) - 12} more" if len(listed) > 12 else ""
    message = f"has {len(ends)} ends: {words}{more}; name one, e.g. --tip {example or listed[0]}"
    raise InputError(robot.file, "tip", message)


def _ends(robot: Robot, start: str) -> tuple[dict[str, tuple[str, ...]], list[list[str]]]:
    """The ends of the tree that joints move, each with these joints, and the links on the way to each."""
    ends: dict[str, tuple[str, ...]] = {}
    ways: list[list[str]] = []
    pending: list[tuple[list[str], tuple[str, ...]]] = [([start], ())]
    while pending:
        way, moving = pending.pop()
        onward = robot.below[way[-1]]
        if not onward and moving:
            ends[way[-1]] = moving
            ways.append(way)
        pending += [([*way, joint.child], (*moving, joint.name) if joint.moves else moving) for joint in onward]
    return ends, ways
