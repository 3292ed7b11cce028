"""What a diagnosis says, held against results that would make it false."""

import math
from dataclasses import replace

import pytest

from linkwright.core.diagnose.answer.sentences import put_in_first, verdict_sentence
from linkwright.core.diagnose.compare.compare import compare
from linkwright.core.diagnose.result import FittedParameter, Left, WrittenArm
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.face.planning.comparison import comparison_sentence
from linkwright.results.diagnoses.answer import answer, to_do
from linkwright.results.diagnoses.described import describe
from linkwright.results.diagnoses.words import where_sentences
from tests.diagnose.made_diagnosis import made_arm, made_diagnosis

FLOOR = 2e-5


def left(fitted, held_out=None):
    """What is left, in times of the noise floor."""
    return Left(fitted * FLOOR, (fitted if held_out is None else held_out) * FLOOR, FLOOR, RULES.fitting)


def said(found, what, before=1e-4):
    return verdict_sentence(found.findings, None, before, what, 0.001)


@pytest.mark.parametrize(("fitted", "held_out"), [(1.0, 1.0), (1.08, 1.09), (0.9, 1.7), (1.05, 1.2), (1.3, 1.3)])
def test_what_remains_is_called_noise_where_that_is_so_of_readings_not_fitted(fitted, held_out):
    """1.7 times the noise floor held out is not the noise floor, on the first screen no more than below."""
    rms = {"rms_after": fitted * FLOOR, "rms_after_held_out": held_out * FLOOR, "noise_floor": FLOOR}
    result = replace(made_diagnosis("named"), **rms)
    noise = max(fitted, held_out) <= 1.1
    texts = said(result, result.left), answer(result)
    assert [("is the noise floor" in texts[0]), texts[1].endswith(" mm, the noise floor.")] == [noise, noise]
    if not noise:
        shown = held_out if fitted <= 1.1 else fitted
        assert all(f"{shown:.1f} times the noise floor" in text for text in texts)


def test_without_a_noise_floor_nothing_is_called_it():
    result = replace(made_diagnosis("named"), noise_floor=None)
    assert "no repeats say how much" in said(result, result.left)
    assert math.isnan(result.left.times)
    assert not result.left.is_noise
    assert not result.left.is_more
    assert "noise floor" not in answer(result)


def test_nothing_missing_is_said_of_what_is_no_more_than_noise():
    """1.4 times the noise floor is no mismatch that could be told, but not the noise floor; 1.8 times is more."""
    made = made_diagnosis("none")

    def at(times):
        rms = dict.fromkeys(("rms_before", "rms_after", "rms_after_held_out"), times * FLOOR)
        return replace(made, noise_floor=FLOOR, **rms)

    plain, some, much = at(1.0), at(1.4), at(1.8)
    assert answer(plain).endswith("that remain are the noise floor.")
    assert "No mismatch beyond the noise floor" in said(plain, plain.left, plain.rms_before)
    assert answer(some).endswith("remain, 1.4 times the noise floor.")
    assert "No mismatch beyond chance" in said(some, some.left, some.rms_before)
    assert answer(much).startswith("More than noise")
    assert "More than noise" in said(much, much.left, much.rms_before)
    assert much.unexplained
    assert "nothing missing" not in repr(describe(much))
    assert "nothing missing" in repr(describe(plain))


def test_what_wanders_counts_with_the_noise():
    result = replace(made_diagnosis("named"), noise_floor=3e-5, wandered=4e-5, rms_after=5e-5, rms_after_held_out=5e-5)
    assert result.left.floor == pytest.approx(5e-5)
    assert result.left.is_noise


@pytest.mark.parametrize(("share", "sits"), [(0.98, True), (0.5, True), (0.49, False), (0.007, False)])
def test_a_mismatch_sits_at_a_joint_that_could_describe_half_of_it(share, sits):
    made = made_diagnosis("named")
    where = replace(made.where, joint=3, joint_shares=(0.01, 0.2, share))
    text = " ".join(where_sentences(replace(made, where=where)))
    assert ("sits at joint 3" in text) == sits
    assert ("no single joint" in text) != sits
    assert f"{100 * share:.2g} %" in text


