"""Expressions that designs of one structure share, and evaluations that are cached: never those of another arm."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from linkwright.core.arm.chain.balance import IdealCounterbalance, PointMass
from linkwright.core.arm.chain.chain import Arm, DhRow, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects import EFFECTS, Settings, Twist
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.structure import Structure
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import build

STEEL = load_catalogue(user=False).find("steel-s355")
ALUMINIUM = load_catalogue(user=False).find("aluminium-6061-t6")
ANGLE = {"width": 0.04, "height": 0.06, "thickness": 0.005}


def arm(diameter: float = 0.05, length: float = 0.5, **changes: Any) -> Arm:
    """One level link on a fixed pin, a kilogram at its tip."""
    link = Link(length, section=build("circle", {"diameter": diameter}), material=STEEL)
    made = Arm("lever", (Joint(range=(0.0, 0.0)),), (link,), payload=LoadCase(1.0), leave_out=frozenset({"axial"}))
    return replace(made, **changes)


@pytest.mark.parametrize(("diameter", "length", "material"), [(0.05, 0.5, STEEL), (0.02, 0.9, ALUMINIUM)])
def test_designs_that_share_expressions_bend_as_each_should(diameter: float, length: float, material: Any) -> None:
    """F L^3 / 3 E I + w L^4 / 8 E I of a cantilever, by whatever design the expressions were made for."""
    lever = arm(diameter, length)
    lever = lever.with_links((replace(lever.links[0], material=material),))
    model = error_model(replace(lever, leave_out=frozenset({"axial", "shear_deformation"})))
    result = model.cases[0].arrays(np.zeros((1, 1)), beam_values(beams_of(lever))).vector[0, 1]
    values = material.at(lever.temperature)
    rigidity = values.elastic_modulus * math.pi * diameter**4 / 64.0
    weight = 9.81 * values.density * math.pi * diameter**2 / 4.0
    assert result == pytest.approx(-(9.81 * length**3 / 3.0 + weight * length**4 / 8.0) / rigidity, rel=1e-9)
    assert model.arm.links == lever.links


def test_sizes_and_materials_share_a_structure_and_nothing_else_does() -> None:
    """What the expressions take as symbols is no part of the structure; every other field is."""
    given = arm()
    assert Structure(given) == Structure(arm(0.08, 0.3))
    weight = PointMass(2.0)
    others = {
        "payload": arm(payload=LoadCase(2.0)),
        "stiffness": arm(joints=(Joint(range=(0.0, 0.0), stiffness=1e4),)),
        "effects": arm(effects=(EffectEntry("encoder_offset", (1,), {"offset": 1e-3}),)),
        "offset": arm(effects=(EffectEntry("encoder_offset", (1,), {"offset": 2e-3}),)),
        "rigid": arm(links=(Link(0.5, mass=1.0),)),
        "heavier": arm(links=(Link(0.5, mass=2.0),)),
        "askew": arm(links=(replace(given.links[0], section=build("angle", ANGLE)),)),
        "hung": arm(links=(replace(given.links[0], masses=(weight,)),)),
        "chosen": arm(links=(replace(given.links[0], masses=(replace(weight, chosen=True),)),)),
        "balanced": arm(joints=(Joint(counterbalance=IdealCounterbalance(9.0)),)),
        "balancer chosen": arm(joints=(Joint(counterbalance=IdealCounterbalance(9.0), balancer_chosen="torque"),)),
    }
    keys = [Structure(given), *map(Structure, others.values())]
    assert len(set(keys)) == len(keys)


def test_rows_of_dh_share_a_structure() -> None:
    """A row says again what the link's length says, and a length is a symbol."""
    short, long = (
        arm(length=a, joints=(Joint(range=(0.0, 0.0), dh=DhRow(a, 0.0, 0.0, 0.0, False)),)) for a in (0.5, 0.9)
    )
    assert Structure(short) == Structure(long)


def test_an_evaluation_is_cached_by_all_that_an_arm_holds() -> None:
    """The same question has the same answer; a flag that only a note tells of makes another question."""
    given = arm(joints=(Joint(range=(0.0, 1.0)),), gravity=(0.0, 0.0, -9.81))
    assert evaluate(given) is evaluate(replace(given))
    assert evaluate(given, pose=[0.5]).compliance.q == (0.5,)
    assert not any("no gravity is given" in note for note in evaluate(given).notes)
    assert any("no gravity is given" in note for note in evaluate(replace(given, gravity_given=False)).notes)
    assert evaluate(arm(0.06)).max_error < evaluate(arm(0.05)).max_error


def test_another_effect_of_the_same_name_makes_other_expressions() -> None:
    """What is withdrawn and registered anew is not found in the cache."""
    results: list[float] = []
    for turn in (1e-3, 2e-3):
        EFFECTS.register(replace(EFFECTS["encoder_offset"], id="lifted", twists=_turned(turn), automatic=True))
        try:
            results.append(evaluate(arm()).by_effect["lifted"])
        finally:
            EFFECTS.withdraw("lifted")
    assert results == pytest.approx([0.5e-3, 1e-3])


def _turned(turn: float) -> Callable[[PoseState, Settings], Iterable[Twist]]:
    return lambda _state, _settings: (Twist("joint", 0, rotation=(0.0, 0.0, turn)),)
