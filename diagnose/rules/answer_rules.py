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
        "So much must be left, where nothing was found, to be called unknown: heavy tails and memory together make "
        "repeats look up to twice too quiet.",
        PROOF,
    )
    too_far_to_scatter: float = rule(
        2.2,
        "times the noise floor",
        "More is not taken for scatter of an arm that no visit came back to, beside names or without: `unknown`.",
        "judged on the development half of the second proof, seeds 2026112801 to 2026112803: arms that return badly "
        "and are rightly named leave 1.95 at most",
    )
    lasting: float = rule(
        0.2,
        "share of the remainder",
        "As much must be there again, or predict itself elsewhere, for it to be the model's fault.",
        PROOF,
    )
    refuted: float = rule(
        0.05,
        "share of what is left",
        "A finding without which held-out readings are better by as much (RMS) is dropped; a form must predict as much "
        "of them to give an unknown its shape.",
        PROOF,
    )
    least_moved: float = rule(
        0.2, "times the noise floor", "One of several findings that moves the tip by less (RMS) goes."
    )
    kept_anyway: float = rule(
        0.2,
        "share of the mismatch",
        "A finding that moves the tip by as much (RMS) is never dropped for that: others may take its place.",
    )
    takes_over: float = rule(
        0.3,
        "share of what it moves",
        "Where a finding may be nothing by itself and others take up more than half of it (sum of squares), each of "
        "these takes up as much (RMS) at least: they are said together.",
    )
    cancelled: float = rule(
        0.2,
        "share of what it moves",
        "Findings that move less together than this, and of which the others take up all but this, only balance each "
        "other, and are said together.",
    )
    scatter_beside: float = rule(
        0.1,
        "share of the mismatch",
        "Findings that leave no more (sum of squares beyond the noise), and nothing that predicts itself, stand beside "
        "an arm that returns badly; where they leave more, readings of a visit refute them.",
        "judged on the development half of the second proof, seeds 2026112801 to 2026112803",
    )
    scatter_follows: float = rule(
        0.02,
        "p-value",
        "Below it what is left of a visit is like that of the visits before: what is left beside names is no scatter "
        "of an arm that returns badly.",
        "judged on the development half of the second proof, seeds 2026112801 and 2026112802",
    )
    promise: float = rule(
        0.02,
        "share of the promised RMS",
        "The written arm file may leave so much more or less of its own recording; beyond that it is said.",
    )
    held_out_beyond: float = rule(
        1.35,
        "times what noise, or the fit, leaves",
        "More on parts of the workspace held out than of noise there, and than any draw of it, refutes a fit too; far "
        "more than is left of what was fitted, and neither scatter nor small causes excuse names.",
        PROOF,
    )
    most_memory: float = rule(0.8, "correlation", "No more is granted to noise before a fit is held to its repeats.")
    local: float = rule(0.25, "median over RMS", "A remainder below this sits at a few visits.", PROOF)
    one_direction: float = rule(0.6, "share of the mismatch", "Along one direction, or it is mixed.")
    told: float = rule(
        13.0, "non-centrality", "A wrong name is refused with high power (one coefficient, odds of 20 to 1).", "odds"
    )
    hopeless: float = rule(0.02, "non-centrality a reading", "Below this no number of poses is reasonable.")
