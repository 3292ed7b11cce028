"""Arms whose zeros and lengths are off, measured by chains of plain matrices: no code of the tool takes part."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

QUARTER = 0.5 * math.pi


@dataclass(frozen=True)
class Case:
    """An arm by its modified DH table (a, d, alpha, theta), or a planar one by its lengths (n,); what its zeros (rad)
    and lengths (m) are off by, (n,) each, and the noise (m) of its readings."""

    table: np.ndarray
    zeros: np.ndarray
    longer: np.ndarray
    sigma: float
    tool_free: bool
    weighed: bool
    poses: int

    @property
    def planar(self):
        return self.table.ndim == 1

    @property
    def off(self):
        """(effect, joint or link from 1) of all that is off."""
        results = [("encoder_offset", k + 1) for k in np.flatnonzero(self.zeros)]
        return results + [("link_length", k + 1) for k in np.flatnonzero(self.longer)]


def lengths_of(table):
    """Of each link, the a or d before the next joint."""
    if table.ndim == 1:
        return table
    return np.append(np.hypot(table[1:, 0], table[1:, 1]), 0.0)


def tables(rng):
    """A shoulder set off with a spherical wrist, one with three parallel joints, one with all axes meeting."""
    base, up, fore, wrist = (rng.uniform(*ends) for ends in ((0.1, 0.4), (0.25, 0.6), (0.2, 0.5), (0.05, 0.12)))
    q, shoulder = QUARTER, rng.uniform(0.05, 0.15)
    spherical = [[up, 0, 0, 0], [0, fore, -q, 0], [0, 0, q, 0], [0, wrist, -q, 0]]
    return (
        [[0, base, 0, 0], [shoulder, 0, -q, -q], *spherical],
        [[0, base, 0, 0], [0, 0, q, 0], [-up, 0, 0, 0], [-fore, 0, 0, 0], [0, wrist, q, 0], [0, 0.9 * wrist, -q, 0]],
        [[0, base, 0, 0], [0, 0, -q, -q], *spherical],
    )


def drawn(seed):
    """One to four zeros off by 0.1 to 15 deg, lengths by about 1 % in most arms, noise of 0.05 to 0.65 mm."""
    rng = np.random.default_rng([seed, 77])
    count = int(rng.integers(3, 5))
    table = rng.uniform(0.2, 0.6, count) if seed % 2 == 0 else np.array(tables(rng)[int(rng.integers(3))])
    lengths, size = lengths_of(table), len(table)
    tool_free = bool(rng.random() < 0.5)
    # A free frame takes up the zero of the first joint, and a free tool that of the last.
    able = np.arange(1, size - 1 if tool_free else size)
    zeros = np.zeros(size)
    for k in rng.choice(able, int(rng.integers(1, min(4, len(able)) + 1)), replace=False):
        zeros[k] = math.radians(math.exp(rng.uniform(math.log(0.1), math.log(15.0)))) * rng.choice([-1, 1])
    sign = rng.choice([-1.0, 1.0], size)
    some = (rng.random(size) < 0.3) & (lengths > 0.03) & (rng.random() < 0.6)
    longer = np.where(some, lengths * rng.uniform(0.004, 0.015, size) * sign, 0.0)
    sigma = 1e-3 * math.exp(rng.uniform(math.log(0.05), math.log(0.65)))
    return Case(table, zeros, longer, sigma, tool_free, bool(rng.random() < 0.5), int(rng.integers(35, 70)))


def ends(case, q, zeros, longer):
    """Tips (N, D) and orientations (N, D, D) in the arm's own frame."""
    if case.planar:
        angles = np.cumsum(q + zeros, axis=1)
        tip = np.stack([np.cos(angles) @ (case.table + longer), np.sin(angles) @ (case.table + longer)], axis=1)
        return tip, Rotation.from_rotvec(np.outer(angles[:, -1], [0.0, 0.0, 1.0])).as_matrix()[:, :2, :2]
    turn, tip, lengths = Rotation.identity(len(q)), np.zeros((len(q), 3)), lengths_of(case.table)
    for k, (a, d, alpha, theta) in enumerate(case.table):
        more = 1.0 + longer[k - 1] / lengths[k - 1] if k and lengths[k - 1] > 0.0 else 1.0
        twist = Rotation.from_euler("x", alpha)
        tip = tip + turn.apply(more * (np.array([a, 0.0, 0.0]) + twist.apply([0.0, 0.0, d])))
        turn = turn * twist * Rotation.from_rotvec(np.outer(q[:, k] + theta + zeros[k], [0.0, 0.0, 1.0]))
    return tip, turn.as_matrix()


