"""A diagnosis of motion logs described: what is missing from the drives' torques, joint by joint, and what is left."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath

from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.result import MotionDiagnosis, MotionFinding, MotionUnknown, OfJoint, Rollout
from linkwright.core.diagnose.motion.sentences import since_words
from linkwright.core.units.lists import listed
from linkwright.report.charts.joints import joints_at_a_glance
from linkwright.report.charts.motion import left_against, torque_against_time
from linkwright.report.charts.rollout import rolled_out_against_time
from linkwright.results.design import settings
from linkwright.results.diagnoses.evidence import set_aside
from linkwright.results.diagnoses.words import (
    interval,
    parameter_rows,
    place_words,
    portion,
    spoken,
    value,
    verdict_words,
    whole_sentence,
)
from linkwright.results.document import (
    BARS,
    Bars,
    Cell,
    Column,
    Description,
    Fact,
    Facts,
    Item,
    Lines,
    Paragraph,
    Picture,
    Section,
    count,
    number,
    section,
    share,
    table,
)
from linkwright.results.figures_in_words import effect_title, figure, lasted, with_unit

from .answer import answer, explained_share, largest_of, left_with_own, over, to_do
from .words import (
    alias_sentence,
    by_draws,
    dependence_words,
    finding_words,
    logs_words,
    sample_words,
    torque,
    torque_unit,
)

_WITHOUT = "Without JavaScript the torques against time are missing. All else is here. diagnosis.json has the figures."
MOST_READINGS = 6
"""Findings up to which a page has a sentence for each."""
MOST_FINDINGS = 12
"""Findings whose rows a screen shows."""


def describe(diagnosis: MotionDiagnosis) -> Description:
    """A diagnosis of one motion log or several."""
    # Of logs that do not suffice no joint's figures are known.
    known = any(math.isfinite(item.before) for item in diagnosis.per_joint)
    items: list[Item | None] = [
        _currents(diagnosis),
        Picture(lambda: joints_at_a_glance(diagnosis)) if diagnosis.traces else None,
        Lines(to_do(diagnosis)) if to_do(diagnosis) else None,
        Paragraph(spoken(diagnosis.sentence)),
        _facts(diagnosis),
        _joints(diagnosis) if known else None,
        _logs(diagnosis) if len(diagnosis.of_logs) > 1 else None,
        _events(diagnosis) if diagnosis.events else None,
        _findings(diagnosis) if diagnosis.findings else None,
        None if diagnosis.rollout is None else _rollout(diagnosis, diagnosis.rollout),
        None if diagnosis.unknown is None else _unknown(diagnosis, diagnosis.unknown),
        _pictures(diagnosis) if diagnosis.traces else None,
        _set_aside(diagnosis),
        _notes(diagnosis),
        section("What was asked", settings(_asked(diagnosis)), detail=True),
    ]
    title = f"{diagnosis.arm.name}: what the model lacks in the torques"
    held = tuple(item for item in items if item is not None)
    return Description(title, answer(diagnosis), held, brief(diagnosis), without=_WITHOUT)


def _currents(diagnosis: MotionDiagnosis) -> Paragraph | None:
    """A warning where nobody says the torque constants, and which the arm's weights make."""
    free = [log for log in diagnosis.logs if log.torque_constants_free]
    if not free:
        return None
    sentence = f"Nobody says the torque constants of {listed([PurePath(log.file).name for log in free])}"
    weighed = list(enumerate(free[0].weighed or (), start=1))
    values = [f"{value:.3g} at joint {joint}" for joint, value in weighed if not math.isnan(value)]
    lacking = [str(joint) for joint, value in weighed if math.isnan(value)]
    unit = f"N·m/{free[0].drive.unit}"
    by = f": the arm's weights make them {listed(values)} ({unit}), as wrong as its masses are" if values else ""
    those = "that of joint" if len(lacking) == 1 else "those of joints"
    without = f"; no weight tells {those} {listed(lacking)}, whose drives count as not logged" if lacking else ""
    return Paragraph(f"{sentence}{by}{without}.{_loops(free[0])}", "warning")


