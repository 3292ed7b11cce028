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
        1.25, "1", "The factor on that limit, since the scale is an estimate and tails are heavier than Gauss's.", PROOF
    )
    most_outliers: float = rule(
        0.05,
        "share of the rows",
        "If more rows are far off, they are part of the mismatch and not a few bad readings.",
        PROOF,
    )
    most_alone: float = rule(
        0.35,
        "share of the rows",
        "Up to this share may lie far off where other readings of the same visit do not. The cause is the readings, "
        "not the pose.",
    )
    same_way: float = rule(
        0.8,
        "cosine",
        "Readings that begin a recording far off and point the same way are settling, and are no outliers. Torques, "
        "speeds or currents of a log that correlate this much with the expected ones are a multiple of them.",
    )
    enough: int = rule(
        20,
        "degrees of freedom",
        "From here on a scatter can separate noise from physics, and the noise's memory is sought. A log then shows "
        "gravity, friction and inertia.",
        PROOF,
        rows="A noise floor from fewer is wrong by a sixth or more. A correlation of fewer is chance. The five numbers "
        "of one joint fit any data.",
    )
    least_parts: int = rule(
        10,
        "parts of the workspace, of a recording, visits",
        "From this number on, scatter shows what carries over or lasts, and what visits share. Time is cut into this "
        "many parts, so that visits one part apart are far apart in time. What needs `enough` numbers of each part is "
        "not sought in fewer.",
        rows="The scatter of fewer is wrong by a quarter or more.",
    )
    most_memory: float = rule(0.95, "correlation", "The largest correlation that is removed from readings.")
    much_memory: float = rule(
        0.3, "correlation", "A memory beyond this makes the rough model worth another pass.", PROOF
    )
    wander: tuple[float, float] = rule(
        (0.02, 2.0),
        "scatters from one visit to the next",
        "The slowest and the fastest random walk that is sought. Beyond the fastest, each visit has an error of its "
        "own.",
    )
    wander_beyond: float = rule(
        12.0,
        "twice the logarithm of a likelihood",
        "A random walk must be better than none by this much. A step, a trend or a period, picked from many, must be "
        "better than a walk by as much. At 6, one walk in twenty looks like one.",
        "odds",
    )
    rather_a_drift: float = rule(
        16.0,
        "twice the logarithm of a likelihood",
        "A steady drift must be better than a random walk by this much. Walks over 62 visits that reach 0.5 to 1.5 "
        "times the noise look as steady once in 200. At 6 they do once in 20.",
        "simulated",
    )
    shuffled: float = rule(
        0.6,
        "times the usual distance of poses",
        "Neighbouring visits must be this far apart for time and the arm's path to be separate causes.",
    )
    poses_come_back_to: int = rule(
        5,
        "poses",
        "If this many poses are visited again, a wander can be seen even where each pose is near the one before.",
        rows="With fewer series, each less its mean, a walk is mixed with the error of single poses.",
    )
    own_scatter: float = rule(
        40.0,
        "readings",
        "At this number a component's scatter is half its own and half that of all.",
        rows="The weight shifts evenly with the readings.",
    )
    softest: float = rule(
        1e-2,
        "rad, m",
        "The largest sag under unknown weights, as of a soft drive under a light link or a stiff drive under a heavy "
        "link.",
    )
    least_lever: float = rule(
        0.01,
        "share of the arm's reach",
        "No link's centre of mass is assumed nearer to its joint. A wrist without length has a tool of some size.",
    )
    tether: float = rule(
        5.0,
        "standard deviations",
        "Where the data do not determine a parameter, its bounds are this many standard deviations of its prior.",
    )
    many_sizes: int = rule(
        12,
        "coefficients",
        "A curve with more coefficients is held to usual values, else readings that lie close make them arbitrary. In "
        "a curve with fewer, parameters that the data do not determine are set aside.",
        PROOF,
    )
    far_above: float = rule(
        1.6,
        "times the noise floor",
        "Noise with a memory (correlation 0.6) makes repeats of three look at most 1.45 times too quiet. A larger "
        "factor is more than noise.",
        PROOF,
    )
    at_the_floor: float = rule(
        1.1, "times the noise floor", "A remainder up to this is called the noise floor and refutes nothing."
    )
    cancelling: float = rule(
        4.0, "times the mismatch", "A displacement with a larger sum of squares can only cancel another.", PROOF
    )
    usual: float = rule(
        3.0,
        "times",
        "A parameter may exceed its typical limits by this factor (small and large robots) and still be of a usual "
        "magnitude. A link may expand by this share of its material's coefficient, or twice the usual maximum. A "
        "larger expansion means another length.",
        "judged: steel taken for what was aluminium is off by 2",
    )
    held: float = rule(
        0.8, "share of what holds it", "From this standard error on, the data do not determine the parameter.", PROOF
    )
    telling: float = rule(
        0.5, "half interval over value", "A compliance under unknown weights is reported if the ratio is smaller."
    )
    whole: float = rule(
        0.25, "share", "Physics that was set aside is restored where its fitted share is within this of 1."
    )
    rival_travel: float = rule(
        0.3,
        "rad",
        "Where a joint moved by less, only the names are candidates for the file: no held-out reading judges other "
        "sizes of that joint.",
        "judged: of a grid of two joints' poses ridge left 0.13 mm, and 0.74 mm on lines of all six",
    )
    no_worse: float = rule(
        1.05,
        "times the RMS of the arm as given",
        "Up to so much held-out motion of a joint may leave with the arm that is written. Chance alone makes some of "
        "six joints a little worse, and kept better files from being written.",
        "development half of the proof of motion logs, seed 2026112950",
    )
    lightest: float = rule(
        0.1, "share of its mass", "No link is assumed to weigh less than this share of the mass in its file."
    )
    largest_unnamed: float = rule(
        0.3,
        "times the noise's RMS",
        "The most that each candidate without a name may move. A larger movement shows.",
        PROOF,
    )
    least_unnamed: float = rule(
        0.1,
        "times the noise's RMS",
        "The least that each candidate without a name moves on such an arm. That is six small causes of a third of the "
        "noise, of sixty candidates. The remainder would give too small a value, since names were chosen to make it "
        "small.",
        "development half of the second proof, seed 2026112402; of 236 intervals of seed 2026112403, 95 % held",
    )
    largest_small: float = rule(
        0.15,
        "times the noise's RMS",
        "The most that each candidate without a name may move in a remainder of small causes. That is eight of a third "
        "of the noise, of forty candidates. Of 24 unknowns of the development half's classes, which leave at least 1.5 "
        "times the noise, none is so small.",
        "development half of the second proof, seed 2026112501",
    )
