"""Beside which terms that every drive has a cause counts: those that it varies, and at its own joints alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.motion.rigid import link_parameters
from linkwright.core.diagnose.motion.model.candidates import candidates
from linkwright.core.diagnose.motion.model.evidence import Member, system
from linkwright.core.diagnose.motion.model.products import products
from linkwright.core.diagnose.motion.model.rows import joint_rows, log_rows
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.rules.rules import RULES
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm

DRIVE = {"friction_coulomb", "friction_viscous", "torque_offset", "armature"}


def test_a_cause_counts_beside_the_plain_terms_that_it_varies(tmp_path: Path) -> None:
    arm = plumb_arm(tmp_path)
    log = logged(1, lambda time: np.full(len(time), HAND), lambda q, _: np.zeros_like(q))
    prepared = prepare(arm, log, rules=RULES)
    effects = [effect for effect in (EFFECTS[name] for name in EFFECTS) if effect.torques is not None]
    pool = candidates(arm, effects, prepared.motion, link_parameters(arm), 0.0, rules=RULES)
    made = products(joint_rows([log_rows(prepared, pool, rules=RULES)]), pool.width, near=False)
    all_ = system(pool, made, np.ones(2), np.zeros(pool.width))

    def beside(
        effect: str, at: tuple[int, ...], *, members: tuple[Member, ...] = ()
    ) -> set[tuple[str, tuple[int, ...]]]:
        number = next(
            k
            for k, group in enumerate(pool.groups)
            if (group.effect.id, group.at) == (effect, at) and not group.nuisance
        )
        terms = all_.plain_beside(number, members)
        return {(pool.groups[term.group].effect.id, pool.groups[term.group].at) for term in terms}

    for effect in ("friction_quadratic", "friction_stribeck", "friction_place", "spring", "torque_constant"):
        assert beside(effect, (2,)) == {(plain, (2,)) for plain in DRIVE}
    assert beside("joint_coupling", (2,)) == {(plain, (joint,)) for plain in DRIVE for joint in (1, 2)}
    assert beside("payload", ()) == {("armature", (1,)), ("armature", (2,))}
    # A plain term and one factor of all masses vary none.
    for effect, at in (("friction_coulomb", (2,)), ("link_inertial", (1, 2))):
        assert beside(effect, at) == set()
    taken = next(term for term in all_.drives if pool.groups[term.group].effect.id == "armature")
    assert len(beside("payload", (), members=(taken,))) == 1
