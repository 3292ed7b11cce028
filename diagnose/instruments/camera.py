"""A camera that sees a target: one of both is on the tool, and where either is nobody knows.

A camera that stands still reads where a target on the tool is in its frame; a camera on the tool reads where a target
that stands still is. Either way two unknown frames, six numbers each, close the chain from the measuring frame (the
camera's, or the fixed target's) over the arm to what the tool carries: the hand-eye problem. It is solved in closed
form first, whatever the rotations are (M. Shah, J. Mechanisms Robotics 5 (2013) 031007, doi:10.1115/1.4024473), then
by Gauss and Newton's steps over places and turns together, each weighed by its scatter; so is a scale of the
depths, which an error of the focal length makes. Residuals are in the camera's axes, for depth is read several
times worse than what lies across, and by turns about its axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.sections.numeric import Array

from .placement import UNDETERMINED, axes_in_words, rigid
from .registry import kinds_of

if TYPE_CHECKING:
    from linkwright.core.diagnose.recording import Recording

_STEPS, _FOUND = 60, 1e-13
_LONGEST = 0.5
"""rad; how far one step turns a frame at most."""
_EXACT = 1e-3
"""Of the scatter of the loosest number that any other is taken to have at least, where both frames are sought."""
DEPTHS = "depths of the camera"
"""What the nuisance is called that an error of the focal length makes."""


_EACH = ("residual", "turned", "axes", "shown", "turning", "depths", "at", "away", "carried", "lever")
"""What a sight holds of each reading."""


@dataclass(frozen=True)
class Sight:
    """What a camera's readings are against the model: `residual` (N, 3), m, and `turned` (N, 3), rad (zero where a
    row has no orientation), measured less modelled, both in the camera's axes, the columns of `axes` (N, 3, 3) in the
    base frame. `shown` and `turning` (N, 3, 3) are what displacements and turns of the tool in the base frame show,
    `depths` (N,), m, how deep in its view the target is. `rotation` and `translation` bring the measuring frame into
    the base's, `tool` is where on the last link the carried one is, beyond the arm's own, `depth` the share by which
    depths are read too long. `away` (N, 3), m, is the way from the camera to the target, `carried` (N,) where the
    camera is on the tool. `lever` (N, 3), m, is the way from the tip, at which loads act, to what is carried.
    """

    residual: Array
    turned: Array
    axes: Array
    shown: Array
    turning: Array
    depths: Array
    at: Array
    rotation: Array
    translation: Array
    tool: Array
    depth: float
    away: Array
    carried: NDArray[np.bool_]
    lever: Array
    undetermined: tuple[str, ...] = ()

    def change(self, moved: Array, turned: Array) -> Array:
        """What displacements of the tip (N, 3), m, and turns of the tool (N, 3), rad, show, exactly, (N, 3)."""
        turn = Rotation.from_rotvec(turned)
        there = moved + turn.apply(self.lever) - self.lever
        now = turn.inv().apply(self.away - there)
        return np.einsum("nwa,na->nw", self.shown, np.where(self.carried[:, None], self.away - now, there))

    @property
    def turning_about_tip(self) -> Array:
        """What turns of the tool about the tip show, (N, 3, 3)."""
        return self.turning - np.einsum("nwa,nab->nwb", self.shown, _crossed(self.lever))


def joined_sights(sights: Sequence[Sight | None]) -> Sight | None:
    """The sights of several cameras as one, in their order, the frames being the first one's; None without cameras."""
    present = [sight for sight in sights if sight is not None]
    if len(present) < len(sights) or not present:
        return None
    arrays = {name: np.concatenate([getattr(sight, name) for sight in present]) for name in _EACH}
    return replace(present[0], **arrays)


def is_camera(recording: Recording) -> bool:
    """Whether a recording was made by a camera."""
    return recording.slots is not None and any(kind.name == "camera" for kind in kinds_of(recording.slots))


