"""Which name of an alias class goes first."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.aliases import Rival, preferred
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import group_of, prepared_null, recorded, with_residual
from tests.diagnose.made_diagnosis import made_arm
from tests.diagnose.recorded import planar_arm


@pytest.mark.parametrize("space", [False, True])
def test_every_candidate_may_go_first(space):
    """Sizes, shares of what the model lacks, and forms outside the library."""
    arm = made_arm(space)
    recording = recorded(arm)
    namer = Namer(
        prepare(observe(replace(arm, leave_out=frozenset({"slope_propagation"})), recording), Options()),
        thorough=False,
        seed=0,
    )
    kinds = {(group.candidate.effect, group.candidate.sizes): k for k, group in enumerate(namer.pool.groups)}
    assert any(group.candidate.share for group in namer.pool.groups)
    for member in kinds.values():
        assert preferred(namer, [member], member, []) == member


def test_what_takes_all_places_to_be_wrong_alike_comes_after_one_thing():
    """All lengths in proportion and the instrument's scale are one pattern."""
    null = prepared_null()
    namer = Namer(null, thorough=False, seed=0)
    candidates = [group.candidate for group in namer.pool.groups]
    (scale,) = (k for k, item in enumerate(candidates) if item.effect == "instrument_scale")
    (lengths,) = (k for k, item in enumerate(candidates) if item.effect == "link_length" and item.sizes == ("stretch",))
    (column,) = null.columns[scale].transpose(2, 0, 1)
    signal = Namer(with_residual(null, null.observed.residual + 3e-4 * column), thorough=False, seed=0)
    for first, other in ((scale, lengths), (lengths, scale)):
        assert preferred(signal, [first], first, [Rival(other, 1.0, 0.0)]) == scale


@pytest.mark.parametrize("size", [-0.3, -0.1, 0.2])
def test_what_a_file_says_is_off_before_it_lacks_a_bending(size):
    """The noise alone looks like a modulus off by 0.04."""
    null = prepared_null()
    names = [group_of(null, name, (1,)) for name in ("link_modulus", "link_bending")]
    moved = null.columns[names[0]][:, :, 0] * size
    signal = Namer(with_residual(null, null.observed.residual + moved), thorough=False, seed=0)
    for member, rival in (names, names[::-1]):
        assert preferred(signal, [member], member, [Rival(rival, 1.0, 0.0)]) == names[0]


def test_a_joint_that_stands_gives_way_by_far_to_no_other_name_of_its_own():
    """A worn gear that holds a lever of 100 mm, pulled by 10 N to either side, turns by 30 mrad each way. That is four
    times the play that is usual, and 300 times the compliance: it counts for less that drives give more often."""
    rng, way = np.random.default_rng(1), np.tile(np.repeat([1.0, -1.0], 3), 12)
    arm = planar_arm((0.1,))
    tip = 0.1 * np.stack([np.cos(30e-3 * way), np.sin(30e-3 * way)], axis=1)
    tip += 5e-5 * rng.standard_normal(tip.shape)
    force = np.stack([np.zeros(72), 10.0 * way, np.zeros(72)], axis=1)
    read = Recording("made", np.zeros((72, 1)), tip, np.arange(1, 73), force=force, frame="known", tool="known")
    (finding,) = diagnose(arm, read).findings
    assert finding.effect == "backlash"
    (total, *_) = finding.parameters
    assert total.value == pytest.approx(60e-3, rel=0.02)
    compliance = next(item for item in finding.alternatives if item.effect == "joint_compliance")
    assert compliance.worse > 10.0
