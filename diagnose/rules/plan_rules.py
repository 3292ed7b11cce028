"""Rules of planning: what is tried for a recording, in which order it is made, and what counts as told apart."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, TIME, rule


@dataclass(frozen=True)
class PlanRules:
    """How a recording is planned."""

    tried: int = rule(
        300, "poses", "Spread over the joint ranges, of which a plan is chosen.", TIME, rows="They are tried alone."
    )
    searched: int = rule(16, "times `tried`", "Poses looked at, at most, for those that keep to their room.", TIME)
    run: float = rule(0.0873, "rad", "A joint comes from as far (5 deg): beyond any play.", "usual")
    slide_run: float = rule(0.01, "m", "A slide comes from as far.", "usual")
    most_run: float = rule(0.05, "share of the range", "No joint comes from farther.", JUDGED)
    widest_rival: int = rule(
        6, "coefficients", "Curves of more could look like anything; poses are not chosen to tell them.", TIME
    )
    pairs: float = rule(
        0.3,
        "share of the score",
        "Of telling apart beside seeing; with 1, sizes were larger by 3 to 9 % on three arms and hardly more was told.",
        JUDGED,
    )
    known: float = rule(
        0.02,
        "share of a visit",
        "Of what an average visit tells is taken as known beforehand, so that the first few poses can be weighed.",
        JUDGED,
    )
    passes: int = rule(3, "passes", "Of exchange over all visits, at most.", TIME)
    never: float = rule(
        0.9999, "correlation", "Patterns as alike over all poses tried are told apart by no pose.", JUDGED
    )
    returns: int = rule(
        3,
        "visits",
        "To one pose, at the beginning, in the middle and at the end; with several payloads one in each of two blocks.",
        JUDGED,
        rows="They are part of what is planned.",
    )
    least_beside: int = rule(
        4, "times the returns", "Fewer visits than that leave no room for returns.", JUDGED, rows="Nothing is judged."
    )
    rivals: int = rule(5, "plans", "At random, whose middle figure a plan is set beside.", TIME)
    touches_of_point: int = rule(6, "visits", "For each point that is touched again.", JUDGED, rows="It is planned.")
    touches_of_plane: int = rule(12, "visits", "For each plane that is touched.", JUDGED, rows="It is planned.")
    touches_of_bar: int = rule(6, "visits", "For each place in which a bar lies.", JUDGED, rows="It is planned.")
    across_plane: float = rule(
        0.02,
        "share of the reach",
        "Touches of a plane that reach less far across hardly tell how it is turned.",
        JUDGED,
    )
    between_readings: float = rule(2.0, "s", "From reading to reading, for the clock of a plan.", "usual")
    between_visits: float = rule(20.0, "s", "For a move, for the clock of a plan.", "usual")
    between_payloads: float = rule(300.0, "s", "To change the payload, for the clock of a plan.", "usual")
