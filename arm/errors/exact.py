"""The arm as it really stands: finite motions, and loads on the deformed shape.

To first order the twists along a chain add up, and loads act at the undeformed pose. For an arm that bends by
millimetres both are off by micrometres. Here the same twists, from the same effects, are finite motions: each carries
all that lies beyond it, turned as it has been turned by those before it (R. W. Brockett, in: Mathematical Theory of
Networks and Systems, Springer 1984, 120, doi:10.1007/BFb0031048). Loads are solved for again on the shape that they
give the arm, until it no longer changes. Elastic links are cut into pieces, each of which takes its strain as constant,
so that it bends to an arc (J. C. Simo, Comput. Methods Appl. Mech. Eng. 49 (1985) 55,
doi:10.1016/0045-7825(85)90050-7).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import columns, matrices
from linkwright.core.arm.chain.kinematics import Frames, JointFrame, LinkFrame, Orientation
from linkwright.core.arm.chain.segments import PIECES, Pieces, cut
from linkwright.core.arm.chain.statics import JointState, LinkState, PoseState, solve
from linkwright.core.arm.chain.vectors import (
    IDENTITY,
    ZERO,
    Scalar,
    Vector,
    add,
    compose,
    cross,
    dot,
    is_zero,
    plus,
    rotate,
    scale,
    subtract,
    times,
    transpose,
)
from linkwright.core.arm.chain.vectors import Rotation as Rows
from linkwright.core.arm.effects import Twist
from linkwright.core.arm.effects.effect import NO_LOAD
from linkwright.core.arm.effects.loads.added_weights import bearing, borne_wholly
from linkwright.core.sections.numeric import Array

from .finite_turns import after, arc, half_of, matrix
from .tip import ActiveEffect, on_the_way

Node = tuple[str, int]

SETTLED = 1e-9
"""m; the shape is found when a pass moves no tip by more."""
MOST_PASSES = 30


@dataclass(frozen=True)
class Deformed:
    """An arm at N poses as it stands. `state` holds its places and loads there, so that an effect's twists are those
    about this shape; `tip` (N, 3) m and `turn` (N, 3) rad are how far the tip has moved and turned from nominal.

    `settled` (N,) says where the passes have met their tolerance: a shape that is about to buckle has none. `turned`
    are the rotations (N, 3, 3), from where they would stand undeformed, of the base and of each link's far end.
    """

    state: PoseState
    tip: Array
    turn: Array
    settled: NDArray[np.bool_]
    turned: tuple[Array, ...] = ()


@dataclass(frozen=True)
class Shape:
    """Places and orientations along the chain, and what the effects did at them.

    `pieces` are the frames of the cut arm, `whole` those of the arm itself; `lengths` (m) each link's, with what
    effects add to it; `turned` how the base and each link's far end are turned, `end` the tip. `tip` (N, 3) m is how
    far that has moved, `seen_turned` (N, 3) rad by how much more than it is turned an instrument sees it turned.
    `undeformed` are the frames of the arm at its nominal pose.
    """

    pieces: Frames
    whole: Frames
    lengths: tuple[Scalar, ...]
    tip: Array
    end: Rows
    turned: tuple[Rows, ...]
    undeformed: Frames
    seen_turned: Array | float = 0.0

    def at(self, rows: NDArray[np.intp]) -> Shape:
        """The shape at some of its poses."""
        return _taken(self, rows, len(self.tip))

    def turn(self, rows: int) -> Array:
        """How the tip is turned (N, 3), rad."""
        return Rotation.from_matrix(matrices(self.end, rows)).as_rotvec() + self.seen_turned


def deformed(state: PoseState, effects: Sequence[ActiveEffect], rows: int, *, play_stays: bool = False) -> Deformed:
    """The arm of `state` (numbers or arrays of `rows`, at its undeformed pose) with `effects` as finite motions.

    Play lies where the loads on the shape seat it, or, where it `play_stays`, where those of the undeformed pose do.
    A joint that nothing loads at the undeformed pose (about a plumb axis) is loaded by a hair on the shape, which the
    least friction holds: there its play lies on the side that the joint came from, in the middle where nobody knows.

    Effects of the instrument move nothing of the arm; they are added to first order in what it has moved. Where play
    that the load seats one way makes it seat the other way (a link that hangs nearly plumb), passes go to and fro
    between two shapes for ever: the arm stands between them, and the middle is taken.
    """
    return settled_shape(state, effects, rows, play_stays=play_stays)[0]


def settled_shape(
    state: PoseState, effects: Sequence[ActiveEffect], rows: int, *, play_stays: bool = False
) -> tuple[Deformed, Shape]:
    """What `deformed` finds, and the shape of the last pass, with which `bent_on` goes on to poses nearby."""
    chain = _Chain(state, rows, _carries_slopes(effects), play_stays)
    shape, now = chain.straight(), state
    last = earlier = shape
    tip, done, between = shape.tip, np.zeros(rows, dtype=bool), np.zeros((rows, 1), dtype=bool)
    for _ in range(MOST_PASSES):
        earlier, last = last, shape
        result, there = chain.bent(shape, effects)
        if not np.isfinite(result.tip).all():  # it is bent beyond all numbers
            break
        shape, now = result, there
        settled = np.linalg.norm(shape.tip - last.tip, axis=1) <= SETTLED
        swinging = ~settled & (np.linalg.norm(shape.tip - earlier.tip, axis=1) <= SETTLED)
        # A pose that is found stays as it is: what it is depends on no other that is computed with it.
        between, known = swinging[:, None], done[:, None]
        tip = np.where(known, tip, np.where(between, 0.5 * (shape.tip + last.tip), shape.tip))
        done = done | settled | swinging
        if done.all():
            break
    turn = shape.turn(rows)
    if between.any():
        turn = np.where(between, 0.5 * (turn + last.turn(rows)), turn)
    return Deformed(now, tip, turn, done, tuple(matrices(item, rows) for item in shape.turned)), shape


def bent_on(
    last: Shape, state: PoseState, effects: Sequence[ActiveEffect], rows: int
) -> tuple[Shape, NDArray[np.bool_]]:
    """The shape that the loads on a `last` one give the arm of `state`, whose poses are near those of that: one pass.
    As the poses come to rest, it becomes the one that `deformed` finds where it says so (rows,): elsewhere play lies on
    another side than the undeformed pose would have it, and on which depends on where the passes came from."""
    chain = _Chain(state, rows, _carries_slopes(effects), play_stays=False)
    shape, now = chain.bent(chain.taken_along(last), effects)
    return shape, chain.seated_as_undeformed(now, effects)


def _carries_slopes(effects: Iterable[ActiveEffect]) -> bool:
    """Whether bent links turn what follows: an arm without that has no pieces that could turn each other."""
    return any(effect.effect.link.turns_along for effect in effects)


class _Chain:
    """The arm at its undeformed poses, cut into pieces."""

    def __init__(self, state: PoseState, rows: int, cut_links: bool, play_stays: bool) -> None:
        self.state, self.rows, self.play_stays = state, rows, play_stays
        self.beams = [link.beam for link in state.links]
        self.pieces: Pieces = cut(state.arm, self.beams, PIECES if cut_links else 1)
        self.nominal = columns(state.tip(), rows)
        self.before = [joint.before.matrix() for joint in state.frames.joints]

    def straight(self) -> Shape:
        """The shape without anything at work."""
        nothing = [ZERO] * len(self.pieces.owner)
        return self._walk({}, {}, nothing, nothing, [beam.length for beam in self.beams])

    def taken_along(self, shape: Shape) -> Shape:
        """A shape at other poses taken to these, each link turned as the undeformed one is."""
        pairs = zip(self.state.frames.links, shape.undeformed.links, strict=True)
        turns = [compose(transpose(_directions(now)), _directions(then)) for now, then in pairs]
        return replace(
            shape,
            pieces=_with_links(shape.pieces, turns, self.pieces.owner),
            whole=_with_links(shape.whole, turns, range(len(turns))),
        )

    def bent(self, shape: Shape, effects: Sequence[ActiveEffect]) -> tuple[Shape, PoseState]:
        """The shape that the loads on `shape` give, and the state on it."""
        cut_state = self._loaded(shape)
        now = self._whole(shape, cut_state)
        seating = self._seating(now)
        moved: dict[Node, Vector] = {}
        turned: dict[Node, Vector] = {}
        strain: list[Vector] = [ZERO] * len(self.pieces.owner)
        bend: list[Vector] = [ZERO] * len(self.pieces.owner)
        seen_tip: list[Twist] = []
        for active in effects:
            effect, settings = active.effect, active.settings
            if effect.link.along:
                at = tuple(k for link in settings.at for k in self.pieces.of(link))
                for twist in on_the_way(cut_state.arm, effect.twists(cut_state, replace(settings, at=at))):
                    strain[twist.index] = add(strain[twist.index], twist.translation)
                    bend[twist.index] = add(bend[twist.index], twist.rotation)
                continue
            twists = [*on_the_way(now.arm, [*effect.twists(now, settings), *effect.play.seated(seating, settings)])]
            if effect.recording.of_instrument and effect.place in ("base", "tip"):
                seen_tip += twists
                continue
            for twist in twists:
                key = (twist.node, twist.index if twist.node in ("joint", "link") else 0)
                moved[key] = add(moved.get(key, ZERO), twist.translation)
                turned[key] = add(turned.get(key, ZERO), twist.rotation)
        lengths: list[Scalar] = []
        for index, beam in enumerate(self.beams):
            length: Scalar = beam.length
            shift = moved.get(("link", index), ZERO)
            if not is_zero(shift):
                # What lengthens a link makes it a longer beam; what is left shifts its far end.
                along = now.links[index].along
                longer = times(dot(shift, along), np.where(np.asarray(length) > 0.0, 1.0, 0.0))
                moved["link", index] = subtract(shift, scale(longer, along))
                length = plus(length, longer)
            lengths.append(length)
        shape_ = self._walk(moved, turned, strain, bend, lengths)
        return self._measured(shape_, seen_tip), now

    def _seating(self, now: PoseState) -> PoseState:
        """The state whose loads seat play: on the shape, but for joints that nothing loads at the undeformed pose."""
        if self.play_stays:
            return self.state
        now = borne_wholly(now)
        pairs = zip(self._loaded_undeformed, now.joints, strict=True)
        return replace(now, joints=tuple(_loaded_by_more_than_a_hair(there, *loaded) for loaded, there in pairs))

    def seated_as_undeformed(self, now: PoseState, effects: Sequence[ActiveEffect]) -> NDArray[np.bool_]:
        """Where the loads on a shape seat all play on the side on which those of the undeformed pose do."""
        same = np.ones(self.rows, dtype=bool)
        for effect, settings in ((entry.effect, entry.settings) for entry in effects):
            states = self._seating(now), self._seating(self.state)
            for here, there in zip(*(effect.play.seated(state, settings) for state in states), strict=True):
                for a, b in ((here.translation, there.translation), (here.rotation, there.rotation)):
                    same &= np.asarray(times(4.0, dot(a, b)) >= plus(dot(a, a), dot(b, b)))
        return same

    @cached_property
    def _loaded_undeformed(self) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
        """Whether each joint's drive is loaded at the undeformed pose, and whether its pin is across its axis."""
        joints = bearing(self.state).joints
        across = (cross(joint.axis, joint.force) for joint in joints)
        return [
            (np.abs(np.asarray(joint.drive_load)) > NO_LOAD, np.sqrt(dot(force, force)) > NO_LOAD)
            for joint, force in zip(joints, across, strict=True)
        ]

    def _measured(self, shape: Shape, twists: Sequence[Twist]) -> Shape:
        """The tip as an instrument that is itself off sees it."""
        tip, turn = shape.tip, shape.seen_turned
        for twist in twists:
            tip = tip + columns(twist.translation, self.rows)
            if twist.node == "base":
                place = _vector(self.nominal + tip - columns(twist.translation, self.rows))
                tip = tip + columns(subtract(rotate(matrix(twist.rotation), place), place), self.rows)
            turn = turn + columns(twist.rotation, self.rows)
        return replace(shape, tip=tip, seen_turned=turn)

    def _walk(
        self,
        moved: dict[Node, Vector],
        turned: dict[Node, Vector],
        strain: Sequence[Vector],
        bend: Sequence[Vector],
        lengths: Sequence[Scalar],
    ) -> Shape:
        """From the base out: every motion carries all that lies beyond it."""
        state, frames = self.state, self.state.frames
        carried = place = moved.get(("base", 0), ZERO)
        orientation = after(IDENTITY, turned.get(("base", 0), ZERO))
        joints: list[JointFrame] = []
        links: list[LinkFrame] = []
        cut_joints: list[JointFrame] = []
        cut_links: list[LinkFrame] = []
        turned_so_far = [orientation]
        for index, frame in enumerate(frames.links):
            before = Orientation(compose(orientation, self.before[index]), (0.0, 0.0, 1.0), 0.0)
            axis = rotate(orientation, frames.joints[index].axis)
            step = rotate(orientation, state.leads[index])
            shift = moved.get(("joint", index), ZERO)
            followed = self._followed(index, axis, joints, moved, turned, bend)
            if not state.joints[index].revolute:
                shift, followed = add(shift, followed), ZERO
            step = add(step, shift)
            place, lead = add(place, step), add(carried, step)
            orientation = after(after(orientation, turned.get(("joint", index), ZERO)), followed)
            joints.append(JointFrame(lead, axis, before))
            start, root = place, orientation
            directions = at_root = _turned(root, _directions(frame))
            pieces = self.pieces.of(index)
            length = times(1.0 / len(pieces), lengths[index])
            for number, piece in enumerate(pieces):
                half, step = arc(bend[piece], scale(length, directions[0]), strain[piece])
                middle = _turned(half, directions)
                if piece == pieces[-1]:
                    step = add(step, moved.get(("link", index), ZERO))
                cut_joints.append(JointFrame(lead if number == 0 else ZERO, axis, before))
                cut_links.append(LinkFrame(step, *middle))
                place = add(place, step)
                directions = _turned(half, middle)
            stiff = all(is_zero(bend[piece]) for piece in pieces)
            link_turn = IDENTITY if stiff else compose(transpose(directions), at_root)
            link_turn = after(link_turn, turned.get(("link", index), ZERO))
            orientation = compose(link_turn, root)
            turned_so_far.append(orientation)
            links.append(LinkFrame(subtract(place, start), *_turned(half_of(link_turn), at_root)))
            carried = ZERO
        tool = add(rotate(orientation, state.tool), moved.get(("tip", 0), ZERO))
        orientation = after(orientation, turned.get(("tip", 0), ZERO))
        end = compose(orientation, frames.orientation)
        return Shape(
            Frames(tuple(cut_joints), tuple(cut_links), tool, end),
            Frames(tuple(joints), tuple(links), tool, end),
            tuple(lengths),
            columns(add(place, tool), self.rows) - self.nominal,
            orientation,
            tuple(turned_so_far),
            frames,
        )

    def _followed(
        self,
        joint: int,
        axis: Vector,
        before: Sequence[JointFrame],
        moved: dict[Node, Vector],
        turned: dict[Node, Vector],
        bend: Sequence[Vector],
    ) -> Vector:
        """What moves a joint along its axis because it moves those that it follows (`arm.errors.tip`)."""
        total: Scalar = 0.0
        follows = self.state.arm.joints[joint].follows
        for tie in () if follows is None else follows.ties:
            there = turned if self.state.joints[tie.joint].revolute else moved
            amount = there.get(("joint", tie.joint), ZERO)
            if tie.along:
                amount = add(amount, turned.get(("link", tie.joint), ZERO))
                for piece in self.pieces.of(tie.joint):
                    amount = add(amount, bend[piece])
            total = plus(total, times(tie.weight, dot(amount, before[tie.joint].axis)))
        return scale(total, axis)

    def _loaded(self, shape: Shape) -> PoseState:
        """The statics of the cut arm on a shape."""
        state, pieces = self.state, self.pieces
        return solve(
            pieces.arm,
            pieces.coordinates([joint.coordinate for joint in state.joints]),
            pieces.beams(self.beams, shape.lengths),
            pieces.load(state.load),
            gravity=state.gravity,
            conditions=pieces.conditions(state.conditions),
            payload_mass=state.payload_mass,
            tip_force=state.tip_force,
            frames=shape.pieces,
        )

    def _whole(self, shape: Shape, cut_state: PoseState) -> PoseState:
        """The arm itself on a shape, with the loads of its pieces."""
        first, pieces = self.pieces.first, self.pieces
        joints = tuple(
            replace(cut_state.joints[piece], spans=joint.spans)
            for piece, joint in zip(first, self.state.joints, strict=True)
        )
        links = tuple(
            _link(link, shape.whole.links[index], cut_state.links[first[index]], cut_state.links[pieces.last(index)])
            for index, link in enumerate(self.state.links)
        )
        leads = tuple(joint.lead for joint in shape.whole.joints)
        return replace(self.state, joints=joints, links=links, leads=leads, tool=shape.whole.tool, frames=shape.whole)


