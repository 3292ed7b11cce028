"""A search that is made again goes on from what an earlier one named, and is made anew where that does not hold."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.naming import Namer, _anew, name_missing
from tests.diagnose.arm_of_drives import arm_of_drives, read, turned_by

ARM = arm_of_drives()
RIPPLE = (3.0, 7.0, 11.0)
"""Orders of the errors of the three joints' angles, a finding each, beside their zeros."""
DEARER = 0.2
"""A group more, its shape moved off the grid, makes the choice among variants dearer by some hundredths."""


@pytest.fixture(scope="module")
def namer():
    """Zeros that are off at all joints, and angles that ripple at each."""
    rng = np.random.default_rng(8)
    q = np.repeat(rng.uniform(-1.6, 1.6, (150, 3)), 2, axis=0)
    off = turned_by(q, (2e-4, -3e-4, 2.5e-4)) + sum(
        turned_by(q, np.eye(3)[joint][None, :] * (1.5e-4 * np.sin(order * q[:, joint]))[:, None])
        for joint, order in enumerate(RIPPLE)
    )
    carried = np.repeat(rng.choice([0.0, 4.0], 150), 2)
    return Namer(
        prepare(observe(ARM, read(q, off, rng, payload_mass=carried)), Options(), None), thorough=False, seed=0
    )


def named_of(namer, before=()):
    return name_missing(namer, lambda _: None, before)


def candidates(namer, members):
    return [namer.pool.groups[member].candidate for member in members]


@pytest.mark.slow
def test_what_was_named_is_found_again_in_the_pool(namer):
    named = named_of(namer)
    assert len(named.members) > 3
    assert namer.numbers_of(candidates(namer, named.members)) == named.members


def test_a_shape_off_the_grid_comes_in_as_a_group_of_its_own(namer):
    of = next(g.candidate for g in namer.pool.groups if g.candidate.free_shapes and not g.candidate.outside)
    moved = replace(of, shapes={**of.shapes, **{name: 1.07 * of.shapes[name] for name in of.free_shapes}})
    groups = len(namer.pool.groups)
    (number,) = namer.numbers_of([moved])
    assert number == groups
    assert namer.pool.groups[number].candidate.shapes == moved.shapes


@pytest.mark.slow
@pytest.mark.parametrize("beginning", ["what holds", "and one that does not", "nothing that holds", "a few"])
def test_what_an_earlier_search_named_is_not_searched_anew(namer, monkeypatch, beginning):
    """Exchanges take the place of what does not hold, even where that is all."""
    namer = namer.with_prepared(namer.prepared)  # what it takes in is its own
    whole = named_of(namer)
    known, value = candidates(namer, whole.members), namer.criterion_of(whole.members)
    families = namer.families(whole.members)
    others = [k for k, g in enumerate(namer.pool.groups) if namer.library[k] and g.candidate.family not in families]
    alone = namer.prepared.products.gains()
    nothing = candidates(namer, sorted(others, key=lambda number: alone[number])[:5])
    before = {
        "what holds": known,
        "and one that does not": [*known, nothing[0]],
        "nothing that holds": nothing,
        "a few": known[:3],
    }
    ways = []

    def anew(*asked):
        ways.append("anew")
        return _anew(*asked)

    monkeypatch.setattr("linkwright.core.diagnose.search.naming._anew", anew)
    again = named_of(namer, before[beginning])
    assert namer.criterion_of(again.members) <= value + DEARER
    assert ways == (["anew"] if beginning == "a few" else [])


@pytest.mark.slow
def test_the_better_end_counts(namer, monkeypatch):
    """A search anew that stops early does not lose what was known; one that goes all the way loses nothing by a bad
    beginning."""
    whole = named_of(namer)
    known = candidates(namer, whole.members)
    value = namer.criterion_of(whole.members)
    from_bad = named_of(namer, known[:1])
    assert namer.criterion_of(from_bad.members) <= value + DEARER

    monkeypatch.setattr(
        "linkwright.core.diagnose.search.naming._carried_on", lambda _, members, p_values: (members, p_values)
    )
    early = named_of(namer)
    assert namer.criterion_of(early.members) > value + 1.0
    again = named_of(namer, known)
    assert namer.criterion_of(again.members) <= value + DEARER
