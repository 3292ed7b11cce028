"""The first bending frequency of an arm at a pose, from its compliance and its masses.

Every link is cut into segments; unit forces at their ends, through the same effects as the tip's error, give the
compliance matrix F; masses sit at the same points, the links' own by Simpson's rule, a rigid link's at its centre of
mass. What stands off a link (a counterweight, the payload in a tool) sits at the end of a rigid offset. The first
frequency belongs to the largest eigenvalue of F M: 1/omega^2 = max of (M phi)' F (M phi) / phi' M phi (Rayleigh).
Drives count with their stiffness, that of the softest zone; rotary inertia is left out, as it is small for bending.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.acting import masses_on
from linkwright.core.arm.chain.balance import End, PointMass
from linkwright.core.arm.chain.beam import QUARTERS, Beam
from linkwright.core.arm.chain.branches import ways
from linkwright.core.arm.chain.chain import Arm, FloatVector, Joint, Link, LoadCase
from linkwright.core.arm.chain.kinematics import Frames, place, section_directions
from linkwright.core.arm.chain.statics import run_out, solve
from linkwright.core.arm.chain.vectors import (
    IDENTITY,
    ZERO,
    Scalar,
    Vector,
    add,
    cross,
    minus,
    norm,
    times,
    unit,
)
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.tip import ActiveEffect, active_effects, displacements
from linkwright.core.sections.numeric import Array

SEGMENTS = QUARTERS
"""Pieces of each elastic link; even, for Simpson's rule."""
_SIMPSON = (1.0 / 12.0, 4.0 / 12.0, 2.0 / 12.0, 4.0 / 12.0, 1.0 / 12.0)


SegmentKind = Literal["head", "part", "before", "after", "offset", "counterweight"]
_OFFSETS = ("offset", "counterweight")


@dataclass(frozen=True)
class CutWay:
    """A serial arm to one tip whose links are cut, with the numbers of its segments in the whole arm (see `Way`); the
    first `shared` of them are the torso's."""

    arm: Arm
    nodes: tuple[int, ...]
    shared: int


@dataclass(frozen=True)
class SegmentedArm:
    """An arm whose links are cut into segments; `owner` gives each segment's link, `effects` its elastic physics.

    `kinds` says what each segment is: a `part` of an elastic link, or of a rigid one the stretch `before` its centre of
    mass and the one `after` it; a `head` without length, for the mass of a joint that a slide or an offset sets
    apart from the end of the link before; an `offset`, rigid and weightless, to a mass that stands off the link, back
    from there, or to the tip of a tool; the same along the link to a `counterweight` whose place is chosen. `lengths`
    are those of offsets (m), 0 for all else, `hung` what sits at a segment's far end: which of the masses on its link.
    `before` gives the segment on which each link stands, none for the first. `whole` is the arm before it was cut,
    `ways` the serial arms in segments that it is: one to each tip.
    """

    whole: Arm
    ways: tuple[CutWay, ...]
    owner: tuple[int, ...]
    kinds: tuple[SegmentKind, ...]
    lengths: tuple[float, ...]
    hung: tuple[int | None, ...]
    before: tuple[int | None, ...]
    effects: tuple[ActiveEffect, ...]


@dataclass(frozen=True)
class _Piece:
    """What becomes one segment: a stretch of the link or, with a `vector` (m, in the link's frame), an offset from it;
    `mass` is which of the masses on the link sits at its far end."""

    kind: SegmentKind
    vector: FloatVector = ZERO
    mass: int | None = None