def sessions(case, seed):
    """Angles (rad) and measured tips (m), in a frame that nobody knows: poses read twice, and further ones once."""
    rng, size, width = np.random.default_rng([seed, 5]), len(case.zeros), 2 if case.planar else 3
    span = np.radians([80] * size if case.planar else [150, 80, 110, 150, 110, 170])
    tool = rng.normal(0.0, 0.03, width) if case.tool_free else np.zeros(width)
    turn, shift = Rotation.from_euler("z", 0.4).as_matrix()[:width, :width], rng.normal(0.0, 0.5, width)
    results = []
    for q in (np.repeat(rng.uniform(-span, span, (case.poses, size)), 2, axis=0), rng.uniform(-span, span, (80, size))):
        tip, axes = ends(case, q, case.zeros, case.longer)
        tip = (tip + axes @ tool) @ turn.T + shift
        results.append((q, tip + case.sigma * rng.standard_normal(tip.shape)))
    return results


def placed(case, tip, axes, seen):
    """What is left (N, D) once frame, and tool where it is free, are as they fit best: in turn, until they stay."""
    width = tip.shape[1]
    tool, left = np.zeros(width), np.zeros(tip.shape)
    for _ in range(60 if case.tool_free else 1):
        at = tip + axes @ tool
        middle, there = at.mean(axis=0), seen.mean(axis=0)
        u, _, vt = np.linalg.svd((at - middle).T @ (seen - there))
        proper = np.diag([*np.ones(width - 1), np.sign(np.linalg.det(u @ vt))])
        turn = vt.T @ proper @ u.T
        left = seen - there - (at - middle) @ turn.T
        design = np.concatenate([(turn @ axes).reshape(-1, width), np.tile(np.eye(width), (len(tip), 1))], axis=1)
        tool = tool + np.linalg.lstsq(design, left.reshape(-1), rcond=None)[0][:width]
    return left


def least_squares_with_the_true_set(case, fitted, further):
    """The RMS length (m) left of further readings by what is off, fitted by least squares; and how many standard errors
    each of it is beside all other zeros and lengths: what those could be instead, or what moves no tip, is not sure."""
    every = [(effect, k) for effect in ("encoder_offset", "link_length") for k in range(len(case.zeros))]
    which = [("encoder_offset", k) for k in np.flatnonzero(case.zeros)]
    which += [("link_length", k) for k in np.flatnonzero(case.longer)]
    true = np.array([(case.zeros if effect == "encoder_offset" else case.longer)[k] for effect, k in which])

    def left(values, names, q, seen):
        zeros, longer = np.zeros(len(case.zeros)), np.zeros(len(case.zeros))
        for (effect, k), value in zip(names, values, strict=True):
            (zeros if effect == "encoder_offset" else longer)[k] = value
        return placed(case, *ends(case, q, zeros, longer), seen).reshape(-1)

    result = least_squares(left, true, x_scale=np.abs(true), args=(which, *fitted), diff_step=1e-5)
    there = np.concatenate([case.zeros, case.longer])
    steps = 1e-6 * np.eye(len(every))
    slopes = [(left(there + step, every, *fitted) - left(there - step, every, *fitted)) / 2e-6 for step in steps]
    # A turn of a radian or a metre more is all that is known of each before.
    known = np.stack(slopes) @ np.stack(slopes).T / case.sigma**2 + np.eye(len(every))
    errors = dict(zip(every, np.sqrt(np.diag(np.linalg.inv(known))).tolist(), strict=True))
    rest = left(result.x, which, *further).reshape(len(further[1]), -1)
    told = {(name, int(k) + 1): abs(size) / errors[name, k] for (name, k), size in zip(which, true, strict=True)}
    return float(np.sqrt(np.mean(np.sum(rest**2, axis=1)))), told


def arm_file(case):
    """The arm as its file has it: nothing off, nothing gives."""
    down = "[0 m/s^2, -9.81 m/s^2, 0 m/s^2]" if case.planar else "[0 m/s^2, 0 m/s^2, -9.81 m/s^2]"
    lines = ["name: drawn", f"gravity: {down}", "payload: {mass: 0 kg}", "chain:"]
    for k, row in enumerate(case.table):
        mass = f"mass: {4.0 - 0.5 * k} kg" if case.weighed else "mass: unknown"
        lines.append("  - joint: {range: [-360 deg, 360 deg]}")
        if case.planar:
            lines.append(f"    link: {{length: {row:.12f} m, rigid: true, {mass}}}")
        else:
            a, d, alpha, theta = row
            lines.append(f"    dh: {{a: {a:.12f} m, d: {d:.12f} m, alpha: {math.degrees(alpha)} deg,")
            lines.append(f"         theta: {math.degrees(theta)} deg, convention: modified}}")
            lines.append(f"    link: {{rigid: true, {mass}}}")
    return "\n".join(lines) + "\n"
