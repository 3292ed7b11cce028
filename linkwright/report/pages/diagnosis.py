"""The report of a diagnosis: the plain sentence first, then where it sits, how sure it is, what else it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.diagnose.result import Diagnosis
from linkwright.redesigning import Redesign
from linkwright.report.contents import Contents
from linkwright.report.page import side_by_side
from linkwright.report.pictures.arm import arm_picture, shared_window, skeleton_at
from linkwright.report.pictures.joint_curves import joint_curves
from linkwright.report.pictures.ladder import ladder_picture
from linkwright.report.pictures.residual_map import arrow_maps, hover_maps
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.svg import element, nice_below, text
from linkwright.results.diagnoses.described import describe
from linkwright.results.diagnoses.words import row_words
from linkwright.results.figures_in_words import figure, mm, pose

from .covariates import small_multiples

_WITHOUT = "Without JavaScript the maps to hover over are missing; all else is here. diagnosis.json has the figures."


def diagnosis_report(diagnosis: Diagnosis, redesign: Redesign | None = None) -> Contents:
    """What the report shows."""
    places, figures = hover_maps(diagnosis)
    pictures = {
        "curves": joint_curves(diagnosis),
        "first": side_by_side(_arm(diagnosis), ladder_picture(diagnosis)),
        "maps": arrow_maps(diagnosis) + places,
        "covariates": small_multiples(diagnosis),
    }
    if redesign is not None:
        pictures["redesigned"] = sections_grid((("before", redesign.old.arm), ("after", redesign.new.arm)))
    return Contents(describe(diagnosis, redesign), pictures, figures, _WITHOUT)


def _arm(diagnosis: Diagnosis) -> str:
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
