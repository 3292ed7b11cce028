"""Rules of the search: when anything is named, which name it gets, and when a form is the better answer."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, TIME, rule


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
        "Beyond the nuisances; with fewer the data do not suffice, nor do fewer readings tell a wrong convention.",
        PROOF,
        rows="Three findings and their criterion need about as many; frame, tool and a convention fit fewer by chance.",
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
    material: float = rule(
        0.15,
        "share of the mismatch (RMS)",
        "A smaller remainder is a blemish of the model found, not another cause; names that miss no more of what a "
        "form explains are not given up for it; nor is a joint named that describes no more than the next by as much.",
        PROOF,
    )
    many: int = rule(
        3000,
        "observations",
        "With so many the least blemish is beyond chance: what one more finding must be worth falls from `worth`, "
        "and the memory worth another pass grows, in proportion to their number: a memory is rather physics that the "
        "rough model lacks, and goes with the arm's path.",
        PROOF,
        rows="It changes evenly with the number of observations; none by itself decides.",
    )
    worth: float = rule(
        0.01, "share of what is left", "One more finding beyond three must take off as much (sum of squares).", PROOF
    )
    draws: int = rule(499, "draws", "Of each test; the tail beyond is read off a Gumbel distribution.", TIME)
    enough_visits: int = rule(
        12,
        "visits",
        "From so many on signs alone are drawn: 2048 different draws.",
        PROOF,
        rows="With fewer there are not draws enough to reach the level; visits are then exchanged as well.",
    )
    most_fitted: float = rule(0.5, "coefficients an observation", "A model of more explains nothing.")
    alike: float = rule(0.98, "correlation", "Patterns beyond this are one class.", PROOF)
    confident: float = rule(
        6.0,
        "criterion",
        "A name no worse than this (odds of 20 to 1) could be it too; a form beside names must better them by more, "
        "and a log's name none.",
        "odds",
    )
    refuted: float = rule(
        20.0, "criterion", "Even of one class, a name worse than this (20,000 to 1) is refuted.", "odds"
    )
    tied: float = rule(
        2.0, "criterion", "Names no worse than this fit equally well: the simpler and commoner goes first.", PROOF
    )
    rivalling: float = rule(
        0.5,
        "share of what the other explains",
        "What explains less can be no other name for it. Forms that predict less on readings held out than this of "
        "the best, or of what is left and no noise, are no description: the unknown is nothing simple.",
    )
    coupling_matters: float = rule(
        0.02,
        "share",
        "Loads whose patterns a flexibility changes by less, and flexibility that does, need no second look.",
    )
    long: int = rule(
        2000,
        "readings",
        "Up to so many, loads and flexibility are sought from several beginnings, and names are judged with room for "
        "causes too small to be named.",
        TIME,
        rows="Each beginning is a search of its own, which takes minutes in longer recordings; and more readings tell "
        "small causes one by one, so that there is less and less to make room for.",
    )
    motion_matters: float = rule(
        0.1,
        "share of the scatter",
        "What lies beyond first order, or turns out turned, is looked at again where the tip changes by more: a tenth "
        "adds half a percent to what is left.",
        PROOF,
    )
    balanced: float = rule(
        1.2,
        "times the mismatch",
        "What gives under unknown weights and moves the tip by more (RMS) can only balance others: the search is made "
        "again without it.",
    )

    @property
    def log_odds(self) -> float:
        """What the odds of `confident`, twice a logarithm, are in nats."""
        return 0.5 * self.confident

    @property
    def refuted_odds(self) -> float:
        """What the odds of `refuted`, twice a logarithm, are in nats."""
        return 0.5 * self.refuted
