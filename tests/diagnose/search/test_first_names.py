"""Which name of an alias class goes first."""

from dataclasses import replace

import pytest

from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.aliases import Rival, preferred
from linkwright.core.diagnose.search.naming import Namer
from tests.diagnose.core_cases import group_of, prepared_null, recorded, with_residual
from tests.diagnose.made_diagnosis import made_arm


@pytest.mark.parametrize("space", [False, True])
def test_every_candidate_may_go_first(space):
    """Sizes, shares of what the model leaves out, and forms outside the library."""
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
