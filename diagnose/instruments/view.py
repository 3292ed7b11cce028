"""What an instrument should read where the model has the tip, and what of it a displacement of the tip shows.

A reading may be a coordinate, the height along a direction, the distance from an anchor, the tilt of a level, or
nought: that a point, a plane or a bar was touched again. Residuals are exact (distances and tilts are not linearised);
what displacements, turns and nuisances show is to first order about where the arm stands, as everywhere in the
diagnosis.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.placement import UNDETERMINED
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .camera import DEPTHS, Sight, is_camera, sighted
from .instrument import ALONG, BAR, COUNT, DISTANCE, PLANE, POINT, TILT_X, TILT_Y, X
from .level import Stand, tilts

_STEPS, _START_STEPS, _START_ROWS = 40, 6, 150
_FOUND = 1e-12
_BETTER = 0.9
"""Of an earlier start's RMS, which turns less: another start must fit so much better."""
_LONGEST = 0.5
"""rad; how far one step turns a level at most."""


@dataclass(frozen=True)
class View:
    """A recording's readings against the model. `residual` (N, W), m, is measured less modelled; `shown` (N, W, D) what
    a displacement of the tip along each axis of the base shows, `beside` (N, W, b) what the unknown places of anchor,
    points, planes and bars and how a level sits (`names`) do. `rotation` and `translation` bring what was measured into
    the base frame, `tool` is added to the arm's own, in the last link's frame, m. `anchor` (3,), m, is that in the base
    frame (of several recordings each reading's, (N, 3)), None without distances; `at` (N, 3) where the tip stands;
    `settled` (N, 3) the same but on what was touched: how far off it is told is what was measured, and nothing may be
    made of that to explain it. `framed` and `distances` (N, W) mark places and heights in the measuring frame, and
    distances. `rises` (N, W, 3) is the axis of a level of which a number tells how far it rises towards `up` (3,), in
    the base frame; nought for all other numbers. `sight` is what else there is of a camera.
    """

    residual: Array
    shown: Array
    beside: Array
    names: tuple[str, ...]
    rotation: Array
    translation: Array
    tool: Array
    anchor: Array | None
    at: Array
    distances: NDArray[np.bool_]
    framed: NDArray[np.bool_]
    settled: Array
    rises: Array
    up: Array
    sight: Sight | None = None
    undetermined: tuple[str, ...] = ()

    @property
    def turned(self) -> Array:
        """What a turn about each axis of the base of what a level stands on shows, or of the tool about the tip, which
        carries a camera or its target, (N, W, 3)."""
        if self.sight is not None:
            return self.sight.turning_about_tip
        return np.cross(self.rises, self.up)

    def of_tip(self, moved: Array, turned: Array | None = None) -> Array:
        """What displacements of the tip (N, 3), m, and turns of what a level stands on or a camera is on (N, 3), rad,
        show to first order, (N, W)."""
        seen = np.einsum("nwa,na->nw", self.shown, moved[:, : self.shown.shape[2]])
        return seen if turned is None else seen + np.einsum("nwa,na->nw", self.turned, turned)

    def change(self, moved: Array, turned: Array | None = None) -> Array:
        """What displacements of the tip (N, 3), m, and turns of what a level stands on (N, 3), rad, show, (N, W): of
        distances and tilts exactly."""
        if self.sight is not None:
            return self.sight.change(moved, np.zeros(moved.shape) if turned is None else turned)
        seen = self.of_tip(moved)
        if turned is not None:
            now = np.einsum("nab,nwb->nwa", Rotation.from_rotvec(turned).as_matrix(), self.rises)
            seen = seen + (now - self.rises) @ self.up
        if self.anchor is None:
            return seen
        away = self.at - self.anchor
        exact = np.linalg.norm(away + moved, axis=1) - np.linalg.norm(away, axis=1)
        return np.where(self.distances, exact[:, None], seen)


