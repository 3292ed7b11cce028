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
        "Curves of more could look like anything: no poses are chosen to tell them, and none is watched.",
        TIME,
    )
    pairs: float = rule(
        0.3,
        "share of the score",
        "Of telling apart beside seeing; with 1, sizes were larger by 3 to 9 % on three arms and hardly more was told.",
    )
    known: float = rule(
        0.02,
        "share of a visit",
        "Of what an average visit tells is taken as known beforehand, so that the first few poses can be weighed.",
    )
    passes: int = rule(3, "passes", "Of exchange over all visits, at most.", TIME)
    rivals: int = rule(5, "plans", "At random, whose middle figure a plan is set beside.", TIME)
    across_plane: float = rule(
        0.02, "share of the reach", "Touches of a plane that reach less far across hardly tell how it is turned."
    )
