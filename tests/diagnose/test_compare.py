"""Two recordings of one arm: differences of parameters with their intervals, shared poses, the command."""

import json
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from scipy import stats

import linkwright as lw
from linkwright.core.diagnose.compare.compare import common_model, compare, fit_common, holm
from linkwright.core.diagnose.compare.places import regions, shared_poses
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.result import Alternative, Covered, Finding, FittedParameter
from linkwright.face.planning.comparison import Comparison, comparison_sentence
from tests.diagnose.by_cosines import file, noise, poses, recording, tips
from tests.diagnose.made_diagnosis import made_arm, made_diagnosis, made_recording, measured, softer, write_recording
from tests.linkwright.conftest import bench, linkwright  # noqa: F401 - fixtures

NOISE = 2e-5


def recording_of(compliance, seed, visit_noise=0.0, **changed):
    """The made recording, read from an arm whose drive 2 gives more; `visit_noise` (m) is shared by a visit's rows."""
    arm = made_arm()
    plain = made_recording(arm, poses=16, repeats=3, sides=None, temperature=None, **changed)
    rng = np.random.default_rng(seed)
    tip = measured(softer(arm, compliance), plain.q, plain.payload_mass, rng, NOISE)
    tip = tip + np.repeat(rng.normal(0.0, visit_noise, (16, 2)), 3, axis=0) if visit_noise else tip
    return replace(plain, tip=tip)


def diagnosis_of(compliance, seed, named=True, **changed):
    """A diagnosis of such a recording as the engine would return it, with the finding made by hand."""
    recording = recording_of(compliance, seed, **changed)
    residual = observe(made_arm(), recording).tip_residual()
    verdict = "named" if named else "none"
    return made_diagnosis(verdict, recording=recording, residual_before=residual, noise_floor=NOISE * 2**0.5)