@dataclass(frozen=True)
class _Place:
    """Where the frame stands (measured to base), the tool's offset, anchor, points and planes (n, c), which way bars
    point (n, 3), unit or nought, and how a level sits on what it stands on (3, 3)."""

    rotation: Array
    translation: Array
    tool: Array
    anchor: Array | None
    points: Array
    normals: Array
    offsets: Array
    bars: Array
    seat: Array


@dataclass(frozen=True)
class _Seen:
    """Readings against a place: `residual` (N, W), `shown` and `rises` (N, W, 3), where the tip is `at` (N, 3)."""

    residual: Array
    shown: Array
    at: Array
    rises: Array

    def rms(self) -> float:
        """The root mean square of the residual."""
        return float(np.sqrt(np.mean(self.residual**2)))


def viewed(
    recording: Recording,
    tips: Array,
    directions: Array,
    stand: Stand | None = None,
    *,
    flat: bool,
    rules: ResidualRules = RULES.residual,
) -> View:
    """Set what was read against modelled tips (N, 3), m, with frame, tool and anchor free where the recording says so;
    `directions` (N, 3, 3) are how an offset of the tool displaces the tip, `stand` is what a level stands on. An arm
    that stays in its plane is `flat`.
    """
    if is_camera(recording):
        return _of_camera(sighted(recording, tips, directions, rules=rules), tips)
    return _Viewing(recording, tips, directions, stand, flat, rules).view()


def _of_camera(sight: Sight, tips: Array) -> View:
    """The view of a camera on modelled tips (N, 3), m, whose depths may be off in proportion besides."""
    nowhere, none = np.zeros(sight.shown.shape), np.zeros(sight.residual.shape, dtype=bool)
    deep = np.zeros((*sight.residual.shape, 1))
    deep[:, 2, 0] = sight.depths
    return View(
        residual=sight.residual,
        shown=sight.shown,
        beside=deep,
        names=(DEPTHS,),
        rotation=sight.rotation,
        translation=sight.translation,
        tool=sight.tool,
        anchor=None,
        at=tips,
        distances=none,
        framed=none,
        settled=tips,
        rises=nowhere,
        up=np.zeros(3),
        sight=sight,
        undetermined=sight.undetermined,
    )


def touched_planes(at: Array, touches: NDArray[np.int64], count: int, *, flat: bool) -> tuple[Array, Array, Array]:
    """The planes that fit what was touched best: normals (count, 3), offsets (count,) m and how far their touches reach
    along each of the plane's axes (count, 2), RMS, m; nought for labels without touches."""
    normals, offsets, reach = np.zeros((count, 3)), np.zeros(count), np.zeros((count, 2))
    width = 2 if flat else 3
    for label in range(count):
        points = at[touches == label][:, :width]
        if len(points) == 0:
            continue
        middle = points.mean(axis=0)
        _, size, axes = np.linalg.svd(points - middle, full_matrices=True)
        normals[label, :width] = axes[-1]
        offsets[label] = float(axes[-1] @ middle)
        sizes = np.concatenate([size, np.zeros(3)])[: width - 1] / np.sqrt(len(points))
        reach[label] = [*sizes, *([sizes[0]] if flat else [])]
    return normals, offsets, reach


def touched_bars(at: Array, touches: NDArray[np.int64], along: Array, count: int) -> tuple[Array, Array, Array]:
    """The bars that fit tips `at` (N, 3) best, m, which touch them so far `along` (N,): the middle of the touches
    (count, 3), which way they point (count, 3), unit, and how far from that middle each touch should be (N,). A bar
    that is touched at one place points nowhere."""
    middles, ways, away = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(len(at))
    for label in range(count):
        rows = touches == label
        if not rows.any():
            continue
        middles[label], away[rows] = at[rows].mean(axis=0), along[rows] - along[rows].mean()
        way = away[rows] @ (at[rows] - middles[label])
        ways[label] = way / max(float(np.linalg.norm(way)), 1e-300)
    return middles, ways, away


