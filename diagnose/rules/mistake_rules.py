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
        "Up to this share, stamps that run backwards are strays, and their rows are set aside. With more, the times "
        "are not used, and a log is several. A larger share of samples that jump is no fault of the logger.",
    )
    pasted_rows: int = rule(
        3, "rows in order", "This many rows that the file already holds, in the same order, were pasted in again."
    )
    fine_steps: float = rule(
        1e4, "steps over the spread", "An instrument with more steps never repeats the same reading at so many poses."
    )
    surroundings: tuple[float, float] = rule(
        (193.15, 523.15), "K", "-80 to 250 degC. The surroundings of an arm are neither colder nor hotter."
    )
    payload_in_grams: float = rule(
        50.0,
        "times what the arm weighs, or what its drives hold at full stretch",
        "No arm carries as much. Payloads in grams in a column of kilograms are a thousand times too large.",
    )
    far: float = rule(
        10.0,
        "times the middle distance",
        "A row further off than this contradicts its joints. No physics of an arm reaches as far.",
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
        "Up to this many contradictions in a row are jumps. A longer run is only reported.",
        rows="It counts the length of one event, not of the recording.",
    )
    few_rows: float = rule(
        0.1,
        "share of the rows",
        "Up to this share, jumps, copied readings, repeated tips and joints beyond their range are slips, and are set "
        "aside. Up to this share, blanks were forgotten. A larger share points to the instrument, another zero or data "
        "not measured.",
    )
    whole: float = rule(
        0.1,
        "share of the tips' spread",
        "If the median reading is further off, the recording contradicts the arm. No physics of an arm comes near "
        "this. A wrong convention that explains the contradiction leaves less.",
    )
    better: float = rule(
        0.2,
        "share of the distance",
        "Another unit, frame, tool, joint, order or convention explains a contradiction if less of the distance "
        "remains. The samples around a spike must leave less as well.",
    )
    simpler: float = rule(
        2.0, "times the least distance", "Frame or tool alone is enough where both together leave no less."
    )
    noticed: float = rule(2e-3, "share of the reach", "From here on a wrong convention is sought.", PROOF)
    as_well: float = rule(
        1.05,
        "times the least distance",
        "Of conventions that leave no more than this, the most common one comes first. Of a log's, all are reported.",
    )
    one_number: float = rule(
        0.1,
        "1, or rad",
        "A ratio, coupling, zero or compliance of a joint that is off by less is fitted by the library's effects. It "
        "is not treated as a misread recording.",
    )
    exact: float = rule(
        1e-5, "share of the reach", "A smaller remainder does not separate one reading of the recording from another."
    )
    stuck: float = rule(
        0.8,
        "share of the rows",
        "If a joint's reading stands still, this share of the rows must fit with the joint free.",
    )
    agree: float = rule(
        0.1, "share of the distance", "Contradictions in a row that differ by less agree, and are no jumps."
    )
    coarse: float = rule(
        3.0, "steps of the instrument", "Where repeats differ by no more (median), some are equal by rounding."
    )
    label_leaves: float = rule(
        0.7,
        "share of what was left",
        "Labels are called wrong if corrected labels leave no more than this, with the names found, and no more than "
        "the noise floor. Arms are called different if parameters of their own leave no more.",
    )
    zero_fits: float = rule(
        30.0,
        "2 ln of the likelihoods' ratio",
        "Another zero that a free frame or tool could absorb must fit the tip this much better, which is five standard "
        "errors.",
    )
