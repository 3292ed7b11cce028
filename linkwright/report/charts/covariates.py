"""Residuals against everything that was recorded as small multiples, and the curves by which joints err."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.arrays import motion_directions
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.result import Diagnosis, Finding
from linkwright.core.sections.numeric import Array
from linkwright.core.units.temperature import ZERO_CELSIUS
from linkwright.report.pictures.residual_map import chosen_rows, states
from linkwright.report.pictures.svg import Plot, binned, course, dots, element, line, spanned, text
from linkwright.results.diagnoses.words import covariate_words, probability

MOST_DOTS = 500
_WIDTH, _HEIGHT = 270.0, 150.0


@dataclass(frozen=True)
class Covariate:
    """Something recorded beside the tip: `name` as in `depends_on`, `label` for the axis, `values` (N,)."""

    name: str
    label: str
    values: Array


def covariates(diagnosis: Diagnosis) -> list[Covariate]:
    """All that the recording holds and that varies."""
    recording, arm = diagnosis.recording, diagnosis.arm
    list_: list[Covariate] = []
    for index, joint in enumerate(arm.joints):
        values = np.degrees(recording.q[:, index]) if joint.revolute else 1e3 * recording.q[:, index]
        unit = "degrees" if joint.revolute else "mm"
        list_.append(Covariate(f"q{index + 1}", f"joint {index + 1} in {unit}", values))
    if recording.sides is not None:
        for index in range(arm.size):
            label = f"side of joint {index + 1} (+1 from below)"
            list_.append(Covariate(f"dir{index + 1}", label, recording.sides[:, index]))
    if recording.payload_mass is not None:
        list_.append(Covariate("payload_kg", "payload in kg", recording.payload_mass))
    if recording.force is not None:
        list_.append(Covariate("force", "force at the tip in N", np.linalg.norm(recording.force, axis=1)))
    if recording.temperature is not None:
        list_.append(Covariate("temperature_degC", "temperature in °C", recording.temperature - ZERO_CELSIUS))
    if recording.time is not None:
        span = float(np.ptp(recording.time))
        factor, unit = (3600.0, "h") if span > 7200.0 else (60.0, "min") if span > 300.0 else (1.0, "s")
        list_.append(Covariate("time", f"time in {unit}", recording.time / factor))
    return [item for item in list_ if np.ptp(item.values) > 0.0]


def shown_component(diagnosis: Diagnosis) -> tuple[Array, str]:
    """The direction (N, D) along which residuals are shown, and what it is in words.

    It is the motion of the joint in which the mismatch sits, else the direction in which the mismatch is largest.
    """
    width = diagnosis.recording.tip.shape[1]
    joint = diagnosis.where.joint
    if joint is not None and diagnosis.shown is None:
        directions = motion_directions(diagnosis.arm, diagnosis.recording.q)[:, joint - 1, :width]
        return directions, f"along the motion of joint {joint}"
    residual = diagnosis.residual_before
    main = np.linalg.eigh(residual.T @ residual)[1][:, -1]
    main = main * (np.sign(main[np.argmax(np.abs(main))]) or 1.0)
    if width == 1:
        return np.broadcast_to(main, residual.shape), "of what was measured"
    words = ", ".join(f"{value:.2f}".replace("-", "−") for value in main + 0.0)
    return np.broadcast_to(main, residual.shape), f"along ({words}), where it is largest"


def small_multiples(diagnosis: Diagnosis) -> str:
    """A plot for each covariate, all to one scale of the residual."""
    directions, words = shown_component(diagnosis)
    parts = [(when, 1e3 * np.sum(residual * directions, axis=1)) for when, residual in states(diagnosis)]
    up = spanned(np.concatenate([values for _, values in parts]), 0.06)
    noise = None
    if diagnosis.noise_floor is not None:
        noise = 1e3 * diagnosis.noise_floor / np.sqrt(diagnosis.recording.tip.shape[1])
    drawn = [_panel(diagnosis, covariate, parts, up, noise) for covariate in covariates(diagnosis)]
    keys = "".join(element("span", class_=f"key {when}") + text(when) for when, _ in parts)
    lead = f"Each dot is a reading: the residual {words}, in mm. Lines are means. The band is the noise, ±1 σ."
    return element("p", text(lead), keys, class_="lead") + element("div", *drawn, class_="multiples")


def _panel(
    diagnosis: Diagnosis,
    covariate: Covariate,
    parts: list[tuple[str, Array]],
    up: tuple[float, float],
    noise: float | None,
) -> str:
    plot = Plot(_WIDTH, _HEIGHT, spanned(covariate.values), up)
    rows = chosen_rows(len(covariate.values), MOST_DOTS)
    x = covariate.values
    two = len(np.unique(x)) <= 3
    children: list[str] = []
    if noise is not None:
        y = plot.y(np.clip(np.array([noise, -noise]), *up))
        band = {"x": plot.left, "y": float(y[0]), "width": plot.width, "height": float(y[1] - y[0])}
        children.append(element("rect", **band, class_="band"))
    spread = 0.04 * (plot.across[1] - plot.across[0])
    for index, (when, values) in enumerate(parts):
        # Where a covariate has few values, before and after stand side by side.
        aside = (index - 0.5 * (len(parts) - 1)) * spread if two else 0.0
        children.append(dots(plot.x(x[rows] + aside), plot.y(values[rows]), when))
    if covariate.name == "time" and diagnosis.where.since is not None and diagnosis.recording.time is not None:
        factor = float(np.ptp(x)) / float(np.ptp(diagnosis.recording.time))
        since = float(plot.x(np.array(diagnosis.where.since * factor)))
        children.append(line((since, plot.top), (since, plot.top + plot.height), "error-line", 1.5))
    for when, values in parts:
        means = binned(x, values)
        children.append(course(plot.x(means[0]), plot.y(means[1]), when))
    tested = next((dependence for dependence in diagnosis.where.dependences if dependence.on == covariate.name), None)
    depends = covariate.name in diagnosis.where.depends_on
    said = "" if tested is None else ", " + f"p {probability(tested.p_value).text}".replace(" ", "\u00a0")
    verdict = f"Depends on {covariate_words(covariate.name)}" if depends else "No dependence shown"
    caption = "" if tested is None and not depends else f"{verdict}{said}"
    ticks = np.unique(x).tolist() if two else None
    picture = plot.drawn(f"Residuals against {covariate.label}", (covariate.label, "mm"), *children, ticks=ticks)
    return element("figure", picture, element("figcaption", text(caption), class_="strong" if depends else None))


_CURVE_HEIGHT, _POINTS = 130.0, 400


def joint_curves(diagnosis: Diagnosis) -> str:
    """A small plot for each joint whose angle errs by a curve; nothing where none does."""
    single = [finding for finding in diagnosis.findings if finding.effect in EFFECTS and len(finding.at) == 1]
    curves = [(item, EFFECTS[item.effect].drive.curve) for item in single]
    panels = [_curve_panel(diagnosis, item, curve) for item, curve in curves if curve is not None]
    if not panels:
        return ""
    heading = element("h3", text("How joints err over their travel"))
    return heading + element("div", *panels, class_="multiples")


def _curve_panel(diagnosis: Diagnosis, finding: Finding, curve: Callable[[Scalar, Mapping[str, float]], Scalar]) -> str:
    joint = finding.at[0]
    travelled = diagnosis.recording.q[:, joint - 1]
    angle = np.linspace(travelled.min(), travelled.max(), _POINTS)
    values = {fitted.parameter: fitted.value for fitted in finding.parameters}
    error = 1e3 * np.asarray(curve(angle, values), dtype=float)
    across = (float(np.degrees(angle[0])), float(np.degrees(angle[-1])))
    plot = Plot(_WIDTH, _CURVE_HEIGHT, across, spanned(error))
    about = f"Error of joint {joint} over its travel, within {np.abs(error).max():.2g} mrad."
    drawn = course(plot.x(np.degrees(angle)), plot.y(error), "after")
    return plot.drawn(about, (f"joint {joint} in degrees", "error in mrad"), drawn)
