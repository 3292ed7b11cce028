"""Plans for levels and cameras: their promise against least squares on readings by plain rotation matrices."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.diagnose.instruments.observes import observed_by
from linkwright.core.diagnose.plan.plan_request import Asked
from linkwright.core.diagnose.plan.planning import plan
from linkwright.core.diagnose.plan.promise import _sound
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.instruments.six_joint_arm import Hand, flange, seen_by_camera, six_joint_arm
from tests.diagnose.instruments.spatial_arm import RANGE, Truth, spatial_arm, tips
from tests.diagnose.instruments.test_levels import recorded, tilted
from tests.diagnose.plan.test_plan import silent

FAST = replace(RULES, plan=replace(RULES.plan, tried=64, rivals=3, passes=1), search=replace(RULES.search, draws=199))
SOFT = 1e-6
"""rad/(N*m), by which readings are differentiated."""


def planned(arm, instrument, effects, poses=16, frame="known", **settings):
    """A plan for an instrument under no payload and 5 kg."""
    keys = ("sigma", "camera_noise", "bars")
    noise = {key: settings.pop(key) for key in keys if key in settings}
    said = observed_by(instrument, None, None, arm, anchor_free=False, **settings)
    asked = Asked(
        poses, effects, instrument, payloads=(0.0, 5.0), frame=frame, tool=frame, rules=FAST, slots=said["slots"],
        reads=said["instrument"], bar=said.get("bar", ()), **noise,
    )  # fmt: skip
    return plan(arm, asked, silent)


def errors(columns, beside):
    """Standard errors by least squares of each of some columns (n,), over their scatter, beside others (n, k)."""
    left = [column - beside @ np.linalg.lstsq(beside, column, rcond=1e-9)[0] for column in columns]
    return np.array([1.0 / np.linalg.norm(item) for item in left])


def gains(found):
    return [found.at_random(item) / item.smallest for item in found.promise.shown]


def kept(found, own):
    """That the smallest sizes are some four standard errors, alike for all."""
    smallest = np.array([item.smallest for item in found.promise.shown])
    assert smallest / own == pytest.approx(np.full(len(own), smallest[0] / own[0]), rel=0.03)
    assert 3.5 < smallest[0] / own[0] < 6.0


@pytest.fixture(scope="module")
def levelled():
    effects = tuple(("joint_compliance", (joint,)) for joint in (0, 1, 2))
    return planned(spatial_arm(), "tilt", effects, tilt_link=3, sigma=20e-6)


def test_sizes_by_a_level_are_those_of_least_squares(levelled):
    """How the level sits (straight, but for some mrad) is found along; about the upright joint nothing is tilted."""
    assert levelled.axes == ("tilt x", "tilt y")
    assert [item.at for item in levelled.promise.shown] == [(2,), (3,)]
    assert np.mean(np.log(gains(levelled))) > np.log(1.1)
    q, payload = levelled.recording.q, levelled.recording.payload_mass

    def read(*soft, seat=(0.0, 0.0, 0.0)):
        truth = Truth(compliance=(*soft, *(0.0,) * (5 - len(soft))))
        return tilted(q, payload, truth, seat=Rotation.from_rotvec(seat)).reshape(-1) / 20e-6

    sound = read()
    columns = [(read(*(SOFT * np.eye(3)[joint])) - sound) / SOFT for joint in (1, 2)]
    seats = np.stack([(read(seat=1e-6 * axis) - sound) / 1e-6 for axis in np.eye(3)], axis=1)
    kept(levelled, errors(columns, seats))


def test_what_a_level_is_promised_to_show_is_found(levelled):
    """Read at the plan's visits by plain matrices, a degree askew: by its own account the diagnosis sees as much."""
    arm, q, payload = spatial_arm(), levelled.recording.q, levelled.recording.payload_mass
    promised, askew = levelled.promise.shown[1], Rotation.from_rotvec([0.01, -0.015, 0.01])
    large, small = (
        diagnose(arm, recorded(q, payload, tilted(q, payload, Truth(compliance=(0.0, 0.0, size, 0, 0)), seat=askew)))
        for size in (3.0 * promised.smallest, 0.2 * promised.smallest)
    )
    names = [(one.effect, one.at) for finding in large.findings for one in (finding, *finding.alternatives)]
    assert ("joint_compliance", (3,)) in names
    assert small.verdict == "none"
    own = next(item for item in small.detectable if (item.effect, item.at) == ("joint_compliance", (3,)))
    assert own.value == pytest.approx(promised.smallest, rel=0.3)