def segmented(arm: Arm) -> SegmentedArm:
    """The arm in segments, weightless, with the elastic physics of its model (bending and slopes always)."""
    owner: list[int] = []
    pieces: list[_Piece] = []
    before: list[int | None] = [None] * arm.size
    cuts: list[CutWay] = []
    for way in ways(arm):
        serial, cut, made = _cut(way.arm)
        shared = cut.index(way.shared) if way.shared < way.arm.size else len(cut)
        first = shared if cuts else 0
        nodes = (*range(first), *range(len(owner), len(owner) + len(cut) - first))
        owner += [way.joints[item] for item in cut[first:]]
        pieces += made[first:]
        for link in range(1, way.arm.size):
            before[way.joints[link]] = nodes[cut.index(link) - 1]
        cuts.append(CutWay(serial, nodes, shared))
    active = {effect.effect.id for effect in active_effects(arm)}
    elastic = [item for item in EFFECTS.values() if item.link.flexible and item.automatic]
    effects = tuple(ActiveEffect(item, Settings()) for item in elastic if item.link.in_modes or item.id in active)
    return SegmentedArm(
        arm,
        tuple(cuts),
        tuple(owner),
        tuple(piece.kind for piece in pieces),
        tuple(norm(piece.vector) for piece in pieces),
        tuple(piece.mass for piece in pieces),
        tuple(before),
        effects,
    )


def _cut(arm: Arm) -> tuple[Arm, list[int], list[_Piece]]:
    """A serial arm in segments, with the link of each and what it is."""
    joints: list[Joint] = []
    links: list[Link] = []
    owner: list[int] = []
    pieces: list[_Piece] = []
    for index, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
        stretches = [_Piece("part")] * SEGMENTS if link.elastic else [_Piece("before"), _Piece("after")]
        height, width = section_directions(link, joint)
        axes = (link.direction, height, width)
        body = [*_offsets(link, axes, "joint"), *stretches, *_offsets(link, axes, "end")]
        if joint.mass and (not joint.revolute or any(joint.origin_translation)):
            body.insert(0, _Piece("head"))
        tool = [_Piece("offset", arm.tool)] if index == arm.size - 1 and any(arm.tool) else []
        axis = joint.axis if joint.revolute else (0.0, 0.0, 1.0)
        starts = {link: owner.index(link) for link in range(index)}
        follows = None if joint.follows is None else joint.follows.moved(starts)
        if link.runs_out:
            joint = replace(joint, zero=0.0)  # its segments are as long as it has run out
        count = len(body) + len(tool)
        joints.append(replace(joint, spans=count, zones=(), counterbalance=None, follows=follows))
        joints += [Joint(axis=axis, range=(0.0, 0.0))] * (count - 1)
        plain = replace(link, end_rotation=IDENTITY, masses=(), runs_out=False, flange=None, compliance=None)
        stretch = replace(plain, length=link.length / len(stretches), height_direction=height)
        made = [_offset(plain, piece.vector) if piece.kind in _OFFSETS else stretch for piece in body]
        last = max(number for number, piece in enumerate(body) if piece.kind not in _OFFSETS)
        made[last] = replace(stretch, flange=link.flange, compliance=link.compliance)
        made[-1] = replace(made[-1], end_rotation=link.end_rotation)
        links += made + [_offset(plain, piece.vector) for piece in tool]
        pieces += body + tool
        owner += [index] * count
    whole = replace(
        arm, joints=tuple(joints), links=tuple(links), gravity=ZERO, payload=LoadCase(), effects=(), tool=ZERO
    )
    return whole, owner, pieces


def _offsets(link: Link, axes: Sequence[FloatVector], end: End) -> list[_Piece]:
    """The offsets from one end of a link to each mass that stands off it, and back; `axes` are the directions along the
    link, its section's height and its width."""
    made: list[_Piece] = []
    for number, mass in enumerate(link.masses):
        if mass.on != end or not _stands_off(mass):
            continue
        along, height, width = mass.at
        if mass.chosen:
            across = _vector(axes, (0.0, height, width))
            steps = [_Piece("counterweight", link.direction), *([_Piece("offset", across)] if any(across) else [])]
        else:
            steps = [_Piece("offset", _vector(axes, (along, height, width)))]
        made += [*steps[:-1], replace(steps[-1], mass=number)]
        made += [replace(step, vector=_vector([step.vector], (-1.0,))) for step in reversed(steps)]
    return made


def _vector(axes: Sequence[FloatVector], parts: Sequence[float]) -> FloatVector:
    x, y, z = (sum(part * axis[k] for part, axis in zip(parts, axes, strict=True)) for k in range(3))
    return x, y, z


def _stands_off(mass: PointMass) -> bool:
    return mass.chosen or any(mass.at)


