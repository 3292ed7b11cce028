"""A planar arm's position error, written by hand for the plane: what the general code is measured against.

Joint i carries link i; gravity pulls along -y.  Link i points along u = (cos phi, sin phi), n is u turned
by +90 degrees.  Behind its end hangs the weight P (payload and all further links), with the moment M about
that end.  Its own weight is w per length.  Then its end moves by

    n (F L^3/3 + M L^2/2 + f L^4/8)/EI + u (N L + a L^2/2)/EA,    F, N and f, a: P and w along n and u,

and turns by (F L^2/2 + M L + f L^3/6)/EI; the joint turns by the torque of all it carries, over K.  The tip
moves by the sum of it all, every turn with the lever from where it happens to the tip.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class PlanarArm:
    """Design of a planar arm, a value per link (or joint), as numbers or as the entries of an SX column.

    Bending stiffness EI in N m^2, axial stiffness EA in N, weight in N/m, length in m, joint stiffness K in
    N m/rad, weight of the payload in N.
    """

    EI: Any
    EA: Any
    weight: Any
    length: Any
    K: Any
    payload: Any


EXAMPLE = PlanarArm(
    EI=(4.0e5, 9.0e4, 1.2e4),
    EA=(3.0e8, 1.6e8, 6.0e7),
    weight=(190.0, 95.0, 38.0),
    length=(0.85, 0.75, 0.30),
    K=(1.1e6, 4.0e5, 9.0e4),
    payload=147.0,
)


def planar_symbols(joints: int) -> tuple[ca.SX, PlanarArm, list[ca.SX]]:
    """Joint angles and a design of symbols, and all of them as a list of input columns."""
    q = ca.SX.sym("q", joints)
    columns = [ca.SX.sym(name, joints) for name in ("EI", "EA", "weight", "length", "K")]
    payload = ca.SX.sym("payload")
    return q, PlanarArm(*columns, payload), [q, *columns, payload]


def planar_error_sx(q: ca.SX, arm: PlanarArm) -> ca.SX:
    """Displacement of the tip in m, an SX column of 2, at the joint angles `q` in rad."""
    joints = q.numel()
    phi, total = [], 0
    for i in range(joints):
        total = total + q[i]
        phi.append(total)

    load, moment = arm.payload, 0
    lever_x, lever_y = 0, 0
    error_x, error_y = 0, 0
    for i in reversed(range(joints)):
        c, s = ca.cos(phi[i]), ca.sin(phi[i])
        length, weight = arm.length[i], arm.weight[i]
        own = weight * length
        across = c * length * length * (load / 3 + own / 8) - moment * length / 2
        across = -across * length / arm.EI[i]
        along = -s * length * (load + own / 2) / arm.EA[i]
        slope = (moment - c * length * (load / 2 + own / 6)) * length / arm.EI[i]
        error_x += along * c - across * s - slope * lever_y
        error_y += along * s + across * c + slope * lever_x

        moment -= c * length * (load + own / 2)
        load += own
        lever_x += length * c
        lever_y += length * s
        turn = moment / arm.K[i]
        error_x -= turn * lever_y
        error_y += turn * lever_x
    return ca.vertcat(error_x, error_y)


def planar_error_numpy(q: Array, arm: PlanarArm, block: int = 2048, half_angle: bool = False) -> Array:
    """Size of the displacement of the tip in m, shape (N,), at the joint angles `q`, shape (N, joints).

    As one would write it for speed: constants of the design folded first, blocks of rows that stay in the
    cache, every step into a buffer that is there already.  With `half_angle`, sine and cosine come from one
    tangent of half the angle, which is quicker where NumPy's tangent is vectorised and its sine is not.
    """
    rows, joints = q.shape
    links = _folded(arm, joints)
    size = np.empty(rows)
    buffers = [np.empty(block) for _ in range(11)]
    cosines, sines = np.empty((joints, block)), np.empty((joints, block))
    angles = np.empty((joints, block))
    for start in range(0, rows, block):
        stop = min(start + block, rows)
        count = stop - start
        t, v, across, along, slope, moment, lever_x, lever_y, error_x, error_y, turn = (
            buffer[:count] for buffer in buffers
        )
        phi, cosine, sine = angles[:, :count], cosines[:, :count], sines[:, :count]
        np.copyto(phi, q[start:stop].T)
        for i in range(1, joints):
            np.add(phi[i], phi[i - 1], out=phi[i])
        if half_angle:
            np.multiply(phi, 0.5, out=phi)
            np.tan(phi, out=phi)
            np.multiply(phi, phi, out=cosine)
            np.add(cosine, 1.0, out=cosine)
            np.divide(2.0, cosine, out=cosine)
            np.multiply(cosine, phi, out=sine)
            np.subtract(cosine, 1.0, out=cosine)
        else:
            np.cos(phi, out=cosine)
            np.sin(phi, out=sine)
        for i in reversed(range(joints)):
            c, s = cosine[i], sine[i]
            length, bend_load, bend_moment, stretch, turn_load, turn_moment, torque, flexibility = links[i]
            last = i == joints - 1
            np.multiply(c, bend_load, out=across)
            np.multiply(s, stretch, out=along)
            np.multiply(c, turn_load, out=slope)
            if last:
                np.multiply(along, c, out=error_x)
                np.multiply(across, s, out=t)
                np.subtract(error_x, t, out=error_x)
                np.multiply(along, s, out=error_y)
            else:
                np.multiply(moment, bend_moment, out=t)
                np.add(across, t, out=across)
                np.multiply(moment, turn_moment, out=t)
                np.add(slope, t, out=slope)
                np.multiply(along, c, out=t)
                np.add(error_x, t, out=error_x)
                np.multiply(across, s, out=t)
                np.subtract(error_x, t, out=error_x)
                np.multiply(slope, lever_y, out=t)
                np.subtract(error_x, t, out=error_x)
                np.multiply(along, s, out=t)
                np.add(error_y, t, out=error_y)
                np.multiply(slope, lever_x, out=t)
                np.add(error_y, t, out=error_y)
            np.multiply(across, c, out=t)
            np.add(error_y, t, out=error_y)
            if last:
                np.multiply(c, torque, out=moment)
                np.multiply(c, length, out=lever_x)
                np.multiply(s, length, out=lever_y)
            else:
                np.multiply(c, torque, out=t)
                np.add(moment, t, out=moment)
                np.multiply(c, length, out=t)
                np.add(lever_x, t, out=lever_x)
                np.multiply(s, length, out=t)
                np.add(lever_y, t, out=lever_y)
            np.multiply(moment, flexibility, out=turn)
            np.multiply(turn, lever_y, out=t)
            np.subtract(error_x, t, out=error_x)
            np.multiply(turn, lever_x, out=v)
            np.add(error_y, v, out=error_y)
        np.multiply(error_x, error_x, out=t)
        np.multiply(error_y, error_y, out=v)
        np.add(t, v, out=t)
        np.sqrt(t, out=size[start:stop])
    return size


def _folded(arm: PlanarArm, joints: int) -> list[tuple[float, ...]]:
    """What depends on the design only, per link: the factors of cos phi, sin phi and the moment."""
    links: list[tuple[float, ...]] = []
    load = float(arm.payload)
    for i in reversed(range(joints)):
        L, w, EI, EA = arm.length[i], arm.weight[i], arm.EI[i], arm.EA[i]
        links.append(
            (
                L,
                -(load * L**3 / 3 + w * L**4 / 8) / EI,
                L**2 / (2 * EI),
                -(load * L + w * L**2 / 2) / EA,
                -(load * L**2 / 2 + w * L**3 / 6) / EI,
                L / EI,
                -L * (load + w * L / 2),
                1 / arm.K[i],
            )
        )
        load += w * L
    return links[::-1]
