"""The parts of a diagnosis's report: what is missing, where it sits, the ladder, and what else was considered."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from arm.worst import WorstPose
from diagnose.result import Detectable, Diagnosis, RejectedForm, Unknown
from linkwright.diagnosis_words import (
    alias_sentence,
    covariate_words,
    covered_words,
    detectable_words,
    effect_words,
    interval_words,
    least_visible,
    main_parameters,
    next_pose_words,
    p_words,
    parameter_title,
    share_words,
    spoken,
    time_words,
    value_words,
    where_sentences,
    whole_sentence,
)
from linkwright.words import figure, mm, pose

from .arm_picture import arm_picture, shared_window, skeleton_at
from .joint_curves import joint_curves
from .page import side_by_side, table
from .svg import element, nice_below, text

MOST_LISTED = 40

SPLITS = (
    ("pose blocks", "a part of the workspace at a time (the one quoted above)"),
    ("random rows", "a fifth of the rows at random"),
    ("time blocks", "a stretch of time at a time"),
    ("payloads", "a payload at a time"),
)


def sentences(lines: list[str], class_: str = "binding") -> str:
    """Sentences as a list."""
    return element("ul", *(element("li", text(each)) for each in lines), class_=class_) if lines else ""


def findings(diagnosis: Diagnosis) -> str:
    """What is missing: the sentences, then every parameter with its interval."""
    rows: list[list[str]] = []
    for finding in diagnosis.findings:
        rest = [mm(finding.rms_explained, 3), mm(finding.rms_without, 3), p_words(finding.p_value)]
        parameters, further = main_parameters(finding)
        for index, fitted in enumerate(parameters):
            title = parameter_title(fitted, finding.effect)
            value = value_words(fitted) + (" (at its bound)" if fitted.at_bound else "")
            row = [effect_words(finding.effect, finding.at) if index == 0 else "", title, value, interval_words(fitted)]
            rows.append(row + (rest if index == 0 else ["", "", ""]))
        if further:
            rows.append(["", further, "", "", "", "", ""])
    said = "".join(
        element("p", text(spoken(each.reading)), class_="statement") for each in diagnosis.findings if each.reading
    )
    headings = ("left out", "parameter", "value", "95 % interval", "explains (RMS)", "RMS without it", "p")
    # The engine's sentence may say it already; then only how alike the patterns are is new.
    aliases = [
        sentence
        for each in diagnosis.findings
        if (sentence := alias_sentence(each)) and "cannot tell" not in each.reading
    ]
    found = (table(headings, rows, numbers=(2, 3, 4, 5, 6)) if rows else "") + joint_curves(diagnosis)
    others = [
        [
            effect_words(each.effect, each.at),
            effect_words(other.effect, other.at),
            figure(other.likeness, 4),
            figure(round(other.worse, 3), 2),
        ]
        for each in diagnosis.findings
        for other in each.alternatives
    ]
    if not others:
        return said + found
    heading = element("h3", text("What the data cannot tell apart"))
    columns = ("named", "may as well be", "likeness of the patterns", "criterion (BIC) worse by")
    return said + found + heading + sentences(aliases) + table(columns, others, numbers=(2, 3))


def to_do(diagnosis: Diagnosis) -> str:
    """What the files beside the page are good for."""
    if diagnosis.unknown is not None:
        lines = []
        if diagnosis.unknown.predicted is not None:
            lines.append(
                "compensation.csv: what to subtract at the poses recorded. It describes and does not explain; it holds "
                "as long as the cause stays as it was."
            )
        lines.append("Record what would decide (above), and diagnose again.")
        return sentences(lines)
    if not diagnosis.findings:
        return ""
    return sentences([
        "arm.yaml: the arm with what was found in it. linkwright evaluate and optimize take it; linkwright compensate "
        "makes the table of it that a controller can subtract.",
        "residuals.csv: every reading with its residual before and after.",
        "After a repair, record the same poses again; linkwright compare says what has changed and what has not.",
    ])


def unknown(found: Unknown) -> str:
    """What nothing in the library explains."""
    lines = [f"Its shape: {found.shape}.", f"Its size: RMS {mm(found.amplitude, 3)}."]
    if found.depends_on:
        lines.append(f"It depends on: {', '.join(covariate_words(name) for name in found.depends_on)}.")
    if found.since is not None:
        lines.append(f"It is there since {time_words(found.since)} into the recording.")
    if found.decide:
        lines.append(f"What would decide: {whole_sentence(found.decide)}")
    if found.held_out_share is not None:
        lines.append(
            f"A smooth model of it predicts {share_words(found.held_out_share)} of its sum of squares on readings that "
            "it has not seen. It describes and does not explain: good for compensation within the poses recorded only."
        )
    forms = [
        [each.name.replace("_", " "), share_words(each.share), share_words(each.share_held_out), each.sentence]
        for each in found.forms
    ]
    shown = sentences(lines)
    if forms:
        headings = ("form that describes it", "share", "held out", "")
        shown += table(headings, forms, numbers=(1, 2))
    if found.rejected:
        shown += element("h3", text("Why no near entry of the library will do")) + rejected(found.rejected)
    return shown


def rejected(forms: tuple[RejectedForm, ...]) -> str:
    """What was considered and not taken, and why."""
    rows = [[effect_words(each.effect, each.at), share_words(each.share), each.reason] for each in forms]
    headings = ("considered", "would explain more", "not taken because")
    shown = table(headings, rows[:MOST_LISTED], numbers=(1,))
    if len(rows) > MOST_LISTED:
        rest = table(headings, rows[MOST_LISTED:], numbers=(1,))
        shown += element("details", element("summary", text(f"{len(rows) - MOST_LISTED} more")), rest)
    return shown


def location(diagnosis: Diagnosis) -> str:
    """The arm at the reading where the mismatch is largest, the joint ringed; and each joint's share as bars."""
    picture = _arm(diagnosis)
    shares = [
        (f"joint {number}", share, number == diagnosis.where.joint)
        for number, share in enumerate(diagnosis.where.joint_shares, start=1)
    ]
    bars = element("h3", text("What each joint's motion could describe")) + _share_bars(shares)
    bars += element("p", text("Each joint alone; the shares overlap, and do not add up to the whole."), class_="lead")
    told = sentences(where_sentences(diagnosis)) or element("p", text("There is no mismatch to locate."))
    return side_by_side(picture, element("div", told, bars if shares else ""))


