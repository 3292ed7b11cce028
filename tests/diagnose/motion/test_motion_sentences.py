"""The plain answer of a diagnosis of motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.motion.result import Alternative, MotionFinding, OfJoint
from linkwright.core.diagnose.motion.sentences import answer
from linkwright.core.diagnose.result import FittedParameter


def finding(effect: str, at: int, name: str, kind: str, value: float, rms: float) -> MotionFinding:
    parameter = FittedParameter(f"{name}_{at}", name, (at,), kind, value, (0.9 * value, 1.1 * value))
    explained = tuple(rms * np.eye(3)[at - 1])
    return MotionFinding(effect, (at,), (parameter,), (), explained, (0.0, 0.0, 0.0), 100.0, 0.005, "", draws=199)


def test_what_is_said_to_be_friction_is_friction() -> None:
    """A link that is off more than any one joint rubs, though all of them together rub more: it stands beside friction,
    in whatever order they were found."""
    rubs = [finding("friction_coulomb", at, "torque", "torque", 5.0, 4.0) for at in (1, 2, 3)]
    link = finding("link_inertial", 3, "mass", "mass", 1.5, 4.5)
    joints = tuple(OfJoint(at, 5.0, 0.1, 0.1, 0.1, 0.01, (), 1.0) for at in (1, 2, 3))
    said = answer("named", [link, *rubs], None, joints)
    assert said.startswith("Friction is what the model lacks most: dry (Coulomb) friction at joints 1 to 3 (")
    assert "; beside it mass, centre and inertia of a link at link 3 (mass 1.5 kg). " in said
    alone = answer("named", rubs, None, joints)
    assert alone.startswith("Friction is what the model lacks most: dry (Coulomb) friction")
    assert "beside it" not in alone
    assert answer("named", [link, rubs[0]], None, joints).startswith(
        "The model lacks mass, centre and inertia of a link"
    )


def test_of_many_names_small_ones_are_counted_as_one() -> None:
    """Of five names two are small: they are no names in the answer; of four each is named."""
    rubs = [finding("friction_coulomb", at, "torque", "torque", 5.0, 4.0) for at in (1, 2, 3)]
    small = [
        replace(finding(effect, 1, "torque", "torque", 0.1, 0.1), small=True)
        for effect in ("torque_offset", "friction_asymmetry")
    ]
    joints = tuple(OfJoint(at, 5.0, 0.1, 0.1, 0.1, 0.01, (), 1.0) for at in (1, 2, 3))
    said = answer("named", [*rubs, *small], None, joints, together=(0.125, 0.0, 0.0))
    assert "(5 N*m, 5 N*m and 5 N*m); 2 small ones, together 0.12 N*m RMS. " in said
    assert "offset" not in said
    assert "offset" in answer("named", [*rubs, small[0]], None, joints, together=(0.1, 0.0, 0.0))


def test_what_logs_cannot_tell_from_a_name_is_said_beside_it() -> None:
    link = finding("link_inertial", 3, "mass", "mass", 1.5, 4.5)
    both = Alternative((("torque_offset", (2,)), ("friction_asymmetry", (2,))), 2.0)
    open_ = replace(link, alternatives=(Alternative((("payload", ()),), 0.5), both))
    joints = tuple(OfJoint(at, 5.0, 0.1, 0.1, 0.1, 0.01, (), 1.0) for at in (1, 2, 3))
    assert answer("alias_class", [open_], None, joints).endswith(
        " The data fit equally well: extra mass at the tip or offset of the torque's zero at joint 2 and friction that "
        "differs with the direction at joint 2, in place of mass, centre and inertia of a link at link 3."
    )
    assert "equally well" not in answer("named", [link], None, joints)
