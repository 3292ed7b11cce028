"""Lost motion with a memory: the play operator that follows the path of visits, and pins in their bores."""

from __future__ import annotations

import numpy as np

from benchmarks.blind.generator.vectors import Array, dot


def play_path(motor: Array, width: Array, start: float = 0.0) -> Array:
    """Where the output stands along a path of motor positions: it stays until the play, `width` in all, is used up.

    x_k = max(min(x_{k-1}, u_k + w/2), u_k - w/2): A. Visintin, Differential Models of Hysteresis (1994), ch. III.
    Returns output less motor at each point; `start` is that of the first point before it moves.
    """
    out = np.empty_like(motor)
    position = motor[0] + start
    for k in range(motor.size):
        half = 0.5 * width[k]
        position = max(min(position, motor[k] + half), motor[k] - half)
        out[k] = position - motor[k]
    return out


def approached(q: Array, side: Array, width: Array, run_up: float, fresh: Array) -> Array:
    """Held lost motion at each visit of one joint that comes to q from q - side * run_up.

    `fresh` marks rows for which the joint moves; at the others it stands as it stood. Output less motor, (m,).
    """
    path, widths, reads = [q[0] - side[0] * run_up], [width[0]], []
    for k in range(q.size):
        if fresh[k]:
            path.append(q[k] - side[k] * run_up)
            widths.append(width[k])
        path.append(q[k])
        widths.append(width[k])
        reads.append(len(path) - 1)
    return play_path(np.array(path), np.array(widths))[np.array(reads)]


def backlash(
    q: Array, side: Array, torque: Array, total: float, held_below: float, run_up: float, fresh: Array
) -> Array:
    """Displacement of one joint by its backlash: seated by the load, or held by friction where the load is small."""
    held = approached(q, side, np.full(q.size, total), run_up, fresh)
    seated = 0.5 * total * np.sign(torque)
    return np.where(np.abs(torque) < held_below, held, seated)


def pressed(force: Array, axis: Array, radius: float) -> Array:
    """Where a pin rests that `force` (3, m) presses into its bore: radius along the force, across the axis."""
    across = force - axis * dot(axis, force)
    size = np.sqrt(dot(across, across))
    return radius * across / np.where(size > 1e-9, size, np.inf)
