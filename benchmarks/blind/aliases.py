"""Which effects a recording cannot tell apart: canonical correlations of signatures on its own rows.

Every candidate (effect, place) spans the columns of its signature; what the nuisances explain is projected out, and the
correlation of the concealed signature with a candidate's span is the cosine of the angle between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.blind.generator.concealed import Effect, Scene, departure
from benchmarks.blind.generator.perturbation import Response, first_order
from benchmarks.blind.generator.vectors import Array

ALIAS = 0.98


@dataclass(frozen=True)
class Candidate:
    """An effect at a place, as one or more spans of signature columns (several where it has non-linear constants)."""

    effect: str
    at: tuple[int, ...]
    spans: tuple[Array, ...]  # each (rows * axes, columns)


def signature(effect: Effect, scene: Scene, response: Response) -> Array:
    """First-order signature of an effect on the readings, (3, m), in m."""
    if effect.effect == "slope_propagation":
        return response.slope.sum(axis=0)
    if effect.effect == "shear_deformation":
        return response.shear
    return first_order(response, departure(effect, scene))


def flat(vectors: Array, planar: bool) -> Array:
    """(3, m) as one column of the measured axes."""
    return vectors[: 2 if planar else 3].reshape(-1)


def frame_columns(scene: Scene) -> list[Array]:
    """Shifts and rotations of the measuring frame."""
    tip = scene.solution.tip
    columns = []
    for axis in range(2 if scene.arm.planar else 3):
        shift = np.zeros_like(tip)
        shift[axis] = 1.0
        columns.append(shift)
    for axis in (2,) if scene.arm.planar else (0, 1, 2):
        unit = np.zeros(3)
        unit[axis] = 1.0
        columns.append(np.cross(unit, tip.T).T)
    return columns


def geometry_columns(scene: Scene, response: Response) -> list[Array]:
    """Frame, encoder offsets, link lengths, tool."""
    arm, rotation = scene.arm, response.nominal.rotation
    tool = [rotation[:, axis] for axis in range(2 if arm.planar else 3)]
    return [*frame_columns(scene), *response.joint, *response.axial, *tool]


def basis(columns: list[Array], planar: bool) -> Array:
    """Orthonormal columns of the span; exact dependences dropped."""
    if not columns:
        return np.zeros((0, 0))
    return orthonormal(np.stack([flat(c, planar) for c in columns], axis=1))


def orthonormal(matrix: Array, least: float = 0.0, tolerance: float = 1e-7) -> Array:
    """Orthonormal basis of the columns' span, by a relative rank tolerance; columns no longer than `least` are none."""
    size = np.linalg.norm(matrix, axis=0)
    kept = matrix[:, size > least] / size[size > least]
    if kept.shape[1] == 0:
        return kept
    u, s, _ = np.linalg.svd(kept, full_matrices=False)
    return u[:, s > tolerance * s[0]]


def without(matrix: Array, nuisance: Array) -> Array:
    """Projected off the nuisance's orthonormal columns."""
    return matrix if nuisance.size == 0 else matrix - nuisance @ (nuisance.T @ matrix)


def _one(name: str, at: tuple[int, ...], **parameters: float) -> Effect:
    return Effect(name, at, "", dict(parameters))


def _lags(truth: list[Effect]) -> list[float]:
    own = [e.parameters["lag"] for e in truth if "lag" in e.parameters]
    return sorted({0.0, 1800.0, 3600.0, 7200.0, *own})


