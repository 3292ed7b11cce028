"""The corrected arm file, written and read back, leaves nothing to be found in the same recording."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.diagnose.fitting.corrected_arm import corrected_arm
from linkwright.core.diagnose.fitting.refit import Refit
from linkwright.core.diagnose.fitting.terms import Term
from linkwright.core.diagnose.motion.corrected import completed
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.core_cases import recorded, with_effects
from tests.diagnose.made_diagnosis import made_arm

CASES = {
    "offset in space": (True, ("encoder_offset", (3,), {"offset": 3e-4}), {}),
    "backlash held by friction": (False, ("backlash", (1,), {"total": 3e-4, "held_below": 1e6}), {}),
    "lag": (
        False,
        ("thermal_expansion", (1, 2, 3), {"expansion": 23e-6, "lag": 2400.0}),
        {"hours": 6.0, "temperature": (293.15, 318.15)},
    ),
    "modulus": (False, ("link_modulus", (1, 2, 3), {"excess": -0.3}), {"payloads": (0.0, 20.0)}),
    "creep of the arm's own weight": (
        False,
        ("creep", (1,), {"compliance": 4e-6, "time_constant": 3600.0, "anew": 0.0}),
        {"hours": 5.0},
    ),
}


def read_back(arm, folder):
    path = folder / "arm.yaml"
    write_arm(arm, path)
    return read_arm(path)


@pytest.mark.parametrize("name", slow_but(CASES, "backlash held by friction"))
def test_the_corrected_arm_explains_the_recording(name, tmp_path):
    space, entry, changed = CASES[name]
    arm = made_arm(space)
    recording = recorded(with_effects(arm, entry), **{"poses": 12, **changed})
    first = diagnose(arm, recording)
    assert first.findings
    again = diagnose(read_back(first.corrected, tmp_path), recording)
    assert again.verdict == "none"
    assert again.rms_before == pytest.approx(first.rms_after, rel=2e-2)


@pytest.mark.slow
def test_physics_left_out_comes_back_whole(tmp_path):
    arm = made_arm()
    recording = recorded(arm, payloads=(0.0, 20.0), poses=12)
    first = diagnose(replace(arm, leave_out=frozenset({"slope_propagation"})), recording)
    assert [finding.effect for finding in first.findings] == ["slope_propagation"]
    again = diagnose(read_back(first.corrected, tmp_path), recording)
    assert again.verdict == "none"


def refitted(candidate, sizes):
    """A fit that found this one term."""
    nothing = np.zeros((1, 2))
    return Refit((Term(candidate, sizes, nothing[:, :, None], nothing),), ((),), nothing, 0.0, 1)


@pytest.mark.parametrize(("share", "back"), [(0.98, True), (0.5, False), (1.8, False)])
def test_half_an_effect_does_not_come_back_whole(share, back):
    """The file can hold the physics or leave it out; where neither is so, it says that it cannot."""
    arm = replace(made_arm(), leave_out=frozenset({"slope_propagation"}))
    candidate = Candidate("slope_propagation", (0, 1), ("share",), MappingProxyType({}), share=True)
    corrected, notes = corrected_arm(arm, refitted(candidate, np.array([share])))
    assert ("slope_propagation" not in corrected.leave_out) is back
    assert any("slope_propagation" in note for note in notes) is not back


def test_a_shape_of_nought_is_kept_where_it_says_something():
    """Creep that began with the recording must not turn into creep that begins anew with each payload."""
    shapes = {"time_constant": 3600.0, "anew": 0.0}
    candidate = Candidate("creep", (0,), ("compliance",), MappingProxyType(shapes))
    corrected, _ = corrected_arm(made_arm(), refitted(candidate, np.array([1e-6])))
    assert corrected.effects[0].parameters["anew"] == 0.0


def test_what_was_fitted_as_nothing_does_not_enter_the_file():
    """Sizes held to what is usual lie at zero exactly; a zero that the file has stays."""
    compliance = Candidate("joint_compliance", (0,), ("compliance",), MappingProxyType({}))
    lag = Candidate("creep", (0,), ("compliance",), MappingProxyType({"time_constant": 3600.0}))
    given = EffectEntry("encoder_offset", (2,), {"offset": 0.0})
    arm = replace(made_arm(), effects=(given,))
    for candidate in (compliance, lag):
        assert corrected_arm(arm, refitted(candidate, np.array([0.0])))[0].effects == (given,)
        assert len(corrected_arm(arm, refitted(candidate, np.array([1e-9])))[0].effects) == 2
    nothing, something = (
        EffectEntry("gear_ripple", (1,), {"sine": x, "cosine": 0.0, "order": 2.0}) for x in (0.0, 0.5)
    )
    assert completed(arm, (), (), (nothing,)).effects == (given,)
    assert len(completed(arm, (), (), (something,)).effects) == 2


def test_forms_do_not_enter_the_file():
    arm = made_arm()
    form = Candidate("step_in_time", (), (), MappingProxyType({"since": 1.0}), outside=True)
    corrected, notes = corrected_arm(arm, refitted(form, np.array([1.0])))
    assert corrected == arm
    assert notes == ()