def _offset(link: Link, vector: FloatVector) -> Link:
    """A stretch of a link along another direction; its length is its beam's."""
    return replace(link, direction=unit(vector), height_direction=None)


def segment_coordinates(arm: SegmentedArm, q: Sequence[Scalar]) -> list[Scalar]:
    """The segmented arm's joint coordinates: 0 between segments, or the link's angle where angles are absolute."""
    out: list[Scalar] = []
    for index, owner in enumerate(arm.owner):
        first = index == 0 or arm.owner[index - 1] != owner
        absolute = arm.whole.angles == "absolute" and (not first or arm.whole.joints[owner].revolute)
        out.append(q[owner] if (first and not arm.whole.links[owner].runs_out) or absolute else 0.0)
    return out


def segment_beams(arm: SegmentedArm, beams: Sequence[Beam]) -> list[Beam]:
    """Each link's beam, shared out among its segments (weightless: masses enter on their own)."""
    results: list[Beam] = []
    for index, (owner, kind) in enumerate(zip(arm.owner, arm.kinds, strict=True)):
        number = sum(1 for k in range(index) if arm.owner[k] == owner and arm.kinds[k] == "part")
        results.append(Beam(length=arm.lengths[index]) if kind == "offset" else _segment(beams[owner], kind, number))
    return results


def _segment(beam: Beam, kind: SegmentKind, number: int) -> Beam:
    if kind == "head":
        return Beam(length=0.0)
    if kind == "counterweight":
        return Beam(length=beam.counterweight_at)
    if kind == "part" and beam.taper.parts:
        part = beam.taper.parts[number]
        rigidities = {name: times(ratio, getattr(beam, name)) for name, ratio in part.rigidities.items()}
        length = times(1.0 / SEGMENTS, beam.length)
        return replace(beam, length=length, mass_per_length=0.0, lumped_mass=0.0, taper=part.taper, **rigidities)
    if kind == "part":
        length = times(1.0 / SEGMENTS, beam.length)
        return replace(beam, length=length, mass_per_length=0.0, lumped_mass=0.0, housed=0.0)
    return Beam(length=beam.lumped_at if kind == "before" else minus(beam.length, beam.lumped_at))


def node_masses(arm: Arm, segments: SegmentedArm, beams: Sequence[Beam], payloads: Sequence[Scalar]) -> list[Scalar]:
    """The masses (kg) that move with the segments' far ends: links by Simpson's rule, joints, the payload of each tip.
    Links that run out of a sleeve count as if they had done so whole: elsewhere the arm is no slower than that."""
    masses: list[Scalar] = [0.0] * len(segments.owner)

    def add_at(node: int | None, mass: Scalar) -> None:
        if node is not None:  # what stands on the ground does not move
            masses[node] = masses[node] + mass

    hung = [masses_on(link.masses, beam) for link, beam in zip(arm.links, beams, strict=True)]
    for node, (owner, number) in enumerate(zip(segments.owner, segments.hung, strict=True)):
        if number is not None:
            add_at(node, hung[owner][number].mass)
    for index, beam in enumerate(beams):
        nodes = [k for k, owner in enumerate(segments.owner) if owner == index and segments.kinds[k] not in _OFFSETS]
        start = segments.before[index]
        if segments.kinds[nodes[0]] == "head":
            start = nodes.pop(0)
        add_at(start, arm.joints[index].mass)
        for mass in hung[index]:
            if not _stands_off(mass):
                add_at(nodes[-1] if mass.on == "end" else start, mass.mass)
        if arm.links[index].compliance is not None:
            # Nobody knows how it moves between its ends: at these its mass makes the arm no faster than it is.
            share = times(beam.lumped_mass, beam.lumped_at / beam.length)
            add_at(nodes[-1], share)
            add_at(start, minus(beam.lumped_mass, share))
        elif segments.kinds[nodes[0]] == "before":
            add_at(nodes[0], beam.lumped_mass)
        else:
            total = times(beam.mass_per_length, beam.length)
            density = beam.taper.density or (1.0,) * len(_SIMPSON)
            for node, weight, share in zip([start, *nodes], _SIMPSON, density, strict=True):
                add_at(node, weight * share * total)
    for way, payload in zip(segments.ways, payloads, strict=True):
        add_at(way.nodes[-1], payload)
    return masses


