"""The whole diagnosis on recordings of the library's own physics: consistency, not proof."""

from dataclasses import replace
from functools import cache
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Joint
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.core_cases import recorded, with_effects
from tests.diagnose.made_diagnosis import made_arm

WARM = {"temperature": (293.15, 313.15), "hours": 5.0}
SINGLES = {
    # All that have shapes, and of those that have none a few; the benchmark takes them all.
    "link_bending": (True, (3,), {}, {}),
    "joint_compliance": (False, (1,), {}, {}),
    "joint_hardening": (False, (2,), {"knee": 15.0}, {"payloads": (0.0, 10.0)}),
    "servo_droop": (True, (2,), {}, {"commands": True}),
    "backlash": (False, (1,), {"held_below": 1e6}, {}),
    "friction_windup": (False, (1,), {}, {}),
    "encoder_offset": (True, (2,), {}, {}),
    "axis_misalignment": (True, (2,), {}, {}),
    "gear_transmission_error": (False, (1,), {"order": 3.0}, {}),
    "payload": (False, (), {}, {}),
    "thermal_expansion": (False, (1, 2, 3), {"lag": 1800.0}, WARM),
    "thermal_bending": (True, (2,), {"lag": 0.0}, WARM),
    "gearbox_thermal": (False, (2,), {"lag": 0.0}, WARM),
    "creep": (False, (1,), {"time_constant": 1200.0}, WARM),
    "base_compliance": (True, (), {}, {"base_target": True}),
    "frame_drift": (False, (), {}, {"base_target": True, **WARM}),
}
NOT_SIMULATED = {"latency", "dynamic_deflection", "joint_waviness", "screw_expansion"}  # they ask for more
PLAN = {"poses": 12}


def names_of(found):
    """What a diagnosis names, alternatives included, as (effect, at)."""
    return {(alternative.effect, alternative.at) for f in found.findings for alternative in (f, *f.alternatives)}


@cache
def shown(space, changed):
    """What a recording of nothing but noise could just have shown."""
    result = diagnose(made_arm(space), recorded(made_arm(space), **{**PLAN, **dict(changed), "seed": 99}))
    assert result.verdict == "none"
    return {(item.effect, item.at): (item.parameter, item.value) for item in result.detectable}


def test_every_effect_with_a_size_is_tried_somewhere():
    sized = {name for name, effect in EFFECTS.items() if effect.sizes}
    assert (
        sized - NOT_SIMULATED == (set(SINGLES) | {name for name in sized if not EFFECTS[name].shapes}) - NOT_SIMULATED
    )


@pytest.mark.parametrize("effect", slow_but(["joint_compliance", "encoder_offset", "backlash"], "backlash"))
def test_a_single_is_named(effect):
    """Three that no noise has taken for something else."""
    assert named_alone(effect)


@pytest.mark.slow
@pytest.mark.parametrize("effect", SINGLES)
def test_singles_are_explained(effect):
    """What holds whatever the noise: something is found, noise is left, and a class is said where there is one."""
    _, result = of_single(effect)
    assert result.verdict != "none"
    assert result.rms_after < 1.15 * result.noise_floor
    if effect != "servo_droop":  # which encoders see, so the tip's residual never held it
        assert result.rms_before > result.rms_after
    if result.unknown is None:
        assert (result.verdict == "alias_class") is any(f.alternatives for f in result.findings)


@pytest.mark.slow
def test_singles_are_named():
    """95 % of many: of these 16, one may have a second name for a whim of the noise."""
    wrong = [effect for effect in SINGLES if not named_alone(effect)]
    assert len(wrong) <= 1, wrong


@cache
def of_single(effect):
    """A single's place, and its diagnosis at three times the size that the recording could just have shown."""
    space, at, shapes, changed = SINGLES[effect]
    arm = made_arm(space)
    name, size = shown(space, tuple(changed.items()))[effect, at]
    true = with_effects(arm, (effect, at, {name: 3.0 * size, **shapes}))
    return at, diagnose(arm, recorded(true, **{**PLAN, **changed}))