def _joint_spans(scene: Scene, i: int, truth: list[Effect]) -> dict[str, list[list[Effect]]]:
    at = (i + 1,)
    spans: dict[str, list[list[Effect]]] = {
        "encoder_offset": [[_one("encoder_offset", at, offset=1e-4)]],
        "encoder_scale": [[_one("encoder_scale", at, scale=1e-4)]],
        "encoder_eccentricity": [
            [_one("encoder_eccentricity", at, sine=a, cosine=b) for a, b in ((1e-4, 0.0), (0.0, 1e-4))]
        ],
    }
    if scene.arm.joints[i].prismatic:
        return {name: spans[name] for name in ("encoder_offset", "encoder_scale")}
    own = {round(e.parameters["harmonic"]) for e in truth if "harmonic" in e.parameters}
    spans["gear_transmission_error"] = [
        [_one("gear_transmission_error", at, harmonic=k, sine=a, cosine=b) for a, b in ((1e-4, 0.0), (0.0, 1e-4))]
        for k in sorted({2, 3, 4, 5, 6, 8, 10} | own)
    ]
    if i == 2:
        spans["joint_coupling"] = [[_one("joint_coupling", at, ratio=1e-4)]]
    spans |= _of_loads(scene, i, truth)
    spans["gearbox_thermal"] = [[_one("gearbox_thermal", at, rate=1e-6, lag=lag)] for lag in _lags(truth)]
    if np.abs(scene.design.force).max() > 0.0:
        spans["clearance"] = [[_one("clearance", at, radius=1e-5)]]
    return spans


def _of_loads(scene: Scene, i: int, truth: list[Effect]) -> dict[str, list[list[Effect]]]:
    """What a drive does under its load."""
    at, load = (i + 1,), np.abs(scene.solution.torque[i])
    spans: dict[str, list[list[Effect]]] = {}
    if float(load.max()) > 0.05:
        spans["joint_compliance"] = [[_one("joint_compliance", at, compliance=1e-6)]]
        spans["servo_droop"] = [[_one("servo_droop", at, compliance=1e-6)]]
        knees = [float(load.max()) * share for share in (0.2, 0.4, 0.8)]
        spans["joint_hardening"] = [
            [_one("joint_hardening", at, compliance=1e-6, knee=k, zones=z)] for k in knees for z in (0.0, 1.0)
        ]
        times = {1800.0, 5400.0} | {e.parameters["time"] for e in truth if "time" in e.parameters}
        spans["creep"] = [[_one("creep", at, compliance=1e-6, time=t)] for t in sorted(times)]
        if i == 1 and scene.arm.joints[i].compliance > 0.0:
            spans["counterbalance"] = [
                [_one("counterbalance", at, spring=100.0, phase=phase) for phase in (0.0, np.pi / 2)]
            ]
    holds = {0.0, 1e9} | {e.parameters["held_below"] for e in truth if "held_below" in e.parameters}
    spans["backlash"] = [[_one("backlash", at, total=1e-4, held_below=h)] for h in sorted(holds)]
    small = 1e-5 / max(float(load.max()), 1.0)
    spans["friction_windup"] = [
        [
            _one("friction_windup", at, coulomb=1e-5, proportional=0.0),
            _one("friction_windup", at, coulomb=0.0, proportional=small),
        ]
    ]
    return spans


def _link_spans(scene: Scene, i: int, truth: list[Effect]) -> dict[str, list[list[Effect]]]:
    at, link = (i + 1,), scene.arm.links[i]
    spans: dict[str, list[list[Effect]]] = {"link_length": [[_one("link_length", at, length=1e-4)]]}
    spans["link_mass"] = [[_one("link_mass", at, mass=1.0)]]
    if link.section is None:
        spans["link_bending"] = [[_one("link_bending", at, flexibility=1e-6)]]
    else:
        spans["link_modulus"] = [[_one("link_modulus", at, softness=0.01)]]
    spans["thermal_expansion"] = [[_one("thermal_expansion", at, expansion=1e-5, lag=lag)] for lag in _lags(truth)]
    spans["thermal_bending"] = [[_one("thermal_bending", at, gradient=0.1, lag=lag)] for lag in _lags(truth)]
    return spans