def _loops(log: MotionLog) -> str:
    """How stiff servos hold by their loops; else empty."""
    loops = zip(log.loop or (), log.weighed or (), strict=False)
    held = [
        f"{volts * constant:.3g} at joint {k}" for k, (volts, constant) in enumerate(loops, start=1) if constant > 0
    ]
    return f" By them servos hold with {listed(held)} (N·m/rad)." if held else ""


def brief(diagnosis: MotionDiagnosis) -> str:
    """The answer in a few words."""
    mismatch = torque(diagnosis.rms_before).text
    first, rest = largest_of(diagnosis), len(diagnosis.findings) - 1
    if first is None:
        return f"{verdict_words(diagnosis.verdict)}, mismatch {mismatch}"
    more = f" and {rest} more" if rest else ""
    part = explained_share(diagnosis)
    explained = "" if part is None else f", {portion(part).text} of {mismatch} explained"
    unknown = ", the rest not explained" if diagnosis.verdict == "unknown" else ""
    return f"{finding_words(first)}{more}{explained}{unknown}"


def _facts(diagnosis: MotionDiagnosis) -> Facts:
    gate = f"any mismatch at all: p {by_draws(diagnosis.gate_p, tests=2).text}"
    facts = [
        Fact("verdict", verdict_words(diagnosis.verdict, short=True), gate),
        Fact("noise floor", torque(diagnosis.noise_floor), "what the whole library leaves"),
        Fact(
            "RMS of the mismatch",
            torque(diagnosis.rms_before),
            f"all joints where they move; {sample_words(diagnosis)}",
        ),
    ]
    if diagnosis.findings:
        part = explained_share(diagnosis)
        note = "" if part is None else f"{portion(part).text} of the mismatch explained"
        left, held_out = left_with_own(diagnosis)
        facts.append(Fact("with what was found", torque(left), note))
        said = f"{over(diagnosis)}; {diagnosis.split}" if diagnosis.split else over(diagnosis)
        facts.append(Fact("on motion not fitted", torque(held_out), said))
        if diagnosis.rms_with_own is not None:
            facts.append(
                Fact("by the arm file alone", torque(diagnosis.rms_after), "what one log alone has is not in it")
            )
    return Facts(tuple(facts), headed=False)


def _joints(diagnosis: MotionDiagnosis) -> Section:
    rows: list[list[Cell]] = []
    for item in diagnosis.per_joint:
        unit = torque_unit(diagnosis.arm, item.joint)
        figures = (item.before, item.after, item.held_out, item.floor)
        depends = dependence_words(item.depends_on)
        text = f"{depends} (p {by_draws(item.p_unknown).text})" if depends else ""
        if math.isnan(item.before):
            text = "stood still or not logged"
        bars = Bars(tuple(zip(("before", "after", "held"), _shares(item), strict=True)))
        row = [count(item.joint), *(torque(value, unit) for value in figures), share(item.share), text, bars]
        rows.append(row)
    headings = ("joint", "before", "after", "held out", "floor", "of its torque", "what is left depends on", BARS)
    lead = (
        "What the model leaves of each joint's torque (RMS, where the joint moves). Held out: on motion not fitted. "
        "Bars are shares of the joint's torque: before (grey), after (blue), held out (pale)."
    )
    return section("Each joint", table(headings, rows), lead=lead)


def _shares(item: OfJoint) -> tuple[float, float, float]:
    """What is left before, after and on motion held out, of the joint's torque."""
    whole = item.held_out / item.share if item.share > 0.0 else math.nan  # the RMS of its torque
    return item.before / whole, item.after / whole, item.held_out / whole


def _logs(diagnosis: MotionDiagnosis) -> Section:
    dated = any(log.date for log in diagnosis.of_logs)
    rows: list[list[Cell]] = [
        [
            log.name,
            *([log.date] if dated else []),
            count(log.samples),
            *(torque(value) for value in (log.rms_before, log.rms_after, log.rms_held_out)),
            count(len(log.rejected)),
        ]
        for log in diagnosis.of_logs
    ]
    shown = ("samples", "before", "after", "held out", Column("rows set aside", detail=True))
    headings = ("log", *(["date"] if dated else []), *shown)
    return section("Each log", table(headings, rows), lead="The physics is shared. RMS of all joints together.")