@pytest.mark.parametrize("camera", [pytest.param("fixed", marks=pytest.mark.slow), "on_tool"])
def test_sizes_by_a_camera_are_those_of_least_squares(camera):
    """Both frames and the depths' scale are found along; each component has its own scatter."""
    noise, on_tool = (30e-6, 200e-6, 80e-6), camera == "on_tool"
    effects = tuple(("joint_compliance", (joint,)) for joint in (1, 2, 4))
    result = planned(
        six_joint_arm(), "camera", effects, frame="free", camera=camera, sigma=noise[0], camera_noise=noise[1:]
    )
    assert np.mean(np.log(gains(result))) > np.log(1.1)
    recording = result.recording
    sight = _sound(result.arm, recording, result.axes, result.asked).observed.sight
    hand, last = Hand(fixed=np.eye(4), carried=np.eye(4)), flange(recording.q)[:, :3, :3]
    hand.fixed[:3, :3], hand.fixed[:3, 3], hand.carried[:3, 3] = sight.rotation, sight.translation, sight.tool
    if on_tool:
        hand.carried[:3, :3] = last[0].T @ sight.axes[0]

    def read(soft=None, **moved):
        seen = seen_by_camera(
            recording.q, recording.payload_mass, replace(hand, compliance=soft or {}, **moved), on_tool=on_tool,
            noise=(0.0, 0.0, 0.0),
        )  # fmt: skip
        return seen.tip, seen.orientation

    at, turned = read()

    def change(other, step):
        off = Rotation.from_matrix(other[1] @ np.swapaxes(turned, 1, 2)).as_rotvec()
        both = np.concatenate([other[0] - at, off], axis=1) / np.array([noise[0], noise[0], noise[1], *(noise[2],) * 3])
        return both.reshape(-1) / step

    columns = [change(read({joint + 1: SOFT}), SOFT) for joint in (1, 2, 4)]
    beside = [change((at * np.array([1.0, 1.0, 1.0 + 1e-6]), turned), 1e-6)]
    for name in ("fixed", "carried"):
        for k in range(6):
            step = np.eye(4)
            step[:3, :3] = Rotation.from_rotvec(1e-6 * np.eye(6)[k, :3]).as_matrix()
            step[:3, 3] = 1e-6 * np.eye(6)[k, 3:]
            beside.append(change(read(**{name: getattr(hand, name) @ step}), 1e-6))
    kept(result, errors(columns, np.stack(beside, axis=1)))


@pytest.mark.parametrize("instrument", ["same_point", pytest.param("plane", marks=pytest.mark.slow)])
def test_sizes_by_touches_are_those_of_least_squares(instrument):
    """Where each point or plane is, is found along; each is touched often enough, there within the joint ranges."""
    arm = spatial_arm()
    effects = tuple(("joint_compliance", (joint,)) for joint in (1, 2, 4))
    result = planned(arm, instrument, effects, poses=24)
    assert np.mean(np.log(gains(result))) > np.log(1.1)
    recording, visits, sigma = result.recording, result.visits, result.asked.sigma
    q, payload, label = recording.q, recording.payload_mass, recording.touches
    assert np.abs(q).max() < RANGE
    at = tips(q, payload, Truth())
    columns, beside = [], []
    if instrument == "same_point":
        for joint in (1, 2, 4):
            soft = tips(q, payload, Truth(compliance=tuple(SOFT * np.eye(5)[joint])))
            columns.append((soft - at).reshape(-1) / SOFT / sigma)
        beside = [np.outer(label == one, axis).reshape(-1) for one in range(label.max() + 1) for axis in np.eye(3)]
    normals = np.zeros(at.shape)
    for one in range(label.max() + 1):
        own = at[label == one]
        assert len(np.unique(visits.q[visits.touches == one], axis=0)) >= (2 if instrument == "same_point" else 4)
        away = own - own.mean(axis=0)
        if instrument == "same_point":
            assert np.abs(away).max() < 1e-4
            continue
        _, reach, axes = np.linalg.svd(away, full_matrices=False)
        assert reach[2] < 1e-3 * reach[1]
        normals[label == one] = axes[2]
        beside += [np.where(label == one, column, 0.0) for column in (np.ones(len(at)), at @ axes[0], at @ axes[1])]
    if instrument == "plane":
        for joint in (1, 2, 4):
            soft = tips(q, payload, Truth(compliance=tuple(SOFT * np.eye(5)[joint])))
            columns.append(np.sum((soft - at) * normals, axis=1) / SOFT / sigma)
    kept(result, errors(columns, np.stack(beside, axis=1)))


