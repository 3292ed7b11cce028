"""The written arm file is applied to its own recording, and what it does not keep is said."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry, Link
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import WrittenArm
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.json.diagnosis import diagnosis_json
from linkwright.output.diagnosis_folder import with_written
from linkwright.results.diagnoses.described import describe
from linkwright.results.document import Paragraph
from tests.diagnose.made_diagnosis import made_diagnosis
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip, poses

LONGER = 1e-3
"""m, of link 2."""
NOISE = 2e-5


def diagnosed(*effects, arm=None, promised=3e-5):
    """A diagnosis whose corrected arm holds these effects, of a recording by an arm whose link 2 is longer; with it
    what is left by sums of cosines of what the file says, (N, 2) m."""
    q = poses(40)
    noise = NOISE * np.random.default_rng(2).standard_normal((40, 2))
    true = (LENGTHS[0], LENGTHS[1] + LONGER, LENGTHS[2])
    recording = Recording("r.csv", q, planar_tip(q, true) + noise, np.arange(1, 41))
    arm = planar_arm() if arm is None else arm
    made = made_diagnosis("named")
    finding = replace(made.findings[0], effect="link_length", at=(2,), alternatives=())
    corrected = replace(arm, effects=effects)
    result = replace(
        made, arm=arm, recording=recording, findings=(finding,), corrected=corrected, rms_promised=promised
    )
    own = planar_tip(q, true if effects else LENGTHS)
    return with_written(result, load_catalogue(user=False)), recording.tip - own


def rms(vectors):
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1))))


def warnings(found):
    return [item.text for item in describe(found).items if isinstance(item, Paragraph) and "Warning" in item.text]


def test_a_file_that_holds_what_was_found_keeps_its_promise():
    longer = EffectEntry("link_length", (2,), MappingProxyType({"length": LONGER}))
    result, left = diagnosed(longer)
    assert result.written.rms == pytest.approx(rms(left), rel=1e-9)
    assert result.written.lacks == ()
    assert diagnosis_json(result)["written_arm_rms_mm"] == pytest.approx(1e3 * rms(left))
    kept = replace(result, written=replace(result.written, promised=rms(left) / 1.019))
    assert warnings(kept) == []
    assert len(warnings(replace(result, written=replace(result.written, promised=rms(left) / 1.021)))) == 1


def test_a_file_that_lacks_a_finding_says_so():
    result, left = diagnosed()
    assert result.written.rms == pytest.approx(rms(left), rel=1e-9)
    assert result.written.rms > 0.8 * LONGER
    (warning,) = warnings(result)
    assert "The file lacks true lengths of the links at link 2." in warning
    assert f"{1e3 * rms(left):.3g} mm" in warning


def test_unknown_weights_are_named():
    arm = planar_arm()
    links = (arm.links[0], Link(LENGTHS[1]), Link(LENGTHS[2]))
    result, _ = diagnosed(arm=arm.with_links(links))
    assert result.written.lacks[-1] == "the weight of links 2, 3, which is unknown"


def test_a_diagnosis_that_was_not_written_promises_nothing():
    made = made_diagnosis("named")
    assert made.written is None
    assert diagnosis_json(made)["written_arm_rms_mm"] is None
    assert warnings(made) == []
    told = replace(made, written=WrittenArm(1e-4, 1e-4, ()))
    assert diagnosis_json(told)["written_arm"] == {"rms_mm": 0.1, "promised_mm": 0.1, "lacks": []}
