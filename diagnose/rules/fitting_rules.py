"""Rules of fits: weights, outliers, the noise's memory, what is physically possible, what is held out."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, rule


@dataclass(frozen=True)
class FittingRules:
    """How a recording is prepared, and what a fit may say."""

    far_tail: float = rule(
        0.002, "chance a recording", "An outlier is a row that scatter alone would produce in one recording of 500."
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
    )
    same_way: float = rule(
        0.8,
        "cosine",
        "Readings that begin a recording far off and point the same way settle: no outliers. Torques, speeds or "
        "currents of a log that go so much with what they should be are a multiple of it.",
    )
    enough: int = rule(
        20,
        "degrees of freedom",
        "From here on a scatter is trusted to tell noise from physics, the noise's memory is looked for, and a log "
        "tells of gravity, friction and inertia.",
        PROOF,
        rows="A noise floor from fewer is off by a sixth and more, which is what it is to judge; a correlation of "
        "fewer is chance; and the five numbers of one joint are fitted to anything.",
    )
    least_parts: int = rule(
        10,
        "parts of the workspace, of a recording, visits",
        "From so many on their scatter tells what carries over, or lasts, from what does not, and what visits share; "
        "into so many time is cut: visits a part apart are far from each other in it. What is told from `enough` "
        "numbers of each part is not sought in fewer.",
        rows="The scatter of fewer is off by a quarter and more.",
    )
    most_memory: float = rule(0.95, "correlation", "No more is taken out of readings, whatever is found.")
    much_memory: float = rule(
        0.3, "correlation", "A memory beyond this makes the rough model worth another pass.", PROOF
    )
    wander: tuple[float, float] = rule(
        (0.02, 2.0),
        "scatters from one visit to the next",
        "The slowest and the fastest random walk that is looked for: beyond the latter each visit is off anew.",
    )
    wander_beyond: float = rule(
        12.0,
        "twice the logarithm of a likelihood",
        "By so much a random walk must say more than none, and a step, a trend or a period, picked from many, more "
        "than a walk: one walk in twenty looks like one at 6.",
        "odds",
    )
    rather_a_drift: float = rule(
        16.0,
        "twice the logarithm of a likelihood",
        "By so much an even drift must say more than a random walk: of walks over 62 visits that reach half to one and "
        "a half times the noise one in 200 looks as even, and one in 20 does at 6.",
        "simulated",
    )
    shuffled: float = rule(
        0.6,
        "times the usual distance of poses",
        "Neighbouring visits must be as far apart for time and the arm's path to be two things.",
    )
    poses_come_back_to: int = rule(
        5,
        "poses",
        "Come back to so many, and a wander can be told by them where each pose is near the one before.",
        rows="A walk below fewer series, each less its mean, is mixed with what just one pose does.",
    )
    own_scatter: float = rule(
        40.0,
        "readings",
        "With as many, a component's scatter is half its own and half that of all.",
        rows="The weight shifts evenly with the readings.",
    )
    softest: float = rule(
        1e-2,
        "rad, m",
        "A sag under unknown weights: a soft drive's under a light link, or a stiff one's under a heavy link.",
    )
    least_lever: float = rule(
        0.01,
        "share of the arm's reach",
        "No link's centre lies nearer to its joint for sure: a wrist without length has a tool of some size.",
    )
    tether: float = rule(
        5.0, "standard deviations", "Of what a size is held to where the data say nothing: its bounds lie there."
    )
    many_sizes: int = rule(
        12,
        "coefficients",
        "A curve of more is held to usual sizes, or readings that lie close make them anything; of one of less, sizes "
        "that the data do not tell are left out.",
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
        1.1, "times the noise floor", "What remains and is no more is called the noise floor, and refutes nothing."
    )
    cancelling: float = rule(
        4.0, "times the mismatch", "A displacement whose sum of squares is more can only cancel another.", PROOF
    )
    usual: float = rule(
        3.0,
        "times",
        "Beyond its typical limits a size is still of a usual magnitude, and may well be (on small and large robots "
        "alike); and what a link may expand by of what its "
        "material declares, or twice the most that is usual: what seems to expand by more is another length.",
        "judged: steel taken for what was aluminium is off by 2",
    )
    held: float = rule(
        0.8, "share of what holds it", "A standard error from here on: the data tell nothing of that size.", PROOF
    )
    telling: float = rule(
        0.5, "half interval over value", "A compliance under unknown weights is told where it is less."
    )
    whole: float = rule(
        0.25, "share", "Physics that was left out comes back where its fitted share is within this of 1."
    )
    lightest: float = rule(
        0.1, "share of its mass", "No link weighs less of what its file says: one of no weight would be none."
    )
    largest_unnamed: float = rule(
        0.3, "times the noise's RMS", "What each candidate that is not named may move: more shows.", PROOF
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
