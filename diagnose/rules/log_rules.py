"""Rules of reading a motion log: what is no sample, no clock, no motion."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import rule


@dataclass(frozen=True)
class LogRules:
    """What is set aside from a motion log, and what is refused."""

    alternates: float = rule(
        0.1,
        "1",
        "Samples that lie this much nearer to those two before than to the one before are of two robots in turn.",
    )
    gap: float = rule(
        5.0,
        "sampling intervals",
        "A longer wait between two samples is a gap. Nothing is known about the motion in it.",
    )
    jitter: float = rule(
        0.05,
        "sampling intervals",
        "Intervals that scatter by more are reported, since differences of samples become less exact.",
    )
    intervals: tuple[float, float] = rule(
        (1e-5, 600.0),
        "s",
        "The time from sample to sample. A clock that runs faster or slower is in another unit (ms, us, ns).",
    )
    spike: float = rule(
        12.0,
        "standard deviations",
        "A single sample this far from the median of the five around it is a fault of the logger.",
        "public logs hold spikes of 65 N*m and angles of 1e282",
    )
    spike_of_torque: float = rule(
        0.2,
        "share of the torque's spread",
        "A spike of torque is at least as large. A smaller one is noise with long tails, which a fit tolerates.",
    )
    spike_of_angle: float = rule(
        0.02, "share of the angle's spread", "A jump of a joint there and back is at least as large."
    )
    explains: float = rule(
        0.4,
        "share of the torque's square",
        "A convention explains a joint's torque where it leaves less than this of it.",
    )
    unexplained: float = rule(
        0.01,
        "share of the torque's variance",
        "The least that bodies and friction leave of a torque. A smaller remainder is no merit of a convention.",
    )
    of_bodies: float = rule(
        0.1,
        "share of the current's variance",
        "At a joint that bears weight, bodies make at least this of a current. A voltage or a PWM shows less of them.",
    )
    conventions_exact: float = rule(
        0.002,
        "share of the torque's variance",
        "A smaller remainder does not separate one reading of a log from another.",
    )
    conventions_samples: float = rule(
        8.0,
        "samples",
        "This many independent samples show conventions, since the unexplained part stays alike for seconds.",
    )
    conventions_masses: tuple[float, float, float] = rule(
        (0.7, 0.15, 0.03),
        "share of the file's; of the link's mass; of the arm's",
        "A link's body differs from the file's by the first as a whole, and by point masses of the other two together.",
    )
    conventions_reach: float = rule(
        0.15,
        "share of the arm's length",
        "A point mass that the file lacks lies at most this far from the ends of its link.",
    )
    conventions_gain: float = rule(
        1.5,
        "logs of shares",
        "Each mistake of convention must lower the remainder by more than this, over all joints (a fifth at one of "
        "them, for example). A log is refused from twice this on, since sound ones reach nearly that. Below, it is "
        "doubted.",
    )
    convention_window: float = rule(
        0.1, "s", "Speeds and accelerations are means over this time. Poses further apart are taken at rest."
    )
    lag: float = rule(
        0.1,
        "share of the speeds' spread",
        "Speeds that lag the coordinates' own by a filter and differ by more for it are taken from the coordinates.",
    )
    clipped: float = rule(
        0.005,
        "share of the samples",
        "A torque that holds its extreme to the last digit so often, in motion, is clipped.",
    )
    clipped_beside: float = rule(
        5.0,
        "times the next values' count",
        "A clipped torque holds its extreme this much oftener than values beside it.",
    )
    least_gear: float = rule(
        12.0,
        "1",
        "Torques smaller than the weights make by more than this are the motor's.",
        "gears of arms: 30 to 320",
    )
    slowest: float = rule(
        0.5, "1", "Speeds between this and its inverse times the differences of angles are those of a filter."
    )
    beyond_range: float = rule(
        4.0,
        "of the joint's range",
        "A joint moves through less than this factor of the range in the file. A motor moves further.",
    )
    heavy: float = rule(
        0.3,
        "share of the largest torque",
        "Gears and units are determined from the joints that carry at least this share.",
    )
