"""A plan: the readings to take, what they will show, and what poses at random would."""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.instruments.touched import touched_bars, touched_planes
from linkwright.core.diagnose.recording import Recording

from .plan_request import Asked
from .promise import Promise, Shown


@dataclass(frozen=True)
class Touched:
    """A point, or the middle of where a plane or bar is touched, `at` (m, base frame), the plane's `normal`, and the
    `way` in which the bar points."""

    label: str
    at: tuple[float, float, float]
    normal: tuple[float, ...] | None
    way: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Planned:
    """`recording` holds the readings in their order (its tips are where the arm stands undeformed), `axes` the
    numbers that the instrument reads, `promise` what they will show, `random` what some plans at random would.
    `returns` are the visits (from 1) that go back to one pose, `with_time` the largest correlation of the order with a
    joint or a side, `tried` how many visits were tried. `after` is the recording that it goes on from (None: none).
    `interrupted`: it was stopped, and is the best until then, with as many plans at random as were made."""

    arm: Arm
    asked: Asked
    recording: Recording
    axes: tuple[str, ...]
    promise: Promise
    random: tuple[Promise, ...]
    returns: tuple[int, ...]
    with_time: float
    tried: int
    seconds: float
    after: Recording | None = None
    interrupted: bool = False

    @property
    def visits(self) -> Recording:
        """The first reading of each visit."""
        rows = self.recording.row
        return self.recording.kept((rows - 1) % self.asked.repeats == 0)

    @property
    def touched(self) -> tuple[Touched, ...]:
        """The points, planes or bars that are touched, as the arm undeformed reaches them."""
        visits = self.visits
        if visits.touches is None:
            return ()
        at, flat, count = tip_position(self.arm, visits.q), self.arm.planar(), len(visits.instrument.labels)
        normals = touched_planes(at, visits.touches, count, flat=flat)[0]
        middle = [at[visits.touches == label].mean(axis=0).tolist() for label in range(count)]
        planes = self.asked.instrument == "plane"
        if visits.bar_at is not None:
            ways = touched_bars(at, visits.touches, visits.bar_at, count)[1]
            return tuple(
                Touched(name, (where[0], where[1], where[2]), None, tuple(way.tolist()))
                for name, where, way in zip(visits.instrument.labels, middle, ways, strict=True)
            )
        return tuple(
            Touched(name, (where[0], where[1], where[2]), tuple(normal.tolist()) if planes else None)
            for name, where, normal in zip(visits.instrument.labels, middle, normals, strict=True)
        )

    def at_random(self, shown: Shown) -> float:
        """The smallest size of a parameter that the middle one of the plans at random shows; infinite where most do not
        show it."""
        sizes = [next((item.smallest for item in one.shown if _same(item, shown)), math.inf) for one in self.random]
        return sorted(sizes)[len(sizes) // 2] if sizes else math.inf

    def torques_at_random(self, joint: int, name: str) -> float:
        """The standard error of `links`, `payload` or `friction` by the torque of a drive (joint from 1) that the
        middle one of the plans at random has; infinite where most do not tell it."""
        torques = [next((torque for torque in one.torques if torque.joint == joint), None) for one in self.random]
        values: list[float | None] = [None if torque is None else getattr(torque, name) for torque in torques]
        values_sorted = sorted(math.inf if value is None else value for value in values)
        return values_sorted[len(values_sorted) // 2] if values_sorted else math.inf

    @property
    def separated_at_random(self) -> tuple[int, int]:
        """Of how many pairs of causes how many the middle one of the plans at random tells apart: (told, pairs). What a
        plan does not see has no pairs, so that plans have not the same number of them."""
        counts = sorted(((one.separated, one.pairs) for one in self.random), key=lambda item: item[0] / max(item[1], 1))
        return counts[len(counts) // 2] if counts else (0, 0)

    @property
    def tells_more(self) -> bool:
        """Whether it tells more of its pairs of causes apart, as a share, than any of the plans at random of theirs."""
        return bool(self.random) and _share(self.promise) > max(map(_share, self.random))

    @property
    def smaller(self) -> float:
        """How many times smaller the sizes are that it shows than those at random, on average (geometric mean) over
        the causes that both show; nan where there are none."""
        sizes = [(self.at_random(item), item.smallest) for item in self.promise.shown]
        gains = [math.log(random / designed) for random, designed in sizes if math.isfinite(random)]
        return math.exp(sum(gains) / len(gains)) if gains else math.nan


def _share(promise: Promise) -> float:
    return promise.separated / max(promise.pairs, 1)


def _same(one: Shown, other: Shown) -> bool:
    """Whether two are one cause by sizes of one kind (of a sine and a cosine either may show least)."""
    return (one.effect, one.at, one.kind) == (other.effect, other.at, other.kind)
