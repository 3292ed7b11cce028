"""An arm and a recording on the stage: exact positions, signatures' sizes once geometry is projected out, doses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.blind import aliases
from benchmarks.blind.generator.concealed import UNIFORM, Effect, Scene, departure
from benchmarks.blind.generator.designs import Design, warmed
from benchmarks.blind.generator.draws import Recipe
from benchmarks.blind.generator.mechanics import Arm, nominal_inputs, solve, with_changes
from benchmarks.blind.generator.perturbation import Response, departed, nothing, respond
from benchmarks.blind.generator.vectors import Array

# Effects that are geometry themselves: of the nuisances only a free frame is projected out of them.
GEOMETRIC = frozenset({"encoder_offset", "link_length", "tool_offset", "frame_misalignment", "instrument_scale"})


def exact(arm: Arm, design: Design, effects: tuple[Effect, ...]) -> Array:
    """Positions of the point the tracker sees, (3, m), with all histories and deformations carried to the end."""
    inputs = nominal_inputs(arm, design.q, design.payload, design.force)
    solution = solve(arm, inputs, 3)
    if not effects:
        return solution.tip
    total = nothing(arm, design.time.size)
    for rounds in (2, 3):
        total = nothing(arm, design.time.size)
        for effect in effects:
            total = total.plus(departure(effect, Scene(arm, design, solution)))
        solution = solve(arm, departed(inputs, total), rounds)
    return solution.tip + total.reading


def nominal_without(arm: Arm, design: Design, effects: tuple[Effect, ...], response: Response) -> Array:
    """What the arm file's physics alone would give: exact, less what the file leaves out."""
    tip = exact(arm, design, ())
    for effect in effects:
        if effect.effect in UNIFORM:
            tip = tip - aliases.signature(effect, Scene(arm, design, response.nominal), response)
    return tip


def nonlinearity(arm: Arm, design: Design) -> float:
    """Greatest length (m) by which the nominal arm's exact deflection departs from first-order theory."""
    first = design.fresh > 0.0  # repeats stand in the same place
    inputs = nominal_inputs(arm, design.q[:, first], design.payload[first], design.force[:, first])
    tips: list[Array] = []
    for share in (0.0, 1e-3, 1.0):
        scaled = with_changes(inputs, gravity=inputs.gravity * share, force=inputs.force * share)
        tips.append(solve(arm, scaled, 3).tip)
    rest = (tips[2] - tips[0]) - (tips[1] - tips[0]) * 1e3
    return float(np.linalg.norm(rest, axis=0).max())


def stage(arm: Arm, design: Design) -> tuple[Scene, Response]:
    response = respond(arm, design.q, design.payload, design.force)
    return Scene(arm, design, response.nominal), response


def nuisance(scene: Scene, response: Response, geometric: bool) -> Array:
    if geometric:
        columns = aliases.frame_columns(scene) if scene.design.frame_free else []
    else:
        columns = aliases.geometry_columns(scene, response)
    return aliases.basis(columns, scene.arm.planar)


def projected_rms(change: Array, scene: Scene, response: Response, geometric: bool) -> tuple[float, float]:
    """RMS length per row of a change of readings, the nuisances projected out, and as it is; m."""
    column = aliases.flat(change, scene.arm.planar)
    left = aliases.without(column[:, None], nuisance(scene, response, geometric))
    rows = change.shape[1]
    return float(np.sqrt(np.sum(left**2) / rows)), float(np.sqrt(np.sum(column**2) / rows))


def dosed_to(
    effect: Effect, scene: Scene, response: Response, wanted: float, needs: Recipe
) -> tuple[Effect, Scene, float] | None:
    """The effect scaled to a projected RMS of `wanted` (m); None where geometry hides nearly all of it."""
    geometric = effect.effect in GEOMETRIC
    now, raw = projected_rms(aliases.signature(effect, scene, response), scene, response, geometric)
    if raw < 1e-9 or now < 0.03 * raw:
        return None
    factor = float(np.clip(wanted / now, needs.least, needs.greatest))
    if effect.effect in UNIFORM:
        return effect, scene, now
    if effect.effect == "link_modulus":
        softness = effect.parameters["softness"]
        factor = min(factor, (-0.28 if softness < 0 else 0.65) / softness)
    if effect.effect == "thermal_expansion":
        return effect, replace(scene, design=warmed(scene.design, factor)), now * factor
    return effect.dosed(factor), scene, now * factor


def alike(effects: list[Effect], scene: Scene, response: Response) -> bool:
    """Whether one of two effects is nearly a case of the other on this recording, whatever the other's sizes: no tool
    could name both."""
    plain = not any(effect.effect in GEOMETRIC for effect in effects)
    hidden = nuisance(scene, response, not plain)
    spans = {(c.effect, c.at): c for c in aliases.candidates(scene, response, effects)}
    for one, two in (effects, effects[::-1]):
        columns = [aliases.flat(aliases.signature(e, scene, response), scene.arm.planar) for e in (one, two)]
        own = aliases.Candidate(two.effect, two.at, (columns[1][:, None],))
        result = aliases.correlations(columns[0], [own, spans.get((two.effect, two.at), own)], hidden)
        if not result or result[0][0] > 0.9:
            return True
    return False
