"""What a camera's readings say of the camera itself: its scatter, its focal length, what its frames take up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.terms import Term
from linkwright.core.diagnose.instruments.camera import DEPTHS
from linkwright.core.diagnose.residual.noise import NoiseFloor
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity


def of_camera(prepared: Prepared, terms: Sequence[Term], noise: NoiseFloor) -> tuple[str, ...]:
    """Sentences on a camera; none of another instrument."""
    observed = prepared.observed
    if observed.sight is None:
        return ()
    frames = [item for item in ("frame", "tool") if getattr(observed.recording, item) == "free"]
    sentences: list[str] = []
    if frames:
        what = "both the camera and the target are" if len(frames) > 1 else "one of camera and target is"
        taken = "Whatever moves the base or the tool as a whole cannot be told apart from them"
        sentences.append(f"Nobody knows where {what}. Six numbers each are fitted along. {taken}.")
    sentences += _scatter(observed, noise)
    return (*sentences, *_depths(prepared, terms))


def turn_scatter(observed: Observed) -> tuple[float, int]:
    """By how much turns of one visit differ about each axis (rad, RMS), and the degrees of freedom of that."""
    turned = observed.residual[:, observed.turn_columns]
    visit = np.unique(observed.block, return_inverse=True)[1].reshape(-1)
    count = np.bincount(visit)
    means = np.stack([np.bincount(visit, weights=column) / count for column in turned.T], axis=1)
    freedom = int(np.sum(count - 1)) * turned.shape[1]
    return (float(np.sqrt(np.sum((turned - means[visit]) ** 2) / freedom)) if freedom else 0.0), freedom


def _scatter(observed: Observed, noise: NoiseFloor) -> list[str]:
    sentences: list[str] = []
    if noise.sigma is not None and len(noise.sigma) == 3:
        across = format_quantity(float(np.hypot(*noise.sigma[:2])) / np.sqrt(2.0), "length", digits=2)
        deep = format_quantity(noise.sigma[2], "length", digits=2)
        sentences.append(
            f"The camera scatters by {across} across its view and by {deep} in depth. Each has its own weight."
        )
    if not observed.has_turns:
        return sentences
    scatter, freedom = turn_scatter(observed)
    declared, rules = observed.recording.sigma_angle, observed.rules.residual
    if freedom >= rules.enough_freedom and scatter > 0.0:
        angle = format_quantity(scatter, "angle", digits=2)
        sentences.append(f"Its turns scatter by {angle} about each axis.")
        # The standard error of a standard deviation.
        if declared is not None and abs(scatter / declared - 1.0) > rules.torque_sure / np.sqrt(2.0 * freedom):
            declared_text = format_quantity(declared, "angle", digits=2)
            sentences[-1] += f" Declared are {declared_text} (sigma_angle): chance does not explain the difference."
    return sentences


def _depths(prepared: Prepared, terms: Sequence[Term]) -> list[str]:
    """How much too long depths are read, where that is beyond doubt."""
    observed, sight = prepared.observed, prepared.observed.sight
    if sight is None or DEPTHS not in prepared.beside_names:
        return []  # of several cameras each has depths of its own
    at = prepared.beside_names.index(DEPTHS)
    columns = np.concatenate([prepared.beside, *(term.columns for term in terms)], axis=2)
    design, left = observed.whitened(columns), observed.whitened(observed.residual)
    value, error = _estimate(design, left, at)
    share = value + sight.depth
    if not error > 0.0 or abs(share) <= observed.rules.residual.torque_sure * error:
        return []
    low, high = (100.0 * (abs(share) + times * error) for times in (-1.96, 1.96))
    way = "long" if share > 0.0 else "short"
    return [
        f"Depths are read {100.0 * abs(share):.3g} % too {way} ({low:.3g} to {high:.3g} %). The focal length "
        "assumed for the camera is off by as much. This is fitted along."
    ]


def _estimate(design: Array, left: Array, at: int) -> tuple[float, float]:
    """One value of a least-squares fit and its standard error."""
    size = np.linalg.norm(design, axis=0)
    scaled = design / np.where(size > 0.0, size, 1.0)
    u, s, vt = np.linalg.svd(scaled, full_matrices=False)
    determined = s > 1e-9 * s[0]
    values = vt[determined].T @ ((u[:, determined].T @ left) / s[determined])
    freedom = max(len(left) - int(determined.sum()), 1)
    variance = float(np.sum((left - scaled @ values) ** 2)) / freedom
    spread = variance * float(np.sum((vt[determined][:, at] / s[determined]) ** 2))
    return float(values[at] / size[at]), float(np.sqrt(spread) / size[at])