def _events(diagnosis: MotionDiagnosis) -> Section:
    """What happened in the logs, when, where and how much."""
    rows: list[list[Cell]] = []
    for event in diagnosis.events:
        change = event.change
        most = max(range(len(change.torque)), key=lambda joint: change.torque[joint])
        size = change.parameters[0] if change.parameters else None
        instants = (change.start, change.end)
        begins, ends = ("" if each is None else with_unit(each.time, "s", 4) for each in instants)
        spans = [
            "" if each is None else f"{listed([figure(t, 4) for t in each.interval], 'to')} s" for each in instants
        ]
        where = f"link {listed([str(link) for link in event.links], 'or')}" if event.links else "tip"
        adds = f"{torque(change.torque[most], torque_unit(diagnosis.arm, most + 1)).text} at joint {most + 1}"
        known = [interval(size)] if size else [""]
        figures = [value(size) if size else "", *known, adds, PurePath(change.log).name]
        rows.append([event.kind, where, begins, spans[0], ends, spans[1], *figures])
    instant = ("95 % interval", "ends", "95 % interval", "how much", "95 % interval", "adds (RMS)")
    lead = "What acted for a while. These rows are set aside from all else."
    headings = ("event", "at", "begins", *instant, Column("log", detail=True))
    return section("Events in the log", table(headings, rows), lead=lead)


def _findings(diagnosis: MotionDiagnosis) -> Section:
    few = diagnosis.findings if len(diagnosis.findings) <= MOST_READINGS else ()
    readings = [Paragraph(spoken(item.reading), "statement", True) for item in few if item.reading]
    rows: list[list[Cell]] = []
    small, shown = [item for item in diagnosis.findings if item.small], 0
    most = min(MOST_FINDINGS, len(diagnosis.findings) - len(small))
    for finding in diagnosis.findings:
        where = place_words(finding.effect, finding.at).replace(" ", "\u00a0", 1)  # a number stays with its joint
        where = "; ".join(item for item in (where, f"{finding.recording} alone" if finding.recording else "") if item)
        made = parameter_rows(finding, effect_title(finding.effect), _rest(diagnosis, finding))
        # An arm has many findings, of which what the parameters mean would take the room.
        rows += [[row[0], where if row[0] else "", row[1], *row[3:]] for row in made]
        shown = len(rows) if finding in diagnosis.findings[:most] else shown
    headings = (
        "found",
        "at",
        "parameter",
        "value",
        "95 % interval",
        "adds at most (RMS)",
        Column("evidence in nats", detail=True),
        "p",
    )
    left = len(diagnosis.findings) - most
    more = f"and {left} more findings; the report and the JSON have them" if left > 0 else ""
    return section(
        "What describes part of it" if diagnosis.verdict == "unknown" else "What is missing",
        *readings,
        table(headings, rows, first=shown, rest=more),
        Paragraph(_small_words(small, max(diagnosis.small_together))) if small else None,
        *(Paragraph(sentence) for item in diagnosis.findings if (sentence := alias_sentence(item))),
    )


def _small_words(small: Sequence[MotionFinding], together: float) -> str:
    """What motion held out hardly needs, and what it adds at a joint together (N*m)."""
    return f"Small, together {torque(together, digits=2).text} at most: {listed([finding_words(i) for i in small])}."


def _rest(diagnosis: MotionDiagnosis, finding: MotionFinding) -> list[Cell]:
    """What a finding adds, at the joint where that is most, and what speaks for it."""
    if finding.apart is not None:
        chance = [number(finding.evidence, 3), by_draws(finding.p_value, finding.draws)]
        return [f"{finding.apart.words(finding.apart.without)} between encoders", *chance]
    known = [k for k, item in enumerate(finding.rms_explained) if math.isfinite(item)]
    most = max(known, key=lambda k: finding.rms_explained[k])
    adds = torque(finding.rms_explained[most], torque_unit(diagnosis.arm, most + 1)).text
    where = "" if finding.at == (most + 1,) else f" at joint {most + 1}"
    return [f"{adds}{where}", number(finding.evidence, 3), by_draws(finding.p_value, finding.draws)]