def response(
    segments: SegmentedArm, q: Sequence[Scalar], beams: Sequence[Beam], forces: Sequence[Vector]
) -> tuple[Vector, ...]:
    """The displacements (m) of the segments' far ends under forces (N) there; `q` and `beams` are the whole arm's."""
    beams = run_out(segments.whole, beams, q)
    places, pieces = segment_coordinates(segments, q), segment_beams(segments, beams)
    entries = [[places[k] for k in way.nodes] for way in segments.ways]
    parts = [[pieces[k] for k in way.nodes] for way in segments.ways]
    loads = [[forces[k] for k in way.nodes] for way in segments.ways]
    frames = [
        place(way.arm, at, [beam.length for beam in beams])
        for way, at, beams in zip(segments.ways, entries, parts, strict=True)
    ]
    pulls = [_pull(way, at, load) for way, at, load in zip(segments.ways, frames, loads, strict=True)]
    results: dict[int, Vector] = {}
    for number, way in enumerate(segments.ways):
        pushed, turning = list(loads[number]), None
        if len(segments.ways) > 1:
            end = way.shared - 1
            others = [pull for k, pull in enumerate(pulls) if k != number]
            pushed[end] = reduce(add, [force for force, _ in others], pushed[end])
            turning = {end: reduce(add, [moment for _, moment in others], ZERO)}
        state = solve(
            way.arm,
            entries[number],
            parts[number],
            LoadCase(),
            warming=0.0,
            point_forces=pushed,
            point_moments=turning,
            frames=frames[number],
        )
        twists = [twist for effect in segments.effects for twist in effect.effect.twists(state, effect.settings)]
        results.update(zip(way.nodes, displacements(state, twists), strict=True))
    return tuple(results[k] for k in range(len(segments.owner)))


def _pull(way: CutWay, frames: Frames, forces: Sequence[Vector]) -> tuple[Vector, Vector]:
    """What forces (N) at the ends of a branch's segments come to at the torso's end: force, and moment about it."""
    away: Vector = ZERO
    force: Vector = ZERO
    moment: Vector = ZERO
    for k in range(way.shared, len(way.nodes)):
        away = add(add(away, frames.joints[k].lead), frames.links[k].vector)
        force = add(force, forces[k])
        moment = add(moment, cross(away, forces[k]))
    return force, moment


def compliance_matrices(segments: SegmentedArm, beams: Sequence[Beam], q: Array) -> Array:
    """The compliance (m/N) of the segments' far ends at poses q (N, n): (N, 3 s, 3 s), by unit forces."""
    poses, size = len(q), 3 * len(segments.owner)
    unit = np.tile(np.eye(size), (poses, 1))
    moved = responses(segments, beams, np.repeat(q, size, axis=0), unit)
    return moved.reshape(poses, size, size).transpose(0, 2, 1)


