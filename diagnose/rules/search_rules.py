"""Rules of the search: when anything is named, which name it gets, and when a form is the better answer."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, PROOF, TIME, rule


@dataclass(frozen=True)
class SearchRules:
    """Tests, criteria and how far a search goes."""

    longest: int = rule(
        7500,
        "observations",
        "So many are searched at most, 2500 readings in space; the findings are then fitted to all. Memory goes by it.",
        TIME,
        rows="Of a longer recording visits are picked at random with the share 7500/N, which changes evenly with N.",
    )
    least_visits: int = rule(
        8,
        "visits",
        "With fewer the verdict is that the data do not suffice.",
        PROOF,
        rows="Visits exchanged at random give too few different draws for any test.",
    )
    least_observations: int = rule(
        12,
        "observations",
        "Beyond the nuisances; with fewer the data do not suffice.",
        PROOF,
        rows="Three findings and their criterion need about as many.",
    )
    false_alarm: float = rule(
        0.003, "p-value", "Of each test; where nothing is missing two are made (library and forms).", PROOF
    )
    margin: float = rule(
        10.0,
        "criterion",
        "So much better a form must be than one or two named effects before they are given up for it.",
        PROOF,
    )
    sparing: int = rule(
        2,
        "findings",
        "With more, the form must only be better: each has been paid for in the criterion, and many small errors that "
        "each fit a part are what a form outside the library looks like.",
        PROOF,
    )
    beside: float = rule(6.0, "criterion", "So much a form must better it beside something that was named.", PROOF)
    material: float = rule(
        0.15,
        "share of the mismatch (RMS)",
        "A smaller remainder is a blemish of the model found, not another cause; names that miss no more of what a "
        "form explains are not given up for it.",
        PROOF,
    )
    many: int = rule(
        3000,
        "observations",
        "With so many the least blemish is beyond chance: what one more finding must be worth falls from `worth` in "
        "proportion to their number.",
        PROOF,
        rows="It changes evenly with the number of observations; none by itself decides.",
    )
    worth: float = rule(
        0.01, "share of what is left", "One more finding beyond three must take off as much (sum of squares).", PROOF
    )
    worth_of_many: float = rule(
        0.004, "share of what is left", "However many the observations, it must take off as much.", PROOF
    )
    worth_keeping: float = rule(
        0.5,
        "times `worth_of_many`",
        "A finding without which no more is left is superfluous once later ones are beside it.",
        JUDGED,
    )
    draws: int = rule(499, "draws", "Of each test; the tail beyond is read off a Gumbel distribution.", TIME)
    few_draws: int = rule(99, "draws", "For each finding beyond three, and whatever the size of a test.", TIME)
    enough_visits: int = rule(
        12,
        "visits",
        "From so many on signs alone are drawn: 2048 different draws.",
        PROOF,
        rows="With fewer there are not draws enough to reach the level; visits are then exchanged as well.",
    )
    most_findings: int = rule(30, "findings", "A search ends there.", TIME)
    kept: int = rule(60, "subsets", "The best of each size that are looked at closely.", TIME)
    most_fitted: float = rule(0.5, "coefficients an observation", "A model of more explains nothing.", JUDGED)
    most_in_triples: int = rule(
        160, "families", "Of which triples are made; of more, those that explain least alone are left.", TIME
    )
    alike: float = rule(0.98, "correlation", "Patterns beyond this are one class.", PROOF)
    confident: float = rule(
        6.0, "criterion", "A name no worse than this (odds of 20 to 1) could as well be it.", "odds"
    )
    refuted: float = rule(
        20.0, "criterion", "Even of one class, a name worse than this (20,000 to 1) is refuted.", "odds"
    )
    tied: float = rule(
        2.0, "criterion", "Names no worse than this fit equally well: the simpler and commoner goes first.", PROOF
    )
    rivalling: float = rule(
        0.5, "share of what the member explains", "What explains less can be no other name for it.", JUDGED
    )
    same_flexibility: float = rule(0.01, "share", "Flexibility that changed by no more is what was assumed.", JUDGED)
    coupling_matters: float = rule(
        0.02, "share of the pattern", "Loads whose patterns a flexibility changes by less need no second look.", JUDGED
    )
    several_beginnings: int = rule(
        2000,
        "readings",
        "Up to so many, loads and flexibility are sought from several beginnings.",
        TIME,
        rows="Each beginning is a search of its own, which takes minutes in longer recordings.",
    )
    motion_rounds: int = rule(4, "rounds", "Of search about large findings, until they no longer change.", TIME)
    motion_matters: float = rule(
        0.1, "share of the scatter", "What lies beyond first order is looked at again where it changes by more.", PROOF
    )
    balanced: float = rule(
        1.2,
        "times the mismatch",
        "What gives under unknown weights and moves the tip by more (RMS) can only balance others: the search is made "
        "again without it.",
        JUDGED,
    )
