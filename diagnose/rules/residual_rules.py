"""Rules of what is noise: repeats, visits, outliers, orientations."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, PROOF, TIME, rule


@dataclass(frozen=True)
class ResidualRules:
    """What counts as one pose, one visit, one load, and what repeats tell."""

    same_angle: float = rule(
        2e-4,
        "rad",
        "Joints closer than this are at the same pose: what servos come back to, and finer than any grid.",
        JUDGED,
    )
    same_session: float = rule(
        0.25,
        "share of what both last",
        "A recording whose clock goes on from another's after a pause no longer than this goes on from it: a tracker "
        "set up anew, a battery changed. In a longer one the arm may have been put to other work.",
        JUDGED,
    )
    better_start: float = rule(
        0.9,
        "times the RMS",
        "A frame that turns more is where an instrument stands if it fits this much better.",
        JUDGED,
    )
    level_places: float = rule(
        1e-3,
        "share of their extent",
        "Places that reach less far across lie in a plane: an anchor is beside it.",
        JUDGED,
    )
    torque_off: float = rule(
        0.05,
        "share",
        "Weights that torques find further off than this are said, and compliance goes by the torque measured: motors' "
        "torque constants are known to some percent.",
        JUDGED,
    )
    torque_sure: float = rule(4.0, "standard errors", "So far off they must be beyond doubt.", JUDGED)
    torque_seen: float = rule(
        0.02,
        "share of the load's spread",
        "What links or payload turn a drive by less, from pose to pose, its torque tells nothing of.",
        JUDGED,
    )
    torque_least: float = rule(
        0.2,
        "share of the torque's spread",
        "Where the model's load spreads by less, a torque is another thing than weights (friction, a sensor that "
        "drifts): no arm file is off by such a factor.",
        JUDGED,
    )
    torque_noise: float = rule(
        0.1,
        "share of the load's spread",
        "A torque noisier than this is no better load than the model's: compliance would come out less by its square.",
        JUDGED,
    )
    torque_against: float = rule(
        -0.5,
        "correlation",
        "Torque that goes so much against the load that it should hold is counted the other way.",
        JUDGED,
    )
    mass_beside: float = rule(
        0.1,
        "share of the reach",
        "Masses of links that nobody has weighed lie so far beside a link, or half its length: motors sit there.",
        JUDGED,
    )
    same_length: float = rule(2e-5, "m", "The same for slides.", JUDGED)
    same_payload: float = rule(1e-3, "kg", "A scale's noise is no new payload.", JUDGED)
    long_pause: float = rule(
        10.0, "usual intervals", "After a longer pause readings at one pose are no plain repeats.", JUDGED
    )
    coarsest: float = rule(
        10.0,
        "times same_angle or same_length",
        "An encoder may count as coarsely as this, and one pose be as wide.",
        JUDGED,
    )
    steps: float = rule(1.5, "steps of the encoder", "Coordinates closer than this differ by one step at most.", JUDGED)
    one_pose: float = rule(
        4.0,
        "times how close the readings of a visit lie",
        "Visits whose middles lie closer are of one pose: drives come back less exactly than a reading repeats.",
        JUDGED,
    )
    other_load: float = rule(
        1e-3, "share", "Payload, side or force that changes by more from one reading to the next is another.", JUDGED
    )
    other_temperature: float = rule(
        1.0, "K", "Temperatures of a recording that lie further apart are conditions of their own.", JUDGED
    )
    other_speed: float = rule(
        1e-2, "share", "A speed that changes by more from one reading to the next is another.", JUDGED
    )
    even_steps: float = rule(
        0.02, "share", "Steps that are whole numbers of the least to within this are an encoder's counts.", JUDGED
    )
    false_outlier: float = rule(
        0.01, "chance a recording", "That any row of a clean Gaussian recording is called an outlier.", JUDGED
    )
    enough_freedom: int = rule(
        5,
        "degrees of freedom",
        "From here on repeats are trusted more than a declared sigma.",
        PROOF,
        rows="A standard deviation from fewer is off by a third and more.",
    )
    settles: float = rule(
        2.5,
        "standard deviations",
        "A visit's second reading that lies so far off the later ones, the way the first does, still settles.",
        JUDGED,
    )
    disagree: float = rule(0.01, "chance", "Repeats that the declared sigma gives less often disagree with it.", JUDGED)
    finest: float = rule(1e-9, "m", "No instrument of an arm's size resolves less.", JUDGED)
    drift_beyond: float = rule(
        3.0, "standard deviations", "What visits of one pose differ by is drift beyond this much noise.", JUDGED
    )
    short_stay: int = rule(
        6,
        "readings",
        "A stay at least twice as long is cut into visits of so many: meanwhile arms warm and frames drift.",
        PROOF,
        rows="It counts the readings of one stay, not of the recording.",
    )
    long_stay: int = rule(
        12,
        "readings",
        "A stay as long may drift, which is tested.",
        JUDGED,
        rows="Three runs of neighbours are the least that tells drift from scatter.",
    )
    neighbours: int = rule(
        4,
        "readings",
        "A stay that drifts is cut into runs of so many repeats.",
        JUDGED,
        rows="It counts the readings of one stay, not of the recording.",
    )
    drift_false_alarm: float = rule(1e-3, "chance", "That a stay without drift is taken for one that drifts.", JUDGED)
    most_values: int = rule(
        1500,
        "readings",
        "Of more values an even share goes into the robust scale Qn, which compares all pairs.",
        TIME,
        rows="The share is spread evenly, so that one more reading changes the scale no more than any other.",
    )
    undetermined: float = rule(
        1e-3,
        "share of the best told direction",
        "Less of frame and tool than this is not told by the readings and is left at nought: a target that turns by a "
        "milliradian puts a tool a metre off for a millimetre of anything.",
        JUDGED,
    )
    named_part: float = rule(0.1, "share", "Of a direction that is not told: parts that have more are named.", JUDGED)
    turned: float = rule(
        0.1, "rad", "Poses that differ by no more tell nothing of how orientations are written.", JUDGED
    )
    half_turn: float = rule(2.5, "rad", "Near half a turn its sign is chance.", JUDGED)
    turns_disagree: float = rule(
        0.1,
        "rad",
        "Measured and modelled turns between poses that differ by more (median) are not of one convention.",
        JUDGED,
    )

    def same_coordinate(self, revolute: bool) -> float:
        """How close a joint's coordinates at one pose lie: rad, of a slide m."""
        return self.same_angle if revolute else self.same_length