def test_holm_by_hand():
    """Sorted 0.005, 0.01, 0.03, 0.04: times 4, 3, 2, 1, never falling."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([]) == []
    assert holm([0.9, 0.8]) == pytest.approx([1.0, 1.0])


def test_change_is_measured():
    """Drive 2 from 20 to 35 urad/(N*m): the difference is 15, within its interval, and beyond doubt."""
    result = compare(made_arm(), diagnosis_of(2e-5, 1), diagnosis_of(3.5e-5, 2))
    (change,) = result.changes
    assert (change.effect, change.first.at, change.first.parameter) == ("joint_compliance", (2,), "compliance")
    assert change.first.interval[0] < 2e-5 < change.first.interval[1]
    assert change.second.interval[0] < 3.5e-5 < change.second.interval[1]
    assert change.interval[0] < 1.5e-5 < change.interval[1]
    wide, *of_each = (np.ptp(item) for item in (change.interval, change.first.interval, change.second.interval))
    assert wide == pytest.approx(np.hypot(*of_each), rel=0.02)
    assert change.changed
    assert result.unexplained == pytest.approx((NOISE * 2**0.5,) * 2, rel=0.15)
    sentence = comparison_sentence(result)
    assert sentence.startswith("Changed: compliance of the drives (joint 2), compliance from 2")
    content = json.loads(Comparison(lw.Arm.of(result.first.arm), result).to_json())
    assert content["changes"][0]["difference"] == pytest.approx(change.difference)
    assert content["sentence"] == sentence


def test_what_only_one_shows_is_measured_in_the_other():
    """Nothing was named in the first; there the common model finds nothing, within its interval."""
    result = compare(made_arm(), diagnosis_of(0.0, 3, named=False), diagnosis_of(2e-5, 4))
    (change,) = result.changes
    assert change.first.interval[0] < 0.0 < change.first.interval[1]
    assert change.changed


def test_change_of_an_arm_that_gives_by_millimetres():
    """Drive 2 gives 100, then 130 urad/(N*m) more than the file's 200, which bends the arm by millimetres: nothing is
    left but the noise, and no interval is wider than that of readings that first order holds for."""
    gives, sigma = np.array([1.2e-4, 2.0e-4, 2.5e-4]), 5e-6
    stiff = file()
    joints = tuple(replace(joint, stiffness=1.0 / item) for joint, item in zip(stiff.joints, gives, strict=True))
    arm = replace(stiff, joints=joints)
    fits = []
    for seed, more in ((1, 1.0e-4), (2, 1.3e-4)):
        q = np.repeat(poses(seed, 120), 2, axis=0)
        tip = tips(q, gives=gives + np.array([0.0, more, 0.0]), rounds=30) + noise(seed, len(q), sigma)
        term = Candidate("joint_compliance", (1,), ("compliance",), MappingProxyType({}))
        fits.append(fit_common(arm, recording(q, tip), (term,)))
        reach = stats.t.ppf(0.975, fits[-1].freedom) * fits[-1].errors[0][0]
        assert abs(fits[-1].sizes[0][0] - more) < 1.5 * reach
        assert reach < 1e-7
        assert fits[-1].rms == pytest.approx(sigma * 2**0.5, rel=0.1)


@pytest.mark.parametrize(
    ("visit_noise", "pairs"),
    [(3e-5, 40), pytest.param(0.0, 150, marks=pytest.mark.slow), pytest.param(3e-5, 150, marks=pytest.mark.slow)],
)
def test_intervals_cover_and_nothing_is_called_changed(visit_noise, pairs):
    """Pairs without a change: 95 % intervals cover them (binomial, 3 sigma), also where visits share errors."""
    arm = made_arm()
    terms, _ = common_model(diagnosis_of(2e-5, 1), diagnosis_of(2e-5, 2))
    values, reach = np.empty(2 * pairs), np.empty(2 * pairs)
    for seed in range(2 * pairs):
        fitted = fit_common(arm, recording_of(2e-5, seed, visit_noise), terms)
        values[seed] = fitted.sizes[0][0]
        reach[seed] = stats.t.ppf(0.975, fitted.freedom) * fitted.errors[0][0]
    covered = np.mean(np.abs(values[::2] - values[1::2]) < np.hypot(reach[::2], reach[1::2]))
    assert covered >= 0.95 - 3.0 * (0.95 * 0.05 / pairs) ** 0.5
    assert pairs < 150 or covered <= 0.999  # every eighth sample of 40 has no miss
    assert abs(values.mean() - 2e-5) < 4.0 * values.std() / (2 * pairs) ** 0.5


def test_names_that_the_data_cannot_tell_apart_are_one():
    """The second names bending of link 2 and lists the drive as its alternative: one term, and a note."""
    first, second = diagnosis_of(2e-5, 1), diagnosis_of(2e-5, 2)
    other = Finding(
        "link_modulus",
        (2,),
        (Alternative("joint_compliance", (2,), 0.999, 0.1),),
        (),
        1e-4,
        1e-3,
        2e-4,
        2e-4,
        "",
    )
    terms, notes = common_model(first, replace(second, findings=(other,)))
    assert [(term.effect, term.at) for term in terms] == [("joint_compliance", (1,))]
    assert "link_modulus at 2" in notes[0]


def test_left_out_physics_is_compared_as_a_share():
    """`share` belongs to effects that the arm file leaves out: a pure number, one column."""
    arm = replace(made_arm(), leave_out=frozenset({"slope_propagation"}))
    fitted = FittedParameter("share", "share", (), "dimensionless", 1.0, (0.9, 1.1))
    finding = replace(made_diagnosis().findings[0], effect="slope_propagation", at=(), parameters=(fitted,))
    recording = recording_of(0.0, 5)
    residual = observe(arm, recording).tip_residual()
    one = made_diagnosis("named", arm, recording=recording, residual_before=residual, findings=(finding,))
    (change,) = compare(arm, one, one).changes
    assert change.first.kind == "dimensionless"
    # The recording comes from an arm that has the whole of it.
    assert change.first.interval[0] < 1.0 < change.first.interval[1]


def test_shared_poses_by_hand():
    """Two poses of three are shared under the same load; there the mismatch moved by 3 and 4 um: sqrt(12.5) um RMS."""
    arm = made_arm()
    q = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]])

    def at(q, payload, residual):
        rows = np.arange(len(q))
        recording = replace(made_recording(arm), q=q, tip=q[:, :2], row=rows, payload_mass=np.array(payload))
        results = {"recording": recording, "residual_before": 1e-6 * np.array(residual), "noise_floor": 1e-6}
        return replace(made_diagnosis(), **results)

    first = at(q, [0.0, 0.0, 0.0], [[0, 0], [0, 0], [9, 9]])
    second = at(np.vstack([q + 1e-5, q[2:]]), [0.0, 0.0, 5.0, 5.0], [[3, 0], [0, 4], [50, 0], [50, 0]])
    shared = shared_poses(arm, first, second)
    assert shared.count == 2
    assert shared.moved == pytest.approx(12.5**0.5 * 1e-6)
    assert shared.by_chance == pytest.approx(2.0**0.5 * 1e-6)
    assert shared_poses(arm, at(q[:1], [0.0], [[0, 0]]), at(q[1:2], [0.0], [[0, 0]])) is None


def test_regions_hold_only_what_both_visited():
    """Every region has readings of both, and together not more than there are."""
    first, second = diagnosis_of(2e-5, 1), diagnosis_of(2e-5, 2)
    result = regions(made_arm(), first, second)
    assert result
    assert all(min(item.counts) >= 5 for item in result)
    assert sum(item.counts[0] for item in result) <= first.recording.size


def test_figures_of_both_stand_beside_each_other():
    one = Covered("RP", "pose repeatability", "ISO 9283:1998", 1e-5, 9)
    first = replace(diagnosis_of(2e-5, 1), figures=(one, replace(one, symbol="AP")))
    second = replace(diagnosis_of(2e-5, 2), figures=(replace(one, value=2e-5),))
    assert [(a.value, b.value) for a, b in compare(made_arm(), first, second).figures] == [(1e-5, 2e-5)]


def test_columns_that_only_one_has_are_said():
    first = diagnosis_of(2e-5, 1)
    second = replace(first, recording=replace(first.recording, payload_mass=None, frame="free"))
    notes = compare(made_arm(), first, second).notes
    assert "Only the first recording holds the payload." in notes
    assert any("Frame or tool" in note for note in notes)


def test_verdicts_of_unknown_are_told():
    """What nothing explains, and only in the second, is a change as well."""
    first, second = made_diagnosis("none"), made_diagnosis("unknown")
    words = comparison_sentence(compare(made_arm(), first, second))
    assert "The second holds a mismatch that nothing explains" in words


def test_command(linkwright, bench):  # noqa: F811 - the fixtures
    """Before and after: what gave more gives more, and the exit status is 0."""
    write_recording(bench, 2e-5, "before.csv", seed=1)
    write_recording(bench, 5e-5, "after.csv", seed=2)
    status, out, err = linkwright(
        "compare", "arm.yaml", "before.csv", "after.csv", "--json", "c.json", "--markdown", "c.md"
    )
    assert (status, err) == (0, "")
    content = json.loads((bench / "c.json").read_text(encoding="utf-8"))
    changed = [item for item in content["changes"] if item["changed"]]
    assert changed
    assert content["sentence"] in out
    assert "| left by the common model |" in (bench / "c.md").read_text(encoding="utf-8")
    assert content["shared_poses"]["count"] == 48
    assert content["shared_poses"]["moved_mm"] > 5.0 * content["shared_poses"]["by_chance_mm"]
    assert MappingProxyType(content).keys() >= {"recordings", "regions", "iso_figures", "notes"}
    status, out, err = linkwright("compare", "arm.yaml", "before.csv", "none.csv")
    assert (status, len(err.splitlines())) == (2, 1)