@pytest.mark.parametrize("bars", [pytest.param(0, marks=pytest.mark.slow), 1, pytest.param(6, marks=pytest.mark.slow)])
def test_sizes_by_a_bar_are_those_of_least_squares(bars):
    """Of a bar of 0.3 m where it lies and which way it points is found along; how long it is, is known."""
    arm, length = spatial_arm(), 0.3
    effects = tuple(("joint_compliance", (joint,)) for joint in (1, 2, 4))
    result = planned(arm, "bar", effects, poses=24, bar=[0.0, length], bars=bars)
    assert np.mean(np.log(gains(result))) > np.log(1.1)
    recording, sigma = result.recording, result.asked.sigma
    q, payload, label, along = recording.q, recording.payload_mass, recording.touches, recording.bar_at
    assert np.abs(q).max() < RANGE
    assert label.max() + 1 <= (bars or 4)
    for one in range(label.max() + 1):  # both ends alike
        ends = [np.sum((label == one) & (along == end)) // result.asked.repeats for end in (0.0, length)]
        assert min(ends) >= 1
        assert abs(ends[0] - ends[1]) <= 1
    at = tips(q, payload, Truth())
    columns = []
    for joint in (1, 2, 4):
        soft = tips(q, payload, Truth(compliance=tuple(SOFT * np.eye(5)[joint])))
        columns.append((soft - at).reshape(-1) / SOFT / sigma)
    beside = []
    for one in range(label.max() + 1):
        own = label == one
        ends = [at[own & (along == end)].mean(axis=0) for end in (0.0, length)]
        assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(length, abs=1e-4)
        beside += [np.outer(own, axis).reshape(-1) for axis in np.eye(3)]
        across = np.linalg.svd((ends[1] - ends[0])[None])[2][1:]
        beside += [np.outer(np.where(own, along, 0.0), way).reshape(-1) for way in across]
    kept(result, errors(columns, np.stack(beside, axis=1)))


@pytest.mark.slow
@pytest.mark.parametrize(("instrument", "bar"), [("same_point", ()), ("bar", (0.0, 0.3))])
def test_what_touches_have_told_counts(instrument, bar):
    """The sizes of a plan after a recording are those of least squares of both, each with its own places."""
    arm, effects = spatial_arm(), tuple(("joint_compliance", (joint,)) for joint in (1, 2, 4))
    before = planned(arm, instrument, effects, poses=12, **({"bar": bar} if bar else {}))
    result = plan(arm, before.asked, silent, before.recording)
    q, payload, label, along = [], [], [], []
    for part in (before.recording, result.recording):
        q.append(part.q)
        payload.append(part.payload_mass)
        label.append(part.touches + (max(label[0]) + 1 if label else 0))
        along.append(np.zeros(part.size) if part.bar_at is None else part.bar_at)
    q, payload, label, along = (np.concatenate(item) for item in (q, payload, label, along))
    at = tips(q, payload, Truth())
    soft = [tips(q, payload, Truth(compliance=tuple(SOFT * np.eye(5)[joint]))) for joint in (1, 2, 4)]
    columns = [(item - at).reshape(-1) / SOFT / result.asked.sigma for item in soft]
    beside = []
    for one in range(label.max() + 1):
        own = label == one
        beside += [np.outer(own, axis).reshape(-1) for axis in np.eye(3)]
        if bar:
            way = at[own & (along == bar[1])].mean(axis=0) - at[own & (along == bar[0])].mean(axis=0)
            beside += [
                np.outer(np.where(own, along, 0.0), item).reshape(-1) for item in np.linalg.svd(way[None])[2][1:]
            ]
    kept(result, errors(columns, np.stack(beside, axis=1)))
    smaller = [old.smallest / new.smallest for old, new in zip(before.promise.shown, result.promise.shown, strict=True)]
    assert min(smaller) > 1.2
