"""Rules of the answer: what is confirmed, located, called unknown, and which poses come next."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, rule


@dataclass(frozen=True)
class AnswerRules:
    """What a search's findings are held to before they are said."""

    farther: float = rule(
        2.0,
        "times the noise floor",
        "Where nothing was found, a remainder of this size is called unknown. Heavy tails and memory together make "
        "repeats look up to twice too quiet.",
        PROOF,
    )
    too_far_to_scatter: float = rule(
        2.2,
        "times the noise floor",
        "A larger remainder is not taken for scatter of an arm, with or without names, if no pose was visited again. "
        "It is `unknown`.",
        "judged on the development half of the second proof, seeds 2026112801 to 2026112803: arms that return badly "
        "and are rightly named leave 1.95 at most",
    )
    balanced: float = rule(
        2.0,
        "times the square of the mismatch",
        "If the squares of what names at one joint move add up to more, these balance each other. With a rest above "
        "the noise they are a form that the library lacks, and it is `unknown`.",
        "development half of the second proof, seed 2026113071: right names reach 1.01, a belt named as six causes 6.3",
    )
    lasting: float = rule(
        0.2,
        "share of the remainder",
        "At least this share must recur, or predict itself elsewhere, to be the model's fault.",
        PROOF,
    )
    refuted: float = rule(
        0.05,
        "share of what is left",
        "A finding is dropped if held-out readings are better by this share (RMS) without it. A form must predict at "
        "least this share of them to give an unknown its shape.",
        PROOF,
    )
    least_moved: float = rule(
        0.2, "times the noise floor", "One of several findings that moves the tip by less (RMS) is dropped."
    )
    small: float = rule(
        0.05,
        "share of what held-out readings leave",
        "Findings are small if held-out readings get worse by less (RMS, at each joint) without all of them.",
        "the share from which on a row of docs/real-machines.md counts as missed",
    )
    kept_anyway: float = rule(
        0.2,
        "share of the mismatch",
        "A finding that moves the tip or a torque by at least this share (RMS) is never dropped as small, or called "
        "so. Others may replace it.",
    )
    takes_over: float = rule(
        0.3,
        "share of what it moves",
        "Where a finding may be zero by itself, others can replace more than half of it (sum of squares). Those that "
        "replace at least this share (RMS) are reported together with it.",
    )
    cancelled: float = rule(
        0.2,
        "share of what it moves",
        "Findings that together move less than this, and that others replace up to this share, only cancel each other. "
        "They are reported together.",
    )
    scatter_beside: float = rule(
        0.1,
        "share of the mismatch",
        "Findings may be named for an arm with poor repeatability if they leave no more (sum of squares beyond the "
        "noise) and nothing predicts itself. If they leave more, readings of a visit refute them.",
        "judged on the development half of the second proof, seeds 2026112801 to 2026112803",
    )
    scatter_follows: float = rule(
        0.02,
        "p-value",
        "Below this value the remainder of a visit resembles the visits before. With names, such a remainder is no "
        "scatter of an arm with poor repeatability.",
        "judged on the development half of the second proof, seeds 2026112801 and 2026112802",
    )
    promise: float = rule(
        0.02,
        "share of the promised RMS",
        "The written arm file may leave this much more or less of its own recording. A larger difference is reported.",
    )
    held_out_beyond: float = rule(
        1.35,
        "times what noise, or the fit, leaves",
        "A fit is also refuted if held-out parts of the workspace leave more than this, and more than any draw of the "
        "noise there. If they leave far more than fitted parts, neither scatter nor small causes excuse names.",
        PROOF,
    )
    held_out_easier: float = rule(
        0.05,
        "share of the RMS in sample",
        "Held-out readings that leave less than fitted ones by this share contradict them. Least squares of one model "
        "never does. Weights by branch change the ratio a little.",
        "canonical recordings: at most 0.002 over all joints",
    )
    held_out_apart: float = rule(
        3.0,
        "times",
        "Blocks of poses that leave this many times what single rows leave show a fit of these poses alone. Stretches "
        "of time against blocks of poses show a change with time.",
        "canonical recordings: at most 1.2 for tips, 1.4 for a joint",
    )
    most_memory: float = rule(0.8, "correlation", "No more is granted to noise before a fit is held to its repeats.")
    local: float = rule(0.25, "median over RMS", "A remainder below this is concentrated at a few visits.", PROOF)
    one_direction: float = rule(
        0.6, "share of the mismatch", "At least this share lies along one direction. Otherwise the direction is mixed."
    )
    told: float = rule(
        13.0, "non-centrality", "A wrong name is rejected with high power (one coefficient, odds of 20 to 1).", "odds"
    )
    hopeless: float = rule(0.02, "non-centrality a reading", "Below this no number of poses is reasonable.")