def _unknown(diagnosis: MotionDiagnosis, unknown: MotionUnknown) -> Section:
    """What stays unexplained."""
    worst = unknown.worst
    joints = f"joint{'s' if len(unknown.joints) > 1 else ''} {listed([str(joint) for joint in unknown.joints])}"
    amplitude = torque(unknown.amplitude, torque_unit(diagnosis.arm, worst)).text
    text = f"Not explained, at {joints}: {unknown.shape}. RMS {amplitude} at joint {worst}."
    depends = dependence_words(unknown.depends_on)
    return section(
        "What stays unexplained",
        Paragraph(text),
        Paragraph(f"It depends on {depends}.") if depends else None,
        None if unknown.change is None else Paragraph(since_words(unknown.change)),
        Paragraph(f"What would decide: {whole_sentence(unknown.decide)}") if unknown.decide else None,
        lead="What remains, and what it depends on. Nothing here is a cause.",
    )


def _rollout(diagnosis: MotionDiagnosis, rollout: Rollout) -> Section:
    """How far the simulated arm is off before and after, by joint, and both drawn."""
    if rollout.lacks:
        return section("Rollout", Paragraph(f"Nothing was simulated: {rollout.lacks}.", "warning"))
    rows: list[list[Cell]] = []
    for item in rollout.per_joint:
        turns = diagnosis.arm.joints[item.joint - 1].revolute
        scale, units = (180.0 / math.pi, ("°", "°/s")) if turns else (1e3, ("mm", "mm/s"))
        states = (item.before, item.after, item.held_out)
        figures = [(state.q_end, units[0]) for state in states]
        figures += [(state.q, units[0]) for state in states[:2]] + [(state.velocity, units[1]) for state in states[:2]]
        rows.append([count(item.joint), *(torque(scale * value, unit) for value, unit in figures)])
    over = ("over them, before", "after", Column("speed, before", detail=True), Column("after", detail=True))
    headings = ("joint", "at the ends, before", "after", "held out", *over)
    length = with_unit(rollout.seconds, "s", 3)
    lead = (
        f"MuJoCo moves the arm under the logged torques, from the logged state at the start of each {length} on. "
        f"Simulated less measured, RMS of {rollout.windows} windows. Held out: sizes fitted to other motion."
    )
    gone = [f"{left} {when}" for left, when in zip(rollout.left, ("before", "after", "held out"), strict=True) if left]
    names = listed([effect_title(effect) for effect in rollout.beside])
    return section(
        "Rollout",
        table(headings, rows),
        Paragraph(f"Windows in which a joint left its range and was stopped there: {listed(gone)}.") if gone else None,
        Paragraph(f"Simulated beside what MJCF holds: {names}.") if names else None,
        Picture(lambda: rolled_out_against_time(diagnosis.arm, rollout)),
        lead=lead,
    )


def _pictures(diagnosis: MotionDiagnosis) -> Section:
    """Torques against time, and what the model leaves of them against angle."""
    about = "Torques as measured, by the model as given, and with the findings. All are filtered alike."
    beside = "Measured less modelled where the joint moves, before (grey) and after (blue). Lines are means."
    time = section("Torque against time", Picture(lambda: torque_against_time(diagnosis)), lead=about)
    against = Picture(lambda: left_against(diagnosis))
    left = section("What is left against each joint's angle", against, lead=beside)
    return section("Torques", time, left, detail=True)


def _set_aside(diagnosis: MotionDiagnosis) -> Section:
    several = len(diagnosis.logs) > 1
    return set_aside(
        [
            (f"row {item.row} of {PurePath(log.file).name}" if several else f"row {item.row}", item.reason)
            for log in diagnosis.logs
            for item in log.rejected
        ]
    )


def _notes(diagnosis: MotionDiagnosis) -> Section | None:
    lines = tuple(dict.fromkeys((*diagnosis.notes, *(warning for log in diagnosis.logs for warning in log.warnings))))
    return section("Notes", Lines(lines)) if lines else None


def _asked(diagnosis: MotionDiagnosis) -> list[tuple[str, str]]:
    rates = sorted({figure(rate, 3) for rate in diagnosis.rates})
    rows = [
        ("logs" if len(diagnosis.logs) > 1 else "log", logs_words(diagnosis.logs)),
        ("samples", sample_words(diagnosis)),
        ("sampled at", f"{listed(rates)} Hz"),
        ("low-pass on both sides, without phase", with_unit(diagnosis.cutoff, "Hz", 3)),
        ("held out", diagnosis.split),
    ]
    took = lasted(diagnosis.seconds, "")
    return [*rows, ("time taken", took)] if took else rows
