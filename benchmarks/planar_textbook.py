"""The same planar arm straight from the textbook: each formula as it is printed, nothing folded, nothing wasted.

Per link, a cantilever in the plane: n (F L^3/3 + M L^2/2 + w L^4/8)/EI and u (N L + w_a L^2/2)/EA at its end, whose
slope (F L^2/2 + M L + w L^3/6)/EI turns what follows; per joint, tau/K turns all that it carries.
"""

from __future__ import annotations

import casadi as ca

from benchmarks.planar_by_hand import PlanarArm


def planar_error_textbook(q: ca.SX, arm: PlanarArm) -> ca.SX:
    """Displacement of the tip in m, an SX column of 2, at the joint angles `q` in rad."""
    joints = q.numel()
    cosine, sine = [], []
    x, y = [0], [0]
    phi = 0
    for i in range(joints):
        phi = phi + q[i]
        cosine.append(ca.cos(phi))
        sine.append(ca.sin(phi))
        x.append(x[i] + arm.length[i] * cosine[i])
        y.append(y[i] + arm.length[i] * sine[i])

    error_x, error_y = 0, 0
    beyond, moment = arm.payload, 0  # the weight behind a link's end, and its moment about that end
    for i in reversed(range(joints)):
        c, s, L, EI, EA = cosine[i], sine[i], arm.length[i], arm.EI[i], arm.EA[i]
        F, w = -beyond * c, -arm.weight[i] * c
        N, a = -beyond * s, -arm.weight[i] * s
        bent = (F * L**3 / 3 + moment * L**2 / 2 + w * L**4 / 8) / EI
        slope = (F * L**2 / 2 + moment * L + w * L**3 / 6) / EI
        stretched = (N * L + a * L**2 / 2) / EA
        error_x += -bent * s + stretched * c - slope * (y[joints] - y[i + 1])
        error_y += bent * c + stretched * s + slope * (x[joints] - x[i + 1])

        moment = moment + F * L + w * L**2 / 2
        beyond = beyond + arm.weight[i] * L
        turn = moment / arm.K[i]
        error_x += -turn * (y[joints] - y[i])
        error_y += turn * (x[joints] - x[i])
    return ca.vertcat(error_x, error_y)
