"""Rules of what cannot be right in a recording: far beyond any physics of an arm."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, PROOF, TIME, rule


@dataclass(frozen=True)
class MistakeRules:
    """Rows, columns and whole recordings that contradict the arm."""

    few_stray: float = rule(
        0.02,
        "share of the rows",
        "So many stamps that run backwards are strays and cost their rows; with more, the times are not used.",
        JUDGED,
    )
    many_alike: float = rule(
        0.1,
        "share of the rows",
        "Rows alike to the last digit are a logger's copies up to this share; more are readings too coarse.",
        JUDGED,
    )
    pasted_rows: int = rule(
        3, "rows in order", "So many that stand in the file already, in the same order, were pasted in again.", JUDGED
    )
    fine_steps: float = rule(
        1e4, "steps over the spread", "An instrument with more never says the same of so many poses again.", JUDGED
    )
    standing: float = rule(
        1e-3,
        "rad, m",
        "A joint whose coordinate changes by no more has not moved by its encoder: counts jitter.",
        JUDGED,
    )
    coldest: float = rule(193.15, "K", "-80 degC: what stands around an arm is not colder.", JUDGED)
    hottest: float = rule(523.15, "K", "250 degC: what stands around an arm is not hotter.", JUDGED)
    fewest: int = rule(
        5,
        "readings",
        "So many must tell of one motion before rows are judged by it.",
        JUDGED,
        rows="A median of fewer says nothing of each.",
    )
    far: float = rule(
        10.0,
        "times the middle distance",
        "A row further off than this contradicts its joints; a robust middle and no physics reaches as far.",
        PROOF,
    )
    gross: float = rule(5e-3, "share of the reach", "Nothing nearer than this is called a contradiction.", PROOF)
    still: float = rule(
        1e-3,
        "share of the reach",
        "A tip that repeats itself to the last digit is frozen where the joints have moved it by more.",
        JUDGED,
    )
    short_run: int = rule(
        3,
        "readings",
        "Contradictions in a row up to which they are jumps; what lasts longer is only said.",
        JUDGED,
        rows="It counts the length of one event, not of the recording.",
    )
    most_jumps: float = rule(0.2, "share of the rows", "With more jumps than this none is set aside.", JUDGED)
    many_still: float = rule(
        0.2, "share of the rows", "With more tips that repeat the one before, the instrument is coarse.", JUDGED
    )
    whole: float = rule(
        0.1, "share of the tips' spread", "The middle reading that is further off contradicts the arm.", JUDGED
    )
    least_whole: float = rule(
        0.01, "share of the reach", "The middle reading contradicts the arm from here on, at least.", JUDGED
    )
    better: float = rule(
        0.2,
        "share of the distance",
        "Another unit, frame, tool or joint explains a contradiction if it leaves less than this of it.",
        JUDGED,
    )
    undetermined: float = rule(
        1e-3,
        "share of the best told direction",
        "Less of a tool than this does not show beside the frame: it is left as the arm file has it.",
        JUDGED,
    )
    simpler: float = rule(
        2.0, "times the least distance", "Frame or tool alone is enough where both together leave no less.", JUDGED
    )
    another_frame: float = rule(
        0.1, "rad", "A frame turned by more is another one, not a mount that has shifted.", JUDGED
    )
    noticed: float = rule(2e-3, "share of the reach", "From here on a wrong convention is looked for.", PROOF)
    fewest_for_conventions: int = rule(
        12,
        "readings",
        "A wrong convention is looked for in so many at least.",
        JUDGED,
        rows="Frame, tool and a convention together fit fewer by chance.",
    )
    hopeless: float = rule(
        0.2, "share of the tips' spread", "No small displacements explain what is further off.", JUDGED
    )
    hopeless_whole: float = rule(
        0.05, "share of the reach", "No small displacements explain what is further off.", JUDGED
    )
    looked_at: int = rule(
        40,
        "poses",
        "A search for conventions looks at so many; all readings confirm what it finds.",
        TIME,
        rows="They are spread evenly over all poses; one more pose moves each a little.",
    )
    fewest_poses: int = rule(
        8,
        "poses",
        "A wrong convention is looked for in so many different poses at least.",
        JUDGED,
        rows="Frame, tool and a convention together fit fewer by chance.",
    )
    deep: int = rule(3, "mistakes", "So many are sought together, at most.", TIME)
    late: int = rule(5, "rows", "So far tips may stand beside their joints, at most.", JUDGED)
    as_well: float = rule(
        1.05,
        "times the least distance",
        "Of conventions that leave no more than this, the one that is made most often goes first.",
        JUDGED,
    )
    in_another_order: float = rule(
        0.1,
        "share of what is near by chance",
        "Tips that stand in another order than the joints lie this near to one of the modelled tips (median).",
        JUDGED,
    )
    stuck: float = rule(
        0.8,
        "share of the rows",
        "Of a joint's reading that stands still, as many must fit with the joint free.",
        JUDGED,
    )
    agree: float = rule(
        0.1, "share of the distance", "Contradictions in a row that differ by less are no jumps: they agree.", JUDGED
    )
    near_another_unit: float = rule(
        0.1, "share of the distance", "A row that fits in another unit comes as near to the nominal tip.", JUDGED
    )
    coarse: float = rule(
        3.0, "steps of the instrument", "Where repeats differ by no more (median) some are alike by rounding.", JUDGED
    )
    convention_leaves: float = rule(
        0.2,
        "share of the mismatch",
        "A right convention leaves no more; one more mistake must do as well against one less.",
        PROOF,
    )
    convention_enough: float = rule(
        0.05,
        "share of the tips' spread",
        "What is left of a mismatch that a convention explains is less. No physics of an arm comes near it.",
        PROOF,
    )
    label_leaves: float = rule(
        0.7,
        "share of what was left",
        "Labels are called wrong where, with them put right, what is named leaves no more, and the noise floor.",
        JUDGED,
    )
    swapped_levels: int = rule(
        4, "payloads", "Of so many every two are swapped in turn; of more nobody confuses just two.", TIME
    )
    searched_again: int = rule(
        3,
        "mistakes of labels",
        "The most promising, by what a few of the library then explain; only these are searched as a whole.",
        TIME,
    )
    taken_at_once: int = rule(
        4, "causes", "Which are taken one after the other to see how promising labels put right are.", TIME
    )
    swapped_sides: int = rule(
        3,
        "pairs of joints",
        "Whose sides are tried in each other's columns: where each one's tell most of how the other is off.",
        TIME,
    )
    rows_beyond: float = rule(
        0.1,
        "share of the rows",
        "As many beyond the declared range of a joint may tell of another zero; fewer went too far.",
        JUDGED,
    )
    zero_fits: float = rule(
        30.0,
        "2 ln of the likelihoods' ratio",
        "Another zero that a free frame or tool swallows must fit the tip so much better: five standard errors.",
        JUDGED,
    )
    most_signs: int = rule(7, "joints", "So many may count the other way together, at most.", TIME)