def _link(link: LinkState, frame: LinkFrame, first: LinkState, last: LinkState) -> LinkState:
    return replace(
        link,
        vector=frame.vector,
        along=frame.along,
        height=frame.height,
        width=frame.width,
        force=last.force,
        moment=last.moment,
        base_moment=first.base_moment,
    )


def _loaded_by_more_than_a_hair(joint: JointState, pushed: NDArray[np.bool_], across: NDArray[np.bool_]) -> JointState:
    along = scale(dot(joint.axis, joint.force), joint.axis)
    x, y, z = (np.where(across, *pair) for pair in zip(joint.force, along, strict=True))
    return replace(joint, drive_load=np.where(pushed, joint.drive_load, 0.0), force=(x, y, z))


def _taken(value: Any, rows: NDArray[np.intp], count: int) -> Any:
    """Whatever holds arrays with a row for each of `count` poses, with some of them."""
    if len(rows) == count:
        return value
    if isinstance(value, np.ndarray):
        return value[rows] if value.shape[:1] == (count,) else value
    if isinstance(value, tuple):
        return tuple(_taken(item, rows, count) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(
            value, **{field.name: _taken(getattr(value, field.name), rows, count) for field in fields(value)}
        )
    return value


def _directions(frame: LinkFrame) -> Rows:
    return frame.along, frame.height, frame.width


def _with_links(frames: Frames, turns: Sequence[Rows], owner: Sequence[int]) -> Frames:
    """Frames turned as the links are, each with the one that is its `owner`."""
    joints: list[JointFrame] = []
    links: list[LinkFrame] = []
    for link, joint, item in zip(frames.links, frames.joints, owner, strict=True):
        before = turns[item - 1] if item else IDENTITY
        joints.append(JointFrame(rotate(before, joint.lead), rotate(before, joint.axis), joint.before))
        turn = turns[item]
        links.append(LinkFrame(rotate(turn, link.vector), *_turned(turn, _directions(link))))
    return Frames(tuple(joints), tuple(links), rotate(turns[-1], frames.tool), frames.orientation)


def _turned(turn: Rows, directions: Rows) -> Rows:
    """Three directions, each normal to the others, turned."""
    one, two = rotate(turn, directions[0]), rotate(turn, directions[1])
    return one, two, cross(one, two)


def _vector(columns: Array) -> Vector:
    return (columns[:, 0], columns[:, 1], columns[:, 2])
