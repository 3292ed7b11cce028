"""Rules of the answer: what is confirmed, located, called unknown, and which poses come next."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, PROOF, TIME, rule


@dataclass(frozen=True)
class AnswerRules:
    """What a search's findings are held to before they are said."""

    enough_repeats: int = rule(
        20,
        "degrees of freedom",
        "From here on repeats are trusted to tell noise from physics.",
        PROOF,
        rows="A noise floor from fewer is off by a sixth and more, which is what it is to judge.",
    )
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
    enough_returns: int = rule(
        8,
        "visits",
        "Returns to a pose (less one for each) from which they tell what lasts from what does not.",
        PROOF,
        rows="A scatter from fewer is off by a quarter and more.",
    )
    lasting: float = rule(
        0.2,
        "share of the remainder",
        "As much must be there again, or predict itself elsewhere, for it to be the model's fault.",
        PROOF,
    )
    lasting_chance: float = rule(
        0.05,
        "p-value",
        "Scatter between visits of one pose may have come out so small by chance, for it to be the whole remainder.",
        "odds",
    )
    most_left: float = rule(
        0.5,
        "share of the mismatch",
        "Findings that leave more (sum of squares beyond the noise) do not explain it.",
        PROOF,
    )
    refuted: float = rule(
        0.05,
        "share of the RMS",
        "A finding without which held-out readings are better by as much is dropped.",
        PROOF,
    )
    carries: float = rule(
        1.0,
        "standard errors",
        "By so much at least one finding among several must lower the sum of squares that is left of parts of the "
        "workspace held out, or the others are said without it.",
        "one standard error, of the difference: L. Breiman et al., Classification and Regression Trees (1984)",
    )
    kept_anyway: float = rule(
        0.2,
        "share of the mismatch",
        "A finding that moves the tip by as much (RMS) is never dropped for that: others may take its place.",
        JUDGED,
    )
    missed: float = rule(
        0.05,
        "share of the mismatch",
        "It must leave as much more (RMS) where it is taken out, or it only balances others.",
        JUDGED,
    )
    least_parts: int = rule(
        10,
        "parts of the workspace",
        "From so many on the scatter between them tells what carries over from what does not.",
        JUDGED,
        rows="The scatter of fewer is off by a quarter and more.",
    )
    least_moved: float = rule(
        0.2, "times the noise floor", "One of several findings that moves the tip by less (RMS) goes.", JUDGED
    )
    taken_over: float = rule(
        0.7,
        "share of what it moves",
        "Others take up more of it than half (sum of squares) where it alone moves less: of a finding that may be "
        "nothing by itself, they are said together.",
        JUDGED,
    )
    takes_over: float = rule(
        0.3, "share of what it moves", "Each of these others takes up as much of it (RMS) at least.", JUDGED
    )
    cancelled: float = rule(
        0.2,
        "share of what it moves",
        "Findings that move less together than this, and of which the others take up all but this, only balance each "
        "other, and are said together.",
        JUDGED,
    )
    balanced: float = rule(
        1.2,
        "times the mismatch",
        "So do those of which one moves more (RMS) than there is to explain, and the others take up all but that share "
        "of it.",
        JUDGED,
    )
    scatter_beside: float = rule(
        0.1,
        "share of the mismatch",
        "Findings that leave no more (sum of squares beyond the noise), and nothing that predicts itself, stand beside "
        "an arm that returns badly; where they leave more, readings of a visit refute them.",
        "judged on the development half of the second proof, seeds 2026112801 to 2026112803",
    )
    scatter_carries: float = rule(
        1.35,
        "times what is left",
        "What scatters, and what small causes leave, is as large on readings that were not fitted; where far more is "
        "left of those, the names do not carry over, and neither excuses them.",
        PROOF,
    )
    scatter_follows: float = rule(
        0.02,
        "p-value",
        "Below it what is left of a visit is like that of the visit before: what is left beside names is no scatter of "
        "an arm that returns badly.",
        "judged on the development half of the second proof, seeds 2026112801 and 2026112802",
    )
    scatter_predicts: float = rule(
        0.5,
        "share of what is beyond the noise",
        "As much of a small remainder must predict itself to be the model's fault; forms picked by what they predict "
        "reach a third of it by chance.",
        PROOF,
    )
    lack_of_fit: float = rule(
        0.001,
        "p-value",
        "Of the lack-of-fit test: below it readings of one pose refute what was named.",
        JUDGED,
    )
    beyond_floor: float = rule(
        1.1,
        "times the pure error",
        "What is left must be more for a refusal: of thousands of readings the least blemish is beyond chance.",
        JUDGED,
    )
    promise: float = rule(
        0.02,
        "share of the promised RMS",
        "The written arm file may leave so much more or less of its own recording; beyond that it is said.",
        JUDGED,
    )
    held_out_beyond: float = rule(
        1.2,
        "times what noise leaves held out",
        "More on parts of the workspace held out, and more than any draw of noise leaves there, refutes a fit too.",
        JUDGED,
    )
    return_worse: float = rule(
        0.01, "p-value", "Below it visits of one pose differ by more than their readings do.", JUDGED
    )
    most_memory: float = rule(
        0.8, "correlation", "No more is granted to noise before a fit is held to its repeats.", JUDGED
    )
    memory_beyond: float = rule(
        1.64,
        "standard errors",
        "So much more than was found the noise may remember, by either of two signs; the lesser counts.",
        "one-sided 95 %",
    )
    local: float = rule(0.25, "median over RMS", "A remainder below this sits at a few visits.", PROOF)
    power: float = rule(0.9, "probability", "With which an effect of the size shown would have been found.", "usual")
    smooth_rows: int = rule(
        300,
        "readings",
        "So many at most make the smooth model of what is unknown.",
        TIME,
        rows="Its cost grows with the third power; of more readings as many are picked at random.",
    )
    least_visits: int = rule(
        5,
        "readings",
        "At one pose from which a standard deviation is told.",
        "ISO 230-2:2014 asks for five visits",
        rows="It only decides whether a figure is shown.",
    )
    least_each: int = rule(
        3,
        "readings",
        "In each of two groups (sides, loads, times) whose means are compared.",
        JUDGED,
        rows="It only decides whether a figure is shown.",
    )
    same_load: float = rule(1e-3, "kg or N", "A scale's noise is no other load.", JUDGED)
    longer: float = rule(3.0, "usual steps", "A longer pause between readings of one pose begins a new visit.", JUDGED)
    location_draws: int = rule(299, "draws", "Of the test what a mismatch depends on.", TIME)
    location_level: float = rule(0.01, "p-value", "Below which a mismatch depends on a covariate.", JUDGED)
    noticeable: float = rule(
        0.05, "share of the strongest", "A dependence that describes less is not worth a word.", JUDGED
    )
    clearest: float = rule(
        0.15, "share of the mismatch", "By which one joint must describe more than the next to be named.", PROOF
    )
    one_direction: float = rule(0.6, "share of the mismatch", "Along one direction, or it is mixed.", JUDGED)
    tried: int = rule(150, "poses", "Tried for those worth recording next.", TIME, rows="They are tried, not recorded.")
    taken: int = rule(6, "poses", "Proposed.", JUDGED, rows="They are proposed, not recorded.")
    unseen_share: float = rule(
        1e-3,
        "share of the motion",
        "A motion of which no more shows is not seen by an instrument: that much comes of how far the arm is bent.",
        JUDGED,
    )
    told: float = rule(
        13.0, "non-centrality", "A wrong name is refused with high power (one coefficient, odds of 20 to 1).", "odds"
    )
    apart: float = rule(
        1.5,
        "times",
        "Sizes of its own that leave so much less in one of several recordings say that they are not of one arm.",
        JUDGED,
    )
    hopeless: float = rule(0.02, "non-centrality a reading", "Below this no number of poses is reasonable.", JUDGED)
    forms: int = rule(5, "forms", "That describe an unknown, at most.", JUDGED)
    form_tells: float = rule(
        0.05,
        "share of what is left",
        "A form must predict as much on readings held out to give the unknown its shape.",
        PROOF,
    )
    form_leads: float = rule(
        0.5,
        "share of what is left and no noise",
        "Forms that predict less of it on readings held out are no description: the unknown is nothing simple.",
        JUDGED,
    )
    near: int = rule(12, "entries", "Of the library that came nearest, with why they were not taken.", JUDGED)