def named_alone(effect):
    """Whether a single is the one finding, by its name or by names that hold it."""
    at, result = of_single(effect)
    return result.unknown is None and len(result.findings) == 1 and (effect, at) in names_of(result)


@pytest.mark.slow
def test_a_bent_rail_is_no_entry_of_the_library():
    """Straightness of a slide has a zone but no size to be fitted: what bends along it is called unknown."""
    arm = made_arm()
    rail = Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 1.5), stiffness=5e7)
    arm = replace(arm, joints=(rail, *arm.joints[1:]), links=(replace(arm.links[0], length=0.05), *arm.links[1:]))
    plain = recorded(arm, poses=24, payloads=())
    bent = plain.tip + np.column_stack([np.zeros(plain.size), 2e-4 * np.sin(4.0 * plain.q[:, 0])])
    result = diagnose(arm, replace(plain, tip=bent))
    assert result.verdict == "unknown"
    assert "q1" in result.unknown.depends_on or "position" in result.unknown.depends_on


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_noise_alone_is_nothing(space):
    arm = made_arm(space)
    for seed in (31, 32):
        result = diagnose(arm, recorded(arm, seed=seed))
        assert result.verdict == "none"
        assert result.findings == ()
        assert result.unknown is None
        assert result.gate_p > 0.006
        assert result.where.joint is None
        assert result.corrected == arm
        assert result.detectable
        assert "No mismatch" in result.sentence


PAIRS = {
    "geometry": (("encoder_offset", (2,), {"offset": 2e-4}), ("link_length", (1,), {"length": 2e-4})),
    "stiffness and geometry": (
        ("joint_compliance", (1,), {"compliance": 6e-6}),
        ("encoder_offset", (3,), {"offset": 4e-4}),
    ),
    "friction and scale": (("friction_windup", (1,), {"windup": 1e-4}), ("instrument_scale", (), {"scale": 2e-4})),
}


@pytest.mark.parametrize("name", slow_but(PAIRS, "geometry"))
def test_a_pair_is_named(name):
    arm = made_arm()
    result = diagnose(arm, recorded(with_effects(arm, *PAIRS[name]), **PLAN))
    assert len(result.findings) == 2
    for effect, at, _ in PAIRS[name]:
        assert (effect, at) in names_of(result)
    assert result.ladder[0].label == "model as given"
    assert result.ladder[2].rms < result.ladder[1].rms < result.ladder[0].rms
    for rung in result.ladder[3:]:  # each left out in turn
        assert rung.rms > 1.5 * result.ladder[2].rms
    for finding in result.findings:
        assert finding.p_value <= 0.003
        assert finding.rms_without_held_out > result.rms_after_held_out
    assert result.rms_after_held_out < 1.15 * result.noise_floor


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "at", "values", "without"),
    [
        ("gear_transmission_error", (1,), {"sine": 2e-4, "order": 3.0}, {"gear_transmission_error"}),
        ("friction_windup", (2,), {"windup": 3e-4}, {"friction_windup", "backlash"}),
    ],
)
def test_an_effect_taken_out_of_the_library_is_not_named(effect, at, values, without):
    """Unknown, or an honest name that resembles it; never the effect itself, and nothing with a wrong claim."""
    arm = made_arm()
    recording = recorded(with_effects(arm, (effect, at, values)), **PLAN)
    result = diagnose(arm, recording, Options(without=frozenset(without)))
    assert result.verdict in ("unknown", "alias_class", "named")
    assert all(name not in without for name, _ in names_of(result))
    assert all(item.effect not in without for item in result.detectable)
    if result.verdict != "unknown":
        # A name was given: then it must describe what there is, or the report must say what is left.
        assert result.rms_after < 1.3 * result.noise_floor


def test_too_few_readings_decide_nothing():
    arm = made_arm()
    true = with_effects(arm, ("encoder_offset", (2,), {"offset": 1e-3}))
    result = diagnose(arm, recorded(true, poses=3, repeats=1, sides="one", payloads=()))
    assert result.verdict == "insufficient_data"
    assert result.findings == ()
    assert result.corrected == arm