class _Viewing:
    """The fit of what is free to one recording."""

    def __init__(
        self,
        recording: Recording,
        tips: Array,
        directions: Array,
        stand: Stand | None,
        flat: bool,
        rules: ResidualRules,
    ) -> None:
        assert recording.slots is not None
        self.recording, self.tips, self.directions, self.stand = recording, tips, directions, stand
        self.flat, self.rules, self.width = flat, rules, 2 if flat else 3
        self.slots = recording.slots
        self.touches = np.full(recording.size, -1) if recording.touches is None else recording.touches
        self.labels = recording.instrument.labels
        self.distances = self.slots == DISTANCE
        self.framed = self.slots <= ALONG
        self.points = (self.slots >= POINT) & (self.slots < PLANE)
        self.bars, self.tilts = self.slots >= BAR, tilts(recording)
        self.along = np.zeros(recording.size) if recording.bar_at is None else _from_middle(recording.bar_at, self)
        known = recording.instrument.anchor is not None
        free = recording.frame == "free"
        # A known place in a frame that stands anywhere is an unknown place, unless more is measured in that frame.
        self.anchor_free = bool(self.distances.any()) and (not known or (free and not self.framed.any()))
        self.frame_free = free and bool(self.framed.any())
        self.tool_free = recording.tool == "free"

    def view(self) -> View:
        """The view that fits best."""
        place = self._seated(self._start())
        undetermined = np.zeros((0, 0))
        if self.frame_free or self.tool_free or self.anchor_free:
            place, undetermined = self._fitted(place, _STEPS)
        seen = self.seen(place)
        columns, names = self._labelled(seen, place)
        if self.anchor_free:
            columns = [-np.where(self.distances[:, :, None], seen.shown, 0.0), *columns]
            names = [*(f"anchor {axis}" for axis in "xyz"), *names]
        if self.stand is not None:
            columns, names = [*columns, self._sits(seen, place)], [*names, *(f"level about {axis}" for axis in "xyz")]
        width = self.width
        return View(
            residual=seen.residual,
            shown=seen.shown[:, :, :width],
            beside=np.concatenate([np.zeros((*self.slots.shape, 0)), *columns], axis=2),
            names=tuple(names),
            rotation=place.rotation[:width, :width],
            translation=place.translation[:width],
            tool=place.tool[:width],
            anchor=self._anchor(place),
            at=seen.at,
            distances=self.distances,
            framed=self.framed,
            settled=self._settled(place, seen.at),
            rises=seen.rises,
            up=np.zeros(3) if self.stand is None else self.stand.up,
            undetermined=self._sentences(undetermined),
        )

    def _settled(self, place: _Place, at: Array) -> Array:
        """Where the tips (N, 3) are, those that touch something just there."""
        settled = at.copy()
        points, planes = self.points.any(axis=1), (self.slots == PLANE).any(axis=1)
        settled[points] = place.points[self.touches[points]]
        normals, label = place.normals[self.touches[planes]], self.touches[planes]
        off = np.sum(at[planes] * normals, axis=1) - place.offsets[label]
        settled[planes] = at[planes] - off[:, None] * normals
        bars = self.bars.any(axis=1)
        label = self.touches[bars]
        settled[bars] = place.points[label] + self.along[bars, None] * place.bars[label]
        return settled

    def _anchor(self, place: _Place) -> Array | None:
        if not self.distances.any():
            return None
        if place.anchor is not None:
            return place.anchor
        anchor = self.recording.instrument.anchor
        assert anchor is not None
        return place.rotation @ np.array(anchor) + place.translation

    def seen(self, place: _Place) -> _Seen:
        """The readings against what they should be."""
        at = self.tips + np.einsum("nab,b->na", self.directions, place.tool)
        rows = len(at)
        modelled, slope = np.zeros((rows, COUNT)), np.zeros((rows, COUNT, 3))
        modelled[:, X:ALONG] = (at - place.translation) @ place.rotation
        slope[:, X:ALONG] = place.rotation.T
        direction = self.recording.instrument.direction
        if direction is not None:
            modelled[:, ALONG] = modelled[:, X:ALONG] @ np.array(direction)
            slope[:, ALONG] = place.rotation @ np.array(direction)
        anchor = self._anchor(place)
        if anchor is not None:
            away = at - anchor
            modelled[:, DISTANCE] = np.linalg.norm(away, axis=1)
            slope[:, DISTANCE] = away / np.maximum(modelled[:, DISTANCE], 1e-9)[:, None]
        touched = np.flatnonzero(self.touches >= 0)
        label = self.touches[touched]
        modelled[touched, POINT:PLANE] = at[touched] - place.points[label]
        slope[touched, POINT:PLANE] = np.eye(3)
        modelled[touched, PLANE] = np.sum(at[touched] * place.normals[label], axis=1) - place.offsets[label]
        slope[touched, PLANE] = place.normals[label]
        modelled[touched, BAR:] = modelled[touched, POINT:PLANE] - self.along[touched, None] * place.bars[label]
        slope[touched, BAR:] = np.eye(3)
        rises = np.zeros((rows, COUNT, 3))
        if self.stand is not None:
            axes = self.stand.axes @ place.seat
            # A level turned about its x has its y rise; turned about its y, its x sinks.
            rises[:, TILT_X], rises[:, TILT_Y] = axes[:, :, 1], -axes[:, :, 0]
            modelled[:, [TILT_X, TILT_Y]] = rises[:, [TILT_X, TILT_Y]] @ self.stand.up
        residual = self.recording.tip - np.take_along_axis(modelled, self.slots, axis=1)
        shown, rises = (np.take_along_axis(item, self.slots[:, :, None], axis=1) for item in (slope, rises))
        return _Seen(residual, shown, at, rises)

    def _sits(self, seen: _Seen, place: _Place) -> Array:
        """How readings move with small turns of a level about its own axes, (N, W, 3)."""
        assert self.stand is not None
        turned = np.einsum("nwa,nab->nwb", np.cross(seen.rises, self.stand.up), self.stand.axes @ place.seat)
        # About what stays upright, a turn shows nothing but rounding.
        size = np.linalg.norm(turned.reshape(-1, 3), axis=0)
        return np.where(size > UNDETERMINED * size.max(), turned, 0.0)

    def _seated(self, place: _Place) -> _Place:
        """The place with a level as it sits on what it stands on: on a link turned anyhow, on the base but a little."""
        if self.stand is None:
            return place
        quarters = sorted(Rotation.create_group("O").as_matrix(), key=lambda turn: -float(np.trace(turn)))
        turns = [np.eye(3)] if self.stand.known else quarters
        best, least = place, np.inf
        for turn in turns:
            tried = replace(place, seat=self.stand.seat @ turn)
            for _ in range(_START_STEPS):
                tried = self._levelled(tried)
            off = float(np.sqrt(np.mean(self.seen(tried).residual[self.tilts] ** 2)))
            # An earlier one is turned less from level at zero angles: what fits as well is rather that.
            if off < _BETTER * least:
                best, least = tried, off
        for _ in range(_START_STEPS):
            best = self._levelled(best)
        return best

    def _levelled(self, place: _Place) -> _Place:
        """One of Gauss and Newton's steps for how a level sits."""
        seen = self.seen(place)
        design, left = self._sits(seen, place)[self.tilts], seen.residual[self.tilts]
        step = np.linalg.lstsq(design, left, rcond=UNDETERMINED)[0]
        size = float(np.linalg.norm(step))
        step = step * min(1.0, _LONGEST / size) if size > 0.0 else step
        return replace(place, seat=place.seat @ Rotation.from_rotvec(step).as_matrix())

    def _touched(self, place: _Place) -> _Place:
        """The place with the points and planes that fit the touches best: for points their middle."""
        count = len(self.labels)
        if not count:
            return place
        at = self.tips + np.einsum("nab,b->na", self.directions, place.tool)
        points = np.stack([at[self.touches == label].mean(axis=0) if (self.touches == label).any() else np.zeros(3)
                           for label in range(count)])  # fmt: skip
        normals, offsets, _ = touched_planes(at, self.touches, count, flat=self.flat)
        # The side from which a plane is looked at is nobody's: it stays the same from fit to fit.
        same = np.where(np.sum(normals * place.normals, axis=1) < 0.0, -1.0, 1.0)
        bars = np.zeros((count, 3))
        np.add.at(bars, self.touches[self.touches >= 0], (self.along[:, None] * at)[self.touches >= 0])
        bars /= np.maximum(np.linalg.norm(bars, axis=1, keepdims=True), 1e-12)
        return replace(place, points=points, normals=normals * same[:, None], offsets=offsets * same, bars=bars)

    def _start(self) -> _Place:
        count = len(self.labels)
        each = np.zeros((count, 3))
        nothing = _Place(np.eye(3), np.zeros(3), np.zeros(3), None, each, each, np.zeros(count), each, np.eye(3))
        place = self._touched(nothing)
        if self.anchor_free:
            place = replace(place, anchor=self._trilaterated())
        if not self.frame_free:
            return place
        rows = np.unique(np.linspace(0, len(self.tips) - 1, _START_ROWS).astype(int))
        few = _Viewing(
            replace(self.recording.kept(_marked(rows, len(self.tips))), tool="known"),
            self.tips[rows], self.directions[rows], None, self.flat, self.rules,
        )  # fmt: skip
        best, least = place, np.inf
        for rotation in self._rotations():
            tried = replace(place, rotation=rotation, translation=self._shift(rotation))
            found, _ = few._fitted(tried, _START_STEPS)  # its own kind
            rms = few.seen(found).rms()
            # An earlier start turns less: it stays unless another fits clearly better.
            if rms < _BETTER * least:
                best, least = replace(place, rotation=found.rotation, translation=found.translation), rms
        return best

    def _rotations(self) -> Iterator[Array]:
        """Where frames may stand: as the base does, as the heights say, and turned anyhow."""
        yield np.eye(3)
        direction = self.recording.instrument.direction
        if direction is not None and (rows := (self.slots == ALONG).any(axis=1)).sum() > self.width + 1:
            at = self.tips[rows] - self.tips[rows].mean(axis=0)
            read = self.recording.tip[rows][self.slots[rows] == ALONG]
            up = np.linalg.lstsq(at, read - read.mean(), rcond=1e-6)[0]
            if np.linalg.norm(up) > 0.0:
                yield Rotation.align_vectors(up[None], np.array([direction]))[0].as_matrix()
        if self.flat:
            yield from (Rotation.from_rotvec([0.0, 0.0, k * np.pi / 4.0]).as_matrix() for k in range(1, 8))
            return
        yield from Rotation.create_group("O").as_matrix()

    def _shift(self, rotation: Array) -> Array:
        """Where the frame stands best once it is turned so (3,), m."""
        count = len(self.labels)
        nowhere, each = np.zeros(3), np.zeros((count, 3))
        place = _Place(rotation, nowhere, nowhere, nowhere, each, each, np.zeros(count), each, np.eye(3))
        seen = self.seen(place)
        shift = np.linalg.lstsq(-seen.shown[self.framed], seen.residual[self.framed], rcond=1e-9)[0]
        return np.asarray(shift, dtype=np.float64)

    def _trilaterated(self) -> Array:
        """The anchor that distances tell by their squares (3,), m: linear in its place and one number more."""
        rows = self.distances.any(axis=1)
        read = self.recording.tip[self.distances]
        middle = self.tips[rows].mean(axis=0)
        at = self.tips[rows] - middle
        design = np.column_stack([-2.0 * at, np.ones(len(at))])
        size = np.maximum(np.linalg.norm(design, axis=0), 1e-12)
        values = np.linalg.lstsq(design / size, read**2 - np.sum(at**2, axis=1), rcond=1e-6)[0] / size
        # What the places reached leave open (a plane of them) goes across it.
        across = np.linalg.svd(at, full_matrices=True)[2][-1]
        missing = float(values[3] - values[:3] @ values[:3])
        spread = np.linalg.svd(at, compute_uv=False)
        level = spread[-1] < self.rules.level_places * spread[0]
        return middle + values[:3] + (across * np.sqrt(max(missing, 0.0)) if level else 0.0)

    def _fitted(self, place: _Place, steps: int) -> tuple[_Place, Array]:
        """Gauss and Newton's steps for frame, tool and anchor, and what these cannot tell of them (m, k)."""
        width, turns = self.width, 1 if self.flat else 3
        undetermined = np.zeros((0, 0))
        for _ in range(steps):
            place = self._touched(place)
            seen = self.seen(place)
            center = seen.at.mean(axis=0)
            reach = max(float(np.sqrt(np.mean(np.sum((seen.at - center) ** 2, axis=1)))), 1e-9)
            columns: list[Array] = []
            if self.frame_free:
                inside = self.framed if self.anchor_free else self.framed | self.distances
                framed = np.where(inside[:, :, None], seen.shown, 0.0)
                turned = np.stack([np.cross(axis, seen.at - center) for axis in np.eye(3)], axis=2)[:, :, -turns:]
                columns += [-framed[:, :, :width], -np.einsum("nwa,nak->nwk", framed, turned) / reach]
            if self.anchor_free:
                columns.append(-np.where(self.distances[:, :, None], seen.shown, 0.0))
            if self.tool_free:
                columns.append(np.einsum("nwa,nab->nwb", seen.shown, self.directions[:, :, :width]))
            own = sum(part.shape[2] for part in columns)
            labelled, _ = self._labelled(seen, place)
            design = np.concatenate([*columns, *labelled], axis=2).reshape(-1, own + sum(p.shape[2] for p in labelled))
            step, undetermined = _determined(design, seen.residual.reshape(-1), own, UNDETERMINED)
            at = 0
            if self.frame_free:
                shift, turn = np.zeros(3), np.zeros(3)
                shift[:width], turn[-turns:] = step[:width], step[width : width + turns] / reach
                rotation = Rotation.from_rotvec(turn).as_matrix()
                moved = rotation @ (place.translation - center) + center + shift
                place = replace(place, rotation=rotation @ place.rotation, translation=moved)
                at = width + turns
            if self.anchor_free and place.anchor is not None:
                place, at = replace(place, anchor=place.anchor + step[at : at + 3]), at + 3
            if self.tool_free:
                tool = place.tool.copy()
                tool[:width] += step[at : at + width]
                place = replace(place, tool=tool)
            if np.abs(step).max(initial=0.0) < _FOUND:
                break
        return self._touched(place), undetermined

    def _labelled(self, seen: _Seen, place: _Place) -> tuple[list[Array], list[str]]:
        """How readings move with the points and planes touched, (N, W, 2 or 3) each."""
        columns: list[Array] = []
        names: list[str] = []
        for label, name in enumerate(self.labels):
            rows = self.touches == label
            point = self.points & rows[:, None]
            if point.any():
                columns.append(-np.where(point[:, :, None], seen.shown[:, :, : self.width], 0.0))
                names += [f"point {name} {axis}" for axis in "xyz"[: self.width]]
                continue
            bar = self.bars & rows[:, None]
            if bar.any():
                directions = np.where(bar[:, :, None], seen.shown[:, :, : self.width], 0.0)
                across = self._across(place.bars[label])[:, : self.width]
                turned = np.einsum("nwa,ka->nwk", directions, across) * self.along[:, None, None]
                columns.append(np.concatenate([directions, turned], axis=2))
                names += [f"bar {name} {axis}" for axis in "xyz"[: self.width]]
                names += [f"bar {name} {what}" for what in ("turn", "other turn")[: len(across)]]
                continue
            plane = (self.slots == PLANE) & rows[:, None]
            if not plane.any():
                continue
            away = seen.at - seen.at[rows].mean(axis=0)
            normal = place.normals[label]
            tangents = self._across(normal)
            tilts = np.stack([np.ones(len(away)), *(away @ tangent for tangent in tangents)], axis=1)
            columns.append(np.where(plane[:, :, None], tilts[:, None, :], 0.0))
            names += [f"plane {name} {what}" for what in ("offset", "tilt", "other tilt")[: tilts.shape[1]]]
        return columns, names

    def _across(self, direction: Array) -> Array:
        """Directions across one (3,), (2, 3); in the plane the one, (1, 3)."""
        return np.array([[-direction[1], direction[0], 0.0]]) if self.flat else np.linalg.svd(direction[None])[2][1:]

    def _sentences(self, undetermined: Array) -> tuple[str, ...]:
        """What the readings do not tell of tool and anchor, in words."""
        if not undetermined.size:
            return ()
        sentences: list[str] = []
        shares = np.sum(undetermined**2, axis=0)
        if self.tool_free:
            shares_of_tool = shares[len(shares) - self.width :]
            axes = [
                axis for axis, part in zip("xyz", shares_of_tool.tolist(), strict=False) if part > self.rules.named_part
            ]
            if axes:
                sentences.append(
                    f"The target's place on the tool along {' and '.join(axes)} cannot be told from what was measured, "
                    "and is left as the arm file has it."
                )
        if self.anchor_free:
            first = (self.width + (1 if self.flat else 3)) if self.frame_free else 0
            if shares[first : first + self.width].sum() > self.rules.named_part:
                sentences.append(
                    "The places reached lie on a line or closer: where the anchor stands about it cannot be told."
                )
        return tuple(sentences)