def _whole_spans(scene: Scene, truth: list[Effect]) -> dict[str, list[list[Effect]]]:
    arm = scene.arm
    every = tuple(range(1, arm.count + 1))
    axes = "ab" if arm.planar else "abc"
    tilts = "z" if arm.planar else "xy"
    still = {"x": 0.0, "y": 0.0, "z": 0.0}
    ways = [{**still, "rotation": 0.0, k: 1e-4} for k in (("x", "y") if arm.planar else ("x", "y", "z"))]
    ways.append({**still, "rotation": 1e-4})
    spans: dict[str, list[list[Effect]]] = {
        "payload": [[_one("payload", (), mass=0.1)]],
        "tool_offset": [[_one("tool_offset", (), **({"a": 0.0, "b": 0.0, "c": 0.0} | {k: 1e-4})) for k in axes]],
        "base_tilt": [[_one("base_tilt", (), **(still | {k: 1e-3})) for k in tilts]],
        "frame_drift": [[_one("frame_drift", (), **way) for way in ways]],
        "instrument_scale": [[_one("instrument_scale", (), scale=1e-4)]],
    }
    if not scene.design.frame_free:
        spans["frame_misalignment"] = [[_one("frame_misalignment", (), **way) for way in ways]]
    if arm.planar and not arm.joints[0].prismatic:
        spans["base_compliance"] = [[_one("base_compliance", (), compliance=1e-6)]]
    if np.abs(scene.design.speed).max() > 0.0:
        spans["latency"] = [[_one("latency", (), delay=1e-3)]]
    spans["thermal_expansion@all"] = [
        [_one("thermal_expansion", every, expansion=1e-5, lag=lag)] for lag in _lags(truth)
    ]
    return spans


def candidates(scene: Scene, response: Response, truth: list[Effect]) -> list[Candidate]:
    """Every effect at every place, with the signature columns of this recording."""
    arm = scene.arm
    every = tuple(range(1, arm.count + 1))
    groups: list[tuple[str, tuple[int, ...], list[list[Effect]]]] = []
    for i in range(arm.count):
        for name, spans in {**_joint_spans(scene, i, truth), **_link_spans(scene, i, truth)}.items():
            groups.append((name, (i + 1,), spans))
    for name, spans in _whole_spans(scene, truth).items():
        groups.append((name.removesuffix("@all"), every if name.endswith("@all") else (), spans))
    results = []
    for name, at, spans in groups:
        matrices = [np.stack([flat(signature(e, scene, response), arm.planar) for e in span], axis=1) for span in spans]
        results.append(Candidate(name, at, tuple(matrices)))
    proportional = response.axial.sum(axis=0)
    results.append(Candidate("link_length", every, (flat(proportional, arm.planar)[:, None],)))
    by_key = {(c.effect, c.at): c for c in results}
    for i in range(1, arm.count):
        pair = [by_key.get(("gearbox_thermal", (k,))) for k in (i, i + 1)]
        if pair[0] is not None and pair[1] is not None:
            both = tuple(np.hstack(two) for two in zip(pair[0].spans, pair[1].spans, strict=True))
            results.append(Candidate("gearbox_thermal", (i, i + 1), both))
    return results


def correlations(concealed: Array, found: list[Candidate], nuisance: Array) -> list[tuple[float, Candidate]]:
    """Cosine between the concealed signature (flat) and each candidate's span, the nuisance projected out."""
    left = without(concealed[:, None], nuisance)[:, 0]
    size = float(np.linalg.norm(left))
    if size < 1e-6 * max(float(np.linalg.norm(concealed)), 1e-30):
        return []
    result = []
    for candidate in found:
        best = 0.0
        for span in candidate.spans:
            rest = without(span, nuisance)
            live = np.linalg.norm(rest, axis=0) > 1e-6 * np.maximum(np.linalg.norm(span, axis=0), 1e-30)
            if live.any():
                best = max(best, float(np.linalg.norm(orthonormal(rest[:, live]).T @ left)) / size)
        result.append((best, candidate))
    return sorted(result, key=lambda pair: -pair[0])


def beyond(concealed: Array, found: list[Candidate], nuisance: Array, groups: int = 3) -> Array:
    """What is left of a signature after the nuisance and the `groups` candidates that explain most, one by one."""
    left = without(concealed[:, None], nuisance)
    taken = nuisance
    for _ in range(groups):
        best: tuple[float, Array] = (0.0, left)
        for candidate in found:
            for span in candidate.spans:
                own = orthonormal(without(span, taken))
                won = float(np.linalg.norm(own.T @ left)) if own.size else 0.0
                if won > best[0]:
                    best = (won, own)
        if best[0] == 0.0:
            break
        taken = np.hstack([taken, best[1]]) if taken.size else best[1]
        left = without(left, best[1])
    return left[:, 0]
