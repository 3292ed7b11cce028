"""Rules of planning: what is tried for a recording, in which order it is made, and what counts as told apart."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import TIME, rule


@dataclass(frozen=True)
class PlanRules:
    """How a recording is planned."""

    tried: int = rule(
        300, "poses", "Spread over the joint ranges, of which a plan is chosen.", TIME, rows="They are tried alone."
    )
    widest_rival: int = rule(
        6,
        "coefficients",
        "Curves with more fit almost anything. No poses are chosen for them, and none is watched.",
        TIME,
    )
    pairs: float = rule(
        0.3,
        "share of the score",
        "The weight of telling causes apart, against seeing them. With 1, parameters were larger by 3 to 9 % on three "
        "arms and hardly more causes were separated.",
    )
    known: float = rule(
        0.02,
        "share of a visit",
        "This share of an average visit's information is taken as known beforehand, so that the first few poses can be "
        "weighed.",
    )
    passes: int = rule(3, "passes", "The most passes of exchange over all visits.", TIME)
    rivals: int = rule(5, "plans", "Random plans, whose median figure a plan is compared with.", TIME)
    across_plane: float = rule(
        0.02, "share of the reach", "Touches of a plane that reach less far across hardly show the plane's direction."
    )
