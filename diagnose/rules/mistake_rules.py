"""Rules of what cannot be right in a recording: far beyond any physics of an arm."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, rule


@dataclass(frozen=True)
class MistakeRules:
    """Rows, columns and whole recordings that contradict the arm."""

    few_stray: float = rule(
        0.02,
        "share of the rows",
        "So many stamps that run backwards are strays and cost their rows; with more, the times are not used, and a "
        "log is several. More samples of a log that jump by themselves are no faults of the logger.",
    )
    pasted_rows: int = rule(
        3, "rows in order", "So many that stand in the file already, in the same order, were pasted in again."
    )
    fine_steps: float = rule(
        1e4, "steps over the spread", "An instrument with more never says the same of so many poses again."
    )
    surroundings: tuple[float, float] = rule(
        (193.15, 523.15), "K", "-80 to 250 degC: what stands around an arm is neither colder nor hotter."
    )
    far: float = rule(
        10.0,
        "times the middle distance",
        "A row further off than this contradicts its joints; a robust middle and no physics reaches as far.",
        PROOF,
    )
    gross: float = rule(
        5e-3,
        "share of the reach",
        "No reading nearer than this is called a contradiction, nor is the middle one.",
        PROOF,
    )
    still: float = rule(
        1e-3,
        "share of the reach",
        "A tip that repeats itself to the last digit is frozen where the joints have moved it by more.",
    )
    short_run: int = rule(
        3,
        "readings",
        "Contradictions in a row up to which they are jumps; what lasts longer is only said.",
        rows="It counts the length of one event, not of the recording.",
    )
    few_rows: float = rule(
        0.1,
        "share of the rows",
        "Up to so many jumps, copies to the last digit, tips that repeat the one before and joints beyond their range "
        "are slips, which are set aside, and so many blanks were forgotten; more tell of the instrument, of another "
        "zero, or of what was not measured.",
    )
    whole: float = rule(
        0.1,
        "share of the tips' spread",
        "The middle reading that is further off contradicts the arm, which no physics of one comes near; what a wrong "
        "convention that explains it leaves is less.",
    )
    better: float = rule(
        0.2,
        "share of the distance",
        "Another unit, frame, tool, joint, order or convention explains a contradiction if it leaves less of it, and "
        "the samples beside it a spike.",
    )
    simpler: float = rule(
        2.0, "times the least distance", "Frame or tool alone is enough where both together leave no less."
    )
    noticed: float = rule(2e-3, "share of the reach", "From here on a wrong convention is looked for.", PROOF)
    as_well: float = rule(
        1.05,
        "times the least distance",
        "Of conventions that leave no more than this, the one that is made most often goes first; of a log's, all are "
        "told.",
    )
    one_number: float = rule(
        0.1,
        "1, or rad",
        "A ratio or a coupling that is off by less, a zero that is nearer, a joint that gives way by less is fitted by "
        "the library's effects, and no other reading of the recording.",
    )
    exact: float = rule(
        1e-5, "share of the reach", "What is left below it tells no reading of the recording from another."
    )
    stuck: float = rule(
        0.8, "share of the rows", "Of a joint's reading that stands still, as many must fit with the joint free."
    )
    agree: float = rule(
        0.1, "share of the distance", "Contradictions in a row that differ by less are no jumps: they agree."
    )
    coarse: float = rule(
        3.0, "steps of the instrument", "Where repeats differ by no more (median) some are alike by rounding."
    )
    label_leaves: float = rule(
        0.7,
        "share of what was left",
        "Labels are called wrong where, with them put right, what is named leaves no more, and the noise floor; arms "
        "are called different where sizes of their own leave no more.",
    )
    zero_fits: float = rule(
        30.0,
        "2 ln of the likelihoods' ratio",
        "Another zero that a free frame or tool swallows must fit the tip so much better: five standard errors.",
    )
