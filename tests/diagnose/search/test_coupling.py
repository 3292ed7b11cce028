"""Loads that nobody declared act through flexibility that nobody declared; a free tool is where it was found."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry, Link, LoadCase
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.coupling import softened, through_what_is_named
from linkwright.core.diagnose.search.naming import Named, Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import SIGMA, recorded, with_effects
from tests.diagnose.made_diagnosis import made_arm, made_recording

SOFT = ("joint_compliance", (2,), {"compliance": 3e-5})
HEAVY = ("payload", (), {"mass": 1.0})


def test_a_softened_recording_is_that_of_the_softer_arm():
    """What a kilogram does through the file's flexibility and an entry of `effects`, against an arm that has the entry
    in its file; the residual stays against the file, and so does every pattern that is no load.

    The shape about which they are taken stays the file's as well: levers are off by what the softer drive turns by.
    """
    arm, recording = made_arm(), made_recording()
    plain, softer = observe(arm, recording), observe(with_effects(arm, SOFT), recording)
    result = plain.softened(softer.arm.effects)
    kilogram = Settings((), {"mass": 1.0})
    torque = max(np.abs(joint.drive_load).max() for joint in plain.state.joints)
    expected = softer.signature("payload", kilogram)
    off = np.linalg.norm(result.signature("payload", kilogram) - expected)
    assert off < 2.0 * SOFT[2]["compliance"] * torque * np.linalg.norm(expected)
    stiff = plain.signature("payload", kilogram)
    assert np.linalg.norm(result.signature("payload", kilogram)) > 1.3 * np.linalg.norm(stiff)
    assert (result.residual == plain.residual).all()
    offset = Settings((1,), {"offset": 1e-3})
    assert (result.signature("encoder_offset", offset) == plain.signature("encoder_offset", offset)).all()


FEW = {"joint_compliance", "joint_hardening", "link_bending", "base_compliance", "payload", "link_mass", "backlash"}


@pytest.mark.parametrize("names", [FEW, pytest.param(set(EFFECTS), marks=pytest.mark.slow)], ids=["few", "all"])
def test_a_heavier_payload_on_a_softer_drive(names):
    """They multiply: without going back, the payload comes out 1.43 kg (1.40 to 1.47) and the drive as hardening."""
    arm, asked = made_arm(), Options(without=frozenset(EFFECTS) - names)
    recording = recorded(with_effects(arm, SOFT, HEAVY), poses=24, repeats=3, payloads=(0.0, 5.0))
    result = diagnose(arm, recording, asked)
    assert {(finding.effect, finding.at) for finding in result.findings} == {
        ("joint_compliance", (2,)),
        ("payload", ()),
    }
    sizes = {p.parameter: p for finding in result.findings for p in finding.parameters}
    for name, truth in (("compliance", 3e-5), ("mass", 1.0)):
        low, high = sizes[name].interval
        # Three standard errors: 95 % intervals are two to either side.
        assert abs(sizes[name].value - truth) < 0.75 * (high - low)
        assert high - low < 0.3 * truth
    assert diagnose(result.corrected, recording, asked).verdict == "none"


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_a_free_tool_is_put_where_it_was_found(space):
    """Rotations turn the target that was measured: a tool of some centimetres changes every pattern by that much."""
    arm = made_arm(space)
    width = 3 if space else 2
    tool = (0.06, 0.04, 0.03 if space else 0.0)
    true = replace(arm, tool=tool)
    recording = made_recording(true)
    exact = observe(true, recording)
    measured = replace(recording, tip=recording.tip - exact.residual[:, :width])
    result = observe(arm, replace(measured, tool="free"))
    # One pass sees the tool through the error that it makes itself, first order in its size.
    assert result.arm.tool == pytest.approx(tool, abs=2e-6)
    assert result.arm_given.tool == pytest.approx(arm.tool, abs=1e-12)
    turning = Settings((0,), {"offset": 1.0})
    expected = exact.signature("encoder_offset", turning)
    assert result.signature("encoder_offset", turning) == pytest.approx(expected, abs=1e-5)
    assert np.abs(result.tip_residual()).max() < 0.1 * SIGMA


def test_a_known_load_tells_compliance_where_links_weigh_nobody_knows_what():
    """The sag under the links is a product; what a payload adds to it is not."""
    arm = made_arm(True)
    joints = tuple(replace(joint, stiffness=None) for joint in arm.joints)
    links = tuple(Link(link.length, mass=mass) for link, mass in zip(arm.links, (4.0, 3.0, 1.5), strict=True))
    arm = replace(arm, joints=joints, links=links)
    truth = 2e-5
    recording = recorded(
        with_effects(arm, ("joint_compliance", (2,), {"compliance": truth})), poses=30, repeats=2, payloads=(0.0, 5.0)
    )
    unknown = replace(arm, links=(links[0], *(replace(link, mass=None) for link in links[1:])))
    result = diagnose(unknown, recording)
    told = {(finding.at, p.parameter): p for finding in result.findings for p in finding.parameters}
    compliance = told[(2,), "compliance"]
    low, high = compliance.interval
    assert abs(compliance.value - truth) < 0.75 * (high - low) < 0.1 * truth
    entries = {(effect.effect, effect.at): effect.parameters for effect in result.corrected.effects}
    assert entries["joint_compliance", (2,)]["compliance"] == compliance.value


def test_a_load_acts_through_what_is_named_or_is_not_named():
    """A kilogram through a drive that gives, on an arm whose file gives nothing: where how drives give is left out of
    the search it would be named alone, and do nothing in the arm file that is written. So it is sought again without
    what is not named, and is no candidate then."""
    arm = made_arm()
    stiff = replace(
        arm,
        joints=tuple(replace(joint, stiffness=None) for joint in arm.joints),
        links=tuple(Link(link.length, mass=3.0) for link in arm.links),
        payload=LoadCase(),
    )
    recording = recorded(with_effects(stiff, SOFT), poses=16, payloads=())
    entry = EffectEntry(SOFT[0], SOFT[1], SOFT[2])
    giving = frozenset(effect.id for effect in EFFECTS.values() if effect.cause == "flexibility")
    without = giving | {"counterbalance"}
    bare = prepare(observe(stiff, recording), Options(without=without), None)
    prepared = softened(bare, (entry,), without)
    namer = Namer(prepared, thorough=False, seed=0)
    heavy = next(k for k, group in enumerate(namer.pool.groups) if group.candidate.effect == "payload")
    gate = namer.test(())
    named = Named((heavy,), (), (0.0,), gate, None)
    assert namer.prepared.observed.softening == (entry,)
    namer, _ = through_what_is_named(namer, named, without, lambda _: None)
    assert namer.prepared.observed.softening == ()
    assert not any(group.candidate.effect == "payload" for group in namer.pool.groups)
