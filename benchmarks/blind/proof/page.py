"""docs/proof.md from halves and figures: words and tables, nothing computed."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import yaml

from benchmarks.blind.answers import Rate, Spread, Table
from benchmarks.blind.generator.concealed import OUTSIDE
from benchmarks.blind.proof.figures import Figures, Prediction
from benchmarks.blind.proof.halves import Half
from benchmarks.blind.proof.targets import TARGETS, Cause, Target, causes

POWER = "proof-power.svg"
WORDS = Path(__file__).with_name("words.yaml")
Both = Sequence[tuple[Half, Figures]]
Row = tuple[str, Callable[[Half, Figures], str]]


def _short(rate: Rate) -> str:
    return f"{100 * rate.share:.0f} % ({rate.count}/{rate.total})" if rate.total else "-"


def _ratio(value: Spread) -> str:
    """1.01 (93 %): the median and the share within the target."""
    return f"{value.median:.3f} ({100 * value.within:.0f} %)" if value.count else "-"


def _span(value: Spread) -> str:
    return f"{value.median:.3g}, 95th percentile {value.upper:.3g}" if value.count else "-"


def _any(value: Rate | Spread | float) -> str:
    if isinstance(value, Rate):
        return value.shown()
    if isinstance(value, Spread):
        within = "" if math.isnan(value.within) else f"; {100 * value.within:.0f} % of {value.count} within"
        return f"{value.median:.3f}{within}" if value.count else "-"
    return f"{value:g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(r) + " |" for r in rows), ""]


def _by_half(both: Both, head: str, rows: Sequence[Row]) -> list[str]:
    names = [half.name for half, _ in both]
    return _table([head, *names], [[label, *(call(half, found) for half, found in both)] for label, call in rows])


def _tables(both: Both, head: str, pick: Callable[[Half], Table], words: Callable[[str], str] = str) -> list[str]:
    """A breakdown of the score with one column for each half."""
    labels = list(dict.fromkeys(label for half, _ in both for label, _ in pick(half)))

    def row(label: str) -> Row:
        return words(label), lambda half, _: _found(pick(half), label)

    return _by_half(both, head, [row(label) for label in labels])


def _found(table: Table, label: str) -> str:
    return next((rate.shown() for key, rate in table if key == label), "-")


def _plain(name: str) -> str:
    return name.replace("_", " ")


def page(both: Both, written: Mapping[str, Cause] | None = None) -> str:
    """The whole report. `both` holds the disclosed half, the sealed one, or both, in that order."""
    known = causes() if written is None else written
    lines = ["# The proof", "", *_words("opening"), *_how(both), *_reached(both, known), *_alarms(both)]
    for section in (_power, _confused, _located, _covered, _unknown, _hidden, _predicted, _poses):
        lines += section(both)
    return "\n".join(lines).rstrip() + "\n"


def _words(key: str, **values: str) -> list[str]:
    """The paragraphs of words.yaml under a key, folded."""
    result = yaml.safe_load(WORDS.read_text(encoding="utf-8"))[key]
    lines: list[str] = []
    for paragraph in [result] if isinstance(result, str) else result:
        text = paragraph.format(**values) if values else paragraph
        if paragraph.startswith("**"):
            lines += textwrap.wrap(text, 158, initial_indent="- ", subsequent_indent="  ", break_long_words=False)
        else:
            lines += [*textwrap.wrap(text, 158, break_long_words=False), ""]
    return lines if not lines[-1] else [*lines, ""]


def _how(both: Both) -> list[str]:
    lines = ["## How it was done", "", *_words("how")]
    rows: list[Row] = [
        *(_count(kind) for kind in _kinds(both)),
        ("answered", lambda h, _: f"{len(h.truths)} of {_written(h)}"),
        ("failed or timed out", lambda h, _: str(h.score.failed.count)),
        ("seconds a case", lambda h, _: _span(h.score.seconds)),
        ("alternatives to a name", lambda h, _: f"{h.score.alternatives_a_name:.2f}"),
        ("pieces of the parts below that failed", lambda _, f: str(f.failed)),
        ("seal of the truths", lambda h, _: f"`{h.score.seal[:16]}`"),
        ("SHA-256 of the answers", lambda h, _: f"`{h.given[:16]}`"),
    ]
    lines += _by_half(both, "cases", rows)
    if len(both) == 1:
        other = "sealed" if both[0][0].name == "disclosed" else "disclosed"
        lines += [f"The {other} half is not in this report.", ""]
    return lines


def _count(kind: str) -> Row:
    return _plain(kind), lambda half, _: str(dict(half.score.cases).get(kind, 0))


def _written(half: Half) -> int:
    return sum(1 for _ in (half.cases / "cases").iterdir())


def _kinds(both: Both) -> list[str]:
    return list(dict.fromkeys(kind for half, _ in both for kind, _ in half.score.cases))


def _reached(both: Both, known: Mapping[str, Cause]) -> list[str]:
    names = [half.name for half, _ in both]
    rows = [
        [target.what, target.wanted, *(_judged(target, both, number) for number in range(len(both)))]
        for target in TARGETS
    ]
    lines = ["## Targets and what was reached", "", *_words("targets"), *_table(["", "target", *names], rows)]
    missed = [t for t in TARGETS if any(t.met(both, number) is False for number in range(len(both)))]
    notes: list[str] = []
    for target in TARGETS:
        cause = known.get(target.key, Cause("", ""))
        if target in missed:
            notes.append(f"- **{target.what}**: {cause.why or 'the cause is not known yet.'}")
        if cause.before:
            notes.append(f"- {target.what}, before: {cause.before}")
    return [*lines, *(["Misses:", ""] if missed else []), *notes, ""]


def _judged(target: Target, both: Both, number: int) -> str:
    met = target.met(both, number)
    text = _any(target.reached(*both[number]))
    return text if met is None or met else f"**MISSED** {text}"


def _alarms(both: Both) -> list[str]:
    lines = ["## False alarms", "", *_words("alarms")]
    lines += _by_half(
        both,
        "nothing is missing, yet something is said",
        [
            ("all", lambda h, _: h.score.false_alarms.shown()),
            ("plain", lambda h, _: h.score.false_alarms_plain.shown()),
            ("hostile", lambda h, _: h.score.false_alarms_hostile.shown()),
        ],
    )
    lines += _tables(both, "hostile by vice", lambda h: h.score.false_alarms_by_hostility, _plain)
    return lines + _tables(both, "by design of the recording", lambda h: h.score.false_alarms_by_design, _plain)


def _power(both: Both) -> list[str]:
    lines = ["## Power", "", f"![share named against projected signal to noise](pictures/{POWER})", ""]
    for half, _ in both:
        lines += [f"Single effects, {half.name} half:", ""]
        tables = [
            ("signal to noise", None),
            ("class named", dict(half.score.class_by_dose)),
            ("that name alone", dict(half.score.exact_by_dose)),
            ("a wrong name", dict(half.score.wrong_name_by_dose)),
            ("anything said", dict(half.score.detected_by_dose)),
        ]
        doses = [dose for dose, _ in half.score.class_by_dose]
        rows = [[label, *(_short(table[dose]) for dose in doses)] for label, table in tables if table is not None]
        lines += _table([tables[0][0], *doses], rows)
    lines += ["Pairs, both classes right and nothing else said, by the weaker's signal to noise:", ""]
    lines += _tables(both, "weaker of the pair", lambda h: h.score.pairs_by_dose)
    lines += ["From 0.9 on, by effect:", ""]
    lines += _tables(both, "class named", lambda h: h.score.class_by_effect, _plain)
    return lines + _tables(both, "by design of the recording", lambda h: h.score.class_by_design, _plain)


def _confused(both: Both) -> list[str]:
    half, result = both[-1]
    lines = ["## What is taken for what", "", *_words("confused", half=half.name)]
    rows: list[tuple[int, list[str]]] = []
    for effect, cells in result.confusion:
        total = sum(count for _, count in cells)
        wrong = [(label, count) for label, count in cells if label != effect]
        outside = effect in OUTSIDE
        if outside:
            wrong = [(label, count) for label, count in wrong if label != "unknown"]
        if wrong:
            words = ", ".join(f"{_plain(label)} {count}" for label, count in wrong)
            name = _plain(effect) + (" (outside)" if outside else "")
            rows.append((-sum(count for _, count in wrong), [name, str(total), words]))
    return lines + _table(["truth", "cases", "taken for"], [row for _, row in sorted(rows)])


def _located(both: Both) -> list[str]:
    rows: list[Row] = [
        ("the true joint or link is named first", lambda h, _: h.score.joint_right.shown()),
        ("it or its neighbour", lambda h, _: h.score.joint_within_one.shown()),
        ("the direction (of the predicted sample, below)", lambda _, f: f.direction.shown()),
        ("a slip's moment is given at all", lambda h, _: h.score.since_found.shown()),
        ("by how much it is off, s", lambda h, _: _span(h.score.since_error_s)),
    ]
    return ["## Where", "", *_by_half(both, "effects of one place, from 0.9 on", rows)]


def _covered(both: Both) -> list[str]:
    lines = ["## Intervals", "", *_words("intervals")]
    lines += _by_half(both, "", [("all parameters", lambda h, _: h.score.coverage.shown())])
    return lines + _tables(both, "by parameter", lambda h: h.score.coverage_by_parameter, _plain)


def _unknown(both: Both) -> list[str]:
    rows: list[Row] = [
        ("called unknown", lambda h, _: h.score.unknown_recall.shown()),
        ("given a name", lambda h, _: h.score.wrong_closure.shown()),
        ("called unknown, 1 left by any three effects", lambda h, _: h.score.unknown_recall_beyond_library.shown()),
        ("given a name, likewise", lambda h, _: h.score.wrong_closure_beyond_library.shown()),
    ]
    lines = ["## Unknown physics", "", *_words("unknown")]
    lines += _by_half(both, "signal to noise from 1 on", rows)
    return lines + _tables(both, "called unknown, by cause", lambda h: h.score.unknown_by_effect, _plain)


def _hidden(both: Both) -> list[str]:
    rows: list[Row] = [
        ("invisible in the recording: nothing claimed", lambda h, _: h.score.refused.shown()),
        ("visible, but exactly another's pattern: the class declared", lambda h, _: h.score.aliases_declared.shown()),
    ]
    return ["## What cannot be seen, or not told apart", "", *_by_half(both, "", rows)]


def _predicted(both: Both) -> list[str]:
    lines = ["## Prediction where nobody recorded", "", *_words("predicted")]
    for half, found in both:
        if not found.predictions:
            continue
        about = f"{found.predicted} single effects and pairs of signal to noise from 0.5 on, by a fixed seed:"
        lines += [f"{half.name.capitalize()} half, {about}", ""]
        head = ["", "inside", "outside", "unseen payload", "e/n inside", "e/n outside", "e/n unseen payload"]
        lines += _table(head, [_prediction(prediction) for prediction in found.predictions])
    return lines


def _prediction(prediction: Prediction) -> list[str]:
    errors = [f"{value.median:.2f}" if value.count else "-" for value in prediction.error]
    return [prediction.way, *(_ratio(value) for value in prediction.whole), *errors]


def _poses(both: Both) -> list[str]:
    told = [(half, found) for half, found in both if found.poses]
    if not told:
        return []
    lines = ["## Designed next poses against random ones", "", *_words("poses")]
    for half, found in told:
        about = f"{found.posed[0]} cases; in {found.posed[1]} others the tool says that no pose would help"
        lines += [f"{half.name.capitalize()} half, {about}.", ""]
        rows = [[p.way, _short(p.resolved), _short(p.smaller), _short(p.stayed), _short(p.lost)] for p in found.poses]
        rows += [
            [f"{p.way}, promised", _short(p.resolved), _short(p.smaller), _short(p.stayed), _short(p.lost)]
            for p in found.promised
        ]
        lines += _table(["poses", "the true name alone", "class smaller", "as before", "truth lost"], rows)
    return lines
