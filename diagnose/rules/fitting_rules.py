"""Rules of fits: weights, outliers, the noise's memory, what is physically possible, what is held out."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, PROOF, TIME, rule


@dataclass(frozen=True)
class FittingRules:
    """How a recording is prepared, and what a fit may say."""

    far_tail: float = rule(
        0.002,
        "chance a recording",
        "An outlier is a row that scatter alone would produce in one recording of 500.",
        JUDGED,
    )
    outlier_margin: float = rule(
        1.25, "1", "Upon that limit, since the scale is an estimate and tails are heavier than Gauss's.", PROOF
    )
    most_outliers: float = rule(
        0.05, "share of the rows", "More rows far off are no handful of bad readings but part of the mismatch.", PROOF
    )
    most_alone: float = rule(
        0.35,
        "share of the rows",
        "So many may lie far off where others of their own visit do not: that is the readings, not the pose.",
        JUDGED,
    )
    same_way: float = rule(
        0.8, "cosine", "Readings that begin a recording far off and point the same way settle: no outliers.", JUDGED
    )
    least_pairs: int = rule(
        20,
        "pairs of readings",
        "From so many on the noise's memory is looked for.",
        JUDGED,
        rows="The correlation of fewer is chance; below this none is beyond doubt anyway.",
    )
    memory_beyond: float = rule(
        2.5, "standard errors", "A correlation of neighbours must lie this far from nought to be allowed for.", PROOF
    )
    most_memory: float = rule(0.95, "correlation", "No more is taken out of readings, whatever is found.", JUDGED)
    passes: int = rule(3, "passes", "So often the rough model is made anew where the noise remembers much.", PROOF)
    much_memory: float = rule(
        0.3, "correlation", "A memory beyond this makes the rough model worth another pass.", PROOF
    )
    memory_of_physics: int = rule(
        1000,
        "readings",
        "In longer recordings a memory is rather physics that the rough model lacks, and goes with the arm's path: "
        "beyond these, the memory that is worth another pass grows in proportion.",
        PROOF,
        rows="The limit grows evenly with the readings; no reading by itself decides.",
    )
    memory_grows: float = rule(
        0.02, "correlation", "A pass that finds so little more memory is the last: the sum no longer moves.", JUDGED
    )
    no_more_of_memory: float = rule(
        3.0, "scatters", "A reading further off says no more of the noise's memory than one that far off.", JUDGED
    )
    least_wander: float = rule(
        0.02, "scatters from one visit to the next", "The slowest random walk that is looked for.", JUDGED
    )
    most_wander: float = rule(
        2.0, "scatters from one visit to the next", "The fastest: beyond that each visit is off anew.", JUDGED
    )
    wander_beyond: float = rule(
        12.0, "twice the logarithm of a likelihood", "By so much a random walk must say more than none.", "odds"
    )
    rather_a_drift: float = rule(
        16.0,
        "twice the logarithm of a likelihood",
        "By so much an even drift must say more than a random walk: of walks over 62 visits that reach half to one and "
        "a half times the noise one in 200 looks as even, and one in 20 does at 6.",
        "simulated",
    )
    rather_a_form: float = rule(
        12.0,
        "twice the logarithm of a likelihood",
        "The same of a step, a trend or a period, picked from many: one walk in twenty looks like one at 6.",
        "odds",
    )
    shuffled: float = rule(
        0.6,
        "times the usual distance of poses",
        "Neighbouring visits must be as far apart for time and the arm's path to be two things.",
        JUDGED,
    )
    poses_come_back_to: int = rule(
        5,
        "poses",
        "Come back to so many, and a wander can be told by them where each pose is near the one before.",
        JUDGED,
        rows="A walk below fewer series, each less its mean, is mixed with what just one pose does.",
    )
    far_in_time: int = rule(
        10,
        "parts of the recording",
        "Visits of one place that lie a part apart are far from each other in time.",
        JUDGED,
    )
    moved_anew: float = rule(
        0.5,
        "share of the visits",
        "Before more of them the arm must have moved for a visit's readings to share an error: a long stay cut into "
        "visits shares none within each.",
        JUDGED,
    )
    weighed_down: float = rule(
        2.5, "times the middle distance", "A reading further off weighs less in the rough model (P. J. Huber).", JUDGED
    )
    own_scatter: float = rule(
        40.0,
        "readings",
        "With as many, a component's scatter is half its own and half that of all.",
        JUDGED,
        rows="The weight shifts evenly with the readings.",
    )
    softest: float = rule(
        1e-2,
        "rad, m",
        "A sag under unknown weights: a soft drive's under a light link, or a stiff one's under a heavy link.",
        JUDGED,
    )
    weights_alike: float = rule(
        1.0,
        "times the largest and the share of the arm beyond the joint",
        "What unknown first moments are held to where the data do not show them: masses of one arm on its own levers.",
        JUDGED,
    )
    mass_off: float = rule(
        1.0,
        "share of the file's mass",
        "What torques do not tell of a link's mass is held to the file by as much as such a figure may be off.",
        JUDGED,
    )
    centre_off: float = rule(
        0.1,
        "share of the link's length",
        "The same of a centre of mass, which is the better known of the two.",
        JUDGED,
    )
    least_lever: float = rule(
        0.01,
        "share of the arm's reach",
        "No link's centre lies nearer to its joint for sure: a wrist without length has a tool of some size.",
        JUDGED,
    )
    tether: float = rule(
        5.0,
        "standard deviations",
        "Of what a size is held to where the data say nothing: its bounds lie there.",
        JUDGED,
    )
    many_sizes: int = rule(
        12,
        "coefficients",
        "A curve of more is held to usual sizes, or readings that lie close make them anything.",
        PROOF,
    )
    far_above: float = rule(
        1.6,
        "times the noise floor",
        "Noise with a memory (correlation 0.6) makes repeats of three look 1.45 times too quiet at most; what is more "
        "than this is more than noise.",
        PROOF,
    )
    at_the_floor: float = rule(
        1.1, "times the noise floor", "What remains and is no more is called the noise floor.", JUDGED
    )
    rough: int = rule(4, "patterns", "In the first rough model, at most.", PROOF)
    cancelling: float = rule(
        4.0, "times the mismatch", "A displacement whose sum of squares is more can only cancel another.", PROOF
    )
    beyond_bounds: float = rule(
        2.5, "standard errors", "A size so far outside its bounds is impossible, not just badly known.", PROOF
    )
    usual: float = rule(3.0, "times", "Beyond its typical limits a size is still of a usual magnitude.", JUDGED)
    held: float = rule(
        0.8, "share of what holds it", "A standard error from here on: the data tell nothing of that size.", PROOF
    )
    few_sizes: int = rule(
        8, "sizes", "Up to so many, those that the data do not tell are left out of a finding.", JUDGED
    )
    telling: float = rule(
        0.5, "half interval over value", "A compliance under unknown weights is told where it is less.", JUDGED
    )
    folds: int = rule(5, "parts", "Into which readings are held out in turn.", "usual; five to ten")
    whole: float = rule(
        0.25, "share", "Physics that was left out comes back where its fitted share is within this of 1.", JUDGED
    )
    heavier: float = rule(
        1.0,
        "times its own mass",
        "More than this and a usual extra mass does not hang on a link whose mass the arm file tells.",
        JUDGED,
    )
    lightest: float = rule(
        0.1,
        "share of its mass",
        "No link weighs less of what its file says: one of no weight would be none.",
        JUDGED,
    )
    lifts: float = rule(
        1.0,
        "times its own mass",
        "More extra mass at the tip than this, no arm lifts: the lightest for what they carry lift their own.",
        "A. Albu-Schaeffer et al., Industrial Robot 34 (2007) 376: a load-to-weight ratio of 1:1",
    )
    expands: float = rule(
        3.0,
        "times what the arm file declares",
        "No link expands by more, nor by more than twice the most that is usual, where its material declares by how "
        "much it does: what seems to is another length.",
        "judged: steel taken for what was aluminium is off by 2",
    )
    largest_unnamed: float = rule(
        0.3, "times the noise's RMS", "What each candidate that is not named may move: more shows.", PROOF
    )
    weak_finding: float = rule(
        1.0,
        "times the noise's RMS",
        "A finding beside a stronger one that moves less is a sample of the arm's small causes: those that are not "
        "named may be as large.",
        JUDGED,
    )
    weak_sample: int = rule(
        2, "weak findings", "One alone is a cause, and tells nothing of how large others are.", JUDGED
    )
    visits_apart: float = rule(
        0.01,
        "p-value",
        "Where visits differ by so much more than readings of a visit, intervals rest on how visits differ.",
        JUDGED,
    )
    more_findings: int = rule(
        2,
        "findings",
        "From so many on intervals have room for causes too small to be named: one alone may be all there is, a second "
        "says that the arm has more.",
        "development half of the second proof, seeds 2026112804 and 2026112805: of 71 intervals beside one other "
        "finding 62 held without, 69 with, of which one by another mend",
        rows="It counts causes, of which an arm has as many however long it is recorded.",
    )
    many_findings: int = rule(
        3,
        "findings",
        "From so many on an arm has causes too small to be named, of which the largest were chosen: other names that "
        "could be with room for those are declared.",
        "development half of the second proof, seed 2026112402",
        rows="It counts causes, of which an arm has as many however long it is recorded.",
    )
    least_unnamed: float = rule(
        0.1,
        "times the noise's RMS",
        "What each candidate that is not named moves at least on such an arm: six small causes of a third of the noise "
        "among sixty candidates. What is left says less, since names were chosen to make it small.",
        "development half of the second proof, seed 2026112402; of 236 intervals of seed 2026112403, 95 % held",
    )
    largest_small: float = rule(
        0.15,
        "times the noise's RMS",
        "What each candidate that is not named may move of a remainder that small causes are to explain: eight of a "
        "third of the noise among forty candidates. Of 24 unknowns of the development half's classes, which leave "
        "1.5 times the noise and more, none comes to so little.",
        "development half of the second proof, seed 2026112501",
    )
    room_for_small: int = rule(
        2000,
        "readings",
        "Up to so many, names are judged with room for such causes.",
        TIME,
        rows="More readings tell small causes one by one, so that there is less and less to make room for.",
    )
    nothing_unnamed: float = rule(
        0.5, "chance", "Beforehand, that nothing but what is named is there.", "neither more likely than the other"
    )
    motion_settled: float = rule(
        0.05,
        "standard errors",
        "What finite motions still change of the sizes found, when they are fitted about the arm as these make it.",
        "less than the last digit that is shown of an interval",
    )
    origin_found: float = rule(
        0.003,
        "times the arm's length",
        "A middle reading no further off is at the transform that is sought: no other start is tried. Arms give and "
        "wear by less; a wrong turn is off by far more.",
        JUDGED,
    )
    origin_beyond: float = rule(
        0.1,
        "times what is left",
        "A turn found beside the findings whose square moves the tip by more makes the diagnosis begin again about it.",
        "a tenth adds half a percent to what is left",
    )
