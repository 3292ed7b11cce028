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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from arm.chain.arrays import columns, matrices
from arm.chain.kinematics import Frames, JointFrame, LinkFrame, Orientation
from arm.chain.segments import PIECES, Pieces, cut
from arm.chain.statics import JointState, LinkState, PoseState, solve
from arm.chain.vectors import Rotation as Rows
from arm.chain.vectors import Scalar, Vector
from arm.effects import Twist
from arm.effects.effect import NO_LOAD
from arm.effects.loads.added_weights import bearing, borne_wholly
from sections.numeric import Array

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
class _Shape:
    """Places and orientations along the chain, and what the effects did at them.

    `pieces` are the frames of the cut arm, `whole` those of the arm itself; `lengths` (m) each link's, with what
    effects add to it; `turned` how the base and each link's far end are turned (N, 3, 3).
    """

    pieces: Frames
    whole: Frames
    lengths: tuple[Scalar, ...]
    tip: Array
    turn: Array
    turned: tuple[Array, ...]


def deformed(state: PoseState, effects: Sequence[ActiveEffect], rows: int, *, play_stays: bool = False) -> Deformed:
    """The arm of `state` (numbers or arrays of `rows`, at its undeformed pose) with `effects` as finite motions.

    Play lies where the loads on the shape seat it, or, where it `play_stays`, where those of the undeformed pose do.
    A joint that nothing loads at the undeformed pose (about a plumb axis) is loaded by a hair on the shape, which the
    least friction holds: there its play lies on the side that the joint came from, in the middle where nobody knows.

    Effects of the instrument move nothing of the arm; they are added to first order in what it has moved. Where play
    that the load seats one way makes it seat the other way (a link that hangs nearly plumb), passes go to and fro
    between two shapes for ever: the arm stands between them, and the middle is taken.
    """
    chain = _Chain(state, rows, _carries_slopes(effects), play_stays)
    shape, now = chain.straight(), state
    last = earlier = shape
    settled = swinging = np.zeros(rows, dtype=bool)
    for _ in range(MOST_PASSES):
        earlier, last = last, shape
        try:
            shape, now = chain.bent(shape, now, effects)
        except np.linalg.LinAlgError:  # it is bent beyond all numbers
            settled = swinging = np.zeros(rows, dtype=bool)
            break
        settled = np.linalg.norm(shape.tip - last.tip, axis=1) <= SETTLED
        swinging = ~settled & (np.linalg.norm(shape.tip - earlier.tip, axis=1) <= SETTLED)
        if (settled | swinging).all():
            break
    between = swinging[:, None]
    tip = np.where(between, 0.5 * (shape.tip + last.tip), shape.tip)
    turn = np.where(between, 0.5 * (shape.turn + last.turn), shape.turn)
    return Deformed(now, tip, turn, settled | swinging, shape.turned)


def _carries_slopes(effects: Iterable[ActiveEffect]) -> bool:
    """Whether bent links turn what follows: an arm without that has no pieces that could turn each other."""
    return any(each.effect.turns_along_the_link for each in effects)