def _determined(design: Array, target: Array, own: int, share: float) -> tuple[Array, Array]:
    """Least squares of a target (n,) by columns (n, k) in the directions that the readings tell: the step of the first
    `own`, and which directions of them are not told (m, own), those that move less than a share of the best."""
    beside = design[:, own:]
    if beside.shape[1]:
        basis, size, _ = np.linalg.svd(beside, full_matrices=False)
        basis = basis[:, size > 1e-9 * size[0]]
        design, target = design[:, :own] - basis @ (basis.T @ design[:, :own]), target - basis @ (basis.T @ target)
    u, s, vt = np.linalg.svd(design[:, :own], full_matrices=False)
    determined = s > share * s[0]
    return vt[determined].T @ ((u[:, determined].T @ target) / s[determined]), vt[~determined]


def _from_middle(along: Array, viewing: _Viewing) -> Array:
    """How far along its bar each reading touches (N,), m, from the middle of that bar's touches."""
    distances = np.zeros(len(along))
    for label in range(len(viewing.labels)):
        rows = (viewing.touches == label) & viewing.bars.any(axis=1)
        if rows.any():
            distances[rows] = along[rows] - along[rows].mean()
    return distances


def _marked(rows: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    marked = np.zeros(count, dtype=bool)
    marked[rows] = True
    return marked


def rigid_motions(at: Array) -> Array:
    """What each of the six ways to move the arm as a whole displaces its tips (N, 3) by, (N, 3, 6)."""
    shifts = np.broadcast_to(np.eye(3), (len(at), 3, 3))
    turns = np.stack([np.cross(axis, at) for axis in np.eye(3)], axis=2)
    return np.concatenate([shifts, turns], axis=2)


AXES = tuple(f"{what} {axis}" for what, axis in itertools.product(("along", "about"), "xyz"))
"""What `rigid_motions` are, in their order."""
