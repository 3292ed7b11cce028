"""A score as the last section of docs/proof.md; nothing is computed here."""

from __future__ import annotations

import itertools
import textwrap
from pathlib import Path

from benchmarks.multibody.score import Score, target_table

HEADING = "## A second generator: a multibody engine"
WORDS = (
    """
    Forms of the tool describe each unknown class of the library above. `benchmarks/multibody` draws anew, on
    MuJoCo. Links are chains of segments on springs that bend by millimetres. 1 or 2 large causes stand among 4 to 8
    small ones. Frames and tools are free, trackers are remounted and wander, arms return badly, columns bear wrong
    names. Recordings have 20 poses, arms up to seven axes. It imports nothing that is judged, which a test reads.
    """,
    """
    Thirty-one unknown classes are split by class, by a recorded seed, into a development half, which sets the
    tool's rules, and a proof half. Nothing in the tool may be made for the proof half. An unknown's size is what
    geometry and any three usual causes leave of it.
    """,
    """
    Again: `make proof-multibody PROOF_CASES=600 PROOF_SEED=... PROOF_HALF=development` (or `proof`, asked once).
    `python -m benchmarks.multibody score CASES --answers ANSWERS --page docs/proof.md` writes this section. The
    oracle knows every cause at its true size and fits free frames and tools. The three figures are those of
    arXiv:2606.23215. F1 is of the joints, moments and covariates that are pointed at. False discoveries neither are
    a cause nor declare one.
    """,
)


DESCRIBED = "product_of_joints"
"""The class of the proof half that a form of the tool has come to describe, since people asked for it."""

NO_FORM = """
    Earlier trials, each a new draw of the same classes, none of which got a form of its own (axes that wobble as they
    turn were a class until the fourth):
    """

ENOUGH = 100
"""Cases from which on the fine tables say anything; the JSON of a score has them always."""
FINE = ("by effect", "by arm", "by recording", "by parameter", "small causes")


def trials() -> tuple[list[str], dict[int, str]]:
    """The head of a table of what the openings of the proof half said, and its rows by their seeds, in the order in
    which they were opened."""
    lines = Path(__file__).with_name("trials.md").read_text(encoding="utf-8").splitlines()
    title, rule, *rows = (line for line in lines if line.startswith("|"))
    return [title, rule], {int(row.split("|")[2].partition(",")[0]): row for row in rows}


def _wrapped(text: str) -> str:
    return "\n".join(textwrap.wrap(" ".join(text.split()), 158, break_long_words=False, break_on_hyphens=False))


def section(score: Score) -> str:
    """The section: what was run, the targets, the three figures, the tables, every miss."""
    lines = [HEADING, ""]
    for paragraph in WORDS:
        lines += [_wrapped(paragraph), ""]
    lines += [_ran(score), "", *target_table(score.targets), *_trials(score), "", *_figures(score), *_tables(score)]
    lines += ["", "Verdicts by kind: " + "; ".join(f"{kind}: {_tally(tally)}" for kind, tally in score.verdicts) + "."]
    if score.impossible:
        lines += ["", "Impossible sizes:", "", *(f"- {item}" for item in score.impossible)]
    if score.misses:
        lines += ["", "Misses, each with its case's number:", "", *(f"- {miss}" for miss in score.misses)]
    return "\n".join(lines).rstrip() + "\n"


def _half(score: Score) -> str:
    return "proof" if score.half == "sealed" else "development"


def _count(score: Score) -> int:
    return sum(number for _, number in score.cases)


def _ran(score: Score) -> str:
    """What was run."""
    kinds = ", ".join(f"{name} {number}" for name, number in score.cases)
    half, two = _half(score), score.remounted
    ran = [
        f"**What was run: {_count(score)} cases of the {half} half**, seed {' and '.join(map(str, score.seeds))} "
        f"({kinds});",
        f"{len(score.failed)} without an answer; {score.seconds.shown()} seconds a case.",
        f"{two.total} of them have two mountings of the tracker, and {two.count} of these an answer."
        if two.total
        else "None of them has two mountings of the tracker.",
        "The proof half has not been opened." if half == "development" else "",
        "Shares with their 95 % Clopper-Pearson interval.",
    ]
    return _wrapped(" ".join(ran))


def _trials(score: Score) -> list[str]:
    """Of a proof half what is proof of it, and what earlier trials found."""
    if _half(score) != "proof":
        return []
    head, opened = trials()
    earlier = [opened[seed] for seed in itertools.takewhile(lambda seed: seed not in score.seeds, opened)]
    return ["", _wrapped(_of_others(score)), *(["", _wrapped(NO_FORM), "", *head, *earlier] if earlier else [])]


def _figures(score: Score) -> list[str]:
    """The three figures."""
    localised = [
        f"| F1, {name} | {item.f1:.2f} (precision {item.hits}/{item.claimed}, recall {item.hits}/{item.true}) |"
        for name, item in score.localised
        if item.claimed + item.true
    ]
    head = ["| the three figures | |", "|---|---|", f"| relative error of right parameters | {score.bias.shown()} |"]
    return [*head, *localised, f"| false discoveries | {score.false_discoveries.shown(0)} |"]


def _tables(score: Score) -> list[str]:
    """The rates by kind, dose, effect and the like, as far as there are cases enough."""
    lines: list[str] = []
    for title, table in score.tables:
        shown = [(label, rate) for label, rate in table if rate.total]
        if shown and (_count(score) >= ENOUGH or not any(word in title for word in FINE)):
            lines += ["", f"| {title} | |", "|---|---|", *(f"| {label} | {rate.shown(0)} |" for label, rate in shown)]
    return lines


def _of_others(score: Score) -> str:
    """What of the unknown classes is proof: all but the one that a form of the tool describes."""
    tables = dict(score.tables)
    called, named = (
        [item for name, item in tables[f"unknown classes {what}"] if name != DESCRIBED]
        for what in ("called unknown", "given a name")
    )
    asked = sum(item.total for item in called)
    return (
        f"One class of the proof half, `{DESCRIBED}`, is no proof any more: a form of the tool describes it. "
        f"Of the other {len(called)} classes {sum(item.count for item in called)} of {asked} cases are called unknown; "
        f"given a name: {sum(item.count for item in named)}. The targets above count all."
    )


def _tally(tally: tuple[tuple[str, int], ...]) -> str:
    return ", ".join(f"{verdict} {number}" for verdict, number in tally)


def write_section(page: Path, score: Score) -> None:
    """Puts the section at the end of a page, in place of the one it holds."""
    text = page.read_text(encoding="utf-8") if page.exists() else ""
    own = text.partition(f"\n{HEADING}\n")[0].rstrip()
    page.write_text((own + "\n\n" if own else "") + section(score), encoding="utf-8", newline="\n")
