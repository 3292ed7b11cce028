"""How many instructions the planar 3R error takes: our general spatial code against code written for the plane.

All sides have the same inputs (joint angles; per link EI, EA, weight per length, length and drive stiffness; the
payload's weight), the same two outputs and the same physics. Gravity is 1 along -y here, so that a mass is a weight.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from benchmarks.planar_by_hand import PlanarArm, planar_error_sx, planar_symbols
from benchmarks.planar_textbook import planar_error_textbook
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.tip import active_effects, tip_error

TARGET = 0.9
AGREEMENT = 1e-12
JOINTS = 3


def general_error_sx(q: ca.SX, arm: PlanarArm) -> ca.SX:
    """The same error by the general code: chains in space with any axes, of which this one happens to be planar."""
    general = Arm(
        "planar",
        joints=tuple(Joint(stiffness=arm.K[i]) for i in range(JOINTS)),
        links=tuple(Link(0.0) for _ in range(JOINTS)),
        gravity=(0.0, -1.0, 0.0),
        leave_out=frozenset({"shear_deformation", "torsion"}),
    )
    beams = [
        Beam(
            length=arm.length[i],
            mass_per_length=arm.weight[i],
            axial_rigidity=arm.EA[i],
            flexural_rigidity_height=arm.EI[i],
            flexural_rigidity_width=arm.EI[i],
        )
        for i in range(JOINTS)
    ]
    state = solve(general, parts(q), beams, payload_mass=arm.payload)
    x, y, z = tip_error(state, active_effects(general)).vector
    if not (isinstance(z, float) and z == 0.0):
        raise SystemExit("the general code moves a planar arm out of its plane")
    return ca.vertcat(x, y)


def symbolic_size() -> list[str]:
    """Compare, print, and return the targets missed."""
    q, arm, inputs = planar_symbols(JOINTS)
    sides = {
        "general spatial code": general_error_sx(q, arm),
        "written for the plane, textbook formulas": planar_error_textbook(q, arm),
        "written for the plane, Horner form": planar_error_sx(q, arm),
    }
    functions = {name: ca.Function("error", inputs, [error]) for name, error in sides.items()}
    _agree(functions)
    print(f"instructions of the planar {JOINTS}R error (inputs and outputs counted; without and with ca.cse)")
    counts = {name: function.n_instructions() for name, function in functions.items()}
    fewer = {name: ca.Function("error", inputs, [ca.cse(error)]).n_instructions() for name, error in sides.items()}
    for name, count in counts.items():
        print(f"  {name:44}{count:6d}{fewer[name]:6d}")
    ours, textbook, horner = counts.values()
    print(f"  ratio to the textbook's (the target's): {ours / textbook:.3f}, at most {TARGET} is asked for")
    print(f"  ratio to the Horner form's:             {ours / horner:.3f}")
    return [] if ours / textbook <= TARGET else [f"symbolic size: {ours / textbook:.3f} instead of {TARGET}"]


def _agree(functions: dict[str, ca.Function]) -> None:
    generator = np.random.default_rng(2)
    for _ in range(20):
        values = [
            generator.uniform(-np.pi, np.pi, JOINTS),
            generator.uniform(1e4, 5e5, JOINTS),
            generator.uniform(5e7, 3e8, JOINTS),
            generator.uniform(30.0, 200.0, JOINTS),
            generator.uniform(0.2, 0.9, JOINTS),
            generator.uniform(5e4, 1e6, JOINTS),
            generator.uniform(10.0, 200.0),
        ]
        found = [np.array(function(*values)).ravel() for function in functions.values()]
        for other in found[1:]:
            off = np.abs(other - found[0]).max() / np.abs(found[0]).max()
            if not off <= AGREEMENT:
                raise SystemExit(f"the sides disagree by {off:.1e} (relative): there is nothing to compare")


if __name__ == "__main__":
    raise SystemExit("\n".join(symbolic_size()) or 0)
