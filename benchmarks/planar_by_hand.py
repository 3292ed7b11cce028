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
