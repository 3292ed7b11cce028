"""What an instrument should read where the model has the tip, and what of it a displacement of the tip shows.

Each kind of instrument models its numbers (`instruments.kinds`); here frame, tool and what is unknown of every kind
are fitted together. Residuals are exact; what displacements, turns and nuisances show is to first order about where the
arm stands, as everywhere in the diagnosis.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .camera import DEPTHS, Sight, is_camera, sighted
from .kind import Change, Frame, Marked, Part, Scene, Seen
from .level import Stand
from .placement import axes_in_words, determined
from .registry import kinds_of, marked, slots_of

_STEPS, _START_STEPS, _START_ROWS = 40, 6, 150
_FOUND = 1e-12
_BETTER = 0.9
"""Of an earlier start's RMS, which turns less: another start must fit so much better."""


@dataclass(frozen=True)
class View:
    """A recording's readings against the model. `residual` (N, W), m, is measured less modelled; `shown` (N, W, D) what
    a displacement of the tip along each axis of the base shows, `turning` (N, W, 3) what a turn about each axis of the
    base of what the instrument stands on does (of the tool, about the tip), `beside` (N, W, b) what the unknowns of the
    kinds of instruments (`names`) do. `rotation` and `translation` bring what was measured into the base frame, `tool`
    is added to the arm's own, in the last link's frame, m. `at` (N, 3) is where the tip stands; `settled` (N, 3) the
    same but on what was touched: how far off it is told is what was measured, and nothing may be made of that to
    explain it. `framed` (N, W) marks places and heights in the measuring frame, `changes` are what is not linear.
    `sight` is what else there is of a camera.
    """

    residual: Array
    shown: Array
    turning: Array
    beside: Array
    names: tuple[str, ...]
    rotation: Array
    translation: Array
    tool: Array
    at: Array
    framed: Marked
    settled: Array
    changes: tuple[Change, ...] = ()
    sight: Sight | None = None
    undetermined: tuple[str, ...] = ()

    @property
    def turned(self) -> Array:
        """What a turn about each axis of the base of what the instrument stands on shows, (N, W, 3)."""
        return self.turning if self.sight is None else self.sight.turning_about_tip

    def of_tip(self, moved: Array, turned: Array | None = None) -> Array:
        """What displacements of the tip (N, 3), m, and turns of what the instrument stands on (N, 3), rad, show to
        first order, (N, W)."""
        seen = np.einsum("nwa,na->nw", self.shown, moved[:, : self.shown.shape[2]])
        return seen if turned is None else seen + np.einsum("nwa,na->nw", self.turned, turned)

    def change(self, moved: Array, turned: Array | None = None) -> Array:
        """What displacements of the tip (N, 3), m, and turns of what the instrument stands on (N, 3), rad, show
        exactly, (N, W)."""
        turns = np.zeros(moved.shape) if turned is None else turned
        if self.sight is not None:
            return self.sight.change(moved, turns)
        seen = self.of_tip(moved, turned)
        for change in self.changes:
            seen = np.where(change.mask, change.exact(moved, turns), seen)
        return seen


@dataclass(frozen=True)
class Within(Change):
    """A change of the readings of one recording among those of several, from the row `first` on."""

    change: Change
    first: int
    rows: int

    @property
    def mask(self) -> Marked:  # pyright: ignore[reportIncompatibleVariableOverride] - of all rows
        """Those of that recording."""
        marked = self.change.mask
        mask = np.zeros((self.rows, marked.shape[1]), dtype=np.bool_)
        mask[self.first : self.first + len(marked)] = marked
        return mask

    def exact(self, moved: Array, turned: Array) -> Array:
        """Of its rows, zero of others."""
        rows_here = slice(self.first, self.first + len(self.change.mask))
        seen = np.zeros((self.rows, self.change.mask.shape[1]))
        seen[rows_here] = self.change.exact(moved[rows_here], turned[rows_here])
        return seen


