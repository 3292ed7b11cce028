"""What some effects are beside their core, by subject: play, drives, links, recordings, watches.

>>> import linkwright as lw
>>> lw.traits.RecordingTraits(least_travel=0.5).of_instrument
False
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector

if TYPE_CHECKING:
    from .effect import Disc, Interval, Kink, Settings, Twist


def nothing(state: PoseState, settings: Settings) -> tuple[()]:
    """For effects without twists, without play, or smooth in the loads."""
    del state, settings
    return ()


def stands_plumb(settings: Settings) -> Vector:
    """No turn: for effects that leave the base as plumb as the arm file has it."""
    del settings
    return ZERO


@dataclass(frozen=True)
class Readings:
    """What a recording of N readings holds, for an effect to say whether it shows there: the arm's state at them, the
    joint coordinates `q` (N, n) in rad and m, and the clock `time` (N,) in s, None where it has none."""

    state: PoseState
    q: NDArray[np.float64]
    time: NDArray[np.float64] | None


def always_shown(readings: Readings, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    """True: for effects that ask no more of a recording than what they `require`."""
    del readings, at, shapes
    return True


@dataclass(frozen=True)
class Sum:
    """A parameter that an effect may be given by in place of a size, and is told by where a recording does not show its
    sizes one by one: the sum of them times `factors`, by what the arm's beams and the place (from 0) are; None where
    that is no one figure. `beside` is the size of which only this sum may show."""

    name: str
    factors: Callable[[Sequence[Beam], int], Mapping[str, float] | None]
    beside: str


@dataclass(frozen=True)
class PlayTraits:
    """What an effect leaves free, and where its displacement bends.

    `free` gives what it leaves free at a pose. A recording knows more than a design: there `seated` says where the play
    came to lie, by the load or by the side of approach. `kinks` tells which of the twists are piecewise linear in a
    load, and where they bend. `repeats` marks play that is a deviation nobody knows but the same whenever the arm
    stands there, so that a calibration takes it.

    >>> import linkwright as lw
    >>> lw.effects["backlash"].play.repeats
    False
    """

    free: Callable[[PoseState, Settings], Iterable[Interval | Disc]] = nothing
    seated: Callable[[PoseState, Settings], Iterable[Twist]] = nothing
    kinks: Callable[[PoseState, Settings], Iterable[Kink]] = nothing
    repeats: bool = False


@dataclass(frozen=True)
class DriveTraits:
    """What an effect is of a drive.

    `needed` marks what only a drive does: a passive joint has none. `gives` marks how drives give: it adds to what the
    arm file gives them, the whole may not become negative, and under links of unknown weight only its product with that
    weight can be known. `before_encoder` marks what moves the joint away from its command but is seen by the encoder:
    it moves the tip only as long as the coordinates are commands. `across` marks what a joint does beside its
    coordinate, of which an encoder on it sees nothing. `by_load` marks how far its link goes from its motor by nothing
    but the load between the two: encoders on both sides show it in motion. `curve` gives a joint's error (rad) at
    coordinates (rad) by the parameters' values, for what is drawn as a curve.

    >>> import linkwright as lw
    >>> lw.effects["servo_droop"].drive.before_encoder
    True
    """

    needed: bool = False
    gives: bool = False
    before_encoder: bool = False
    across: bool = False
    by_load: bool = False
    curve: Callable[[Scalar, Mapping[str, float]], Scalar] | None = None


@dataclass(frozen=True)
class LinkTraits:
    """What an effect is of links, and of what gives in the arm.

    `built_in` marks what another link would not have (None: as all effects at links). `along` marks what every piece of
    a link does alike, by the loads on it, so that a link that is cut does what the whole does; `turns_along` which of
    these turns the pieces beyond. `shear_modulus` says where its materials need one, `expansion_unless` that they need
    a coefficient of thermal expansion where an entry does not give this parameter. `flexible` marks what gives in
    proportion to the load, so that unknown loads act through it. Where it is automatic, frequencies count it too: as
    long as it is in the model, or, `in_modes`, always. `through_flexibility` marks loads that move the tip by what
    gives in the arm, what `effects` add to that included. `declared` tells what an arm file whose links are these beams
    gives already of the first size at a joint or link (from 0), in its unit: file and finding together are not less
    than zero (infinite: nobody knows).

    >>> import linkwright as lw
    >>> lw.effects["link_bending"].link.flexible
    True
    """

    built_in: bool | None = None
    along: bool = False
    turns_along: bool = False
    shear_modulus: Literal["in space", "always"] | None = None
    expansion_unless: str | None = None
    flexible: bool = False
    in_modes: bool = False
    through_flexibility: bool = False
    declared: Callable[[Arm, Sequence[Beam], int], float] | None = None


@dataclass(frozen=True)
class RecordingTraits:
    """What a diagnosis of a recording goes by.

    `of_instrument` marks what the measurement brings in: a corrected arm may carry it, but it moves no tip. `free_with`
    is the setting of a recording that leaves its sizes open. `least_travel` (rad, m) is how far a joint must have gone
    for the effect to be sought there, and `shown_by` whether a recording holds what it takes to see it at these places
    (from 0) with these shapes. `size_from_slope` turns a size found with the pattern of small ones into the one that
    moves as much, where displacements are not in proportion. `under_forces` marks what gives under forces, not under
    moments about where it is alone: of links that nobody has weighed it shows the masses beside the first moments.
    `weights_named` marks what could be almost anything under unknown weights of its own, and is sought only under those
    that an arm file names. `last_resort` marks what could be any torque over its joint's coordinate, and is sought only
    where all else leaves something. `of_voltage` marks what only a log of voltages shows. `told_as` is a sum of its
    sizes by which it is reported where they do not show one by one.
    `sizes_at` names which of its sizes a joint or link (from 0) of an arm has, where not all have the same.
    `against_plumb` is how the whole arm is turned against the plumb line (rad, about the base's axes), of which levels
    see what the tip does not.

    >>> import linkwright as lw
    >>> lw.effects["instrument_scale"].recording.of_instrument
    True
    """

    of_instrument: bool = False
    free_with: Literal["frame", "tool"] | None = None
    least_travel: float = 0.0
    shown_by: Callable[[Readings, tuple[int, ...], Mapping[str, float]], bool] = always_shown
    size_from_slope: Callable[[float], float] | None = None
    under_forces: bool = False
    weights_named: bool = False
    last_resort: bool = False
    of_voltage: bool = False
    told_as: Sum | None = None
    sizes_at: Callable[[Arm, int], tuple[str, ...]] | None = None
    against_plumb: Callable[[Settings], Vector] = stands_plumb


@dataclass(frozen=True)
class WatchTraits:
    """How an effect goes on from one recording to the next.

    `lasts` says how long it stays as it is: as long as `the arm` does, `a while` (until something wears, slips, is
    adjusted or mounted anew), or as long as `a recording` (what is held, how it is measured). `always` marks what is
    looked at in every watch over dated recordings, named by a diagnosis or not.

    >>> import linkwright as lw
    >>> lw.effects["servo_droop"].watch.lasts
    'a while'
    """

    lasts: Literal["the arm", "a while", "a recording"] = "the arm"
    always: bool = False
