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
        "Joints closer than this are at the same pose: what servos come back to, and finer than any grid.",
    )
    same_session: float = rule(
        0.25,
        "share of what both last",
        "A recording whose clock goes on from another's after a pause no longer than this goes on from it: a tracker "
        "set up anew, a battery changed. In a longer one the arm may have been put to other work.",
    )
    level_places: float = rule(
        1e-3,
        "share of their extent",
        "Places that reach less far across lie in a plane (an anchor is beside it), on a line, or are one.",
    )
    torque_off: float = rule(
        0.05,
        "share",
        "Weights that torques find further off than this are said, and compliance goes by the torque measured: motors' "
        "torque constants are known to some percent.",
    )
    torque_sure: float = rule(4.0, "standard errors", "So far off they must be beyond doubt.")
    torque_seen: float = rule(
        0.02,
        "share of the load's spread",
        "What links or payload turn a drive by less, from pose to pose, its torque tells nothing of; nor, of a log's "
        "largest, its current of the torque constant.",
    )
    torque_least: float = rule(
        0.2,
        "share of the torque's spread",
        "Where the model's load spreads by less, a torque is another thing than weights (friction, a sensor that "
        "drifts): no arm file is off by such a factor.",
    )
    torque_against: float = rule(
        -0.5, "correlation", "Torque that goes so much against the load that it should hold is counted the other way."
    )
    mass_beside: float = rule(
        0.1,
        "share of the reach",
        "Masses of links that nobody has weighed lie so far beside a link, or half its length: motors sit there.",
    )
    same_payload: float = rule(
        1e-3,
        "kg, share",
        "A scale's noise is no new payload; payload, side or force that changes by a larger share is another.",
    )
    long_pause: float = rule(10.0, "usual intervals", "After a longer pause readings at one pose are no plain repeats.")
    coarsest: float = rule(
        10.0,
        "times same_pose",
        "An encoder may count as coarsely as this, and one pose be as wide; a joint that moves by no more "
        "stands still.",
    )
    one_pose: float = rule(
        4.0,
        "times how close the readings of a visit lie",
        "Visits whose middles lie closer are of one pose: drives come back less exactly than a reading repeats.",
    )
    other_temperature: float = rule(
        1.0, "K", "Temperatures of a recording that lie further apart are conditions of their own."
    )
    other_speed: float = rule(1e-2, "share", "A speed that changes by more from one reading to the next is another.")
    enough_freedom: int = rule(
        5,
        "degrees of freedom",
        "From here on repeats are trusted more than a declared sigma, and rows are judged by what most of them say.",
        PROOF,
        rows="A standard deviation from fewer is off by a third and more, and a median says nothing of each.",
    )
    beyond_chance: float = rule(
        2.5,
        "standard errors",
        "Nearer than this two numbers may be one: a visit's second reading that lies further off the later ones, the "
        "way the first does, still settles; visits of one pose that differ by more drift; a size further outside its "
        "bounds is impossible, not just badly known; so far from zero a correlation of neighbours is allowed for.",
        PROOF,
    )
    level: float = rule(
        0.01,
        "p-value",
        "Of a test made of a recording or a log as a whole: that rows are outliers, that those set aside have "
        "something in common, that repeats disagree with the declared sigma, that visits differ by more than their "
        "readings do (intervals and refusals then rest on how visits differ), that a mismatch depends on a covariate, "
        "that a log's torques hold a name, an order or a dependence.",
    )
    surely: float = rule(
        0.001,
        "p-value",
        "Of a test made over and over: that a stay drifts, and that readings of one pose refute what was named (lack "
        "of fit).",
    )
    short_stay: int = rule(
        6,
        "readings",
        "A stay at least twice as long is cut into visits of so many: meanwhile arms warm and frames drift.",
        PROOF,
        rows="It counts the readings of one stay, not of the recording.",
    )
    neighbours: int = rule(
        4,
        "readings",
        "A stay that drifts is cut into runs of so many repeats.",
        rows="It counts the readings of one stay, not of the recording.",
    )
    named_part: float = rule(0.1, "share", "Of a direction that is not told: parts that have more are named.")
    turned: float = rule(
        0.1,
        "rad",
        "Poses that differ by no more tell nothing of how orientations are written; measured and modelled turns that "
        "differ by more (median) are not of one convention, a frame turned by more is another one, no mount that has "
        "shifted, and a range that lacks no more is a whole turn.",
    )

    def same_coordinate(self, revolute: bool) -> float:
        """How close a joint's coordinates at one pose lie: rad, of a slide m."""
        return self.same_pose[0 if revolute else 1]

    def coarsest_count(self, revolute: bool) -> float:
        """By how much a joint that stands still may seem to move: rad, of a slide m."""
        return self.coarsest * self.same_coordinate(revolute)