@dataclass(frozen=True)
class _Place:
    """Where the frame stands (measured to base), the tool's offset, and the state of each kind's unknowns."""

    rotation: Array
    translation: Array
    tool: Array
    states: tuple[Any, ...]

    @property
    def frame(self) -> Frame:
        """The measuring frame."""
        return Frame(self.rotation, self.translation)


def viewed(
    recording: Recording,
    tips: Array,
    directions: Array,
    stand: Stand | None = None,
    *,
    flat: bool,
    rules: ResidualRules = RULES.residual,
) -> View:
    """Set what was read against modelled tips (N, 3), m, with frame, tool and all else free where the recording says
    so; `directions` (N, 3, 3) are how an offset of the tool displaces the tip, `stand` is what a level stands on. An
    arm that stays in its plane is `flat`.
    """
    if is_camera(recording):
        return _of_camera(sighted(recording, tips, directions, rules=rules), tips)
    return _Viewing(recording, tips, directions, stand, flat, rules).view()


def _of_camera(sight: Sight, tips: Array) -> View:
    """The view of a camera on modelled tips (N, 3), m, whose depths may be off in proportion besides."""
    none = np.zeros(sight.residual.shape, dtype=bool)
    deep = np.zeros((*sight.residual.shape, 1))
    deep[:, 2, 0] = sight.depths
    return View(
        residual=sight.residual,
        shown=sight.shown,
        turning=np.zeros(sight.shown.shape),
        beside=deep,
        names=(DEPTHS,),
        rotation=sight.rotation,
        translation=sight.translation,
        tool=sight.tool,
        at=tips,
        framed=none,
        settled=tips,
        sight=sight,
        undetermined=sight.undetermined,
    )


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
        self.recording, self.flat, self.width = recording, flat, 2 if flat else 3
        kinds = kinds_of(recording.slots)
        self.framed = marked(recording.slots, [kind for kind in kinds if kind.framed])
        touches = np.full(recording.size, -1) if recording.touches is None else recording.touches
        self.scene = Scene(
            recording.instrument, recording.slots, recording.tip, tips, directions, stand, touches, recording.bar_at,
            recording.frame == "free", self.framed, flat, rules,
        )  # fmt: skip
        parts = (kind.part(slots_of(kind.name)[0], self.scene) for kind in kinds)
        self.parts: list[Part] = [part for part in parts if part is not None]
        self.stepped_count = sum(len(part.own_names) for part in self.parts)
        self.frame_free = recording.frame == "free" and bool(self.framed.any())
        self.tool_free = recording.tool == "free"

    def view(self) -> View:
        """The view that fits best."""
        place = self._start()
        undetermined = np.zeros((0, 0))
        if self.frame_free or self.tool_free or self.stepped_count:
            place, undetermined = self._fitted(place, _STEPS)
        seen = self.seen(place)
        columns = [part.own_columns(state, seen) for part, state in self._each(place)]
        names = [name for part in self.parts for name in part.own_names]
        for part, state in self._each(place):
            further, further_names = part.beside(state, seen)
            columns, names = [*columns, *further], [*names, *further_names]
        for part, state in self._each(place):
            further, further_names = part.also(state, seen)
            columns, names = [*columns, *further], [*names, *further_names]
        settled = seen.at.copy()
        for part, state in self._each(place):
            part.settled(state, seen.at, settled)
        changes = (part.change(state, seen, place.frame) for part, state in self._each(place))
        width = self.width
        return View(
            residual=seen.residual,
            shown=seen.shown[:, :, :width],
            turning=seen.turning,
            beside=np.concatenate([np.zeros((*self.scene.slots.shape, 0)), *columns], axis=2),
            names=tuple(names),
            rotation=place.rotation[:width, :width],
            translation=place.translation[:width],
            tool=place.tool[:width],
            at=seen.at,
            framed=self.framed,
            settled=settled,
            changes=tuple(change for change in changes if change is not None),
            undetermined=self._sentences(undetermined),
        )

    def _each(self, place: _Place) -> Iterator[tuple[Part, Any]]:
        """Each kind's numbers with their state."""
        return zip(self.parts, place.states, strict=True)

    def _at(self, place: _Place) -> Array:
        return self.scene.tips + np.einsum("nab,b->na", self.scene.directions, place.tool)

    def seen(self, place: _Place) -> Seen:
        """The readings against what they should be."""
        at = self._at(place)
        modelled, shown, turning = (np.zeros((*self.scene.slots.shape, *more)) for more in ((), (3,), (3,)))
        for part, state in self._each(place):
            modelled_part = part.model(state, at, place.frame)
            where = np.clip(self.scene.slots - part.first, 0, modelled_part.values.shape[1] - 1)
            modelled = np.where(part.mask, np.take_along_axis(modelled_part.values, where, axis=1), modelled)
            shown, turning = (
                np.where(part.mask[:, :, None], np.take_along_axis(item, where[:, :, None], axis=1), before)
                for item, before in ((modelled_part.shown, shown), (modelled_part.turning, turning))
            )
        return Seen(self.scene.read - modelled, shown, turning, at)

    def _refitted(self, place: _Place) -> _Place:
        """The place with the states that fit the tips best."""
        at = self._at(place)
        return replace(place, states=tuple(part.refit(state, at) for part, state in self._each(place)))

    def _start(self) -> _Place:
        place = _Place(np.eye(3), np.zeros(3), np.zeros(3), tuple(part.start() for part in self.parts))
        if not self.frame_free:
            return place
        count = len(self.scene.tips)
        rows = np.unique(np.linspace(0, count - 1, _START_ROWS).astype(int))
        few = _Viewing(
            replace(self.recording.kept(_marked(rows, count)), tool="known"),
            self.scene.tips[rows], self.scene.directions[rows], None, self.flat, self.scene.rules,
        )  # fmt: skip
        if len(few.parts) < len(self.parts):  # of a kind there is none among so few rows
            few = self
        best, least = place, np.inf
        for rotation in self._rotations():
            tried = replace(place, rotation=rotation, translation=self._shift(rotation, place))
            result, _ = few._fitted(tried, _START_STEPS)  # its kind
            rms = few.seen(result).rms()
            # An earlier start turns less: it stays unless another fits clearly better.
            if rms < _BETTER * least:
                best, least = replace(place, rotation=result.rotation, translation=result.translation), rms
        return best

    def _rotations(self) -> Iterator[Array]:
        """Where frames may stand: as the base does, as the numbers say, and turned anyhow."""
        yield np.eye(3)
        for part in self.parts:
            yield from part.rotations()
        if self.flat:
            yield from (Rotation.from_rotvec([0.0, 0.0, k * np.pi / 4.0]).as_matrix() for k in range(1, 8))
            return
        yield from Rotation.create_group("O").as_matrix()

    def _shift(self, rotation: Array, place: _Place) -> Array:
        """Where the frame stands best once it is turned so (3,), m."""
        seen = self.seen(replace(place, rotation=rotation, translation=np.zeros(3)))
        shift = np.linalg.lstsq(-seen.shown[self.framed], seen.residual[self.framed], rcond=1e-9)[0]
        return np.asarray(shift, dtype=np.float64)

    def _fitted(self, place: _Place, steps: int) -> tuple[_Place, Array]:
        """Gauss and Newton's steps for frame, tool and what is unknown of the kinds, and what is not told of them
        (m, k)."""
        width, turns = self.width, 1 if self.flat else 3
        undetermined = np.zeros((0, 0))
        for _ in range(steps):
            place = self._refitted(place)
            seen = self.seen(place)
            center = seen.at.mean(axis=0)
            reach = max(float(np.sqrt(np.mean(np.sum((seen.at - center) ** 2, axis=1)))), 1e-9)
            columns: list[Array] = []
            if self.frame_free:
                inside = np.any([part.in_frame() for part in self.parts], axis=0)
                framed = np.where(inside[:, :, None], seen.shown, 0.0)
                turned = np.stack([np.cross(axis, seen.at - center) for axis in np.eye(3)], axis=2)[:, :, -turns:]
                columns += [-framed[:, :, :width], -np.einsum("nwa,nak->nwk", framed, turned) / reach]
            columns += [part.own_columns(state, seen) for part, state in self._each(place)]
            if self.tool_free:
                columns.append(np.einsum("nwa,nab->nwb", seen.shown, self.scene.directions[:, :, :width]))
            stepped = sum(part.shape[2] for part in columns)
            beside = [column for part, state in self._each(place) for column in part.beside(state, seen)[0]]
            design = np.concatenate([*columns, *beside], axis=2).reshape(-1, stepped + sum(p.shape[2] for p in beside))
            step, undetermined = _determined(design, seen.residual.reshape(-1), stepped)
            at = 0
            if self.frame_free:
                shift, turn = np.zeros(3), np.zeros(3)
                shift[:width], turn[-turns:] = step[:width], step[width : width + turns] / reach
                rotation = Rotation.from_rotvec(turn).as_matrix()
                moved = rotation @ (place.translation - center) + center + shift
                place = replace(place, rotation=rotation @ place.rotation, translation=moved)
                at = width + turns
            states: list[Any] = []
            for part, state in self._each(place):
                states.append(part.stepped(state, step[at : at + len(part.own_names)]))
                at += len(part.own_names)
            place = replace(place, states=tuple(states))
            if self.tool_free:
                tool = place.tool.copy()
                tool[:width] += step[at : at + width]
                place = replace(place, tool=tool)
            if np.abs(step).max(initial=0.0) < _FOUND:
                break
        return self._refitted(place), undetermined

    def _sentences(self, undetermined: Array) -> tuple[str, ...]:
        """What the readings do not tell of the tool and of the kinds' unknowns, in words."""
        if not undetermined.size:
            return ()
        sentences: list[str] = []
        shares = np.sum(undetermined**2, axis=0)
        if self.tool_free:
            axes = axes_in_words(shares[len(shares) - self.width :], self.scene.rules.named_part)
            if axes:
                sentences.append(
                    f"The target's place on the tool along {axes} cannot be told from what was measured, "
                    "and is left as the arm file has it."
                )
        at = (self.width + (1 if self.flat else 3)) if self.frame_free else 0
        for part in self.parts:
            if part.own_names:
                sentences += part.untold(shares[at : at + len(part.own_names)])
                at += len(part.own_names)
        return tuple(sentences)


def _determined(design: Array, target: Array, stepped_count: int) -> tuple[Array, Array]:
    """The step of the first `stepped_count` of columns (n, k), what the others take of a target (n,) left aside, and
    which directions of the step are not told (m, own)."""
    stepped, beside = design[:, :stepped_count], design[:, stepped_count:]
    if beside.shape[1]:
        basis, size, _ = np.linalg.svd(beside, full_matrices=False)
        basis = basis[:, size > 1e-9 * size[0]]
        stepped, target = stepped - basis @ (basis.T @ stepped), target - basis @ (basis.T @ target)
    return determined(stepped, target)


def _marked(rows: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    marked = np.zeros(count, dtype=bool)
    marked[rows] = True
    return marked


def rigid_motions(at: Array) -> Array:
    """What each of the six ways to move the arm as a whole displaces its tips (N, 3) by, (N, 3, 6)."""
    shifts = np.broadcast_to(np.eye(3), (len(at), 3, 3))
    turns = np.stack([np.cross(axis, at) for axis in np.eye(3)], axis=2)
    return np.concatenate([shifts, turns], axis=2)