def _arm(diagnosis: Diagnosis) -> str:
    recording, arm = diagnosis.recording, diagnosis.arm
    length = np.linalg.norm(diagnosis.residual_before, axis=1)
    worst = int(np.argmax(length))
    vector = [*diagnosis.residual_before[worst].tolist(), 0.0][:3]
    shown = (vector[0], vector[1], vector[2])
    at = WorstPose(tuple(recording.q[worst].tolist()), 0, float(length[worst]), shown, (), ())
    drawn = skeleton_at(arm, at)
    window = shared_window([drawn])
    if at.error > 0.0:
        # Seen from the side the arrow may point at the reader; it must not be drawn longer for that.
        longest = nice_below(0.2e-3 * window.width / at.error)
        window = replace(window, exaggeration=min(window.exaggeration, longest))
    joint = None if diagnosis.where.joint is None else diagnosis.where.joint - 1
    row = int(recording.row[worst])
    ring = "" if joint is None else f"; joint {joint + 1} is ringed"
    about = f"{arm.name} at row {row}, where the mismatch is largest: {mm(at.error, 3)}{ring}"
    view = "" if arm.planar() else "; seen from the side, in the upright plane through the tip"
    arrow = f"The arrow is the mismatch, {figure(window.exaggeration)} times its size{view}."
    words = f"{about} ({pose(arm, at.q)}). {arrow}"
    picture = arm_picture(arm, drawn, window, "before", marked=joint, about=about)
    return element("figure", picture, element("figcaption", text(words)), class_="bounded")


def _share_bars(shares: list[tuple[str, float, bool]]) -> str:
    rows = [
        _bar_row(name, [("after" if best else "before", share, share_words(share))]) for name, share, best in shares
    ]
    return element("table", element("tbody", *rows), class_="bars")


def _bar_row(name: str, bars: list[tuple[str, float, str]], *more: str) -> str:
    drawn: list[str] = []
    for class_, share, words in bars:
        width = 100.0 * min(1.0, max(0.0, share)) if math.isfinite(share) else 0.0
        fill = element("span", class_=f"fill {class_}", style=f"width:{width:.2f}%")
        amount = element("span", text(words), class_="amount")
        drawn.append(element("div", element("span", fill, class_="track"), amount, class_="bar"))
    cells = [element("td", text(words), class_="number") for words in more]
    return element("tr", element("th", text(name), scope="row"), element("td", *drawn), *cells)


