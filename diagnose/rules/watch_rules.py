"""Rules of watching an arm over dated recordings."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, rule

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
    over: int = rule(
        50, "recordings", "A year of weekly recordings; the chance of a false alarm is told over so many.", PROOF
    )
    prior: float = rule(
        2.0,
        "degrees of freedom",
        "By so many the scatter that the parameters have in common, of their standard errors, counts beside a "
        "parameter's own: few recordings tell no scatter.",
        "moderated t: G. K. Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3; " + _SIMULATED,
        rows="It is a prior's weight, which each further recording lessens evenly.",
    )
    shown: float = rule(
        0.1,
        "of its pattern",
        "A parameter is watched where recordings show so much of its pattern beside all others, frame and tool.",
    )
    hides: float = rule(
        0.5,
        "of its pattern",
        "What is asked for beside what was found leaves so much of how well that is shown without it.",
    )
    far_off: float = rule(
        6.0, "times the robust scatter", "Readings that lie so far from the fit of their recording are left out."
    )
