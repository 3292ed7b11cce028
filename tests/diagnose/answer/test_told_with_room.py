"""Verdicts beside small causes, by the side of approach, and by waves that a joint does not go through as a whole: by
recordings of plain sums of cosines."""

import numpy as np
import pytest

import linkwright as lw
from benchmarks.multibody.cases import kind_of, make_case
from benchmarks.multibody.files import write_case
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.aliases import rivals
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.json.diagnosis import diagnosis_json
from tests.diagnose.by_cosines import GIVES, LENGTHS, SIGMA, file, noise, poses, recording, tips


def many(seed, large):
    """A drive that gives more beside many small causes: zeros, scales, eccentricities, lengths, weight, waves, each of
    them moving the tip by about a third of the noise."""
    rng = np.random.default_rng(seed)
    q = np.repeat(poses(seed, 90), 2, axis=0)
    sizes = SIGMA / 3.0 / np.array([0.7, 0.5, 0.25])
    way = rng.choice([-1.0, 1.0], (5, 3))
    errors = sizes * (way[0] + way[1] * q / 1.3 + way[2] * np.sin(q + 1.0) + way[3] * np.sin(5.0 * q))
    errors[:, 1] += sizes[1] * q[:, 0] / 1.3
    lengths = LENGTHS + SIGMA / 2.0 * way[4]
    tip = tips(q, errors=errors, gives=GIVES + np.array([0.0, large, 0.0]), lengths=lengths, mass=6.01)
    return recording(q, tip + noise(seed, len(q)))


def played(folder, number, seed=2026112501):
    """The diagnosis of a development case of the multibody generator, which shares no code with the product."""
    kind, count = kind_of(number)
    write_case(make_case("case", (seed, 0, number), "development", kind, count), folder)
    own = folder / "cases" / "case"
    arm = lw.read_arm(own / "arm.yaml")
    paths = sorted(own.glob("recording*.csv"))
    read = lw.read_recording(paths[0], arm) if len(paths) == 1 else lw.read_recordings(paths, arm)
    return lw.diagnose(arm, read).found


def test_a_large_cause_beside_eight_small_ones_is_named(tmp_path):
    """1.74 kg more at the tip; beside it a hardening drive, a base that gives, a tool, a drift, a modulus, a heavier
    link, a scale and a coupling, 0.2 to 0.44 times the noise each: none can be told, and all together refute the name
    as the whole answer."""
    result = played(tmp_path, 44)
    assert result.verdict in ("named", "alias_class")
    (load,) = result.findings
    assert load.effect == "payload"
    assert load.parameters[0].interval[0] < 1.74 < load.parameters[0].interval[1]
    told = diagnosis_json(result)
    assert told["lack_of_fit"]["p_value"] < 1e-6
    assert told["lack_of_fit_p"] == told["small_causes"]["lack_of_fit"]["p_value"] >= 0.001
    assert told["small_causes"]["lack_of_fit"]["held_out_times"] < 1.2
    assert 0.5 * told["noise_floor_mm"] < told["small_causes"]["moved_mm"] < 1.3 * told["noise_floor_mm"]
    assert "too small to be told one by one" in result.sentence
    assert any(note.startswith("Remaining error: ") for note in result.notes)


@pytest.mark.slow
def test_many_names_that_foretell_nothing_give_way_to_a_form(tmp_path):
    """A coupling of far joints, which was told by nine names and small causes beside them, is a form that leaves noise;
    the zero that is off is its mean."""
    result = played(tmp_path, 183, seed=2026112801)
    assert result.verdict == "unknown"
    assert result.small is None
    assert [finding.effect for finding in result.findings] == ["encoder_offset"]
    assert result.lack_of_fit.held_out_times < 1.1


@pytest.mark.slow
def test_what_the_library_lacks_beside_a_right_name_stays_unknown(tmp_path):
    """A ripple that grows with the load: no small causes."""
    result = played(tmp_path, 50)
    assert result.verdict == "unknown"
    assert result.small is None


def test_what_cannot_be_told_with_room_for_small_causes_is_declared_too():
    """Names refused by little, as if nothing but noise were beside them, come in; none that was declared goes."""
    read = many(4, 12e-6)
    prepared = prepare(observe(file(), read), Options())
    namer = Namer(prepared, thorough=False, seed=0)
    best = namer.best_of_library()[2].members
    plain = [{rival.member for rival in rivals(namer, best, member)} for member in best]
    judge = namer.with_room(best, least=0.15)
    assert judge is not namer
    roomy = [{rival.member for rival in rivals(namer, best, member, (judge,))} for member in best]
    families = [
        tuple({namer.pool.groups[m].candidate.family for m in found} for found in pair)
        for pair in zip(plain, roomy, strict=True)
    ]
    assert all(before <= after for before, after in families)
    assert sum(len(after) for _, after in families) > sum(len(before) for before, _ in families)


def by_side(seed, size, wave):
    """Joint 2 is off by a wave of its own coordinate, the other way round for each side it came from."""
    q = np.repeat(poses(seed, 60), 2, axis=0)
    sides = np.repeat(np.random.default_rng(seed + 7).choice([-1.0, 1.0], (60, 3)), 2, axis=0)
    errors = size * np.outer(sides[:, 1] * np.sin(wave * q[:, 1] + 0.5), [0.0, 1.0, 0.0])
    return recording(q, tips(q, errors=errors) + noise(seed, len(q)), sides=sides)


@pytest.mark.slow
def test_far_above_the_noise_where_no_pose_was_come_back_to_nothing_is_not_the_answer():
    """A fast ripple that nothing foretells, four times the noise: scatter of the arm, it may be, or not."""
    read = by_side(1, 0.25e-3, 41.0)
    result = diagnose(file(), read)
    assert result.rms_before > 3.0 * result.noise_floor
    assert result.verdict == "unknown"


@pytest.mark.slow
def test_an_arm_that_scatters_by_twice_the_noise_lacks_nothing():
    result = diagnose(file(), by_side(2, 0.05e-3, 41.0))
    assert 1.5 * result.noise_floor < result.rms_before < 2.2 * result.noise_floor
    assert result.verdict == "none"
    assert result.scatter is not None


OF_JOINTS = {"gear_transmission_error", "encoder_eccentricity", "encoder_offset", "encoder_scale", "joint_coupling"}
OF_JOINTS |= {"joint_compliance", "joint_waviness", "link_length", "backlash"}


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_gear_errs_twice_a_turn_though_its_joint_turns_by_less_than_half(seed):
    """Joint 2 goes through 0.83 of a wave: neither an eccentricity nor order 3, among what joints may err by."""
    q = np.repeat(poses(seed, 60), 2, axis=0)
    q[:, 1] *= 1.3 / 2.3
    errors = 0.5e-3 * np.outer(np.sin(2.0 * q[:, 1] + 0.8), [0.0, 1.0, 0.0])
    read = recording(q, tips(q, errors=errors) + noise(seed, len(q)))
    result = diagnose(file(), read, Options(without=frozenset(EFFECTS) - OF_JOINTS))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("gear_transmission_error", (2,))]
    assert {parameter.parameter: parameter.value for parameter in result.findings[0].parameters}["order"] == 2.0