class _Chain:
    """The arm at its undeformed poses, cut into pieces."""

    def __init__(self, state: PoseState, rows: int, cut_links: bool, play_stays: bool) -> None:
        self.state, self.rows, self.play_stays = state, rows, play_stays
        self.beams = [link.beam for link in state.links]
        self.pieces: Pieces = cut(state.arm, self.beams, PIECES if cut_links else 1)
        self.leads = [columns(lead, rows) for lead in state.leads]
        self.vectors = [columns(link.vector, rows) for link in state.links]
        self.tool = columns(state.tool, rows)
        self.nominal = columns(state.tip(), rows)

    def straight(self) -> _Shape:
        """The shape without anything at work."""
        nothing = [np.zeros((self.rows, 3))] * len(self.pieces.owner)
        return self._walk({}, {}, nothing, nothing, [beam.length for beam in self.beams])

    def bent(self, shape: _Shape, now: PoseState, effects: Sequence[ActiveEffect]) -> tuple[_Shape, PoseState]:
        """The shape that the loads on `shape` give, and the state on it."""
        cut_state = self._loaded(shape)
        now = self._whole(shape, cut_state)
        seating = self._seating(now)
        moved: dict[Node, Array] = {}
        turned: dict[Node, Array] = {}
        strain = [np.zeros((self.rows, 3)) for _ in self.pieces.owner]
        bend = [np.zeros((self.rows, 3)) for _ in self.pieces.owner]
        seen_tip: list[Twist] = []
        for active in effects:
            effect, settings = active.effect, active.settings
            if effect.along_the_link:
                at = tuple(k for link in settings.at for k in self.pieces.of(link))
                for twist in on_the_way(cut_state.arm, effect.twists(cut_state, replace(settings, at=at))):
                    strain[twist.index] = strain[twist.index] + columns(twist.translation, self.rows)
                    bend[twist.index] = bend[twist.index] + columns(twist.rotation, self.rows)
                continue
            twists = [*on_the_way(now.arm, [*effect.twists(now, settings), *effect.seated(seating, settings)])]
            if effect.of_instrument and effect.place in ("base", "tip"):
                seen_tip += twists
                continue
            for twist in twists:
                key = (twist.node, twist.index if twist.node in ("joint", "link") else 0)
                moved[key] = moved.get(key, 0.0) + columns(twist.translation, self.rows)
                turned[key] = turned.get(key, 0.0) + columns(twist.rotation, self.rows)
        lengths: list[Scalar] = []
        for index, beam in enumerate(self.beams):
            own: Scalar = beam.length
            shift = moved.get(("link", index))
            if shift is not None:
                # What lengthens a link makes it a longer beam; what is left shifts its far end.
                along = columns(now.links[index].along, self.rows)
                longer = np.sum(shift * along, axis=1) * (_ones(own, self.rows) > 0.0)
                moved["link", index] = shift - longer[:, None] * along
                own = own + longer
            lengths.append(own)
        found = self._walk(moved, turned, strain, bend, lengths)
        return self._measured(found, seen_tip), now

    def _seating(self, now: PoseState) -> PoseState:
        """The state whose loads seat play: on the shape, but for joints that nothing loads at the undeformed pose."""
        if self.play_stays:
            return self.state
        now = borne_wholly(now)
        pairs = zip(bearing(self.state).joints, now.joints, strict=True)
        return replace(now, joints=tuple(self._loaded_by_more_than_a_hair(*pair) for pair in pairs))

    def _loaded_by_more_than_a_hair(self, undeformed: JointState, there: JointState) -> JointState:
        pushed = np.abs(_ones(undeformed.drive_load, self.rows)) > NO_LOAD
        first_axis, axis = (columns(each.axis, self.rows) for each in (undeformed, there))
        first, force = (columns(each.force, self.rows) for each in (undeformed, there))
        across = np.linalg.norm(np.cross(first_axis, first), axis=1) > NO_LOAD
        along = np.sum(axis * force, axis=1)[:, None] * axis
        return replace(
            there,
            drive_load=np.where(pushed, there.drive_load, 0.0),
            force=_vector(np.where(across[:, None], force, along)),
        )

    def _measured(self, shape: _Shape, twists: Sequence[Twist]) -> _Shape:
        """The tip as an instrument that is itself off sees it."""
        tip, turn = shape.tip, shape.turn
        for twist in twists:
            shift, rotation = columns(twist.translation, self.rows), columns(twist.rotation, self.rows)
            place = self.nominal + tip if twist.node == "base" else np.zeros_like(tip)
            tip = tip + shift + _turned(_matrix(rotation), place) - place
            turn = turn + rotation
        return replace(shape, tip=tip, turn=turn)

    def _walk(
        self,
        moved: dict[Node, Array],
        turned: dict[Node, Array],
        strain: Sequence[Array],
        bend: Sequence[Array],
        lengths: Sequence[Scalar],
    ) -> _Shape:
        """From the base out: every motion carries all that lies beyond it."""
        rows, frames = self.rows, self.state.frames
        orientation = np.broadcast_to(np.eye(3), (rows, 3, 3))
        base = moved.get(("base", 0), np.zeros((rows, 3)))
        place = base
        orientation = _after(orientation, turned.get(("base", 0)))
        joints: list[JointFrame] = []
        links: list[LinkFrame] = []
        cut_joints: list[JointFrame] = []
        cut_links: list[LinkFrame] = []
        carried = base
        turned_so_far = [orientation]
        for index, frame in enumerate(frames.links):
            lead = carried + _turned(orientation, self.leads[index])
            joint = frames.joints[index]
            before = Orientation(_product(orientation, joint.before.matrix()), (0.0, 0.0, 1.0), 0.0)
            axis = _vector(_turned(orientation, columns(joint.axis, rows)))
            place = place + _turned(orientation, self.leads[index])
            shift = moved.get(("joint", index), np.zeros((rows, 3)))
            followed = self._followed(index, columns(axis, rows), joints, moved, turned, bend)
            if not self.state.joints[index].revolute:
                shift, followed = shift + followed, np.zeros((rows, 3))
            place, lead = place + shift, lead + shift
            orientation = _after(_after(orientation, turned.get(("joint", index))), followed)
            joints.append(JointFrame(_vector(lead), axis, before))
            start, root = place, orientation
            own = self.pieces.of(index)
            nominal = self._piece(index, lengths[index], len(own))
            for number, piece in enumerate(own):
                half = _matrix(0.5 * bend[piece])
                across = _turned(np.swapaxes(half, 1, 2), strain[piece])
                middle = half @ orientation
                step = _arc(bend[piece], _turned(orientation, nominal), across)
                if piece == own[-1]:
                    step = step + moved.get(("link", index), 0.0)
                cut_joints.append(JointFrame(_vector(lead) if number == 0 else (0.0, 0.0, 0.0), axis, before))
                cut_links.append(_turned_link(middle, frame, step))
                place = place + step
                orientation = _matrix(bend[piece]) @ orientation
            orientation = _after(orientation, turned.get(("link", index)))
            turned_so_far.append(orientation)
            links.append(_turned_link(_between(root, orientation), frame, place - start))
            carried = np.zeros((rows, 3))
        offset = moved.get(("tip", 0), np.zeros((rows, 3)))
        tool = _turned(orientation, self.tool) + offset
        place = place + tool
        orientation = _after(orientation, turned.get(("tip", 0)))
        end = _product(orientation, frames.orientation)
        return _Shape(
            Frames(tuple(cut_joints), tuple(cut_links), _vector(tool), end),
            Frames(tuple(joints), tuple(links), _vector(tool), end),
            tuple(lengths),
            place - self.nominal,
            Rotation.from_matrix(orientation).as_rotvec(),
            tuple(turned_so_far),
        )

    def _followed(
        self,
        joint: int,
        axis: Array,
        before: Sequence[JointFrame],
        moved: dict[Node, Array],
        turned: dict[Node, Array],
        bend: Sequence[Array],
    ) -> Array:
        """What moves a joint along its axis because it moves those that it follows (`arm.errors.tip`)."""
        total = np.zeros(self.rows)
        follows = self.state.arm.joints[joint].follows
        for tie in () if follows is None else follows.ties:
            there = turned if self.state.joints[tie.joint].revolute else moved
            amount = there.get(("joint", tie.joint), 0.0) + np.zeros((self.rows, 3))
            if tie.along:
                amount = amount + turned.get(("link", tie.joint), 0.0)
                amount = amount + sum(bend[piece] for piece in self.pieces.of(tie.joint))
            total += tie.weight * np.sum(amount * columns(before[tie.joint].axis, self.rows), axis=1)
        return total[:, None] * axis

    def _piece(self, link: int, length: Scalar, count: int) -> Array:
        """A piece's vector as it lies in the undeformed arm, with what the link has been made longer."""
        given = _ones(self.beams[link].length, self.rows)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = np.where(given == 0.0, 1.0, _ones(length, self.rows) / given)
        return self.vectors[link] * (ratio / count)[:, None]

    def _loaded(self, shape: _Shape) -> PoseState:
        """The statics of the cut arm on a shape."""
        state, pieces = self.state, self.pieces
        return solve(
            pieces.arm,
            pieces.coordinates([joint.coordinate for joint in state.joints]),
            pieces.beams(self.beams, shape.lengths),
            state.load,
            gravity=state.gravity,
            conditions=pieces.conditions(state.conditions),
            payload_mass=state.payload_mass,
            tip_force=state.tip_force,
            frames=shape.pieces,
        )

    def _whole(self, shape: _Shape, cut_state: PoseState) -> PoseState:
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


