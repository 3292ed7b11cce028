"""Links cut into pieces, each a separate beam: for loads and bending along a shape that is no longer straight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from linkwright.core.arm.bodies.inertia import Moving

from .balance import PointMass
from .beam import Beam
from .chain import Arm, EffectEntry, Joint, Link, LoadCase
from .conditions import Conditions
from .kinematics import section_directions
from .vectors import IDENTITY, Scalar, minus, plus, times

PIECES = 4
"""Of each uniform elastic link. What a piece's curvature leaves out falls with the square of their number: with
four it is below 0.1 um for links that bend by 10 mm."""


@dataclass(frozen=True)
class Pieces:
    """An arm whose links are cut; `owner` gives each piece's link, `first` the first piece of each link."""

    arm: Arm
    owner: tuple[int, ...]
    first: tuple[int, ...]

    def last(self, link: int) -> int:
        """The last piece of a link."""
        return (self.first[link + 1] if link + 1 < len(self.first) else len(self.owner)) - 1

    def of(self, link: int) -> range:
        """The pieces of a link, from its joint out."""
        return range(self.first[link], self.last(link) + 1)

    def coordinates(self, q: Sequence[Scalar]) -> list[Scalar]:
        """The cut arm's joint coordinates: 0 between pieces, or the link's angle where angles are absolute."""
        turning = [self.arm.angles == "absolute" and joint.revolute for joint in self.arm.joints]
        return [
            q[owner] if index == self.first[owner] or turning[index] else 0.0 for index, owner in enumerate(self.owner)
        ]

    def load(self, case: LoadCase) -> LoadCase:
        """A load case, its motion that of the pieces."""
        moving = case.moving
        if moving is None:
            return case
        q, velocity, acceleration = map(self.coordinates, (moving.q, moving.velocity, moving.acceleration))
        return replace(case, moving=Moving(tuple(q), tuple(velocity), tuple(acceleration), moving.time, moving.source))

    def beams(self, beams: Sequence[Beam], lengths: Sequence[Scalar]) -> list[Beam]:
        """Each link's beam shared out among its pieces, for links of these lengths (m)."""
        counts = [len(self.of(link)) for link in range(len(self.first))]
        return [
            replace(
                beams[o],
                length=times(1.0 / counts[o], lengths[o]),
                # Pieces beyond twist a piece by their whole weight, whatever its own does.
                torsion_by_weight=plus(times(counts[o], minus(beams[o].torsion_by_weight, 1.0)), 1.0),
                housed=beams[o].housed if piece == self.first[o] else 0.0,
            )
            for piece, o in enumerate(self.owner)
        ]

    def conditions(self, held: Conditions) -> Conditions:
        """The conditions, with a temperature for each piece."""
        if held.warming is None:
            return held
        return replace(held, warming=tuple(held.warming[owner] for owner in self.owner))


def cut(arm: Arm, beams: Sequence[Beam], pieces: int = PIECES) -> Pieces:
    """The arm with every uniform elastic link in so many pieces; rigid and tapered ones stay whole."""
    joints: list[Joint] = []
    links: list[Link] = []
    owner: list[int] = []
    first: list[int] = []
    for index, (joint, link, beam) in enumerate(zip(arm.joints, arm.links, beams, strict=True)):
        count = 1 if beam.flexural_rigidity_height is None or beam.taper.parts else pieces
        height, _ = section_directions(link, joint)
        first.append(len(owner))
        owner += [index] * count
        axis = joint.axis if joint.revolute else (0.0, 0.0, 1.0)
        follows = None if joint.follows is None else joint.follows.moved(dict(enumerate(first)))
        joints += [replace(joint, spans=count, follows=follows), *[Joint(axis=axis, range=(0.0, 0.0))] * (count - 1)]
        piece = replace(
            link,
            length=link.length / count,
            end_rotation=IDENTITY,
            height_direction=height,
            runs_out=False,
            flange=None,
            compliance=None,
        )
        parts = [*[piece] * (count - 1), replace(piece, end_rotation=link.end_rotation)]
        links += [
            replace(part, masses=_at_ends(link, first=number == 0, last=number == count - 1))
            for number, part in enumerate(parts)
        ]
    effects = tuple(_at_first_pieces(entry, first) for entry in arm.effects)
    ends = [*first, len(owner)]
    branches = tuple(replace(branch, first=ends[branch.first], end=ends[branch.end]) for branch in arm.branches)
    whole = replace(arm, joints=tuple(joints), links=tuple(links), effects=effects, branches=branches)
    return Pieces(whole, tuple(owner), tuple(first))


def _at_first_pieces(entry: EffectEntry, first: Sequence[int]) -> EffectEntry:
    """An entry of the arm's effects where the cut arm has it: what a link weighs is about its joint."""
    return replace(entry, at=tuple(first[number - 1] + 1 for number in entry.at or range(1, len(first) + 1)))


def _at_ends(link: Link, *, first: bool, last: bool) -> tuple[PointMass, ...]:
    """What hangs on a piece of a link: at the link's ends alone."""
    return tuple(mass for mass in link.masses if (first if mass.on == "joint" else last))