def responses(segments: SegmentedArm, beams: Sequence[Beam], q: Array, forces: Array) -> Array:
    """The displacements (N, 3 s) in m of the segments' far ends at poses q (N, n) under forces (N, 3 s) there, N."""
    columns: list[Vector] = [
        (forces[:, 3 * k], forces[:, 3 * k + 1], forces[:, 3 * k + 2]) for k in range(forces.shape[1] // 3)
    ]
    moved = response(segments, [q[:, j] for j in range(q.shape[1])], beams, columns)
    return np.stack([np.broadcast_to(part, len(q)) for shift in moved for part in shift], axis=1)


def _each(payload: float | Sequence[float]) -> Sequence[float]:
    return (payload,) if isinstance(payload, float | int) else payload


@dataclass(frozen=True)
class Modes:
    """The first mode at N poses: frequency (N,) in Hz, and the displacements of the nodes (N, 3 s), largest entry 1."""

    frequency: Array
    shape: Array


def coordinate_masses(arm: Arm, segments: SegmentedArm, beams: Sequence[Beam], payloads: Sequence[float]) -> Array:
    """`node_masses` (3 s,) once for each coordinate of a node."""
    return np.repeat(np.array([float(mass) for mass in node_masses(arm, segments, beams, payloads)]), 3)


def symmetric(compliance: Array, root: Array) -> Array:
    """M^(1/2) F M^(1/2) (N, 3 s, 3 s), whose eigenvalues are 1/omega^2 (s^2); `root` (3 s,) is that of the masses."""
    return 0.5 * (compliance + compliance.transpose(0, 2, 1)) * root[:, None] * root[None, :]


def _hertz(values: NDArray[np.floating[Any]]) -> Array:
    """The frequency (N,) of the largest of eigenvalues (N, 3 s), the last."""
    with np.errstate(divide="ignore"):
        return 1.0 / (2.0 * math.pi * np.sqrt(np.maximum(values[:, -1], 0.0)))


def first_frequencies(arm: Arm, beams: Sequence[Beam], payload: float | Sequence[float], q: Array) -> Array:
    """The first bending frequency (N,) in Hz at poses q (N, n), as `first_modes` has it."""
    segments = segmented(arm)
    root = np.sqrt(coordinate_masses(arm, segments, beams, _each(payload)))
    return _hertz(np.linalg.eigvalsh(symmetric(compliance_matrices(segments, beams, q), root)))


def first_modes(arm: Arm, beams: Sequence[Beam], payload: float | Sequence[float], q: Array) -> Modes:
    """The first bending frequency and mode at poses q (N, n) with a payload (kg) at the tip, or one at each of the tips
    of several arms on one torso, which swing together.

    The tool's offset beyond the last link counts as rigid and massless but for the payload at its tip. Where nothing
    gives, the frequency is infinite.
    """
    segments = segmented(arm)
    root = np.sqrt(coordinate_masses(arm, segments, beams, _each(payload)))
    compliance = compliance_matrices(segments, beams, q)
    values, vectors = np.linalg.eigh(symmetric(compliance, root))
    # The eigenvector is M^(1/2) phi; the displacements follow from F M phi, which also holds where a mass is zero.
    shape = np.einsum("nij,nj->ni", compliance * root[None, None, :], vectors[:, :, -1])
    top = np.abs(shape).max(axis=1, keepdims=True)
    return Modes(_hertz(values), shape / np.where(top > 0.0, top, 1.0))


def inertia_excess(
    arm: Arm,
    segments: SegmentedArm,
    q: Sequence[float],
    beams: Sequence[Beam],
    payloads: Sequence[Scalar],
    shape: Sequence[float],
    frequency: float,
) -> Scalar:
    """(M phi)' F (M phi) omega^2 / phi' M phi - 1 for a fixed trial shape: above 0, the frequency lies below
    `frequency`.

    For the true mode it is exact; for any other shape it is a valid cut (Rayleigh), so an optimiser may use shapes
    found at earlier designs. `beams` may hold symbols.
    """
    work, inertia = work_and_inertia(arm, segments, q, beams, payloads, shape)
    return work * (2.0 * math.pi * frequency) ** 2 / inertia - 1.0


def work_and_inertia(
    arm: Arm,
    segments: SegmentedArm,
    q: Sequence[float],
    beams: Sequence[Beam],
    payloads: Sequence[Scalar],
    shape: Sequence[float],
) -> tuple[Scalar, Scalar]:
    """(M phi)' F (M phi) and phi' M phi for a trial shape; `beams` may hold symbols, or arrays of many designs."""
    masses = node_masses(arm, segments, beams, payloads)
    forces: list[Vector] = [
        (times(mass, shape[3 * k]), times(mass, shape[3 * k + 1]), times(mass, shape[3 * k + 2]))
        for k, mass in enumerate(masses)
    ]
    moved = response(segments, q, beams, forces)
    work: Scalar = 0.0
    inertia: Scalar = 0.0
    for k, shift in enumerate(moved):
        for axis in range(3):
            work = work + times(forces[k][axis], shift[axis])
            inertia = inertia + times(forces[k][axis], shape[3 * k + axis])
    return work, inertia


__all__ = [
    "SEGMENTS",
    "Modes",
    "SegmentedArm",
    "compliance_matrices",
    "first_modes",
    "inertia_excess",
    "segmented",
    "work_and_inertia",
]
