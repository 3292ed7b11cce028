"""Rules of the diagnosis of motion logs: which samples count, when an effect is named, what stays unknown."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import rule

_LOGS = "logs of four robots and 59 simulated ones"


@dataclass(frozen=True)
class MotionRules:
    """Rows, evidence, gains on motion that was not fitted, and structure that nothing explains."""

    least_moving: float = rule(3.0, "s", "Some joint must move for so long, else the data do not suffice.")
    low_pass: tuple[int, ...] = rule(
        (4, 8),
        "Hz",
        "The least and the greatest low-pass of both sides that is chosen: below it friction is blurred, above it "
        "noise enters.",
        _LOGS,
    )
    bands: float = rule(
        3.0,
        "times the low-pass",
        "So fast coordinates are smoothed, to lose nothing within the low-pass, and samples are kept: more repeat each "
        "other.",
    )
    speeds_agree: float = rule(
        0.1, "share of the square", "Logged speeds further from the coordinates' own are of something else."
    )
    gap: float = rule(0.25, "s", "Over a longer wait between two samples no motion is interpolated.")
    slow: float = rule(0.03, "rad/s or m/s", "Below it the sign of a speed is uncertain, and with it friction.", _LOGS)
    still: float = rule(
        0.005,
        "rad/s or m/s",
        "A joint that dwells below it is at rest: friction there is whatever holds it, up to the stiction.",
    )
    reversal: float = rule(
        0.1, "s", "So near a reversal a drive's presliding acts, beside what the low-pass blurs.", _LOGS
    )
    block: float = rule(
        5.0, "s", "What is left of torques is correlated within a block, and nearly independent between blocks.", _LOGS
    )
    of_a_sample: float = rule(
        0.75,
        "sampling intervals",
        "Three standard deviations of how late torques are to coordinates without a delay: how a log was written.",
    )
    scaled: float = rule(0.15, "share", "By which all masses may be off alike, as torque constants are.")
    gain: float = rule(
        0.03, "share of a joint's RMS", "By which a name must lower it on motion that was not fitted.", _LOGS
    )
    cut: float = rule(0.1, "share of a joint's RMS", "By which a name must lower it on motion that was fitted.", _LOGS)
    filters: float = rule(
        0.002,
        "share of a joint's torque",
        "Four standard deviations of what filters, clocks and forms leave uncertain of each pattern, however long a "
        "log is: beside it names are tested, and beside at least so much sizes are told.",
    )
    turning: float = rule(
        0.01,
        "share of a joint's torque",
        "The same of patterns with reversals, where the sign of a speed is uncertain; and what is smaller is no name.",
    )
    shown: float = rule(
        0.25,
        "of the greatest usual size",
        "A number of a group with a larger standard deviation is not shown by the logs, and not told.",
    )
    ripple_speed: float = rule(
        0.4, "rad/s", "Faster, a control loop turns fast orders into accelerations; none are sought.", _LOGS
    )
    ripple_band: float = rule(
        3.0, "Hz", "What an order beyond the low-pass must reach; slower than two thirds is taken off."
    )
    stands_out: float = rule(12.0, "times the median of its neighbours", "The power of an order that is proposed.")
    dependence: float = rule(
        0.1, "share of the square left", "What bins explain beyond chance from which on it is structure.", _LOGS
    )
    unexplained: float = rule(
        0.03,
        "share of a joint's torque",
        "From which on what depends on something is no small cause, where sensors are not quieter still: unknown.",
    )
    uneven: float = rule(
        3.0, "times the median of all joints", "A joint's share that nothing explains is unknown beyond it."
    )
    never_noise: float = rule(0.12, "share of a joint's torque", "More that is left is unknown, whatever others leave.")
