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
        "The most that are searched (2500 readings in space). The findings are then fitted to all. Memory grows with "
        "this number.",
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
        "Beyond the nuisances. With fewer the data do not suffice, and fewer readings cannot show a wrong convention.",
        PROOF,
        rows="Three findings and their criterion need about as many. Frame, tool and a convention fit fewer by chance.",
    )
    false_alarm: float = rule(
        0.003, "p-value", "The level of each test. Where nothing is missing two are made (library and forms).", PROOF
    )
    margin: float = rule(
        10.0,
        "criterion",
        "A form must be better by this much before one or two named effects are given up for it.",
        PROOF,
    )
    sparing: int = rule(
        2,
        "findings",
        "With more findings, the form must only be better, since each is already paid for in the criterion. Many small "
        "errors that each fit a part are typical of a form outside the library.",
        PROOF,
    )
    material: float = rule(
        0.15,
        "share of the mismatch (RMS)",
        "A smaller remainder is a flaw of the model found, and not another cause. Names that miss no more of a form's "
        "explanation are not given up for the form. A joint is named only if it describes more than the next by this "
        "share.",
        PROOF,
    )
    many: int = rule(
        3000,
        "observations",
        "With this many, the smallest flaw is beyond chance. One more finding must then be worth less than `worth`, in "
        "proportion to their number. The memory worth another pass grows likewise, since a memory is more likely "
        "physics that the rough model lacks.",
        PROOF,
        rows="It changes evenly with the number of observations. None by itself decides.",
    )
    worth: float = rule(
        0.01, "share of what is left", "One more finding beyond three must remove this share (sum of squares).", PROOF
    )
    draws: int = rule(499, "draws", "Draws of each test. The tail beyond them is read off a Gumbel distribution.", TIME)
    enough_visits: int = rule(
        12,
        "visits",
        "From this number on only signs are drawn (2048 different draws).",
        PROOF,
        rows="With fewer there are too few draws to reach the level. Visits are then exchanged as well.",
    )
    most_fitted: float = rule(0.5, "coefficients an observation", "A model with more explains nothing.")
    alike: float = rule(0.98, "correlation", "Patterns that correlate more are one class.", PROOF)
    confident: float = rule(
        6.0,
        "criterion",
        "A name no worse than this (odds of 20 to 1) is also possible. A form reported with names must be better by "
        "more. For a log's name, no form may be.",
        "odds",
    )
    refuted: float = rule(
        20.0, "criterion", "Even within one class, a name worse than this (20,000 to 1) is refuted.", "odds"
    )
    tied: float = rule(
        2.0,
        "criterion",
        "Names no worse than this fit equally well. The simpler and more common one comes first.",
        PROOF,
    )
    rivalling: float = rule(
        0.5,
        "share of what the other explains",
        "An effect that explains less is no alternative name. A form must predict at least this share of the best "
        "form, and of the remainder without noise, on held-out readings. Otherwise the unknown has no simple "
        "description.",
    )
    coupling_matters: float = rule(
        0.02,
        "share",
        "If a flexibility changes the patterns of loads by less, loads and flexibility need no second look.",
    )
    long: int = rule(
        2000,
        "readings",
        "Up to this many, loads and flexibility are sought from several starting points. Names are judged with room "
        "for causes too small to be named.",
        TIME,
        rows="Each starting point is a search of its own, which takes minutes in longer recordings. More readings "
        "determine small causes one by one, so less room is needed for them.",
    )
    motion_matters: float = rule(
        0.1,
        "share of the scatter",
        "Nonlinear parts, and parts that prove to be turned, are computed again if the tip changes by more. A tenth "
        "adds half a percent to the remainder.",
        PROOF,
    )
    balanced: float = rule(
        1.2,
        "times the mismatch",
        "A compliance under unknown weights that moves the tip by more (RMS) can only cancel others. The search is "
        "repeated without it.",
    )

    @property
    def log_odds(self) -> float:
        """What the odds of `confident`, twice a logarithm, are in nats."""
        return 0.5 * self.confident

    @property
    def refuted_odds(self) -> float:
        """What the odds of `refuted`, twice a logarithm, are in nats."""
        return 0.5 * self.refuted
