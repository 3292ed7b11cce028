"""Rules of what is noise: repeats, visits, outliers, orientations."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, rule


@dataclass(frozen=True)
class ResidualRules:
    """What counts as one pose, one visit, one load, and what repeats tell."""

    same_pose: tuple[float, float] = rule(
        (2e-4, 2e-5),
        "rad, of slides m",
        "Joints closer than this are at the same pose. The limit is the repeatability of servos, and finer than any "
        "grid.",
    )
    same_session: float = rule(
        0.25,
        "share of what both last",
        "A recording continues another if its clock goes on after a pause no longer than this (a tracker set up anew, "
        "a battery changed). In a longer pause the arm may have done other work.",
    )
    level_places: float = rule(
        1e-3,
        "share of their extent",
        "Places that reach less far across lie in a plane (an anchor is outside it), on a line, or are one.",
    )
    torque_off: float = rule(
        0.05,
        "share",
        "Weights that torques show to be further off than this are reported. Compliance then uses the measured torque. "
        "Torque constants of motors are known to some percent.",
    )
    torque_sure: float = rule(4.0, "standard errors", "Weights that are off must be off by this many standard errors.")
    torque_seen: float = rule(
        0.02,
        "share of the load's spread",
        "If links or payload change a drive's torque by less from pose to pose, the torque says nothing about them. If "
        "they change it by less than this share of a log's largest, the current says nothing about the torque "
        "constant.",
    )
    torque_least: float = rule(
        0.2,
        "share of the torque's spread",
        "If the model's load spreads by less, a torque shows something other than weights (friction, a sensor that "
        "drifts). No arm file is off by such a factor.",
    )
    torque_against: float = rule(
        -0.5, "correlation", "Torque that is so opposite to the load that it should hold has the other sign."
    )
    mass_beside: float = rule(
        0.1,
        "share of the reach",
        "Masses of links that nobody has weighed lie this far beside a link, or half its length, since motors sit "
        "there.",
    )
    same_payload: float = rule(
        1e-3,
        "kg, share",
        "A smaller change is a scale's noise, and no new payload. A payload, side or force that changes by a larger "
        "share is another one.",
    )
    long_pause: float = rule(10.0, "usual intervals", "After a longer pause readings at one pose are no plain repeats.")
    coarsest: float = rule(
        10.0,
        "times same_pose",
        "An encoder may be as coarse as this, and one pose as wide. A joint that moves by no more stands still.",
    )
    one_pose: float = rule(
        4.0,
        "times how close the readings of a visit lie",
        "Visits whose centres lie closer are of one pose. Drives return less exactly than a reading repeats.",
    )
    other_temperature: float = rule(
        1.0, "K", "Temperatures of a recording that lie further apart are separate conditions."
    )
    other_speed: float = rule(
        1e-2, "share", "A speed that changes by a larger share from one reading to the next is another one."
    )
    enough_freedom: int = rule(
        5,
        "degrees of freedom",
        "From here on repeats are trusted more than a declared sigma, and rows are judged by the majority.",
        PROOF,
        rows="A standard deviation from fewer is wrong by a third or more, and a median says nothing about each of "
        "them.",
    )
    beyond_chance: float = rule(
        2.5,
        "standard errors",
        "Two numbers that are nearer may be equal. A visit is still settling if its second reading is further off, the "
        "way the first is. Visits of one pose that differ by more drift. A parameter further outside its bounds is "
        "impossible. A correlation of neighbours further from zero is allowed for.",
        PROOF,
    )
    level: float = rule(
        0.01,
        "p-value",
        "The level of tests of a whole recording or log. They ask whether rows are outliers, and whether the rows set "
        "aside have something in common. They ask whether repeats disagree with the declared sigma, and whether visits "
        "differ by more than their readings (intervals and rejections then use the visits). They ask whether a "
        "mismatch depends on a covariate, and whether a log's torques show an effect, an order or a dependence.",
    )
    surely: float = rule(
        0.001,
        "p-value",
        "The level of tests that are made many times. They ask whether a stay drifts, and whether readings of one pose "
        "refute what was named (lack of fit).",
    )
    short_stay: int = rule(
        6,
        "readings",
        "A stay at least twice as long is cut into visits of this length, since arms warm and frames drift meanwhile.",
        PROOF,
        rows="It counts the readings of one stay, not of the recording.",
    )
    neighbours: int = rule(
        4,
        "readings",
        "A stay that drifts is cut into runs of this many repeats.",
        rows="It counts the readings of one stay, not of the recording.",
    )
    named_part: float = rule(0.1, "share", "Parts that have a larger share of an undetermined direction are named.")
    turned: float = rule(
        0.1,
        "rad",
        "Poses that differ by no more do not show how orientations are written. Measured and modelled turns that "
        "differ by more (median) are of different conventions. A frame turned by more is another frame, and no mount "
        "that has shifted. A range that lacks no more is a whole turn.",
    )

    def same_coordinate(self, revolute: bool) -> float:
        """How close a joint's coordinates at one pose lie: rad, of a slide m."""
        return self.same_pose[0 if revolute else 1]

    def coarsest_count(self, revolute: bool) -> float:
        """By how much a joint that stands still may seem to move: rad, of a slide m."""
        return self.coarsest * self.same_coordinate(revolute)
