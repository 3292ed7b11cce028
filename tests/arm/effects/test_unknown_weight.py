"""Weights up to one unknown factor: what gives under them does what it would do under the weights themselves."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.bodies.beams import PropertyNeeded
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.compensation import model_error
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import Asked, seen
from linkwright.core.arm.errors.unknown_mass import payloads_left_out
from linkwright.core.arm.evaluation import evaluate

UNIT = 7.0
"""kg; any will do, as only products show."""
POSES = [np.random.default_rng(5).uniform(-1.0, 1.0, 4) for _ in range(5)]


def arm_of_known_masses() -> Arm:
    """Five joints in space, one of them a slide."""
    axes = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    joints = tuple(Joint("prismatic" if k == 2 else "revolute", axis=axis) for k, axis in enumerate(axes))
    links = (
        Link(0.3, (0.0, 0.0, 1.0), mass=8.0, center_of_mass=0.1),
        Link(0.5, mass=5.0, center_of_mass=0.2),
        Link(0.3, mass=3.0, center_of_mass=0.1),
        Link(0.4, mass=4.0),
        Link(0.2, mass=2.0),
    )
    return Arm("five joints", joints, links, gravity=(0.0, 0.0, -9.81))


def weighed_by_a_unit(arm: Arm) -> Arm:
    """The same arm, its masses unknown and written as multiples of a unit."""
    entries: list[EffectEntry] = []
    for number, link in enumerate(arm.links, start=1):
        assert link.mass is not None
        at = 0.5 * link.length if link.center_of_mass is None else link.center_of_mass
        values = {"mass": link.mass / UNIT, "along": link.mass * at / UNIT}
        entries.append(EffectEntry("unknown_weight", (number,), MappingProxyType(values)))
    links = tuple(replace(link, mass=None, center_of_mass=None) for link in arm.links)
    return replace(arm, links=links, effects=(*arm.effects, *entries))


@pytest.mark.parametrize(
    ("effect", "size", "at", "lever"),
    [
        ("joint_compliance", "compliance", (1,), 1.0),
        ("joint_compliance", "compliance", (2,), 1.0),
        ("base_compliance", "compliance", (), 1.0),
        ("column_bending", "flexibility", (2,), 1.0),
        ("lateral_compliance", "compliance", (0,), 1.0),
        ("link_bending", "flexibility", (0,), 0.3),
        ("link_bending", "flexibility", (1,), 0.5),
    ],
)
def test_a_product_does_what_its_factors_do(effect: str, size: str, at: tuple[int, ...], lever: float) -> None:
    known = arm_of_known_masses()
    unknown = weighed_by_a_unit(known)
    bare = unknown.with_links(tuple(replace(link, mass=0.0) for link in unknown.links))
    compliance = 1e-5
    product = compliance * UNIT * 9.80665 * lever
    asked = Asked(4)
    expected = seen(solve(known, POSES, beams_of(known)), EFFECTS[effect], Settings(at, {size: compliance}), asked).tip
    result = seen(solve(bare, POSES, beams_of(bare)), EFFECTS[effect], Settings(at, {"unit_sag": product}), asked).tip
    assert np.abs(expected).max() > 1e-5
    assert result == pytest.approx(expected, abs=1e-15)


def test_a_tilted_base_acts_through_products() -> None:
    known, tilt = arm_of_known_masses(), Settings((), {"about_x": 0.01})
    soft = EffectEntry("joint_compliance", (2,), MappingProxyType({"compliance": 1e-5}))
    sag = EffectEntry("joint_compliance", (2,), MappingProxyType({"unit_sag": 1e-5 * UNIT * 9.80665}))
    unknown = weighed_by_a_unit(known)
    bare = replace(unknown, effects=(*unknown.effects, sag))
    bare = bare.with_links(tuple(replace(link, mass=0.0) for link in bare.links))
    whole = replace(known, effects=(soft,))
    moved = [seen(solve(arm, POSES, beams_of(arm)), EFFECTS["base_tilt"], tilt, Asked(4)).tip for arm in (whole, bare)]
    assert np.abs(moved[0]).max() > 1e-6
    assert moved[1] == pytest.approx(moved[0], abs=1e-15)


def test_what_needs_no_mass_is_answered_and_what_does_is_named() -> None:
    known = arm_of_known_masses()
    soft = replace(known, effects=(EffectEntry("joint_compliance", (2,), MappingProxyType({"compliance": 1e-5})),))
    unknown = weighed_by_a_unit(known)
    sag = EffectEntry("joint_compliance", (2,), MappingProxyType({"unit_sag": 1e-5 * UNIT * 9.80665}))
    product = replace(unknown, effects=(*unknown.effects, sag))
    q = np.stack(POSES, axis=1)
    assert model_error(product, q, 0.0) == pytest.approx(model_error(soft, q, 0.0), abs=1e-9)
    told = evaluate(product)
    assert told.max_error == pytest.approx(evaluate(soft).max_error, rel=1e-6)
    assert told.mass is None
    assert told.stiffness is None
    assert "links 1, 2, 3, 4, 5" in told.unknown["mass"]
    heavy = replace(soft, links=product.links)
    with pytest.raises(PropertyNeeded, match=r"link 2 .* compliance of the drives at joint 2"):
        evaluate(heavy)


def test_another_payload_through_a_product_is_said_to_be_missing() -> None:
    """The compliance itself shows with a second payload (the tip sinks further); its product cannot say by how much."""
    known = arm_of_known_masses()
    soft = replace(known, effects=(EffectEntry("joint_compliance", (2,), MappingProxyType({"compliance": 1e-5})),))
    sag = EffectEntry("joint_compliance", (2,), MappingProxyType({"unit_sag": 1e-5 * UNIT * 9.80665}))
    unknown = weighed_by_a_unit(known)
    product = replace(unknown, effects=(*unknown.effects, sag))
    q = np.array(POSES)
    short = model_error(soft, q.T, 3.0) - model_error(product, q.T, 3.0)
    assert np.abs(short).max() > 1e-4
    left_out = payloads_left_out(product, (0.0, 3.0))
    assert left_out is not None
    assert "another payload (3 kg)" in left_out
    assert "joint 2" in left_out
    assert payloads_left_out(product, (0.0,)) is None
    assert payloads_left_out(soft, (3.0,)) is None