def test_a_small_recording_is_not_fitted_to_the_last_digit():
    """Seven readings of an arm whose drive gives: no form of a dozen coefficients may be the answer."""
    arm = made_arm()
    true = with_effects(arm, ("joint_compliance", (2,), {"compliance": 1e-4}))
    result = diagnose(arm, recorded(true, poses=7, repeats=1, sides="one", payloads=()))
    assert result.verdict != "unknown"
    assert result.rms_after > 1e-6


def test_a_free_frame_swallows_what_it_must():
    """The instrument stands anywhere: an offset of encoder 1 is a turn of it, a compliance is not."""
    arm = made_arm()
    offset = with_effects(arm, ("encoder_offset", (1,), {"offset": 1e-3}))
    result = diagnose(arm, recorded(offset, free_frame=True))
    assert result.verdict == "none"
    assert ("encoder_offset", (1,)) in result.invisible
    assert any("encoder" in sentence for sentence in result.null_vectors)
    soft = with_effects(arm, ("joint_compliance", (2,), {"compliance": 2e-5}))
    result = diagnose(arm, recorded(soft, free_frame=True, **PLAN))
    assert ("joint_compliance", (2,)) in names_of(result)
    compliance = result.findings[0].parameters[0]
    assert compliance.interval[0] < 2e-5 < compliance.interval[1]


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_q_and_tip_are_enough(space):
    """No time, sides, payload, temperature: what remains visible is still named."""
    arm = made_arm(space)
    true = with_effects(arm, ("encoder_offset", (2,), {"offset": 2e-4}))
    full = recorded(true, poses=24, payloads=(), repeats=2)
    bare = replace(full, time=None, sides=None, payload_mass=None, temperature=None)
    result = diagnose(arm, bare)
    assert ("encoder_offset", (2,)) in names_of(result)
    assert result.where.since is None
    absent = {name for name, _ in result.invisible}
    assert {"friction_windup", "latency"} <= absent


@pytest.mark.parametrize(
    ("effect", "at", "size"),
    [
        pytest.param("joint_compliance", (1,), 6e-6, marks=pytest.mark.slow),
        pytest.param("base_compliance", (), 3e-6, marks=pytest.mark.slow),
        ("servo_droop", (1,), 6e-6),
    ],
)
def test_joint_side_encoders_and_commands_tell_exact_aliases_apart(effect, at, size):
    """To the tip a servo's droop, a drive's compliance and the base's are one; other instruments tell them."""
    channels = {"joint_side": True, "commands": True, "base_target": True, **PLAN}
    true = with_effects(made_arm(), (effect, at, {"compliance": size}))
    result = diagnose(made_arm(), recorded(true, **channels))
    assert [(f.effect, f.at) for f in result.findings] == [(effect, at)]
    others = {name for name, _ in names_of(result)} - {effect}
    assert others.isdisjoint({"joint_compliance", "base_compliance", "servo_droop"})


def test_what_is_measured_the_same_everywhere_says_nothing():
    """One pose, read forty times: a mismatch there has any number of names, and none may be given as the only one."""
    arm = made_arm(True)
    true = with_effects(arm, ("encoder_offset", (2,), {"offset": 3e-4}))
    result = diagnose(arm, recorded(true, poses=1, repeats=40, payloads=(), sides="one"))
    assert result.verdict != "none"  # 0.2 mm off where repeats differ by 0.02 mm
    assert result.verdict != "named"


def test_constant_columns_and_strange_names_do_no_harm():
    arm = made_arm()
    plain = recorded(arm)
    strange = replace(
        plain,
        temperature=np.full(plain.size, 300.0),
        other=MappingProxyType({"humidity": np.full(plain.size, 40.0), "x y/z": np.arange(plain.size) % 7.0}),
    )
    assert diagnose(arm, strange).verdict == "none"


def test_a_perfect_recording_has_no_mismatch():
    """Not a digit is wrong: no rounding may be diagnosed, and nothing may be divided by it."""
    arm = made_arm()
    with np.errstate(all="raise", under="ignore"):
        result = diagnose(arm, recorded(arm, noise=0.0))
    assert result.verdict == "none"
    assert result.rms_before == pytest.approx(0.0, abs=1e-12)