def test_a_direction_is_that_of_most_of_the_mismatch():
    made = made_diagnosis("named")
    assert "The tip is displaced" in " ".join(where_sentences(made))
    hardly = replace(made, rms_after=0.9 * made.rms_before)
    assert "The tip is displaced" not in " ".join(where_sentences(hardly))


@pytest.mark.parametrize("told", [True, False])
def test_next_poses_are_asked_for_as_they_tell(told):
    """Once where that is enough; and none, no advice."""
    made = made_diagnosis("alias_class", next_poses_enough=told)
    lines = " ".join(to_do(made))
    assert ("which tell the names apart" in lines) == told
    assert ("each several times" in lines) != told
    assert "poses listed below" not in " ".join(to_do(replace(made, next_poses=())))


def test_an_arm_file_that_makes_it_worse_is_not_advised():
    made = made_diagnosis("named")
    better, worse = (WrittenArm(share * made.rms_before, made.rms_after, ()) for share in (0.5, 1.01))
    assert "Use arm.yaml" in " ".join(to_do(replace(made, written=better)))
    assert "Use arm.yaml" not in " ".join(to_do(replace(made, written=worse)))


def test_a_file_of_findings_that_may_be_nothing_is_not_advised():
    made = made_diagnosis("named")
    doubtful = tuple(replace(finding, may_be_nothing=True) for finding in made.findings)
    assert "Use arm.yaml" in " ".join(to_do(made))
    assert "Use arm.yaml" not in " ".join(to_do(replace(made, findings=doubtful)))


@pytest.mark.parametrize("off", [(3.0,), (3.0, 1.5)])
def test_zeros_that_are_off_are_put_in_first(off):
    result = made_diagnosis("named")
    (made,) = result.findings
    zeros = [
        FittedParameter(f"offset_{k}", "offset", (k,), "angle", math.radians(value), (0.0, 1.0))
        for k, value in enumerate(off, start=4)
    ]
    findings = [replace(made, effect="encoder_offset", at=zero.at, parameters=(zero,)) for zero in reversed(zeros)]
    assert put_in_first([made, *findings], result.arm) == (
        " Zero of joint 4 is off by 3 deg: put it into the arm file first."
        if len(off) == 1
        else " Zeros of joints 4 and 5 are off by 3 and 1.5 deg: put them into the arm file first."
    )
    assert put_in_first([made], result.arm) == ""


@pytest.mark.parametrize(("share", "good"), [(0.9, True), (0.02, False), (-0.4, False)])
def test_a_smooth_model_that_predicts_nothing_is_no_compensation(share, good):
    made = made_diagnosis("unknown")
    page = repr(describe(replace(made, unknown=replace(made.unknown, held_out_share=share))))
    assert ("good for compensation" in page) == good
    assert ("compensation.csv: what to subtract" in page) == good
    assert ("nothing to compensate by" in page) != good


@pytest.mark.parametrize(
    ("source", "words"),
    [("repeats", "what repeats scatter by"), ("declared", "as declared"), ("revisits", "visits of one")],
)
def test_the_noise_floor_is_said_to_be_what_it_is(source, words):
    """Beside a declared one stands no word of repeats."""
    page = repr(describe(made_diagnosis("named", noise_from=source)))
    assert words in page
    assert ("what repeats scatter by" in page) == (source == "repeats")


def test_of_a_recording_that_says_nothing_no_comparison_says_that_it_holds_no_mismatch():
    unknown, none, nothing = (made_diagnosis(item) for item in ("unknown", "none", "insufficient_data"))
    floor = none.noise_floor
    loud = replace(none, rms_before=2 * floor, rms_after=2 * floor, rms_after_held_out=2 * floor)

    def compared(first, second):
        return comparison_sentence(compare(made_arm(), first, second))

    assert "The second holds a mismatch that nothing explains; the first does not." in compared(none, unknown)
    assert "The first held a mismatch that nothing explains; the second does not." in compared(unknown, none)
    assert "The second holds a mismatch that nothing explains." in compared(nothing, unknown)
    assert "Both hold a mismatch that nothing explains." in compared(loud, unknown)
    assert "a mismatch" not in compared(none, none)
