"""Rules of watching an arm over dated recordings."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, TIME, rule

_SIMULATED = "benchmarks/watch: quiet series, frames mounted anew"


@dataclass(frozen=True)
class WatchRules:
    """When a parameter has moved, and which parameters are watched."""

    false_alarm: float = rule(
        0.01,
        "chance",
        "Of any alarm over `over` quiet recordings, all parameters together, looked at again after each of them.",
        "what a watch is worth: one false alarm in a hundred years of weekly recordings",
    )
    over: int = rule(50, "recordings", "A year of weekly recordings; the chance of a false alarm is told over so many.")
    tests: float = rule(
        7.0,
        "tests",
        "As many independent tests as all dates of a step and one steady drift come to, each time they are looked at.",
        _SIMULATED,
    )
    prior: float = rule(
        2.0,
        "degrees of freedom",
        "By so many the scatter that the parameters have in common, of their standard errors, counts beside a "
        "parameter's own: few recordings tell no scatter.",
        "moderated t: G. K. Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3; " + _SIMULATED,
        rows="It is a prior's weight, which each further recording lessens evenly.",
    )
    located: float = rule(
        3.84,
        "chi-square",
        "Dates at which a change fits worse by no more belong to the interval of its date.",
        "the 95 % point of one degree of freedom",
    )
    pooled: int = rule(
        5, "recordings", "Of more, so many are diagnosed together to see which parameters there are to watch.", TIME
    )
    shown: float = rule(
        0.1,
        "of its pattern",
        "A parameter is watched where recordings show so much of its pattern beside all others, frame and tool.",
        JUDGED,
    )
    hides: float = rule(
        0.5,
        "of its pattern",
        "What is asked for beside what was found leaves so much of how well that is shown without it.",
        JUDGED,
    )
    many_sizes: int = rule(6, "sizes", "A curve of more coefficients is held as it was found, not watched.", JUDGED)
    far_off: float = rule(
        6.0,
        "times the robust scatter",
        "Readings that lie so far from the fit of their recording are left out.",
        JUDGED,
    )
    power: float = rule(0.9, "chance", "With which the smallest step told would be found.", "the usual power")
    soon: int = rule(3, "recordings", "After so many further ones the smallest step told would be found.", JUDGED)