def dependences(diagnosis: Diagnosis) -> str:
    """What the mismatch was tested against."""
    rows = [
        [covariate_words(each.on), share_words(each.share), p_words(each.p_value), yes]
        for each in diagnosis.where.dependences
        for yes in ["it depends on this" if each.on in diagnosis.where.depends_on else ""]
    ]
    headings = ("tested against", "could describe", "p", "")
    return table(headings, rows, numbers=(1, 2)) if rows else ""


def ladder(diagnosis: Diagnosis) -> str:
    """The models tried, each with its RMS on fitted and on held-out readings."""
    known = [value for rung in diagnosis.ladder for value in (rung.rms, rung.held_out) if math.isfinite(value)]
    largest = max(known, default=0.0) or 1.0
    rows = [
        _bar_row(
            rung.label,
            [
                ("after", rung.rms / largest, f"RMS {mm(rung.rms, 3)}"),
                ("before", rung.held_out / largest, f"held out {mm(rung.held_out, 3)}"),
            ],
            mm(rung.mean, 3),
            mm(rung.largest, 3),
        )
        for rung in diagnosis.ladder
    ]
    titles = (("model", None), ("residual", None), ("mean", "number"), ("largest", "number"))
    head = element("tr", *(element("th", text(words), scope="col", class_=class_) for words, class_ in titles))
    shown = element("table", element("thead", head), element("tbody", *rows), class_="bars")
    splits = [f"{dict(SPLITS).get(name, name)}: RMS {mm(value, 3)}" for name, value in diagnosis.splits.items()]
    held = element("h3", text("On readings that it has not seen, by what was held out")) if splits else ""
    return shown + element("p", text(diagnosis.noise_source), class_="lead") + held + sentences(splits)


def detectable(diagnosis: Diagnosis) -> str:
    """The smallest sizes that would have been found, and what cannot be seen at all."""
    visible = [each for each in diagnosis.detectable if each.visible > 0.0]
    worst = least_visible(diagnosis)
    shown = _detectable_table(worst) if visible else ""
    if len(visible) > len(worst):
        summary = element("summary", text(f"All {len(visible)}, at every joint and link"))
        shown += element("details", summary, _detectable_table(visible))
    hidden = [effect_words(effect, at) for effect, at in diagnosis.invisible]
    if hidden:
        shown += element("h3", text("Not to be seen in this recording at all")) + element("p", text(", ".join(hidden)))
    return shown


def _detectable_table(found: list[Detectable]) -> str:
    # Where no nuisance hides a part of any pattern, there is nothing to say about it.
    hidden = any(each.visible < 0.995 for each in found)
    rows = [
        [
            effect_words(each.effect, each.at),
            mm(each.rms, 3),
            f"{each.parameter.replace('_', ' ')} {detectable_words(each)}",
            *([share_words(each.visible)] if hidden else []),
        ]
        for each in found
    ]
    headings = ("effect", "RMS at the tip", "its parameter", "visible share of its pattern")
    return table(headings if hidden else headings[:3], rows, numbers=(1, 2, 3))


def next_poses(diagnosis: Diagnosis) -> str:
    """Readings that would decide more."""
    headings = ("joint coordinates", "payload", "side of approach", "to decide")
    rows = [[*next_pose_words(diagnosis.arm, each), each.decides] for each in diagnosis.next_poses]
    shown = table(headings, rows) if rows else ""
    note = element("p", text(diagnosis.next_poses_note)) if diagnosis.next_poses_note else ""
    return shown + note


def standards(diagnosis: Diagnosis) -> str:
    """Figures of ISO 9283 and ISO 230-2."""
    rows = [
        [each.symbol, each.name, covered_words(each), str(each.count), each.standard] for each in diagnosis.figures
    ]
    return table(("figure", "what", "value", "readings", "standard"), rows, numbers=(2, 3))


def set_aside(diagnosis: Diagnosis) -> str:
    """The rows that were not used, and why."""
    rows = [[str(each.row), each.reason] for each in diagnosis.rejected_rows]
    if not rows:
        return element("p", text("Every row was used."))
    shown = table(("row", "why"), rows[:MOST_LISTED])
    if len(rows) > MOST_LISTED:
        rest = table(("row", "why"), rows[MOST_LISTED:])
        shown += element("details", element("summary", text(f"{len(rows) - MOST_LISTED} more")), rest)
    return shown
