"""The arm where a diagnosis finds it farthest off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.diagnose.result import Diagnosis
from linkwright.report.pictures.arm import arm_picture, shared_window, skeleton_at
from linkwright.report.pictures.svg import element, nice_below, text
from linkwright.results.diagnoses.words import row_words
from linkwright.results.figures_in_words import figure, mm, pose


def arm_at_mismatch(diagnosis: Diagnosis) -> str:
    """The arm at the reading where the mismatch is largest, the joint ringed."""
    recording, arm = diagnosis.recording, diagnosis.arm
    length = np.linalg.norm(diagnosis.residual_before, axis=1)
    worst = int(np.argmax(length))
    vector = [*diagnosis.in_space(diagnosis.residual_before)[worst].tolist(), 0.0][:3]
    shown = (vector[0], vector[1], vector[2])
    at = WorstPose(tuple(recording.q[worst].tolist()), 0, float(length[worst]), shown, (), ())
    drawn = skeleton_at(arm, at)
    window = shared_window([drawn])
    if at.error > 0.0:
        # Seen from the side the arrow may point at the reader; it must not be drawn longer for that.
        longest = nice_below(0.2e-3 * window.width / at.error)
        window = replace(window, exaggeration=min(window.exaggeration, longest))
    joint = None if diagnosis.where.joint is None else diagnosis.where.joint - 1
    ring = "" if joint is None else f"; joint {joint + 1} is ringed"
    row = row_words(recording, int(recording.row[worst]))
    about = f"{arm.name} at {row}, where the mismatch is largest: {mm(at.error, 3)}{ring}"
    view = "" if arm.planar() else "; seen from the side, in the upright plane through the tip"
    arrow = f"The arrow is the mismatch, {figure(window.exaggeration)} times its size{view}."
    words = f"{about} ({pose(arm, at.q)}). {arrow}"
    picture = arm_picture(arm, drawn, window, "before", marked=joint, about=about)
    return element("figure", picture, element("figcaption", text(words)), class_="bounded small")
