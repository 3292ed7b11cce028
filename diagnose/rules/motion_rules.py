"""Rules of the diagnosis of motion logs: which samples count, when an effect is named, what stays unknown."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import rule

_LOGS = "logs of four robots and 59 simulated ones"


@dataclass(frozen=True)
class MotionRules:
    """Rows, evidence, gains on motion that was not fitted, and structure that nothing explains."""

    least_moving: float = rule(3.0, "s", "Some joint must move for at least this time, else the data do not suffice.")
    low_pass: tuple[int, ...] = rule(
        (4, 8),
        "Hz",
        "The lowest and the highest zero-phase low-pass that is chosen. Below it friction is blurred. Above it noise "
        "enters.",
        _LOGS,
    )
    bands: float = rule(
        3.0,
        "times the low-pass",
        "Coordinates are smoothed at this frequency, so that nothing within the low-pass is lost. Samples are kept at "
        "this rate, since more would repeat each other.",
    )
    speeds_agree: float = rule(
        0.1, "share of the square", "Logged speeds further from the coordinates' own are of something else."
    )
    encoders_agree: float = rule(
        0.1,
        "share of the motion",
        "Two encoders of a joint whose difference scatters by more than this share of the largest scatter of any "
        "joint's coordinates tell of different motions. The second ones are not used.",
    )
    gap: float = rule(0.25, "s", "Over a longer wait between two samples no motion is interpolated.")
    slow: float = rule(0.03, "rad/s or m/s", "Below it the sign of a speed is uncertain, and with it friction.", _LOGS)
    still: float = rule(
        0.005,
        "rad/s or m/s",
        "A joint that stays below this speed is at rest. Friction there takes any value up to the stiction.",
    )
    reversal: float = rule(0.1, "s", "This near a reversal, presliding of a drive acts, and the low-pass blurs.", _LOGS)
    block: float = rule(
        5.0, "s", "The remainder of torques is correlated within a block, and nearly independent between blocks.", _LOGS
    )
    of_a_sample: float = rule(
        0.75,
        "sampling intervals",
        "Three standard deviations of the lag of torques behind coordinates in a log without a delay. The logger "
        "causes this lag.",
    )
    scaled: float = rule(0.15, "share", "All masses may be wrong by this common factor, as torque constants are.")
    gain: float = rule(
        0.03,
        "share of a joint's RMS",
        "A name must lower the joint's RMS by this share on motion that was not fitted.",
        _LOGS,
    )
    cut: float = rule(
        0.1,
        "share of a joint's RMS",
        "A name must lower the joint's RMS by this share on motion that was fitted.",
        _LOGS,
    )
    filters: float = rule(
        0.002,
        "share of a joint's torque",
        "Four standard deviations of the uncertainty of each pattern from filters, clocks and forms, for a log of any "
        "length. Names are tested with it, and reported uncertainties include at least this much.",
    )
    turning: float = rule(
        0.01,
        "share of a joint's torque",
        "The same for patterns with reversals, where the sign of a speed is uncertain. A smaller effect gets no name.",
    )
    shown: float = rule(
        0.25,
        "of the greatest usual size",
        "A parameter of a group with a larger standard deviation is not shown by the logs, and not reported.",
    )
    ripple_speed: float = rule(
        0.4, "rad/s", "At higher speed a control loop turns fast orders into accelerations, and none are sought.", _LOGS
    )
    stands_out: float = rule(12.0, "times the median of its neighbours", "The power of an order that is proposed.")
    stands_alone: float = rule(
        0.5,
        "share of the square left",
        "An order that explains as much where it acts is proposed whatever its neighbours are: they hold a part of it.",
    )
    dependence: float = rule(
        0.1,
        "share of the square left",
        "If bins explain more than this share beyond chance, the remainder has structure.",
        _LOGS,
    )
    event: float = rule(
        5.0,
        "times the usual RMS",
        "Rows of a log further than this from what the rest of it foretells may be an event.",
        "no event in 10 clean logs with rough friction (python -m benchmarks.motion_events 0 10 clean)",
    )
    steady: float = rule(
        0.1, "share of its torque", "A push is held to be steady. Its torque may be off by this share without a cause."
    )
    collision: float = rule(
        0.5, "s", "A push of a shorter time is called a collision.", "ISO/TS 15066:2016: transient contact, below 0.5 s"
    )
    unexplained: float = rule(
        0.03,
        "share of a joint's torque",
        "From this share on, or from the noise of the sensors if that is smaller, a dependence is called unknown.",
    )
    above_noise: float = rule(
        10.0,
        "times the noise of the sensors, or what the whole library leaves",
        "What names leave of a joint an order of magnitude above them is called unknown, if it exceeds what filters "
        "leave. The noise is that above the low-pass. Noise with memory is up to 3 times louder below it.",
        "the proof's disclosed half: causes too small to be named leave 5 times at most",
    )
    uneven: float = rule(
        3.0, "times the median of all joints", "A joint's unexplained share beyond this is called unknown."
    )
    never_noise: float = rule(
        0.12, "share of a joint's torque", "A larger remainder is called unknown, whatever other joints leave."
    )
    rollout: float = rule(
        0.5,
        "s",
        "Windows over which an arm is simulated under logged torques. Errors of torque grow with the square of the "
        "time, and a longer window is far from the motion that was measured.",
    )
