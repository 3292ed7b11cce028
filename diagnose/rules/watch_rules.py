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
        "The chance of any alarm over `over` quiet recordings, for all parameters together, tested again after each "
        "recording.",
        "what a watch is worth: one false alarm in a hundred years of weekly recordings",
    )
    over: int = rule(
        50, "recordings", "A year of weekly recordings. The chance of a false alarm is stated for this many.", PROOF
    )
    prior: float = rule(
        2.0,
        "degrees of freedom",
        "The weight of the parameters' common scatter, in standard errors, against a parameter's own. A few recordings "
        "do not determine a scatter.",
        "moderated t: G. K. Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3; " + _SIMULATED,
        rows="It is a prior's weight, which each further recording lessens evenly.",
    )
    shown: float = rule(
        0.1,
        "of its pattern",
        "A parameter is watched where recordings show at least this share of its pattern, with all others, frame and "
        "tool free.",
    )
    hides: float = rule(
        0.5,
        "of its pattern",
        "Parameters asked for in addition to the findings must leave this share of how well the pattern is shown "
        "without them.",
    )
    far_off: float = rule(
        6.0, "times the robust scatter", "Readings that lie this far from the fit of their recording are set aside."
    )