@dataclass(frozen=True)
class _Place:
    """Where the measuring frame is (measured to base), the carried one's place and turn on the last link, and by which
    share depths are read too long."""

    rotation: Array
    translation: Array
    tool: Array
    seat: Array
    depth: float


def sighted(recording: Recording, tips: Array, flange: Array, *, rules: ResidualRules) -> Sight:
    """Set what a camera read against modelled tips (N, 3), m, and how the last link is turned `flange` (N, 3, 3)."""
    return _Sighting(recording, tips, flange, rules).sight()


class _Sighting:
    """The fit of both frames to one camera's readings."""

    def __init__(self, recording: Recording, tips: Array, flange: Array, rules: ResidualRules) -> None:
        self.recording, self.tips, self.flange, self.rules = recording, tips, flange, rules
        self.read, self.carried = recording.tip, recording.instrument.camera == "on_tool"
        turns = recording.orientation if recording.seat == "free" else None
        turns_ = np.full((recording.size, 3, 3), np.nan) if turns is None else turns
        self.sound = np.asarray(np.isfinite(turns_).all(axis=(1, 2)), dtype=np.bool_)
        seen = np.where(self.sound[:, None, None], turns_, np.eye(3))
        self.turns = np.transpose(seen, (0, 2, 1)) if self.carried else seen
        self.frame_free, self.tool_free = recording.frame == "free", recording.tool == "free"

    def sight(self) -> Sight:
        """The sight that fits best: of the starts that the turns and the places tell, whichever ends nearer."""
        ends = [self._fitted(start) for start in self._starts()]
        place, determined = min(ends, key=lambda end: self._misfit(end[0]))
        sight = self.seen(place)
        return replace(sight, undetermined=self._sentences(determined))

    def _misfit(self, place: _Place) -> float:
        seen = self.seen(place)
        reach = max(float(np.sqrt(np.mean(np.sum((self.tips - self.tips.mean(axis=0)) ** 2, axis=1)))), 1e-9)
        return float(np.mean(np.sum(seen.residual**2, axis=1)) + reach**2 * np.mean(np.sum(seen.turned**2, axis=1)))

    def seen(self, place: _Place) -> Sight:
        """The readings against what they should be."""
        lever = np.einsum("nab,b->na", self.flange, place.tool)
        at = self.tips + lever
        axes = self.flange @ place.seat if self.carried else np.broadcast_to(place.rotation, self.flange.shape)
        away = place.translation - at if self.carried else at - place.translation
        within = np.einsum("nab,na->nb", axes, away)
        depth = np.array([1.0, 1.0, 1.0 + place.depth])
        off = Rotation.from_matrix(place.rotation @ self.turns @ np.transpose(self.flange @ place.seat, (0, 2, 1)))
        turned = np.where(self.sound[:, None], np.einsum("nab,na->nb", axes, off.as_rotvec()), 0.0)
        across = depth[:, None] * np.transpose(axes, (0, 2, 1))
        return Sight(
            residual=self.read - depth * within,
            turned=turned,
            axes=axes,
            shown=-across if self.carried else across,
            turning=np.einsum("nwa,nab->nwb", across, _crossed(away)) if self.carried else np.zeros(across.shape),
            depths=depth[2] * within[:, 2],
            at=at,
            rotation=place.rotation,
            translation=place.translation,
            tool=place.tool,
            depth=place.depth,
            away=away,
            carried=np.full(len(at), self.carried),
            lever=lever,
        )

    def _starts(self) -> list[_Place]:
        """Where both may be, from the data alone."""
        places: list[_Place] = []
        if self.sound.sum() >= 2 or not self.frame_free:
            rotation = self._of_turns() if self.frame_free else np.eye(3)
            places.append(self._shifted(rotation, self._seat(rotation)))
        if self.frame_free and not self.carried:
            rotation, _ = rigid(self.read, self.tips)
            places.append(self._shifted(rotation, self._seat(rotation)))
        if self.carried and not self.sound.any():
            places.append(self._shifted(np.eye(3), self._of_places()))
        return places

    def _of_turns(self) -> Array:
        """How the measuring frame is turned, by the turns alone (Shah's closed form)."""
        inverse = np.transpose(self.turns[self.sound], (0, 2, 1))
        arm = np.transpose(self.flange[self.sound], (0, 2, 1))
        # The seat is flange' F turns: linear in F, by columns.
        both = np.einsum("nab,ncd->acbd", inverse, arm).reshape(9, 9)
        vector: Array = np.asarray(np.linalg.svd(both)[2][0], dtype=np.float64)
        return _nearest(vector.reshape(3, 3).T)

    def _seat(self, rotation: Array) -> Array:
        """How the carried one is turned on the last link, once the measuring frame is."""
        if not self.sound.any():
            return np.eye(3)
        seats = np.transpose(self.flange, (0, 2, 1)) @ rotation @ self.turns
        return np.asarray(Rotation.from_matrix(seats[self.sound]).mean().as_matrix())

    def _of_places(self) -> Array:
        """How a camera is turned on the tool, where its readings hold no turns: linear in that turn and both places."""
        # Flange (seat read + tool) - target = -tip.
        turned = np.einsum("nab,nc->nacb", self.flange, self.read).reshape(len(self.read), 3, 9)
        design = np.concatenate([turned, self.flange, -np.broadcast_to(np.eye(3), self.flange.shape)], axis=2)
        values = np.linalg.lstsq(design.reshape(-1, 15), -self.tips.reshape(-1), rcond=1e-9)[0]
        return _nearest(np.asarray(values[:9], dtype=np.float64).reshape(3, 3).T)

    def _shifted(self, rotation: Array, seat: Array) -> _Place:
        """Both places by least squares, once both turns are known."""
        if self.carried:
            predicted = self.tips + np.einsum("nab,nb->na", self.flange @ seat, self.read)
            design, target = np.concatenate([_alike(self.flange), -self.flange], axis=2), predicted
        else:
            predicted = self.read @ rotation.T - self.tips
            design, target = np.concatenate([-_alike(self.flange), self.flange], axis=2), predicted
        free = np.repeat([self.frame_free, self.tool_free], 3)
        values = np.zeros(6)
        if free.any():
            values[free] = np.linalg.lstsq(
                design[:, :, free].reshape(-1, int(free.sum())), target.reshape(-1), rcond=UNDETERMINED
            )[0]
        return _Place(rotation, values[:3], values[3:], seat, 0.0)

    def _fitted(self, place: _Place) -> tuple[_Place, Array]:
        """Gauss and Newton's steps for both frames and the depths, and the directions that are not told (m, 13)."""
        free = np.concatenate(
            [np.repeat([self.frame_free, self.frame_free, self.tool_free, True], 3), [True]]
        )  # shift and turn of the frame, place and turn of what is carried, depths
        untold = np.zeros((0, 13))
        for _ in range(_STEPS):
            seen = self.seen(place)
            rows, left, scale, lengths = self._rows(seen)
            # What can be told is a matter of the poses; how much each number counts, of its scatter.
            plain = (rows / lengths[:, None]).reshape(-1, 13)
            size = np.linalg.norm(plain, axis=0)
            used = free & (size > 1e-9 * size.max())
            _, s, vt = np.linalg.svd(plain[:, used] / size[used], full_matrices=False)
            determined = s > UNDETERMINED * s[0]
            ways = np.zeros((13, int(determined.sum())))
            ways[used] = vt[determined].T / size[used][:, None]
            weighed = (rows / scale[:, None]).reshape(-1, 13) @ ways
            step = ways @ np.linalg.lstsq(weighed, (left / scale).reshape(-1), rcond=None)[0]
            untold = np.zeros((int(np.sum(~determined)), 13))
            untold[:, used] = vt[~determined]
            longest = max(float(np.linalg.norm(step[3:6])), float(np.linalg.norm(step[9:12])))
            step *= min(1.0, _LONGEST / longest) if longest > 0.0 else 1.0
            place = self._stepped(place, step, seen)
            if np.abs(step).max() < _FOUND:
                break
        return place, untold

    def _rows(self, seen: Sight) -> tuple[Array, Array, Array, Array]:
        """How residuals (N, 6) go with both frames and the depths (N, 6, 13), the residuals, their scatter (6,), and
        what of each kind makes a metre (6,): turns by how far the tool reaches."""
        count = len(self.tips)
        center = seen.translation if self.carried else seen.at.mean(axis=0)
        inside = np.zeros((count, 3, 13))
        inside[:, :, 0:3] = -seen.shown
        if self.carried:
            inside[:, :, 9:12] = np.einsum("nwa,nab->nwb", seen.turning, self.flange)
        else:
            inside[:, :, 3:6] = -np.einsum("nwa,nab->nwb", seen.shown, -_crossed(seen.at - center))
        inside[:, :, 6:9] = np.einsum("nwa,nab->nwb", seen.shown, self.flange)
        inside[:, 2, 12] = seen.depths / (1.0 + seen.depth)
        turned = np.zeros((count, 3, 13))
        turned[:, :, 3:6] = -np.transpose(seen.axes, (0, 2, 1))
        turned[:, :, 9:12] = np.transpose(seen.axes, (0, 2, 1)) @ self.flange
        turned[~self.sound] = 0.0
        left = np.concatenate([seen.residual, seen.turned], axis=1)
        scale = 1.4826 * np.median(np.abs(left), axis=0)
        if self.sound.any():
            scale[3:] = 1.4826 * np.median(np.abs(seen.turned[self.sound]), axis=0)
        reach = max(float(np.sqrt(np.mean(np.sum((self.tips - self.tips.mean(axis=0)) ** 2, axis=1)))), 1e-9)
        lengths = np.repeat([1.0, 1.0 / reach], 3)
        # Numbers that are next to exact must not leave the others without a say.
        scale = np.maximum(scale, lengths * max(_EXACT * float((scale / lengths).max()), 1e-12))
        return np.concatenate([inside, turned], axis=1), left, scale, lengths

    def _stepped(self, place: _Place, step: Array, seen: Sight) -> _Place:
        """The place one step further."""
        center = seen.translation if self.carried else seen.at.mean(axis=0)
        turn = np.asarray(Rotation.from_rotvec(step[3:6]).as_matrix())
        # Seats turn about the last link's axes.
        seat = np.asarray(Rotation.from_rotvec(step[9:12]).as_matrix()) @ place.seat
        translation = turn @ (place.translation - center) + center + step[:3]
        return _Place(turn @ place.rotation, translation, place.tool + step[6:9], seat, place.depth + float(step[12]))

    def _sentences(self, untold: Array) -> tuple[str, ...]:
        """What the readings do not tell of both frames, in words."""
        if not len(untold):
            return ()
        shares = np.sum(untold**2, axis=0)
        what, where = ("camera", "target") if self.carried else ("target", "camera")
        named = self.rules.named_part
        axes = axes_in_words(shares[6:9], named)
        if axes:
            return (
                f"The tool hardly turns about more than one axis. The {what}'s place on the tool along "
                f"{axes} cannot be told apart from where the {where} stands. The arm file's value is "
                "kept.",
            )
        if (shares[9:12] > named).any():
            return (f"How the {what} is turned on the tool cannot be told apart from how the {where} stands.",)
        return ()


def _crossed(vectors: Array) -> Array:
    """The matrices (N, 3, 3) that take b to a x b, for vectors a (N, 3)."""
    return np.stack([np.cross(vectors, axis) for axis in np.eye(3)], axis=2)


def _alike(flange: Array) -> Array:
    return np.broadcast_to(np.eye(3), flange.shape)


def _nearest(matrix: Array) -> Array:
    """The rotation nearest to a matrix that is one but for its size and sign."""
    u, _, vt = np.linalg.svd(matrix * np.sign(np.linalg.det(matrix)))
    return u @ np.diag([1.0, 1.0, float(np.linalg.det(u @ vt))]) @ vt