def _arc(turn: Array, straight: Array, shift: Array) -> Array:
    """Where the end of a piece lies that turns by `turn` in all and is shifted by `shift` against its root: to first
    order straight + shift, with its strain constant along it as finite motions are."""
    strain = straight + shift - 0.5 * np.cross(turn, straight)
    angle = np.linalg.norm(turn, axis=1)[:, None]
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    once = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    twice = np.where(small, 1.0 / 6.0 - angle**2 / 120.0, (safe - np.sin(safe)) / safe**3)
    across = np.cross(turn, strain)
    return strain + once * across + twice * np.cross(turn, across)


def _turned_link(orientation: Array, frame: LinkFrame, vector: Array) -> LinkFrame:
    along, height, width = (
        _vector(_turned(orientation, columns(part, len(vector)))) for part in (frame.along, frame.height, frame.width)
    )
    return LinkFrame(_vector(vector), along, height, width)


def _between(first: Array, last: Array) -> Array:
    """The orientation half way from one to the other."""
    turn = Rotation.from_matrix(last @ np.swapaxes(first, 1, 2)).as_rotvec()
    return _matrix(0.5 * turn) @ first


def _after(orientation: Array, turn: Array | None) -> Array:
    return orientation if turn is None else _matrix(turn) @ orientation


def _matrix(turn: Array) -> Array:
    return Rotation.from_rotvec(turn).as_matrix()


def _product(orientation: Array, rows: Rows) -> Rows:
    size = len(orientation)
    found = orientation @ matrices(rows, size)
    first, second, third = (_vector(found[:, k]) for k in range(3))
    return (first, second, third)


def _ones(value: object, rows: int) -> Array:
    return np.broadcast_to(np.asarray(value, dtype=float), (rows,))


def _vector(columns: Array) -> Vector:
    return (columns[:, 0], columns[:, 1], columns[:, 2])


def _turned(matrices: Array, vectors: Array) -> Array:
    return np.einsum("nij,nj->ni", matrices, vectors)
